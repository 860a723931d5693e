/* The GLSL of a strategy's lookups, with the definitions of a variant before it. */
#include "base/log.h"
#include "base/memory.h"
#include "gl/store/scale.h"
#include "gl/store/texture.h"

#include <stdio.h>
#include <string.h>

#define HANDLES_EXTENSION "#extension GL_ARB_bindless_texture : require\n"
#define BALLOT_EXTENSION "#extension GL_ARB_shader_ballot : require\n"

bool slvi_gl_taps_in_shader(const slv_gl_texture *texture) {
    return texture->params.taps != SLV_GL_TAPS_SAMPLER;
}

static bool in_vectors(const slv_gl_texture *texture) {
    slv_gl_branching branching = texture->params.branching;
    return texture->gl->ballot &&
           (branching == SLV_GL_BRANCHING_AUTO ? texture->gl->info.software
                                               : branching == SLV_GL_BRANCHING_VECTORS);
}

slv_result slvi_gl_slot_read(const slv_gl_texture *texture, slv_gl_slot *slot) {
    const slv_env *env = &texture->env;
    const slv_strategy *strategy = slot->strategy;
    char *beyond = NULL;
    slv_result result = slvi_gl_shader_with_parts(
        env, strategy->file ? strategy->file : strategy->name, strategy->glsl, &slot->lookups);
    if (result || !slvi_gl_is_black(&texture->params))
        return result;
    if ((result = slvi_gl_shader_with_parts(env, "lookup/beyond.glsl", NULL, &beyond)))
        return result;
    size_t length = strlen(slot->lookups), more = strlen(beyond) + 1;
    if (!(result = slvi_grow(env, "shader text", length + more, 1, &slot->lookups)))
        memcpy(slot->lookups + length, beyond, more);
    slvi_free(beyond);
    return result;
}

/* How many faces the rows that a draw is shown belong to; 0 means all. */
static uint32_t chunk_of(const slv_gl_texture *texture, const slv_gl_slot *slot) {
    slv_gl_chunks chunks = texture->reaches[slot->reach].reach.chunks;
    return chunks.count > 1 ? 1u << chunks.log2 : 0;
}

static slv_result write_variant(const slv_gl_texture *texture, const slv_gl_slot *slot,
                                uint32_t variant, char **out) {
    const slv_gl_texture_params *params = &texture->params;
    size_t size = strlen(slot->lookups) + 640;
    slv_result result = slvi_alloc_plain(&texture->env, "text of a strategy", size, 1, out);
    if (result)
        return result;
    /* alpha is a texel's own only where there are four channels */
    float scale = texture->scaled ? SLV_GL_SCALE : 1;
    bool even = params->even_levels && (slot->strategy->reach == SLV_GL_REACH_NEIGHBOURS ||
                                        slvi_gl_is_even(params, slot->strategy->form()));
    bool turns = params->edge_filter == SLV_EDGE_FILTER_TANVEC && params->first_channel == 0 &&
                 params->nchannels > 1;
    snprintf(*out, size,
             "%s#define SLV_HANDLES %u\n#define SLV_POOLS %u\n#define SLV_SUBFACES %u\n#define "
             "SLV_SHARED_PAGES %d\n"
             "#define SLV_SPLIT_COVERAGE %d\n#define SLV_ANISOTROPY %u\n#define SLV_BORDER %u\n"
             "#define SLV_TAPS %d\n#define SLV_VECTORS %d\n#define SLV_FIRST_UNIT %u\n#define "
             "SLV_FIRST_STORAGE %u\n#define SLV_CHUNK %u\n#define SLV_EXPLICIT %d\n#define "
             "SLV_EVEN %d\n#define SLV_CONSTANTS %d\n#define SLV_BLACK %d\n#define SLV_OWN_ALPHA "
             "%d\n#define SLV_SCALED "
             "%d\n#define SLV_TURNS %d\n#define SLV_SCALE "
             "vec4(vec3(%.1f), "
             "%.1f)\n%s\n",
             slot->handles_at ? HANDLES_EXTENSION : "", slot->handles_at,
             slv_gl_variant_pools(variant), variant & 1, texture->stores[slot->store].pools.shares,
             slot->split_coverage, params->anisotropy, params->border,
             even || slvi_gl_taps_in_shader(texture), in_vectors(texture), params->first_unit,
             params->first_storage, chunk_of(texture, slot), params->explicit_only, even,
             texture->constants, slvi_gl_is_black(params),
             slvi_gl_is_black(params) && slvi_gl_own_alpha(params), texture->scaled, turns,
             (double)scale, (double)(slvi_gl_own_alpha(params) ? scale : 1), slot->lookups);
    return SLV_OK;
}

