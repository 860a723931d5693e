/* Textures of triangles made into textures of their sub-faces. */
#include "adjacency/triangle.h"
#include "base/log.h"
#include "base/memory.h"
#include "texture/reduce.h"
#include "texture/texture_data.h"
#include "texture/triangle_taps.h"

#include <string.h>

/* More crossings than the way to a texel nearby takes, but in files that make no sense. */
enum { MOST_CROSSINGS = 16 };

/* The taps of the samples of one tile that is all of a sub-face. */
typedef struct plan {
    slvi_tile tile;
    slvi_lattice window;
    slvi_tap *taps;
    uint8_t *counts;
} plan;

typedef struct making {
    slv_env env; /* logs one at a time */
    const slv_texture_desc *desc;
    const slv_texture *triangles; /* light, if they have to be decoded */
    const slv_adjacency *adjacency;
    unsigned char **reduced; /* per triangle: its levels from 1 on, or NULL; NULL: none has any */
    plan plans[SLV_TRIANGLE_FINE_LOG2 + 1][3];
    bool encode;
    slv_texture *out;
} making;

/* What a thread needs for a tile. */
typedef struct scratch {
    plan own;
    float *window, *samples;
    uint8_t *present;
    unsigned char *texels;
    uint64_t cells, nsamples;
} scratch;

static const slv_texture_desc *source_desc(const making *m) {
    return slv_texture_get_desc(m->triangles);
}

static size_t source_size(const making *m) {
    const slv_texture_desc *desc = source_desc(m);
    return slv_type_size(desc->type) * desc->nchannels;
}

static slv_result reduce_faces(void *user, uint64_t first, uint64_t end) {
    const making *m = user;
    const slv_texture_desc *desc = source_desc(m);
    size_t size = source_size(m);
    for (uint32_t face = (uint32_t)first; face < end; face++) {
        int log2 = desc->res[face].u;
        uint64_t count = 0;
        unsigned char *to;
        const unsigned char *from = slv_texture_texels(m->triangles, face);
        if (slv_texture_is_constant(m->triangles, face) || !log2)
            continue;
        for (int k = 0; k < log2; k++)
            count += UINT64_C(1) << (2 * k);
        slv_result result =
            slvi_alloc_plain(&m->env, "reduced triangles", count, size, &m->reduced[face]);
        if (result)
            return result;
        to = m->reduced[face];
        for (int k = log2; k-- > 0;) {
            size_t width = (size_t)2 << k;
            slvi_halve_triangle(desc->type, desc->nchannels, width, width, from, from, to,
                                width / 2);
            from = to;
            to += (size << (2 * k));
        }
    }
    return SLV_OK;
}

/* Levels are only looked at from a coarser face. */
static slv_result reduce_all(making *m) {
    const slv_texture_desc *desc = m->desc;
    bool mixed = false;
    for (uint32_t f = 1; f < desc->nfaces; f++)
        mixed |= desc->res[f].u != desc->res[0].u;
    if (!mixed)
        return SLV_OK;
    slv_result result =
        slvi_alloc(&m->env, "reduced triangles", desc->nfaces, sizeof *m->reduced, &m->reduced);
    return result ? result : slvi_parallel_for(&m->env, desc->nfaces, 16, reduce_faces, m);
}

/* A point in units of a third of a texel of the triangle that is being made: [0] u, [1] v, [2] w.
 * Those are zero along the edges 2, 0 and 1. */
typedef struct spot {
    int32_t face;
    int32_t at[3];
} spot;

static bool cross(const making *m, spot *p, unsigned coordinate, int32_t whole) {
    unsigned edge = (coordinate + 2) % 3, to_edge;
    int32_t mirrored[3], to;
    if (!slvi_triangle_across(m->adjacency, p->face, edge, &to, &to_edge))
        return false;
    for (unsigned i = 0; i < 3; i++)
        mirrored[i] = (i == coordinate ? 0 : whole) - p->at[i];
    unsigned turn = (to_edge + 3 - edge) % 3;
    for (unsigned i = 0; i < 3; i++)
        p->at[i] = mirrored[(i + 3 - turn) % 3];
    p->face = to;
    return true;
}

/* Walks to the triangle that a point beside another one lies in, as if all lay in one plane: over
 * the edge that it is furthest behind, or another one. */
static bool walk(const making *m, spot *p, int32_t whole) {
    for (int step = 0; step < MOST_CROSSINGS; step++) {
        unsigned order[3] = {0, 1, 2}, count = 0;
        for (unsigned i = 0; i < 3; i++)
            if (p->at[i] < 0)
                order[count++] = i;
        if (!count)
            return true;
        if (count == 2 && p->at[order[1]] < p->at[order[0]]) {
            unsigned furthest = order[1];
            order[1] = order[0];
            order[0] = furthest;
        }
        if (!cross(m, p, order[0], whole) && (count < 2 || !cross(m, p, order[1], whole)))
            return false;
    }
    return false;
}

