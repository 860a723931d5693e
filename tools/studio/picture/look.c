/* What a look begins as, and its words. */
#include "studio/picture/look.h"

#include <selvage/gl_strategy.h>

const char *const studio_compare_names[STUDIO_COMPARES] = {"whole", "split", "difference",
                                                           "flicker"};
const char *const studio_encoding_names[STUDIO_ENCODINGS] = {"srgb", "linear", "data"};
const char *const studio_overlay_names[STUDIO_OVERLAYS] = {"none",   "faces",   "resolution",
                                                           "levels", "widened", "damaged"};

studio_look studio_look_default(void) {
    studio_look look = {.divider = 0.5f, .gain = 8, .msaa = 4, .anisotropy = 1};
    while (slv_strategy_at(look.strategy) != slv_strategy_default())
        look.strategy++;
    return look;
}
