/* The outcome of a comparison, and the files that tell of it. */
#ifndef SELVAGE_TOOLS_REPORT_H
#define SELVAGE_TOOLS_REPORT_H

#include "cli.h"

#include <selvage/reference.h>

#include <stdio.h>

enum { REPORT_LEVELS = 5, REPORT_MAX_VIEWS = 4, REPORT_MAX_SPOTS = 6, REPORT_ERROR_STEPS = 41 };

/* How far a strategy's pictures are from the reference, over all views. A pixel's error is the
 * length of the difference of its linear RGB. */
typedef struct report_error {
    double rms, max;
    double over_1, over_4, over_16;   /* share of pixels further away than 1/255, 4/255, 16/255 */
    double share[REPORT_ERROR_STEPS]; /* and than each of report_error_step */
    uint64_t npixels;
} report_error;

typedef struct report_strategy {
    slv_strategy strategy;
    double median_ms, min_ms, max_ms; /* of a frame */
    double ratio; /* of medians, to clamp (or to the first strategy if clamp is not there) */
    slv_gl_texture_stats stats;
    slv_gl_seam seams[REPORT_LEVELS]; /* footprint magnified, then 2, 4, ... texels */
    slv_image views[REPORT_MAX_VIEWS];
    slv_image spots[REPORT_MAX_SPOTS];
    report_error all, inside; /* of all pixels, and of those that the surface covers in full */
} report_strategy;

/* How two strategies' pictures differ, over the pixels that both cover, values in 0..1 linear. */
typedef struct report_pair {
    uint32_t a, b;          /* indices of strategies */
    double max, mean, psnr; /* psnr is infinite for equal pictures */
    double over_1, over_4;  /* share of pixels that differ by more than 1/255, 4/255 */
    slv_image heat;         /* of the first view: 0 black, 16/255 and more white, colours between */
} report_pair;

typedef struct report_spot {
    uint32_t view;
    float x, y, zoom; /* in the view, 0..1 from the upper left; how many times enlarged */
} report_spot;

/* The ray-cast pictures, if they were asked for. */
typedef struct report_reference {
    uint32_t samples; /* per pixel; 0: there is none */
    slv_pixel_filter filter;
    double estimate; /* RMS of its own error */
    double seconds;
    slv_image views[REPORT_MAX_VIEWS];
} report_reference;

typedef struct report_data {
    const char *ptx, *mesh;
    slv_gl_info gl;
    uint32_t nfaces, segments, frames, width, height, msaa, anisotropy;
    uint32_t nstrategies, nviews, nspots, npairs;
    report_strategy strategies[SLV_STRATEGY_COUNT];
    report_pair pairs[SLV_STRATEGY_COUNT * SLV_STRATEGY_COUNT];
    report_spot spots[REPORT_MAX_SPOTS];
    report_reference reference;
    uint32_t nresolutions; /* distinct face resolutions */
    double seconds;        /* the whole run */
} report_data;

/* Pictures as PNG into `folder`: view0_clamp.png, seam0_clamp.png, difference_clamp_borders.png,
 * ... */
slv_result report_write_pictures(const slv_env *env, const char *folder, const report_data *report);
slv_result report_write_json(const slv_env *env, const char *path, const report_data *report);
/* One file with everything in it; needs no network and no neighbours. */
slv_result report_write_html(const slv_env *env, const char *path, const report_data *report);

/* The section about the reference, for the page; nothing without one. */
void report_write_errors(FILE *stream, const report_data *report);
/* Error number i of a curve: 1/1024 to 1 in steps of a quarter of an octave. */
double report_error_step(uint32_t i);

void report_free(report_data *report);

#endif
