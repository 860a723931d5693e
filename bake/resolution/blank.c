/* Blank textures: how many texels each face is given, and the texture without any paint. */
#include <selvage/blank.h>

#include "base/log.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

#define DEFAULT_TEXELS (UINT64_C(4) << 20)
enum { DEFAULT_MAX_LOG2 = 12, SPAN = 2, GRID = SPAN + 1 };

/* The lengths of faces along u and v, and what is asked of them. */
typedef struct plan {
    const slv_mesh *mesh;
    const slv_blank_params *params;
    uint32_t nfaces;
    float *sides; /* 2 per face */
    slv_res low, high;
} plan;

static double distance(const float *a, const float *b) {
    double sum = 0;
    for (int k = 0; k < 3; k++)
        sum += ((double)a[k] - (double)b[k]) * ((double)a[k] - (double)b[k]);
    return sqrt(sum);
}

static slv_result measure(const slv_env *env, plan *p) {
    const slv_surface_params how = {.scheme = p->params->scheme};
    slv_surface *surface = NULL;
    float points[GRID * GRID * 3];
    slv_result result = slvi_alloc(env, "sides", p->nfaces, 2 * sizeof(float), &p->sides);
    if (result || (result = slv_surface_create(env, p->mesh, &how, &surface)))
        return result;
    for (uint32_t face = 0; face < p->nfaces && !result; face++) {
        const slv_surface_arrays out = {.positions = points};
        double u = 0, v = 0;
        result = slv_surface_evaluate_grid(surface, (int32_t)face, SPAN, SPAN, &out);
        for (int j = 0; j < GRID && !result; j++)
            for (int i = 0; i < SPAN; i++) {
                u += distance(points + 3 * (j * GRID + i), points + 3 * (j * GRID + i + 1));
                v += distance(points + 3 * (i * GRID + j), points + 3 * ((i + 1) * GRID + j));
            }
        p->sides[2 * (size_t)face] = (float)(u / GRID);
        p->sides[2 * (size_t)face + 1] = (float)(v / GRID);
    }
    slv_surface_destroy(surface);
    return result;
}

static int8_t within(double value, int low, int high) {
    return (int8_t)(value > low ? (value < high ? lround(value) : high) : low); /* NaN: low */
}

/* Of a density, whatever the largest is. */
static slv_res unlimited_res(const plan *p, uint32_t face, double density) {
    double u = (double)p->sides[2 * (size_t)face] * density,
           v = (double)p->sides[2 * (size_t)face + 1] * density;
    if (p->params->square)
        u = v = sqrt(u * v);
    return (slv_res){within(log2(u), p->low.u, INT8_MAX), within(log2(v), p->low.v, INT8_MAX)};
}

static slv_res face_res(const plan *p, uint32_t face, double density) {
    bool half = slv_mesh_faces(p->mesh)[face].sub >= 0;
    if (p->params->uniform)
        return (slv_res){within(p->params->res.u - half, p->low.u, p->high.u),
                         within(p->params->res.v - half, p->low.v, p->high.v)};
    slv_res res = unlimited_res(p, face, density);
    return (slv_res){res.u < p->high.u ? res.u : p->high.u, res.v < p->high.v ? res.v : p->high.v};
}

static uint64_t count_texels(const plan *p, double density) {
    uint64_t total = 0;
    for (uint32_t face = 0; face < p->nfaces; face++) {
        slv_res res = face_res(p, face, density);
        total += UINT64_C(1) << (res.u + res.v);
    }
    return total;
}

/* The largest density that keeps within a number of texels, by halving an interval of exponents;
 * where all faces are as large as they may be, the smallest that makes them so. */
static double find_density(const plan *p, uint64_t texels) {
    double low = -160, high = 160;
    uint64_t most = count_texels(p, exp2(high));
    bool whole = most <= texels;
    for (int i = 0; i < 60; i++) {
        double middle = (low + high) / 2;
        uint64_t count = count_texels(p, exp2(middle));
        if (whole ? count < most : count <= texels)
            low = middle;
        else
            high = middle;
    }
    return exp2(whole ? high : low);
}

static bool is_limited(const slv_blank_params *params) {
    return params->max_given || params->max_res.u || params->max_res.v;
}

