/* Half-edges and their squares, for the files of htex. */
#ifndef SLV_TEXTURE_HTEX_H
#define SLV_TEXTURE_HTEX_H

#include "texture/texture_data.h"

#include <selvage/htex.h>

#define SLV_HTEX_NONE UINT32_MAX

/* Half-edge 4 f + e is edge e of a whole quad f. Of sub-face f only 4 f is one: the polygon's
 * half-edge that starts at its corner 0. Vertices and centres are nodes: that of half-edge h, where
 * it starts, is h, joined with others into one root; the centre of face f's polygon is 4 nfaces +
 * the polygon's first face. */
typedef struct slv_htex_mesh {
    uint32_t nfaces, nedges;
    uint32_t *after;     /* per face: the next sub-face around its polygon, or SLV_HTEX_NONE */
    uint32_t *before;    /* likewise */
    uint32_t *polygon;   /* per face: the polygon's first face */
    uint32_t *twin;      /* per half-edge: the one across, or SLV_HTEX_NONE */
    uint32_t *edge;      /* per half-edge: its edge; SLV_HTEX_NONE if there is no such half-edge */
    uint32_t (*half)[2]; /* per edge: its half-edges, the second SLV_HTEX_NONE at a boundary */
    uint32_t *root;      /* per half-edge: the node of its start */
} slv_htex_mesh;

slv_result slvi_htex_mesh_create(const slv_env *env, const slv_adjacency *adjacency,
                                 slv_htex_mesh *out);
void slvi_htex_mesh_free(slv_htex_mesh *mesh);

static inline bool slv_htex_is_part(const slv_htex_mesh *mesh, uint32_t face) {
    return mesh->after[face] != SLV_HTEX_NONE;
}
/* The half-edge that follows around the polygon. */
static inline uint32_t slv_htex_next(const slv_htex_mesh *mesh, uint32_t half) {
    uint32_t face = half / 4;
    return slv_htex_is_part(mesh, face) ? 4 * mesh->after[face] : 4 * face + slvi_edge_next(half);
}
static inline uint32_t slv_htex_centre(const slv_htex_mesh *mesh, uint32_t half) {
    return 4 * mesh->nfaces + mesh->polygon[half / 4];
}

/* (u,v) of a face as a function of (s,t) of one of its half-edges, or of its inverse. */
typedef struct slv_htex_map {
    float us, ut, u0, vs, vt, v0;
} slv_htex_map;

/* For a whole quad `index` is the edge; for a sub-face 0 is the half-edge that starts at its corner
 * 0 (u >= v), and 1 the one before it. */
static inline slv_htex_map slv_htex_to_face(bool part, uint32_t index) {
    static const slv_htex_map whole[4] = {{-0.5f, 0.5f, 0.5f, -0.5f, -0.5f, 0.5f},
                                          {0.5f, 0.5f, 0.5f, -0.5f, 0.5f, 0.5f},
                                          {0.5f, -0.5f, 0.5f, 0.5f, 0.5f, 0.5f},
                                          {-0.5f, -0.5f, 0.5f, 0.5f, -0.5f, 0.5f}};
    static const slv_htex_map parts[2] = {{-1, 1, 1, -1, -1, 1}, {-1, -1, 1, 1, -1, 1}};
    return part ? parts[index] : whole[index];
}

/* Where squares meet: the values of one corner begin at `first`, those for log2 = 0 to the least of
 * the squares around it. */
typedef struct slv_htex_corner {
    uint32_t first;
    uint8_t log2;
    uint8_t room; /* the largest log2 that there are values for */
} slv_htex_corner;

struct slv_htex {
    slv_texture_desc desc;
    slv_res *res;
    size_t texel_size;
    bool vectors; /* of each square along its edge, of each corner in the frame of the face that its
                     node is numbered after */
    uint32_t nedges;
    uint8_t *log2; /* per edge */
    slv_htex_face *faces;
    unsigned char **at;    /* per edge: its levels */
    unsigned char *texels; /* of all edges; those of another size since have their own */
    uint64_t ntexels;      /* bytes of these */
    uint64_t bytes;
    uint32_t ncorners, nvalues, values_capacity;
    slv_htex_corner *corners;
    float *values;
};

static inline uint64_t slv_htex_level_texels(uint32_t log2, uint32_t level) {
    return UINT64_C(1) << 2 * (log2 - level);
}

/* A face's level 0 with its border, which the squares are taken from: floats, one texel of border.
 */
typedef struct slv_htex_source {
    slv_res res;
    size_t nchannels;
    const float *texels;
} slv_htex_source;

