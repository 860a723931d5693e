#include "gl/store/store.h"

#include "base/log.h"
#include "base/memory.h"
#include "gl/strategy/parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const strategy_names[SLV_STRATEGY_COUNT] = {
    "clamp", "borders", "traverse", "discard", "hybrid", "traverse-full", "edge-aligned", "htex"};

const char *slv_strategy_name(slv_strategy strategy) {
    return strategy < SLV_STRATEGY_COUNT ? strategy_names[strategy] : "unknown";
}

bool slv_strategy_from_name(const char *name, slv_strategy *out) {
    for (int s = 0; s < SLV_STRATEGY_COUNT; s++) {
        if (strcmp(name, strategy_names[s]) == 0) {
            *out = (slv_strategy)s;
            return true;
        }
    }
    return false;
}

/* Software samplers take an anisotropic footprint from neighbouring fragments' coordinates and
 * ignore explicit derivatives; of an isotropic one they only estimate the length. */
static bool taps_in_shader(const slv_gl_texture *texture) {
    return texture->gl->info.software;
}

static bool in_vectors(const slv_gl_texture *texture) {
    slv_gl_branching branching = texture->params.branching;
    return texture->gl->ballot &&
           (branching == SLV_GL_BRANCHING_AUTO ? texture->gl->info.software
                                               : branching == SLV_GL_BRANCHING_VECTORS);
}

enum { SAMPLER_CLAMPED, SAMPLER_ZERO_BORDER, SAMPLER_PACKED, SAMPLER_SQUARES, SAMPLERS };

static void make_samplers(slv_gl_texture *texture) {
    static const float zero[4] = {0, 0, 0, 0};
    const slv_gl_api *api = &texture->gl->api;
    api->CreateSamplers(SAMPLERS, texture->samplers);
    for (int i = 0; i < SAMPLERS; i++) {
        GLuint sampler = texture->samplers[i];
        /* a packed layer is never left, and a square by half a texel at most, which repeats the
         * one at its side; but with these modes software drivers filter 8-bit texels in float and
         * not in 8 bits */
        GLint wrap = i == SAMPLER_CLAMPED   ? GL_CLAMP_TO_EDGE
                     : i == SAMPLER_SQUARES ? GL_MIRRORED_REPEAT
                                            : GL_CLAMP_TO_BORDER;
        api->SamplerParameteri(sampler, GL_TEXTURE_WRAP_S, wrap);
        api->SamplerParameteri(sampler, GL_TEXTURE_WRAP_T, wrap);
        api->SamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        api->SamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER,
                               i == SAMPLER_PACKED ? GL_LINEAR : GL_LINEAR_MIPMAP_LINEAR);
        api->SamplerParameterfv(sampler, GL_TEXTURE_BORDER_COLOR, zero);
        if (texture->params.anisotropy > 1 && !taps_in_shader(texture) && i != SAMPLER_SQUARES)
            api->SamplerParameterf(sampler, GL_TEXTURE_MAX_ANISOTROPY,
                                   (float)texture->params.anisotropy);
    }
}

