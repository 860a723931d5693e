/* Texels of a plane at another resolution: means of those that are smaller, and between those that
 * are larger bilinearly, across edges. The larger ones around a piece are gathered first, in a
 * window, and so each is made but once for all texels of the piece between them. */
#include "layer/document_data.h"

#include "texture/bilinear.h"

#include <math.h>
#include <string.h>

/* A plane as seen at a resolution no finer than that of its faces. */
typedef struct view {
    const slvi_plane *plane;
    const slv_adjacency *adjacency;
    uint32_t face;
    slv_res res; /* that of the face, or that which is wanted where it is coarser */
    slvi_taps *taps;
} view;

static slv_res coarser(slv_res a, slv_res b) {
    return (slv_res){a.u < b.u ? a.u : b.u, a.v < b.v ? a.v : b.v};
}

static uint32_t least(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

/* Whether fill can be seen, where nothing was put. */
static bool fill_shows(const slvi_plane *plane) {
    return plane->filled && (plane->alpha < 0 || plane->fill[plane->alpha] != 0);
}

/* Whether nothing is seen of the blocks in which a rectangle lies. */
static bool is_clear(const slvi_plane *plane, uint32_t face, slv_rect rect) {
    const slvi_table *table = plane->tables[face];
    const slv_rect blocks = slvi_rect_blocks(plane->res[face], rect);
    const uint32_t along = slvi_blocks_along(plane->res[face].u);
    bool clear = !fill_shows(plane);
    for (uint32_t y = 0; table && clear && y < blocks.height; y++)
        for (uint32_t x = 0; clear && x < blocks.width; x++)
            clear = !table->blocks[(blocks.y + y) * along + blocks.x + x];
    return clear;
}

/* Adds texels first..end-1 of a row to the sums of those that cover 2^du of them. */
static inline void add_texels(const float *row, uint32_t first, uint32_t end, int du, uint32_t n,
                              int32_t alpha, double *sums) {
    for (uint32_t i = first; i < end; i++, row += n) {
        double *sum = sums + (size_t)(i >> du) * n, by = alpha >= 0 ? (double)row[alpha] : 1;
        for (uint32_t c = 0; c < n; c++)
            sum[c] += (double)row[c] * ((int32_t)c == alpha ? 1 : by);
    }
}

/* The means of the texels of a face that so many in a row at `res` cover: colours by their alpha.
 * Whether there is anything to be seen. */
static bool means(const slvi_plane *plane, uint32_t face, slv_res res, uint32_t x, uint32_t y,
                  uint32_t count, float *out) {
    const uint32_t n = plane->nchannels;
    const int32_t alpha = plane->alpha;
    int du = plane->res[face].u - res.u, dv = plane->res[face].v - res.v;
    uint32_t begin = x << du, end = (x + count) << du, low = y << dv, high = (y + 1) << dv;
    uint32_t side = 1u << slvi_block_log2(plane->res[face].v);
    float row[SLVI_BLOCK_SIDE * SLVI_MOST_CHANNELS];
    double sums[SLVI_BLOCK_SIDE * SLVI_MOST_CHANNELS] = {0};
    bool clear = is_clear(plane, face, (slv_rect){begin, low, end - begin, 1}), any = !clear;
    if (!du && !dv) {
        slvi_plane_read(plane, face, (slv_rect){x, y, count, 1}, out);
        return any;
    }
    for (uint32_t j = low; j < high; j++) {
        if (!(j & (side - 1)) && j > low)
            clear = is_clear(plane, face, (slv_rect){begin, j, end - begin, 1});
        any = any || !clear;
        for (uint32_t i = begin, next; !clear && i < end; i = next) {
            next = least((i | (SLVI_BLOCK_SIDE - 1)) + 1, end);
            const slv_rect piece = {i, j, next - i, 1};
            if (is_clear(plane, face, piece))
                continue;
            slvi_plane_read(plane, face, piece, row);
            if (n == 4 && alpha == 3)
                add_texels(row, i - begin, next - begin, du, 4, 3, sums);
            else
                add_texels(row, i - begin, next - begin, du, n, alpha, sums);
        }
    }
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t c = 0; c < n; c++) {
            const double *sum = sums + (size_t)i * n,
                         weight = alpha >= 0 ? sum[alpha] : ldexp(1, du + dv);
            *out++ = (int32_t)c == alpha ? (float)ldexp(sum[c], -du - dv)
                     : weight > 0        ? (float)(sum[c] / weight)
                                         : 0;
        }
    return any;
}

/* A texel of a view that lies outside of the face. */
static bool make_tap(const view *v, int32_t x, int32_t y, float *out) {
    int32_t width = 1 << v->res.u, height = 1 << v->res.v, face = (int32_t)v->face;
    float s = ((float)x + 0.5f) / (float)width, t = ((float)y + 0.5f) / (float)height;
    if (!v->adjacency || !slv_adjacency_resolve(v->adjacency, false, &face, &s, &t)) {
        int32_t inside_x = x < 0 ? 0 : x < width ? x : width - 1;
        int32_t inside_y = y < 0 ? 0 : y < height ? y : height - 1;
        return means(v->plane, v->face, v->res, (uint32_t)inside_x, (uint32_t)inside_y, 1, out);
    }
    int8_t most = v->res.u > v->res.v ? v->res.u : v->res.v;
    slv_res res = coarser(v->plane->res[face], (slv_res){most, most});
    float last_x = (float)((1u << res.u) - 1), last_y = (float)((1u << res.v) - 1);
    float px = floorf(s * (float)(1u << res.u)), py = floorf(t * (float)(1u << res.v));
    return means(v->plane, (uint32_t)face, res, (uint32_t)fmaxf(0, fminf(px, last_x)),
                 (uint32_t)fmaxf(0, fminf(py, last_y)), 1, out);
}

