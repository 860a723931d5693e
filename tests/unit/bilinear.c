/* The one bilinear lookup: which texels it takes, where it stops, and that it is linear between
 * texel centres, by the formula that everybody knows, in double. */
#include "kit/test.h"

#include "texture/bilinear.h"

static double expected(const float *texels, uint32_t width, double x, double y) {
    double fx = x - floor(x), fy = y - floor(y);
    const float *at = texels + (size_t)y * width + (size_t)x;
    double right = fx > 0 ? (double)at[1] : 0, up = fy > 0 ? (double)at[width] : 0;
    double up_right = fx > 0 && fy > 0 ? (double)at[width + 1] : 0;
    return (1 - fy) * ((1 - fx) * (double)at[0] + fx * right) +
           fy * ((1 - fx) * up + fx * up_right);
}

static double clamped(double at, double last) {
    return at > 0 ? at < last ? at : last : 0;
}

static void test_places(slv_res res) {
    uint32_t width = 1u << res.u, height = 1u << res.v;
    uint64_t random = 3;
    float *texels = malloc((width + 2) * (height + 2) * sizeof *texels);
    REQUIRE(texels);
    for (uint32_t i = 0; i < (width + 2) * (height + 2); i++)
        texels[i] = (float)(test_random(&random) % 256) / 256;
    for (int i = -3; i <= 67; i++)
        for (int j = -3; j <= 67; j++) {
            float u = (float)i / 64, v = (float)j / 64, found;
            double x = (double)u * width, y = (double)v * height;
            slvi_bilinear at = slvi_bilinear_centred(res, u, v);
            slvi_bilinear_typed(SLV_TYPE_FLOAT, texels, sizeof *texels, width * sizeof *texels, &at,
                                1, &found);
            CHECK(fabs((double)found - expected(texels, width, clamped(x - 0.5, width - 1),
                                                clamped(y - 0.5, height - 1))) < 1e-6);
            double sum = 0;
            for (uint32_t k = 0; k < 4; k++) {
                float share = slvi_bilinear_share(at.wx, at.wy, (int)k);
                if (share > 0)
                    sum +=
                        (double)share * (double)texels[(at.y + (k >> 1)) * width + at.x + (k & 1)];
            }
            CHECK(fabs((double)found - sum) < 1e-6);
            at = slvi_bilinear_edge_aligned(res, u, v);
            slvi_bilinear_typed(SLV_TYPE_FLOAT, texels, sizeof *texels,
                                (width + 1) * sizeof *texels, &at, 1, &found);
            CHECK(fabs((double)found -
                       expected(texels, width + 1, clamped(x, width), clamped(y, height))) < 1e-6);
            if (i < 0 || j < 0 || i > 64 || j > 64)
                continue;
            at = slvi_bilinear_bordered_floats(texels, res, 1, u, v, &found);
            CHECK(fabs((double)found - expected(texels, width + 2, x + 0.5, y + 0.5)) < 1e-6);
            CHECK(at.x == (uint32_t)(x + 0.5) && at.y == (uint32_t)(y + 0.5));
        }
    free(texels);
}

static void test_types(void) {
    const uint8_t bytes[2][2][3] = {{{0, 51, 255}, {102, 51, 0}}, {{0, 0, 0}, {255, 255, 255}}};
    const slvi_bilinear at = {.wx = 0.5f, .wy = 0.25f, .right = true, .up = true};
    const slvi_bilinear last = {.x = 1, .y = 1};
    float found[3];
    slvi_bilinear_typed(SLV_TYPE_U8, bytes, 3, 6, &at, 3, found);
    CHECK(fabsf(found[0] - (0.75f * 0.2f + 0.25f * 0.5f)) < 1e-6f);
    CHECK(fabsf(found[1] - (0.75f * 0.2f + 0.25f * 0.5f)) < 1e-6f);
    CHECK(fabsf(found[2] - (0.75f * 0.5f + 0.25f * 0.5f)) < 1e-6f);
    slvi_bilinear_typed(SLV_TYPE_U8, bytes, 3, 6, &last, 3, found);
    CHECK(found[0] == 1 && found[1] == 1 && found[2] == 1);
}

/* Beyond the outermost texels, and at what is not a number. */
static void test_ends(void) {
    float weight;
    CHECK(slvi_linear_at(-INFINITY, 7, &weight) == 0 && weight == 0);
    CHECK(slvi_linear_at(INFINITY, 7, &weight) == 7 && weight == 0);
    CHECK(slvi_linear_at(NAN, 7, &weight) == 0 && weight == 0);
    CHECK(slvi_linear_at(6.75f, 7, &weight) == 6 && weight == 0.75f);
    const float here = 2, infinite = INFINITY;
    const slvi_bilinear at = {.wx = 0, .wy = 0.5f};
    float found;
    slvi_bilinear_mix(&at, &here, NULL, NULL, NULL, 1, &found);
    CHECK(found == 2);
    slvi_bilinear_mix(&at, &here, NULL, &here, NULL, 1, &found);
    CHECK(found == 2);
    slvi_bilinear_mix(&at, &here, NULL, &infinite, NULL, 1, &found);
    CHECK(found == INFINITY);
}

int main(void) {
    for (int8_t u = 0; u <= 3; u++)
        for (int8_t v = 0; v <= 3; v++)
            test_places((slv_res){u, v});
    test_types();
    test_ends();
    return test_end();
}
