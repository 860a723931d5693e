/* Textures carried over to a changed model, face by face and texel by texel. */
#include "transfer/transfer_data.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "transfer/closest.h"

#include <selvage/ptx.h>

#include <math.h>
#include <string.h>

enum { SEGMENTS = 8, MAX_NEW_LOG2 = 12, MAX_SAMPLES = 4 };
#define MATCH_TOLERANCE 1e-5f  /* of the source's diagonal */
#define OTHER_UNITS 10         /* times larger or smaller is hardly meant */
#define DEFAULT_DISTANCE 0.01f /* of the same */

struct transfer {
    slv_env env;
    const slv_texture *texture;
    const slv_texture_desc *desc;
    slv_texture *out;
    slv_transfer_params params;
    slv_transfer_face *faces;
    float *source_corners, *target_corners;
    slv_surface *source, *target;
    slv_closest *closest;
    transfer_source look;
    slv_res *res; /* of the target's faces */
    int8_t most_log2;
    slvi_steps steps;
};

/* The nearest point that faces the same way, or, if that is too far, that faces any way. */
static slv_closest_hit find(const struct transfer *t, const float *position, const float *normal) {
    float most = t->params.max_distance;
    slv_closest_hit hit = slvi_closest_find(t->closest, position, normal, most);
    if (hit.point.face >= 0 && hit.distance <= most)
        return hit;
    return slvi_closest_find(t->closest, position, NULL, INFINITY);
}

static bool is_near(const struct transfer *t, const slv_closest_hit *hit) {
    return hit->point.face >= 0 && hit->distance <= t->params.max_distance;
}

static int8_t log2_for(const struct transfer *t, double texels) {
    double wanted = texels > 1 ? round(log2(texels)) : 0;
    return (int8_t)fmin(wanted, (double)t->most_log2);
}

/* The most that a new face gets: twice the finest side of the source, more if the target has fewer
 * faces for the same surface. Models of other units would ask for any number. */
static int8_t most_log2(const slv_texture_desc *desc, uint32_t ntarget) {
    int most = 0;
    for (uint32_t face = 0; face < desc->nfaces; face++) {
        most = desc->res[face].u > most ? desc->res[face].u : most;
        most = desc->res[face].v > most ? desc->res[face].v : most;
    }
    if (ntarget && desc->nfaces > ntarget)
        most += (int)ceil(0.5 * log2((double)desc->nfaces / ntarget));
    return (int8_t)(most + 1 < MAX_NEW_LOG2 ? most + 1 : MAX_NEW_LOG2);
}

/* As many texels a length as the source has where the middle of the face lies; where that is not
 * near, there is no density to speak of. */
static slv_res choose_res(const struct transfer *t, uint32_t face, const slv_closest_hit *hit) {
    const float *c = t->target_corners + (size_t)12 * face;
    if (hit->point.face < 0)
        return (slv_res){0, 0};
    slv_res res = t->desc->res[hit->point.face];
    double area = slvi_transfer_area(t->source_corners + (size_t)12 * (size_t)hit->point.face);
    double density = area > 0 ? sqrt(ldexp(1, res.u + res.v) / area) : 0;
    double u = density * (double)slvi_transfer_mean_length(c, c + 3, c + 9, c + 6),
           v = density * (double)slvi_transfer_mean_length(c, c + 9, c + 3, c + 6);
    if (!is_near(t, hit) || !(density > 0) || !isfinite(u) || !isfinite(v))
        return res;
    return (slv_res){log2_for(t, u), log2_for(t, v)};
}

static slv_result prepare_range(void *user, uint64_t first, uint64_t end) {
    struct transfer *t = user;
    for (uint64_t i = first; i < end; i++) {
        slv_transfer_face *f = &t->faces[i];
        const float *corners = t->target_corners + 12 * i;
        f->area = (float)slvi_transfer_area(corners);
        if (f->source >= 0) {
            t->res[i] = slvi_transfer_turned(t->desc->res[f->source], f);
            continue;
        }
        float position[3], normal[3];
        slv_surface_point point = {(int32_t)i, 0.5f, 0.5f};
        slv_surface_arrays arrays = {.positions = position, .normals = normal};
        slv_result result = slv_surface_evaluate(t->target, 1, &point, &arrays);
        if (result)
            return result;
        f->kind = SLV_TRANSFER_RESAMPLED;
        slv_closest_hit hit = find(t, position, normal);
        f->source = hit.point.face;
        t->res[i] = choose_res(t, (uint32_t)i, &hit);
    }
    return SLV_OK;
}

