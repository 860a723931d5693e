/* One sample of UV images, anywhere on a face: over the edges of tiles, and where some are missing.
 */
#include "uv/uv_source.h"

#include <math.h>

void slvi_uv_own_cells(const float *corners, int32_t cells[4]) {
    for (int axis = 0; axis < 2; axis++) {
        float low = corners[axis], high = corners[axis];
        for (int c = 1; c < 4; c++) {
            low = fminf(low, corners[2 * c + axis]);
            high = fmaxf(high, corners[2 * c + axis]);
        }
        cells[axis] = (int32_t)floorf(low);
        cells[2 + axis] = (int32_t)ceilf(high) - 1;
        if (cells[2 + axis] < cells[axis])
            cells[2 + axis] = cells[axis];
    }
}

const uv_tile *slvi_uv_reach(const uv_face *f, const uv_tile *tile, const int32_t cell[2],
                             int32_t *x, int32_t *y) {
    const uv_set *set = &f->source->set;
    int32_t w = (int32_t)tile->width, h = (int32_t)tile->height;
    int32_t du = *x < 0 ? -1 : *x >= w, dv = *y < 0 ? 1 : *y >= h ? -1 : 0;
    if (!du && !dv)
        return tile;
    if (!set->udim && set->wrap == SLV_BAKE_WRAP_REPEAT) {
        *x = set->ends[0] ? slvi_uv_clamp(*x, 0, w - 1) : (*x % w + w) % w;
        *y = set->ends[1] ? slvi_uv_clamp(*y, 0, h - 1) : (*y % h + h) % h;
        return tile;
    }
    const uv_tile *next = NULL;
    int32_t u = cell[0] + du, v = cell[1] + dv;
    if (set->udim && u >= f->cells[0] && u <= f->cells[2] && v >= f->cells[1] && v <= f->cells[3])
        next = slvi_uv_set_at(set, u, v);
    if (next) {
        /* the place in a tile of another size that is as far along */
        int32_t nw = (int32_t)next->width, nh = (int32_t)next->height;
        *x = du ? (du < 0 ? nw - 1 : 0) : (int32_t)((int64_t)*x * nw / w);
        *y = dv ? (dv > 0 ? nh - 1 : 0) : (int32_t)((int64_t)*y * nh / h);
        return next;
    }
    *x = slvi_uv_clamp(*x, 0, w - 1);
    *y = slvi_uv_clamp(*y, 0, h - 1);
    return tile;
}

slv_bake_miss slvi_uv_sample_at(const uv_face *f, double u, double v, double *sum) {
    const uv_set *set = &f->source->set;
    int32_t cell[2] = {slvi_uv_clamp((int32_t)floor(u), f->own[0], f->own[2]),
                       slvi_uv_clamp((int32_t)floor(v), f->own[1], f->own[3])};
    if (!set->udim && set->wrap == SLV_BAKE_WRAP_CLAMP) {
        cell[0] = cell[1] = 0;
        u = u < 0 ? 0 : u > 1 ? 1 : u;
        v = v < 0 ? 0 : v > 1 ? 1 : v;
    }
    const uv_tile *tile = slvi_uv_set_at(set, cell[0], cell[1]);
    if (!tile)
        return SLV_BAKE_NO_TILE;
    double x = (u - cell[0]) * tile->width - 0.5, y = (cell[1] + 1 - v) * tile->height - 0.5;
    int32_t left = (int32_t)floor(x), top = (int32_t)floor(y);
    double fx = x - left, fy = y - top, value[4] = {0};
    for (int k = 0; k < 4; k++) {
        int32_t px = left + (k & 1), py = top + (k >> 1);
        uv_pixel pixel;
        double weight = (k & 1 ? fx : 1 - fx) * (k >> 1 ? fy : 1 - fy);
        const uv_tile *from = slvi_uv_reach(f, tile, cell, &px, &py);
        if (!(weight > 0))
            continue;
        slvi_uv_decode(from, set->nchannels, (uint32_t)px, (uint32_t)py, 1, &pixel);
        for (uint32_t c = 0; c < 4; c++)
            value[c] += weight * (double)pixel[c];
    }
    for (uint32_t c = 0; c < set->nchannels; c++)
        if (!isfinite(value[c]))
            return SLV_BAKE_NAN;
    for (uint32_t c = 0; c < 4; c++)
        sum[c] += value[c];
    return SLV_BAKE_HIT;
}

void slvi_uv_place(const float *corners, double u, double v, double out[2]) {
    for (int axis = 0; axis < 2; axis++) {
        double low =
            (double)corners[axis] + ((double)corners[2 + axis] - (double)corners[axis]) * u;
        double high =
            (double)corners[6 + axis] + ((double)corners[4 + axis] - (double)corners[6 + axis]) * u;
        out[axis] = low + (high - low) * v;
    }
}

slv_bake_miss slvi_uv_careful(const uv_face *f, uint32_t x, uint32_t y, float *out) {
    uint32_t n = f->source->set.nchannels;
    uint64_t count[SLV_BAKE_MISSES] = {0};
    double sum[4] = {0};
    for (uint32_t j = 0; j < f->nv; j++)
        for (uint32_t i = 0; i < f->nu; i++) {
            double at[2];
            slvi_uv_place(f->corners, ((double)x + (i + 0.5) / f->nu) / f->width,
                          ((double)y + (j + 0.5) / f->nv) / f->height, at);
            count[slvi_uv_sample_at(f, at[0], at[1], sum)]++;
        }
    for (uint32_t c = 0; c < n; c++)
        out[c] = count[SLV_BAKE_HIT] ? (float)(sum[c] / (double)count[SLV_BAKE_HIT]) : 0;
    if (count[SLV_BAKE_HIT])
        return SLV_BAKE_HIT;
    return count[SLV_BAKE_NAN] ? SLV_BAKE_NAN : SLV_BAKE_NO_TILE;
}
