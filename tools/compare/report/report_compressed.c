/* The section of the page about textures in blocks. */
#include "compare/report/report_experiment.h"
#include "compare/report/report_words.h"

#include <math.h>

static void write_decibels(FILE *stream, double psnr) {
    if (isfinite(psnr))
        fprintf(stream, "<td>%.1f</td>", psnr);
    else
        fprintf(stream, "<td class=\"quiet\">%s</td>", isnan(psnr) ? "none" : "equal");
}

static void write_jump(FILE *stream, const slv_gl_seam *seam, float jump) {
    if (!seam->nedges) {
        fputs("<td class=\"quiet\">none</td>", stream);
        return;
    }
    fputs("<td>", stream);
    report_write_jump(stream, (double)jump);
    fputs("</td>", stream);
}

void report_write_compressed(FILE *stream, const report_data *report) {
    bool reference = report->reference.first < REPORT_SOURCES;
    if (!report->compressed)
        return;
    fputs("<section aria-labelledby=\"blocks\">\n<h2 id=\"blocks\">Compressed in blocks</h2>\n"
          "<p class=\"caption\" id=\"blocks-what\">The same views from textures that the GPU keeps "
          "as blocks of 4 &times; 4 texels (BC1 and its kin). <em>PSNR</em> is in dB, of linear "
          "RGB, over all pixels that the surface covers in full; more is better. The error of "
          "texels is what the encoder loses, of all that a strategy stores.</p>\n"
          "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-labelledby=\"blocks\">\n"
          "<table class=\"many\" aria-labelledby=\"blocks\" "
          "aria-describedby=\"blocks-what\">\n<thead>\n<tr>"
          "<th scope=\"col\" rowspan=\"2\">Strategy</th><th scope=\"colgroup\" colspan=\"3\">GPU "
          "memory</th>",
          stream);
    fprintf(stream, "<th scope=\"colgroup\" colspan=\"%d\">PSNR, dB</th>", reference ? 3 : 1);
    fputs("<th scope=\"colgroup\" colspan=\"2\">Error of texels</th><th scope=\"colgroup\" "
          "colspan=\"2\">Seam jump, magnified, 1/255</th></tr>\n<tr><th scope=\"col\">MB</th><th "
          "scope=\"col\">ratio to texels</th><th scope=\"col\">ratio to uncompressed</th><th "
          "scope=\"col\">from uncompressed</th>",
          stream);
    if (reference)
        fputs("<th scope=\"col\">from the reference</th><th scope=\"col\">uncompressed</th>",
              stream);
    fputs("<th scope=\"col\">RMS</th><th scope=\"col\">largest</th><th scope=\"col\">largest</th>"
          "<th scope=\"col\">mean</th></tr>\n</thead>\n<tbody>\n",
          stream);
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        const report_strategy *row = &report->strategies[k];
        const report_blocks *blocks = &row->blocks;
        double bytes = (double)blocks->stats.gpu_bytes;
        fprintf(stream, "<tr><th scope=\"row\">%s</th><td>%.2f</td><td>%.2f</td><td>%.2f</td>",
                row->strategy->name, bytes / 1e6, bytes / (double)row->stats.texel_bytes,
                bytes / (double)row->stats.gpu_bytes);
        write_decibels(stream, blocks->psnr);
        if (reference) {
            write_decibels(stream, blocks->reference_psnr);
            write_decibels(stream, blocks->plain_reference_psnr);
        }
        fprintf(stream, "<td>%.4f</td><td>%.3f</td>", blocks->stats.block_rms,
                blocks->stats.block_max);
        write_jump(stream, &blocks->seam, blocks->seam.max);
        write_jump(stream, &blocks->seam, blocks->seam.mean);
        fputs("</tr>\n", stream);
    }
    fputs("</tbody>\n</table>\n</div>\n</section>\n", stream);
}
