/* Strategies: how a lookup behaves at the edge of a face. A strategy says which form it looks up
 * (form.h), how that lies in array textures, what a draw has to bind, and the GLSL of its lookups.
 * Those of the library are a table; an application may describe one of its own, and pass it
 * wherever one is taken. */
#ifndef SELVAGE_GL_STRATEGY_H
#define SELVAGE_GL_STRATEGY_H

#include <selvage/form.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Where items go. */
typedef enum slv_gl_packing {
    SLV_GL_LAYERS = 0, /* a layer each, with OpenGL's levels */
    SLV_GL_PAGES       /* all levels of an item side by side in one layer, which it may share with
                          others ("lookup/packed.glsl" finds it): needed by forms with borders or
                          samples, possible for lookups that never leave a level */
} slv_gl_packing;
SLV_API const char *slv_gl_packing_name(slv_gl_packing packing); /* layers, pages */

/* What a lookup finds beyond a layer. */
typedef enum slv_gl_wrapping {
    SLV_GL_WRAP_CLAMP = 0, /* the outermost texels */
    SLV_GL_WRAP_ZERO,      /* zero, in the coverage too */
    SLV_GL_WRAP_MIRROR
} slv_gl_wrapping;
SLV_API const char *slv_gl_wrapping_name(slv_gl_wrapping wrapping); /* clamp, zero, mirror */

/* What a draw has to bind for its faces. */
typedef enum slv_gl_reach_kind {
    SLV_GL_REACH_OWN = 0,    /* the face's own layer */
    SLV_GL_REACH_NEIGHBOURS, /* those of the faces across its edges too; a table of links, and the
                                values of corners */
    SLV_GL_REACH_SQUARES,    /* the squares of htex, and the values of corners */
    SLV_GL_REACH_COUNT
} slv_gl_reach_kind;
SLV_API const char *slv_gl_reach_kind_name(slv_gl_reach_kind kind); /* own, neighbours, squares */

/* Zero means default; `name`, `form` and one of `file` and `glsl` are needed. */
typedef struct slv_strategy {
    const char *name;  /* one word, as on command lines; in names of files - is _ */
    const char *title; /* half a sentence, as in reports and help */
    const slv_form *(*form)(void);
    slv_gl_packing packing;
    slv_gl_wrapping wrap;
    slv_gl_reach_kind reach;
    bool coverage;   /* lookups divide by how much filter weight fell inside */
    bool own_taps;   /* lookups take the taps of a long footprint themselves on every driver */
    bool resampled;  /* inside a face, too, what is drawn is not the texture's own texels, filtered
                        as samplers do it: of a resampled form it is slightly blurred */
    bool comparison; /* of use in comparisons only: drawn where it is asked for by name */
    /* The GLSL: of a file in shaders/, or itself. A line #include "NAME" stands for a part of
     * shaders/, or a strategy's file with its parts; "lookup/interface.glsl" says what a strategy
     * finds and defines, and "lookup/footprint.glsl" has the rest of that. */
    const char *file, *glsl;
    uint64_t reserved[4];
} slv_strategy;

/* The strategies of the library. slv_strategy_at is NULL past the last, slv_strategy_find if there
 * is none of that name. */
SLV_API uint32_t slv_strategy_count(void);
SLV_API const slv_strategy *slv_strategy_at(uint32_t index);
SLV_API const slv_strategy *slv_strategy_find(const char *name);
/* Which to take where nobody has chosen one: exact in most cases, and for every texture. */
SLV_API const slv_strategy *slv_strategy_default(void);

#ifdef __cplusplus
}
#endif

#endif
