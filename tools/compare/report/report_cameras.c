/* The section of the page about cameras that were given. */
#include "compare/report/report_experiment.h"

#include "command/output.h"
#include "compare/report/report_words.h"

#include <math.h>

static void write_error(FILE *stream, const report_errors *errors, unsigned labels) {
    report_tally tally = report_errors_part(errors, labels);
    if (!tally.npixels) {
        fputs("<td class=\"quiet\">none</td>", stream);
        return;
    }
    fputs("<td>", stream);
    report_write_jump(stream, report_rms(&tally));
    fputs("</td>", stream);
}

static void write_camera(FILE *stream, const report_data *report, const report_camera *camera) {
    bool errors = report->reference.first < REPORT_SOURCES;
    fputs("<h3>", stream);
    output_html(stream, camera->path);
    fputs("</h3>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" "
          "aria-labelledby=\"cameras\">\n<table aria-labelledby=\"cameras\">\n<thead>\n<tr><th "
          "scope=\"col\">Strategy</th><th scope=\"col\">ms</th><th scope=\"col\">ratio</th>",
          stream);
    if (errors)
        fputs("<th scope=\"col\">error inside</th><th scope=\"col\">at seams</th><th "
              "scope=\"col\">all pixels</th>",
              stream);
    fputs("</tr>\n</thead>\n<tbody>\n", stream);
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        fprintf(stream, "<tr><th scope=\"row\">%s</th><td>%.2f</td><td>%.2f</td>",
                report->strategies[k].strategy->name, camera->ms[k], camera->ratio[k]);
        if (errors) {
            write_error(stream, &camera->errors[k], 1 << REPORT_INTERIOR);
            write_error(stream, &camera->errors[k], REPORT_SEAMS);
            write_error(stream, &camera->errors[k], REPORT_ALL);
        }
        fputs("</tr>\n", stream);
    }
    fputs("</tbody>\n</table>\n</div>\n", stream);
}

void report_write_cameras(FILE *stream, const report_data *report) {
    if (!report->ncameras)
        return;
    fprintf(stream,
            "<section aria-labelledby=\"cameras\">\n<h2 id=\"cameras\">At the given views</h2>\n<p "
            "class=\"caption\">One frame each, at %u sample%s per pixel; errors are RMS, in "
            "1/255.</p>\n",
            report->rates[report->shown].samples,
            report->rates[report->shown].samples == 1 ? "" : "s");
    for (uint32_t c = 0; c < report->ncameras; c++)
        write_camera(stream, report, &report->cameras[c]);
    fputs("</section>\n", stream);
}
