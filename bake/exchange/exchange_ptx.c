/* A .ptx out of a .ptx or of images. */
#include "exchange/exchange_data.h"
#include "exchange/import.h"

struct conversion {
    const slvi_exchange_plan *plan;
    slv_ptx_writer *writer;
};

static slv_result write_face(void *user, const slv_env *env, uint32_t face,
                             const slv_ptx_face *info, void *texels) {
    const struct conversion *conversion = user;
    slv_ptx_face changed = *info;
    const void *values = texels;
    void *own;
    slv_result result = slvi_exchange_face(env, conversion->plan, face, &changed, &values, &own);
    if (!result)
        result = slv_ptx_writer_write_face(conversion->writer, face, &changed, values);
    slvi_free(own);
    return result;
}

static slv_result copy_meta(slv_ptx_writer *writer, const slv_ptx *ptx) {
    for (uint32_t i = 0; i < slv_ptx_get_info(ptx)->nmeta; i++) {
        const slv_ptx_meta *meta;
        slv_result result = slv_ptx_load_meta(ptx, i, &meta);
        if (result || (result = slv_ptx_writer_set_meta(writer, meta)))
            return result;
    }
    return SLV_OK;
}

static slv_result from_ptx(const slv_env *env, const slv_exchange *source,
                           const slv_exchange_params *params, const slvi_exchange_plan *plan,
                           const char *path) {
    struct conversion conversion = {.plan = plan};
    slv_result result;
    if ((result = slv_ptx_writer_create(env, path, &plan->target, &conversion.writer)) ||
        (!params->no_meta && (result = copy_meta(conversion.writer, source->ptx))) ||
        (params->mesh && (result = slv_ptx_writer_set_mesh(conversion.writer, params->mesh))) ||
        (result = slvi_exchange_visited(
             env, plan, slv_ptx_visit_faces(env, source->ptx, write_face, &conversion))))
        goto done;
    result = slv_ptx_writer_finish(conversion.writer);
done:
    slv_ptx_writer_destroy(conversion.writer);
    return result;
}

slv_result slv_exchange_to_ptx(const slv_env *given, const slv_exchange *source,
                               const slv_exchange_params *params, const char *path,
                               slv_exchange_stats *stats) {
    static const slv_exchange_params none = {0};
    slv_env env = slvi_env_or_default(given);
    slvi_exchange_totals totals;
    slvi_exchange_plan plan = {0};
    params = params ? params : &none;
    slvi_exchange_begin(&totals, params->progress, source->params.nfaces);
    slv_result result =
        slvi_exchange_plan_make(&env, params, source->path, &source->params, &totals, &plan);
    if (!result)
        result = source->ptx ? from_ptx(&env, source, params, &plan, path)
                             : slvi_exchange_import(&env, source, params, &plan, path);
    slvi_exchange_end(&env, &totals, result, &plan.target, stats);
    slvi_exchange_plan_free(&plan);
    return result;
}