static slv_result check(const slv_env *env, const slv_blank_params *params) {
    uint32_t n = params->nchannels ? params->nchannels : 3;
    if ((params->uniform != 0) + (params->density != 0) + (params->max_texels != 0) > 1)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "new texture: a resolution, a density or a number of texels: one of them");
    if (!(params->density >= 0) || !isfinite(params->density))
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "new texture: %g texels a unit, expected more than 0",
                         (double)params->density);
    if (params->res.u < 0 || params->res.u > SLV_MAX_LOG2_RES || params->res.v < 0 ||
        params->res.v > SLV_MAX_LOG2_RES)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "new texture: 2^%d x 2^%d texels, expected 0 to %d", params->res.u,
                         params->res.v, SLV_MAX_LOG2_RES);
    if (is_limited(params) &&
        (params->min_res.u > params->max_res.u || params->min_res.v > params->max_res.v))
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "new texture: no face smaller than %ux%u and none larger than %ux%u",
                         1u << params->min_res.u, 1u << params->min_res.v, 1u << params->max_res.u,
                         1u << params->max_res.v);
    if (params->alpha_channel < 0 || (uint32_t)params->alpha_channel > n)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "new texture: alpha is channel %d of %u",
                         (int)params->alpha_channel - 1, (unsigned)n);
    return SLV_OK;
}

static void tell(const plan *p, const slv_res *res, double density, slv_blank_stats *stats) {
    uint32_t n = p->params->nchannels ? p->params->nchannels : 3;
    *stats = (slv_blank_stats){.density = (float)density};
    for (uint32_t face = 0; face < p->nfaces; face++) {
        int size = res[face].u + res[face].v;
        if (!face || size < stats->smallest.u + stats->smallest.v)
            stats->smallest = res[face];
        if (!face || size > stats->largest.u + stats->largest.v)
            stats->largest = res[face];
        stats->texels += UINT64_C(1) << size;
        slv_res wanted = p->params->uniform ? res[face] : unlimited_res(p, face, density);
        if ((wanted.u > res[face].u || wanted.v > res[face].v) && !stats->nlimited++)
            stats->first_limited = face;
    }
    stats->bytes = stats->texels * n * slv_type_size(p->params->type);
}

static void warn(const slv_env *env, const plan *p, const slv_blank_stats *stats) {
    const slv_blank_params *params = p->params;
    if (params->density > 0 && stats->nlimited)
        slvi_logf(env, SLV_LOG_WARNING,
                  "new texture: %u of %u faces, the first %u, take more than %ux%u texels at %g a "
                  "unit of length, and have no more",
                  stats->nlimited, p->nfaces, stats->first_limited, 1u << p->high.u,
                  1u << p->high.v, (double)params->density);
    if (params->max_texels && stats->texels > params->max_texels)
        slvi_logf(env, SLV_LOG_WARNING,
                  "new texture: %llu texels where %llu were asked for: no face is smaller than "
                  "%ux%u",
                  (unsigned long long)stats->texels, (unsigned long long)params->max_texels,
                  1u << p->low.u, 1u << p->low.v);
}

slv_result slv_blank_plan(const slv_env *env, const slv_mesh *mesh, const slv_blank_params *params,
                          slv_res **out, slv_blank_stats *stats) {
    static const slv_blank_params none = {0};
    plan p = {.mesh = mesh, .params = params ? params : &none};
    slv_res *res = NULL;
    double density = 0;
    slv_result result = check(env, p.params);
    *out = NULL;
    if (result)
        return result;
    p.nfaces = slv_mesh_face_count(mesh);
    p.low = p.params->min_res;
    p.high = p.params->max_res;
    if (!is_limited(p.params))
        p.high = p.params->uniform ? (slv_res){SLV_MAX_LOG2_RES, SLV_MAX_LOG2_RES}
                                   : (slv_res){DEFAULT_MAX_LOG2, DEFAULT_MAX_LOG2};
    p.high.u = p.high.u > p.low.u ? p.high.u : p.low.u;
    p.high.v = p.high.v > p.low.v ? p.high.v : p.low.v;
    if (!(result = slvi_alloc(env, "resolutions", p.nfaces, sizeof *res, &res)) &&
        !p.params->uniform && !(result = measure(env, &p)))
        density =
            p.params->density > 0
                ? (double)p.params->density
                : find_density(&p, p.params->max_texels ? p.params->max_texels : DEFAULT_TEXELS);
    for (uint32_t face = 0; !result && face < p.nfaces; face++)
        res[face] = face_res(&p, face, density);
    if (!result) {
        slv_blank_stats own;
        tell(&p, res, density, &own);
        warn(env, &p, &own);
        if (stats)
            *stats = own;
    }
    slvi_free(p.sides);
    if (result) {
        slvi_free(res);
        return result;
    }
    *out = res;
    return SLV_OK;
}

