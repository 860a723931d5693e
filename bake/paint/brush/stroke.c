/* A stroke from pen down to pen up: samples make a curve, the brush makes dabs along it, and each
 * dab goes to its place, and to its mirrors', and onto the canvas. */
#include "brush/stroke_data.h"
#include "surface/painter_data.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/names.h"

#include <math.h>
#include <string.h>

/* The curve is handed to libmypaint in steps of a share of its radius. */
#define STEP 0.25
/* Of pens that tell no time: units of the plane in a second. */
#define SPEED 1000.0
/* Further from the first sample libmypaint counts no more. */
#define FARTHEST 2e5
#define MOST_DABS (UINT64_C(1) << 20)
enum { TAP_TRIES = 24 };

static const char *const unit_names[] = {"world", "pixels", "texels"};

const char *slv_size_unit_name(slv_size_unit unit) {
    return slvi_name_of(unit_names, SLVI_COUNT(unit_names), (int)unit);
}

bool slv_size_unit_from_name(const char *name, slv_size_unit *out) {
    int value;
    if (!slvi_name_find(unit_names, SLVI_COUNT(unit_names), name, &value))
        return false;
    *out = (slv_size_unit)value;
    return true;
}

static void put(slv_stroke *s, const slv_stroke_dab *dab) {
    slv_patches patches = {0};
    if (!s->result && s->params.each)
        s->result = s->params.each(s->params.user, dab);
    if (!s->result)
        s->result = slv_stroke_dab_apply(s->painter, &s->canvas, dab, &patches);
    s->stats.dabs += patches.count > 0;
    s->stats.texels += patches.ntexels;
}

/* Whether a mirrored dab is one that was put already: a round one on its own mirror, of which one
 * is enough. */
static bool is_again(const slv_stroke *s, const slv_stroke_dab *dab, float (*centres)[3],
                     uint32_t *count) {
    float *own = centres[*count];
    if (dab->on_screen || dab->laid || dab->dab.aspect > 1 ||
        !slv_paint_surface_at(slv_painter_get_surface(s->painter), dab->dab.at, own, NULL, NULL))
        return false;
    for (uint32_t i = 0; i < *count; i++)
        if (hypotf(hypotf(own[0] - centres[i][0], own[1] - centres[i][1]),
                   own[2] - centres[i][2]) <= 1e-3f * dab->dab.radius)
            return true;
    ++*count;
    return false;
}

/* A dab and its mirrored ones. */
static void put_all(slv_stroke *s, const slv_stroke_dab *dab) {
    float centres[1u << SLV_MIRRORS][3];
    uint32_t count = 0;
    (void)is_again(s, dab, centres, &count);
    put(s, dab);
    for (unsigned which = 1; which < 1u << s->params.nmirrors; which++) {
        slv_stroke_dab other;
        if (!slvi_mirror_dab(s, which, dab, &other))
            s->stats.missed++;
        else if (!is_again(s, &other, centres, &count))
            put(s, &other);
    }
}

/* The colours of a dab, in the channels that are colours. */
static void set_color(slv_stroke *s, const float rgb[3], slv_paint *paint) {
    slv_canvas_desc desc;
    if (s->canvas.fns->describe(s->canvas.user, &desc) ||
        desc.nchannels < 3u + (desc.alpha_channel >= 0))
        return;
    for (uint32_t c = paint->first_channel, k = 0; c < desc.nchannels && k < 3; c++)
        if ((int32_t)c != desc.alpha_channel && c - paint->first_channel < SLV_PAINT_CHANNELS)
            paint->color[c - paint->first_channel] = rgb[k++];
}

/* What the stroke's ink wants of a dab: of a stamp the disc is around its square. False if there is
 * nothing to paint with. */
static bool aim_ink(slv_stroke *s, slv_stroke_dab *dab) {
    const float around = 1.41421356f;
    dab->laid = s->params.lay != NULL;
    if (!dab->laid)
        return true;
    dab->lay = s->lay;
    dab->dab.unfold = s->lay.ink.kind >= SLV_INK_STAMP;
    if (s->lay.ink.kind == SLV_INK_STAMP) {
        dab->dab.radius *= around;
        dab->screen.radius *= around;
        dab->dab.hardness = dab->screen.hardness = 1;
        dab->dab.aspect = dab->screen.aspect = 1;
    }
    return s->lay.ink.kind != SLV_INK_CLONE || slvi_place_source(s, dab);
}

/* A dab of libmypaint is up to four: what it erases, and what of the rest keeps alpha, or the
 * luminosity, or nothing. */
