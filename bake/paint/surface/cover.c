/* Which texels a dab covers: the square of the distance as a polynomial of each triangle.
 *
 * In a plane the squared distance of the point with weights w of a triangle's corners is
 * sum w_i d_i^2 - sum w_i w_j l_ij^2, with d the corners' distances and l the sides' lengths: it
 * takes no place of the dab's middle, and on a side it depends on that side alone. The same holds
 * of any positive quadratic form in place of the square, which makes dabs that are longer than
 * wide. */
#include "surface/painter_data.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <string.h>

/* From how many texels on work is shared out. */
#define SHARED_TEXELS 32768

slv_result slv_painter_create(const slv_env *env, const slv_paint_surface *surface,
                              slv_painter **out) {
    slv_painter *p = NULL;
    *out = NULL;
    slv_result result = slvi_alloc(env, "painter", 1, sizeof *p, &p);
    if (result)
        return result;
    p->env = slvi_env_or_default(env);
    p->surface = surface;
    if ((result = slvi_alloc(env, "painter", surface->nverts, sizeof *p->vertices, &p->vertices)) ||
        (result = slvi_alloc(env, "painter", 2 * (uint64_t)surface->ncells, sizeof *p->tri_round,
                             &p->tri_round))) {
        slv_painter_destroy(p);
        return result;
    }
    *out = p;
    return SLV_OK;
}

void slv_painter_destroy(slv_painter *painter) {
    if (!painter)
        return;
    slvi_free(painter->vertices);
    slvi_free(painter->tri_round);
    slvi_free(painter->heap);
    slvi_free(painter->touched);
    slvi_free(painter->patches);
    slvi_free(painter->parts);
    slvi_free(painter->coverage);
    slvi_free(painter->texels);
    slvi_free(painter->sums);
    slvi_free(painter);
}

const slv_paint_surface *slv_painter_get_surface(const slv_painter *painter) {
    return painter->surface;
}

/* Shell's sort with Ciura's gaps: lists are short, or nearly in order. */
void slvi_sort_numbers(uint32_t *list, uint32_t count) {
    static const uint32_t gaps[] = {463792, 206130, 91613, 40717, 18096, 8043, 3575, 1589,
                                    701,    301,    132,   57,    23,    10,   4,    1};
    for (size_t g = 0; g < sizeof gaps / sizeof *gaps; g++)
        for (uint32_t i = gaps[g]; i < count; i++) {
            uint32_t one = list[i], j = i;
            for (; j >= gaps[g] && list[j - gaps[g]] > one; j -= gaps[g])
                list[j] = list[j - gaps[g]];
            list[j] = one;
        }
}

/* A dab as it is evaluated. */
typedef struct brush_shape {
    double radius, hardness;
    const slv_res *res;
    double along[2], across[2]; /* the axes, in the unfolded plane; `across` times the aspect */
    bool round;
    double edge; /* how wide the rim is at least: a texel where the dab is */
} brush_shape;

/* What falls off from the middle: see slv_dab. */
typedef struct profile {
    double radius2, inner2; /* squared: of all, and of what is within the rim */
    double hardness, slope; /* down to this at the inner radius; then per square to 0 */
    double radius, opacity;
} profile;

/* For a face: dabs that are thinner than its texels are made as wide as these, and thinner. */
static profile make_profile(const brush_shape *b, double texel) {
    double r = b->radius, least = 0.75 * texel, rim;
    profile f = {.hardness = fmax((double)b->hardness, 0.02), .opacity = 1};
    if (r < least) {
        f.opacity = r / least * (r / least);
        r = least;
    }
    double width = fmax(fmin(b->edge, 2 * r), 1e-6 * r);
    rim = r * (1 - sqrt(f.hardness));
    if (rim < width) { /* the rim grows to both sides */
        r += (width - rim) / 2;
        rim = fmin(width, r);
    }
    f.radius = r;
    f.radius2 = r * r;
    f.inner2 = (r - rim) * (r - rim);
    f.slope = f.hardness / (f.radius2 - f.inner2);
    return f;
}

static float evaluate(const profile *f, double square) {
    if (square >= f->radius2)
        return 0;
    double value = square <= f->inner2
                       ? 1 - (1 - f->hardness) * (f->inner2 > 0 ? square / f->inner2 : 0)
                       : f->slope * (f->radius2 - square);
    return (float)(value * f->opacity);
}

