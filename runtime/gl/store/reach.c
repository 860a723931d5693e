/* The kinds of reach, a row each. */
#include "gl/store/reach.h"

#include "base/log.h"
#include "base/memory.h"
#include "gl/store/links.h"
#include "gl/store/squares.h"

#include <string.h>

static slv_result build_own(const slv_gl_source *source, const slv_gl_pools *pools,
                            const void *made, slv_gl_reach *out) {
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces, log2 = 32;
    (void)made;
    while (log2 > 0 && ((uint64_t)8 << log2) > source->gl->max_storage)
        log2--;
    out->chunks = slv_gl_chunks_of(nfaces, log2);
    return slvi_gl_batches_by_pool(source->env, pools, out->chunks, &out->batches);
}

static const struct reach_row {
    slv_result (*build)(const slv_gl_source *source, const slv_gl_pools *pools, const void *made,
                        slv_gl_reach *out);
    /* after a change; NULL: there are no values of corners */
    slv_result (*refresh)(const slv_gl_source *source, const slv_gl_pools *pools, const void *made,
                          const slv_gl_marks *faces, slv_gl_reach *reach);
    uint32_t items;       /* that a face needs */
    uint32_t least_pools; /* of a batch, however few a host asks for */
} kinds[SLV_GL_REACH_COUNT] = {
    [SLV_GL_REACH_OWN] = {build_own, NULL, 1, 1},
    [SLV_GL_REACH_NEIGHBOURS] = {slvi_gl_reach_neighbours, slvi_gl_links_refresh, 1, 1},
    [SLV_GL_REACH_SQUARES] = {slvi_gl_reach_squares, slvi_gl_squares_refresh, 4,
                              SLV_GL_SQUARES_POOLS},
};

slv_result slvi_gl_reach_build(const slv_gl_source *source, slv_gl_reach_kind kind,
                               const slv_gl_pools *pools, const void *made, slv_gl_reach *out) {
    uint32_t items[SLV_FORM_ITEMS];
    slv_result result = SLV_OK;
    memset(out, 0, sizeof *out);
    out->chunks = slv_gl_chunks_of(0, 32);
    if (slv_levels_get_desc(source->levels)->nfaces &&
        pools->form->items(made, 0, items) != kinds[kind].items)
        return slvi_fail(source->env, SLV_ERROR_ARGUMENT,
                         "lookups in the form %s cannot reach as the strategy says",
                         pools->form->name);
    result = kinds[kind].build(source, pools, made, out);
    if (result)
        slvi_gl_reach_free(source->gl, out);
    else if (source->params.binding == SLV_GL_BINDING_HANDLES)
        slvi_gl_batches_unite(&out->batches);
    if (!result && !source->params.live) {
        slvi_free(out->corners.where);
        out->corners.where = NULL;
    }
    return result;
}

bool slvi_gl_reach_has_values(slv_gl_reach_kind kind) {
    return kinds[kind].refresh != NULL;
}

slv_result slvi_gl_reach_refresh(const slv_gl_source *source, slv_gl_reach_kind kind,
                                 const slv_gl_pools *pools, const void *made,
                                 const slv_gl_marks *faces, slv_gl_reach *reach) {
    return kinds[kind].refresh ? kinds[kind].refresh(source, pools, made, faces, reach) : SLV_OK;
}

void slvi_gl_reach_free(const slv_gl *gl, slv_gl_reach *reach) {
    slvi_gl_parts_free(gl, reach->chunks, reach->parts);
    slvi_gl_batches_free(&reach->batches);
    slvi_gl_corners_free(&reach->corners);
    slvi_gl_marks_end(&reach->at_hand);
    memset(reach, 0, sizeof *reach);
}

uint32_t slvi_gl_reach_pools(slv_gl_reach_kind kind, const slv_gl_texture_params *params) {
    uint32_t least = kinds[kind].least_pools;
    return params->batch_pools < least ? least : params->batch_pools;
}
