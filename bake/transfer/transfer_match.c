/* Faces of two meshes with the same corners, however they are numbered, turned or flipped. */
#include "transfer/transfer_data.h"

#include "adjacency/edge.h"
#include "base/memory.h"
#include "base/names.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *slv_transfer_kind_name(slv_transfer_kind kind) {
    static const char *const names[] = {"copied", "resampled", "partly", "far"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)kind);
}

slv_result slvi_transfer_corners(const slv_env *env, const slv_mesh *mesh, float **out) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    uint32_t nfaces = slv_mesh_face_count(mesh);
    const slv_mesh_face *faces = slv_mesh_faces(mesh);
    uint64_t *starts = NULL;
    slv_result result = slvi_alloc(env, "corners", nfaces, 12 * sizeof **out, out);
    if (result ||
        (result = slvi_alloc(env, "polygons", (uint64_t)view->npolys + 1, sizeof *starts, &starts)))
        return result;
    for (uint32_t poly = 0; poly < view->npolys; poly++)
        starts[poly + 1] = starts[poly] + (uint32_t)view->poly_sizes[poly];
    for (uint32_t face = 0; face < nfaces; face++) {
        const slv_mesh_face *f = &faces[face];
        const int32_t *verts = view->poly_verts + starts[f->poly];
        int32_t n = view->poly_sizes[f->poly], k = f->sub;
        float *corners = *out + (size_t)12 * face;
        for (int axis = 0; axis < 3; axis++) {
            const float *at = view->positions + axis;
            if (k < 0) {
                for (int c = 0; c < 4; c++)
                    corners[3 * c + axis] = at[3 * (size_t)verts[c]];
                continue;
            }
            double sum = 0;
            for (int32_t i = 0; i < n; i++)
                sum += (double)at[3 * (size_t)verts[i]];
            float own = at[3 * (size_t)verts[k]], next = at[3 * (size_t)verts[(k + 1) % n]],
                  last = at[3 * (size_t)verts[(k + n - 1) % n]];
            corners[axis] = own;
            corners[3 + axis] = 0.5f * (own + next);
            corners[6 + axis] = (float)(sum / n);
            corners[9 + axis] = 0.5f * (own + last);
        }
    }
    slvi_free(starts);
    return SLV_OK;
}

