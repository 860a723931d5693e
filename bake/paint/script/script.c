/* Scripts: lines that are run on a canvas, which notes what they touch. */
#include "script/script_data.h"
#include "surface/painter_data.h"

#include "base/json.h"
#include "base/log.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

static slv_result describe(void *user, slv_canvas_desc *out) {
    const slv_script *s = user;
    return s->inner.fns->describe(s->inner.user, out);
}

static bool is_covered(const slv_patch *patch) {
    size_t count = (size_t)patch->rect.width * patch->rect.height, i = 0;
    while (i < count && !(patch->coverage[i] > 0))
        i++;
    return i < count;
}

static slv_result begin(void *user, const slv_patches *patches) {
    slv_script *s = user;
    uint64_t most = (uint64_t)s->stats.faces + patches->count, room = most + most / 2;
    slv_result result = SLV_OK;
    if (most > s->list_room &&
        !(result = slvi_grow(&s->env, "script", room, sizeof *s->list, &s->list)))
        s->list_room = room;
    if (!result && s->inner.fns->begin)
        result = s->inner.fns->begin(s->inner.user, patches);
    for (uint32_t i = 0; i < patches->count && !result; i++) {
        uint32_t face = patches->list[i].face;
        if (s->touched[face] || !is_covered(&patches->list[i])) /* a mask may have left nothing */
            continue;
        s->list[s->stats.faces++] = face;
        s->touched[face] = 1;
    }
    return result;
}

static slv_result read_rect(void *user, uint32_t face, slv_rect rect, float *out) {
    const slv_script *s = user;
    return s->inner.fns->read(s->inner.user, face, rect, out);
}

static slv_result write_rect(void *user, uint32_t face, slv_rect rect, const float *texels) {
    const slv_script *s = user;
    return s->inner.fns->write(s->inner.user, face, rect, texels);
}

static void set_defaults(slvi_line *set) {
    set->stroke.paint.opacity = 1;
    set->stroke.unit = SLV_SIZE_WORLD;
    set->degrees = 30;
    set->at[0] = set->at[1] = 0.5f;
    for (int c = 3; c < SLV_PAINT_CHANNELS; c++)
        set->stroke.paint.color[c] = 1;
}

slv_result slv_script_create(slv_painter *painter, const slv_canvas *canvas,
                             const slv_script_params *params, slv_script **out) {
    static const slv_canvas_fns fns = {
        .describe = describe, .begin = begin, .read = read_rect, .write = write_rect};
    const slv_script_params none = {0};
    const slv_env *env = slvi_painter_env(painter);
    slv_canvas_desc desc;
    slv_script *s = NULL;
    *out = NULL;
    params = params ? params : &none;
    slv_result result = canvas->fns->describe(canvas->user, &desc);
    if (result || (result = slvi_alloc(env, "script", 1, sizeof *s, &s)))
        return result;
    s->env = *env;
    s->painter = painter;
    s->inner = *canvas;
    s->canvas = (slv_canvas){&fns, s};
    s->params = *params;
    s->nfaces = desc.nfaces;
    s->nchannels = desc.nchannels;
    set_defaults(&s->set);
    if ((result = slvi_script_copy(env, params->name ? params->name : "script", &s->name)) ||
        (result = slvi_script_copy(env, params->folder ? params->folder : "", &s->folder)) ||
        (result = slvi_alloc(env, "script", desc.nfaces, 1, &s->touched)) ||
        (result = slvi_alloc(env, "script", desc.nfaces, 1, &s->line_faces)) ||
        (result = slvi_alloc(env, "script", desc.nfaces, 1, &s->set_faces)) ||
        (result = slvi_alloc(env, "script", desc.nfaces, 1, &s->selected))) {
        slv_script_destroy(s);
        return result;
    }
    *out = s;
    return SLV_OK;
}

void slv_script_destroy(slv_script *script) {
    if (!script)
        return;
    for (uint32_t i = 0; i < script->nbrushes; i++) {
        slvi_free(script->brushes[i].key);
        slv_brush_destroy(script->brushes[i].brush);
    }
    slvi_free(script->brushes);
    slvi_script_free_images(script);
    slv_symmetry_destroy(script->symmetry);
    slv_symmetry_destroy(script->old_symmetry);
    slvi_free(script->line_faces);
    slvi_free(script->set_faces);
    slvi_free(script->name);
    slvi_free(script->folder);
    slvi_free(script->touched);
    slvi_free(script->list);
    slvi_free(script->selected);
    slvi_free(script);
}

void slv_script_get_stats(const slv_script *script, slv_script_stats *out) {
    *out = script->stats;
}

