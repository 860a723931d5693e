#include "convert/convert.h"

#include <math.h>
#include <stdlib.h>

#define DEFAULT_MAX_BYTES (UINT64_C(16) << 30) /* what slv_env.max_bytes of 0 means */

/* Resampling wants colours multiplied by alpha, so that what is not covered does not bleed. */
static slv_result resize(const slv_env *env, const convert_plan *plan, uint32_t face, slv_res from,
                         slv_res to, float **values, bool *multiplied) {
    const slv_ptx_writer_params *source = &plan->source;
    float *out = malloc(((size_t)1 << (to.u + to.v)) * source->nchannels * sizeof *out);
    slv_result result;
    if (!out)
        return output_fail(env, SLV_ERROR_MEMORY, "%s: face %u: no memory for %u x %u texels",
                           plan->path, face, 1u << to.u, 1u << to.v);
    if (source->alpha_channel >= 0 && !*multiplied) {
        slv_ptx_premultiply(SLV_TYPE_FLOAT, source->nchannels, source->alpha_channel, *values,
                            (uint64_t)1 << (from.u + from.v));
        *multiplied = true;
    }
    if ((result =
             slv_ptx_resize(env, source->mesh_type, source->nchannels, from, *values, to, out))) {
        free(out);
        return result;
    }
    free(*values);
    *values = out;
    return SLV_OK;
}

static float *select_channels(const convert_plan *plan, const float *values, size_t count) {
    uint32_t from = plan->source.nchannels, to = plan->target.nchannels;
    float *out = count <= SIZE_MAX / sizeof *out / to ? malloc(count * to * sizeof *out) : NULL;
    for (size_t i = 0; out && i < count; i++)
        for (uint32_t c = 0; c < to; c++) {
            const convert_channel *channel = &plan->channels[c];
            out[i * to + c] =
                channel->source < 0 ? channel->value : values[i * from + (uint32_t)channel->source];
        }
    return out;
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

void convert_warn_clipped(const convert_totals *totals, slv_type type) {
    if (totals->clipped)
        cli_warning("%llu value%s did not fit into %s and %s clipped",
                    (unsigned long long)totals->clipped, totals->clipped == 1 ? "" : "s",
                    slv_type_name(type), totals->clipped == 1 ? "was" : "were");
}

static void count_face(const convert_plan *plan, slv_res from, const slv_ptx_face *info) {
    convert_totals *totals = plan->totals;
    totals->faces++;
    totals->resized += from.u != info->res.u || from.v != info->res.v;
    totals->texels += (uint64_t)1 << (info->res.u + info->res.v);
    cli_progress_step(&totals->progress);
}

/* All values of a face are in memory at once, as floats. */
static slv_result check_size(const slv_env *env, const convert_plan *plan, uint32_t face,
                             slv_res res) {
    uint64_t channels = plan->source.nchannels > plan->target.nchannels ? plan->source.nchannels
                                                                        : plan->target.nchannels,
             bytes = (channels * sizeof(float)) << (res.u + res.v),
             limit = env->max_bytes ? env->max_bytes : DEFAULT_MAX_BYTES;
    if (bytes <= limit && bytes <= SIZE_MAX)
        return SLV_OK;
    return output_fail(env, SLV_ERROR_LIMIT,
                       "%s: face %u: %u x %u texels of %llu channels are %.1f GiB, the limit is "
                       "%.1f GiB",
                       plan->path, face, 1u << res.u, 1u << res.v, (unsigned long long)channels,
                       (double)bytes / (1 << 30), (double)limit / (1 << 30));
}

slv_result convert_face(const slv_env *env, const convert_plan *plan, uint32_t face,
                        slv_ptx_face *info, const void **texels, void **own) {
    const slv_ptx_writer_params *source = &plan->source, *target = &plan->target;
    slv_res to = convert_plan_res(plan, face, info->res), from = info->res;
    bool constant = info->flags & SLV_FACE_CONSTANT, multiplied = plan->unmultiply;
    bool same_res = constant || (to.u == from.u && to.v == from.v);
    size_t count = constant ? 1 : (size_t)1 << (from.u + from.v);
    float *values = NULL, *selected = NULL;
    void *out = NULL;
    slv_result result = SLV_OK;
    *own = NULL;
    info->res = to;
    count_face(plan, from, info);
    if (same_res && plan->same_channels && source->type == target->type && !plan->premultiply &&
        !plan->unmultiply)
        return SLV_OK;
    if (!constant && (result = check_size(env, plan, face, to)))
        return result;
    if (count <= SIZE_MAX / sizeof *values / source->nchannels)
        values = malloc(count * source->nchannels * sizeof *values);
    if (!values)
        goto no_memory;
    slv_type_to_float(source->type, *texels, count * source->nchannels, values);
    if (!same_res) {
        if ((result = resize(env, plan, face, from, to, &values, &multiplied)))
            goto done;
        count = (size_t)1 << (to.u + to.v);
    }
    if (multiplied && !plan->premultiply)
        slv_ptx_unmultiply(SLV_TYPE_FLOAT, source->nchannels, source->alpha_channel, values, count);
    else if (!multiplied && plan->premultiply)
        slv_ptx_premultiply(SLV_TYPE_FLOAT, source->nchannels, source->alpha_channel, values,
                            count);
    selected = plan->same_channels ? values : select_channels(plan, values, count);
    if (!selected)
        goto no_memory;
    out = malloc(count * target->nchannels * slv_type_size(target->type));
    if (!out)
        goto no_memory;
    slv_type_from_float(target->type, selected, count * target->nchannels, out);
    plan->totals->clipped += count_clipped(target->type, selected, count * target->nchannels);
    *texels = *own = out;
    goto done;
no_memory:
    result = output_fail(env, SLV_ERROR_MEMORY, "%s: face %u: no memory for its texels", plan->path,
                         face);
done:
    if (selected != values)
        free(selected);
    free(values);
    return result;
}