/* In double: squares of lengths that float holds need not fit in one. */
static double triangle_area(const float *a, const float *b, const float *c) {
    double x[3], y[3];
    for (int k = 0; k < 3; k++) {
        x[k] = (double)b[k] - (double)a[k];
        y[k] = (double)c[k] - (double)a[k];
    }
    double n[3] = {x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
    return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

double slvi_transfer_area(const float *corners) {
    return triangle_area(corners, corners + 3, corners + 6) +
           triangle_area(corners, corners + 6, corners + 9);
}

static double length_of(const float *a, const float *b) {
    double x = (double)b[0] - (double)a[0], y = (double)b[1] - (double)a[1],
           z = (double)b[2] - (double)a[2];
    return sqrt(x * x + y * y + z * z);
}

float slvi_transfer_mean_length(const float *a, const float *b, const float *c, const float *d) {
    return (float)(0.5 * (length_of(a, b) + length_of(c, d)));
}

/* A face by the middle of its corners, along one axis: faces that match are near each other there.
 */
struct entry {
    float key;
    uint32_t face;
};

static float middle(const float *corners) {
    return 0.25f * ((corners[0] + corners[3]) + (corners[6] + corners[9]));
}

static int compare(const void *left, const void *right) {
    const struct entry *a = left, *b = right;
    if (a->key != b->key)
        return a->key < b->key ? -1 : 1;
    return (a->face > b->face) - (a->face < b->face);
}

static bool same_point(const float *a, const float *b, float tolerance) {
    return fabsf(a[0] - b[0]) <= tolerance && fabsf(a[1] - b[1]) <= tolerance &&
           fabsf(a[2] - b[2]) <= tolerance;
}

static unsigned source_corner(const slv_transfer_face *match, unsigned corner) {
    return (match->flipped ? match->turn + 4u - corner : match->turn + corner) % 4;
}

static bool corners_match(const float *source, const float *target, float tolerance,
                          slv_transfer_face *match) {
    for (int way = 0; way < 8; way++) {
        bool same = true;
        match->flipped = way >= 4;
        match->turn = (uint8_t)(way % 4);
        for (unsigned c = 0; c < 4 && same; c++)
            same = same_point(source + 3 * source_corner(match, c), target + 3 * c, tolerance);
        if (same)
            return true;
    }
    match->flipped = false;
    match->turn = 0;
    return false;
}

slv_result slvi_transfer_match(const slv_env *env, uint32_t nsource, const float *source,
                               uint32_t ntarget, const float *target, float tolerance,
                               slv_transfer_face *faces) {
    struct entry *entries = NULL;
    slv_result result = slvi_alloc(env, "faces to match", nsource, sizeof *entries, &entries);
    if (result)
        return result;
    for (uint32_t face = 0; face < nsource; face++)
        entries[face] = (struct entry){middle(source + (size_t)12 * face), face};
    qsort(entries, nsource, sizeof *entries, compare);
    for (uint32_t face = 0; face < ntarget; face++) {
        const float *corners = target + (size_t)12 * face;
        float key = middle(corners);
        uint32_t low = 0, high = nsource;
        faces[face] = (slv_transfer_face){.source = -1};
        /* the same number is tried first: of faces that lie in one place it is the likely one */
        if (face < nsource &&
            corners_match(source + (size_t)12 * face, corners, tolerance, &faces[face])) {
            faces[face].source = (int32_t)face;
            continue;
        }
        while (low < high) {
            uint32_t at = low + (high - low) / 2;
            if (entries[at].key < key - tolerance)
                low = at + 1;
            else
                high = at;
        }
        for (; low < nsource && entries[low].key <= key + tolerance; low++)
            if (corners_match(source + (size_t)12 * entries[low].face, corners, tolerance,
                              &faces[face])) {
                faces[face].source = (int32_t)entries[low].face;
                break;
            }
    }
    slvi_free(entries);
    return SLV_OK;
}

slv_res slvi_transfer_turned(slv_res res, const slv_transfer_face *match) {
    /* a flip at corner 0 swaps the axes, and every quarter turn does */
    bool swapped = (match->turn % 2 != 0) != match->flipped;
    return swapped ? (slv_res){res.v, res.u} : res;
}

slv_result slvi_transfer_copy(const slv_env *env, const slv_texture *from,
                              const slv_transfer_face *match, slv_texture *to, uint32_t face) {
    const slv_texture_desc *desc = slv_texture_get_desc(from);
    uint32_t source = (uint32_t)match->source;
    const uint8_t *in = slv_texture_texels(from, source);
    slv_res res = slvi_transfer_turned(desc->res[source], match);
    int64_t w = INT64_C(1) << res.u, h = INT64_C(1) << res.v;
    int64_t sw = INT64_C(1) << desc->res[source].u, sh = INT64_C(1) << desc->res[source].v;
    size_t size = slv_type_size(desc->type) * desc->nchannels;
    if (slv_texture_is_constant(from, source))
        return slv_texture_set_constant(to, face, in);
    unsigned c0 = source_corner(match, 0), c1 = source_corner(match, 1),
             c3 = source_corner(match, 3);
    /* how the source's (u,v) goes along this face's u (towards corner 1) and v (towards corner 3)
     */
    int uu = slvi_corner_u(c1) - slvi_corner_u(c0), uv = slvi_corner_u(c3) - slvi_corner_u(c0),
        vu = slvi_corner_v(c1) - slvi_corner_v(c0), vv = slvi_corner_v(c3) - slvi_corner_v(c0);
    int64_t u0 = slvi_corner_u(c0) * (sw - 1), v0 = slvi_corner_v(c0) * (sh - 1);
    uint8_t *texels = NULL;
    slv_result result = slvi_alloc(env, "texels", (uint64_t)(w * h), size, &texels);
    if (result)
        return result;
    for (int64_t y = 0; y < h; y++)
        for (int64_t x = 0; x < w; x++) {
            int64_t sx = u0 + uu * x + uv * y, sy = v0 + vu * x + vv * y;
            memcpy(texels + (size_t)(y * w + x) * size, in + (size_t)(sy * sw + sx) * size, size);
        }
    result = slv_texture_set_face(to, face, texels);
    slvi_free(texels);
    return result;
}
