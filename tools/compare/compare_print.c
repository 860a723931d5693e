/* The outcome of a comparison as tables on a terminal. */
#include "compare/compare.h"

#include "compare/report/report_words.h"

#include <math.h>
#include <stdio.h>

/* Right-aligned, behind a space; values of large floats would not fit as they are. */
static void print_number(int width, int decimals, double value) {
    if (isnan(value))
        printf(" %*s", width, "none");
    else if (fabs(value) < 1e6)
        printf(" %*.*f", width, decimals, value);
    else
        printf(" %*.4g", width, value);
}

static void print_jumps(const slv_gl_seam *seam) {
    print_number(12, 5, seam->nedges ? (double)seam->max : NAN);
    print_number(12, 6, seam->nedges ? (double)seam->mean : NAN);
    putchar('\n');
}

static void print_rates(const report_data *report) {
    printf("%-14s", "frame ms");
    for (uint32_t r = 0; r < report->nrates; r++)
        printf(" %9ux", report->rates[r].samples);
    putchar('\n');
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        printf("%-14s", report->strategies[k].strategy->name);
        for (uint32_t r = 0; r < report->nrates; r++)
            printf(" %10.2f", report->strategies[k].rates[r].median_ms);
        putchar('\n');
    }
    for (uint32_t r = 0; r < report->nrates; r++)
        if (report->rates[r].frames > 1)
            printf("(%ux is %u pictures of %ux, averaged)\n", report->rates[r].samples,
                   report->rates[r].frames, report->rates[r].msaa);
    if (report->left_out[0])
        printf("(left out: %s samples per pixel)\n", report->left_out);
    putchar('\n');
}

static void print_errors(const report_data *report) {
    const report_reference *ref = &report->reference;
    if (ref->first == REPORT_SOURCES)
        return;
    printf("\n%-14s %10s %10s %10s %10s %10s\n", "RMS error", "interior", "edge", "regular",
           "other", "all pixels");
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        const report_errors *errors =
            &report->strategies[k].rates[report->shown].errors[ref->first];
        report_tally all = report_errors_part(errors, REPORT_ALL);
        printf("%-14s", report->strategies[k].strategy->name);
        for (int label = REPORT_INTERIOR; label < REPORT_LABELS; label++)
            print_number(10, 6, report_rms(&errors->labels[label]));
        print_number(10, 6, report_rms(&all));
        putchar('\n');
    }
    printf("(%ux MSAA against the reference '%s', of %u frame%s)\n",
           report->rates[report->shown].samples, report_source_name(ref->first), ref->frames,
           ref->frames == 1 ? "" : "s");
}

static void print_compressed(const report_data *report) {
    bool reference = report->reference.first < REPORT_SOURCES;
    if (!report->compressed)
        return;
    printf("\n%-14s %10s %10s %10s %12s %12s\n", "in blocks", "GPU MB", "PSNR",
           reference ? "reference" : "", "max jump", "mean jump");
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        const report_strategy *row = &report->strategies[k];
        const report_blocks *blocks = &row->blocks;
        printf("%-14s %10.1f", row->strategy->name, (double)blocks->stats.gpu_bytes / 1e6);
        print_number(10, 2, blocks->psnr);
        if (reference)
            print_number(10, 2, blocks->reference_psnr);
        else
            printf(" %10s", "");
        print_jumps(&blocks->seam);
    }
    printf("(dB from the pictures of the uncompressed texture%s)\n",
           reference ? ", and from the reference" : "");
}

/* The answer; those that do as well stand behind it. */
static void print_advice(const report_data *report, const report_advice *advice, const char *what) {
    if (!advice->measured)
        return;
    printf("%s: %s", what, report->strategies[advice->take].strategy->name);
    if (advice->ntied > 1) {
        fputs(" (tied with ", stdout);
        report_write_tied(stdout, report, advice);
        putchar(')');
    }
    putchar('\n');
}

static void print_times(const report_data *report) {
    printf("%-14s %10s %6s %13s %10s %12s %12s\n", "strategy", "frame ms", "ratio", "from - to",
           "GPU MB", "max jump", "mean jump");
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        const report_strategy *row = &report->strategies[k];
        printf("%-14s %10.2f %6.2f %6.2f -%5.2f %10.1f", row->strategy->name, row->median_ms,
               row->ratio.median, row->ratio.low, row->ratio.high,
               (double)row->stats.gpu_bytes / 1e6);
        print_jumps(&row->seams[0]);
    }
    printf("(%s; %u frame%s of %u x %u, %ux MSAA, %ux anisotropy%s; ratios to %s, from - to with "
           "%.0f %% certainty; jumps of magnified lookups, full scale is 1)\n",
           report->gl.renderer, report->frames, report->frames == 1 ? "" : "s", report->width,
           report->height, report->rates[report->shown].samples, report->anisotropy,
           report->even_levels ? ", even levels" : "",
           report->strategies[report_baseline(report)].strategy->name,
           100 * interval_coverage(report->frames));
}

/* Maps by texture coordinates, which are no strategies. */
static void print_maps(const report_data *report) {
    const report_maps *maps = &report->maps;
    if (!maps->image)
        return;
    printf("\n%-14s %10s %6s %13s %8s %8s %8s %6s", "beside maps", "frame ms", "ratio", "from - to",
           "vertices", "kB", "GPU MB", "cut");
    printf(maps->referenced ? " %10s %10s %10s %10s\n" : "\n", "inside", "edges", "end", "apart");
    for (uint32_t k = 0; k < maps->nrows; k++) {
        const report_map *row = &maps->rows[k];
        printf("%-14s %10.2f %6.2f %6.2f -%5.2f %8u %8.1f %8.2f %6u", row->name, row->median_ms,
               row->ratio.median, row->ratio.low, row->ratio.high, row->vertices,
               (double)row->vertices * row->vertex_bytes / 1e3, (double)row->gpu_bytes / 1e6,
               row->cut);
        for (int place = REPORT_PLACE_INSIDE; place < REPORT_PLACES && maps->referenced; place++)
            print_number(10, 6, report_rms(&row->errors[place]));
        if (maps->referenced)
            print_number(10, 6, row->strategy ? (double)NAN : row->apart);
        putchar('\n');
    }
    printf("(%s by texture coordinates and per-face textures, ratios to %s", maps->image,
           maps->rows[maps->baseline].name);
    if (maps->referenced)
        printf(
            "; RMS errors against rays at the image, where one face is seen, faces meet, and the "
            "map ends; apart: the furthest pixel from %s",
            maps->rows[maps->baseline].name);
    puts(")");
}

void compare_print(const report_data *report, const char *folder) {
    if (report->nrates > 1 || report->left_out[0])
        print_rates(report);
    print_times(report);
    print_errors(report);
    print_compressed(report);
    print_maps(report);
    report_advice advice = report_advise(report), cameras = report_advise_cameras(report);
    print_advice(report, &advice, "for this orbit");
    print_advice(report, &cameras, "for the given views");
    printf("report: %s/report.html\n", folder);
}
