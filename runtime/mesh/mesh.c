/* Polygon meshes: checked, copied, and cut into faces. */
#include "mesh/mesh_data.h"

#include "adjacency/adjacency_data.h"
#include "base/log.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

static slv_result check_floats(const slv_env *env, const char *what, const float *values,
                               uint64_t count, unsigned per_item) {
    for (uint64_t i = 0; i < count * per_item; i++)
        if (!isfinite(values[i]))
            return slvi_fail(env, SLV_ERROR_FORMAT, "mesh: %s %llu is not finite", what,
                             (unsigned long long)(i / per_item));
    return SLV_OK;
}

static slv_result check_indices(const slv_env *env, const char *what, const int32_t *indices,
                                uint64_t count, uint32_t limit) {
    for (uint64_t i = 0; i < count; i++)
        if (indices[i] < 0 || (uint32_t)indices[i] >= limit)
            return slvi_fail(env, SLV_ERROR_FORMAT, "mesh: %s %llu names %d, expected 0..%u", what,
                             (unsigned long long)i, indices[i], limit ? limit - 1 : 0);
    return SLV_OK;
}

static slv_result check_sharpness(const slv_env *env, const char *what, const float *values,
                                  uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        if (!(values[i] >= 0 && isfinite(values[i])))
            return slvi_fail(env, SLV_ERROR_FORMAT, "mesh: %s %u has sharpness %g", what, i,
                             (double)values[i]);
    return SLV_OK;
}

static slv_result check_poly_indices(const slv_env *env, const slv_mesh_view *view,
                                     const char *what, const int32_t *indices, int32_t lowest,
                                     uint32_t limit) {
    if (!indices)
        return SLV_OK;
    for (uint32_t p = 0; p < view->npolys; p++)
        for (int32_t i = 0; i < view->poly_sizes[p]; i++, indices++)
            if (*indices < lowest || (*indices >= 0 && (uint32_t)*indices >= limit))
                return slvi_fail(env, SLV_ERROR_FORMAT,
                                 "mesh: polygon %u: %s index %d is outside 0..%lld", p, what,
                                 *indices, (long long)limit - 1);
    return SLV_OK;
}

static slv_result check_present(const slv_env *env, const slv_mesh_view *view) {
    if ((view->nverts && !view->positions) ||
        (view->npolys && (!view->poly_sizes || !view->poly_verts)) ||
        (view->ntexcoords && !view->texcoords) || (view->nnormals && !view->normals) ||
        (view->ncreases && (!view->crease_verts || !view->crease_sharpness)) ||
        (view->ncorners && (!view->corner_verts || !view->corner_sharpness)) ||
        (view->nholes && !view->hole_polys) ||
        (view->ngroups && (!view->group_names || !view->group_first)))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "mesh: an array is counted but not given");
    if (view->nverts > INT32_MAX || view->npolys > INT32_MAX || view->ntexcoords > INT32_MAX ||
        view->nnormals > INT32_MAX)
        return slvi_fail(env, SLV_ERROR_LIMIT, "mesh: more than %d elements of a kind", INT32_MAX);
    if ((unsigned)view->boundary > SLV_BOUNDARY_EDGE_AND_CORNER)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "mesh: unknown boundary rule %d",
                         (int)view->boundary);
    for (uint32_t g = 0; g < view->ngroups; g++)
        if (!view->group_names[g] || view->group_first[g] < 0 ||
            (uint32_t)view->group_first[g] > view->npolys ||
            (g && view->group_first[g] < view->group_first[g - 1]) ||
            (view->group_count &&
             (view->group_count[g] < 0 ||
              (uint32_t)view->group_count[g] > view->npolys - (uint32_t)view->group_first[g])))
            return slvi_fail(env, SLV_ERROR_ARGUMENT, "mesh: group %u is out of order", g);
    return SLV_OK;
}

static slv_result check_origin(const slv_env *env, const slv_mesh_view *view) {
    const double *origin = view->origin;
    if (isfinite(origin[0]) && isfinite(origin[1]) && isfinite(origin[2]))
        return SLV_OK;
    return slvi_fail(env, SLV_ERROR_FORMAT, "mesh: its origin is not finite");
}