/* What one face needs: points and normals of a row, all values and texels. */
struct buffers {
    slv_surface_point *points;
    float *positions, *normals, *values, *scratch;
    void *texels;
};

static void free_buffers(struct buffers *b) {
    slvi_free(b->points);
    slvi_free(b->positions);
    slvi_free(b->normals);
    slvi_free(b->values);
    slvi_free(b->scratch);
    slvi_free(b->texels);
}

static slv_result allocate(const struct transfer *t, uint64_t w, uint64_t count,
                           struct buffers *b) {
    uint32_t n = t->desc->nchannels;
    slv_result result;
    if ((result = slvi_alloc(&t->env, "points", w, sizeof *b->points, &b->points)) ||
        (result = slvi_alloc(&t->env, "points", w, 3 * sizeof(float), &b->positions)) ||
        (result = slvi_alloc(&t->env, "normals", w, 3 * sizeof(float), &b->normals)) ||
        (result = slvi_alloc(&t->env, "values", count, n * sizeof(float), &b->values)) ||
        (result = slvi_alloc(&t->env, "values", n, sizeof(float), &b->scratch)))
        return result;
    return slvi_alloc(&t->env, "texels", count, n * slv_type_size(t->desc->type), &b->texels);
}

/* Where a row of samples lies: one a texel, or `count` of them across one texel. */
static slv_result evaluate_row(const struct transfer *t, struct buffers *b, uint32_t face,
                               float first, float step, float v, uint64_t count) {
    const slv_surface_arrays arrays = {.positions = b->positions, .normals = b->normals};
    for (uint64_t i = 0; i < count; i++)
        b->points[i] = (slv_surface_point){(int32_t)face, first + step * (float)i, v};
    return slv_surface_evaluate(t->target, count, b->points, &arrays);
}

/* How many samples a side it takes so that no texel of the source is missed; beyond the most, each
 * sample is a mean. */
static uint32_t samples_for(float texel, float finest) {
    float ratio = texel / finest;
    return !(ratio > 1.5f) ? 1 : ratio < MAX_SAMPLES ? (uint32_t)ceilf(ratio) : MAX_SAMPLES;
}

/* A texel that covers many of the source is the mean of a grid of samples. */
static slv_result average(const struct transfer *t, uint32_t face, uint64_t x, uint64_t y,
                          const float size[2], float finest, struct buffers *b, float *out) {
    float w = ldexpf(1, t->res[face].u), h = ldexpf(1, t->res[face].v);
    uint32_t nu = samples_for(size[0], finest), nv = samples_for(size[1], finest), count = 0;
    float footprint = fmaxf(size[0] / (float)nu, size[1] / (float)nv);
    slv_result result = SLV_OK;
    for (uint32_t j = 0; j < nv && !result; j++) {
        float v = ((float)y + ((float)j + 0.5f) / (float)nv) / h;
        result = evaluate_row(t, &b[1], face, ((float)x + 0.5f / (float)nu) / w,
                              1 / ((float)nu * w), v, nu);
        for (uint32_t i = 0; i < nu && !result; i++) {
            slv_closest_hit hit =
                find(t, b[1].positions + 3 * (size_t)i, b[1].normals + 3 * (size_t)i);
            if (hit.point.face < 0 || (t->params.blank && !is_near(t, &hit)))
                continue;
            slvi_transfer_look_up(&t->look, &hit.point, footprint, b->scratch, out);
            count++;
        }
    }
    for (uint32_t c = 0; count && c < t->desc->nchannels; c++)
        out[c] /= (float)count;
    return result;
}

