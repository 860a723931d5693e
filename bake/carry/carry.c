/* What another mesh has, on this one: each texel from the nearest place of the other's surface, or
 * from what lies along the normal. Whatever source the other has is looked up as texels are. */
#include "carry/carry.h"
#include "rays/look.h"
#include "source/cage.h"
#include "source/closest.h"

#include "base/log.h"
#include "base/memory.h"

#include <selvage/half.h>
#include <selvage/ptx.h>

#include <math.h>
#include <string.h>

enum { AT_ONCE = 256, MOST_SAMPLES = 16, LEAST_COST = 32 };
#define DEFAULT_DISTANCE 0.01f /* of the diagonal, to the nearest place */
#define DEFAULT_REACH 0.05f    /* of the same, along rays */
#define MATCH_TOLERANCE 1e-5f  /* of the same, between corners */

typedef struct carry {
    slv_bake_source base;
    slv_bake_carry params;
    const slv_surface *surface;
    slv_bake_source *of;
    slv_surface *other;
    slv_closest *closest;
    slv_tessellation triangles; /* what `scene` was made of */
    ray_scene scene;
    ray_look look;
    bake_cage cage;
    carry_pool *pool;
    slv_face_match *matches; /* NULL: none */
    float offset[3];         /* from this mesh's frame to the other's */
} carry;

typedef struct points {
    slv_surface_point at[AT_ONCE];
    float positions[AT_ONCE][3], normals[AT_ONCE][3], du[AT_ONCE][3], dv[AT_ONCE][3],
        cage[AT_ONCE][3];
} points;

