/* Texels of UV images block by block, the pixels under one being decoded once. */
#include "uv/uv_source.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

#define MARGIN 0.01 /* pixels: what rounding may do to a place */
/* texels a side; pixels that are decoded at once, few enough for memory that is at hand */
enum { BLOCK = 32, MOST_PIXELS = 7 << 10, AHEAD = 4 };

/* Where the results of a rectangle of texels go. */
typedef struct uv_work {
    uv_pixel *pixels; /* MOST_PIXELS, of a window */
    slv_rect whole;
    float *values;
    uint8_t *misses;
} uv_work;

enum { LINES = 6 };

/* The part of one tile that a block of texels lies on, in pixels, with those around it. */
typedef struct uv_part {
    const uv_tile *tile;
    int32_t cell[2], left, top;
    uint32_t width, height;
    /* lines between any two corners of the block, each downwards: texels lie between them */
    float from[LINES][2], to[LINES][2], slope[LINES];
} uv_part;

static void draw_lines(double corners[4][2], uv_part *part) {
    static const int ends[LINES][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    float at[4][2];
    for (int k = 0; k < 4; k++) {
        at[k][0] = (float)((corners[k][0] - part->cell[0]) * part->tile->width - 0.5 - part->left);
        at[k][1] =
            (float)((part->cell[1] + 1 - corners[k][1]) * part->tile->height - 0.5 - part->top);
    }
    for (int k = 0; k < LINES; k++) {
        const bool down = at[ends[k][0]][1] <= at[ends[k][1]][1];
        const float *from = at[ends[k][!down]], *to = at[ends[k][down]];
        memcpy(part->from[k], from, sizeof part->from[k]);
        memcpy(part->to[k], to, sizeof part->to[k]);
        part->slope[k] = to[1] > from[1] ? (to[0] - from[0]) / (to[1] - from[1]) : 0;
    }
}

static bool find_part(const uv_face *f, slv_rect rect, uv_part *part) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, at[4][2];
    for (int k = 0; k < 4; k++) {
        slvi_uv_place(f->corners, (double)(rect.x + (k & 1 ? rect.width : 0)) / f->width,
                      (double)(rect.y + (k & 2 ? rect.height : 0)) / f->height, at[k]);
        for (int axis = 0; axis < 2; axis++) {
            low[axis] = fmin(low[axis], at[k][axis]);
            high[axis] = fmax(high[axis], at[k][axis]);
        }
    }
    const uv_set *set = &f->source->set;
    bool repeats[2];
    for (int axis = 0; axis < 2; axis++) {
        repeats[axis] = !set->udim && set->wrap == SLV_BAKE_WRAP_REPEAT && !set->ends[axis];
        part->cell[axis] = slvi_uv_clamp((int32_t)floor(low[axis]), f->own[axis], f->own[2 + axis]);
        if (low[axis] < part->cell[axis] || (high[axis] > part->cell[axis] + 1 && !repeats[axis]))
            return false;
    }
    part->tile = slvi_uv_set_at(set, part->cell[0], part->cell[1]);
    if (!part->tile)
        return false;
    double w = part->tile->width, h = part->tile->height;
    double left = floor((low[0] - part->cell[0]) * w - 0.5 - MARGIN),
           top = floor((part->cell[1] + 1 - high[1]) * h - 0.5 - MARGIN),
           right = floor((high[0] - part->cell[0]) * w - 0.5 + MARGIN) + 1,
           bottom = floor((part->cell[1] + 1 - low[1]) * h - 0.5 + MARGIN) + 1;
    if (!repeats[0]) {
        left = left < -1 ? -1 : left;
        right = right < w ? right : w;
    }
    if (!repeats[1]) {
        top = top < -1 ? -1 : top;
        bottom = bottom < h ? bottom : h;
    }
    if ((right - left + 1) * (bottom - top + 1) > MOST_PIXELS)
        return false;
    part->left = (int32_t)left;
    part->top = (int32_t)top;
    part->width = (uint32_t)(right - left) + 1;
    part->height = (uint32_t)(bottom - top) + 1;
    draw_lines(at, part);
    return true;
}

