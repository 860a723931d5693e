/* Tables for papers, and those of the report as CSV. */
#include "compare/report/report_paper.h"

#include "command/output.h"
#include "compare/engine/report_advice.h"
#include "compare/report/report_files.h"

#include <math.h>
#include <string.h>

static void write_number(FILE *stream, double value, int digits, const char *otherwise) {
    if (isfinite(value))
        fprintf(stream, "%.*f", digits, value);
    else
        fputs(otherwise, stream);
}

/* A time of 3 or 4 digits. */
static int time_digits(double ms) {
    return ms < 10 ? 3 : ms < 100 ? 2 : 1;
}

/* What TeX takes for commands. */
static void write_tex(FILE *stream, const char *text) {
    for (; *text; text++) {
        if (strchr("#$%&_{}", *text))
            fputc('\\', stream);
        if (strchr("\\^~", *text))
            fputc(' ', stream);
        else
            fputc(*text, stream);
    }
}

void report_write_latex(FILE *stream, const report_data *report) {
    fputs("\\begin{tabular}{l", stream);
    for (uint32_t r = 0; r < 2 * report->nrates + 1; r++)
        fputc('r', stream);
    fprintf(stream, "}\n\\hline\n & \\multicolumn{%u}{c}{ms per frame}", report->nrates);
    fprintf(stream, " & \\multicolumn{%u}{c}{RMS error at seams, 1/255} & memory\\\\\nStrategy",
            report->nrates);
    for (uint32_t r = 0; r < 2 * report->nrates; r++)
        fprintf(stream, " & $%u\\times$", report->rates[r % report->nrates].samples);
    fputs(" & MB\\\\\n\\hline\n", stream);
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        const report_strategy *row = &report->strategies[k];
        write_tex(stream, row->strategy->name);
        for (uint32_t r = 0; r < report->nrates; r++) {
            fputs(" & ", stream);
            write_number(stream, row->rates[r].median_ms, time_digits(row->rates[r].median_ms),
                         "--");
        }
        for (uint32_t r = 0; r < report->nrates; r++) {
            fputs(" & ", stream);
            write_number(stream, 255 * report_seam_error(report, report->reference.first, r, k), 2,
                         "--");
        }
        fprintf(stream, " & %.1f\\\\\n", (double)row->stats.gpu_bytes / 1e6);
    }
    fputs("\\hline\n\\end{tabular}\n% ", stream);
    write_tex(stream, report->gl.renderer);
    fprintf(stream, ", %u x %u, %ux anisotropy, %u frames, medians\n", report->width,
            report->height, report->anisotropy, report->frames);
}

void report_write_markdown(FILE *stream, const report_data *report) {
    fputs("| strategy |", stream);
    for (uint32_t r = 0; r < report->nrates; r++)
        fprintf(stream, " ms, %ux |", report->rates[r].samples);
    for (uint32_t r = 0; r < report->nrates; r++)
        fprintf(stream, " error at seams, %ux |", report->rates[r].samples);
    fputs(" MB |\n|---|", stream);
    for (uint32_t r = 0; r < 2 * report->nrates + 1; r++)
        fputs("--:|", stream);
    fputc('\n', stream);
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        const report_strategy *row = &report->strategies[k];
        fprintf(stream, "| `%s` |", row->strategy->name);
        for (uint32_t r = 0; r < report->nrates; r++) {
            fputc(' ', stream);
            write_number(stream, row->rates[r].median_ms, time_digits(row->rates[r].median_ms), "");
            fputs(" |", stream);
        }
        for (uint32_t r = 0; r < report->nrates; r++) {
            fputc(' ', stream);
            write_number(stream, 255 * report_seam_error(report, report->reference.first, r, k), 2,
                         "");
            fputs(" |", stream);
        }
        fprintf(stream, " %.1f |\n", (double)row->stats.gpu_bytes / 1e6);
    }
}

