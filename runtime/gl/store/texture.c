/* Textures on the GPU: what there is of them, and what a draw binds. */
#include "gl/live/making.h"

#include "base/log.h"
#include "base/memory.h"

#include <selvage/border.h>

#include <math.h>
#include <string.h>

static const slv_gl_reach *reach_of(const slv_gl_texture *texture, const slv_gl_slot *slot) {
    return &texture->reaches[slot->reach].reach;
}

void slv_gl_texture_destroy(slv_gl_texture *texture) {
    if (!texture)
        return;
    slv_gl keeping;
    texture->gl = slvi_gl_for_deleting(texture->gl, &keeping);
    const slv_gl_api *api = &texture->gl->api;
    GLint storage = 0; /* a driver may unbind it with a table of ours that is still bound */
    api->GetIntegerv(GL_SHADER_STORAGE_BUFFER_BINDING, &storage);
    slvi_gl_texture_leave_handles(texture);
    for (uint32_t k = 0; k < texture->nstores; k++)
        slvi_gl_store_free(texture->gl, &texture->stores[k]);
    for (uint32_t k = 0; k < texture->nreaches; k++)
        slvi_gl_reach_free(texture->gl, &texture->reaches[k].reach);
    for (uint32_t s = 0; s < texture->nslots; s++) {
        slv_gl_slot *slot = &texture->slots[s];
        slvi_gl_delete(api->DeleteSamplers, &slot->sampler);
        slvi_free(slot->lookups);
        for (int v = 0; v < SLV_GL_MAX_VARIANTS; v++) {
            slvi_free(slot->glsl[v]);
            slvi_free(slot->named[v]);
            if (slot->lookup_programs[v])
                api->DeleteProgram(slot->lookup_programs[v]);
        }
    }
    slvi_gl_making_free(texture);
    api->BindBuffer(GL_SHADER_STORAGE_BUFFER, (GLuint)storage);
    slvi_gl_live_destroy(texture->live);
    slvi_free(texture->stores);
    slvi_free(texture->reaches);
    slvi_free(texture->slots);
    slvi_free(texture->res);
    slvi_free(texture->prefix);
    slvi_free(texture);
}

slv_gl_texture_stats slv_gl_texture_get_stats(const slv_gl_texture *texture,
                                              const slv_strategy *strategy) {
    slv_gl_texture_stats stats = {.texel_bytes = texture->texel_bytes};
    const slv_gl_slot *slot = slvi_gl_texture_slot(texture, strategy);
    if (!slot)
        return stats;
    const slv_gl_store *store = &texture->stores[slot->store];
    const slv_gl_reach *reach = reach_of(texture, slot);
    stats.gpu_bytes = store->bytes + reach->bytes + slot->handles.bytes;
    stats.pools = slvi_gl_array_count(&store->pools);
    stats.batches = reach->batches.count;
    stats.widened = store->nwide;
    stats.clipped = store->nclipped;
    stats.block_max = store->error.most;
    if (store->error.count)
        stats.block_rms = sqrt(store->error.squares / (double)store->error.count);
    if (slot->split_coverage)
        stats.gpu_bytes += store->coverage_bytes;
    return stats;
}

bool slv_gl_texture_is_widened(const slv_gl_texture *texture, const slv_strategy *strategy,
                               uint32_t face) {
    const slv_gl_slot *slot = slvi_gl_texture_slot(texture, strategy);
    const slv_gl_store *store = slot ? &texture->stores[slot->store] : NULL;
    uint32_t items[SLV_FORM_ITEMS];
    bool wide = false;
    if (!store || !store->wide || face >= texture->nfaces)
        return false;
    for (uint32_t i = store->pools.form->items(store->made, face, items); i--;)
        wide |= store->wide[items[i]];
    return wide;
}

uint32_t slv_gl_texture_face_count(const slv_gl_texture *texture) {
    return texture->nfaces;
}

uint32_t slv_gl_texture_strategy_count(const slv_gl_texture *texture) {
    return texture->nslots;
}

const slv_strategy *slv_gl_texture_strategy(const slv_gl_texture *texture, uint32_t index) {
    return index < texture->nslots ? texture->slots[index].strategy : NULL;
}

uint32_t slv_gl_texture_batch_count(const slv_gl_texture *texture, const slv_strategy *strategy) {
    return slvi_gl_texture_batches(texture, strategy)->count;
}

slv_gl_batch slv_gl_texture_batch(const slv_gl_texture *texture, const slv_strategy *strategy,
                                  uint32_t index) {
    const slv_gl_batches *batches = slvi_gl_texture_batches(texture, strategy);
    slv_gl_batch batch = {0};
    if (index < batches->count) {
        batch.faces = batches->faces + batches->ranges[index].first;
        batch.nfaces = batches->ranges[index].count;
        batch.variant = batches->ranges[index].variant;
    }
    return batch;
}

slv_gl_run slv_gl_texture_run(const slv_gl_texture *texture, const slv_strategy *strategy,
                              uint32_t first) {
    const slv_gl_slot *slot = slvi_gl_texture_slot(texture, strategy);
    const slv_gl_batches *batches = slvi_gl_texture_batches(texture, strategy);
    slv_gl_run run = {0};
    if (first >= batches->count)
        return run;
    const slv_gl_batch_range *ranges = batches->ranges + first;
    run = (slv_gl_run){1, ranges[0].variant};
    while (slot->handles_at && run.nbatches < batches->count - first &&
           ranges[run.nbatches].chunk == ranges[0].chunk)
        run.nbatches++;
    return run;
}

