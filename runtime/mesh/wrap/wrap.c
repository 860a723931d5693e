/* Meshes with one texture coordinate a vertex, and what keeps some from having one. */
#include "mesh/wrap/round.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/names.h"

#include <string.h>

#define TURN 6.28318530717958647692
#define SAME SLVI_WRAP_SAME
enum { LISTED = 64 }; /* values of a vertex that are compared with another */

static const char *const maps[] = {"keep", "cylinder", "torus", "sphere"};

const char *slv_wrap_map_name(slv_wrap_map map) {
    return slvi_name_of(maps, SLVI_COUNT(maps), (int)map);
}

const char *slv_wrap_round_name(slv_wrap_round round) {
    static const char *const rounds[] = {"no", "u", "v", "both"};
    return slvi_name_of(rounds, SLVI_COUNT(rounds), (int)round);
}

bool slv_wrap_map_from_name(const char *name, slv_wrap_map *out) {
    int value = 0;
    bool found = slvi_name_find(maps, SLVI_COUNT(maps), name, &value);
    if (found)
        *out = (slv_wrap_map)value;
    return found;
}

static float turn_of(double y, double x) {
    double u = atan2(y, x) / TURN;
    float rounded = (float)(u - floor(u));
    return rounded < 1 ? rounded : 0;
}

/* ---- from positions ---- */

typedef struct frame {
    slv_wrap_map map;
    int axis;
    double middle[3], half; /* half: of the box, along the axis */
    double ring, reach;     /* a torus: the radius of its tube's middle; the largest radius */
} frame;

static void polar(const frame *f, const float *p, double *x, double *y, double *h) {
    int a = (f->axis + 1) % 3, b = (f->axis + 2) % 3;
    *x = (double)p[a] - f->middle[a];
    *y = (double)p[b] - f->middle[b];
    *h = (double)p[f->axis] - f->middle[f->axis];
}

static frame frame_of(const slv_mesh_view *view, const slvi_weld *w,
                      const slv_wrap_params *params) {
    frame f = {.map = params->map, .axis = params->axis};
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double nearest = INFINITY, x, y, h;
    for (uint32_t s = 0; s < w->nsides; s++)
        for (int c = 0; c < 3; c++) {
            double at = (double)view->positions[3 * (size_t)w->from[w->verts[s]] + (size_t)c];
            low[c] = fmin(low[c], at);
            high[c] = fmax(high[c], at);
        }
    for (int c = 0; c < 3; c++)
        f.middle[c] = 0.5 * (low[c] + high[c]);
    f.half = 0.5 * (high[f.axis] - low[f.axis]);
    for (uint32_t s = 0; s < w->nsides; s++) {
        polar(&f, view->positions + 3 * (size_t)w->from[w->verts[s]], &x, &y, &h);
        nearest = fmin(nearest, hypot(x, y));
        f.reach = fmax(f.reach, hypot(x, y));
    }
    f.ring = 0.5 * (nearest + f.reach);
    return f;
}

/* False on the axis, where there is no angle; u is not written then. */
static bool map_point(const frame *f, const float *p, float uv[2]) {
    double x, y, h;
    polar(f, p, &x, &y, &h);
    double radius = hypot(x, y);
    if (f->map == SLV_WRAP_CYLINDER)
        uv[1] = f->half > 0 ? (float)(0.5 + 0.5 * h / f->half) : 0;
    else if (f->map == SLV_WRAP_TORUS)
        uv[1] = turn_of(h, radius - f->ring);
    else
        uv[1] = (float)(0.5 + atan2(h, radius) / (0.5 * TURN));
    if (!(radius > 1e-6 * fmax(f->reach, f->half)))
        return false;
    uv[0] = turn_of(y, x);
    return true;
}

/* Sides at poles have the angle of what is around in their own polygon. */
static void map_positions(const slv_mesh_view *view, const slvi_weld *w,
                          const slv_wrap_params *params, slvi_wrap_values *c) {
    const frame f = frame_of(view, w, params);
    uint32_t first = 0;
    c->round[0] = true;
    c->round[1] = params->map == SLV_WRAP_TORUS;
    for (uint32_t p = 0; p < w->npolys; first += (uint32_t)w->sizes[p++]) {
        uint32_t size = (uint32_t)w->sizes[p], count = 0;
        float start = 0, sum = 0;
        for (uint32_t s = first; s < first + size; s++) {
            float *at = c->at + 2 * (size_t)s;
            at[0] = NAN;
            if (!map_point(&f, view->positions + 3 * (size_t)w->from[w->verts[s]], at))
                continue;
            start = count++ ? start : at[0];
            sum += slv_wrap_step(start, at[0]);
        }
        float middle = count ? start + sum / (float)count : 0;
        for (uint32_t s = first; s < first + size; s++)
            if (isnan(c->at[2 * (size_t)s]))
                c->at[2 * (size_t)s] = middle - floorf(middle);
    }
}

