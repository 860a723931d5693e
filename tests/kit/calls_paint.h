/* Calls of calls_kit.h that have to do with new textures and with painting. */
#ifndef CALLS_PAINT_H
#define CALLS_PAINT_H

#include "kit/calls_data.h"

#include <selvage/blank.h>
#include <selvage/brush.h>
#include <selvage/script.h>

static slv_result call_blank(const slv_env *env) {
    const slv_blank_params params = {.max_texels = 1000};
    slv_res *res = NULL;
    slv_texture *texture = NULL;
    slv_result result = slv_blank_plan(env, calls.mesh, &params, &res, NULL);
    if (!result && !(result = slv_blank_create(env, calls.mesh, &params, &texture, NULL)))
        result = slv_blank_save(env, calls.mesh, &params, calls_path("blank.ptx"), NULL);
    slv_free(res);
    slv_texture_destroy(texture);
    return result;
}

/* A painter and what it paints on, made within a call. */
typedef struct calls_easel {
    slv_paint_surface *surface;
    slv_painter *painter;
    slv_texture *texture;
    slv_canvas canvas;
} calls_easel;

static slv_result easel_begin(const slv_env *env, calls_easel *easel) {
    const slv_blank_params params = {.uniform = true, .res = {3, 3}};
    *easel = (calls_easel){0};
    slv_result result = slv_paint_surface_create(env, calls.mesh, NULL, &easel->surface);
    if (!result && !(result = slv_painter_create(env, easel->surface, &easel->painter)))
        result = slv_blank_create(env, calls.mesh, &params, &easel->texture, NULL);
    if (!result)
        easel->canvas = slv_texture_as_canvas(easel->texture);
    return result;
}

static void easel_end(calls_easel *easel) {
    slv_texture_destroy(easel->texture);
    slv_painter_destroy(easel->painter);
    slv_paint_surface_destroy(easel->surface);
}

static slv_camera easel_camera(const calls_easel *easel) {
    float low[3], high[3];
    slv_paint_surface_bounds(easel->surface, low, high);
    return slv_camera_orbit(low, high, 20, 60, 30, 1);
}

static slv_result call_dabs(const slv_env *env) {
    const slv_paint paint = {.color = {1, 0.5f, 0}, .opacity = 0.7f};
    calls_easel easel;
    slv_patches patches;
    float mean[4];
    slv_result result = easel_begin(env, &easel);
    const slv_res *res = result ? NULL : slv_texture_get_desc(easel.texture)->res;
    const slv_dab dab = {.at = {0, 0.9f, 0.5f}, .radius = 0.4f, .hardness = 0.5f};
    if (!result && !(result = slv_painter_cover(easel.painter, res, &dab, &patches)) &&
        !(result = slv_painter_apply(easel.painter, &easel.canvas, &patches, &paint)) &&
        !(result = slv_painter_mean(easel.painter, &easel.canvas, &patches, mean, NULL))) {
        const slv_screen_dab screen = {.camera = easel_camera(&easel),
                                       .width = 64,
                                       .height = 64,
                                       .x = 32,
                                       .y = 32,
                                       .radius = 9,
                                       .hardness = 0.5f};
        result = slv_painter_cover_screen(easel.painter, res, &screen, &patches);
    }
    easel_end(&easel);
    return result;
}

static const char calls_brush[] =
    "{\"version\": 3, \"settings\": {\"opaque\": {\"base_value\": 0.8, \"inputs\": {}}}}";

static bool calls_mypaint; /* whether there is libmypaint */

static inline void calls_prepare_brush(void) {
    slv_env env = test_env();
    slv_brush *brush = NULL;
    FILE *stream = fopen(calls_path("brush.myb"), "w");
    REQUIRE(stream && fputs(calls_brush, stream) >= 0 && fclose(stream) == 0);
    calls_mypaint = slv_brush_load(&env, calls.out, &brush) != SLV_ERROR_UNSUPPORTED;
    slv_brush_destroy(brush);
}

static slv_result call_brush(const slv_env *env) {
    slv_brush *brush = NULL, *loaded = NULL;
    const char *path = calls_path("brush.myb");
    if (!calls_mypaint) {
        slv_result without = slv_brush_create(env, NULL, &brush);
        slv_brush_destroy(brush);
        return without;
    }
    slv_result result = slv_brush_parse(env, "brush", calls_brush, sizeof calls_brush - 1, &brush);
    if (!result)
        result = slv_brush_load(env, path, &loaded);
    slv_brush_destroy(brush);
    slv_brush_destroy(loaded);
    return result;
}

