/* How a colour goes over another: the modes of layers, brushes and recipes. */
#ifndef SELVAGE_BLEND_H
#define SELVAGE_BLEND_H

#include <selvage/result.h>

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* W3C Compositing and Blending, level 1, where it has them. In the values that are there, as
 * programs for images do; sessions hold the numbers. */
typedef enum slv_blend {
    SLV_BLEND_NORMAL = 0,
    SLV_BLEND_MULTIPLY,
    SLV_BLEND_SCREEN,
    SLV_BLEND_OVERLAY,
    SLV_BLEND_DARKEN,
    SLV_BLEND_LIGHTEN,
    SLV_BLEND_ADD,
    SLV_BLEND_COLOR,    /* hue and saturation of what comes over, luminosity of what is there; of
                           other than three colours: normal */
    SLV_BLEND_REPLACE,  /* alpha too becomes that of what comes over */
    SLV_BLEND_SUBTRACT, /* what comes over is taken away */
    SLV_BLEND_COUNT
} slv_blend;

/* normal, multiply, screen, overlay, darken, lighten, add, color, replace, subtract */
SLV_API const char *slv_blend_name(slv_blend blend);
SLV_API bool slv_blend_from_name(const char *name, slv_blend *out);

#ifdef __cplusplus
}
#endif

#endif
