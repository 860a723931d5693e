/* Uploading a texture bit by bit: arrays pool by pool, level by level, some layers at a time, then
 * tables. */
#include "gl/live/making.h"

#include "base/log.h"
#include "base/memory.h"
#include "gl/store/tables.h"

#include <selvage/border.h>
#include <selvage/gl_live.h>

#include <string.h>
#include <time.h>

#define AT_ONCE (UINT64_C(32) << 20) /* bytes in one call of the driver's */
#define IN_STEPS (UINT64_C(1) << 18) /* the same where a call is to end soon */
#define ITEMS_IN_STEP 2048u          /* of a texel each, which take their time however few bytes */
#define MOST_SECONDS 0.016
#define CLEARED (UINT64_C(1) << 20) /* bytes that a software driver clears in next to no time */

slv_result slvi_gl_making_begin(slv_gl_texture *texture) {
    slv_result result =
        slvi_alloc(&texture->env, "GL texture", 1, sizeof *texture->making, &texture->making);

    if (!result)
        slvi_steps_begin(&texture->making->steps, texture->params.progress, 0);
    return result;
}

void slvi_gl_making_free(slv_gl_texture *texture) {
    slv_gl_making *making = texture->making;
    if (!making)
        return;
    slvi_gl_delete(texture->gl->api.DeleteBuffers, &making->buffer);
    slvi_gl_tables_free(&making->tables);
    slvi_gl_staging_free(&making->staging);
    slvi_steps_end(&making->steps);
    slvi_free(making);
    texture->making = NULL;
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
    if (texture->params.anisotropy > 1 && !slvi_gl_taps_in_shader(texture) && !strategy->own_taps)
        api->SamplerParameterf(sampler, GL_TEXTURE_MAX_ANISOTROPY,
                               (float)texture->params.anisotropy);
    return sampler;
}

/* How far one call may go. */
struct bounds {
    uint64_t bytes, begun, end; /* making->done at first, and to stop at */
    double until;               /* 0: as long as it takes */
    bool over;                  /* what was made, or is to be, is for a call of its own */
};

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool is_over(const slv_gl_making *making, const struct bounds *bounds) {
    return bounds->over || making->done >= bounds->end ||
           (bounds->until > 0 && now() >= bounds->until);
}

/* Whether so many bytes on the GPU are made in this call; large ones are all that a call does. */
static bool may_make(const slv_gl_making *making, uint64_t bytes, struct bounds *bounds) {
    bounds->over = bounds->until > 0 && bytes > CLEARED;
    return !bounds->over || making->done == bounds->begun;
}

/* The share of the store's steps that a pool stands for. */
static slv_result count_pool(const slv_gl_texture *texture, const slv_gl_pools *pools,
                             const slv_gl_pool *pool) {
    slv_gl_making *making = texture->making;
    uint64_t nfaces = texture->nfaces, before = making->layers;
    making->layers += pool->nlayers;
    return slvi_steps_add(&making->steps, &texture->env, "GL texture",
                          nfaces * making->layers / pools->nitems -
                              nfaces * before / pools->nitems);
}

/* Some layers of the level that comes next. */
static slv_result upload_layers(slv_gl_texture *texture, slv_gl_store *store,
                                struct bounds *bounds) {
    slv_gl_making *making = texture->making;
    slv_gl_pool *pool = &store->pools.pools[making->pool];
    const slv_gl_source *source = &texture->live->source;
    slv_gl_layers layers = {pool, making->level, making->layer, 1};
    uint64_t each = slvi_gl_layers_bytes(&store->pools, &layers);
    uint64_t left = bounds->end - making->done, most = left < bounds->bytes ? left : bounds->bytes;
    slv_result result = SLV_OK;
    if (!pool->texture) {
        bool may = slv_gl_pool_array(&store->pools, pool).texture ||
                   may_make(making, slvi_gl_array_bytes(&store->pools, pool), bounds);
        if (!may || (result = slvi_gl_store_make_pool(source, store, pool)) || bounds->over)
            return result;
    }
    if (bounds->until > 0 && most > ITEMS_IN_STEP * each)
        most = ITEMS_IN_STEP * each;
    layers.count = slvi_gl_layers_fitting(&store->pools, &layers, most);
    if ((result = slvi_gl_upload_layers(source, &store->pools, store->made, &layers,
                                        &making->staging, &store->error)))
        return result;
    making->done += each * layers.count;
    making->layer += layers.count;
    if (making->layer < pool->nlayers)
        return SLV_OK;
    making->layer = 0;
    if (++making->level < slv_gl_pool_levels(&store->pools, pool))
        return SLV_OK;
    making->level = 0;
    making->pool++;
    return count_pool(texture, &store->pools, pool);
}

