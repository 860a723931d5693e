/* The reference picture: many samples of every pixel, and how sure their mean is. */
#include "rays/reference_data.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/progress.h"

#include <selvage/half.h>

#include <math.h>
#include <string.h>

enum { TILE = 16, RAYS = 16 };

typedef struct work {
    const slv_env *env;
    const slv_reference *reference;
    const slv_reference_frame *frame;
    reference_sampler sampler;
    reference_eye eye;
    uint32_t tiles_across;
    uint64_t ntiles;
    slvi_steps steps;
    slv_image image, error;
} work;

/* What a half of a pixel's samples add up to. */
typedef struct sum {
    double weighted[4], plain[4], weight;
    uint32_t count;
} sum;

/* Rays of one or more pixels on their way through the scene. */
typedef struct packet {
    struct RTCRayHit16 rays;
    float x[RAYS], y[RAYS], weight[RAYS]; /* in eye units on the window's plane */
    sum *to[RAYS];
    _Alignas(64) int valid[RAYS]; /* as Embree reads it */
    uint32_t count;
} packet;

static void intersect(const slv_reference *reference, packet *p) {
#if SLV_EMBREE_VERSION >= 4
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    rtcIntersect16(p->valid, reference->scene, &p->rays, &arguments);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(p->valid, reference->scene, &context, &p->rays);
#endif
}

/* A colour of full saturation for 0..1, as the renderer's shader makes it. */
static void hue(float h, float rgb[3]) {
    static const float turn[3] = {0.0f, 2.0f / 3, 1.0f / 3};
    for (int c = 0; c < 3; c++) {
        float at = h + turn[c];
        rgb[c] = reference_clamp(fabsf((at - floorf(at)) * 6 - 3) - 1, 1.0f);
    }
}

static void face_color(uint32_t face, float u, float v, float rgb[3]) {
    uint32_t h = face * 0x9E3779B9u;
    h = (h ^ h >> 15) * 0x85EBCA6Bu;
    h ^= h >> 13;
    hue((float)(h & 1023) / 1024, rgb);
    float rim = fmaxf(fabsf(u - 0.5f), fabsf(v - 0.5f)) > 0.48f ? 0.6f : 1.0f;
    for (int c = 0; c < 3; c++)
        rgb[c] = (0.8f + 0.6f * (rgb[c] - 0.8f)) * rim;
}

/* Between the three vertices of the triangle that was hit; any length. */
static void normal_at(const work *w, const uint32_t *quad, float s, float t, float normal[3]) {
    const slv_vertex *vertices = w->reference->mesh.vertices;
    bool far_side = s + t > 1;
    const float *a = vertices[quad[far_side ? 2 : 0]].normal;
    const float *b = vertices[quad[far_side ? 3 : 1]].normal;
    const float *c = vertices[quad[far_side ? 1 : 3]].normal;
    float q = far_side ? 1 - s : s, r = far_side ? 1 - t : t;
    for (int k = 0; k < 3; k++)
        normal[k] = a[k] + q * (b[k] - a[k]) + r * (c[k] - a[k]);
}

static float length_of(const float v[3]) {
    return fmaxf(sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]), 1e-20f);
}

/* -dot(n, i) */
static float facing(const work *w, const float normal[3], float x, float y) {
    const float *m = w->eye.normal_matrix;
    float n[3];
    for (int k = 0; k < 3; k++)
        n[k] = m[3 * k] * normal[0] + m[3 * k + 1] * normal[1] + m[3 * k + 2] * normal[2];
    float length = length_of(n);
    if (!w->eye.perspective)
        return n[2] / length;
    return (n[2] - n[0] * x - n[1] * y) / (length * sqrtf(x * x + y * y + 1));
}

/* (u,v) of a hit, between those of the three vertices of the triangle. */
static void place(const slv_tessellation *mesh, const uint32_t *quad, float s, float t,
                  float uv[2]) {
    bool far_side = s + t > 1;
    const uint16_t *a = mesh->vertices[quad[far_side ? 2 : 0]].uv;
    const uint16_t *b = mesh->vertices[quad[far_side ? 3 : 1]].uv;
    const uint16_t *c = mesh->vertices[quad[far_side ? 1 : 3]].uv;
    float q = far_side ? 1 - s : s, r = far_side ? 1 - t : t;
    for (int k = 0; k < 2; k++) {
        float from = slv_half_to_float(a[k]);
        uv[k] = from + q * (slv_half_to_float(b[k]) - from) + r * (slv_half_to_float(c[k]) - from);
    }
}

