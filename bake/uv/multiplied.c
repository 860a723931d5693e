/* Sources give texels at full resolution as painted and reductions multiplied; means over both want
 * one of them. */
#include "uv/multiplied.h"

#include "base/memory.h"

#include <selvage/ptx.h>

typedef struct multiplied {
    slv_source inner;
    slv_source_desc desc;
} multiplied;

static slv_result describe(void *user, slv_source_desc *out) {
    const multiplied *m = user;
    *out = m->desc;
    out->alpha_channel = SLV_NO_ALPHA;
    return SLV_OK;
}

static slv_result face_of(void *user, uint32_t face, slv_source_face *out) {
    const multiplied *m = user;
    return m->inner.fns->face(m->inner.user, face, out);
}

static slv_result read_rect(void *user, uint32_t face, slv_res res, slv_rect rect, void *out) {
    const multiplied *m = user;
    slv_source_face whole;
    slv_result result = m->inner.fns->read(m->inner.user, face, res, rect, out);
    if (!result)
        result = m->inner.fns->face(m->inner.user, face, &whole);
    if (!result && ((res.u == whole.res.u && res.v == whole.res.v) || (res.u == 0 && res.v == 0)))
        slv_ptx_premultiply(m->desc.type, m->desc.nchannels, m->desc.alpha_channel, out,
                            (uint64_t)rect.width * rect.height);
    return result;
}

static void close_both(void *user) {
    multiplied *m = user;
    slv_source_close(&m->inner);
    slvi_free(m);
}

slv_result slvi_uv_multiplied(const slv_env *env, slv_source *inner, slv_source *out) {
    static const slv_source_fns fns = {
        .describe = describe, .face = face_of, .read = read_rect, .close = close_both};
    multiplied *m = NULL;
    slv_source_desc desc;
    slv_result result = inner->fns->describe(inner->user, &desc);
    if (!result && desc.alpha_channel < 0) {
        *out = *inner;
        return SLV_OK;
    }
    if (!result)
        result = slvi_alloc(env, "premultiplied source", 1, sizeof *m, &m);
    if (result) {
        slv_source_close(inner);
        return result;
    }
    *m = (multiplied){*inner, desc};
    *out = (slv_source){&fns, m};
    return SLV_OK;
}
