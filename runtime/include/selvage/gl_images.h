/* Images on the GPU that a mesh's texture coordinates look up: what the renderer draws in place of
 * a per-face texture. */
#ifndef SELVAGE_GL_IMAGES_H
#define SELVAGE_GL_IMAGES_H

#include <selvage/gl_renderer.h>
#include <selvage/uv_images.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Lives on the thread of its context. */
typedef struct slv_gl_images slv_gl_images;

/* Uploads all of them, with levels of their own that are means over areas, whatever their sizes:
 * 8 bytes a pixel and a third, 16 of `wide` and 4 of `narrow` ones. Lookups are bilinear and
 * trilinear, with up to `anisotropy` (1 to 16) taps of the sampler; they stop at the edge of a
 * tile. An image larger than the driver takes is SLV_ERROR_LIMIT. `images` is not kept.
 * Leaves GL state as it was. */
SLV_NODISCARD SLV_API slv_result slv_gl_images_create(slv_gl *gl, const slv_env *env,
                                                      const slv_uv_images *images,
                                                      uint32_t anisotropy, slv_gl_images **out);
SLV_API void slv_gl_images_destroy(slv_gl_images *images);
SLV_API uint64_t slv_gl_images_bytes(const slv_gl_images *images); /* on the GPU */

/* As slv_gl_renderer_draw, with images; `strategy` of the frame is not looked at. */
SLV_NODISCARD SLV_API slv_result slv_gl_renderer_draw_images(slv_gl_renderer *renderer,
                                                             const slv_env *env,
                                                             slv_gl_images *images,
                                                             const slv_frame *frame,
                                                             slv_image *image, double *seconds);

#ifdef __cplusplus
}
#endif

#endif
