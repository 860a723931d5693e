/* Sums of faces' errors, on threads, in the order of faces. */
#include "form/resample_error.h"

#include "base/log.h"
#include "base/memory.h"

#include <math.h>

slv_result slvi_resample_measure_all(const slv_env *env, slv_resample_measure *measure,
                                     const slv_texture_desc *desc, const char *name,
                                     slv_range_fn faces, slv_face_error *out) {
    const slv_texture_desc *levels = &measure->levels->desc;
    slv_parallel_log *log = NULL;
    slv_face_error sum = {0};
    double count = 0;
    slv_result result;
    if (!slvi_texture_desc_same(levels, desc) ||
        slv_adjacency_face_count(measure->adjacency) != desc->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH,
                         "%s not made from these levels and this adjacency", name);
    if ((result = slvi_parallel_env_begin(env, &log, &measure->env)))
        return result;
    if ((result = slvi_alloc(&measure->env, "errors of faces", desc->nfaces, sizeof *measure->faces,
                             &measure->faces)) ||
        (result = slvi_parallel_for(&measure->env, desc->nfaces, 16, faces, measure)))
        goto done;
    for (uint32_t face = 0; face < desc->nfaces; face++) {
        const slv_face_error *from = &measure->faces[face];
        sum.texel_sum += from->texel_sum;
        sum.function_sum += from->function_sum;
        sum.texel_max = fmax(sum.texel_max, from->texel_max);
        sum.function_max = fmax(sum.function_max, from->function_max);
        count += (double)slv_res_texels(desc->res[face]) * desc->nchannels;
    }
    count = count > 0 ? count : 1;
    sum.texel_sum = sqrt(sum.texel_sum / count);
    sum.function_sum = sqrt(sum.function_sum / count);
    *out = sum;
done:
    slvi_free(measure->faces);
    slvi_parallel_env_end(log);
    return result;
}
