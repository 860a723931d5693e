/* Sums along lines of pixels compiled for each kind of processor give the same bytes, what
 * bilinear interpolation comes to, and where pixels are alike texels that are, to the bit. */
#include "kit/test.h"

#include "base/processor.h"
#include "uv/lines.h"

enum { SIDE = 40, TEXELS = 32, MOST_EACH = 200 };

static float between(uint64_t *random, float low, float high) {
    return low + (high - low) * (float)(test_random(random) % 1000001) * 1e-6f;
}

/* A line that stays in the window. */
static uv_line line_within(uint64_t *random, uint32_t count) {
    const float from[2] = {between(random, 0, SIDE - 1.1f), between(random, 0, SIDE - 1.1f)},
                to[2] = {between(random, 0, SIDE - 1.1f), between(random, 0, SIDE - 1.1f)};
    const uint32_t straight = (uint32_t)(test_random(random) % 4); /* of two along an axis each */
    return (uv_line){from[0], from[1], straight == 1 ? 0 : (to[0] - from[0]) / (float)count,
                     straight == 2 ? 0 : (to[1] - from[1]) / (float)count};
}

static double sum_at(const uv_pixel *pixels, const uv_line *line, uint32_t first, uint32_t count,
                     int channel) {
    double sum = 0;
    for (uint32_t k = first; k < first + count; k++) {
        const double x = (double)line->x + k * (double)line->dx,
                     y = (double)line->y + k * (double)line->dy;
        const int left = (int)x, top = (int)y;
        const uv_pixel *at = pixels + top * SIDE + left;
        const double upper = (double)at[0][channel] +
                             (x - left) * (double)(at[1][channel] - at[0][channel]),
                     lower = (double)at[SIDE][channel] +
                             (x - left) * (double)(at[SIDE + 1][channel] - at[SIDE][channel]);
        sum += upper + (y - top) * (lower - upper);
    }
    return sum;
}

int main(void) {
#define LINE(KIND) {#KIND, slvi_has_##KIND, slvi_uv_sum_line_##KIND},
    static const struct {
        const char *name;
        bool (*runs)(void);
        slvi_uv_sum_line *sum;
    } kinds[] = {SLVI_UV_PROCESSORS(LINE)};
    enum { COUNT = sizeof kinds / sizeof *kinds };
    static uv_pixel pixels[SIDE * SIDE], want[TEXELS], found[TEXELS];
    uint64_t random = 7;
    int ran = 0;
    for (int round = 0; round < 400; round++) {
        const bool alike = round % 5 == 0;
        for (int i = 0; i < SIDE * SIDE; i++)
            for (int c = 0; c < 4; c++)
                pixels[i][c] = alike && i ? pixels[0][c] : between(&random, -1, 2);
        const uint32_t each = round % 3 ? 1 + (uint32_t)round % 9
                                        : 1 + (uint32_t)(test_random(&random) % MOST_EACH),
                       ntexels = 1 + (uint32_t)(test_random(&random) % TEXELS);
        const uv_line line = line_within(&random, each * ntexels);
        const uv_window window = {pixels, SIDE};
        for (int k = COUNT - 1; k >= 0; k--) {
            if (!kinds[k].runs())
                continue;
            memset(found, 0, sizeof found);
            kinds[k].sum(&window, &line, each, ntexels, found);
            if (k == COUNT - 1)
                memcpy(want, found, sizeof want);
            CHECK_MSG(memcmp(want, found, ntexels * sizeof *want) == 0, "round %d: %s differs",
                      round, kinds[k].name);
            ran += k < COUNT - 1;
        }
        for (uint32_t i = 0; i < ntexels; i++)
            for (int c = 0; c < 4; c++) {
                const double exact = sum_at(pixels, &line, i * each, each, c);
                CHECK_MSG(fabs((double)want[i][c] - exact) < 2e-5 * each,
                          "round %d: texel %u has %g, not %g", round, i, (double)want[i][c], exact);
                if (alike)
                    CHECK_MSG(want[i][c] == want[0][c],
                              "round %d: of alike pixels texels have %.9g and %.9g", round,
                              (double)want[0][c], (double)want[i][c]);
            }
    }
    if (!ran) {
        fprintf(stderr, "this processor has no AVX2: nothing to compare\n");
        return test_end() ? 1 : 77;
    }
    return test_end();
}