slv_result slvi_gl_texture_text(slv_gl_texture *texture, const slv_strategy *strategy,
                                uint32_t variant, const char **out) {
    slv_gl_slot *slot = NULL;
    slv_result result = slvi_gl_texture_need(texture, &texture->env, strategy, &slot);
    *out = NULL;
    if (result)
        return result;
    if (variant >= SLV_GL_MAX_VARIANTS)
        return slvi_fail(&texture->env, SLV_ERROR_ARGUMENT, "there is no variant %u of shaders",
                         variant);
    if (!slot->glsl[variant])
        result = write_variant(texture, slot, variant, &slot->glsl[variant]);
    *out = slot->glsl[variant];
    return result;
}

static bool is_word(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/* A copy with other names: what begins with slv_ begins with the prefix, what begins with SLV_ with
 * the same in capitals. Lines of extensions are left out. */
static slv_result rename_all(const slv_env *env, const char *text, const char *prefix, char **out) {
    size_t length = strlen(prefix), size = strlen(text) + 1;
    for (const char *at = text; (at = strstr(at, "_")); at++)
        size += length;
    slv_result result = slvi_alloc_plain(env, "text of a strategy", size, 1, out);
    if (result)
        return result;
    char *to = *out;
    for (const char *at = text; *at;) {
        bool begins = at == text || !is_word(at[-1]);
        if (begins && strncmp(at, "#extension", 10) == 0) {
            at += strcspn(at, "\n");
        } else if (begins && strncmp(at, "slv_", 4) == 0) {
            memcpy(to, prefix, length);
            to += length;
            at += 4;
        } else if (begins && strncmp(at, "SLV_", 4) == 0) {
            for (size_t i = 0; i < length; i++)
                *to++ = prefix[i] >= 'a' && prefix[i] <= 'z' ? (char)(prefix[i] - 'a' + 'A')
                                                             : prefix[i];
            at += 4;
        } else {
            *to++ = *at++;
        }
    }
    *to = 0;
    return SLV_OK;
}

slv_result slv_gl_texture_glsl(slv_gl_texture *texture, const slv_strategy *strategy,
                               uint32_t variant, const char **out) {
    const char *text = NULL;
    slv_result result = slvi_gl_texture_text(texture, strategy, variant, &text);
    *out = text;
    if (result || !texture->prefix)
        return result;
    char **named = &slvi_gl_texture_slot(texture, strategy)->named[variant];
    if (!*named)
        result = rename_all(&texture->env, text, texture->prefix, named);
    *out = result ? NULL : *named;
    return result;
}

slv_result slv_gl_texture_key(slv_gl_texture *texture, const slv_strategy *strategy,
                              uint32_t variant, uint64_t *out) {
    const char *text = NULL;
    slv_result result = slv_gl_texture_glsl(texture, strategy, variant, &text);
    *out = UINT64_C(0xcbf29ce484222325); /* FNV-1a */
    for (; !result && *text; text++)
        *out = (*out ^ (unsigned char)*text) * UINT64_C(0x100000001b3);
    return result;
}

const char *slv_gl_texture_extensions(const slv_gl_texture *texture) {
    static const char *const lines[2][2] = {
        {"", BALLOT_EXTENSION}, {HANDLES_EXTENSION, HANDLES_EXTENSION BALLOT_EXTENSION}};
    return lines[texture->params.binding == SLV_GL_BINDING_HANDLES][in_vectors(texture)];
}
