/* Light from an image of all directions, as nine spherical harmonics for each colour. */
#include "base/srgb.h"

#include <selvage/light.h>

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

enum { BASES = 9, FINE = 256 };

/* Real spherical harmonics up to the second band. */
static void bases_at(double x, double y, double z, double out[BASES]) {
    out[0] = 0.28209479177387814;
    out[1] = 0.48860251190291992 * y;
    out[2] = 0.48860251190291992 * z;
    out[3] = 0.48860251190291992 * x;
    out[4] = 1.0925484305920792 * x * y;
    out[5] = 1.0925484305920792 * y * z;
    out[6] = 0.31539156525252005 * (3 * z * z - 1);
    out[7] = 1.0925484305920792 * x * z;
    out[8] = 0.54627421529603959 * (x * x - y * y);
}

/* Of a matt surface, over pi: what it keeps of each band. */
static const double kept[3] = {1, 2.0 / 3, 1.0 / 4};

/* n . M n with 1 behind n, of what the harmonics are polynomials of. */
static void to_matrix(const double sums[BASES], float m[16]) {
    double l[BASES];
    double k0 = 0.28209479177387814, k1 = 0.48860251190291992, k2 = 1.0925484305920792,
           k3 = 0.31539156525252005, k4 = 0.54627421529603959;
    for (int i = 0; i < BASES; i++)
        l[i] = sums[i] * kept[i == 0 ? 0 : i < 4 ? 1 : 2];
    const double all[16] = {
        k4 * l[8] - k3 * l[6], k2 / 2 * l[4],          k2 / 2 * l[7], k1 / 2 * l[3],
        k2 / 2 * l[4],         -k4 * l[8] - k3 * l[6], k2 / 2 * l[5], k1 / 2 * l[1],
        k2 / 2 * l[7],         k2 / 2 * l[5],          2 * k3 * l[6], k1 / 2 * l[2],
        k1 / 2 * l[3],         k1 / 2 * l[1],          k1 / 2 * l[2], k0 * l[0]};
    for (int i = 0; i < 16; i++)
        m[i] = (float)all[i];
}

static double value_of(const slv_image *image, size_t pixel, uint32_t channel) {
    const bool colored = image->nchannels > 2;
    float value = image->pixels[pixel * image->nchannels + (colored ? channel : 0)];
    if (!isfinite(value))
        return 0;
    return (double)(image->encoding == SLV_TEXTURE_SRGB ? slvi_srgb_to_linear(value) : value);
}

/* Integrals of the harmonics over a pixel, by so many points that small images are no worse. */
static void add_pixel(const slv_image *image, uint32_t row, uint32_t column, double out[BASES]) {
    const uint32_t steps = 1 + FINE / image->height;
    const double high = PI / image->height, wide = 2 * PI / image->width;
    for (uint32_t y = 0; y < steps; y++) {
        /* of a sphere of radius 1 as much as lies between two heights */
        const double up = PI / 2 - high * (row + (y + 0.5) / steps), half = high / (2 * steps),
                     area = (sin(up + half) - sin(up - half)) * wide / steps;
        for (uint32_t x = 0; x < steps; x++) {
            const double around = PI - wide * (column + (x + 0.5) / steps);
            double bases[BASES];
            bases_at(sin(around) * cos(up), sin(up), cos(around) * cos(up), bases);
            for (int i = 0; i < BASES; i++)
                out[i] += area * bases[i];
        }
    }
}

void slv_light_from_image(const slv_image *image, slv_light *out) {
    double sums[3][BASES] = {{0}};
    for (uint32_t row = 0; row < image->height; row++)
        for (uint32_t column = 0; column < image->width; column++) {
            double pixel[BASES] = {0};
            add_pixel(image, row, column, pixel);
            for (uint32_t c = 0; c < 3; c++) {
                const double value = value_of(image, (size_t)row * image->width + column, c);
                for (int i = 0; i < BASES; i++)
                    sums[c][i] += value * pixel[i];
            }
        }
    for (int c = 0; c < 3; c++)
        to_matrix(sums[c], out->matrices[c]);
}

slv_light slv_light_turn(const slv_light *light, float degrees) {
    const double angle = (double)degrees * PI / 180, s = sin(angle), c = cos(angle);
    /* from the light that is turned to the one that is not */
    const double turn[4][4] = {{c, 0, -s, 0}, {0, 1, 0, 0}, {s, 0, c, 0}, {0, 0, 0, 1}};
    slv_light out;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++) {
                double sum = 0;
                for (int a = 0; a < 4; a++)
                    for (int b = 0; b < 4; b++)
                        sum += turn[a][i] * (double)light->matrices[k][4 * a + b] * turn[b][j];
                out.matrices[k][4 * i + j] = (float)sum;
            }
    return out;
}

void slv_light_at(const slv_light *light, const float normal[3], float rgb[3]) {
    const float n[4] = {normal[0], normal[1], normal[2], 1};
    for (int c = 0; c < 3; c++) {
        float sum = 0;
        for (int i = 0; i < 16; i++)
            sum += n[i / 4] * light->matrices[c][i] * n[i % 4];
        rgb[c] = fmaxf(sum, 0);
    }
}
