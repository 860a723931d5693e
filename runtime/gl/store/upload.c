/* Texels are converted on threads into staging memory, compressed if need be, and handed to the
 * driver from there. */
#include "gl/store/upload.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <string.h>

/* Where texels come from. */
struct origin {
    const slv_gl_source *source;
    const slv_gl_pools *pools;
    const void *made;
    const slv_gl_format *format;
};

/* An item's level as the form has it. */
struct level {
    slv_form_extent extent;
    slv_form_texels read;
};

static slv_result read_level(const struct origin *from, uint32_t item, uint32_t level, bool rim,
                             float *scratch, struct level *out) {
    const slv_form *form = from->pools->form;
    const slv_texture_desc *desc = slv_levels_get_desc(from->source->levels);
    out->extent = slvi_gl_extent(from->source, form, form->res(from->made, item), level);
    slv_result result = rim ? form->read_rim(from->made, item, level, scratch, &out->read)
                            : form->read(from->made, item, level, scratch, &out->read);
    if (!result && out->read.type != desc->type && out->read.type != SLV_TYPE_FLOAT)
        return slvi_fail(&from->source->shared, SLV_ERROR_ARGUMENT,
                         "form %s: %s of another type than the texture's is not float", form->name,
                         form->item);
    return result;
}

/* Texels of another type than the format's, by way of floats. */
static void convert_widened(const struct origin *from, slv_type type, const void *texels,
                            size_t count, unsigned char *out) {
    enum { VALUES = 512 };
    float floats[VALUES];
    uint32_t nchannels = slv_levels_get_desc(from->source->levels)->nchannels;
    size_t texel = nchannels * slv_type_size(type), most = VALUES / nchannels;
    for (size_t at = 0, n; at < count; at += n) {
        n = count - at < most ? count - at : most;
        slv_type_to_float(type, (const unsigned char *)texels + at * texel, n * nchannels, floats);
        slvi_gl_convert_float(from->format, floats, nchannels, n,
                              out + at * from->format->texel_bytes);
    }
}

/* Converts a rectangle of a level; rows of `out` are `pitch` texels apart. */
static void convert(const struct origin *from, const struct level *level, slv_rect rect,
                    unsigned char *out, size_t pitch) {
    const slv_gl_format *format = from->format;
    const slv_texture_desc *desc = slv_levels_get_desc(from->source->levels);
    const slv_form_texels read = level->read;
    const slv_form_extent extent = level->extent;
    bool encoded = read.type == SLV_TYPE_HALF && format->srgb;
    bool widened = !encoded && read.type != format->type && read.type != SLV_TYPE_FLOAT;
    size_t texel = desc->nchannels * slv_type_size(read.type), row = extent.width * texel;
    bool whole = rect.width == extent.width && rect.width == pitch && !widened;
    uint32_t runs = whole ? 1 : rect.height;
    size_t count = whole ? (size_t)rect.width * rect.height : rect.width;
    for (uint32_t y = 0; y < runs; y++) {
        const void *texels =
            (const unsigned char *)read.texels + (rect.y + y) * row + rect.x * texel;
        unsigned char *to = out + y * pitch * format->texel_bytes;
        if (widened)
            convert_widened(from, read.type, texels, count, to);
        else if (encoded)
            slvi_gl_convert_half(format, texels, desc->nchannels, count, to);
        else if (read.type == format->type)
            slvi_gl_convert(format, texels, desc->nchannels, count, to);
        else
            slvi_gl_convert_float(format, texels, desc->nchannels, count, to);
    }
}

/* The four strips that the border, or the samples on edges, of a level take. */
static void cut_rim(const slv_form *form, slv_form_extent extent, slv_rect out[4]) {
    uint32_t x = extent.border_u + form->samples, y = extent.border_v + form->samples;
    uint32_t width = extent.width, height = extent.height;
    out[0] = (slv_rect){0, 0, width, y};
    out[1] = (slv_rect){0, height - y, width, y};
    out[2] = (slv_rect){0, y, x, height - 2 * y};
    out[3] = (slv_rect){width - x, y, x, height - 2 * y};
}

