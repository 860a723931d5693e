/* A .ptx out of a .ptx or of images. */
#include "exchange/exchange_data.h"
#include "exchange/geometry.h"
#include "exchange/import.h"

#include <string.h>

struct conversion {
    const slvi_exchange_plan *plan;
    const slv_ptx *ptx;
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
        result = slvi_exchange_plan_move(conversion->plan, conversion->ptx, &changed);
    if (!result)
        result = slv_ptx_writer_write_face(
            conversion->writer, (uint32_t)slvi_exchange_plan_place(conversion->plan, (int32_t)face),
            &changed, values);
    slvi_free(own);
    return result;
}

/* Of some faces geometry is made anew, and a record of parts would be of others. */
static slv_result copy_meta(const slv_env *env, const slvi_exchange_plan *plan,
                            slv_ptx_writer *writer, const slv_ptx *ptx, bool notes) {
    slv_result result = SLV_OK;
    for (uint32_t i = 0; i < slv_ptx_get_info(ptx)->nmeta && !result; i++) {
        const slv_ptx_meta *meta;
        result = slv_ptx_load_meta(ptx, i, &meta);
        if (!result && (notes || strcmp(meta->key, SLV_PTX_ENCODING_KEY) != 0) &&
            !(plan->faces &&
              (slvi_geometry_key(meta->key) >= 0 || strcmp(meta->key, SLV_PARTS_KEY) == 0)))
            result = slv_ptx_writer_set_meta(writer, meta);
    }
    return result || !plan->faces
               ? result
               : slvi_geometry_select(env, ptx, plan->faces, plan->target.nfaces, NULL, writer);
}

slv_result slvi_exchange_write_faces(const slv_env *env, const slvi_exchange_plan *plan,
                                     const slv_ptx *ptx, slv_ptx_writer *writer) {
    struct conversion conversion = {.plan = plan, .ptx = ptx, .writer = writer};
    return slvi_exchange_visit(env, plan, ptx, write_face, &conversion);
}

static slv_result from_ptx(const slv_env *env, const slv_exchange *source,
                           const slv_exchange_params *params, const slvi_exchange_plan *plan,
                           const char *path) {
    slv_ptx_writer *writer = NULL;
    /* what is noted of the colours may not be so of another type */
    bool anew = params->encoding ||
                slv_type_encoding(plan->source.type) != slv_type_encoding(plan->target.type);
    slv_result result;
    if ((result = slv_ptx_writer_create(env, path, &plan->target, &writer)) ||
        (!params->no_meta && (result = copy_meta(env, plan, writer, source->ptx, !anew))) ||
        (anew && slvi_exchange_needs_note(plan) &&
         (result = slvi_exchange_note_encoding(plan, writer))) ||
        (params->mesh && (result = slv_ptx_writer_set_mesh(writer, params->mesh))) ||
        (result = slvi_exchange_write_faces(env, plan, source->ptx, writer)))
        goto done;
    result = slv_ptx_writer_finish(writer);
done:
    slv_ptx_writer_destroy(writer);
    return result;
}

slv_result slv_exchange_to_ptx(const slv_env *given, const slv_exchange *source,
                               const slv_exchange_params *params, const char *path,
                               slv_exchange_stats *stats) {
    static const slv_exchange_params none = {0};
    slv_env env = slvi_budget_begin(given);
    slvi_exchange_totals totals;
    slvi_exchange_plan plan = {0};
    params = params ? params : &none;
    slvi_exchange_begin(&totals, params->progress, 0);
    slv_result result =
        slvi_exchange_plan_make(&env, params, source->path, &source->params, &totals, &plan);
    totals.steps.total = plan.target.nfaces;
    if (!result && params->faces && !source->ptx)
        result = slvi_fail(&env, SLV_ERROR_UNSUPPORTED, "%s: of images all faces are taken",
                           source->path);
    plan.encoding = plan.encoding ? plan.encoding : source->encoding;
    if (!result && source->ptx)
        result = slvi_exchange_check_memory(&env, &plan, source->ptx);
    if (!result)
        result = source->ptx ? from_ptx(&env, source, params, &plan, path)
                             : slvi_exchange_import(&env, source, params, &plan, path);
    slvi_exchange_end(&env, &totals, result, &plan.target, stats);
    slvi_exchange_plan_free(&plan);
    return slvi_budget_end(&env, result);
}
