/* A source of values as texels: what transfers look up is made when it is read. */
#include "carry/carry.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <selvage/blank.h>
#include <selvage/ptx.h>

#include <math.h>
#include <pthread.h>
#include <string.h>

/* Of a source without a resolution: as many texels, or what they cost, in all. */
enum { MOST_LOG2 = 12, TEXELS = 1 << 22, RAYS = 1 << 26 };

/* A face at one resolution, which took rays. */
typedef struct kept_face {
    slv_res res;
    float *values; /* misses are NaN */
    struct kept_face *next;
} kept_face;

typedef struct texels {
    const slv_bake_source *source;
    slv_env env; /* its log is serialised */
    slv_parallel_log *log;
    slv_adjacency *adjacency;
    slv_source self;
    slv_res *res;
    pthread_mutex_t lock;
    kept_face **kept; /* of each face; NULL: nothing is worth keeping */
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

static slv_result make(const texels *t, uint32_t face, slv_res res, slv_rect rect, float *values) {
    uint32_t n = t->source->desc.nchannels;
    size_t count = (size_t)rect.width * rect.height;
    uint8_t *misses = NULL;
    slv_result result = slvi_alloc_plain(&t->env, "bake: misses", count, 1, &misses);
    if (result)
        return result;
    result = slv_bake_evaluate(t->source, &t->env, face, res, rect, values, misses);
    bool whole = res.u == t->res[face].u && res.v == t->res[face].v;
    if (!result && !whole && (res.u || res.v))
        slv_ptx_premultiply(SLV_TYPE_FLOAT, n, t->source->desc.alpha_channel, values, count);
    for (size_t i = 0; i < count && !result; i++)
        for (uint32_t c = 0; misses[i] && c < n; c++)
            values[i * n + c] = NAN;
    slvi_free(misses);
    return result;
}

/* A face as it was made before, or NULL. */
static const kept_face *find_kept(texels *t, uint32_t face, slv_res res) {
    const kept_face *kept;
    pthread_mutex_lock(&t->lock);
    for (kept = t->kept[face]; kept; kept = kept->next)
        if (kept->res.u == res.u && kept->res.v == res.v)
            break;
    pthread_mutex_unlock(&t->lock);
    return kept;
}

static void free_kept(kept_face *kept) {
    slvi_free(kept->values);
    slvi_free(kept);
}

/* Makes a whole face and keeps it, unless another thread was quicker. */
static slv_result keep(texels *t, uint32_t face, slv_res res, const kept_face **out) {
    const slv_rect whole = {0, 0, 1u << res.u, 1u << res.v};
    kept_face *made = NULL;
    slv_result result = slvi_alloc(&t->env, "bake: texels", 1, sizeof *made, &made);
    if (result)
        return result;
    made->res = res;
    if ((result = slvi_alloc_plain(&t->env, "bake: texels", (uint64_t)whole.width * whole.height,
                                   t->source->desc.nchannels * sizeof(float), &made->values)) ||
        (result = make(t, face, res, whole, made->values))) {
        free_kept(made);
        return result;
    }
    if ((*out = find_kept(t, face, res))) {
        free_kept(made);
        return SLV_OK;
    }
    pthread_mutex_lock(&t->lock);
    made->next = t->kept[face];
    t->kept[face] = made;
    pthread_mutex_unlock(&t->lock);
    *out = made;
    return SLV_OK;
}

static slv_result read_texels(void *user, uint32_t face, slv_res res, slv_rect rect, void *out) {
    texels *t = user;
    const size_t texel = t->source->desc.nchannels * sizeof(float), width = (size_t)1 << res.u;
    slv_source_face info;
    slv_result result = slv_source_check(&t->env, &t->self, face, res, rect, &info);
    if (result || !t->kept)
        return result ? result : make(t, face, res, rect, out);
    const kept_face *kept = find_kept(t, face, res);
    if (!kept && (result = keep(t, face, res, &kept)))
        return result;
    for (uint32_t y = 0; y < rect.height; y++)
        memcpy((char *)out + y * rect.width * texel,
               (const char *)kept->values + ((rect.y + y) * width + rect.x) * texel,
               rect.width * texel);
    return SLV_OK;
}

static void close_texels(void *user) {
    texels *t = user;
    for (uint32_t face = 0; t->kept && face < t->source->nfaces; face++)
        while (t->kept[face]) {
            kept_face *next = t->kept[face]->next;
            free_kept(t->kept[face]);
            t->kept[face] = next;
        }
    slvi_free(t->kept);
    pthread_mutex_destroy(&t->lock);
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
    pthread_mutex_init(&t->lock, NULL);
    t->self = (slv_source){&fns, t};
    if (!(result = slvi_parallel_env_begin(env, &t->log, &t->env)) &&
        !(result = slv_mesh_adjacency(env, mesh, &t->adjacency)) && source->fns->extent)
        result = slvi_alloc(env, "resolutions", source->nfaces, sizeof *t->res, &t->res);
    else if (!result)
        result = slv_blank_plan(env, mesh, &even, &t->res, NULL);
    if (!result && !source->fns->extent && source->cost)
        result = slvi_alloc(env, "bake: texels", source->nfaces, sizeof(kept_face *), &t->kept);
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