static void put_plane_dab(void *user, const slvi_plane_dab *dab) {
    slv_stroke *s = user;
    slvi_plane_dab placed = *dab;
    slv_stroke_dab out;
    if (s->result)
        return;
    if (s->ndabs++ >= MOST_DABS) {
        s->result = slvi_fail(&s->env, SLV_ERROR_LIMIT, "stroke: more than %llu dabs",
                              (unsigned long long)MOST_DABS);
        return;
    }
    if (s->tap) {
        placed.x = s->first.x;
        placed.y = s->first.y;
    }
    if (!slvi_place_dab(s, &placed, &out) || !aim_ink(s, &out)) {
        s->stats.missed++;
        return;
    }
    float rest = 1 - dab->erase;
    const float shares[4] = {dab->erase, rest * (1 - dab->lock_alpha) * (1 - dab->colorize),
                             rest * dab->lock_alpha * (1 - dab->colorize), rest * dab->colorize};
    for (int pass = 0; pass < 4; pass++) {
        out.paint = s->params.paint;
        out.paint.opacity = fminf(out.paint.opacity * dab->opacity * shares[pass], 1);
        if (s->params.brush->is_file)
            set_color(s, dab->rgb, &out.paint);
        out.paint.erase |= pass == 0;
        out.paint.lock_alpha |= pass == 2;
        if (pass == 3)
            out.paint.blend = SLV_BLEND_COLOR;
        out.blur = s->params.blur * out.dab.radius;
        if (out.paint.opacity > 0)
            put_all(s, &out);
    }
}

/* What is under a brush: the mean over a soft dab of its size. */
static void pick_color(void *user, double x, double y, double radius, float rgba[4]) {
    slv_stroke *s = user;
    const slvi_plane_dab dab = {
        .x = x, .y = y, .radius = radius, .opacity = 1, .hardness = 0.5f, .aspect = 1};
    slv_stroke_dab placed;
    slv_patches patches;
    slv_canvas_desc desc;
    float mean[64];
    bool any = false;
    if (s->result || !slvi_place_dab(s, &dab, &placed) ||
        s->canvas.fns->describe(s->canvas.user, &desc) ||
        desc.nchannels > sizeof mean / sizeof *mean)
        return;
    s->result = placed.on_screen
                    ? slv_painter_cover_screen(s->painter, desc.res, &placed.screen, &patches)
                    : slv_painter_cover(s->painter, desc.res, &placed.dab, &patches);
    if (!s->result)
        s->result = slv_painter_mean(s->painter, &s->canvas, &patches, mean, &any);
    if (s->result || !any)
        return;
    uint32_t k = 0;
    for (uint32_t c = 0; c < desc.nchannels && k < 3; c++)
        if ((int32_t)c != desc.alpha_channel)
            rgba[k++] = mean[c];
    for (; k && k < 3; k++)
        rgba[k] = rgba[0];
    rgba[3] = desc.alpha_channel >= 0 ? mean[desc.alpha_channel] : 1;
}

static void put_round_dab(slv_stroke *s, const slvi_path_point *at, double heading) {
    const slv_brush_params *b = &s->params.brush->round;
    float press = fminf(fmaxf(at->pressure, 0), 1);
    slvi_plane_dab dab = {.x = at->x,
                          .y = at->y,
                          .radius = s->radius * (double)(1 - b->pressure_radius * (1 - press)),
                          .opacity = 1 - b->pressure_opacity * (1 - press),
                          .hardness = b->hardness,
                          .aspect = b->aspect,
                          .angle = b->angle};
    if (b->follow)
        dab.angle += (float)(heading * 180 / 3.14159265358979);
    s->next = s->walked + (double)b->spacing * fmax(dab.radius, 0.01 * s->radius);
    if (dab.radius > 0 && dab.opacity > 0)
        put_plane_dab(s, &dab);
}

static void move_mypaint(slv_stroke *s, const slvi_path_point *to) {
    double seconds = to->time - s->step.time;
    if (!(seconds > 0))
        seconds = hypot(to->x - s->step.x, to->y - s->step.y) / SPEED;
    slvi_mypaint_move(s->engine, to->x, to->y, to->pressure, to->tilt_x, to->tilt_y,
                      fmax(seconds, 1e-5));
    s->step = *to;
    s->next = s->walked + STEP * s->radius;
}

static slvi_path_point between(const slvi_path_point *a, const slvi_path_point *b, double t) {
    float f = (float)t;
    return (slvi_path_point){a->x + t * (b->x - a->x),
                             a->y + t * (b->y - a->y),
                             a->time + t * (b->time - a->time),
                             a->pressure + f * (b->pressure - a->pressure),
                             a->tilt_x + f * (b->tilt_x - a->tilt_x),
                             a->tilt_y + f * (b->tilt_y - a->tilt_y)};
}