/* The colour of a hit, multiplied by alpha. */
static void shade(const work *w, const packet *p, uint32_t lane, float rgba[4]) {
    const slv_reference *reference = w->reference;
    const slv_tessellation *mesh = &reference->mesh;
    const struct RTCHit16 *hit = &p->rays.hit;
    const uint32_t *quad = reference->quads + 4 * (size_t)hit->primID[lane];
    float s = hit->u[lane], t = hit->v[lane], ka = w->frame->ka, kd = w->frame->kd;
    uint32_t face = (uint32_t)mesh->vertices[quad[3]].face;
    float uv[2];
    place(mesh, quad, s, t, uv);
    float u = uv[0], v = uv[1];
    float light = 1;
    reference_color(reference, face, u, v, rgba);
    if (w->frame->shading == SLV_SHADE_FACES) {
        face_color(face, u, v, rgba);
        for (int c = 0; c < 3; c++)
            rgba[c] *= rgba[3];
    }
    if (reference->alpha == SLV_ALPHA_MASK) {
        bool there = rgba[3] >= 0.5f;
        for (int c = 0; c < 4; c++)
            rgba[c] = there ? rgba[c] / rgba[3] : 0;
    }
    if (w->frame->shading == SLV_SHADE_UNLIT)
        return;
    float normal[3];
    normal_at(w, quad, s, t, normal);
    if (w->frame->shading == SLV_SHADE_IMAGE) {
        float length = length_of(normal), rgb[3];
        for (int c = 0; c < 3; c++)
            normal[c] /= length;
        slv_light_at(w->frame->light, normal, rgb);
        for (int c = 0; c < 3; c++)
            rgba[c] *= rgb[c];
        return;
    }
    float front = facing(w, normal, p->x[lane], p->y[lane]);
    if (w->frame->shading == SLV_SHADE_HEADLIGHT)
        light = kd * fmaxf(front, 0) + ka;
    else if (w->frame->shading == SLV_SHADE_HEADLIGHT_ABS)
        light = kd * reference_clamp(fabsf(front) + ka, 1.0f);
    else if (w->frame->shading == SLV_SHADE_HEADLIGHT_COS2)
        light = kd * front * front + ka;
    else
        light = kd * fabsf(front) + ka;
    for (int c = 0; c < 3; c++)
        rgba[c] *= light;
}

/* Lets rays that were not stopped go on behind what they hit. */
static bool go_on(const work *w, packet *p, const float left[RAYS]) {
    bool any = false;
    for (uint32_t lane = 0; lane < p->count; lane++) {
        float at = p->rays.ray.tfar[lane];
        if (p->valid[lane] && left[lane] <= 0)
            p->valid[lane] = 0;
        if (!p->valid[lane])
            continue;
        p->rays.ray.tnear[lane] = at + 2e-6f * (at + w->reference->step);
        p->rays.ray.tfar[lane] = INFINITY;
        p->rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        p->rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
        any = true;
    }
    return any;
}

static void flush(const work *w, packet *p) {
    if (!p->count)
        return;
    for (uint32_t lane = 0; lane < RAYS; lane++)
        p->valid[lane] = lane < p->count ? -1 : 0;
    float seen[RAYS][4] = {{0}}, left[RAYS];
    for (uint32_t lane = 0; lane < RAYS; lane++)
        left[lane] = 1;
    do {
        intersect(w->reference, p);
        for (uint32_t lane = 0; lane < p->count; lane++) {
            float rgba[4];
            if (!p->valid[lane])
                continue;
            bool missed = p->rays.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID;
            if (missed)
                memcpy(rgba, w->frame->background, sizeof rgba);
            else
                shade(w, p, lane, rgba);
            for (int c = 0; c < 4; c++)
                seen[lane][c] += left[lane] * rgba[c];
            left[lane] = missed ? 0 : left[lane] * (1 - rgba[3]);
        }
    } while (go_on(w, p, left));
    for (uint32_t lane = 0; lane < p->count; lane++) {
        const float *rgba = seen[lane];
        sum *to = p->to[lane];
        float weight = p->weight[lane];
        for (int c = 0; c < 4; c++) {
            to->weighted[c] += (double)(weight * rgba[c]);
            to->plain[c] += (double)rgba[c];
        }
        to->weight += (double)weight;
        to->count++;
    }
    p->count = 0;
}

