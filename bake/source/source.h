/* What every source of values is: a description and a few functions. */
#ifndef SLV_BAKE_SOURCE_H
#define SLV_BAKE_SOURCE_H

#include <selvage/bake.h>

typedef struct slvi_bake_fns {
    /* As slv_bake_evaluate, whose arguments have been checked; `values` and `misses` are zero. */
    slv_result (*evaluate)(const slv_bake_source *source, const slv_env *env, uint32_t face,
                           slv_res res, slv_rect rect, float *values, uint8_t *misses);
    /* Texels that the source itself has along u and v of a face; 0: it cannot tell. NULL: it has no
     * resolution. */
    void (*extent)(const slv_bake_source *source, uint32_t face, float size[2]);
    const slv_bake_tile *(*tiles)(const slv_bake_source *source, uint32_t *count); /* or NULL */
    void (*destroy)(slv_bake_source *source); /* all of it, the struct too */
    void (*images)(const slv_bake_source *source, slv_uv_images *out); /* or NULL */
} slvi_bake_fns;

/* Begins what a source of a kind is. */
struct slv_bake_source {
    const slvi_bake_fns *fns;
    uint32_t nfaces;
    slv_bake_source_desc desc;
    bool apart;    /* values are a face's own: those of two faces have no mean */
    uint32_t cost; /* rays a texel, or what takes as long; 0: few */
};

enum { SLVI_BAKE_MAX_CHANNELS = 4 };

#endif
