/* Loads the scene that a verb draws. */
#include "command/scene.h"
#include "command/output.h"
#include "command/words.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *scene_strategies(char *text, size_t size) {
    size_t length = 0;
    text[0] = 0;
    for (uint32_t s = 0; s < slv_strategy_count() && length < size; s++)
        length += (size_t)snprintf(text + length, size - length, "%s%s", s ? "|" : "",
                                   slv_strategy_at(s)->name);
    return text;
}

/* The box around polygons first..end-1, whose vertices begin at `verts`. */
static void add_bounds(const slv_mesh_view *mesh, const int32_t *verts, uint32_t first,
                       uint32_t end, float low[3], float high[3]) {
    for (uint32_t p = first; p < end; verts += mesh->poly_sizes[p++])
        for (int32_t k = 0; k < mesh->poly_sizes[p]; k++)
            for (int c = 0; c < 3; c++) {
                low[c] = fminf(low[c], mesh->positions[3 * (size_t)verts[k] + (size_t)c]);
                high[c] = fmaxf(high[c], mesh->positions[3 * (size_t)verts[k] + (size_t)c]);
            }
}

/* The box around all groups of a name; all polygons if the name is NULL. False if there is no such
 * group. */
static bool find_bounds(const slv_mesh_view *mesh, const char *group, float low[3], float high[3]) {
    const int32_t *verts = mesh->poly_verts;
    uint32_t at = 0;
    bool found = false;
    for (int c = 0; c < 3; c++) {
        low[c] = INFINITY;
        high[c] = -INFINITY;
    }
    if (!group) {
        add_bounds(mesh, verts, 0, mesh->npolys, low, high);
        return mesh->npolys > 0;
    }
    for (uint32_t g = 0; g < mesh->ngroups; g++) {
        if (strcmp(mesh->group_names[g], group) != 0)
            continue;
        uint32_t first = (uint32_t)mesh->group_first[g];
        while (at < first) /* runs are in the order of their beginnings */
            verts += mesh->poly_sizes[at++];
        add_bounds(mesh, verts, first, first + (uint32_t)mesh->group_count[g], low, high);
        found |= mesh->group_count[g] > 0;
    }
    return found;
}

/* What words_hint says of the groups' names. */
static const char *hint_group(const slv_mesh_view *mesh, const char *typed,
                              char text[SLV_WORDS_HINT]) {
    size_t size = 1;
    for (uint32_t g = 0; g < mesh->ngroups; g++)
        size += strlen(mesh->group_names[g]) + 1;
    char *names = malloc(size), *end = names;
    text[0] = 0;
    for (uint32_t g = 0; g < mesh->ngroups && names; g++)
        end += sprintf(end, "%s%s", g ? "|" : "", mesh->group_names[g]);
    if (end != names)
        slv_words_hint(typed, names, text);
    free(names);
    return text;
}

slv_result scene_load_geometry(const slv_env *env, const slv_ptx *ptx, const char *option,
                               slv_mesh **out) {
    slv_env silent = *env;
    silent.log = NULL;
    slv_result result = slv_ptx_load_mesh(&silent, ptx, out);
    if (result == SLV_ERROR_UNSUPPORTED)
        return output_fail(env, result, "%s: holds no geometry: give it with %s", slv_ptx_name(ptx),
                           option);
    return result ? slv_ptx_load_mesh(env, ptx, out) : SLV_OK; /* for its message */
}

static slv_result find_focus(const slv_env *env, const scene_params *params, scene_data *out) {
    const slv_mesh_view *mesh = slv_mesh_get_view(out->mesh);
    char hint[SLV_WORDS_HINT];
    if (find_bounds(mesh, params->focus, out->bounds_min, out->bounds_max))
        return SLV_OK;
    return output_fail(env, SLV_ERROR_ARGUMENT, "%s: there is no group '%s' to focus on%s",
                       params->mesh ? params->mesh : params->ptx,
                       params->focus ? params->focus : "",
                       params->focus ? hint_group(mesh, params->focus, hint) : "");
}

