/* Reductions of a source that has none, bit for bit as a .ptx file has them. A rectangle of a
 * reduction comes from one of the next finer, that from one finer still; where rectangles grow too
 * large they are halved, so that memory does not depend on the size of the face. */
#include "base/log.h"
#include "base/memory.h"
#include "texture/reduce.h"

#include <selvage/source.h>

#include <string.h>

#define MOST_BYTES 65536
#define MAX_STEPS (2 * SLV_MAX_LOG2_RES)
#define LEAST_STORED 2 /* files store no reduction with a side below this */

struct plan {
    const slv_env *env;
    const slv_source *source;
    slv_source_desc desc;
    size_t texel_size;
    uint32_t face, steps;
    bool premultiply;               /* what is read */
    slv_res res[MAX_STEPS + 1];     /* from the one that is asked for to the face's */
    unsigned char *work[MAX_STEPS]; /* rectangles at res[i + 1] */
};

static slv_result read_full(const struct plan *plan, slv_rect rect, unsigned char *out) {
    const slv_source *source = plan->source;
    slv_result result =
        source->fns->read(source->user, plan->face, plan->res[plan->steps], rect, out);
    if (!result && plan->premultiply)
        slvi_multiply_alpha(plan->desc.type, plan->desc.nchannels, plan->desc.alpha_channel, false,
                            out, (uint64_t)rect.width * rect.height);
    return result;
}

/* The rectangle at res[i + 1] that one at res[i] is made of. */
static slv_rect grow(const struct plan *plan, uint32_t i, slv_rect rect) {
    int u = plan->res[i + 1].u - plan->res[i].u, v = plan->res[i + 1].v - plan->res[i].v;
    return (slv_rect){rect.x << u, rect.y << v, rect.width << u, rect.height << v};
}

/* Where the odd texels of a triangle's rectangle are, which `rect` is at the next coarser ones. */
static slv_rect mirror(const struct plan *plan, uint32_t i, slv_rect rect) {
    uint32_t side = 1u << plan->res[i + 1].u;
    return (slv_rect){side - 2 * (rect.y + rect.height), side - 2 * (rect.x + rect.width),
                      2 * rect.height, 2 * rect.width};
}

static size_t bytes_of(const struct plan *plan, slv_rect rect) {
    return (size_t)rect.width * rect.height * plan->texel_size;
}

/* A rectangle at res[i], into rows `pitch` texels apart. */
static slv_result make(const struct plan *plan, uint32_t i, slv_rect rect, unsigned char *out,
                       size_t pitch) {
    const slv_source_desc *desc = &plan->desc;
    slv_rect from = grow(plan, i, rect);
    slv_result result;
    if (bytes_of(plan, from) > MOST_BYTES && (rect.width > 1 || rect.height > 1)) {
        slv_rect first = rect, second = rect;
        size_t distance;
        if (rect.width >= rect.height) {
            first.width /= 2;
            distance = first.width;
            second.x += first.width;
            second.width -= first.width;
        } else {
            first.height /= 2;
            distance = first.height * pitch;
            second.y += first.height;
            second.height -= first.height;
        }
        result = make(plan, i, first, out, pitch);
        return result ? result : make(plan, i, second, out + distance * plan->texel_size, pitch);
    }
    unsigned char *work = plan->work[i], *mirrored = work + bytes_of(plan, from);
    bool last = i + 1 == plan->steps;
    result = last ? read_full(plan, from, work) : make(plan, i + 1, from, work, from.width);
    if (desc->triangles && !result) {
        slv_rect odd = mirror(plan, i, rect);
        result =
            last ? read_full(plan, odd, mirrored) : make(plan, i + 1, odd, mirrored, odd.width);
    }
    if (result)
        return result;
    if (desc->triangles) {
        slvi_halve_triangle(desc->type, desc->nchannels, from.width, from.height, work, mirrored,
                            out, pitch);
        return SLV_OK;
    }
    slv_halving along = (slv_halving)((from.width != rect.width ? SLV_HALVE_U : 0) |
                                      (from.height != rect.height ? SLV_HALVE_V : 0));
    slvi_halve(desc->type, desc->nchannels, along, from.width, from.height, work, work);
    size_t row = rect.width * plan->texel_size;
    for (uint32_t y = 0; y < rect.height; y++)
        memcpy(out + y * pitch * plan->texel_size, work + y * row, row);
    return SLV_OK;
}

