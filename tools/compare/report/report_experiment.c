/* The sections of the page about the orbit: times, errors, findings. */
#include "compare/report/report_experiment.h"

#include "command/output.h"
#include "compare/engine/report_findings.h"
#include "compare/report/report_paper.h"
#include "compare/report/report_plot.h"
#include "compare/report/report_words.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *source_words(report_source source, char text[96]) {
    if (source == REPORT_RAYCAST)
        return "ray-cast, box filter";
    if (source == REPORT_MITCHELL)
        return "ray-cast, Mitchell filter";
    snprintf(text, 96, "<code>%s</code> 8 &times; 8 times as large, Mitchell filter",
             report_supersampled_with()->name);
    return text;
}

static const char *name_of(const report_data *report, uint32_t k) {
    return report->strategies[k].strategy->name;
}

static void write_rate(FILE *stream, const report_rate *rate) {
    fprintf(stream, "%u&times;", rate->samples);
    if (rate->frames > 1)
        fprintf(stream, "<small>%u of %u&times;</small>", rate->frames, rate->msaa);
}

void report_write_rates(FILE *stream, const report_data *report) {
    report_paper_strategies known = report_of_paper(report);
    uint32_t clamp = known.clamp, traverse = known.traverse, n = report->nstrategies;
    fputs("<section aria-labelledby=\"rates\">\n<h2 id=\"rates\">Frame time by sampling rate</h2>\n"
          "<p class=\"caption\" id=\"rates-what\">Median milliseconds of a frame, as in Toth's "
          "Table 1; below, ratios at the same rate",
          stream);
    fputs(clamp < n ? " to <code>clamp</code>" : "", stream);
    fputs(clamp < n && traverse < n ? " and" : "", stream);
    fputs(traverse < n ? " to <code>traverse</code>" : "", stream);
    fputs(". ", stream);
    output_html(stream, report->gl.renderer);
    fputs(".", stream);
    if (report->left_out[0])
        fprintf(stream, " Left out: %s samples per pixel.", report->left_out);
    fputs("</p>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"rates\">\n"
          "<table aria-labelledby=\"rates\" aria-describedby=\"rates-what\">\n<thead>\n<tr><th "
          "scope=\"col\">Strategy</th>",
          stream);
    for (uint32_t r = 0; r < report->nrates; r++) {
        fputs("<th scope=\"col\">", stream);
        write_rate(stream, &report->rates[r]);
        fputs("</th>", stream);
    }
    fputs("</tr>\n</thead>\n<tbody>\n", stream);
    for (uint32_t k = 0; k < n; k++) {
        fprintf(stream, "<tr><th scope=\"row\">%s</th>", name_of(report, k));
        for (uint32_t r = 0; r < report->nrates; r++) {
            double ms = report->strategies[k].rates[r].median_ms;
            fprintf(stream, "<td>%.*f<small>", ms < 10 ? 3 : ms < 100 ? 2 : 1, ms);
            if (clamp < n)
                fprintf(stream, "%.2f", ms / report->strategies[clamp].rates[r].median_ms);
            if (traverse < n)
                fprintf(stream, "%s%.2f", clamp < n ? " &middot; " : "",
                        ms / report->strategies[traverse].rates[r].median_ms);
            fputs("</small></td>", stream);
        }
        fputs("</tr>\n", stream);
    }
    fputs("</tbody>\n</table>\n</div>\n</section>\n", stream);
}

static void write_left(FILE *stream, const report_data *report) {
    report_curve curves[REPORT_MAX_RATES];
    char names[REPORT_MAX_RATES][16];
    for (uint32_t r = 0; r < report->nrates; r++) {
        snprintf(names[r], sizeof names[r], "%u\u00d7", report->rates[r].samples);
        curves[r] = (report_curve){names[r], r, &report->apart[r]};
    }
    fputs("<h3>Traverse from discard</h3>\n<div class=\"plots\">\n", stream);
    report_write_plot(stream, "Every frame of the orbit",
                      "Share of pixels by the difference of traverse and discard", curves,
                      report->nrates);
    fputs("</div>\n", stream);
}

static void write_right(FILE *stream, const report_data *report, report_source source) {
    char words[96];
    fprintf(stream, "<h3>From the reference: %s</h3>\n<div class=\"plots\">\n",
            source_words(source, words));
    for (uint32_t r = 0; r < report->nrates; r++) {
        report_curve curves[REPORT_MAX_STRATEGIES];
        char title[64];
        for (uint32_t k = 0; k < report->nstrategies; k++)
            curves[k] =
                (report_curve){name_of(report, k), report_colour(report->strategies[k].strategy),
                               &report->strategies[k].rates[r].errors[source]};
        snprintf(title, sizeof title, "%u sample%s per pixel", report->rates[r].samples,
                 report->rates[r].samples == 1 ? "" : "s");
        report_write_plot(stream, title, "Share of pixels by distance from the reference", curves,
                          report->nstrategies);
    }
    fputs("</div>\n", stream);
}

