/* libmypaint as the maker of dabs: what it would draw on a canvas of its own is handed on.
 *
 * The surface interface of the first generation is used: the second one mixes spectra, which takes
 * many times as long and is not ours to undo. */
#include "brush/brush_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

#ifdef SLV_HAVE_MYPAINT

#include <mypaint-brush.h>

struct slvi_mypaint {
    MyPaintSurface surface; /* first: libmypaint hands it back */
    slvi_plane plane;
    MyPaintBrush *brush;
};

/* Its engine keeps a buffer that all strokes share. */
static pthread_mutex_t engine_lock = PTHREAD_MUTEX_INITIALIZER;

int slvi_mypaint_settings(void) {
    return MYPAINT_BRUSH_SETTINGS_COUNT;
}

/* Its own search for names ends the process where there are none, in some versions. */
int slvi_mypaint_setting(const char *name) {
    for (int i = 0; i < MYPAINT_BRUSH_SETTINGS_COUNT; i++)
        if (strcmp(mypaint_brush_setting_info((MyPaintBrushSetting)i)->cname, name) == 0)
            return i;
    return -1;
}

int slvi_mypaint_input(const char *name) {
    for (int i = 0; i < MYPAINT_BRUSH_INPUTS_COUNT; i++)
        if (strcmp(mypaint_brush_input_info((MyPaintBrushInput)i)->cname, name) == 0)
            return i;
    return -1;
}

void slvi_mypaint_range(int setting, float *low, float *base, float *high) {
    const MyPaintBrushSettingInfo *info = mypaint_brush_setting_info((MyPaintBrushSetting)setting);
    *low = info->min;
    *base = info->def;
    *high = info->max;
}

float slvi_mypaint_radius(const slv_brush *brush) {
    float r = expf(brush->base[MYPAINT_BRUSH_SETTING_RADIUS_LOGARITHMIC]);
    return r < 0.2f ? 0.2f : r > 1000 ? 1000 : r;
}

/* What is not within 0..1 is cut off, as libmypaint's own surfaces do. */
static float share(float value) {
    return fminf(fmaxf(value, 0), 1);
}

/* As many parameters as there are, since libmypaint calls it with them. */
static int draw_dab(MyPaintSurface *surface, float x, float y, float radius, float r, float g,
                    float b, float opaque, float hardness, float alpha_eraser, float aspect_ratio,
                    float angle, float lock_alpha, float colorize) {
    const slvi_mypaint *engine = (const slvi_mypaint *)(const void *)surface;
    slvi_plane_dab dab = {.x = (double)x,
                          .y = (double)y,
                          .radius = (double)radius,
                          .rgb = {r, g, b},
                          .opacity = share(opaque),
                          .hardness = share(hardness),
                          .aspect = fminf(fmaxf(aspect_ratio, 1), 1000),
                          .angle = angle,
                          .erase = 1 - share(alpha_eraser),
                          .lock_alpha = share(lock_alpha),
                          .colorize = share(colorize)};
    if (!(radius >= 0.1f) || !isfinite(radius + x + y + angle) || !(opaque > 0) || !(hardness > 0))
        return 0;
    engine->plane.dab(engine->plane.user, &dab);
    return 1;
}

static void get_color(MyPaintSurface *surface, float x, float y, float radius, float *r, float *g,
                      float *b, float *a) {
    const slvi_mypaint *engine = (const slvi_mypaint *)(const void *)surface;
    float rgba[4] = {0};
    engine->plane.color(engine->plane.user, (double)x, (double)y, (double)radius, rgba);
    *r = rgba[0];
    *g = rgba[1];
    *b = rgba[2];
    *a = rgba[3];
}

