/* Inks: a colour for each texel under a dab, of a gradient, an image, or another place. */
#include "canvas/lay_data.h"

#include "base/log.h"
#include "base/names.h"

#include <string.h>

/* Image pixels that are averaged along an axis, at most. */
enum { MOST_TAPS = 8 };

const char *slv_ink_kind_name(slv_ink_kind kind) {
    static const char *const names[] = {"plain", "gradient", "image", "stamp", "clone"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)kind);
}

/* Red, green, blue and alpha of an image between its pixels' middles; nothing is beside it. Pixels
 * from its upper left corner. Colours are multiplied by alpha. */
static void add_tap(const slv_image *image, double x, double y, double weight, double rgba[4]) {
    double fx = x - 0.5 - floor(x - 0.5), fy = y - 0.5 - floor(y - 0.5);
    int64_t left = (int64_t)floor(x - 0.5), top = (int64_t)floor(y - 0.5);
    uint32_t n = image->nchannels;
    for (int k = 0; k < 4; k++) {
        int64_t i = left + (k & 1), j = top + (k >> 1);
        double w = weight * (k & 1 ? fx : 1 - fx) * (k >> 1 ? fy : 1 - fy);
        if (i < 0 || j < 0 || i >= (int64_t)image->width || j >= (int64_t)image->height)
            continue;
        const float *p = image->pixels + ((size_t)j * image->width + (size_t)i) * n;
        double alpha = n == 2 || n == 4 ? (double)p[n - 1] : 1;
        for (uint32_t c = 0; c < 3; c++)
            rgba[c] += w * alpha * (double)p[n >= 3 ? c : 0];
        rgba[3] += w * alpha;
    }
}

/* The mean of a square of the image. */
static void sample_image(const slv_image *image, double x, double y, double width, double rgba[4]) {
    int taps = width > 1 ? (int)fmin(ceil(width), MOST_TAPS) : 1;
    memset(rgba, 0, 4 * sizeof *rgba);
    if (!(fabs(x) < 1e6 && fabs(y) < 1e6))
        return;
    for (int j = 0; j < taps; j++)
        for (int i = 0; i < taps; i++)
            add_tap(image, x + ((i + 0.5) / taps - 0.5) * width * (taps > 1),
                    y + ((j + 0.5) / taps - 0.5) * width * (taps > 1), 1.0 / (taps * taps), rgba);
}

/* Puts a colour, not multiplied by alpha, where the canvas has its colours. */
static void put_rgb(const slvi_laying *w, const double rgb[3], float *color) {
    uint32_t n = w->desc.nchannels, first = w->paint->first_channel;
    uint32_t colours = n - (w->desc.alpha_channel >= 0), k = 0;
    for (uint32_t c = 0; c < n; c++) {
        if ((int32_t)c == w->desc.alpha_channel)
            continue;
        double value =
            colours == 1 ? 0.3 * rgb[0] + 0.59 * rgb[1] + 0.11 * rgb[2] : rgb[k < 3 ? k : 2];
        if (c >= first && c - first < SLV_PAINT_CHANNELS)
            color[c - first] = (float)value;
        k++;
    }
    if (w->desc.alpha_channel >= (int32_t)first &&
        w->desc.alpha_channel - (int32_t)first < SLV_PAINT_CHANNELS)
        color[w->desc.alpha_channel - (int32_t)first] = 1;
}

static float put_image(const slvi_laying *w, const double at[2], double width, float *color) {
    double rgba[4];
    sample_image(w->lay->ink.image, at[0], at[1], width, rgba);
    if (!(rgba[3] > 0))
        return 0;
    for (int k = 0; k < 3; k++)
        rgba[k] /= rgba[3];
    put_rgb(w, rgba, color);
    return (float)fmin(rgba[3], 1);
}

static bool find_point(const slvi_laying *w, slv_surface_point at, double out[3]) {
    float p[3] = {0};
    bool found = slv_paint_surface_at(w->p->surface, at, p, NULL, NULL);
    for (int k = 0; k < 3; k++)
        out[k] = (double)p[k];
    return found;
}

/* From a place relative to the image's middle, x right and y down, and pixels of the image for a
 * unit there, to a pixel. */
static void turn(const slv_ink *ink, const double from[2], double scale, double out[2]) {
    double angle = (double)ink->angle * 3.14159265358979 / 180, c = cos(angle), s = sin(angle);
    out[0] = (c * from[0] + s * from[1]) * scale + 0.5 * ink->image->width;
    out[1] = (c * from[1] - s * from[0]) * scale + 0.5 * ink->image->height;
}