static slv_result call_stroke(const slv_env *env) {
    const slv_stroke_sample samples[3] = {
        {.at = {0, 0.1f, 0.2f}, .pressure = 1},
        {.at = {0, 0.5f, 0.6f}, .pressure = 1, .time = 0.1},
        {.at = {0, 0.9f, 0.4f}, .pressure = 1, .time = 0.2},
    };
    const slv_stroke_dab again = {.dab = {.at = {0, 0.5f, 0.5f}, .radius = 0.2f},
                                  .paint = {.color = {1, 1, 1}, .opacity = 1}};
    calls_easel easel;
    slv_brush *brush = NULL;
    slv_stroke *stroke = NULL;
    float vector[2];
    bool reached;
    const float axis[3] = {0};
    slv_result result = easel_begin(env, &easel);
    if (!result &&
        !(result = slv_painter_locate(easel.painter, samples[0].at, axis, samples[2].at, 9, vector,
                                      &reached)) &&
        !(result = slv_brush_create(env, NULL, &brush))) {
        const slv_stroke_params params = {
            .brush = brush, .paint = {.color = {1, 0, 0}, .opacity = 1}, .radius = 0.2f};
        result = slv_stroke_begin(easel.painter, &easel.canvas, &params, &stroke);
    }
    if (!result && !(result = slv_stroke_add(stroke, samples, 3)) &&
        !(result = slv_stroke_end(stroke, NULL)))
        result = slv_stroke_dab_apply(easel.painter, &easel.canvas, &again, NULL);
    slv_stroke_destroy(stroke);
    slv_brush_destroy(brush);
    easel_end(&easel);
    return result;
}

static slv_result call_fill(const slv_env *env) {
    const slv_paint paint = {.color = {1, 0.5f, 0}, .opacity = 0.7f};
    const slv_dab dab = {.at = {0, 0.9f, 0.5f}, .radius = 0.4f, .hardness = 0.5f};
    slv_seam_certificate seams;
    slv_patches patches;
    uint8_t selected[CALLS_FACES] = {0};
    calls_easel easel;
    slv_result result = easel_begin(env, &easel);
    const slv_res *res = result ? NULL : slv_texture_get_desc(easel.texture)->res;
    if (!result &&
        !(result = slv_painter_select(easel.painter, 1, SLV_SELECT_CONNECTED, 0, selected)) &&
        !(result = slv_painter_fill(easel.painter, &easel.canvas, selected, &paint, NULL)) &&
        !(result = slv_painter_cover(easel.painter, res, &dab, &patches)) &&
        !(result = slv_painter_blur(easel.painter, &easel.canvas, &patches, 0.2f, 1)))
        result = slv_seam_certify_two(env, &easel.canvas, &easel.canvas,
                                      slv_paint_surface_adjacency(easel.surface), &seams);
    if (!result)
        result = slv_seam_certify(env, &easel.canvas, slv_paint_surface_adjacency(easel.surface),
                                  &seams);
    easel_end(&easel);
    return result;
}

/* A masked clone on both sides of a symmetry, gradients all over, and what is alike. */
static slv_result call_lay(const slv_env *env) {
    const slv_paint paint = {.color = {1, 0.5f, 0}, .opacity = 0.7f};
    const slv_dab dab = {.at = {0, 0.9f, 0.5f}, .radius = 0.4f, .hardness = 0.5f, .unfold = true};
    const uint32_t face[2] = {0, 1};
    const unsigned edge[2] = {1, 3};
    slv_symmetry *symmetry = NULL;
    slv_lay lay = {.ink = {.kind = SLV_INK_CLONE, .source = {1, 0.5f, 0.5f}},
                   .mask = {.towards = {0, 0, 1}, .degrees = 170}};
    uint8_t selected[CALLS_FACES] = {1, 1};
    slv_patches patches;
    calls_easel easel;
    slv_result result = easel_begin(env, &easel);
    const slv_res *res = result ? NULL : slv_texture_get_desc(easel.texture)->res;
    if (!result &&
        !(result = slv_symmetry_create(env, slv_paint_surface_adjacency(easel.surface), face, edge,
                                       &symmetry, NULL)) &&
        !(result = slv_painter_cover(easel.painter, res, &dab, &patches))) {
        lay.symmetry = symmetry;
        result = slv_painter_lay(easel.painter, &easel.canvas, &patches, &paint, &lay, &dab, NULL);
    }
    lay.ink = (slv_ink){.kind = SLV_INK_GRADIENT, .to = {1, 1, 0}};
    if (!result && !(result = slv_painter_fill_with(easel.painter, &easel.canvas, selected, &paint,
                                                    &lay, NULL)))
        result = slv_painter_flood(easel.painter, &easel.canvas, (slv_surface_point){0, 0.1f, 0.1f},
                                   0.5f, &paint, &lay, NULL);
    slv_symmetry_destroy(symmetry);
    easel_end(&easel);
    return result;
}

static const char calls_script[] =
    "{\"radius\": 0.3, \"brush\": {\"hardness\": 0.7}, \"color\": [1, 0, 0], \"samples\": "
    "[[0, 0.2, 0.4], [0, 0.5, 0.6], [1, 0.4, 0.4]], \"mirror\": [{\"point\": [1, 0, 0], "
    "\"normal\": [1, 0, 0]}]}";

static slv_result call_script(const slv_env *env) {
    calls_easel easel;
    slv_script *script = NULL;
    slv_result result = easel_begin(env, &easel);
    if (!result && !(result = slv_script_create(easel.painter, &easel.canvas, NULL, &script)))
        result = slv_script_run(script, 1, calls_script, sizeof calls_script - 1);
    slv_script_destroy(script);
    easel_end(&easel);
    return result;
}

#endif
