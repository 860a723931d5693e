/* The seam certificate: by how much both sides of shared edges contradict each other. */
#include "adjacency/edge.h"
#include "base/log.h"
#include "base/memory.h"

#include <selvage/canvas.h>

#include <math.h>

/* The two outermost rows of texels along an edge, as they are read. */
typedef struct side {
    const slv_canvas *canvas;
    const slv_canvas_desc *desc;
    uint32_t face;
    unsigned edge;
    int32_t along, rows; /* how many texels, and how many rows: 1 or 2 */
    float *texels;       /* of the rectangle of both rows */
    slv_rect rect;
    float *room;
    uint64_t have;
} side;

static slv_result read_side(const slv_env *env, side *s, uint32_t face, unsigned edge) {
    slv_res res = s->desc->res[face];
    int32_t width = 1 << res.u, height = 1 << res.v, x0, y0, x1, y1;
    s->face = face;
    s->edge = edge;
    s->along = slvi_edge_along(edge, width, height);
    s->rows = slvi_edge_across(edge, width, height) > 1 ? 2 : 1;
    slvi_edge_texel(width, height, edge, 0, 0, &x0, &y0);
    slvi_edge_texel(width, height, edge, s->along - 1, s->rows - 1, &x1, &y1);
    s->rect = (slv_rect){(uint32_t)(x0 < x1 ? x0 : x1), (uint32_t)(y0 < y1 ? y0 : y1),
                         (uint32_t)(x0 < x1 ? x1 - x0 : x0 - x1) + 1,
                         (uint32_t)(y0 < y1 ? y1 - y0 : y0 - y1) + 1};
    uint64_t count = (uint64_t)s->rect.width * s->rect.height * s->desc->nchannels;
    if (count > s->have) {
        slv_result result = slvi_grow(env, "seam certificate", count, sizeof(float), &s->room);
        if (result)
            return result;
        s->have = count;
    }
    s->texels = s->room;
    slv_result result = s->canvas->fns->read(s->canvas->user, face, s->rect, s->texels);
    uint32_t n = s->desc->nchannels;
    for (uint64_t i = 0; !result && s->desc->alpha_channel >= 0 && i < count; i++)
        if (i % n != (uint32_t)s->desc->alpha_channel)
            s->texels[i] *= s->texels[i - i % n + (uint32_t)s->desc->alpha_channel];
    return result;
}

static double texel_at(const side *s, int32_t j, int32_t depth, uint32_t channel) {
    slv_res res = s->desc->res[s->face];
    int32_t x, y;
    slvi_edge_texel(1 << res.u, 1 << res.v, s->edge, j, depth, &x, &y);
    size_t at = (size_t)((uint32_t)y - s->rect.y) * s->rect.width + ((uint32_t)x - s->rect.x);
    return (double)s->texels[at * s->desc->nchannels + channel];
}

/* Between texel centres along the edge. */
static double row_at(const side *s, double t, int32_t depth, uint32_t channel) {
    double at = fmin(fmax(t * s->along - 0.5, 0), s->along - 1);
    int32_t j = (int32_t)at;
    double f = at - j, a = texel_at(s, j, depth, channel);
    return f > 0 ? a + f * (texel_at(s, j + 1, depth, channel) - a) : a;
}

/* What a side may mean to be on the edge: a texel to either side counts too, or a rim of paint that
 * crosses the edge aslant would be taken for a seam. */
static void find_range(const side *s, double t, uint32_t channel, double out[2]) {
    out[0] = INFINITY;
    out[1] = -INFINITY;
    for (int k = -1; k <= 1; k++) {
        double at = t + (double)k / s->along, own = row_at(s, at, 0, channel);
        double led = s->rows > 1 ? own + (own - row_at(s, at, 1, channel)) / 2 : own;
        out[0] = fmin(out[0], fmin(own, led));
        out[1] = fmax(out[1], fmax(own, led));
    }
}

