/* UV images as those see them who draw them: pixels, tiles, and the colour at a place. */
#include "uv/uv_source.h"

#include <math.h>

static void none_color(float rgba[4]) {
    slv_bake_miss_color(SLV_BAKE_NO_TILE, rgba);
    slv_texels_decode(3, SLV_NO_ALPHA, rgba, 1);
    rgba[3] = 1;
}

static void as_rgba(const uv_set *set, const double *value, float rgba[4]) {
    bool grey = set->nchannels < 3;
    for (uint32_t c = 0; c < 3; c++)
        rgba[c] = (float)value[grey ? 0 : c];
    rgba[3] = set->alpha >= 0 ? (float)value[set->alpha] : 1;
    if (!isfinite(rgba[0]) || !isfinite(rgba[1]) || !isfinite(rgba[2]) || !isfinite(rgba[3]))
        none_color(rgba);
}

static void read_pixels(const void *user, uint32_t tile, uint32_t x, uint32_t y, uint32_t count,
                        float *rgba) {
    const uv_set *set = &((const uv_source *)user)->set;
    for (uint32_t i = 0; i < count; i++, rgba += 4) {
        uv_pixel pixel;
        slvi_uv_decode(&set->tiles[tile], set->nchannels, x + i, y, 1, &pixel);
        const double value[4] = {(double)pixel[0], (double)pixel[1], (double)pixel[2],
                                 (double)pixel[3]};
        as_rgba(set, value, rgba);
    }
}

static void color_at(const void *user, uint32_t face, float u, float v, float rgba[4]) {
    const uv_source *s = user;
    uv_face f = {
        .source = s, .corners = slvi_uv_corners_of(s, face), .cells = s->cells + 4 * (size_t)face};
    double at[2], sum[4] = {0};
    none_color(rgba);
    if (isnan(f.corners[0]))
        return;
    slvi_uv_own_cells(f.corners, f.own);
    slvi_uv_place(f.corners, (double)u, (double)v, at);
    if (slvi_uv_sample_at(&f, at[0], at[1], sum) == SLV_BAKE_HIT)
        as_rgba(&s->set, sum, rgba);
}

void slvi_uv_images(const slv_bake_source *source, slv_uv_images *out) {
    const uv_source *s = (const uv_source *)source;
    *out = (slv_uv_images){.nfaces = s->base.nfaces,
                           .texcoords = s->once ? s->once : s->corners,
                           .round_u = s->round[0],
                           .round_v = s->round[1],
                           .tiled = s->set.udim || s->set.wrap == SLV_BAKE_WRAP_NONE,
                           .repeat_u = s->set.wrap == SLV_BAKE_WRAP_REPEAT && !s->set.ends[0],
                           .repeat_v = s->set.wrap == SLV_BAKE_WRAP_REPEAT && !s->set.ends[1],
                           .wide = s->set.type == SLV_TYPE_FLOAT || s->set.type == SLV_TYPE_U16,
                           .narrow = s->set.type == SLV_TYPE_U8 && s->set.alpha < 0,
                           .data = s->set.encoding != SLV_TEXTURE_SRGB,
                           .ntiles = s->set.ntiles,
                           .tiles = s->squares,
                           .pixels = read_pixels,
                           .color = color_at,
                           .user = s};
    none_color(out->none);
}
