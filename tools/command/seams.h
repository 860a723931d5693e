/* What verbs say of seam certificates. */
#ifndef SELVAGE_TOOLS_SEAMS_H
#define SELVAGE_TOOLS_SEAMS_H

#include <selvage/canvas.h>

#include <jansson.h>

/* A line: "  seams WHEN: at most ...". */
void seams_print(const char *when, const slv_seam_certificate *certificate);
json_t *seams_json(const slv_seam_certificate *certificate);

#endif
