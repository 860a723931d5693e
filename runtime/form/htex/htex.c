/* Squares of edges: laid out, filled from both faces, and reduced. */
#include "form/htex/htex_data.h"

#include "base/log.h"
#include "base/memory.h"
#include "texture/bilinear.h"

#include <assert.h>
#include <string.h>

#define ITEMS_PER_RANGE 16
#define MOST_POINTS 16 /* along a side of a texel, where a square is coarser than the face */

/* Which part of a half-edge's triangle lies in a face. */
typedef enum triangle_part { ALL, START_SIDE, END_SIDE } triangle_part;

void slvi_htex_source_at(const slv_htex_source *source, float u, float v, float *out) {
    slvi_bilinear_bordered_floats(source->texels, source->res, source->nchannels, u, v, out);
}

/* The texel (i,j) of a square, as the face has it: the value at its centre, or the mean of several
 * points where the face has finer texels than the square. Its parameters are many since it is the
 * body of a loop, for each turn of which a struct would be filled anew. */
static void sample(const slv_htex_source *source, const slv_htex_map *map, triangle_part part,
                   uint32_t log2, uint32_t npoints, uint32_t i, uint32_t j, float *point,
                   float *out) {
    float texel = 1.0f / (float)(1u << log2), step = texel / (float)npoints;
    if (npoints > 1)
        memset(out, 0, source->nchannels * sizeof *out);
    for (uint32_t k = 0; k < npoints * npoints; k++) {
        float s = (float)i * texel + ((float)(k % npoints) + 0.5f) * step;
        float t = (float)j * texel + ((float)(k / npoints) + 0.5f) * step;
        if (s + t > 1) { /* the part of a texel on the edge that the other face has */
            float mirrored = 1 - t;
            t = 1 - s;
            s = mirrored;
        }
        if ((part == START_SIDE && s < t) || (part == END_SIDE && s > t)) {
            float mirrored = s;
            s = t;
            t = mirrored;
        }
        float u = map->us * s + map->ut * t + map->u0, v = map->vs * s + map->vt * t + map->v0;
        if (npoints == 1) {
            slvi_htex_source_at(source, u, v, out);
            return;
        }
        slvi_htex_source_at(source, u, v, point);
        for (size_t c = 0; c < source->nchannels; c++)
            out[c] += point[c] / (float)(npoints * npoints);
    }
}

static uint32_t points_for(slv_res res, bool part, uint32_t log2) {
    int finer = (res.u > res.v ? res.u : res.v) - (part ? 0 : 1) - (int)log2;
    uint32_t points = finer > 0 ? 1u << finer : 1;
    return points < MOST_POINTS ? points : MOST_POINTS;
}

/* A face's share of one half-edge's triangle. `row` is scratch. */
static void fill_triangle(const slv_htex_fill *fill, const slv_htex_source *source, uint32_t half,
                          triangle_part part, float *row) {
    slv_htex *htex = fill->htex;
    size_t n = source->nchannels;
    uint32_t edge = fill->mesh->edge[half], log2 = htex->log2[edge], width = 1u << log2;
    if (fill->wanted && !fill->wanted[edge])
        return;
    bool second = fill->mesh->half[edge][0] != half;
    slv_htex_map map = slv_htex_to_face(part != ALL, part == ALL ? half % 4 : part == END_SIDE);
    uint32_t npoints = points_for(source->res, part != ALL, log2);
    unsigned turns = 0u - slvi_htex_square_turns(fill->mesh, half, part == END_SIDE);
    float *point = row + width * n;
    float *diagonal = fill->diagonals + (fill->ends[edge] * 2 + (second ? width : 0)) * n;
    unsigned char *texels = htex->at[edge];
    for (uint32_t j = 0; j < width; j++) {
        uint32_t last = width - 1 - j, first = part == START_SIDE ? j : 0;
        uint32_t end = part == END_SIDE && j < last + 1 ? j : last + 1; /* one past */
        if (first >= end)
            continue;
        uint32_t inside = end > last ? last : end, count = inside > first ? inside - first : 0;
        for (uint32_t i = first; i < inside; i++) {
            uint32_t place = second ? inside - 1 - i : i - first;
            sample(source, &map, part, log2, npoints, i, j, point, row + place * n);
            if (htex->vectors)
                slvi_edge_turn_vector(turns, row + place * n, row + place * n + 1);
        }
        size_t at =
            second ? (size_t)(width - 1 - j) * width + (width - inside) : (size_t)j * width + first;
        slv_type_from_float(htex->desc.type, row, count * n, texels + at * htex->texel_size);
        if (end > last) {
            float *to = diagonal + (second ? width - 1 - last : last) * n;
            sample(source, &map, part, log2, npoints, last, j, point, to);
            if (htex->vectors)
                slvi_edge_turn_vector(turns, to, to + 1);
        }
    }
}

