/* Textures carried over to a changed model, face by face and texel by texel. */
#include "transfer/transfer_data.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/progress.h"
#include "source/closest.h"

#include <selvage/ptx.h>

#include <math.h>
#include <string.h>

enum { SEGMENTS = 8, MAX_NEW_LOG2 = 12, MAX_SAMPLES = 4 };
#define MATCH_TOLERANCE 1e-5f  /* of the source's diagonal */
#define OTHER_UNITS 10         /* times larger or smaller is hardly meant */
#define DEFAULT_DISTANCE 0.01f /* of the same */

struct transfer {
    slv_env env;
    const slv_transfer_sink *sink;
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
static int8_t most_log2(const transfer_source *source, uint32_t ntarget) {
    int most = 0;
    for (uint32_t face = 0; face < source->desc.nfaces; face++) {
        most = source->faces[face].res.u > most ? source->faces[face].res.u : most;
        most = source->faces[face].res.v > most ? source->faces[face].res.v : most;
    }
    if (ntarget && source->desc.nfaces > ntarget)
        most += (int)ceil(0.5 * log2((double)source->desc.nfaces / ntarget));
    return (int8_t)(most + 1 < MAX_NEW_LOG2 ? most + 1 : MAX_NEW_LOG2);
}

/* As many texels a length as the source has where the middle of the face lies; where that is not
 * near, there is no density to speak of. */
static slv_res choose_res(const struct transfer *t, uint32_t face, const slv_closest_hit *hit) {
    const float *c = t->target_corners + (size_t)12 * face;
    if (hit->point.face < 0)
        return (slv_res){0, 0};
    slv_res res = t->look.faces[hit->point.face].res;
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
            t->res[i] = slvi_transfer_turned(t->look.faces[f->source].res, f);
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

/* What one face needs: points, normals and values of a row, and all texels. */
struct buffers {
    slv_surface_point *points;
    float *positions, *normals, *values;
    void *texels;
};

static void free_buffers(struct buffers *b) {
    slvi_free(b->points);
    slvi_free(b->positions);
    slvi_free(b->normals);
    slvi_free(b->values);
    slvi_free(b->texels);
}

static slv_result allocate(const struct transfer *t, uint64_t w, uint64_t count,
                           struct buffers *b) {
    uint32_t n = t->look.desc.nchannels;
    slv_result result;
    if ((result = slvi_alloc(&t->env, "points", w, sizeof *b->points, &b->points)) ||
        (result = slvi_alloc(&t->env, "points", w, 3 * sizeof(float), &b->positions)) ||
        (result = slvi_alloc(&t->env, "normals", w, 3 * sizeof(float), &b->normals)) ||
        (result = slvi_alloc(&t->env, "values", w, n * sizeof(float), &b->values)))
        return result;
    return slvi_alloc(&t->env, "texels", count, n * slv_type_size(t->look.desc.type), &b->texels);
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

/* A texel that covers many of the source is the mean of a grid of samples. The parameters are the
 * texel, and what is known of it. */
static slv_result average(const struct transfer *t, transfer_tiles *tiles, uint32_t face,
                          const uint64_t at[2], const float size[2], float finest,
                          struct buffers *b, float *out) {
    float w = ldexpf(1, t->res[face].u), h = ldexpf(1, t->res[face].v);
    uint32_t nu = samples_for(size[0], finest), nv = samples_for(size[1], finest), count = 0;
    float footprint = fmaxf(size[0] / (float)nu, size[1] / (float)nv);
    slv_result result = SLV_OK;
    for (uint32_t j = 0; j < nv && !result; j++) {
        float v = ((float)at[1] + ((float)j + 0.5f) / (float)nv) / h;
        result = evaluate_row(t, b, face, ((float)at[0] + 0.5f / (float)nu) / w,
                              1 / ((float)nu * w), v, nu);
        for (uint32_t i = 0; i < nu && !result; i++) {
            slv_closest_hit hit = find(t, b->positions + 3 * (size_t)i, b->normals + 3 * (size_t)i);
            if (hit.point.face < 0 || (t->params.blank && !is_near(t, &hit)))
                continue;
            slvi_transfer_look_up(tiles, &hit.point, footprint, out);
            count++;
        }
    }
    for (uint32_t c = 0; count && c < t->look.desc.nchannels; c++)
        out[c] /= (float)count;
    return result;
}

/* A row of a face's texels; `near` counts those that are covered. */
static slv_result resample_row(const struct transfer *t, transfer_tiles *tiles, uint32_t face,
                               uint64_t y, const float size[2], struct buffers b[2],
                               uint64_t *near) {
    slv_transfer_face *f = &t->faces[face];
    uint64_t w = UINT64_C(1) << t->res[face].u, h = UINT64_C(1) << t->res[face].v;
    uint32_t n = t->look.desc.nchannels;
    slv_result result =
        evaluate_row(t, b, face, 0.5f / (float)w, 1 / (float)w, ((float)y + 0.5f) / (float)h, w);
    memset(b->values, 0, w * n * sizeof *b->values);
    for (uint64_t x = 0; x < w && !result; x++) {
        slv_closest_hit hit = find(t, b->positions + 3 * x, b->normals + 3 * x);
        float *out = b->values + x * n;
        const uint64_t at[2] = {x, y};
        *near += is_near(t, &hit);
        f->distance = fmaxf(f->distance, hit.distance);
        if (hit.point.face < 0 || (t->params.blank && !is_near(t, &hit)))
            continue;
        float finest = slvi_transfer_finest_texel(&t->look, &hit.point, fmaxf(size[0], size[1]));
        /* what is not covered is not worth a mean of many */
        if (is_near(t, &hit) &&
            (samples_for(size[0], finest) > 1 || samples_for(size[1], finest) > 1))
            result = average(t, tiles, face, at, size, finest, &b[1], out);
        else
            slvi_transfer_look_up(tiles, &hit.point, 0, out);
        result = result ? result : tiles->result;
    }
    slv_ptx_unmultiply(SLV_TYPE_FLOAT, n, t->look.desc.alpha_channel, b->values, w);
    return result;
}

static slv_result resample(const struct transfer *t, transfer_tiles *tiles, uint32_t face) {
    slv_transfer_face *f = &t->faces[face];
    slv_res res = t->res[face];
    uint64_t w = UINT64_C(1) << res.u, h = UINT64_C(1) << res.v, near = 0;
    const slv_source_desc *desc = &t->look.desc;
    size_t row = w * desc->nchannels;
    const float *c = t->target_corners + (size_t)12 * face;
    const float size[2] = {ldexpf(slvi_transfer_mean_length(c, c + 3, c + 9, c + 6), -res.u),
                           ldexpf(slvi_transfer_mean_length(c, c + 9, c + 3, c + 6), -res.v)};
    struct buffers b[2] = {0};
    slv_result result = allocate(t, w, w * h, &b[0]);
    if (!result)
        result = allocate(t, MAX_SAMPLES, 0, &b[1]);
    for (uint64_t y = 0; y < h && !result; y++) {
        result = resample_row(t, tiles, face, y, size, b, &near);
        if (!result)
            slv_type_from_float(desc->type, b->values, row,
                                (char *)b->texels + y * row * slv_type_size(desc->type));
    }
    if (!result) {
        f->covered = (float)near / (float)(w * h);
        f->kind = near == w * h ? SLV_TRANSFER_RESAMPLED
                  : near        ? SLV_TRANSFER_PARTLY
                                : SLV_TRANSFER_FAR;
        result = t->sink->face(t->sink->user, &t->env, face, false, b->texels);
    }
    free_buffers(&b[0]);
    free_buffers(&b[1]);
    return result;
}

/* Texels of a face with the same corners, as they are. */
static slv_result copy(const struct transfer *t, uint32_t face) {
    slv_transfer_face *f = &t->faces[face];
    const slv_source_face *from = &t->look.faces[f->source];
    const slv_source_desc *desc = &t->look.desc;
    bool constant = from->flags & SLV_FACE_CONSTANT;
    slv_res res = constant ? (slv_res){0, 0} : from->res;
    const slv_rect all = {0, 0, 1u << res.u, 1u << res.v};
    size_t pixel = slv_type_size(desc->type) * desc->nchannels;
    uint64_t count = (uint64_t)all.width * all.height;
    bool turned = f->turn || f->flipped;
    uint8_t *in = NULL, *out = NULL;
    slv_result result = slvi_alloc_plain(&t->env, "texels", count, pixel, &in);
    if (!result && turned)
        result = slvi_alloc_plain(&t->env, "texels", count, pixel, &out);
    if (!result)
        result = t->look.texels.fns->read(t->look.texels.user, (uint32_t)f->source, res, all, in);
    if (!result && turned)
        slvi_transfer_turn(f, res, pixel, in, out);
    f->covered = 1;
    if (!result)
        result = t->sink->face(t->sink->user, &t->env, face, constant, turned ? out : in);
    slvi_free(in);
    slvi_free(out);
    return result;
}

static slv_result fill_range(void *user, uint64_t first, uint64_t end) {
    struct transfer *t = user;
    transfer_tiles tiles;
    slv_result result = SLV_OK;
    slvi_transfer_tiles_begin(&t->env, &t->look, &tiles);
    for (uint64_t i = first; i < end && !result; i++)
        result = t->faces[i].kind == SLV_TRANSFER_COPIED ? copy(t, (uint32_t)i)
                                                         : resample(t, &tiles, (uint32_t)i);
    slvi_transfer_tiles_end(&tiles);
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

static slv_result prepare(const slv_env *env, struct transfer *t, const slv_source *texels,
                          const slv_mesh *source, const slv_mesh *target) {
    slv_surface_params surface = {.scheme = t->params.scheme};
    uint32_t nsource = slv_mesh_face_count(source), ntarget = slv_mesh_face_count(target);
    slv_result result;
    if ((result = slv_mesh_corners(env, source, NULL, &t->source_corners)) ||
        (result = slv_mesh_corners(env, target, NULL, &t->target_corners)) ||
        (result = slv_surface_create(env, source, &surface, &t->source)) ||
        (result = slv_surface_create(env, target, &surface, &t->target)) ||
        (result = slvi_closest_create(env, t->source, SEGMENTS, &t->closest)) ||
        (result = slvi_transfer_source_begin(env, source, texels, t->source_corners, &t->look)) ||
        (result = slvi_alloc(env, "resolutions", ntarget, sizeof *t->res, &t->res)))
        return result;
    warn_of_units(env, diagonal_of(nsource, t->source_corners),
                  diagonal_of(ntarget, t->target_corners));
    t->most_log2 = most_log2(&t->look, ntarget);
    float diagonal = slvi_closest_diagonal(t->closest);
    if (!(t->params.max_distance > 0))
        t->params.max_distance = DEFAULT_DISTANCE * diagonal;
    return slvi_transfer_match(env, t->params.no_copies ? 0 : nsource, t->source_corners, ntarget,
                               t->target_corners, MATCH_TOLERANCE * diagonal, t->faces);
}

/* A copy of a mesh, `scale` times as large, in the frame of `origin`. */
static slv_result place(const slv_env *env, const slv_mesh *mesh, double scale,
                        const double origin[3], slv_mesh **out) {
    slv_mesh_view view = *slv_mesh_get_view(mesh);
    float *positions = NULL;
    *out = NULL;
    slv_result result =
        slvi_alloc_plain(env, "positions", view.nverts, 3 * sizeof *positions, &positions);
    for (size_t i = 0; !result && i < (size_t)3 * view.nverts; i++)
        positions[i] = (float)(scale * (double)view.positions[i] +
                               (scale * view.origin[i % 3] - origin[i % 3]));
    view.positions = positions;
    memcpy(view.origin, origin, sizeof view.origin);
    if (!result)
        result = slv_mesh_create(env, &view, out);
    slvi_free(positions);
    return result;
}

static slv_result check(const slv_env *env, const struct transfer *t, const slv_source *texels,
                        const slv_mesh *source) {
    slv_source_desc desc;
    slv_result result = texels->fns->describe(texels->user, &desc);
    if (result)
        return result;
    if (desc.triangles)
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED,
                         "%s: a texture of triangles: the surfaces that texels are carried over "
                         "are made of quads",
                         desc.name);
    if (desc.nfaces != slv_mesh_face_count(source))
        return slvi_fail(env, SLV_ERROR_MISMATCH, "the texture has %u faces, its mesh %u",
                         desc.nfaces, slv_mesh_face_count(source));
    if (!isfinite(t->params.source_scale) || t->params.source_scale < 0)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "a scale of %g between the models",
                         (double)t->params.source_scale);
    return SLV_OK;
}

/* Both meshes in one frame, at one scale; those that are so already stay NULL. */
static slv_result join(const slv_env *env, const struct transfer *t, const slv_mesh *source,
                       const slv_mesh *target, slv_mesh *joined[2]) {
    double scale = t->params.source_scale > 0 ? (double)t->params.source_scale : 1, origin[3];
    slv_result result = SLV_OK;
    for (int k = 0; k < 3; k++)
        origin[k] = scale * slv_mesh_get_view(source)->origin[k];
    if (scale < 1 || scale > 1)
        result = place(env, source, scale, origin, &joined[0]);
    if (!result && memcmp(origin, slv_mesh_get_view(target)->origin, sizeof origin) != 0)
        result = place(env, target, 1, origin, &joined[1]);
    return result;
}

static slv_result carry_over(const slv_env *env, const slv_mesh *source, const slv_source *texels,
                             const slv_mesh *target, const slv_transfer_params *params,
                             const slv_transfer_sink *sink, slv_transfer_face *faces,
                             float *covered) {
    struct transfer t = {.sink = sink, .faces = faces};
    uint32_t ntarget = slv_mesh_face_count(target);
    slv_parallel_log *log = NULL;
    slv_mesh *joined[2] = {NULL, NULL};
    double area = 0, near = 0;
    slv_result result = slvi_parallel_env_begin(env, &log, &t.env);
    if (result)
        return result;
    if (params)
        t.params = *params;
    slvi_steps_begin(&t.steps, t.params.progress, ntarget);
    if ((result = check(env, &t, texels, source)) ||
        (result = join(env, &t, source, target, joined)) ||
        (result = prepare(env, &t, texels, joined[0] ? joined[0] : source,
                          joined[1] ? joined[1] : target)) ||
        (result = slvi_parallel_for(env, ntarget, 64, prepare_range, &t)))
        goto done;
    const slv_texture_desc desc = {.nfaces = ntarget,
                                   .type = t.look.desc.type,
                                   .nchannels = t.look.desc.nchannels,
                                   .alpha_channel = t.look.desc.alpha_channel,
                                   .res = t.res};
    if ((result = sink->begin(sink->user, &desc)) ||
        (result = slvi_parallel_for(env, ntarget, 4, fill_range, &t)))
        goto done;
    for (uint32_t face = 0; face < ntarget; face++) {
        double own = slvi_transfer_area(t.target_corners + (size_t)12 * face);
        area += own;
        near += own * (double)faces[face].covered;
    }
    if (covered)
        *covered = area > 0 ? (float)(near / area) : 0;
done:
    slv_mesh_destroy(joined[0]);
    slv_mesh_destroy(joined[1]);
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

slv_result slv_transfer_from(const slv_env *env, const slv_mesh *source, const slv_source *texels,
                             const slv_mesh *target, const slv_transfer_params *params,
                             const slv_transfer_sink *sink, slv_transfer_face *faces,
                             float *covered) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own,
                           carry_over(&own, source, texels, target, params, sink, faces, covered));
}
