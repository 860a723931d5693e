/* Textures on the GPU: which stores, batches and samplers a list of strategies needs, and what a
 * draw binds of them. */
#include "gl/store/texture.h"

#include "base/log.h"
#include "base/memory.h"

#include <selvage/border.h>

#include <math.h>
#include <string.h>

static const slv_gl_reach *reach_of(const slv_gl_texture *texture, const slv_gl_slot *slot) {
    return &texture->reaches[slot->reach].reach;
}

static GLuint make_sampler(const slv_gl_texture *texture, const slv_strategy *strategy) {
    static const float zero[4] = {0, 0, 0, 0};
    static const GLint wraps[] = {[SLV_GL_WRAP_CLAMP] = GL_CLAMP_TO_EDGE,
                                  [SLV_GL_WRAP_ZERO] = GL_CLAMP_TO_BORDER,
                                  [SLV_GL_WRAP_MIRROR] = GL_MIRRORED_REPEAT};
    const slv_gl_api *api = &texture->gl->api;
    GLint wrap = wraps[strategy->wrap];
    GLuint sampler = 0;
    api->CreateSamplers(1, &sampler);
    api->SamplerParameteri(sampler, GL_TEXTURE_WRAP_S, wrap);
    api->SamplerParameteri(sampler, GL_TEXTURE_WRAP_T, wrap);
    api->SamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    api->SamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER,
                           strategy->packing == SLV_GL_PAGES ? GL_LINEAR : GL_LINEAR_MIPMAP_LINEAR);
    api->SamplerParameterfv(sampler, GL_TEXTURE_BORDER_COLOR, zero);
    if (texture->params.anisotropy > 1 && !slvi_gl_taps_in_shader(texture->gl) &&
        !strategy->own_taps)
        api->SamplerParameterf(sampler, GL_TEXTURE_MAX_ANISOTROPY,
                               (float)texture->params.anisotropy);
    return sampler;
}

static slv_result fill_params(slv_gl *gl, const slv_env *env, const slv_texture_desc *desc,
                              const slv_gl_texture_params *given, slv_gl_texture_params *out) {
    slv_gl_texture_params params = {0};
    if (given)
        params = *given;
    if (!params.nchannels && params.first_channel < desc->nchannels) {
        params.nchannels = desc->nchannels - params.first_channel;
        params.nchannels = params.nchannels < 4 ? params.nchannels : 4;
    }
    if (params.nchannels < 1 || params.nchannels > 4 || params.first_channel >= desc->nchannels ||
        params.nchannels > desc->nchannels - params.first_channel)
        return slvi_fail(
            env, SLV_ERROR_ARGUMENT, "channels %u to %u cannot be shown, the texture has %u",
            params.first_channel, params.first_channel + params.nchannels - 1, desc->nchannels);
    if ((unsigned)params.encoding > SLV_TEXTURE_DATA)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "unknown texture encoding %d",
                         (int)params.encoding);
    if (!params.anisotropy)
        params.anisotropy = 1;
    if (params.anisotropy > gl->info.max_anisotropy) {
        slvi_logf(env, SLV_LOG_WARNING, "anisotropy %u is cut to the driver's %u",
                  params.anisotropy, gl->info.max_anisotropy);
        params.anisotropy = gl->info.max_anisotropy;
    }
    if (!params.border)
        params.border = params.anisotropy;
    params.border = params.border < 256 ? params.border : 256;
    uint32_t units = gl->info.texture_units / (params.nchannels == 4 ? 2 : 1), fitting = 16;
    if (params.batch_pools && params.batch_pools < units)
        units = params.batch_pools;
    while (fitting > units)
        fitting /= 2;
    params.batch_pools = fitting;
    uint32_t layers = gl->info.max_layers < 0xffff ? gl->info.max_layers : 0xffff;
    if (!params.pool_layers || params.pool_layers > layers)
        params.pool_layers = layers;
    *out = params;
    return SLV_OK;
}

