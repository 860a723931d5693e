/* The filter of triangle meshes: an elliptical gaussian over barycentric coordinates, cut at edges
 * and laid onto the neighbours as the Ptex library does (Heckbert 1989 for the ellipse). */
#include "filter/gather_template.h"

/* Pieces that go further come of files that make no sense. */
#define MAX_TRIANGLES 8

/* The ellipse a du^2 + b du dv + c dv^2 around (u,v), and the ranges of u, v and w = 1-u-v that a
 * piece of it covers: [0] u, [1] v, [2] w. */
typedef struct ellipse {
    float a, b, c;
    float at[3], low[3], high[3];
} ellipse;

/* Which coordinate is zero along an edge. */
static const int edge_coordinate[3] = {1, 2, 0};

/* Makes it no narrower than a texel and no more eccentric than 15 to 1. Returns the resolution. */
static int make_ellipse(const lookup_state *state, const slv_lookup *l, int face_res, ellipse *e) {
    const slv_sampler *s = state->sampler;
    const float big = 1e4f, root3 = 1.7320508f;
    float uw1 = fminf(fmaxf(l->uw1, -big), big), vw1 = fminf(fmaxf(l->vw1, -big), big);
    float uw2 = fminf(fmaxf(l->uw2, -big), big), vw2 = fminf(fmaxf(l->vw2, -big), big);
    float width = fminf(s->width, big), blur = fminf(s->blur, big), q = width * width * 0.25f;
    float a = (vw1 * vw1 + vw2 * vw2) * q, b = -2 * (uw1 * vw1 + uw2 * vw2) * q;
    float c = (uw1 * uw1 + uw2 * uw2) * q;
    /* in Cartesian coordinates of an equilateral triangle */
    float x = 0.75f * a, y = root3 * 0.5f * (b - a), z = 0.25f * a - 0.5f * b + c;
    float spread = sqrtf((x - z) * (x - z) + y * y);
    float eccentric = 0.5f * (spread * (226.0f / 224.0f) - (x + z));
    float texel = 0.5f / num_power_of_two(face_res), more = fmaxf(eccentric, texel * texel);
    more = fmaxf(more, blur * blur * 0.25f);
    x += more;
    z += more;
    float minor = sqrtf(2 * (x * z - 0.25f * y * y) / (x + z + spread));
    int res = num_negative_log2(fminf(2 * minor, 1));
    const float scale = 3.5f * 3.5f;
    e->a = 4.0f / 3.0f * x;
    e->b = 2 / root3 * y + e->a;
    e->c = (-0.25f * e->a + 0.5f * e->b + z) * scale;
    e->a *= scale;
    e->b *= scale;
    float extent[3] = {sqrtf(e->c), sqrtf(e->a), sqrtf(e->a - e->b + e->c)};
    float u = fminf(fmaxf(l->u, 0), 1), v = fminf(fmaxf(l->v, 0), 1);
    float at[3] = {u, v, 1 - u - v};
    for (int i = 0; i < 3; i++) {
        e->at[i] = at[i];
        e->low[i] = at[i] - fminf(extent[i], 1);
        e->high[i] = at[i] + fminf(extent[i], 1);
    }
    return res < 0 ? 0 : res;
}

/* Into the frame of the neighbour over an edge. */
static void cross(ellipse *e, int edge, int to_edge) {
    for (int i = 0; i < 3; i++) {
        float mirror = i == edge_coordinate[edge] ? 0 : 1, low = e->low[i];
        e->at[i] = mirror - e->at[i];
        e->low[i] = mirror - e->high[i];
        e->high[i] = mirror - low;
    }
    ellipse o = *e;
    int turn = (to_edge - edge + 3) % 3;
    for (int i = 0; i < 3; i++) {
        int from = (i + 3 - turn) % 3;
        e->at[i] = o.at[from];
        e->low[i] = o.low[from];
        e->high[i] = o.high[from];
    }
    if (turn == 1) {
        e->a = o.c;
        e->b = 2 * o.c - o.b;
        e->c = o.a + o.c - o.b;
    } else if (turn == 2) {
        e->a = o.a + o.c - o.b;
        e->b = 2 * o.a - o.b;
        e->c = o.a;
    }
}

/* Texels of one kind, even or odd, of a face: where they begin and end, and their ellipse around
 * (u,v) in units of texels. */
typedef struct texel_set {
    float a, b, c, u, v;
    int low[3], high[3];
} texel_set;

static bool make_set(const ellipse *e, int res, bool odd, texel_set *out) {
    float size = num_power_of_two(res), third = 1.0f / 3.0f;
    out->a = odd ? e->c : e->a;
    out->b = e->b;
    out->c = odd ? e->a : e->c;
    out->u = (odd ? 1 - e->at[1] : e->at[0]) * size - third;
    out->v = (odd ? 1 - e->at[0] : e->at[1]) * size - third;
    float low[3] = {e->low[0], e->low[1], e->low[2]};
    float high[3] = {e->high[0], e->high[1], e->high[2]};
    if (odd) {
        low[0] = 1 - e->high[1], high[0] = 1 - e->low[1];
        low[1] = 1 - e->high[0], high[1] = 1 - e->low[0];
        low[2] = -e->high[2], high[2] = -e->low[2];
    }
    for (int i = 0; i < 3; i++) {
        out->low[i] = (int)ceilf(low[i] * size - third);
        out->high[i] = (int)ceilf(high[i] * size - third);
        if (out->low[i] >= out->high[i])
            return false;
    }
    return true;
}

