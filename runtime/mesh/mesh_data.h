/* Inside an slv_mesh, and its edges. */
#ifndef SLV_MESH_MESH_DATA_H
#define SLV_MESH_MESH_DATA_H

#include <selvage/mesh.h>

struct slv_mesh {
    slv_mesh_view view; /* points into the arrays below */
    void *owned[16];
    uint32_t nowned;
    uint32_t nfaces, nsubfaces;
    uint32_t *poly_first; /* npolys + 1: where each polygon's vertices start */
    int32_t *poly_face;   /* npolys: its first face */
    uint8_t *poly_hole;
    slv_mesh_face *faces;
    uint8_t *flags;
};

/* The parsers; with `points` a file need not have polygons. */
slv_result slvi_obj_parse(const slv_env *env, const char *name, const char *text, size_t size,
                          bool points, slv_mesh **out);
slv_result slvi_ply_parse(const slv_env *env, const char *name, const char *bytes, size_t size,
                          bool points, slv_mesh **out);

/* mesh_origin.c: whether the polygons lie so far from zero that their positions are to be relative
 * to `origin`, which is zero else. `verts` is NULL for all vertices in turn. */
bool slvi_mesh_find_origin(const float *positions, const int32_t *verts, uint64_t nsides,
                           double origin[3]);
/* Makes positions relative; `rests`, which may be NULL, is what their floats lack. */
void slvi_mesh_shift(float *positions, const float *rests, uint64_t nverts, const double origin[3]);
/* Whether the origin is not zero. */
bool slvi_mesh_is_far(const slv_mesh_view *view);

#define SLV_NO_EDGE UINT32_MAX

/* An edge of the mesh; sides are positions in poly_verts, each standing for the edge that starts
 * there. */
typedef struct slv_mesh_edge {
    int32_t v0, v1; /* v0 < v1 */
    uint32_t count; /* of sides */
    uint32_t side[2];
    bool hole; /* one side is a hole */
} slv_mesh_edge;

typedef struct slv_mesh_edges {
    uint32_t count;
    slv_mesh_edge *edges; /* in the order in which the polygons name them */
    uint32_t *side_edge;  /* per side: its edge, SLV_NO_EDGE where both ends are one vertex */
    uint32_t *side_poly;  /* per side: its polygon */
    uint32_t *table;      /* open addressing over the vertex pair */
    uint32_t table_mask;
} slv_mesh_edges;

slv_result slvi_mesh_edges_create(const slv_env *env, const slv_mesh *mesh, slv_mesh_edges *out);
void slvi_mesh_edges_clear(slv_mesh_edges *edges);
/* The edge between two vertices in either order, or SLV_NO_EDGE. */
uint32_t slvi_mesh_edges_find(const slv_mesh_edges *edges, int32_t a, int32_t b);
/* True if the two sides of an edge used twice run the same way along it. */
bool slvi_mesh_edge_is_flipped(const slv_mesh *mesh, const slv_mesh_edge *edge);

/* A mesh pulled apart until it is an oriented manifold: each fan of polygons that hang together
 * around a vertex over edges shared by two polygons running opposite ways gets a vertex of its own.
 */
typedef struct slv_mesh_fans {
    uint32_t nverts;
    int32_t *side_vert; /* per side: the vertex at its start */
    int32_t *origin; /* per vertex: the mesh's; the first nverts of the mesh stand for themselves */
    uint8_t *sharp; /* per vertex: 1 if the fans of one place end on different edges, so that only a
                       corner keeps them together */
} slv_mesh_fans;

/* `left_out` marks polygons that belong to no fan. */
slv_result slvi_mesh_fans_create(const slv_env *env, const slv_mesh *mesh,
                                 const slv_mesh_edges *edges, const uint8_t *left_out,
                                 slv_mesh_fans *out);
void slvi_mesh_fans_clear(slv_mesh_fans *fans);

#endif
