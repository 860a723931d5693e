/* The kinds of reach, a row each. */
#include "gl/store/reach.h"

#include "base/log.h"
#include "gl/store/links.h"
#include "gl/store/squares.h"

#include <string.h>

static slv_result build_own(const slv_gl_source *source, const slv_gl_pools *pools,
                            const void *made, slv_gl_reach *out) {
    (void)made;
    return slvi_gl_batches_by_pool(source->env, pools, &out->batches);
}

static const struct reach_row {
    slv_result (*build)(const slv_gl_source *source, const slv_gl_pools *pools, const void *made,
                        slv_gl_reach *out);
    uint32_t items;       /* that a face needs */
    uint32_t least_pools; /* of a batch, however few a host asks for */
} kinds[SLV_GL_REACH_COUNT] = {
    [SLV_GL_REACH_OWN] = {build_own, 1, 1},
    [SLV_GL_REACH_NEIGHBOURS] = {slvi_gl_reach_neighbours, 1, 1},
    [SLV_GL_REACH_SQUARES] = {slvi_gl_reach_squares, 4, 4},
};

slv_result slvi_gl_reach_build(const slv_gl_source *source, slv_gl_reach_kind kind,
                               const slv_gl_pools *pools, const void *made, slv_gl_reach *out) {
    uint32_t items[SLV_FORM_ITEMS];
    slv_result result = SLV_OK;
    memset(out, 0, sizeof *out);
    if (slv_levels_get_desc(source->levels)->nfaces &&
        pools->form->items(made, 0, items) != kinds[kind].items)
        return slvi_fail(source->env, SLV_ERROR_ARGUMENT,
                         "lookups in the form %s cannot reach as the strategy says",
                         pools->form->name);
    result = kinds[kind].build(source, pools, made, out);
    if (result)
        slvi_gl_reach_free(source->gl, out);
    return result;
}

void slvi_gl_reach_free(const slv_gl *gl, slv_gl_reach *reach) {
    slvi_gl_batches_free(&reach->batches);
    gl->api.DeleteBuffers(1, &reach->ways);
    gl->api.DeleteBuffers(1, &reach->values);
    memset(reach, 0, sizeof *reach);
}

uint32_t slvi_gl_reach_pools(slv_gl_reach_kind kind, const slv_gl_texture_params *params) {
    uint32_t least = kinds[kind].least_pools;
    return params->batch_pools < least ? least : params->batch_pools;
}
