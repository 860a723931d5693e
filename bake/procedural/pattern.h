/* A pattern with its defaults filled in, so that a batch resolves them once. */
#ifndef SLV_BAKE_PATTERN_H
#define SLV_BAKE_PATTERN_H

#include <selvage/bake.h>

slv_procedural slvi_pattern_resolve(const slv_procedural *pattern);

/* slv_procedural_evaluate of a resolved pattern. */
void slvi_pattern_evaluate(const slv_procedural *resolved, int32_t face, const float position[3],
                           float rgba[4]);

#endif
