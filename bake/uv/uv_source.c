/* The mean of UV images over texels: samples at half a pixel's distance or less, along lines that
 * are straight in the images because faces are bilinear there. */
#include "uv/uv_source.h"
#include "uv/corners.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/processor.h"

#include <selvage/wrap.h>

#include <math.h>
#include <string.h>

#define MOST_SAMPLES (UINT64_C(1) << 26) /* a face, or 4 a texel */

/* ---- which cells belong to a face ---- */

static void widen(int32_t cells[4], const int32_t other[4]) {
    for (int axis = 0; axis < 2; axis++) {
        cells[axis] = cells[axis] < other[axis] ? cells[axis] : other[axis];
        cells[2 + axis] = cells[2 + axis] > other[2 + axis] ? cells[2 + axis] : other[2 + axis];
    }
}

static slv_result find_cells(const slv_env *env, const slv_mesh *mesh, uv_source *s) {
    slv_adjacency *adjacency = NULL;
    slv_result result =
        slvi_alloc(env, "bake: cells", s->base.nfaces, 4 * sizeof *s->cells, &s->cells);
    if (result || !s->set.udim || (result = slv_mesh_adjacency(env, mesh, &adjacency)))
        return result;
    for (uint32_t face = 0; face < s->base.nfaces; face++) {
        int32_t *cells = s->cells + 4 * (size_t)face, other[4];
        if (isnan(slvi_uv_corners_of(s, face)[0]))
            continue;
        slvi_uv_own_cells(slvi_uv_corners_of(s, face), cells);
        for (unsigned edge = 0; edge < 4; edge++) {
            slv_neighbour next[2];
            uint32_t count = slv_adjacency_neighbours(adjacency, (int32_t)face, edge, next);
            for (uint32_t i = 0; i < count; i++) {
                const float *there = slvi_uv_corners_of(s, (uint32_t)next[i].face);
                if (isnan(there[0]) || !slv_uv_continues(slvi_uv_corners_of(s, face), edge,
                                                         &next[i], there, false, false))
                    continue;
                slvi_uv_own_cells(there, other);
                widen(cells, other);
            }
        }
    }
    slv_adjacency_destroy(adjacency);
    return SLV_OK;
}

/* ---- how densely ---- */

/* Pixels along an axis of a face: the longer of its two sides there, and the mean of them. */
static void sides_of(const uv_source *s, const float *corners, float longest[2], float mean[2]) {
    uint32_t width = 0, height = 0;
    float middle[2] = {0.25f * (corners[0] + corners[2] + corners[4] + corners[6]),
                       0.25f * (corners[1] + corners[3] + corners[5] + corners[7])};
    const uv_tile *tile =
        slvi_uv_set_at(&s->set, (int32_t)floorf(middle[0]), (int32_t)floorf(middle[1]));
    /* where there is none, as densely as the widest of the others would have it */
    for (uint32_t i = 0; !tile && i < s->set.ntiles; i++)
        if (s->set.tiles[i].width > width)
            width = s->set.tiles[i].width, height = s->set.tiles[i].height;
    if (tile)
        width = tile->width, height = tile->height;
    static const unsigned from[2][2] = {{0, 3}, {0, 1}}, to[2][2] = {{1, 2}, {3, 2}};
    for (int axis = 0; axis < 2; axis++) {
        float length[2];
        for (int k = 0; k < 2; k++) {
            const float *a = corners + 2 * (size_t)from[axis][k],
                        *b = corners + 2 * (size_t)to[axis][k];
            length[k] = hypotf((b[0] - a[0]) * (float)width, (b[1] - a[1]) * (float)height);
        }
        longest[axis] = fmaxf(length[0], length[1]);
        mean[axis] = 0.5f * (length[0] + length[1]);
    }
}

static uint32_t samples_for(float pixels, uint32_t texels) {
    float each = 2 * pixels / (float)texels - 0.01f;
    return each > 1 ? each < 65536 ? (uint32_t)ceilf(each) : 65536 : 1;
}

static uv_face begin_face(const uv_source *s, uint32_t face, slv_res res) {
    uv_face f = {.source = s,
                 .corners = slvi_uv_corners_of(s, face),
                 .cells = s->cells + 4 * (size_t)face,
                 .width = 1u << res.u,
                 .height = 1u << res.v};
    float longest[2], mean[2];
    slvi_uv_own_cells(f.corners, f.own);
    sides_of(s, f.corners, longest, mean);
    f.nu = samples_for(longest[0], f.width);
    f.nv = samples_for(longest[1], f.height);
    uint64_t texels = (uint64_t)f.width * f.height;
    uint64_t most = MOST_SAMPLES > 4 * texels ? MOST_SAMPLES : 4 * texels;
    while ((uint64_t)f.nu * f.nv > most / texels)
        if (f.nu > f.nv)
            f.nu = (f.nu + 1) / 2;
        else
            f.nv = (f.nv + 1) / 2;
    return f;
}

/* Colours as painted again. */
static void unmultiply(uint32_t n, float *values, size_t count) {
    for (size_t i = 0; i < count; i++, values += n) {
        const float alpha = values[n - 1] > 0 ? values[n - 1] : 1;
        if (n == 4) { /* all at once: divisions take long */
            uv_pixel value;
            memcpy(&value, values, sizeof value);
            value /= (uv_pixel){alpha, alpha, alpha, 1};
            memcpy(values, &value, sizeof value);
        } else {
            values[0] /= alpha;
        }
    }
}

