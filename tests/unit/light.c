/* Light from images of all directions: against integrals over the image, turned, and for images of
 * one colour. */
#include "kit/test.h"

#include <selvage/light.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

enum { WIDTH = 64, HEIGHT = 32 };

static uint64_t state = 7;

/* From 0 to 1. */
static double any(void) {
    return (double)test_random(&state) / 4294967296.0;
}

static slv_image make_image(uint32_t nchannels) {
    slv_env env = test_env();
    slv_image image;
    REQUIRE(slv_image_create(&env, WIDTH, HEIGHT, nchannels, &image) == SLV_OK);
    return image;
}

/* The direction of a pixel, as the header says that it lies. */
static void direction(uint32_t row, uint32_t column, double out[3]) {
    double up = PI * (0.5 - (row + 0.5) / HEIGHT), around = PI - 2 * PI * (column + 0.5) / WIDTH;
    out[0] = sin(around) * cos(up);
    out[1] = sin(up);
    out[2] = cos(around) * cos(up);
}

static void check_even(void) {
    slv_image image = make_image(4);
    slv_light light;
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
        memcpy(image.pixels + 4 * i, (const float[4]){0.5f, 0.25f, 2, 0.1f}, 4 * sizeof(float));
    image.pixels[0] = NAN;
    slv_light_from_image(&image, &light);
    for (int k = 0; k < 50; k++) {
        float n[3] = {(float)any() - 0.5f, (float)any() - 0.5f, (float)any() - 0.5f}, rgb[3];
        float length = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        for (int c = 0; c < 3; c++)
            n[c] /= length;
        slv_light_at(&light, n, rgb);
        /* the pixel that is no number is a hundred-thousandth of the sphere */
        CHECK_MSG(fabsf(rgb[0] - 0.5f) < 1e-4f && fabsf(rgb[1] - 0.25f) < 1e-5f &&
                      fabsf(rgb[2] - 2) < 1e-4f,
                  "%g %g %g", (double)rgb[0], (double)rgb[1], (double)rgb[2]);
    }
    for (size_t i = 0; i < 4 * (size_t)WIDTH * HEIGHT; i++)
        image.pixels[i] = 0.5f;
    image.encoding = SLV_TEXTURE_SRGB;
    slv_light_from_image(&image, &light);
    float rgb[3];
    slv_light_at(&light, (const float[3]){0, 1, 0}, rgb);
    CHECK(fabsf(rgb[0] - 0.21404f) < 1e-4f);
    slv_image_free(&image);
}

/* A smooth light has nothing beyond the second band that a matt surface would see. */
static double smooth(const double at[3]) {
    return 1 + 0.8 * at[0] - 0.3 * at[1] + 0.5 * at[2] + 0.4 * at[0] * at[2] + 0.3 * at[1] * at[1];
}

/* What comes back, by the integral over the image. */
static double expected(const double n[3], double (*value)(const double at[3])) {
    double sum = 0;
    for (uint32_t row = 0; row < HEIGHT; row++)
        for (uint32_t column = 0; column < WIDTH; column++) {
            double at[3], facing;
            direction(row, column, at);
            facing = fmax(at[0] * n[0] + at[1] * n[1] + at[2] * n[2], 0);
            sum += value(at) * facing * cos(PI * (0.5 - (row + 0.5) / HEIGHT));
        }
    return sum * (PI / HEIGHT) * (2 * PI / WIDTH) / PI;
}

static void check_smooth(void) {
    slv_image image = make_image(1);
    slv_light light, turned;
    for (uint32_t row = 0; row < HEIGHT; row++)
        for (uint32_t column = 0; column < WIDTH; column++) {
            double at[3];
            direction(row, column, at);
            image.pixels[(size_t)row * WIDTH + column] = (float)smooth(at);
        }
    slv_light_from_image(&image, &light);
    for (int k = 0; k < 200; k++) {
        double n[3] = {any() - 0.5, any() - 0.5, any() - 0.5};
        double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        float rgb[3], again[3];
        for (int c = 0; c < 3; c++)
            n[c] /= length;
        const float normal[3] = {(float)n[0], (float)n[1], (float)n[2]};
        slv_light_at(&light, normal, rgb);
        CHECK_MSG(fabs((double)rgb[0] - expected(n, smooth)) < 0.01, "%g, expected %g",
                  (double)rgb[0], expected(n, smooth));
        CHECK(rgb[0] == rgb[1] && rgb[1] == rgb[2]);
        /* the surface turned along with the light sees the same */
        float degrees = (float)(720 * any() - 360);
        double a = (double)degrees * PI / 180;
        const float along[3] = {(float)(cos(a) * n[0] + sin(a) * n[2]), (float)n[1],
                                (float)(cos(a) * n[2] - sin(a) * n[0])};
        turned = slv_light_turn(&light, degrees);
        slv_light_at(&turned, along, again);
        CHECK_MSG(fabsf(again[0] - rgb[0]) < 1e-5f, "turned by %g: %g, not %g", (double)degrees,
                  (double)again[0], (double)rgb[0]);
    }
    slv_image_free(&image);
}

/* A small bright spot above: what faces it is bright, what turns away is dark and never below
 * zero. */
static void check_spot(void) {
    slv_image image = make_image(3);
    slv_light light;
    float up[3], down[3], side[3];
    for (uint32_t column = 0; column < WIDTH; column++)
        image.pixels[3 * column] = 100;
    slv_light_from_image(&image, &light);
    slv_light_at(&light, (const float[3]){0, 1, 0}, up);
    slv_light_at(&light, (const float[3]){0, -1, 0}, down);
    slv_light_at(&light, (const float[3]){1, 0, 0}, side);
    CHECK(up[0] > 0.2f && up[1] == 0 && down[0] >= 0 && side[0] >= 0);
    CHECK(up[0] > 4 * side[0] && up[0] > 4 * down[0]);
    slv_image_free(&image);
}

int main(void) {
    check_even();
    check_smooth();
    check_spot();
    return test_end();
}