static slv_result check_view(const slv_env *env, const slv_mesh_view *view, uint64_t *nsides,
                             uint64_t *nfaces) {
    slv_result result = check_present(env, view);
    if (result)
        return result;
    *nsides = *nfaces = 0;
    for (uint32_t p = 0; p < view->npolys; p++) {
        if (view->poly_sizes[p] < 3)
            return slvi_fail(env, SLV_ERROR_FORMAT,
                             "mesh: polygon %u has %d vertices, expected at least 3", p,
                             view->poly_sizes[p]);
        *nsides += (uint32_t)view->poly_sizes[p];
        *nfaces += view->poly_sizes[p] == 4 ? 1 : (uint32_t)view->poly_sizes[p];
    }
    if (*nsides > INT32_MAX || *nfaces > SLV_MAX_FACES)
        return slvi_fail(env, SLV_ERROR_LIMIT, "mesh: %llu faces, at most %d are possible",
                         (unsigned long long)*nfaces, SLV_MAX_FACES);
    if ((result = check_poly_indices(env, view, "vertex", view->poly_verts, 0, view->nverts)) ||
        (result = check_poly_indices(env, view, "texture", view->poly_texcoords, -1,
                                     view->ntexcoords)) ||
        (result =
             check_poly_indices(env, view, "normal", view->poly_normals, -1, view->nnormals)) ||
        (result = check_floats(env, "position", view->positions, view->nverts, 3)) ||
        (result = check_origin(env, view)) ||
        (result = check_floats(env, "texture coordinate", view->texcoords, view->ntexcoords, 2)) ||
        (result = check_floats(env, "normal", view->normals, view->nnormals, 3)) ||
        (result = check_indices(env, "crease vertex", view->crease_verts,
                                2 * (uint64_t)view->ncreases, view->nverts)) ||
        (result = check_indices(env, "corner", view->corner_verts, view->ncorners, view->nverts)) ||
        (result = check_indices(env, "hole", view->hole_polys, view->nholes, view->npolys)) ||
        (result = check_sharpness(env, "crease", view->crease_sharpness, view->ncreases)) ||
        (result = check_sharpness(env, "corner", view->corner_sharpness, view->ncorners)))
        return result;
    return SLV_OK;
}

/* A copy that the mesh releases; NULL where the source has nothing. */
static slv_result copy_array(const slv_env *env, slv_mesh *mesh, const void *source, uint64_t count,
                             uint64_t size, void *out) {
    void *copy = NULL;
    if (source && count) {
        slv_result result = slvi_alloc(env, "mesh", count, size, &copy);
        if (result)
            return result;
        memcpy(copy, source, (size_t)(count * size));
        mesh->owned[mesh->nowned++] = copy;
    }
    memcpy(out, &copy, sizeof copy);
    return SLV_OK;
}

/* The mesh always has the counts. */
static slv_result copy_group_counts(const slv_env *env, slv_mesh *mesh, const slv_mesh_view *from) {
    int32_t *count = NULL;
    slv_result result = slvi_alloc(env, "mesh groups", from->ngroups, sizeof *count, &count);
    if (result)
        return result;
    mesh->owned[mesh->nowned++] = count;
    for (uint32_t g = 0; g < from->ngroups; g++) {
        int32_t end = g + 1 < from->ngroups ? from->group_first[g + 1] : (int32_t)from->npolys;
        count[g] = from->group_count ? from->group_count[g] : end - from->group_first[g];
    }
    mesh->view.group_count = count;
    return SLV_OK;
}

static slv_result copy_groups(const slv_env *env, slv_mesh *mesh, const slv_mesh_view *from) {
    uint64_t bytes = 0;
    char *text = NULL;
    const char **names = NULL;
    slv_result result = SLV_OK;
    for (uint32_t g = 0; g < from->ngroups; g++)
        bytes += strlen(from->group_names[g]) + 1;
    if ((result = copy_array(env, mesh, from->group_first, from->ngroups, sizeof(int32_t),
                             &mesh->view.group_first)) ||
        (result = slvi_alloc(env, "mesh group names", bytes, 1, &text)))
        return result;
    mesh->owned[mesh->nowned++] = text;
    if ((result = slvi_alloc(env, "mesh group names", from->ngroups, sizeof *names, &names)))
        return result;
    mesh->owned[mesh->nowned++] = names;
    for (uint32_t g = 0; g < from->ngroups; g++) {
        size_t size = strlen(from->group_names[g]) + 1;
        memcpy(text, from->group_names[g], size);
        names[g] = text;
        text += size;
    }
    mesh->view.group_names = names;
    return copy_group_counts(env, mesh, from);
    return SLV_OK;
}

