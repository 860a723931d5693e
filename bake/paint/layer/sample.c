/* Texels of a plane at another resolution: means of those that are smaller, and between those that
 * are larger bilinearly, across edges. */
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
} view;

static slv_res coarser(slv_res a, slv_res b) {
    return (slv_res){a.u < b.u ? a.u : b.u, a.v < b.v ? a.v : b.v};
}

/* Whether a texel is in a block that nothing was put into, of a plane whose fill is not seen. */
static bool is_clear(const slvi_plane *plane, uint32_t face, uint32_t x, uint32_t y) {
    const slvi_table *table = plane->tables[face];
    slv_res res = plane->res[face];
    if (plane->filled && (plane->alpha < 0 || plane->fill[plane->alpha] != 0))
        return false;
    return !table || !table->blocks[(y >> slvi_block_log2(res.v)) * slvi_blocks_along(res.u) +
                                    (x >> slvi_block_log2(res.u))];
}

/* The mean of the texels of a face that one at `res` covers: colours by their alpha. */
static void mean(const slvi_plane *plane, uint32_t face, slv_res res, uint32_t x, uint32_t y,
                 float *out) {
    int du = plane->res[face].u - res.u, dv = plane->res[face].v - res.v;
    float row[SLVI_BLOCK_SIDE * SLVI_MOST_CHANNELS];
    double sum[SLVI_MOST_CHANNELS] = {0}, weight = 0;
    uint32_t n = plane->nchannels, width = 1u << du, height = 1u << dv;
    uint32_t piece = width < SLVI_BLOCK_SIDE ? width : SLVI_BLOCK_SIDE;
    if (!du && !dv) {
        slvi_plane_read(plane, face, (slv_rect){x, y, 1, 1}, out);
        return;
    }
    for (uint32_t j = 0; j < height; j++)
        for (uint32_t i = 0; i < width; i += piece) {
            if (is_clear(plane, face, (x << du) + i, (y << dv) + j)) {
                weight += plane->alpha < 0 ? piece : 0;
                continue;
            }
            slvi_plane_read(plane, face, (slv_rect){(x << du) + i, (y << dv) + j, piece, 1}, row);
            for (uint32_t k = 0; k < piece; k++) {
                double alpha = plane->alpha >= 0 ? (double)row[k * n + (uint32_t)plane->alpha] : 1;
                for (uint32_t c = 0; c < n; c++)
                    sum[c] += (double)row[k * n + c] * ((int32_t)c == plane->alpha ? 1 : alpha);
                weight += alpha;
            }
        }
    for (uint32_t c = 0; c < n; c++)
        out[c] = (int32_t)c == plane->alpha ? (float)ldexp(sum[c], -du - dv)
                 : weight > 0               ? (float)(sum[c] / weight)
                                            : 0;
}

/* A texel of a view, which may lie a texel outside of the face. */
static void tap(const view *v, int32_t x, int32_t y, float *out) {
    int32_t width = 1 << v->res.u, height = 1 << v->res.v, face = (int32_t)v->face;
    int32_t inside_x = x < 0 ? 0 : x < width ? x : width - 1;
    int32_t inside_y = y < 0 ? 0 : y < height ? y : height - 1;
    float s = ((float)x + 0.5f) / (float)width, t = ((float)y + 0.5f) / (float)height;
    if ((inside_x == x && inside_y == y) || !v->adjacency ||
        !slv_adjacency_resolve(v->adjacency, false, &face, &s, &t)) {
        mean(v->plane, v->face, v->res, (uint32_t)inside_x, (uint32_t)inside_y, out);
        return;
    }
    int8_t most = v->res.u > v->res.v ? v->res.u : v->res.v;
    slv_res res = coarser(v->plane->res[face], (slv_res){most, most});
    float last_x = (float)((1u << res.u) - 1), last_y = (float)((1u << res.v) - 1);
    float px = floorf(s * (float)(1u << res.u)), py = floorf(t * (float)(1u << res.v));
    mean(v->plane, (uint32_t)face, res, (uint32_t)fmaxf(0, fminf(px, last_x)),
         (uint32_t)fmaxf(0, fminf(py, last_y)), out);
}

/* Four texels around a place, colours by their alpha. */
static void between(const view *v, float x, float y, float *out) {
    const slvi_plane *plane = v->plane;
    float left = floorf(x), low = floorf(y), weight = 0, sum[SLVI_MOST_CHANNELS] = {0};
    float texel[SLVI_MOST_CHANNELS];
    for (int k = 0; k < 4; k++) {
        float share = slvi_bilinear_share(x - left, y - low, k);
        if (!(share > 0))
            continue;
        tap(v, (int32_t)left + (k & 1), (int32_t)low + (k >> 1), texel);
        float alpha = plane->alpha >= 0 ? share * texel[plane->alpha] : share;
        for (uint32_t c = 0; c < plane->nchannels; c++)
            sum[c] += texel[c] * ((int32_t)c == plane->alpha ? share : alpha);
        weight += alpha;
    }
    for (uint32_t c = 0; c < plane->nchannels; c++)
        out[c] = (int32_t)c == plane->alpha ? sum[c] : weight > 0 ? sum[c] / weight : 0;
}

void slvi_plane_sample(const slvi_plane *plane, const slv_adjacency *adjacency, uint32_t face,
                       slv_res res, slv_rect rect, float *out) {
    slv_res own = plane->res[face];
    view v = {plane, adjacency, face, coarser(own, res)};
    float step_x = ldexpf(1, v.res.u - res.u), step_y = ldexpf(1, v.res.v - res.v);
    if (own.u == res.u && own.v == res.v) {
        slvi_plane_read(plane, face, rect, out);
        return;
    }
    if (!plane->filled && !plane->tables[face] && own.u >= res.u && own.v >= res.v) {
        memset(out, 0, (size_t)rect.width * rect.height * plane->nchannels * sizeof *out);
        return;
    }
    for (uint32_t y = 0; y < rect.height; y++)
        for (uint32_t x = 0; x < rect.width; x++, out += plane->nchannels)
            between(&v, ((float)(rect.x + x) + 0.5f) * step_x - 0.5f,
                    ((float)(rect.y + y) + 0.5f) * step_y - 0.5f, out);
}
