/* The GLSL of a strategy's lookups, with the definitions of a variant before it. */
#include "base/log.h"
#include "base/memory.h"
#include "gl/store/scale.h"
#include "gl/store/texture.h"

#include <stdio.h>
#include <string.h>

/* Software samplers take an anisotropic footprint from neighbouring fragments' coordinates and
 * ignore explicit derivatives; of an isotropic one they only estimate the length. */
bool slvi_gl_taps_in_shader(const slv_gl *gl) {
    return gl->info.software;
}

static bool in_vectors(const slv_gl_texture *texture) {
    slv_gl_branching branching = texture->params.branching;
    return texture->gl->ballot &&
           (branching == SLV_GL_BRANCHING_AUTO ? texture->gl->info.software
                                               : branching == SLV_GL_BRANCHING_VECTORS);
}

slv_result slvi_gl_slot_read(const slv_env *env, slv_gl_slot *slot) {
    const slv_strategy *strategy = slot->strategy;
    return slvi_gl_shader_with_parts(env, strategy->file ? strategy->file : strategy->name,
                                     strategy->glsl, &slot->lookups);
}

/* How many faces the rows that a draw is shown belong to; 0 means all. */
static uint32_t chunk_of(const slv_gl_texture *texture, const slv_gl_slot *slot) {
    slv_gl_chunks chunks = texture->reaches[slot->reach].reach.chunks;
    return chunks.count > 1 ? 1u << chunks.log2 : 0;
}

static slv_result write_variant(const slv_gl_texture *texture, const slv_gl_slot *slot,
                                uint32_t variant, char **out) {
    const slv_gl_texture_params *params = &texture->params;
    size_t size = strlen(slot->lookups) + 512;
    slv_result result = slvi_alloc_plain(&texture->env, "text of a strategy", size, 1, out);
    if (result)
        return result;
    /* alpha is a texel's own only where there are four channels */
    float scale = texture->scaled ? SLV_GL_SCALE : 1;
    snprintf(*out, size,
             "#define SLV_POOLS %u\n#define SLV_SUBFACES %u\n"
             "#define SLV_SPLIT_COVERAGE %d\n#define SLV_ANISOTROPY %u\n#define SLV_BORDER %u\n"
             "#define SLV_TAPS %d\n#define SLV_VECTORS %d\n#define SLV_FIRST_UNIT %d\n#define "
             "SLV_FIRST_STORAGE %d\n#define SLV_CHUNK %u\n#define SLV_SCALED %d\n#define SLV_SCALE "
             "vec4(vec3(%.1f), "
             "%.1f)\n%s\n",
             slv_gl_variant_pools(variant), variant & 1, slot->split_coverage, params->anisotropy,
             params->border, slvi_gl_taps_in_shader(texture->gl), in_vectors(texture),
             SLV_GL_FIRST_UNIT, SLV_GL_FIRST_STORAGE, chunk_of(texture, slot), texture->scaled,
             (double)scale, (double)(params->nchannels == 4 ? scale : 1), slot->lookups);
    return SLV_OK;
}

slv_result slv_gl_texture_glsl(slv_gl_texture *texture, const slv_strategy *strategy,
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
