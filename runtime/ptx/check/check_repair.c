/* Copies in which what follows from the texels and a mesh is made anew. */
#include "ptx/check/check.h"

#include "base/log.h"

#include <selvage/ptx_writer.h>

static slv_result copy_face(void *user, const slv_env *env, uint32_t face, const slv_ptx_face *info,
                            void *texels) {
    (void)env;
    return slv_ptx_writer_write_face(user, face, info, texels);
}

static slv_result copy_with_mesh(const slv_env *env, const slv_ptx *ptx, const slv_mesh *mesh,
                                 const char *path) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    slv_ptx_writer *writer = NULL;
    slv_result result = slv_ptx_load_tables(ptx);
    if (result)
        return result;
    slv_ptx_writer_params params = slv_ptx_writer_params_like(ptx);
    if ((result = slv_ptx_writer_create(env, path, &params, &writer)))
        goto done;
    for (uint32_t i = 0; i < info->nmeta; i++)
        if ((result = slv_ptx_writer_set_meta(writer, slv_ptx_get_meta(ptx, i))))
            goto done;
    if ((result = slv_ptx_writer_set_mesh(writer, mesh)) ||
        (result = slv_ptx_visit_faces(env, ptx, copy_face, writer)))
        goto done;
    result = slv_ptx_writer_finish(writer);
done:
    slv_ptx_writer_destroy(writer);
    return result;
}

slv_result slv_ptx_repair(const slv_env *env, const slv_ptx *ptx, const slv_mesh *mesh,
                          const char *path) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    if (!mesh)
        return slv_ptx_rewrite(env, ptx, path, NULL);
    uint32_t count = info->mesh_type == SLV_PTX_TRIANGLE ? slv_mesh_get_view(mesh)->npolys
                                                         : slv_mesh_face_count(mesh);
    if (count != info->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "%s: has %u faces, the mesh has %u",
                         slv_ptx_name(ptx), info->nfaces, count);
    return copy_with_mesh(env, ptx, mesh, path);
}