uint32_t slvi_gl_slot_units(const slv_gl_texture *texture, const slv_gl_slot *slot) {
    if (slot->handles_at)
        return 0;
    uint32_t pools = slvi_gl_reach_pools(slot->strategy->reach, &texture->params);
    return pools * (slot->split_coverage ? 2 : 1);
}

/* Shows draws the rows of one chunk, and handles from a batch on, in one call for tables side by
 * side. */
static void bind_tables(const slv_gl_texture *texture, const slv_gl_slot *slot, uint32_t chunk,
                        uint32_t batch) {
    const slv_gl_store *store = &texture->stores[slot->store];
    const slv_gl_reach *reach = reach_of(texture, slot);
    const slv_gl_part none = {0}, *part = reach->parts ? &reach->parts[chunk] : &none;
    GLuint tables[4] = {store->table, part->ways, store->rects, part->values};
    uint64_t face = chunk ? (uint64_t)chunk << reach->chunks.log2 : 0, end = texture->nfaces;
    if (reach->chunks.count > 1 && chunk + 1 < reach->chunks.count)
        end = (uint64_t)(chunk + 1) << reach->chunks.log2;
    GLintptr at[4] = {(GLintptr)(8 * face)};
    GLsizeiptr size[4] = {(GLsizeiptr)(8 * (end - face)), (GLsizeiptr)part->way_bytes,
                          (GLsizeiptr)store->rect_bytes, (GLsizeiptr)part->value_bytes};
    if (slot->handles_at) {
        tables[slot->handles_at] = slot->handles.table;
        at[slot->handles_at] = (GLintptr)(batch * sizeof(slv_gl_handle_row));
        size[slot->handles_at] = (GLsizeiptr)slot->handles.bytes - at[slot->handles_at];
    }
    for (uint32_t first = 0; first < 4; first++) {
        uint32_t last = first;
        while (last < 4 && tables[last] && size[last])
            last++;
        if (last > first)
            texture->gl->api.BindBuffersRange(
                GL_SHADER_STORAGE_BUFFER, texture->params.first_storage + first,
                (GLsizei)(last - first), tables + first, at + first, size + first);
        first = last;
    }
}

void slv_gl_texture_bind_shared(slv_gl_texture *texture, const slv_strategy *strategy) {
    const slv_gl_slot *slot = slvi_gl_texture_slot(texture, strategy);
    GLuint samplers[SLV_GL_MAX_UNITS];
    if (!slot)
        return;
    uint32_t units = slvi_gl_slot_units(texture, slot);
    for (uint32_t k = 0; k < units; k++)
        samplers[k] = slot->sampler;
    if (units)
        texture->gl->api.BindSamplers(texture->params.first_unit, (GLsizei)units, samplers);
    slvi_gl_handles_need(texture->gl, &slot->handles);
    bind_tables(texture, slot, 0, 0);
}

void slv_gl_texture_bind_batch(slv_gl_texture *texture, const slv_strategy *strategy,
                               uint32_t index) {
    const slv_gl_slot *slot = slvi_gl_texture_slot(texture, strategy);
    GLuint arrays[SLV_GL_MAX_UNITS];
    if (!slot || index >= reach_of(texture, slot)->batches.count)
        return;
    const slv_gl_pools *pools = &texture->stores[slot->store].pools;
    const slv_gl_batch_range *range = &reach_of(texture, slot)->batches.ranges[index];
    uint32_t npools = slv_gl_variant_pools(range->variant), units = npools;
    if (slot->handles_at) {
        bind_tables(texture, slot, range->chunk, index);
        return;
    }
    for (uint32_t k = 0; k < npools; k++) {
        const slv_gl_pool *pool = &pools->pools[range->pools[k < range->npools ? k : 0]];
        arrays[k] = pool->texture;
        if (slot->split_coverage)
            arrays[npools + k] = pool->coverage;
    }
    units *= slot->split_coverage ? 2 : 1;
    texture->gl->api.BindTextures(texture->params.first_unit, (GLsizei)units, arrays);
    if (reach_of(texture, slot)->chunks.count > 1)
        bind_tables(texture, slot, range->chunk, index);
}

void slv_gl_texture_bind(slv_gl_texture *texture, const slv_strategy *strategy, uint32_t index) {
    if (index >= slv_gl_texture_batch_count(texture, strategy))
        return;
    slv_gl_texture_bind_shared(texture, strategy);
    slv_gl_texture_bind_batch(texture, strategy, index);
}

void slv_gl_texture_unbind(slv_gl_texture *texture) {
    uint32_t units = 0;
    for (uint32_t k = 0; k < texture->nslots; k++) {
        uint32_t bound = slvi_gl_slot_units(texture, &texture->slots[k]);
        units = units > bound ? units : bound;
    }
    if (units)
        texture->gl->api.BindSamplers(texture->params.first_unit, (GLsizei)units, NULL);
}
