/* Which way a map goes round, told by how its charts hang together. */
#ifndef SLV_MESH_WRAP_ROUND_H
#define SLV_MESH_WRAP_ROUND_H

#include "mesh/wrap/weld.h"

#define SLVI_WRAP_SAME 1e-5f        /* coordinates that are one */
#define SLVI_WRAP_FARTHEST 65536.0f /* beyond it they say nothing */

/* Coordinates on their way: one pair a side, and then a list of values for each vertex. */
typedef struct slvi_wrap_values {
    float *at;            /* 2 per side; NaN: none */
    bool round[2];        /* the axis goes round */
    float *values;        /* 2 per value */
    int32_t *index;       /* per side its value, or -1 */
    int32_t *head, *next; /* per vertex its first value, per value the next of its vertex, or -1 */
    uint32_t count;
} slvi_wrap_values;

/* A polygon or a value, and how many whole numbers its chart is from that of `parent`. */
typedef struct slvi_wrap_node {
    int32_t parent;
    uint32_t shift[2];
} slvi_wrap_node;

/* Says in c->round which axes go round, of values that were listed as if both did: charts are
 * joined by whole numbers where they share one, and an axis goes round if that leads back to a
 * chart with another number. `nodes` has room for w->npolys and c->count. */
void slvi_wrap_find_round(const slvi_weld *w, slvi_wrap_values *c, slvi_wrap_node *nodes);

/* Vertices at which a chart meets itself, not a whole number apart, from the list that was made
 * with what goes round, and the nodes of before; `user` has room for c->count. */
void slvi_wrap_find_ends(const slvi_weld *w, const slvi_wrap_values *c, slvi_wrap_node *nodes,
                         const int32_t *poly_from, int32_t *user, slv_wrap_report *report);

/* Different pairs of a vertex and its texture coordinates, or none, at sides of polygons. */
slv_result slvi_wrap_count_drawn(const slv_env *env, const slv_mesh *mesh, uint32_t *out);

static inline bool slvi_wrap_is_far(const float *at) {
    return fabsf(at[0]) > SLVI_WRAP_FARTHEST || fabsf(at[1]) > SLVI_WRAP_FARTHEST;
}

#endif
