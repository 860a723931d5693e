/* Calls of what makes textures out of images, and images out of textures. */
#ifndef CALLS_BAKE_H
#define CALLS_BAKE_H

#include "kit/calls_data.h"

#include <selvage/bake_recipe.h>
#include <selvage/wrap.h>

static slv_result call_bake(const slv_env *env) {
    return slv_bake_procedural(env, calls.surface, &calls_noise, NULL, calls.texture);
}

static slv_result call_bake_save(const slv_env *env) {
    const slv_bake_job job = {.uniform = true, .res = {3, 3}, .miss_map = calls_path("map.ptx")};
    slv_mesh *mesh = NULL;
    slv_bake_source *uv = NULL, *pattern = NULL;
    float *corners = NULL, *round = NULL, values[4 * 4];
    uint8_t misses[4];
    const slv_rect rect = {1, 1, 2, 2};
    char path[256];
    snprintf(path, sizeof path, "%s/baked.ptx", calls.folder);
    slv_result result =
        slv_mesh_parse_obj(env, "mesh", calls_uv_obj, sizeof calls_uv_obj - 1, &mesh);
    if (!result && !(result = slv_mesh_face_texcoords(env, mesh, &corners)) &&
        !(result = slv_mesh_round_texcoords(env, mesh, true, true, &round)) &&
        !(result = slv_bake_from_uv(env, mesh, calls.png, NULL, &uv)) &&
        !(result = slv_bake_evaluate(uv, env, 0, (slv_res){3, 3}, rect, values, misses)) &&
        !(result = slv_bake_save(env, mesh, uv, &job, path, NULL)))
        result = slv_bake_from_pattern(env, calls.surface, &calls_noise, &pattern);
    if (!result)
        result = slv_bake_evaluate(pattern, env, 0, (slv_res){3, 3}, rect, values, misses);
    slv_free(corners);
    slv_free(round);
    slv_bake_source_destroy(uv);
    slv_bake_source_destroy(pattern);
    slv_mesh_destroy(mesh);
    return result;
}

static slv_result call_bake_recipe(const slv_env *env) {
    static const char changes[] =
        "{\"source\": {\"blend\": \"multiply\", \"bottom\": {\"pattern\": \"noise\"}, \"top\": "
        "{\"levels\": {\"channels\": [1], \"of\": {\"constant\": [1, 0.5]}}}}, \"size\": 4}";
    slv_bake_recipe *recipe = NULL;
    slv_bake_source *source = NULL;
    char part[256];
    slv_result result = slv_bake_recipe_load(env, NULL, changes, &recipe);
    if (!result && !(result = slv_bake_recipe_source(env, recipe, calls.mesh, &source))) {
        slv_bake_job job = *slv_bake_recipe_job(recipe);
        snprintf(part, sizeof part, "%s/baked.part", calls.folder);
        unlink(part); /* of a call that failed */
        job.resume = part;
        result = slv_bake_save(env, calls.mesh, source, &job, calls_path("mixed.ptx"), NULL);
    }
    slv_bake_source_destroy(source);
    slv_bake_recipe_destroy(recipe);
    return result;
}

static slv_result call_bake_colors(const slv_env *env) {
    static const char obj[] = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nf 1 2 3\n";
    slv_mesh *mesh = NULL, *points = NULL;
    slv_bake_source *source = NULL, *texture = NULL;
    slv_result result = slv_mesh_parse_obj(env, "mesh", obj, sizeof obj - 1, &mesh);
    if (!result)
        result = slv_bake_from_vertex_colors(env, mesh, SLV_TEXTURE_AUTO, &source);
    slv_bake_source_destroy(source);
    source = NULL;
    if (!result)
        result = slv_bake_from_points(env, calls.mesh, calls.surface, mesh, NULL, &source);
    slv_bake_source_destroy(source);
    source = NULL;
    if (!result)
        result = slv_mesh_load_points(env, calls.obj, &points);
    if (!result &&
        !(result = slv_bake_from_texture(env, calls.mesh, calls.ptx, SLV_TEXTURE_AUTO, &texture)))
        result = slv_bake_from_mesh(env, calls.mesh, calls.surface, points, texture, NULL, &source);
    slv_mesh_destroy(points);
    slv_bake_source_destroy(source);
    slv_mesh_destroy(mesh);
    return result;
}

static slv_result call_bake_rays(const slv_env *env) {
    const slv_bake_rays rays = {.samples = 2, .segments = 2};
    slv_bake_source *source = NULL;
    slv_result result = slv_bake_from_surface(env, calls.surface, SLV_BAKE_NORMAL, &source);
    slv_bake_source_destroy(source);
    source = NULL;
    if (!result)
        result = slv_bake_from_rays(env, calls.mesh, calls.surface, &rays, &source);
    slv_bake_source_destroy(source);
    source = NULL;
    if (!result)
        result = slv_bake_from_detail(env, calls.mesh, calls.surface, calls.mesh, NULL, &source);
    slv_bake_source_destroy(source);
    return result;
}

static slv_result call_unbake(const slv_env *env) {
    const slv_unbake_params params = {.width = 8, .height = 8};
    slv_mesh *mesh = NULL;
    slv_bake_source *uv = NULL;
    slv_ptx *ptx = NULL;
    char path[256];
    snprintf(path, sizeof path, "%s/for_unbake.ptx", calls.folder);
    slv_result result =
        slv_mesh_parse_obj(env, "mesh", calls_uv_obj, sizeof calls_uv_obj - 1, &mesh);
    if (!result && !(result = slv_bake_from_uv(env, mesh, calls.png, NULL, &uv)))
        result = slv_bake_save(env, mesh, uv, NULL, path, NULL);
    if (!result && !(result = slv_ptx_open(env, path, &ptx)))
        result = slv_unbake(env, ptx, mesh, &params, calls_path("back.png"), NULL);
    slv_ptx_close(ptx);
    slv_bake_source_destroy(uv);
    slv_mesh_destroy(mesh);
    return result;
}

static slv_result call_unbake_normals(const slv_env *env) {
    const slv_unbake_params params = {.width = 8, .height = 8, .normals = SLV_UNBAKE_FACE_NORMALS};
    slv_mesh *mesh = NULL;
    slv_surface *surface = NULL;
    slv_bake_source *source = NULL;
    slv_ptx *ptx = NULL;
    char path[256];
    snprintf(path, sizeof path, "%s/for_normals.ptx", calls.folder);
    const slv_bake_job job = {.uniform = true, .res = {2, 2}};
    slv_result result =
        slv_mesh_parse_obj(env, "mesh", calls_uv_obj, sizeof calls_uv_obj - 1, &mesh);
    if (!result && !(result = slv_surface_create(env, mesh, NULL, &surface)) &&
        !(result = slv_bake_from_surface(env, surface, SLV_BAKE_NORMAL, &source)))
        result = slv_bake_save(env, mesh, source, &job, path, NULL);
    if (!result && !(result = slv_ptx_open(env, path, &ptx)))
        result = slv_unbake(env, ptx, mesh, &params, calls_path("normals.png"), NULL);
    slv_ptx_close(ptx);
    slv_bake_source_destroy(source);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    return result;
}

#endif