static slv_result resample(const struct transfer *t, uint32_t face) {
    slv_transfer_face *f = &t->faces[face];
    slv_res res = t->res[face];
    uint64_t w = UINT64_C(1) << res.u, h = UINT64_C(1) << res.v, near = 0;
    uint32_t n = t->desc->nchannels;
    const float *c = t->target_corners + (size_t)12 * face;
    const float size[2] = {ldexpf(slvi_transfer_mean_length(c, c + 3, c + 9, c + 6), -res.u),
                           ldexpf(slvi_transfer_mean_length(c, c + 9, c + 3, c + 6), -res.v)};
    struct buffers b[2] = {0};
    slv_result result = allocate(t, w, w * h, &b[0]);
    if (!result)
        result = allocate(t, MAX_SAMPLES, 0, &b[1]);
    for (uint64_t y = 0; y < h && !result; y++) {
        result = evaluate_row(t, b, face, 0.5f / (float)w, 1 / (float)w,
                              ((float)y + 0.5f) / (float)h, w);
        for (uint64_t x = 0; x < w && !result; x++) {
            slv_closest_hit hit = find(t, b->positions + 3 * x, b->normals + 3 * x);
            float *out = b->values + (y * w + x) * n;
            near += is_near(t, &hit);
            f->distance = fmaxf(f->distance, hit.distance);
            if (hit.point.face < 0 || (t->params.blank && !is_near(t, &hit)))
                continue;
            float finest =
                slvi_transfer_finest_texel(&t->look, &hit.point, fmaxf(size[0], size[1]));
            /* what is not covered is not worth a mean of many */
            if (is_near(t, &hit) &&
                (samples_for(size[0], finest) > 1 || samples_for(size[1], finest) > 1))
                result = average(t, face, x, y, size, finest, b, out);
            else
                slvi_transfer_look_up(&t->look, &hit.point, 0, b->scratch, out);
        }
    }
    if (!result) {
        f->covered = (float)near / (float)(w * h);
        f->kind = near == w * h ? SLV_TRANSFER_RESAMPLED
                  : near        ? SLV_TRANSFER_PARTLY
                                : SLV_TRANSFER_FAR;
        slv_ptx_unmultiply(SLV_TYPE_FLOAT, n, t->desc->alpha_channel, b->values, w * h);
        slv_type_from_float(t->desc->type, b->values, w * h * n, b->texels);
        result = slv_texture_set_face(t->out, face, b->texels);
    }
    free_buffers(&b[0]);
    free_buffers(&b[1]);
    return result;
}

static slv_result fill_range(void *user, uint64_t first, uint64_t end) {
    struct transfer *t = user;
    slv_result result = SLV_OK;
    for (uint64_t i = first; i < end && !result; i++) {
        slv_transfer_face *f = &t->faces[i];
        if (f->kind != SLV_TRANSFER_COPIED) {
            result = resample(t, (uint32_t)i);
            continue;
        }
        f->covered = 1;
        result = slvi_transfer_copy(&t->env, t->texture, f, t->out, (uint32_t)i);
    }
    return result ? result : slvi_steps_add(&t->steps, &t->env, "transfer", end - first);
}

static float diagonal_of(uint32_t nfaces, const float *corners) {
    float low[3] = {0}, high[3] = {0};
    for (size_t i = 0; i < (size_t)4 * nfaces; i++)
        for (int k = 0; k < 3; k++) {
            low[k] = i ? fminf(low[k], corners[3 * i + (size_t)k]) : corners[k];
            high[k] = i ? fmaxf(high[k], corners[3 * i + (size_t)k]) : corners[k];
        }
    return slvi_transfer_mean_length(low, high, low, high);
}

static void warn_of_units(const slv_env *env, float source, float target) {
    if (source > OTHER_UNITS * target || target > OTHER_UNITS * source)
        slvi_logf(env, SLV_LOG_WARNING,
                  "the old model's diagonal is %g, the new one's %g: are their units the same?",
                  (double)source, (double)target);
}

