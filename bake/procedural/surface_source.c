/* What the surface itself is: where it lies, which way it faces, which face it is. */
#include "source/source.h"

#include "base/log.h"
#include "base/memory.h"

#include <math.h>

enum { SIDE = 2, EACH = SIDE * SIDE, AT_ONCE = 256 };

typedef struct surface_source {
    slv_bake_source base;
    const slv_surface *surface;
    slv_bake_surface_kind kind;
} surface_source;

typedef struct points {
    slv_surface_point at[AT_ONCE * EACH];
    float positions[AT_ONCE * EACH][3], normals[AT_ONCE * EACH][3], du[AT_ONCE * EACH][3],
        dv[AT_ONCE * EACH][3];
} points;

static float length_of_cross(const float a[3], const float b[3]) {
    float sum = 0;
    for (int k = 0; k < 3; k++) {
        float c = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
        sum += c * c;
    }
    return sqrtf(sum);
}

static float dot(const float a[3], const float b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Half the trace of the shape operator, from how normals differ between the samples of a texel. */
static float curvature_of(const points *work, uint32_t first, slv_res res) {
    float du[3] = {0}, dv[3] = {0}, nu[3], nv[3];
    const float(*n)[3] = (const float(*)[3])work->normals + first;
    for (int c = 0; c < 3; c++) {
        for (uint32_t k = 0; k < EACH; k++) {
            du[c] += work->du[first + k][c] / EACH;
            dv[c] += work->dv[first + k][c] / EACH;
        }
        nu[c] = (n[1][c] - n[0][c] + n[3][c] - n[2][c]) * (float)(1u << res.u);
        nv[c] = (n[2][c] - n[0][c] + n[3][c] - n[1][c]) * (float)(1u << res.v);
    }
    float e = dot(du, du), f = dot(du, dv), g = dot(dv, dv), area = e * g - f * f;
    float l = dot(nu, du), m = 0.5f * (dot(nu, dv) + dot(nv, du)), k = dot(nv, dv);
    return area > 0 ? (e * k - 2 * f * m + g * l) / (2 * area) : 0;
}

static void add_samples(const float samples[EACH][3], float sum[3]) {
    for (uint32_t k = 0; k < EACH; k++)
        for (int c = 0; c < 3; c++)
            sum[c] += samples[k][c];
}

static void mean_of(const surface_source *s, const points *work, uint32_t texel, slv_res res,
                    float *out) {
    float sum[3] = {0};
    switch (s->kind) {
    case SLV_BAKE_POSITION:
        add_samples(work->positions + (size_t)texel * EACH, sum);
        for (int c = 0; c < 3; c++)
            out[c] = sum[c] / EACH;
        break;
    case SLV_BAKE_NORMAL: {
        add_samples(work->normals + (size_t)texel * EACH, sum);
        float length = sqrtf(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
        for (int c = 0; c < 3; c++)
            out[c] = length > 0 ? sum[c] / length : 0;
        break;
    }
    case SLV_BAKE_FACE_ID:
        break; /* the same everywhere */
    case SLV_BAKE_CURVATURE:
        out[0] = curvature_of(work, texel * EACH, res);
        break;
    case SLV_BAKE_DENSITY: {
        float area = 0;
        for (uint32_t k = texel * EACH; k < (texel + 1) * EACH; k++)
            area += length_of_cross(work->du[k], work->dv[k]) / EACH;
        out[0] = area > 0 ? sqrtf((float)(UINT64_C(1) << (res.u + res.v)) / area) : 0;
        break;
    }
    }
}

static slv_result evaluate(const slv_bake_source *source, const slv_env *env, uint32_t face,
                           slv_res res, slv_rect rect, float *values, uint8_t *misses) {
    const surface_source *s = (const surface_source *)source;
    uint32_t n = s->base.desc.nchannels, total = rect.width * rect.height;
    const slv_bake_surface_kind kind = s->kind;
    points *work = NULL;
    (void)misses; /* a surface is everywhere */
    for (uint32_t i = 0; i < total && kind == SLV_BAKE_FACE_ID; i++)
        values[i] = (float)face;
    if (kind == SLV_BAKE_FACE_ID)
        return SLV_OK;
    slv_result result = slvi_alloc_plain(env, "bake: samples", 1, sizeof *work, &work);
    for (uint32_t first = 0; first < total && !result; first += AT_ONCE) {
        uint32_t count = total - first < AT_ONCE ? total - first : AT_ONCE;
        for (uint32_t i = 0; i < count * EACH; i++) {
            uint32_t texel = first + i / EACH, k = i % EACH;
            float x = (float)(rect.x + texel % rect.width) + ((float)(k % SIDE) + 0.5f) / SIDE,
                  y = (float)(rect.y + texel / rect.width) + ((float)(k / SIDE) + 0.5f) / SIDE;
            work->at[i] = (slv_surface_point){(int32_t)face, x / (float)(1u << res.u),
                                              y / (float)(1u << res.v)};
        }
        const bool turns = kind == SLV_BAKE_NORMAL || kind == SLV_BAKE_CURVATURE,
                   stretches = kind == SLV_BAKE_DENSITY || kind == SLV_BAKE_CURVATURE;
        const slv_surface_arrays arrays = {
            .positions = kind == SLV_BAKE_POSITION ? work->positions[0] : NULL,
            .normals = turns ? work->normals[0] : NULL,
            .du = stretches ? work->du[0] : NULL,
            .dv = stretches ? work->dv[0] : NULL};
        result = slv_surface_evaluate(s->surface, (size_t)count * EACH, work->at, &arrays);
        for (uint32_t i = 0; i < count && !result; i++)
            mean_of(s, work, i, res, values + (size_t)(first + i) * n);
    }
    slvi_free(work);
    return result;
}

static void destroy(slv_bake_source *source) {
    slvi_free(source);
}

slv_result slv_bake_from_surface(const slv_env *env, const slv_surface *surface,
                                 slv_bake_surface_kind kind, slv_bake_source **out) {
    static const slvi_bake_fns fns = {evaluate, NULL, NULL, destroy, NULL};
    surface_source *s = NULL;
    *out = NULL;
    if ((unsigned)kind > SLV_BAKE_CURVATURE)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: unknown kind of surface values %d",
                         (int)kind);
    slv_result result = slvi_alloc(env, "bake: surface", 1, sizeof *s, &s);
    if (result)
        return result;
    bool three = kind == SLV_BAKE_POSITION || kind == SLV_BAKE_NORMAL;
    s->surface = surface;
    s->kind = kind;
    s->base = (slv_bake_source){.fns = &fns,
                                .nfaces = slv_surface_face_count(surface),
                                .apart = kind == SLV_BAKE_FACE_ID,
                                .desc = {kind == SLV_BAKE_NORMAL ? SLV_TYPE_HALF : SLV_TYPE_FLOAT,
                                         three ? 3 : 1, SLV_NO_ALPHA, SLV_TEXTURE_DATA}};
    *out = &s->base;
    return SLV_OK;
}
