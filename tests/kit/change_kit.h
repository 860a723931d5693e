/* Meshes, resolutions and changes of texels of many kinds, for tests of what follows them. */
#ifndef CHANGE_KIT_H
#define CHANGE_KIT_H

#include "kit/border_kit.h"

#include <selvage/edge_aligned.h>
#include <selvage/form.h>

enum { KIT_MESHES = 10 };

static inline void kit_any_mesh(kit *k, uint32_t which, uint64_t *random) {
    if (which == 0)
        kit_pentagons(k, random);
    else if (which == 1)
        kit_cube(k, random);
    else if (which < 6)
        kit_disc(k, (int32_t)which + 1, random);
    else
        kit_grid(k, 6, 5, which % 2, which > 7 ? 30 : 0, random, NULL);
}

static inline void kit_any_resolutions(kit *k, uint32_t which, uint64_t *random) {
    if (which == 0)
        kit_equal(k, 4);
    else
        kit_mixed(k, 4, random);
    for (uint32_t face = 0; which == 2 && face < k->nfaces; face++)
        k->res[face].v = (int8_t)(test_random(random) % 5);
}

/* Levels, even or plain ones, their resolutions, and forms that can be made of even ones. */
static inline slv_levels *kit_levels(const kit *k, bool even) {
    slv_env env = test_env();
    slv_levels *levels = NULL;
    REQUIRE(!(even ? slv_levels_create_even(&env, k->texture, &levels)
                   : slv_levels_create(&env, k->texture, &levels)));
    return levels;
}
static inline slv_res kit_level_res(slv_res res, uint32_t level, bool even) {
    return even ? slv_res_even_level(res, level) : slv_res_level(res, level);
}
static inline slv_form_extent kit_extent(const slv_form *form, slv_res res, uint32_t level,
                                         uint32_t border, bool even) {
    return even ? slv_form_even_extent(form, res, level, border)
                : slv_form_level_extent(form, res, level, border);
}
static inline bool kit_takes_even(const slv_form *form) {
    return form == slv_form_borders() || form == slv_form_edge_aligned();
}

static inline slv_rect kit_rect(slv_res res, uint64_t *random) {
    uint32_t width = 1u << res.u, height = 1u << res.v;
    slv_rect rect = {.x = test_random(random) % width, .y = test_random(random) % height};
    rect.width = 1 + test_random(random) % (width - rect.x);
    rect.height = 1 + test_random(random) % (height - rect.y);
    return rect;
}

/* Changes a face in one of the ways that there are: all of it, to a single colour or to noise, or a
 * rectangle, to a single colour (now and then of the face's first texel) or to noise. */
static inline void kit_change(const kit *k, uint32_t face, float most, uint64_t *random) {
    slv_res res = k->res[face];
    slv_rect rect = kit_rect(res, random);
    uint32_t how = test_random(random) % 10;
    bool whole = how < 3, single = how == 0 || how == 3 || how == 4;
    size_t value = slv_type_size(k->type), texel = value * k->nchannels;
    size_t count = whole ? kit_texels(res) : (size_t)rect.width * rect.height;
    unsigned char *texels = malloc(count * texel);
    REQUIRE(texels);
    for (size_t i = 0; i < count * k->nchannels; i++) {
        float f = most * (float)(test_random(random) % 4096) / 4095.0f;
        slv_type_from_float(k->type, &f, 1, texels + i * value);
    }
    if (how == 4)
        memcpy(texels, slv_texture_texels(k->texture, face), texel);
    for (size_t i = 1; single && i < count; i++)
        memcpy(texels + i * texel, texels, texel);
    if (how == 0)
        REQUIRE(slv_texture_set_constant(k->texture, face, texels) == SLV_OK);
    else if (whole)
        REQUIRE(slv_texture_set_face(k->texture, face, texels) == SLV_OK);
    else
        REQUIRE(slv_texture_set_rect(k->texture, face, rect, texels) == SLV_OK);
    free(texels);
}

/* Gives a face another resolution, at most 2^most along each axis, and noise or a single colour. */
static inline void kit_resize(kit *k, uint32_t face, int most, bool square, uint64_t *random) {
    slv_res res = {(int8_t)(test_random(random) % (uint32_t)(most + 1)), 0};
    res.v = square ? res.u : (int8_t)(test_random(random) % (uint32_t)(most + 1));
    size_t value = slv_type_size(k->type), count = kit_texels(res) * k->nchannels;
    bool single = test_random(random) % 4 == 0;
    unsigned char *texels = malloc(count * value);
    REQUIRE(texels);
    for (size_t i = 0; i < count; i++) {
        float f = (float)(test_random(random) % 4096) / 4095.0f;
        if (single && i >= k->nchannels)
            memcpy(texels + i * value, texels + (i - k->nchannels) * value, value);
        else
            slv_type_from_float(k->type, &f, 1, texels + i * value);
    }
    REQUIRE(slv_texture_set_resolution(k->texture, face, res, texels) == SLV_OK);
    k->res[face] = res;
    free(texels);
}

#endif
