/* A texture on the GPU: what its strategies look up, and what each of them binds. */
#ifndef SLV_GL_TEXTURE_DATA_H
#define SLV_GL_TEXTURE_DATA_H

#include "gl/live/live.h"
#include "gl/store/handles.h"
#include "gl/store/reach.h"
#include "gl/store/store.h"

/* Units that a draw can take: 16 pools, each with its coverage. */
#define SLV_GL_MAX_UNITS (2 * SLV_GL_ROW_POOLS)

/* Whether zeros lie beyond a boundary. */
static inline bool slvi_gl_is_black(const slv_gl_texture_params *params) {
    return params->border_u == SLV_BORDER_BLACK || params->border_v == SLV_BORDER_BLACK;
}

/* One strategy of a texture. */
typedef struct slv_gl_slot {
    const slv_strategy *strategy;
    uint32_t store, reach; /* which of the texture's */
    GLuint sampler;
    bool split_coverage; /* coverage has arrays of its own */
    uint32_t handles_at; /* which storage binding has the table of handles; 0: arrays are bound */
    slv_gl_handles handles;
    char *lookups; /* its GLSL, without a variant's definitions */
    char *glsl[SLV_GL_MAX_VARIANTS];
    char *named[SLV_GL_MAX_VARIANTS]; /* the same with the host's prefix */
    GLuint lookup_programs[SLV_GL_MAX_VARIANTS];
} slv_gl_slot;

/* Strategies share the stores and reaches that they have in common. */
typedef struct slv_gl_reach_row {
    uint32_t store;
    slv_gl_reach_kind kind;
    slv_gl_reach reach;
} slv_gl_reach_row;

struct slv_gl_texture {
    slv_gl *gl;
    slv_env env; /* of whom made it: for what is made when it is first needed */
    uint64_t serial;
    slv_gl_texture_params params;
    uint32_t nfaces;
    slv_res *res; /* of each face */
    char *prefix; /* or NULL */
    uint64_t texel_bytes;
    bool constants;               /* faces of one value may have one texel */
    bool scaled;                  /* see slvi_gl_scale_down */
    slv_gl_live *live;            /* NULL where nothing follows changes */
    struct slv_gl_making *making; /* NULL once all is uploaded */
    slv_gl_store *stores;
    slv_gl_reach_row *reaches;
    slv_gl_slot *slots;
    uint32_t nstores, nreaches, nslots;
};

/* The strategies that are asked for: the caller's list, or `one`, filled with the default. */
const slv_strategy *const *slvi_gl_strategies(const slv_gl_texture_params *params,
                                              const slv_strategy *one[1], uint32_t *count);
/* The slot of a strategy, or for NULL the first; NULL if the texture was not made for it. */
slv_gl_slot *slvi_gl_texture_slot(const slv_gl_texture *texture, const slv_strategy *strategy);
/* The same with an error message. */
slv_result slvi_gl_texture_need(const slv_gl_texture *texture, const slv_env *env,
                                const slv_strategy *strategy, slv_gl_slot **out);
/* SLV_ERROR_ARGUMENT of one that is not uploaded yet, or slvi_gl_need_current. */
slv_result slvi_gl_texture_need_ready(const slv_gl_texture *texture, const slv_env *env);
/* Empty for a strategy that the texture was not made for. */
const slv_gl_batches *slvi_gl_texture_batches(const slv_gl_texture *texture,
                                              const slv_strategy *strategy);

/* slv_gl_texture_prepare; `at_once`: slv_gl_texture_create. */
slv_result slvi_gl_texture_prepare(slv_gl *gl, const slv_env *env, const slv_gl_given *given,
                                   const slv_gl_texture_params *params, bool at_once,
                                   slv_gl_texture **out);
/* All of a texture that follows changes anew, in the same place. */
slv_result slvi_gl_texture_renew(slv_gl_texture *texture);

/* Texture units that any batch of a strategy takes. */
uint32_t slvi_gl_slot_units(const slv_gl_texture *texture, const slv_gl_slot *slot);

/* The tables of handles that are not there, of batches as they are; and before arrays are deleted,
 * that there are none. */
slv_result slvi_gl_texture_take_handles(slv_gl_texture *texture);
void slvi_gl_texture_leave_handles(slv_gl_texture *texture);

/* Whether shaders take the taps of a long footprint themselves, where the sampler would not. */
bool slvi_gl_taps_in_shader(const slv_gl_texture *texture);
/* slv_gl_texture_glsl with the library's own names. */
slv_result slvi_gl_texture_text(slv_gl_texture *texture, const slv_strategy *strategy,
                                uint32_t variant, const char **out);
/* Reads the GLSL of a slot's strategy, and what follows it. */
slv_result slvi_gl_slot_read(const slv_gl_texture *texture, slv_gl_slot *slot);

#endif