static slv_result upload_texels(slv_gl_texture *texture, struct bounds *bounds) {
    slv_gl_making *making = texture->making;
    slv_result result = SLV_OK;
    while (!result && making->store < texture->nstores && !is_over(making, bounds)) {
        slv_gl_store *store = &texture->stores[making->store];
        if (making->pool < store->pools.npools) {
            result = upload_layers(texture, store, bounds);
            continue;
        }
        /* giving back what a form made of a million faces takes its time too */
        bounds->over = bounds->until > 0 && making->done > bounds->begun;
        if (bounds->over)
            break;
        making->store++;
        making->pool = 0;
        making->layers = 0;
        if (!texture->params.live)
            slvi_gl_store_let_go(store);
    }
    return result;
}

/* A part of the last table. */
static slv_result upload_table(slv_gl_texture *texture, struct bounds *bounds) {
    slv_gl_making *making = texture->making;
    slv_gl_table *table = &making->tables.tables[making->tables.count - 1];
    uint64_t left = table->bytes - making->filled, most = bounds->end - making->done;
    slv_result result = SLV_OK;
    most = most < bounds->bytes ? most : bounds->bytes;
    most = left < most ? left : most;
    if (!making->buffer && (!may_make(making, table->bytes, bounds) ||
                            (result = slvi_gl_buffer(texture->gl, &texture->env, table->what, NULL,
                                                     table->bytes, &making->buffer)) ||
                            bounds->over))
        return result;
    if (most)
        texture->gl->api.NamedBufferSubData(making->buffer, (GLintptr)making->filled,
                                            (GLsizeiptr)most,
                                            (const char *)table->data + making->filled);
    making->filled += most;
    making->done += most;
    if (making->filled < table->bytes)
        return SLV_OK;
    *table->out = making->buffer;
    making->buffer = 0;
    making->filled = 0;
    slvi_free(table->data);
    making->tables.count--;
    return SLV_OK;
}

slv_result slvi_gl_making_upload(slv_gl_texture *texture, uint64_t max_bytes) {
    slv_gl_making *making = texture->making;
    bool unbounded = max_bytes == UINT64_MAX;
    struct bounds bounds = {.bytes = unbounded ? AT_ONCE : IN_STEPS,
                            .begun = making->done,
                            .end = max_bytes < UINT64_MAX - making->done ? making->done + max_bytes
                                                                         : UINT64_MAX,
                            .until = unbounded ? 0 : now() + MOST_SECONDS};
    slv_result result = upload_texels(texture, &bounds);
    while (!result && making->store == texture->nstores && making->tables.count &&
           !is_over(making, &bounds))
        result = upload_table(texture, &bounds);
    return result ? result : slvi_gl_check(texture->gl, &texture->env, "texture upload");
}

slv_result slvi_gl_making_end(slv_gl_texture *texture) {
    slv_gl_live *live = texture->live;
    slv_result result;
    for (uint32_t i = 0; i < texture->nslots; i++)
        if (!texture->slots[i].sampler)
            texture->slots[i].sampler = make_sampler(texture, texture->slots[i].strategy);
    if ((result = slvi_gl_texture_take_handles(texture)) ||
        (result = slvi_gl_check(texture->gl, &texture->env, "GL texture")))
        return result;
    live->source.steps = NULL;
    live->source.put_off = NULL;
    if (texture->params.live) {
        if ((result = slvi_gl_marks_begin(&texture->env, texture->nfaces, &live->faces)) ||
            (result = slv_form_borders()->create(&live->source.shared, live->levels,
                                                 live->source.adjacency, 1, &live->around)))
            return result;
    } else {
        slvi_gl_live_destroy(live);
        texture->live = NULL;
    }
    slvi_gl_making_free(texture);
    return SLV_OK;
}

uint64_t slvi_gl_making_bytes(const slv_gl_texture *texture) {
    uint64_t bytes = 0;
    for (uint32_t s = 0; s < texture->nstores; s++) {
        const slv_gl_pools *pools = &texture->stores[s].pools;
        for (uint32_t p = 0; p < pools->npools; p++)
            bytes += slvi_gl_layer_bytes(pools, &pools->pools[p]) * pools->pools[p].nlayers;
    }
    for (uint32_t i = 0; i < texture->making->tables.count; i++)
        bytes += texture->making->tables.tables[i].bytes;
    return bytes;
}

slv_result slv_gl_texture_upload(slv_gl_texture *texture, const slv_env *env, uint64_t max_bytes,
                                 slv_gl_upload *out) {
    slv_gl_making *making = texture->making;
    slv_result result = SLV_OK;
    uint64_t done = 0, total = 0;
    if (making && making->failed)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "the upload was cancelled or failed: the texture can only be destroyed");
    if (making && (result = slvi_gl_need_current(texture->gl, env)))
        return result;
    if (making) {
        if (!making->total)
            making->total = slvi_gl_making_bytes(texture);
        slv_gl_transfer before = slvi_gl_transfer_begin(texture->gl);
        result = slvi_gl_making_upload(texture, max_bytes ? max_bytes : 1);
        slvi_gl_transfer_end(texture->gl, &before);
        done = making->done;
        total = making->total;
        if (!result && making->store == texture->nstores && !making->tables.count)
            result = slvi_gl_making_end(texture);
        if (result)
            making->failed = true;
    }
    if (out)
        *out = (slv_gl_upload){.ready = !texture->making, .done = done, .total = total};
    return result;
}