/* Weighs the texels of a set within a rectangle of them; `texels` is the rectangle's first, or the
 * one for all if `pitch` is 0. Nine parameters, since whole sets and tiles of one come here,
 * which differ in all of them. */
static void sum_rectangle(lookup_state *state, const texel_set *set, int res, int x0, int y0,
                          int width, int height, const uint8_t *texels, size_t pitch) {
    const cache_tables *t = state->tables;
    float area = num_power_of_two(-2 * res);
    int size = 1 << res;
    int top = set->high[1] < y0 + height ? set->high[1] : y0 + height;
    for (int y = set->low[1] > y0 ? set->low[1] : y0; y < top; y++) {
        int x = set->low[0], end = set->high[0];
        x = x > size - y - set->high[2] ? x : size - y - set->high[2];
        end = end < size - y - set->low[2] ? end : size - y - set->low[2];
        x = x > x0 ? x : x0;
        end = end < x0 + width ? end : x0 + width;
        for (; x < end; x++) {
            float du = (float)x - set->u, dv = (float)y - set->v;
            float q = set->a * du * du + set->b * du * dv + set->c * dv * dv;
            if (!(q < 1))
                continue;
            float weight = expf(-6.125f * q) * area;
            size_t at = pitch ? (size_t)(y - y0) * pitch + (size_t)(x - x0) : 0;
            gather_add_texel(t->type, texels + at * t->pixel_size, state->first, state->count,
                             weight, state->sum);
            state->weight += weight;
        }
    }
}

static void sum_set(lookup_state *state, uint32_t face, cache_face *f, const texel_set *set,
                    int res) {
    const cache_tables *t = state->tables;
    int size = 1 << res;
    if ((cache_flags(f) & SLV_FACE_CONSTANT) || res == 0) {
        const uint8_t *average = lookup_find_average(state, face, f);
        if (average)
            sum_rectangle(state, set, res, 0, 0, size, size, average, 0);
        return;
    }
    if (2 * res <= t->whole_log2) {
        const uint8_t *texels = lookup_find_whole(state, face, f, res, res);
        if (texels)
            sum_rectangle(state, set, res, 0, 0, size, size, texels, (size_t)size);
        return;
    }
    int tile = slvi_cache_tile_res(t, res, res).u, last = (1 << (res - tile)) - 1, low[2], high[2];
    for (int i = 0; i < 2; i++) {
        low[i] = set->low[i] > 0 ? set->low[i] >> tile : 0;
        high[i] = (set->high[i] - 1) >> tile < last ? (set->high[i] - 1) >> tile : last;
    }
    for (int y = low[1]; y <= high[1]; y++)
        for (int x = low[0]; x <= high[0]; x++) {
            uint32_t index = ((uint32_t)y << (res - tile)) + (uint32_t)x;
            const uint8_t *texels = lookup_find_tile(state, face, res, res, index);
            if (!texels)
                return;
            sum_rectangle(state, set, res, x << tile, y << tile, 1 << tile, 1 << tile, texels,
                          (size_t)1 << tile);
        }
}

static void sum_face(lookup_state *state, uint32_t face, cache_face *f, ellipse e, int res) {
    res = res < f->res_u ? res : f->res_u;
    for (int i = 0; i < 3; i++)
        e.low[i] = fmaxf(e.low[i], 0);
    e.high[0] = fminf(e.high[0], 1 - (e.low[1] + e.low[2]));
    e.high[1] = fminf(e.high[1], 1 - (e.low[2] + e.low[0]));
    e.high[2] = fminf(e.high[2], 1 - (e.low[0] + e.low[1]));
    float scale = 1 / (num_power_of_two(2 * res) * (e.a * e.c - 0.25f * e.b * e.b));
    e.a *= scale;
    e.b *= scale;
    e.c *= scale;
    for (int odd = 0; odd < 2 && !lookup_is_over(state); odd++) {
        texel_set set;
        if (make_set(&e, res, odd, &set))
            sum_set(state, face, f, &set, res);
    }
}

static void sum_across(lookup_state *state, uint32_t face, ellipse e, int res) {
    static const int order[3] = {2, 0, 1};
    cache_face *f = cache_find_face(state->tables, face);
    if (state->depth >= MAX_TRIANGLES)
        return;
    state->depth++;
    for (int i = 0; i < 3 && !lookup_is_over(state); i++) {
        int edge = order[i], x = edge_coordinate[edge];
        if (e.low[x] >= 0 || f->adjacent[edge] < 0)
            continue;
        ellipse part = e;
        part.high[x] = 0;
        e.low[x] = 0;
        cross(&part, edge, f->edges >> (2 * edge) & 3);
        sum_across(state, (uint32_t)f->adjacent[edge], part, res);
    }
    if (!lookup_is_over(state))
        sum_face(state, face, f, e, res);
    state->depth--;
}

void slvi_triangle_sum(lookup_state *state, const slv_lookup *l) {
    cache_face *f = cache_find_face(state->tables, l->face);
    if (cache_flags(f) & SLV_FACE_NEIGHBOURS_CONSTANT) {
        state->weight = 1;
        gather_add_average(state, l->face, f, 1);
        return;
    }
    ellipse e;
    int res = make_ellipse(state, l, f->res_u, &e);
    sum_across(state, l->face, e, res);
}