/* The values at the vertices and the centre that this face stands for. */
static void fill_tops(const slv_htex_fill *fill, const slv_htex_source *source, uint32_t face) {
    const slv_htex_mesh *mesh = fill->mesh;
    bool part = slv_htex_is_part(mesh, face);
    for (uint32_t e = 0; e < (part ? 1u : 4u); e++)
        if (mesh->root[4 * face + e] == 4 * face + e)
            slvi_htex_source_at(source, (float)slvi_corner_u(e), (float)slvi_corner_v(e),
                                fill->tops + (size_t)(4 * face + e) * source->nchannels);
    if (mesh->polygon[face] == face)
        slvi_htex_source_at(source, part ? 1 : 0.5f, part ? 1 : 0.5f,
                            fill->tops + (4 * (size_t)mesh->nfaces + face) * source->nchannels);
}

slv_result slvi_htex_fill_face(const slv_htex_fill *fill, uint32_t face, float *bordered,
                               float *row) {
    const slv_htex_mesh *mesh = fill->mesh;
    slv_htex_source source = {fill->htex->res[face], fill->htex->desc.nchannels, bordered};
    slv_result result =
        slv_border_build(fill->levels, fill->adjacency, face, 0, 1, 1, bordered, NULL);
    if (result)
        return result;
    fill_tops(fill, &source, face);
    if (slv_htex_is_part(mesh, face)) {
        fill_triangle(fill, &source, 4 * face, START_SIDE, row);
        fill_triangle(fill, &source, 4 * mesh->before[face], END_SIDE, row);
        return SLV_OK;
    }
    for (uint32_t e = 0; e < 4; e++)
        fill_triangle(fill, &source, 4 * face + e, ALL, row);
    return SLV_OK;
}

static slv_result fill_faces(void *user, uint64_t first, uint64_t end) {
    const slv_htex_fill *fill = user;
    const slv_htex *htex = fill->htex;
    size_t n = htex->desc.nchannels;
    uint64_t texels = 0, width = 0;
    float *bordered = NULL, *row = NULL;
    slv_result result;
    for (uint64_t face = first; face < end; face++) {
        slv_res res = htex->res[face];
        uint64_t count = ((UINT64_C(1) << res.u) + 2) * ((UINT64_C(1) << res.v) + 2);
        texels = count > texels ? count : texels;
        for (uint32_t e = 0; e < 4; e++) {
            uint64_t side = UINT64_C(1) << htex->log2[htex->faces[face].edge[e]];
            width = side > width ? side : width;
        }
    }
    if ((result = slvi_alloc(&fill->env, "border", texels * n, sizeof *bordered, &bordered)) ||
        (result = slvi_alloc(&fill->env, "texels", (width + 1) * n, sizeof *row, &row)))
        goto done;
    for (uint32_t face = (uint32_t)first; !result && face < end; face++)
        result = slvi_htex_fill_face(fill, face, bordered, row);
done:
    slvi_free(bordered);
    slvi_free(row);
    return result;
}

