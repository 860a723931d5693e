/* The outcome as report.json. */
#include "command/output.h"
#include "compare/engine/report_advice.h"
#include "compare/engine/report_findings.h"
#include "compare/report/report_files.h"

#include <string.h>

static json_t *text(const char *string) {
    return string ? output_json_name(string) : json_null();
}

static json_t *number_or_null(int32_t value) {
    return value < 0 ? json_null() : json_integer(value);
}

/* NULL once anything has failed, which jansson hands up to the root. */
static json_t *append(json_t *list, json_t *item) {
    if (json_array_append_new(list, item) == 0)
        return list;
    json_decref(list);
    return NULL;
}

static json_t *seams_json(const report_strategy *row) {
    json_t *list = json_array();
    for (uint32_t level = 0; level < REPORT_LEVELS; level++) {
        const slv_gl_seam *seam = &row->seams[level];
        bool any = seam->nedges > 0, equal = seam->nequal > 0;
        /* "o" takes the reference over, and turns a NULL into a failure of the whole object */
        json_t *item = json_pack(
            "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:I, s:I}", "footprint_texels",
            json_real(level ? (double)(1u << level) : 1.0 / 64), "max",
            any ? output_json_number((double)seam->max) : json_null(), "mean",
            any ? output_json_number((double)seam->mean) : json_null(), "equal_max",
            equal ? output_json_number((double)seam->equal_max) : json_null(), "equal_mean",
            equal ? output_json_number((double)seam->equal_mean) : json_null(), "face",
            number_or_null(seam->face), "edge", number_or_null(seam->edge), "t",
            seam->face < 0 ? json_null() : output_json_number((double)seam->t), "edges",
            (json_int_t)seam->nedges, "equal_edges", (json_int_t)seam->nequal);
        list = append(list, item);
    }
    return list;
}

static json_t *tally_json(const report_tally *t) {
    double n = t->npixels ? (double)t->npixels : 1;
    return json_pack("{s:I, s:o, s:o, s:o, s:o, s:o}", "pixels", (json_int_t)t->npixels, "rms",
                     output_json_number(report_rms(t)), "max", output_json_number(t->max),
                     "share_over_1_255", json_real((double)t->over[0] / n), "share_over_4_255",
                     json_real((double)t->over[1] / n), "share_over_16_255",
                     json_real((double)t->over[2] / n));
}

static json_t *curve_json(const report_errors *errors) {
    json_t *curve = json_array();
    for (uint32_t i = 0; i < REPORT_ERROR_STEPS; i++)
        curve = append(curve, json_pack("[o, o]", json_real(report_error_step(i)),
                                        json_real(report_share(errors, i))));
    return curve;
}

static json_t *part_json(const report_errors *errors, unsigned labels) {
    report_tally tally = report_errors_part(errors, labels);
    return tally_json(&tally);
}

static json_t *errors_json(const report_errors *errors) {
    json_t *all = json_pack(
        "{s:o, s:o, s:o, s:o}", "curve", curve_json(errors), "all", part_json(errors, REPORT_ALL),
        "inside", part_json(errors, REPORT_INSIDE), "seams", part_json(errors, REPORT_SEAMS));
    for (int label = 0; label < REPORT_LABELS && all; label++) {
        if (json_object_set_new(all, report_label_name((report_label)label),
                                tally_json(&errors->labels[label]))) {
            json_decref(all);
            all = NULL;
        }
    }
    return all;
}

/* An object of what there is for each reference in use. */
static json_t *sources_json(const report_data *report, const report_cell *cell) {
    json_t *all = json_object();
    for (int s = 0; s < REPORT_SOURCES && all; s++) {
        if (report->reference.used[s] &&
            json_object_set_new(all, report_source_name((report_source)s),
                                errors_json(&cell->errors[s]))) {
            json_decref(all);
            all = NULL;
        }
    }
    return all;
}

/* A ratio of frame times with its interval. */
static json_t *interval_json(const interval *ratio) {
    return json_pack("{s:o, s:o, s:o}", "median", output_json_number(ratio->median), "low",
                     output_json_number(ratio->low), "high", output_json_number(ratio->high));
}

