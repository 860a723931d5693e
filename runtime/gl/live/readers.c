/* Threads that read levels of faces: means of all texels of level 0, as the levels of the whole
 * texture would be. */
#include "gl/live/residency.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <string.h>

#define TILE (UINT64_C(1) << 18) /* texels that are read at once to make means of them */

static uint32_t log2_of(uint32_t size) {
    uint32_t log2 = 0;
    while (size >> log2 > 1)
        log2++;
    return log2;
}

/* A level of a piece that lies on whole texels of it; the piece as the source has it, or as the
 * store has. */
static slv_result reduce(const slvi_readers *readers, bool of_source, slv_res res,
                         const void *texels, uint32_t level, void *out) {
    slv_texture_desc desc = *readers->desc;
    slv_texture *piece = NULL, *light = NULL;
    slv_levels *levels = NULL;
    desc.nfaces = 1;
    desc.res = &res;
    if (of_source && readers->encoded) {
        desc.type = readers->type;
        desc.encoding = SLV_TEXTURE_SRGB;
    }
    slv_result result = slv_texture_create(&readers->env, &desc, &piece);
    if (!result)
        result = slv_texture_set_face(piece, 0, texels);
    if (!result)
        result = slv_texture_decode(&readers->env, piece, desc.encoding, &light);
    if (!result)
        result = slv_levels_create_over(&readers->env, light ? light : piece, &levels);
    if (!result)
        memcpy(out, slv_levels_texels(levels, 0, level),
               slvi_texels_in(slv_res_level(res, level)) * desc.nchannels *
                   slv_type_size(readers->desc->type));
    slv_levels_destroy(levels);
    slv_texture_destroy(light);
    slv_texture_destroy(piece);
    return result;
}

/* What is at hand of a face. */
struct piece {
    const slvi_readers *readers;
    uint32_t face;
    slv_res full;
    size_t texel; /* bytes of the store */
};

static slv_result read_tile(const struct piece *piece, uint32_t level, slv_rect all,
                            unsigned char *out) {
    const slvi_readers *readers = piece->readers;
    const slv_source *source = &readers->source;
    slv_res res = {(int8_t)log2_of(all.width), (int8_t)log2_of(all.height)};
    void *texels = NULL;
    slv_result result =
        slvi_alloc_plain(&readers->env, "texels of a face", slvi_texels_in(res),
                         readers->desc->nchannels * slv_type_size(readers->type), &texels);
    if (!result)
        result = source->fns->read(source->user, piece->face, piece->full, all, texels);
    if (!result)
        result = reduce(readers, true, res, texels, level, out);
    slvi_free(texels);
    return result;
}

/* A rectangle of a level: from level 0 at once if that is little, else in two halves, or,
 * of a single texel, from the level above. */
static slv_result fill(const struct piece *piece, uint32_t level, slv_rect rect,
                       unsigned char *out) {
    slv_res res = slv_res_level(piece->full, level);
    uint32_t u = (uint32_t)(piece->full.u - res.u), v = (uint32_t)(piece->full.v - res.v);
    uint64_t count = (uint64_t)rect.width * rect.height;
    slv_rect half = rect;
    slv_result result;
    if (count << (u + v) <= TILE)
        return read_tile(piece, level,
                         (slv_rect){rect.x << u, rect.y << v, rect.width << u, rect.height << v},
                         out);
    if (count > 1) { /* rows lie one behind the other, and so do these */
        if (rect.height > 1)
            half.height /= 2;
        else
            half.width /= 2;
        if ((result = fill(piece, level, half, out)))
            return result;
        half.x = rect.x + rect.width - half.width;
        half.y = rect.y + rect.height - half.height;
        return fill(piece, level, half, out + count / 2 * piece->texel);
    }
    slv_res above = slv_res_level(piece->full, level - 1); /* a single texel is no level 0 */
    u = (uint32_t)(above.u - res.u);
    v = (uint32_t)(above.v - res.v);
    unsigned char *four = NULL;
    if ((result =
             slvi_alloc_plain(&piece->readers->env, "texels of a face", 4, piece->texel, &four)))
        return result;
    result = fill(piece, level - 1, (slv_rect){rect.x << u, rect.y << v, 1u << u, 1u << v}, four);
    if (!result)
        result = reduce(piece->readers, false, (slv_res){(int8_t)u, (int8_t)v}, four, 1, out);
    slvi_free(four);
    return result;
}