/* The texel of a face that holds a point of it, at the face's resolution or, if that is finer, at
 * that of the triangle which is being made. */
static const void *texel_at(const making *m, const spot *p, int log2) {
    const slv_texture_desc *desc = source_desc(m);
    int own = desc->res[p->face].u, at = own < log2 ? own : log2;
    const unsigned char *texels = slv_texture_texels(m->triangles, (uint32_t)p->face);
    size_t size = source_size(m);
    if (slv_texture_is_constant(m->triangles, (uint32_t)p->face))
        return texels;
    if (at < own) {
        texels = m->reduced[p->face];
        for (int k = own - 1; k > at; k--)
            texels += size << (2 * k);
    }
    int32_t unit = 3 << (log2 - at), i = p->at[0] / unit, j = p->at[1] / unit, n = 1 << at;
    bool odd = p->at[0] % unit + p->at[1] % unit > unit;
    size_t column = (size_t)(odd ? n - 1 - j : i), row = (size_t)(odd ? n - 1 - i : j);
    return texels + (row * (size_t)n + column) * size;
}

/* Fetches the texels of a window. False if all are the same, which `first` then points to. */
static bool fill_window(const making *m, uint32_t triangle, int log2, const slvi_lattice *w,
                        scratch *s, const void **first) {
    const slv_texture_desc *desc = source_desc(m);
    const int32_t whole = 3 << log2;
    bool differ = false;
    float *to = s->window;
    *first = NULL;
    for (int32_t i = 0; i < 2 * w->width * w->height; i++, to += desc->nchannels) {
        int32_t cell = i / 2, third = 1 + i % 2;
        int32_t u = 3 * (w->u0 + cell % w->width) + third,
                v = 3 * (w->v0 + cell / w->width) + third;
        spot p = {(int32_t)triangle, {u, v, whole - u - v}};
        s->present[i] = walk(m, &p, whole);
        if (!s->present[i])
            continue;
        const void *texel = texel_at(m, &p, log2);
        differ = differ || (*first && memcmp(*first, texel, source_size(m)) != 0);
        *first = *first ? *first : texel;
        slv_type_to_float(desc->type, texel, desc->nchannels, to);
    }
    return differ;
}

static void sum_sample(const scratch *s, const slvi_tap *taps, uint8_t count, uint32_t nchannels,
                       float *out) {
    float weight = 0;
    for (uint32_t c = 0; c < nchannels; c++)
        out[c] = 0;
    for (uint8_t k = 0; k < count; k++) {
        const float *texel = s->window + (size_t)taps[k].texel * nchannels;
        if (!s->present[taps[k].texel])
            continue;
        for (uint32_t c = 0; c < nchannels; c++)
            out[c] += taps[k].weight * texel[c];
        weight += taps[k].weight;
    }
    for (uint32_t c = 0; c < nchannels; c++)
        out[c] /= weight;
}

static slv_result reserve_samples(const making *m, scratch *s, uint64_t count) {
    uint64_t n = m->desc->nchannels, size = slv_type_size(m->desc->type);
    slv_result result = SLV_OK;
    if (count <= s->nsamples)
        return SLV_OK;
    if (!(result = slvi_grow(&m->env, "samples", count * n, sizeof *s->samples, &s->samples)) &&
        !(result = slvi_grow(&m->env, "samples", count * n, size, &s->texels)))
        s->nsamples = count;
    return result;
}

static slv_result reserve(const making *m, scratch *s, const plan *p) {
    uint64_t cells = 2 * (uint64_t)p->window.width * (uint64_t)p->window.height,
             n = m->desc->nchannels;
    slv_result result = reserve_samples(m, s, (uint64_t)p->tile.width * p->tile.height);
    if (result || cells <= s->cells)
        return result;
    if (!(result = slvi_grow(&m->env, "texels", cells * n, sizeof *s->window, &s->window)) &&
        !(result = slvi_grow(&m->env, "texels", cells, 1, &s->present)))
        s->cells = cells;
    return result;
}

