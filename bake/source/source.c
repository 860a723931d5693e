/* What is the same for every source of values, and the causes of misses. */
#include "source/source.h"

#include "base/log.h"
#include "base/names.h"

#include <string.h>

static const char *const misses[] = {"hit",     "no-uv",       "no-tile", "no-hit",
                                     "too-far", "back-facing", "nan"};
static const char *const surfaces[] = {"position", "normal", "face-id", "density", "curvature"};
static const char *const rays[] = {"ao", "bent-normal", "thickness"};
static const char *const details[] = {"displacement", "object-normal", "face-normal",
                                      "object-vector", "face-vector"};
static const char *const wraps[] = {"auto", "repeat", "clamp", "none"};
/* Grey where there is a value; the others are far apart for eyes that cannot tell red and green
 * too. */
static const float colors[][3] = {
    {0.25f, 0.25f, 0.25f}, {1, 0.35f, 0},      {0.1f, 0.45f, 1}, {0, 0, 0},
    {0.5f, 0.8f, 1},       {0.8f, 0.2f, 0.7f}, {1, 0.95f, 0.2f}};

const char *slv_bake_miss_name(slv_bake_miss miss) {
    return slvi_name_of(misses, SLVI_COUNT(misses), (int)miss);
}

const char *slv_bake_wrap_name(slv_bake_wrap wrap) {
    return slvi_name_of(wraps, SLVI_COUNT(wraps), (int)wrap);
}

const char *slv_bake_surface_kind_name(slv_bake_surface_kind kind) {
    return slvi_name_of(surfaces, SLVI_COUNT(surfaces), (int)kind);
}

const char *slv_bake_rays_kind_name(slv_bake_rays_kind kind) {
    return slvi_name_of(rays, SLVI_COUNT(rays), (int)kind);
}

const char *slv_bake_detail_kind_name(slv_bake_detail_kind kind) {
    return slvi_name_of(details, SLVI_COUNT(details), (int)kind);
}

void slv_bake_miss_color(slv_bake_miss miss, float rgb[3]) {
    size_t which = (size_t)miss < SLVI_COUNT(colors) ? (size_t)miss : 0;
    memcpy(rgb, colors[which], sizeof colors[which]);
}

const slv_bake_source_desc *slv_bake_source_get_desc(const slv_bake_source *source) {
    return &source->desc;
}

const slv_bake_tile *slv_bake_source_tiles(const slv_bake_source *source, uint32_t *count) {
    *count = 0;
    return source->fns->tiles ? source->fns->tiles(source, count) : NULL;
}

bool slv_bake_source_images(const slv_bake_source *source, slv_uv_images *out) {
    memset(out, 0, sizeof *out);
    if (source->fns->images)
        source->fns->images(source, out);
    return source->fns->images != NULL;
}

void slv_bake_source_destroy(slv_bake_source *source) {
    if (source)
        source->fns->destroy(source);
}

slv_result slv_bake_evaluate(const slv_bake_source *source, const slv_env *env, uint32_t face,
                             slv_res res, slv_rect rect, float *values, uint8_t *missed) {
    if (face >= source->nfaces)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: face %u: there are %u faces", face,
                         source->nfaces);
    if (res.u < 0 || res.v < 0 || res.u > SLV_MAX_LOG2_RES || res.v > SLV_MAX_LOG2_RES)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "bake: face %u: a resolution of 2^%d x 2^%d",
                         face, res.u, res.v);
    if (rect.x > 1u << res.u || rect.width > (1u << res.u) - rect.x || rect.y > 1u << res.v ||
        rect.height > (1u << res.v) - rect.y)
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "bake: face %u: texels %u,%u and %u x %u of them, but there are %u x %u",
                         face, rect.x, rect.y, rect.width, rect.height, 1u << res.u, 1u << res.v);
    size_t count = (size_t)rect.width * rect.height;
    memset(values, 0, count * source->desc.nchannels * sizeof *values);
    memset(missed, SLV_BAKE_HIT, count);
    return source->fns->evaluate(source, env, face, res, rect, values, missed);
}