/* A straight piece of the curve. */
static void walk_piece(void *user, const slvi_path_point *from, const slvi_path_point *to) {
    slv_stroke *s = user;
    double begin = s->walked, length = hypot(to->x - from->x, to->y - from->y),
           heading = atan2(to->y - from->y, to->x - from->x);
    if (!(length > 0)) { /* the pen rests, and time passes */
        if (s->engine)
            move_mypaint(s, to);
        return;
    }
    while (s->next <= begin + length && !s->result) {
        s->walked = s->next;
        slvi_path_point at = between(from, to, (s->walked - begin) / length);
        if (s->engine)
            move_mypaint(s, &at);
        else
            put_round_dab(s, &at, heading);
    }
    s->walked = begin + length;
}

static slv_result check(const slv_env *env, const slv_stroke_params *p) {
    bool fine = isfinite(p->radius) && p->radius >= 0 && p->blur >= 0 && p->blur <= 16 &&
                !(p->blur > 0 && p->project) && p->nmirrors <= SLV_MIRRORS &&
                (unsigned)p->unit < SLVI_COUNT(unit_names) && p->paint.opacity >= 0 &&
                p->paint.opacity <= 1;
    for (int c = 0; c < SLV_PAINT_CHANNELS; c++)
        fine = fine && isfinite(p->paint.color[c]);
    for (uint32_t i = 0; fine && i < p->nmirrors; i++) {
        const slv_mirror *m = &p->mirrors[i];
        float n = 0;
        for (int k = 0; k < 3; k++) {
            fine = fine && isfinite(m->point[k]) && isfinite(m->normal[k]);
            n += fabsf(m->normal[k]);
        }
        fine = fine && n > 0;
    }
    if (!fine || !p->brush)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "stroke: radius, opacity, colour, blur or mirrors are out of range");
    if (p->lay && p->lay->ink.kind == SLV_INK_CLONE && p->project)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "stroke: dabs of the picture clone nothing");
    if (!p->in_picture && (p->unit == SLV_SIZE_PIXELS || !(p->radius > 0)))
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "stroke: on the surface a radius is in mesh units or texels, more than 0");
    if (p->in_picture && (!p->width || !p->height))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "stroke: a picture of %u x %u pixels",
                         (unsigned)p->width, (unsigned)p->height);
    return SLV_OK;
}

slv_result slv_stroke_begin(slv_painter *painter, const slv_canvas *canvas,
                            const slv_stroke_params *params, slv_stroke **out) {
    const slv_env *env = slvi_painter_env(painter);
    slv_stroke *s = NULL;
    *out = NULL;
    slv_result result = check(env, params);
    if (result || (result = slvi_alloc(env, "stroke", 1, sizeof *s, &s)))
        return result;
    s->env = *env;
    s->painter = painter;
    s->canvas = *canvas;
    s->params = *params;
    for (uint32_t i = 0; i < params->nmirrors; i++)
        s->mirrors[i] = params->mirrors[i];
    if (params->lay)
        s->lay = *params->lay;
    s->params.lay = params->lay ? &s->lay : NULL;
    s->source.at.face = -1; /* no dab was cloned yet */
    s->radius = (double)slv_brush_radius(params->brush);
    if (!(s->params.radius > 0)) {
        s->params.radius = (float)s->radius;
        s->params.unit = SLV_SIZE_PIXELS;
    }
    s->path = (slvi_path){.piece = walk_piece, .user = s, .smallest = 1e-3 * s->radius};
    *out = s;
    return SLV_OK;
}

static bool sample_is_fine(const slv_stroke *s, const slv_stroke_sample *a) {
    bool placed = s->params.in_picture
                      ? isfinite(a->x) && isfinite(a->y)
                      : isfinite(a->at.u) && isfinite(a->at.v) &&
                            slv_paint_surface_at(slv_painter_get_surface(s->painter), a->at, NULL,
                                                 NULL, NULL);
    return placed && isfinite(a->pressure) && isfinite(a->tilt_x) && isfinite(a->tilt_y) &&
           isfinite(a->time);
}

static float within(float value, float low, float high) {
    return value > low ? value < high ? value : high : low;
}

