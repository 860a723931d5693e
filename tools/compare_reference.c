#include "compare_reference.h"

#include <math.h>
#include <stdio.h>

static bool show_progress(void *user, uint64_t done, uint64_t total) {
    cli_progress *progress = user;
    progress->total = total;
    cli_progress_update(progress, done);
    return !cli_interrupted();
}

static void add_pixel(report_error *error, double distance) {
    error->npixels++;
    error->rms += distance * distance;
    error->max = distance > error->max ? distance : error->max;
    error->over_1 += distance > 1.0 / 255;
    error->over_4 += distance > 4.0 / 255;
    error->over_16 += distance > 16.0 / 255;
    for (uint32_t i = 0; i < REPORT_ERROR_STEPS && distance > report_error_step(i); i++)
        error->share[i]++;
}

static void finish(report_error *error) {
    double n = error->npixels ? (double)error->npixels : 1;
    error->rms = sqrt(error->rms / n);
    error->over_1 /= n;
    error->over_4 /= n;
    error->over_16 /= n;
    for (uint32_t i = 0; i < REPORT_ERROR_STEPS; i++)
        error->share[i] /= n;
}

static void measure(const report_data *report, report_strategy *row) {
    size_t npixels = (size_t)report->width * report->height;
    for (uint32_t v = 0; v < report->nviews; v++) {
        const float *a = row->views[v].pixels, *b = report->reference.views[v].pixels;
        for (size_t i = 0; i < npixels; i++, a += 4, b += 4) {
            double squares = 0;
            for (int c = 0; c < 3; c++)
                squares += (double)(a[c] - b[c]) * (double)(a[c] - b[c]);
            /* what is not a number is as wrong as can be */
            double distance = squares >= 0 ? sqrt(squares) : INFINITY;
            add_pixel(&row->all, distance);
            if (a[3] > 0.999f && b[3] > 0.999f)
                add_pixel(&row->inside, distance);
        }
    }
    finish(&row->all);
    finish(&row->inside);
}

slv_result compare_reference(const slv_env *env, const scene_data *scene, const slv_frame *frames,
                             bool quiet, report_data *report) {
    report_reference *r = &report->reference;
    const slv_reference_params params = {.segments = report->segments};
    slv_reference *reference = NULL;
    double start = cli_now(), squares = 0;
    slv_result result = slv_reference_create(env, scene->mesh, scene->surface, scene->texture,
                                             scene->adjacency, &params, &reference);
    for (uint32_t v = 0; v < report->nviews && !result; v++) {
        char what[64];
        snprintf(what, sizeof what, "casting rays, view %u of %u", v + 1, report->nviews);
        cli_progress progress = cli_progress_begin(what, 1, quiet);
        slv_reference_stats stats;
        const slv_reference_frame frame = {.camera = frames[v].camera,
                                           .width = frames[v].width,
                                           .height = frames[v].height,
                                           .shading = frames[v].shading,
                                           .ka = frames[v].ka,
                                           .kd = frames[v].kd,
                                           .filter = r->filter,
                                           .samples = r->samples,
                                           .progress = show_progress,
                                           .progress_user = &progress};
        result = slv_reference_render(reference, env, &frame, &r->views[v], NULL, &stats);
        if (!result)
            cli_progress_end(&progress);
        squares += stats.error * stats.error / report->nviews;
    }
    slv_reference_destroy(reference);
    r->estimate = sqrt(squares);
    r->seconds = cli_now() - start;
    for (uint32_t k = 0; k < report->nstrategies && !result; k++)
        measure(report, &report->strategies[k]);
    return result;
}

void compare_print_errors(const report_data *report) {
    if (!report->reference.samples)
        return;
    printf("%-10s %12s %12s %10s %10s\n", "strategy", "RMS error", "largest", "> 1/255", "> 4/255");
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        const report_error *error = &report->strategies[k].inside;
        printf("%-10s %12.6f %12.5f %8.3f %% %8.3f %%\n",
               slv_strategy_name(report->strategies[k].strategy), error->rms, error->max,
               error->over_1 * 100, error->over_4 * 100);
    }
    printf("(against %u rays per pixel, themselves in error by %.6f; where the surface covers the "
           "pixel)\n",
           report->reference.samples, report->reference.estimate);
}