/* The pixels of row j that samples reach: those between the lines from a row above to one below. */
static void find_span(const uv_part *part, uint32_t j, uint32_t *first, uint32_t *end) {
    const float above = (float)j - 1 - (float)MARGIN, below = (float)j + 1 + (float)MARGIN;
    float low = INFINITY, high = -INFINITY;
    for (int k = 0; k < LINES; k++) {
        const float *from = part->from[k], *to = part->to[k];
        const float upper =
                        above > from[1] ? from[0] + (above - from[1]) * part->slope[k] : from[0],
                    lower = below < to[1] ? from[0] + (below - from[1]) * part->slope[k] : to[0],
                    left = upper < lower ? upper : lower, right = upper < lower ? lower : upper;
        const bool meets = above <= to[1] && below >= from[1];
        low = meets && left < low ? left : low;
        high = meets && right > high ? right : high;
    }
    low -= (float)MARGIN;
    high += 2 + (float)MARGIN;
    *first = low > 0 ? (uint32_t)low : 0;
    *end = high < (float)part->width ? high > 0 ? (uint32_t)high : 0 : part->width;
}

/* The memory of a row's pixels is asked for while rows before it are decoded: they are short, and
 * far from each other. */
static void ask_for_row(const uv_part *part, uint32_t n, uint32_t j, uint32_t first, uint32_t end) {
    enum { LINE = 64 };
    const uv_tile *tile = part->tile;
    const int32_t y = part->top + (int32_t)j, left = part->left + (int32_t)first,
                  right = part->left + (int32_t)end;
    const size_t size = slv_type_size(tile->type) * n;
    if (y < 0 || y >= (int32_t)tile->height || left < 0 || right > (int32_t)tile->width)
        return;
    const char *row = (const char *)tile->pixels + (size_t)y * tile->width * size;
    for (size_t at = (size_t)left * size; at < (size_t)right * size; at += LINE)
        __builtin_prefetch(row + at);
}

/* The pixels of a part, those beyond the tile's edge as a filter finds them there. */
static void decode_part(const uv_face *f, const uv_part *part, uv_pixel *out) {
    const uv_tile *tile = part->tile;
    uint32_t n = f->source->set.nchannels;
    for (uint32_t j = 0; j < part->height; j++, out += part->width) {
        int32_t y = part->top + (int32_t)j, x = part->left;
        bool inside = y >= 0 && y < (int32_t)tile->height;
        uint32_t i, end;
        find_span(part, j, &i, &end);
        ask_for_row(part, n, j + AHEAD, i, end);
        while (i < end) {
            int32_t px = x + (int32_t)i, py = y;
            uint32_t run = 1;
            const uv_tile *from = tile;
            if (inside && px >= 0 && px < (int32_t)tile->width) {
                uint32_t left = tile->width - (uint32_t)px;
                run = end - i < left ? end - i : left;
            } else {
                from = slvi_uv_reach(f, tile, part->cell, &px, &py);
            }
            slvi_uv_decode(from, n, (uint32_t)px, (uint32_t)py, run, out + i);
            i += run;
        }
    }
}

static bool finite_all(const float *values, uint32_t n) {
    for (uint32_t c = 0; c < n; c++)
        if (!isfinite(values[c]))
            return false;
    return true;
}

/* A row of sums as values; whether all of them are finite. */
static bool store_row(const uv_pixel *sums, float scale, uint32_t n, uint32_t width, float *out) {
    float row[BLOCK * 4];
    uv_pixel zero = {0};
    for (uint32_t i = 0; i < width; i++) {
        /* what is beyond the channels is written over by the next texel */
        const uv_pixel value = sums[i] * scale;
        memcpy(row + (size_t)i * n, &value, sizeof value);
        zero += value * 0.0f; /* NaN of what is not finite; channels that are not there are 0 */
    }
    memcpy(out, row, (size_t)width * n * sizeof *out);
    return zero[0] + zero[1] + zero[2] + zero[3] == 0;
}

