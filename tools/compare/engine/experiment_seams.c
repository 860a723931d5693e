/* How far lookups differ on both sides of edges. */
#include "compare/engine/experiment.h"

slv_result experiment_measure_seams(experiment *e) {
    report_data *report = e->report;
    slv_result result = experiment_begin(e, report->nstrategies * REPORT_LEVELS);
    for (uint32_t k = 0; !result && k < report->nstrategies; k++) {
        report_strategy *row = &report->strategies[k];
        row->stats = slv_gl_texture_get_stats(e->texture, row->strategy);
        for (uint32_t level = 0; !result && level < REPORT_LEVELS; level++) {
            slv_gl_seam_params params = {.level = level};
            if (!(result =
                      slv_gl_texture_seam_jump(e->texture, e->env, row->strategy,
                                               e->scene->adjacency, &params, &row->seams[level])))
                result = experiment_step(e);
        }
    }
    return result;
}
