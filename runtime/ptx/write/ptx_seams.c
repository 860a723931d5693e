/* Faces that agree where they meet: their texels wait until all are known, and are packed then. */
#include "ptx/write/ptx_write.h"

#include "base/beside.h"
#include "base/file.h"
#include "base/log.h"
#include "base/names.h"
#include "form/seamless/rims.h"
#include "texture/levels.h"
#include "texture/reduce.h"

#include <errno.h>
#include <sys/mman.h>
#include <unistd.h>

#define BLOCK (UINT64_C(32) << 20) /* bytes after which pages of the file are let go */

const char *slv_ptx_seams_name(slv_ptx_seams seams) {
    static const char *const names[] = {"plain", "seamless", "all"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)seams);
}

slv_result slvi_ptx_seams_begin(slv_ptx_writer *writer) {
    slv_result result = slvi_alloc(&writer->env, writer->path, writer->params.nfaces,
                                   sizeof *writer->seams.positions, &writer->seams.positions);
    return result ? result
                  : slvi_beside_nameless(&writer->env, writer->path, writer->spill_path,
                                         &writer->seams.descriptor);
}

void slvi_ptx_seams_end(slv_ptx_writer *writer) {
    if (writer->seams.descriptor >= 0)
        close(writer->seams.descriptor);
    slvi_free(writer->seams.positions);
}

static uint64_t chain_texels(slv_res res) {
    uint64_t texels = 0;
    for (uint32_t level = 0; level < slv_res_level_count(res); level++)
        texels += ptx_texel_count(slv_res_level(res, level));
    return texels;
}

/* The levels behind the first, to 1x1, by the format's arithmetic. */
static void reduce_all(const slv_ptx_writer_params *p, size_t size, slv_res res,
                       const uint8_t *from, uint8_t *to) {
    for (uint32_t level = 1; level < slv_res_level_count(res); level++) {
        slv_res above = slv_res_level(res, level - 1), now = slv_res_level(res, level);
        slv_halving along = above.u == now.u   ? SLV_HALVE_V
                            : above.v == now.v ? SLV_HALVE_U
                                               : SLV_HALVE_BOTH;
        slvi_halve(p->type, p->nchannels, along, (size_t)1 << above.u, (size_t)1 << above.v, from,
                   to);
        from = to;
        to += ptx_texel_count(now) * size;
    }
}

/* Of several threads that cannot write the first one says why. */
static slv_result keep_bytes(slv_ptx_writer *writer, const slv_env *env, const void *bytes,
                             uint64_t size, uint64_t at) {
    slv_env quiet = {.max_bytes = env->max_bytes};
    slv_result result =
        slvi_write_at(&quiet, writer->path, writer->seams.descriptor, bytes, size, at);
    int reason = errno;
    if (result && !atomic_exchange(&writer->failed, true))
        return slvi_fail(env, result, "%s: write failed: %s", writer->path, strerror(reason));
    return result;
}

/* Behind texels with alpha lie the same multiplied by it, which is what averages are made of. */
slv_result slvi_ptx_seams_keep(slv_ptx_writer *writer, ptx_packer *packer, uint32_t face,
                               slv_res res, const void *texels) {
    const slv_ptx_writer_params *p = &writer->params;
    bool alpha = p->alpha_channel >= 0;
    uint64_t count = ptx_texel_count(res), bytes = count * writer->pixel_size;
    uint64_t rest = (chain_texels(res) - (alpha ? 0 : count)) * writer->pixel_size;
    ptx_bytes *work = packer->work;
    slv_result result;
    work[0].size = 0;
    if ((result = slvi_ptx_bytes_reserve(packer->env, packer->path, &work[0], rest)))
        return result;
    if (alpha) {
        memcpy(work[0].data, texels, (size_t)bytes);
        slv_ptx_premultiply(p->type, p->nchannels, p->alpha_channel, work[0].data, count);
        reduce_all(p, writer->pixel_size, res, work[0].data, work[0].data + bytes);
    } else {
        reduce_all(p, writer->pixel_size, res, texels, work[0].data);
    }
    pthread_mutex_lock(&writer->lock);
    uint64_t at = writer->seams.size;
    writer->seams.size += bytes + rest;
    pthread_mutex_unlock(&writer->lock);
    writer->seams.positions[face] = at;
    result = keep_bytes(writer, packer->env, texels, bytes, at);
    return result ? result : keep_bytes(writer, packer->env, work[0].data, rest, at + bytes);
}

