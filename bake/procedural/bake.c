/* Patterns evaluated at the texels of a surface, on several threads. */
#include "base/log.h"
#include "base/memory.h"
#include "base/names.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "procedural/pattern.h"

#include <string.h>

#define MAX_SAMPLES 64
#define MAX_CHANNELS 4
#define FACES_PER_RANGE 16
/* Points of one call to the surface; a texel of MAX_SAMPLES squared still fits. */
#define BATCH_POINTS (MAX_SAMPLES * MAX_SAMPLES)

struct batch {
    slv_surface_point points[BATCH_POINTS];
    float positions[3 * BATCH_POINTS];
    float values[MAX_CHANNELS * BATCH_POINTS];
};

struct bake {
    slv_env env;
    const slv_surface *surface;
    const slv_texture_desc *desc;
    slv_procedural pattern;
    uint32_t samples, first_face;
    slv_texture *texture;
    slvi_steps steps;
};

static uint64_t face_texels(slv_res res) {
    return UINT64_C(1) << (res.u + res.v);
}

static void keep_channels(const float rgba[4], uint32_t nchannels, float *out) {
    if (nchannels == 1)
        out[0] = 0.2126f * rgba[0] + 0.7152f * rgba[1] + 0.0722f * rgba[2];
    else
        memcpy(out, rgba, nchannels * sizeof *out);
}

/* Sample points of `count` texels from number `first` on, those of a texel together. */
static void place_samples(slv_surface_point *points, uint32_t face, slv_res res, uint32_t samples,
                          uint64_t first, uint64_t count) {
    float du = 1.0f / (float)(UINT64_C(1) << res.u), dv = 1.0f / (float)(UINT64_C(1) << res.v);
    float step = 1.0f / (float)samples;
    for (uint64_t i = first; i < first + count; i++) {
        uint64_t x = i & ((UINT64_C(1) << res.u) - 1), y = i >> res.u;
        for (uint32_t k = 0; k < samples * samples; k++) {
            float fx = ((float)(k % samples) + 0.5f) * step,
                  fy = ((float)(k / samples) + 0.5f) * step;
            *points++ = (slv_surface_point){
                .face = (int32_t)face, .u = ((float)x + fx) * du, .v = ((float)y + fy) * dv};
        }
    }
}

static void mean_of_samples(const struct bake *bake, uint32_t face, const float *positions,
                            uint64_t count, float *values) {
    uint32_t per_texel = bake->samples * bake->samples, nchannels = bake->desc->nchannels;
    for (uint64_t i = 0; i < count; i++) {
        float sum[4] = {0}, rgba[4];
        for (uint32_t k = 0; k < per_texel; k++, positions += 3) {
            slvi_pattern_evaluate(&bake->pattern, (int32_t)face, positions, rgba);
            for (int c = 0; c < 4; c++)
                sum[c] += rgba[c];
        }
        for (int c = 0; c < 4; c++)
            sum[c] /= (float)per_texel;
        keep_channels(sum, nchannels, values + i * nchannels);
    }
}

static slv_result bake_face(const struct bake *bake, uint32_t face, struct batch *batch,
                            char *texels) {
    const slv_texture_desc *desc = bake->desc;
    slv_res res = desc->res[face];
    uint64_t texel_size = slv_type_size(desc->type) * desc->nchannels;
    uint64_t total = face_texels(res), per_batch = BATCH_POINTS / (bake->samples * bake->samples);
    if (bake->pattern.pattern == SLV_PATTERN_FACE_COLOR) {
        static const float origin[3];
        float rgba[4];
        slvi_pattern_evaluate(&bake->pattern, (int32_t)face, origin, rgba);
        keep_channels(rgba, desc->nchannels, batch->values);
        slv_type_from_float(desc->type, batch->values, desc->nchannels, texels);
        return slv_texture_set_constant(bake->texture, face, texels);
    }
    for (uint64_t first = 0; first < total; first += per_batch) {
        uint64_t count = total - first < per_batch ? total - first : per_batch;
        place_samples(batch->points, face, res, bake->samples, first, count);
        slv_result result = slv_surface_evaluate(
            bake->surface, (size_t)(count * bake->samples * bake->samples), batch->points,
            &(slv_surface_arrays){.positions = batch->positions});
        if (result)
            return result;
        mean_of_samples(bake, face, batch->positions, count, batch->values);
        slv_type_from_float(desc->type, batch->values, (size_t)count * desc->nchannels,
                            texels + first * texel_size);
    }
    return slv_texture_set_face(bake->texture, face, texels);
}

