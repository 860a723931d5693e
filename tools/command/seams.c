/* Seam certificates in words and as JSON. */
#include "command/seams.h"
#include "command/output.h"

#include <stdio.h>

void seams_print(const char *when, const slv_seam_certificate *c) {
    printf("  seams %s: at most %.4g apart (%.3g/255), %.3g in the mean", when, c->largest,
           255 * c->largest, c->mean);
    if (c->face >= 0)
        printf("; the most at face %d edge %u, %.3f along it", (int)c->face, c->edge, (double)c->t);
    printf(", %llu places\n", (unsigned long long)c->places);
}

json_t *seams_json(const slv_seam_certificate *c) {
    return json_pack("{s:o, s:o, s:I, s:I, s:i}", "largest", output_json_number(c->largest), "mean",
                     output_json_number(c->mean), "places", (json_int_t)c->places, "face",
                     (json_int_t)c->face, "edge", c->edge);
}
