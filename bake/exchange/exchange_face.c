/* One face of a source as a face of the result: resized, its channels chosen, in another type. */
#include "exchange/exchange_data.h"

#include "base/parallel.h"

#include <selvage/ptx_resize.h>

#include <math.h>

#define LARGE (UINT64_C(256) << 20) /* bytes: of less nobody asks whether there are any */

/* Resampling wants colours multiplied by alpha, so that what is not covered does not bleed. */
static slv_result resize(const slv_env *env, const slvi_exchange_plan *plan, slv_res from,
                         slv_res to, float **values, bool *multiplied) {
    const slv_ptx_writer_params *source = &plan->source;
    float *out;
    slv_result result = slvi_alloc_plain(env, plan->path, (uint64_t)1 << (to.u + to.v),
                                         source->nchannels * sizeof *out, &out);
    if (result)
        return result;
    if (source->alpha_channel >= 0 && !*multiplied) {
        slv_ptx_premultiply(SLV_TYPE_FLOAT, source->nchannels, source->alpha_channel, *values,
                            (uint64_t)1 << (from.u + from.v));
        *multiplied = true;
    }
    if ((result =
             slv_ptx_resize(env, source->mesh_type, source->nchannels, from, *values, to, out))) {
        slvi_free(out);
        return result;
    }
    slvi_free(*values);
    *values = out;
    return SLV_OK;
}

static slv_result select_channels(const slv_env *env, const slvi_exchange_plan *plan,
                                  const float *values, size_t count, float **out) {
    uint32_t from = plan->source.nchannels, to = plan->target.nchannels;
    slv_result result = slvi_alloc_plain(env, plan->path, count, to * sizeof **out, out);
    for (size_t i = 0; !result && i < count; i++)
        for (uint32_t c = 0; c < to; c++) {
            const slv_exchange_channel *channel = &plan->channels[c];
            (*out)[i * to + c] =
                channel->source < 0 ? channel->value : values[i * from + (uint32_t)channel->source];
        }
    return result;
}

/* Values that become another number by more than rounding. */
static uint64_t count_clipped(slv_type type, const float *values, size_t count) {
    float half_unit = type == SLV_TYPE_U8 ? 0.5f / 255 : 0.5f / 65535;
    uint64_t clipped = 0;
    if (type == SLV_TYPE_FLOAT)
        return 0;
    if (type == SLV_TYPE_HALF) {
        for (size_t i = 0; i < count; i++)
            clipped += fabsf(values[i]) >= 65520 && isfinite(values[i]);
        return clipped;
    }
    for (size_t i = 0; i < count; i++)
        clipped += !(values[i] >= -half_unit && values[i] <= 1 + half_unit);
    return clipped;
}

void slvi_exchange_begin(slvi_exchange_totals *totals, slv_progress progress, uint64_t nfaces) {
    atomic_init(&totals->faces, 0);
    atomic_init(&totals->resized, 0);
    atomic_init(&totals->texels, 0);
    atomic_init(&totals->clipped, 0);
    slvi_steps_begin(&totals->steps, progress, nfaces);
}

void slvi_exchange_end(const slv_env *env, slvi_exchange_totals *totals, slv_result result,
                       const slv_ptx_writer_params *wrote, slv_exchange_stats *stats) {
    uint64_t clipped = totals->clipped;
    slvi_steps_end(&totals->steps);
    if (!result && clipped)
        slvi_logf(env, SLV_LOG_WARNING, "%llu value%s did not fit into %s and %s clipped",
                  (unsigned long long)clipped, clipped == 1 ? "" : "s", slv_type_name(wrote->type),
                  clipped == 1 ? "was" : "were");
    if (stats)
        *stats = (slv_exchange_stats){.faces = totals->faces,
                                      .resized = totals->resized,
                                      .texels = totals->texels,
                                      .clipped = clipped,
                                      .wrote = *wrote};
}

static slv_result count_face(const slvi_exchange_plan *plan, slv_res from,
                             const slv_ptx_face *info) {
    static const slv_env silent = {0};
    slvi_exchange_totals *totals = plan->totals;
    totals->faces++;
    totals->resized += from.u != info->res.u || from.v != info->res.v;
    totals->texels += (uint64_t)1 << (info->res.u + info->res.v);
    return slvi_steps_add(&totals->steps, &silent, plan->path, 1);
}

slv_result slvi_exchange_visited(const slv_env *env, const slvi_exchange_plan *plan,
                                 slv_result result) {
    return result == SLV_ERROR_CANCELLED ? slvi_fail(env, result, "%s: cancelled", plan->path)
                                         : result;
}

slv_result slvi_exchange_visit(const slv_env *env, const slvi_exchange_plan *plan,
                               const slv_ptx *ptx, slv_ptx_visit_fn visit, void *user) {
    return slvi_exchange_visited(
        env, plan,
        slv_ptx_visit_some_faces(env, ptx, plan->faces, plan->target.nfaces, visit, user));
}