static void compare(const side *a, const side *b, const slv_neighbour *link,
                    slv_seam_certificate *out, double *sum) {
    int32_t fine = (int32_t)fmaxf((float)a->along * (link->t1 - link->t0), (float)b->along);
    for (int32_t j = 0; j < fine; j++) {
        /* a sub-face meets half of a quad's edge, and is all of its own */
        float t = link->t0 + ((float)j + 0.5f) / (float)fine * (link->t1 - link->t0), u, v;
        slvi_edge_point(a->edge, t, &u, &v);
        slv_affine_apply(&link->map, u, v, &u, &v);
        float other = slvi_edge_t(b->edge, u, v);
        out->places++;
        for (uint32_t c = 0; c < a->desc->nchannels; c++) {
            double mine[2], its[2];
            find_range(a, (double)t, c, mine);
            find_range(b, (double)other, c, its);
            double gap = fmax(0, fmax(mine[0] - its[1], its[0] - mine[1]));
            *sum += gap;
            if (gap > out->largest) {
                out->largest = gap;
                out->face = (int32_t)a->face;
                out->edge = (uint8_t)a->edge;
                out->channel = c;
                out->t = t;
            }
        }
    }
}

/* All edges, the near side of `a` and the far one of `b`. */
static slv_result certify_sides(const slv_env *env, side *a, side *b,
                                const slv_adjacency *adjacency, slv_seam_certificate *out,
                                double *sum) {
    slv_result result = SLV_OK;
    for (uint32_t face = 0; face < a->desc->nfaces && !result; face++)
        for (unsigned edge = 0; edge < 4 && !result; edge++) {
            slv_neighbour list[2];
            uint32_t count = slv_adjacency_neighbours(adjacency, (int32_t)face, edge, list);
            bool read = false;
            for (uint32_t k = 0; k < count && !result; k++) {
                /* each pair once: from the face of the lower number, or of the whole quad */
                uint32_t to = (uint32_t)list[k].face;
                if (list[k].scale < 0.75f ||
                    (list[k].scale < 1.5f && (to < face || (to == face && list[k].edge < edge))))
                    continue;
                if (!read && (result = read_side(env, a, face, edge)))
                    break;
                read = true;
                if (!(result = read_side(env, b, to, list[k].edge)))
                    compare(a, b, &list[k], out, sum);
            }
        }
    return result;
}

static slv_result check(const slv_env *env, const slv_canvas_desc *a, const slv_canvas_desc *b,
                        const slv_adjacency *adjacency) {
    uint32_t nfaces = slv_adjacency_face_count(adjacency);
    if (a->nfaces != nfaces || b->nfaces != nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "seam certificate: %u faces, and neighbours of %u",
                         (unsigned)(a->nfaces != nfaces ? a->nfaces : b->nfaces), (unsigned)nfaces);
    if (a->nchannels != b->nchannels || a->alpha_channel != b->alpha_channel)
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "seam certificate: %u channels, alpha %d, beside %u, alpha %d",
                         (unsigned)a->nchannels, (int)a->alpha_channel, (unsigned)b->nchannels,
                         (int)b->alpha_channel);
    return SLV_OK;
}

slv_result slv_seam_certify(const slv_env *env, const slv_canvas *canvas,
                            const slv_adjacency *adjacency, slv_seam_certificate *out) {
    return slv_seam_certify_two(env, canvas, canvas, adjacency, out);
}

slv_result slv_seam_certify_two(const slv_env *env, const slv_canvas *a, const slv_canvas *b,
                                const slv_adjacency *adjacency, slv_seam_certificate *out) {
    slv_canvas_desc descs[2];
    double sum = 0;
    bool same = a->user == b->user && a->fns == b->fns;
    *out = (slv_seam_certificate){.face = -1};
    side one = {.canvas = a, .desc = &descs[0]}, other = {.canvas = b, .desc = &descs[1]};
    slv_result result = a->fns->describe(a->user, &descs[0]);
    if (result || (result = b->fns->describe(b->user, &descs[1])) ||
        (result = check(env, &descs[0], &descs[1], adjacency)))
        return result;
    result = certify_sides(env, &one, &other, adjacency, out, &sum);
    if (!result && !same)
        result = certify_sides(env, &other, &one, adjacency, out, &sum);
    if (out->places)
        out->mean = sum / ((double)out->places * descs[0].nchannels);
    slvi_free(one.room);
    slvi_free(other.room);
    return result;
}
