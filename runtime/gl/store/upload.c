/* Texels are converted on threads into staging memory, compressed if need be, and handed to the
 * driver from there. */
#include "gl/store/upload.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <string.h>

#define STAGING_BYTES (UINT64_C(32) << 20)

struct fill_job {
    const slv_gl_source *source;
    const slv_gl_pools *pools;
    const slv_gl_pool *pool;
    const slv_gl_format *format;
    const void *made;
    uint32_t first_layer, level;
    uint64_t layer_size, block_size; /* of a layer before and after compression */
    uint32_t width, height;
    unsigned char *staging, *blocks;
    unsigned char *used;        /* NULL: all texels */
    slv_gl_block_error *errors; /* per layer */
};

static slv_result fill_level(const struct fill_job *job, uint32_t item, uint32_t level,
                             float *scratch, unsigned char *out) {
    const slv_form *form = job->pools->form;
    const slv_gl_format *format = job->format;
    uint32_t nchannels = slv_levels_get_desc(job->source->levels)->nchannels;
    slv_form_extent extent =
        slv_form_level_extent(form, job->pool->res, level, slvi_gl_border(&job->source->params));
    slv_form_texels from;
    slv_result result = form->read(job->made, item, level, scratch, &from);
    if (result)
        return result;
    slv_type type = slv_levels_get_desc(job->source->levels)->type;
    if (from.type != type && from.type != SLV_TYPE_FLOAT)
        return slvi_fail(&job->source->shared, SLV_ERROR_ARGUMENT,
                         "form %s: %s of another type than the texture's is not float", form->name,
                         form->item);
    float *floats = NULL;
    if (from.type != format->type && from.type != SLV_TYPE_FLOAT) {
        size_t values = (size_t)extent.width * extent.height * nchannels;
        if ((result =
                 slvi_alloc_plain(&job->source->shared, "level", values, sizeof *floats, &floats)))
            return result;
        slv_type_to_float(from.type, from.texels, values, floats);
        from = (slv_form_texels){floats, SLV_TYPE_FLOAT};
    }
    size_t row = (size_t)extent.width * nchannels * slv_type_size(from.type);
    bool whole = extent.width == job->width;
    uint32_t runs = whole ? 1 : extent.height;
    size_t count = whole ? (size_t)extent.width * extent.height : extent.width;
    for (uint32_t y = 0; y < runs; y++) {
        const void *texels = (const unsigned char *)from.texels + y * row;
        unsigned char *to = out + (size_t)y * job->width * format->texel_bytes;
        if (from.type == format->type)
            slvi_gl_convert(format, texels, nchannels, count, to);
        else
            slvi_gl_convert_float(format, texels, nchannels, count, to);
    }
    slvi_free(floats);
    return SLV_OK;
}

static slv_result fill_layer(const struct fill_job *job, uint32_t layer, float *scratch) {
    uint32_t item = job->pool->items[job->first_layer + layer];
    unsigned char *out = job->staging + layer * job->layer_size;
    slv_result result = SLV_OK;
    if (job->pools->packing != SLV_GL_PAGES)
        return fill_level(job, item, job->level, scratch, out);
    for (uint32_t level = 0; !result && level < job->pool->nlevels; level++) {
        const slv_gl_rect *rect = &job->pool->rects[level];
        size_t at = (size_t)rect->y * job->width + rect->x;
        result = fill_level(job, item, level, scratch, out + at * job->format->texel_bytes);
    }
    return result;
}

static slv_result fill(void *user, uint64_t first, uint64_t end) {
    const struct fill_job *job = user;
    const slv_env *env = &job->source->shared;
    slv_result result = SLV_OK;
    float *scratch = NULL;
    if (job->pools->form->computed)
        result = slvi_alloc_plain(env, "level",
                                  (uint64_t)job->width * job->height *
                                      slv_levels_get_desc(job->source->levels)->nchannels,
                                  sizeof *scratch, &scratch);
    for (uint64_t layer = first; !result && layer < end; layer++) {
        result = fill_layer(job, (uint32_t)layer, scratch);
        if (!result && job->format->block)
            result = slvi_gl_compress(env, job->format->block, job->format->ncomponents,
                                      job->format->nsource, job->width, job->height,
                                      job->staging + layer * job->layer_size, job->used,
                                      job->blocks + layer * job->block_size, &job->errors[layer]);
    }
    slvi_free(scratch);
    return result;
}

