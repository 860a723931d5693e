/* What the report shows of a few moments: views, how they differ, places to look at closely. */
#include "compare/engine/experiment.h"

#include <math.h>

enum { SPOT_CELL = 24, SPOT_SIZE = 240, SPOT_ZOOM = 32 };

static double view_time(const report_data *report, uint32_t view) {
    return (double)view / report->nviews;
}

static slv_result draw_views(experiment *e) {
    report_data *report = e->report;
    slv_result result = experiment_begin(e, report->nviews * report->nstrategies);
    for (uint32_t v = 0; v < report->nviews && !result; v++) {
        slv_frame frame = experiment_frame_at(e, view_time(report, v), NULL);
        double estimate;
        for (uint32_t k = 0; k < report->nstrategies && !result; k++) {
            frame.strategy = report->strategies[k].strategy;
            if (!(result = experiment_draw(e, &frame, &report->rates[report->shown],
                                           &report->strategies[k].views[v], NULL)))
                result = experiment_step(e);
        }
        if (!result && report->reference.first < REPORT_SOURCES)
            result = experiment_reference(e, report->reference.first, &frame,
                                          &report->reference.views[v], &estimate);
    }
    return result;
}

static float pixel_difference(const slv_image *a, const slv_image *b, size_t pixel) {
    float difference = 0;
    for (int c = 0; c < 3; c++) {
        float one = fabsf(a->pixels[4 * pixel + c] - b->pixels[4 * pixel + c]);
        if (!(one <= difference)) /* a NaN differs from everything */
            difference = isnan(one) ? INFINITY : one;
    }
    return difference;
}

/* Black, blue, red, yellow, white. */
static void heat_color(float value, float *rgba) {
    static const float stops[5][3] = {
        {0, 0, 0}, {0.02f, 0.05f, 0.5f}, {0.8f, 0.03f, 0.05f}, {1, 0.7f, 0.02f}, {1, 1, 1}};
    float at = fminf(fmaxf(value, 0), 1) * 4;
    int i = at >= 4 ? 3 : (int)at;
    for (int c = 0; c < 3; c++)
        rgba[c] = stops[i][c] + (at - (float)i) * (stops[i + 1][c] - stops[i][c]);
    rgba[3] = 1;
}

static slv_result draw_heat(const experiment *e, const slv_image *a, const slv_image *b,
                            slv_image *out) {
    size_t npixels = (size_t)a->width * a->height;
    slv_result result = slv_image_create(e->env, a->width, a->height, 4, out);
    for (size_t i = 0; i < npixels && !result; i++)
        heat_color(pixel_difference(a, b, i) * 255 / 16, out->pixels + 4 * i);
    return result;
}

static slv_result compare_pair(const experiment *e, report_pair *pair) {
    const report_data *report = e->report;
    const report_strategy *a = &report->strategies[pair->a], *b = &report->strategies[pair->b];
    double sum = 0, squares = 0;
    uint64_t covered = 0, over_1 = 0, over_4 = 0;
    slv_result result = draw_heat(e, &a->views[0], &b->views[0], &pair->heat);
    if (result)
        return result;
    for (uint32_t v = 0; v < report->nviews; v++) {
        size_t npixels = (size_t)report->width * report->height;
        for (size_t i = 0; i < npixels; i++) {
            float d = pixel_difference(&a->views[v], &b->views[v], i);
            if (a->views[v].pixels[4 * i + 3] < 0.999f)
                continue;
            covered++;
            sum += d;
            over_1 += d > 1.0f / 255;
            over_4 += d > 4.0f / 255;
            pair->max = fmax(pair->max, d);
            for (int c = 0; c < 3; c++) {
                double one = a->views[v].pixels[4 * i + c] - b->views[v].pixels[4 * i + c];
                squares += one * one;
            }
        }
    }
    double n = covered ? (double)covered : 1;
    pair->mean = sum / n;
    pair->over_1 = (double)over_1 / n;
    pair->over_4 = (double)over_4 / n;
    pair->psnr = squares > 0 ? -10 * log10(squares / (3 * n)) : INFINITY;
    return SLV_OK;
}

