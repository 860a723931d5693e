/* A detailed mesh on a plainer surface: rays both ways along the normal of the limit, to the
 * nearest thing that faces the same way; vectors to the nearest place in any direction. */
#include "rays/look.h"
#include "source/cage.h"
#include "source/closest.h"
#include "source/source.h"
#include "source/vectors.h"

#include "base/log.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

enum { AT_ONCE = 256, MOST_SIDE = 16 };
#define DEFAULT_REACH 0.05f /* of the diagonal */

typedef struct detail {
    slv_bake_source base;
    slv_bake_detail params;
    const slv_surface *surface;
    ray_scene scene;
    bake_cage cage;
    float size; /* what coordinates reach: how exactly a point can be told */
    /* for vectors */
    slv_surface *detailed;
    slv_closest *closest;
    float offset[3]; /* from the mesh's frame to the detailed one's */
} detail;

typedef struct points {
    slv_surface_point at[AT_ONCE];
    float positions[AT_ONCE][3], normals[AT_ONCE][3], du[AT_ONCE][3], cage[AT_ONCE][3];
} points;

/* Along the axes of the face: growing u, as far as it is across the normal, normal x that, and the
 * normal. */
static void to_face(const float n[3], const float du[3], float v[3]) {
    float tangent[3], bitangent[3], out[3];
    for (int k = 0; k < 3; k++)
        tangent[k] = du[k] - slvi_dot(du, n) * n[k];
    slvi_normalise(tangent);
    for (int k = 0; k < 3; k++)
        bitangent[k] =
            n[(k + 1) % 3] * tangent[(k + 2) % 3] - n[(k + 2) % 3] * tangent[(k + 1) % 3];
    out[0] = slvi_dot(v, tangent);
    out[1] = slvi_dot(v, bitangent);
    out[2] = slvi_dot(v, n);
    memcpy(v, out, sizeof out);
}

/* To the nearest place. */
static slv_bake_miss vector_to(const detail *d, const float p[3], const float n[3], float out[3]) {
    float reach = fmaxf(d->params.front, d->params.back), at[3];
    for (int k = 0; k < 3; k++)
        at[k] = p[k] + d->offset[k];
    slv_closest_hit hit = slvi_closest_find(d->closest, at, n, reach);
    for (int k = 0; k < 3; k++)
        out[k] = hit.position[k] - at[k];
    if (hit.point.face >= 0 && hit.distance <= reach)
        return SLV_BAKE_HIT;
    hit = slvi_closest_find(d->closest, at, NULL, reach);
    return hit.point.face >= 0 && hit.distance <= reach ? SLV_BAKE_BACK_FACING : SLV_BAKE_TOO_FAR;
}

/* What is asked for of the place that was found from a point of the surface. */
static slv_bake_miss sample(const detail *d, const points *work, uint32_t i, float out[3]) {
    const float *p = work->positions[i], *n = work->normals[i];
    ray_found best;
    slv_bake_miss miss;
    slv_bake_detail_kind kind = d->params.kind;
    const ray_look look = {&d->scene, d->params.front, d->params.back, d->size};
    if (d->closest) {
        miss = vector_to(d, p, n, out);
    } else {
        miss = d->cage.surface ? slvi_ray_look_from(&look, work->cage[i], p, &best)
                               : slvi_ray_look(&look, p, n, &best);
        out[0] = best.distance;
        if (!miss && kind != SLV_BAKE_DISPLACEMENT)
            slvi_ray_normal(&d->scene, best.triangle, best.weights, out);
    }
    if (!miss && (kind == SLV_BAKE_FACE_NORMAL || kind == SLV_BAKE_FACE_VECTOR))
        to_face(n, work->du[i], out);
    return miss;
}

