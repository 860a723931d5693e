/* Whether a file and a mesh belong together. */
#include "ptx/format/ptx_file.h"

#include "base/log.h"

#include <stdio.h>

struct match {
    const slv_env *env;
    const slv_ptx *ptx;
    const slv_mesh *mesh;
    const slv_adjacency *adjacency;
};

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
    slv_neighbour neighbours[2];
    uint32_t count = slv_adjacency_neighbours(match->adjacency, (int32_t)face, edge, neighbours);
    for (uint32_t i = 0; i < count; i++)
        if (neighbours[i].face == there && neighbours[i].edge == file->edge[edge])
            return true;
    if (count)
        return false;
    /* the mesh's adjacency stops at holes, a painter's may not */
    return there < 0 || (there < (int32_t)slv_mesh_face_count(match->mesh) &&
                         slv_mesh_face_is_hole(match->mesh, there));
}

/* Finds the first of `count` faces that differs. Returns false, with words in `out`, if there is
 * one. */
static bool faces_match(const struct match *match, uint32_t count, char *out, size_t size) {
    const uint8_t *flags = slv_mesh_face_flags(match->mesh);
    const slv_face_adjacency *mesh_faces = slv_adjacency_faces(match->adjacency);
    for (uint32_t face = 0; face < count; face++) {
        slv_ptx_face f = slvi_ptx_face_at(match->ptx, face);
        bool file_sub = f.flags & SLV_FACE_SUBFACE, mesh_sub = flags[face] & SLV_FACE_SUBFACE;
        if (file_sub != mesh_sub) {
            snprintf(out, size, "face %u, from its edge 0 on: the file says %s, the mesh says %s",
                     face, file_sub ? "a sub-face of an n-gon" : "a whole quad",
                     mesh_sub ? "a sub-face of an n-gon" : "a whole quad");
            return false;
        }
        if (slv_mesh_face_is_hole(match->mesh, (int32_t)face))
            continue;
        for (unsigned edge = 0; edge < 4; edge++) {
            if (edge_matches(match, face, edge))
                continue;
            char file_side[48], mesh_side[48];
            describe(file_side, sizeof file_side, f.adjacency.face[edge], f.adjacency.edge[edge]);
            describe(mesh_side, sizeof mesh_side, mesh_faces[face].face[edge],
                     mesh_faces[face].edge[edge]);
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

slv_result slv_ptx_match_mesh(const slv_env *env, const slv_ptx *ptx, const slv_mesh *mesh) {
    uint32_t file_count = ptx->info.nfaces, mesh_count = slv_mesh_face_count(mesh);
    uint32_t common = file_count < mesh_count ? file_count : mesh_count;
    char difference[200] = "";
    slv_adjacency *adjacency = NULL;
    slv_result result = SLV_OK;
    if (ptx->info.mesh_type == SLV_PTX_TRIANGLE)
        return slvi_fail(
            env, SLV_ERROR_MISMATCH,
            "%s does not fit the mesh: it is a triangle-mesh texture, the mesh's faces "
            "are quads (first at face 0 edge 3)",
            ptx->name);
    if ((result = ptx_need(ptx, PTX_FACES)))
        return result;
    bool compare = has_adjacency(ptx);
    if (compare && (result = slv_mesh_adjacency(env, mesh, &adjacency)))
        return result;
    struct match match = {env, ptx, mesh, adjacency};
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
