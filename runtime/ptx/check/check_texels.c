/* Whether every face can be read, and whether its reductions are its own. */
#include "ptx/check/check.h"

#include "adjacency/edge.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/progress.h"

#include <math.h>
#include <string.h>

enum { GRAIN = 32 };

struct work {
    check_context *check;
    slvi_steps steps;
};

/* What a range of faces needs. */
struct reading {
    check_context *check;
    slv_ptx_reader *reader;
    check_log log;
    uint8_t *bytes[3]; /* the face or a reduction of it, the next one, the stored one */
    size_t capacity[3];
};

static slv_result reserve(struct reading *r, int buffer, uint64_t size) {
    if (size <= r->capacity[buffer])
        return SLV_OK;
    slvi_free(r->bytes[buffer]);
    r->bytes[buffer] = NULL;
    r->capacity[buffer] = 0;
    slv_result result = slvi_alloc(&r->check->env, "texels", size, 1, &r->bytes[buffer]);
    if (!result)
        r->capacity[buffer] = (size_t)size;
    return result;
}

static uint64_t texel_count(slv_res res) {
    return UINT64_C(1) << (res.u + res.v);
}

/* Deflate packs at most 1032 to 1: what cannot be true is not worth the memory to find out. */
static bool is_plausible(const slv_ptx_block *block, uint64_t bytes) {
    if (block->encoding == SLV_PTX_ZIPPED || block->encoding == SLV_PTX_DIFF_ZIPPED)
        return bytes / 1032 <= block->bytes;
    return true;
}

/* Reads a level of a face; a failure becomes a finding, and `*good` false. */
static slv_result read_level(struct reading *r, uint32_t face, uint32_t level, slv_res res,
                             int buffer, bool *good) {
    check_context *check = r->check;
    uint64_t bytes = texel_count(res) * check->pixel_size;
    slv_check_finding finding = {.kind = SLV_CHECK_TEXELS,
                                 .repairable = level > 0, /* made anew of the face itself */
                                 .face = (int32_t)face,
                                 .edge = -1,
                                 .level = (int32_t)level};
    slv_ptx_block block;
    *good = false;
    slv_result result = slv_ptx_get_block(check->ptx, face, level, &block);
    if (!result && block.stored && !is_plausible(&block, bytes)) {
        slvi_check_find(check->findings, &finding,
                        "face %u: %u bytes at level %u cannot hold %u x %u texels", face,
                        block.bytes, level, 1u << res.u, 1u << res.v);
        return SLV_OK;
    }
    if (!result && (result = reserve(r, buffer, bytes)))
        return result;
    if (!result)
        result = slv_ptx_reader_read(r->reader, face, res, r->bytes[buffer]);
    if (result && !slvi_check_is_of_file(result))
        return slvi_fail(&check->env, result, "%s: %s", slv_ptx_name(check->ptx), r->log.message);
    if (result)
        slvi_check_find(check->findings, &finding, "%s", r->log.message);
    *good = !result;
    return SLV_OK;
}

static void check_values(check_context *check, uint32_t face, const uint8_t *texels,
                         uint64_t count) {
    uint64_t bad = 0, nvalues = count * check->info->nchannels, first = 0;
    if (check->info->type != SLV_TYPE_HALF && check->info->type != SLV_TYPE_FLOAT)
        return;
    for (uint64_t i = nvalues; i-- > 0;) {
        bool finite = check->info->type == SLV_TYPE_HALF
                          ? (((const uint16_t *)(const void *)texels)[i] & 0x7c00) != 0x7c00
                          : isfinite(((const float *)(const void *)texels)[i]);
        bad += !finite;
        first = finite ? first : i;
    }
    slv_check_finding finding = {
        .kind = SLV_CHECK_VALUES, .warning = true, .face = (int32_t)face, .edge = -1, .level = -1};
    if (bad)
        slvi_check_find(
            check->findings, &finding,
            "face %u: %llu of %llu values are not finite, the first in texel %llu channel "
            "%llu",
            face, (unsigned long long)bad, (unsigned long long)nvalues,
            (unsigned long long)(first / check->info->nchannels),
            (unsigned long long)(first % check->info->nchannels));
}

static float largest_difference(const check_context *check, const uint8_t *a, const uint8_t *b,
                                uint64_t count, float *scale) {
    size_t value = slv_type_size(check->info->type);
    float worst = 0;
    *scale = 0;
    for (uint64_t i = 0; i < count * check->info->nchannels; i++) {
        float x, y;
        slv_type_to_float(check->info->type, a + i * value, 1, &x);
        slv_type_to_float(check->info->type, b + i * value, 1, &y);
        if (isfinite(x) && fabsf(x) > *scale)
            *scale = fabsf(x);
        if (x == y || (isnan(x) && isnan(y)))
            continue;
        float difference = isfinite(x) && isfinite(y) ? fabsf(x - y) : INFINITY;
        if (difference > worst)
            worst = difference;
    }
    return worst;
}

