#include "scene.h"

#include <math.h>
#include <string.h>

static void find_bounds(const slv_mesh *mesh, float low[3], float high[3]) {
    slv_mesh_stats stats;
    if (slv_mesh_get_stats(NULL, mesh, &stats) == SLV_OK) {
        memcpy(low, stats.bounds_min, sizeof stats.bounds_min);
        memcpy(high, stats.bounds_max, sizeof stats.bounds_max);
    }
}

slv_result scene_load(const slv_env *env, const scene_params *params, scene_data *out) {
    slv_ptx *ptx = NULL;
    slv_result result;
    memset(out, 0, sizeof *out);
    if ((result = slv_ptx_open(env, params->ptx, &ptx)))
        goto done;
    result = params->mesh ? slv_mesh_load_obj(env, params->mesh, &out->mesh)
                          : slv_ptx_load_mesh(env, ptx, &out->mesh);
    if (result || (params->adjacency == 0 && (result = slv_ptx_match_mesh(env, ptx, out->mesh))))
        goto done;
    result = params->adjacency == 1 ? slv_ptx_load_adjacency(env, ptx, &out->adjacency)
                                    : slv_mesh_adjacency(env, out->mesh, &out->adjacency);
    if (result)
        goto done;
    if (slv_adjacency_face_count(out->adjacency) != slv_ptx_get_info(ptx)->nfaces ||
        slv_mesh_face_count(out->mesh) != slv_ptx_get_info(ptx)->nfaces) {
        result = slv_ptx_match_mesh(env, ptx, out->mesh); /* for its message */
        goto done;
    }
    slv_surface_params surface = {.scheme = params->scheme, .boundary = params->boundary};
    if ((result = slv_surface_create(env, out->mesh, &surface, &out->surface)) ||
        (result = slv_ptx_load_texture(env, ptx, &out->texture)))
        goto done;
    find_bounds(out->mesh, out->bounds_min, out->bounds_max);
done:
    slv_ptx_close(ptx);
    if (result)
        scene_free(out);
    return result;
}

void scene_free(scene_data *scene) {
    slv_mesh_destroy(scene->mesh);
    slv_adjacency_destroy(scene->adjacency);
    slv_surface_destroy(scene->surface);
    slv_texture_destroy(scene->texture);
    memset(scene, 0, sizeof *scene);
}
