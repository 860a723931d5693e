/* Curves as SVG. */
#include "compare/report/report_plot.h"

#include <math.h>

enum { WIDTH = 480, HEIGHT = 320, LEFT = 74, RIGHT = 470, TOP = 12, BOTTOM = 268, PALETTE = 8 };

/* Colours that come again are dashed. */
static bool dashed(uint32_t color) {
    return color / PALETTE % 2;
}

static double plot_x(double error) {
    return LEFT + (RIGHT - LEFT) * (log2(error) + 10) / 10;
}

/* A share of 1 is at the top, `low` at the bottom. */
static double plot_y(double share, double low) {
    return TOP + (BOTTOM - TOP) * log(share) / log(low);
}

static void write_curve(FILE *stream, const report_curve *curve, double low, double width) {
    bool any = false;
    for (uint32_t i = 0; i < REPORT_ERROR_STEPS && report_share(curve->errors, i) >= low; i++) {
        fprintf(stream, "%s%.1f %.1f", any ? "L" : "<path d=\"M", plot_x(report_error_step(i)),
                plot_y(report_share(curve->errors, i), low));
        any = true;
    }
    if (any)
        fprintf(stream, "\" fill=\"none\" stroke=\"var(--c%u)\" stroke-width=\"%.2f\"%s/>\n",
                curve->color % PALETTE, width,
                dashed(curve->color) ? " stroke-dasharray=\"7 4\"" : "");
}

static void write_axes(FILE *stream, double low) {
    for (int k = -10; k <= 0; k += 2)
        fprintf(stream,
                "<path d=\"M%.1f %dV%d\" stroke=\"currentColor\" stroke-opacity=\"0.15\"/>"
                "<text x=\"%.1f\" y=\"%d\" text-anchor=\"%s\">%s%d</text>\n",
                plot_x(exp2(k)), TOP, BOTTOM, plot_x(exp2(k)), BOTTOM + 18, k ? "middle" : "end",
                k ? "1/" : "", 1 << -k);
    for (double share = 1; share > low * 0.99; share /= 10)
        fprintf(stream,
                "<path d=\"M%d %.1fH%d\" stroke=\"currentColor\" stroke-opacity=\"0.15\"/>"
                "<text x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%g %%</text>\n",
                LEFT, plot_y(share, low), RIGHT, LEFT - 8, plot_y(share, low) + 4, share * 100);
    fprintf(stream,
            "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">distance in linear RGB</text>\n",
            (LEFT + RIGHT) / 2, BOTTOM + 40);
}

void report_write_plot(FILE *stream, const char *title, const char *label,
                       const report_curve *curves, uint32_t ncurves) {
    double low = 0.1;
    report_tally all = report_errors_part(curves[0].errors, REPORT_ALL);
    while (low > 1e-6 && low * (double)all.npixels > 10)
        low /= 10;
    fprintf(stream,
            "<figure class=\"plot\"><figcaption>%s</figcaption><svg viewBox=\"0 0 %d %d\" "
            "role=\"img\" aria-label=\"%s\" font-size=\"12\" fill=\"currentColor\">\n",
            title, WIDTH, HEIGHT, label);
    write_axes(stream, low);
    for (uint32_t i = 0; i < ncurves; i++) /* the first is seen beneath others that lie on it */
        write_curve(stream, &curves[i], low, i + 1 < ncurves ? 4.5 - 3.0 * i / ncurves : 1.5);
    fputs("</svg><p class=\"key\">", stream);
    for (uint32_t i = 0; i < ncurves; i++)
        fprintf(stream,
                dashed(curves[i].color)
                    ? "<span><i style=\"background:repeating-linear-gradient(90deg,"
                      "var(--c%u) 0 4px,transparent 4px 7px)\"></i>%s</span>"
                    : "<span><i style=\"background:var(--c%u)\"></i>%s</span>",
                curves[i].color % PALETTE, curves[i].name);
    fputs("</p></figure>\n", stream);
}