void report_write_csv(FILE *stream, const report_data *report) {
    report_paper_strategies known = report_of_paper(report);
    uint32_t clamp = known.clamp, traverse = known.traverse, n = report->nstrategies;
    fputs("strategy,samples,pictures,median_ms,min_ms,max_ms,to_clamp,to_traverse,gpu_bytes,"
          "seam_rms,flicker_rms\n",
          stream);
    for (uint32_t k = 0; k < n; k++) {
        const report_strategy *row = &report->strategies[k];
        for (uint32_t r = 0; r < report->nrates; r++) {
            const report_cell *cell = &row->rates[r];
            fprintf(stream, "%s,%u,%u,%.6g,%.6g,%.6g,", row->strategy->name,
                    report->rates[r].samples, report->rates[r].frames, cell->median_ms,
                    cell->min_ms, cell->max_ms);
            if (clamp < n)
                write_number(stream, cell->median_ms / report->strategies[clamp].rates[r].median_ms,
                             4, "");
            fputc(',', stream);
            if (traverse < n)
                write_number(stream,
                             cell->median_ms / report->strategies[traverse].rates[r].median_ms, 4,
                             "");
            fprintf(stream, ",%llu,", (unsigned long long)row->stats.gpu_bytes);
            write_number(stream, report_seam_error(report, report->reference.first, r, k), 8, "");
            fputc(',', stream);
            write_number(stream, report_rms(&cell->flicker), 8, "");
            fputc('\n', stream);
        }
    }
}

static void write_field(FILE *stream, double value) {
    fputc(',', stream);
    write_number(stream, value, 8, "");
}

static void write_maps(FILE *stream, const report_data *report) {
    const report_maps *maps = &report->maps;
    fputs("map,median_ms,ratio,ratio_low,ratio_high,vertices,vertex_bytes,gpu_bytes,cut_edges,"
          "rms_inside,rms_edges,rms_end,apart\n",
          stream);
    for (uint32_t k = 0; k < maps->nrows; k++) {
        const report_map *row = &maps->rows[k];
        fprintf(stream, "%s,%.6g,%.4f,%.4f,%.4f,%u,%u,%llu,%u", row->name, row->median_ms,
                row->ratio.median, row->ratio.low, row->ratio.high, row->vertices,
                row->vertices * row->vertex_bytes, (unsigned long long)row->gpu_bytes, row->cut);
        for (int place = REPORT_PLACE_INSIDE; place < REPORT_PLACES; place++)
            write_field(stream, report_rms(&row->errors[place]));
        write_field(stream, row->strategy || !maps->referenced ? (double)NAN : row->apart);
        fputc('\n', stream);
    }
}

static void write_left(FILE *stream, const report_data *report) {
    fputs("distance", stream);
    for (uint32_t r = 0; r < report->nrates; r++)
        fprintf(stream, ",%ux", report->rates[r].samples);
    fputc('\n', stream);
    for (uint32_t i = 0; i < REPORT_ERROR_STEPS; i++) {
        fprintf(stream, "%.9g", report_error_step(i));
        for (uint32_t r = 0; r < report->nrates; r++)
            fprintf(stream, ",%.9g", report_share(&report->apart[r], i));
        fputc('\n', stream);
    }
}

static void write_right(FILE *stream, const report_data *report, report_source source) {
    fputs("distance", stream);
    for (uint32_t k = 0; k < report->nstrategies; k++)
        for (uint32_t r = 0; r < report->nrates; r++)
            fprintf(stream, ",%s %ux", report->strategies[k].strategy->name,
                    report->rates[r].samples);
    fputc('\n', stream);
    for (uint32_t i = 0; i < REPORT_ERROR_STEPS; i++) {
        fprintf(stream, "%.9g", report_error_step(i));
        for (uint32_t k = 0; k < report->nstrategies; k++)
            for (uint32_t r = 0; r < report->nrates; r++)
                fprintf(stream, ",%.9g",
                        report_share(&report->strategies[k].rates[r].errors[source], i));
        fputc('\n', stream);
    }
}

