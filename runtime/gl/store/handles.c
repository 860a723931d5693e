/* Handles of array textures: which there are, where they are resident, and the table of batches. */
#include "gl/store/handles.h"

#include "base/memory.h"
#include "gl/store/tables.h"
#include "gl/store/texture.h"

#include <string.h>

static void make_resident(const slv_gl *gl, const slv_gl_handles *handles) {
    const slv_gl_api *api = &gl->api;
    for (uint32_t i = 0; i < handles->count; i++) /* pools on one page have one */
        if (handles->listed[i] && !api->IsTextureHandleResidentARB(handles->listed[i]))
            api->MakeTextureHandleResidentARB(handles->listed[i]);
}

static void list_handles(const slv_gl *gl, const slv_gl_pools *pools, GLuint sampler,
                         GLuint64 *listed) {
    const slv_gl_api *api = &gl->api;
    for (uint32_t p = 0; p < pools->npools; p++) {
        const slv_gl_pool *pool = &pools->pools[p];
        if (!pool->nlayers)
            continue;
        listed[2 * p] = api->GetTextureSamplerHandleARB(pool->texture, sampler);
        if (pool->coverage)
            listed[2 * p + 1] = api->GetTextureSamplerHandleARB(pool->coverage, sampler);
    }
}

static void let_go(const slv_gl *gl, slv_gl_handles *handles) {
    const slv_gl_api *api = &gl->api;
    for (uint32_t i = 0; i < handles->count; i++)
        if (handles->listed[i] && api->IsTextureHandleResidentARB(handles->listed[i]))
            api->MakeTextureHandleNonResidentARB(handles->listed[i]);
    slvi_gl_delete(api->DeleteBuffers, &handles->table);
    slvi_free(handles->listed);
    memset(handles, 0, sizeof *handles);
}

static slv_result make(slv_gl_texture *texture, slv_gl_slot *slot) {
    const slv_env *env = &texture->env;
    const slv_gl_pools *pools = &texture->stores[slot->store].pools;
    const slv_gl_batches *batches = &texture->reaches[slot->reach].reach.batches;
    slv_gl_handles *out = &slot->handles;
    slv_gl_handle_row *rows = NULL;
    slv_result result =
        slvi_alloc(env, "handles", 2 * (uint64_t)pools->npools, sizeof *out->listed, &out->listed);
    if (result || (result = slvi_alloc(env, "handles", batches->count, sizeof *rows, &rows)))
        goto done;
    out->count = 2 * pools->npools;
    list_handles(texture->gl, pools, slot->sampler, out->listed);
    for (uint32_t b = 0; b < batches->count; b++) {
        const slv_gl_batch_range *range = &batches->ranges[b];
        for (uint32_t k = 0; k < SLV_GL_ROW_POOLS; k++) {
            uint32_t pool = range->pools[k < range->npools ? k : 0];
            rows[b].pools[k] = out->listed[2 * pool];
            rows[b].coverage[k] = out->listed[2 * pool + 1];
        }
    }
    make_resident(texture->gl, out);
    out->bytes = (uint64_t)batches->count * sizeof *rows;
    result = slvi_gl_buffer(texture->gl, env, "handles", rows, out->bytes, &out->table);
done:
    slvi_free(rows);
    if (result)
        let_go(texture->gl, out);
    return result;
}

void slvi_gl_handles_need(const slv_gl *gl, const slv_gl_handles *handles) {
    uint32_t first = 0; /* all are, or none */
    while (first < handles->count && !handles->listed[first])
        first++;
    if (first < handles->count && !gl->api.IsTextureHandleResidentARB(handles->listed[first]))
        make_resident(gl, handles);
}

slv_result slvi_gl_texture_take_handles(slv_gl_texture *texture) {
    slv_result result = SLV_OK;
    for (uint32_t s = 0; !result && s < texture->nslots; s++) {
        slv_gl_slot *slot = &texture->slots[s];
        if (slot->handles_at && !slot->handles.table)
            result = make(texture, slot);
    }
    return result;
}

void slvi_gl_texture_leave_handles(slv_gl_texture *texture) {
    for (uint32_t s = 0; s < texture->nslots; s++)
        let_go(texture->gl, &texture->slots[s].handles);
}