/* ---- one value a vertex ---- */

static bool is_same(const float *a, const float *b, const bool round[2]) {
    for (int axis = 0; axis < 2; axis++)
        if (!(fabsf(round[axis] ? slv_wrap_step(a[axis], b[axis]) : b[axis] - a[axis]) < SAME))
            return false;
    return true;
}

/* Lists each vertex's values; along what goes round those that are whole numbers apart are one. */
static void list_values(const slvi_weld *w, slvi_wrap_values *c) {
    c->count = 0;
    for (uint32_t v = 0; v < w->nverts; v++)
        c->head[v] = -1;
    for (uint32_t s = 0; s < w->nsides; s++) {
        const float *at = c->at + 2 * (size_t)s;
        int32_t *end = &c->head[w->verts[s]];
        c->index[s] = -1;
        if (isnan(at[0]))
            continue;
        for (int tried = 0; *end >= 0 && tried < LISTED; end = &c->next[*end], tried++)
            if (is_same(c->values + 2 * (size_t)*end, at, c->round)) {
                c->index[s] = *end;
                break;
            }
        if (c->index[s] >= 0)
            continue;
        int32_t made = (int32_t)c->count++;
        c->next[made] = *end;
        *end = made;
        memcpy(c->values + 2 * (size_t)made, at, 2 * sizeof *at);
        c->index[s] = made;
    }
}

/* Into 0..1 along what goes round. */
static void settle(slvi_wrap_values *c) {
    for (uint32_t i = 0; i < c->count; i++)
        for (int axis = 0; axis < 2; axis++) {
            float *at = &c->values[2 * i + (uint32_t)axis];
            if (c->round[axis] && fabsf(*at) <= SLVI_WRAP_FARTHEST)
                *at -= floorf(*at);
        }
}

/* Those that the mesh has, and which way they go round. */
static slv_result take(const slv_env *env, const slv_mesh_view *view, const slvi_weld *w,
                       slvi_wrap_values *c, slvi_wrap_node **nodes) {
    for (uint32_t s = 0; s < w->nsides; s++) {
        int32_t id = view->poly_texcoords ? view->poly_texcoords[w->side[s]] : -1;
        for (int axis = 0; axis < 2; axis++)
            c->at[2 * (size_t)s + (size_t)axis] =
                id >= 0 ? view->texcoords[2 * (size_t)id + (size_t)axis] : NAN;
    }
    c->round[0] = c->round[1] = true;
    list_values(w, c);
    slv_result result = slvi_alloc_plain(env, "texture coordinates", (uint64_t)w->npolys + c->count,
                                         sizeof **nodes, nodes);
    if (!result)
        slvi_wrap_find_round(w, c, *nodes);
    return result;
}

/* How far the coordinates of a polygon are apart as the mesh had them. */
static float span_before(const slvi_weld *w, const slvi_wrap_values *c, uint32_t p, uint32_t first,
                         int axis) {
    float least = INFINITY, most = -INFINITY;
    for (uint32_t s = first; s < first + (uint32_t)w->sizes[p]; s++) {
        least = fminf(least, c->at[2 * (size_t)s + (size_t)axis]);
        most = fmaxf(most, c->at[2 * (size_t)s + (size_t)axis]);
    }
    return most - least;
}

/* Coordinates that the mesh `had` say by themselves how far a polygon reaches: one from 0 to 1 has
 * nothing left of the map where both become one value. */
