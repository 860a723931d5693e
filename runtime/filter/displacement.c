/* A displacement that looks its values up in a texture. */
#include "cache/cache_lookup.h"

#include "base/log.h"
#include "base/memory.h"
#include "filter/displacement_texels.h"

#include <selvage/displacement.h>

#include <math.h>
#include <stdatomic.h>

enum { ROUND = 256 };

/* Of the texels that are not looked up as they stand: a source reads of a cache that is not the one
 * that holds it. */
#define OWN_BYTES (UINT64_C(256) << 20)

typedef struct lookups {
    slv_cache *cache;
    slv_file_id file;
    slv_cache *own; /* or NULL: then `cache` is this one */
    atomic_flag told;
    slv_filter_params filter;
    uint32_t width; /* numbers a point */
    float scale, bias;
    uint32_t nfaces;
    uint8_t *log2; /* per face: of the most texels along an axis */
} lookups;

/* The first value that is no number is told of, since nothing shows of it. */
static void tell(lookups *from, int32_t face) {
    slv_source source;
    slv_source_desc desc;
    if (atomic_flag_test_and_set(&from->told) ||
        slv_cache_as_source(from->cache, from->file, &source))
        return;
    if (!source.fns->describe(source.user, &desc))
        slvi_logf(
            slvi_cache_env(from->cache), SLV_LOG_WARNING,
            "%s: face %d: displaces by what is no number, which moves nothing; others are not "
            "told of",
            desc.name, face);
    slv_source_close(&source);
}

static slv_result evaluate(void *user, int32_t face, float spacing, size_t count, const float *uv,
                           float *out) {
    lookups *from = user;
    slv_lookup round[ROUND];
    slv_sampler *sampler = NULL;
    slv_result result = slv_sampler_create(from->cache, &from->filter, &sampler);
    for (size_t first = 0; first < count && !result; first += ROUND) {
        size_t n = count - first < ROUND ? count - first : ROUND;
        for (size_t i = 0; i < n; i++)
            round[i] = (slv_lookup){.file = from->file,
                                    .face = (uint32_t)face,
                                    .u = uv[2 * (first + i)],
                                    .v = uv[2 * (first + i) + 1],
                                    .uw1 = spacing,
                                    .vw2 = spacing};
        float *to = out + first * from->width;
        result = slv_sample_batch(sampler, round, n, to, from->width, NULL);
        for (size_t i = 0; i < n * from->width && !result; i++) {
            if (!isfinite(to[i]))
                tell(from, face);
            to[i] = isfinite(to[i]) ? from->scale * (to[i] + from->bias) : 0;
        }
    }
    slv_sampler_destroy(sampler);
    return result;
}

static uint32_t detail(void *user, int32_t face) {
    const lookups *from = user;
    return (uint32_t)face < from->nfaces ? UINT32_C(1) << from->log2[face] : 1;
}

static slv_result read_sizes(const slv_env *env, lookups *to) {
    slv_source source;
    slv_result result = slvi_alloc(env, "displacement", to->nfaces, 1, &to->log2);
    if (result || (result = slv_cache_as_source(to->cache, to->file, &source)))
        return result;
    for (uint32_t f = 0; f < to->nfaces && !result; f++) {
        slv_source_face face;
        if (!(result = source.fns->face(source.user, f, &face)))
            to->log2[f] = (uint8_t)(face.res.u > face.res.v ? face.res.u : face.res.v);
    }
    slv_source_close(&source);
    return result;
}

/* What is wrong with what is asked of a texture. */
static slv_result check(const slv_env *env, const slv_displacement_params *p,
                        const slv_ptx_info *info) {
    const uint32_t width = p->space ? 3 : 1;
    if ((unsigned)p->space > SLV_DISPLACE_TANGENT)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "displacement: there is no space %d",
                         (int)p->space);
    if (p->channel >= info->nchannels || info->nchannels - p->channel < width)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "displacement: %u channel(s) from %u on, of a texture with %u", width,
                         p->channel, info->nchannels);
    if (!isfinite(p->scale) || !isfinite(p->bias))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "displacement: scale %g, bias %g: no numbers",
                         (double)p->scale, (double)p->bias);
    return SLV_OK;
}

/* Has the lookups go to other neighbours, or sub-faces of triangles. */
static slv_result rewire(const slv_env *env, const slv_adjacency *adjacency, lookups *to) {
    const slv_cache_params params = {.max_bytes = OWN_BYTES};
    slv_source texels;
    slv_result result = slvi_displacement_texels(to->cache, to->file, adjacency, &texels);
    if (result)
        return result;
    if ((result = slv_cache_create(env, &params, &to->own))) {
        slv_source_close(&texels);
        return result;
    }
    to->cache = to->own;
    return slv_cache_open_source(to->own, &texels, NULL, &to->file);
}

slv_result slv_displacement_open(slv_cache *cache, slv_file_id file,
                                 const slv_displacement_params *given, slv_displacement *out) {
    const slv_displacement_params p = given ? *given : (slv_displacement_params){0};
    const slv_env *env = slvi_cache_env(cache);
    lookups *made = NULL;
    slv_ptx_info info;
    slv_result result = slv_cache_get_info(cache, file, &info);
    *out = (slv_displacement){.space = p.space};
    if (result || (result = check(env, &p, &info)) ||
        (result = slvi_alloc(env, "displacement", 1, sizeof *made, &made)))
        return result;
    const bool triangles = info.mesh_type == SLV_PTX_TRIANGLE;
    *made = (lookups){
        .cache = cache,
        .file = file,
        .told = ATOMIC_FLAG_INIT,
        .width = p.space ? 3 : 1,
        .nfaces = (triangles ? 3 : 1) * info.nfaces,
        .scale = p.scale == 0 ? 1 : p.scale,
        .bias = p.bias,
        .filter =
            p.filter ? *p.filter : (slv_filter_params){.filter = SLV_FILTER_BSPLINE, .lerp = true}};
    made->filter.first_channel = p.channel;
    made->filter.nchannels = made->width;
    slv_sampler *tried = NULL; /* what is wrong with the filter is said now */
    if (triangles || p.adjacency)
        result = rewire(env, p.adjacency, made);
    if (!result)
        result = slv_sampler_create(made->cache, &made->filter, &tried);
    slv_sampler_destroy(tried); /* while its cache is there */
    if (result || (result = read_sizes(env, made))) {
        slv_displacement failed = {.space = p.space, .user = made};
        slv_displacement_close(&failed);
    } else {
        *out = (slv_displacement){
            .space = p.space, .evaluate = evaluate, .detail = detail, .user = made};
    }
    return result;
}

void slv_displacement_close(slv_displacement *displacement) {
    lookups *from = displacement->user;
    if (from) {
        slv_cache_destroy(from->own);
        slvi_free(from->log2);
    }
    slvi_free(from);
    *displacement = (slv_displacement){.space = SLV_DISPLACE_NORMAL};
}
