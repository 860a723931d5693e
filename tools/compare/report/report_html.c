/* The page: report.html, with its pictures inside. */
#include "command/output.h"
#include "compare/report/report_experiment.h"
#include "compare/report/report_files.h"
#include "compare/report/report_maps.h"
#include "compare/report/report_page.h"

#include <string.h>

/* Made by the build from the files beside this one. */
struct report_table_row {
    const char *name, *text;
};
extern const struct report_table_row report_table[];

static const char *find_text(const char *name, size_t length) {
    for (const struct report_table_row *row = report_table; row->name; row++)
        if (strlen(row->name) == length && memcmp(row->name, name, length) == 0)
            return row->text;
    return NULL;
}

static const char *file_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash && slash[1] ? slash + 1 : path;
}

static void write_jump_cell(FILE *stream, const slv_gl_seam *seam, bool equal) {
    double max = (double)(equal ? seam->equal_max : seam->max);
    double mean = (double)(equal ? seam->equal_mean : seam->mean);
    if (!(equal ? seam->nequal : seam->nedges)) {
        fputs("<td class=\"quiet\">none</td><td class=\"quiet\">none</td>", stream);
        return;
    }
    fputs(report_jump_hidden(max) ? "<td class=\"good\">" : "<td>", stream);
    report_write_jump(stream, max);
    fputs("</td><td>", stream);
    report_write_jump(stream, mean);
    fputs("</td>", stream);
}

static slv_result strategy_rows(const page *p) {
    static const char *const picks[] = {[REPORT_NO_SEAMS] = "least memory",
                                        [REPORT_SEAMLESS] = "no visible seam, least memory",
                                        [REPORT_EQUAL_ONLY] =
                                            "seamless at equal resolution, least memory",
                                        [REPORT_ALL_VISIBLE] = "smallest seams"};
    for (uint32_t i = 0; i < p->report->nstrategies; i++) {
        const report_strategy *row = &p->report->strategies[i];
        bool best = i == p->verdict.best;
        fprintf(p->stream, "<tr%s><th scope=\"row\">%s", best ? " class=\"best\"" : "",
                page_strategy_name(p, i));
        if (best)
            fprintf(p->stream, " <span class=\"pick\">%s</span>", picks[p->verdict.outcome]);
        if (p->advice.measured && i == p->advice.take)
            fputs(" <span class=\"pick\">for this orbit</span>", p->stream);
        else if (p->advice.measured && p->advice.ntied > 1 && p->advice.tied[i])
            fputs(" <span class=\"pick\">tied with it</span>", p->stream);
        if (row->strategy->title)
            fprintf(p->stream, "<small>%s</small>", row->strategy->title);
        fputs("</th>", p->stream);
        fprintf(p->stream,
                "<td>%.2f<small>%.2f to %.2f</small></td><td>%.2f<small>%.2f to "
                "%.2f</small></td>",
                row->median_ms, row->min_ms, row->max_ms, row->ratio.median, row->ratio.low,
                row->ratio.high);
        double megabytes = (double)row->stats.gpu_bytes / 1e6;
        fprintf(p->stream, "<td>%.*f</td><td>%.2f</td>", megabytes < 10 ? 2 : 1, megabytes,
                report_memory_ratio(row));
        write_jump_cell(p->stream, &row->seams[0], false);
        write_jump_cell(p->stream, &row->seams[0], true);
        fputs("</tr>\n", p->stream);
    }
    return SLV_OK;
}

static slv_result level_rows(const page *p) {
    for (uint32_t i = 0; i < p->report->nstrategies; i++) {
        fprintf(p->stream, "<tr><th scope=\"row\">%s</th>", page_strategy_name(p, i));
        for (uint32_t level = 0; level < REPORT_LEVELS; level++) {
            const slv_gl_seam *seam = &p->report->strategies[i].seams[level];
            if (!seam->nedges) {
                fputs("<td class=\"quiet\">none</td>", p->stream);
                continue;
            }
            fputs(report_jump_hidden((double)seam->max) ? "<td class=\"good\">" : "<td>",
                  p->stream);
            report_write_jump(p->stream, (double)seam->max);
            fputs("<small>", p->stream);
            report_write_jump(p->stream, (double)seam->mean);
            fputs("</small></td>", p->stream);
        }
        fputs("</tr>\n", p->stream);
    }
    return SLV_OK;
}

