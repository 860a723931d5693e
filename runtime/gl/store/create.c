/* Making textures on the GPU: which stores and reaches a list of strategies needs. */
#include "gl/live/making.h"

#include "base/log.h"
#include "base/memory.h"

#include <selvage/gl_live.h>

#include <string.h>

/* Whether all faces are squares of one size, of which even levels are the plain ones, and meet
 * like to like. One that is live may change. */
static bool is_regular(const slv_gl_given *given, bool live) {
    const slv_texture_desc *desc = slv_texture_get_desc(given->texture);
    bool same = !live && !given->resident;
    for (uint32_t f = 0; same && f < desc->nfaces; f++)
        same = desc->res[f].u == desc->res[0].u && desc->res[f].v == desc->res[0].u &&
               slv_adjacency_is_subface(given->adjacency, (int32_t)f) ==
                   slv_adjacency_is_subface(given->adjacency, 0);
    return same;
}

/* That each choice is one that there is, and that the driver has. */
static slv_result check_choices(const slv_gl *gl, const slv_env *env,
                                const slv_gl_texture_params *params) {
    if ((unsigned)params->encoding > SLV_TEXTURE_DATA)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "unknown texture encoding %d",
                         (int)params->encoding);
    if ((unsigned)params->branching > SLV_GL_BRANCHING_VECTORS ||
        (unsigned)params->compression > SLV_GL_COMPRESSION_BLOCKS ||
        (unsigned)params->taps > SLV_GL_TAPS_SHADER ||
        (unsigned)params->layout > SLV_GL_LAYOUT_PAGES ||
        (unsigned)params->binding > SLV_GL_BINDING_HANDLES)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "unknown branching %d, compression %d, taps %d, layout %d or binding %d",
                         (int)params->branching, (int)params->compression, (int)params->taps,
                         (int)params->layout, (int)params->binding);
    if (params->binding == SLV_GL_BINDING_HANDLES && !gl->handles)
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED,
                         "the driver has no handles of textures (GL_ARB_bindless_texture)");
    if ((unsigned)params->border_u > SLV_BORDER_PERIODIC ||
        (unsigned)params->border_v > SLV_BORDER_PERIODIC)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "unknown border mode %d or %d",
                         (int)params->border_u, (int)params->border_v);
    if ((unsigned)params->edge_filter > SLV_EDGE_FILTER_TANVEC)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "unknown edge filter %d",
                         (int)params->edge_filter);
    return SLV_OK;
}

static slv_result fill_params(slv_gl *gl, const slv_env *env, const slv_gl_given *from,
                              const slv_gl_texture_params *given, slv_gl_texture_params *out) {
    const slv_texture_desc *desc = slv_texture_get_desc(from->texture);
    slv_gl_texture_params params = {0};
    slv_result result;
    if (given)
        params = *given;
    if (!params.nchannels && !params.first_channel)
        params.grey_alpha = desc->nchannels == 2 && desc->alpha_channel == 1;
    if (!params.nchannels && params.first_channel < desc->nchannels) {
        params.nchannels = desc->nchannels - params.first_channel;
        params.nchannels = params.nchannels < 4 ? params.nchannels : 4;
    }
    if (params.nchannels < 1 || params.nchannels > 4 || params.first_channel >= desc->nchannels ||
        params.nchannels > desc->nchannels - params.first_channel)
        return slvi_fail(
            env, SLV_ERROR_ARGUMENT, "channels %u to %u cannot be shown, the texture has %u",
            params.first_channel, params.first_channel + params.nchannels - 1, desc->nchannels);
    if (params.grey_alpha && params.nchannels != 2)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "grey and alpha are two channels and not %u",
                         params.nchannels);
    if ((result = check_choices(gl, env, &params)))
        return result;
    if (params.binding == SLV_GL_BINDING_AUTO)
        params.binding =
            gl->handles && !gl->info.software ? SLV_GL_BINDING_HANDLES : SLV_GL_BINDING_UNITS;
    if (params.layout == SLV_GL_LAYOUT_AUTO)
        params.layout = SLV_GL_LAYOUT_PAGES;
    if (desc->nchannels < 2)
        params.edge_filter = SLV_EDGE_FILTER_NONE;
    if (params.edge_filter && params.compression == SLV_GL_COMPRESSION_BLOCKS)
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED,
                         "a texture of vectors cannot be compressed: blocks have no signs");
    if (!params.anisotropy)
        params.anisotropy = 1;
    if (params.anisotropy > gl->info.max_anisotropy) {
        slvi_logf(env, SLV_LOG_WARNING, "anisotropy %u is cut to the driver's %u",
                  params.anisotropy, gl->info.max_anisotropy);
        params.anisotropy = gl->info.max_anisotropy;
    }
    params.even_levels = params.even_levels && !is_regular(from, params.live);
    if (!params.border) /* no row of taps in even levels leaves a face */
        params.border = params.even_levels ? 1 : params.anisotropy;
    params.border = params.border < 256 ? params.border : 256;
    if (!params.first_unit)
        params.first_unit = SLV_GL_FIRST_UNIT;
    if (!params.first_storage)
        params.first_storage = SLV_GL_FIRST_STORAGE;
    if (params.first_unit >= gl->info.texture_units)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "there is no texture unit %u, only %u of them",
                         params.first_unit, gl->info.texture_units);
    if (params.first_storage > gl->storage_bindings ||
        gl->storage_bindings - params.first_storage < 4)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "there are no four storage bindings from %u on, only %u in all",
                         params.first_storage, gl->storage_bindings);
    uint32_t units = gl->info.texture_units - params.first_unit, fitting = 16;
    units /= slvi_gl_own_alpha(&params) ? 2 : 1;
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

