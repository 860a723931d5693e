/* Rows of patterns compiled for each kind of processor give the same bytes. */
#include "kit/test.h"

#include "base/processor.h"
#include "procedural/row.h"

static float between(uint64_t *random, float low, float high) {
    return low + (high - low) * (float)(test_random(random) % 1000001) * 1e-6f;
}

/* Corners of texels of any size, some of them where no number lies. */
static void fill_corners(slvi_pattern_rows *rows, uint64_t *random) {
    static const float odd[] = {NAN, INFINITY, -3e38f, 2e9f, -1073741824.0f, 1e-42f, -0.0f};
    const float size = exp2f(between(random, -7, 3)), far = exp2f(between(random, 0, 16));
    for (int axis = 0; axis < 3; axis++) {
        const float at = between(random, -far, far), u = between(random, -size, size),
                    v = between(random, -size, size);
        for (uint32_t i = 0; i < SLVI_ROW_ROOM; i++)
            for (unsigned row = 0; row < 2; row++)
                rows->corners[row][axis][i] =
                    test_random(random) % 64
                        ? at + (float)i * u + (float)row * v + between(random, -size, size) * 0.1f
                        : odd[test_random(random) % (sizeof odd / sizeof *odd)];
    }
}

int main(void) {
#define ROW(KIND) {#KIND, slvi_has_##KIND, slvi_pattern_means_##KIND},
    static const struct {
        const char *name;
        bool (*runs)(void);
        slvi_pattern_means *means;
    } kinds[] = {SLVI_ROW_PROCESSORS(ROW)};
    enum { COUNT = sizeof kinds / sizeof *kinds };
    static slvi_pattern_rows want, found;
    uint64_t random = 3;
    int ran = 0;
    for (int round = 0; round < 400; round++) {
        const slv_procedural pattern = slvi_pattern_resolve(
            &(slv_procedural){.pattern = (slv_pattern)(round % 3), /* stripes, noise, cubes */
                              .warp = round & 8 ? 0.7f : 0,
                              .seed = (uint32_t)round,
                              .octaves = (uint32_t)(1 + round % 7)});
        const uint32_t width = 1 + (uint32_t)(test_random(&random) % SLVI_ROW_TEXELS);
        slvi_octave octaves[SLVI_MAX_OCTAVES];
        for (uint32_t i = 0; i < pattern.octaves; i++)
            octaves[i] = slvi_pattern_octave(pattern.seed, i);
        memset(&want, 0, sizeof want);
        fill_corners(&want, &random);
        for (int k = COUNT - 1; k >= 0; k--) {
            if (!kinds[k].runs())
                continue;
            memset(&found, 0, sizeof found);
            memcpy(found.corners, want.corners, sizeof found.corners);
            kinds[k].means(&pattern, octaves, &found, round & 1, width);
            if (k == COUNT - 1) {
                memcpy(want.means, found.means, sizeof want.means);
                memcpy(want.squares, found.squares, sizeof want.squares);
            }
            CHECK_MSG(memcmp(want.means, found.means, width * sizeof *want.means) == 0 &&
                          memcmp(want.squares, found.squares, width * sizeof *want.squares) == 0,
                      "round %d: %s differs", round, kinds[k].name);
            ran += k < COUNT - 1;
        }
        for (uint32_t i = 0; i < width; i++)
            CHECK_MSG(want.means[i] >= 0 && want.means[i] <= 1 &&
                          want.squares[i] <= want.means[i] + 1e-6f &&
                          want.squares[i] >= want.means[i] * want.means[i] - 1e-6f,
                      "round %d: %g, and %g of its square", round, (double)want.means[i],
                      (double)want.squares[i]);
    }
    if (!ran) {
        fprintf(stderr, "this processor has no AVX2: nothing to compare\n");
        return test_end() ? 1 : 77;
    }
    return test_end();
}
