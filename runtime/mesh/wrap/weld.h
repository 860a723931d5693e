/* Vertices at one place joined. */
#ifndef SLV_MESH_WRAP_WELD_H
#define SLV_MESH_WRAP_WELD_H

#include "mesh/mesh_data.h"

#include <selvage/wrap.h>

/* A mesh with fewer vertices, in the order of the input's. */
typedef struct slvi_weld {
    uint32_t nverts, npolys, nsides;
    int32_t *to;    /* per vertex of the input: the result's */
    int32_t *from;  /* per vertex of the result: the input's first */
    int32_t *poly;  /* per polygon of the input: the result's; where it is gone, that of the next */
    int32_t *sizes; /* per polygon of the result */
    int32_t *verts;
    uint32_t *side; /* per side of the result: the input's */
} slvi_weld;

/* Without `join` the same mesh. */
slv_result slvi_weld_make(const slv_env *env, const slv_mesh *mesh, bool join,
                          slv_wrap_report *report, slvi_weld *out);
void slvi_weld_free(slvi_weld *weld);

#endif
