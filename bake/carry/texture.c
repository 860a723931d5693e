/* A per-face texture as a source of its own mesh: the mean over each texel of what it has. */
#include "carry/carry.h"

#include "base/log.h"
#include "base/memory.h"

#include <selvage/cache.h>

#include <math.h>

enum { MOST_ACROSS = 16 };
#define CACHE_BYTES (UINT64_C(256) << 20)

typedef struct texture_source {
    slv_bake_source base;
    slv_ptx *ptx;
    slv_cache *cache;
    carry_pool *pool; /* apart, since threads change it */
} texture_source;

/* At the resolution of the texture, or a coarser one: texels, as they are. */
static slv_result read_texels(const texture_source *s, const slv_env *env, uint32_t face,
                              slv_res res, slv_rect rect, float *values) {
    const transfer_source *from = &s->pool->source;
    const slv_source_desc *desc = &from->desc;
    slv_res whole = from->faces[face].res;
    size_t count = (size_t)rect.width * rect.height;
    void *raw = NULL;
    slv_result result = slvi_alloc_plain(env, "bake: texels", count,
                                         desc->nchannels * slv_type_size(desc->type), &raw);
    if (!result)
        result = from->texels.fns->read(from->texels.user, face, res, rect, raw);
    if (!result)
        slv_type_to_float(desc->type, raw, count * desc->nchannels, values);
    bool painted = (res.u == whole.u && res.v == whole.v) || (!res.u && !res.v);
    if (!result && !painted)
        slv_ptx_unmultiply(SLV_TYPE_FLOAT, desc->nchannels, desc->alpha_channel, values, count);
    slvi_free(raw);
    return result;
}

/* Finer than the texture along an axis: a texel lies between four centres then, and the mean of
 * what is linear between them is what it has in its middle; along the other axis the mean of
 * several. */
static slv_result interpolate(const texture_source *s, const slv_env *env, uint32_t face,
                              slv_res res, slv_rect rect, float *values) {
    const transfer_source *from = &s->pool->source;
    slv_res whole = from->faces[face].res;
    uint32_t n = from->desc.nchannels;
    uint32_t nu = whole.u > res.u ? 1u << (whole.u - res.u) : 1,
             nv = whole.v > res.v ? 1u << (whole.v - res.v) : 1;
    size_t count = (size_t)rect.width * rect.height;
    transfer_tiles *tiles = NULL;
    nu = nu < MOST_ACROSS ? nu : MOST_ACROSS;
    nv = nv < MOST_ACROSS ? nv : MOST_ACROSS;
    slv_result result = slvi_carry_take(s->pool, env, &tiles);
    for (size_t i = 0; i < count && !result; i++) {
        float *out = values + i * n;
        for (uint32_t k = 0; k < nu * nv; k++) {
            float x = (float)(rect.x + i % rect.width) + ((float)(k % nu) + 0.5f) / (float)nu,
                  y = (float)(rect.y + i / rect.width) + ((float)(k / nu) + 0.5f) / (float)nv;
            const slv_surface_point at = {(int32_t)face, ldexpf(x, -res.u), ldexpf(y, -res.v)};
            slvi_transfer_look_up(tiles, &at, 0, out);
        }
        for (uint32_t c = 0; c < n; c++)
            out[c] /= (float)(nu * nv);
        result = tiles->result;
    }
    slvi_carry_put(s->pool, tiles);
    slv_ptx_unmultiply(SLV_TYPE_FLOAT, n, from->desc.alpha_channel, values, count);
    return result;
}