static float length(const float v[3]) {
    return sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static slv_result surface_points(const carry *s, points *work, uint32_t count) {
    const slv_surface_arrays arrays = {.positions = work->positions[0],
                                       .normals = work->normals[0],
                                       .du = work->du[0],
                                       .dv = work->dv[0]};
    slv_result result = slv_surface_evaluate(s->surface, count, work->at, &arrays);
    if (!result && s->cage.surface)
        result = slvi_cage_points(&s->cage, count, work->at, work->cage[0]);
    for (uint32_t i = 0; i < count && !result; i++)
        for (int k = 0; k < 3; k++) {
            work->positions[i][k] += s->offset[k];
            work->cage[i][k] += s->offset[k];
        }
    return result;
}

/* ---- where on the other ---- */

static slv_bake_miss nearest(const carry *s, const float p[3], const float n[3],
                             slv_surface_point *out) {
    slv_closest_hit hit = slvi_closest_find(s->closest, p, n, s->params.distance);
    *out = hit.point;
    if (hit.point.face >= 0 && hit.distance <= s->params.distance)
        return SLV_BAKE_HIT;
    hit = slvi_closest_find(s->closest, p, NULL, s->params.distance);
    return hit.point.face >= 0 && hit.distance <= s->params.distance ? SLV_BAKE_BACK_FACING
                                                                     : SLV_BAKE_TOO_FAR;
}

static slv_bake_miss along(const carry *s, const points *work, uint32_t i, slv_surface_point *out) {
    ray_found found;
    slv_bake_miss miss =
        s->cage.surface ? slvi_ray_look_from(&s->look, work->cage[i], work->positions[i], &found)
                        : slvi_ray_look(&s->look, work->positions[i], work->normals[i], &found);
    if (miss)
        return miss;
    const uint32_t *corners = s->scene.triangles + 3 * (size_t)found.triangle;
    const float w[3] = {1 - found.weights[0] - found.weights[1], found.weights[0],
                        found.weights[1]};
    *out = (slv_surface_point){s->triangles.vertices[corners[0]].face, 0, 0};
    for (int c = 0; c < 3; c++) {
        const slv_vertex *v = &s->triangles.vertices[corners[c]];
        out->u += w[c] * slv_half_to_float(v->uv[0]);
        out->v += w[c] * slv_half_to_float(v->uv[1]);
    }
    return SLV_BAKE_HIT;
}

static slv_bake_miss find(const carry *s, const points *work, uint32_t i, slv_surface_point *out) {
    return s->closest ? nearest(s, work->positions[i], work->normals[i], out)
                      : along(s, work, i, out);
}

/* ---- what is there ---- */

/* What one call works with. */
typedef struct walk {
    const carry *s;
    const slv_env *env;
    transfer_tiles *tiles;
    points row, grid; /* the middles of texels, and the samples of one */
    slv_res res;
} walk;

/* Adds what the other has around a point, multiplied by alpha; where texels beside it have no value
 * that of the point itself, or why it has none. */
static slv_bake_miss look_up(walk *w, const slv_surface_point *at, float footprint, float *sum) {
    const carry *s = w->s;
    uint32_t n = s->base.desc.nchannels;
    float one[SLVI_BAKE_MAX_CHANNELS] = {0};
    bool whole = true;
    slvi_transfer_look_up(w->tiles, at, footprint, one);
    for (uint32_t c = 0; c < n; c++)
        whole = whole && isfinite(one[c]);
    if (!whole) {
        slv_res res = s->pool->source.faces[at->face].res;
        uint32_t width = 1u << res.u, height = 1u << res.v;
        uint32_t x = (uint32_t)(at->u * (float)width), y = (uint32_t)(at->v * (float)height);
        uint8_t missed = 0;
        const slv_rect rect = {x < width ? x : width - 1, y < height ? y : height - 1, 1, 1};
        slv_result result =
            slv_bake_evaluate(s->of, w->env, (uint32_t)at->face, res, rect, one, &missed);
        w->tiles->result = w->tiles->result ? w->tiles->result : result;
        if (missed || result)
            return missed ? (slv_bake_miss)missed : SLV_BAKE_NAN;
        slv_ptx_premultiply(SLV_TYPE_FLOAT, n, s->base.desc.alpha_channel, one, 1);
    }
    for (uint32_t c = 0; c < n; c++)
        sum[c] += one[c];
    return SLV_BAKE_HIT;
}

static uint32_t samples_for(float texel, float finest) {
    float ratio = texel / finest;
    return !(ratio > 1.5f) ? 1 : ratio < MOST_SAMPLES ? (uint32_t)ceilf(ratio) : MOST_SAMPLES;
}

/* A texel that covers many of the other is the mean of a grid of samples, each the mean of what
 * lies around it. */
static slv_result average(walk *w, const slv_surface_point *middle, const uint32_t count[2],
                          float footprint, float *out, uint8_t *missed) {
    uint32_t n = w->s->base.desc.nchannels, each = count[0] * count[1], found = 0;
    for (uint32_t k = 0; k < each; k++) {
        float x = ((float)(k % count[0]) + 0.5f) / (float)count[0] - 0.5f,
              y = ((float)(k / count[0]) + 0.5f) / (float)count[1] - 0.5f;
        w->grid.at[k] = (slv_surface_point){middle->face, middle->u + ldexpf(x, -w->res.u),
                                            middle->v + ldexpf(y, -w->res.v)};
    }
    slv_result result = surface_points(w->s, &w->grid, each);
    for (uint32_t k = 0; k < each && !result; k++) {
        slv_surface_point at;
        slv_bake_miss miss = find(w->s, &w->grid, k, &at);
        miss = miss ? miss : look_up(w, &at, footprint, out);
        found += !miss;
        *missed = miss ? (uint8_t)miss : *missed;
    }
    if (found)
        *missed = 0;
    for (uint32_t c = 0; c < n && found; c++)
        out[c] /= (float)found;
    return result;
}

static slv_result texel(walk *w, uint32_t i, float *out, uint8_t *missed) {
    slv_surface_point at;
    slv_bake_miss miss = find(w->s, &w->row, i, &at);
    float width = ldexpf(length(w->row.du[i]), -w->res.u),
          height = ldexpf(length(w->row.dv[i]), -w->res.v);
    uint32_t count[2] = {2, 2}; /* part of a texel may be there though its middle is not */
    if (!miss) {
        float finest = slvi_transfer_finest_texel(&w->s->pool->source, &at, fmaxf(width, height));
        count[0] = samples_for(width, finest);
        count[1] = samples_for(height, finest);
        if (count[0] == 1 && count[1] == 1) {
            *missed = (uint8_t)look_up(w, &at, 0, out);
            return w->tiles->result;
        }
    }
    float footprint = fmaxf(width / (float)count[0], height / (float)count[1]);
    slv_result result = average(w, &w->row.at[i], count, footprint, out, missed);
    return result ? result : w->tiles->result;
}

/* ---- faces that both have ---- */

/* A rectangle of a face that lies as one of the other's does: what the other has, turned. */
static slv_result copy(const carry *s, const slv_env *env, const slv_face_match *match, slv_res res,
                       slv_rect rect, float *values, uint8_t *misses) {
    uint32_t n = s->base.desc.nchannels;
    const slv_transfer_face how = {.turn = match->turn, .flipped = match->flipped};
    slv_res source = slvi_transfer_turned(res, &how); /* a turn by two axes and back is the same */
    size_t count = (size_t)rect.width * rect.height;
    if (!match->turn && !match->flipped)
        return slv_bake_evaluate(s->of, env, (uint32_t)match->face, res, rect, values, misses);
    int64_t w = INT64_C(1) << source.u, h = INT64_C(1) << source.v, at[3][2];
    for (int k = 0; k < 3; k++) { /* the corner (0,0), and how far it is along u and v */
        static const unsigned corners[3] = {0, 1, 3};
        unsigned c = slv_face_match_corner(match, corners[k]);
        at[k][0] = c == 1 || c == 2;
        at[k][1] = c >= 2;
    }
    int64_t x0 = at[0][0] * (w - 1), y0 = at[0][1] * (h - 1);
    slv_result result = SLV_OK;
    for (size_t i = 0; i < count && !result; i++) {
        int64_t x = rect.x + i % rect.width, y = rect.y + i / rect.width;
        slv_rect one = {(uint32_t)(x0 + (at[1][0] - at[0][0]) * x + (at[2][0] - at[0][0]) * y),
                        (uint32_t)(y0 + (at[1][1] - at[0][1]) * x + (at[2][1] - at[0][1]) * y), 1,
                        1};
        result = slv_bake_evaluate(s->of, env, (uint32_t)match->face, source, one, values + i * n,
                                   misses + i);
    }
    return result;
}

static slv_result evaluate(const slv_bake_source *source, const slv_env *env, uint32_t face,
                           slv_res res, slv_rect rect, float *values, uint8_t *misses) {
    const carry *s = (const carry *)source;
    uint32_t n = source->desc.nchannels, total = rect.width * rect.height;
    walk *w = NULL;
    if (s->matches && s->matches[face].face >= 0)
        return copy(s, env, &s->matches[face], res, rect, values, misses);
    slv_result result = slvi_alloc_plain(env, "bake: samples", 1, sizeof *w, &w);
    if (result)
        return result;
    w->s = s;
    w->env = env;
    w->res = res;
    result = slvi_carry_take(s->pool, env, &w->tiles);
    for (uint32_t first = 0; first < total && !result; first += AT_ONCE) {
        uint32_t count = total - first < AT_ONCE ? total - first : AT_ONCE;
        for (uint32_t i = 0; i < count; i++)
            w->row.at[i] = (slv_surface_point){
                (int32_t)face, ldexpf((float)(rect.x + (first + i) % rect.width) + 0.5f, -res.u),
                ldexpf((float)(rect.y + (first + i) / rect.width) + 0.5f, -res.v)};
        result = surface_points(s, &w->row, count);
        for (uint32_t i = 0; i < count && !result; i++)
            result = texel(w, i, values + (size_t)(first + i) * n, misses + first + i);
    }
    slv_ptx_unmultiply(SLV_TYPE_FLOAT, n, source->desc.alpha_channel, values, total);
    slvi_carry_put(s->pool, w->tiles);
    slvi_free(w);
    return result;
}

/* As many texels a length as the other has where the middle of the face lies. */
static void extent(const slv_bake_source *source, uint32_t face, float size[2]) {
    const carry *s = (const carry *)source;
    points work = {0};
    slv_surface_point at;
    float du[3], dv[3], own[2];
    const slv_surface_arrays arrays = {.du = du, .dv = dv};
    size[0] = size[1] = 1;
    if (s->matches && s->matches[face].face >= 0) {
        const slv_face_match *m = &s->matches[face];
        s->of->fns->extent(s->of, (uint32_t)m->face, own);
        bool swapped = (m->turn % 2 != 0) != m->flipped;
        size[0] = own[swapped];
        size[1] = own[!swapped];
        return;
    }
    work.at[0] = (slv_surface_point){(int32_t)face, 0.5f, 0.5f};
    if (surface_points(s, &work, 1) || find(s, &work, 0, &at) ||
        slv_surface_evaluate(s->other, 1, &at, &arrays))
        return;
    s->of->fns->extent(s->of, (uint32_t)at.face, own);
    float area = length(du) * length(dv);
    float density = area > 0 ? sqrtf(own[0] * own[1] / area) : 0;
    size[0] = density * length(work.du[0]);
    size[1] = density * length(work.dv[0]);
}

static void destroy(slv_bake_source *source) {
    carry *s = (carry *)source;
    if (s->pool)
        slvi_carry_pool_end(s->pool);
    slvi_free(s->pool);
    slvi_ray_scene_free(&s->scene);
    slv_tessellation_free(&s->triangles);
    slvi_closest_destroy(s->closest);
    slvi_cage_destroy(&s->cage);
    slv_surface_destroy(s->other);
    slvi_free(s->matches);
    slv_bake_source_destroy(s->of);
    slvi_free(s);
}

/* ---- making one ---- */

static void bounds_of(const slv_mesh *mesh, const float offset[3], float low[3], float high[3]) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    for (int k = 0; k < 3; k++) {
        low[k] = INFINITY;
        high[k] = -INFINITY;
    }
    for (size_t i = 0; i < (size_t)3 * view->nverts; i++) {
        low[i % 3] = fminf(low[i % 3], view->positions[i] + offset[i % 3]);
        high[i % 3] = fmaxf(high[i % 3], view->positions[i] + offset[i % 3]);
    }
}