/* a + b x + c y + d x^2 + e x y + f y^2 over a triangle's half of its cell. */
typedef struct polynomial {
    double a, b, c, d, e, f;
} polynomial;

static double form(const brush_shape *b, double x, double y) {
    double p = x * b->along[0] + y * b->along[1], q = x * b->across[0] + y * b->across[1];
    return p * p + q * q;
}

static polynomial make_polynomial(const slv_painter *p, const brush_shape *b, uint32_t tri) {
    double q[3], side[3];
    const slvi_front_vertex *v[3];
    for (unsigned k = 0; k < 3; k++) {
        v[k] = &p->vertices[slvi_tri_vertex(p->surface, tri, k)];
        q[k] =
            b->round ? v[k]->distance * v[k]->distance : form(b, (double)v[k]->x, (double)v[k]->y);
    }
    for (unsigned k = 0; k < 3; k++) {
        const slvi_front_vertex *from = v[k], *to = v[(k + 1) % 3];
        double l = slvi_distance(slvi_tri_point(p->surface, tri, k),
                                 slvi_tri_point(p->surface, tri, (k + 1) % 3));
        side[k] = l * l;
        double x = (double)to->x - (double)from->x, y = (double)to->y - (double)from->y,
               n = x * x + y * y;
        if (!b->round && n > 0) /* its direction there, with its own length */
            side[k] *= form(b, x, y) / n;
    }
    /* weights 1 - x, x - y, y of corners 0, 1, 2; in the upper half x and y change places, the
     * middle corner comes last, and so do its sides */
    bool upper = tri & 1;
    double q1 = upper ? q[2] : q[1], q2 = upper ? q[1] : q[2];
    double s01 = upper ? side[2] : side[0], s12 = side[1], s02 = upper ? side[0] : side[2];
    polynomial f = {q[0], q1 - q[0] - s01, q2 - q1 + s01 - s02, s01, s02 - s01 - s12, s12};
    if (upper)
        f = (polynomial){f.a, f.c, f.b, f.f, f.e, f.d};
    return f;
}

/* Where in its cell a triangle may be nearer than `limit` (squared): low x, low y, high x, high y.
 * False if nowhere. */
static bool find_extent(const polynomial *f, double limit, double out[4]) {
    double det = 4 * f->d * f->f - f->e * f->e;
    out[0] = out[1] = 0;
    out[2] = out[3] = 1;
    if (!(det > 1e-9 * (f->d + f->f) * (f->d + f->f)))
        return true;
    double x = (f->e * f->c - 2 * f->f * f->b) / det, y = (f->e * f->b - 2 * f->d * f->c) / det;
    double least = f->a + (f->b * x + f->c * y) / 2;
    /* rounding, where the middle of the dab is far away */
    double room = limit - least + 1e-9 * fabs(f->a);
    if (!(room > 0))
        return false;
    double dx = sqrt(4 * f->f * room / det), dy = sqrt(4 * f->d * room / det);
    out[0] = fmax(x - dx, 0);
    out[1] = fmax(y - dy, 0);
    out[2] = fmin(x + dx, 1);
    out[3] = fmin(y + dy, 1);
    return out[0] < out[2] && out[1] < out[3];
}

/* The texels of an axis whose centres lie within low..high of cell `at` of n; each texel is in one
 * cell. */
static void find_texels(uint32_t at, uint32_t n, uint32_t size, double low, double high,
                        uint32_t *first, uint32_t *end) {
    double scale = (double)size / n;
    /* those of the cell: texel i has its centre at i + 1/2 */
    uint32_t begin = (uint32_t)ceil(at * scale - 0.5),
             stop = (uint32_t)ceil((at + 1) * scale - 0.5);
    double from = floor((at + low) * scale - 0.5), to = ceil((at + high) * scale - 0.5) + 1;
    *first = from > begin ? (uint32_t)from : begin;
    *end = to < stop ? (uint32_t)fmax(to, 0) : stop;
    *end = *end < *first ? *first : *end;
}

typedef struct tri_texels {
    polynomial f;
    uint32_t x0, x1, y0, y1; /* texels */
    uint32_t column, row;    /* of the cell */
} tri_texels;