static void add_ray(const work *w, packet *p, float pixel_x, float pixel_y, float weight, sum *to) {
    const reference_eye *e = &w->eye;
    struct RTCRay16 *ray = &p->rays.ray;
    const float *window = e->window;
    uint32_t lane = p->count++;
    float x = window[0] + pixel_x / (float)w->frame->width * (window[1] - window[0]);
    float y = window[3] - pixel_y / (float)w->frame->height * (window[3] - window[2]);
    float origin[3], direction[3];
    reference_eye_ray(e, x, y, origin, direction);
    ray->org_x[lane] = origin[0];
    ray->org_y[lane] = origin[1];
    ray->org_z[lane] = origin[2];
    ray->dir_x[lane] = direction[0];
    ray->dir_y[lane] = direction[1];
    ray->dir_z[lane] = direction[2];
    ray->tnear[lane] = e->perspective ? e->nearest : 0;
    ray->tfar[lane] = INFINITY;
    ray->time[lane] = 0;
    ray->mask[lane] = UINT32_MAX;
    ray->id[lane] = lane;
    ray->flags[lane] = 0;
    p->rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    p->rays.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
    p->x[lane] = x;
    p->y[lane] = y;
    p->weight[lane] = weight;
    p->to[lane] = to;
    if (p->count == RAYS)
        flush(w, p);
}

/* The weights' mean is 1 only in the long run. What it lacks is filled with the plain mean, so that
 * equal samples give their value, and nothing is divided by weights that may cancel out. */
static double estimate(const sum *s, int channel) {
    double n = s->count;
    return (s->weighted[channel] + (1 - s->weight / n) * s->plain[channel]) / n;
}

static void finish_pixel(work *w, uint32_t x, uint32_t y, const sum halves[2]) {
    size_t at = (size_t)y * w->frame->width + x;
    sum all = halves[0];
    double squares = 0;
    for (int c = 0; c < 4; c++) {
        all.weighted[c] += halves[1].weighted[c];
        all.plain[c] += halves[1].plain[c];
    }
    all.weight += halves[1].weight;
    all.count += halves[1].count;
    for (int c = 0; c < 4; c++)
        w->image.pixels[4 * at + (size_t)c] = (float)estimate(&all, c);
    for (int c = 0; c < 3 && w->frame->samples > 1; c++) {
        double apart = estimate(&halves[0], c) - estimate(&halves[1], c);
        squares += apart * apart / 4;
    }
    w->error.pixels[at] = (float)sqrt(squares / 3);
}

static slv_result render_tile(work *w, uint64_t tile) {
    const slv_reference_frame *frame = w->frame;
    uint32_t left = (uint32_t)(tile % w->tiles_across) * TILE;
    uint32_t top = (uint32_t)(tile / w->tiles_across) * TILE;
    uint32_t width = frame->width - left < TILE ? frame->width - left : TILE;
    uint32_t height = frame->height - top < TILE ? frame->height - top : TILE;
    sum sums[TILE * TILE][2];
    packet p = {.count = 0};
    memset(sums, 0, sizeof sums);
    for (uint32_t i = 0; i < width * height; i++) {
        uint32_t x = left + i % width, y = top + i / width;
        for (uint32_t half = 0; half < 2; half++) {
            reference_sequence sequence = slvi_reference_sequence_begin(&w->sampler, x, y, half);
            for (uint32_t k = 0; k < (frame->samples + 1 - half) / 2; k++) {
                float offset[2], weight = slvi_reference_sample(&w->sampler, &sequence, k, offset);
                add_ray(w, &p, (float)x + offset[0], (float)y + offset[1], weight, &sums[i][half]);
            }
        }
    }
    flush(w, &p);
    for (uint32_t i = 0; i < width * height; i++)
        finish_pixel(w, left + i % width, top + i / width, sums[i]);
    return slvi_steps_add(&w->steps, w->env, "reference", 1);
}