static slv_result fill_params(slv_gl *gl, const slv_env *env, const slv_texture_desc *desc,
                              const slv_gl_texture_params *given, slv_gl_texture_params *out) {
    slv_gl_texture_params params = {0};
    if (given)
        params = *given;
    if (!params.strategies)
        params.strategies = (1u << SLV_STRATEGY_COUNT) - 1;
    if (!params.nchannels && params.first_channel < desc->nchannels) {
        params.nchannels = desc->nchannels - params.first_channel;
        params.nchannels = params.nchannels < 4 ? params.nchannels : 4;
    }
    if (params.nchannels < 1 || params.nchannels > 4 || params.first_channel >= desc->nchannels ||
        params.nchannels > desc->nchannels - params.first_channel)
        return slvi_fail(
            env, SLV_ERROR_ARGUMENT, "channels %u to %u cannot be shown, the texture has %u",
            params.first_channel, params.first_channel + params.nchannels - 1, desc->nchannels);
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
    params.strategies &= (1u << SLV_STRATEGY_COUNT) - 1;
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

static uint64_t texel_bytes(const slv_texture_desc *desc, uint32_t nchannels) {
    uint64_t texels = 0;
    for (uint32_t f = 0; f < desc->nfaces; f++)
        texels += (uint64_t)1 << (desc->res[f].u + desc->res[f].v);
    return texels * nchannels * slv_type_size(desc->type);
}

static slv_gl_layout layout_of(slv_strategy strategy) {
    return strategy == SLV_STRATEGY_BORDERS        ? SLV_GL_BORDERED
           : strategy == SLV_STRATEGY_EDGE_ALIGNED ? SLV_GL_EDGE_ALIGNED
           : strategy == SLV_STRATEGY_HTEX         ? SLV_GL_HALF_EDGE
                                                   : SLV_GL_BARE;
}

static bool wants(const slv_gl_texture *texture, slv_strategy strategy) {
    return texture->params.strategies >> strategy & 1;
}

/* Those that look into neighbours share one set of tables. */
static bool reaches(slv_strategy strategy) {
    return strategy == SLV_STRATEGY_TRAVERSE || strategy == SLV_STRATEGY_HYBRID ||
           strategy == SLV_STRATEGY_TRAVERSE_FULL;
}

static slv_result read_lookups(const slv_env *env, char *lookups[SLV_STRATEGY_COUNT]) {
    slv_result result = SLV_OK;
    for (int s = 0; !result && s < SLV_STRATEGY_COUNT; s++)
        result = slvi_gl_strategy_text(env, (slv_strategy)s, &lookups[s]);
    return result;
}

slv_result slv_gl_texture_create(slv_gl *gl, const slv_env *env, const slv_texture *texture,
                                 const slv_adjacency *adjacency,
                                 const slv_gl_texture_params *params, slv_gl_texture **out) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    slv_gl_texture *made = NULL;
    slv_texture *scaled = NULL;
    slv_levels *levels = NULL;
    slvi_steps steps;
    slv_result result = SLV_OK;
    *out = NULL;
    if (slv_adjacency_face_count(adjacency) != desc->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "the texture has %u faces, the adjacency %u",
                         desc->nfaces, slv_adjacency_face_count(adjacency));
    if ((result = slvi_alloc(env, "GL texture", 1, sizeof *made, &made)))
        return result;
    slvi_steps_begin(&steps, params ? params->progress : (slv_progress){0}, 0);
    made->gl = gl;
    made->serial = ++gl->serial;
    made->nfaces = desc->nfaces;
    if ((result = fill_params(gl, env, desc, params, &made->params)) ||
        (result = read_lookups(env, made->lookups)) ||
        (result = slvi_alloc(env, "face table", desc->nfaces, sizeof *made->res, &made->res)) ||
        (result = slvi_gl_scale_down(env, texture, &scaled)) ||
        (result = slv_levels_create(env, scaled ? scaled : texture, &levels)))
        goto done;
    made->scaled = scaled != NULL;
    slv_texture_destroy(scaled);
    scaled = NULL;
    slvi_gl_set_state(gl);
    memcpy(made->res, desc->res, desc->nfaces * sizeof *made->res);
    made->texel_bytes = texel_bytes(desc, made->params.nchannels);
    slv_gl_source source = {.env = env,
                            .gl = gl,
                            .levels = levels,
                            .adjacency = adjacency,
                            .params = made->params,
                            .steps = &steps};
    bool reaching = wants(made, SLV_STRATEGY_TRAVERSE) || wants(made, SLV_STRATEGY_HYBRID) ||
                    wants(made, SLV_STRATEGY_TRAVERSE_FULL);
    bool layouts[SLV_GL_LAYOUT_COUNT] = {false};
    for (int s = 0; s < SLV_STRATEGY_COUNT; s++)
        layouts[layout_of((slv_strategy)s)] |= wants(made, (slv_strategy)s);
    for (int k = 0; k < SLV_GL_LAYOUT_COUNT; k++)
        steps.total += layouts[k] ? desc->nfaces : 0;
    for (int k = 0; k < SLV_GL_LAYOUT_COUNT; k++)
        if (layouts[k] && (result = slvi_gl_store_build(&source, (slv_gl_layout)k, &made->stores[k],
                                                        &made->own[k])))
            goto done;
    if (reaching && (result = slvi_gl_batches_with_neighbours(&source, &made->stores[SLV_GL_BARE],
                                                              &made->reach, &made->links,
                                                              &made->corners, &made->reach_bytes)))
        goto done;
    make_samplers(made);
    result = slvi_gl_check(gl, env, "GL texture");
done:
    slvi_steps_end(&steps);
    slv_texture_destroy(scaled);
    slv_levels_destroy(levels);
    if (result) {
        slv_gl_texture_destroy(made);
        made = NULL;
    }
    *out = made;
    return result;
}

