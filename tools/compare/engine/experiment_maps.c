/* An image through texture coordinates beside per-face textures that show the same: all drawn in
 * turn, and held against rays that look the image up. */
#include "command/output.h"
#include "compare/engine/experiment.h"
#include "compare/engine/map_rows.h"

#include <math.h>
#include <stdlib.h>

enum { MOST_FRAMES = 60, IMAGES = 3, CELL = 24, SPOT_SIZE = 240 };

typedef struct maps_run {
    experiment *e;
    report_maps *maps;
    slv_uv_images images;
    map_coordinates coordinates;
    slv_gl_images *drawn[IMAGES];
    double *ms; /* rows x frames */
    float score;
    double t; /* of the pictures */
} maps_run;

/* The pictures of one moment. */
typedef struct maps_moment {
    slv_frame frame;
    slv_image reference, images[REPORT_MAX_MAPS];
    uint8_t *labels;
} maps_moment;

static void free_moment(maps_moment *m) {
    for (uint32_t k = 0; k < REPORT_MAX_MAPS; k++)
        slv_image_free(&m->images[k]);
    slv_image_free(&m->reference);
    free(m->labels);
}

static slv_result draw_row(maps_run *run, const slv_frame *given, uint32_t k, slv_image *image,
                           double *ms) {
    experiment *e = run->e;
    slv_frame frame = *given;
    frame.strategy = run->maps->rows[k].strategy;
    e->images = frame.strategy ? NULL : run->drawn[k];
    slv_result result = experiment_draw(e, &frame, &e->report->rates[e->report->shown], image, ms);
    e->images = NULL;
    return result ? result : experiment_ask(e);
}

/* ---- where the map is cut ---- */

static uint8_t place_of(const experiment *e, const slv_reference_hit *hit) {
    const slv_face_adjacency *meets = &slv_adjacency_faces(e->scene->adjacency)[hit->face];
    uint8_t cut = e->cut[hit->face];
    bool over[4], edge = false, seam = (cut & MAP_OVER_END) != 0;
    experiment_reaches(e, hit, over);
    for (unsigned k = 0; k < 4; k++) {
        edge |= over[k] && meets->face[k] >= 0;
        seam |= over[k] && (cut >> k & 1);
    }
    return seam ? REPORT_PLACE_SEAM : edge ? REPORT_PLACE_EDGE : REPORT_PLACE_INSIDE;
}

/* ---- a moment ---- */

/* Where the rows are furthest from each other in how far they are from the reference. */
static void find_spot(maps_run *run, const maps_moment *m, double t) {
    const uint32_t width = m->frame.width, height = m->frame.height;
    for (uint32_t top = 0; top + CELL <= height; top += CELL)
        for (uint32_t left = 0; left + CELL <= width; left += CELL) {
            float sum = 0;
            for (uint32_t p = 0; p < CELL * CELL; p++) {
                size_t at = (size_t)(top + p / CELL) * width + left + p % CELL;
                double least = INFINITY, most = 0;
                for (uint32_t k = 0; k < run->maps->nrows && m->labels[at]; k++) {
                    double one =
                        report_distance(m->images[k].pixels + 4 * at, m->reference.pixels + 4 * at);
                    least = fmin(least, one);
                    most = fmax(most, one);
                }
                sum += m->labels[at] ? (float)(most - least) : 0;
            }
            if (!(sum > run->score))
                continue;
            run->score = sum;
            run->t = t;
            run->maps->spot.x = ((float)left + CELL / 2) / (float)width;
            run->maps->spot.y = ((float)top + CELL / 2) / (float)height;
        }
}

static void add_moment(maps_run *run, const maps_moment *m, double t) {
    report_maps *maps = run->maps;
    size_t npixels = (size_t)m->frame.width * m->frame.height;
    for (size_t i = 0; i < npixels; i++)
        maps->npixels[m->labels[i]]++;
    for (uint32_t k = 0; k < maps->nrows; k++) {
        report_map *row = &maps->rows[k];
        for (size_t i = 0; i < 4 * npixels; i += 4) {
            const float *own = m->images[k].pixels + i;
            report_tally_add(&row->errors[m->labels[i / 4]],
                             report_distance(own, m->reference.pixels + i));
            if (!row->strategy)
                row->apart =
                    fmax(row->apart, report_distance(own, m->images[maps->baseline].pixels + i));
        }
    }
    find_spot(run, m, t);
}

static slv_result measure_moment(maps_run *run, uint32_t index, bool referenced) {
    experiment *e = run->e;
    report_maps *maps = run->maps;
    const double t = (double)index / maps->frames;
    maps_moment m = {.frame = experiment_frame_at(e, t, NULL)};
    double estimate = 0;
    slv_result result = SLV_OK;
    if (referenced &&
        ((result = experiment_classify(e, &m.frame, place_of, &m.labels)) ||
         (result = experiment_map_reference(e, &run->images, &m.frame, &m.reference, &estimate))))
        goto done;
    for (uint32_t k = 0; k < maps->nrows && !result; k++) {
        uint32_t row = (k + index) % maps->nrows;
        result = draw_row(run, &m.frame, row, referenced ? &m.images[row] : NULL,
                          &run->ms[(size_t)row * maps->frames + index]);
    }
    if (!result && referenced) {
        add_moment(run, &m, t);
        maps->estimate += estimate * estimate;
        maps->referenced++;
    }
done:
    free_moment(&m);
    return result;
}

