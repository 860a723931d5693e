/* How the error of a reference falls with its samples: a table and a plot. */
#include "reference/convergence.h"
#include "command/output.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

convergence convergence_begin(uint32_t samples) {
    convergence c = {.count = 0};
    for (uint32_t n = 1; n < samples; n *= 4)
        c.rows[c.count++] = (convergence_row){.samples = n, .estimate = NAN, .measured = NAN};
    c.rows[c.count++] = (convergence_row){.samples = samples, .estimate = NAN, .measured = NAN};
    return c;
}

double convergence_distance(const slv_image *a, const slv_image *b) {
    size_t npixels = (size_t)a->width * a->height;
    double squares = 0;
    for (size_t i = 0; i < npixels; i++) {
        for (size_t c = 0; c < 3; c++) {
            double one = (double)a->pixels[4 * i + c] - (double)b->pixels[4 * i + c];
            squares += one * one;
        }
    }
    return sqrt(squares / (3 * (double)npixels));
}

double convergence_order(const convergence *c) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (uint32_t i = 0; i < c->count; i++) {
        if (!(c->rows[i].estimate > 0))
            continue;
        double a = log((double)c->rows[i].samples), b = log(c->rows[i].estimate);
        n++;
        x += a;
        y += b;
        xx += a * a;
        xy += a * b;
    }
    return n < 2 ? NAN : -(n * xy - x * y) / (n * xx - x * x);
}

static slv_result write_csv(const slv_env *env, const char *path, const convergence *c) {
    slv_output *file = NULL;
    slv_result result = slv_output_open(env, path, &file);
    if (result)
        return result;
    FILE *stream = slv_output_stream(file);
    fputs("samples,seconds,estimated_rms,measured_rms\n", stream);
    for (uint32_t i = 0; i < c->count; i++) {
        const convergence_row *row = &c->rows[i];
        fprintf(stream, "%u,%.4f,", row->samples, row->seconds);
        if (!isnan(row->estimate))
            fprintf(stream, "%.9g", row->estimate);
        fputc(',', stream);
        if (!isnan(row->measured))
            fprintf(stream, "%.9g", row->measured);
        fputc('\n', stream);
    }
    return slv_output_end(file, SLV_OK);
}

enum { WIDTH = 640, HEIGHT = 420, LEFT = 70, RIGHT = 620, TOP = 20, BOTTOM = 370 };

/* Both axes are logarithmic: samples in powers of four, errors in powers of ten. */
typedef struct plot {
    FILE *stream;
    double most_samples, low, high;
} plot;

static double plot_x(const plot *p, double samples) {
    return LEFT + (RIGHT - LEFT) * log(samples) / log(p->most_samples);
}

static double plot_y(const plot *p, double error) {
    return BOTTOM - (BOTTOM - TOP) * log(error / p->low) / log(p->high / p->low);
}

static bool in_plot(const plot *p, double error) {
    return error >= p->low && error <= p->high;
}

static void write_axes(const plot *p) {
    fprintf(p->stream,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" "
            "height=\"%d\" font-family=\"sans-serif\" font-size=\"12\" fill=\"#333\">\n"
            "<title>Error of the reference by samples per pixel</title>\n"
            "<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n",
            WIDTH, HEIGHT, WIDTH, HEIGHT, WIDTH, HEIGHT);
    for (double n = 1; n <= p->most_samples; n *= 4)
        fprintf(p->stream,
                "<path d=\"M%.1f %dV%d\" stroke=\"#ddd\"/><text x=\"%.1f\" y=\"%d\" "
                "text-anchor=\"middle\">%.0f</text>\n",
                plot_x(p, n), TOP, BOTTOM, plot_x(p, n), BOTTOM + 18, n);
    for (double e = p->low; e <= p->high * 1.001; e *= 10)
        fprintf(p->stream,
                "<path d=\"M%d %.1fH%d\" stroke=\"#ddd\"/><text x=\"%d\" y=\"%.1f\" "
                "text-anchor=\"end\">%.0e</text>\n",
                LEFT, plot_y(p, e), RIGHT, LEFT - 8, plot_y(p, e) + 4, e);
    fprintf(p->stream,
            "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">samples per pixel</text>\n"
            "<text transform=\"translate(16 %d) rotate(-90)\" text-anchor=\"middle\">RMS error, "
            "linear, 1 is full scale</text>\n",
            (LEFT + RIGHT) / 2, BOTTOM + 40, (TOP + BOTTOM) / 2);
}

