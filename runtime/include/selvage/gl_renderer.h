/* Draws a tessellated limit surface with a per-face texture. */
#ifndef SELVAGE_GL_RENDERER_H
#define SELVAGE_GL_RENDERER_H

#include <selvage/gl_texture.h>
#include <selvage/light.h>
#include <selvage/tessellation.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Zero means default. */
typedef struct slv_frame {
    slv_camera camera;
    uint32_t width, height; /* default 512 */
    uint32_t msaa; /* 1, 2, 4, 8; default 1. More than the driver has is SLV_ERROR_UNSUPPORTED */
    const slv_strategy *strategy; /* NULL means the texture's first */
    slv_shading shading;
    float ka, kd;         /* both zero means 0.2 and 0.8 */
    float background[4];  /* linear RGBA, colour multiplied by alpha */
    bool float_target;    /* render to 32-bit float instead of half */
    float level_bias;     /* added to the level of each lookup: footprints are 2^bias times as long.
                             Of textures; images do without it. */
    slv_alpha_mode alpha; /* but for SLV_ALPHA_IGNORE the colours of the texture must be multiplied
                             by alpha (slv_texture_premultiply) */
    const slv_light *light; /* of SLV_SHADE_IMAGE, which does not do without */
    uint64_t reserved[3];
} slv_frame;

typedef struct slv_gl_renderer slv_gl_renderer;

/* Tessellates as slv_tessellate does, by the mesh's own adjacency. `segments` is a power of two, 2
 * to 128; see slv_tessellation_for. */
SLV_NODISCARD SLV_API slv_result slv_gl_renderer_create(slv_gl *gl, const slv_env *env,
                                                        const slv_mesh *mesh,
                                                        const slv_surface *surface,
                                                        uint32_t segments, slv_gl_renderer **out);
/* Tessellates as slv_tessellate_with does. */
SLV_NODISCARD SLV_API slv_result slv_gl_renderer_create_with(slv_gl *gl, const slv_env *env,
                                                             const slv_mesh *mesh,
                                                             const slv_surface *surface,
                                                             const slv_tessellation_params *params,
                                                             slv_gl_renderer **out);
/* Divides a surface, that one or another, anew, for a camera that moved say, and keeps all else;
 * after a failure the renderer is as it was. */
SLV_NODISCARD SLV_API slv_result slv_gl_renderer_tessellate(slv_gl_renderer *renderer,
                                                            const slv_env *env,
                                                            const slv_mesh *mesh,
                                                            const slv_surface *surface,
                                                            const slv_tessellation_params *params);
SLV_API void slv_gl_renderer_destroy(slv_gl_renderer *renderer);
/* How many triangles a frame has. */
SLV_API uint64_t slv_gl_renderer_triangles(const slv_gl_renderer *renderer);

/* Draws one frame. `image` (may be NULL) receives linear RGBA with colour multiplied by alpha,
 * alpha the coverage of the pixel by the surface. To blend, fragments are sorted pixel by pixel, so
 * that triangles may come in any order, and each counts for the samples that it covers: one row of
 * more than 512 MiB of them, or of the driver's longest buffer, is SLV_ERROR_LIMIT. `seconds` (may
 * be NULL) receives the time of drawing and resolving, without reading back: by GL timer on
 * hardware, by the clock around glFinish in software. Changes GL state as slv_gl_wrap says. The
 * texture may be another each time. */
SLV_NODISCARD SLV_API slv_result slv_gl_renderer_draw(slv_gl_renderer *renderer, const slv_env *env,
                                                      slv_gl_texture *texture,
                                                      const slv_frame *frame, slv_image *image,
                                                      double *seconds);

/* The framebuffer object that holds the last frame, resolved, linear RGBA: for those who show it
 * without reading it back. 0 before the first; another after one of another size or kind. */
SLV_API uint32_t slv_gl_renderer_framebuffer(const slv_gl_renderer *renderer);

#ifdef __cplusplus
}
#endif

#endif
