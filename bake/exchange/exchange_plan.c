/* What becomes of a source's faces: parameters are checked against the source, once for all. */
#include "exchange/exchange_data.h"

#include "adjacency/edge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_CHANNELS = 65535 };

static slv_result choose_channels(const slv_env *env, const slv_exchange_params *params,
                                  slvi_exchange_plan *plan) {
    uint32_t have = plan->source.nchannels, count = params->channels ? params->nchannels : have;
    if (count < 1 || count > MAX_CHANNELS)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: %u channels, expected 1 to %u", plan->path,
                         count, MAX_CHANNELS);
    slv_result result = slvi_alloc(env, "channels", count, sizeof *plan->channels, &plan->channels);
    plan->target.nchannels = count;
    plan->same_channels = count == have;
    for (uint32_t i = 0; i < count && !result; i++) {
        slv_exchange_channel channel = {.source = (int32_t)i};
        if (params->channels)
            channel = params->channels[i];
        if (channel.source < -1 || channel.source >= (int32_t)have || !isfinite(channel.value))
            return slvi_fail(env, SLV_ERROR_ARGUMENT,
                             "%s: channel %u of the result is neither a channel of the source nor "
                             "a finite value",
                             plan->path, i);
        plan->same_channels &= channel.source == (int32_t)i;
        plan->channels[i] = channel;
    }
    return result;
}

/* Alpha goes where its channel went, if it is still there. */
static slv_result choose_alpha(const slv_env *env, const slv_exchange_params *params,
                               slvi_exchange_plan *plan) {
    int32_t alpha = params->alpha_channel;
    plan->target.alpha_channel = SLV_NO_ALPHA;
    if (!(params->changes & SLV_EXCHANGE_ALPHA)) {
        for (uint32_t i = plan->target.nchannels; plan->source.alpha_channel >= 0 && i-- > 0;)
            if (plan->channels[i].source == plan->source.alpha_channel)
                plan->target.alpha_channel = (int32_t)i;
        return SLV_OK;
    }
    if (alpha != SLV_NO_ALPHA && (alpha < 0 || (uint32_t)alpha >= plan->target.nchannels))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: there is no channel %d to be alpha",
                         plan->path, alpha);
    plan->target.alpha_channel = alpha;
    return SLV_OK;
}

static int compare_faces(const void *left, const void *right) {
    const slv_exchange_face_res *a = left, *b = right;
    return (a->face > b->face) - (a->face < b->face);
}

static bool is_res(const slvi_exchange_plan *plan, slv_res res) {
    return res.u >= 0 && res.v >= 0 && res.u <= SLV_MAX_LOG2_RES && res.v <= SLV_MAX_LOG2_RES &&
           (plan->source.mesh_type != SLV_PTX_TRIANGLE || res.u == res.v);
}

static slv_result choose_face_sizes(const slv_env *env, const slv_exchange_params *params,
                                    slvi_exchange_plan *plan) {
    uint32_t count = params->nface_res;
    slv_result result = slvi_alloc(env, "sizes", count, sizeof *plan->face_res, &plan->face_res);
    if (result)
        return result;
    memcpy(plan->face_res, params->face_res, count * sizeof *plan->face_res);
    qsort(plan->face_res, count, sizeof *plan->face_res, compare_faces);
    plan->nface_res = count;
    for (uint32_t i = 0; i < count; i++) {
        const slv_exchange_face_res *one = &plan->face_res[i];
        if (one->face >= plan->source.nfaces || !is_res(plan, one->res) ||
            (i && one->face == one[-1].face))
            return slvi_fail(env, SLV_ERROR_ARGUMENT,
                             "%s: face %u: there is none, it cannot have the size asked for, or it "
                             "is asked for twice",
                             plan->path, one->face);
    }
    return SLV_OK;
}

static slv_result choose_sizes(const slv_env *env, const slv_exchange_params *params,
                               slvi_exchange_plan *plan) {
    slv_res max = {SLV_MAX_LOG2_RES, SLV_MAX_LOG2_RES}, min = params->min_res;
    if (params->changes & SLV_EXCHANGE_MAX_RES)
        max = params->max_res;
    if (!is_res(plan, max) || !is_res(plan, min) || min.u > max.u || min.v > max.v ||
        abs(params->scale_log2) > SLV_MAX_LOG2_RES)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "%s: a scale or bounds that the sizes of faces cannot have", plan->path);
    plan->shift = params->scale_log2;
    plan->max[0] = max.u;
    plan->max[1] = max.v;
    plan->min[0] = min.u;
    plan->min[1] = min.v;
    return params->nface_res ? choose_face_sizes(env, params, plan) : SLV_OK;
}

static int compare_numbers(const void *left, const void *right) {
    const uint32_t *a = left, *b = right;
    return (*a > *b) - (*a < *b);
}

/* A list may have a face twice; the result does not. */
static slv_result choose_faces(const slv_env *env, const slv_exchange_params *params,
                               slvi_exchange_plan *plan) {
    uint32_t count = params->nfaces, kept = 0;
    slv_result result = slvi_alloc(env, "faces", count, sizeof *plan->faces, &plan->faces);
    if (result)
        return result;
    memcpy(plan->faces, params->faces, count * sizeof *plan->faces);
    qsort(plan->faces, count, sizeof *plan->faces, compare_numbers);
    if (count && plan->faces[count - 1] >= plan->source.nfaces)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: there is no face %u", plan->path,
                         plan->faces[count - 1]);
    for (uint32_t i = 0; i < count; i++)
        if (!i || plan->faces[i] != plan->faces[i - 1])
            plan->faces[kept++] = plan->faces[i];
    plan->target.nfaces = kept;
    return SLV_OK;
}

