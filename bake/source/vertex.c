/* Colours of a mesh's vertices, interpolated over its faces. */
#include "source/source.h"

#include "base/log.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

enum { CORNER = 4, FACE = 4 * CORNER }; /* floats: RGBA at each of four corners */

typedef struct vertex_source {
    slv_bake_source base;
    float *corners; /* light, multiplied by alpha; NaN where a vertex of the polygon has none */
} vertex_source;

/* Linear, as texture coordinates are: of a sub-face its vertex, two middles with the mean of all
 * between them. */
static void corners_of(const float *colors, const int32_t *verts, int32_t size, float *out) {
    for (int c = 0; c < CORNER; c++) {
        double sum = 0;
        for (int32_t k = 0; k < size; k++)
            sum += (double)colors[4 * (size_t)verts[k] + (size_t)c];
        for (int32_t k = 0; k < size; k++) {
            float own = colors[4 * (size_t)verts[k] + (size_t)c];
            float next = colors[4 * (size_t)verts[(k + 1) % size] + (size_t)c];
            float last = colors[4 * (size_t)verts[(k + size - 1) % size] + (size_t)c];
            if (size == 4) {
                out[CORNER * k + c] = own;
                continue;
            }
            float *face = out + FACE * k + c;
            face[0] = own;
            face[CORNER] = 0.5f * (own + next);
            face[2 * CORNER] = (float)(sum / size);
            face[3 * CORNER] = 0.5f * (own + last);
        }
    }
}

/* The mean of what is bilinear over a texel is what it has in the texel's middle. */
static slv_result evaluate(const slv_bake_source *source, const slv_env *env, uint32_t face,
                           slv_res res, slv_rect rect, float *values, uint8_t *misses) {
    const float *at = ((const vertex_source *)source)->corners + (size_t)FACE * face;
    uint32_t n = source->desc.nchannels;
    (void)env;
    for (uint32_t i = 0; i < rect.width * rect.height; i++) {
        float u = ((float)(rect.x + i % rect.width) + 0.5f) / (float)(1u << res.u),
              v = ((float)(rect.y + i / rect.width) + 0.5f) / (float)(1u << res.v), rgba[CORNER];
        for (int c = 0; c < CORNER; c++)
            rgba[c] = (at[c] * (1 - u) + at[CORNER + c] * u) * (1 - v) +
                      (at[3 * CORNER + c] * (1 - u) + at[2 * CORNER + c] * u) * v;
        for (uint32_t c = 0; c < n; c++) {
            float value = c < 3 && rgba[3] > 0 ? rgba[c] / rgba[3] : rgba[c];
            if (!isfinite(value))
                misses[i] = SLV_BAKE_NAN;
            values[(size_t)i * n + c] = misses[i] ? 0 : value;
        }
    }
    return SLV_OK;
}

static void destroy(slv_bake_source *source) {
    slvi_free(((vertex_source *)source)->corners);
    slvi_free(source);
}

static slv_result fill(const slv_env *env, const slv_mesh *mesh, bool srgb, vertex_source *s) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    const int32_t *verts = view->poly_verts;
    float *colors = NULL, *out;
    slv_result result =
        slvi_alloc(env, "bake: colours", s->base.nfaces, FACE * sizeof(float), &s->corners);
    if (!result)
        result = slvi_alloc(env, "bake: colours", view->nverts, 4 * sizeof *colors, &colors);
    if (result)
        return result;
    memcpy(colors, view->colors, 4 * sizeof *colors * view->nverts);
    if (srgb)
        slv_texels_decode(4, 3, colors, view->nverts);
    for (size_t v = 0; v < view->nverts; v++)
        for (int c = 0; c < 3; c++)
            colors[4 * v + (size_t)c] *= colors[4 * v + 3];
    out = s->corners;
    for (uint32_t poly = 0; poly < view->npolys; poly++) {
        int32_t size = view->poly_sizes[poly];
        corners_of(colors, verts, size, out);
        verts += size;
        out += FACE * (size == 4 ? 1 : size);
    }
    slvi_free(colors);
    return SLV_OK;
}

slv_result slv_bake_from_vertex_colors(const slv_env *env, const slv_mesh *mesh,
                                       slv_texture_encoding encoding, slv_bake_source **out) {
    static const slvi_bake_fns fns = {evaluate, NULL, NULL, destroy, NULL};
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    vertex_source *s = NULL;
    *out = NULL;
    if (!view->colors)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "bake: the mesh's vertices have no colours");
    if (encoding == SLV_TEXTURE_AUTO)
        encoding = view->colors_linear ? SLV_TEXTURE_LINEAR : SLV_TEXTURE_SRGB;
    slv_result result = slvi_alloc(env, "bake: colours", 1, sizeof *s, &s);
    if (result)
        return result;
    bool alpha = view->colors_alpha;
    s->base = (slv_bake_source){.fns = &fns,
                                .nfaces = slv_mesh_face_count(mesh),
                                .desc = {view->colors_linear ? SLV_TYPE_FLOAT : SLV_TYPE_U8,
                                         alpha ? 4 : 3, alpha ? 3 : SLV_NO_ALPHA, encoding}};
    if ((result = fill(env, mesh, encoding == SLV_TEXTURE_SRGB, s))) {
        destroy(&s->base);
        return result;
    }
    *out = &s->base;
    return SLV_OK;
}