static slv_result check_strategy(const slv_env *env, const slv_strategy *strategy) {
    if (!strategy || !strategy->name || !strategy->form || !strategy->form() ||
        (!strategy->file && !strategy->glsl))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "a strategy without a name, form or GLSL");
    const slv_form *form = strategy->form();
    if ((unsigned)strategy->wrap > SLV_GL_WRAP_MIRROR ||
        (unsigned)strategy->packing > SLV_GL_PAGES ||
        (unsigned)strategy->reach >= SLV_GL_REACH_COUNT)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "strategy %s: a wrap, packing or reach unknown",
                         strategy->name);
    if ((form->borders || form->samples) && strategy->packing != SLV_GL_PAGES)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "strategy %s: the form %s needs pages",
                         strategy->name, form->name);
    return SLV_OK;
}

/* One slot for each strategy of the list, or of the table. */
static slv_result list_slots(slv_gl_texture *texture, const slv_gl_texture_params *given) {
    bool all = !given || !given->nstrategies;
    uint32_t count = all ? slv_strategy_count() : given->nstrategies;
    const slv_env *env = &texture->env;
    slv_result result =
        slvi_alloc(env, "strategies", count, sizeof *texture->slots, &texture->slots);
    if (!result)
        result = slvi_alloc(env, "strategies", count, sizeof *texture->stores, &texture->stores);
    if (!result)
        result = slvi_alloc(env, "strategies", count, sizeof *texture->reaches, &texture->reaches);
    for (uint32_t i = 0; !result && i < count; i++) {
        const slv_strategy *strategy = all ? slv_strategy_at(i) : given->strategies[i];
        if ((result = check_strategy(env, strategy)))
            break;
        if (texture->nslots && slvi_gl_texture_slot(texture, strategy))
            continue;
        slv_gl_slot *slot = &texture->slots[texture->nslots++];
        slot->strategy = strategy;
        slot->split_coverage = texture->params.nchannels == 4 && strategy->coverage;
        result = slvi_gl_slot_read(env, slot);
    }
    return result;
}

static bool same_store(const slv_strategy *a, const slv_strategy *b) {
    return a->form() == b->form() && a->packing == b->packing;
}

/* Whether arrays have coverage: if any strategy that could share them needs it, listed or not, so
 * that a strategy's pictures and memory do not depend on which others are there. */
static bool needs_coverage(const slv_gl_texture *texture, const slv_strategy *strategy) {
    bool needs = false;
    for (uint32_t i = 0; i < slv_strategy_count(); i++)
        needs |= slv_strategy_at(i)->coverage && same_store(slv_strategy_at(i), strategy);
    for (uint32_t i = 0; i < texture->nslots; i++)
        needs |= texture->slots[i].strategy->coverage &&
                 same_store(texture->slots[i].strategy, strategy);
    return needs;
}

/* The reach of a slot, shared with those before it or built. */
static slv_result find_reach(const slv_gl_source *source, slv_gl_texture *texture,
                             slv_gl_slot *slot) {
    slv_gl_reach_kind kind = slot->strategy->reach;
    for (slot->reach = 0; slot->reach < texture->nreaches; slot->reach++) {
        const slv_gl_reach_row *row = &texture->reaches[slot->reach];
        if (row->store == slot->store && row->kind == kind)
            return SLV_OK;
    }
    slv_gl_reach_row *row = &texture->reaches[texture->nreaches];
    const slv_gl_store *store = &texture->stores[slot->store];
    slv_result result = slvi_gl_reach_build(source, kind, &store->pools, store->made, &row->reach);
    if (result)
        return result;
    row->store = slot->store;
    row->kind = kind;
    texture->nreaches++;
    return SLV_OK;
}

/* The store of one strategy, and of all others that share it, with their reaches. */
static slv_result build_store(const slv_gl_source *source, slv_gl_texture *texture,
                              const slv_strategy *strategy) {
    const slv_form *form = strategy->form();
    uint32_t store = texture->nstores;
    void *made = NULL;
    slv_result result = form->create(&source->shared, source->levels, source->adjacency,
                                     slvi_gl_border(&source->params), &made);
    if (!result)
        result = slvi_gl_store_build(source, form, made, strategy->packing,
                                     needs_coverage(texture, strategy), &texture->stores[store]);
    if (!result)
        texture->nstores++;
    for (uint32_t i = 0; !result && i < texture->nslots; i++) {
        slv_gl_slot *slot = &texture->slots[i];
        if (!same_store(slot->strategy, strategy))
            continue;
        slot->store = store;
        slot->sampler = make_sampler(texture, slot->strategy);
        result = find_reach(source, texture, slot);
    }
    return result;
}