static json_t *rates_json(const report_data *report, const report_strategy *row) {
    json_t *list = json_array();
    for (uint32_t r = 0; r < report->nrates; r++) {
        const report_cell *cell = &row->rates[r];
        list =
            append(list, json_pack("{s:I, s:o, s:o, s:o, s:o, s:o, s:o}", "samples",
                                   (json_int_t)report->rates[r].samples, "median_ms",
                                   output_json_number(cell->median_ms), "min_ms",
                                   output_json_number(cell->min_ms), "max_ms",
                                   output_json_number(cell->max_ms), "time_ratio",
                                   interval_json(&cell->ratio), "flicker",
                                   cell->flicker.npixels ? tally_json(&cell->flicker) : json_null(),
                                   "errors", sources_json(report, cell)));
    }
    return list;
}

static json_t *reference_json(const report_data *report) {
    const report_reference *r = &report->reference;
    json_t *sources = json_object(), *pixels = json_object();
    for (int s = 0; s < REPORT_SOURCES; s++)
        if (r->used[s] && json_object_set_new(sources, report_source_name((report_source)s),
                                              output_json_number(r->estimate[s])))
            return NULL;
    for (int label = 0; label < REPORT_LABELS; label++)
        if (json_object_set_new(pixels, report_label_name((report_label)label),
                                json_integer((json_int_t)r->npixels[label])))
            return NULL;
    return json_pack("{s:o, s:I, s:I, s:o}", "estimated_rms", sources, "samples",
                     (json_int_t)r->samples, "frames", (json_int_t)r->frames, "pixels", pixels);
}

static json_t *findings_json(const report_data *report) {
    report_finding findings[REPORT_FINDINGS];
    json_t *list = json_array();
    report_find_out(report, findings);
    for (int i = 0; i < REPORT_FINDINGS; i++)
        list = append(list, json_pack("{s:s, s:s, s:s}", "claim", findings[i].claim, "judgement",
                                      report_judgement_name(findings[i].judgement), "numbers",
                                      findings[i].numbers));
    return list;
}

/* Traverse from discard, at each rate. */
static json_t *apart_json(const report_data *report) {
    json_t *list = json_array();
    for (uint32_t r = 0; r < report->nrates; r++)
        list = append(list,
                      json_pack("{s:I, s:o, s:o}", "samples", (json_int_t)report->rates[r].samples,
                                "all", part_json(&report->apart[r], REPORT_ALL), "curve",
                                curve_json(&report->apart[r])));
    return list;
}

static json_t *blocks_json(const report_data *report, const report_strategy *row) {
    const report_blocks *blocks = &row->blocks;
    const slv_gl_texture_stats *stats = &blocks->stats;
    if (!report->compressed)
        return json_null();
    return json_pack(
        "{s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:I, s:o, s:o}", "gpu_bytes",
        (json_int_t)stats->gpu_bytes, "memory_ratio",
        output_json_number((double)stats->gpu_bytes / (double)row->stats.texel_bytes), "psnr",
        output_json_number(blocks->psnr), "reference_psnr",
        output_json_number(blocks->reference_psnr), "uncompressed_reference_psnr",
        output_json_number(blocks->plain_reference_psnr), "texel_rms",
        output_json_number(stats->block_rms), "texel_max", output_json_number(stats->block_max),
        "clipped_faces", (json_int_t)stats->clipped, "seam_max",
        blocks->seam.nedges ? output_json_number((double)blocks->seam.max) : json_null(),
        "seam_mean",
        blocks->seam.nedges ? output_json_number((double)blocks->seam.mean) : json_null());
}

static json_t *strategies_json(const report_data *report) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < report->nstrategies; i++) {
        const report_strategy *row = &report->strategies[i];
        const slv_gl_texture_stats *stats = &row->stats;
        double texels = (double)stats->texel_bytes;
        json_t *item = json_pack(
            "{s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:I, s:I, s:o, s:I, s:I, s:I, s:o, s:o, s:o}",
            "name", row->strategy->name, "median_ms", output_json_number(row->median_ms), "min_ms",
            output_json_number(row->min_ms), "max_ms", output_json_number(row->max_ms),
            "time_ratio", output_json_number(row->ratio.median), "time_ratio_low",
            output_json_number(row->ratio.low), "time_ratio_high",
            output_json_number(row->ratio.high), "texel_bytes", (json_int_t)stats->texel_bytes,
            "gpu_bytes", (json_int_t)stats->gpu_bytes, "memory_ratio",
            output_json_number((double)stats->gpu_bytes / texels), "pools",
            (json_int_t)stats->pools, "batches", (json_int_t)stats->batches, "widened_faces",
            (json_int_t)stats->widened, "seams", seams_json(row), "rates", rates_json(report, row),
            "compressed", blocks_json(report, row));
        list = append(list, item);
    }
    return list;
}

