/* From a brush's plane to the surface: pixels along rays, and unrolled paths along straight walks.
 */
#include "brush/mirror.h"
#include "brush/stroke_data.h"
#include "surface/painter_data.h"

#include <string.h>

/* The axis turned by an angle (degrees / turn: cosine and sine) around a normal. */
static void turn_axis(const float axis[3], const float normal[3], double c, double s,
                      float out[3]) {
    double a[3], n[3], across[3];
    for (int k = 0; k < 3; k++) {
        a[k] = (double)axis[k];
        n[k] = (double)normal[k];
    }
    slvi_cross(n, a, across);
    for (int k = 0; k < 3; k++)
        out[k] = (float)(c * a[k] + s * across[k]);
}

/* Straight from a base to a place of the plane: the point there, and the plane's x there. */
static void walk_from(const slv_stroke *s, const slvi_base *base, double x, double y,
                      slv_surface_point *at, float axis[3]) {
    const slv_paint_surface *surface = slv_painter_get_surface(s->painter);
    double dx = x - base->x, dy = y - base->y, far = hypot(dx, dy);
    float normal[3], direction[3];
    *at = base->at;
    memcpy(axis, base->axis, sizeof base->axis);
    if (!(far > 0))
        return;
    slv_paint_surface_at(surface, base->at, NULL, normal, NULL);
    turn_axis(base->axis, normal, dx / far, dy / far, direction);
    slv_paint_surface_walk(surface, at, direction, (float)far);
    slv_paint_surface_at(surface, *at, NULL, normal, NULL);
    turn_axis(direction, normal, dx / far, -dy / far, axis);
}

/* The direction of a face's u, at right angles to the normal and of length 1. */
static void begin_axis(const slv_paint_surface *surface, slv_surface_point at, float axis[3]) {
    slv_paint_surface_at(surface, at, NULL, NULL, axis);
}

slv_result slvi_place_sample(slv_stroke *s, const slv_stroke_sample *sample, double *x, double *y,
                             bool *reached) {
    const slv_paint_surface *surface = slv_painter_get_surface(s->painter);
    if (s->params.in_picture) {
        *x = (double)sample->x * s->scale;
        *y = (double)sample->y * s->scale;
        *reached = true;
        return SLV_OK;
    }
    slvi_base base = {.at = sample->at},
              *last = &s->bases[(s->nbases + SLVI_BASES - 1) % SLVI_BASES];
    float a[3], b[3], vector[2];
    *reached = s->nbases > 0;
    if (*reached) {
        slv_paint_surface_at(surface, last->at, a, NULL, NULL);
        slv_paint_surface_at(surface, sample->at, b, NULL, NULL);
        /* a path that is much longer than the straight line is no stroke but a jump */
        float limit = 3 * (float)slvi_distance(a, b) + 1e-6f * s->params.radius;
        slv_result result = slv_painter_locate(s->painter, last->at, last->axis, sample->at, limit,
                                               vector, reached);
        if (result)
            return result;
    }
    if (*reached) {
        slv_surface_point end;
        base.x = last->x + (double)vector[0];
        base.y = last->y + (double)vector[1];
        walk_from(s, last, base.x, base.y, &end, base.axis);
    } else {
        s->nbases = 0;
        begin_axis(surface, sample->at, base.axis);
    }
    s->bases[s->nbases++ % SLVI_BASES] = base;
    *x = base.x * s->scale;
    *y = base.y * s->scale;
    return SLV_OK;
}

static float texel_at(const slv_stroke *s, slv_surface_point at) {
    slv_canvas_desc desc;
    if (s->canvas.fns->describe(s->canvas.user, &desc) || (uint32_t)at.face >= desc.nfaces)
        return 0;
    return slvi_texel_length(slv_painter_get_surface(s->painter), (uint32_t)at.face,
                             desc.res[at.face]);
}

/* The point that a pixel shows, how large a pixel is there, and which way the picture's right lies.
 */
static bool look(const slv_stroke *s, double x, double y, slv_paint_hit *hit, double *pixel,
                 float right[3]) {
    const slv_paint_surface *surface = slv_painter_get_surface(s->painter);
    const slv_stroke_params *p = &s->params;
    float o[3], d[3], beside[3], towards[3];
    double sum = 0;
    if (!slv_paint_surface_ray(surface, &p->camera, p->width, p->height, (float)x, (float)y, o,
                               d) ||
        !slv_paint_surface_hit(surface, o, d, hit) ||
        !slv_paint_surface_ray(surface, &p->camera, p->width, p->height, (float)x + 1, (float)y,
                               beside, towards))
        return false;
    for (int k = 0; k < 3; k++) {
        right[k] = beside[k] - o[k] + hit->distance * (towards[k] - d[k]);
        sum += (double)right[k] * (double)right[k];
    }
    *pixel = sqrt(sum);
    return *pixel > 0;
}