static slv_result build_all(const slv_gl_source *source, slv_gl_texture *texture) {
    slv_result result = SLV_OK;
    for (uint32_t i = 0; i < texture->nslots; i++) {
        uint32_t k = 0;
        while (!same_store(texture->slots[k].strategy, texture->slots[i].strategy))
            k++;
        source->steps->total += k == i ? texture->nfaces : 0;
    }
    for (uint32_t i = 0; !result && i < texture->nslots; i++)
        if (!texture->slots[i].sampler)
            result = build_store(source, texture, texture->slots[i].strategy);
    return result ? result : slvi_gl_check(texture->gl, source->env, "GL texture");
}

static uint64_t texel_bytes(const slv_texture_desc *desc, uint32_t nchannels) {
    uint64_t texels = 0;
    for (uint32_t f = 0; f < desc->nfaces; f++)
        texels += (uint64_t)1 << (desc->res[f].u + desc->res[f].v);
    return texels * nchannels * slv_type_size(desc->type);
}

/* What remains only where changes are followed. */
static slv_result keep_live(slv_gl_texture *texture) {
    slv_gl_live *live = texture->live;
    slv_result result;
    live->source.steps = NULL;
    live->source.env = &texture->env;
    if (texture->params.live) {
        if ((result = slvi_gl_marks_begin(&texture->env, texture->nfaces, &live->faces)))
            return result;
        return slv_form_borders()->create(&live->source.shared, live->levels,
                                          live->source.adjacency, 1, &live->around);
    }
    for (uint32_t k = 0; k < texture->nstores; k++)
        slvi_gl_store_let_go(&texture->stores[k]);
    slvi_gl_live_destroy(live);
    texture->live = NULL;
    return SLV_OK;
}

slv_result slv_gl_texture_create(slv_gl *gl, const slv_env *env, const slv_texture *texture,
                                 const slv_adjacency *adjacency,
                                 const slv_gl_texture_params *params, slv_gl_texture **out) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    slvi_steps steps;
    slv_gl_texture *made = NULL;
    slv_result result = SLV_OK;
    *out = NULL;
    if (slv_adjacency_face_count(adjacency) != desc->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "the texture has %u faces, the adjacency %u",
                         desc->nfaces, slv_adjacency_face_count(adjacency));
    if ((result = slvi_alloc(env, "GL texture", 1, sizeof *made, &made)))
        return result;
    slvi_steps_begin(&steps, params ? params->progress : (slv_progress){0}, 0);
    made->gl = gl;
    if (env)
        made->env = *env;
    made->serial = ++gl->serial;
    made->nfaces = desc->nfaces;
    if ((result = fill_params(gl, env, desc, params, &made->params)) ||
        (result = list_slots(made, params)) ||
        (result = slvi_alloc(env, "face table", desc->nfaces, sizeof *made->res, &made->res)) ||
        (result =
             slvi_gl_live_create(gl, env, texture, adjacency, &made->params, &steps, &made->live)))
        goto done;
    slvi_gl_set_state(gl);
    memcpy(made->res, desc->res, desc->nfaces * sizeof *made->res);
    made->texel_bytes = texel_bytes(desc, made->params.nchannels);
    made->scaled = made->live->scaled;
    if (!(result = build_all(&made->live->source, made)))
        result = keep_live(made);
done:
    slvi_steps_end(&steps);
    if (result) {
        slv_gl_texture_destroy(made);
        made = NULL;
    }
    *out = made;
    return result;
}

