#include "gl/store/store.h"

#include "base/memory.h"
#include "base/parallel.h"

#include <string.h>

#define STAGING_BYTES (UINT64_C(32) << 20)

struct fill_job {
    const slv_gl_source *source;
    slv_env env; /* logs one at a time */
    const slv_gl_pool *pool;
    const slv_gl_format *format;
    slv_gl_layout layout;
    const slv_gl_forms *forms;
    uint32_t first_layer, level;
    uint64_t layer_size, block_size; /* of a layer before and after compression */
    uint32_t width, height;
    unsigned char *staging, *blocks;
    unsigned char *used;        /* NULL: all texels */
    slv_gl_block_error *errors; /* per layer */
};

static slv_result fill_bare(const struct fill_job *job, uint32_t layer) {
    uint32_t face = job->pool->faces[job->first_layer + layer];
    const slv_texture_desc *desc = slv_levels_get_desc(job->source->levels);
    slv_res res = slv_res_level(job->pool->res, job->level);
    const void *texels = job->forms->htex
                             ? slv_htex_texels(job->forms->htex, face, job->level)
                             : slv_levels_texels(job->source->levels, face, job->level);
    slvi_gl_convert(job->format, texels, desc->nchannels, (size_t)1 << (res.u + res.v), false,
                    job->staging + layer * job->layer_size);
    return SLV_OK;
}

static slv_result fill_bordered(const struct fill_job *job, uint32_t layer, float *scratch) {
    uint32_t face = job->pool->faces[job->first_layer + layer];
    const slv_texture_desc *desc = slv_levels_get_desc(job->source->levels);
    unsigned char *out = job->staging + layer * job->layer_size;
    for (uint32_t level = 0; level < job->pool->nlevels; level++) {
        const slv_gl_rect *rect = &job->pool->rects[level];
        uint32_t width = rect->width + 2 * rect->bu, height = rect->height + 2 * rect->bv;
        slv_result result = slv_border_build(job->source->levels, job->source->adjacency, face,
                                             level, rect->bu, rect->bv, scratch, NULL);
        if (result)
            return result;
        for (uint32_t y = 0; y < height; y++)
            slvi_gl_convert_float(job->format, scratch + (size_t)y * width * desc->nchannels,
                                  desc->nchannels, width,
                                  out + ((size_t)(rect->y + y) * job->pool->width + rect->x) *
                                            job->format->texel_bytes);
    }
    return SLV_OK;
}

static slv_result fill_aligned(const struct fill_job *job, uint32_t layer) {
    uint32_t face = job->pool->faces[job->first_layer + layer];
    const slv_texture_desc *desc = slv_levels_get_desc(job->source->levels);
    unsigned char *out = job->staging + layer * job->layer_size;
    for (uint32_t level = 0; level < job->pool->nlevels; level++) {
        const slv_gl_rect *rect = &job->pool->rects[level];
        const unsigned char *from = slv_edge_aligned_samples(job->forms->aligned, face, level);
        size_t row = rect->width + 1, bytes = row * desc->nchannels * slv_type_size(desc->type);
        for (uint32_t y = 0; y <= rect->height; y++, from += bytes)
            slvi_gl_convert(job->format, from, desc->nchannels, row, false,
                            out + ((size_t)(rect->y + y) * job->pool->width + rect->x) *
                                      job->format->texel_bytes);
    }
    return SLV_OK;
}

static slv_result fill(void *user, uint64_t first, uint64_t end) {
    const struct fill_job *job = user;
    slv_result result = SLV_OK;
    float *scratch = NULL;
    if (job->layout == SLV_GL_BORDERED) {
        uint32_t nchannels = slv_levels_get_desc(job->source->levels)->nchannels;
        result = slvi_alloc(&job->env, "border",
                            (uint64_t)job->pool->width * job->pool->height * nchannels,
                            sizeof *scratch, &scratch);
    }
    for (uint64_t layer = first; !result && layer < end; layer++) {
        result = job->layout == SLV_GL_BORDERED ? fill_bordered(job, (uint32_t)layer, scratch)
                 : job->forms->aligned          ? fill_aligned(job, (uint32_t)layer)
                                                : fill_bare(job, (uint32_t)layer);
        if (!result && job->format->block)
            result = slvi_gl_compress(&job->env, job->format->block, job->format->ncomponents,
                                      job->format->nsource, job->width, job->height,
                                      job->staging + layer * job->layer_size, job->used,
                                      job->blocks + layer * job->block_size, &job->errors[layer]);
    }
    slvi_free(scratch);
    return result;
}

