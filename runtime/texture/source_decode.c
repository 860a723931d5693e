/* A source whose colours are light, over one that has them as sRGB. */
#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <selvage/source.h>

typedef struct decoded_source {
    slv_env env; /* its log is serialised: any thread may read */
    slv_parallel_log *log;
    slv_source inner;
    slv_source_desc desc, stored;
} decoded_source;

static const slv_source_fns decoded_fns;

static slv_result describe(void *user, slv_source_desc *out) {
    *out = ((const decoded_source *)user)->desc;
    return SLV_OK;
}

static slv_result face(void *user, uint32_t index, slv_source_face *out) {
    const decoded_source *source = user;
    return source->inner.fns->face(source->inner.user, index, out);
}

static slv_result read_full(const decoded_source *source, uint32_t index, slv_res res,
                            slv_rect rect, float *out) {
    const slv_source_desc *stored = &source->stored;
    uint64_t texels = (uint64_t)rect.width * rect.height;
    void *values = NULL;
    slv_result result = slvi_alloc_plain(&source->env, stored->name, texels * stored->nchannels,
                                         slv_type_size(stored->type), &values);
    if (result)
        return result;
    if (!(result = source->inner.fns->read(source->inner.user, index, res, rect, values))) {
        slv_type_to_float(stored->type, values, texels * stored->nchannels, out);
        slv_texels_decode(stored->nchannels, stored->alpha_channel, out, texels);
    }
    slvi_free(values);
    return result;
}

/* Reductions are means of light, and so none of those that the inner source may have stored. */
static slv_result read_rect(void *user, uint32_t index, slv_res res, slv_rect rect, void *out) {
    decoded_source *source = user;
    const slv_source self = {&decoded_fns, source};
    slv_source_face found;
    slv_result result = slv_source_check(&source->env, &self, index, res, rect, &found);
    if (result)
        return result;
    if (res.u != found.res.u || res.v != found.res.v)
        return slv_source_reduce(&source->env, &self, index, res, rect, out);
    return read_full(source, index, res, rect, out);
}

static uint64_t version(void *user) {
    return slv_source_version(&((const decoded_source *)user)->inner);
}

static slv_result changed(void *user, uint64_t since, slv_visit_rect visit, void *visitor) {
    return slv_source_changed(&((const decoded_source *)user)->inner, since, visit, visitor);
}

static void close_source(void *user) {
    decoded_source *source = user;
    slv_source_close(&source->inner);
    slvi_parallel_env_end(source->log);
    slvi_free(source);
}

static const slv_source_fns decoded_fns = {.describe = describe,
                                           .face = face,
                                           .read = read_rect,
                                           .version = version,
                                           .changed = changed,
                                           .close = close_source};

slv_result slv_source_decode(const slv_env *env, slv_source *inner, slv_texture_encoding encoding,
                             slv_source *out) {
    slv_source_desc desc;
    decoded_source *source = NULL;
    slv_result result = inner->fns->describe(inner->user, &desc);
    *out = (slv_source){0};
    if (!result && encoding == SLV_TEXTURE_AUTO)
        encoding = desc.edge_filter == SLV_EDGE_FILTER_TANVEC ? SLV_TEXTURE_DATA
                                                              : slv_type_encoding(desc.type);
    if (!result && encoding != SLV_TEXTURE_SRGB) {
        *out = *inner;
        *inner = (slv_source){0};
        return SLV_OK;
    }
    if (!result)
        result = slvi_alloc(env, desc.name, 1, sizeof *source, &source);
    if (!result && (result = slvi_parallel_env_begin(env, &source->log, &source->env)))
        slvi_free(source);
    if (result) {
        slv_source_close(inner);
        return result;
    }
    source->inner = *inner;
    source->stored = source->desc = desc;
    source->desc.type = SLV_TYPE_FLOAT;
    *inner = (slv_source){0};
    *out = (slv_source){&decoded_fns, source};
    return SLV_OK;
}