/* Where a point of the surface lies in the image. */
static bool find_pixel(const slvi_laying *w, slv_surface_point at, double out[2]) {
    const slv_ink *ink = &w->lay->ink;
    double from[2], point[3];
    float flat[2];
    if (ink->kind == SLV_INK_IMAGE) {
        if (!find_point(w, at, point) || !slvi_view_project(&w->view, point, from))
            return false;
        from[0] -= (double)ink->x;
        from[1] -= (double)ink->y;
        turn(ink, from, ink->image->width / (double)ink->size, out);
        return true;
    }
    double radius, angle;
    if (w->screen) {
        if (!find_point(w, at, point) || !slvi_view_project(&w->view, point, from))
            return false;
        from[0] -= (double)w->screen->x;
        from[1] -= (double)w->screen->y;
        radius = (double)w->screen->radius;
        angle = -(double)w->screen->angle;
    } else {
        if (!slv_painter_unfolded(w->p, at, flat))
            return false;
        from[0] = (double)flat[0];
        from[1] = ink->flip ? (double)flat[1] : -(double)flat[1]; /* an image's rows go down */
        radius = (double)w->dab->radius;
        angle = ink->flip ? -(double)w->dab->angle : (double)w->dab->angle;
    }
    double c = cos(angle * 3.14159265358979 / 180), s = sin(angle * 3.14159265358979 / 180);
    double turned[2] = {c * from[0] - s * from[1], s * from[0] + c * from[1]};
    uint32_t longer =
        ink->image->width > ink->image->height ? ink->image->width : ink->image->height;
    /* the corners of the longer side's square are on the rim */
    turn(ink, turned, longer / (radius * 1.41421356237), out);
    if (ink->flip && ink->legible) /* what is up stays up */
        out[0] = ink->image->width - out[0];
    return true;
}

static float image_texel(const slvi_laying *w, const slv_patch *patch, uint32_t x, uint32_t y,
                         float *color) {
    slv_res res = w->res[patch->face];
    slv_surface_point at = slvi_texel_point(patch->face, res, x, y), beside = at;
    double here[2], there[2], point[3], width = 0;
    uint32_t tri;
    double cx, cy;
    if (!find_pixel(w, at, here))
        return 0;
    if (w->lay->ink.kind == SLV_INK_IMAGE &&
        (!find_point(w, at, point) || !slvi_surface_place(w->p->surface, at, &tri, &cx, &cy) ||
         !slvi_view_faces(w->p->surface, &w->view, tri, point) ||
         !slvi_view_sees(w->p, &w->view, point)))
        return 0;
    for (int k = 0; k < 2; k++) { /* how wide a texel is in the image, along both sides */
        beside = at;
        float *to = k ? &beside.v : &beside.u, step = ldexpf(1, -(k ? res.v : res.u));
        *to += *to < 0.5f ? step : -step;
        if ((k ? res.v : res.u) > 0 && find_pixel(w, beside, there))
            width = fmax(width, hypot(there[0] - here[0], there[1] - here[1]));
    }
    return put_image(w, here, width, color);
}

static float gradient_texel(const slvi_laying *w, const slv_patch *patch, uint32_t x, uint32_t y,
                            float *color) {
    const slv_ink *ink = &w->lay->ink;
    double point[3], along = 0, far = 0, length = 0;
    if (!find_point(w, slvi_texel_point(patch->face, w->res[patch->face], x, y), point))
        return 0;
    for (int k = 0; k < 3; k++) {
        double way = (double)ink->to[k] - (double)ink->from[k], d = point[k] - (double)ink->from[k];
        length += way * way;
        along += way * d;
        far += d * d;
    }
    double t = ink->radial ? sqrt(far / length) : along / length;
    t = fmin(fmax(t, 0), 1);
    for (int c = 0; c < SLV_PAINT_CHANNELS; c++)
        color[c] = w->paint->color[c] + (float)t * (ink->color[c] - w->paint->color[c]);
    return 1;
}

static slv_result color_some(void *user, uint64_t begin, uint64_t end) {
    const slvi_laying *w = user;
    bool gradient = w->lay->ink.kind == SLV_INK_GRADIENT;
    for (uint64_t i = begin; i < end; i++) {
        const slv_patch *patch = &w->patches->list[i];
        float *coverage = slvi_own_coverage(w->p, patch),
              *color = w->colors + w->starts[i] * SLV_PAINT_CHANNELS;
        for (uint32_t y = 0; y < patch->rect.height; y++)
            for (uint32_t x = 0; x < patch->rect.width; x++, color += SLV_PAINT_CHANNELS) {
                float *c = &coverage[(size_t)y * patch->rect.width + x];
                if (*c > 0)
                    *c *= (gradient ? gradient_texel : image_texel)(w, patch, patch->rect.x + x,
                                                                    patch->rect.y + y, color);
            }
    }
    return SLV_OK;
}

/* What the canvas has as far from the source, and in the same direction, as each texel lies from
 * the dab's middle. */
