/* Colours of a cloud of points on a surface: of each sample those of the points around it, as far
 * as the nearest few reach, or as the part of the texel that it stands for. */
#include "points/tree.h"
#include "source/source.h"

#include "base/log.h"
#include "base/memory.h"

#include <math.h>

enum { LEAST_SIDE = 2, MOST_SIDE = 16, AT_ONCE = 256, DEFAULT_COUNT = 8, COST = 64 };
#define DEFAULT_DISTANCE 0.01f /* of the diagonal */

typedef struct points_source {
    slv_bake_source base;
    const slv_surface *surface;
    point_tree tree;
    float distance;
    uint32_t count;
} points_source;

typedef struct samples {
    slv_surface_point at[AT_ONCE];
    float positions[AT_ONCE][3], du[AT_ONCE][3], dv[AT_ONCE][3];
} samples;

static float length(const float v[3]) {
    return sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Adds a colour multiplied by alpha, and returns whether there is one. */
static bool sample(const points_source *s, const float at[3], float footprint, double sum[4]) {
    double one[4] = {0}, weights;
    float radius;
    uint32_t found = slvi_point_tree_nearest(&s->tree, at, s->count, s->distance, &radius);
    if (!found)
        return false;
    if (found < s->count)
        radius = s->distance;
    weights = slvi_point_tree_gather(&s->tree, at, fmaxf(radius, footprint), one);
    if (!(weights > 0)) {
        /* all as far away as the radius, or in the very place */
        float more = fmaxf(radius * 1.0001f, 1e-30f);
        weights = slvi_point_tree_gather(&s->tree, at, more, one);
    }
    for (int c = 0; c < 4 && weights > 0; c++)
        sum[c] += one[c] / weights;
    return weights > 0;
}

/* How a texel is cut into cells, each with a sample of its own in its middle. */
typedef struct cells {
    uint32_t u, v;
} cells;

/* Two along each axis, more along the longer one of oblong texels, so that cells are about as wide
 * as high. */
static slv_result cut(const points_source *s, uint32_t face, slv_res res, slv_rect rect,
                      cells *out) {
    const slv_surface_point middle = {(int32_t)face,
                                      ldexpf((float)rect.x + 0.5f * (float)rect.width, -res.u),
                                      ldexpf((float)rect.y + 0.5f * (float)rect.height, -res.v)};
    float du[3], dv[3];
    const slv_surface_arrays arrays = {.du = du, .dv = dv};
    slv_result result = slv_surface_evaluate(s->surface, 1, &middle, &arrays);
    *out = (cells){LEAST_SIDE, LEAST_SIDE};
    if (result)
        return result;
    float w = ldexpf(length(du), -res.u), h = ldexpf(length(dv), -res.v);
    while (out->u < MOST_SIDE && w * (float)out->v > 1.5f * h * (float)out->u)
        out->u *= 2;
    while (out->v < MOST_SIDE && h * (float)out->u > 1.5f * w * (float)out->v)
        out->v *= 2;
    return SLV_OK;
}

/* Of samples first to end - 1, which are a texel's. */
static void mean_of(const points_source *s, const samples *work, uint32_t first, uint32_t end,
                    const float cell[2], float *values, uint8_t *missed) {
    uint32_t n = s->base.desc.nchannels, found = 0;
    double sum[4] = {0};
    for (uint32_t k = first; k < end; k++) {
        float footprint = 0.5f * (length(work->du[k]) * cell[0] + length(work->dv[k]) * cell[1]);
        found += sample(s, work->positions[k], footprint, sum);
    }
    if (!found) {
        *missed = SLV_BAKE_TOO_FAR;
        return;
    }
    for (uint32_t c = 0; c < n; c++)
        values[c] = (float)(c == 3 ? sum[3] / found : sum[3] > 0 ? sum[c] / sum[3] : 0);
}

static slv_result evaluate(const slv_bake_source *source, const slv_env *env, uint32_t face,
                           slv_res res, slv_rect rect, float *values, uint8_t *misses) {
    const points_source *s = (const points_source *)source;
    uint32_t total = rect.width * rect.height;
    samples *work = NULL;
    cells cell;
    slv_result result = slvi_alloc_plain(env, "bake: samples", 1, sizeof *work, &work);
    result = result ? result : cut(s, face, res, rect, &cell);
    if (result) {
        slvi_free(work);
        return result;
    }
    uint32_t each = cell.u * cell.v, most = AT_ONCE / each;
    const float size[2] = {ldexpf(1 / (float)cell.u, -res.u), ldexpf(1 / (float)cell.v, -res.v)};
    for (uint32_t first = 0; first < total && !result; first += most) {
        uint32_t count = total - first < most ? total - first : most;
        for (uint32_t i = 0; i < count * each; i++) {
            uint32_t texel = first + i / each, k = i % each;
            uint32_t x = (rect.x + texel % rect.width) * cell.u + k % cell.u,
                     y = (rect.y + texel / rect.width) * cell.v + k / cell.u;
            work->at[i] = (slv_surface_point){(int32_t)face, ((float)x + 0.5f) * size[0],
                                              ((float)y + 0.5f) * size[1]};
        }
        const slv_surface_arrays arrays = {
            .positions = work->positions[0], .du = work->du[0], .dv = work->dv[0]};
        result = slv_surface_evaluate(s->surface, (size_t)count * each, work->at, &arrays);
        for (uint32_t i = 0; i < count && !result; i++)
            mean_of(s, work, i * each, (i + 1) * each, size,
                    values + (size_t)(first + i) * s->base.desc.nchannels, misses + first + i);
    }
    slvi_free(work);
    return result;
}

static void destroy(slv_bake_source *source) {
    slvi_point_tree_free(&((points_source *)source)->tree);
    slvi_free(source);
}

/* What does not even touch is told before any search. */
static slv_result measure(const slv_env *env, const slv_mesh *mesh, points_source *s) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double diagonal = 0;
    for (size_t i = 0; i < (size_t)3 * view->nverts; i++) {
        low[i % 3] = fminf(low[i % 3], view->positions[i]);
        high[i % 3] = fmaxf(high[i % 3], view->positions[i]);
    }
    for (int k = 0; k < 3; k++)
        diagonal += ((double)high[k] - (double)low[k]) * ((double)high[k] - (double)low[k]);
    if (!(s->distance > 0))
        s->distance = DEFAULT_DISTANCE * (float)sqrt(diagonal);
    for (int k = 0; k < 3; k++)
        if (s->tree.low[k] - s->distance > high[k] || s->tree.high[k] + s->distance < low[k])
            return slvi_fail(env, SLV_ERROR_MISMATCH,
                             "bake: the points lie elsewhere: along axis %d they go from %g to %g, "
                             "the mesh from %g to %g, and a point counts within %g",
                             k, (double)s->tree.low[k], (double)s->tree.high[k], (double)low[k],
                             (double)high[k], (double)s->distance);
    return SLV_OK;
}

