/* Toth's experiment (2013, section 4): every frame of an orbit drawn with every strategy at every
 * sampling rate, timed, and some of them held against references. */
#ifndef SELVAGE_TOOLS_EXPERIMENT_H
#define SELVAGE_TOOLS_EXPERIMENT_H

#include "command/scene.h"
#include "compare/engine/report.h"

#include <jansson.h>

enum { EXPERIMENT_SUPERSAMPLING = 8, EXPERIMENT_STEPS = 1000 };

/* What a frame needs. Outcomes go into `report`, which says what is wanted. */
typedef struct experiment {
    const slv_env *env;
    const scene_data *scene;
    slv_gl *gl;
    slv_gl_texture *texture;
    slv_gl_renderer *renderer;
    slv_gl_images *images; /* what is drawn in place of the texture, while it is not NULL */
    const uint8_t *cut;    /* of each face, while maps are compared (map_rows.h) */
    slv_reference *reference, *map_reference; /* made when first needed; of the texture, and of an
                                                 image */
    slv_camera aimed; /* whom the renderer's surface is divided for, face by face */
    bool aims;        /* it has been for one; and the references' is the same: */
    bool reference_aimed, map_aimed;
    slv_shading shading;
    slv_texture_encoding encoding;
    report_data *report;
    slv_progress progress; /* asked between any two pictures; see experiment_begin */
    uint64_t done, total;
    uint32_t finished; /* frames of the orbit that are measured, of this run and those before it */
} experiment;

/* Work of `total` steps begins: progress hears of none, then of each. What ends because progress
 * said so returns SLV_ERROR_CANCELLED and does not log it: who said so knows. */
slv_result experiment_begin(experiment *e, uint64_t total);
slv_result experiment_step(experiment *e);
/* Between steps: the same number again. */
slv_result experiment_ask(const experiment *e);

/* What one frame of the orbit has to say. Does not depend on any other frame. */
typedef struct experiment_frame {
    uint32_t index; /* from report->frames on they are of cameras that were given */
    bool referenced;
    double seconds, others; /* of the clock, and of other programs on processors meanwhile */
    uint64_t npixels[REPORT_LABELS];
    double estimate[REPORT_SOURCES];
    double ms[REPORT_MAX_RATES][REPORT_MAX_STRATEGIES];
    report_errors apart[REPORT_MAX_RATES];
    report_errors errors[REPORT_SOURCES][REPORT_MAX_RATES][REPORT_MAX_STRATEGIES];
    report_tally flicker[REPORT_MAX_RATES][REPORT_MAX_STRATEGIES];
} experiment_frame;

/* Turns a list such as "1,2,4,8" into report->rates, as far as the driver has them or can have them
 * by at most `accumulate` pictures; the others are named in report->left_out. */
bool experiment_parse_rates(const char *list, report_data *report);
slv_result experiment_find_rates(const slv_env *env, const slv_gl *gl, uint32_t accumulate,
                                 report_data *report);

/* How the surface is divided: all faces alike, or for a camera. */
slv_tessellation_params experiment_tessellation(const report_data *report, const scene_data *scene,
                                                const slv_camera *camera);
/* Divides it so for the eye of pictures to come. */
slv_result experiment_aim(experiment *e, const slv_camera *camera);
/* Draws with a strategy at a rate: report_rate.frames pictures, averaged in linear light. `ms` (may
 * be NULL) is their time together. The size, shading and camera are those of `frame`. */
slv_result experiment_draw(experiment *e, const slv_frame *frame, const report_rate *rate,
                           slv_image *image, double *ms);
/* Whether frame `index` is the middle one of any of `wanted` equal stretches of `frames`. */
bool experiment_is_middle(uint32_t index, uint32_t frames, uint32_t wanted);
slv_frame experiment_frame_at(const experiment *e, double t, const slv_strategy *strategy);

/* Draws and measures all frames, writing each into the state file `path` when it is done; with
 * `resume`, those that are there already are taken from there. `conditions` must be equal for that;
 * not taken over. */
slv_result experiment_run(experiment *e, const char *path, const json_t *conditions, bool resume);

/* How far lookups differ on both sides of edges, and what a texture takes; a step a strategy and
 * level. */
slv_result experiment_measure_seams(experiment *e);

/* Views, their differences, places to look at closely, and what the references show there. */
slv_result experiment_draw_pictures(experiment *e);

/* The same views from a texture in blocks, and what that costs; after the above. */
slv_result experiment_draw_compressed(experiment *e, slv_gl_texture *blocks);

/* A picture to hold others against, as the eye of `frame` sees it. `estimate` is NaN if unknown. */
slv_result experiment_reference(experiment *e, report_source source, const slv_frame *frame,
                                slv_image *image, double *estimate);
/* The same by rays that look up an image, a box filter. */
slv_result experiment_map_reference(experiment *e, const slv_uv_images *images,
                                    const slv_frame *frame, slv_image *image, double *estimate);
/* A label for each pixel, REPORT_OUTLINE or what `label` says, such as the report_label that
 * experiment_seam_label finds; for free(). */
typedef uint8_t (*experiment_label_fn)(const experiment *e, const slv_reference_hit *hit);
slv_result experiment_classify(experiment *e, const slv_frame *frame, experiment_label_fn label,
                               uint8_t **labels);
uint8_t experiment_seam_label(const experiment *e, const slv_reference_hit *hit);
/* Which edges of its face the lookup of a hit reaches over. */
void experiment_reaches(const experiment *e, const slv_reference_hit *hit, bool over[4]);

/* An image through the mesh's texture coordinates beside all strategies, with coordinates that go
 * round in all ways that there are; after experiment_run. */
slv_result experiment_compare_maps(experiment *e, const slv_uv_images *images,
                                   slv_wrap_round round);

/* The file of finished frames: one line of JSON each, after one of conditions. */
typedef struct experiment_state {
    int file;
    const char *path;
    uint64_t size; /* of what is complete */
} experiment_state;

/* Starts the file, or goes on with it: `each` is called for every frame that it holds. */
slv_result experiment_state_open(const slv_env *env, const char *path, const json_t *conditions,
                                 bool resume,
                                 slv_result (*each)(void *user, const experiment_frame *frame),
                                 void *user, const report_data *report, experiment_state *out);
slv_result experiment_state_append(const slv_env *env, experiment_state *state,
                                   const report_data *report, const experiment_frame *frame);
void experiment_state_close(experiment_state *state);

json_t *experiment_errors_json(const report_errors *errors);

#endif