static void write_options(const page *p, uint32_t selected) {
    for (uint32_t i = 0; i < p->report->nstrategies; i++)
        fprintf(p->stream, "<option value=\"%u\"%s>%s</option>", i,
                i == selected ? " selected" : "", page_strategy_name(p, i));
    if (page_has_reference(p))
        fprintf(p->stream, "<option value=\"%u\">reference</option>", p->report->nstrategies);
}

static slv_result left_options(const page *p) {
    write_options(p, p->verdict.baseline);
    return SLV_OK;
}

static slv_result right_options(const page *p) {
    uint32_t other = p->advice.measured ? p->advice.take : p->verdict.best;
    if (other == p->verdict.baseline && p->report->nstrategies > 1)
        other = (other + 1) % p->report->nstrategies;
    write_options(p, other);
    return SLV_OK;
}

static slv_result view_options(const page *p) {
    for (uint32_t v = 0; v < p->report->nviews; v++)
        fprintf(p->stream, "<option value=\"%u\">%u of %u</option>", v, v + 1, p->report->nviews);
    return SLV_OK;
}

static slv_result method(const page *p) {
    fprintf(p->stream,
            "For the timing the camera moved around the model: %u frames, each drawn with "
            "every strategy "
            "before the next, in changing order, so that whatever else the machine did fell on all "
            "alike. "
            "Times are %s, without reading the picture back; a ratio is the median over frames of "
            "the ratio to %s in the same frame, and beside it the interval that holds the true "
            "median with %.0f %% certainty. "
            "The pictures are drawn at %u points of the same path. For the seam jumps the texture "
            "is looked up "
            "on the GPU by the same shader code, on both sides of each of the %u edges that two "
            "faces share; "
            "%u of them join faces with texels of one size.",
            p->report->frames,
            p->report->gl.software ? "by the clock, because this driver draws on the processor"
                                   : "by the GPU's own timer",
            page_strategy_name(p, p->verdict.baseline), 100 * interval_coverage(p->report->frames),
            p->report->nviews, p->report->strategies[0].seams[0].nedges,
            p->report->strategies[0].seams[0].nequal);
    return SLV_OK;
}

static void write_fact(const page *p, const char *name, const char *value) {
    fprintf(p->stream, "<div><dt>%s</dt><dd>", name);
    output_html(p->stream, value);
    fputs("</dd></div>\n", p->stream);
}

