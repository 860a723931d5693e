/* The sections of the page about the orbit: each writes nothing where there is nothing to say. */
#ifndef SELVAGE_TOOLS_REPORT_EXPERIMENT_H
#define SELVAGE_TOOLS_REPORT_EXPERIMENT_H

#include "compare/engine/report.h"

void report_write_rates(FILE *stream, const report_data *report);    /* Toth's Table 1 */
void report_write_curves(FILE *stream, const report_data *report);   /* his Figure 5 */
void report_write_errors(FILE *stream, const report_data *report);   /* by kind of pixel */
void report_write_cameras(FILE *stream, const report_data *report);  /* given beside the orbit */
void report_write_findings(FILE *stream, const report_data *report); /* his conclusions */
/* Textures in blocks against those that are not. */
void report_write_compressed(FILE *stream, const report_data *report);
slv_result report_write_papers(const slv_env *env, FILE *stream, const report_data *report);

#endif
