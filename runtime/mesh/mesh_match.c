/* Where the faces of a mesh lie, and faces of two meshes with the same corners, however they are
 * numbered, turned or flipped. */
#include "mesh/mesh_data.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

/* The corners of a polygon's faces. Its middle is the same for all, so that its size counts once.
 */
static void polygon_corners(const slv_mesh_view *view, const double shift[3], const int32_t *verts,
                            int32_t size, float *out) {
    for (int axis = 0; axis < 3; axis++) {
        const float *at = view->positions + axis;
        if (size == 4) {
            for (int c = 0; c < 4; c++)
                out[3 * c + axis] = (float)((double)at[3 * (size_t)verts[c]] + shift[axis]);
            continue;
        }
        double sum = 0;
        for (int32_t i = 0; i < size; i++)
            sum += (double)at[3 * (size_t)verts[i]] + shift[axis];
        for (int32_t k = 0; k < size; k++) {
            float own = (float)((double)at[3 * (size_t)verts[k]] + shift[axis]);
            float next = (float)((double)at[3 * (size_t)verts[(k + 1) % size]] + shift[axis]);
            float last =
                (float)((double)at[3 * (size_t)verts[(k + size - 1) % size]] + shift[axis]);
            float *corners = out + (size_t)12 * (size_t)k;
            corners[axis] = own;
            corners[3 + axis] = 0.5f * (own + next);
            corners[6 + axis] = (float)(sum / size);
            corners[9 + axis] = 0.5f * (own + last);
        }
    }
}

slv_result slv_mesh_corners(const slv_env *env, const slv_mesh *mesh, const double *origin,
                            float **out) {
    const slv_mesh_view *view = &mesh->view;
    double shift[3] = {0, 0, 0};
    for (int axis = 0; axis < 3 && origin; axis++)
        shift[axis] = view->origin[axis] - origin[axis];
    slv_result result = slvi_alloc(env, "corners", mesh->nfaces, 12 * sizeof **out, out);
    for (uint32_t poly = 0; !result && poly < view->npolys; poly++)
        polygon_corners(view, shift, view->poly_verts + mesh->poly_first[poly],
                        view->poly_sizes[poly], *out + (size_t)12 * (size_t)mesh->poly_face[poly]);
    return result;
}

/* A face by the middle of its corners, along a direction in which few faces of a model are level:
 * faces that match are near each other there. */
struct entry {
    double key;
    uint32_t face;
};

static const double along[3] = {0.61803398875, 0.41421356237, 0.73205080757};

static double middle(const float *corners) {
    double sum = 0;
    for (int i = 0; i < 12; i++)
        sum += along[i % 3] * (double)corners[i];
    return sum / 4;
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

static bool corners_match(const float *source, const float *target, float tolerance,
                          slv_face_match *match) {
    for (int way = 0; way < 8; way++) {
        bool same = true;
        match->flipped = way >= 4;
        match->turn = (uint8_t)(way % 4);
        for (unsigned c = 0; c < 4 && same; c++)
            same =
                same_point(source + 3 * slv_face_match_corner(match, c), target + 3 * c, tolerance);
        if (same)
            return true;
    }
    match->flipped = false;
    match->turn = 0;
    return false;
}

slv_result slv_mesh_match_corners(const slv_env *env, uint32_t nsource, const float *source,
                                  uint32_t ntarget, const float *target, float tolerance,
                                  slv_face_match *out) {
    struct entry *entries = NULL;
    double slack = 2 * (double)tolerance; /* the weights add up to less */
    slv_result result = slvi_alloc(env, "faces to match", nsource, sizeof *entries, &entries);
    if (result)
        return result;
    for (uint32_t face = 0; face < nsource; face++)
        entries[face] = (struct entry){middle(source + (size_t)12 * face), face};
    if (nsource)
        qsort(entries, nsource, sizeof *entries, compare);
    for (uint32_t face = 0; face < ntarget; face++) {
        const float *corners = target + (size_t)12 * face;
        double key = middle(corners);
        uint32_t low = 0, high = nsource;
        out[face] = (slv_face_match){.face = -1};
        /* the same number is tried first: of faces that lie in one place it is the likely one */
        if (face < nsource &&
            corners_match(source + (size_t)12 * face, corners, tolerance, &out[face])) {
            out[face].face = (int32_t)face;
            continue;
        }
        while (low < high) {
            uint32_t at = low + (high - low) / 2;
            if (entries[at].key < key - slack)
                low = at + 1;
            else
                high = at;
        }
        for (; low < nsource && entries[low].key <= key + slack; low++)
            if (corners_match(source + (size_t)12 * entries[low].face, corners, tolerance,
                              &out[face])) {
                out[face].face = (int32_t)entries[low].face;
                break;
            }
    }
    slvi_free(entries);
    return result;
}
