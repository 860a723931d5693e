/* Comparing two files, whatever their types and resolutions. */
#include "ptx/format/ptx_file.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/progress.h"

#include <selvage/ptx_diff.h>

#include <math.h>

enum { GRAIN = 16 };

struct work {
    const slv_env *env;
    const slv_ptx *files[2];
    const slv_ptx_info *infos[2];
    slv_ptx_diff_params params;
    slv_face_diff *out;
    ptx_errors errors;
    slvi_steps steps;
};

/* One side of what a range of faces needs. */
struct side {
    slv_ptx_reader *reader;
    uint8_t *texels;
    float *values;
    uint64_t capacity;
};

static slv_result read_values(const slv_env *env, const slv_ptx *ptx, struct side *side,
                              uint32_t face, slv_res res) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    uint64_t count = (UINT64_C(1) << (res.u + res.v)) * info->nchannels;
    slv_result result;
    if (count > side->capacity) {
        slvi_free(side->texels);
        slvi_free(side->values);
        side->texels = NULL;
        side->values = NULL;
        side->capacity = 0;
        if ((result = slvi_alloc(env, "texels", count, slv_type_size(info->type), &side->texels)) ||
            (result = slvi_alloc(env, "texels", count, sizeof(float), &side->values)))
            return result;
        side->capacity = count;
    }
    if ((result = slv_ptx_reader_read(side->reader, face, res, side->texels)))
        return result;
    slv_type_to_float(info->type, side->texels, count, side->values);
    return SLV_OK;
}

static float difference(float a, float b) {
    if (a == b || (isnan(a) && isnan(b)))
        return 0;
    return isfinite(a) && isfinite(b) ? fabsf(a - b) : INFINITY;
}

static void compare_texels(const struct work *work, const struct side sides[2],
                           slv_face_diff *diff) {
    uint32_t na = work->infos[0]->nchannels, nb = work->infos[1]->nchannels;
    uint32_t channels = na < nb ? na : nb;
    uint64_t count = UINT64_C(1) << (diff->compared.u + diff->compared.v), finite = 0;
    double sum = 0;
    for (uint64_t i = 0; i < count; i++) {
        bool beyond = false;
        for (uint32_t c = 0; c < channels; c++) {
            float d = difference(sides[0].values[i * na + c], sides[1].values[i * nb + c]);
            beyond |= d > work->params.tolerance;
            if (isfinite(d)) {
                sum += (double)d;
                finite++;
            }
            if (d <= diff->largest)
                continue;
            diff->largest = d;
            diff->x = (uint32_t)(i & ((UINT64_C(1) << diff->compared.u) - 1));
            diff->y = (uint32_t)(i >> diff->compared.u);
            diff->channel = c;
        }
        diff->ndifferent += beyond;
    }
    diff->mean = finite ? sum / (double)finite : 0;
    if (diff->ndifferent)
        diff->what |= SLV_DIFF_TEXELS;
}

static int8_t smaller(int8_t a, int8_t b) {
    return a < b ? a : b;
}

static slv_result compare_face(const struct work *work, const slv_env *env, struct side sides[2],
                               uint32_t face) {
    slv_face_diff *diff = &work->out[face];
    slv_ptx_face faces[2];
    slv_result result;
    *diff = (slv_face_diff){.edge = -1};
    for (int i = 0; i < 2; i++) {
        if (face >= work->infos[i]->nfaces) {
            diff->what |= SLV_DIFF_MISSING;
            continue;
        }
        if ((result = slv_ptx_get_face(work->files[i], face, &faces[i])))
            return result;
        diff->res[i] = faces[i].res;
    }
    if (diff->what)
        return SLV_OK;
    diff->compared =
        (slv_res){smaller(faces[0].res.u, faces[1].res.u), smaller(faces[0].res.v, faces[1].res.v)};
    if (faces[0].res.u != faces[1].res.u || faces[0].res.v != faces[1].res.v)
        diff->what |= SLV_DIFF_RES;
    if ((faces[0].flags ^ faces[1].flags) & SLV_FACE_SUBFACE)
        diff->what |= SLV_DIFF_SUBFACE;
    for (int edge = 3; edge >= 0; edge--) {
        const slv_face_adjacency *a = &faces[0].adjacency, *b = &faces[1].adjacency;
        if (a->face[edge] != b->face[edge] ||
            (a->face[edge] >= 0 && a->edge[edge] != b->edge[edge])) {
            diff->what |= SLV_DIFF_ADJACENCY;
            diff->edge = edge;
        }
    }
    /* two constant faces need no more than one texel of each */
    slv_res res = diff->compared;
    if (faces[0].flags & faces[1].flags & SLV_FACE_CONSTANT)
        diff->compared = (slv_res){0, 0};
    for (int i = 0; i < 2; i++)
        if ((result = read_values(env, work->files[i], &sides[i], face, diff->compared)))
            return result;
    compare_texels(work, sides, diff);
    if (diff->ndifferent)
        diff->ndifferent <<= res.u + res.v - diff->compared.u - diff->compared.v;
    diff->compared = res;
    return SLV_OK;
}

