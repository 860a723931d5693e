/* What a surface does to the light that falls on it: ambient occlusion, bent normals, thickness.
 * Rays begin all over a texel, on the triangles that they are cast at, so that none begins behind
 * them. */
#include "rays/texel_rays.h"
#include "source/source.h"
#include "source/vectors.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/processor.h"
#include "base/progress.h"

#include <math.h>
#include <string.h>

enum { DEFAULT_SAMPLES = 256, MOST_SAMPLES = 1 << 16, DEFAULT_SEGMENTS = 16 };

typedef struct occlusion {
    slv_bake_source base;
    slv_bake_rays params;
    slv_tessellation tessellation;
    ray_scene scene;
    reference_sampler sampler;
    ray_ground ground;
    slvi_texel_rays *texel_rays; /* for this processor */
} occlusion;

typedef struct tally {
    double open, distance, direction[3];
    uint32_t hits;
} tally;

static void cast(const occlusion *o, struct RTCRay *rays, uint32_t count, tally *t) {
    if (o->params.kind != SLV_BAKE_THICKNESS)
        slvi_rays_block(&o->scene, rays, count);
    for (uint32_t i = 0; i < count; i++) {
        const struct RTCRay *ray = &rays[i];
        const float origin[3] = {ray->org_x, ray->org_y, ray->org_z},
                    direction[3] = {ray->dir_x, ray->dir_y, ray->dir_z};
        if (o->params.kind == SLV_BAKE_THICKNESS) {
            float distance =
                slvi_ray_cast(&o->scene, origin, direction, o->ground.limit, NULL, NULL);
            t->hits += isfinite(distance);
            t->distance += isfinite(distance) ? (double)distance : 0;
        } else if (!(ray->tfar < 0)) {
            t->open++;
            for (int k = 0; k < 3; k++)
                t->direction[k] += (double)direction[k];
        }
    }
}

/* Where nothing is open: the smooth normal in the middle of the texel. */
static void middle_normal(const slv_tessellation *t, const ray_texel *texel, float out[3]) {
    const uint32_t n = t->segments[texel->face];
    const float x = ((float)texel->x + 0.5f) / (float)(1u << texel->res.u) * (float)n,
                y = ((float)texel->y + 0.5f) / (float)(1u << texel->res.v) * (float)n;
    const uint32_t cx = (uint32_t)x < n ? (uint32_t)x : n - 1,
                   cy = (uint32_t)y < n ? (uint32_t)y : n - 1;
    const float fx = x - (float)cx, fy = y - (float)cy;
    const slv_vertex *low = t->vertices + t->first[texel->face] + (size_t)cy * (n + 1) + cx,
                     *high = low + n + 1;
    for (int k = 0; k < 3; k++)
        out[k] = (low[0].normal[k] * (1 - fx) + low[1].normal[k] * fx) * (1 - fy) +
                 (high[0].normal[k] * (1 - fx) + high[1].normal[k] * fx) * fy;
    slvi_normalise(out);
}

static void store(const occlusion *o, const tally *t, const ray_texel *texel, float *out,
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
        if (!(length > 0))
            middle_normal(&o->tessellation, texel, out);
        for (int k = 0; k < 3 && length > 0; k++)
            out[k] = (float)(d[k] / length);
    }
}

static slv_result evaluate(const slv_bake_source *source, const slv_env *env, uint32_t face,
                           slv_res res, slv_rect rect, float *values, uint8_t *misses) {
    const occlusion *o = (const occlusion *)source;
    uint32_t n = o->base.desc.nchannels;
    (void)env;
    if (!o->tessellation.segments[face])
        return SLV_OK; /* a hole is not there */
    for (uint32_t i = 0; i < rect.width * rect.height; i++) {
        const ray_texel texel = {face, rect.x + i % rect.width, rect.y + i / rect.width, res};
        struct RTCRay rays[SLVI_TEXEL_RAYS];
        tally t = {0};
        for (uint32_t k = 0; k < o->params.samples; k += SLVI_TEXEL_RAYS) {
            const uint32_t left = o->params.samples - k,
                           count = left < SLVI_TEXEL_RAYS ? left : SLVI_TEXEL_RAYS;
            o->texel_rays(&o->ground, &texel, k, count, rays);
            cast(o, rays, count, &t);
        }
        store(o, &t, &texel, values + (size_t)i * n, &misses[i]);
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

static slvi_texel_rays *best_rays(void) {
#define KIND_OR(KIND) slvi_has_##KIND() ? slvi_texel_rays_##KIND:
    return SLVI_RAYS_PROCESSORS(KIND_OR) NULL;
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
    o->params.progress = (slv_progress){0};
    o->texel_rays = best_rays();
    bool bent = own.kind == SLV_BAKE_BENT_NORMAL;
    o->base = (slv_bake_source){.fns = &fns,
                                .nfaces = slv_mesh_face_count(mesh),
                                .cost = own.samples,
                                .desc = {own.kind == SLV_BAKE_AO ? SLV_TYPE_U8
                                         : bent                  ? SLV_TYPE_HALF
                                                                 : SLV_TYPE_FLOAT,
                                         bent ? 3 : 1, SLV_NO_ALPHA, SLV_TEXTURE_DATA}};
    if ((result = slv_mesh_adjacency(env, mesh, &adjacency)) ||
        (result = slvi_progress(&own.progress, env, "bake", 0, 1)) ||
        (result = slv_tessellate(env, mesh, surface, adjacency, own.segments, &o->tessellation)) ||
        (result = slvi_progress(&own.progress, env, "bake", 0, 1)) ||
        (result = slvi_ray_scene_of_surface(env, &o->tessellation, &own.progress, &o->scene)) ||
        (result =
             slvi_reference_sampler_create(env, SLV_PIXEL_BOX, own.seed, own.samples, &o->sampler)))
        goto done;
    float size = 0;
    for (int k = 0; k < 3; k++)
        size = fmaxf(size, fmaxf(fabsf(o->scene.low[k]), fabsf(o->scene.high[k])));
    o->ground = (ray_ground){.tessellation = &o->tessellation,
                             .sampler = &o->sampler,
                             .offset = o->scene.nvertices ? 4e-6f * size : 0,
                             .limit = own.distance > 0 ? own.distance : INFINITY,
                             .inwards = own.kind == SLV_BAKE_THICKNESS};
    *out = &o->base;
    o = NULL;
done:
    slv_adjacency_destroy(adjacency);
    if (o)
        destroy(&o->base);
    return result;
}