void report_write_curves(FILE *stream, const report_data *report) {
    bool left = report_of_paper(report).both;
    if (!left && report->reference.first == REPORT_SOURCES)
        return;
    fputs("<section aria-labelledby=\"curves\">\n<h2 id=\"curves\">How many pixels are how far "
          "off</h2>\n<p class=\"caption\">The share of all pixels, background and outlines "
          "included, that are further away than a distance, as in Toth's Figure 5. Lower left is "
          "better. The numbers are in figure5_*.csv beside this page.</p>\n",
          stream);
    if (left)
        write_left(stream, report);
    for (int s = 0; s < REPORT_SOURCES; s++)
        if (report->reference.used[s])
            write_right(stream, report, (report_source)s);
    fputs("</section>\n", stream);
}

/* The sets that a row shows, in order. */
static const struct {
    unsigned labels;
    const char *title;
} sets[] = {
    {1 << REPORT_INTERIOR, "interior"},
    {1 << REPORT_EDGE, "edge"},
    {1 << REPORT_REGULAR, "regular vertex"},
    {1 << REPORT_EXTRAORDINARY, "other vertex"},
    {REPORT_SEAMS, "all seams"},
    {REPORT_ALL, "all pixels"},
};
enum { SETS = sizeof sets / sizeof *sets };

static double set_error(const report_data *report, report_source source, uint32_t k, size_t set) {
    report_tally tally = report_errors_part(
        &report->strategies[k].rates[report->shown].errors[source], sets[set].labels);
    return report_rms(&tally);
}

/* Quiet if there is none, marked if it is the least or within one part in a hundred of it. */
static void write_error(FILE *stream, double value, double least) {
    if (!isfinite(value)) {
        fputs("<td class=\"quiet\">none</td>", stream);
        return;
    }
    fputs(value <= least * 1.01 ? "<td class=\"good\">" : "<td>", stream);
    report_write_jump(stream, value);
    fputs("</td>", stream);
}

static void write_rows(FILE *stream, const report_data *report, report_source source) {
    double least[SETS], least_flicker = INFINITY;
    bool flickers = report->reference.first < REPORT_SUPERSAMPLED;
    for (size_t i = 0; i < SETS; i++) {
        least[i] = INFINITY;
        for (uint32_t k = 0; k < report->nstrategies; k++)
            least[i] = fmin(least[i], set_error(report, source, k, i));
    }
    for (uint32_t k = 0; k < report->nstrategies; k++)
        least_flicker =
            fmin(least_flicker, report_rms(&report->strategies[k].rates[report->shown].flicker));
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        fprintf(stream, "<tr><th scope=\"row\">%s</th>", name_of(report, k));
        for (size_t i = 0; i < SETS; i++)
            write_error(stream, set_error(report, source, k, i), least[i]);
        if (flickers && source == report->reference.first)
            write_error(stream, report_rms(&report->strategies[k].rates[report->shown].flicker),
                        least_flicker);
        fputs("</tr>\n", stream);
    }
}

static void write_table(FILE *stream, const report_data *report, report_source source) {
    char words[96];
    const report_reference *ref = &report->reference;
    uint64_t all = 0;
    bool flickers = source == ref->first && source < REPORT_SUPERSAMPLED;
    for (int label = 0; label < REPORT_LABELS; label++)
        all += ref->npixels[label];
    fprintf(stream,
            "<h3 id=\"error-%s\">Reference: %s</h3>\n<div class=\"scroll\" tabindex=\"0\" "
            "role=\"region\" aria-labelledby=\"error-%s\">\n<table "
            "aria-labelledby=\"error-%s\">\n<thead>\n<tr><th scope=\"col\" "
            "rowspan=\"2\">Strategy</th><th scope=\"colgroup\" colspan=\"%d\">RMS error, "
            "1/255, of pixels of</th>",
            report_source_name(source), source_words(source, words), report_source_name(source),
            report_source_name(source), (int)SETS);
    if (flickers)
        fputs("<th scope=\"col\" rowspan=\"2\">flicker</th>", stream);
    fputs("</tr>\n<tr>", stream);
    for (size_t i = 0; i < SETS; i++) {
        uint64_t some = 0;
        for (int label = 0; label < REPORT_LABELS; label++)
            some += sets[i].labels >> label & 1 ? ref->npixels[label] : 0;
        fprintf(stream, "<th scope=\"col\">%s<small>%.3g %%</small></th>", sets[i].title,
                all ? 100 * (double)some / (double)all : 0);
    }
    fputs("</tr>\n</thead>\n<tbody>\n", stream);
    write_rows(stream, report, source);
    fputs("</tbody>\n</table>\n</div>\n", stream);
}