/* The way from `res` to the face's own: along one axis until the nearest reduction that a file
 * stores, or the face itself; from there on squares. Returns whether a stored reduction is on it.
 */
static bool find_way(struct plan *plan, slv_res full, slv_res res) {
    int least = full.u < full.v ? full.u : full.v;
    plan->steps = 0;
    plan->res[0] = res;
    for (;;) {
        int du = full.u - res.u, dv = full.v - res.v;
        bool along_u = du > dv || (du == dv && (res.u & 1));
        if (du == dv && (du == 0 || least - du >= LEAST_STORED))
            break;
        if (plan->desc.triangles || along_u)
            res.u++;
        if (plan->desc.triangles || !along_u)
            res.v++;
        plan->res[++plan->steps] = res;
    }
    bool stored = res.u != full.u;
    while (res.u != full.u) {
        res = (slv_res){(int8_t)(res.u + 1), (int8_t)(res.v + 1)};
        plan->res[++plan->steps] = res;
    }
    return stored;
}

static slv_result make_rect(struct plan *plan, slv_res full, slv_res res, slv_rect rect, void *out,
                            bool premultiply) {
    size_t largest = MOST_BYTES > 4 * plan->texel_size ? MOST_BYTES : 4 * plan->texel_size;
    unsigned char *work = NULL;
    plan->premultiply = find_way(plan, full, res) || premultiply;
    if (!plan->steps)
        return read_full(plan, rect, out);
    slv_result result = slvi_alloc_plain(plan->env, plan->desc.name, plan->steps,
                                         largest << plan->desc.triangles, &work);
    for (uint32_t i = 0; !result && i < plan->steps; i++)
        plan->work[i] = work + i * (largest << plan->desc.triangles);
    if (!result)
        result = make(plan, 0, rect, out, rect.width);
    slvi_free(work);
    return result;
}

/* The mean of the last reduction that a file stores. */
static slv_result average(struct plan *plan, slv_res full, void *out) {
    int least = full.u < full.v ? full.u : full.v;
    int level = least > LEAST_STORED ? least - LEAST_STORED : 0;
    slv_res res = {(int8_t)(full.u - level), (int8_t)(full.v - level)};
    slv_rect rect = {0, 0, 1u << res.u, 1u << res.v};
    const slv_source_desc *desc = &plan->desc;
    void *texels = NULL;
    slv_result result = slvi_alloc_plain(plan->env, desc->name, bytes_of(plan, rect), 1, &texels);
    if (!result && !(result = make_rect(plan, full, res, rect, texels, true))) {
        slvi_average(desc->type, desc->nchannels, texels, (uint64_t)rect.width * rect.height, out);
        slvi_multiply_alpha(desc->type, desc->nchannels, desc->alpha_channel, true, out, 1);
    }
    slvi_free(texels);
    return result;
}

slv_result slv_source_reduce(const slv_env *env, const slv_source *source, uint32_t index,
                             slv_res res, slv_rect rect, void *out) {
    struct plan plan = {.env = env, .source = source, .face = index};
    slv_source_face face;
    slv_result result;
    if ((result = source->fns->describe(source->user, &plan.desc)) ||
        (result = source->fns->face(source->user, index, &face)))
        return result;
    plan.texel_size = slv_type_size(plan.desc.type) * plan.desc.nchannels;
    uint64_t count = (uint64_t)rect.width * rect.height;
    if (face.flags & SLV_FACE_CONSTANT) {
        result = source->fns->read(source->user, index, face.res, (slv_rect){0, 0, 1, 1}, out);
        if (!result && count > 1)
            slvi_fill_texels((unsigned char *)out + plan.texel_size, out, plan.texel_size,
                             count - 1);
        return result;
    }
    if (res.u == 0 && res.v == 0 && (face.res.u || face.res.v))
        return average(&plan, face.res, out);
    return make_rect(&plan, face.res, res, rect, out, false);
}
