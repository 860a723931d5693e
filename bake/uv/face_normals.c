/* Frames differ from face to face, so texels are turned before any lookup mixes them. */
#include "uv/face_normals.h"

#include "base/memory.h"
#include "source/vectors.h"

enum { AT_ONCE = 256 };

typedef struct face_normals {
    const slv_env *env;
    const slv_surface *surface;
    slv_source inner;
    slv_type type;
} face_normals;

typedef struct frames {
    slv_surface_point at[AT_ONCE];
    float normals[AT_ONCE][3], du[AT_ONCE][3], dv[AT_ONCE][3];
} frames;

static slv_result describe(void *user, slv_source_desc *out) {
    const face_normals *f = user;
    return f->inner.fns->describe(f->inner.user, out);
}

static slv_result face_of(void *user, uint32_t face, slv_source_face *out) {
    const face_normals *f = user;
    slv_result result = f->inner.fns->face(f->inner.user, face, out);
    out->flags &= (uint8_t) ~(SLV_FACE_CONSTANT | SLV_FACE_NEIGHBOURS_CONSTANT);
    return result;
}

static void turn(const float n[3], const float du[3], float v[3]) {
    float tangent[3], out[3];
    for (int k = 0; k < 3; k++)
        tangent[k] = du[k] - slvi_dot(du, n) * n[k];
    slvi_normalise(tangent);
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        out[k] = v[0] * tangent[k] + v[1] * (n[i] * tangent[j] - n[j] * tangent[i]) + v[2] * n[k];
    }
    for (int k = 0; k < 3; k++)
        v[k] = out[k];
}

static slv_result read_rect(void *user, uint32_t face, slv_res res, slv_rect rect, void *out) {
    const face_normals *f = user;
    const uint32_t total = rect.width * rect.height;
    frames *work = NULL;
    slv_result result = f->inner.fns->read(f->inner.user, face, res, rect, out);
    if (result || (result = slvi_alloc_plain(f->env, "normals", 1, sizeof *work, &work)))
        return result;
    for (uint32_t first = 0; first < total && !result; first += AT_ONCE) {
        const uint32_t count = total - first < AT_ONCE ? total - first : AT_ONCE;
        for (uint32_t i = 0; i < count; i++) {
            const float x = (float)(rect.x + (first + i) % rect.width) + 0.5f,
                        y = (float)(rect.y + (first + i) / rect.width) + 0.5f;
            work->at[i] = (slv_surface_point){(int32_t)face, x / (float)(1u << res.u),
                                              y / (float)(1u << res.v)};
        }
        const slv_surface_arrays arrays = {
            .normals = work->normals[0], .du = work->du[0], .dv = work->dv[0]};
        result = slv_surface_evaluate(f->surface, count, work->at, &arrays);
        for (uint32_t i = 0; i < count && !result; i++) {
            unsigned char *texel =
                (unsigned char *)out + 3 * slv_type_size(f->type) * (size_t)(first + i);
            float value[3];
            slv_type_to_float(f->type, texel, 3, value);
            turn(work->normals[i], work->du[i], value);
            slv_type_from_float(f->type, value, 3, texel);
        }
    }
    slvi_free(work);
    return result;
}

static void close_both(void *user) {
    face_normals *f = user;
    slv_source_close(&f->inner);
    slvi_free(f);
}

slv_result slvi_uv_face_normals(const slv_env *env, const slv_surface *surface, slv_source *inner,
                                slv_source *out) {
    static const slv_source_fns fns = {
        .describe = describe, .face = face_of, .read = read_rect, .close = close_both};
    face_normals *f = NULL;
    slv_source_desc desc;
    slv_result result = inner->fns->describe(inner->user, &desc);
    if (!result)
        result = slvi_alloc(env, "normals", 1, sizeof *f, &f);
    if (result) {
        slv_source_close(inner);
        return result;
    }
    *f = (face_normals){env, surface, *inner, desc.type};
    *out = (slv_source){&fns, f};
    return SLV_OK;
}
