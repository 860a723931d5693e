/* What a surface does to the light that falls on it: ambient occlusion, bent normals, thickness.
 * Rays begin all over a texel, on the triangles that they are cast at, so that none begins behind
 * them. */
#include "rays/ray_scene.h"
#include "rays/reference_data.h"
#include "source/source.h"

#include "base/log.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

enum { DEFAULT_SAMPLES = 256, MOST_SAMPLES = 1 << 16, DEFAULT_SEGMENTS = 16, AT_ONCE = 64 };

typedef struct occlusion {
    slv_bake_source base;
    slv_bake_rays params;
    slv_tessellation tessellation;
    ray_scene scene;
    reference_sampler sampler;
    float offset; /* from the surface, where rays begin */
} occlusion;

typedef float four __attribute__((vector_size(16))); /* three of them count */

static inline four load(const float *from) {
    return (four){from[0], from[1], from[2], 0};
}

static inline float length_of(four x) {
    return sqrtf(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
}

typedef struct surface_place {
    four point, flat, smooth; /* the normal across the triangle, and the smooth one */
} surface_place;

/* The point of the tessellation at (u,v). */
static inline surface_place surface_at(const occlusion *o, uint32_t face, float u, float v) {
    uint32_t n = o->tessellation.segments[face];
    float x = u * (float)n, y = v * (float)n;
    uint32_t cx = (uint32_t)x < n ? (uint32_t)x : n - 1, cy = (uint32_t)y < n ? (uint32_t)y : n - 1;
    float fx = x - (float)cx, fy = y - (float)cy;
    const slv_vertex *a =
        o->tessellation.vertices + o->tessellation.first[face] + cy * (n + 1) + cx;
    const slv_vertex *c = a + n + 2, *b = fx > fy ? a + 1 : a + n + 1;
    /* on the triangle a, c and the corner between them on this side of the diagonal */
    const float wb = fabsf(fx - fy), wc = fx < fy ? fx : fy, wa = 1 - wb - wc;
    const four pa = load(a->position), pb = load(b->position), pc = load(c->position), ab = pb - pa,
               ac = pc - pa;
    surface_place p = {.point = wa * pa + wb * pb + wc * pc,
                       .smooth =
                           wa * load(a->normal) + wb * load(b->normal) + wc * load(c->normal)};
    p.flat =
        __builtin_shufflevector(ab, ab, 1, 2, 0, 3) * __builtin_shufflevector(ac, ac, 2, 0, 1, 3) -
        __builtin_shufflevector(ab, ab, 2, 0, 1, 3) * __builtin_shufflevector(ac, ac, 1, 2, 0, 3);
    p.flat = fx > fy ? p.flat : -p.flat;
    const float across = length_of(p.flat), along = length_of(p.smooth);
    p.flat = across > 0 ? p.flat * (1 / across) : p.smooth;
    p.smooth = along > 0 ? p.smooth * (1 / along) : p.flat;
    return p;
}

/* Two directions across a normal (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"). */
static void basis(const float n[3], float a[3], float b[3]) {
    float sign = copysignf(1.0f, n[2]), p = -1.0f / (sign + n[2]), q = n[0] * n[1] * p;
    a[0] = 1.0f + sign * n[0] * n[0] * p;
    a[1] = sign * q;
    a[2] = -sign * n[0];
    b[0] = q;
    b[1] = sign + n[1] * n[1] * p;
    b[2] = -n[1];
}

/* As likely as its cosine to the normal. */
static void direction_of(const float normal[3], const float random[2], float out[3]) {
    float a[3], b[3], radius = sqrtf(random[0]), angle = 6.28318531f * random[1];
    float x = radius * cosf(angle), y = radius * sinf(angle), z = sqrtf(1 - random[0]);
    basis(normal, a, b);
    for (int k = 0; k < 3; k++)
        out[k] = x * a[k] + y * b[k] + z * normal[k];
}

typedef struct tally {
    double open, distance, direction[3];
    uint32_t hits;
} tally;

typedef struct one_ray {
    float origin[3], direction[3];
} one_ray;

static inline one_ray ray_at(const occlusion *o, uint32_t face, float u, float v,
                             const float random[2]) {
    const surface_place p = surface_at(o, face, u, v);
    const float side = o->params.kind == SLV_BAKE_THICKNESS ? -1 : 1;
    const four n = side * p.smooth, from = p.point + side * o->offset * p.flat;
    const float normal[3] = {n[0], n[1], n[2]};
    one_ray ray = {.origin = {from[0], from[1], from[2]}};
    direction_of(normal, random, ray.direction);
    return ray;
}

static void cast(const occlusion *o, const one_ray *ray, float limit, tally *t) {
    if (o->params.kind == SLV_BAKE_THICKNESS) {
        float distance = slvi_ray_cast(&o->scene, ray->origin, ray->direction, limit, NULL, NULL);
        t->hits += isfinite(distance);
        t->distance += isfinite(distance) ? (double)distance : 0;
        return;
    }
    if (slvi_ray_is_blocked(&o->scene, ray->origin, ray->direction, limit))
        return;
    t->open++;
    for (int k = 0; k < 3; k++)
        t->direction[k] += (double)ray->direction[k];
}

static void store(const occlusion *o, const tally *t, uint32_t face, float u, float v, float *out,
                  uint8_t *missed) {
    double samples = o->params.samples;
    if (o->params.kind == SLV_BAKE_AO) {
        out[0] = (float)(t->open / samples);
    } else if (o->params.kind == SLV_BAKE_THICKNESS) {
        out[0] = t->hits ? (float)(t->distance / t->hits) : 0;
        *missed = t->hits ? SLV_BAKE_HIT : SLV_BAKE_NO_HIT;
    } else {
        const double *d = t->direction;
        double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        /* where nothing is open, the normal as it is */
        const four smooth = surface_at(o, face, u, v).smooth;
        for (int k = 0; k < 3; k++)
            out[k] = length > 0 ? (float)(d[k] / length) : smooth[k];
    }
}

static slv_result evaluate(const slv_bake_source *source, const slv_env *env, uint32_t face,
                           slv_res res, slv_rect rect, float *values, uint8_t *misses) {
    const occlusion *o = (const occlusion *)source;
    uint32_t n = o->base.desc.nchannels;
    float limit = o->params.distance > 0 ? o->params.distance : INFINITY;
    const float du = 1 / (float)(1u << res.u), dv = 1 / (float)(1u << res.v);
    (void)env;
    if (!o->tessellation.segments[face])
        return SLV_OK; /* a hole is not there */
    for (uint32_t i = 0; i < rect.width * rect.height; i++) {
        uint32_t x = rect.x + i % rect.width, y = rect.y + i / rect.width;
        uint32_t texel = y << res.u | x;
        reference_sequence place = slvi_reference_sequence_begin(&o->sampler, texel, face, 0),
                           way = slvi_reference_sequence_begin(&o->sampler, texel, face, 1);
        tally t = {0};
        /* rays are made before any is cast: processors make several at a time then */
        for (uint32_t k = 0; k < o->params.samples;) {
            one_ray rays[AT_ONCE];
            uint32_t count = 0;
            for (; count < AT_ONCE && k < o->params.samples; count++, k++) {
                float at[2], random[2];
                slvi_reference_sample(&o->sampler, &place, k, at);
                slvi_reference_sample(&o->sampler, &way, k, random);
                rays[count] =
                    ray_at(o, face, ((float)x + at[0]) * du, ((float)y + at[1]) * dv, random);
            }
            for (uint32_t r = 0; r < count; r++)
                cast(o, &rays[r], limit, &t);
        }
        store(o, &t, face, ((float)x + 0.5f) / (float)(1u << res.u),
              ((float)y + 0.5f) / (float)(1u << res.v), values + (size_t)i * n, &misses[i]);
    }
    return SLV_OK;
}

static void destroy(slv_bake_source *source) {
    occlusion *o = (occlusion *)source;
    slvi_ray_scene_free(&o->scene);
    slv_tessellation_free(&o->tessellation);
    slvi_reference_sampler_free(&o->sampler);
    slvi_free(o);
}

static slv_result check(const slv_env *env, slv_bake_rays *params) {
    params->samples = params->samples ? params->samples : DEFAULT_SAMPLES;
    params->segments = params->segments ? params->segments : DEFAULT_SEGMENTS;
    if ((unsigned)params->kind > SLV_BAKE_THICKNESS)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: unknown kind of rays %d",
                         (int)params->kind);
    if (params->samples > MOST_SAMPLES)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: %u rays a texel, at most %d",
                         params->samples, MOST_SAMPLES);
    if (!(params->distance >= 0) || !isfinite(params->distance))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: a distance of %g",
                         (double)params->distance);
    return SLV_OK;
}

