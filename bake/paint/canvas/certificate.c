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
    return s->canvas->fns->read(s->canvas->user, face, s->rect, s->texels);
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

slv_result slv_seam_certify(const slv_env *env, const slv_canvas *canvas,
                            const slv_adjacency *adjacency, slv_seam_certificate *out) {
    slv_canvas_desc desc;
    double sum = 0;
    *out = (slv_seam_certificate){.face = -1};
    slv_result result = canvas->fns->describe(canvas->user, &desc);
    side a = {.canvas = canvas, .desc = &desc}, b = a;
    if (!result && desc.nfaces != slv_adjacency_face_count(adjacency))
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "seam certificate: %u faces, and neighbours of %u", (unsigned)desc.nfaces,
                         (unsigned)slv_adjacency_face_count(adjacency));
    for (uint32_t face = 0; face < desc.nfaces && !result; face++)
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
                if (!read && (result = read_side(env, &a, face, edge)))
                    break;
                read = true;
                if (!(result = read_side(env, &b, to, list[k].edge)))
                    compare(&a, &b, &list[k], out, &sum);
            }
        }
    if (out->places)
        out->mean = sum / ((double)out->places * desc.nchannels);
    slvi_free(a.room);
    slvi_free(b.room);
    return result;
}