/* Which texels of a packed layer belong to a level. */
static void mark_used(const slv_gl_pool *pool, slv_gl_layout layout, unsigned char *used) {
    uint32_t more = layout == SLV_GL_EDGE_ALIGNED ? 1 : 0;
    for (uint32_t level = 0; level < pool->nlevels; level++) {
        const slv_gl_rect *rect = &pool->rects[level];
        uint32_t width = rect->width + 2 * rect->bu + more;
        uint32_t height = rect->height + 2 * rect->bv + more;
        for (uint32_t y = 0; y < height; y++)
            memset(used + (size_t)(rect->y + y) * pool->width + rect->x, 1, width);
    }
}

/* What compressing the layers of one upload takes. */
static slv_result begin_blocks(const slv_gl_source *source, uint32_t count, struct fill_job *job) {
    uint64_t texels = (uint64_t)job->width * job->height;
    slv_result result;
    job->block_size = slv_gl_compressed_bytes(job->format->block, job->width, job->height);
    if ((result = slvi_alloc(source->env, "blocks", job->block_size * count, 1, &job->blocks)) ||
        (result = slvi_alloc(source->env, "errors of blocks", count, sizeof *job->errors,
                             &job->errors)) ||
        (slv_gl_is_packed(job->layout) &&
         (result = slvi_alloc(source->env, "layer", texels, 1, &job->used))))
        return result;
    if (job->used)
        mark_used(job->pool, job->layout, job->used);
    return SLV_OK;
}

static void end_blocks(struct fill_job *job) {
    slvi_free(job->blocks);
    slvi_free(job->errors);
    slvi_free(job->used);
}

static void send(const slv_gl_api *api, const struct fill_job *job, uint32_t count) {
    const slv_gl_format *format = job->format;
    GLuint texture = job->pool->texture;
    GLint level = (GLint)job->level, first = (GLint)job->first_layer;
    GLsizei width = (GLsizei)job->width, height = (GLsizei)job->height, depth = (GLsizei)count;
    if (format->block)
        api->CompressedTextureSubImage3D(texture, level, 0, 0, first, width, height, depth,
                                         format->internal, (GLsizei)(job->block_size * count),
                                         job->blocks);
    else
        api->TextureSubImage3D(texture, level, 0, 0, first, width, height, depth, format->external,
                               format->data, job->staging);
}

slv_result slvi_gl_upload_level(const slv_gl_source *source, const slv_env *env,
                                slv_gl_store *store, const slv_gl_forms *forms,
                                const slv_gl_pool *pool, uint32_t level, unsigned char **staging,
                                uint64_t *capacity) {
    const slv_gl_format *format = pool->wide ? &store->wide_format : &store->format;
    slv_res res = slv_res_level(pool->res, level);
    bool packed = slv_gl_is_packed(store->layout);
    uint32_t width = packed ? pool->width : 1u << res.u;
    uint32_t height = packed ? pool->height : 1u << res.v;
    uint64_t layer_size = (uint64_t)width * height * format->texel_bytes;
    uint64_t at_once = STAGING_BYTES / layer_size ? STAGING_BYTES / layer_size : 1;
    slv_result result = SLV_OK;
    at_once = at_once < pool->nlayers ? at_once : pool->nlayers;
    if (layer_size * at_once > *capacity) {
        slvi_free(*staging);
        *capacity = layer_size * at_once;
        if ((result = slvi_alloc(source->env, "upload", *capacity, 1, staging)))
            return result;
    }
    for (uint32_t first = 0; !result && first < pool->nlayers; first += (uint32_t)at_once) {
        uint32_t count =
            pool->nlayers - first < at_once ? pool->nlayers - first : (uint32_t)at_once;
        struct fill_job job = {.source = source,
                               .env = *env,
                               .pool = pool,
                               .format = format,
                               .layout = store->layout,
                               .forms = forms,
                               .first_layer = first,
                               .level = level,
                               .layer_size = layer_size,
                               .width = width,
                               .height = height,
                               .staging = *staging};
        if (packed)
            memset(*staging, 0, layer_size * count);
        if (format->block)
            result = begin_blocks(source, count, &job);
        if (!result)
            result =
                slvi_parallel_for(source->env, count, count > 512 ? 64 : count / 8 + 1, fill, &job);
        if (!result)
            send(&source->gl->api, &job, count);
        for (uint32_t i = 0; !result && format->block && i < count; i++)
            slvi_gl_block_error_add(&store->error, &job.errors[i]);
        end_blocks(&job);
    }
    return result;
}