slv_result slv_bake_from_rays(const slv_env *env, const slv_mesh *mesh, const slv_surface *surface,
                              const slv_bake_rays *params, slv_bake_source **out) {
    static const slvi_bake_fns fns = {evaluate, NULL, NULL, destroy, NULL};
    occlusion *o = NULL;
    slv_adjacency *adjacency = NULL;
    slv_bake_rays own = params ? *params : (slv_bake_rays){0};
    *out = NULL;
    slv_result result = check(env, &own);
    if (result || (result = slvi_alloc(env, "bake: rays", 1, sizeof *o, &o)))
        return result;
    o->params = own;
    bool bent = own.kind == SLV_BAKE_BENT_NORMAL;
    o->base = (slv_bake_source){.fns = &fns,
                                .nfaces = slv_mesh_face_count(mesh),
                                .cost = own.samples,
                                .desc = {own.kind == SLV_BAKE_AO ? SLV_TYPE_U8
                                         : bent                  ? SLV_TYPE_HALF
                                                                 : SLV_TYPE_FLOAT,
                                         bent ? 3 : 1, SLV_NO_ALPHA, SLV_TEXTURE_DATA}};
    if ((result = slv_mesh_adjacency(env, mesh, &adjacency)) ||
        (result = slv_tessellate(env, mesh, surface, adjacency, own.segments, &o->tessellation)) ||
        (result = slvi_ray_scene_of_surface(env, &o->tessellation, &o->scene)) ||
        (result =
             slvi_reference_sampler_create(env, SLV_PIXEL_BOX, own.seed, own.samples, &o->sampler)))
        goto done;
    float size = 0;
    for (int k = 0; k < 3; k++)
        size = fmaxf(size, fmaxf(fabsf(o->scene.low[k]), fabsf(o->scene.high[k])));
    o->offset = o->scene.nvertices ? 4e-6f * size : 0;
    *out = &o->base;
    o = NULL;
done:
    slv_adjacency_destroy(adjacency);
    if (o)
        destroy(&o->base);
    return result;
}
