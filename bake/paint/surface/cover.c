/* Which texels a dab covers: the square of the distance as a polynomial of each triangle.
 *
 * In a plane the squared distance of the point with weights w of a triangle's corners is
 * sum w_i d_i^2 - sum w_i w_j l_ij^2, with d the corners' distances and l the sides' lengths: it
 * takes no place of the dab's middle, and on a side it depends on that side alone. The same holds
 * of any positive quadratic form in place of the square, which makes dabs that are longer than
 * wide. */
#include "surface/painter_data.h"

#include "base/log.h"

#include <string.h>

/* A dab as it is evaluated. */
typedef struct brush_shape {
    double radius, hardness;
    const slv_res *res;
    double along[2], across[2]; /* the axes, in the unfolded plane; `across` times the aspect */
    bool round;
    double edge; /* how wide the rim is at least: a texel where the dab is */
} brush_shape;

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
        double l = slvi_tri_length(p->surface, tri, k);
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

/* Of the texels first..end-1, those whose centres lie within low..high of cell `at` of n. */
static void narrow(uint32_t at, uint32_t n, uint32_t size, double low, double high, uint32_t *first,
                   uint32_t *end) {
    double scale = (double)size / n;
    double from = floor((at + low) * scale - 0.5), to = ceil((at + high) * scale - 0.5) + 1;
    *first = from > *first ? (uint32_t)from : *first;
    *end = to < *end ? (uint32_t)fmax(to, 0) : *end;
}

static slvi_profile face_profile(const slv_painter *p, const brush_shape *b, uint32_t face) {
    return slvi_profile_make(b->radius, b->hardness, b->edge,
                             (double)slvi_texel_length(p->surface, face, b->res[face]));
}

/* So many texels of a cell are not looked at more closely before they are filled. */
#define FEW_TEXELS 32

/* Which texels of a triangle may be near enough. */
static bool find_tri_texels(const slv_painter *p, const void *user, uint32_t tri,
                            slvi_cell_texels *out) {
    const slv_paint_surface *s = p->surface;
    const brush_shape *b = user;
    uint32_t face = s->cells[tri / 2].face, n = s->segments[face], local = tri / 2 - s->first[face];
    double extent[4];
    *out = slvi_find_cell_texels(n, local, b->res[face]);
    uint64_t count = (uint64_t)(out->x1 - out->x0) * (out->y1 - out->y0);
    if (count <= FEW_TEXELS)
        return count > 0;
    polynomial f = make_polynomial(p, b, tri);
    if (!find_extent(&f, face_profile(p, b, face).radius2, extent))
        return false;
    narrow(local % n, n, 1u << b->res[face].u, extent[0], extent[2], &out->x0, &out->x1);
    narrow(local / n, n, 1u << b->res[face].v, extent[1], extent[3], &out->y0, &out->y1);
    return out->x0 < out->x1 && out->y0 < out->y1;
}

/* Puts the value of each texel of a triangle into its patch. */
static bool fill_tri(const slv_painter *p, const brush_shape *b, const slvi_profile *f,
                     uint32_t tri, const slv_patch *patch, float *coverage) {
    slvi_cell_texels t;
    if (!find_tri_texels(p, b, tri, &t))
        return false;
    const polynomial g = make_polynomial(p, b, tri);
    uint32_t n = p->surface->segments[patch->face],
             local = tri / 2 - p->surface->first[patch->face];
    bool upper = tri & 1, covered = false;
    double step_x = (double)n / (double)(1u << b->res[patch->face].u),
           step_y = (double)n / (double)(1u << b->res[patch->face].v);
    for (uint32_t j = t.y0; j < t.y1; j++) {
        double y = (j + 0.5) * step_y - local / n;
        float *row = coverage + (size_t)(j - patch->rect.y) * patch->rect.width - patch->rect.x;
        double at_y = g.a + y * (g.c + y * g.f), slope = g.b + y * g.e;
        for (uint32_t i = t.x0; i < t.x1; i++) {
            double x = (i + 0.5) * step_x - local % n;
            if ((y > x) == upper) {
                row[i] = slvi_profile_at(f, at_y + x * (slope + x * g.d));
                covered |= row[i] > 0;
            }
        }
    }
    return covered;
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
        slvi_part *part = &p->parts[i];
        float *coverage = p->coverage + part->texel;
        slvi_profile f = face_profile(p, w->shape, patch->face);
        memset(coverage, 0, sizeof(float) * (size_t)patch->rect.width * patch->rect.height);
        for (uint32_t k = 0; k < part->count; k++)
            part->covered |=
                fill_tri(p, w->shape, &f, p->touched[part->first + k], patch, coverage);
    }
    return SLV_OK;
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
    slvi_profile f = face_profile(painter, &shape, (uint32_t)dab->at.face);
    slvi_reach reach = {
        .least = (float)(f.radius * 1.0001), .res = res, .places = !shape.round || dab->unfold};
    if ((result = slvi_painter_spread(painter, dab->at, dab->axis, &reach)) ||
        (result = slvi_painter_gather(painter, res, find_tri_texels, &shape, out)))
        return result;
    filling w = {painter, &shape};
    if (!(result = slvi_painter_share(painter, out, fill_patches, &w)))
        slvi_painter_keep_covered(painter, out);
    return result;
}
