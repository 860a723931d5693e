/* The scene of a reference: the tessellation as quads for Embree, and the texture. */
#include "rays/reference_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

static slv_result make_quads(slv_reference *r, uint64_t *count) {
    const slv_tessellation *mesh = &r->mesh;
    uint64_t n = 0;
    for (uint32_t face = 0; face < mesh->nfaces; face++)
        n += (uint64_t)mesh->segments[face] * mesh->segments[face];
    *count = n;
    slv_result result = slvi_alloc(&r->env, "quads", n, 4 * sizeof *r->quads, &r->quads);
    uint32_t *to = r->quads;
    for (uint32_t face = 0; !result && face < mesh->nfaces; face++) {
        uint32_t side = mesh->segments[face], row = side + 1, first = mesh->first[face];
        for (uint32_t y = 0; y < side; y++) {
            for (uint32_t x = 0; x < side; x++, to += 4) {
                uint32_t a = first + y * row + x;
                to[0] = a + 1;
                to[1] = a + row + 1;
                to[2] = a + row;
                to[3] = a;
            }
        }
    }
    return result;
}

static slv_result make_scene(slv_reference *r) {
    uint64_t nquads;
    slv_result result = make_quads(r, &nquads);
    if (result)
        return result;
    for (int k = 0; k < 3 && nquads; k++)
        r->step += fabsf(r->mesh.bounds_max[k] - r->mesh.bounds_min[k]);
    embree_faces faces = {.what = "reference",
                          .type = RTC_GEOMETRY_TYPE_QUAD,
                          .points = nquads ? r->mesh.vertices->position : NULL,
                          .stride = sizeof *r->mesh.vertices,
                          .npoints = r->mesh.first[r->mesh.nfaces],
                          .corners = r->quads,
                          .count = nquads,
                          .low = r->mesh.bounds_min,
                          .high = r->mesh.bounds_max};
    return embree_build(&r->env, &faces, &r->device, &r->scene);
}

/* The surface as it is divided, and the tree of its quads. */
static slv_result make_geometry(slv_reference *r, const slv_env *env, const slv_mesh *mesh,
                                const slv_surface *surface, const slv_tessellation_params *params) {
    slv_adjacency *adjacency = NULL;
    slv_result result = slv_mesh_adjacency(env, mesh, &adjacency);
    if (!result)
        result = slv_tessellate_with(env, mesh, surface, adjacency, params, &r->mesh);
    slv_adjacency_destroy(adjacency);
    return result ? result : make_scene(r);
}

static void free_geometry(slv_reference *r) {
    embree_release(r->device, r->scene);
    slv_tessellation_free(&r->mesh);
    slvi_free(r->quads);
}

static slv_result check(const slv_env *env, const slv_mesh *mesh, const slv_surface *surface,
                        const slv_texture *texture, const slv_adjacency *adjacency,
                        slv_reference_params *params) {
    uint32_t nfaces = slv_mesh_face_count(mesh);
    if (params->images &&
        (texture || params->images->nfaces != nfaces || slv_surface_face_count(surface) != nfaces))
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "reference: the mesh has %u faces, the surface %u, the images %u%s",
                         nfaces, slv_surface_face_count(surface), params->images->nfaces,
                         texture ? ", and there is a texture too" : "");
    if (params->images)
        return SLV_OK;
    if ((unsigned)params->border_u > SLV_BORDER_PERIODIC ||
        (unsigned)params->border_v > SLV_BORDER_PERIODIC)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "reference: unknown border mode %d or %d",
                         (int)params->border_u, (int)params->border_v);
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    if (slv_surface_face_count(surface) != nfaces || desc->nfaces != nfaces ||
        slv_adjacency_face_count(adjacency) != nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "reference: the mesh has %u faces, the surface %u, the texture %u, the "
                         "adjacency %u",
                         nfaces, slv_surface_face_count(surface), desc->nfaces,
                         slv_adjacency_face_count(adjacency));
    if ((unsigned)params->alpha > SLV_ALPHA_MASK)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "reference: there is no alpha mode %d",
                         (int)params->alpha);
    if (!params->nchannels && params->first_channel < desc->nchannels) {
        params->nchannels = desc->nchannels - params->first_channel;
        params->nchannels = params->nchannels < 4 ? params->nchannels : 4;
    }
    if (params->nchannels < 1 || params->nchannels > 4 ||
        params->first_channel >= desc->nchannels ||
        params->nchannels > desc->nchannels - params->first_channel)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "reference: %u channels from %u on, of a texture with %u",
                         params->nchannels, params->first_channel, desc->nchannels);
    return SLV_OK;
}