static slv_result evaluate(const slv_bake_source *source, const slv_env *env, uint32_t face,
                           slv_res res, slv_rect rect, float *values, uint8_t *misses) {
    const uv_source *s = (const uv_source *)source;
    uint32_t n = s->set.nchannels;
    if (isnan(slvi_uv_corners_of(s, face)[0])) {
        memset(misses, SLV_BAKE_NO_UV, (size_t)rect.width * rect.height);
        return SLV_OK;
    }
    const uv_face f = begin_face(s, face, res);
    slv_result result = slvi_uv_fill(&f, env, rect, values, misses);
    if (result)
        return result;
    if (s->set.alpha >= 0)
        unmultiply(n, values, (size_t)rect.width * rect.height);
    return SLV_OK;
}

static void extent(const slv_bake_source *source, uint32_t face, float size[2]) {
    const uv_source *s = (const uv_source *)source;
    float longest[2];
    size[0] = size[1] = 0;
    if (!isnan(slvi_uv_corners_of(s, face)[0]))
        sides_of(s, slvi_uv_corners_of(s, face), longest, size);
}

static const slv_bake_tile *tiles(const slv_bake_source *source, uint32_t *count) {
    const uv_source *s = (const uv_source *)source;
    *count = s->set.ntiles;
    return s->set.list;
}

static slv_result list_squares(const slv_env *env, uv_source *s) {
    slv_result result =
        slvi_alloc(env, "bake: tiles", s->set.ntiles, sizeof *s->squares, &s->squares);
    for (uint32_t i = 0; i < s->set.ntiles && !result; i++) {
        const slv_bake_tile *tile = &s->set.list[i];
        int32_t cell = tile->number ? (int32_t)tile->number - UV_FIRST_TILE : 0;
        s->squares[i] =
            (slv_uv_tile){cell % UV_CELLS_U, cell / UV_CELLS_U, tile->width, tile->height};
    }
    return result;
}

static void destroy(slv_bake_source *source) {
    uv_source *s = (uv_source *)source;
    slvi_free(s->squares);
    slvi_uv_set_free(&s->set);
    slvi_free(s->corners);
    slvi_free(s->once);
    slvi_free(s->cells);
    slvi_free(s);
}

/* What is drawn has one value a vertex, in 0..1; what is looked up here leaves that. */
static slv_result go_round(const slv_env *env, uv_source *s) {
    size_t count = (size_t)s->base.nfaces * 8;
    slv_result result =
        slvi_alloc_plain(env, "bake: texture coordinates", count, sizeof *s->once, &s->once);
    for (size_t i = 0; i < count && !result; i++)
        s->once[i] = s->round[i & 1] ? s->corners[i] - floorf(s->corners[i]) : s->corners[i];
    return result;
}

static slvi_uv_sum_line *best_line(void) {
#define KIND_OR(KIND) slvi_has_##KIND() ? slvi_uv_sum_line_##KIND:
    return SLVI_UV_PROCESSORS(KIND_OR) NULL;
}

slv_result slv_bake_from_uv(const slv_env *env, const slv_mesh *mesh, const char *path,
                            const slv_bake_uv *params, slv_bake_source **out) {
    static const slv_bake_uv none = {0};
    static const slvi_bake_fns fns = {evaluate, extent, tiles, destroy, slvi_uv_images};
    uv_source *s = NULL;
    *out = NULL;
    slv_result result = slvi_alloc(env, "bake: UV image", 1, sizeof *s, &s);
    if (result)
        return result;
    s->base = (slv_bake_source){.fns = &fns, .nfaces = slv_mesh_face_count(mesh)};
    slv_bake_uv chosen = params ? *params : none;
    s->sum_line = best_line();
    s->round[0] = chosen.round_u;
    s->round[1] = chosen.round_v;
    if ((s->round[0] || s->round[1]) && strstr(path, SLV_BAKE_UDIM)) {
        result = slvi_fail(env, SLV_ERROR_ARGUMENT,
                           "%s: coordinates that go round take one image, which repeats, and no "
                           "set of tiles",
                           path);
        goto done;
    }
    if ((result = slv_mesh_round_texcoords(env, mesh, s->round[0], s->round[1], &s->corners)))
        goto done;
    const uv_lacking lacking = slvi_uv_check_corners(s->corners, s->base.nfaces);
    if (s->base.nfaces && lacking.none + lacking.far == s->base.nfaces) {
        result = slvi_fail(env, SLV_ERROR_MISMATCH,
                           "%s: the mesh has no texture coordinates (vt) to look it up with, or "
                           "none that are within 65536",
                           path);
        goto done;
    }
    if ((s->round[0] || s->round[1]) && (result = go_round(env, s)))
        goto done;
    slvi_uv_warn_of_lacking(env, path, &lacking, s->base.nfaces);
    slvi_uv_warn_of_wide(env, path, s->corners, s->base.nfaces, s->round);
    const bool along = (s->round[0] || s->round[1]) && !chosen.wrap;
    if (along)
        chosen.wrap = SLV_BAKE_WRAP_REPEAT;
    if ((result = slvi_uv_set_load(env, path, &chosen, s->corners, s->base.nfaces, &s->set)) ||
        (result = find_cells(env, mesh, s)) || (result = list_squares(env, s)))
        goto done;
    for (int axis = 0; axis < 2; axis++)
        s->set.ends[axis] =
            along && !s->round[axis] && slvi_uv_stays(s->corners, s->base.nfaces, axis);
    s->base.desc =
        (slv_bake_source_desc){s->set.type, s->set.nchannels, s->set.alpha, s->set.encoding};
    *out = &s->base;
    s = NULL;
done:
    if (s)
        destroy(&s->base);
    return result;
}