static bool find_tri_texels(const slv_painter *p, const brush_shape *b, const profile *f,
                            uint32_t tri, tri_texels *out) {
    const slv_paint_surface *s = p->surface;
    uint32_t face = s->cell_face[tri / 2], n = s->segments[face], local = tri / 2 - s->first[face];
    double extent[4];
    out->f = make_polynomial(p, b, tri);
    if (!find_extent(&out->f, f->radius2, extent))
        return false;
    out->column = local % n;
    out->row = local / n;
    find_texels(out->column, n, 1u << b->res[face].u, extent[0], extent[2], &out->x0, &out->x1);
    find_texels(out->row, n, 1u << b->res[face].v, extent[1], extent[3], &out->y0, &out->y1);
    return out->x0 < out->x1 && out->y0 < out->y1;
}

/* Puts the value of each texel of a triangle into its patch. */
static void fill_tri(const slv_painter *p, const brush_shape *b, const profile *f, uint32_t tri,
                     const slv_patch *patch, float *coverage) {
    tri_texels t;
    if (!find_tri_texels(p, b, f, tri, &t))
        return;
    uint32_t n = p->surface->segments[patch->face];
    bool upper = tri & 1;
    double step_x = (double)n / (double)(1u << b->res[patch->face].u),
           step_y = (double)n / (double)(1u << b->res[patch->face].v);
    for (uint32_t j = t.y0; j < t.y1; j++) {
        double y = (j + 0.5) * step_y - t.row;
        float *row = coverage + (size_t)(j - patch->rect.y) * patch->rect.width - patch->rect.x;
        double at_y = t.f.a + y * (t.f.c + y * t.f.f), slope = t.f.b + y * t.f.e;
        for (uint32_t i = t.x0; i < t.x1; i++) {
            double x = (i + 0.5) * step_x - t.column;
            if ((y > x) == upper)
                row[i] = evaluate(f, at_y + x * (slope + x * t.f.d));
        }
    }
}

/* Of the touched triangles, which are sorted, those of one face make a patch, unless none of their
 * texels is near enough. */
static slv_result add_patch(slv_painter *p, const brush_shape *b, uint32_t first, uint32_t end,
                            slv_patches *out) {
    const slv_paint_surface *s = p->surface;
    uint32_t face = s->cell_face[p->touched[first] / 2], low[2] = {UINT32_MAX, UINT32_MAX},
             high[2] = {0, 0};
    profile f = make_profile(b, (double)slvi_texel_length(s, face, b->res[face]));
    for (uint32_t i = first; i < end; i++) {
        tri_texels t;
        if (!find_tri_texels(p, b, &f, p->touched[i], &t))
            continue;
        low[0] = t.x0 < low[0] ? t.x0 : low[0];
        low[1] = t.y0 < low[1] ? t.y0 : low[1];
        high[0] = t.x1 > high[0] ? t.x1 : high[0];
        high[1] = t.y1 > high[1] ? t.y1 : high[1];
    }
    if (high[0] <= low[0])
        return SLV_OK;
    slv_result result;
    uint64_t room = p->patch_room;
    if ((result = slvi_painter_room(p, (uint64_t)out->count + 1, sizeof *p->patches, &p->patches,
                                    &room)) ||
        (result = slvi_painter_room(p, (uint64_t)out->count + 1, sizeof *p->parts, &p->parts,
                                    &p->patch_room)))
        return result;
    slv_rect rect = {low[0], low[1], high[0] - low[0], high[1] - low[1]};
    p->patches[out->count] =
        (slv_patch){face, rect, NULL, slv_paint_surface_texel_area(s, face, b->res[face])};
    p->parts[out->count++] = (slvi_part){first, end - first, out->ntexels};
    out->ntexels += (uint64_t)rect.width * rect.height;
    return SLV_OK;
}

typedef struct filling {
    slv_painter *p;
    const brush_shape *shape;
} filling;

static slv_result fill_patches(void *user, uint64_t begin, uint64_t end) {
    const filling *w = user;
    slv_painter *p = w->p;
    for (uint64_t i = begin; i < end; i++) {
        const slv_patch *patch = &p->patches[i];
        const slvi_part *part = &p->parts[i];
        float *coverage = p->coverage + part->texel;
        profile f = make_profile(w->shape, (double)slvi_texel_length(p->surface, patch->face,
                                                                     w->shape->res[patch->face]));
        memset(coverage, 0, sizeof(float) * (size_t)patch->rect.width * patch->rect.height);
        for (uint32_t k = 0; k < part->count; k++)
            fill_tri(p, w->shape, &f, p->touched[part->first + k], patch, coverage);
    }
    return SLV_OK;
}