static void reduce(slv_type type, size_t n, uint32_t width, const unsigned char *from, float *rows,
                   unsigned char *to) {
    size_t length = width * n, bytes = length * slv_type_size(type);
    float *low = rows, *high = rows + length;
    for (uint32_t y = 0; y < width; y += 2, from += 2 * bytes, to += bytes / 2) {
        slv_type_to_float(type, from, length, low);
        slv_type_to_float(type, from + bytes, length, high);
        for (size_t x = 0; x < width / 2; x++)
            for (size_t c = 0; c < n; c++) {
                size_t at = 2 * x * n + c;
                low[x * n + c] = 0.25f * ((low[at] + low[at + n]) + (high[at] + high[at + n]));
            }
        slv_type_from_float(type, low, length / 2, to);
    }
}

void slvi_htex_fill_edge(const slv_htex_fill *fill, uint32_t edge, float *rows) {
    slv_htex *htex = fill->htex;
    size_t n = htex->desc.nchannels, size = htex->texel_size;
    uint32_t log2 = htex->log2[edge], width = 1u << log2;
    bool boundary = fill->mesh->half[edge][1] == SLV_HTEX_NONE;
    unsigned char *texels = htex->at[edge];
    const float *diagonal = fill->diagonals + fill->ends[edge] * 2 * n,
                *other = diagonal + (boundary ? 0 : width * n);
    for (uint32_t i = 0; i < width; i++) {
        for (size_t c = 0; c < n; c++)
            rows[c] = 0.5f * (diagonal[i * n + c] + other[i * n + c]);
        slv_type_from_float(htex->desc.type, rows, n,
                            texels + ((size_t)(width - 1 - i) * width + i) * size);
    }
    for (uint32_t j = 1; boundary && j < width; j++)
        for (uint32_t i = width - j; i < width; i++)
            memcpy(texels + ((size_t)j * width + i) * size,
                   texels + ((size_t)(width - 1 - i) * width + (width - 1 - j)) * size, size);
    for (uint32_t level = 1; level <= log2; level++) {
        uint64_t count = slv_htex_level_texels(log2, level - 1);
        reduce(htex->desc.type, n, width >> (level - 1), texels, rows, texels + count * size);
        texels += count * size;
    }
}

static slv_result fill_edges(void *user, uint64_t first, uint64_t end) {
    const slv_htex_fill *fill = user;
    uint64_t n = fill->htex->desc.nchannels, most = 0;
    float *rows = NULL;
    for (uint64_t edge = first; edge < end; edge++)
        most = fill->htex->log2[edge] > most ? fill->htex->log2[edge] : most;
    slv_result result =
        slvi_alloc(&fill->env, "texels", (UINT64_C(2) << most) * n, sizeof *rows, &rows);
    for (uint64_t edge = first; !result && edge < end; edge++)
        slvi_htex_fill_edge(fill, (uint32_t)edge, rows);
    slvi_free(rows);
    return result;
}

static uint32_t log2_for(slv_res res, bool part) {
    return (uint32_t)(res.u + res.v + 1) / 2 + (part ? 1 : 0);
}

uint32_t slvi_htex_log2_for(const slv_htex_mesh *mesh, const slv_res *res, uint32_t edge) {
    uint32_t most = 0;
    for (uint32_t side = 0; side < 2; side++) {
        uint32_t half = mesh->half[edge][side];
        if (half == SLV_HTEX_NONE)
            continue;
        bool part = slv_htex_is_part(mesh, half / 4);
        uint32_t log2 = log2_for(res[half / 4], part);
        most = log2 > most ? log2 : most;
        if (!part)
            continue;
        log2 = log2_for(res[mesh->after[half / 4]], part);
        most = log2 > most ? log2 : most;
    }
    return most;
}

uint64_t slvi_htex_square_bytes(const slv_htex *htex, uint32_t log2) {
    uint64_t texels = 0;
    for (uint32_t level = 0; level <= log2; level++)
        texels += slv_htex_level_texels(log2, level);
    return texels * htex->texel_size;
}

