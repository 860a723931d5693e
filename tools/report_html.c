#include "output.h"
#include "report_verdict.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Made by the build from the files of tools/report. */
struct report_table_row {
    const char *name, *text;
};
extern const struct report_table_row report_table[];

typedef struct page {
    const slv_env *env;
    FILE *stream;
    const report_data *report;
    report_verdict verdict;
} page;

static const char *const strategy_phrases[SLV_STRATEGY_COUNT] = {
    [SLV_STRATEGY_CLAMP] = "reads its own face only; the baseline that shows the problem",
    [SLV_STRATEGY_BORDERS] = "every level stored with a border copied from the neighbours",
    [SLV_STRATEGY_TRAVERSE] = "reads the neighbours that a lookup reaches as well",
    [SLV_STRATEGY_DISCARD] = "drops what falls outside its face; multisampling blends",
    [SLV_STRATEGY_HYBRID] = "traverse where texels are larger than pixels, else discard",
    [SLV_STRATEGY_TRAVERSE_FULL] = "traverse in its plain form, for comparison",
    [SLV_STRATEGY_EDGE_ALIGNED] = "samples on the edges of faces, shared with the neighbours",
};

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

static const char *strategy_name(const page *p, uint32_t index) {
    return slv_strategy_name(p->report->strategies[index].strategy);
}

static void write_base64(FILE *stream, const unsigned char *bytes, size_t size) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char line[4096];
    size_t filled = 0;
    for (size_t i = 0; i < size; i += 3) {
        size_t left = size - i;
        uint32_t triple = (uint32_t)bytes[i] << 16 | (left > 1 ? (uint32_t)bytes[i + 1] << 8 : 0) |
                          (left > 2 ? bytes[i + 2] : 0u);
        line[filled++] = digits[triple >> 18];
        line[filled++] = digits[triple >> 12 & 63];
        line[filled++] = left > 1 ? digits[triple >> 6 & 63] : '=';
        line[filled++] = left > 2 ? digits[triple & 63] : '=';
        if (filled == sizeof line) {
            fwrite(line, 1, filled, stream);
            filled = 0;
        }
    }
    fwrite(line, 1, filled, stream);
}

/* The attributes src, width and height of a picture. */
static slv_result write_source(const page *p, const slv_image *image) {
    static const slv_image_params params = {.encoding = SLV_ENCODE_SRGB, .bits = 8};
    void *bytes = NULL;
    size_t size = 0;
    slv_result result = slv_image_encode_png(p->env, image, &params, &bytes, &size);
    if (result)
        return result;
    fprintf(p->stream, " width=\"%u\" height=\"%u\" src=\"data:image/png;base64,", image->width,
            image->height);
    write_base64(p->stream, bytes, size);
    fputs("\"", p->stream);
    free(bytes);
    return SLV_OK;
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
    static const char *const picks[] = {[REPORT_NO_SEAMS] = "quickest",
                                        [REPORT_SEAMLESS] = "no visible seam, lowest cost",
                                        [REPORT_EQUAL_ONLY] =
                                            "seamless at equal resolution, lowest cost",
                                        [REPORT_ALL_VISIBLE] = "smallest seams"};
    for (uint32_t i = 0; i < p->report->nstrategies; i++) {
        const report_strategy *row = &p->report->strategies[i];
        bool best = i == p->verdict.best;
        fprintf(p->stream, "<tr%s><th scope=\"row\">%s", best ? " class=\"best\"" : "",
                strategy_name(p, i));
        if (best)
            fprintf(p->stream, " <span class=\"pick\">%s</span>", picks[p->verdict.outcome]);
        fprintf(p->stream, "<small>%s</small></th>", strategy_phrases[row->strategy]);
        fprintf(p->stream, "<td>%.2f<small>%.2f to %.2f</small></td><td>%.2f</td>", row->median_ms,
                row->min_ms, row->max_ms, row->ratio);
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
        fprintf(p->stream, "<tr><th scope=\"row\">%s</th>", strategy_name(p, i));
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
                i == selected ? " selected" : "", strategy_name(p, i));
    if (p->report->reference.samples)
        fprintf(p->stream, "<option value=\"%u\">reference</option>", p->report->nstrategies);
}

static slv_result left_options(const page *p) {
    write_options(p, p->verdict.baseline);
    return SLV_OK;
}