static slv_result copy_view(const slv_env *env, slv_mesh *mesh, const slv_mesh_view *from,
                            uint64_t nsides) {
    slv_mesh_view *to = &mesh->view;
    slv_result result = SLV_OK;
    *to = *from;
    if ((result = copy_array(env, mesh, from->positions, from->nverts, 12, &to->positions)) ||
        (result = copy_array(env, mesh, from->colors, from->nverts, 16, &to->colors)) ||
        (result = copy_array(env, mesh, from->poly_sizes, from->npolys, 4, &to->poly_sizes)) ||
        (result = copy_array(env, mesh, from->poly_verts, nsides, 4, &to->poly_verts)) ||
        (result = copy_array(env, mesh, from->texcoords, from->ntexcoords, 8, &to->texcoords)) ||
        (result = copy_array(env, mesh, from->poly_texcoords, nsides, 4, &to->poly_texcoords)) ||
        (result = copy_array(env, mesh, from->normals, from->nnormals, 12, &to->normals)) ||
        (result = copy_array(env, mesh, from->poly_normals, nsides, 4, &to->poly_normals)) ||
        (result =
             copy_array(env, mesh, from->crease_verts, from->ncreases, 8, &to->crease_verts)) ||
        (result = copy_array(env, mesh, from->crease_sharpness, from->ncreases, 4,
                             &to->crease_sharpness)) ||
        (result =
             copy_array(env, mesh, from->corner_verts, from->ncorners, 4, &to->corner_verts)) ||
        (result = copy_array(env, mesh, from->corner_sharpness, from->ncorners, 4,
                             &to->corner_sharpness)) ||
        (result = copy_array(env, mesh, from->hole_polys, from->nholes, 4, &to->hole_polys)))
        return result;
    return copy_groups(env, mesh, from);
}

static void number_faces(slv_mesh *mesh) {
    const slv_mesh_view *view = &mesh->view;
    uint32_t side = 0;
    int32_t face = 0;
    for (uint32_t p = 0; p < view->npolys; p++) {
        int32_t size = view->poly_sizes[p];
        mesh->poly_first[p] = side;
        mesh->poly_face[p] = face;
        side += (uint32_t)size;
        for (int32_t k = 0; k < (size == 4 ? 1 : size); k++) {
            mesh->faces[face] = (slv_mesh_face){(int32_t)p, size == 4 ? -1 : k};
            mesh->flags[face] = size == 4 ? 0 : SLV_FACE_SUBFACE;
            mesh->nsubfaces += size != 4;
            face++;
        }
    }
    mesh->poly_first[view->npolys] = side;
    for (uint32_t h = 0; h < view->nholes; h++)
        mesh->poly_hole[view->hole_polys[h]] = 1;
}

static slv_result create(const slv_env *env, const slv_mesh_view *view, slv_mesh **out) {
    slv_result result = SLV_OK;
    slv_mesh *mesh = NULL;
    uint64_t nsides = 0, nfaces = 0;
    *out = NULL;
    if ((result = check_view(env, view, &nsides, &nfaces)) ||
        (result = slvi_alloc(env, "mesh", 1, sizeof *mesh, &mesh)))
        return result;
    mesh->nfaces = (uint32_t)nfaces;
    uint64_t npolys = view->npolys;
    if ((result = copy_view(env, mesh, view, nsides)) ||
        (result =
             slvi_alloc(env, "mesh", npolys + 1, sizeof *mesh->poly_first, &mesh->poly_first)) ||
        (result = slvi_alloc(env, "mesh", npolys, sizeof *mesh->poly_face, &mesh->poly_face)) ||
        (result = slvi_alloc(env, "mesh", npolys, 1, &mesh->poly_hole)) ||
        (result = slvi_alloc(env, "mesh faces", nfaces, sizeof *mesh->faces, &mesh->faces)) ||
        (result = slvi_alloc(env, "mesh faces", nfaces, 1, &mesh->flags)))
        goto done;
    number_faces(mesh);
    *out = mesh;
    mesh = NULL;
done:
    slv_mesh_destroy(mesh);
    return result;
}

slv_result slv_mesh_create(const slv_env *env, const slv_mesh_view *view, slv_mesh **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, create(&own, view, out));
}

void slv_mesh_destroy(slv_mesh *mesh) {
    if (!mesh)
        return;
    while (mesh->nowned)
        slvi_free(mesh->owned[--mesh->nowned]);
    slvi_free(mesh->poly_first);
    slvi_free(mesh->poly_face);
    slvi_free(mesh->poly_hole);
    slvi_free(mesh->faces);
    slvi_free(mesh->flags);
    slvi_free(mesh);
}

const slv_mesh_view *slv_mesh_get_view(const slv_mesh *mesh) {
    return &mesh->view;
}

uint32_t slv_mesh_face_count(const slv_mesh *mesh) {
    return mesh->nfaces;
}

const slv_mesh_face *slv_mesh_faces(const slv_mesh *mesh) {
    return mesh->faces;
}

const uint8_t *slv_mesh_face_flags(const slv_mesh *mesh) {
    return mesh->flags;
}

bool slv_mesh_face_is_hole(const slv_mesh *mesh, int32_t face) {
    return face >= 0 && (uint32_t)face < mesh->nfaces && mesh->poly_hole[mesh->faces[face].poly];
}