static json_t *pairs_json(const report_data *report) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < report->npairs; i++) {
        const report_pair *pair = &report->pairs[i];
        json_t *item = json_pack(
            "{s:s, s:s, s:o, s:o, s:o, s:o, s:o}", "a", report->strategies[pair->a].strategy->name,
            "b", report->strategies[pair->b].strategy->name, "max", output_json_number(pair->max),
            "mean", output_json_number(pair->mean), "psnr", output_json_number(pair->psnr),
            "share_over_1_255", output_json_number(pair->over_1), "share_over_4_255",
            output_json_number(pair->over_4));
        list = append(list, item);
    }
    return list;
}

static json_t *spots_json(const report_data *report) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < report->nspots; i++) {
        const report_spot *spot = &report->spots[i];
        json_t *item =
            json_pack("{s:I, s:o, s:o, s:o}", "view", (json_int_t)spot->view, "x",
                      output_json_number((double)spot->x), "y", output_json_number((double)spot->y),
                      "zoom", output_json_number((double)spot->zoom));
        list = append(list, item);
    }
    return list;
}

static json_t *orbit_json(const orbit *path) {
    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f}", "azimuth", (double)path->azimuth, "turn",
                     (double)path->turn, "elevation", (double)path->elevation, "tilt",
                     (double)path->tilt, "dolly", (double)path->dolly, "fov", (double)path->fov);
}

static json_t *how_json(const report_data *report) {
    json_t *list = json_array();
    for (uint32_t r = 0; r < report->nrates; r++)
        list = append(list,
                      json_pack("{s:I, s:I, s:I}", "samples", (json_int_t)report->rates[r].samples,
                                "pictures", (json_int_t)report->rates[r].frames, "msaa",
                                (json_int_t)report->rates[r].msaa));
    return list;
}

static json_t *conditions_json(const report_data *report) {
    const slv_gl_info *gl = &report->gl;
    return json_pack(
        "{s:o, s:o, s:o, s:b, s:I, s:I, s:I, s:o, s:s, s:I, s:b, s:I, s:I, s:I, s:o, s:o, s:o, "
        "s:b}",
        "vendor", text(gl->vendor), "renderer", text(gl->renderer), "gl_version", text(gl->version),
        "software", (int)gl->software, "width", (json_int_t)report->width, "height",
        (json_int_t)report->height, "msaa", (json_int_t)report->rates[report->shown].samples,
        "rates", how_json(report), "left_out", report->left_out, "anisotropy",
        (json_int_t)report->anisotropy, "even_levels", (int)report->even_levels, "frames",
        (json_int_t)report->frames, "views", (json_int_t)report->nviews, "segments",
        (json_int_t)report->segments, "orbit", orbit_json(&report->path), "seconds",
        output_json_number(report->seconds), "others", output_json_number(report->others),
        "disturbed", (int)report_disturbed(report));
}

static json_t *take_json(const report_data *report, const report_advice *advice) {
    return advice->measured ? text(report->strategies[advice->take].strategy->name) : json_null();
}

/* Everything that the rule weighed. */
static json_t *points_json(const report_data *report, const report_advice *advice) {
    json_t *list = json_array();
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        const double *p = advice->points[k];
        list = append(list,
                      json_pack("{s:s, s:b, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "name",
                                report->strategies[k].strategy->name, "tied", (int)advice->tied[k],
                                "inside", output_json_number(p[REPORT_ERROR_INSIDE]), "seams",
                                output_json_number(p[REPORT_ERROR_SEAMS]), "close_up",
                                output_json_number(p[REPORT_CLOSE_UP]), "memory",
                                output_json_number(p[REPORT_MEMORY]), "time",
                                output_json_number(p[REPORT_TIME]), "low",
                                output_json_number(advice->low[k]), "high",
                                output_json_number(advice->high[k])));
    }
    return list;
}