/* Other writers round otherwise, a unit or so each level. */
static float rounding(slv_type type, uint32_t level, float scale) {
    float steps = (float)level + 0.5f;
    switch (type) {
    case SLV_TYPE_U8:
        return steps / 255;
    case SLV_TYPE_U16:
        return steps / 65535;
    case SLV_TYPE_HALF:
        return steps * scale / 1024;
    case SLV_TYPE_FLOAT:
        break;
    }
    return steps * scale * 1e-5f;
}

/* Takes what neighbours have a say in out of a comparison. */
static void hide_rim(const check_context *check, slv_res res, const uint8_t *expected,
                     uint8_t *found) {
    size_t size = check->pixel_size, w = (size_t)1 << res.u, h = (size_t)1 << res.v;
    for (size_t y = 0; y < h; y++) {
        size_t row = y * w * size, step = y == 0 || y + 1 == h || w == 1 ? size : (w - 1) * size;
        for (size_t x = 0; x < w * size; x += step)
            memcpy(found + row + x, expected + row + x, size);
    }
}

static void compare(struct reading *r, uint32_t face, uint32_t level, const uint8_t *expected,
                    const uint8_t *found, uint64_t count, bool average) {
    check_context *check = r->check;
    float scale = 0, difference;
    if (memcmp(expected, found, count * check->pixel_size) == 0)
        return;
    difference = largest_difference(check, expected, found, count, &scale);
    if (difference <= rounding(check->info->type, average ? level + 2 : level, scale))
        return;
    slv_check_finding finding = {.kind = SLV_CHECK_REDUCTIONS,
                                 .repairable = true,
                                 .face = (int32_t)face,
                                 .edge = -1,
                                 .level = average ? -1 : (int32_t)level,
                                 .amount = difference};
    if (average)
        slvi_check_find(check->findings, &finding, "face %u: its average is off by %g", face,
                        (double)difference);
    else
        slvi_check_find(check->findings, &finding,
                        "face %u: its reduction at level %u is off by %g", face, level,
                        (double)difference);
}

static slv_result check_average(struct reading *r, uint32_t face, uint32_t level,
                                const uint8_t *texels, uint64_t count) {
    const slv_ptx_info *info = r->check->info;
    slv_result result = reserve(r, 2, 2 * (uint64_t)r->check->pixel_size);
    uint8_t *expected = r->bytes[2];
    if (result)
        return result;
    slv_ptx_average(info->type, info->nchannels, texels, count, expected);
    slv_ptx_unmultiply(info->type, info->nchannels, info->alpha_channel, expected, 1);
    uint8_t *found = expected + r->check->pixel_size;
    if ((result = slv_ptx_reader_read(r->reader, face, (slv_res){0, 0}, found)))
        return slvi_fail(&r->check->env, result, "%s: %s", slv_ptx_name(r->check->ptx),
                         r->log.message);
    compare(r, face, level, expected, found, 1, true);
    return SLV_OK;
}

/* The face itself is in buffer 0, as painted. */
static slv_result check_levels(struct reading *r, uint32_t face) {
    check_context *check = r->check;
    const slv_ptx_info *info = check->info;
    const slv_ptx_face *f = &check->faces[face];
    slv_res res = f->res;
    uint32_t level = 0;
    slv_result result = SLV_OK;
    slv_ptx_premultiply(info->type, info->nchannels, info->alpha_channel, r->bytes[0],
                        texel_count(res));
    while (!(f->flags & SLV_FACE_EDITED) && level + 1 < info->nlevels && res.u && res.v) {
        slv_ptx_block block;
        bool good;
        if (slv_ptx_get_block(check->ptx, face, level + 1, &block) || !block.stored)
            break;
        slv_res next = {(int8_t)(res.u - 1), (int8_t)(res.v - 1)};
        uint64_t count = texel_count(next);
        if ((result = reserve(r, 1, count * check->pixel_size)) ||
            (result = read_level(r, face, level + 1, next, 2, &good)))
            return result;
        slv_ptx_reduce(info->mesh_type, info->type, info->nchannels, res, r->bytes[0], r->bytes[1]);
        level++;
        if (good && check->seamless)
            hide_rim(check, next, r->bytes[1], r->bytes[2]);
        if (good)
            compare(r, face, level, r->bytes[1], r->bytes[2], count, false);
        uint8_t *swap = r->bytes[0];
        size_t capacity = r->capacity[0];
        r->bytes[0] = r->bytes[1];
        r->capacity[0] = r->capacity[1];
        r->bytes[1] = swap;
        r->capacity[1] = capacity;
        res = next;
    }
    return check_average(r, face, level, r->bytes[0], texel_count(res));
}

