/* Textures as samples on the edges of faces: made, looked up, and turned back. */
#include "form/edge_aligned/edge_aligned_data.h"

#include "base/log.h"
#include "base/memory.h"
#include "texture/bilinear.h"

#include <assert.h>
#include <string.h>

#define FACES_PER_RANGE 16

struct slv_edge_aligned {
    slv_env env; /* its log is serialised: faces may be converted back by many threads at once */
    slv_parallel_log *log;
    slv_texture_desc desc;
    slv_res *res;
    bool even; /* of even levels */
    size_t texel_size;
    size_t *first; /* per face: its first level in `at` */
    unsigned char **at;
    uint64_t bytes;
    unsigned char *samples; /* of all faces */
};

uint64_t slv_edge_aligned_count(slv_res res) {
    return ((UINT64_C(1) << res.u) + 1) * ((UINT64_C(1) << res.v) + 1);
}

/* Means of the four texels around each inner sample. Row y of texels is put in row y + 1 of `out`
 * first, and then summed from below, so that no other memory is needed. */
static void fill_interior(const slv_levels *levels, uint32_t face, uint32_t level, slv_res res,
                          float *out) {
    size_t n = levels->desc.nchannels, width = (size_t)1 << res.u, height = (size_t)1 << res.v;
    size_t pitch = (width + 1) * n, row = width * n;
    const unsigned char *from = slv_levels_texels(levels, face, level);
    for (size_t y = 0; y < height; y++, from += width * levels->texel_size)
        slv_type_to_float(levels->desc.type, from, row, out + (y + 1) * pitch);
    for (size_t y = 1; y < height; y++) {
        float *at = out + y * pitch;
        for (size_t i = 0; i < row; i++)
            at[i] += at[pitch + i];
        for (size_t i = row; i-- > n;)
            at[i] = 0.25f * (at[i] + at[i - n]);
    }
}

static void fill_edges(const slv_levels *levels, const slv_adjacency *adjacency, bool rounded,
                       uint32_t face, uint32_t level, slv_res res, float *out) {
    ptrdiff_t n = (ptrdiff_t)levels->desc.nchannels, pitch = (((ptrdiff_t)1 << res.u) + 1) * n;
    slv_border_view view = slvi_border_view_begin(levels, adjacency);
    slv_border_edge edges[4];
    for (uint32_t edge = 0; edge < 4; edge++)
        edges[edge] = slvi_border_edge_at(&view, face, level, edge);
    while (slvi_border_view_next(&view)) {
        for (uint32_t edge = 0; edge < 4; edge++) {
            int32_t x, y;
            slvi_corner_texel((1 << res.u) + 1, (1 << res.v) + 1, edge, &x, &y);
            float value[SLV_BORDER_CHANNELS], *start = out + y * pitch + x * n + view.first;
            ptrdiff_t step = slvi_edge_step(edge, n, pitch);
            slvi_edge_aligned_corner(&view, rounded, face, level, edge, value);
            for (uint32_t c = 0; c < view.count; c++)
                start[c] = value[c] / view.one;
            slvi_edge_aligned_side(&view, rounded, &edges[edge], start + step, step);
        }
    }
}

void slvi_edge_aligned_fill(const slv_levels *levels, const slv_adjacency *adjacency, uint32_t face,
                            uint32_t level, bool rim, float *out) {
    slv_res res = slvi_level_res(levels, face, level);
    slv_ring rings[4];
    uint32_t positions[4];
    if (!rim)
        fill_interior(levels, face, level, res, out);
    if (slvi_edge_aligned_is_alike(levels, adjacency, face, rings, positions))
        slvi_edge_aligned_fill_alike(levels, face, level, rings, positions, out);
    else
        fill_edges(levels, adjacency, true, face, level, res, out);
}

