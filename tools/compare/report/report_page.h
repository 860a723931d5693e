/* The page while it is being written. */
#ifndef SELVAGE_TOOLS_REPORT_PAGE_H
#define SELVAGE_TOOLS_REPORT_PAGE_H

#include "compare/report/report_words.h"

typedef struct page {
    const slv_env *env;
    FILE *stream;
    const report_data *report;
    report_verdict verdict;
    report_advice advice;
} page;

static inline bool page_has_reference(const page *p) {
    return p->report->reference.first < REPORT_SOURCES;
}

static inline const char *page_strategy_name(const page *p, uint32_t index) {
    return p->report->strategies[index].strategy->name;
}

/* The attributes src, width and height of a picture. */
slv_result page_image(const page *p, const slv_image *image);
/* The pictures: those of the viewer, seams close up, and maps of differences. */
slv_result page_views(const page *p);
slv_result page_spots(const page *p);
slv_result page_pairs(const page *p);

#endif
