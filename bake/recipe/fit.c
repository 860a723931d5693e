/* Resolution by error: each face is measured four times as finely as its source is resolved, and
 * the coarsest texture is taken that comes back to what was measured. */
#include "recipe/fit.h"
#include "source/holes.h"
#include "source/source.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/progress.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

enum {
    FINER = 2,      /* log2 of samples for each pixel or texel along an axis */
    MOST_LOG2 = 20, /* of samples on a face */
    BLIND_LOG2 = 8  /* along an axis, of sources without a resolution */
};

typedef struct fit {
    const slv_bake_source *source;
    const slv_bake_job *job;
    const encoder *e;
    slv_env env;
    slv_res *res;
    slv_bake_report *report;
    pthread_mutex_t lock;
    slvi_steps steps;
} fit;

/* A face in the making. All arrays are of samples, n channels each. */
typedef struct face_fit {
    uint32_t n;
    slv_res fine;
    float *means;               /* light, at every resolution up to `fine`: see at_res */
    float *stored, *low, *high; /* encoded; light between which a reconstruction may be */
} face_fit;

static uint64_t count_of(slv_res res) {
    return UINT64_C(1) << (res.u + res.v);
}

/* Means are kept for each (u,v): rows of resolutions of one v hold 2^(u + 1) - 1 columns in all. */
static float *at_res(const face_fit *f, slv_res res) {
    uint64_t row = (UINT64_C(2) << f->fine.u) - 1;
    uint64_t before = ((UINT64_C(1) << res.v) - 1) * row;
    return f->means + (before + ((UINT64_C(1) << res.u) - 1) * (UINT64_C(1) << res.v)) * f->n;
}

static void halve(const face_fit *f, slv_res from, slv_res to) {
    const float *in = at_res(f, from);
    float *out = at_res(f, to);
    bool along_u = from.u > to.u;
    for (uint64_t i = 0; i < count_of(to); i++) {
        uint64_t x = i & ((UINT64_C(1) << to.u) - 1), y = i >> to.u;
        uint64_t a = along_u ? (y << from.u) + 2 * x : (2 * y << from.u) + x;
        uint64_t b = along_u ? a + 1 : a + (UINT64_C(1) << from.u);
        for (uint32_t c = 0; c < f->n; c++)
            out[i * f->n + c] = 0.5f * (in[a * f->n + c] + in[b * f->n + c]);
    }
}

/* Four samples to a pixel, and no more than fit; 1x1 of what has no extent. */
static slv_res fine_res(const fit *t, uint32_t face) {
    slv_res high = t->job->max_res, out = {BLIND_LOG2, BLIND_LOG2};
    float size[2] = {0, 0};
    if (t->source->fns->extent) {
        t->source->fns->extent(t->source, face, size);
        out.u = (int8_t)(size[0] > 1 ? ceilf(log2f(fminf(size[0], 65536))) : 0);
        out.v = (int8_t)(size[1] > 1 ? ceilf(log2f(fminf(size[1], 65536))) : 0);
    }
    out.u = (int8_t)((out.u < high.u ? out.u : high.u) + FINER);
    out.v = (int8_t)((out.v < high.v ? out.v : high.v) + FINER);
    while (out.u + out.v > MOST_LOG2)
        if (out.u > out.v)
            out.u--;
        else
            out.v--;
    return out;
}

static slv_result measure(const fit *t, uint32_t face, face_fit *f) {
    uint64_t count = count_of(f->fine);
    uint64_t all = ((UINT64_C(2) << f->fine.u) - 1) * ((UINT64_C(2) << f->fine.v) - 1);
    uint8_t *missed = NULL;
    slv_result result;
    if ((result = slvi_alloc_plain(&t->env, "fit: means", all, f->n * sizeof(float), &f->means)) ||
        (result =
             slvi_alloc_plain(&t->env, "fit: samples", count, f->n * sizeof(float), &f->stored)) ||
        (result =
             slvi_alloc_plain(&t->env, "fit: samples", count, f->n * sizeof(float), &f->low)) ||
        (result =
             slvi_alloc_plain(&t->env, "fit: samples", count, f->n * sizeof(float), &f->high)) ||
        (result = slvi_alloc_plain(&t->env, "fit: samples", count, 1, &missed)))
        goto done;
    float *samples = at_res(f, f->fine), error = t->job->max_error;
    const slv_rect whole = {0, 0, 1u << f->fine.u, 1u << f->fine.v};
    if ((result = slv_bake_evaluate(t->source, &t->env, face, f->fine, whole, samples, missed)) ||
        (result = slvi_holes_fill(&t->env, f->n, whole.width, whole.height, missed, samples)))
        goto done;
    memcpy(f->stored, samples, count * f->n * sizeof(float));
    if (t->e->srgb)
        slv_texels_encode(f->n, t->e->alpha, f->stored, count);
    for (uint64_t i = 0; i < count * f->n; i++) {
        f->low[i] = f->stored[i] - error;
        f->high[i] = f->stored[i] + error;
    }
    if (t->e->srgb) {
        slv_texels_decode(f->n, t->e->alpha, f->low, count);
        slv_texels_decode(f->n, t->e->alpha, f->high, count);
    }
    for (int8_t v = f->fine.v; v >= 0; v--) {
        if (v < f->fine.v)
            halve(f, (slv_res){f->fine.u, (int8_t)(v + 1)}, (slv_res){f->fine.u, v});
        for (int8_t u = (int8_t)(f->fine.u - 1); u >= 0; u--)
            halve(f, (slv_res){(int8_t)(u + 1), v}, (slv_res){u, v});
    }
done:
    slvi_free(missed);
    return result;
}