void slvi_htex_free_own(const slv_htex *htex, uint32_t edge) {
    uintptr_t at = (uintptr_t)htex->at[edge], first = (uintptr_t)htex->texels;
    if (at < first || at > first + htex->ntexels)
        slvi_free(htex->at[edge]);
}

/* Resolutions, how much everything takes, and what each face looks up. */
static slv_result lay_out(const slv_env *env, const slv_htex_mesh *mesh, slv_htex *htex,
                          uint64_t *ends) {
    uint64_t length = 0;
    for (uint32_t face = 0; face < mesh->nfaces; face++) {
        bool part = slv_htex_is_part(mesh, face);
        uint32_t half = 4 * face;
        slv_htex_face *row = &htex->faces[face];
        row->part = part;
        if (part)
            half = 4 * mesh->before[mesh->before[face]];
        for (uint32_t k = 0; k < 4; k++, half = slv_htex_next(mesh, half)) {
            row->edge[k] = mesh->edge[half];
            row->second[k] = mesh->half[row->edge[k]][0] != half;
        }
    }
    for (uint32_t edge = 0; edge < mesh->nedges; edge++) {
        uint32_t log2 = slvi_htex_log2_for(mesh, htex->res, edge);
        uint64_t bytes = slvi_htex_square_bytes(htex, log2);
        htex->log2[edge] = (uint8_t)log2;
        ends[edge] = length;
        length += UINT64_C(1) << log2;
        if (bytes > UINT64_MAX - htex->bytes)
            return slvi_fail(env, SLV_ERROR_LIMIT, "half-edges: more than 2^64 bytes of texels");
        htex->bytes += bytes;
    }
    ends[mesh->nedges] = length;
    return SLV_OK;
}

static void point(slv_htex *htex) {
    unsigned char *next = htex->texels;
    htex->ntexels = htex->bytes;
    for (uint32_t edge = 0; edge < htex->nedges; edge++) {
        htex->at[edge] = next;
        next += slvi_htex_square_bytes(htex, htex->log2[edge]);
    }
}

static slv_result create(const slv_env *env, const slv_levels *levels,
                         const slv_adjacency *adjacency, const slv_htex_mesh *mesh,
                         slv_htex *htex) {
    slv_htex_fill fill = {.levels = levels, .adjacency = adjacency, .mesh = mesh, .htex = htex};
    uint64_t nedges = mesh->nedges, n = htex->desc.nchannels;
    slv_parallel_log *log = NULL;
    slv_result result;
    if ((result = slvi_alloc(env, "edges", nedges, sizeof *htex->log2, &htex->log2)) ||
        (result = slvi_alloc(env, "faces", mesh->nfaces, sizeof *htex->faces, &htex->faces)) ||
        (result = slvi_alloc(env, "edges", nedges, sizeof *htex->at, &htex->at)) ||
        (result = slvi_alloc(env, "edges", nedges + 1, sizeof *fill.ends, &fill.ends)) ||
        (result = lay_out(env, mesh, htex, fill.ends)) ||
        (result = slvi_alloc_plain(env, "squares", htex->bytes, 1, &htex->texels)) ||
        (result = slvi_alloc_plain(env, "samples on edges", fill.ends[nedges] * 2 * n,
                                   sizeof *fill.diagonals, &fill.diagonals)) ||
        (result = slvi_alloc(env, "corners", 5 * (uint64_t)mesh->nfaces * n, sizeof *fill.tops,
                             &fill.tops)))
        goto done;
    point(htex);
    if ((result = slvi_parallel_env_begin(env, &log, &fill.env)) ||
        (result = slvi_parallel_for(env, mesh->nfaces, ITEMS_PER_RANGE, fill_faces, &fill)) ||
        (result = slvi_parallel_for(env, nedges, ITEMS_PER_RANGE, fill_edges, &fill)))
        goto done;
    result = slvi_htex_find_corners(env, htex, mesh, adjacency, fill.tops);
done:
    slvi_parallel_env_end(log);
    slvi_free(fill.ends);
    slvi_free(fill.diagonals);
    slvi_free(fill.tops);
    return result;
}

