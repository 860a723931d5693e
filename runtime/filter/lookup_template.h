/* Template: the lookups of a sampler, one at a time and many, for each filter. A source file that
 * includes this says for which kind of processor by SLVI_VARIANT_NAME, see variants.h; the numbers
 * are the same for all. */
#ifndef SLV_FILTER_LOOKUP_TEMPLATE_H
#define SLV_FILTER_LOOKUP_TEMPLATE_H

#include "filter/group_template.h"

static inline __attribute__((always_inline)) slv_result
lookup_one(slv_sampler *s, const slv_lookup *l, slv_filter filter, float *out) {
    slv_result result = SLV_OK;
    cache_pin(&s->thread);
    if (!quick_look_up(s, l, filter, out, &result))
        result = any_look_up(s, l, s->nchannels == UINT32_MAX ? 0 : s->nchannels, out);
    cache_unpin(&s->thread);
    cache_count(&s->thread.lookups, 1);
    return result;
}

static inline __attribute__((always_inline)) bool
lookup_at_once(slv_sampler *s, const slv_lookup *l, slv_filter filter, float *out) {
    cache_pin(&s->thread);
    bool done = quick_at_once(s, l, filter, out);
    cache_unpin(&s->thread);
    if (done)
        cache_count(&s->thread.lookups, 1);
    return done;
}

#define LOOKUP_DEFINE(CODE, FILTER)                                                                \
    static __attribute__((noinline))                                                               \
    slv_result lookup_slowly_##CODE(slv_sampler *s, const slv_lookup *l, float *out) {             \
        return lookup_one(s, l, FILTER, out);                                                      \
    }                                                                                              \
    static slv_result lookup_one_##CODE(slv_sampler *s, const slv_lookup *l, float *out) {         \
        return lookup_at_once(s, l, FILTER, out) ? SLV_OK : lookup_slowly_##CODE(s, l, out);       \
    }                                                                                              \
    static slv_result lookup_many_##CODE(slv_sampler *s, const slv_lookup *l,                      \
                                         const uint32_t *order, size_t count, float *out,          \
                                         size_t stride, slv_result *results) {                     \
        return group_look_up_many(s, l, order, count, FILTER, out, stride, results);               \
    }
SLVI_FILTER_CODES(LOOKUP_DEFINE)

#define LOOKUP_ENTRY(FILTER, NAME, CODE) [FILTER] = {lookup_one_##CODE, lookup_many_##CODE},
const lookup_functions SLVI_VARIANT(slvi_lookup)[SLV_FILTER_COUNT] = {
    SLVI_FILTER_KINDS(LOOKUP_ENTRY)};

#endif