static slv_result clone_patch(const slvi_laying *w, uint64_t i) {
    const slv_ink *ink = &w->lay->ink;
    const slv_patch *patch = &w->patches->list[i];
    const slv_paint_surface *s = w->p->surface;
    uint32_t n = w->desc.nchannels, count = patch->rect.width * patch->rect.height;
    int32_t alpha = w->desc.alpha_channel;
    float *coverage = slvi_own_coverage(w->p, patch), flat[2], values[64];
    float *color = w->colors + w->starts[i] * SLV_PAINT_CHANNELS;
    double axis[3], across[3];
    uint32_t tri;
    double cx, cy;
    if (!slvi_surface_place(s, ink->source, &tri, &cx, &cy))
        return SLV_OK;
    slvi_tri_frame(s, tri, ink->axis, axis, across);
    slv_result result = SLV_OK;
    for (uint32_t k = 0; k < count && !result; k++, color += SLV_PAINT_CHANNELS) {
        slv_surface_point at = slvi_texel_point(patch->face, w->res[patch->face],
                                                patch->rect.x + k % patch->rect.width,
                                                patch->rect.y + k / patch->rect.width);
        if (!(coverage[k] > 0) || !slv_painter_unfolded(w->p, at, flat)) {
            coverage[k] = 0;
            continue;
        }
        flat[1] = ink->flip ? -flat[1] : flat[1];
        float far = hypotf(flat[0], flat[1]), direction[3];
        for (int c = 0; c < 3; c++)
            direction[c] = (float)(axis[c] * (double)flat[0] + across[c] * (double)flat[1]);
        at = ink->source;
        if (far > 0 && slv_paint_surface_walk(s, &at, direction, far) < 0.999f * far)
            coverage[k] = 0; /* nothing is beyond a boundary */
        if (!(result = slvi_painter_look_up(w->p, 1, &at, 0, values)))
            for (uint32_t c = w->paint->first_channel, d = 0; c < n && d < SLV_PAINT_CHANNELS; c++)
                color[d++] = values[c];
        if (alpha >= 0)
            coverage[k] *= values[alpha];
    }
    return result;
}

static slv_result check(const slvi_laying *w) {
    const slv_ink *ink = &w->lay->ink;
    const slv_env *env = &w->p->env;
    const slv_image *image = ink->image;
    bool images = ink->kind == SLV_INK_IMAGE || ink->kind == SLV_INK_STAMP;
    if (images &&
        (!image || !image->width || !image->height || !image->nchannels || image->nchannels > 4))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "ink: an image of 1 to 4 channels is missing");
    if ((ink->kind == SLV_INK_STAMP && !w->dab && !w->screen) ||
        (ink->kind == SLV_INK_CLONE && !w->dab))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "ink: %s are for dabs of the surface",
                         ink->kind == SLV_INK_STAMP ? "stamps" : "clones");
    if (ink->kind == SLV_INK_IMAGE &&
        (!(ink->size > 0) || !isfinite(ink->x + ink->y + ink->size + ink->angle)))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "ink: an image %g pixels wide at %g %g",
                         (double)ink->size, (double)ink->x, (double)ink->y);
    float length = 0;
    for (int k = 0; k < 3; k++)
        length += (ink->to[k] - ink->from[k]) * (ink->to[k] - ink->from[k]);
    if (ink->kind == SLV_INK_GRADIENT && !(length > 0 && isfinite(length)))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "ink: a gradient from a place to itself");
    return SLV_OK;
}

slv_result slvi_lay_ink(slvi_laying *w) {
    const slv_ink *ink = &w->lay->ink;
    slv_painter *p = w->p;
    slv_result result = SLV_OK;
    if (ink->kind == SLV_INK_PLAIN)
        return SLV_OK;
    if ((result = check(w)) ||
        (result = slvi_painter_room(p, w->patches->ntexels * SLV_PAINT_CHANNELS + 1,
                                    sizeof *p->colors, &p->colors, &p->color_room)))
        return result;
    w->colors = p->colors;
    const slv_screen_dab *screen = ink->kind == SLV_INK_STAMP ? w->screen : NULL;
    if ((ink->kind == SLV_INK_IMAGE &&
         (!ink->width || !ink->height ||
          !slvi_view_make(p->surface, &ink->camera, ink->width, ink->height, &w->view))) ||
        (screen &&
         !slvi_view_make(p->surface, &screen->camera, screen->width, screen->height, &w->view)))
        return slvi_fail(&p->env, SLV_ERROR_ARGUMENT, "ink: the camera cannot be inverted");
    if (ink->kind != SLV_INK_CLONE)
        return slvi_painter_share(p, w->patches, color_some, w);
    if (w->desc.nchannels > 64)
        return slvi_fail(&p->env, SLV_ERROR_LIMIT, "ink: %u channels are too many to be cloned",
                         (unsigned)w->desc.nchannels);
    result = slvi_painter_watch(p, w->canvas, &w->desc);
    for (uint64_t i = 0; i < w->patches->count && !result; i++)
        result = clone_patch(w, i);
    return result;
}
