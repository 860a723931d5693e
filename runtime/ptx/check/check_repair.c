/* Copies in which what follows from the texels and a mesh is made anew. */
#include "ptx/check/check.h"

#include "base/log.h"
#include "ptx/write/ptx_write.h"

slv_result slv_ptx_repair(const slv_env *env, const slv_ptx *ptx, const slv_mesh *mesh,
                          const char *path, const slv_ptx_writer_params *params) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    uint32_t count = !mesh                                 ? info->nfaces
                     : info->mesh_type == SLV_PTX_TRIANGLE ? slv_mesh_get_view(mesh)->npolys
                                                           : slv_mesh_face_count(mesh);
    if (count != info->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "%s: has %u faces, the mesh has %u",
                         slv_ptx_name(ptx), info->nfaces, count);
    return slvi_ptx_copy(env, ptx, mesh, path, params);
}