/* The cameras that were given. */
static json_t *cameras_json(const report_data *report) {
    json_t *list = json_array();
    for (uint32_t c = 0; c < report->ncameras; c++) {
        const report_camera *camera = &report->cameras[c];
        json_t *rows = json_array();
        for (uint32_t k = 0; k < report->nstrategies; k++)
            rows = append(rows, json_pack("{s:s, s:o, s:o, s:o}", "name",
                                          report->strategies[k].strategy->name, "ms",
                                          output_json_number(camera->ms[k]), "time_ratio",
                                          output_json_number(camera->ratio[k]), "errors",
                                          report->reference.first < REPORT_SOURCES
                                              ? errors_json(&camera->errors[k])
                                              : json_null()));
        list =
            append(list, json_pack("{s:o, s:o}", "view", text(camera->path), "strategies", rows));
    }
    return list;
}

/* An image by texture coordinates beside the strategies. */
static json_t *maps_json(const report_maps *maps) {
    static const char *const places[REPORT_PLACES] = {"outline", "inside", "edges", "end"};
    json_t *rows = json_array();
    for (uint32_t k = 0; k < maps->nrows; k++) {
        const report_map *row = &maps->rows[k];
        json_t *errors = json_object();
        for (int place = 0; place < REPORT_PLACES; place++)
            if (json_object_set_new(errors, places[place], tally_json(&row->errors[place])))
                return NULL;
        rows = append(
            rows,
            json_pack("{s:s, s:b, s:o, s:o, s:o, s:o, s:I, s:I, s:I, s:I, s:o, s:o}", "name",
                      row->name, "strategy", (int)(row->strategy != NULL), "median_ms",
                      output_json_number(row->median_ms), "time_ratio",
                      output_json_number(row->ratio.median), "time_ratio_low",
                      output_json_number(row->ratio.low), "time_ratio_high",
                      output_json_number(row->ratio.high), "vertices", (json_int_t)row->vertices,
                      "vertex_bytes", (json_int_t)row->vertices * row->vertex_bytes, "gpu_bytes",
                      (json_int_t)row->gpu_bytes, "cut_edges", (json_int_t)row->cut, "apart",
                      row->strategy || !maps->referenced ? json_null()
                                                         : output_json_number(row->apart),
                      "errors", errors));
    }
    return json_pack("{s:o, s:s, s:s, s:I, s:I, s:I, s:o, s:I, s:o}", "image", text(maps->image),
                     "round", slv_wrap_round_name(maps->round), "baseline",
                     maps->rows[maps->baseline].name, "frames", (json_int_t)maps->frames,
                     "reference_frames", (json_int_t)maps->referenced, "samples",
                     (json_int_t)maps->samples, "reference_rms", output_json_number(maps->estimate),
                     "faces_over_end", (json_int_t)maps->over_end, "rows", rows);
}

json_t *report_json(const report_data *report) {
    char version[32];
    uint32_t v = slv_version();
    report_advice advice = report_advise(report), cameras = report_advise_cameras(report);
    bool both = report_of_paper(report).both;
    snprintf(version, sizeof version, "%u.%u.%u", v >> 16, v >> 8 & 255, v & 255);
    return json_pack(
        "{s:i, s:s, s:s, s:o, s:o, s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, "
        "s:o, s:o}",
        "schema", 2, "tool", "selvage compare", "version", version, "texture", text(report->ptx),
        "mesh", text(report->mesh), "faces", (json_int_t)report->nfaces, "resolutions",
        (json_int_t)report->nresolutions, "conditions", conditions_json(report), "reference",
        report->reference.first < REPORT_SOURCES ? reference_json(report) : json_null(),
        "strategies", strategies_json(report), "traverse_from_discard",
        both ? apart_json(report) : json_null(), "pairs", pairs_json(report), "spots",
        spots_json(report), "advice", take_json(report, &advice), "points",
        advice.measured ? points_json(report, &advice) : json_null(), "cameras",
        cameras_json(report), "maps", report->maps.image ? maps_json(&report->maps) : json_null(),
        "advice_for_cameras", take_json(report, &cameras), "findings", findings_json(report));
}

slv_result report_write_json(const slv_env *env, const char *path, const report_data *report) {
    slv_output *file = NULL;
    slv_result result = SLV_OK;
    json_t *root = report_json(report);
    if (!root)
        return output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for its contents", path);
    if ((result = slv_output_open(env, path, &file)))
        goto done;
    FILE *stream = slv_output_stream(file);
    /* 9 digits bring every float back exactly and keep the file readable */
    if (json_dumpf(root, stream, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) == 0)
        fputc('\n', stream);
    else if (!ferror(stream))
        result = output_fail(env, SLV_ERROR_MEMORY, "%s: no memory to write it", path);
    result = slv_output_end(file, result);
done:
    json_decref(root);
    return result;
}