slv_result slv_edge_aligned_build(const slv_levels *levels, const slv_adjacency *adjacency,
                                  uint32_t face, uint32_t level, float *out) {
    const slv_texture_desc *desc = &levels->desc;
    if (slv_adjacency_face_count(adjacency) != desc->nfaces)
        return slvi_fail(&levels->env, SLV_ERROR_MISMATCH,
                         "edge-aligned: %u faces of texture, %u of adjacency",
                         (unsigned)desc->nfaces, (unsigned)slv_adjacency_face_count(adjacency));
    if (face >= desc->nfaces || level >= slv_levels_count(levels, face))
        return slvi_fail(&levels->env, SLV_ERROR_ARGUMENT,
                         "edge-aligned: face %u of %u has no level %u", (unsigned)face,
                         (unsigned)desc->nfaces, (unsigned)level);
    slv_res res = slvi_level_res(levels, face, level);
    fill_interior(levels, face, level, res, out);
    fill_edges(levels, adjacency, false, face, level, res, out);
    return SLV_OK;
}

/* Floats that the largest face of a range takes. */
static uint64_t largest(const slv_texture_desc *desc, uint64_t first, uint64_t end) {
    uint64_t most = 0;
    for (uint64_t face = first; face < end; face++) {
        uint64_t count = slv_edge_aligned_floats(desc, (uint32_t)face);
        most = count > most ? count : most;
    }
    return most;
}

struct fill {
    const slv_levels *levels;
    const slv_adjacency *adjacency;
    slv_edge_aligned *aligned;
};

/* All levels of a face; `scratch` has room for the largest as floats. */
static void fill_face(const struct fill *fill, uint32_t face, float *scratch) {
    slv_edge_aligned *aligned = fill->aligned;
    unsigned char *const *at = aligned->at + aligned->first[face];
    for (uint32_t level = 0; level < slv_res_level_count(aligned->res[face]); level++) {
        uint64_t count =
            slv_edge_aligned_count(slvi_res_level(aligned->res[face], level, aligned->even));
        slvi_edge_aligned_fill(fill->levels, fill->adjacency, face, level, false, scratch);
        slv_type_from_float(aligned->desc.type, scratch, (size_t)count * aligned->desc.nchannels,
                            at[level]);
    }
}

static slv_result fill_faces(void *user, uint64_t first, uint64_t end) {
    const struct fill *fill = user;
    slv_edge_aligned *aligned = fill->aligned;
    float *scratch = NULL;
    slv_result result = slvi_alloc_plain(
        &aligned->env, "samples", largest(&aligned->desc, first, end), sizeof *scratch, &scratch);
    for (uint64_t face = first; !result && face < end; face++)
        fill_face(fill, (uint32_t)face, scratch);
    slvi_free(scratch);
    return result;
}

static uint64_t face_bytes(const slv_edge_aligned *aligned, uint32_t face) {
    uint64_t bytes = 0;
    for (uint32_t level = 0; level < slv_res_level_count(aligned->res[face]); level++)
        bytes += slv_edge_aligned_count(slvi_res_level(aligned->res[face], level, aligned->even)) *
                 aligned->texel_size;
    return bytes;
}

static slv_result count_bytes(slv_edge_aligned *aligned) {
    uint64_t total = 0;
    for (uint32_t face = 0; face < aligned->desc.nfaces; face++) {
        uint64_t bytes = face_bytes(aligned, face);
        if (bytes > UINT64_MAX - total)
            return slvi_fail(&aligned->env, SLV_ERROR_LIMIT,
                             "edge-aligned: more than 2^64 bytes of samples");
        total += bytes;
    }
    aligned->bytes = total;
    return SLV_OK;
}

/* Where a face's levels are, one behind the other from `next` on; returns where they end. */
static unsigned char *point(slv_edge_aligned *aligned, uint32_t face, unsigned char *next) {
    for (uint32_t level = 0; level < slv_res_level_count(aligned->res[face]); level++) {
        aligned->at[aligned->first[face] + level] = next;
        next += slv_edge_aligned_count(slvi_res_level(aligned->res[face], level, aligned->even)) *
                aligned->texel_size;
    }
    return next;
}

static void point_all(slv_edge_aligned *aligned) {
    unsigned char *next = aligned->samples;
    size_t at = 0;
    for (uint32_t face = 0; face < aligned->desc.nfaces; face++) {
        aligned->first[face] = at;
        at += slv_res_level_count(aligned->res[face]);
        next = point(aligned, face, next);
    }
}