/* The brush is put down at a sample. */
static slv_result begin_path(slv_stroke *s, const slvi_path_point *at) {
    const slvi_plane plane = {put_plane_dab, pick_color, s};
    slv_result result = SLV_OK;
    s->walked = 0;
    s->next = 0;
    s->step = *at;
    if (!s->begun)
        s->first = *at;
    s->begun = true;
    if (!s->params.brush->is_file)
        return SLV_OK;
    slvi_mypaint_end(s->engine);
    s->engine = NULL;
    float rgb[3] = {s->params.paint.color[0], s->params.paint.color[1], s->params.paint.color[2]};
    if (!(result = slvi_mypaint_begin(s->params.brush, rgb, &plane, &s->engine)))
        slvi_mypaint_move(s->engine, at->x, at->y, 0, at->tilt_x, at->tilt_y, 10);
    s->next = STEP * s->radius;
    return result;
}

static slv_result add(slv_stroke *s, const slv_stroke_sample *sample) {
    slvi_path_point at = {.time = sample->time,
                          .pressure = within(sample->pressure, 0, 1),
                          .tilt_x = within(sample->tilt_x, -1, 1),
                          .tilt_y = within(sample->tilt_y, -1, 1)};
    if (!sample_is_fine(s, sample))
        return slvi_fail(&s->env, SLV_ERROR_ARGUMENT,
                         "stroke: a sample at face %d, pixel %g %g, that is no place",
                         (int)sample->at.face, (double)sample->x, (double)sample->y);
    if (!(s->scale > 0) && !slvi_place_scale(s, sample)) {
        s->scale = 0; /* not above the surface yet */
        s->stats.missed++;
        return SLV_OK;
    }
    bool reached;
    slv_result result = slvi_place_sample(s, sample, &at.x, &at.y, &reached);
    if (result)
        return result;
    if (!(fabs(at.x) < FARTHEST && fabs(at.y) < FARTHEST))
        return slvi_fail(&s->env, SLV_ERROR_LIMIT,
                         "stroke: a sample %g radii away is too far for one stroke",
                         hypot(at.x, at.y) / s->radius);
    if (!reached || !s->begun) {
        slvi_path_end(&s->path);
        if ((result = begin_path(s, &at)))
            return result;
    }
    slvi_path_add(&s->path, &at);
    return s->result;
}

slv_result slv_stroke_add(slv_stroke *stroke, const slv_stroke_sample *samples, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        slv_result result = stroke->result ? stroke->result : add(stroke, &samples[i]);
        if (result)
            return result;
    }
    return SLV_OK;
}

/* A pen that did not move: brushes of MyPaint make dabs as time passes, or on a way that is short
 * here, and the dab is put where the pen was. */
static void tap(slv_stroke *s) {
    slvi_path_point at = s->first;
    s->tap = true;
    if (!s->engine) {
        put_round_dab(s, &at, 0);
        return;
    }
    for (int i = 0; i < TAP_TRIES && !s->ndabs; i++) {
        at.time += 0.02;
        at.x += i < TAP_TRIES / 4 ? 0 : 0.2 * s->radius;
        move_mypaint(s, &at);
    }
}

slv_result slv_stroke_end(slv_stroke *stroke, slv_stroke_stats *stats) {
    slvi_path_point last =
        stroke->path.count ? stroke->path.last[stroke->path.count - 1] : (slvi_path_point){0};
    bool moved = stroke->path.count > 1;
    slvi_path_end(&stroke->path);
    if (stroke->engine && moved && !stroke->result)
        move_mypaint(stroke, &last); /* what is less than a step */
    if (stroke->begun && !stroke->ndabs && !stroke->result)
        tap(stroke);
    if (stats)
        *stats = stroke->stats;
    return stroke->result;
}

void slv_stroke_destroy(slv_stroke *stroke) {
    if (!stroke)
        return;
    slvi_mypaint_end(stroke->engine);
    slvi_free(stroke);
}

slv_result slv_stroke_dab_apply(slv_painter *painter, const slv_canvas *canvas,
                                const slv_stroke_dab *dab, slv_patches *patches) {
    slv_patches own;
    slv_canvas_desc desc;
    patches = patches ? patches : &own;
    *patches = (slv_patches){0};
    slv_result result = canvas->fns->describe(canvas->user, &desc);
    if (!result)
        result = dab->on_screen ? slv_painter_cover_screen(painter, desc.res, &dab->screen, patches)
                                : slv_painter_cover(painter, desc.res, &dab->dab, patches);
    if (result)
        return result;
    if (dab->laid) {
        slv_lay lay = dab->lay;
        lay.blur = dab->blur;
        return slv_painter_lay(painter, canvas, patches, &dab->paint, &lay,
                               dab->on_screen ? NULL : &dab->dab,
                               dab->on_screen ? &dab->screen : NULL);
    }
    return dab->blur > 0 ? slv_painter_blur(painter, canvas, patches, dab->blur, dab->paint.opacity)
                         : slv_painter_apply(painter, canvas, patches, &dab->paint);
}
