/* The outcome of a comparison: what was measured, and what follows from it. */
#ifndef SELVAGE_TOOLS_REPORT_H
#define SELVAGE_TOOLS_REPORT_H

#include "compare/engine/interval.h"
#include "compare/engine/orbit.h"

#include <selvage/reference.h>
#include <selvage/selvage.h>
#include <selvage/wrap.h>

#include <stdio.h>

enum {
    REPORT_LEVELS = 5,
    REPORT_MAX_VIEWS = 4,
    REPORT_MAX_SPOTS = 6,
    REPORT_ERROR_STEPS = 41,
    REPORT_MAX_RATES = 8,
    REPORT_MAX_STRATEGIES = 16,
    REPORT_MAX_MAPS = REPORT_MAX_STRATEGIES + 3,
    REPORT_MAX_CAMERAS = 16
};

/* Samples per pixel: `frames` pictures of `msaa` samples, moved by parts of a pixel and averaged.
 */
typedef struct report_rate {
    uint32_t samples, msaa, frames;
} report_rate;

/* What a picture is held against. */
typedef enum report_source {
    REPORT_RAYCAST,      /* rays, each pixel the mean of its square */
    REPORT_MITCHELL,     /* rays, Mitchell and Netravali's filter */
    REPORT_SUPERSAMPLED, /* traverse at 8 x 8 times the size, the same filter (Toth 2013) */
    REPORT_SOURCES
} report_source;

/* What a pixel shows: where its footprint and the filter's reach end. */
typedef enum report_label {
    REPORT_OUTLINE,       /* background, an outline, or a fold that hides something */
    REPORT_INTERIOR,      /* one face */
    REPORT_EDGE,          /* a face and its neighbour over an edge */
    REPORT_REGULAR,       /* a vertex of four faces */
    REPORT_EXTRAORDINARY, /* a vertex of any other number */
    REPORT_LABELS
} report_label;

/* Sets of labels. */
enum {
    REPORT_ALL = (1 << REPORT_LABELS) - 1,
    REPORT_INSIDE = REPORT_ALL & ~(1 << REPORT_OUTLINE),
    REPORT_SEAMS = REPORT_INSIDE & ~(1 << REPORT_INTERIOR)
};

/* Distances of pixels. A pixel's error is the length of the difference of its linear RGB. */
typedef struct report_tally {
    uint64_t npixels, over[3]; /* further away than 1/255, 4/255, 16/255 */
    double squares, max;
} report_tally;

typedef struct report_errors {
    report_tally labels[REPORT_LABELS];
    uint64_t curve[REPORT_ERROR_STEPS]; /* of all pixels, those further than report_error_step */
} report_errors;

/* One strategy at one rate, over the whole orbit. */
typedef struct report_cell {
    double median_ms, min_ms, max_ms; /* of a frame */
    interval ratio;                   /* to the baseline in the same frame */
    report_errors errors[REPORT_SOURCES];
    report_tally flicker; /* how much the error inside changes from one frame to the next */
} report_cell;

/* A strategy with the texture in blocks. */
typedef struct report_blocks {
    slv_gl_texture_stats stats;
    slv_gl_seam seam; /* magnified */
    /* In dB, of the views: from the pictures of the uncompressed texture, and of both from the
     * first reference; infinite for equal pictures, NaN without a reference. */
    double psnr, reference_psnr, plain_reference_psnr;
} report_blocks;