/* ---- when all faces are known ---- */

typedef struct packing {
    slv_ptx_writer *writer;
    slv_levels *levels;
    slv_adjacency *adjacency;
    uint8_t *map, *multiplied; /* the file; colours of constant faces multiplied by alpha */
    uint32_t first;            /* face of a stretch */
} packing;

static bool is_constant(const slv_ptx_writer *writer, uint32_t face, slv_ptx_face *out) {
    slvi_ptx_unpack_record(writer->records + (size_t)face * PTX_FACE_INFO_SIZE, false, out);
    return out->flags & SLV_FACE_CONSTANT;
}

static void plain_level(const packing *p, uint32_t face, uint32_t level, uint8_t *out) {
    const slv_levels *levels = p->levels;
    uint64_t count = ptx_texel_count(slv_res_level(levels->res[face], level));
    const uint8_t *plain = slv_levels_texels(levels, face, level);
    if (levels->kind[face] & SLVI_LEVELS_SINGLE)
        slvi_fill_texels(out, plain, levels->texel_size, count);
    else
        memcpy(out, plain, (size_t)count * levels->texel_size);
}

/* Level 0 with alpha: colours agree multiplied by it, and those that are as they were stay as
 * painted. */
static slv_result fill_painted(const packing *p, ptx_packer *packer, uint32_t face, uint8_t *out) {
    const slv_ptx_writer *writer = p->writer;
    const slv_ptx_writer_params *params = &writer->params;
    slv_res res = p->levels->res[face];
    size_t size = writer->pixel_size, w = (size_t)1 << res.u, h = (size_t)1 << res.v;
    bool single = p->levels->kind[face] & SLVI_LEVELS_SINGLE;
    const uint8_t *was = slv_levels_texels(p->levels, face, 0);
    packer->work[1].size = 0;
    slv_result result =
        slvi_ptx_bytes_reserve(packer->env, packer->path, &packer->work[1], w * h * size);
    if (result)
        return result;
    uint8_t *agreed = packer->work[1].data;
    plain_level(p, face, 0, agreed);
    slvi_rims_agree(p->levels, p->adjacency, face, 0, agreed);
    if (single)
        slvi_fill_texels(out, writer->constants + face * size, size, w * h);
    else
        memcpy(out, p->map + writer->seams.positions[face], w * h * size);
    for (size_t i = 0; i < w * h; i++) {
        if (memcmp(agreed + i * size, was + (single ? 0 : i * size), size) == 0)
            continue;
        memcpy(out + i * size, agreed + i * size, size);
        slv_ptx_unmultiply(params->type, params->nchannels, params->alpha_channel, out + i * size,
                           1);
    }
    return SLV_OK;
}

/* A level of a face as it is to be stored. */
static slv_result fill_level(const packing *p, ptx_packer *packer, uint32_t face, uint32_t level,
                             uint8_t *out) {
    const slv_ptx_writer *writer = p->writer;
    if (!level && writer->params.alpha_channel >= 0 && writer->params.seams == SLV_PTX_SEAMS_ALL)
        return fill_painted(p, packer, face, out);
    if (!level && writer->params.alpha_channel >= 0) /* constant faces stay: never single */
        memcpy(out, p->map + writer->seams.positions[face],
               (size_t)ptx_texel_count(p->levels->res[face]) * writer->pixel_size);
    else
        plain_level(p, face, level, out);
    if (level || writer->params.seams == SLV_PTX_SEAMS_ALL)
        slvi_rims_agree(p->levels, p->adjacency, face, level, out);
    return SLV_OK;
}

/* The mean of the texels at full resolution as they are stored. */
static slv_result average(const packing *p, ptx_packer *packer, uint32_t face,
                          const uint8_t *texels) {
    slv_ptx_writer *writer = p->writer;
    const slv_ptx_writer_params *params = &writer->params;
    uint8_t *out = writer->constants + face * writer->pixel_size;
    uint64_t count = ptx_texel_count(p->levels->res[face]), bytes = count * writer->pixel_size;
    if (params->alpha_channel >= 0) {
        packer->work[1].size = 0;
        slv_result result =
            slvi_ptx_bytes_reserve(packer->env, packer->path, &packer->work[1], bytes);
        if (result)
            return result;
        memcpy(packer->work[1].data, texels, (size_t)bytes);
        texels = packer->work[1].data;
        slv_ptx_premultiply(params->type, params->nchannels, params->alpha_channel,
                            packer->work[1].data, count);
    }
    slv_ptx_average(params->type, params->nchannels, texels, count, out);
    slv_ptx_unmultiply(params->type, params->nchannels, params->alpha_channel, out, 1);
    return SLV_OK;
}