static slv_result create_whole(const slv_env *env, const slv_levels *levels,
                               const slv_adjacency *adjacency, slv_htex **out) {
    const slv_texture_desc *desc = &levels->desc;
    slv_htex_mesh mesh = {0};
    slv_htex *htex = NULL;
    slv_result result;
    *out = NULL;
    if (slv_adjacency_face_count(adjacency) != desc->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "half-edges: %u faces of texture, %u of adjacency", (unsigned)desc->nfaces,
                         (unsigned)slv_adjacency_face_count(adjacency));
    if ((result = slvi_alloc(env, "half-edge texture", 1, sizeof *htex, &htex)))
        return result;
    htex->desc = *desc;
    htex->texel_size = levels->texel_size;
    htex->vectors = levels->vectors;
    if ((result = slvi_alloc(env, "resolutions", desc->nfaces, sizeof *htex->res, &htex->res)) ||
        (result = slvi_htex_mesh_create(env, adjacency, &mesh)))
        goto done;
    if (desc->nfaces)
        memcpy(htex->res, desc->res, desc->nfaces * sizeof *htex->res);
    htex->desc.res = htex->res;
    htex->nedges = mesh.nedges;
    if ((result = create(env, levels, adjacency, &mesh, htex)))
        goto done;
    *out = htex;
    htex = NULL;
done:
    slvi_htex_mesh_free(&mesh);
    slv_htex_destroy(htex);
    return result;
}

slv_result slv_htex_create(const slv_env *env, const slv_levels *levels,
                           const slv_adjacency *adjacency, slv_htex **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, create_whole(&own, levels, adjacency, out));
}

void slv_htex_destroy(slv_htex *htex) {
    if (!htex)
        return;
    for (uint32_t edge = 0; htex->ntexels && edge < htex->nedges; edge++)
        slvi_htex_free_own(htex, edge);
    slvi_free(htex->texels);
    slvi_free(htex->corners);
    slvi_free(htex->values);
    slvi_free(htex->at);
    slvi_free(htex->faces);
    slvi_free(htex->log2);
    slvi_free(htex->res);
    slvi_free(htex);
}

const slv_texture_desc *slv_htex_get_desc(const slv_htex *htex) {
    return &htex->desc;
}

uint64_t slv_htex_bytes(const slv_htex *htex) {
    return htex->bytes;
}

uint32_t slv_htex_edge_count(const slv_htex *htex) {
    return htex->nedges;
}

uint32_t slv_htex_log2(const slv_htex *htex, uint32_t edge) {
    assert(edge < htex->nedges);
    return htex->log2[edge];
}

const void *slv_htex_texels(const slv_htex *htex, uint32_t edge, uint32_t level) {
    assert(edge < htex->nedges && level <= htex->log2[edge]);
    uint64_t first = 0;
    for (uint32_t l = 0; l < level; l++)
        first += slv_htex_level_texels(htex->log2[edge], l);
    return htex->at[edge] + first * htex->texel_size;
}

uint32_t slv_htex_value_count(const slv_htex *htex) {
    return htex->nvalues;
}

const float *slv_htex_values(const slv_htex *htex) {
    return htex->values;
}

void slv_htex_get_corner(const slv_htex *htex, uint32_t corner, uint32_t *first, uint32_t *log2) {
    assert(corner < htex->ncorners);
    *first = htex->corners[corner].first;
    *log2 = htex->corners[corner].log2;
}

slv_htex_face slv_htex_get_face(const slv_htex *htex, uint32_t face) {
    assert(face < htex->desc.nfaces);
    return htex->faces[face];
}