static slv_result render_tiles(void *user, uint64_t first, uint64_t end) {
    slv_result result = SLV_OK;
    for (uint64_t tile = first; tile < end && !result; tile++)
        result = render_tile(user, tile);
    return result;
}

static slv_result prepare(const slv_env *env, const slv_reference_frame *given,
                          slv_reference_frame *frame) {
    *frame = *given;
    frame->width = frame->width ? frame->width : 512;
    frame->height = frame->height ? frame->height : 512;
    frame->samples = frame->samples ? frame->samples : 64;
    if (frame->ka == 0 && frame->kd == 0) {
        frame->ka = 0.2f;
        frame->kd = 0.8f;
    }
    if (frame->samples > SLV_REFERENCE_MAX_SAMPLES)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "reference: %u samples per pixel, the most is %u",
                         frame->samples, SLV_REFERENCE_MAX_SAMPLES);
    if ((unsigned)frame->filter > SLV_PIXEL_MITCHELL)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "reference: there is no pixel filter %d",
                         (int)frame->filter);
    if ((unsigned)frame->shading > SLV_SHADE_IMAGE)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "reference: there is no shading %d",
                         (int)frame->shading);
    if (frame->shading == SLV_SHADE_IMAGE && !frame->light)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "reference: the shading by an image has no light");
    if (frame->shading == SLV_SHADE_LEVELS)
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED,
                         "reference: the shading by levels is about lookups, of which it has none");
    return SLV_OK;
}

static slv_reference_stats judge(const work *w) {
    size_t npixels = (size_t)w->frame->width * w->frame->height;
    slv_reference_stats stats = {.samples = (uint64_t)npixels * w->frame->samples};
    double squares = 0;
    for (size_t i = 0; i < npixels; i++) {
        double error = (double)w->error.pixels[i];
        squares += error * error;
        stats.worst = error > stats.worst ? error : stats.worst;
        stats.ncovered += w->image.pixels[4 * i + 3] >= 0.5f;
    }
    stats.error = sqrt(squares / (double)npixels);
    if (w->frame->samples == 1)
        stats.error = stats.worst = NAN;
    return stats;
}

static slv_result render(const slv_reference *reference, const slv_env *env,
                         const slv_reference_frame *given, slv_image *image, slv_image *error,
                         slv_reference_stats *stats) {
    slv_reference_frame frame;
    work w = {.env = env, .reference = reference, .frame = &frame};
    slv_result result = prepare(env, given, &frame);
    if (result)
        return result;
    if ((result = slvi_reference_eye_make(env, reference, &frame.camera, &w.eye)) ||
        (result = slv_image_create(env, frame.width, frame.height, 4, &w.image)) ||
        (result = slv_image_create(env, frame.width, frame.height, 1, &w.error)) ||
        (result = slvi_reference_sampler_create(env, frame.filter, frame.seed,
                                                (frame.samples + 1) / 2, &w.sampler)))
        goto done;
    w.tiles_across = (frame.width + TILE - 1) / TILE;
    w.ntiles = (uint64_t)w.tiles_across * ((frame.height + TILE - 1) / TILE);
    slvi_steps_begin(&w.steps, frame.progress, w.ntiles);
    result = slvi_parallel_for(env, w.ntiles, 1, render_tiles, &w);
    slvi_steps_end(&w.steps);
    if (result)
        goto done;
    if (stats)
        *stats = judge(&w);
    *image = w.image;
    memset(&w.image, 0, sizeof w.image);
    if (error) {
        *error = w.error;
        memset(&w.error, 0, sizeof w.error);
    }
done:
    slvi_reference_sampler_free(&w.sampler);
    slv_image_free(&w.image);
    slv_image_free(&w.error);
    return result;
}

slv_result slv_reference_render(const slv_reference *reference, const slv_env *env,
                                const slv_reference_frame *given, slv_image *image,
                                slv_image *error, slv_reference_stats *stats) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, render(reference, &own, given, image, error, stats));
}
