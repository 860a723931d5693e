/* A pattern with its defaults filled in, so that a batch resolves them once. */
#ifndef SLV_BAKE_PATTERN_H
#define SLV_BAKE_PATTERN_H

#include <selvage/bake.h>

slv_procedural slvi_pattern_resolve(const slv_procedural *pattern);

/* slv_procedural_evaluate of a resolved pattern. */
void slvi_pattern_evaluate(const slv_procedural *resolved, int32_t face, const float position[3],
                           float rgba[4]);

/* Of stripes, noise and cubes the value alone, 0..1, at points whose coordinates are in three
 * arrays.
 */
void slvi_pattern_values(const slv_procedural *resolved, size_t count, float *const at[3],
                         float *out);
/* The colour of a value; `p` is the position as it enters the pattern. */
void slvi_pattern_color(const slv_procedural *resolved, int32_t face, const float p[3], float value,
                        float rgba[4]);

#endif
