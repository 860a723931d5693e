/* What a cage must be for its points to stand for those of the mesh. */
#include "source/cage.h"

#include "base/log.h"

#include <math.h>

static slv_result compare(const slv_env *env, const slv_mesh_view *mesh,
                          const slv_mesh_view *cage) {
    const int32_t *a = mesh->poly_verts, *b = cage->poly_verts;
    if (mesh->npolys != cage->npolys || mesh->nverts != cage->nverts)
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "bake: the cage has %u polygons of %u vertices, the mesh %u of %u",
                         cage->npolys, cage->nverts, mesh->npolys, mesh->nverts);
    for (uint32_t poly = 0; poly < mesh->npolys; poly++) {
        int32_t size = mesh->poly_sizes[poly];
        if (size != cage->poly_sizes[poly])
            return slvi_fail(env, SLV_ERROR_MISMATCH,
                             "bake: polygon %u of the cage has %d sides, the mesh's %d", poly,
                             cage->poly_sizes[poly], size);
        for (int32_t k = 0; k < size; k++)
            if (a[k] != b[k])
                return slvi_fail(
                    env, SLV_ERROR_MISMATCH,
                    "bake: corner %d of polygon %u is vertex %d of the cage, but %d of "
                    "the mesh",
                    k, poly, b[k], a[k]);
        a += size;
        b += size;
    }
    return SLV_OK;
}

slv_result slvi_cage_create(const slv_env *env, const slv_mesh *mesh, const slv_mesh *cage,
                            slv_scheme scheme, bake_cage *out) {
    const slv_surface_params how = {.scheme = scheme};
    const slv_mesh_view *own = slv_mesh_get_view(mesh);
    *out = (bake_cage){0};
    if (!cage)
        return SLV_OK;
    const slv_mesh_view *view = slv_mesh_get_view(cage);
    slv_result result = compare(env, own, view);
    for (int k = 0; k < 3; k++)
        out->offset[k] = (float)(view->origin[k] - own->origin[k]);
    return result ? result : slv_surface_create(env, cage, &how, &out->surface);
}

void slvi_cage_bound(const bake_cage *cage, const slv_mesh *given, const float *offset,
                     float low[3], float high[3]) {
    const slv_mesh_view *view = given ? slv_mesh_get_view(given) : NULL;
    for (size_t i = 0; view && i < (size_t)3 * view->nverts; i++) {
        float at = view->positions[i] + cage->offset[i % 3] + (offset ? offset[i % 3] : 0);
        low[i % 3] = fminf(low[i % 3], at);
        high[i % 3] = fmaxf(high[i % 3], at);
    }
}

void slvi_cage_destroy(bake_cage *cage) {
    slv_surface_destroy(cage->surface);
}

slv_result slvi_cage_points(const bake_cage *cage, size_t count, const slv_surface_point *points,
                            float *positions) {
    const slv_surface_arrays arrays = {.positions = positions};
    slv_result result = slv_surface_evaluate(cage->surface, count, points, &arrays);
    for (size_t i = 0; i < 3 * count && !result; i++)
        positions[i] += cage->offset[i % 3];
    return result;
}