/* The samples in the texture's type; those of one texel if it is given. */
static void write_samples(const making *m, const void *same, size_t count, scratch *s) {
    uint32_t n = m->desc->nchannels;
    size_t computed = same ? 1 : count;
    if (same)
        slv_type_to_float(source_desc(m)->type, same, n, s->samples);
    if (m->encode)
        slv_texels_encode(n, m->desc->alpha_channel, s->samples, computed);
    slv_type_from_float(m->desc->type, s->samples, computed * n, s->texels);
    for (size_t i = 1, size = slv_type_size(m->desc->type) * n; same && i < count; i++)
        memcpy(s->texels + i * size, s->texels, size);
}

static slv_result make_tile(const making *m, scratch *s, uint32_t triangle, const plan *p) {
    uint32_t n = m->desc->nchannels, face = 3 * triangle + p->tile.sub;
    size_t count = (size_t)p->tile.width * p->tile.height;
    const void *same;
    slv_result result = reserve(m, s, p);
    if (result)
        return result;
    /* what rounding would make of equal texels is not all equal */
    if (!fill_window(m, triangle, p->tile.log2, &p->window, s, &same)) {
        write_samples(m, same, count, s);
    } else {
        for (size_t i = 0; i < count; i++)
            sum_sample(s, p->taps + i * SLVI_TAPS, p->counts[i], n, s->samples + i * n);
        write_samples(m, NULL, count, s);
    }
    slv_rect rect = {p->tile.x, p->tile.y, p->tile.width, p->tile.height};
    return slv_texture_set_rect(m->out, face, rect, s->texels);
}

static slv_result make_plan(const making *m, const slvi_tile *tile, plan *p) {
    uint64_t count = (uint64_t)tile->width * tile->height;
    slv_result result = SLV_OK;
    if (!p->taps && !(result = slvi_alloc_plain(&m->env, "weights", count * SLVI_TAPS,
                                                sizeof *p->taps, &p->taps)))
        result = slvi_alloc_plain(&m->env, "weights", count, 1, &p->counts);
    if (result)
        return result;
    p->tile = *tile;
    p->window = slvi_triangle_window(tile);
    slvi_triangle_taps(tile, &p->window, p->taps, p->counts);
    return SLV_OK;
}

/* The samples of triangles of few texels are the same means on all of them. */
static slv_result make_plans(making *m) {
    bool used[SLV_TRIANGLE_FINE_LOG2 + 1] = {false};
    slv_result result = SLV_OK;
    for (uint32_t f = 0; f < m->desc->nfaces; f++)
        if (m->desc->res[f].u <= SLV_TRIANGLE_FINE_LOG2)
            used[m->desc->res[f].u] = true;
    for (int log2 = 0; log2 <= SLV_TRIANGLE_FINE_LOG2; log2++)
        for (unsigned sub = 0; sub < 3 && used[log2] && !result; sub++) {
            uint32_t side = 1u << slv_triangle_subface_log2(log2);
            slvi_tile tile = {log2, sub, 0, 0, side, side};
            result = make_plan(m, &tile, &m->plans[log2][sub]);
        }
    return result;
}

/* Whether this triangle and all that share a vertex with it are of one and the same texel. */
static bool is_all_constant(const making *m, uint32_t triangle) {
    const void *own = slv_texture_texels(m->triangles, triangle);
    for (unsigned k = 0; k < 3; k++) {
        slv_ring ring = slv_adjacency_ring(m->adjacency, (int32_t)(3 * triangle + k), 0, NULL);
        for (uint32_t i = 0; i < ring.count; i++) {
            uint32_t other = (uint32_t)ring.corners[i].face / 3;
            if (!slv_texture_is_constant(m->triangles, other) ||
                memcmp(own, slv_texture_texels(m->triangles, other), source_size(m)) != 0)
                return false;
        }
    }
    return true;
}

static slv_result make_large(const making *m, scratch *s, uint32_t triangle, unsigned sub) {
    int log2 = m->desc->res[triangle].u;
    uint32_t side = 1u << slv_triangle_subface_log2(log2);
    slv_result result = SLV_OK;
    if (is_all_constant(m, triangle)) {
        if ((result = reserve_samples(m, s, 1)))
            return result;
        write_samples(m, slv_texture_texels(m->triangles, triangle), 1, s);
        return slv_texture_set_constant(m->out, 3 * triangle + sub, s->texels);
    }
    for (uint32_t y = 0; y < side && !result; y += SLVI_TILE)
        for (uint32_t x = 0; x < side && !result; x += SLVI_TILE) {
            slvi_tile tile = {log2, sub, x, y, SLVI_TILE, SLVI_TILE};
            if (!(result = make_plan(m, &tile, &s->own)))
                result = make_tile(m, s, triangle, &s->own);
        }
    return result;
}