static slv_result create(const slv_env *env, const slv_mesh *mesh, const slv_surface *surface,
                         const slv_texture *texture, const slv_adjacency *adjacency,
                         const slv_reference_params *given, slv_reference **out) {
    slv_reference_params params = given ? *given : (slv_reference_params){0};
    slv_texture *decoded = NULL;
    slv_reference *made = NULL;
    slv_result result;
    bool grey_alpha = false;
    if (texture && !params.nchannels && !params.first_channel) {
        const slv_texture_desc *desc = slv_texture_get_desc(texture);
        grey_alpha = desc->nchannels == 2 && desc->alpha_channel == 1;
    }
    const slv_tessellation_params even = {.segments = params.segments ? params.segments : 32};
    *out = NULL;
    if ((result = check(env, mesh, surface, texture, adjacency, &params)) ||
        (result = slvi_alloc(env, "reference", 1, sizeof *made, &made)))
        return result;
    made->env = slvi_env_or_default(env);
    made->alpha = params.alpha;
    uint32_t most = params.alpha ? 4 : 3, shown = params.nchannels < most ? params.nchannels : most;
    if (params.images)
        made->images = *params.images;
    else if ((result = slv_texture_decode(env, texture, params.encoding, &decoded)) ||
             (result = slvi_reference_texels_create(env, decoded ? decoded : texture, adjacency,
                                                    &params, shown, &made->texels)) ||
             (result = slvi_reference_texels_border(env, adjacency, params.border_u,
                                                    params.border_v, &made->texels)))
        goto done;
    made->texels.alpha = grey_alpha;
    if ((result = make_geometry(made, env, mesh, surface,
                                params.tessellation ? params.tessellation : &even)))
        goto done;
    *out = made;
    made = NULL;
done:
    slv_texture_destroy(decoded);
    slv_reference_destroy(made);
    return result;
}

slv_result slv_reference_create(const slv_env *env, const slv_mesh *mesh,
                                const slv_surface *surface, const slv_texture *texture,
                                const slv_adjacency *adjacency, const slv_reference_params *given,
                                slv_reference **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, create(&own, mesh, surface, texture, adjacency, given, out));
}

void slv_reference_destroy(slv_reference *reference) {
    if (!reference)
        return;
    free_geometry(reference);
    slvi_reference_texels_free(&reference->texels);
    slvi_free(reference);
}

slv_result slv_reference_tessellate(slv_reference *reference, const slv_env *env,
                                    const slv_mesh *mesh, const slv_surface *surface,
                                    const slv_tessellation_params *params) {
    slv_reference fresh = {.env = reference->env};
    uint32_t nfaces = reference->mesh.nfaces;
    if (slv_mesh_face_count(mesh) != nfaces || slv_surface_face_count(surface) != nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "reference: the mesh has %u faces, the surface %u, and what is shown %u",
                         slv_mesh_face_count(mesh), slv_surface_face_count(surface), nfaces);
    slv_env own = slvi_budget_begin(env);
    slv_result result = slvi_budget_end(&own, make_geometry(&fresh, &own, mesh, surface, params));
    if (result) {
        free_geometry(&fresh);
        return result;
    }
    free_geometry(reference);
    reference->mesh = fresh.mesh;
    reference->quads = fresh.quads;
    reference->device = fresh.device;
    reference->scene = fresh.scene;
    reference->step = fresh.step;
    return SLV_OK;
}

slv_result slv_reference_lookup(const slv_reference *reference, size_t count,
                                const slv_surface_point *points, float *rgb) {
    for (size_t i = 0; i < count; i++) {
        if (points[i].face < 0 || (uint32_t)points[i].face >= reference->mesh.nfaces)
            return slvi_fail(&reference->env, SLV_ERROR_ARGUMENT,
                             "reference: point %zu: there is no face %d", i, points[i].face);
        float rgba[4];
        reference_color(reference, (uint32_t)points[i].face, points[i].u, points[i].v, rgba);
        memcpy(rgb + 3 * i, rgba, 3 * sizeof *rgb);
    }
    return SLV_OK;
}