void slv_gl_texture_destroy(slv_gl_texture *texture) {
    if (!texture)
        return;
    const slv_gl_api *api = &texture->gl->api;
    for (int k = 0; k < SLV_GL_LAYOUT_COUNT; k++) {
        slvi_gl_store_free(texture->gl, &texture->stores[k]);
        slvi_gl_batches_free(&texture->own[k]);
    }
    slvi_gl_batches_free(&texture->reach);
    api->DeleteBuffers(1, &texture->links);
    api->DeleteBuffers(1, &texture->corners);
    api->DeleteSamplers(SAMPLERS, texture->samplers);
    for (int s = 0; s < SLV_STRATEGY_COUNT; s++) {
        slvi_free(texture->lookups[s]);
        for (int v = 0; v < SLV_GL_MAX_VARIANTS; v++) {
            slvi_free(texture->glsl[s][v]);
            api->DeleteProgram(texture->lookup_programs[s][v]);
        }
    }
    slvi_free(texture->res);
    slvi_free(texture);
}

static bool split_coverage(const slv_gl_texture *texture, slv_strategy strategy) {
    return texture->params.nchannels == 4 && strategy != SLV_STRATEGY_CLAMP &&
           layout_of(strategy) == SLV_GL_BARE;
}

static const slv_gl_store *store_of(const slv_gl_texture *texture, slv_strategy strategy) {
    return &texture->stores[layout_of(strategy)];
}

const slv_gl_batches *slvi_gl_texture_batches(const slv_gl_texture *texture,
                                              slv_strategy strategy) {
    static const slv_gl_batches none;
    if ((unsigned)strategy >= SLV_STRATEGY_COUNT || !wants(texture, strategy))
        return &none;
    return reaches(strategy) ? &texture->reach : &texture->own[layout_of(strategy)];
}

slv_gl_texture_stats slv_gl_texture_get_stats(const slv_gl_texture *texture,
                                              slv_strategy strategy) {
    const slv_gl_store *store = store_of(texture, strategy);
    slv_gl_texture_stats stats = {.texel_bytes = texture->texel_bytes,
                                  .gpu_bytes = store->bytes,
                                  .pools = store->npools,
                                  .batches = slvi_gl_texture_batches(texture, strategy)->count,
                                  .widened = store->nwide,
                                  .clipped = store->nclipped,
                                  .block_max = store->error.most};
    if (store->error.count)
        stats.block_rms = sqrt(store->error.squares / (double)store->error.count);
    if (split_coverage(texture, strategy))
        stats.gpu_bytes += store->coverage_bytes;
    if (reaches(strategy))
        stats.gpu_bytes += texture->reach_bytes;
    return stats;
}

uint32_t slv_gl_texture_face_count(const slv_gl_texture *texture) {
    return texture->nfaces;
}

uint32_t slv_gl_texture_batch_count(const slv_gl_texture *texture, slv_strategy strategy) {
    return slvi_gl_texture_batches(texture, strategy)->count;
}