/* A few texels: as many as their samples fit into a batch. */
static slv_result evaluate_some(const detail *d, points *work, uint32_t face, slv_res res,
                                slv_rect rect, float *values, uint8_t *misses) {
    uint32_t side = d->params.samples, each = side * side, n = d->base.desc.nchannels;
    for (uint32_t i = 0; i < rect.width; i++)
        for (uint32_t k = 0; k < each; k++) {
            float x = (float)(rect.x + i) + ((float)(k % side) + 0.5f) / (float)side;
            float y = (float)rect.y + ((float)(k / side) + 0.5f) / (float)side;
            work->at[i * each + k] = (slv_surface_point){(int32_t)face, x / (float)(1u << res.u),
                                                         y / (float)(1u << res.v)};
        }
    const slv_surface_arrays arrays = {
        .positions = work->positions[0], .normals = work->normals[0], .du = work->du[0]};
    slv_result result =
        slv_surface_evaluate(d->surface, (size_t)rect.width * each, work->at, &arrays);
    if (!result && d->cage.surface)
        result = slvi_cage_points(&d->cage, (size_t)rect.width * each, work->at, work->cage[0]);
    for (uint32_t i = 0; i < rect.width && !result; i++) {
        uint32_t count[SLV_BAKE_MISSES] = {0};
        float sum[3] = {0}, one[3];
        for (uint32_t k = i * each; k < (i + 1) * each; k++) {
            slv_bake_miss miss = sample(d, work, k, one);
            for (uint32_t c = 0; c < n && miss == SLV_BAKE_HIT; c++)
                sum[c] += one[c];
            count[miss]++;
        }
        if (count[SLV_BAKE_HIT]) {
            for (uint32_t c = 0; c < n; c++)
                values[i * n + c] = sum[c] / (float)count[SLV_BAKE_HIT];
            if (n == 3 && !d->closest)
                slvi_normalise(values + (size_t)i * n);
            continue;
        }
        for (int miss = 1; miss < SLV_BAKE_MISSES; miss++)
            if (count[miss])
                misses[i] = (uint8_t)miss;
    }
    return result;
}

static slv_result evaluate(const slv_bake_source *source, const slv_env *env, uint32_t face,
                           slv_res res, slv_rect rect, float *values, uint8_t *misses) {
    const detail *d = (const detail *)source;
    uint32_t most = AT_ONCE / (d->params.samples * d->params.samples), n = d->base.desc.nchannels;
    points *work = NULL;
    slv_result result = slvi_alloc_plain(env, "bake: samples", 1, sizeof *work, &work);
    for (uint32_t y = 0; y < rect.height && !result; y++)
        for (uint32_t x = 0; x < rect.width && !result; x += most) {
            size_t at = (size_t)y * rect.width + x;
            slv_rect part = {rect.x + x, rect.y + y, rect.width - x, 1};
            part.width = part.width < most ? part.width : most;
            result = evaluate_some(d, work, face, res, part, values + at * n, misses + at);
        }
    slvi_free(work);
    return result;
}

static void destroy(slv_bake_source *source) {
    detail *d = (detail *)source;
    slvi_ray_scene_free(&d->scene);
    slvi_closest_destroy(d->closest);
    slvi_cage_destroy(&d->cage);
    slv_surface_destroy(d->detailed);
    slvi_free(d);
}

/* Both meshes in one frame; what does not even touch is told before any ray. */
static slv_result measure(const slv_env *env, const slv_mesh *mesh, detail *d) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double diagonal = 0;
    for (uint32_t i = 0; i < 3 * view->nverts; i++) {
        low[i % 3] = fminf(low[i % 3], view->positions[i]);
        high[i % 3] = fmaxf(high[i % 3], view->positions[i]);
    }
    for (int k = 0; k < 3; k++)
        diagonal += ((double)high[k] - (double)low[k]) * ((double)high[k] - (double)low[k]);
    slvi_cage_bound(&d->cage, d->params.cage, NULL, low, high);
    for (int k = 0; k < 3; k++) {
        d->size = fmaxf(d->size, fmaxf(fabsf(low[k]), fabsf(high[k])));
        d->size = fmaxf(d->size, fmaxf(fabsf(d->scene.low[k]), fabsf(d->scene.high[k])));
    }
    float reach = DEFAULT_REACH * (float)sqrt(diagonal);
    d->params.front = d->params.front > 0 ? d->params.front : reach;
    d->params.back = d->params.back > 0 ? d->params.back : reach;
    float most = fmaxf(d->params.front, d->params.back);
    slv_result result = embree_check_box(env, "rays", low, high);
    if (result)
        return result;
    for (int k = 0; k < 3; k++)
        if (d->scene.low[k] - most > high[k] || d->scene.high[k] + most < low[k])
            return slvi_fail(env, SLV_ERROR_MISMATCH,
                             "bake: the detailed mesh lies elsewhere: along axis %d it goes from "
                             "%g to %g, the other from %g to %g, and rays reach %g",
                             k, (double)d->scene.low[k], (double)d->scene.high[k], (double)low[k],
                             (double)high[k], (double)most);
    return SLV_OK;
}

