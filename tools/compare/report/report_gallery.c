/* The pictures of the page. */
#include "compare/report/report_page.h"

#include <math.h>
#include <stdlib.h>

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

slv_result page_image(const page *p, const slv_image *image) {
    const slv_image_params params = {.encoding = p->report->pictures, .bits = 8};
    void *bytes = NULL;
    size_t size = 0;
    slv_result result = slv_image_encode_png(p->env, image, &params, &bytes, &size);
    if (result)
        return result;
    fprintf(p->stream, " width=\"%u\" height=\"%u\" src=\"data:image/png;base64,", image->width,
            image->height);
    write_base64(p->stream, bytes, size);
    fputs("\"", p->stream);
    slv_free(bytes);
    return SLV_OK;
}

slv_result page_views(const page *p) {
    slv_result result = SLV_OK;
    for (uint32_t v = 0; v < p->report->nviews; v++) {
        if (page_has_reference(p)) {
            fprintf(p->stream,
                    "<img alt=\"View %u, the reference\" data-view=\"%u\" data-strategy=\"%u\"",
                    v + 1, v, p->report->nstrategies);
            result = page_image(p, &p->report->reference.views[v]);
            fputs(">\n", p->stream);
        }
        for (uint32_t i = 0; !result && i < p->report->nstrategies; i++) {
            fprintf(p->stream,
                    "<img alt=\"View %u, drawn with %s\" data-view=\"%u\" data-strategy=\"%u\"",
                    v + 1, page_strategy_name(p, i), v, i);
            result = page_image(p, &p->report->strategies[i].views[v]);
            fputs(">\n", p->stream);
        }
    }
    return result;
}

slv_result page_spots(const page *p) {
    const report_data *report = p->report;
    slv_result result = SLV_OK;
    if (!report->nspots) {
        fputs(
            "<p>There is no place in the views where the strategies' pictures differ by a visible "
            "amount.</p>\n",
            p->stream);
        return result;
    }
    fprintf(p->stream,
            "<p>%s, drawn again by a camera that looks at nothing else. Nothing was smoothed: each "
            "square is a pixel of that drawing.</p>\n",
            page_has_reference(p)
                ? "The places of all views where the worst strategy is further from "
                  "the reference than the best"
                : "The places of all views where the strategies disagree most");
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
                report->nstrategies + page_has_reference(p));
        if (page_has_reference(p)) {
            fprintf(p->stream, "<figure><img alt=\"Seam %u, enlarged, the reference\"", s + 1);
            result = page_image(p, &report->reference.spots[s]);
            fputs("><figcaption>reference</figcaption></figure>\n", p->stream);
        }
        for (uint32_t i = 0; !result && i < report->nstrategies; i++) {
            fprintf(p->stream, "<figure><img alt=\"Seam %u, enlarged, drawn with %s\"", s + 1,
                    page_strategy_name(p, i));
            result = page_image(p, &report->strategies[i].spots[s]);
            fprintf(p->stream, "><figcaption>%s</figcaption></figure>\n", page_strategy_name(p, i));
        }
        fputs("</div>\n</div>\n", p->stream);
    }
    return result;
}

static void write_legend(FILE *stream) {
    fputs(
        "<div class=\"legend\"><div class=\"legend-bar\" role=\"img\" aria-label=\"Scale: black is "
        "equal, then blue, red and yellow, white is a difference of 16/255 and more\"></div>"
        "<div class=\"legend-ticks\" aria-hidden=\"true\"><span>equal</span>"
        "<span style=\"--i:2\">4/255</span><span style=\"--i:3\">8/255</span>"
        "<span style=\"--i:4\">12/255</span><span>16/255</span></div></div>\n",
        stream);
}

static slv_result write_heats(const page *p) {
    const report_data *report = p->report;
    slv_result result = SLV_OK;
    fputs("<h3>From the reference</h3>\n<div class=\"pairs\">\n", p->stream);
    for (uint32_t i = 0; !result && i < report->nstrategies; i++) {
        const char *name = page_strategy_name(p, i);
        fprintf(p->stream, "<figure><img alt=\"Map of the distance of %s from the reference\"",
                name);
        result = page_image(p, &report->strategies[i].heat);
        fprintf(p->stream, ">\n<figcaption>%s</figcaption></figure>\n", name);
    }
    fputs("</div>\n<h3>From each other</h3>\n", p->stream);
    return result;
}

static void write_pair_row(const page *p, const report_pair *pair) {
    fprintf(p->stream, "<tr><th scope=\"row\">%s and %s</th><td>", page_strategy_name(p, pair->a),
            page_strategy_name(p, pair->b));
    report_write_jump(p->stream, pair->max);
    fputs("</td><td>", p->stream);
    report_write_jump(p->stream, pair->mean);
    if (isfinite(pair->psnr))
        fprintf(p->stream, "</td><td>%.1f dB", pair->psnr);
    else
        fputs("</td><td>identical", p->stream);
    fprintf(p->stream, "</td><td>%.2f %%</td><td>%.2f %%</td></tr>\n", pair->over_1 * 100,
            pair->over_4 * 100);
}

slv_result page_pairs(const page *p) {
    const report_data *report = p->report;
    slv_result result = SLV_OK;
    if (!report->npairs && !page_has_reference(p)) {
        fputs("<p>One strategy alone has nothing to be compared with.</p>\n", p->stream);
        return result;
    }
    fputs("<p>Each map shows the first view: how far two pictures' pixels are apart in their most "
          "different channel, in linear light.</p>\n",
          p->stream);
    write_legend(p->stream);
    if (page_has_reference(p))
        result = write_heats(p);
    fputs("<div class=\"pairs\">\n", p->stream);
    for (uint32_t i = 0; !result && i < report->npairs; i++) {
        const report_pair *pair = &report->pairs[i];
        const char *a = page_strategy_name(p, pair->a), *b = page_strategy_name(p, pair->b);
        fprintf(p->stream, "<figure><img alt=\"Map of the differences between %s and %s\"", a, b);
        result = page_image(p, &pair->heat);
        fprintf(p->stream, ">\n<figcaption>%s and %s</figcaption></figure>\n", a, b);
    }
    fprintf(p->stream,
            "</div>\n<p class=\"caption\" id=\"pairs-what\">Over all %u views, where the surface "
            "covers the whole pixel.</p>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" "
            "aria-labelledby=\"differences\">\n<table aria-labelledby=\"differences\" "
            "aria-describedby=\"pairs-what\">\n<thead>\n<tr><th scope=\"col\" "
            "rowspan=\"2\">Strategies</th><th scope=\"colgroup\" colspan=\"2\">Difference, "
            "1/255</th><th scope=\"col\" rowspan=\"2\">PSNR</th><th scope=\"colgroup\" "
            "colspan=\"2\">Pixels further apart than</th></tr>\n<tr><th scope=\"col\">largest</th>"
            "<th scope=\"col\">mean</th><th scope=\"col\">1/255</th><th "
            "scope=\"col\">4/255</th></tr>\n</thead>\n<tbody>\n",
            report->nviews);
    for (uint32_t i = 0; i < report->npairs; i++)
        write_pair_row(p, &report->pairs[i]);
    fputs("</tbody>\n</table>\n</div>\n", p->stream);
    return result;
}