static slv_result create(const slv_env *env, const slv_levels *levels,
                         const slv_adjacency *adjacency, slv_edge_aligned **out) {
    const slv_texture_desc *desc = &levels->desc;
    slv_edge_aligned *aligned = NULL;
    uint64_t nlevels = 0;
    slv_result result;
    *out = NULL;
    if (slv_adjacency_face_count(adjacency) != desc->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "edge-aligned: %u faces of texture, %u of adjacency",
                         (unsigned)desc->nfaces, (unsigned)slv_adjacency_face_count(adjacency));
    if ((result = slvi_alloc(env, "edge-aligned texture", 1, sizeof *aligned, &aligned)))
        return result;
    aligned->desc = *desc;
    aligned->texel_size = levels->texel_size;
    aligned->even = levels->even;
    for (uint32_t face = 0; face < desc->nfaces; face++)
        nlevels += slv_res_level_count(desc->res[face]);
    if ((result = slvi_parallel_env_begin(env, &aligned->log, &aligned->env)) ||
        (result =
             slvi_alloc(env, "resolutions", desc->nfaces, sizeof *aligned->res, &aligned->res)) ||
        (result =
             slvi_alloc(env, "faces", desc->nfaces, sizeof *aligned->first, &aligned->first)) ||
        (result = slvi_alloc(env, "levels", nlevels, sizeof *aligned->at, &aligned->at)))
        goto done;
    if (desc->nfaces)
        memcpy(aligned->res, desc->res, desc->nfaces * sizeof *aligned->res);
    aligned->desc.res = aligned->res;
    if ((result = count_bytes(aligned)) ||
        (result =
             slvi_alloc_plain(env, "edge-aligned samples", aligned->bytes, 1, &aligned->samples)))
        goto done;
    point_all(aligned);
    struct fill fill = {levels, adjacency, aligned};
    if ((result = slvi_parallel_for(env, desc->nfaces, FACES_PER_RANGE, fill_faces, &fill)))
        goto done;
    *out = aligned;
    aligned = NULL;
done:
    slv_edge_aligned_destroy(aligned);
    return result;
}

slv_result slv_edge_aligned_create(const slv_env *env, const slv_levels *levels,
                                   const slv_adjacency *adjacency, slv_edge_aligned **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, create(&own, levels, adjacency, out));
}

void slv_edge_aligned_destroy(slv_edge_aligned *aligned) {
    if (!aligned)
        return;
    slvi_free(aligned->samples);
    slvi_free(aligned->at);
    slvi_free(aligned->first);
    slvi_free(aligned->res);
    slvi_parallel_env_end(aligned->log);
    slvi_free(aligned);
}

const slv_texture_desc *slv_edge_aligned_get_desc(const slv_edge_aligned *aligned) {
    return &aligned->desc;
}

uint64_t slv_edge_aligned_bytes(const slv_edge_aligned *aligned) {
    return aligned->bytes;
}

const void *slv_edge_aligned_samples(const slv_edge_aligned *aligned, uint32_t face,
                                     uint32_t level) {
    assert(face < aligned->desc.nfaces && level < slv_res_level_count(aligned->res[face]));
    return aligned->at[aligned->first[face] + level];
}

void slv_edge_aligned_lookup(const slv_edge_aligned *aligned, uint32_t face, uint32_t level,
                             float u, float v, float *out) {
    const unsigned char *samples = slv_edge_aligned_samples(aligned, face, level);
    slv_res res = slvi_res_level(aligned->res[face], level, aligned->even);
    slv_type type = aligned->desc.type;
    size_t value_size = slv_type_size(type), texel = aligned->texel_size;
    slvi_bilinear at = slvi_bilinear_edge_aligned(res, u, v);
    for (uint32_t first = 0; first < aligned->desc.nchannels; first += SLVI_BILINEAR_CHANNELS) {
        uint32_t left = aligned->desc.nchannels - first;
        uint32_t count = left < SLVI_BILINEAR_CHANNELS ? left : SLVI_BILINEAR_CHANNELS;
        slvi_bilinear_typed(type, samples + first * value_size, texel,
                            (((size_t)1 << res.u) + 1) * texel, &at, count, out + first);
    }
}

