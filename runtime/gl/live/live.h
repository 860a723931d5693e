/* What a texture on the GPU is made from, which one that follows its texels keeps. */
#ifndef SLV_GL_LIVE_H
#define SLV_GL_LIVE_H

#include "base/parallel.h"
#include "gl/store/marks.h"
#include "gl/store/upload.h"

/* What a texture is made of. */
typedef struct slv_gl_given {
    const slv_texture *texture;
    const slv_adjacency *adjacency;
    bool resident; /* faces come and go: what their neighbours take must not change with it */
    bool decoded;  /* halves: the light of encoded 8-bit colours, which it is to be on the GPU */
} slv_gl_given;

typedef struct slv_gl_live {
    slv_gl_source source; /* refers to what follows */
    slv_parallel_log *log;
    const slv_texture *texture; /* the host's */
    bool decoded;
    slv_texture *copy;         /* its light, where it is encoded or its values are too large */
    slv_levels *levels, *even; /* even: NULL unless asked for */
    uint8_t *srgb;             /* see slvi_gl_srgb_fill; NULL where nothing is encoded */
    bool scaled;               /* see slvi_gl_scale_down */
    uint64_t room;             /* bytes by which arrays may grow in an update */
    uint64_t seen;             /* the version that the GPU has */
    bool half_done;            /* an update failed midway: the next one makes all anew */
    slv_form_change *changes;
    uint32_t nchanges, capacity;
    void *around;       /* made of slv_form_borders: which faces depend on which */
    slv_gl_marks faces; /* that depend on those changed */
    slv_form_room room_of_forms;
    slv_gl_staging staging;
} slv_gl_live;

/* The levels of a texture's light, and all else that uploading takes. `env` outlives it, as does
 * `texture` where the levels are read. */
slv_result slvi_gl_live_create(slv_gl *gl, const slv_env *env, const slv_gl_given *given,
                               const slv_gl_texture_params *params, slvi_steps *steps,
                               slv_gl_live **out);
void slvi_gl_live_destroy(slv_gl_live *live);

/* Brings the levels up to date; `changes` then lists what was changed since `seen`. *renew says
 * that all of the texture has to be uploaded anew, and the levels are not up to date. */
slv_result slvi_gl_live_follow(slv_gl_live *live, const slv_env *env, bool *renew);

#endif
