/* Whether a file and a mesh belong together. */
#include "adjacency/triangle.h"
#include "ptx/format/ptx_file.h"

#include "base/log.h"

#include <stdio.h>

struct match {
    const slv_env *env;
    const slv_ptx *ptx;
    const slv_mesh *mesh;
    const slv_adjacency *adjacency;
    bool triangles;
};

/* The mesh's first face of a face of the file. */
static int32_t face_of(const struct match *match, int32_t face) {
    return match->triangles ? 3 * face : face;
}

/* A face's record by the mesh, its triangles as the file numbers them. */
static slv_face_adjacency record_of(const struct match *match, uint32_t face) {
    return match->triangles ? slvi_triangle_record(match->adjacency, (int32_t)face)
                            : slv_adjacency_faces(match->adjacency)[face];
}

static void describe(char *out, size_t size, int32_t face, unsigned edge) {
    if (face < 0)
        snprintf(out, size, "a boundary");
    else
        snprintf(out, size, "face %d edge %u", face, edge);
}

static bool edge_matches(const struct match *match, uint32_t face, unsigned edge) {
    slv_ptx_face f = slvi_ptx_face_at(match->ptx, face);
    const slv_face_adjacency *file = &f.adjacency;
    int32_t there = file->face[edge];
    slv_face_adjacency record = record_of(match, face);
    slv_neighbour neighbours[2];
    if (record.face[edge] == there && there >= 0)
        return record.edge[edge] == file->edge[edge];
    uint32_t count = match->triangles ? record.face[edge] >= 0
                                      : slv_adjacency_neighbours(match->adjacency, (int32_t)face,
                                                                 edge, neighbours);
    for (uint32_t i = 0; i < count && !match->triangles; i++)
        if (neighbours[i].face == there && neighbours[i].edge == file->edge[edge])
            return true;
    if (count)
        return false;
    /* the mesh's adjacency stops at holes, a painter's may not */
    return there < 0 || (face_of(match, there) < (int32_t)slv_mesh_face_count(match->mesh) &&
                         slv_mesh_face_is_hole(match->mesh, face_of(match, there)));
}

/* Finds the first of `count` faces that differs. Returns false, with words in `out`, if there is
 * one. */
static bool faces_match(const struct match *match, uint32_t count, char *out, size_t size) {
    const uint8_t *flags = slv_mesh_face_flags(match->mesh);
    for (uint32_t face = 0; face < count; face++) {
        slv_ptx_face f = slvi_ptx_face_at(match->ptx, face);
        slv_face_adjacency record = record_of(match, face);
        bool file_sub = f.flags & SLV_FACE_SUBFACE, mesh_sub = flags[face] & SLV_FACE_SUBFACE;
        if (file_sub != mesh_sub && !match->triangles) {
            snprintf(out, size, "face %u, from its edge 0 on: the file says %s, the mesh says %s",
                     face, file_sub ? "a sub-face of an n-gon" : "a whole quad",
                     mesh_sub ? "a sub-face of an n-gon" : "a whole quad");
            return false;
        }
        if (slv_mesh_face_is_hole(match->mesh, face_of(match, (int32_t)face)))
            continue;
        for (unsigned edge = 0; edge < (match->triangles ? 3 : 4); edge++) {
            if (edge_matches(match, face, edge))
                continue;
            char file_side[48], mesh_side[48];
            describe(file_side, sizeof file_side, f.adjacency.face[edge], f.adjacency.edge[edge]);
            describe(mesh_side, sizeof mesh_side, record.face[edge], record.edge[edge]);
            snprintf(out, size, "face %u edge %u: the file says %s, the mesh says %s", face, edge,
                     file_side, mesh_side);
            return false;
        }
    }
    return true;
}

static bool has_adjacency(const slv_ptx *ptx) {
    for (uint32_t face = 0; face < ptx->info.nfaces; face++) {
        slv_ptx_face f = slvi_ptx_face_at(ptx, face);
        for (unsigned edge = 0; edge < 4; edge++)
            if (f.adjacency.face[edge] >= 0)
                return true;
    }
    return false;
}

/* Triangles belong to polygons of three vertices. */
static slv_result check_polygons(const slv_env *env, const slv_ptx *ptx, const slv_mesh *mesh) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    for (uint32_t poly = 0; poly < view->npolys; poly++)
        if (view->poly_sizes[poly] != 3)
            return slvi_fail(env, SLV_ERROR_MISMATCH,
                             "%s does not fit the mesh: it is a triangle-mesh texture, and polygon "
                             "%u of the mesh has %d vertices (face %u edge 3)",
                             ptx->name, poly, view->poly_sizes[poly], poly);
    return SLV_OK;
}

slv_result slv_ptx_match_mesh(const slv_env *env, const slv_ptx *ptx, const slv_mesh *mesh) {
    bool triangles = ptx->info.mesh_type == SLV_PTX_TRIANGLE;
    uint32_t file_count = ptx->info.nfaces,
             mesh_count = triangles ? slv_mesh_get_view(mesh)->npolys : slv_mesh_face_count(mesh);
    uint32_t common = file_count < mesh_count ? file_count : mesh_count;
    char difference[200] = "";
    slv_adjacency *adjacency = NULL;
    slv_result result = triangles ? check_polygons(env, ptx, mesh) : SLV_OK;
    if (result)
        return result;
    if ((result = ptx_need(ptx, PTX_FACES)))
        return result;
    bool compare = has_adjacency(ptx);
    if (compare && (result = slv_mesh_adjacency(env, mesh, &adjacency)))
        return result;
    struct match match = {env, ptx, mesh, adjacency, triangles};
    bool equal = !compare || faces_match(&match, common, difference, sizeof difference);
    if (equal && file_count != mesh_count)
        snprintf(difference, sizeof difference, "face %u edge 0 is the first that the %s lacks",
                 common, file_count < mesh_count ? "file" : "mesh");
    if (file_count != mesh_count)
        result = slvi_fail(env, SLV_ERROR_MISMATCH,
                           "%s does not fit the mesh: it has %u faces, the mesh has %u: %s",
                           ptx->name, file_count, mesh_count, difference);
    else if (!equal)
        result = slvi_fail(env, SLV_ERROR_MISMATCH, "%s does not fit the mesh: %s", ptx->name,
                           difference);
    slv_adjacency_destroy(adjacency);
    return result;
}