static slv_result right_options(const page *p) {
    uint32_t other = p->verdict.best;
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

static slv_result views(const page *p) {
    slv_result result = SLV_OK;
    for (uint32_t v = 0; v < p->report->nviews; v++) {
        if (p->report->reference.samples) {
            fprintf(p->stream,
                    "<img alt=\"View %u, ray-cast\" data-view=\"%u\" data-strategy=\"%u\"", v + 1,
                    v, p->report->nstrategies);
            result = write_source(p, &p->report->reference.views[v]);
            fputs(">\n", p->stream);
        }
        for (uint32_t i = 0; !result && i < p->report->nstrategies; i++) {
            fprintf(p->stream,
                    "<img alt=\"View %u, drawn with %s\" data-view=\"%u\" data-strategy=\"%u\"",
                    v + 1, strategy_name(p, i), v, i);
            result = write_source(p, &p->report->strategies[i].views[v]);
            fputs(">\n", p->stream);
        }
    }
    return result;
}

static slv_result spots(const page *p) {
    const report_data *report = p->report;
    slv_result result = SLV_OK;
    if (!report->nspots) {
        fputs("<p>There is no place in the first view where the strategies' pictures differ by a "
              "visible "
              "amount.</p>\n",
              p->stream);
        return result;
    }
    fputs("<p>The places where the strategies disagree most, drawn again by a camera that looks at "
          "nothing "
          "else. Nothing was smoothed: each square is a pixel of that drawing.</p>\n",
          p->stream);
    for (uint32_t s = 0; !result && s < report->nspots; s++) {
        const report_spot *spot = &report->spots[s];
        fprintf(p->stream,
                "<div class=\"spot\">\n<div class=\"spot-head\"><h3>Seam %u</h3><p>View %u, %.0f "
                "%% from the "
                "left and %.0f %% from the top, enlarged %g times</p>"
                "<button type=\"button\" hidden data-view=\"%u\" data-x=\"%.5f\" "
                "data-y=\"%.5f\">Find it in "
                "the picture</button></div>\n<div class=\"row\" style=\"--n:%u\">\n",
                s + 1, spot->view + 1, (double)spot->x * 100, (double)spot->y * 100,
                (double)spot->zoom, spot->view, (double)spot->x, (double)spot->y,
                report->nstrategies);
        for (uint32_t i = 0; !result && i < report->nstrategies; i++) {
            fprintf(p->stream, "<figure><img alt=\"Seam %u, enlarged, drawn with %s\"", s + 1,
                    strategy_name(p, i));
            result = write_source(p, &report->strategies[i].spots[s]);
            fprintf(p->stream, "><figcaption>%s</figcaption></figure>\n", strategy_name(p, i));
        }
        fputs("</div>\n</div>\n", p->stream);
    }
    return result;
}

static slv_result pairs(const page *p) {
    const report_data *report = p->report;
    slv_result result = SLV_OK;
    if (!report->npairs) {
        fputs("<p>One strategy alone has nothing to be compared with.</p>\n", p->stream);
        return result;
    }
    fprintf(p->stream,
            "<p>Each map shows the first view: how far two strategies' pixels are apart in their "
            "most different "
            "channel, in linear light. The numbers are over all %u views, where the surface covers "
            "the whole "
            "pixel.</p>\n"
            "<div class=\"legend\"><div class=\"legend-bar\" role=\"img\" aria-label=\"Scale: "
            "black is equal, "
            "then blue, red and yellow, white is a difference of 16/255 and more\"></div>"
            "<div class=\"legend-ticks\" aria-hidden=\"true\"><span>equal</span>"
            "<span style=\"--i:2\">4/255</span><span style=\"--i:3\">8/255</span>"
            "<span style=\"--i:4\">12/255</span><span>16/255</span></div></div>\n"
            "<div class=\"pairs\">\n",
            report->nviews);
    for (uint32_t i = 0; !result && i < report->npairs; i++) {
        const report_pair *pair = &report->pairs[i];
        const char *a = strategy_name(p, pair->a), *b = strategy_name(p, pair->b);
        fprintf(p->stream, "<figure><img alt=\"Map of the differences between %s and %s\"", a, b);
        result = write_source(p, &pair->heat);
        fprintf(p->stream, ">\n<figcaption>%s and %s</figcaption>\n<table><tbody>\n", a, b);
        fputs("<tr><th scope=\"row\">Largest difference</th><td>", p->stream);
        report_write_jump(p->stream, pair->max);
        fputs(" /255</td></tr>\n<tr><th scope=\"row\">Mean difference</th><td>", p->stream);
        report_write_jump(p->stream, pair->mean);
        fputs(" /255</td></tr>\n<tr><th scope=\"row\">PSNR, higher is closer</th><td>", p->stream);
        if (isfinite(pair->psnr))
            fprintf(p->stream, "%.1f dB", pair->psnr);
        else
            fputs("identical", p->stream);
        fprintf(p->stream,
                "</td></tr>\n<tr><th scope=\"row\">Pixels further apart than 1/255</th><td>%.2f "
                "%%</td></tr>\n"
                "<tr><th scope=\"row\">Pixels further apart than 4/255</th><td>%.2f %%</td></tr>\n"
                "</tbody></table></figure>\n",
                pair->over_1 * 100, pair->over_4 * 100);
    }
    fputs("</div>\n", p->stream);
    return result;
}

static slv_result method(const page *p) {
    fprintf(p->stream,
            "For the timing the camera moved around the model: %u frames, each drawn with "
            "every strategy "
            "before the next, in changing order, so that whatever else the machine did fell on all "
            "alike. "
            "Times are %s, without reading the picture back. "
            "The pictures are drawn at %u points of the same path. For the seam jumps the texture "
            "is looked up "
            "on the GPU by the same shader code, on both sides of each of the %u edges that two "
            "faces share; "
            "%u of them join faces with texels of one size.",
            p->report->frames,
            p->report->gl.software ? "by the clock, because this driver draws on the processor"
                                   : "by the GPU's own timer",
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
    char text[320];
    write_fact(p, "Texture file", r->ptx);
    write_fact(p, "Mesh", r->mesh ? r->mesh : "the geometry inside the texture file");
    write_fact(p, "Driver", r->gl.renderer);
    snprintf(text, sizeof text, "%s, %s", r->gl.version, r->gl.vendor);
    write_fact(p, "OpenGL", text);
    snprintf(text, sizeof text, "%u x %u pixels", r->width, r->height);
    write_fact(p, "Picture size", text);
    snprintf(text, sizeof text, "%u", r->msaa > 1 ? r->msaa : 1);
    write_fact(p, "Multisampling (MSAA), samples per pixel", text);
    snprintf(text, sizeof text, r->anisotropy > 1 ? "up to %u times" : "none", r->anisotropy);
    write_fact(p, "Anisotropic filtering, for slanted views", text);
    snprintf(text, sizeof text, "%u per strategy, %u strategies", r->frames, r->nstrategies);
    write_fact(p, "Frames timed", text);
    snprintf(text, sizeof text, "%u, at %u different resolutions", r->nfaces, r->nresolutions);
    write_fact(p, "Faces", text);
    snprintf(text, sizeof text, "%u segments along each face's edge", r->segments);
    write_fact(p, "Tessellation", text);
    if (r->reference.samples) {
        snprintf(text, sizeof text, "%u samples per pixel, %.0f seconds", r->reference.samples,
                 r->reference.seconds);
        write_fact(p, "Ray-cast reference", text);
    }
    snprintf(text, sizeof text, "%.0f seconds", r->seconds);
    write_fact(p, "The whole comparison took", text);
    return SLV_OK;
}

static slv_result errors(const page *p) {
    report_write_errors(p->stream, p->report);
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
    report_write_verdict(p->stream, p->report, &p->verdict);
    return SLV_OK;
}

static slv_result baseline(const page *p) {
    fputs(strategy_name(p, p->verdict.baseline), p->stream);
    return SLV_OK;
}

static slv_result ratio_to_baseline(const page *p) {
    fprintf(p->stream, "ratio to %s", strategy_name(p, p->verdict.baseline));
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
    {"views", views},
    {"width", width},
    {"height", height},
    {"spots", spots},
    {"pairs", pairs},
    {"method", method},
    {"facts", facts},
    {"errors", errors},
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
    output_file file;
    if (!report->nstrategies)
        return output_fail(env, SLV_ERROR_ARGUMENT, "%s: a report without strategies", path);
    slv_result result = output_open(env, path, &file);
    if (result)
        return result;
    page p = {.env = env, .stream = file.stream, .report = report, .verdict = report_judge(report)};
    return output_close(&file, write_page(&p));
}
