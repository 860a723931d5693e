/* What has no value takes what is nearest, so that averages mix nothing in. */
#include "source/holes.h"

#include "base/memory.h"

#include <string.h>

typedef struct level {
    uint32_t width, height;
    float *values;
    uint8_t *known;
} level;

static uint32_t half_of(uint32_t size) {
    return (size + 1) / 2;
}

/* The mean of what is known of each 2x2, and whether anything is. */
static void pull(uint32_t n, const level *from, level *to) {
    for (uint32_t y = 0; y < to->height; y++)
        for (uint32_t x = 0; x < to->width; x++) {
            size_t i = (size_t)y * to->width + x;
            uint32_t count = 0;
            float sum[4] = {0};
            for (uint32_t k = 0; k < 4; k++) {
                uint32_t px = 2 * x + (k & 1), py = 2 * y + (k >> 1);
                size_t at = (size_t)py * from->width + px;
                if (px >= from->width || py >= from->height || !from->known[at])
                    continue;
                for (uint32_t c = 0; c < n; c++)
                    sum[c] += from->values[at * n + c];
                count++;
            }
            for (uint32_t c = 0; c < n; c++)
                to->values[i * n + c] = count ? sum[c] / (float)count : 0;
            to->known[i] = count > 0;
        }
}

/* Recursive, a level at a time: as many as a side can be halved. */
static slv_result fill(const slv_env *env, uint32_t n, level *own) {
    level above = {half_of(own->width), half_of(own->height), NULL, NULL};
    size_t count = (size_t)above.width * above.height, total = (size_t)own->width * own->height;
    if (total == 1 || !memchr(own->known, 0, total))
        return SLV_OK;
    slv_result result =
        slvi_alloc_plain(env, "filling", count, n * sizeof *above.values, &above.values);
    if (!result && !(result = slvi_alloc_plain(env, "filling", count, 1, &above.known))) {
        pull(n, own, &above);
        result = fill(env, n, &above);
    }
    for (uint32_t y = 0; y < own->height && !result; y++)
        for (uint32_t x = 0; x < own->width; x++) {
            size_t i = (size_t)y * own->width + x;
            if (!own->known[i])
                memcpy(own->values + i * n,
                       above.values + ((size_t)(y / 2) * above.width + x / 2) * n,
                       n * sizeof *own->values);
        }
    slvi_free(above.values);
    slvi_free(above.known);
    return result;
}

slv_result slvi_holes_fill(const slv_env *env, uint32_t nchannels, uint32_t width, uint32_t height,
                           const uint8_t *missed, float *values) {
    size_t count = (size_t)width * height;
    level own = {width, height, values, NULL};
    slv_result result = slvi_alloc_plain(env, "filling", count, 1, &own.known);
    if (result)
        return result;
    for (size_t i = 0; i < count; i++)
        own.known[i] = !missed[i];
    result = fill(env, nchannels, &own);
    slvi_free(own.known);
    return result;
}
