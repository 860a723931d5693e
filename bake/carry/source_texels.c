/* A source of values as texels: what transfers look up is made when it is read. */
#include "carry/carry.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <selvage/blank.h>
#include <selvage/ptx.h>

#include <math.h>

/* Of a source without a resolution: as many texels, or what they cost, in all. */
enum { MOST_LOG2 = 12, TEXELS = 1 << 22, RAYS = 1 << 27 };

typedef struct texels {
    const slv_bake_source *source;
    slv_env env; /* its log is serialised */
    slv_parallel_log *log;
    slv_adjacency *adjacency;
    slv_source self;
    slv_res *res;
} texels;

static slv_result describe(void *user, slv_source_desc *out) {
    const texels *t = user;
    const slv_bake_source_desc *desc = &t->source->desc;
    *out = (slv_source_desc){.name = "source",
                             .nfaces = t->source->nfaces,
                             .type = SLV_TYPE_FLOAT,
                             .nchannels = desc->nchannels,
                             .alpha_channel = desc->alpha_channel};
    return SLV_OK;
}

static slv_result face_of(void *user, uint32_t face, slv_source_face *out) {
    const texels *t = user;
    if (face >= t->source->nfaces)
        return slvi_fail(&t->env, SLV_ERROR_ARGUMENT, "bake: face %u: there are %u faces", face,
                         t->source->nfaces);
    *out = (slv_source_face){.res = t->res[face],
                             .adjacency = slv_adjacency_faces(t->adjacency)[face]};
    return SLV_OK;
}

static slv_result read_texels(void *user, uint32_t face, slv_res res, slv_rect rect, void *out) {
    const texels *t = user;
    uint32_t n = t->source->desc.nchannels;
    size_t count = (size_t)rect.width * rect.height;
    float *values = out;
    uint8_t *misses = NULL;
    slv_source_face info;
    slv_result result = slv_source_check(&t->env, &t->self, face, res, rect, &info);
    if (result || (result = slvi_alloc_plain(&t->env, "bake: misses", count, 1, &misses)))
        return result;
    result = slv_bake_evaluate(t->source, &t->env, face, res, rect, values, misses);
    bool whole = res.u == info.res.u && res.v == info.res.v;
    if (!result && !whole && (res.u || res.v))
        slv_ptx_premultiply(SLV_TYPE_FLOAT, n, t->source->desc.alpha_channel, values, count);
    for (size_t i = 0; i < count && !result; i++)
        for (uint32_t c = 0; misses[i] && c < n; c++)
            values[i * n + c] = NAN;
    slvi_free(misses);
    return result;
}

static void close_texels(void *user) {
    texels *t = user;
    slv_adjacency_destroy(t->adjacency);
    slvi_free(t->res);
    slvi_parallel_env_end(t->log);
    slvi_free(t);
}

static int8_t log2_of(float size) {
    return (int8_t)(size > 1 ? fminf(ceilf(log2f(size) - 0.01f), MOST_LOG2) : 0);
}

slv_result slvi_carry_texels_of(const slv_env *env, const slv_mesh *mesh,
                                const slv_bake_source *source, slv_source *out) {
    static const slv_source_fns fns = {
        .describe = describe, .face = face_of, .read = read_texels, .close = close_texels};
    const uint32_t fit = RAYS / (source->cost ? source->cost : 1);
    /* two a side, so that what goes across a face shows */
    const slv_blank_params even = {.max_texels = fit < TEXELS ? fit : TEXELS, .min_res = {1, 1}};
    texels *t = NULL;
    slv_result result = slvi_alloc(env, "bake: texels", 1, sizeof *t, &t);
    *out = (slv_source){0};
    if (result)
        return result;
    t->source = source;
    t->self = (slv_source){&fns, t};
    if (!(result = slvi_parallel_env_begin(env, &t->log, &t->env)) &&
        !(result = slv_mesh_adjacency(env, mesh, &t->adjacency)) && source->fns->extent)
        result = slvi_alloc(env, "resolutions", source->nfaces, sizeof *t->res, &t->res);
    else if (!result)
        result = slv_blank_plan(env, mesh, &even, &t->res, NULL);
    for (uint32_t face = 0; face < source->nfaces && source->fns->extent && !result; face++) {
        float size[2];
        source->fns->extent(source, face, size);
        t->res[face] = (slv_res){log2_of(size[0]), log2_of(size[1])};
    }
    if (result)
        close_texels(t);
    else
        *out = t->self;
    return result;
}