static void fill_brush(MyPaintBrush *to, const slv_brush *from, const float rgb[3]) {
    float hsv[3];
    for (int i = 0; i < MYPAINT_BRUSH_SETTINGS_COUNT; i++)
        mypaint_brush_set_base_value(to, (MyPaintBrushSetting)i, from->base[i]);
    for (uint32_t i = 0; i < from->ncurves; i++) {
        const slvi_brush_curve *c = &from->curves[i];
        MyPaintBrushSetting setting = (MyPaintBrushSetting)c->setting;
        mypaint_brush_set_mapping_n(to, setting, (MyPaintBrushInput)c->input, c->count);
        for (int k = 0; k < c->count; k++)
            mypaint_brush_set_mapping_point(to, setting, (MyPaintBrushInput)c->input, k,
                                            c->points[2 * k], c->points[2 * k + 1]);
    }
    slvi_rgb_to_hsv(rgb, hsv);
    mypaint_brush_set_base_value(to, MYPAINT_BRUSH_SETTING_COLOR_H, hsv[0]);
    mypaint_brush_set_base_value(to, MYPAINT_BRUSH_SETTING_COLOR_S, hsv[1]);
    mypaint_brush_set_base_value(to, MYPAINT_BRUSH_SETTING_COLOR_V, hsv[2]);
}

slv_result slvi_mypaint_begin(const slv_brush *brush, const float rgb[3], const slvi_plane *plane,
                              slvi_mypaint **out) {
    slvi_mypaint *engine = NULL;
    *out = NULL;
    slv_result result = slvi_alloc(&brush->env, "brush", 1, sizeof *engine, &engine);
    if (result)
        return result;
    engine->plane = *plane;
    pthread_mutex_lock(&engine_lock);
    mypaint_surface_init(&engine->surface);
    engine->surface.draw_dab = draw_dab;
    engine->surface.get_color = get_color;
    engine->brush = mypaint_brush_new();
    if (engine->brush) {
        fill_brush(engine->brush, brush, rgb);
        mypaint_brush_reset(engine->brush);
        mypaint_brush_new_stroke(engine->brush);
    }
    pthread_mutex_unlock(&engine_lock);
    if (!engine->brush) {
        slvi_free(engine);
        return slvi_fail(&brush->env, SLV_ERROR_MEMORY, "brush: libmypaint has no memory");
    }
    *out = engine;
    return SLV_OK;
}

void slvi_mypaint_move(slvi_mypaint *engine, double x, double y, float pressure, float tilt_x,
                       float tilt_y, double seconds) {
    pthread_mutex_lock(&engine_lock);
    mypaint_brush_stroke_to(engine->brush, &engine->surface, (float)x, (float)y, pressure, tilt_x,
                            tilt_y, seconds);
    pthread_mutex_unlock(&engine_lock);
}

void slvi_mypaint_end(slvi_mypaint *engine) {
    if (!engine)
        return;
    mypaint_brush_unref(engine->brush);
    slvi_free(engine);
}

#else

int slvi_mypaint_settings(void) {
    return 0;
}

int slvi_mypaint_setting(const char *name) {
    (void)name;
    return -1;
}

int slvi_mypaint_input(const char *name) {
    (void)name;
    return -1;
}

void slvi_mypaint_range(int setting, float *low, float *base, float *high) {
    (void)setting;
    *low = *base = *high = 0;
}

float slvi_mypaint_radius(const slv_brush *brush) {
    return brush->radius;
}

slv_result slvi_mypaint_begin(const slv_brush *brush, const float rgb[3], const slvi_plane *plane,
                              slvi_mypaint **out) {
    (void)rgb;
    (void)plane;
    *out = NULL;
    return slvi_fail(&brush->env, SLV_ERROR_UNSUPPORTED,
                     "brush: brushes of MyPaint take a build with libmypaint");
}

void slvi_mypaint_move(slvi_mypaint *engine, double x, double y, float pressure, float tilt_x,
                       float tilt_y, double seconds) {
    (void)engine, (void)x, (void)y, (void)pressure, (void)tilt_x, (void)tilt_y, (void)seconds;
}

void slvi_mypaint_end(slvi_mypaint *engine) {
    (void)engine;
}

#endif
