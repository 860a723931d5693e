/* Hue, saturation and value, as MyPaint has colours. */
#include "brush/brush_data.h"

#include <math.h>

void slvi_rgb_to_hsv(const float rgb[3], float hsv[3]) {
    float high = fmaxf(rgb[0], fmaxf(rgb[1], rgb[2])), low = fminf(rgb[0], fminf(rgb[1], rgb[2]));
    float c = high - low, h = 0;
    if (c > 0)
        h = high == rgb[0]   ? fmodf((rgb[1] - rgb[2]) / c + 6, 6)
            : high == rgb[1] ? (rgb[2] - rgb[0]) / c + 2
                             : (rgb[0] - rgb[1]) / c + 4;
    hsv[0] = h / 6;
    hsv[1] = high > 0 ? c / high : 0;
    hsv[2] = high;
}
