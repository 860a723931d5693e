/* Samples per pixel: those of the driver, and those made of several pictures. */
#include "command/output.h"
#include "compare/engine/experiment.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_SAMPLES = 64 };

bool experiment_parse_rates(const char *list, report_data *report) {
    report->nrates = 0;
    while (*list) {
        char *end;
        unsigned long samples = *list >= '0' && *list <= '9' ? strtoul(list, &end, 10) : 0;
        if (samples < 1 || samples > MAX_SAMPLES || (samples & (samples - 1)) ||
            (*end && (*end != ',' || !end[1])))
            return false;
        uint32_t at = 0;
        while (at < report->nrates && report->rates[at].samples < samples)
            at++;
        list = end + (*end == ',');
        if (at < report->nrates && report->rates[at].samples == samples)
            continue;
        memmove(report->rates + at + 1, report->rates + at,
                (report->nrates - at) * sizeof *report->rates);
        report->rates[at] = (report_rate){.samples = (uint32_t)samples};
        report->nrates++;
    }
    return report->nrates > 0;
}

static void add_words(char *text, size_t size, const char *format, uint32_t number) {
    size_t length = strlen(text);
    snprintf(text + length, size - length, format, number);
}

slv_result experiment_find_rates(const slv_env *env, const slv_gl *gl, uint32_t accumulate,
                                 report_data *report) {
    char had[64] = "1", missing[64] = "";
    uint32_t kept = 0;
    for (uint32_t n = 2; n <= MAX_SAMPLES; n *= 2)
        if (slv_gl_has_samples(gl, n))
            add_words(had, sizeof had, ", %u", n);
    for (uint32_t i = 0; i < report->nrates; i++) {
        report_rate rate = report->rates[i];
        rate.msaa = rate.samples;
        while (!slv_gl_has_samples(gl, rate.msaa))
            rate.msaa /= 2;
        rate.frames = rate.samples / rate.msaa;
        if (rate.frames <= accumulate)
            report->rates[kept++] = rate;
        else
            add_words(missing, sizeof missing, *missing ? ", %u" : "%u", rate.samples);
    }
    if (*missing)
        snprintf(report->left_out, sizeof report->left_out, "%s (the driver has %s)", missing, had);
    report->nrates = kept;
    report->shown = kept ? kept - 1 : 0;
    for (uint32_t i = 0; i < kept; i++)
        report->shown = report->rates[i].samples == 4 ? i : report->shown;
    if (!kept)
        return output_fail(env, SLV_ERROR_UNSUPPORTED,
                           "%s samples per pixel: the driver has %s, and --accumulate makes more",
                           missing, had);
    return SLV_OK;
}

/* Offset i of n, a power of two, no two in one row or column of n by n: in pixels from the middle.
 * A pattern of so many samples that has the same property keeps it if the offsets are divided by
 * their number. */
static void offset(uint32_t i, uint32_t n, float out[2]) {
    uint32_t reversed = 0;
    for (uint32_t bit = 1; bit < n; bit *= 2)
        reversed = reversed * 2 + (i & bit ? 1 : 0);
    out[0] = ((float)i + 0.5f) / (float)n - 0.5f;
    out[1] = ((float)reversed + 0.5f) / (float)n - 0.5f;
}

slv_tessellation_params experiment_tessellation(const report_data *report, const scene_data *scene,
                                                const slv_camera *camera) {
    return (slv_tessellation_params){.segments = report->segments,
                                     .displacement = scene->environment ? &scene->sphere : NULL,
                                     .camera = camera,
                                     .width = report->width,
                                     .height = report->height};
}

static bool same_camera(const slv_camera *a, const slv_camera *b) {
    return a->perspective == b->perspective &&
           memcmp(a->world_to_camera, b->world_to_camera, sizeof a->world_to_camera) == 0 &&
           memcmp(a->window, b->window, sizeof a->window) == 0;
}

slv_result experiment_aim(experiment *e, const slv_camera *camera) {
    const slv_tessellation_params params = experiment_tessellation(e->report, e->scene, camera);
    if (params.segments || (e->aims && same_camera(&e->aimed, camera)))
        return SLV_OK;
    slv_result result =
        slv_gl_renderer_tessellate(e->renderer, e->env, e->scene->mesh, e->scene->surface, &params);
    e->aims = !result;
    e->aimed = *camera;
    e->reference_aimed = e->map_aimed = false;
    return result;
}

slv_result experiment_draw(experiment *e, const slv_frame *given, const report_rate *rate,
                           slv_image *image, double *ms) {
    slv_frame frame = *given;
    slv_image one = {0};
    slv_result result = experiment_aim(e, &given->camera);
    double total = 0, seconds = 0;
    size_t count = (size_t)frame.width * frame.height * 4;
    frame.msaa = rate->msaa;
    for (uint32_t i = 0; i < rate->frames && !result; i++) {
        float by[2];
        offset(i, rate->frames, by);
        frame.camera = orbit_shifted(&given->camera, frame.width, frame.height,
                                     by[0] / (float)rate->msaa, by[1] / (float)rate->msaa);
        slv_image *to = image ? (i ? &one : image) : NULL;
        double *time = ms ? &seconds : NULL;
        result = e->images
                     ? slv_gl_renderer_draw_images(e->renderer, e->env, e->images, &frame, to, time)
                     : slv_gl_renderer_draw(e->renderer, e->env, e->texture, &frame, to, time);
        total += seconds;
        for (size_t k = 0; i && image && !result && k < count; k++)
            image->pixels[k] += one.pixels[k];
        slv_image_free(&one);
    }
    for (size_t k = 0; image && !result && rate->frames > 1 && k < count; k++)
        image->pixels[k] /= (float)rate->frames;
    if (result && image)
        slv_image_free(image);
    if (ms)
        *ms = total * 1e3;
    return result;
}

slv_frame experiment_frame_at(const experiment *e, double t, const slv_strategy *strategy) {
    return (slv_frame){.width = e->report->width,
                       .height = e->report->height,
                       .strategy = strategy,
                       .shading = e->shading,
                       .alpha = e->scene->alpha,
                       .camera = orbit_camera(&e->report->path, t)};
}
