/* Says how far an experiment is, and hears whether it is to go on. */
#include "compare/engine/experiment.h"

slv_result experiment_ask(const experiment *e) {
    bool go_on = !e->progress.report || e->progress.report(e->progress.user, e->done, e->total);
    return go_on ? SLV_OK : SLV_ERROR_CANCELLED;
}

slv_result experiment_begin(experiment *e, uint64_t total) {
    e->done = 0;
    e->total = total;
    return experiment_ask(e);
}

slv_result experiment_step(experiment *e) {
    e->done++;
    return experiment_ask(e);
}