/* Whether a face, of which `texels` are level 0, is constant as it is stored: its reductions, of
 * which none would be stored then, can agree with neighbours in what level 0 does not. */
static slv_result find_constant(const packing *p, ptx_packer *packer, uint32_t face,
                                uint8_t *texels, bool *constant) {
    const slv_ptx_writer *writer = p->writer;
    slv_res res = p->levels->res[face];
    bool single = slvi_texels_equal(texels, writer->pixel_size, ptx_texel_count(res));
    slv_result result = SLV_OK;
    *constant = single;
    for (uint32_t level = 1; *constant && !result && !writer->params.no_reductions &&
                             ptx_min_log2(slv_res_level(res, level - 1)) > 2;
         level++) {
        result = fill_level(p, packer, face, level, texels);
        *constant = slvi_texels_equal(texels, writer->pixel_size,
                                      ptx_texel_count(slv_res_level(res, level)));
    }
    return result || !single ? result : fill_level(p, packer, face, 0, texels);
}

static slv_result pack_levels(packing *p, ptx_packer *packer, uint32_t face, bool *constant) {
    slv_ptx_writer *writer = p->writer;
    slv_res res = p->levels->res[face];
    slv_result result;
    packer->work[0].size = packer->out.size = 0;
    if ((result = slvi_ptx_bytes_reserve(packer->env, packer->path, &packer->work[0],
                                         ptx_texel_count(res) * writer->pixel_size)))
        return result;
    uint8_t *texels = packer->work[0].data;
    for (uint32_t level = 0;; level++) {
        slv_res now = slv_res_level(res, level);
        if ((result = fill_level(p, packer, face, level, texels)))
            return result;
        if (!level && (result = find_constant(p, packer, face, texels, constant)))
            return result;
        if (*constant) { /* what is stored of it; its reductions are the same */
            memcpy(writer->constants + face * writer->pixel_size, texels, writer->pixel_size);
            return SLV_OK;
        }
        if ((result = slvi_ptx_pack(packer, face, texels, now, &writer->headers[level][face])))
            return result;
        if (!level && (result = average(p, packer, face, texels)))
            return result;
        if (writer->params.no_reductions || ptx_min_log2(now) <= 2)
            break;
    }
    return slvi_ptx_spill_append(&writer->spill, packer->env, packer->out.data, packer->out.size,
                                 &writer->positions[face]);
}

/* Whether a constant face is to agree with nothing but what it is. */
static bool stays(const packing *p, uint32_t face) {
    return p->levels->kind[face] & SLVI_LEVELS_STAYS;
}

static slv_result pack_faces(void *user, uint64_t first, uint64_t end) {
    packing *p = user;
    slv_ptx_writer *writer = p->writer;
    const slv_env *env = &writer->env;
    slv_result result = SLV_OK;
    for (uint64_t i = first; i < end && !result; i++) {
        uint32_t face = p->first + (uint32_t)i;
        slv_ptx_face info;
        ptx_packer *packer = NULL;
        bool constant = is_constant(writer, face, &info);
        if (!stays(p, face) && !(result = slvi_ptx_writer_take(writer, env, &packer)))
            result = pack_levels(p, packer, face, &constant);
        slvi_ptx_writer_give(writer, packer);
        info.flags =
            (uint8_t)((info.flags & ~SLV_FACE_CONSTANT) | (constant ? SLV_FACE_CONSTANT : 0));
        slvi_ptx_pack_record(&info, writer->records + (size_t)face * PTX_FACE_INFO_SIZE);
        if (!result)
            result = slvi_steps_add(&writer->steps, env, writer->path, 1);
    }
    return result;
}

static slv_result link_faces(packing *p) {
    slv_ptx_writer *writer = p->writer;
    uint32_t n = writer->params.nfaces;
    slv_face_adjacency *faces = NULL;
    uint8_t *flags = NULL;
    slv_result result = slvi_alloc(&writer->env, writer->path, n, sizeof *faces, &faces);
    if (!result)
        result = slvi_alloc(&writer->env, writer->path, n, 1, &flags);
    for (uint32_t face = 0; face < n && !result; face++) {
        slv_ptx_face info;
        is_constant(writer, face, &info);
        if (writer->links) {
            info.adjacency = writer->links[face].adjacency;
            info.flags = writer->links[face].flags;
        }
        faces[face] = info.adjacency;
        flags[face] = info.flags & SLV_FACE_SUBFACE;
    }
    if (!result)
        result = slv_adjacency_create(&writer->env, n, faces, flags, &p->adjacency);
    slvi_free(faces);
    slvi_free(flags);
    return result;
}