bool slvi_place_scale(slv_stroke *s, const slv_stroke_sample *sample) {
    const slv_stroke_params *p = &s->params;
    slv_paint_hit hit = {.point = sample->at};
    double pixel = 1, size = (double)p->radius;
    float right[3];
    bool seen =
        !p->in_picture || look(s, (double)sample->x, (double)sample->y, &hit, &pixel, right);
    if (p->unit != SLV_SIZE_PIXELS && !seen)
        return false;
    if (p->unit == SLV_SIZE_TEXELS)
        size *= (double)texel_at(s, hit.point);
    if (p->in_picture && p->unit != SLV_SIZE_PIXELS)
        size /= pixel;
    s->scale = s->radius / size;
    return s->scale > 0 && isfinite(s->scale);
}

bool slvi_place_dab(slv_stroke *s, const slvi_plane_dab *dab, slv_stroke_dab *out) {
    const slv_stroke_params *p = &s->params;
    double x = dab->x / s->scale, y = dab->y / s->scale, length = dab->radius / s->scale;
    double share = dab->radius / s->radius, pixel = 1;
    *out = (slv_stroke_dab){.on_screen = p->in_picture && p->project};
    if (out->on_screen) {
        out->screen = (slv_screen_dab){.camera = p->camera,
                                       .width = p->width,
                                       .height = p->height,
                                       .x = (float)x,
                                       .y = (float)y,
                                       .radius = (float)length,
                                       .hardness = dab->hardness,
                                       .aspect = dab->aspect,
                                       .angle = dab->angle};
        return true;
    }
    out->dab = (slv_dab){.hardness = dab->hardness, .aspect = dab->aspect, .angle = dab->angle};
    if (p->in_picture) {
        slv_paint_hit hit;
        if (!look(s, x, y, &hit, &pixel, out->dab.axis))
            return false;
        out->dab.at = hit.point;
        out->dab.angle = -dab->angle; /* the picture's y runs down */
        length *= pixel;
    } else {
        const slvi_base *nearest = NULL;
        uint64_t have = s->nbases < SLVI_BASES ? s->nbases : SLVI_BASES;
        for (uint64_t i = 0; i < have; i++) {
            const slvi_base *b = &s->bases[i];
            if (!nearest || hypot(x - b->x, y - b->y) < hypot(x - nearest->x, y - nearest->y))
                nearest = b;
        }
        if (!nearest)
            return false;
        walk_from(s, nearest, x, y, &out->dab.at, out->dab.axis);
    }
    /* lengths and texels are those of the place, not of where the stroke began */
    if (p->unit == SLV_SIZE_WORLD)
        length = share * (double)p->radius;
    else if (p->unit == SLV_SIZE_TEXELS)
        length = share * (double)p->radius * (double)texel_at(s, out->dab.at);
    out->dab.radius = (float)length;
    return length > 0;
}

bool slvi_place_source(slv_stroke *s, slv_stroke_dab *dab) {
    const slv_paint_surface *surface = slv_painter_get_surface(s->painter);
    slv_ink *ink = &dab->lay.ink;
    float a[3], b[3], vector[2];
    double axis[3], across[3], x, y;
    uint32_t tri;
    bool reached;
    if (s->source.at.face < 0) {
        if (!slvi_surface_place(surface, s->lay.ink.source, &tri, &x, &y))
            return false;
        slvi_tri_frame(surface, tri, dab->dab.axis, axis, across);
        s->source = (slvi_base){.at = s->lay.ink.source};
        for (int k = 0; k < 3; k++)
            s->source.axis[k] = (float)axis[k];
        s->first_dab = (slvi_base){.at = dab->dab.at};
        memcpy(s->first_dab.axis, dab->dab.axis, sizeof dab->dab.axis);
    }
    slv_paint_surface_at(surface, s->first_dab.at, a, NULL, NULL);
    slv_paint_surface_at(surface, dab->dab.at, b, NULL, NULL);
    float limit = 3 * (float)slvi_distance(a, b) + dab->dab.radius;
    s->result = slv_painter_locate(s->painter, s->first_dab.at, s->first_dab.axis, dab->dab.at,
                                   limit, vector, &reached);
    if (s->result || !reached)
        return false;
    walk_from(s, &s->source, (double)vector[0], (double)vector[1], &ink->source, ink->axis);
    return true;
}

bool slvi_mirror_dab(const slv_stroke *s, unsigned which, const slv_stroke_dab *dab,
                     slv_stroke_dab *out) {
    const slvi_mirrors mirrors = {slv_painter_get_surface(s->painter), s->mirrors,
                                  s->params.nmirrors};
    float axis[3] = {0};
    *out = *dab;
    slvi_mirror_camera(&mirrors, which, &out->screen.camera);
    if (dab->laid && !slvi_mirror_lay(&mirrors, which, dab->dab.radius, &out->lay, &out->facing))
        return false;
    if (dab->on_screen)
        return true;
    slv_paint_surface_at(mirrors.surface, dab->dab.at, NULL, NULL, axis);
    if (dab->dab.axis[0] != 0 || dab->dab.axis[1] != 0 || dab->dab.axis[2] != 0)
        memcpy(axis, dab->dab.axis, sizeof axis);
    if (!slvi_mirror_point(&mirrors, which, dab->dab.radius, &out->dab.at, axis))
        return false;
    memcpy(out->dab.axis, axis, sizeof axis);
    out->dab.angle = slvi_mirror_turns(which) ? -dab->dab.angle : dab->dab.angle;
    return true;
}
