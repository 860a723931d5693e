/* Paint through patches onto a canvas, and what a canvas has under patches. */
#include "canvas/blend.h"
#include "canvas/lay_data.h"

#include "base/log.h"

#include <string.h>

/* Work on all patches, whose texels are one after the other. */
typedef struct work {
    slv_painter *p;
    const slv_canvas *canvas;
    slv_canvas_desc desc;
    const slv_patches *patches;
    const slv_paint *paint;
    const float *colors; /* of each texel, or NULL */
    uint64_t *starts;    /* of each patch's texels */
    double *sums;        /* nchannels + 1 for each patch */
} work;

static uint64_t texels_of(const slv_patch *patch) {
    return (uint64_t)patch->rect.width * patch->rect.height;
}

static slv_result apply_some(void *user, uint64_t begin, uint64_t end) {
    const work *w = user;
    slv_result result = SLV_OK;
    for (uint64_t i = begin; i < end && !result; i++) {
        const slv_patch *patch = &w->patches->list[i];
        float *texels = w->p->texels + w->starts[i] * w->desc.nchannels;
        if ((result = w->canvas->fns->read(w->canvas->user, patch->face, patch->rect, texels)))
            break;
        const float *colors = w->colors ? w->colors + w->starts[i] * SLV_PAINT_CHANNELS : NULL;
        slvi_blend_texels(&w->desc, w->paint, patch->coverage, colors, texels_of(patch), texels);
        result = w->canvas->fns->write(w->canvas->user, patch->face, patch->rect, texels);
    }
    return result;
}

static slv_result sum_some(void *user, uint64_t begin, uint64_t end) {
    const work *w = user;
    uint32_t n = w->desc.nchannels;
    int32_t alpha = w->desc.alpha_channel;
    for (uint64_t i = begin; i < end; i++) {
        const slv_patch *patch = &w->patches->list[i];
        float *texels = w->p->texels + w->starts[i] * n;
        double *sum = w->sums + i * (n + 2);
        slv_result result = w->canvas->fns->read(w->canvas->user, patch->face, patch->rect, texels);
        if (result)
            return result;
        memset(sum, 0, (n + 2) * sizeof *sum);
        for (uint64_t k = 0; k < texels_of(patch); k++, texels += n) {
            double weight = (double)patch->coverage[k] * (double)patch->texel_area;
            double colour = alpha >= 0 ? weight * (double)texels[alpha] : weight;
            for (uint32_t c = 0; weight > 0 && c < n; c++)
                sum[c] += ((int32_t)c == alpha ? weight : colour) * (double)texels[c];
            sum[n] += weight;
            sum[n + 1] += colour;
        }
    }
    return SLV_OK;
}

/* Room for the texels of all patches, and for `extra` numbers of each. */
static slv_result prepare(work *w, uint64_t extra) {
    slv_painter *p = w->p;
    uint64_t total = 0, count = w->patches->count;
    slv_result result = w->canvas->fns->describe(w->canvas->user, &w->desc);
    if (result)
        return result;
    /* one more than is needed: of none there is a first one, too */
    if ((result = slvi_painter_room(p, count * (extra + 1) + 1, sizeof *p->sums, &p->sums,
                                    &p->sum_room)))
        return result;
    w->sums = p->sums + count;
    w->starts = (uint64_t *)(void *)p->sums;
    for (uint64_t i = 0; i < count; i++) {
        const slv_patch *patch = &w->patches->list[i];
        if (patch->face >= w->desc.nfaces)
            return slvi_fail(&p->env, SLV_ERROR_ARGUMENT, "canvas: face %u of %u",
                             (unsigned)patch->face, (unsigned)w->desc.nfaces);
        w->starts[i] = total;
        total += texels_of(patch);
    }
    return slvi_painter_room(p, total * w->desc.nchannels + 1, sizeof *p->texels, &p->texels,
                             &p->texel_room);
}

slv_result slvi_painter_apply(slv_painter *painter, const slv_canvas *canvas,
                              const slv_patches *patches, const slv_paint *paint,
                              const float *colors) {
    work w = {.p = painter, .canvas = canvas, .patches = patches, .paint = paint, .colors = colors};
    slv_result result = prepare(&w, 0);
    if (result)
        return result;
    if (paint->first_channel >= w.desc.nchannels || !(paint->opacity >= 0 && paint->opacity <= 1) ||
        (unsigned)paint->blend >= SLV_BLEND_COUNT)
        return slvi_fail(&painter->env, SLV_ERROR_ARGUMENT,
                         "canvas: paint of opacity %g from channel %u on, of %u channels",
                         (double)paint->opacity, (unsigned)paint->first_channel,
                         (unsigned)w.desc.nchannels);
    if (!patches->count)
        return SLV_OK;
    if (canvas->fns->begin && (result = canvas->fns->begin(canvas->user, patches)))
        return result;
    return slvi_painter_share(painter, patches, apply_some, &w);
}

slv_result slv_painter_apply(slv_painter *painter, const slv_canvas *canvas,
                             const slv_patches *patches, const slv_paint *paint) {
    return slvi_painter_apply(painter, canvas, patches, paint, NULL);
}

slv_result slv_painter_mean(slv_painter *painter, const slv_canvas *canvas,
                            const slv_patches *patches, float *out, bool *any) {
    work w = {.p = painter, .canvas = canvas, .patches = patches};
    slv_result result = canvas->fns->describe(canvas->user, &w.desc);
    uint32_t n = w.desc.nchannels;
    double weight = 0, colour = 0;
    if (result || (result = prepare(&w, (uint64_t)n + 2)) ||
        (result = slvi_painter_share(painter, patches, sum_some, &w)))
        return result;
    for (uint32_t i = 0; i < patches->count; i++) {
        weight += w.sums[i * ((size_t)n + 2) + n];
        colour += w.sums[i * ((size_t)n + 2) + n + 1];
    }
    for (uint32_t c = 0; c < n; c++) {
        double sum = 0, by = (int32_t)c == w.desc.alpha_channel ? weight : colour;
        for (uint32_t i = 0; i < patches->count; i++)
            sum += w.sums[i * ((size_t)n + 2) + c];
        out[c] = by > 0 ? (float)(sum / by) : 0;
    }
    if (any)
        *any = weight > 0;
    return SLV_OK;
}