static slv_result facts(const page *p) {
    const report_data *r = p->report;
    char text[320], name[64];
    write_fact(p, "Texture file", r->ptx);
    write_fact(p, "Mesh", r->mesh ? r->mesh : "the geometry inside the texture file");
    write_fact(p, "Driver", r->gl.renderer);
    snprintf(text, sizeof text, "%s, %s", r->gl.version, r->gl.vendor);
    write_fact(p, "OpenGL", text);
    snprintf(text, sizeof text, "%u x %u pixels", r->width, r->height);
    write_fact(p, "Picture size", text);
    snprintf(text, sizeof text, "%u%s", r->rates[r->shown].samples,
             r->rates[r->shown].frames > 1 ? ", from several pictures averaged" : "");
    write_fact(p, "Samples per pixel (MSAA) of pictures", text);
    if (r->left_out[0])
        write_fact(p, "Sampling rates left out", r->left_out);
    for (uint32_t i = 0; i < r->nrates; i++) {
        if (r->rates[i].frames == 1)
            continue;
        snprintf(text, sizeof text,
                 "%u pictures of %u, moved by exact parts of a pixel, averaged in linear light; "
                 "their time is that of all",
                 r->rates[i].frames, r->rates[i].msaa);
        snprintf(name, sizeof name, "%u samples per pixel", r->rates[i].samples);
        write_fact(p, name, text);
    }
    snprintf(text, sizeof text,
             "%g degrees from %g on; elevation %g, swinging by %g three times; distance from 1/%g "
             "to %g times that which frames the model, once",
             (double)r->path.turn, (double)r->path.azimuth, (double)r->path.elevation,
             (double)r->path.tilt, (double)r->path.dolly, (double)r->path.dolly);
    write_fact(p, "Orbit", text);
    snprintf(text, sizeof text, r->anisotropy > 1 ? "up to %u times" : "none", r->anisotropy);
    write_fact(p, "Anisotropic filtering, for slanted views", text);
    write_fact(p, "Levels",
               r->even_levels ? "even: borders, edge-aligned, traverse and hybrid halve the longer "
                                "side of a face first"
                              : "both sides of a face are halved");
    snprintf(text, sizeof text, "%u per strategy, %u strategies", r->frames, r->nstrategies);
    write_fact(p, "Frames timed", text);
    snprintf(text, sizeof text, "%u, at %u different resolutions", r->nfaces, r->nresolutions);
    write_fact(p, "Faces", text);
    if (r->segments)
        snprintf(text, sizeof text, "%u segments along each face's edge", r->segments);
    else
        snprintf(text, sizeof text, "each face as far as the picture needs");
    write_fact(p, "Tessellation", text);
    for (int k = 0; k < REPORT_SOURCES; k++) {
        if (!r->reference.used[k])
            continue;
        if (k == REPORT_SUPERSAMPLED)
            snprintf(text, sizeof text, "drawn with %s, 8 x 8 times as large, %u frames",
                     report_supersampled_with()->name, r->reference.frames);
        else
            snprintf(text, sizeof text, "%u rays per pixel, %u frames", r->reference.samples,
                     r->reference.frames);
        snprintf(name, sizeof name, "Reference '%s'", report_source_name((report_source)k));
        write_fact(p, name, text);
    }
    snprintf(text, sizeof text, "%.0f seconds", r->seconds);
    write_fact(p, "The whole comparison took", text);
    return SLV_OK;
}

static slv_result orbit_sections(const page *p) {
    report_write_rates(p->stream, p->report);
    report_write_errors(p->stream, p->report);
    report_write_cameras(p->stream, p->report);
    report_write_curves(p->stream, p->report);
    report_write_findings(p->stream, p->report);
    report_write_compressed(p->stream, p->report);
    return SLV_OK;
}

static slv_result papers(const page *p) {
    return report_write_papers(p->env, p->stream, p->report);
}

static slv_result advice(const page *p) {
    const report_data *report = p->report;
    report_advice cameras = report_advise_cameras(report);
    if (report_disturbed(report))
        fprintf(p->stream,
                "<p class=\"verdict\">Other programs took %.1f of the processors while frames were "
                "drawn: the times are not to be trusted.</p>\n",
                report->others);
    if (p->advice.measured) {
        fprintf(p->stream, "<p class=\"verdict\">On this orbit, at %u sample%s per pixel, ",
                report->rates[report->shown].samples,
                report->rates[report->shown].samples == 1 ? "" : "s");
        report_write_advice(p->stream, report, &p->advice);
        fputs("</p>\n", p->stream);
    }
    if (cameras.measured) {
        fputs("<p class=\"verdict\">For the given views, ", p->stream);
        report_write_advice(p->stream, report, &cameras);
        fputs("</p>\n", p->stream);
    }
    return SLV_OK;
}

static slv_result rule(const page *p) {
    if (p->advice.measured)
        report_write_rule(p->stream, p->report, &p->advice);
    fputs(
        "<p class=\"small\">The last paragraph is about close views alone, where texels are larger "
        "than pixels: of the strategies whose seam jumps are all hidden, the one with the least "
        "memory.</p>\n",
        p->stream);
    return SLV_OK;
}

static slv_result texture(const page *p) {
    output_html(p->stream, file_name(p->report->ptx));
    return SLV_OK;
}

static slv_result mesh(const page *p) {
    if (p->report->mesh) {
        fputs("on ", p->stream);
        output_html(p->stream, file_name(p->report->mesh));
    } else {
        fputs("on the mesh inside the file", p->stream);
    }
    return SLV_OK;
}

