/* Brushes: round ones, and those of MyPaint. */
#ifndef SELVAGE_BRUSH_H
#define SELVAGE_BRUSH_H

#include <selvage/result.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Immutable; any number of threads may paint with one. */
typedef struct slv_brush slv_brush;

/* Of a round brush. Zero means default. */
typedef struct slv_brush_params {
    float hardness; /* of its dabs, as in slv_dab; 0: 0.5 */
    float spacing;  /* from dab to dab, in radii; 0: 0.2 */
    float aspect;   /* 1..; 0: 1 */
    float angle;    /* degrees, counter-clockwise from the stroke's first axis, or if it follows
                       from where the stroke goes */
    bool follow;
    /* 0..1: how much of the radius and of the opacity there is only as far as the stylus presses */
    float pressure_radius, pressure_opacity;
    uint64_t reserved[4];
} slv_brush_params;

SLV_NODISCARD SLV_API slv_result slv_brush_create(const slv_env *env,
                                                  const slv_brush_params *params, slv_brush **out);
/* Reads a brush of MyPaint, JSON of version 3. Settings and inputs that are not known are left out
 * and listed; values are kept within what libmypaint allows. SLV_ERROR_UNSUPPORTED where this
 * library was built without libmypaint. */
SLV_NODISCARD SLV_API slv_result slv_brush_load(const slv_env *env, const char *path,
                                                slv_brush **out);
/* The same from bytes; `name` is for messages. */
SLV_NODISCARD SLV_API slv_result slv_brush_parse(const slv_env *env, const char *name,
                                                 const char *text, size_t size, slv_brush **out);
SLV_API void slv_brush_destroy(slv_brush *brush);

/* What was left out of a file: "setting" or "setting: input". Owned by the brush. */
SLV_API uint32_t slv_brush_unknown(const slv_brush *brush, const char *const **names);
/* The radius that a file gives it, in pixels; of round brushes 20. */
SLV_API float slv_brush_radius(const slv_brush *brush);

#ifdef __cplusplus
}
#endif

#endif