/* All of a level of a face: what is around its own texels, and these without a detour. */
static slv_result fill_around(const struct origin *from, uint32_t face, uint32_t number,
                              float *scratch, unsigned char *out, size_t pitch) {
    const slv_levels *levels = slvi_gl_levels_of(from->source, from->pools->form);
    struct level level, own;
    slv_rect strips[4];
    slv_result result = read_level(from, face, number, true, scratch, &level);
    cut_rim(from->pools->form, level.extent, strips);
    for (uint32_t i = 0; !result && i < 4; i++)
        convert(from, &level, strips[i],
                out + (strips[i].y * pitch + strips[i].x) * from->format->texel_bytes, pitch);
    own.extent = (slv_form_extent){.width = level.extent.width - 2 * level.extent.border_u,
                                   .height = level.extent.height - 2 * level.extent.border_v};
    own.read = (slv_form_texels){slv_levels_texels(levels, face, number),
                                 slv_levels_get_desc(levels)->type};
    size_t at = level.extent.border_v * pitch + level.extent.border_u;
    if (!result)
        convert(from, &own, (slv_rect){0, 0, own.extent.width, own.extent.height},
                out + at * from->format->texel_bytes, pitch);
    return result;
}

static slv_result fill_level(const struct origin *from, uint32_t item, uint32_t number,
                             slv_rect rect, float *scratch, unsigned char *out, size_t pitch) {
    const slv_form *form = from->pools->form;
    struct level level;
    number = slvi_gl_stored_level(from->pools, from->made, item, number);
    level.extent = slvi_gl_extent(from->source, form, form->res(from->made, item), number);
    if (form->read_rim && form->borders && rect.width == level.extent.width &&
        rect.height == level.extent.height)
        return fill_around(from, item, number, scratch, out, pitch);
    slv_result result = read_level(from, item, number, false, scratch, &level);
    if (!result)
        convert(from, &level, rect, out, pitch);
    return result;
}

struct fill_job {
    struct origin from;
    slv_gl_place place; /* the first of the layers; of a grid the first of its cells */
    uint32_t first_layer, level;
    uint32_t across;                 /* cells in a row of what is filled: 1, but for grids */
    uint64_t layer_size, block_size; /* of a layer before and after compression */
    unsigned char *staging, *blocks;
    unsigned char *used;        /* NULL: all texels */
    slv_gl_block_error *errors; /* per layer */
};

static slv_result fill_layer(const struct fill_job *job, uint32_t layer, float *scratch) {
    const slv_gl_pools *pools = job->from.pools;
    const slv_gl_pool *pool = job->place.pool;
    uint32_t item = pool->items[job->first_layer + layer];
    uint32_t first = pools->packing == SLV_GL_PAGES ? 0 : job->level;
    uint32_t end = pools->packing == SLV_GL_PAGES ? pool->nlevels : job->level + 1;
    size_t pitch = (size_t)job->across * job->place.width;
    slv_gl_place cell = slvi_gl_place_cell(pools, pool, job->first_layer + layer, job->level);
    size_t corner = layer / job->across * pitch * cell.height + layer % job->across * cell.width;
    slv_result result = SLV_OK;
    for (uint32_t level = first; !result && level < end; level++) {
        slv_gl_place place = slvi_gl_place(pools, item, level);
        size_t at = corner + (place.y - cell.y) * pitch + (place.x - cell.x);
        result = fill_level(&job->from, item, level, (slv_rect){0, 0, place.width, place.height},
                            scratch, job->staging + at * place.format->texel_bytes, pitch);
    }
    return result;
}

static slv_result fill(void *user, uint64_t first, uint64_t end) {
    const struct fill_job *job = user;
    const slv_env *env = &job->from.source->shared;
    const slv_gl_format *format = job->place.format;
    slv_result result = SLV_OK;
    float *scratch = NULL;
    if (job->from.pools->form->computed)
        result = slvi_alloc_plain(
            env, "level", (uint64_t)job->place.width * job->place.height,
            slv_levels_get_desc(job->from.source->levels)->nchannels * sizeof *scratch, &scratch);
    for (uint64_t layer = first; !result && layer < end; layer++) {
        result = fill_layer(job, (uint32_t)layer, scratch);
        if (!result && format->block)
            result = slvi_gl_compress(env, format->block, format->ncomponents, format->nsource,
                                      job->place.width, job->place.height,
                                      job->staging + layer * job->layer_size, job->used,
                                      job->blocks + layer * job->block_size, &job->errors[layer]);
    }
    slvi_free(scratch);
    return result;
}