const uint32_t *slvi_script_faces(const slv_script *script) {
    return script->list;
}

bool slv_script_touched(const slv_script *script, uint32_t face) {
    return face < script->nfaces && script->touched[face];
}

/* Samples come later. The brush is the script's. */
static slv_result begin_stroke(slv_script *s, uint64_t number, slvi_line *line, slv_stroke **out) {
    slv_result result = SLV_OK;
    *out = NULL;
    line->stroke.mirrors = line->mirrors;
    line->stroke.lay = slvi_script_is_laid(&line->lay) ? &line->lay : NULL;
    if (!line->stroke.brush) {
        json_t *standard = json_object();
        result = slvi_script_brush_of(s, number, standard, &line->stroke.brush);
        json_decref(standard);
    }
    return result ? result : slv_stroke_begin(s->painter, &s->canvas, &line->stroke, out);
}

slv_result slvi_script_stroke(slv_script *script, uint64_t number, json_t *root, slv_stroke **out) {
    slvi_line *all = &script->live; /* the stroke looks at it */
    *all = script->set;
    slv_result result = slvi_script_read(script, number, root, all);
    *out = NULL;
    if (!result && (all->op != SLVI_SCRIPT_STROKE || all->samples))
        result = slvi_fail(&script->env, SLV_ERROR_FORMAT,
                           "%s: line %llu: expected a stroke, its samples to come", script->name,
                           (unsigned long long)number);
    return result ? result : begin_stroke(script, number, all, out);
}

static slv_result run_stroke(slv_script *s, uint64_t number, slvi_line *line) {
    slv_stroke *stroke = NULL;
    slv_stroke_stats stats = {0};
    slv_stroke_sample sample;
    slv_result result = SLV_OK;
    if (!line->samples)
        return slvi_fail(&s->env, SLV_ERROR_FORMAT,
                         "%s: line %llu: samples: expected a list of samples", s->name,
                         (unsigned long long)number);
    /* all of it is looked at before any of it is painted */
    double last = -INFINITY;
    for (size_t i = 0; !result && i < json_array_size(line->samples); i++) {
        if (!(result = slvi_script_sample(s, number, line, i, &sample)) && sample.time < last)
            result = slvi_fail(&s->env, SLV_ERROR_FORMAT,
                               "%s: line %llu: sample %zu: at %g seconds, after one at %g", s->name,
                               (unsigned long long)number, i, sample.time, last);
        last = sample.time;
    }
    if (!result)
        result = begin_stroke(s, number, line, &stroke);
    for (size_t i = 0; !result && i < json_array_size(line->samples); i++)
        if (!(result = slvi_script_sample(s, number, line, i, &sample)))
            result = slv_stroke_add(stroke, &sample, 1);
    if (stroke && !result)
        result = slv_stroke_end(stroke, &stats);
    slv_stroke_destroy(stroke);
    s->stats.dabs += stats.dabs;
    s->stats.missed += stats.missed;
    s->stats.texels += stats.texels;
    return result;
}

/* What a line has set stays, with the faces of its mask. */
static void keep_set(slv_script *s, const slvi_line *line) {
    s->set = *line;
    if (line->lay.mask.faces == s->line_faces) {
        uint8_t *other = s->set_faces;
        s->set_faces = s->line_faces;
        s->line_faces = other;
    }
}

slv_result slv_script_run(slv_script *script, uint64_t number, const char *line, size_t size) {
    json_error_t error;
    slvi_line all = script->set;
    slv_result result;
    size_t blank = 0;
    while (blank < size && strchr(" \t\r\n", line[blank]))
        blank++;
    if (blank == size || line[blank] == '#')
        return SLV_OK;
    json_t *root;
    if ((result = slvi_json_load(line, size, JSON_REJECT_DUPLICATES, &root, &error)) ==
        SLV_ERROR_MEMORY)
        return slvi_fail(&script->env, result, "%s: line %llu: no memory to read it", script->name,
                         (unsigned long long)number);
    if (result)
        return slvi_fail(&script->env, SLV_ERROR_FORMAT, "%s: line %llu: %s", script->name,
                         (unsigned long long)number, error.text);
    if (!(result = slvi_script_read(script, number, root, &all))) {
        if (all.op == SLVI_SCRIPT_SET)
            keep_set(script, &all);
        else
            result = all.op == SLVI_SCRIPT_FILL ? slvi_script_fill(script, &all)
                                                : run_stroke(script, number, &all);
        script->stats.operations += !result && all.op != SLVI_SCRIPT_SET;
    }
    script->set.camera = script->set.samples = NULL;
    json_decref(root);
    return result;
}
