/* Blending by lists: surfaces with alpha, drawn in any order. */
#ifndef SLV_GL_DRAW_BLEND_H
#define SLV_GL_DRAW_BLEND_H

#include "gl/context/api.h"

/* Buffers that last from frame to frame. All zero is none yet. */
typedef struct slv_gl_blender {
    GLuint heads, fragments, program;
    uint64_t heads_bytes, room; /* room: fragments */
    uint32_t storage, msaa;     /* that the program is for */
} slv_gl_blender;

/* A picture to blend. `drawn` (multisampled, say) is what triangles cover, `shown` where the
 * picture goes. */
typedef struct slv_gl_blend {
    GLuint drawn, shown;
    uint32_t width, height, msaa, storage; /* storage: the first of two bindings of buffers */
    const float *background;
    GLuint array; /* any vertex array */
    /* Draws all triangles by programs of surface.frag with SURFACE_ALPHA 1, of which `room` is told
     * to each. */
    void (*draw)(void *user, const GLint room[4]);
    void *user;
} slv_gl_blend;

/* Draws the surface into lists of fragments, one for each pixel, and then each pixel, fragments
 * over those behind. Where buffers become too long the picture is made in bands; a row of pixels
 * that is still too much is SLV_ERROR_LIMIT. */
slv_result slvi_gl_blend(const slv_gl *gl, const slv_env *env, slv_gl_blender *blender,
                         const slv_gl_blend *blend);
void slvi_gl_blender_free(const slv_gl *gl, slv_gl_blender *blender);

#endif
