/* The names of blend modes. */
#include <selvage/blend.h>

#include "base/names.h"

static const char *const blend_names[SLV_BLEND_COUNT] = {"normal",  "multiply", "screen", "overlay",
                                                         "darken",  "lighten",  "add",    "color",
                                                         "replace", "subtract"};

const char *slv_blend_name(slv_blend blend) {
    return slvi_name_of(blend_names, SLVI_COUNT(blend_names), (int)blend);
}

bool slv_blend_from_name(const char *name, slv_blend *out) {
    int value;
    if (!slvi_name_find(blend_names, SLVI_COUNT(blend_names), name, &value))
        return false;
    *out = (slv_blend)value;
    return true;
}