/* Which texels of a page belong to a level. */
static void mark_used(const struct fill_job *job) {
    for (uint32_t level = 0; level < job->pool->nlevels; level++) {
        slv_form_extent extent = slv_form_level_extent(job->pools->form, job->pool->res, level,
                                                       slvi_gl_border(&job->source->params));
        const slv_gl_rect *rect = &job->pool->rects[level];
        for (uint32_t y = 0; y < extent.height; y++)
            memset(job->used + (size_t)(rect->y + y) * job->width + rect->x, 1, extent.width);
    }
}

/* What compressing the layers of one upload takes. */
static slv_result begin_blocks(uint32_t count, struct fill_job *job) {
    const slv_env *env = job->source->env;
    uint64_t texels = (uint64_t)job->width * job->height;
    bool pages = job->pools->packing == SLV_GL_PAGES;
    slv_result result;
    job->block_size = slv_gl_compressed_bytes(job->format->block, job->width, job->height);
    if ((result = slvi_alloc(env, "blocks", job->block_size * count, 1, &job->blocks)) ||
        (result = slvi_alloc(env, "errors of blocks", count, sizeof *job->errors, &job->errors)) ||
        (pages && (result = slvi_alloc(env, "layer", texels, 1, &job->used))))
        return result;
    if (job->used)
        mark_used(job);
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

slv_result slvi_gl_upload_level(const slv_gl_source *source, const slv_gl_pools *pools,
                                const slv_gl_pool *pool, const void *made, uint32_t level,
                                slv_gl_staging *staging, slv_gl_block_error *error) {
    const slv_gl_format *format = slv_gl_pool_format(pools, pool);
    slv_res res = slv_res_level(pool->res, level);
    bool pages = pools->packing == SLV_GL_PAGES;
    struct fill_job job = {.source = source,
                           .pools = pools,
                           .pool = pool,
                           .format = format,
                           .made = made,
                           .level = level,
                           .width = pages ? pool->width : 1u << res.u,
                           .height = pages ? pool->height : 1u << res.v};
    job.layer_size = (uint64_t)job.width * job.height * format->texel_bytes;
    uint64_t at_once = STAGING_BYTES / job.layer_size ? STAGING_BYTES / job.layer_size : 1;
    slv_result result = SLV_OK;
    at_once = at_once < pool->nlayers ? at_once : pool->nlayers;
    if (job.layer_size * at_once > staging->capacity) {
        slvi_free(staging->memory);
        staging->memory = NULL;
        staging->capacity = job.layer_size * at_once;
        if ((result = slvi_alloc(source->env, "upload", staging->capacity, 1, &staging->memory)))
            return result;
    }
    job.staging = staging->memory;
    for (uint32_t first = 0; !result && first < pool->nlayers; first += (uint32_t)at_once) {
        uint32_t count =
            pool->nlayers - first < at_once ? pool->nlayers - first : (uint32_t)at_once;
        job.first_layer = first;
        if (pages)
            memset(job.staging, 0, job.layer_size * count);
        if (format->block)
            result = begin_blocks(count, &job);
        if (!result)
            result =
                slvi_parallel_for(source->env, count, count > 512 ? 64 : count / 8 + 1, fill, &job);
        if (!result)
            send(&source->gl->api, &job, count);
        for (uint32_t i = 0; !result && format->block && i < count; i++)
            slvi_gl_block_error_add(error, &job.errors[i]);
        end_blocks(&job);
        job.blocks = job.used = NULL;
        job.errors = NULL;
    }
    return result;
}
