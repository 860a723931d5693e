/* What a texture on the GPU is made from. */
#ifndef SLV_GL_SOURCE_H
#define SLV_GL_SOURCE_H

#include "base/progress.h"
#include "gl/context/api.h"

#include <selvage/gl_texture.h>

/* Buffers that are still to be made, since there is no context at hand. */
typedef struct slv_gl_table {
    const char *what;
    void *data;
    uint64_t bytes;
    GLuint *out;
} slv_gl_table;

typedef struct slv_gl_tables {
    slv_gl_table *tables;
    uint32_t count, capacity;
} slv_gl_tables;

typedef struct slv_gl_source {
    const slv_env *env;
    slv_env shared; /* the same for what runs on threads: logs one at a time */
    slv_gl *gl;
    slv_type type;            /* of the texture */
    const slv_levels *levels; /* of its colours, decoded */
    const slv_levels *even;   /* likewise, even ones: NULL unless asked for */
    const slv_texture *light; /* what the levels are of: faces of one value take one texel of forms
                                 that have faces as they are. NULL: they take as many as others */
    bool bare_only;           /* likewise, but for the bare form */
    const uint8_t *srgb;      /* NULL, or what encodes them again: 8-bit colours */
    const slv_adjacency *adjacency;
    slv_gl_texture_params params; /* defaults filled in */
    uint64_t array_bytes;         /* of the least array that is made when items move; 0: some */
    slvi_steps *steps;            /* as many as there are faces for each store */
    slv_gl_tables *put_off;       /* NULL: buffers are made at once */
} slv_gl_source;

/* Whether all texels of a face are one. */
static inline bool slvi_gl_is_constant(const slv_gl_source *source, uint32_t face) {
    return source->light && slv_texture_is_constant(source->light, face);
}

/* Faces in breadth-first order over the adjacency, so that faces which meet get layers close
 * together. `order` has room for all. */
slv_result slvi_gl_face_order(const slv_gl_source *source, uint32_t *order);

#endif