static void write_labels(FILE *stream, const report_data *report) {
    fputs("reference,strategy,samples,pixels_of,pixels,rms,max,share_over_1_255,share_over_4_255,"
          "share_over_16_255\n",
          stream);
    for (int s = 0; s < REPORT_SOURCES; s++) {
        for (uint32_t k = 0; report->reference.used[s] && k < report->nstrategies; k++) {
            for (uint32_t r = 0; r < report->nrates; r++) {
                for (int label = 0; label < REPORT_LABELS; label++) {
                    const report_tally *t = &report->strategies[k].rates[r].errors[s].labels[label];
                    double n = t->npixels ? (double)t->npixels : 1;
                    fprintf(stream, "%s,%s,%u,%s,%llu,", report_source_name((report_source)s),
                            report->strategies[k].strategy->name, report->rates[r].samples,
                            report_label_name((report_label)label), (unsigned long long)t->npixels);
                    write_number(stream, report_rms(t), 8, "");
                    fprintf(stream, ",%.9g,%.9g,%.9g,%.9g\n", t->max, (double)t->over[0] / n,
                            (double)t->over[1] / n, (double)t->over[2] / n);
                }
            }
        }
    }
}

static void write_blocks(FILE *stream, const report_data *report) {
    fputs("strategy,gpu_bytes,uncompressed_bytes,texel_bytes,psnr,reference_psnr,"
          "uncompressed_reference_psnr,texel_rms,texel_max,seam_max,seam_mean\n",
          stream);
    for (uint32_t k = 0; k < report->nstrategies; k++) {
        const report_strategy *row = &report->strategies[k];
        const report_blocks *blocks = &row->blocks;
        const double decibels[] = {blocks->psnr, blocks->reference_psnr,
                                   blocks->plain_reference_psnr};
        fprintf(stream, "%s,%llu,%llu,%llu,", row->strategy->name,
                (unsigned long long)blocks->stats.gpu_bytes,
                (unsigned long long)row->stats.gpu_bytes,
                (unsigned long long)row->stats.texel_bytes);
        for (int i = 0; i < 3; i++) {
            write_number(stream, decibels[i], 3, "");
            fputc(',', stream);
        }
        fprintf(stream, "%.6g,%.6g,", blocks->stats.block_rms, blocks->stats.block_max);
        if (blocks->seam.nedges)
            fprintf(stream, "%.6g,%.6g\n", (double)blocks->seam.max, (double)blocks->seam.mean);
        else
            fputs(",\n", stream);
    }
}

enum { TIMES, LATEX, MARKDOWN, LABELS, BLOCKS, MAPS, LEFT, RIGHT };

static slv_result write_table(const slv_env *env, const char *folder, const char *name,
                              const report_data *report, int what) {
    char path[1200];
    slv_output *file = NULL;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    slv_result result = slv_output_open(env, path, &file);
    if (result)
        return result;
    FILE *stream = slv_output_stream(file);
    if (what == TIMES)
        report_write_csv(stream, report);
    else if (what == LATEX)
        report_write_latex(stream, report);
    else if (what == MARKDOWN)
        report_write_markdown(stream, report);
    else if (what == LABELS)
        write_labels(stream, report);
    else if (what == BLOCKS)
        write_blocks(stream, report);
    else if (what == MAPS)
        write_maps(stream, report);
    else if (what == LEFT)
        write_left(stream, report);
    else
        write_right(stream, report, (report_source)(what - RIGHT));
    return slv_output_end(file, SLV_OK);
}

slv_result report_write_tables(const slv_env *env, const char *folder, const report_data *report) {
    slv_result result;
    if ((result = write_table(env, folder, "table1.csv", report, TIMES)) ||
        (result = write_table(env, folder, "table1.tex", report, LATEX)) ||
        (result = write_table(env, folder, "table1.md", report, MARKDOWN)))
        return result;
    if (report->compressed &&
        (result = write_table(env, folder, "compression.csv", report, BLOCKS)))
        return result;
    if (report->maps.image && (result = write_table(env, folder, "maps.csv", report, MAPS)))
        return result;
    if (report_of_paper(report).both)
        result = write_table(env, folder, "figure5_left.csv", report, LEFT);
    if (!result && report->reference.first < REPORT_SOURCES)
        result = write_table(env, folder, "errors.csv", report, LABELS);
    for (int s = 0; s < REPORT_SOURCES && !result; s++) {
        char name[64];
        snprintf(name, sizeof name, "figure5_right_%s.csv", report_source_name((report_source)s));
        if (report->reference.used[s])
            result = write_table(env, folder, name, report, RIGHT + s);
    }
    return result;
}