slv_result slvi_readers_read(const slvi_readers *readers, uint32_t face, slv_res full,
                             uint32_t level, void *out) {
    const slv_source *source = &readers->source;
    slv_res res = slv_res_level(full, level);
    slv_rect all = {0, 0, 1u << res.u, 1u << res.v};
    struct piece piece = {readers, face, full,
                          readers->desc->nchannels * slv_type_size(readers->desc->type)};
    if (level == 0 && !readers->encoded)
        return source->fns->read(source->user, face, full, all, out);
    return fill(&piece, level, all, out);
}

slv_result slvi_readers_read_rough(const slvi_readers *readers, uint32_t face, slv_res res,
                                   void *out) {
    const slv_source *source = &readers->source;
    slv_rect all = {0, 0, 1u << res.u, 1u << res.v};
    void *texels = NULL;
    if (!readers->encoded)
        return source->fns->read(source->user, face, res, all, out);
    slv_result result =
        slvi_alloc_plain(&readers->env, "texels of a face", slvi_texels_in(res),
                         readers->desc->nchannels * slv_type_size(readers->type), &texels);
    if (!result)
        result = source->fns->read(source->user, face, res, all, texels);
    if (!result)
        result = reduce(readers, true, res, texels, 0, out);
    slvi_free(texels);
    return result;
}

slv_result slvi_readers_coarsen(const slvi_readers *readers, const slv_texture *store,
                                uint32_t face, uint32_t level, void *out) {
    const slv_texture_desc *desc = readers->desc;
    slv_res res = desc->res[face];
    uint64_t count = slvi_texels_in(slv_res_level(res, level));
    size_t size = desc->nchannels * slv_type_size(desc->type);
    const void *texels = slv_texture_texels(store, face);
    if (!slv_texture_is_constant(store, face))
        return reduce(readers, false, res, texels, level, out);
    for (uint64_t i = 0; i < count; i++)
        memcpy((unsigned char *)out + i * size, texels, size);
    return SLV_OK;
}

static slvi_load *next_load(slvi_readers *readers) {
    for (uint32_t i = 0; i < SLVI_LOADS; i++)
        if (readers->loads[i].state == SLVI_LOAD_WAITING)
            return &readers->loads[i];
    return NULL;
}

static void *work(void *user) {
    slvi_readers *readers = user;
    pthread_mutex_lock(&readers->lock);
    while (!readers->stop) {
        slvi_load *load = next_load(readers);
        if (!load) {
            pthread_cond_wait(&readers->more, &readers->lock);
            continue;
        }
        load->state = SLVI_LOAD_READING;
        pthread_mutex_unlock(&readers->lock);
        slv_result result =
            slvi_alloc_plain(&readers->env, "texels of a face", load->bytes, 1, &load->texels);
        if (!result)
            result = slvi_readers_read(readers, load->face, load->full, load->level, load->texels);
        pthread_mutex_lock(&readers->lock);
        load->state = result ? SLVI_LOAD_FAILED : SLVI_LOAD_READ;
    }
    pthread_mutex_unlock(&readers->lock);
    return NULL;
}

slv_result slvi_readers_begin(uint32_t count, slvi_readers *readers) {
    pthread_mutex_init(&readers->lock, NULL);
    pthread_cond_init(&readers->more, NULL);
    readers->begun = true;
    while (readers->nthreads < count &&
           slvi_thread_start(&readers->threads[readers->nthreads], work, readers) == 0)
        readers->nthreads++;
    return readers->nthreads ? SLV_OK
                             : slvi_fail(&readers->env, SLV_ERROR_MEMORY,
                                         "no thread could be started to read texels");
}

void slvi_readers_end(slvi_readers *readers) {
    if (readers->begun) {
        pthread_mutex_lock(&readers->lock);
        readers->stop = true;
        pthread_cond_broadcast(&readers->more);
        pthread_mutex_unlock(&readers->lock);
        while (readers->nthreads)
            pthread_join(readers->threads[--readers->nthreads], NULL);
        pthread_cond_destroy(&readers->more);
        pthread_mutex_destroy(&readers->lock);
    }
    for (uint32_t i = 0; i < SLVI_LOADS; i++)
        slvi_free(readers->loads[i].texels);
    slv_source_close(&readers->source);
}