/* A chain of levels that lies in the file, and in the table of constant faces. */
static slv_result lay_levels(packing *p) {
    slv_ptx_writer *writer = p->writer;
    const slv_ptx_writer_params *params = &writer->params;
    const slv_env *env = &writer->env;
    uint32_t n = params->nfaces;
    slv_res *res = NULL;
    slv_result result = slvi_alloc(env, writer->path, n, sizeof *res, &res);
    slv_ptx_face info;
    for (uint32_t face = 0; face < n && !result; face++) {
        is_constant(writer, face, &info);
        res[face] = info.res;
    }
    const slv_texture_desc desc = {n,   params->type,      params->nchannels, params->alpha_channel,
                                   res, SLV_TEXTURE_LINEAR};
    if (result || (result = slvi_levels_lay(env, &desc, writer->constants, &p->levels)) ||
        (result = slvi_levels_kinds(p->levels)) ||
        (result = slvi_alloc(env, writer->path, n, writer->pixel_size, &p->multiplied)))
        goto done;
    if (n)
        memcpy(p->multiplied, writer->constants, n * writer->pixel_size);
    slv_ptx_premultiply(params->type, params->nchannels, params->alpha_channel, p->multiplied, n);
    for (uint32_t face = 0; face < n; face++) {
        if (!is_constant(writer, face, &info)) {
            uint64_t painted = params->alpha_channel >= 0 ? ptx_texel_count(info.res) : 0;
            slvi_levels_put(p->levels, face,
                            p->map + writer->seams.positions[face] + painted * writer->pixel_size,
                            false);
            continue;
        }
        slvi_levels_put(p->levels, face, p->multiplied + face * writer->pixel_size, true);
        if (params->seams == SLV_PTX_SEAMS_REDUCTIONS)
            p->levels->kind[face] |= SLVI_LEVELS_STAYS;
    }
done:
    slvi_free(res);
    return result;
}

/* Faces in stretches: behind each, pages of the file are given back, so that no more of them count
 * as memory than a stretch reads. */
static slv_result pack_all(packing *p) {
    slv_ptx_writer *writer = p->writer;
    uint32_t n = writer->params.nfaces;
    slv_result result = SLV_OK;
    for (uint32_t first = 0, end; first < n && !result; first = end) {
        uint64_t bytes = 0;
        for (end = first; end < n && (end == first || bytes < BLOCK); end++)
            bytes += chain_texels(p->levels->res[end]) * writer->pixel_size;
        p->first = first;
        result = slvi_parallel_for(&writer->env, end - first, 1, pack_faces, p);
        if (p->map)
            madvise(p->map, (size_t)writer->seams.size, MADV_DONTNEED);
    }
    return result;
}

slv_result slvi_ptx_seams_pack(slv_ptx_writer *writer) {
    const slv_ptx_meta note = {SLV_PTX_REDUCTIONS_KEY, SLV_META_STRING, 8, "seamless"};
    packing p = {.writer = writer};
    slv_result result = SLV_OK;
    if (!writer->params.no_reductions && (result = slvi_ptx_writer_keep_meta(writer, &note)))
        return result;
    writer->steps.total += writer->params.nfaces;
    if (writer->seams.size) {
        void *map = mmap(NULL, (size_t)writer->seams.size, PROT_READ, MAP_SHARED,
                         writer->seams.descriptor, 0);
        if (map == MAP_FAILED)
            return slvi_fail(&writer->env, SLV_ERROR_MEMORY,
                             "%s: no room to look at %llu bytes of texels", writer->path,
                             (unsigned long long)writer->seams.size);
        p.map = map;
    }
    if (!(result = link_faces(&p)) && !(result = lay_levels(&p)))
        result = pack_all(&p);
    slv_levels_destroy(p.levels);
    slv_adjacency_destroy(p.adjacency);
    slvi_free(p.multiplied);
    if (p.map)
        munmap(p.map, (size_t)writer->seams.size);
    return result;
}
