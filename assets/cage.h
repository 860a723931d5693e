/* Box modelling: a closed mesh of quads that grows by extruding patches of its faces. */
#ifndef ASSETS_CAGE_H
#define ASSETS_CAGE_H

#include <stdbool.h>
#include <stdint.h>

#define CAGE_MAX 6000
#define CAGE_MAX_PATCH 16

typedef struct point {
    float x, y, z;
} point;

static inline point point_make(float x, float y, float z) {
    return (point){x, y, z};
}

static inline point point_add(point a, point b) {
    return (point){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline point point_scale(point a, float s) {
    return (point){a.x * s, a.y * s, a.z * s};
}

static inline point point_sub(point a, point b) {
    return (point){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline point point_cross(point a, point b) {
    return (point){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline float point_dot(point a, point b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

struct cage {
    point points[CAGE_MAX];
    int32_t quads[CAGE_MAX][4]; /* counter-clockwise seen from outside */
    int npoints, nquads;
    bool full; /* something did not fit: the mesh is useless */
};

/* Some faces that move together, with every vertex's place (a,b) in the plane of a cross-section,
 * -1..1. */
struct patch {
    int faces[CAGE_MAX_PATCH], nfaces;
    int points[4 * CAGE_MAX_PATCH], npoints;
    float a[4 * CAGE_MAX_PATCH], b[4 * CAGE_MAX_PATCH];
    int first_side,
        nsides; /* the quads that the last extrusion added, in order around the struct patch */
};

/* Where a cross-section lies: centre + a * across + b * up. */
typedef struct section {
    point centre, across, up;
} section;

int cage_add_point(struct cage *cage, point p);
int cage_add_quad(struct cage *cage, int a, int b, int c, int d);

/* A patch of faces; (a,b) are left at zero. */
struct patch patch_of(const struct cage *cage, const int *faces, int nfaces);
/* Sets (a,b) from where the points are now along two directions, stretched to -1..1. */
void patch_measure(const struct cage *cage, struct patch *patch, point across, point up);
void patch_place(struct cage *cage, const struct patch *patch, const section *where);
/* Gives the patch new points of its own and joins them to the old by a band of quads. The faces
 * keep their numbers. */
void patch_extrude(struct cage *cage, struct patch *patch);
/* Moves the patch, scaling it about its middle. */
void patch_shift(struct cage *cage, const struct patch *patch, point by, float scale);
/* Extrusion, then patch_place. */
void patch_extrude_to(struct cage *cage, struct patch *patch, const section *where);

/* The quad of the last extrusion whose middle is nearest to (a,b). */
int patch_side(const struct patch *patch, const struct cage *cage, float a, float b);

point cage_face_centre(const struct cage *cage, int face);
point cage_face_normal(const struct cage *cage, int face); /* not of unit length */

/* One step of Catmull and Clark's refinement of a closed mesh; face f becomes 4f .. 4f + 3. */
void cage_refine(const struct cage *coarse, struct cage *fine);

#endif