slv_gl_batch slv_gl_texture_batch(const slv_gl_texture *texture, slv_strategy strategy,
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

const char *slv_gl_texture_glsl(slv_gl_texture *texture, slv_strategy strategy, uint32_t variant) {
    if ((unsigned)strategy >= SLV_STRATEGY_COUNT || variant >= SLV_GL_MAX_VARIANTS)
        return "";
    char **text = &texture->glsl[strategy][variant];
    if (!*text) {
        size_t size = strlen(texture->lookups[strategy]) + 512;
        if (slvi_alloc_plain(NULL, "text of a strategy", size, 1, text))
            return "";
        /* alpha is a texel's own only where there are four channels */
        float scale = texture->scaled ? SLV_GL_SCALE : 1;
        snprintf(*text, size,
                 "#define SLV_POOLS %u\n#define SLV_SUBFACES %u\n"
                 "#define SLV_SPLIT_COVERAGE %d\n#define SLV_ANISOTROPY %u\n#define SLV_BORDER %u\n"
                 "#define SLV_TAPS %d\n#define SLV_VECTORS %d\n#define SLV_FIRST_UNIT %d\n#define "
                 "SLV_FIRST_STORAGE %d\n#define SLV_SCALED %d\n#define SLV_SCALE vec4(vec3(%.1f), "
                 "%.1f)\n%s\n",
                 slv_gl_variant_pools(variant), variant & 1, split_coverage(texture, strategy),
                 texture->params.anisotropy, texture->params.border, taps_in_shader(texture),
                 in_vectors(texture), SLV_GL_FIRST_UNIT, SLV_GL_FIRST_STORAGE, texture->scaled,
                 (double)scale, (double)(texture->params.nchannels == 4 ? scale : 1),
                 texture->lookups[strategy]);
    }
    return *text;
}

void slv_gl_texture_bind(slv_gl_texture *texture, slv_strategy strategy, uint32_t index) {
    const slv_gl_batches *batches = slvi_gl_texture_batches(texture, strategy);
    const slv_gl_store *store = store_of(texture, strategy);
    const slv_gl_api *api = &texture->gl->api;
    if (index >= batches->count)
        return;
    const slv_gl_batch_range *range = &batches->ranges[index];
    uint32_t reach = slv_gl_variant_pools(range->variant);
    GLuint sampler = texture->samplers[slv_gl_is_packed(store->layout)  ? SAMPLER_PACKED
                                       : strategy == SLV_STRATEGY_HTEX  ? SAMPLER_SQUARES
                                       : strategy == SLV_STRATEGY_CLAMP ? SAMPLER_CLAMPED
                                                                        : SAMPLER_ZERO_BORDER];
    bool split = split_coverage(texture, strategy);
    for (uint32_t slot = 0; slot < reach; slot++) {
        const slv_gl_pool *pool = &store->pools[range->pools[slot < range->npools ? slot : 0]];
        api->BindTextureUnit(SLV_GL_FIRST_UNIT + slot, pool->texture);
        api->BindSampler(SLV_GL_FIRST_UNIT + slot, sampler);
        if (split) {
            api->BindTextureUnit(SLV_GL_FIRST_UNIT + reach + slot, pool->coverage);
            api->BindSampler(SLV_GL_FIRST_UNIT + reach + slot, sampler);
        }
    }
    api->BindBufferBase(GL_SHADER_STORAGE_BUFFER, SLV_GL_FIRST_STORAGE, store->table);
    if (reaches(strategy)) {
        api->BindBufferBase(GL_SHADER_STORAGE_BUFFER, SLV_GL_FIRST_STORAGE + 1, texture->links);
        api->BindBufferBase(GL_SHADER_STORAGE_BUFFER, SLV_GL_FIRST_STORAGE + 3, texture->corners);
    }
    if (strategy == SLV_STRATEGY_HTEX) {
        api->BindBufferBase(GL_SHADER_STORAGE_BUFFER, SLV_GL_FIRST_STORAGE + 1, store->squares);
        api->BindBufferBase(GL_SHADER_STORAGE_BUFFER, SLV_GL_FIRST_STORAGE + 3, store->corners);
    }
    if (slv_gl_is_packed(store->layout))
        api->BindBufferBase(GL_SHADER_STORAGE_BUFFER, SLV_GL_FIRST_STORAGE + 2, store->rects);
}

void slv_gl_texture_unbind(slv_gl_texture *texture) {
    uint32_t units = texture->params.batch_pools * (texture->params.nchannels == 4 ? 2 : 1);
    uint32_t squares = slv_gl_square_pools(&texture->params);
    units = units > squares ? units : squares;
    for (uint32_t unit = 0; unit < units; unit++)
        texture->gl->api.BindSampler(SLV_GL_FIRST_UNIT + unit, 0);
}