slv_result slv_edge_aligned_centred(const slv_edge_aligned *aligned, uint32_t face, uint32_t level,
                                    float *out) {
    if (face >= aligned->desc.nfaces || level >= slv_res_level_count(aligned->res[face]))
        return slvi_fail(&aligned->env, SLV_ERROR_ARGUMENT,
                         "edge-aligned: face %u of %u has no level %u", (unsigned)face,
                         (unsigned)aligned->desc.nfaces, (unsigned)level);
    slv_res res = slvi_res_level(aligned->res[face], level, aligned->even);
    size_t n = aligned->desc.nchannels, width = (size_t)1 << res.u, height = (size_t)1 << res.v;
    size_t pitch = (width + 1) * aligned->texel_size;
    const unsigned char *from = slv_edge_aligned_samples(aligned, face, level);
    slv_type type = aligned->desc.type;
    float low[2][SLV_BORDER_CHANNELS], high[2][SLV_BORDER_CHANNELS];
    size_t value_size = slv_type_size(type);
    for (size_t first = 0; first < n; first += SLV_BORDER_CHANNELS) {
        size_t count = n - first < SLV_BORDER_CHANNELS ? n - first : SLV_BORDER_CHANNELS;
        for (size_t y = 0; y < height; y++) {
            const unsigned char *at = from + y * pitch + first * value_size;
            float *to = out + y * width * n + first;
            slv_type_to_float(type, at, count, low[0]);
            slv_type_to_float(type, at + pitch, count, high[0]);
            for (size_t x = 0; x < width; x++, to += n) {
                size_t left = x % 2, right = !left;
                at += aligned->texel_size;
                slv_type_to_float(type, at, count, low[right]);
                slv_type_to_float(type, at + pitch, count, high[right]);
                for (size_t c = 0; c < count; c++)
                    to[c] = 0.25f * ((low[0][c] + low[1][c]) + (high[0][c] + high[1][c]));
            }
        }
    }
    return SLV_OK;
}

struct restore {
    const slv_edge_aligned *aligned;
    slv_env env;
    slv_texture *texture;
};

static slv_result restore_faces(void *user, uint64_t first, uint64_t end) {
    const struct restore *restore = user;
    const slv_texture_desc *desc = &restore->aligned->desc;
    uint64_t most = largest(desc, first, end);
    float *values = NULL;
    void *texels = NULL;
    slv_result result;
    if ((result = slvi_alloc(&restore->env, "texels", most, sizeof *values, &values)) ||
        (result = slvi_alloc(&restore->env, "texels", most, slv_type_size(desc->type), &texels)))
        goto done;
    for (uint64_t face = first; face < end; face++) {
        if ((result = slv_edge_aligned_centred(restore->aligned, (uint32_t)face, 0, values)))
            goto done;
        slv_type_from_float(desc->type, values, slv_res_texels(desc->res[face]) * desc->nchannels,
                            texels);
        if ((result = slv_texture_set_face(restore->texture, (uint32_t)face, texels)))
            goto done;
    }
done:
    slvi_free(values);
    slvi_free(texels);
    return result;
}

static slv_result to_texture(const slv_env *env, const slv_edge_aligned *aligned,
                             slv_texture **out) {
    struct restore restore = {.aligned = aligned};
    slv_parallel_log *log = NULL;
    slv_result result;
    *out = NULL;
    if ((result = slvi_parallel_env_begin(env, &log, &restore.env)))
        return result;
    if (!(result = slv_texture_create(&restore.env, &aligned->desc, &restore.texture)))
        result = slvi_parallel_for(&restore.env, aligned->desc.nfaces, FACES_PER_RANGE,
                                   restore_faces, &restore);
    if (result) {
        slv_texture_destroy(restore.texture);
        restore.texture = NULL;
    }
    slvi_parallel_env_end(log);
    *out = restore.texture;
    return result;
}

slv_result slv_edge_aligned_to_texture(const slv_env *env, const slv_edge_aligned *aligned,
                                       slv_texture **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, to_texture(&own, aligned, out));
}