static slv_result open_sides(const slv_env *env, const slv_ptx *const files[2],
                             struct side sides[2]) {
    slv_result result = SLV_OK;
    for (int i = 0; i < 2 && !result; i++)
        result = slv_ptx_reader_create(env, files[i], &sides[i].reader);
    return result;
}

static void close_sides(struct side sides[2]) {
    for (int i = 0; i < 2; i++) {
        slv_ptx_reader_destroy(sides[i].reader);
        slvi_free(sides[i].texels);
        slvi_free(sides[i].values);
    }
}

static slv_result compare_range(void *user, uint64_t first, uint64_t end) {
    struct work *work = user;
    struct side sides[2] = {0};
    ptx_range_log log;
    slv_env env = slvi_ptx_range_env(work->env, &work->errors, first, &log);
    slv_result result = open_sides(&env, work->files, sides);
    for (uint64_t face = first; face < end && !result; face++)
        result = compare_face(work, &env, sides, (uint32_t)face);
    if (!result)
        result = slvi_steps_add(&work->steps, &env, "comparison", end - first);
    close_sides(sides);
    return result;
}

static slv_result check_types(const slv_env *env, const slv_ptx *a, const slv_ptx *b) {
    if (slv_ptx_get_info(a)->mesh_type != slv_ptx_get_info(b)->mesh_type)
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "%s and %s: triangles cannot be compared with quads", slv_ptx_name(a),
                         slv_ptx_name(b));
    return SLV_OK;
}

slv_result slv_ptx_diff(const slv_env *env, const slv_ptx *a, const slv_ptx *b,
                        const slv_ptx_diff_params *params, slv_face_diff *out) {
    struct work work = {.env = env,
                        .files = {a, b},
                        .infos = {slv_ptx_get_info(a), slv_ptx_get_info(b)},
                        .out = out};
    slv_result result = check_types(env, a, b);
    if (result || (result = slv_ptx_load_tables(a)) || (result = slv_ptx_load_tables(b)))
        return result;
    if (params)
        work.params = *params;
    uint32_t nfaces = work.infos[0]->nfaces > work.infos[1]->nfaces ? work.infos[0]->nfaces
                                                                    : work.infos[1]->nfaces;
    slvi_steps_begin(&work.steps, work.params.progress, nfaces);
    result = slvi_ptx_parallel_for(env, &work.errors, nfaces, GRAIN, compare_range, &work);
    slvi_steps_end(&work.steps);
    return result;
}

slv_result slv_ptx_diff_texels(const slv_env *env, const slv_ptx *a, const slv_ptx *b,
                               uint32_t face, const slv_face_diff *diff, float *out) {
    const slv_ptx *const files[2] = {a, b};
    uint32_t na = slv_ptx_get_info(a)->nchannels, nb = slv_ptx_get_info(b)->nchannels;
    uint32_t channels = na < nb ? na : nb;
    struct side sides[2] = {0};
    slv_result result = check_types(env, a, b);
    if (result || (result = open_sides(env, files, sides)) ||
        (result = read_values(env, a, &sides[0], face, diff->compared)) ||
        (result = read_values(env, b, &sides[1], face, diff->compared)))
        goto done;
    for (uint64_t i = 0; i < UINT64_C(1) << (diff->compared.u + diff->compared.v); i++)
        for (uint32_t c = 0; c < channels; c++)
            out[i * channels + c] =
                difference(sides[0].values[i * na + c], sides[1].values[i * nb + c]);
done:
    close_sides(sides);
    return result;
}