typedef struct report_strategy {
    const slv_strategy *strategy;
    double median_ms, min_ms, max_ms; /* of a frame, at the rate that is shown */
    interval ratio;                   /* to the baseline in the same frame, at that rate */
    slv_gl_texture_stats stats;
    slv_gl_seam seams[REPORT_LEVELS]; /* footprint magnified, then 2, 4, ... texels */
    slv_image views[REPORT_MAX_VIEWS];
    slv_image spots[REPORT_MAX_SPOTS];
    slv_image heat;                      /* its distance from the reference in the first view */
    report_cell rates[REPORT_MAX_RATES]; /* in the order of report_data.rates */
    report_blocks blocks;                /* if report_data.compressed */
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

/* A camera that was given beside the orbit: everything at the rate that is shown, errors from the
 * first reference. */
typedef struct report_camera {
    const char *path;
    slv_camera camera;
    double ms[REPORT_MAX_STRATEGIES], ratio[REPORT_MAX_STRATEGIES]; /* to the baseline */
    report_errors errors[REPORT_MAX_STRATEGIES];
    bool empty; /* no whole pixel of the surface is in view */
} report_camera;

/* What the pictures of some frames were held against. */
typedef struct report_reference {
    bool used[REPORT_SOURCES];
    double estimate[REPORT_SOURCES]; /* RMS of its own error; NaN if unknown */
    uint32_t samples;                /* rays per pixel */
    uint32_t frames;                 /* of the orbit that have one */
    uint64_t npixels[REPORT_LABELS]; /* in those */
    report_source first;             /* of the views and spots */
    slv_image views[REPORT_MAX_VIEWS], spots[REPORT_MAX_SPOTS];
} report_reference;

/* Pixels by where a map by texture coordinates is cut. */
typedef enum report_place {
    REPORT_PLACE_OUTLINE = REPORT_OUTLINE,
    REPORT_PLACE_INSIDE, /* one face */
    REPORT_PLACE_EDGE,   /* faces meet, and the map goes on */
    REPORT_PLACE_SEAM,   /* the map ends at an edge, or goes over its end within the face */
    REPORT_PLACES
} report_place;

/* A way to bring an image onto the mesh. */
typedef struct report_map {
    const char *name, *title;
    const slv_strategy *strategy;    /* of per-face textures; NULL: by texture coordinates, */
    bool once, short_way;            /* which have one value a vertex, and go round */
    uint32_t vertices, vertex_bytes; /* of the control mesh; bytes of one */
    uint32_t cut;                    /* edges at which lookups have to go on elsewhere */
    uint64_t gpu_bytes;              /* of texels and tables */
    double median_ms;
    interval ratio; /* to the row `baseline` in the same frame */
    report_tally errors[REPORT_PLACES];
    double apart; /* of any pixel from that row; not of strategies */
    slv_image view, spot;
} report_map;

/* An image by texture coordinates beside per-face textures that show the same, all against one
 * reference, which looks up the image. */
typedef struct report_maps {
    const char *image; /* NULL: nothing of this was asked for */
    slv_wrap_round round;
    uint32_t nrows, baseline;
    uint32_t frames, referenced, samples; /* `referenced` of them, with so many rays a pixel */
    uint32_t over_end;                    /* faces that one value a vertex is wrong in */
    uint64_t npixels[REPORT_PLACES];
    double estimate; /* RMS of the reference's own error */
    report_map rows[REPORT_MAX_MAPS];
    report_spot spot;         /* where the rows differ most, in `view` */
    slv_image view, close_up; /* the reference's */
} report_maps;

typedef struct report_data {
    const char *ptx, *mesh;
    slv_gl_info gl;
    uint32_t nfaces, segments, frames, width, height, anisotropy;
    bool even_levels; /* not of all strategies: see slv_gl_texture_params */
    report_rate rates[REPORT_MAX_RATES];
    uint32_t nrates, shown;      /* `shown` is the rate of the pictures */
    char left_out[160];          /* rates that the driver does not have, in words; or empty */
    slv_image_encoding pictures; /* of views and seams */
    orbit path;
    report_errors apart[REPORT_MAX_RATES]; /* traverse from discard, if both are there */
    uint32_t nstrategies, nviews, nspots, npairs;
    report_strategy strategies[REPORT_MAX_STRATEGIES];
    report_pair pairs[REPORT_MAX_STRATEGIES * REPORT_MAX_STRATEGIES];
    report_spot spots[REPORT_MAX_SPOTS];
    report_reference reference;
    uint32_t ncameras;
    report_camera cameras[REPORT_MAX_CAMERAS];
    report_maps maps;
    double others; /* processors that other programs took while frames were drawn */
    bool compressed;
    uint32_t nresolutions; /* distinct face resolutions */
    double seconds;        /* the whole run */
} report_data;

/* Error number i of a curve: 1/1024 to 1 in steps of a quarter of an octave. */
double report_error_step(uint32_t i);

/* How many pixels are of the surface alone. */
uint64_t report_covered(const uint64_t npixels[REPORT_LABELS]);
void report_tally_add(report_tally *tally, double distance);
void report_tally_merge(report_tally *to, const report_tally *from);
void report_errors_add(report_errors *errors, report_label label, double distance);
void report_errors_merge(report_errors *to, const report_errors *from);
/* Over a set of labels. */
report_tally report_errors_part(const report_errors *errors, unsigned labels);
double report_rms(const report_tally *tally); /* NaN without pixels */
/* The share of all pixels further away than step i. */
double report_share(const report_errors *errors, uint32_t i);
/* The length of the difference of two pixels' RGB; infinite for what is not a number. */
double report_distance(const float *a, const float *b);

/* What supersampled references are drawn with. */
const slv_strategy *report_supersampled_with(void);
/* raycast, mitchell, supersampled; outline, interior, ... */
const char *report_source_name(report_source source);
const char *report_label_name(report_label label);
/* The index of a strategy in the report, or nstrategies. */
uint32_t report_find(const report_data *report, const char *name);
/* Where the strategies of Toth's paper are in the report, or nstrategies. */
typedef struct report_paper_strategies {
    uint32_t clamp, traverse, discard;
    bool both; /* the two that it compares */
} report_paper_strategies;
report_paper_strategies report_of_paper(const report_data *report);
/* The strategy that times are held against: clamp, or the first if it is not there. */
uint32_t report_baseline(const report_data *report);
/* All that are measured: of the orbit, and of the cameras beside it. */
uint32_t report_frame_count(const report_data *report);
/* Whether others took so much of the processors that times are off. */
bool report_disturbed(const report_data *report);
/* Its index among all that the library has, so that it has the same colour in every report. */
uint32_t report_colour(const slv_strategy *strategy);

void report_free(report_data *report);

#endif