slv_result slvi_exchange_plan_make(const slv_env *env, const slv_exchange_params *params,
                                   const char *path, const slv_ptx_writer_params *source,
                                   slvi_exchange_totals *totals, slvi_exchange_plan *plan) {
    unsigned changes = params->changes;
    *plan = (slvi_exchange_plan){.path = path,
                                 .source = *source,
                                 .target = *source,
                                 .totals = totals,
                                 .encoding = params->encoding,
                                 .premultiply = params->premultiply,
                                 .unmultiply = params->unmultiply};
    slv_ptx_writer_params *target = &plan->target;
    slv_result result;
    if ((result = choose_channels(env, params, plan)) ||
        (result = choose_alpha(env, params, plan)) || (result = choose_sizes(env, params, plan)) ||
        (params->faces && (result = choose_faces(env, params, plan))))
        return result;
    if ((unsigned)params->encoding > SLV_TEXTURE_DATA)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: unknown texture encoding %d", path,
                         (int)params->encoding);
    if (params->premultiply && params->unmultiply)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: both multiplied and divided by alpha", path);
    if ((params->premultiply || params->unmultiply) && source->alpha_channel < 0)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "%s: has no alpha channel", path);
    if (changes & SLV_EXCHANGE_TYPE)
        target->type = params->type;
    if (changes & SLV_EXCHANGE_BORDER_U)
        target->border_u = params->border_u;
    if (changes & SLV_EXCHANGE_BORDER_V)
        target->border_v = params->border_v;
    if (changes & SLV_EXCHANGE_EDGE_FILTER)
        target->edge_filter = params->edge_filter;
    if (changes & SLV_EXCHANGE_REDUCTIONS)
        target->no_reductions = params->no_reductions;
    target->compression = params->compression;
    target->seams = params->seams;
    return SLV_OK;
}

void slvi_exchange_plan_free(slvi_exchange_plan *plan) {
    slvi_free(plan->channels);
    slvi_free(plan->face_res);
    slvi_free(plan->faces);
}

int32_t slvi_exchange_plan_place(const slvi_exchange_plan *plan, int32_t face) {
    uint32_t key = (uint32_t)face;
    if (!plan->faces || face < 0)
        return face;
    const uint32_t *found =
        bsearch(&key, plan->faces, plan->target.nfaces, sizeof key, compare_numbers);
    return found ? (int32_t)(found - plan->faces) : -1;
}

uint32_t slvi_exchange_plan_source(const slvi_exchange_plan *plan, uint32_t place) {
    return plan->faces ? plan->faces[place] : place;
}

static bool is_taken(const slvi_exchange_plan *plan, int32_t face) {
    return face >= 0 && slvi_exchange_plan_place(plan, face) >= 0;
}

/* An edge of a whole quad may meet two sub-faces, of which it names the first and the second is
 * over that one's edge before: it stays only where both do. */
static slv_result meets_both(const slvi_exchange_plan *plan, const slv_ptx *ptx,
                             const slv_face_adjacency *quad, int edge, bool *out) {
    slv_ptx_face first;
    int32_t named = quad->face[edge];
    *out = true;
    if (named < 0 || (uint32_t)named >= plan->source.nfaces)
        return SLV_OK;
    slv_result result = slv_ptx_get_face(ptx, (uint32_t)named, &first);
    if (!result && (first.flags & SLV_FACE_SUBFACE))
        *out = is_taken(plan, named) &&
               is_taken(plan, first.adjacency.face[slvi_edge_before(quad->edge[edge] & 3)]);
    return result;
}

slv_result slvi_exchange_plan_move(const slvi_exchange_plan *plan, const slv_ptx *ptx,
                                   slv_ptx_face *face) {
    slv_face_adjacency *adjacency = &face->adjacency;
    const slv_face_adjacency before = *adjacency;
    slv_result result = SLV_OK;
    for (int edge = 0; plan->faces && edge < 4 && !result; edge++) {
        int32_t there = before.face[edge];
        bool stays = is_taken(plan, there);
        slv_ptx_face other;
        if (stays && !(result = slv_ptx_get_face(ptx, (uint32_t)there, &other)) &&
            (face->flags ^ other.flags) & SLV_FACE_SUBFACE)
            result = face->flags & SLV_FACE_SUBFACE
                         ? meets_both(plan, ptx, &other.adjacency, before.edge[edge] & 3, &stays)
                         : meets_both(plan, ptx, &before, edge, &stays);
        adjacency->face[edge] = stays ? slvi_exchange_plan_place(plan, there) : -1;
        if (!stays)
            adjacency->edge[edge] = 0;
    }
    return result;
}

static int8_t resize_side(const slvi_exchange_plan *plan, int axis, int8_t log2) {
    int side = log2 + plan->shift;
    side = side < plan->min[axis] ? plan->min[axis] : side;
    return (int8_t)(side > plan->max[axis] ? plan->max[axis] : side);
}

slv_res slvi_exchange_plan_res(const slvi_exchange_plan *plan, uint32_t face, slv_res res) {
    slv_exchange_face_res key = {face, res};
    const slv_exchange_face_res *own =
        plan->nface_res ? bsearch(&key, plan->face_res, plan->nface_res, sizeof key, compare_faces)
                        : NULL;
    if (own)
        return own->res;
    return (slv_res){resize_side(plan, 0, res.u), resize_side(plan, 1, res.v)};
}