static void judge(const slvi_weld *w, bool had, const int32_t *poly_from, const slvi_wrap_values *c,
                  slv_wrap_report *report) {
    uint32_t first = 0;
    report->first_many = report->many_poly = report->first_wide = report->first_far = -1;
    report->first_bare = -1;
    report->round = (slv_wrap_round)((c->round[0] ? SLV_WRAP_ROUND_U : 0) |
                                     (c->round[1] ? SLV_WRAP_ROUND_V : 0));
    for (uint32_t v = 0; v < w->nverts; v++)
        if (c->head[v] >= 0 && c->next[c->head[v]] >= 0 && !report->nmany++)
            report->first_many = (int32_t)v;
    for (uint32_t p = 0; p < w->npolys; first += (uint32_t)w->sizes[p++]) {
        bool wide = false, far = false, bare = false, over[2] = {false, false};
        for (uint32_t s = first; s < first + (uint32_t)w->sizes[p]; s++) {
            far |= slvi_wrap_is_far(c->at + 2 * (size_t)s);
            bare |= c->index[s] < 0;
            if (report->many_poly < 0 && w->verts[s] == report->first_many)
                report->many_poly = poly_from[p];
        }
        if (bare && !report->nbare++)
            report->first_bare = poly_from[p];
        if (far && !report->nfar++)
            report->first_far = poly_from[p];
        if (far)
            continue;
        for (int axis = 0; axis < 2 && c->index[first] >= 0; axis++) {
            float start = c->values[2 * c->index[first] + axis];
            float low = 0, high = 0, least = start, most = start;
            for (uint32_t s = first; s < first + (uint32_t)w->sizes[p]; s++) {
                float at = c->index[s] >= 0 ? c->values[2 * c->index[s] + axis] : start;
                low = fminf(low, slv_wrap_step(start, at));
                high = fmaxf(high, slv_wrap_step(start, at));
                least = fminf(least, at);
                most = fmaxf(most, at);
            }
            over[axis] = c->round[axis] && most - least >= 0.5f;
            wide |= c->round[axis] &&
                    fmaxf(high - low, had ? span_before(w, c, p, first, axis) : 0) >= 0.5f - SAME;
        }
        for (int axis = 0; axis < 2; axis++)
            report->nseam[axis] += over[axis] && !wide;
        if (wide && !report->nwide++)
            report->first_wide = poly_from[p];
    }
}

/* ---- the mesh ---- */

/* Arrays of the result that are neither the input's nor the weld's. */
typedef struct rest {
    float *positions, *colors, *sharpness;
    int32_t *creases, *corners, *holes, *first, *count, *poly_from;
} rest;

static void rest_free(rest *r) {
    slvi_free(r->positions);
    slvi_free(r->colors);
    slvi_free(r->sharpness);
    slvi_free(r->creases);
    slvi_free(r->corners);
    slvi_free(r->holes);
    slvi_free(r->first);
    slvi_free(r->count);
    slvi_free(r->poly_from);
}

static slv_result rest_make(const slv_env *env, const slv_mesh_view *from, const slvi_weld *w,
                            slv_mesh_view *view, rest *r) {
    slv_result result;
    if ((result = slvi_alloc(env, "vertices", w->nverts, 3 * sizeof(float), &r->positions)) ||
        (result = slvi_alloc(env, "vertices", from->colors ? w->nverts : 0, 4 * sizeof(float),
                             &r->colors)) ||
        (result = slvi_alloc(env, "creases", from->ncreases, 2 * sizeof(int32_t), &r->creases)) ||
        (result = slvi_alloc(env, "creases", from->ncreases, sizeof(float), &r->sharpness)) ||
        (result = slvi_alloc(env, "corners", from->ncorners, sizeof(int32_t), &r->corners)) ||
        (result = slvi_alloc(env, "holes", from->nholes, sizeof(int32_t), &r->holes)) ||
        (result = slvi_alloc(env, "groups", from->ngroups, sizeof(int32_t), &r->first)) ||
        (result = slvi_alloc(env, "groups", from->ngroups, sizeof(int32_t), &r->count)) ||
        (result = slvi_alloc(env, "polygons", w->npolys, sizeof(int32_t), &r->poly_from)))
        return result;
    for (uint32_t v = 0; v < w->nverts; v++)
        memcpy(r->positions + 3 * (size_t)v, from->positions + 3 * (size_t)w->from[v],
               3 * sizeof(float));
    for (uint32_t v = 0; from->colors && v < w->nverts; v++)
        memcpy(r->colors + 4 * (size_t)v, from->colors + 4 * (size_t)w->from[v], 4 * sizeof(float));
    view->ncreases = view->nholes = 0;
    for (uint32_t i = 0; i < from->ncreases; i++) {
        int32_t a = w->to[from->crease_verts[2 * i]], b = w->to[from->crease_verts[2 * i + 1]];
        if (a == b)
            continue;
        r->creases[2 * view->ncreases] = a;
        r->creases[2 * view->ncreases + 1] = b;
        r->sharpness[view->ncreases++] = from->crease_sharpness[i];
    }
    for (uint32_t i = 0; i < from->ncorners; i++)
        r->corners[i] = w->to[from->corner_verts[i]];
    for (uint32_t p = from->npolys; p-- > 0;)
        if (w->poly[p] < (int32_t)w->npolys)
            r->poly_from[w->poly[p]] = (int32_t)p;
    for (uint32_t p = 0; p < w->npolys; p++) {
        /* of those before it that are gone the last one has its number too */
        int32_t own = r->poly_from[p];
        while (own + 1 < (int32_t)from->npolys && w->poly[own + 1] == (int32_t)p)
            own++;
        r->poly_from[p] = own;
    }
    for (uint32_t i = 0; i < from->nholes; i++) {
        int32_t p = w->poly[from->hole_polys[i]];
        if (p < (int32_t)w->npolys && r->poly_from[p] == from->hole_polys[i])
            r->holes[view->nholes++] = p;
    }
    for (uint32_t g = 0; g < from->ngroups; g++) {
        uint32_t begin = (uint32_t)from->group_first[g],
                 end = begin + (uint32_t)from->group_count[g];
        r->first[g] = begin < from->npolys ? w->poly[begin] : (int32_t)w->npolys;
        r->count[g] = (end < from->npolys ? w->poly[end] : (int32_t)w->npolys) - r->first[g];
    }
    view->positions = r->positions;
    view->colors = from->colors ? r->colors : NULL;
    view->crease_verts = r->creases;
    view->crease_sharpness = r->sharpness;
    view->corner_verts = r->corners;
    view->hole_polys = r->holes;
    view->group_first = r->first;
    view->group_count = r->count;
    return SLV_OK;
}