/* A dashed line that falls as samples^-order from the first point of the estimates. */
static void write_guide(const plot *p, const convergence *c, double order, const char *name) {
    const convergence_row *first = c->count > 1 ? &c->rows[1] : &c->rows[0];
    double from = (double)first->samples, to = p->most_samples, error = first->estimate;
    if (!(error > 0))
        return;
    double least = from * pow(error / p->low, 1 / order);
    to = to < least ? to : least;
    double end = error * pow(to / from, -order);
    fprintf(p->stream,
            "<path d=\"M%.1f %.1fL%.1f %.1f\" stroke=\"#999\" stroke-dasharray=\"5 4\"/>"
            "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\" fill=\"#777\">%s</text>\n",
            plot_x(p, from), plot_y(p, error), plot_x(p, to), plot_y(p, end), plot_x(p, to) - 4,
            plot_y(p, end) - 14, name);
}

static void write_series(const plot *p, const convergence *c, bool measured, const char *color,
                         const char *name) {
    bool any = false;
    fputs("<path d=\"", p->stream);
    for (uint32_t i = 0; i < c->count; i++) {
        double error = measured ? c->rows[i].measured : c->rows[i].estimate;
        if (!in_plot(p, error))
            continue;
        fprintf(p->stream, "%c%.1f %.1f", any ? 'L' : 'M', plot_x(p, c->rows[i].samples),
                plot_y(p, error));
        any = true;
    }
    fprintf(p->stream, "%s\" fill=\"none\" stroke=\"%s\" stroke-width=\"2\"/>\n", any ? "" : "M0 0",
            color);
    for (uint32_t i = 0; i < c->count; i++) {
        double error = measured ? c->rows[i].measured : c->rows[i].estimate;
        if (in_plot(p, error))
            fprintf(p->stream,
                    "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3.5\" fill=\"%s\"><title>%u samples: "
                    "%.3g</title></circle>\n",
                    plot_x(p, c->rows[i].samples), plot_y(p, error), color, c->rows[i].samples,
                    error);
    }
    int y = TOP + (measured ? 36 : 18);
    fprintf(
        p->stream,
        "<circle cx=\"%d\" cy=\"%d\" r=\"3.5\" fill=\"%s\"/><text x=\"%d\" y=\"%d\">%s</text>\n",
        RIGHT - 236, y - 4, color, RIGHT - 226, y, name);
}

static slv_result write_svg(const slv_env *env, const char *path, const convergence *c) {
    slv_output *file = NULL;
    double low = INFINITY, high = 0;
    slv_result result = slv_output_open(env, path, &file);
    if (result)
        return result;
    FILE *stream = slv_output_stream(file);
    for (uint32_t i = 0; i < c->count; i++) {
        const double errors[2] = {c->rows[i].estimate, c->rows[i].measured};
        for (int k = 0; k < 2; k++) {
            low = errors[k] > 0 ? fmin(low, errors[k]) : low;
            high = errors[k] > 0 ? fmax(high, errors[k]) : high;
        }
    }
    plot p = {stream, fmax(c->rows[c->count - 1].samples, 4), 1e-6, 1};
    if (high > 0) {
        p.low = pow(10, floor(log10(low)));
        p.high = pow(10, floor(log10(high)) + 1);
    }
    write_axes(&p);
    write_guide(&p, c, 0.5, "1/\xe2\x88\x9aN");
    write_guide(&p, c, 1, "1/N");
    write_series(&p, c, false, "#0a5fb4", "estimated from two halves");
    write_series(&p, c, true, "#c4450c", "measured against the last picture");
    fputs("</svg>\n", stream);
    return slv_output_end(file, SLV_OK);
}

slv_result convergence_write(const slv_env *env, const char *folder, const convergence *c) {
    char path[1100];
    snprintf(path, sizeof path, "%s/convergence.csv", folder);
    slv_result result = write_csv(env, path, c);
    snprintf(path, sizeof path, "%s/convergence.svg", folder);
    return result ? result : write_svg(env, path, c);
}