static slv_result evaluate(const slv_bake_source *source, const slv_env *env, uint32_t face,
                           slv_res res, slv_rect rect, float *values, uint8_t *misses) {
    const texture_source *s = (const texture_source *)source;
    const slv_source_face *f = &s->pool->source.faces[face];
    uint32_t n = source->desc.nchannels;
    size_t count = (size_t)rect.width * rect.height;
    slv_result result;
    if (f->flags & SLV_FACE_CONSTANT && (res.u > f->res.u || res.v > f->res.v)) {
        result = read_texels(s, env, face, (slv_res){0, 0}, (slv_rect){0, 0, 1, 1}, values);
        for (size_t i = n; i < count * n && !result; i++)
            values[i] = values[i - n];
    } else if (res.u <= f->res.u && res.v <= f->res.v) {
        result = read_texels(s, env, face, res, rect, values);
    } else {
        result = interpolate(s, env, face, res, rect, values);
    }
    for (size_t i = 0; i < count * n && !result; i++)
        if (!isfinite(values[i])) {
            misses[i / n] = SLV_BAKE_NAN;
            values[i] = 0;
        }
    return result;
}

static void extent(const slv_bake_source *source, uint32_t face, float size[2]) {
    slv_res res = ((const texture_source *)source)->pool->source.faces[face].res;
    size[0] = ldexpf(1, res.u);
    size[1] = ldexpf(1, res.v);
}

static void destroy(slv_bake_source *source) {
    texture_source *s = (texture_source *)source;
    if (s->pool)
        slvi_carry_pool_end(s->pool);
    slvi_free(s->pool);
    slv_cache_destroy(s->cache);
    slv_ptx_close(s->ptx);
    slvi_free(s);
}

/* The file behind a cache, as light. */
static slv_result open_texels(const slv_env *env, texture_source *s, const slv_mesh *mesh,
                              slv_texture_encoding encoding) {
    const slv_cache_params params = {.max_bytes = CACHE_BYTES};
    slv_source file, cached, light;
    slv_file_id id;
    slv_result result;
    if ((result = slv_cache_create(env, &params, &s->cache)) ||
        (result = slv_ptx_as_source(env, s->ptx, &file)) ||
        (result = slv_cache_open_source(s->cache, &file, NULL, &id)) ||
        (result = slv_cache_as_source(s->cache, id, &cached)) ||
        (result = slv_source_decode(env, &cached, encoding, &light)))
        return result;
    result = slvi_alloc(env, "bake: texture", 1, sizeof *s->pool, &s->pool);
    if (result)
        slv_source_close(&light);
    else
        result = slvi_carry_pool_begin(env, mesh, &light, s->pool);
    return result;
}

slv_result slv_bake_from_texture(const slv_env *env, const slv_mesh *mesh, const char *path,
                                 slv_texture_encoding encoding, slv_bake_source **out) {
    static const slvi_bake_fns fns = {evaluate, extent, NULL, destroy, NULL};
    texture_source *s = NULL;
    *out = NULL;
    slv_result result = slvi_alloc(env, "bake: texture", 1, sizeof *s, &s);
    if (result)
        return result;
    if ((result = slv_ptx_open(env, path, &s->ptx)))
        goto done;
    const slv_ptx_info *info = slv_ptx_get_info(s->ptx);
    if (info->mesh_type == SLV_PTX_TRIANGLE)
        result =
            slvi_fail(env, SLV_ERROR_UNSUPPORTED, "%s: a texture of triangles, not of quads", path);
    else if (info->nchannels > SLVI_BAKE_MAX_CHANNELS)
        result = slvi_fail(env, SLV_ERROR_UNSUPPORTED, "%s: %u channels, at most %d can be baked",
                           path, info->nchannels, SLVI_BAKE_MAX_CHANNELS);
    else
        result = slv_ptx_match_mesh(env, s->ptx, mesh);
    if (!result && encoding == SLV_TEXTURE_AUTO)
        result = slv_ptx_get_encoding(s->ptx, &encoding);
    if (result)
        goto done;
    s->base =
        (slv_bake_source){.fns = &fns,
                          .nfaces = info->nfaces,
                          .apart = info->edge_filter == SLV_EDGE_FILTER_TANVEC,
                          .desc = {info->type, info->nchannels, info->alpha_channel, encoding}};
    if ((result = open_texels(env, s, mesh, encoding)))
        goto done;
    *out = &s->base;
    s = NULL;
done:
    if (s)
        destroy(&s->base);
    return result;
}