/* The host's prefix, which is copied. */
static slv_result take_prefix(slv_gl_texture *texture, const char *prefix) {
    size_t length = prefix ? strlen(prefix) : 0;
    bool valid = length < 33 && length > 0 && !(prefix[0] >= '0' && prefix[0] <= '9') &&
                 prefix[0] != '_' && strncmp(prefix, "gl_", 3) != 0 && !strstr(prefix, "__");
    for (size_t i = 0; valid && i < length; i++)
        valid = (prefix[i] >= 'a' && prefix[i] <= 'z') || (prefix[i] >= 'A' && prefix[i] <= 'Z') ||
                (prefix[i] >= '0' && prefix[i] <= '9') || prefix[i] == '_';
    if (!prefix || strcmp(prefix, "slv_") == 0)
        return SLV_OK;
    if (!valid)
        return slvi_fail(&texture->env, SLV_ERROR_ARGUMENT, "\"%.40s\" is no prefix of names",
                         prefix);
    slv_result result = slvi_alloc(&texture->env, "prefix", length + 1, 1, &texture->prefix);
    if (!result)
        memcpy(texture->prefix, prefix, length);
    texture->params.prefix = texture->prefix;
    return result;
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

/* Which of the storage bindings a strategy leaves free, or 0: that of what a lookup needs to go
 * further, or that of levels. */
static uint32_t free_binding(const slv_strategy *strategy) {
    if (strategy->reach == SLV_GL_REACH_OWN)
        return 1;
    return strategy->packing == SLV_GL_LAYERS ? 2 : 0;
}

/* One slot for each strategy of the list. */
static slv_result list_slots(slv_gl_texture *texture, const slv_gl_texture_params *given) {
    const slv_strategy *one[1];
    uint32_t count;
    const slv_strategy *const *list = slvi_gl_strategies(given, one, &count);
    const slv_env *env = &texture->env;
    slv_result result =
        slvi_alloc(env, "strategies", count, sizeof *texture->slots, &texture->slots);
    if (!result)
        result = slvi_alloc(env, "strategies", count, sizeof *texture->stores, &texture->stores);
    if (!result)
        result = slvi_alloc(env, "strategies", count, sizeof *texture->reaches, &texture->reaches);
    for (uint32_t i = 0; !result && i < count; i++) {
        const slv_strategy *strategy = list[i];
        if ((result = check_strategy(env, strategy)))
            break;
        if (texture->nslots && slvi_gl_texture_slot(texture, strategy))
            continue;
        slv_gl_slot *slot = &texture->slots[texture->nslots++];
        slot->strategy = strategy;
        slot->split_coverage = slvi_gl_own_alpha(&texture->params) && strategy->coverage;
        if (texture->params.binding == SLV_GL_BINDING_HANDLES)
            slot->handles_at = free_binding(strategy);
        result = slvi_gl_slot_read(texture, slot);
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

/* Whether items share pages: those that nobody looks up but for their own face, in levels that
 * lookups never leave. */
static bool shares_pages(const slv_gl_texture *texture, const slv_strategy *strategy) {
    bool shares = texture->params.layout == SLV_GL_LAYOUT_PAGES &&
                  strategy->packing == SLV_GL_PAGES && !needs_coverage(texture, strategy);
    for (uint32_t i = 0; i < texture->nslots; i++)
        shares &= !same_store(texture->slots[i].strategy, strategy) ||
                  texture->slots[i].strategy->reach == SLV_GL_REACH_OWN;
    return shares;
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
static slv_result prepare_store(const slv_gl_source *source, slv_gl_texture *texture,
                                const slv_strategy *strategy) {
    const slv_form *form = strategy->form();
    uint32_t store = texture->nstores;
    void *made = NULL;
    slv_result result = form->create(&source->shared, slvi_gl_levels_of(source, form),
                                     source->adjacency, slvi_gl_border(&source->params), &made);
    if (!result)
        result = slvi_gl_store_prepare(source, form, made, strategy->packing,
                                       shares_pages(texture, strategy),
                                       needs_coverage(texture, strategy), &texture->stores[store]);
    if (!result)
        texture->nstores++;
    for (uint32_t i = 0; !result && i < texture->nslots; i++) {
        slv_gl_slot *slot = &texture->slots[i];
        if (!same_store(slot->strategy, strategy))
            continue;
        slot->store = store;
        result = find_reach(source, texture, slot);
    }
    return result;
}

/* Prepares all stores; `at_once` uploads each before the next, so that no more than one form need
 * be in memory. */
static slv_result prepare_all(slv_gl_texture *texture, bool at_once) {
    const slv_gl_source *source = &texture->live->source;
    slv_result result = SLV_OK;
    for (uint32_t i = 0; !result && i < texture->nslots; i++) {
        uint32_t k = 0;
        while (!same_store(texture->slots[k].strategy, texture->slots[i].strategy))
            k++;
        source->steps->total += k == i ? texture->nfaces : 0;
    }
    for (uint32_t i = 0; !result && i < texture->nslots; i++) {
        uint32_t k = 0;
        while (!same_store(texture->slots[k].strategy, texture->slots[i].strategy))
            k++;
        if (k == i && !(result = prepare_store(source, texture, texture->slots[i].strategy)) &&
            at_once)
            result = slvi_gl_making_upload(texture, UINT64_MAX);
    }
    return result;
}

static uint64_t texel_bytes(const slv_texture_desc *desc, uint32_t nchannels) {
    uint64_t texels = 0;
    for (uint32_t f = 0; f < desc->nfaces; f++)
        texels += (uint64_t)1 << (desc->res[f].u + desc->res[f].v);
    return texels * nchannels * slv_type_size(desc->type);
}

static slv_result prepare(slv_gl *gl, const slv_env *env, const slv_gl_given *given,
                          const slv_gl_texture_params *params, bool at_once, slv_gl_texture **out) {
    const slv_texture_desc *desc = slv_texture_get_desc(given->texture);
    uint32_t nfaces = slv_adjacency_face_count(given->adjacency);
    slv_gl_texture *made = NULL;
    slv_result result = SLV_OK;
    *out = NULL;
    if (nfaces != desc->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "the texture has %u faces, the adjacency %u",
                         desc->nfaces, nfaces);
    if (at_once && (result = slvi_gl_need_current(gl, env)))
        return result;
    if ((result = slvi_alloc(env, "GL texture", 1, sizeof *made, &made)))
        return result;
    made->gl = gl;
    if (env)
        made->env = *env;
    made->serial = ++gl->serial;
    made->nfaces = desc->nfaces;
    if ((result = fill_params(gl, env, given, params, &made->params)) ||
        (result = take_prefix(made, made->params.prefix)) || (result = list_slots(made, params)) ||
        (result = slvi_alloc(env, "face table", desc->nfaces, sizeof *made->res, &made->res)) ||
        (result = slvi_gl_making_begin(made)) ||
        (result = slvi_gl_live_create(gl, &made->env, given, &made->params, &made->making->steps,
                                      &made->live)))
        goto done;
    memcpy(made->res, desc->res, desc->nfaces * sizeof *made->res);
    made->texel_bytes = texel_bytes(desc, made->params.nchannels);
    made->scaled = made->live->scaled;
    made->constants = made->live->source.light && made->params.live;
    for (uint32_t f = 0; f < desc->nfaces && !made->constants; f++)
        made->constants = slvi_gl_is_constant(&made->live->source, f);
    if (!at_once) {
        made->live->source.put_off = &made->making->tables;
        result = prepare_all(made, false);
        goto done;
    }
    slv_gl_transfer before = slvi_gl_transfer_begin(gl);
    if (!(result = prepare_all(made, true)))
        result = slvi_gl_making_end(made);
    slvi_gl_transfer_end(gl, &before);
done:
    if (result) {
        slv_gl_texture_destroy(made);
        made = NULL;
    }
    *out = made;
    return result;
}

slv_result slvi_gl_texture_prepare(slv_gl *gl, const slv_env *env, const slv_gl_given *given,
                                   const slv_gl_texture_params *params, bool at_once,
                                   slv_gl_texture **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, prepare(gl, &own, given, params, at_once, out));
}

slv_result slv_gl_texture_create(slv_gl *gl, const slv_env *env, const slv_texture *texture,
                                 const slv_adjacency *adjacency,
                                 const slv_gl_texture_params *params, slv_gl_texture **out) {
    const slv_gl_given given = {texture, adjacency, false, false};
    return slvi_gl_texture_prepare(gl, env, &given, params, true, out);
}

slv_result slv_gl_texture_prepare(slv_gl *gl, const slv_env *env, const slv_texture *texture,
                                  const slv_adjacency *adjacency,
                                  const slv_gl_texture_params *params, slv_gl_texture **out) {
    const slv_gl_given given = {texture, adjacency, false, false};
    return slvi_gl_texture_prepare(gl, env, &given, params, false, out);
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
    const slv_gl_given given = {texture->live->texture, texture->live->source.adjacency,
                                texture->live->source.bare_only, texture->live->decoded};
    result = slvi_gl_texture_prepare(texture->gl, env, &given, &params, true, &fresh);
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