static slv_result faces(const page *p) {
    fprintf(p->stream, "%u face%s", p->report->nfaces, p->report->nfaces == 1 ? "" : "s");
    return SLV_OK;
}

static slv_result resolutions(const page *p) {
    if (p->report->nresolutions == 1)
        fputs("all of one resolution", p->stream);
    else
        fprintf(p->stream, "%u resolutions", p->report->nresolutions);
    return SLV_OK;
}

static slv_result verdict(const page *p) {
    if (p->advice.measured)
        fputs("Close up, where texels are larger than pixels: ", p->stream);
    report_write_verdict(p->stream, p->report, &p->verdict);
    return SLV_OK;
}

static slv_result baseline(const page *p) {
    fputs(page_strategy_name(p, p->verdict.baseline), p->stream);
    return SLV_OK;
}

static slv_result ratio_to_baseline(const page *p) {
    fprintf(p->stream, "ratio to %s", page_strategy_name(p, p->verdict.baseline));
    return SLV_OK;
}

static slv_result width(const page *p) {
    fprintf(p->stream, "%u", p->report->width);
    return SLV_OK;
}

static slv_result height(const page *p) {
    fprintf(p->stream, "%u", p->report->height);
    return SLV_OK;
}

static slv_result version(const page *p) {
    uint32_t v = slv_version();
    fprintf(p->stream, "%u.%u.%u", v >> 16, v >> 8 & 255, v & 255);
    return SLV_OK;
}

/* What may stand in the page between {{ and }}, besides the name of another template. */
static const struct {
    const char *name;
    slv_result (*write)(const page *p);
} fields[] = {
    {"texture", texture},
    {"mesh", mesh},
    {"faces", faces},
    {"resolutions", resolutions},
    {"verdict", verdict},
    {"baseline", baseline},
    {"ratio_to_baseline", ratio_to_baseline},
    {"strategy_rows", strategy_rows},
    {"level_rows", level_rows},
    {"left_options", left_options},
    {"right_options", right_options},
    {"view_options", view_options},
    {"views", page_views},
    {"width", width},
    {"height", height},
    {"spots", page_spots},
    {"pairs", page_pairs},
    {"method", method},
    {"facts", facts},
    {"orbit_sections", orbit_sections},
    {"maps", report_write_maps},
    {"papers", papers},
    {"advice", advice},
    {"rule", rule},
    {"version", version},
};

static slv_result write_field(const page *p, const char *name, size_t length) {
    const char *text = find_text(name, length);
    if (text) {
        fputs(text, p->stream);
        return SLV_OK;
    }
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        if (strlen(fields[i].name) == length && memcmp(fields[i].name, name, length) == 0)
            return fields[i].write(p);
    return output_fail(p->env, SLV_ERROR_ARGUMENT,
                       "the report's template has an unknown field '%.*s'", (int)length, name);
}

static slv_result write_page(const page *p) {
    slv_result result = SLV_OK;
    const char *at = find_text("page.html", 9);
    if (!at)
        return output_fail(p->env, SLV_ERROR_ARGUMENT,
                           "the report's template is missing from this build");
    while (!result && *at) {
        const char *open = strstr(at, "{{"), *close = open ? strstr(open, "}}") : NULL;
        if (!close) {
            fputs(at, p->stream);
            break;
        }
        fwrite(at, 1, (size_t)(open - at), p->stream);
        result = write_field(p, open + 2, (size_t)(close - open - 2));
        at = close + 2;
    }
    return result;
}

slv_result report_write_html(const slv_env *env, const char *path, const report_data *report) {
    slv_output *file = NULL;
    if (!report->nstrategies)
        return output_fail(env, SLV_ERROR_ARGUMENT, "%s: a report without strategies", path);
    slv_result result = slv_output_open(env, path, &file);
    if (result)
        return result;
    FILE *stream = slv_output_stream(file);
    page p = {.env = env,
              .stream = stream,
              .report = report,
              .verdict = report_judge(report),
              .advice = report_advise(report)};
    return slv_output_end(file, write_page(&p));
}