static slv_result make(const slv_env *env, const slv_mesh *mesh, const slv_wrap_params *params,
                       slv_wrap_report *report, slv_mesh **out) {
    slv_mesh_view view = mesh->view;
    slvi_weld w;
    slvi_wrap_values c = {0};
    rest r = {0};
    slvi_wrap_node *nodes = NULL;
    int32_t *user = NULL; /* per value a polygon */
    slv_result result = slvi_weld_make(env, mesh, !params->keep_vertices, report, &w);
    if (result || (result = slvi_alloc(env, "texture coordinates", w.nsides, 8, &c.at)) ||
        (result = slvi_alloc(env, "texture coordinates", w.nsides, 8, &c.values)) ||
        (result = slvi_alloc(env, "texture coordinates", w.nsides, 4, &c.index)) ||
        (result = slvi_alloc(env, "texture coordinates", w.nverts, 4, &c.head)) ||
        (result = slvi_alloc(env, "texture coordinates", w.nsides, 4, &c.next)) ||
        (result = slvi_alloc(env, "texture coordinates", w.nsides, 4, &user)) ||
        (result = rest_make(env, &mesh->view, &w, &view, &r)))
        goto done;
    if (params->map)
        map_positions(&mesh->view, &w, params, &c);
    else if ((result = take(env, &mesh->view, &w, &c, &nodes)))
        goto done;
    list_values(&w, &c);
    settle(&c);
    judge(&w, !params->map, r.poly_from, &c, report);
    if (nodes)
        slvi_wrap_find_ends(&w, &c, nodes, r.poly_from, user, report);
    view.nverts = w.nverts;
    view.npolys = w.npolys;
    view.poly_sizes = w.sizes;
    view.poly_verts = w.verts;
    view.ntexcoords = c.count;
    view.texcoords = c.values;
    view.poly_texcoords = c.count ? c.index : NULL;
    view.nnormals = 0;
    view.normals = NULL;
    view.poly_normals = NULL;
    if ((result = slvi_wrap_count_drawn(env, mesh, &report->ndrawn_before)) ||
        (result = slv_mesh_create(env, &view, out)))
        goto done;
    result = slvi_wrap_count_drawn(env, *out, &report->ndrawn);
done:
    if (result) {
        slv_mesh_destroy(*out);
        *out = NULL;
    }
    slvi_free(c.at);
    slvi_free(c.values);
    slvi_free(c.index);
    slvi_free(c.head);
    slvi_free(c.next);
    slvi_free(nodes);
    slvi_free(user);
    rest_free(&r);
    slvi_weld_free(&w);
    return result;
}

slv_result slv_mesh_wrap(const slv_env *env, const slv_mesh *mesh, const slv_wrap_params *given,
                         slv_wrap_report *report, slv_mesh **out) {
    const slv_wrap_params params = given ? *given : (slv_wrap_params){0};
    slv_wrap_report told = {0};
    *out = NULL;
    if (params.axis < 0 || params.axis > 2 || (unsigned)params.map > SLV_WRAP_SPHERE)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "wrap: map %d around axis %d", (int)params.map,
                         params.axis);
    slv_env own = slvi_budget_begin(env);
    slv_result result = slvi_budget_end(&own, make(&own, mesh, &params, &told, out));
    if (report)
        *report = told;
    return result;
}