/* ---- all of them ---- */

static slv_result begin(maps_run *run, slv_wrap_round round) {
    experiment *e = run->e;
    report_data *report = e->report;
    report_maps *maps = run->maps;
    const slv_env *env = e->env;
    slv_result result;
    maps->round = round;
    maps->samples = report->reference.samples;
    maps->frames = report->frames < MOST_FRAMES ? report->frames : MOST_FRAMES;
    if ((result = map_coordinates_make(env, e->scene->mesh, e->scene->adjacency, round,
                                       &run->coordinates)) ||
        (result =
             map_rows_make(env, e->scene->mesh, e->scene->adjacency, &run->coordinates, report)))
        return result;
    e->cut = run->coordinates.cut;
    for (uint32_t k = 0; k < maps->nrows && !result; k++) {
        report_map *row = &maps->rows[k];
        if (row->strategy) {
            row->gpu_bytes = slv_gl_texture_get_stats(e->texture, row->strategy).gpu_bytes;
            continue;
        }
        const slv_uv_images images = map_row_images(row, &run->images, &run->coordinates);
        result = slv_gl_images_create(e->gl, env, &images, report->anisotropy, &run->drawn[k]);
        /* without the coordinates, which are counted with the vertices */
        if (!result)
            row->gpu_bytes =
                slv_gl_images_bytes(run->drawn[k]) - (uint64_t)images.nfaces * 8 * sizeof(float);
    }
    run->ms = calloc((size_t)maps->nrows * maps->frames, sizeof *run->ms);
    if (!result && !run->ms)
        result = output_fail(env, SLV_ERROR_MEMORY, "no memory for %u frames", maps->frames);
    return result;
}

static int by_value(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static slv_result finish(maps_run *run) {
    report_maps *maps = run->maps;
    const uint32_t n = maps->frames;
    double *ratios = calloc(n, sizeof *ratios);
    if (!ratios)
        return output_fail(run->e->env, SLV_ERROR_MEMORY, "no memory for %u frames", n);
    for (uint32_t k = 0; k < maps->nrows; k++) {
        for (uint32_t i = 0; i < n; i++)
            ratios[i] = run->ms[(size_t)k * n + i] / run->ms[(size_t)maps->baseline * n + i];
        maps->rows[k].ratio = interval_of(ratios, n);
    }
    for (uint32_t k = 0; k < maps->nrows; k++) {
        qsort(run->ms + (size_t)k * n, n, sizeof *run->ms, by_value);
        maps->rows[k].median_ms = run->ms[(size_t)k * n + n / 2];
    }
    maps->estimate = maps->referenced ? sqrt(maps->estimate / maps->referenced) : (double)NAN;
    free(ratios);
    return SLV_OK;
}

static slv_result draw_pictures(maps_run *run) {
    experiment *e = run->e;
    report_maps *maps = run->maps;
    const report_spot *spot = &maps->spot;
    slv_frame whole = experiment_frame_at(e, run->t, NULL), part = whole;
    const double half = 0.5 / (double)spot->zoom,
                 across = half * e->report->height / e->report->width, x = (double)spot->x,
                 y = (double)spot->y;
    double estimate;
    slv_result result = SLV_OK;
    part.camera = orbit_part(&whole.camera, x - across, y - half, x + across, y + half);
    part.width = part.height = SPOT_SIZE;
    for (uint32_t k = 0; k < maps->nrows && !result; k++) {
        result = draw_row(run, &whole, k, &maps->rows[k].view, NULL);
        if (!result && maps->referenced)
            result = draw_row(run, &part, k, &maps->rows[k].spot, NULL);
    }
    if (!result && maps->referenced &&
        !(result = experiment_map_reference(e, &run->images, &whole, &maps->view, &estimate)))
        result = experiment_map_reference(e, &run->images, &part, &maps->close_up, &estimate);
    return result;
}

slv_result experiment_compare_maps(experiment *e, const slv_uv_images *images,
                                   slv_wrap_round round) {
    maps_run run = {.e = e, .maps = &e->report->maps, .images = *images};
    const slv_frame first = experiment_frame_at(e, 0, NULL);
    slv_result result = begin(&run, round);
    run.maps->spot.zoom = 8;
    if (!result)
        result = experiment_begin(e, run.maps->frames);
    for (uint32_t k = 0; k < run.maps->nrows && !result; k++)
        result = draw_row(&run, &first, k, NULL, NULL); /* which compiles shaders */
    const uint32_t n = run.maps->frames, all = e->report->reference.frames,
                   wanted = all < n ? all : n;
    for (uint32_t i = 0; i < n && !result; i++)
        if (!(result = measure_moment(&run, i, experiment_is_middle(i, n, wanted))))
            result = experiment_step(e);
    if (!result && !(result = finish(&run)))
        result = draw_pictures(&run);
    for (int k = 0; k < IMAGES; k++)
        slv_gl_images_destroy(run.drawn[k]);
    slv_reference_destroy(e->map_reference);
    e->map_reference = NULL;
    e->cut = NULL;
    map_coordinates_free(&run.coordinates);
    free(run.ms);
    return result;
}