/* Distances, where none are given; what does not even touch is told before any search. */
static slv_result measure(const slv_env *env, const slv_mesh *mesh, const slv_mesh *other,
                          carry *s) {
    static const float none[3] = {0, 0, 0};
    float low[2][3], high[2][3], most;
    double diagonal = 0;
    bounds_of(mesh, s->offset, low[0], high[0]);
    bounds_of(other, none, low[1], high[1]);
    for (int k = 0; k < 3; k++) {
        double side = (double)high[0][k] - (double)low[0][k];
        diagonal += side * side;
    }
    slvi_cage_bound(&s->cage, s->params.cage, s->offset, low[0], high[0]);
    for (int k = 0; k < 3; k++) {
        for (int m = 0; m < 2; m++)
            s->look.size = fmaxf(s->look.size, fmaxf(fabsf(low[m][k]), fabsf(high[m][k])));
    }
    slv_result result = s->params.rays ? embree_check_box(env, "rays", low[0], high[0]) : SLV_OK;
    if (result)
        return result;
    diagonal = sqrt(diagonal);
    s->params.distance =
        s->params.distance > 0 ? s->params.distance : DEFAULT_DISTANCE * (float)diagonal;
    s->look.front = s->params.front > 0 ? s->params.front : DEFAULT_REACH * (float)diagonal;
    s->look.back = s->params.back > 0 ? s->params.back : DEFAULT_REACH * (float)diagonal;
    most = s->params.rays ? fmaxf(s->look.front, s->look.back) : s->params.distance;
    for (int k = 0; k < 3; k++)
        if (low[1][k] - most > high[0][k] || high[1][k] + most < low[0][k])
            return slvi_fail(
                env, SLV_ERROR_MISMATCH,
                "bake: the other mesh lies elsewhere: along axis %d it goes from %g to "
                "%g, this one from %g to %g, and what is looked for reaches %g",
                k, (double)low[1][k], (double)high[1][k], (double)low[0][k], (double)high[0][k],
                (double)most);
    return SLV_OK;
}