/* The same, made but once for all pieces: it may be the mean of a million. */
static bool tap(const view *v, int32_t x, int32_t y, float *out) {
    const uint32_t hash = ((uint32_t)(x + 1) + 31 * (uint32_t)(y + 1) + 7 * v->face +
                           (uint32_t)((uintptr_t)v->plane >> 4)) %
                          SLVI_TAPS;
    slvi_tap *at = &v->taps->list[hash];
    if (at->plane != v->plane || at->face != v->face || at->x != x || at->y != y) {
        *at = (slvi_tap){.plane = v->plane, .face = v->face, .x = x, .y = y};
        at->any = make_tap(v, x, y, at->texel);
    }
    memcpy(out, at->texel, v->plane->nchannels * sizeof *out);
    return at->any;
}

/* Where texels of a piece lie along an axis among those of a view. */
typedef struct span {
    int32_t first;                 /* of the view, maybe -1 */
    uint32_t count;                /* of it, the last of which may be beyond the face */
    uint32_t low[SLVI_BLOCK_SIDE]; /* from the first */
    float weight[SLVI_BLOCK_SIDE]; /* of the one after that */
} span;

static span make_span(int own, int wanted, uint32_t first, uint32_t count) {
    const float step = ldexpf(1, own - wanted);
    span out = {.first = (int32_t)floorf(((float)first + 0.5f) * step - 0.5f)};
    for (uint32_t i = 0; i < count; i++) {
        const float at = ((float)(first + i) + 0.5f) * step - 0.5f, low = floorf(at);
        out.low[i] = (uint32_t)((int32_t)low - out.first);
        out.weight[i] = at - low;
        out.count = out.low[i] + 1 + (out.weight[i] > 0);
    }
    return out;
}

/* The view's texels at two spans. Whether there is anything to be seen of them. */
static bool gather(const view *v, const span *u, const span *w, float *out) {
    const int32_t width = 1 << v->res.u, height = 1 << v->res.v;
    const int32_t end = u->first + (int32_t)u->count;
    const uint32_t n = v->plane->nchannels;
    const int32_t left = u->first > 0 ? u->first : 0, right = end < width ? end : width;
    bool any = false;
    for (int32_t y = w->first; y < w->first + (int32_t)w->count; y++, out += u->count * n) {
        const bool inside = y >= 0 && y < height;
        if (inside)
            any |= means(v->plane, v->face, v->res, (uint32_t)left, (uint32_t)y,
                         (uint32_t)(right - left), out + (left - u->first) * (int32_t)n);
        for (int32_t x = u->first; x < end; x++)
            if (!inside || x < left || x >= right)
                any |= tap(v, x, y, out + (x - u->first) * (int32_t)n);
    }
    return any;
}

/* A row of texels between two rows of others, colours by their alpha. */
static inline void mix_row(const float *const rows[2], const span *u, float up, uint32_t width,
                           uint32_t n, int32_t alpha, float *out) {
    for (uint32_t x = 0; x < width; x++, out += n) {
        float weight = 0, sum[SLVI_MOST_CHANNELS] = {0}, by[SLVI_MOST_CHANNELS];
        for (int k = 0; k < 4; k++) {
            const float share = slvi_bilinear_share(u->weight[x], up, k);
            const float *texel = rows[k >> 1] + (size_t)(u->low[x] + (k & 1)) * n;
            if (!(share > 0)) /* what is there may not have been gathered */
                continue;
            const float all = alpha >= 0 ? share * texel[alpha] : share;
            for (uint32_t c = 0; c < n; c++)
                by[c] = (int32_t)c == alpha ? share : all;
            for (uint32_t c = 0; c < n; c++)
                sum[c] += texel[c] * by[c];
            weight += all;
        }
        for (uint32_t c = 0; c < n; c++)
            out[c] = (int32_t)c == alpha ? sum[c] : weight > 0 ? sum[c] / weight : 0;
    }
}

/* A rectangle of a face at a resolution finer than the view's, or as fine. */
static bool between(const view *v, slv_res res, slv_rect rect, float *out) {
    const uint32_t n = v->plane->nchannels;
    const int32_t alpha = v->plane->alpha;
    const span u = make_span(v->res.u, res.u, rect.x, rect.width);
    const span w = make_span(v->res.v, res.v, rect.y, rect.height);
    float window[SLVI_BLOCK_SIDE * SLVI_BLOCK_SIDE * SLVI_MOST_CHANNELS];
    if (!gather(v, &u, &w, window))
        return false;
    for (uint32_t y = 0; y < rect.height; y++, out += rect.width * n) {
        const float *low = window + (size_t)w.low[y] * u.count * n;
        const float *const rows[2] = {low, low + (size_t)u.count * n};
        if (n == 4 && alpha == 3)
            mix_row(rows, &u, w.weight[y], rect.width, 4, 3, out);
        else if (n == 1 && alpha < 0)
            mix_row(rows, &u, w.weight[y], rect.width, 1, -1, out);
        else
            mix_row(rows, &u, w.weight[y], rect.width, n, alpha, out);
    }
    return true;
}

bool slvi_plane_sample(const slvi_plane *plane, const slv_adjacency *adjacency, uint32_t face,
                       slv_res res, slv_rect rect, slvi_taps *taps, float *out) {
    const slv_res own = plane->res[face];
    const view v = {plane, adjacency, face, coarser(own, res), taps};
    const bool same = own.u == res.u && own.v == res.v;
    const bool any = same ? !is_clear(plane, face, rect) : between(&v, res, rect, out);
    if (any && same)
        slvi_plane_read(plane, face, rect, out);
    if (!any)
        memset(out, 0, (size_t)rect.width * rect.height * plane->nchannels * sizeof *out);
    return any;
}