/* All values of a face are in memory at once, as floats. */
static slv_result check_size(const slv_env *env, const slvi_exchange_plan *plan, uint32_t face,
                             slv_res res) {
    uint64_t channels = plan->source.nchannels > plan->target.nchannels ? plan->source.nchannels
                                                                        : plan->target.nchannels,
             bytes = (channels * sizeof(float)) << (res.u + res.v),
             limit = slvi_env_or_default(env).max_bytes;
    if (bytes <= limit && bytes > LARGE && bytes >= slv_memory_available())
        limit = slv_memory_available();
    else if (bytes <= limit && bytes <= SIZE_MAX)
        return SLV_OK;
    return slvi_fail(env, SLV_ERROR_LIMIT,
                     "%s: face %u: %u x %u texels of %llu channels are %.1f GiB, the limit is "
                     "%.1f GiB",
                     plan->path, face, 1u << res.u, 1u << res.v, (unsigned long long)channels,
                     (double)bytes / (1 << 30), (double)limit / (1 << 30));
}

/* A face as it was read, as floats, resized, its channels chosen, and as it is written. */
static uint64_t face_bytes(const slvi_exchange_plan *plan, slv_res from, slv_res to) {
    const slv_ptx_writer_params *source = &plan->source, *target = &plan->target;
    bool same = from.u == to.u && from.v == to.v;
    uint64_t before = source->nchannels * (slv_type_size(source->type) + sizeof(float)),
             after = target->nchannels * slv_type_size(target->type);
    after += same ? 0 : source->nchannels * sizeof(float);
    after += plan->same_channels ? 0 : target->nchannels * sizeof(float);
    return (before << (from.u + from.v)) + (after << (to.u + to.v));
}

slv_result slvi_exchange_check_memory(slv_env *env, const slvi_exchange_plan *plan,
                                      const slv_ptx *ptx) {
    uint64_t most = 0, available = slv_memory_available();
    uint32_t worst = 0;
    slv_res size = {0, 0};
    slv_result result = SLV_OK;
    for (uint32_t place = 0; place < plan->target.nfaces && !result; place++) {
        uint32_t face = slvi_exchange_plan_source(plan, place);
        slv_ptx_face info;
        if ((result = slv_ptx_get_face(ptx, face, &info)) || (info.flags & SLV_FACE_CONSTANT))
            continue;
        slv_res to = slvi_exchange_plan_res(plan, face, info.res);
        uint64_t bytes = face_bytes(plan, info.res, to);
        if (bytes > most) {
            most = bytes;
            worst = face;
            size = to;
        }
    }
    if (result || !most || (result = check_size(env, plan, worst, size)))
        return result;
    if (most >= available)
        return slvi_fail(env, SLV_ERROR_LIMIT,
                         "%s: face %u: %u x %u texels need %.1f GiB of memory, where %.1f GiB are "
                         "to be had",
                         plan->path, worst, 1u << size.u, 1u << size.v, (double)most / (1 << 30),
                         (double)available / (1 << 30));
    uint64_t together = available / most;
    if (together < slvi_thread_count(env))
        env->threads = (uint32_t)together;
    return SLV_OK;
}

slv_result slvi_exchange_face(const slv_env *env, const slvi_exchange_plan *plan, uint32_t face,
                              slv_ptx_face *info, const void **texels, void **own) {
    const slv_ptx_writer_params *source = &plan->source, *target = &plan->target;
    slv_res to = slvi_exchange_plan_res(plan, face, info->res), from = info->res;
    bool constant = info->flags & SLV_FACE_CONSTANT, multiplied = plan->unmultiply;
    bool same_res = constant || (to.u == from.u && to.v == from.v);
    size_t count = constant ? 1 : (size_t)1 << (from.u + from.v);
    float *values = NULL, *selected = NULL;
    slv_result result;
    *own = NULL;
    info->res = to;
    if ((result = count_face(plan, from, info)))
        return result;
    if (same_res && plan->same_channels && source->type == target->type && !plan->premultiply &&
        !plan->unmultiply)
        return SLV_OK;
    if ((!constant && (result = check_size(env, plan, face, to))) ||
        (result =
             slvi_alloc_plain(env, plan->path, count, source->nchannels * sizeof *values, &values)))
        return result;
    slv_type_to_float(source->type, *texels, count * source->nchannels, values);
    if (!same_res) {
        if ((result = resize(env, plan, from, to, &values, &multiplied)))
            goto done;
        count = (size_t)1 << (to.u + to.v);
    }
    if (multiplied && !plan->premultiply)
        slv_ptx_unmultiply(SLV_TYPE_FLOAT, source->nchannels, source->alpha_channel, values, count);
    else if (!multiplied && plan->premultiply)
        slv_ptx_premultiply(SLV_TYPE_FLOAT, source->nchannels, source->alpha_channel, values,
                            count);
    selected = values;
    if ((!plan->same_channels && (result = select_channels(env, plan, values, count, &selected))) ||
        (result = slvi_alloc_plain(env, plan->path, count,
                                   target->nchannels * slv_type_size(target->type), own)))
        goto done;
    slv_type_from_float(target->type, selected, count * target->nchannels, *own);
    plan->totals->clipped += count_clipped(target->type, selected, count * target->nchannels);
    *texels = *own;
done:
    if (selected != values)
        slvi_free(selected);
    slvi_free(values);
    return result;
}