static slv_result check(const slv_env *env, const slv_mesh *points, const slv_bake_points *p) {
    if (!slv_mesh_get_view(points)->colors)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "bake: the points have no colours");
    if (!(p->distance >= 0) || !isfinite(p->distance))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: a distance of %g", (double)p->distance);
    if (p->count > POINT_NEAREST)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: the nearest %u points, at most %d",
                         p->count, POINT_NEAREST);
    return SLV_OK;
}

slv_result slv_bake_from_points(const slv_env *env, const slv_mesh *mesh,
                                const slv_surface *surface, const slv_mesh *points,
                                const slv_bake_points *params, slv_bake_source **out) {
    static const slvi_bake_fns fns = {evaluate, NULL, NULL, destroy, NULL};
    const slv_bake_points own = params ? *params : (slv_bake_points){0};
    const slv_mesh_view *view = slv_mesh_get_view(points);
    slv_texture_encoding encoding = own.encoding;
    points_source *s = NULL;
    *out = NULL;
    slv_result result = check(env, points, &own);
    if (result || (result = slvi_alloc(env, "bake: points", 1, sizeof *s, &s)))
        return result;
    if (encoding == SLV_TEXTURE_AUTO)
        encoding = view->colors_linear ? SLV_TEXTURE_LINEAR : SLV_TEXTURE_SRGB;
    s->surface = surface;
    s->distance = own.distance;
    s->count = own.count ? own.count : DEFAULT_COUNT;
    s->base = (slv_bake_source){.fns = &fns,
                                .nfaces = slv_mesh_face_count(mesh),
                                .cost = COST,
                                .desc = {view->colors_linear ? SLV_TYPE_FLOAT : SLV_TYPE_U8,
                                         view->colors_alpha ? 4 : 3,
                                         view->colors_alpha ? 3 : SLV_NO_ALPHA, encoding}};
    result = slvi_point_tree_create(env, points, slv_mesh_get_view(mesh)->origin,
                                    encoding == SLV_TEXTURE_SRGB, &s->tree);
    if (!result && !s->tree.count)
        result = slvi_fail(env, SLV_ERROR_MISMATCH, "bake: none of the points has a colour");
    if (result || (result = measure(env, mesh, s))) {
        destroy(&s->base);
        return result;
    }
    *out = &s->base;
    return SLV_OK;
}