/* Which texels of a cell belong to a level. */
static void mark_used(const struct fill_job *job) {
    const slv_gl_pool *pool = job->place.pool;
    for (uint32_t level = 0; level < pool->nlevels; level++) {
        slv_gl_place place = slvi_gl_place(job->from.pools, pool->items[job->first_layer], level);
        uint32_t left = place.x - job->place.x, low = place.y - job->place.y;
        for (uint32_t y = 0; y < place.height; y++)
            memset(job->used + (size_t)(low + y) * job->place.width + left, 1, place.width);
    }
}

/* What compressing the layers of one upload takes. */
static slv_result begin_blocks(uint32_t count, struct fill_job *job) {
    const slv_env *env = job->from.source->env;
    uint64_t texels = (uint64_t)job->place.width * job->place.height;
    bool pages = job->from.pools->packing == SLV_GL_PAGES;
    slv_result result;
    job->block_size = slvi_gl_place_bytes(&job->place);
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

void slvi_gl_staging_free(slv_gl_staging *staging) {
    slvi_free(staging->memory);
    slvi_free(staging->scratch);
    memset(staging, 0, sizeof *staging);
}

static slv_result make_room(const slv_env *env, uint64_t bytes, slv_gl_staging *staging) {
    if (bytes <= staging->capacity)
        return SLV_OK;
    slvi_free(staging->memory);
    staging->memory = NULL;
    staging->capacity = 0;
    slv_result result = slvi_alloc_plain(env, "upload", bytes, 1, &staging->memory);
    if (!result)
        staging->capacity = bytes;
    return result;
}

uint64_t slvi_gl_layers_bytes(const slv_gl_pools *pools, const slv_gl_layers *layers) {
    slv_gl_place place = slvi_gl_place_cell(pools, layers->pool, layers->first, layers->level);
    return slvi_gl_place_bytes(&place);
}

uint32_t slvi_gl_layers_fitting(const slv_gl_pools *pools, const slv_gl_layers *layers,
                                uint64_t bytes) {
    uint32_t left = layers->pool->nlayers - layers->first, columns = layers->pool->columns;
    uint64_t count = bytes / slvi_gl_layers_bytes(pools, layers);
    count = columns ? count / columns * columns : count;
    count = count ? count : columns ? columns : 1;
    return count < left ? (uint32_t)count : left;
}

/* Of a grid one rectangle, but for blocks, which are made cell by cell. */
static void send(const struct fill_job *job, uint32_t count) {
    const slv_gl_pools *pools = job->from.pools;
    const slv_gl_source *source = job->from.source;
    slv_gl_place place = job->place;
    if (!place.pool->columns) {
        slvi_gl_place_send(source, &place, count, job->blocks ? job->blocks : job->staging);
    } else if (job->blocks) {
        for (uint32_t i = 0; i < count; i++) {
            place = slvi_gl_place_cell(pools, place.pool, job->first_layer + i, job->level);
            slvi_gl_place_send(source, &place, 1, job->blocks + i * job->block_size);
        }
    } else {
        place.width *= job->across;
        place.height *= count / job->across;
        slvi_gl_place_send(source, &place, 1, job->staging);
    }
}

/* The filling of layers in a row at a level that OpenGL knows of, to staging memory. */
static slv_result begin_fill(const slv_gl_source *source, const slv_gl_pools *pools,
                             const void *made, const slv_gl_layers *layers, slv_gl_staging *staging,
                             struct fill_job *out) {
    slv_gl_place place = slvi_gl_place_cell(pools, layers->pool, layers->first, layers->level);
    uint32_t columns = place.format->block ? 0 : layers->pool->columns;
    *out = (struct fill_job){.from = {source, pools, made, place.format},
                             .place = place,
                             .first_layer = layers->first,
                             .level = layers->level,
                             .across = 1};
    if (columns)
        out->across = columns < layers->count ? columns : layers->count;
    out->layer_size = (uint64_t)place.width * place.height * place.format->texel_bytes;
    slv_result result = make_room(source->env, out->layer_size * layers->count, staging);
    out->staging = staging->memory;
    if (!result && pools->packing == SLV_GL_PAGES)
        memset(out->staging, 0, out->layer_size * layers->count);
    return result;
}

slv_result slvi_gl_upload_layers(const slv_gl_source *source, const slv_gl_pools *pools,
                                 const void *made, const slv_gl_layers *layers,
                                 slv_gl_staging *staging, slv_gl_block_error *error) {
    uint32_t count = layers->count;
    struct fill_job job;
    slv_result result = begin_fill(source, pools, made, layers, staging, &job);
    bool blocks = job.place.format->block;
    if (result)
        return result;
    if (blocks)
        result = begin_blocks(count, &job);
    if (!result)
        result =
            slvi_parallel_for(source->env, count, count > 512 ? 64 : count / 8 + 1, fill, &job);
    if (!result)
        send(&job, count);
    for (uint32_t i = 0; !result && blocks && i < count; i++)
        slvi_gl_block_error_add(error, &job.errors[i]);
    end_blocks(&job);
    return result;
}

slv_result slvi_gl_staging_scratch(const slv_gl_source *source, uint64_t values,
                                   slv_gl_staging *staging) {
    if (values <= staging->nscratch)
        return SLV_OK;
    slvi_free(staging->scratch);
    staging->scratch = NULL;
    staging->nscratch = 0;
    slv_result result = slvi_alloc_plain(&source->shared, "level", values, sizeof *staging->scratch,
                                         &staging->scratch);
    if (!result)
        staging->nscratch = values;
    return result;
}

/* Room for a level's floats where the form computes it. */
static slv_result make_scratch(const struct origin *from, const slv_gl_place *place,
                               slv_gl_staging *staging) {
    uint64_t values = (uint64_t)place->width * place->height *
                      slv_levels_get_desc(from->source->levels)->nchannels;
    return from->pools->form->computed ? slvi_gl_staging_scratch(from->source, values, staging)
                                       : SLV_OK;
}

bool slvi_gl_begins_run(const slv_gl_pools *pools, const slv_gl_pool *pool, uint32_t layer) {
    enum { RUN_BYTES = 1 << 18 }; /* which a processor's caches hold */
    uint64_t bytes = slvi_gl_layer_bytes(pools, pool);
    uint32_t longest = bytes < RUN_BYTES ? (uint32_t)(RUN_BYTES / bytes) : 1;
    return (pool->columns ? layer % pool->columns : layer) % longest == 0;
}

slv_result slvi_gl_upload_run(const slv_gl_source *source, const slv_gl_pools *pools,
                              const void *made, const slv_gl_pool *pool, uint32_t first,
                              uint32_t count, slv_gl_staging *staging, uint64_t *sent) {
    slv_result result = SLV_OK;
    for (uint32_t level = 0; !result && level < slv_gl_pool_levels(pools, pool); level++) {
        const slv_gl_layers layers = {pool, level, first, count};
        struct fill_job job;
        if ((result = begin_fill(source, pools, made, &layers, staging, &job)) ||
            (result = make_scratch(&job.from, &job.place, staging)))
            return result;
        for (uint32_t layer = 0; !result && layer < count; layer++)
            result = fill_layer(&job, layer, staging->scratch);
        if (result)
            return result;
        send(&job, count);
        *sent += slvi_gl_place_bytes(&job.place) * count;
    }
    return result;
}

/* The intersection of a place with the part of it that is sent, seen from the place's corner; and
 * where that is in the part. */
static slv_rect inside(const slv_gl_place *place, const slv_gl_place *part, size_t *at) {
    uint32_t x = part->x > place->x ? part->x : place->x;
    uint32_t y = part->y > place->y ? part->y : place->y;
    uint32_t end_x = part->x + part->width, end_y = part->y + part->height;
    end_x = end_x < place->x + place->width ? end_x : place->x + place->width;
    end_y = end_y < place->y + place->height ? end_y : place->y + place->height;
    *at = (size_t)(y - part->y) * part->width + (x - part->x);
    return (slv_rect){x - place->x, y - place->y, end_x - x, end_y - y};
}

slv_result slvi_gl_upload_rect(const slv_gl_source *source, const slv_gl_pools *pools,
                               const void *made, uint32_t item, uint32_t level,
                               const slv_rect *rect, slv_gl_staging *staging, uint64_t *sent) {
    slv_gl_place place = slvi_gl_place(pools, item, level);
    slv_rect all = {0, 0, place.width, place.height};
    slv_gl_place part = slvi_gl_place_part(&place, rect ? *rect : all);
    const slv_gl_format *format = place.format;
    struct origin from = {source, pools, made, format};
    uint64_t texels = (uint64_t)part.width * part.height, bytes = texels * format->texel_bytes;
    uint64_t blocks = format->block ? slvi_gl_place_bytes(&part) : 0;
    size_t at;
    slv_rect filled = inside(&place, &part, &at);
    slv_gl_block_error lost = {0};
    slv_result result = make_room(source->env, bytes + blocks + (blocks ? texels : 0), staging);
    if (result || (result = make_scratch(&from, &place, staging)))
        return result;
    unsigned char *stored = staging->memory, *used = stored + bytes + blocks;
    if (format->block) {
        memset(used, 0, texels);
        for (uint32_t y = 0; y < filled.height; y++)
            memset(used + at + (size_t)y * part.width, 1, filled.width);
    }
    if ((result = fill_level(&from, item, level, filled, staging->scratch,
                             stored + at * format->texel_bytes, part.width)))
        return result;
    if (format->block && (result = slvi_gl_compress(
                              &source->shared, format->block, format->ncomponents, format->nsource,
                              part.width, part.height, stored, used, stored + bytes, &lost)))
        return result;
    slvi_gl_place_send(source, &part, 1, format->block ? stored + bytes : stored);
    *sent += format->block ? blocks : bytes;
    return SLV_OK;
}

enum { LEAST_INSIDE = 256 }; /* texels that are left out only where there are more */

static bool is_large(const slv_form *form, slv_form_extent extent) {
    uint32_t x = extent.border_u + form->samples, width = extent.width;
    uint32_t y = extent.border_v + form->samples, height = extent.height;
    return width > 2 * x && height > 2 * y && (width - 2 * x) * (height - 2 * y) > LEAST_INSIDE;
}

bool slvi_gl_has_rim(const slv_gl_source *source, const slv_gl_pools *pools, const void *made,
                     uint32_t item) {
    const slv_form *form = pools->form;
    return form->read_rim && !pools->format.block &&
           is_large(form, slvi_gl_extent(source, form, form->res(made, item),
                                         slvi_gl_stored_level(pools, made, item, 0)));
}

/* The outermost texels of a level of an item, for what is in between is as it was. */
slv_result slvi_gl_upload_rim(const slv_gl_source *source, const slv_gl_pools *pools,
                              const void *made, uint32_t item, uint32_t number,
                              slv_gl_staging *staging, uint64_t *sent) {
    slv_gl_place place = slvi_gl_place(pools, item, number);
    struct origin from = {source, pools, made, place.format};
    struct level level;
    slv_form_extent extent = slvi_gl_extent(source, pools->form, pools->form->res(made, item),
                                            slvi_gl_stored_level(pools, made, item, number));
    uint32_t x = extent.border_u + pools->form->samples, width = extent.width;
    uint32_t y = extent.border_v + pools->form->samples, height = extent.height;
    slv_rect strips[4];
    if (!is_large(pools->form, extent))
        return slvi_gl_upload_rect(source, pools, made, item, number, NULL, staging, sent);
    cut_rim(pools->form, extent, strips);
    uint64_t most = (uint64_t)(width > height ? width : height) * (x > y ? x : y);
    slv_result result = make_room(source->env, most * place.format->texel_bytes, staging);
    if (result || (result = make_scratch(&from, &place, staging)) ||
        (result = read_level(&from, item, number, true, staging->scratch, &level)))
        return result;
    for (uint32_t i = 0; i < 4; i++) {
        slv_gl_place part = slvi_gl_place_part(&place, strips[i]);
        convert(&from, &level, strips[i], staging->memory, strips[i].width);
        slvi_gl_place_send(source, &part, 1, staging->memory);
        *sent += slvi_gl_place_bytes(&part);
    }
    return SLV_OK;
}