slv_result slvi_gl_texture_renew(slv_gl_texture *texture) {
    const slv_env *env = &texture->env;
    slv_gl_texture_params params = texture->params;
    slv_gl_texture *fresh = NULL, old;
    const slv_strategy **strategies = NULL;
    slv_result result =
        slvi_alloc(env, "strategies", texture->nslots, sizeof *strategies, &strategies);
    if (result)
        return result;
    for (uint32_t i = 0; i < texture->nslots; i++)
        strategies[i] = texture->slots[i].strategy;
    params.strategies = strategies;
    params.nstrategies = texture->nslots;
    params.progress = (slv_progress){0};
    result = slv_gl_texture_create(texture->gl, env, texture->live->texture,
                                   texture->live->source.adjacency, &params, &fresh);
    if (!result) {
        old = *texture;
        *texture = *fresh;
        *fresh = old;
        texture->live->source.env = &texture->env;
        fresh->live->source.env = &fresh->env;
        slv_gl_texture_destroy(fresh);
    }
    slvi_free(strategies);
    return result;
}

void slv_gl_texture_destroy(slv_gl_texture *texture) {
    if (!texture)
        return;
    const slv_gl_api *api = &texture->gl->api;
    for (uint32_t k = 0; k < texture->nstores; k++)
        slvi_gl_store_free(texture->gl, &texture->stores[k]);
    for (uint32_t k = 0; k < texture->nreaches; k++)
        slvi_gl_reach_free(texture->gl, &texture->reaches[k].reach);
    for (uint32_t s = 0; s < texture->nslots; s++) {
        slv_gl_slot *slot = &texture->slots[s];
        api->DeleteSamplers(1, &slot->sampler);
        slvi_free(slot->lookups);
        for (int v = 0; v < SLV_GL_MAX_VARIANTS; v++) {
            slvi_free(slot->glsl[v]);
            api->DeleteProgram(slot->lookup_programs[v]);
        }
    }
    slvi_gl_live_destroy(texture->live);
    slvi_free(texture->stores);
    slvi_free(texture->reaches);
    slvi_free(texture->slots);
    slvi_free(texture->res);
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
    stats.gpu_bytes = store->bytes + reach->bytes;
    stats.pools = store->pools.npools;
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

/* Units that any batch of a strategy takes. */
static uint32_t units_of(const slv_gl_texture *texture, const slv_gl_slot *slot) {
    uint32_t pools = slvi_gl_reach_pools(slot->strategy->reach, &texture->params);
    return pools * (slot->split_coverage ? 2 : 1);
}

void slv_gl_texture_bind_shared(slv_gl_texture *texture, const slv_strategy *strategy) {
    const slv_gl_slot *slot = slvi_gl_texture_slot(texture, strategy);
    const slv_gl_api *api = &texture->gl->api;
    GLuint samplers[SLV_GL_MAX_UNITS];
    if (!slot)
        return;
    const slv_gl_store *store = &texture->stores[slot->store];
    const slv_gl_reach *reach = reach_of(texture, slot);
    const GLuint tables[4] = {store->table, reach->ways, store->rects, reach->values};
    uint32_t units = units_of(texture, slot);
    for (uint32_t k = 0; k < units; k++)
        samplers[k] = slot->sampler;
    api->BindSamplers(SLV_GL_FIRST_UNIT, (GLsizei)units, samplers);
    for (uint32_t first = 0; first < 4; first++) { /* those side by side in one call */
        uint32_t end = first;
        while (end < 4 && tables[end])
            end++;
        if (end > first)
            api->BindBuffersBase(GL_SHADER_STORAGE_BUFFER, SLV_GL_FIRST_STORAGE + first,
                                 (GLsizei)(end - first), tables + first);
        first = end;
    }
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
    for (uint32_t k = 0; k < npools; k++) {
        const slv_gl_pool *pool = &pools->pools[range->pools[k < range->npools ? k : 0]];
        arrays[k] = pool->texture;
        if (slot->split_coverage)
            arrays[npools + k] = pool->coverage;
    }
    units *= slot->split_coverage ? 2 : 1;
    texture->gl->api.BindTextures(SLV_GL_FIRST_UNIT, (GLsizei)units, arrays);
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
        uint32_t bound = units_of(texture, &texture->slots[k]);
        units = units > bound ? units : bound;
    }
    texture->gl->api.BindSamplers(SLV_GL_FIRST_UNIT, (GLsizei)units, NULL);
}
