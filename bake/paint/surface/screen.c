/* Dabs of a picture: what the camera sees inside a disc.
 *
 * Rays through the disc find triangles, from which their neighbours are reached as long as they lie
 * under the disc; of these each texel is looked at by itself: whether it faces the eye, lies inside
 * the disc, and is hidden by nothing. */
#include "surface/view.h"

#include "base/log.h"

#include <string.h>

/* Rays along the disc's diameter, at most. */
enum { MOST_RAYS = 48 };

/* The dab as it is evaluated. */
typedef struct view {
    const slv_screen_dab *dab;
    slvi_view seen;
    double along[2], across[2];
    slvi_profile profile;
} view;

static bool make_view(const slv_paint_surface *s, const slv_screen_dab *dab, view *out) {
    double angle = (double)dab->angle * 3.14159265358979 / 180,
           aspect = dab->aspect > 1 ? (double)dab->aspect : 1;
    *out = (view){.dab = dab,
                  .along = {cos(angle), sin(angle)},
                  .across = {-aspect * sin(angle), aspect * cos(angle)},
                  .profile = slvi_profile_make((double)dab->radius, (double)dab->hardness, 1, 0)};
    return slvi_view_make(s, &dab->camera, dab->width, dab->height, &out->seen);
}

/* Whether some of a triangle may lie under the disc, and it faces the eye. */
static bool is_under(const slv_painter *p, const view *v, uint32_t tri) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY},
           reach = v->profile.radius, point[3];
    const float *at[2] = {&v->dab->x, &v->dab->y};
    for (unsigned k = 0; k < 3; k++) {
        const float *q = slvi_tri_point(p->surface, tri, k);
        double pixel[2];
        for (int i = 0; i < 3; i++)
            point[i] = (double)q[i];
        if (!slvi_view_project(&v->seen, point, pixel))
            return false;
        for (int i = 0; i < 2; i++) {
            low[i] = fmin(low[i], pixel[i]);
            high[i] = fmax(high[i], pixel[i]);
        }
    }
    return slvi_view_faces(p->surface, &v->seen, tri, point) && low[0] <= (double)*at[0] + reach &&
           high[0] >= (double)*at[0] - reach && low[1] <= (double)*at[1] + reach &&
           high[1] >= (double)*at[1] - reach;
}

/* The triangles that rays meet, and those around them that lie under the disc. */
static slv_result find_triangles(slv_painter *p, const view *v) {
    const slv_screen_dab *dab = v->dab;
    double r = (double)dab->radius;
    int n = r < MOST_RAYS / 2 ? 1 + 2 * (int)ceil(r) : MOST_RAYS + 1;
    slv_result result = SLV_OK;
    slvi_painter_begin_round(p);
    for (int j = 0; j < n * n && !result; j++) {
        double x = n > 1 ? 2.0 * (j % n) / (n - 1) - 1 : 0,
               y = n > 1 ? 2.0 * (j / n) / (n - 1) - 1 : 0;
        float o[3], d[3];
        slv_paint_hit hit;
        uint32_t tri;
        double at[2];
        if (x * x + y * y <= 1 &&
            slv_paint_surface_ray(p->surface, &dab->camera, dab->width, dab->height,
                                  dab->x + (float)(x * r), dab->y + (float)(y * r), o, d) &&
            slv_paint_surface_hit(p->surface, o, d, &hit) &&
            slvi_surface_place(p->surface, hit.point, &tri, at, at + 1) &&
            p->tri_round[tri] != p->round && is_under(p, v, tri))
            result = slvi_painter_touch(p, tri);
    }
    for (uint32_t i = 0; i < p->ntouched && !result; i++)
        for (unsigned k = 0; k < 3 && !result; k++) {
            uint32_t to;
            unsigned by;
            if (slvi_tri_across(p->surface, p->touched[i], k, &to, &by) &&
                p->tri_round[to] != p->round && is_under(p, v, to))
                result = slvi_painter_touch(p, to);
        }
    return result;
}