static slv_result check(const slv_env *env, slv_bake_detail *p) {
    p->samples = p->samples ? p->samples : 2;
    if ((unsigned)p->kind > SLV_BAKE_FACE_VECTOR)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: unknown kind of detail %d", (int)p->kind);
    if (p->cage && p->kind != SLV_BAKE_OBJECT_NORMAL && p->kind != SLV_BAKE_FACE_NORMAL)
        return slvi_fail(
            env, SLV_ERROR_ARGUMENT,
            "bake: a cage is for normals: displacement goes along those of the surface, "
            "vectors to the nearest place");
    if (p->samples > MOST_SIDE)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: %u samples a texel and axis, at most %d",
                         p->samples, MOST_SIDE);
    if (!(p->front >= 0 && p->back >= 0) || !isfinite(p->front) || !isfinite(p->back))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: distances of %g and %g", (double)p->front,
                         (double)p->back);
    return SLV_OK;
}

/* The polygons as they stand, to search them. */
static slv_result begin_vectors(const slv_env *env, const slv_mesh *mesh, const slv_mesh *detailed,
                                detail *d) {
    const slv_surface_params flat = {.scheme = SLV_SCHEME_BILINEAR};
    for (int k = 0; k < 3; k++)
        d->offset[k] =
            (float)(slv_mesh_get_view(mesh)->origin[k] - slv_mesh_get_view(detailed)->origin[k]);
    slv_result result = slv_surface_create(env, detailed, &flat, &d->detailed);
    return result ? result
                  : slvi_closest_create(env, d->detailed,
                                        slvi_closest_segments(detailed, SLV_SCHEME_BILINEAR),
                                        &d->closest);
}

slv_result slv_bake_from_detail(const slv_env *env, const slv_mesh *mesh,
                                const slv_surface *surface, const slv_mesh *detailed,
                                const slv_bake_detail *params, slv_bake_source **out) {
    static const slvi_bake_fns fns = {evaluate, NULL, NULL, destroy, NULL};
    detail *d = NULL;
    slv_bake_detail own = params ? *params : (slv_bake_detail){0};
    *out = NULL;
    slv_result result = check(env, &own);
    if (result || (result = slvi_alloc(env, "bake: detail", 1, sizeof *d, &d)))
        return result;
    d->params = own;
    d->surface = surface;
    bool height = own.kind == SLV_BAKE_DISPLACEMENT, vector = own.kind >= SLV_BAKE_OBJECT_VECTOR;
    d->base = (slv_bake_source){.fns = &fns,
                                .nfaces = slv_mesh_face_count(mesh),
                                .cost = 2 * own.samples * own.samples,
                                .apart = own.kind == SLV_BAKE_FACE_NORMAL ||
                                         own.kind == SLV_BAKE_FACE_VECTOR,
                                .desc = {height || vector ? SLV_TYPE_FLOAT : SLV_TYPE_HALF,
                                         height ? 1 : 3, SLV_NO_ALPHA, SLV_TEXTURE_DATA}};
    if ((result = slvi_ray_scene_of_polygons(env, detailed, slv_mesh_get_view(mesh)->origin,
                                             &d->scene)) ||
        (result = slvi_cage_create(env, mesh, own.cage, own.cage_scheme, &d->cage)) ||
        (result = measure(env, mesh, d)) ||
        (vector && (result = begin_vectors(env, mesh, detailed, d)))) {
        destroy(&d->base);
        return result;
    }
    *out = &d->base;
    return SLV_OK;
}
