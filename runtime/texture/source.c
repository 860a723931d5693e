/* What all sources share: optional functions, and the check of arguments. */
#include <selvage/source.h>

#include "base/log.h"
#include "texture/texture_data.h"

#include <string.h>

uint64_t slv_source_version(const slv_source *source) {
    return source->fns->version ? source->fns->version(source->user) : 1;
}

slv_result slv_source_changed(const slv_source *source, uint64_t since, slv_visit_rect visit,
                              void *visitor) {
    if (source->fns->changed)
        return source->fns->changed(source->user, since, visit, visitor);
    slv_source_desc desc;
    slv_result result = since ? SLV_OK : source->fns->describe(source->user, &desc);
    for (uint32_t i = 0; !since && !result && i < desc.nfaces; i++) {
        slv_source_face face;
        if (!(result = source->fns->face(source->user, i, &face)))
            result = visit(visitor, i, (slv_rect){0, 0, 1u << face.res.u, 1u << face.res.v});
    }
    return result;
}

void slv_source_close(slv_source *source) {
    if (source->fns && source->fns->close)
        source->fns->close(source->user);
    memset(source, 0, sizeof *source);
}

slv_result slv_source_check(const slv_env *env, const slv_source *source, uint32_t index,
                            slv_res res, slv_rect rect, slv_source_face *face) {
    slv_source_desc desc;
    slv_result result = source->fns->describe(source->user, &desc);
    if (result || (result = source->fns->face(source->user, index, face)))
        return result;
    if (res.u < 0 || res.v < 0 || res.u > face->res.u || res.v > face->res.v ||
        (desc.triangles && res.u != res.v))
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "%s: face %u: has 2^%d x 2^%d texels, which do not reduce to 2^%d x 2^%d",
                         desc.name, (unsigned)index, face->res.u, face->res.v, res.u, res.v);
    if (!slvi_rect_is_within(rect, res))
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "%s: face %u: %u x %u texels at (%u, %u) do not lie within %u x %u",
                         desc.name, (unsigned)index, (unsigned)rect.width, (unsigned)rect.height,
                         (unsigned)rect.x, (unsigned)rect.y, 1u << res.u, 1u << res.v);
    return SLV_OK;
}
