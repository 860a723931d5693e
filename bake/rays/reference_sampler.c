/* Where samples fall within a pixel: scrambled sequences of low discrepancy, and filters. */
#include "rays/reference_data.h"

#include "base/memory.h"
#include "base/names.h"

#include <math.h>
#include <string.h>

enum { SHARES = 4096, STEPS = 64 * SHARES };
#define RADIUS 2.0

static const char *const filters[] = {"box", "mitchell"};

const char *slv_pixel_filter_name(slv_pixel_filter filter) {
    return slvi_name_of(filters, SLVI_COUNT(filters), (int)filter);
}

bool slv_pixel_filter_from_name(const char *name, slv_pixel_filter *out) {
    int value = 0;
    bool found = slvi_name_find(filters, SLVI_COUNT(filters), name, &value);
    if (found)
        *out = (slv_pixel_filter)value;
    return found;
}

/* Mitchell and Netravali 1988, equation 8 with B = C = 1/3. */
double slv_pixel_filter_weight(slv_pixel_filter filter, double x) {
    x = fabs(x);
    if (filter == SLV_PIXEL_BOX)
        return x <= 0.5;
    if (x < 1)
        return (7 * x * x * x - 12 * x * x + 16.0 / 3) / 6;
    if (x < 2)
        return (-7.0 / 3 * x * x * x + 12 * x * x - 20 * x + 32.0 / 3) / 6;
    return 0;
}

/* Samples are denser where the filter is strong. A little is added everywhere so that the weight,
 * filter over density, passes through zero where the filter changes its sign: a jump there would
 * cost the Sobol points their evenness (measured: 1.6 times the error at 1024 samples). */
static double density(double x) {
    return fabs(slv_pixel_filter_weight(SLV_PIXEL_MITCHELL, x)) + 0.05;
}

/* Positions between which the density has the same area everywhere. What the table gets wrong the
 * weight makes good: it is the filter over the density that the table really has. */
static slv_result make_positions(const slv_env *env, float **out) {
    float *positions = NULL;
    double total = 0, sum = 0;
    slv_result result = slvi_alloc(env, "pixel filter", SHARES + 1, sizeof *positions, &positions);
    if (result)
        return result;
    const double step = 2 * RADIUS / STEPS;
    for (int i = 0; i < STEPS; i++)
        total += density(-RADIUS + (i + 0.5) * step);
    int next = 1;
    for (int i = 0; i < STEPS; i++) {
        double here = density(-RADIUS + (i + 0.5) * step);
        for (; next < SHARES && sum + here > total * next / SHARES; next++)
            positions[next] = (float)(-RADIUS + (i + (total * next / SHARES - sum) / here) * step);
        sum += here;
    }
    positions[0] = -(float)RADIUS;
    positions[SHARES] = (float)RADIUS;
    *out = positions;
    return SLV_OK;
}

slv_result slvi_reference_sampler_create(const slv_env *env, slv_pixel_filter filter, uint32_t seed,
                                         uint32_t samples, reference_sampler *out) {
    slv_result result;
    *out = (reference_sampler){.filter = filter, .seed = seed};
    while (out->mask + 1 < samples)
        out->mask = 2 * out->mask + 1;
    const uint32_t count = out->mask + 1;
    if ((result = slvi_alloc(env, "samples", count, sizeof *out->sobol, &out->sobol)) ||
        (filter == SLV_PIXEL_MITCHELL && (result = make_positions(env, &out->positions)))) {
        slvi_reference_sampler_free(out);
        return result;
    }
    /* The direction numbers of Sobol's second dimension: Pascal's triangle modulo 2. */
    for (uint32_t i = 0; i < count; i++) {
        uint32_t value = 0, direction = UINT32_C(1) << 31;
        for (uint32_t bits = i; bits; bits >>= 1, direction ^= direction >> 1)
            value ^= bits & 1 ? direction : 0;
        out->sobol[i] = reference_reverse(value);
    }
    return SLV_OK;
}

void slvi_reference_sampler_free(reference_sampler *sampler) {
    slvi_free(sampler->sobol);
    slvi_free(sampler->positions);
    memset(sampler, 0, sizeof *sampler);
}

static uint32_t mix(uint32_t h, uint32_t value) {
    h = (h ^ value) * 0x9e3779b1u;
    h = (h ^ h >> 15) * 0x85ebca77u;
    h = (h ^ h >> 13) * 0xc2b2ae3du;
    return h ^ h >> 16;
}

reference_sequence slvi_reference_sequence_begin(const reference_sampler *sampler, uint32_t x,
                                                 uint32_t y, uint32_t half) {
    uint32_t h = mix(mix(mix(mix(0x51c64a5du, sampler->seed), half), y), x);
    return (reference_sequence){{mix(h, 1), mix(h, 2)}};
}

float slvi_reference_sample(const reference_sampler *sampler, const reference_sequence *sequence,
                            uint32_t index, float offset[2]) {
    float weight = 1;
    offset[0] = reference_scramble(index, sequence->scramble[0]);
    offset[1] = reference_scramble(sampler->sobol[index], sequence->scramble[1]);
    if (sampler->filter == SLV_PIXEL_BOX)
        return weight;
    for (int axis = 0; axis < 2; axis++) {
        float at = offset[axis] * SHARES;
        uint32_t share = (uint32_t)at;
        float low = sampler->positions[share], width = sampler->positions[share + 1] - low;
        float x = low + (at - (float)share) * width;
        offset[axis] = 0.5f + x;
        weight *= (float)slv_pixel_filter_weight(SLV_PIXEL_MITCHELL, (double)x) * width * SHARES;
    }
    return weight;
}
