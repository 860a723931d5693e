/* Hue, saturation and value, as MyPaint has colours. */
#include "brush/brush_data.h"

#include <math.h>

void slvi_hsv_to_rgb(const float hsv[3], float rgb[3]) {
    float h = 6 * (hsv[0] - floorf(hsv[0])), s = hsv[1], v = hsv[2];
    for (int k = 0; k < 3; k++) {
        float away = fabsf(fmodf(h + (k == 0 ? 0.0f : k == 1 ? 4.0f : 2.0f), 6) - 3) - 1;
        away = away < 0 ? 0 : away > 1 ? 1 : away;
        rgb[k] = v * (1 - s + s * away);
    }
}

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