static uint64_t largest_face(const slv_texture_desc *desc, uint64_t first, uint64_t end) {
    uint64_t most = 1;
    for (uint64_t i = first; i < end; i++)
        if (face_texels(desc->res[i]) > most)
            most = face_texels(desc->res[i]);
    return most * slv_type_size(desc->type) * desc->nchannels;
}

static slv_result bake_range(void *user, uint64_t first, uint64_t end) {
    struct bake *bake = user;
    struct batch *batch = NULL;
    char *texels = NULL;
    first += bake->first_face;
    end += bake->first_face;
    slv_result result = slvi_alloc(&bake->env, "bake: samples", 1, sizeof *batch, &batch);
    if (result)
        goto done;
    result =
        slvi_alloc(&bake->env, "bake: texels", largest_face(bake->desc, first, end), 1, &texels);
    for (uint64_t face = first; !result && face < end; face++)
        if (!(result = bake_face(bake, (uint32_t)face, batch, texels)))
            result = slvi_steps_add(&bake->steps, &bake->env, "bake", 1);
done:
    slvi_free(batch);
    slvi_free(texels);
    return result;
}

static const char *const patterns[] = {"stripes", "noise", "checker", "face-color", "position"};

const char *slv_pattern_name(slv_pattern pattern) {
    return slvi_name_of(patterns, SLVI_COUNT(patterns), (int)pattern);
}

bool slv_pattern_from_name(const char *name, slv_pattern *out) {
    int value = 0;
    bool found = slvi_name_find(patterns, SLVI_COUNT(patterns), name, &value);
    if (found)
        *out = (slv_pattern)value;
    return found;
}

slv_result slv_bake_procedural(const slv_env *env, const slv_surface *surface,
                               const slv_procedural *pattern, const slv_bake_params *params,
                               slv_texture *texture) {
    slv_bake_params p = params ? *params : (slv_bake_params){0};
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    uint32_t nfaces = slv_surface_face_count(surface);
    if (!p.samples)
        p.samples = 1;
    if (desc->nfaces != nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "bake: the surface has %u faces, the texture %u",
                         nfaces, desc->nfaces);
    if (p.samples > MAX_SAMPLES)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: %u samples a texel and axis, at most %d",
                         p.samples, MAX_SAMPLES);
    if (desc->nchannels > MAX_CHANNELS)
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED, "bake: %u channels, a pattern has at most %d",
                         desc->nchannels, MAX_CHANNELS);
    if ((int)pattern->pattern < SLV_PATTERN_STRIPES || pattern->pattern > SLV_PATTERN_POSITION)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: there is no pattern %d",
                         (int)pattern->pattern);
    if (p.first_face > nfaces || p.face_count > nfaces - p.first_face)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "bake: %u faces from face %u on, but there are %u", p.face_count,
                         p.first_face, nfaces);
    if (!p.face_count)
        p.face_count = nfaces - p.first_face;

    /* Checked here and not by each thread for itself, so that it is said once. */
    uint64_t limit = slvi_env_or_default(env).max_bytes;
    uint64_t most = largest_face(desc, p.first_face, (uint64_t)p.first_face + p.face_count);
    if (most > limit || sizeof(struct batch) > limit)
        return slvi_fail(env, SLV_ERROR_LIMIT,
                         "bake: a face of %llu bytes is over the limit of %llu",
                         (unsigned long long)most, (unsigned long long)limit);

    struct bake bake = {.surface = surface,
                        .desc = desc,
                        .pattern = slvi_pattern_resolve(pattern),
                        .samples = p.samples,
                        .first_face = p.first_face,
                        .texture = texture};
    slv_parallel_log *log = NULL;
    slv_result result = slvi_parallel_env_begin(env, &log, &bake.env);
    if (result)
        return result;
    slvi_steps_begin(&bake.steps, p.progress, p.face_count);
    result = slvi_parallel_for(env, p.face_count, FACES_PER_RANGE, bake_range, &bake);
    slvi_steps_end(&bake.steps);
    slvi_parallel_env_end(log);
    return result;
}
