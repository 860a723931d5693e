/* The section of the page about maps by texture coordinates beside per-face textures. */
#include "compare/report/report_maps.h"

#include "command/output.h"
#include <math.h>

static double rms_of(const report_map *row, report_place place) {
    return report_rms(&row->errors[place]);
}

static void write_error(FILE *stream, double rms) {
    if (!isfinite(rms)) {
        fputs("<td class=\"quiet\">none</td>", stream);
        return;
    }
    fputs("<td>", stream);
    report_write_jump(stream, rms);
    fputs("</td>", stream);
}

static void write_row(FILE *stream, const report_maps *maps, const report_map *row) {
    double megabytes = (double)row->gpu_bytes / 1e6,
           kilobytes = (double)row->vertices * row->vertex_bytes / 1e3;
    fprintf(stream, "<tr><th scope=\"row\">%s", row->name);
    if (row->title)
        fprintf(stream, "<small>%s</small>", row->title);
    fprintf(stream,
            "</th><td>%.2f</td><td>%.2f<small>%.2f to %.2f</small></td><td>%u</td><td>%.*f</td><td>"
            "%.*f</td><td>%u</td>",
            row->median_ms, row->ratio.median, row->ratio.low, row->ratio.high, row->vertices,
            kilobytes < 100 ? 1 : 0, kilobytes, megabytes < 10 ? 2 : 1, megabytes, row->cut);
    for (int place = REPORT_PLACE_INSIDE; place < REPORT_PLACES && maps->referenced; place++)
        write_error(stream, rms_of(row, (report_place)place));
    if (maps->referenced && row->strategy)
        fputs("<td class=\"quiet\">&ndash;</td>", stream);
    else if (maps->referenced)
        write_error(stream, row->apart);
    fputs("</tr>\n", stream);
}

static void write_caption(FILE *stream, const report_data *report) {
    const report_maps *maps = &report->maps;
    fprintf(stream, "<section aria-labelledby=\"maps\">\n<h2 id=\"maps\">Beside maps by texture "
                    "coordinates</h2>\n<p class=\"caption\" id=\"maps-what\">");
    output_html(stream, maps->image);
    fprintf(stream,
            " drawn through the mesh's texture coordinates by the same renderer, in turn with the "
            "per-face textures: %u frame%s of the orbit at %u sample%s per pixel. These rows are "
            "other maps, no strategies: what is advised above is among strategies alone.",
            maps->frames, maps->frames == 1 ? "" : "s", report->rates[report->shown].samples,
            report->rates[report->shown].samples == 1 ? "" : "s");
    if (maps->referenced)
        fprintf(stream,
                " All rows are held against one reference, rays (%u per pixel) that look up the "
                "image itself: so the errors of per-face textures have in them what was lost when "
                "they were baked, which the errors above, against rays at the per-face texture, "
                "leave out.",
                maps->samples);
    fputs("</p>\n", stream);
}

static void write_notes(FILE *stream, const report_maps *maps) {
    fprintf(stream,
            "<dl class=\"notes\">\n<div><dt>ratio</dt><dd>A frame's time divided by that of %s in "
            "the same frame.</dd></div>\n<div><dt>vertices</dt><dd>Of the control mesh, as often "
            "as they have to be stored: once for each position and coordinates that differ. "
            "Per-face textures need no coordinates. The kilobytes are of positions, normals and "
            "coordinates in floats, 32 bytes, or 24 without coordinates.</dd></div>\n<div><dt>MB"
            "</dt><dd>Texels on the GPU with all levels, and what a strategy keeps "
            "besides.</dd></div>\n<div><dt>cut edges</dt><dd>Edges between faces at which a lookup "
            "has to go on elsewhere: where the coordinates of a map end, and with per-face "
            "textures every one.</dd></div>\n",
            maps->rows[maps->baseline].name);
    if (maps->referenced)
        fprintf(stream,
                "<div><dt>errors</dt><dd>RMS, 1/255. <em>Inside</em> are pixels whose lookup "
                "reaches one face alone, at <em>edges</em> faces meet and the map goes on, at its "
                "<em>end</em> it is cut, or goes over its end within a face (%u face%s).</dd></div>"
                "\n<div><dt>from %s</dt><dd>How far any pixel is from that row's picture, "
                "1/255.</dd></div>\n",
                maps->over_end, maps->over_end == 1 ? "" : "s", maps->rows[maps->baseline].name);
    fputs("</dl>\n", stream);
}

static void write_table(FILE *stream, const report_maps *maps) {
    static const char *const titles[REPORT_PLACES] = {"", "inside", "at edges", "at the end"};
    fputs("<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"maps\">\n<table "
          "aria-labelledby=\"maps\" aria-describedby=\"maps-what\">\n<thead>\n<tr><th "
          "scope=\"col\">Map</th><th scope=\"col\">median ms</th><th scope=\"col\">ratio</th><th "
          "scope=\"col\">vertices</th><th scope=\"col\">kB</th><th scope=\"col\">MB</th><th "
          "scope=\"col\">cut edges</th>",
          stream);
    uint64_t all = 0;
    for (int place = 0; place < REPORT_PLACES; place++)
        all += maps->npixels[place];
    for (int place = REPORT_PLACE_INSIDE; place < REPORT_PLACES && maps->referenced; place++)
        fprintf(stream, "<th scope=\"col\">%s<small>%.3g %%</small></th>", titles[place],
                100 * (double)maps->npixels[place] / (double)all);
    if (maps->referenced)
        fprintf(stream, "<th scope=\"col\">from %s</th>", maps->rows[maps->baseline].name);
    fputs("</tr>\n</thead>\n<tbody>\n", stream);
    for (uint32_t k = 0; k < maps->nrows; k++)
        write_row(stream, maps, &maps->rows[k]);
    fputs("</tbody>\n</table>\n</div>\n", stream);
}

static slv_result write_figure(const page *p, const char *name, const char *what,
                               const slv_image *image) {
    fprintf(p->stream, "<figure><img alt=\"%s, %s\"", name, what);
    slv_result result = page_image(p, image);
    fprintf(p->stream, ">\n<figcaption>%s</figcaption></figure>\n", name);
    return result;
}

static slv_result write_pictures(const page *p, bool close) {
    const report_maps *maps = &p->report->maps;
    const char *what = close ? "enlarged" : "whole";
    slv_result result = SLV_OK;
    fputs("<div class=\"pairs\">\n", p->stream);
    if (maps->referenced)
        result = write_figure(p, "reference", what, close ? &maps->close_up : &maps->view);
    for (uint32_t k = 0; k < maps->nrows && !result; k++) {
        const report_map *row = &maps->rows[k];
        result = write_figure(p, row->name, what, close ? &row->spot : &row->view);
    }
    fputs("</div>\n", p->stream);
    return result;
}

slv_result report_write_maps(const page *p) {
    const report_maps *maps = &p->report->maps;
    if (!maps->image)
        return SLV_OK;
    write_caption(p->stream, p->report);
    write_table(p->stream, maps);
    write_notes(p->stream, maps);
    slv_result result = SLV_OK;
    if (maps->referenced) {
        fprintf(p->stream,
                "<h3>Where they differ most</h3>\n<p class=\"caption\">%.0f %% from the left and "
                "%.0f %% from the top of the pictures below, enlarged %g times.</p>\n",
                100 * (double)maps->spot.x, 100 * (double)maps->spot.y, (double)maps->spot.zoom);
        result = write_pictures(p, true);
    }
    if (!result)
        result = write_pictures(p, false);
    fputs("</section>\n", p->stream);
    return result;
}