/* Where a sample lies between texel centres along an axis; the outermost go on to the edge. */
static void between(uint64_t sample, int8_t fine, int8_t coarse, uint64_t *first, uint64_t *second,
                    float *weight) {
    double at = ((double)sample + 0.5) * exp2(coarse - fine) - 0.5;
    double most = exp2(coarse) - 1;
    at = at < 0 ? 0 : at > most ? most : at;
    *first = (uint64_t)at;
    *second = *first + 1 <= (uint64_t)most ? *first + 1 : *first;
    *weight = (float)(at - (double)*first);
}

static void rebuild(const face_fit *f, const float *texels, slv_res res, uint64_t x, uint64_t y,
                    float *out) {
    uint64_t x0, x1, y0, y1;
    float fx, fy;
    between(x, f->fine.u, res.u, &x0, &x1, &fx);
    between(y, f->fine.v, res.v, &y0, &y1, &fy);
    const float *a = texels + ((y0 << res.u) + x0) * f->n,
                *b = texels + ((y0 << res.u) + x1) * f->n,
                *c = texels + ((y1 << res.u) + x0) * f->n,
                *d = texels + ((y1 << res.u) + x1) * f->n;
    for (uint32_t k = 0; k < f->n; k++) {
        float lower = a[k] + (b[k] - a[k]) * fx, upper = c[k] + (d[k] - c[k]) * fx;
        out[k] = lower + (upper - lower) * fy;
    }
}

/* Texels as a file holds them, as light. */
static slv_result store(const fit *t, const face_fit *f, slv_res res, float **out) {
    uint64_t count = count_of(res);
    void *packed = NULL;
    slv_result result = slvi_alloc_plain(&t->env, "fit: texels", count, f->n * sizeof(float), out);
    if (result ||
        (result = slvi_alloc_plain(&t->env, "fit: texels", count, f->n * sizeof(float), &packed)))
        return result;
    memcpy(*out, at_res(f, res), count * f->n * sizeof(float));
    slvi_encoder_run(t->e, *out, count, packed);
    slvi_encoder_undo(t->e, packed, count, *out);
    slvi_free(packed);
    return SLV_OK;
}

/* Whether texels come back to all samples; those of a coarse lattice first, which tell most of what
 * is wrong. */
static bool is_near(const face_fit *f, const float *texels, slv_res res) {
    uint64_t width = UINT64_C(1) << f->fine.u, height = UINT64_C(1) << f->fine.v;
    float value[4];
    for (uint64_t step = 7; step; step = step == 7 ? 1 : 0)
        for (uint64_t y = 0; y < height; y += step)
            for (uint64_t x = y % step; x < width; x += step) {
                uint64_t at = (y * width + x) * f->n;
                rebuild(f, texels, res, x, y, value);
                for (uint32_t c = 0; c < f->n; c++)
                    if (!(value[c] >= f->low[at + c] && value[c] <= f->high[at + c]))
                        return false;
            }
    return true;
}

/* The largest difference at a sample; and with what it can change on the way to the next ones,
 * along both axes, added. */
static slv_result tell(const fit *t, const face_fit *f, const float *texels, slv_res res,
                       float *error, float *bound) {
    uint64_t width = UINT64_C(1) << f->fine.u, height = UINT64_C(1) << f->fine.v;
    float *rows[2] = {NULL, NULL};
    slv_result result = slvi_alloc(&t->env, "fit: rows", 2 * width, f->n * sizeof(float), &rows[0]);
    *error = *bound = 0;
    if (result)
        return result;
    rows[1] = rows[0] + width * f->n;
    for (uint64_t y = 0; y < height; y++) {
        float *now = rows[y & 1], *before = rows[~y & 1];
        for (uint64_t x = 0; x < width; x++)
            rebuild(f, texels, res, x, y, now + x * f->n);
        if (t->e->srgb)
            slv_texels_encode(f->n, t->e->alpha, now, width);
        for (uint64_t i = 0; i < width * f->n; i++) {
            now[i] -= f->stored[y * width * f->n + i];
            float along = i >= f->n ? fabsf(now[i] - now[i - f->n]) : 0;
            float across = y ? fabsf(now[i] - before[i]) : 0;
            *error = fmaxf(*error, fabsf(now[i]));
            /* both ends of each step have it added */
            float ends = fabsf(now[i]);
            ends = i >= f->n ? fmaxf(ends, fabsf(now[i - f->n])) : ends;
            ends = y ? fmaxf(ends, fabsf(before[i])) : ends;
            *bound = fmaxf(*bound, ends + along + across);
        }
    }
    slvi_free(rows[0]);
    return SLV_OK;
}

