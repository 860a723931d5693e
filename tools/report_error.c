#include "report_verdict.h"

#include <math.h>
#include <stdio.h>

enum { WIDTH = 640, HEIGHT = 360, LEFT = 64, RIGHT = 625, TOP = 12, BOTTOM = 310 };

static const char *const colors[SLV_STRATEGY_COUNT] = {
    [SLV_STRATEGY_CLAMP] = "#c4450c",
    [SLV_STRATEGY_BORDERS] = "#7a52c7",
    [SLV_STRATEGY_TRAVERSE] = "#0a78b4",
    [SLV_STRATEGY_DISCARD] = "#3c8f2f",
    [SLV_STRATEGY_HYBRID] = "#b0379a",
    [SLV_STRATEGY_TRAVERSE_FULL] = "#6d7a86",
    [SLV_STRATEGY_EDGE_ALIGNED] = "#a37b00",
};

double report_error_step(uint32_t i) {
    return exp2(-10 + 0.25 * i);
}

static double plot_x(double error) {
    return LEFT + (RIGHT - LEFT) * (log2(error) + 10) / 10;
}

/* A share of 1 is at the top, `low` at the bottom. */
static double plot_y(double share, double low) {
    return TOP + (BOTTOM - TOP) * log(share) / log(low);
}

static void write_curve(FILE *stream, const report_strategy *row, double low) {
    bool any = false;
    fputs("<path d=\"", stream);
    for (uint32_t i = 0; i < REPORT_ERROR_STEPS && row->all.share[i] >= low; i++) {
        fprintf(stream, "%c%.1f %.1f", any ? 'L' : 'M', plot_x(report_error_step(i)),
                plot_y(row->all.share[i], low));
        any = true;
    }
    fprintf(stream, "%s\" fill=\"none\" stroke=\"%s\" stroke-width=\"2\"/>\n", any ? "" : "M0 0",
            colors[row->strategy]);
}

static void write_plot(FILE *stream, const report_data *report) {
    const uint64_t npixels = report->strategies[0].all.npixels;
    double low = 0.1;
    while (low > 1e-6 && low * (double)npixels > 10)
        low /= 10;
    fprintf(stream,
            "<figure class=\"plot\"><svg viewBox=\"0 0 %d %d\" role=\"img\" aria-label=\"Share of "
            "pixels by distance from the reference\" font-size=\"12\" fill=\"currentColor\">\n",
            WIDTH, HEIGHT);
    for (int k = -10; k <= 0; k += 2)
        fprintf(stream,
                "<path d=\"M%.1f %dV%d\" stroke=\"currentColor\" stroke-opacity=\"0.15\"/>"
                "<text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%s%d</text>\n",
                plot_x(exp2(k)), TOP, BOTTOM, plot_x(exp2(k)), BOTTOM + 18, k ? "1/" : "", 1 << -k);
    for (double share = 1; share > low * 0.99; share /= 10)
        fprintf(stream,
                "<path d=\"M%d %.1fH%d\" stroke=\"currentColor\" stroke-opacity=\"0.15\"/>"
                "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%g %%</text>\n",
                LEFT, plot_y(share, low), RIGHT, LEFT - 8, plot_y(share, low) + 4, share * 100);
    fprintf(stream,
            "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">distance in linear RGB</text>\n",
            (LEFT + RIGHT) / 2, BOTTOM + 38);
    for (uint32_t i = 0; i < report->nstrategies; i++) {
        const report_strategy *row = &report->strategies[i];
        int y = TOP + 18 + 18 * (int)i;
        write_curve(stream, row, low);
        fprintf(stream,
                "<path d=\"M%d %dh18\" stroke=\"%s\" stroke-width=\"2\"/><text x=\"%d\" "
                "y=\"%d\">%s</text>\n",
                RIGHT - 110, y - 4, colors[row->strategy], RIGHT - 86, y,
                slv_strategy_name(row->strategy));
    }
    fputs("</svg><figcaption>Share of all pixels that are further from the reference than the "
          "distance below; lower left is better.</figcaption></figure>\n",
          stream);
}

static void write_row(FILE *stream, const report_strategy *row) {
    const report_error *e = &row->inside;
    fprintf(stream, "<tr><th scope=\"row\">%s</th><td>", slv_strategy_name(row->strategy));
    report_write_jump(stream, e->rms);
    fputs("</td><td>", stream);
    report_write_jump(stream, e->max);
    fprintf(stream, "</td><td>%.3f %%</td><td>%.3f %%</td><td>%.3f %%</td><td>%.3f %%</td></tr>\n",
            e->over_1 * 100, e->over_4 * 100, e->over_16 * 100, row->all.over_4 * 100);
}

void report_write_errors(FILE *stream, const report_data *report) {
    const report_reference *r = &report->reference;
    if (!r->samples)
        return;
    fprintf(stream,
            "<section aria-labelledby=\"error\">\n<h2 id=\"error\">Error against a ray-cast "
            "reference</h2>\n"
            "<p class=\"caption\" id=\"error-what\">The reference owes nothing to any strategy: "
            "%u rays through every pixel, the texture a continuous function where they land, "
            "averaged by a %s filter. Its own error is estimated as ",
            r->samples, r->filter == SLV_PIXEL_BOX ? "box" : "Mitchell-Netravali");
    report_write_jump(stream, r->estimate);
    fprintf(stream,
            " /255 RMS. A pixel's error is the length of the difference of its linear RGB, over "
            "all %u views; <em>inside</em> counts the pixels that the surface covers in full, "
            "where strategies differ and outlines do not matter.</p>\n"
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"error\">\n"
            "<table aria-labelledby=\"error\" aria-describedby=\"error-what\">\n<thead>\n"
            "<tr><th scope=\"col\" rowspan=\"2\">Strategy</th><th scope=\"colgroup\" "
            "colspan=\"2\">Error inside, 1/255</th><th scope=\"colgroup\" colspan=\"3\">Pixels "
            "inside further away than</th><th scope=\"colgroup\">of all pixels</th></tr>\n"
            "<tr><th scope=\"col\">RMS</th><th scope=\"col\">largest</th><th "
            "scope=\"col\">1/255</th><th scope=\"col\">4/255</th><th scope=\"col\">16/255</th>"
            "<th scope=\"col\">4/255</th></tr>\n</thead>\n<tbody>\n",
            report->nviews);
    for (uint32_t i = 0; i < report->nstrategies; i++)
        write_row(stream, &report->strategies[i]);
    fputs("</tbody>\n</table>\n</div>\n", stream);
    write_plot(stream, report);
    fputs("</section>\n", stream);
}
