/* Masks: what of a patch takes paint. */
#include "canvas/lay_data.h"

#include "base/log.h"

#define PI 3.14159265358979

/* 1 within the angle, and down to 0 a fifth of it further. */
static float let_through(const slv_mask *mask, const float normal[3], double length) {
    double d = 0;
    for (int k = 0; k < 3; k++)
        d += (double)normal[k] * (double)mask->towards[k] / length;
    double degrees = acos(fmin(fmax(d, -1), 1)) * 180 / PI, most = (double)mask->degrees;
    return (float)fmin(fmax((1.2 * most - degrees) / (0.2 * most), 0), 1);
}

static bool faces_camera(const slvi_laying *w, slv_surface_point at) {
    uint32_t tri;
    double x, y, point[3];
    float p[3];
    if (!slvi_surface_place(w->p->surface, at, &tri, &x, &y) ||
        !slv_paint_surface_at(w->p->surface, at, p, NULL, NULL))
        return false;
    for (int k = 0; k < 3; k++)
        point[k] = (double)p[k];
    return slvi_view_faces(w->p->surface, &w->view, tri, point);
}

/* What the mask's canvas has at a texel of another resolution: between its texel centres. */
static slv_result read_canvas(const slvi_laying *w, const slv_canvas_desc *desc,
                              slv_surface_point at, float *out) {
    const slv_mask *mask = &w->lay->mask;
    slv_res res = desc->res[at.face];
    float texels[4 * 64], x = ldexpf(at.u, res.u) - 0.5f, y = ldexpf(at.v, res.v) - 0.5f;
    uint32_t width = 1u << res.u, height = 1u << res.v;
    x = fminf(fmaxf(x, 0), (float)(width - 1));
    y = fminf(fmaxf(y, 0), (float)(height - 1));
    slv_rect r = {(uint32_t)x, (uint32_t)y, 1, 1};
    r.width += r.x + 1 < width;
    r.height += r.y + 1 < height;
    slv_result result = mask->canvas->fns->read(mask->canvas->user, (uint32_t)at.face, r, texels);
    float fx = x - (float)r.x, fy = y - (float)r.y, rows[2];
    for (uint32_t j = 0; j < 2 && !result; j++) {
        const float *row =
            texels + (size_t)(j < r.height ? j : 0) * r.width * desc->nchannels + mask->channel;
        float a = row[0], b = row[r.width > 1 ? desc->nchannels : 0];
        rows[j] = a + fx * (b - a);
    }
    if (!result)
        *out = fminf(fmaxf(rows[0] + fy * (rows[1] - rows[0]), 0), 1);
    return result;
}

static slv_result mask_patch(const slvi_laying *w, const slv_canvas_desc *other, double length,
                             const slv_patch *patch) {
    const slv_mask *mask = &w->lay->mask;
    float *coverage = slvi_own_coverage(w->p, patch), normal[3], share;
    slv_result result = SLV_OK;
    for (uint32_t y = 0; y < patch->rect.height; y++)
        for (uint32_t x = 0; x < patch->rect.width && !result; x++) {
            float *c = &coverage[(size_t)y * patch->rect.width + x];
            slv_surface_point at = slvi_texel_point(patch->face, w->res[patch->face],
                                                    patch->rect.x + x, patch->rect.y + y);
            if (!(*c > 0))
                continue;
            if ((mask->faces && !mask->faces[patch->face]) ||
                (mask->facing && !faces_camera(w, at))) {
                *c = 0;
                continue;
            }
            if (mask->degrees > 0 && slv_paint_surface_at(w->p->surface, at, NULL, normal, NULL))
                *c *= let_through(mask, normal, length);
            if (mask->canvas && !(result = read_canvas(w, other, at, &share)))
                *c *= mask->inverse ? 1 - share : share;
        }
    return result;
}

slv_result slvi_lay_mask(slvi_laying *w) {
    const slv_mask *mask = &w->lay->mask;
    const slv_env *env = &w->p->env;
    slv_canvas_desc other = {0};
    double length = 0;
    slv_result result = SLV_OK;
    if (!mask->faces && !(mask->degrees > 0) && !mask->facing && !mask->canvas)
        return SLV_OK;
    for (int k = 0; k < 3; k++)
        length += (double)mask->towards[k] * (double)mask->towards[k];
    length = sqrt(length);
    if (mask->degrees > 0 && !(length > 0 && isfinite(length) && mask->degrees <= 180))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "mask: %g degrees from a direction of length %g",
                         (double)mask->degrees, length);
    if (mask->facing && !slvi_view_make(w->p->surface, mask->facing, 1, 1, &w->view))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "mask: the camera cannot be inverted");
    if (mask->canvas && (result = mask->canvas->fns->describe(mask->canvas->user, &other)))
        return result;
    if (mask->canvas && (other.nfaces != w->desc.nfaces || mask->channel >= other.nchannels ||
                         other.nchannels > 64))
        return slvi_fail(env, SLV_ERROR_MISMATCH, "mask: channel %u of %u, of %u faces for %u",
                         (unsigned)mask->channel, (unsigned)other.nchannels, (unsigned)other.nfaces,
                         (unsigned)w->desc.nfaces);
    for (uint32_t i = 0; i < w->patches->count && !result; i++)
        result = mask_patch(w, &other, length, &w->patches->list[i]);
    return result;
}
