/* The mean of UV images over texels: samples at half a pixel's distance or less, along lines that
 * are straight in the images because faces are bilinear there, block by block of texels, the pixels
 * under one being decoded once. */
#include "source/source.h"
#include "uv/sample.h"

#include "base/log.h"
#include "base/memory.h"

#include <selvage/wrap.h>

#include <math.h>
#include <string.h>

#define MARGIN 0.01                         /* pixels: what rounding may do to a place */
enum { BLOCK = 32, MOST_PIXELS = 1 << 14 }; /* texels a side; pixels that are decoded at once */
#define MOST_SAMPLES (UINT64_C(1) << 26)    /* a face, or 4 a texel */

typedef struct uv_source {
    slv_bake_source base;
    uv_set set;
    float *corners; /* 8 a face */
    float *once;    /* those of a mesh with one value a vertex, if a coordinate goes round */
    bool round[2];
    int32_t *cells; /* 4 a face: u0, v0, u1, v1 of the cells that filters reach, both included */
    slv_uv_tile *squares; /* of the tiles */
} uv_source;

/* A face as it is sampled. */
typedef struct uv_face {
    const uv_source *source;
    const float *corners;
    const int32_t *cells;
    int32_t own[4];  /* cells of the face itself */
    uint32_t nu, nv; /* samples a texel along each axis */
    uint32_t width, height;
} uv_face;

static const float *corners_of(const uv_source *s, uint32_t face) {
    return s->corners + 8 * (size_t)face;
}

/* ---- which cells belong to a face ---- */