static slv_result compare_views(experiment *e) {
    report_data *report = e->report;
    slv_result result = SLV_OK;
    for (uint32_t a = 0; a < report->nstrategies && !result; a++) {
        report_strategy *row = &report->strategies[a];
        if (report->reference.first < REPORT_SOURCES)
            result = draw_heat(e, &row->views[0], &report->reference.views[0], &row->heat);
        for (uint32_t b = a + 1; b < report->nstrategies && !result; b++) {
            report_pair *pair = &report->pairs[report->npairs++];
            pair->a = a;
            pair->b = b;
            result = compare_pair(e, pair);
        }
    }
    return result;
}

/* How far the strategies are from each other in a pixel; with a reference, how much further from it
 * the worst is than the best, so that what all get wrong does not count. */
static float pixel_score(const report_data *report, uint32_t view, size_t pixel) {
    const slv_image *reference = &report->reference.views[view];
    float least = INFINITY, most = 0;
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        const slv_image *image = &report->strategies[k].views[view];
        if (!(image->pixels[4 * pixel + 3] > 0.999f))
            return -1;
        float one = pixel_difference(
            image, reference->pixels ? reference : &report->strategies[0].views[view], pixel);
        least = fminf(least, one);
        most = fmaxf(most, one);
    }
    return reference->pixels ? most - least : most;
}

static float cell_score(const report_data *report, uint32_t view, uint32_t left, uint32_t top) {
    float sum = 0;
    for (uint32_t p = 0; p < SPOT_CELL * SPOT_CELL; p++)
        sum += pixel_score(report, view,
                           (size_t)(top + p / SPOT_CELL) * report->width + left + p % SPOT_CELL);
    return sum;
}

/* The worst places of all views, no two close together in one view. */
static void find_spots(report_data *report) {
    uint32_t nx = report->width / SPOT_CELL, ny = report->height / SPOT_CELL;
    while (report->nspots < REPORT_MAX_SPOTS) {
        float best = 1.0f / 255;
        report_spot spot = {.zoom = SPOT_ZOOM};
        for (uint32_t at = 0; at < report->nviews * nx * ny; at++) {
            uint32_t view = at / (nx * ny), cell = at % (nx * ny);
            uint32_t left = cell % nx * SPOT_CELL, top = cell / nx * SPOT_CELL;
            float x = ((float)left + SPOT_CELL / 2) / (float)report->width;
            float y = ((float)top + SPOT_CELL / 2) / (float)report->height;
            bool near = false;
            for (uint32_t k = 0; k < report->nspots; k++)
                near |= report->spots[k].view == view &&
                        hypotf(report->spots[k].x - x, report->spots[k].y - y) < 0.15f;
            float score = near ? 0 : cell_score(report, view, left, top);
            if (score > best) {
                best = score;
                spot.view = view;
                spot.x = x;
                spot.y = y;
            }
        }
        if (best <= 1.0f / 255)
            return;
        report->spots[report->nspots++] = spot;
    }
}

/* The same camera through a smaller window: a true magnification, not enlarged pixels. */
static slv_result draw_spots(experiment *e) {
    report_data *report = e->report;
    slv_result result = SLV_OK;
    for (uint32_t i = 0; i < report->nspots && !result; i++) {
        const report_spot *spot = &report->spots[i];
        slv_frame frame = experiment_frame_at(e, view_time(report, spot->view), NULL);
        double half = 0.5 / (double)spot->zoom, x = (double)spot->x, y = (double)spot->y,
               across = half * report->height / report->width, estimate;
        frame.camera = orbit_part(&frame.camera, x - across, y - half, x + across, y + half);
        frame.width = frame.height = SPOT_SIZE;
        for (uint32_t k = 0; k < report->nstrategies && !result; k++) {
            frame.strategy = report->strategies[k].strategy;
            result = experiment_draw(e, &frame, &report->rates[report->shown],
                                     &report->strategies[k].spots[i], NULL);
        }
        if (!result && report->reference.first < REPORT_SOURCES)
            result = experiment_reference(e, report->reference.first, &frame,
                                          &report->reference.spots[i], &estimate);
    }
    return result;
}

slv_result experiment_draw_pictures(experiment *e) {
    slv_result result;
    if ((result = draw_views(e)) || (result = compare_views(e)))
        return result;
    find_spots(e->report);
    return draw_spots(e);
}
