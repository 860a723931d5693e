/* Samplers: parameters checked once, and the way to the lookups of this processor. */
#include "filter/variants.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/processor.h"

#define NAME(FILTER, TEXT, CODE) [FILTER] = TEXT,
static const char *const names[SLV_FILTER_COUNT] = {SLVI_FILTER_KINDS(NAME)};

const char *slv_filter_name(slv_filter filter) {
    return (unsigned)filter < SLV_FILTER_COUNT ? names[filter] : "unknown";
}

bool slv_filter_from_name(const char *name, slv_filter *out) {
    for (int i = 0; i < SLV_FILTER_COUNT; i++)
        if (strcmp(name, names[i]) == 0) {
            *out = (slv_filter)i;
            return true;
        }
    return false;
}

/* The cubic of Mitchell and Netravali 1988 with B = 1 - sharpness and C = sharpness / 2. */
static kernel_cubic make_cubic(float sharpness) {
    float b = 1 - sharpness;
    return (kernel_cubic){
        .near = {1 - b / 3, 0, 1.5f * b - 2.5f, 1.5f - b},
        .far = {2 - 2 * b / 3, 2 * b - 4, 2.5f - 1.5f * b, b / 3 - 0.5f},
    };
}

static const lookup_functions *best_functions(void) {
#define KIND_OR(KIND) slvi_has_##KIND() ? slvi_lookup_##KIND:
    return SLVI_FILTER_PROCESSORS(KIND_OR) NULL;
}

slv_result slv_sampler_create(slv_cache *cache, const slv_filter_params *params,
                              slv_sampler **out) {
    slv_filter_params p = *params;
    const slv_env *env = slvi_cache_env(cache);
    *out = NULL;
    if ((unsigned)p.filter >= SLV_FILTER_COUNT)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "filter %d: there is no such filter",
                         (int)p.filter);
    if (!(p.sharpness >= 0 && p.sharpness <= 1))
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "sharpness %g: must lie in 0..1",
                         (double)p.sharpness);
    if (!(p.width >= 0 && p.width < INFINITY) || !(p.blur >= 0 && p.blur < INFINITY))
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "width %g, blur %g: must be finite and not negative", (double)p.width,
                         (double)p.blur);
    slv_sampler *s = NULL;
    slv_result result = slvi_alloc_aligned(env, "sampler", 64, 1, sizeof *s, &s);
    if (result)
        return result;
    float sharpness = p.filter == SLV_FILTER_BSPLINE       ? 0
                      : p.filter == SLV_FILTER_CATMULL_ROM ? 1
                      : p.filter == SLV_FILTER_MITCHELL    ? 2.0f / 3.0f
                                                           : p.sharpness;
    s->shape = (kernel_shape){p.filter, p.lerp, make_cubic(sharpness)};
    s->width = p.width == 0 ? 1 : p.width;
    s->blur = p.blur;
    s->no_edge_blend = p.no_edge_blend;
    s->first_channel = p.first_channel;
    s->nchannels = p.nchannels ? p.nchannels : UINT32_MAX;
    s->least = p.first_channel ? UINT32_MAX : p.nchannels;
    s->functions = best_functions()[p.filter];
    slvi_cache_thread_begin(cache, &s->thread);
    *out = s;
    return SLV_OK;
}

void slv_sampler_destroy(slv_sampler *sampler) {
    if (!sampler)
        return;
    slvi_cache_thread_end(&sampler->thread);
    slvi_free(sampler);
}

uint32_t slv_sampler_channels(slv_sampler *sampler, slv_file_id file) {
    slv_ptx_info info;
    if (!slvi_cache_info(sampler->thread.cache, file, &info) ||
        info.nchannels <= sampler->first_channel)
        return 0;
    uint32_t there = info.nchannels - sampler->first_channel;
    return there < sampler->nchannels ? there : sampler->nchannels;
}

slv_result slv_sample(slv_sampler *sampler, const slv_lookup *lookup, float *out) {
    return sampler->functions.one(sampler, lookup, out);
}

/* Whether a row has room for what the parameters ask for; all lookups fail if not. */
static bool has_room(const slv_sampler *s, size_t stride, size_t count, slv_result *results) {
    bool has = stride && (s->nchannels == UINT32_MAX || s->nchannels <= stride);
    for (size_t i = 0; !has && results && i < count; i++)
        results[i] = SLV_ERROR_ARGUMENT;
    return has;
}

slv_result slv_sample_batch(slv_sampler *sampler, const slv_lookup *lookups, size_t count,
                            float *out, size_t stride, slv_result *results) {
    if (count && !has_room(sampler, stride, count, results))
        return SLV_ERROR_ARGUMENT;
    return sampler->functions.many(sampler, lookups, NULL, count, out, stride, results);
}

/* Lookups are sorted in runs of this many, so that an index fits 32 bits. */
#define RUN ((size_t)1 << 30)

size_t slv_sample_workspace(size_t count) {
    size_t run = count < RUN ? count : RUN;
    return run * 2 * sizeof(uint32_t);
}

/* A radix sort by the low bytes of file and face that differ. */
static const uint32_t *sort_by_face(const slv_lookup *lookups, size_t count, uint32_t *order,
                                    uint32_t *other) {
    uint64_t all = ~UINT64_C(0), any = 0;
    for (size_t i = 0; i < count; i++) {
        uint64_t key = (uint64_t)lookups[i].file << 32 | lookups[i].face;
        order[i] = (uint32_t)i;
        all &= key;
        any |= key;
    }
    for (unsigned shift = 0; shift < 64; shift += 8) {
        if (!((all ^ any) >> shift & 0xff))
            continue;
        size_t starts[257] = {0};
        for (size_t i = 0; i < count; i++) {
            uint64_t key = (uint64_t)lookups[i].file << 32 | lookups[i].face;
            starts[(key >> shift & 0xff) + 1]++;
        }
        for (int i = 0; i < 256; i++)
            starts[i + 1] += starts[i];
        for (size_t i = 0; i < count; i++) {
            const slv_lookup *l = &lookups[order[i]];
            uint64_t key = (uint64_t)l->file << 32 | l->face;
            other[starts[key >> shift & 0xff]++] = order[i];
        }
        uint32_t *swap = order;
        order = other;
        other = swap;
    }
    return order;
}

slv_result slv_sample_sorted(slv_sampler *sampler, const slv_lookup *lookups, size_t count,
                             float *out, size_t stride, slv_result *results, void *workspace) {
    slv_result first = SLV_OK;
    if (count && !has_room(sampler, stride, count, results))
        return SLV_ERROR_ARGUMENT;
    for (size_t done = 0; done < count; done += RUN) {
        size_t n = count - done < RUN ? count - done : RUN;
        uint32_t *order = workspace;
        const uint32_t *sorted = sort_by_face(lookups + done, n, order, order + n);
        slv_result result =
            sampler->functions.many(sampler, lookups + done, sorted, n, out + done * stride, stride,
                                    results ? results + done : NULL);
        first = first ? first : result;
    }
    return first;
}