void report_write_errors(FILE *stream, const report_data *report) {
    const report_reference *ref = &report->reference;
    if (ref->first == REPORT_SOURCES)
        return;
    fprintf(stream,
            "<section aria-labelledby=\"error\">\n<h2 id=\"error\">Error by kind of pixel</h2>\n"
            "<p class=\"caption\">At %u sample%s per pixel, over %u frame%s of the orbit. A "
            "pixel's error is the length of the difference of its linear RGB. Its kind is where "
            "its lookup reaches: <em>interior</em> one face alone, <em>edge</em> over an edge, or "
            "around a vertex, <em>regular</em> with four faces and <em>other</em> with any other "
            "number. The small numbers are each kind's share of all pixels; the rest is "
            "background and outlines.",
            report->rates[report->shown].samples,
            report->rates[report->shown].samples == 1 ? "" : "s", ref->frames,
            ref->frames == 1 ? "" : "s");
    if (ref->first < REPORT_SUPERSAMPLED) {
        fprintf(stream, " Rays: %u per pixel, whose own error is estimated as ", ref->samples);
        report_write_jump(stream, ref->estimate[ref->first]);
        fputs("/255. <em>Flicker</em> is how much the error of a pixel changes from one moment to "
              "the next, a thousandth of the orbit later, RMS inside the surface.",
              stream);
    }
    fputs("</p>\n", stream);
    for (int s = 0; s < REPORT_SOURCES; s++)
        if (ref->used[s])
            write_table(stream, report, (report_source)s);
    fputs("</section>\n", stream);
}

void report_write_findings(FILE *stream, const report_data *report) {
    report_finding findings[REPORT_FINDINGS];
    bool any = false;
    report_find_out(report, findings);
    for (int i = 0; i < REPORT_FINDINGS; i++)
        any |= findings[i].judgement != REPORT_UNMEASURED;
    if (!any)
        return;
    fputs("<section aria-labelledby=\"toth\">\n<h2 id=\"toth\">What Toth found, and what is found "
          "here</h2>\n<p class=\"caption\">Robert Toth, <cite>Avoiding Texture Seams by Discarding "
          "Filter Taps</cite>, 2013, section 4. Errors are RMS over all pixels, as his curves are, "
          "from his kind of reference (<code>supersampled</code>) if it was asked for; a "
          "difference of less than 2 % decides nothing, and up to 10 % is roughly equal.</p>\n<ol "
          "class=\"findings\">\n",
          stream);
    for (int i = 0; i < REPORT_FINDINGS; i++) {
        const report_finding *f = &findings[i];
        fprintf(stream, "<li><strong class=\"judged-%d\">%s</strong> %s<small>%s%s</small></li>\n",
                (int)f->judgement, report_judgement_name(f->judgement), f->claim,
                f->numbers[0] ? f->numbers
                              : "the strategies, rates or reference for it are missing",
                ".");
    }
    fputs("</ol>\n</section>\n", stream);
}

static slv_result write_paper(const slv_env *env, FILE *stream, const report_data *report,
                              const char *title,
                              void (*write)(FILE *stream, const report_data *report)) {
    char *text = NULL;
    size_t size = 0;
    FILE *memory = open_memstream(&text, &size);
    if (memory)
        write(memory, report);
    if (!memory || fclose(memory) != 0) {
        free(text);
        return output_fail(env, SLV_ERROR_MEMORY, "no memory for the report's tables");
    }
    fprintf(stream,
            "<figure class=\"paper\"><figcaption>%s <button type=\"button\" hidden "
            "data-copy>Copy</button></figcaption><pre tabindex=\"0\">",
            title);
    for (char *line = text, *end; (end = strchr(line, '\n')); line = end + 1) {
        *end = 0;
        output_html(stream, line);
        fputc('\n', stream);
    }
    fputs("</pre></figure>\n", stream);
    free(text);
    return SLV_OK;
}

slv_result report_write_papers(const slv_env *env, FILE *stream, const report_data *report) {
    slv_result result;
    if ((result = write_paper(env, stream, report, "LaTeX", report_write_latex)) ||
        (result = write_paper(env, stream, report, "Markdown", report_write_markdown)))
        return result;
    return write_paper(env, stream, report, "CSV", report_write_csv);
}