slv_result scene_load_images(const slv_env *env, const scene_params *params, const slv_bake_uv *uv,
                             const char *image, scene_data *out) {
    const slv_surface_params surface = {
        .scheme = params->scheme, .boundary = params->boundary, .moves = params->moves};
    slv_result result;
    memset(out, 0, sizeof *out);
    if (!(result = slv_mesh_load(env, cli_input(params->mesh), &out->mesh)) &&
        !(result = slv_bake_from_uv(env, out->mesh, image, uv, &out->uv)) &&
        !(result = slv_surface_create(env, out->mesh, &surface, &out->surface)))
        result = find_focus(env, params, out);
    if (!result)
        slv_bake_source_images(out->uv, &out->images);
    else
        scene_free(out);
    return result;
}

/* Six faces that close a cube. */
static slv_result load_environment(const slv_env *env, const slv_ptx *ptx, scene_data *out) {
    slv_adjacency *adjacency = NULL;
    slv_result result = slv_ptx_load_adjacency(env, ptx, &adjacency);
    if (!result)
        result = slv_mesh_create_cube(env, adjacency, &out->mesh);
    slv_adjacency_destroy(adjacency);
    if (!result) {
        out->environment = true;
        out->sphere = slv_sphere_displacement(out->mesh);
    }
    return result;
}

/* The mesh: named, in the file, or that of an environment. */
static slv_result load_mesh(const slv_env *env, const scene_params *params, const slv_ptx *ptx,
                            scene_data *out) {
    slv_env silent = *env;
    silent.log = NULL;
    if (params->environment && load_environment(&silent, ptx, out))
        return output_fail(env, SLV_ERROR_MISMATCH,
                           "%s: is no environment: that has six faces which close a cube",
                           slv_ptx_name(ptx));
    if (params->environment)
        return SLV_OK;
    if (params->mesh)
        return slv_mesh_load(env, cli_input(params->mesh), &out->mesh);
    if (slv_ptx_load_mesh(&silent, ptx, &out->mesh) == SLV_ERROR_UNSUPPORTED &&
        !load_environment(&silent, ptx, out))
        return SLV_OK;
    return out->mesh ? SLV_OK : scene_load_geometry(env, ptx, "--mesh FILE.obj", &out->mesh);
}

static void begin(const scene_params *params, scene_step step) {
    if (params->begins)
        params->begins(params->user, step);
}

slv_result scene_load_model(const slv_env *env, const scene_params *params, slv_ptx **ptx,
                            scene_data *out) {
    const slv_ptx_open_params open = {.salvage = params->salvage, .progress = params->progress};
    slv_result result;
    memset(out, 0, sizeof *out);
    begin(params, SCENE_STEP_MESH);
    if ((result = slv_ptx_open_with(env, params->ptx, &open, ptx)))
        goto done;
    const slv_ptx_info *info = slv_ptx_get_info(*ptx);
    const bool triangles = info->mesh_type == SLV_PTX_TRIANGLE;
    const uint64_t nfaces = (triangles ? 3 : 1) * (uint64_t)info->nfaces;
    result = load_mesh(env, params, *ptx, out);
    if (result || (params->adjacency == 0 && (result = slv_ptx_match_mesh(env, *ptx, out->mesh))))
        goto done;
    begin(params, SCENE_STEP_ADJACENCY);
    result = params->adjacency == 1 ? slv_ptx_load_adjacency(env, *ptx, &out->adjacency)
                                    : slv_mesh_adjacency(env, out->mesh, &out->adjacency);
    if (result)
        goto done;
    if (slv_adjacency_face_count(out->adjacency) != nfaces ||
        slv_mesh_face_count(out->mesh) != nfaces ||
        (triangles && !scene_is_of_triangles(out->mesh))) {
        result = slv_ptx_match_mesh(env, *ptx, out->mesh); /* for its message */
        goto done;
    }
    slv_surface_params surface = {
        .scheme = params->scheme, .boundary = params->boundary, .moves = params->moves};
    if (triangles && !params->scheme_given)
        surface.scheme = SLV_SCHEME_LOOP;
    if (out->environment)
        surface.scheme = SLV_SCHEME_BILINEAR;
    out->scheme = surface.scheme;
    begin(params, SCENE_STEP_SURFACE);
    if ((result = slv_surface_create(env, out->mesh, &surface, &out->surface)))
        goto done;
    result = find_focus(env, params, out);
    for (int c = 0; c < 3 && out->environment;
         c++) { /* about the box that a camera frames as a sphere */
        out->bounds_min[c] = -0.65f;
        out->bounds_max[c] = 0.65f;
    }
done:
    if (result) {
        scene_free(out);
        slv_ptx_close(*ptx);
        *ptx = NULL;
    }
    return result;
}