/* Triangles into patches, patches into coverage. */
static slv_result fill(slv_painter *p, const brush_shape *b, slv_patches *out) {
    const slv_paint_surface *s = p->surface;
    slvi_sort_numbers(p->touched, p->ntouched);
    for (uint32_t first = 0, end; first < p->ntouched; first = end) {
        uint32_t face = s->cell_face[p->touched[first] / 2];
        for (end = first; end < p->ntouched && p->touched[end] / 2 < s->first[face + 1];)
            end++;
        slv_result result = add_patch(p, b, first, end, out);
        if (result)
            return result;
    }
    slv_result result =
        slvi_painter_room(p, out->ntexels, sizeof *p->coverage, &p->coverage, &p->coverage_room);
    if (result)
        return result;
    for (uint32_t i = 0; i < out->count; i++)
        p->patches[i].coverage = p->coverage + p->parts[i].texel;
    filling w = {p, b};
    out->list = p->patches;
    if (out->ntexels < SHARED_TEXELS || out->count < 2)
        return fill_patches(&w, 0, out->count);
    return slvi_parallel_for(&p->env, out->count, 1 + out->count / 64, fill_patches, &w);
}

static slv_result check(const slv_painter *p, const slv_dab *dab) {
    const slv_paint_surface *s = p->surface;
    if (dab->at.face < 0 || (uint32_t)dab->at.face >= s->nfaces || !s->segments[dab->at.face])
        return slvi_fail(&p->env, SLV_ERROR_ARGUMENT,
                         "dab: face %d: there is no such face to paint on", (int)dab->at.face);
    if (!(dab->radius > 0) || !isfinite(dab->radius))
        return slvi_fail(&p->env, SLV_ERROR_ARGUMENT, "dab: a radius of %g, expected more than 0",
                         (double)dab->radius);
    if (!(dab->hardness >= 0 && dab->hardness <= 1))
        return slvi_fail(&p->env, SLV_ERROR_ARGUMENT, "dab: a hardness of %g, expected 0 to 1",
                         (double)dab->hardness);
    if (!(dab->aspect == 0 || dab->aspect >= 1) || !isfinite(dab->aspect) || !isfinite(dab->angle))
        return slvi_fail(&p->env, SLV_ERROR_ARGUMENT,
                         "dab: an aspect of %g at an angle of %g, expected 1 or more",
                         (double)dab->aspect, (double)dab->angle);
    if (!isfinite(dab->at.u) || !isfinite(dab->at.v) || !isfinite(dab->axis[0]) ||
        !isfinite(dab->axis[1]) || !isfinite(dab->axis[2]))
        return slvi_fail(&p->env, SLV_ERROR_ARGUMENT, "dab: face %d: a place that is no number",
                         (int)dab->at.face);
    return SLV_OK;
}

slv_result slv_painter_cover(slv_painter *painter, const slv_res *res, const slv_dab *dab,
                             slv_patches *out) {
    *out = (slv_patches){0};
    slv_result result = check(painter, dab);
    if (result)
        return result;
    double angle = (double)dab->angle * 3.14159265358979 / 180,
           aspect = dab->aspect > 1 ? (double)dab->aspect : 1;
    const slv_paint_surface *s = painter->surface;
    brush_shape shape = {.radius = (double)dab->radius,
                         .hardness = (double)dab->hardness,
                         .res = res,
                         .along = {cos(angle), sin(angle)},
                         .across = {-aspect * sin(angle), aspect * cos(angle)},
                         .round = aspect == 1};
    slv_res here = res[dab->at.face];
    shape.edge = sqrt((double)slv_paint_surface_texel_area(s, (uint32_t)dab->at.face, here));
    profile f = make_profile(&shape, (double)slvi_texel_length(s, (uint32_t)dab->at.face, here));
    slvi_reach reach = {.least = (float)(f.radius * 1.0001), .res = res};
    if ((result = slvi_painter_spread(painter, dab->at, dab->axis, &reach)))
        return result;
    return fill(painter, &shape, out);
}
