/* Lookups in squares of edges on the CPU, as the shader does them. */
#include "form/htex/htex_data.h"

#include "texture/bilinear.h"

#include <math.h>
#include <string.h>

static float clamp(float value, float low, float high) {
    return value > low ? value < high ? value : high : low; /* NaN becomes low */
}

/* Adds the bilinear value of a level at (s,t), clamped to the square, and turned if it is a vector.
 */
static void add_level(const slv_htex *htex, uint32_t edge, unsigned turns, uint32_t level, float s,
                      float t, float weight, float *out) {
    int8_t log2 = (int8_t)(htex->log2[edge] - level);
    slvi_bilinear at = slvi_bilinear_centred((slv_res){log2, log2}, s, t);
    size_t size = slv_type_size(htex->desc.type), texel = htex->texel_size, pitch = texel << log2;
    const unsigned char *texels = slv_htex_texels(htex, edge, level);
    for (uint32_t first = 0; first < htex->desc.nchannels; first += SLVI_BILINEAR_CHANNELS) {
        float value[SLVI_BILINEAR_CHANNELS];
        uint32_t left = htex->desc.nchannels - first;
        uint32_t count = left < SLVI_BILINEAR_CHANNELS ? left : SLVI_BILINEAR_CHANNELS;
        slvi_bilinear_typed(htex->desc.type, texels + first * size, texel, pitch, &at, count,
                            value);
        if (htex->vectors && first == 0)
            slvi_edge_turn_vector(turns, &value[0], &value[1]);
        for (uint32_t c = 0; c < count; c++)
            out[first + c] += weight * value[c];
    }
}

static void add_square(const slv_htex *htex, const slv_htex_face *face, uint32_t k, float s,
                       float t, float footprint, float weight, float *out) {
    uint32_t edge = face->edge[k], last = htex->log2[edge];
    float level = clamp(footprint + (float)htex->log2[edge], 0, (float)last);
    uint32_t fine = (uint32_t)level, coarse = fine < last ? fine + 1 : last;
    float fraction = level - (float)fine;
    if (weight <= 0)
        return;
    s = face->second[k] ? 1 - s : s;
    t = face->second[k] ? 1 - t : t;
    add_level(htex, edge, face->turns[k], fine, s, t, weight * (1 - fraction), out);
    if (fraction > 0)
        add_level(htex, edge, face->turns[k], coarse, s, t, weight * fraction, out);
}

/* Of the finer of two squares, so that both see the same at the side between them. */
static float finer_texel(const slv_htex *htex, const slv_htex_face *face, uint32_t a, uint32_t b,
                         float footprint) {
    uint8_t first = htex->log2[face->edge[a]], second = htex->log2[face->edge[b]];
    return exp2f(clamp(footprint, -(float)(first > second ? first : second), 0));
}

/* How much of the square across a side a lookup takes, at `from` the side and `along` it: half on
 * the side, none from half a texel on, nor where it is as far from the side as from the next
 * corner. */
static float across(float from, float along, float texel) {
    float corner = 2 * fminf(along, 1 - along);
    return clamp(0.5f - from / fmaxf(fminf(texel, corner), 1e-12f), 0, 1);
}

/* Goes over to the value of the nearest corner. */
static void join_corner(const slv_htex *htex, uint32_t corner, unsigned turns, float distance,
                        float footprint, float *out) {
    const slv_htex_corner *row = &htex->corners[corner];
    float log2 = clamp(-footprint, 0, row->log2), reach = 0.5f * exp2f(-log2);
    uint32_t coarse = (uint32_t)log2, fine = coarse < row->log2 ? coarse + 1 : coarse;
    float share = clamp(distance / reach, 0, 1);
    size_t n = htex->desc.nchannels;
    const float *a = htex->values + (row->first + coarse) * n,
                *b = htex->values + (row->first + fine) * n;
    if (htex->vectors) /* seen from there, and back again */
        slvi_edge_turn_vector(0u - turns, &out[0], &out[1]);
    for (size_t c = 0; c < n; c++) {
        float value = a[c] + (log2 - (float)coarse) * (b[c] - a[c]);
        out[c] = value + share * (out[c] - value);
    }
    if (htex->vectors)
        slvi_edge_turn_vector(turns, &out[0], &out[1]);
}

void slv_htex_lookup(const slv_htex *htex, uint32_t face, float u, float v, float width,
                     float *out) {
    const slv_htex_face *row = &htex->faces[face];
    uint32_t own;
    float s, t;
    u = clamp(u, 0, 1);
    v = clamp(v, 0, 1);
    if (row->part) {
        own = u >= v ? 2 : 1;
        s = own == 2 ? 1 - 0.5f * (u + v) : 0.5f * (v - u);
        t = own == 2 ? 0.5f * (u - v) : 1 - 0.5f * (u + v);
    } else {
        float x = u - 0.5f, y = v - 0.5f;
        bool of_v = fabsf(y) >= fabsf(x);
        own = slvi_edge_at(of_v, (of_v ? y : x) > 0);
        slvi_edge_turn(own, &x, &y);
        s = -x - y;
        t = x - y;
    }
    uint32_t after = slvi_edge_next(own), before = slvi_edge_before(own);
    /* log2 of the footprint's sides in units of a square */
    float footprint = log2f(fmaxf(width * (row->part ? 0.70710678f : 1.41421356f), 1e-12f));
    float to_after = across(s, t, finer_texel(htex, row, own, after, footprint));
    float to_before = across(t, s, finer_texel(htex, row, own, before, footprint));
    memset(out, 0, htex->desc.nchannels * sizeof *out);
    add_square(htex, row, own, s, t, footprint, 1 - to_after - to_before, out);
    add_square(htex, row, after, t, -s, footprint, to_after, out);
    add_square(htex, row, before, -t, s, footprint, to_before, out);
    float most = fmaxf(s, t);
    uint32_t start = s >= t ? own : after;
    join_corner(htex, most < 0.5f ? row->centre : row->start[start],
                row->turns[most < 0.5f ? 8 : 4 + start], most < 0.5f ? most : 1 - most, footprint,
                out);
}
