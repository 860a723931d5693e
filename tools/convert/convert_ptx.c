#include "convert/convert.h"

#include <stdlib.h>

struct conversion {
    const convert_plan *plan;
    slv_ptx_writer *writer;
};

static slv_result write_face(void *user, const slv_env *env, uint32_t face,
                             const slv_ptx_face *info, void *texels) {
    const struct conversion *conversion = user;
    slv_ptx_face changed = *info;
    const void *values = texels;
    void *own;
    slv_result result = convert_face(env, conversion->plan, face, &changed, &values, &own);
    if (!result)
        result = slv_ptx_writer_write_face(conversion->writer, face, &changed, values);
    free(own);
    return result;
}

static slv_result copy_meta(slv_ptx_writer *writer, const slv_ptx *ptx) {
    for (uint32_t i = 0; i < slv_ptx_get_info(ptx)->nmeta; i++) {
        const slv_ptx_meta *meta = slv_ptx_get_meta(ptx, i);
        slv_result result = meta ? slv_ptx_writer_set_meta(writer, meta) : SLV_ERROR_FORMAT;
        if (result)
            return result;
    }
    return SLV_OK;
}

int convert_to_ptx(const slv_env *env, const convert_options *options, const convert_plan *plan,
                   const slv_ptx *ptx, const slv_mesh *mesh, const char *path) {
    struct conversion conversion = {.plan = plan};
    int code = EXIT_FAILED;
    if (slv_ptx_writer_create(env, path, &plan->target, &conversion.writer) ||
        (!options->no_meta && copy_meta(conversion.writer, ptx)) ||
        (mesh && slv_ptx_writer_set_mesh(conversion.writer, mesh)) ||
        slv_ptx_visit_faces(env, ptx, write_face, &conversion) ||
        slv_ptx_writer_finish(conversion.writer))
        goto done;
    code = EXIT_OK;
done:
    slv_ptx_writer_destroy(conversion.writer);
    return code;
}