static float look_at(const slv_painter *p, const view *v, uint32_t tri, double x, double y) {
    double w[3], point[3], pixel[2];
    slvi_tri_weights(tri, x, y, w);
    for (int k = 0; k < 3; k++)
        point[k] = w[0] * (double)slvi_tri_point(p->surface, tri, 0)[k] +
                   w[1] * (double)slvi_tri_point(p->surface, tri, 1)[k] +
                   w[2] * (double)slvi_tri_point(p->surface, tri, 2)[k];
    if (!slvi_view_project(&v->seen, point, pixel))
        return 0;
    double dx = pixel[0] - (double)v->dab->x, dy = pixel[1] - (double)v->dab->y;
    double along = dx * v->along[0] + dy * v->along[1],
           across = dx * v->across[0] + dy * v->across[1];
    float value = slvi_profile_at(&v->profile, along * along + across * across);
    return value > 0 && slvi_view_sees(p, &v->seen, point) ? value : 0;
}

static bool cell_texels(const slv_painter *p, const void *user, uint32_t tri,
                        slvi_cell_texels *out) {
    const slv_res *res = user;
    uint32_t face = p->surface->cells[tri / 2].face;
    *out = slvi_find_cell_texels(p->surface->segments[face], tri / 2 - p->surface->first[face],
                                 res[face]);
    return true;
}

typedef struct looking {
    slv_painter *p;
    const view *view;
    const slv_res *res;
} looking;

static slv_result look_at_patches(void *user, uint64_t begin, uint64_t end) {
    const looking *w = user;
    slv_painter *p = w->p;
    for (uint64_t i = begin; i < end; i++) {
        const slv_patch *patch = &p->patches[i];
        slvi_part *part = &p->parts[i];
        float *coverage = p->coverage + part->texel;
        uint32_t n = p->surface->segments[patch->face];
        memset(coverage, 0, sizeof(float) * (size_t)patch->rect.width * patch->rect.height);
        for (uint32_t k = 0; k < part->count; k++) {
            uint32_t tri = p->touched[part->first + k],
                     local = tri / 2 - p->surface->first[patch->face];
            slvi_cell_texels t = slvi_find_cell_texels(n, local, w->res[patch->face]);
            for (uint32_t y = t.y0; y < t.y1; y++)
                for (uint32_t x = t.x0; x < t.x1; x++) {
                    double cx = ldexp(x + 0.5, -w->res[patch->face].u) * n - local % n,
                           cy = ldexp(y + 0.5, -w->res[patch->face].v) * n - local / n;
                    if ((cy > cx) != (tri & 1))
                        continue;
                    float value = look_at(p, w->view, tri, cx, cy);
                    coverage[(size_t)(y - patch->rect.y) * patch->rect.width + x - patch->rect.x] =
                        value;
                    part->covered |= value > 0;
                }
        }
    }
    return SLV_OK;
}

static slv_result check(const slv_painter *p, const slv_screen_dab *dab) {
    if (!(dab->radius > 0) || !isfinite(dab->radius) || !isfinite(dab->x) || !isfinite(dab->y) ||
        !(dab->hardness >= 0 && dab->hardness <= 1) || !isfinite(dab->angle) ||
        !(dab->aspect == 0 || dab->aspect >= 1) || !isfinite(dab->aspect) || !dab->width ||
        !dab->height)
        return slvi_fail(&p->env, SLV_ERROR_ARGUMENT,
                         "dab: at pixel %g %g of %u x %u, radius %g, hardness %g, aspect %g: one "
                         "is out of range",
                         (double)dab->x, (double)dab->y, (unsigned)dab->width,
                         (unsigned)dab->height, (double)dab->radius, (double)dab->hardness,
                         (double)dab->aspect);
    return SLV_OK;
}

slv_result slv_painter_cover_screen(slv_painter *painter, const slv_res *res,
                                    const slv_screen_dab *dab, slv_patches *out) {
    view v;
    *out = (slv_patches){0};
    slv_result result = check(painter, dab);
    if (result)
        return result;
    if (!make_view(painter->surface, dab, &v))
        return slvi_fail(&painter->env, SLV_ERROR_ARGUMENT, "dab: the camera cannot be inverted");
    if ((result = find_triangles(painter, &v)) ||
        (result = slvi_painter_gather(painter, res, cell_texels, res, out)))
        return result;
    looking w = {painter, &v, res};
    if (!(result = slvi_painter_share(painter, out, look_at_patches, &w)))
        slvi_painter_keep_covered(painter, out);
    return result;
}