/* One texel, as it is stored. For slvi_free. */
static slv_result make_texel(const slv_env *env, const slv_blank_params *params, uint32_t n,
                             void **out) {
    float *values = NULL;
    slv_result result = slvi_alloc(env, "a texel", n, sizeof *values, &values);
    if (!result)
        result = slvi_alloc(env, "a texel", n, slv_type_size(params->type), out);
    for (uint32_t c = 0; !result && c < n; c++)
        values[c] = params->fill ? params->fill[c] : (int32_t)c + 1 == params->alpha_channel;
    if (!result)
        slv_type_from_float(params->type, values, n, *out);
    slvi_free(values);
    return result;
}

slv_result slv_blank_create(const slv_env *env, const slv_mesh *mesh,
                            const slv_blank_params *params, slv_texture **out,
                            slv_blank_stats *stats) {
    static const slv_blank_params none = {0};
    slv_res *res = NULL;
    void *texel = NULL;
    params = params ? params : &none;
    *out = NULL;
    slv_result result = slv_blank_plan(env, mesh, params, &res, stats);
    slv_texture_desc desc = {.nfaces = slv_mesh_face_count(mesh),
                             .type = params->type,
                             .nchannels = params->nchannels ? params->nchannels : 3,
                             .alpha_channel = params->alpha_channel - 1,
                             .res = res,
                             .encoding = params->encoding};
    if (!result && !(result = make_texel(env, params, desc.nchannels, &texel)))
        result = slv_texture_create(env, &desc, out);
    for (uint32_t face = 0; !result && face < desc.nfaces; face++)
        result = slv_texture_set_constant(*out, face, texel);
    slvi_free(texel);
    slvi_free(res);
    if (result) {
        slv_texture_destroy(*out);
        *out = NULL;
    }
    return result;
}

static slv_result note_encoding(const slv_blank_params *params, slv_ptx_writer *writer) {
    if (!params->encoding || params->encoding == slv_type_encoding(params->type))
        return SLV_OK;
    const char *name = slv_texture_encoding_name(params->encoding);
    const slv_ptx_meta meta = {SLV_PTX_ENCODING_KEY, SLV_META_STRING, (uint32_t)strlen(name), name};
    return slv_ptx_writer_set_meta(writer, &meta);
}

slv_result slv_blank_save(const slv_env *env, const slv_mesh *mesh, const slv_blank_params *params,
                          const char *path, slv_blank_stats *stats) {
    static const slv_blank_params none = {0};
    slv_res *res = NULL;
    void *texel = NULL;
    slv_ptx_writer *writer = NULL;
    params = params ? params : &none;
    slv_ptx_writer_params how = {.mesh_type = SLV_PTX_QUAD,
                                 .type = params->type,
                                 .nchannels = params->nchannels ? params->nchannels : 3,
                                 .alpha_channel = params->alpha_channel - 1,
                                 .nfaces = slv_mesh_face_count(mesh),
                                 .compression = params->compression,
                                 .progress = params->progress};
    slv_result result = slv_blank_plan(env, mesh, params, &res, stats);
    if (result || (result = make_texel(env, params, how.nchannels, &texel)) ||
        (result = slv_ptx_writer_create(env, path, &how, &writer)) ||
        (result = slv_ptx_writer_set_mesh(writer, mesh)) ||
        (result = note_encoding(params, writer)))
        goto done;
    for (uint32_t face = 0; face < how.nfaces && !result; face++) {
        const slv_ptx_face info = {
            .res = res[face],
            .flags = SLV_FACE_CONSTANT,
            .adjacency.face = {SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY}};
        result = slv_ptx_writer_write_face(writer, face, &info, texel);
    }
    if (!result)
        result = slv_ptx_writer_finish(writer);
done:
    slv_ptx_writer_destroy(writer);
    slvi_free(texel);
    slvi_free(res);
    return result;
}