static void own_cells(const float *corners, int32_t cells[4]) {
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

static void widen(int32_t cells[4], const int32_t other[4]) {
    for (int axis = 0; axis < 2; axis++) {
        cells[axis] = cells[axis] < other[axis] ? cells[axis] : other[axis];
        cells[2 + axis] = cells[2 + axis] > other[2 + axis] ? cells[2 + axis] : other[2 + axis];
    }
}

static slv_result find_cells(const slv_env *env, const slv_mesh *mesh, uv_source *s) {
    slv_adjacency *adjacency = NULL;
    slv_result result =
        slvi_alloc(env, "bake: cells", s->base.nfaces, 4 * sizeof *s->cells, &s->cells);
    if (result || !s->set.udim || (result = slv_mesh_adjacency(env, mesh, &adjacency)))
        return result;
    for (uint32_t face = 0; face < s->base.nfaces; face++) {
        int32_t *cells = s->cells + 4 * (size_t)face, other[4];
        if (isnan(corners_of(s, face)[0]))
            continue;
        own_cells(corners_of(s, face), cells);
        for (unsigned edge = 0; edge < 4; edge++) {
            slv_neighbour next[2];
            uint32_t count = slv_adjacency_neighbours(adjacency, (int32_t)face, edge, next);
            for (uint32_t i = 0; i < count; i++) {
                const float *there = corners_of(s, (uint32_t)next[i].face);
                if (isnan(there[0]) ||
                    !slv_uv_continues(corners_of(s, face), edge, &next[i], there, false, false))
                    continue;
                own_cells(there, other);
                widen(cells, other);
            }
        }
    }
    slv_adjacency_destroy(adjacency);
    return SLV_OK;
}

/* ---- how densely ---- */

/* Pixels along an axis of a face: the longer of its two sides there, and the mean of them. */
static void sides_of(const uv_source *s, const float *corners, float longest[2], float mean[2]) {
    uint32_t width = 0, height = 0;
    float middle[2] = {0.25f * (corners[0] + corners[2] + corners[4] + corners[6]),
                       0.25f * (corners[1] + corners[3] + corners[5] + corners[7])};
    const uv_tile *tile =
        slvi_uv_set_at(&s->set, (int32_t)floorf(middle[0]), (int32_t)floorf(middle[1]));
    /* where there is none, as densely as the widest of the others would have it */
    for (uint32_t i = 0; !tile && i < s->set.ntiles; i++)
        if (s->set.tiles[i].width > width)
            width = s->set.tiles[i].width, height = s->set.tiles[i].height;
    if (tile)
        width = tile->width, height = tile->height;
    static const unsigned from[2][2] = {{0, 3}, {0, 1}}, to[2][2] = {{1, 2}, {3, 2}};
    for (int axis = 0; axis < 2; axis++) {
        float length[2];
        for (int k = 0; k < 2; k++) {
            const float *a = corners + 2 * (size_t)from[axis][k],
                        *b = corners + 2 * (size_t)to[axis][k];
            length[k] = hypotf((b[0] - a[0]) * (float)width, (b[1] - a[1]) * (float)height);
        }
        longest[axis] = fmaxf(length[0], length[1]);
        mean[axis] = 0.5f * (length[0] + length[1]);
    }
}

static uint32_t samples_for(float pixels, uint32_t texels) {
    float each = 2 * pixels / (float)texels - 0.01f;
    return each > 1 ? each < 65536 ? (uint32_t)ceilf(each) : 65536 : 1;
}

static uv_face begin_face(const uv_source *s, uint32_t face, slv_res res) {
    uv_face f = {.source = s,
                 .corners = corners_of(s, face),
                 .cells = s->cells + 4 * (size_t)face,
                 .width = 1u << res.u,
                 .height = 1u << res.v};
    float longest[2], mean[2];
    own_cells(f.corners, f.own);
    sides_of(s, f.corners, longest, mean);
    f.nu = samples_for(longest[0], f.width);
    f.nv = samples_for(longest[1], f.height);
    uint64_t texels = (uint64_t)f.width * f.height;
    uint64_t most = MOST_SAMPLES > 4 * texels ? MOST_SAMPLES : 4 * texels;
    while ((uint64_t)f.nu * f.nv > most / texels)
        if (f.nu > f.nv)
            f.nu = (f.nu + 1) / 2;
        else
            f.nv = (f.nv + 1) / 2;
    return f;
}

/* ---- samples anywhere ---- */

static int32_t clamp_to(int32_t x, int32_t low, int32_t high) {
    return x < low ? low : x > high ? high : x;
}

/* A pixel next to a sample whose own tile is that of `cell`; (x, y) may be one beyond it. */
static const uv_tile *reach(const uv_face *f, const uv_tile *tile, const int32_t cell[2],
                            int32_t *x, int32_t *y) {
    const uv_set *set = &f->source->set;
    int32_t w = (int32_t)tile->width, h = (int32_t)tile->height;
    int32_t du = *x < 0 ? -1 : *x >= w, dv = *y < 0 ? 1 : *y >= h ? -1 : 0;
    if (!du && !dv)
        return tile;
    if (!set->udim && set->wrap == SLV_BAKE_WRAP_REPEAT) {
        *x = set->ends[0] ? clamp_to(*x, 0, w - 1) : (*x + w) % w;
        *y = set->ends[1] ? clamp_to(*y, 0, h - 1) : (*y + h) % h;
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
    *x = clamp_to(*x, 0, w - 1);
    *y = clamp_to(*y, 0, h - 1);
    return tile;
}

/* A sample at texture coordinates, added to `sum` if it is there. */
static slv_bake_miss sample_at(const uv_face *f, double u, double v, double *sum) {
    const uv_set *set = &f->source->set;
    int32_t cell[2] = {clamp_to((int32_t)floor(u), f->own[0], f->own[2]),
                       clamp_to((int32_t)floor(v), f->own[1], f->own[3])};
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
        const uv_tile *from = reach(f, tile, cell, &px, &py);
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

static void place(const float *corners, double u, double v, double out[2]) {
    for (int axis = 0; axis < 2; axis++) {
        double low =
            (double)corners[axis] + ((double)corners[2 + axis] - (double)corners[axis]) * u;
        double high =
            (double)corners[6 + axis] + ((double)corners[4 + axis] - (double)corners[6 + axis]) * u;
        out[axis] = low + (high - low) * v;
    }
}

/* The mean of a texel of which some samples may be missing. */
static slv_bake_miss careful(const uv_face *f, uint32_t x, uint32_t y, float *out) {
    uint32_t n = f->source->set.nchannels;
    uint64_t count[SLV_BAKE_MISSES] = {0};
    double sum[4] = {0};
    for (uint32_t j = 0; j < f->nv; j++)
        for (uint32_t i = 0; i < f->nu; i++) {
            double at[2];
            place(f->corners, ((double)x + (i + 0.5) / f->nu) / f->width,
                  ((double)y + (j + 0.5) / f->nv) / f->height, at);
            count[sample_at(f, at[0], at[1], sum)]++;
        }
    for (uint32_t c = 0; c < n; c++)
        out[c] = count[SLV_BAKE_HIT] ? (float)(sum[c] / (double)count[SLV_BAKE_HIT]) : 0;
    if (count[SLV_BAKE_HIT])
        return SLV_BAKE_HIT;
    return count[SLV_BAKE_NAN] ? SLV_BAKE_NAN : SLV_BAKE_NO_TILE;
}

/* ---- blocks of texels ---- */

/* Where the results of a rectangle of texels go. */
typedef struct uv_work {
    const slv_env *env;
    uv_pixel *pixels; /* MOST_PIXELS, of a window */
    slv_rect whole;
    float *values;
    uint8_t *misses;
} uv_work;

/* The part of one tile that a block of texels lies on, in pixels, with those around it. */
typedef struct uv_part {
    const uv_tile *tile;
    int32_t cell[2], left, top;
    uint32_t width, height;
} uv_part;

static bool find_part(const uv_face *f, slv_rect rect, uv_part *part) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY}, at[2];
    for (int k = 0; k < 4; k++) {
        place(f->corners, (double)(rect.x + (k & 1 ? rect.width : 0)) / f->width,
              (double)(rect.y + (k & 2 ? rect.height : 0)) / f->height, at);
        for (int axis = 0; axis < 2; axis++) {
            low[axis] = fmin(low[axis], at[axis]);
            high[axis] = fmax(high[axis], at[axis]);
        }
    }
    for (int axis = 0; axis < 2; axis++) {
        part->cell[axis] = clamp_to((int32_t)floor(low[axis]), f->own[axis], f->own[2 + axis]);
        if (low[axis] < part->cell[axis] || high[axis] > part->cell[axis] + 1)
            return false;
    }
    part->tile = slvi_uv_set_at(&f->source->set, part->cell[0], part->cell[1]);
    if (!part->tile)
        return false;
    double w = part->tile->width, h = part->tile->height;
    part->left = (int32_t)floor((low[0] - part->cell[0]) * w - 0.5 - MARGIN);
    part->top = (int32_t)floor((part->cell[1] + 1 - high[1]) * h - 0.5 - MARGIN);
    double right = floor((high[0] - part->cell[0]) * w - 0.5 + MARGIN) + 1,
           bottom = floor((part->cell[1] + 1 - low[1]) * h - 0.5 + MARGIN) + 1;
    part->left = part->left < -1 ? -1 : part->left;
    part->top = part->top < -1 ? -1 : part->top;
    part->width = (uint32_t)((right < w ? right : w) - part->left) + 1;
    part->height = (uint32_t)((bottom < h ? bottom : h) - part->top) + 1;
    return (uint64_t)part->width * part->height <= MOST_PIXELS;
}

/* The pixels of a part, those beyond the tile's edge as a filter finds them there. */
static void decode_part(const uv_face *f, const uv_part *part, uv_pixel *out) {
    const uv_tile *tile = part->tile;
    uint32_t n = f->source->set.nchannels;
    for (uint32_t j = 0; j < part->height; j++, out += part->width) {
        int32_t y = part->top + (int32_t)j, x = part->left;
        bool inside = y >= 0 && y < (int32_t)tile->height;
        for (uint32_t i = 0; i < part->width;) {
            int32_t px = x + (int32_t)i, py = y;
            uint32_t run = 1;
            const uv_tile *from = tile;
            if (inside && px >= 0 && px < (int32_t)tile->width) {
                uint32_t left = tile->width - (uint32_t)px;
                run = part->width - i < left ? part->width - i : left;
            } else {
                from = reach(f, tile, part->cell, &px, &py);
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
            place(f->corners, u, v, from);
            place(f->corners, u + step, v, to);
            const uv_line line = {.x = (float)((from[0] - part->cell[0]) * w - 0.5 - part->left),
                                  .y = (float)((part->cell[1] + 1 - from[1]) * h - 0.5 - part->top),
                                  .dx = (float)((to[0] - from[0]) * w),
                                  .dy = (float)((from[1] - to[1]) * h)};
            slvi_uv_sum_line(&window, &line, f->nu, rect.width, sums);
        }
        size_t at = (size_t)(y - work->whole.y) * work->whole.width + (rect.x - work->whole.x);
        float *out = work->values + at * n;
        for (uint32_t i = 0; i < rect.width; i++, out += n) {
            for (uint32_t c = 0; c < n; c++)
                out[c] = sums[i][c] * scale;
            if (!finite_all(out, n))
                work->misses[at + i] = (uint8_t)careful(f, rect.x + i, y, out);
        }
    }
}

/* Halves a block until it lies on one part of one tile, or is a texel that does not. */
static void fill_block(const uv_face *f, uv_work *work, slv_rect rect) {
    uv_part part;
    if (find_part(f, rect, &part)) {
        fill_part(f, &part, work, rect);
    } else if (rect.width == 1 && rect.height == 1) {
        size_t at = (size_t)(rect.y - work->whole.y) * work->whole.width + (rect.x - work->whole.x);
        work->misses[at] =
            (uint8_t)careful(f, rect.x, rect.y, work->values + at * f->source->set.nchannels);
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

/* Colours as painted again. */
static void unmultiply(uint32_t n, float *values, size_t count) {
    for (size_t i = 0; i < count; i++, values += n)
        for (uint32_t c = 0; c + 1 < n && values[n - 1] > 0; c++)
            values[c] /= values[n - 1];
}

static slv_result evaluate(const slv_bake_source *source, const slv_env *env, uint32_t face,
                           slv_res res, slv_rect rect, float *values, uint8_t *misses) {
    const uv_source *s = (const uv_source *)source;
    uint32_t n = s->set.nchannels;
    if (isnan(corners_of(s, face)[0])) {
        memset(misses, SLV_BAKE_NO_UV, (size_t)rect.width * rect.height);
        return SLV_OK;
    }
    const uv_face f = begin_face(s, face, res);
    uv_work work = {.env = env, .whole = rect, .values = values, .misses = misses};
    slv_result result =
        slvi_alloc_aligned(env, "bake: pixels", 64, MOST_PIXELS, sizeof *work.pixels, &work.pixels);
    if (result)
        return result;
    for (uint32_t y = 0; y < rect.height; y += BLOCK)
        for (uint32_t x = 0; x < rect.width; x += BLOCK) {
            slv_rect block = {rect.x + x, rect.y + y, rect.width - x, rect.height - y};
            block.width = block.width < BLOCK ? block.width : BLOCK;
            block.height = block.height < BLOCK ? block.height : BLOCK;
            fill_block(&f, &work, block);
        }
    slvi_free(work.pixels);
    if (s->set.alpha >= 0)
        unmultiply(n, values, (size_t)rect.width * rect.height);
    return SLV_OK;
}

static void extent(const slv_bake_source *source, uint32_t face, float size[2]) {
    const uv_source *s = (const uv_source *)source;
    float longest[2];
    size[0] = size[1] = 0;
    if (!isnan(corners_of(s, face)[0]))
        sides_of(s, corners_of(s, face), longest, size);
}

static const slv_bake_tile *tiles(const slv_bake_source *source, uint32_t *count) {
    const uv_source *s = (const uv_source *)source;
    *count = s->set.ntiles;
    return s->set.list;
}

/* ---- as images ---- */

static void none_color(float rgba[4]) {
    slv_bake_miss_color(SLV_BAKE_NO_TILE, rgba);
    slv_texels_decode(3, SLV_NO_ALPHA, rgba, 1);
    rgba[3] = 1;
}

static void as_rgba(const uv_set *set, const double *value, float rgba[4]) {
    bool grey = set->nchannels < 3;
    for (uint32_t c = 0; c < 3; c++)
        rgba[c] = (float)value[grey ? 0 : c];
    rgba[3] = set->alpha >= 0 ? (float)value[set->alpha] : 1;
    if (!isfinite(rgba[0]) || !isfinite(rgba[1]) || !isfinite(rgba[2]) || !isfinite(rgba[3]))
        none_color(rgba);
}

static void read_pixels(const void *user, uint32_t tile, uint32_t x, uint32_t y, uint32_t count,
                        float *rgba) {
    const uv_set *set = &((const uv_source *)user)->set;
    for (uint32_t i = 0; i < count; i++, rgba += 4) {
        uv_pixel pixel;
        slvi_uv_decode(&set->tiles[tile], set->nchannels, x + i, y, 1, &pixel);
        const double value[4] = {(double)pixel[0], (double)pixel[1], (double)pixel[2],
                                 (double)pixel[3]};
        as_rgba(set, value, rgba);
    }
}

static void color_at(const void *user, uint32_t face, float u, float v, float rgba[4]) {
    const uv_source *s = user;
    uv_face f = {.source = s, .corners = corners_of(s, face), .cells = s->cells + 4 * (size_t)face};
    double at[2], sum[4] = {0};
    none_color(rgba);
    if (isnan(f.corners[0]))
        return;
    own_cells(f.corners, f.own);
    place(f.corners, (double)u, (double)v, at);
    if (sample_at(&f, at[0], at[1], sum) == SLV_BAKE_HIT)
        as_rgba(&s->set, sum, rgba);
}

static void images(const slv_bake_source *source, slv_uv_images *out) {
    const uv_source *s = (const uv_source *)source;
    *out = (slv_uv_images){.nfaces = s->base.nfaces,
                           .texcoords = s->once ? s->once : s->corners,
                           .round_u = s->round[0],
                           .round_v = s->round[1],
                           .tiled = s->set.udim || s->set.wrap == SLV_BAKE_WRAP_NONE,
                           .repeat_u = s->set.wrap == SLV_BAKE_WRAP_REPEAT && !s->set.ends[0],
                           .repeat_v = s->set.wrap == SLV_BAKE_WRAP_REPEAT && !s->set.ends[1],
                           .wide = s->set.type == SLV_TYPE_FLOAT || s->set.type == SLV_TYPE_U16,
                           .narrow = s->set.type == SLV_TYPE_U8 && s->set.alpha < 0,
                           .data = s->set.encoding != SLV_TEXTURE_SRGB,
                           .ntiles = s->set.ntiles,
                           .tiles = s->squares,
                           .pixels = read_pixels,
                           .color = color_at,
                           .user = s};
    none_color(out->none);
}

static slv_result list_squares(const slv_env *env, uv_source *s) {
    slv_result result =
        slvi_alloc(env, "bake: tiles", s->set.ntiles, sizeof *s->squares, &s->squares);
    for (uint32_t i = 0; i < s->set.ntiles && !result; i++) {
        const slv_bake_tile *tile = &s->set.list[i];
        int32_t cell = tile->number ? (int32_t)tile->number - UV_FIRST_TILE : 0;
        s->squares[i] =
            (slv_uv_tile){cell % UV_CELLS_U, cell / UV_CELLS_U, tile->width, tile->height};
    }
    return result;
}

static void destroy(slv_bake_source *source) {
    uv_source *s = (uv_source *)source;
    slvi_free(s->squares);
    slvi_uv_set_free(&s->set);
    slvi_free(s->corners);
    slvi_free(s->once);
    slvi_free(s->cells);
    slvi_free(s);
}

/* What is drawn has one value a vertex, in 0..1; what is looked up here leaves that. */
static slv_result go_round(const slv_env *env, uv_source *s) {
    size_t count = (size_t)s->base.nfaces * 8;
    slv_result result =
        slvi_alloc_plain(env, "bake: texture coordinates", count, sizeof *s->once, &s->once);
    for (size_t i = 0; i < count && !result; i++)
        s->once[i] = s->round[i & 1] ? s->corners[i] - floorf(s->corners[i]) : s->corners[i];
    return result;
}

/* Of a face over half of the map both ways round are as short, or the wrong one is. */
static void warn_of_wide(const slv_env *env, const char *path, const uv_source *s) {
    uint32_t wide = 0, first = 0;
    for (uint32_t face = 0; face < s->base.nfaces; face++) {
        const float *corners = corners_of(s, face);
        bool is_wide = false;
        for (int axis = 0; axis < 2 && !isnan(corners[0]); axis++) {
            float low = corners[axis], high = corners[axis];
            for (int c = 1; c < 4; c++) {
                low = fminf(low, corners[2 * c + axis]);
                high = fmaxf(high, corners[2 * c + axis]);
            }
            is_wide |= s->round[axis] && high - low > 0.5f - 1e-5f;
        }
        first = is_wide && !wide ? face : first;
        wide += is_wide;
    }
    if (wide)
        slvi_logf(
            env, SLV_LOG_WARNING,
            "%s: %u of %u faces span half of the map or more along what goes round, and may be "
            "taken the wrong way: the first is face %u",
            path, wide, s->base.nfaces, first);
}

slv_result slv_bake_from_uv(const slv_env *env, const slv_mesh *mesh, const char *path,
                            const slv_bake_uv *params, slv_bake_source **out) {
    static const slv_bake_uv none = {0};
    static const slvi_bake_fns fns = {evaluate, extent, tiles, destroy, images};
    uv_source *s = NULL;
    *out = NULL;
    slv_result result = slvi_alloc(env, "bake: UV image", 1, sizeof *s, &s);
    if (result)
        return result;
    s->base = (slv_bake_source){.fns = &fns, .nfaces = slv_mesh_face_count(mesh)};
    slv_bake_uv chosen = params ? *params : none;
    s->round[0] = chosen.round_u;
    s->round[1] = chosen.round_v;
    if ((s->round[0] || s->round[1]) && strstr(path, SLV_BAKE_UDIM)) {
        result = slvi_fail(env, SLV_ERROR_ARGUMENT,
                           "%s: coordinates that go round take one image, which repeats, and no "
                           "set of tiles",
                           path);
        goto done;
    }
    if ((result = slv_mesh_round_texcoords(env, mesh, s->round[0], s->round[1], &s->corners)))
        goto done;
    if (s->base.nfaces && slvi_uv_check_corners(s->corners, s->base.nfaces) == s->base.nfaces) {
        result = slvi_fail(env, SLV_ERROR_MISMATCH,
                           "%s: the mesh has no texture coordinates (vt) to look it up with, or "
                           "none that are within 65536",
                           path);
        goto done;
    }
    if ((s->round[0] || s->round[1]) && (result = go_round(env, s)))
        goto done;
    if (s->round[0] || s->round[1])
        warn_of_wide(env, path, s);
    const bool along = (s->round[0] || s->round[1]) && !chosen.wrap;
    if (along)
        chosen.wrap = SLV_BAKE_WRAP_REPEAT;
    if ((result = slvi_uv_set_load(env, path, &chosen, s->corners, s->base.nfaces, &s->set)) ||
        (result = find_cells(env, mesh, s)) || (result = list_squares(env, s)))
        goto done;
    for (int axis = 0; axis < 2; axis++)
        s->set.ends[axis] =
            along && !s->round[axis] && slvi_uv_stays(s->corners, s->base.nfaces, axis);
    s->base.desc =
        (slv_bake_source_desc){s->set.type, s->set.nchannels, s->set.alpha, s->set.encoding};
    *out = &s->base;
    s = NULL;
done:
    if (s)
        destroy(&s->base);
    return result;
}