static slv_result match(const slv_env *env, const slv_mesh *mesh, const slv_mesh *other, carry *s) {
    float *own = NULL, *theirs = NULL;
    const double *origin = slv_mesh_get_view(other)->origin;
    slv_result result;
    if (s->params.rays || s->params.no_copies)
        return SLV_OK;
    if (!(result = slv_mesh_corners(env, mesh, origin, &own)) &&
        !(result = slv_mesh_corners(env, other, origin, &theirs)) &&
        !(result =
              slvi_alloc(env, "faces to match", s->base.nfaces, sizeof *s->matches, &s->matches)))
        result =
            slv_mesh_match_corners(env, slv_mesh_face_count(other), theirs, s->base.nfaces, own,
                                   MATCH_TOLERANCE * slvi_closest_diagonal(s->closest), s->matches);
    slv_free(own);
    slv_free(theirs);
    return result;
}

static slv_result search_by(const slv_env *env, const slv_mesh *other, carry *s) {
    slv_adjacency *adjacency = NULL;
    uint32_t segments = slvi_closest_segments(other, s->params.scheme);
    if (!s->params.rays)
        return slvi_closest_create(env, s->other, segments, &s->closest);
    slv_result result = slv_mesh_adjacency(env, other, &adjacency);
    if (!result)
        result = slv_tessellate(env, other, s->other, adjacency, 2 * segments, &s->triangles);
    if (!result)
        result = slvi_ray_scene_of_surface(env, &s->triangles, NULL, &s->scene);
    slv_adjacency_destroy(adjacency);
    s->look.scene = &s->scene;
    return result;
}

