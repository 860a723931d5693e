/* Texture coordinates that go round: cylindrical, toroidal and spherical ones with a single value a
 * vertex, for programs that interpolate them the short way, after
 * Tarini, "Cylindrical and toroidal parameterizations without vertex seams" (2011); and meshes
 * without the vertices that were duplicated for want of it. */
#ifndef SELVAGE_WRAP_H
#define SELVAGE_WRAP_H

#include <selvage/mesh.h>

#include <math.h>

#ifdef __cplusplus
extern "C" {
#endif

/* From one coordinate to another the short way: what to add to the first, -1/2 to 1/2. */
static inline float slv_wrap_step(float from, float to) {
    float d = to - from;
    return d - rintf(d);
}

/* A coordinate in 0..1 and in -1/2..1/2: of every triangle that spans less than half of the map at
 * least one is what was meant. What follows is for those who interpolate by themselves; programs in
 * GLSL have the same in selvage_wrap.glsl, which is installed in share/selvage. */
static inline void slv_wrap_pair(float u, float pair[2]) {
    float turned = u + 0.5f;
    pair[0] = u - floorf(u);
    pair[1] = turned - floorf(turned) - 0.5f;
}

/* Of an interpolated pair the one whose |d/dx| + |d/dy|, `change`, is the smaller; the factor keeps
 * rounding from choosing where both are the same. */
static inline float slv_wrap_choose(const float pair[2], const float change[2]) {
    return change[0] <= change[1] * 1.01f ? pair[0] : pair[1];
}

/* The direction in a triangle (three corners of three numbers) in which u grows and v does not, of
 * length 1, zero where there is none; coordinates that go round take the short way from the first
 * corner on. The other tangent has u and v exchanged. */
static inline void slv_wrap_tangent(const float positions[9], const float u[3], const float v[3],
                                    bool round_u, bool round_v, float tangent[3]) {
    float du[2], dv[2], size = 0;
    for (int k = 0; k < 2; k++) {
        du[k] = round_u ? slv_wrap_step(u[0], u[k + 1]) : u[k + 1] - u[0];
        dv[k] = round_v ? slv_wrap_step(v[0], v[k + 1]) : v[k + 1] - v[0];
    }
    float sign = du[0] * dv[1] - du[1] * dv[0] < 0 ? -1.0f : 1.0f;
    for (int c = 0; c < 3; c++) {
        float along = positions[3 + c] - positions[c], other = positions[6 + c] - positions[c];
        tangent[c] = sign * (along * dv[1] - other * dv[0]);
        size += tangent[c] * tangent[c];
    }
    for (int c = 0; c < 3; c++)
        tangent[c] = size > 0 ? tangent[c] / sqrtf(size) : 0;
}

/* Which texture coordinates go round: u is the first bit, v the second. */
typedef enum slv_wrap_round {
    SLV_WRAP_ROUND_NO = 0,
    SLV_WRAP_ROUND_U,
    SLV_WRAP_ROUND_V,
    SLV_WRAP_ROUND_BOTH
} slv_wrap_round;

SLV_API const char *slv_wrap_round_name(slv_wrap_round round); /* no, u, v, both */

/* As slv_mesh_face_texcoords (mesh.h), of a mesh whose coordinates go round along the axes that are
 * named: within a polygon they take the short way from its first corner on, and may leave 0..1
 * there; what is between corners is the mean of these. For slv_free. */
SLV_NODISCARD SLV_API slv_result slv_mesh_round_texcoords(const slv_env *env, const slv_mesh *mesh,
                                                          bool round_u, bool round_v, float **out);

typedef enum slv_wrap_map {
    SLV_WRAP_KEEP = 0, /* those that the mesh has */
    SLV_WRAP_CYLINDER, /* u around the axis, v along it, 0 to 1 from end to end */
    SLV_WRAP_TORUS,    /* u around the axis, v around the middle of the tube; both go round */
    SLV_WRAP_SPHERE    /* u around the axis, v from pole to pole */
} slv_wrap_map;

SLV_API const char *slv_wrap_map_name(slv_wrap_map map); /* keep, cylinder, torus, sphere */
SLV_API bool slv_wrap_map_from_name(const char *name, slv_wrap_map *out);

/* Zero means default. */
typedef struct slv_wrap_params {
    slv_wrap_map map;
    int axis;           /* 0 x, 1 y, 2 z, through the middle of the mesh's box */
    bool keep_vertices; /* vertices at one place stay apart */
    uint64_t reserved[4];
} slv_wrap_params;

/* What was made, and what cannot be made this way; numbers of polygons are the input's, and the
 * first of a kind is named, or -1. */
typedef struct slv_wrap_report {
    uint32_t nverts, nwelded; /* of the result; how many of the input's are gone */
    uint32_t nkept;           /* vertices at the place of another that stay: joined, an edge would
                                 have three sides or two that run the same way */
    int32_t first_kept;
    uint32_t ncollapsed; /* polygons that have no three vertices left, and are gone */
    int32_t first_collapsed;
    uint32_t nseam[2]; /* polygons over the end of u and of v: interpolated the short way */
    uint32_t nwide;    /* polygons that span half of the map or more along an axis that goes
                          round: the method takes them the wrong way */
    int32_t first_wide;
    uint32_t nmany;     /* vertices without a single value: poles, and ends of charts */
    int32_t first_many; /* a vertex of the result, of polygon many_poly of the input */
    int32_t many_poly;
    uint32_t nclose; /* vertices at open edges beside one of another place, too far from it to
                        be joined, and much nearer than along edges */
    int32_t first_close, close_to; /* of the input; these two are `close_apart` apart */
    float close_apart;
    uint32_t nends;    /* of nmany, vertices at which a chart meets itself as far from where it
                          begins as is no whole number: `end_apart`, along u (0) or v (1) */
    int32_t first_end; /* a vertex of the result, of polygon end_poly of the input */
    int32_t end_poly, end_axis;
    float end_apart;
    uint32_t nfar; /* polygons that have coordinates beyond 65536, which stay as they are */
    int32_t first_far;
    slv_wrap_round round; /* along what the result's coordinates go round: by the map that was made,
                             or with KEEP as far as copies at its ends tell */
    uint32_t nbare;       /* with KEEP, polygons that have no texture coordinates at some corner */
    int32_t first_bare;
    uint32_t ndrawn_before, ndrawn; /* vertices where the input and the result are drawn: one for
                                       each texture coordinate that a vertex has in polygons */
    uint64_t reserved[3];
} slv_wrap_report;

/* Joins vertices at one place (to within 5e-7 of the longest side of the mesh's box, since other
 * programs compute the ends of a turn apart; at open edges to within 1e-5 of it and a fiftieth of
 * the edges there, since they write six digits), makes coordinates with one value a vertex, and
 * drops normals, which belong to vertices that are gone. Positions are the input's own; groups,
 * creases, corners and holes stay. A pole, which has no angle, has the values of the polygons
 * around it, as a vertex that keeps several has. Coordinates go round along an axis if charts that
 * are joined where they are whole numbers apart lead back to where they began by another way; else
 * the ends of such charts keep their values. KEEP of a mesh without texture coordinates only joins.
 */
SLV_NODISCARD SLV_API slv_result slv_mesh_wrap(const slv_env *env, const slv_mesh *mesh,
                                               const slv_wrap_params *params,
                                               slv_wrap_report *report, slv_mesh **out);

#ifdef __cplusplus
}
#endif

#endif
