/* Template: coarse resolutions with what lies around the face: an apron. A kernel of a few texels
 * on a face of a few texels crosses its edges nearly always; with an apron it is summed up like any
 * other. What is in the apron was found by laying kernels of one texel across the edges, so that it
 * means the same. Whether a lookup uses one depends on the file and the lookup alone, never on what
 * is cached. */
#ifndef SLV_FILTER_APRON_TEMPLATE_H
#define SLV_FILTER_APRON_TEMPLATE_H

#include "filter/seams_template.h"

#include <selvage/half.h>

#define APRON_LOG2 3       /* up to 8x8 texels */
#define APRON_WIDTH_LOG2 2 /* no wider than the face */
#define APRON_WIDTH (1 << APRON_WIDTH_LOG2)
#define APRON_WHOLE 0x1ffu
#define APRON_SIDE ((1 << APRON_LOG2) + 2 * APRON_WIDTH)

static inline int apron_width(int res) {
    return 1 << (res < APRON_WIDTH_LOG2 ? res : APRON_WIDTH_LOG2);
}

static inline bool apron_fits_axis(const kernel_axis *a) {
    int width = apron_width(a->res);
    return a->res <= APRON_LOG2 && a->start >= -width && a->start + a->n <= (1 << a->res) + width;
}

static inline bool apron_fits(const kernel *k) {
    return apron_fits_axis(&k->a[0]) && apron_fits_axis(&k->a[1]);
}

/* The thirds of an axis that a range reaches: 1 before the face, 2 within, 4 behind. */
static inline unsigned apron_thirds(int start, int n, int res) {
    return (unsigned)(start < 0) | (unsigned)(start + n > 0 && start < 1 << res) << 1 |
           (unsigned)(start + n > 1 << res) << 2;
}

/* One bit for each of the face and the eight regions around it. */
static inline unsigned apron_regions(unsigned thirds_u, unsigned thirds_v) {
    return (thirds_v & 1) * thirds_u | (thirds_v >> 1 & 1) * thirds_u << 3 |
           (thirds_v >> 2) * thirds_u << 6;
}

/* Whether a sum of values is a value that the type has. */
static inline bool apron_store(slv_type type, const float *values, uint32_t count, void *out) {
    for (uint32_t c = 0; c < count; c++) {
        float x = values[c];
        if (type == SLV_TYPE_FLOAT)
            ((float *)out)[c] = x;
        else if (type == SLV_TYPE_HALF) {
            uint16_t half = slv_half_from_float(x);
            if (!(slv_half_to_float(half) == x))
                return false;
            ((uint16_t *)out)[c] = half;
        } else {
            float most = type == SLV_TYPE_U8 ? 255 : 65535;
            if (!(x >= 0 && x <= most && x == (float)(int)x))
                return false;
            if (type == SLV_TYPE_U8)
                ((uint8_t *)out)[c] = (uint8_t)x;
            else
                ((uint16_t *)out)[c] = (uint16_t)x;
        }
    }
    return true;
}

/* Makes the apron of a face at a resolution. Regions where kernels do not simply add up, as behind
 * extraordinary vertices or on sub-faces, are marked as missing. */
static __attribute__((noinline)) const uint8_t *apron_make(lookup_state *state, uint32_t face,
                                                           int res_u, int res_v) {
    cache_tables *t = state->tables;
    float texels[APRON_SIDE * APRON_SIDE * 4];
    int width_u = apron_width(res_u), width_v = apron_width(res_v);
    int side_u = (1 << res_u) + 2 * width_u, side_v = (1 << res_v) + 2 * width_v;
    unsigned there = APRON_WHOLE;
    uint32_t now = cache_apron_now(t);
    memset(texels, 0, sizeof texels);
    for (int y = 0; y < side_v; y++)
        for (int x = 0; x < side_u; x++) {
            kernel k = {{{res_u, x - width_u, 1, {1}}, {res_v, y - width_v, 1, {1}}}, 0};
            unsigned region = apron_regions(apron_thirds(x - width_u, 1, res_u),
                                            apron_thirds(y - width_v, 1, res_v));
            if (!(there & region))
                continue;
            float sum[4] = {0};
            lookup_state one = {.sampler = state->sampler,
                                .tables = t,
                                .count = t->nchannels,
                                .sum = sum,
                                .weight = 1};
            seam_across(&one, face, &k);
            state->pieces += one.pieces;
            if (lookup_is_over(&one)) {
                state->gone = one.gone;
                state->result = one.result;
                return NULL;
            }
            uint8_t *to = (uint8_t *)texels + (size_t)(y * side_u + x) * t->pixel_size;
            if (one.subfaces || one.weight != 1 || !apron_store(t->type, sum, t->nchannels, to))
                there &= ~region;
        }
    const uint8_t *made =
        slvi_cache_publish(&state->sampler->thread, t, face, res_u, res_v, now, texels,
                           (size_t)side_u * (size_t)side_v * t->pixel_size, there);
    state->gone = !made;
    return made;
}

/* The apron of a face at a resolution; NULL when state says why. */
static inline const uint8_t *apron_find(lookup_state *state, uint32_t face, const cache_face *f,
                                        int res_u, int res_v) {
    const cache_view *cache = state->sampler->thread.view;
    const uint8_t *texels = cache_find_apron(cache, state->tables, f, res_u, res_v);
    if (!texels)
        texels = cache_find_hashed(cache, state->tables, face, res_u, res_v,
                                   cache_apron_now(state->tables));
    state->pieces++;
    return texels ? texels : apron_make(state, face, res_u, res_v);
}

/* Whether an apron has all texels under a kernel; which is then moved to the apron's own. */
static inline __attribute__((always_inline)) bool apron_covers(const uint8_t *apron, kernel *k) {
    kernel_axis *u = &k->a[0], *v = &k->a[1];
    uint32_t there = cache_block_note(apron);
    if (there != APRON_WHOLE &&
        (apron_regions(apron_thirds(u->start, u->n, u->res), apron_thirds(v->start, v->n, v->res)) &
         ~there))
        return false;
    u->start += apron_width(u->res);
    v->start += apron_width(v->res);
    return true;
}

/* Texels in a row of it. */
static inline size_t apron_pitch(int res_u) {
    return ((size_t)1 << res_u) + 2 * (size_t)apron_width(res_u);
}

/* Sums up texels of a face and around it. False, and nothing was summed, where the apron has holes:
 * the kernel must then be taken apart. */
static inline bool apron_apply(lookup_state *state, uint32_t face, const cache_face *f, kernel *k) {
    const uint8_t *texels = apron_find(state, face, f, k->a[0].res, k->a[1].res);
    if (!texels || !apron_covers(texels, k))
        return false;
    v4f sum = gather_few(state->tables, texels, apron_pitch(k->a[0].res), k);
    for (uint32_t c = 0; c < state->count; c++)
        state->sum[c] += sum[state->first + c];
    return true;
}

#endif