/* Bilinear; (u,v) lies in the face. */
void slvi_htex_source_at(const slv_htex_source *source, float u, float v, float *out);

/* The nodes at a square's corners: at (0,0), (1,0), (0,1), (1,1); returns how many. */
enum { SLV_HTEX_CORNERS = 4, SLV_HTEX_MOST_LOG2 = SLV_MAX_LOG2_RES + 2 };
uint32_t slvi_htex_nodes_of(const slv_htex_mesh *mesh, uint32_t edge,
                            uint32_t nodes[SLV_HTEX_CORNERS]);

/* The nodes that are corners of squares, numbered, and the squares around each: edge times
 * SLV_HTEX_CORNERS and which of its corners, in the order of edges. */
typedef struct slv_htex_around {
    uint32_t ncorners;
    uint32_t *number; /* per node, or SLV_HTEX_NONE */
    uint32_t *node;   /* per corner */
    uint32_t *first;  /* per corner, and where the last ends */
    uint32_t *squares;
    uint8_t *turns; /* per square: how its axes are turned as the corner sees them; NULL: no vectors
                       are at hand */
} slv_htex_around;
/* `adjacency` is NULL where there are no vectors. Freed also if it fails. */
slv_result slvi_htex_around_create(const slv_env *env, const slv_htex_mesh *mesh,
                                   const slv_adjacency *adjacency, slv_htex_around *out);
void slvi_htex_around_free(slv_htex_around *around);

/* The values of one corner. `tops` has, per node, the value at the least resolution around it;
 * `sums` room for SLV_HTEX_MOST_LOG2 and `value` for one texel. */
void slvi_htex_corner_values(slv_htex *htex, const slv_htex_around *around, const float *tops,
                             uint32_t corner, double *sums, float *value);

/* What squares are filled from. */
typedef struct slv_htex_fill {
    const slv_levels *levels;
    const slv_adjacency *adjacency;
    const slv_htex_mesh *mesh;
    slv_htex *htex;
    slv_env env;
    const uint8_t *wanted; /* per edge; NULL: all */
    uint64_t *ends;        /* per edge: where its samples on the edge begin, in texels */
    float *diagonals; /* per edge and side: samples on the edge, from end to start of the first */
    float *tops;      /* per node */
} slv_htex_fill;

/* A face's share of its squares and tops. `bordered` has room for level 0 with a border of one
 * texel, `row` for a row of the largest square and a texel. */
slv_result slvi_htex_fill_face(const slv_htex_fill *fill, uint32_t face, float *bordered,
                               float *row);
/* What needs both faces: the texels on the edge, the missing half at a boundary, and the levels.
 * `rows` has room for two rows. */
void slvi_htex_fill_edge(const slv_htex_fill *fill, uint32_t edge, float *rows);

/* What making squares anew takes beyond the texture itself, found when it is first needed. */
typedef struct slv_htex_again slv_htex_again;
slv_result slvi_htex_again_create(const slv_env *env, const slv_adjacency *adjacency,
                                  const slv_htex *htex, slv_htex_again **out);
void slvi_htex_again_destroy(slv_htex_again *again);
/* Makes some squares anew, and the values at their corners. */
slv_result slvi_htex_refresh(slv_htex_again *again, const slv_levels *levels,
                             const slv_adjacency *adjacency, const uint32_t *edges, uint32_t count,
                             slv_htex *htex);

/* log2 of the side of an edge's square, by the resolutions of its faces. */
uint32_t slvi_htex_log2_for(const slv_htex_mesh *mesh, const slv_res *res, uint32_t edge);
/* Bytes of all levels of a square of 2^log2. */
uint64_t slvi_htex_square_bytes(const slv_htex *htex, uint32_t log2);
/* Gives back the memory of a square that has its own. */
void slvi_htex_free_own(const slv_htex *htex, uint32_t edge);

/* Finds what the squares at a node agree on, and the corners of each face. */
slv_result slvi_htex_find_corners(const slv_env *env, slv_htex *htex, const slv_htex_mesh *mesh,
                                  const slv_adjacency *adjacency, const float *tops);

/* How a square's axes, of which the first runs along its edge as half-edge `half` does, are turned
 * as the face beside the start of the half-edge sees them, or with `end` that beside its end. */
static inline unsigned slvi_htex_square_turns(const slv_htex_mesh *mesh, uint32_t half, bool end) {
    unsigned along = slv_htex_is_part(mesh, half / 4) ? (end ? 3 : 0) : half & 3;
    return along + (mesh->half[mesh->edge[half]][0] == half ? 0 : 2);
}

#endif
