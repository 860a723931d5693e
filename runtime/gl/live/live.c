/* The light of a texture, its levels, and how they follow the texture's changes. */
#include "gl/live/live.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "gl/store/scale.h"

#include <selvage/border.h>
#include <selvage/source.h>

#include <string.h>

static const slv_texture *light_of(const slv_gl_live *live) {
    return live->copy ? live->copy : live->texture;
}

/* The levels of the texture's light: of a copy, which must outlive them, if it is encoded, or its
 * values are too large. */
static slv_result make_levels(const slv_env *env, const slv_gl_texture_params *params,
                              slv_gl_live *live) {
    slv_texture *scaled = NULL;
    slv_result result = slv_texture_decode(env, live->texture, params->encoding, &live->copy);
    bool bytes =
        live->decoded || (live->copy && slv_texture_get_desc(live->texture)->type == SLV_TYPE_U8);
    if (!result && !live->copy && params->edge_filter)
        result = slv_texture_widen(env, live->texture, &live->copy);
    if (result || (result = slvi_gl_scale_down(env, light_of(live), &scaled)))
        return result;
    if (scaled) {
        slv_texture_destroy(live->copy);
        live->copy = scaled;
        live->scaled = true;
    }
    if (bytes) {
        if ((result = slvi_alloc_plain(env, "sRGB curve", SLVI_GL_SRGB, 1, &live->srgb)))
            return result;
        slvi_gl_srgb_fill(live->srgb);
    }
    if (!(result = slv_levels_create_over(env, light_of(live), &live->levels)))
        slv_levels_set_edge_filter(live->levels, params->edge_filter);
    if (!result && params->even_levels &&
        !(result = slv_levels_create_even(env, light_of(live), &live->even)))
        slv_levels_set_edge_filter(live->even, params->edge_filter);
    return result;
}

slv_result slvi_gl_live_create(slv_gl *gl, const slv_env *env, const slv_gl_given *given,
                               const slv_gl_texture_params *params, slvi_steps *steps,
                               slv_gl_live **out) {
    slv_gl_live *live = NULL;
    slv_result result = slvi_alloc(env, "GL texture", 1, sizeof *live, &live);
    *out = NULL;
    if (result)
        return result;
    live->texture = given->texture;
    live->decoded = given->decoded;
    live->room = UINT64_MAX;
    live->seen = slv_texture_version(live->texture);
    if ((result = slvi_parallel_env_begin(env, &live->log, &live->source.shared)) ||
        (result = make_levels(env, params, live))) {
        slvi_gl_live_destroy(live);
        return result;
    }
    live->source.env = env;
    live->source.gl = gl;
    live->source.type =
        live->decoded
            ? SLV_TYPE_U8
            : slv_texture_get_desc(params->edge_filter ? light_of(live) : live->texture)->type;
    live->source.levels = live->levels;
    live->source.even = live->even;
    live->source.light = given->decoded ? NULL : light_of(live);
    live->source.bare_only = given->resident;
    live->source.srgb = live->srgb;
    live->source.adjacency = given->adjacency;
    live->source.params = *params;
    live->source.steps = steps;
    *out = live;
    return SLV_OK;
}

void slvi_gl_live_destroy(slv_gl_live *live) {
    if (!live)
        return;
    slv_form_borders()->destroy(live->around);
    slvi_gl_marks_end(&live->faces);
    slv_form_room_end(&live->room_of_forms);
    slvi_gl_staging_free(&live->staging);
    slvi_free(live->changes);
    slv_levels_destroy(live->levels);
    slv_levels_destroy(live->even);
    slv_texture_destroy(live->copy);
    slvi_free(live->srgb);
    slvi_parallel_env_end(live->log);
    slvi_free(live);
}

static slv_result list_change(void *user, uint32_t face, slv_rect rect) {
    slv_gl_live *live = user;
    if (live->nchanges == live->capacity) {
        uint32_t capacity = live->capacity ? 2 * live->capacity : 256;
        slv_result result =
            slvi_grow(live->source.env, "changes", capacity, sizeof *live->changes, &live->changes);
        if (result)
            return result;
        live->capacity = capacity;
    }
    live->changes[live->nchanges++] = (slv_form_change){face, rect};
    return SLV_OK;
}

/* Whether a change of float texels makes them too large for lookups as they are. */
static bool becomes_large(const slv_gl_live *live, const slv_form_change *change) {
    const slv_texture *light = light_of(live);
    const slv_texture_desc *desc = slv_texture_get_desc(light);
    if (desc->type != SLV_TYPE_FLOAT)
        return false;
    const float *texels = slv_texture_texels(light, change->face);
    if (slv_texture_is_constant(light, change->face))
        return slvi_gl_is_large(texels, desc->nchannels);
    size_t pitch = (size_t)desc->nchannels << desc->res[change->face].u;
    texels += change->rect.y * pitch + change->rect.x * (size_t)desc->nchannels;
    for (uint32_t y = 0; y < change->rect.height; y++, texels += pitch)
        if (slvi_gl_is_large(texels, (uint64_t)change->rect.width * desc->nchannels))
            return true;
    return false;
}

slv_result slvi_gl_live_follow(slv_gl_live *live, const slv_env *env, bool *renew) {
    slv_result result;
    live->nchanges = 0;
    *renew = false;
    if ((result = slv_texture_changed(live->texture, live->seen, list_change, live)))
        return result;
    *renew = live->scaled && live->nchanges;
    for (uint32_t i = 0; !result && !*renew && i < live->nchanges; i++) {
        const slv_form_change *change = &live->changes[i];
        if (live->copy)
            result =
                slv_texture_decode_rect(env, live->texture, change->face, change->rect, live->copy);
        if (!result && !(*renew = becomes_large(live, change)))
            result = slv_levels_update(live->levels, light_of(live), change->face, change->rect);
        if (!result && !*renew && live->even)
            result = slv_levels_update(live->even, light_of(live), change->face, change->rect);
    }
    return result;
}