/* Texels of a block on one part of a tile. */
static void fill_part(const uv_face *f, const uv_part *part, uv_work *work, slv_rect rect) {
    uint32_t n = f->source->set.nchannels;
    const uv_window window = {work->pixels, part->width};
    double step = 1.0 / ((double)f->width * f->nu), w = part->tile->width, h = part->tile->height;
    float scale = 1.0f / ((float)f->nu * (float)f->nv);
    decode_part(f, part, work->pixels);
    for (uint32_t y = rect.y; y < rect.y + rect.height; y++) {
        uv_pixel sums[BLOCK] = {{0}};
        for (uint32_t j = 0; j < f->nv; j++) {
            double v = ((double)y + (j + 0.5) / f->nv) / f->height, from[2], to[2];
            double u = (double)rect.x / f->width + 0.5 * step;
            slvi_uv_place(f->corners, u, v, from);
            slvi_uv_place(f->corners, u + step, v, to);
            const uv_line line = {.x = (float)((from[0] - part->cell[0]) * w - 0.5 - part->left),
                                  .y = (float)((part->cell[1] + 1 - from[1]) * h - 0.5 - part->top),
                                  .dx = (float)((to[0] - from[0]) * w),
                                  .dy = (float)((from[1] - to[1]) * h)};
            f->source->sum_line(&window, &line, f->nu, rect.width, sums);
        }
        size_t at = (size_t)(y - work->whole.y) * work->whole.width + (rect.x - work->whole.x);
        float *out = work->values + at * n;
        bool finite = store_row(sums, scale, n, rect.width, out);
        for (uint32_t i = 0; i < rect.width && !finite; i++, out += n)
            if (!finite_all(out, n))
                work->misses[at + i] = (uint8_t)slvi_uv_careful(f, rect.x + i, y, out);
    }
}

/* Halves a block until it lies on one part of one tile, or is a texel that does not. */
static void fill_block(const uv_face *f, uv_work *work, slv_rect rect) {
    uv_part part;
    if (find_part(f, rect, &part)) {
        fill_part(f, &part, work, rect);
    } else if (rect.width == 1 && rect.height == 1) {
        size_t at = (size_t)(rect.y - work->whole.y) * work->whole.width + (rect.x - work->whole.x);
        work->misses[at] = (uint8_t)slvi_uv_careful(f, rect.x, rect.y,
                                                    work->values + at * f->source->set.nchannels);
    } else {
        slv_rect half = rect, rest = rect;
        if (rect.width >= rect.height) {
            half.width /= 2;
            rest.x += half.width;
            rest.width -= half.width;
        } else {
            half.height /= 2;
            rest.y += half.height;
            rest.height -= half.height;
        }
        fill_block(f, work, half);
        fill_block(f, work, rest);
    }
}

slv_result slvi_uv_fill(const uv_face *f, const slv_env *env, slv_rect rect, float *values,
                        uint8_t *misses) {
    uv_work work = {.whole = rect, .values = values, .misses = misses};
    slv_result result =
        slvi_alloc_aligned(env, "bake: pixels", 64, MOST_PIXELS, sizeof *work.pixels, &work.pixels);
    if (result)
        return result;
    for (uint32_t y = 0; y < rect.height; y += BLOCK)
        for (uint32_t x = 0; x < rect.width; x += BLOCK) {
            slv_rect block = {rect.x + x, rect.y + y, rect.width - x, rect.height - y};
            block.width = block.width < BLOCK ? block.width : BLOCK;
            block.height = block.height < BLOCK ? block.height : BLOCK;
            fill_block(f, &work, block);
        }
    slvi_free(work.pixels);
    return SLV_OK;
}