/* Candidates by their number of texels, squarish ones first. */
static slv_result choose(const fit *t, const face_fit *f, slv_res low, slv_res high, slv_res *best,
                         float **texels, bool *found) {
    *found = false;
    for (int sum = low.u + low.v; sum <= high.u + high.v && !*found; sum++)
        for (int apart = 0; apart <= sum && !*found; apart++)
            for (int side = 0; side < 2 && !*found; side++) {
                int u = side ? (sum - apart) / 2 : (sum + apart) / 2, v = sum - u;
                if ((sum - apart) % 2 || (side && !apart) || u < low.u || u > high.u || v < low.v ||
                    v > high.v)
                    continue;
                slv_res res = {(int8_t)u, (int8_t)v};
                slvi_free(*texels);
                *texels = NULL;
                slv_result result = store(t, f, res, texels);
                if (result)
                    return result;
                *best = res;
                *found = is_near(f, *texels, res);
            }
    return SLV_OK;
}

static slv_result fit_face(fit *t, uint32_t face) {
    face_fit f = {.n = t->source->desc.nchannels, .fine = fine_res(t, face)};
    slv_res low = t->job->min_res;
    slv_res high = {(int8_t)(f.fine.u > FINER ? f.fine.u - FINER : 0),
                    (int8_t)(f.fine.v > FINER ? f.fine.v - FINER : 0)};
    float *texels = NULL, error = 0, bound = 0;
    bool found = false;
    low.u = low.u < high.u ? low.u : high.u;
    low.v = low.v < high.v ? low.v : high.v;
    slv_result result = measure(t, face, &f);
    if (!result && !(result = choose(t, &f, low, high, &t->res[face], &texels, &found)))
        result = tell(t, &f, texels, t->res[face], &error, &bound);
    slvi_free(texels);
    slvi_free(f.means);
    slvi_free(f.stored);
    slvi_free(f.low);
    slvi_free(f.high);
    pthread_mutex_lock(&t->lock);
    t->report->error = fmaxf(t->report->error, error);
    t->report->error_bound = fmaxf(t->report->error_bound, bound);
    t->report->faces_over += !found;
    pthread_mutex_unlock(&t->lock);
    if (!result)
        result = slvi_steps_add(&t->steps, &t->env, "bake", 1);
    return result;
}

static slv_result fit_faces(void *user, uint64_t first, uint64_t end) {
    slv_result result = SLV_OK;
    for (uint64_t face = first; face < end && !result; face++)
        result = fit_face(user, (uint32_t)face);
    return result;
}

slv_result slvi_bake_fit(const slv_env *env, const slv_bake_source *source, const slv_bake_job *job,
                         const encoder *e, slv_res *res, slv_bake_report *report) {
    fit t = {.source = source, .job = job, .e = e, .res = res, .report = report};
    slv_progress progress = job->progress;
    slv_parallel_log *log = NULL;
    slv_result result = slvi_parallel_env_begin(env, &log, &t.env);
    if (result)
        return result;
    pthread_mutex_init(&t.lock, NULL);
    slvi_steps_begin(&t.steps, slvi_progress_asking(&progress), source->nfaces);
    result = slvi_parallel_for(&t.env, source->nfaces, 1, fit_faces, &t);
    slvi_steps_end(&t.steps);
    pthread_mutex_destroy(&t.lock);
    slvi_parallel_env_end(log);
    return result;
}

/* Errors are tried by halves of the logarithm, from 2^-16 to 2^16. */
slv_result slvi_bake_fit_within(const slv_env *env, const slv_bake_source *source,
                                const slv_bake_job *job, const encoder *e, uint64_t most,
                                slv_res *res, slv_bake_report *report) {
    enum { LOW = -16, HIGH = 16, TRIES = 8 };
    float low = LOW, high = HIGH;
    const slv_bake_report before = *report;
    uint64_t least = 0;
    slv_res *tried = NULL;
    bool found = false;
    slv_result result = slvi_alloc(env, "resolutions", source->nfaces, sizeof *tried, &tried);
    for (int i = 0; i <= TRIES && !result; i++) {
        float now = i ? 0.5f * (low + high) : high;
        slv_bake_job own = *job;
        slv_bake_report told = before;
        uint64_t texels = 0;
        own.max_error = exp2f(now);
        if ((result = slvi_bake_fit(env, source, &own, e, tried, &told)))
            break;
        for (uint32_t face = 0; face < source->nfaces; face++)
            texels += UINT64_C(1) << (tried[face].u + tried[face].v);
        least = i ? least : texels;
        if (texels <= most) {
            memcpy(res, tried, source->nfaces * sizeof *res);
            *report = told;
            high = now;
            found = true;
        } else if (i) {
            low = now;
        } else {
            break;
        }
    }
    slvi_free(tried);
    if (!result && !found)
        result = slvi_fail(env, SLV_ERROR_LIMIT,
                           "bake: %llu texels are too few: the faces take %llu at least",
                           (unsigned long long)most, (unsigned long long)least);
    return result;
}
