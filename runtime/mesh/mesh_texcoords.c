/* Texture coordinates at the corners of faces, sub-faces among them. */
#include "mesh/mesh_data.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

static void polygon_texcoords(const slv_mesh_view *view, const int32_t *ids, int32_t size,
                              float *out) {
    double sum[2] = {0, 0};
    for (int32_t i = 0; i < size; i++)
        for (int axis = 0; axis < 2; axis++)
            sum[axis] += (double)view->texcoords[2 * (size_t)ids[i] + (size_t)axis];
    for (int32_t k = 0; k < size; k++) {
        const float *own = view->texcoords + 2 * (size_t)ids[k];
        const float *next = view->texcoords + 2 * (size_t)ids[(k + 1) % size];
        const float *last = view->texcoords + 2 * (size_t)ids[(k + size - 1) % size];
        if (size == 4) {
            memcpy(out + 2 * (size_t)k, own, 2 * sizeof *out);
            continue;
        }
        for (int axis = 0; axis < 2; axis++) {
            float *corners = out + 8 * (size_t)k + axis;
            corners[0] = own[axis];
            corners[2] = 0.5f * own[axis] + 0.5f * next[axis];
            corners[4] = (float)(sum[axis] / size);
            corners[6] = 0.5f * own[axis] + 0.5f * last[axis];
        }
    }
}

slv_result slv_mesh_face_texcoords(const slv_env *env, const slv_mesh *mesh, float **out) {
    const slv_mesh_view *view = &mesh->view;
    slv_result result = slvi_alloc(env, "texture coordinates", mesh->nfaces, 8 * sizeof **out, out);
    for (uint32_t poly = 0; !result && poly < view->npolys; poly++) {
        int32_t size = view->poly_sizes[poly], nfaces = size == 4 ? 1 : size;
        const int32_t *ids =
            view->poly_texcoords ? view->poly_texcoords + mesh->poly_first[poly] : NULL;
        float *corners = *out + (size_t)8 * (size_t)mesh->poly_face[poly];
        bool whole = ids != NULL;
        for (int32_t i = 0; whole && i < size; i++)
            whole = ids[i] >= 0;
        if (whole)
            polygon_texcoords(view, ids, size, corners);
        else
            for (int32_t i = 0; i < 8 * nfaces; i++)
                corners[i] = NAN;
    }
    return result;
}