/* Keeps the texels along the edges, in the order of walking around the face counter-clockwise. */
static void keep_strips(check_context *check, uint32_t face, const uint8_t *texels, slv_res res) {
    bool triangle = check->info->mesh_type == SLV_PTX_TRIANGLE;
    size_t size = check->pixel_size, w = (size_t)1 << res.u, h = (size_t)1 << res.v;
    uint8_t *out = check->strips + check->strip_starts[face] * size;
    if (check->faces[face].flags & SLV_FACE_CONSTANT) {
        memcpy(out, texels, size);
        return;
    }
    for (unsigned edge = 0; edge < check->nedges; edge++) {
        size_t length = triangle || !slvi_edge_along_v(edge) ? w : h;
        for (size_t t = 0; t < length; t++, out += size) {
            int32_t x, y;
            if (triangle)
                slvi_edge_triangle_texel((int32_t)w, edge, (int32_t)t, &x, &y);
            else
                slvi_edge_texel((int32_t)w, (int32_t)h, edge, (int32_t)t, 0, &x, &y);
            memcpy(out, texels + ((size_t)y * w + (size_t)x) * size, size);
        }
    }
}

static slv_result check_face(struct reading *r, uint32_t face) {
    check_context *check = r->check;
    const slv_ptx_face *f = &check->faces[face];
    bool constant = f->flags & SLV_FACE_CONSTANT, good = false;
    slv_res res = constant ? (slv_res){0, 0} : f->res;
    slv_result result = read_level(r, face, 0, res, 0, &good);
    if (result)
        return result;
    if (!good) {
        if (check->unread)
            check->unread[face] = 1;
        return SLV_OK;
    }
    check_values(check, face, r->bytes[0], texel_count(res));
    if (check->strips)
        keep_strips(check, face, r->bytes[0], res);
    return constant ? SLV_OK : check_levels(r, face);
}

static slv_result check_range(void *user, uint64_t first, uint64_t end) {
    struct work *work = user;
    struct reading r = {.check = work->check};
    slv_env quiet = slvi_check_log_env(&work->check->env, &r.log, slv_ptx_name(work->check->ptx));
    slv_result result = slv_ptx_reader_create(&quiet, work->check->ptx, &r.reader);
    if (result)
        result = slvi_fail(&work->check->env, result, "%s: %s", slv_ptx_name(work->check->ptx),
                           r.log.message);
    for (uint64_t face = first; face < end && !result; face++)
        result = check_face(&r, (uint32_t)face);
    if (!result)
        result = slvi_steps_add(&work->steps, &work->check->env, slv_ptx_name(work->check->ptx),
                                end - first);
    slv_ptx_reader_destroy(r.reader);
    for (int i = 0; i < 3; i++)
        slvi_free(r.bytes[i]);
    return result;
}

static slv_result place_strips(check_context *check) {
    uint64_t total = 0;
    uint32_t nfaces = check->info->nfaces;
    slv_result result =
        slvi_alloc(&check->env, "edges", nfaces, sizeof *check->strip_starts, &check->strip_starts);
    if (result || (result = slvi_alloc(&check->env, "faces", nfaces, 1, &check->unread)))
        return result;
    for (uint32_t face = 0; face < nfaces; face++) {
        const slv_ptx_face *f = &check->faces[face];
        uint64_t w = UINT64_C(1) << f->res.u, h = UINT64_C(1) << f->res.v;
        check->strip_starts[face] = total;
        total += f->flags & SLV_FACE_CONSTANT ? 1 : check->nedges == 3 ? 3 * w : 2 * (w + h);
    }
    return slvi_alloc(&check->env, "texels along the edges", total, check->pixel_size,
                      &check->strips);
}

slv_result slvi_check_texels(check_context *check) {
    struct work work = {.check = check};
    slv_parallel_log *log = NULL;
    slv_env caller = check->env;
    check->seamless = slv_ptx_find_meta(check->ptx, SLV_PTX_REDUCTIONS_KEY) != NULL;
    slv_result result = check->params.seams ? place_strips(check) : SLV_OK;
    if (result || (result = slvi_parallel_env_begin(&caller, &log, &check->env)))
        return result;
    slvi_steps_begin(&work.steps, check->params.progress, check->info->nfaces);
    result = slvi_parallel_for(&caller, check->info->nfaces, GRAIN, check_range, &work);
    slvi_steps_end(&work.steps);
    check->env = caller;
    slvi_parallel_env_end(log);
    return result;
}
