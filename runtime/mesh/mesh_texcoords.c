/* Texture coordinates at the corners of faces, sub-faces among them. */
#include "mesh/mesh_data.h"

#include "base/memory.h"

#include <selvage/wrap.h>

#include <math.h>
#include <string.h>

/* What is at a polygon's corner: if the axis goes round, the short way from its first. */
static float corner_value(const slv_mesh_view *view, const int32_t *ids, int32_t i, int axis,
                          bool round) {
    float value = view->texcoords[2 * (size_t)ids[i] + (size_t)axis],
          first = view->texcoords[2 * (size_t)ids[0] + (size_t)axis];
    return round ? first + slv_wrap_step(first, value) : value;
}

static void polygon_texcoords(const slv_mesh_view *view, const int32_t *ids, int32_t size,
                              const bool round[2], float *out) {
    for (int axis = 0; axis < 2; axis++) {
        double sum = 0;
        for (int32_t i = 0; i < size; i++)
            sum += (double)corner_value(view, ids, i, axis, round[axis]);
        for (int32_t k = 0; k < size; k++) {
            float own = corner_value(view, ids, k, axis, round[axis]),
                  next = corner_value(view, ids, (k + 1) % size, axis, round[axis]),
                  last = corner_value(view, ids, (k + size - 1) % size, axis, round[axis]);
            if (size == 4) {
                out[2 * k + axis] = own;
                continue;
            }
            float *corners = out + 8 * (size_t)k + axis;
            corners[0] = own;
            corners[2] = 0.5f * own + 0.5f * next;
            corners[4] = (float)(sum / size);
            corners[6] = 0.5f * own + 0.5f * last;
        }
    }
}

slv_result slv_mesh_round_texcoords(const slv_env *env, const slv_mesh *mesh, bool round_u,
                                    bool round_v, float **out) {
    const bool round[2] = {round_u, round_v};
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
            polygon_texcoords(view, ids, size, round, corners);
        else
            for (int32_t i = 0; i < 8 * nfaces; i++)
                corners[i] = NAN;
    }
    return result;
}

slv_result slv_mesh_face_texcoords(const slv_env *env, const slv_mesh *mesh, float **out) {
    return slv_mesh_round_texcoords(env, mesh, false, false, out);
}
