/* The same views from a texture in blocks. */
#include "compare/engine/experiment.h"

#include <math.h>

typedef struct sum {
    double squares;
    uint64_t npixels;
} sum;

/* Over the pixels that the surface covers in full. */
static void add_squares(const slv_image *a, const slv_image *b, sum *out) {
    size_t npixels = (size_t)a->width * a->height;
    for (size_t i = 0; i < npixels; i++) {
        if (a->pixels[4 * i + 3] < 0.999f)
            continue;
        out->npixels++;
        for (int c = 0; c < 3; c++) {
            double one = a->pixels[4 * i + (size_t)c] - b->pixels[4 * i + (size_t)c];
            out->squares += one * one;
        }
    }
}

static double psnr(const sum *s) {
    if (!s->npixels)
        return NAN;
    return s->squares > 0 ? -10 * log10(s->squares / (3 * (double)s->npixels)) : INFINITY;
}

static slv_result draw_strategy(experiment *e, report_strategy *row) {
    const report_data *report = e->report;
    report_blocks *blocks = &row->blocks;
    sum from_plain = {0}, plain_error = {0}, error = {0};
    slv_gl_seam_params params = {0};
    slv_result result = slv_gl_texture_seam_jump(e->texture, e->env, row->strategy,
                                                 e->scene->adjacency, &params, &blocks->seam);
    blocks->stats = slv_gl_texture_get_stats(e->texture, row->strategy);
    for (uint32_t v = 0; v < report->nviews && !result; v++) {
        const slv_image *reference = &report->reference.views[v];
        slv_frame frame = experiment_frame_at(e, (double)v / report->nviews, row->strategy);
        slv_image image = {0};
        if ((result = experiment_draw(e, &frame, &report->rates[report->shown], &image, NULL)))
            return result;
        add_squares(&row->views[v], &image, &from_plain);
        if (reference->pixels) {
            add_squares(reference, &row->views[v], &plain_error);
            add_squares(reference, &image, &error);
        }
        slv_image_free(&image);
    }
    blocks->psnr = psnr(&from_plain);
    blocks->plain_reference_psnr = psnr(&plain_error);
    blocks->reference_psnr = psnr(&error);
    return result;
}

slv_result experiment_draw_compressed(experiment *e, slv_gl_texture *blocks) {
    report_data *report = e->report;
    slv_gl_texture *plain = e->texture;
    slv_result result = experiment_begin(e, report->nstrategies);
    e->texture = blocks;
    for (uint32_t k = 0; k < report->nstrategies && !result; k++)
        if (!(result = draw_strategy(e, &report->strategies[k])))
            result = experiment_step(e);
    e->texture = plain;
    return result;
}