static slv_result check(const slv_env *env, const slv_mesh *other, const slv_bake_source *of,
                        const slv_bake_carry *p) {
    if (slv_mesh_face_count(other) != of->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "bake: the other mesh has %u faces, its source %u",
                         slv_mesh_face_count(other), of->nfaces);
    if (p->cage && !p->rays)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: a cage is for rays");
    const float values[] = {p->distance, p->front, p->back};
    for (int k = 0; k < 3; k++)
        if (!(values[k] >= 0) || !isfinite(values[k]))
            return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: a distance of %g", (double)values[k]);
    return SLV_OK;
}

slv_result slv_bake_from_mesh(const slv_env *env, const slv_mesh *mesh, const slv_surface *surface,
                              const slv_mesh *other, slv_bake_source *of,
                              const slv_bake_carry *params, slv_bake_source **out) {
    static const slvi_bake_fns fns = {evaluate, NULL, NULL, destroy, NULL},
                               sized = {evaluate, extent, NULL, destroy, NULL};
    const slv_bake_carry own = params ? *params : (slv_bake_carry){0};
    const slv_surface_params how = {.scheme = own.scheme};
    slv_source texels;
    carry *s = NULL;
    *out = NULL;
    slv_result result = check(env, other, of, &own);
    if (result || (result = slvi_alloc(env, "bake: another mesh", 1, sizeof *s, &s))) {
        slv_bake_source_destroy(of);
        return result;
    }
    s->params = own;
    s->surface = surface;
    s->of = of;
    for (int k = 0; k < 3; k++)
        s->offset[k] =
            (float)(slv_mesh_get_view(mesh)->origin[k] - slv_mesh_get_view(other)->origin[k]);
    s->base = (slv_bake_source){.fns = of->fns->extent ? &sized : &fns,
                                .nfaces = slv_mesh_face_count(mesh),
                                .cost = of->cost + LEAST_COST,
                                .apart = of->apart,
                                .desc = of->desc};
    if ((result = slvi_cage_create(env, mesh, own.cage, own.cage_scheme, &s->cage)) ||
        (result = measure(env, mesh, other, s)) ||
        (result = slv_surface_create(env, other, &how, &s->other)) ||
        (result = search_by(env, other, s)) || (result = match(env, mesh, other, s)) ||
        (result = slvi_alloc(env, "bake: texels", 1, sizeof *s->pool, &s->pool)) ||
        (result = slvi_carry_texels_of(env, other, of, &texels)) ||
        (result = slvi_carry_pool_begin(env, other, &texels, s->pool))) {
        destroy(&s->base);
        return result;
    }
    *out = &s->base;
    return SLV_OK;
}