static slv_result make_faces(void *user, uint64_t first, uint64_t end) {
    const making *m = user;
    scratch s = {.cells = 0};
    slv_result result = SLV_OK;
    for (uint32_t triangle = (uint32_t)first; triangle < end && !result; triangle++)
        for (unsigned sub = 0; sub < 3 && !result; sub++) {
            int log2 = m->desc->res[triangle].u;
            result = log2 <= SLV_TRIANGLE_FINE_LOG2
                         ? make_tile(m, &s, triangle, &m->plans[log2][sub])
                         : make_large(m, &s, triangle, sub);
        }
    slvi_free(s.own.taps);
    slvi_free(s.own.counts);
    slvi_free(s.window);
    slvi_free(s.present);
    slvi_free(s.samples);
    slvi_free(s.texels);
    return result;
}

static slv_result check(const slv_env *env, const slv_texture_desc *desc,
                        const slv_adjacency *adjacency) {
    if (slv_adjacency_face_count(adjacency) != 3 * (uint64_t)desc->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "%u triangles of texture have three sub-faces each, the adjacency is of "
                         "%u",
                         desc->nfaces, slv_adjacency_face_count(adjacency));
    for (uint32_t f = 0; f < desc->nfaces; f++) {
        if (desc->res[f].u != desc->res[f].v)
            return slvi_fail(env, SLV_ERROR_ARGUMENT,
                             "texture: face %u: a triangle of 2^%d x 2^%d texels is not square", f,
                             desc->res[f].u, desc->res[f].v);
        for (unsigned k = 0; k < 3; k++) {
            const slv_face_adjacency *face = slv_adjacency_faces(adjacency) + 3 * (size_t)f + k;
            int32_t next = (int32_t)(3 * f + (k + 1) % 3);
            if (face->face[1] != next || face->edge[1] != 2)
                return slvi_fail(env, SLV_ERROR_MISMATCH,
                                 "face %u edge 1: the adjacency is not of sub-faces of triangles",
                                 3 * f + k);
        }
    }
    return SLV_OK;
}

static slv_result create_out(making *m) {
    slv_texture_desc desc = *m->desc;
    slv_res *res = NULL;
    slv_result result =
        slvi_alloc(&m->env, "texture resolutions", 3 * (uint64_t)desc.nfaces, sizeof *res, &res);
    if (result)
        return result;
    for (uint32_t f = 0; f < 3 * desc.nfaces; f++) {
        int8_t log2 = (int8_t)slv_triangle_subface_log2(m->desc->res[f / 3].u);
        res[f] = (slv_res){log2, log2};
    }
    desc.nfaces *= 3;
    desc.res = res;
    result = slv_texture_create(&m->env, &desc, &m->out);
    slvi_free(res);
    return result;
}

static void free_making(making *m) {
    for (uint32_t f = 0; m->reduced && f < m->desc->nfaces; f++)
        slvi_free(m->reduced[f]);
    slvi_free(m->reduced);
    for (int log2 = 0; log2 <= SLV_TRIANGLE_FINE_LOG2; log2++)
        for (unsigned sub = 0; sub < 3; sub++) {
            slvi_free(m->plans[log2][sub].taps);
            slvi_free(m->plans[log2][sub].counts);
        }
}

static slv_result make(const slv_env *env, const slv_texture *triangles,
                       const slv_adjacency *adjacency, slv_texture_encoding encoding,
                       slv_texture **out) {
    making m = {.desc = slv_texture_get_desc(triangles), .adjacency = adjacency};
    slv_parallel_log *log = NULL;
    slv_texture *light = NULL;
    slv_result result;
    *out = NULL;
    if ((result = check(env, m.desc, adjacency)) ||
        (result = slvi_parallel_env_begin(env, &log, &m.env)) ||
        (result = slv_texture_decode(env, triangles, encoding, &light)))
        goto done;
    m.encode = light != NULL;
    m.triangles = light ? light : triangles;
    /* the result outlives this environment, and takes one of its own */
    slv_env inner = m.env;
    m.env = *env;
    result = create_out(&m);
    m.env = inner;
    if (result || (result = reduce_all(&m)) || (result = make_plans(&m)) ||
        (result = slvi_parallel_for(&m.env, m.desc->nfaces, 16, make_faces, &m)))
        goto done;
    *out = m.out;
    m.out = NULL;
done:
    free_making(&m);
    slv_texture_destroy(m.out);
    slv_texture_destroy(light);
    slvi_parallel_env_end(log);
    return result;
}

slv_result slv_triangle_texture(const slv_env *env, const slv_texture *triangles,
                                const slv_adjacency *adjacency, slv_texture_encoding encoding,
                                slv_texture **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, make(&own, triangles, adjacency, encoding, out));
}
