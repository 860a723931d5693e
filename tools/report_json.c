#include "output.h"
#include "report.h"

#include <string.h>

static json_t *text(const char *string) {
    return string ? output_json_text(string, strlen(string)) : json_null();
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

static json_t *error_json(const report_error *error) {
    json_t *curve = json_array();
    for (uint32_t i = 0; i < REPORT_ERROR_STEPS; i++)
        curve = append(curve, json_pack("[o, o]", output_json_number(report_error_step(i)),
                                        output_json_number(error->share[i])));
    return json_pack("{s:I, s:o, s:o, s:o, s:o, s:o, s:o}", "pixels", (json_int_t)error->npixels,
                     "rms", output_json_number(error->rms), "max", output_json_number(error->max),
                     "share_over_1_255", output_json_number(error->over_1), "share_over_4_255",
                     output_json_number(error->over_4), "share_over_16_255",
                     output_json_number(error->over_16), "curve", curve);
}

static json_t *errors_json(const report_data *report, const report_strategy *row) {
    return report->reference.samples ? json_pack("{s:o, s:o}", "all", error_json(&row->all),
                                                 "inside", error_json(&row->inside))
                                     : json_null();
}

static json_t *reference_json(const report_reference *r) {
    return r->samples
               ? json_pack("{s:s, s:I, s:o, s:o}", "filter",
                           r->filter == SLV_PIXEL_BOX ? "box" : "mitchell", "samples",
                           (json_int_t)r->samples, "estimated_rms", output_json_number(r->estimate),
                           "seconds", output_json_number(r->seconds))
               : json_null();
}

static json_t *strategies_json(const report_data *report) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < report->nstrategies; i++) {
        const report_strategy *row = &report->strategies[i];
        const slv_gl_texture_stats *stats = &row->stats;
        double texels = (double)stats->texel_bytes;
        json_t *item = json_pack(
            "{s:s, s:o, s:o, s:o, s:o, s:I, s:I, s:o, s:I, s:I, s:I, s:o, s:o}", "name",
            slv_strategy_name(row->strategy), "median_ms", output_json_number(row->median_ms),
            "min_ms", output_json_number(row->min_ms), "max_ms", output_json_number(row->max_ms),
            "time_ratio", output_json_number(row->ratio), "texel_bytes",
            (json_int_t)stats->texel_bytes, "gpu_bytes", (json_int_t)stats->gpu_bytes,
            "memory_ratio", output_json_number((double)stats->gpu_bytes / texels), "pools",
            (json_int_t)stats->pools, "batches", (json_int_t)stats->batches, "widened_faces",
            (json_int_t)stats->widened, "seams", seams_json(row), "errors",
            errors_json(report, row));
        list = append(list, item);
    }
    return list;
}

static json_t *pairs_json(const report_data *report) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < report->npairs; i++) {
        const report_pair *pair = &report->pairs[i];
        json_t *item = json_pack(
            "{s:s, s:s, s:o, s:o, s:o, s:o, s:o}", "a",
            slv_strategy_name(report->strategies[pair->a].strategy), "b",
            slv_strategy_name(report->strategies[pair->b].strategy), "max",
            output_json_number(pair->max), "mean", output_json_number(pair->mean), "psnr",
            output_json_number(pair->psnr), "share_over_1_255", output_json_number(pair->over_1),
            "share_over_4_255", output_json_number(pair->over_4));
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

static json_t *conditions_json(const report_data *report) {
    const slv_gl_info *gl = &report->gl;
    return json_pack(
        "{s:o, s:o, s:o, s:b, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:o}", "vendor", text(gl->vendor),
        "renderer", text(gl->renderer), "gl_version", text(gl->version), "software",
        (int)gl->software, "width", (json_int_t)report->width, "height", (json_int_t)report->height,
        "msaa", (json_int_t)report->msaa, "anisotropy", (json_int_t)report->anisotropy, "frames",
        (json_int_t)report->frames, "views", (json_int_t)report->nviews, "segments",
        (json_int_t)report->segments, "seconds", output_json_number(report->seconds));
}

static json_t *report_json(const report_data *report) {
    char version[32];
    uint32_t v = slv_version();
    snprintf(version, sizeof version, "%u.%u.%u", v >> 16, v >> 8 & 255, v & 255);
    return json_pack("{s:i, s:s, s:s, s:o, s:o, s:I, s:I, s:o, s:o, s:o, s:o, s:o}", "schema", 1,
                     "tool", "selvage compare", "version", version, "texture", text(report->ptx),
                     "mesh", text(report->mesh), "faces", (json_int_t)report->nfaces, "resolutions",
                     (json_int_t)report->nresolutions, "conditions", conditions_json(report),
                     "reference", reference_json(&report->reference), "strategies",
                     strategies_json(report), "pairs", pairs_json(report), "spots",
                     spots_json(report));
}

slv_result report_write_json(const slv_env *env, const char *path, const report_data *report) {
    output_file file;
    slv_result result = SLV_OK;
    json_t *root = report_json(report);
    if (!root)
        return output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for its contents", path);
    if ((result = output_open(env, path, &file)))
        goto done;
    /* 9 digits bring every float back exactly and keep the file readable */
    if (json_dumpf(root, file.stream, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) == 0)
        fputc('\n', file.stream);
    else if (!ferror(file.stream))
        result = output_fail(env, SLV_ERROR_MEMORY, "%s: no memory to write it", path);
    result = output_close(&file, result);
done:
    json_decref(root);
    return result;
}