slv_alpha_mode scene_alpha_of(const slv_ptx_info *info, slv_alpha_mode wanted) {
    bool shown = info->alpha_channel == 3 || (info->alpha_channel == 1 && info->nchannels == 2);
    return shown ? wanted : SLV_ALPHA_IGNORE;
}

/* Colours of what is averaged are multiplied by alpha. */
static slv_result multiply(const slv_env *env, slv_texture_encoding encoding, const scene_data *of,
                           slv_texture **texture) {
    slv_texture *multiplied = NULL;
    if (of->alpha == SLV_ALPHA_IGNORE || of->premultiplied)
        return SLV_OK;
    slv_result result = slv_texture_premultiply(
        env, *texture, of->raw && !encoding ? SLV_TEXTURE_DATA : encoding, &multiplied);
    if (!result) {
        slv_texture_destroy(*texture);
        *texture = multiplied;
    }
    return result;
}

static slv_result note_damage(const slv_env *env, const slv_ptx *ptx, scene_data *out) {
    const uint32_t nfaces = slv_mesh_face_count(out->mesh);
    if (!slv_ptx_salvaged_count(ptx))
        return SLV_OK;
    if (!(out->damaged = calloc((size_t)nfaces + 1, 1)))
        return output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for its faces", slv_ptx_name(ptx));
    for (uint32_t f = 0; f < nfaces; f++) {
        out->damaged[f] = slv_ptx_is_salvaged(ptx, (uint32_t)scene_file_face(out, (int32_t)f));
        out->ndamaged += out->damaged[f];
    }
    return SLV_OK;
}

slv_result scene_load_texels(const slv_env *env, const slv_ptx *ptx, const slv_res *res,
                             slv_texture_encoding encoding, scene_data *out) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    bool triangles = info->mesh_type == SLV_PTX_TRIANGLE;
    /* the filter of triangles knows no border modes */
    out->border_u = triangles ? SLV_BORDER_CLAMP : info->border_u;
    out->border_v = triangles ? SLV_BORDER_CLAMP : info->border_v;
    out->edge_filter = triangles ? SLV_EDGE_FILTER_NONE : info->edge_filter;
    out->even = slv_ptx_find_meta(ptx, SLV_PTX_REDUCTIONS_KEY) != NULL;
    slv_result result = scene_check_memory(env, ptx, res);
    if (!result)
        result =
            slv_ptx_load_texture_at(env, ptx, res, triangles ? &out->triangles : &out->texture);
    if (!result)
        result = multiply(env, encoding, out, triangles ? &out->triangles : &out->texture);
    if (!result && triangles)
        result = slv_triangle_texture(env, out->triangles, out->adjacency, encoding, &out->texture);
    return result ? result : note_damage(env, ptx, out);
}

slv_result scene_load(const slv_env *env, const scene_params *params, scene_data *out) {
    slv_ptx *ptx = NULL;
    slv_result result = scene_load_model(env, params, &ptx, out);
    if (!result) {
        out->alpha = scene_alpha_of(slv_ptx_get_info(ptx), params->alpha);
        out->premultiplied = params->premultiplied;
        begin(params, SCENE_STEP_TEXELS);
        if ((result = scene_load_texels(env, ptx, NULL, params->encoding, out)))
            scene_free(out);
    }
    slv_ptx_close(ptx);
    return result;
}

int32_t scene_file_face(const scene_data *scene, int32_t face) {
    return face >= 0 && scene->triangles ? face / 3 : face;
}

void scene_free(scene_data *scene) {
    displace_close(&scene->displace); /* looks at the adjacency */
    slv_mesh_destroy(scene->mesh);
    slv_adjacency_destroy(scene->adjacency);
    slv_surface_destroy(scene->surface);
    slv_texture_destroy(scene->texture);
    slv_bake_source_destroy(scene->uv);
    frames_free(&scene->frames);
    slv_texture_destroy(scene->triangles);
    free(scene->damaged);
    memset(scene, 0, sizeof *scene);
}