static slv_result prepare(const slv_env *env, struct transfer *t, const slv_mesh *source,
                          const slv_mesh *target) {
    slv_surface_params surface = {.scheme = t->params.scheme};
    uint32_t nsource = slv_mesh_face_count(source), ntarget = slv_mesh_face_count(target);
    slv_result result;
    if ((result = slv_mesh_corners(env, source, NULL, &t->source_corners)) ||
        (result = slv_mesh_corners(env, target, NULL, &t->target_corners)) ||
        (result = slv_surface_create(env, source, &surface, &t->source)) ||
        (result = slv_surface_create(env, target, &surface, &t->target)) ||
        (result = slvi_closest_create(env, t->source, SEGMENTS, &t->closest)) ||
        (result =
             slvi_transfer_source_begin(env, source, t->texture, t->source_corners, &t->look)) ||
        (result = slvi_alloc(env, "resolutions", ntarget, sizeof *t->res, &t->res)))
        return result;
    warn_of_units(env, diagonal_of(nsource, t->source_corners),
                  diagonal_of(ntarget, t->target_corners));
    t->most_log2 = most_log2(t->desc, ntarget);
    float diagonal = slvi_closest_diagonal(t->closest);
    if (!(t->params.max_distance > 0))
        t->params.max_distance = DEFAULT_DISTANCE * diagonal;
    return slvi_transfer_match(env, t->params.no_copies ? 0 : nsource, t->source_corners, ntarget,
                               t->target_corners, MATCH_TOLERANCE * diagonal, t->faces);
}

/* The target in the frame of the source's positions. */
static slv_result join_frames(const slv_env *env, const slv_mesh *source, const slv_mesh *target,
                              slv_mesh **out) {
    const slv_mesh_view *from = slv_mesh_get_view(source);
    slv_mesh_view view = *slv_mesh_get_view(target);
    float *positions = NULL;
    *out = NULL;
    if (memcmp(from->origin, view.origin, sizeof view.origin) == 0)
        return SLV_OK;
    slv_result result =
        slvi_alloc_plain(env, "positions", view.nverts, 3 * sizeof *positions, &positions);
    for (size_t i = 0; !result && i < (size_t)3 * view.nverts; i++)
        positions[i] =
            (float)((double)view.positions[i] + (view.origin[i % 3] - from->origin[i % 3]));
    view.positions = positions;
    memcpy(view.origin, from->origin, sizeof view.origin);
    if (!result)
        result = slv_mesh_create(env, &view, out);
    slvi_free(positions);
    return result;
}

slv_result slv_transfer(const slv_env *env, const slv_mesh *source, const slv_texture *texture,
                        const slv_mesh *target, const slv_transfer_params *params,
                        slv_transfer_face *faces, float *covered, slv_texture **out) {
    struct transfer t = {.texture = texture, .desc = slv_texture_get_desc(texture), .faces = faces};
    uint32_t ntarget = slv_mesh_face_count(target);
    slv_parallel_log *log = NULL;
    slv_mesh *joined = NULL;
    double area = 0, near = 0;
    slv_result result = slvi_parallel_env_begin(env, &log, &t.env);
    *out = NULL;
    if (result)
        return result;
    if (params)
        t.params = *params;
    slvi_steps_begin(&t.steps, t.params.progress, ntarget);
    if (t.desc->nfaces != slv_mesh_face_count(source)) {
        result = slvi_fail(env, SLV_ERROR_MISMATCH, "the texture has %u faces, its mesh %u",
                           t.desc->nfaces, slv_mesh_face_count(source));
        goto done;
    }
    if ((result = join_frames(env, source, target, &joined)) ||
        (result = prepare(env, &t, source, joined ? joined : target)) ||
        (result = slvi_parallel_for(env, ntarget, 64, prepare_range, &t)))
        goto done;
    slv_texture_desc desc = *t.desc;
    desc.nfaces = ntarget;
    desc.res = t.res;
    if ((result = slv_texture_create(env, &desc, &t.out)) ||
        (result = slvi_parallel_for(env, ntarget, 4, fill_range, &t)))
        goto done;
    for (uint32_t face = 0; face < ntarget; face++) {
        double own = slvi_transfer_area(t.target_corners + (size_t)12 * face);
        area += own;
        near += own * (double)faces[face].covered;
    }
    if (covered)
        *covered = area > 0 ? (float)(near / area) : 0;
    *out = t.out;
    t.out = NULL;
done:
    slv_mesh_destroy(joined);
    slv_texture_destroy(t.out);
    slvi_closest_destroy(t.closest);
    slvi_transfer_source_end(&t.look);
    slvi_steps_end(&t.steps);
    slv_surface_destroy(t.source);
    slv_surface_destroy(t.target);
    slvi_free(t.source_corners);
    slvi_free(t.target_corners);
    slvi_free(t.res);
    slvi_parallel_env_end(log);
    return result;
}
