/* What a texel of the source is worth around a point: linear between texels, also across edges, or
 * the mean of those that a larger footprint covers. */
#include "transfer/transfer_data.h"

#include <selvage/ptx.h>

#include "base/memory.h"
#include "texture/bilinear.h"

#include <math.h>

enum { MOST_ACROSS = 8 }; /* texels of a mean along an axis */

/* A constant face is as good as one texel however it is looked at. */
static void measure(transfer_source *s, const float *corners, uint32_t face) {
    const float *c = corners + (size_t)12 * face;
    bool constant = s->faces[face].flags & SLV_FACE_CONSTANT;
    float u = slvi_transfer_mean_length(c, c + 3, c + 9, c + 6),
          v = slvi_transfer_mean_length(c, c + 9, c + 3, c + 6);
    slv_res res = s->faces[face].res;
    s->sizes[face].u = constant || !(u > 0) ? INFINITY : ldexpf(u, -res.u);
    s->sizes[face].v = constant || !(v > 0) ? INFINITY : ldexpf(v, -res.v);
}

static float finer(const transfer_size *size) {
    return fminf(size->u, size->v);
}

slv_result slvi_transfer_source_begin(const slv_env *env, const slv_mesh *mesh,
                                      const slv_source *texels, const float *corners,
                                      transfer_source *out) {
    uint32_t nfaces = slv_mesh_face_count(mesh);
    *out = (transfer_source){.texels = *texels};
    slv_result result = texels->fns->describe(texels->user, &out->desc);
    if (result ||
        (result = slvi_alloc(env, "texel sizes", nfaces, sizeof *out->sizes, &out->sizes)) ||
        (result = slvi_alloc(env, "faces", nfaces, sizeof *out->faces, &out->faces)) ||
        (result = slv_mesh_adjacency(env, mesh, &out->adjacency)))
        return result;
    for (uint32_t face = 0; face < nfaces && !result; face++)
        result = texels->fns->face(texels->user, face, &out->faces[face]);
    if (result)
        return result;
    for (uint32_t face = 0; face < nfaces; face++)
        measure(out, corners, face);
    for (uint32_t face = 0; face < nfaces; face++) {
        float finest = finer(&out->sizes[face]);
        for (unsigned edge = 0; edge < 4; edge++) {
            slv_neighbour next[2];
            uint32_t count = slv_adjacency_neighbours(out->adjacency, (int32_t)face, edge, next);
            for (uint32_t i = 0; i < count; i++)
                finest = fminf(finest, finer(&out->sizes[next[i].face]));
        }
        out->sizes[face].finest_around = finest;
    }
    return SLV_OK;
}

void slvi_transfer_source_end(transfer_source *s) {
    slv_adjacency_destroy(s->adjacency);
    slvi_free(s->sizes);
    slvi_free(s->faces);
}

float slvi_transfer_finest_texel(const transfer_source *s, const slv_surface_point *at,
                                 float footprint) {
    const transfer_size *size = &s->sizes[at->face];
    slv_res res = s->faces[at->face].res;
    /* how far the nearest edges are, in mesh units; of constant faces that is not known */
    float u = fminf(at->u, 1 - at->u) * ldexpf(size->u, res.u),
          v = fminf(at->v, 1 - at->v) * ldexpf(size->v, res.v);
    bool inside = isfinite(size->u) && isfinite(size->v) && fminf(u, v) > footprint;
    return inside ? finer(size) : size->finest_around;
}

static void add_texel(transfer_tiles *t, uint32_t face, slv_res res, uint32_t x, uint32_t y,
                      float weight, float *out) {
    const float *values = slvi_transfer_fetch(t, face, res, x, y);
    for (uint32_t c = 0; values && c < t->source->desc.nchannels; c++)
        out[c] += weight * values[c];
}

static float clamp(float value, float low, float high) {
    return fminf(fmaxf(value, low), high);
}

/* The two texel centres beside a coordinate in texels, perhaps outside of the face, and how far it
 * is from the first. */
static int32_t split(float at, float *fraction) {
    float first = floorf(at - 0.5f);
    *fraction = at - 0.5f - first;
    return (int32_t)first;
}

/* Linear, kept inside the face. */
static void add_inside(transfer_tiles *t, uint32_t face, float u, float v, float weight,
                       float *out) {
    slv_res res = t->source->faces[face].res;
    slvi_bilinear at = slvi_bilinear_centred(res, u, v);
    for (uint32_t k = 0; k < 4; k++) {
        float share = slvi_bilinear_share(at.wx, at.wy, (int)k);
        if (share > 0)
            add_texel(t, face, res, at.x + (k & 1), at.y + (k >> 1), weight * share, out);
    }
}

static void add_linear(transfer_tiles *t, const slv_surface_point *at, float *out) {
    uint32_t face = (uint32_t)at->face;
    slv_res res = t->source->faces[face].res;
    float w = ldexpf(1, res.u), h = ldexpf(1, res.v), fx, fy;
    int32_t x0 = split(at->u * w, &fx), y0 = split(at->v * h, &fy);
    for (int k = 0; k < 4; k++) {
        float share = slvi_bilinear_share(fx, fy, k);
        float x = (float)(x0 + (k & 1)) + 0.5f, y = (float)(y0 + (k >> 1)) + 0.5f;
        float u = x / w, v = y / h;
        int32_t there = at->face;
        if (!(share > 0))
            continue;
        if (x > 0 && x < w && y > 0 && y < h)
            add_texel(t, face, res, (uint32_t)x, (uint32_t)y, share, out);
        else if (slv_adjacency_resolve(t->source->adjacency, false, &there, &u, &v))
            add_inside(t, (uint32_t)there, u, v, share, out);
        else
            add_texel(t, face, res, (uint32_t)clamp(x, 0.5f, w - 0.5f),
                      (uint32_t)clamp(y, 0.5f, h - 0.5f), share, out);
    }
}

/* How many texels of a side a footprint covers, and the first of them; of a reduction, if they
 * would be many. */
static uint32_t covered(float footprint, float texel, float at, int8_t *log2, uint32_t *first) {
    float side = ldexpf(1, *log2), count = clamp(roundf(footprint / texel), 1, side);
    while (count > MOST_ACROSS && *log2 > 0) {
        --*log2;
        side /= 2;
        count = clamp(roundf(count / 2), 1, side);
    }
    *first = (uint32_t)clamp(roundf(at * side - 0.5f * count), 0, side - count);
    return (uint32_t)count;
}

void slvi_transfer_look_up(transfer_tiles *t, const slv_surface_point *at, float footprint,
                           float *out) {
    uint32_t face = (uint32_t)at->face, x, y;
    const transfer_size *size = &t->source->sizes[face];
    slv_res res = t->source->faces[face].res;
    uint32_t w = covered(footprint, size->u, at->u, &res.u, &x),
             h = covered(footprint, size->v, at->v, &res.v, &y);
    if (w == 1 && h == 1) {
        add_linear(t, at, out);
        return;
    }
    for (uint32_t j = 0; j < h; j++)
        for (uint32_t i = 0; i < w; i++)
            add_texel(t, face, res, x + i, y + j, 1 / ((float)w * (float)h), out);
}
