/* Draws a tessellated limit surface with a per-face texture. */
#ifndef SELVAGE_GL_RENDERER_H
#define SELVAGE_GL_RENDERER_H

#include <selvage/gl_texture.h>
#include <selvage/image.h>
#include <selvage/surface.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A right-handed eye that looks down its own -z. Matrices are row-major and act on column vectors.
 */
typedef struct slv_camera {
    float world_to_camera[16];
    bool perspective;
    /* left, right, bottom, top: on the plane at distance 1 with perspective, else in eye units */
    float window[4];
} slv_camera;

/* Frames a box from a direction: azimuth in degrees from +z towards +x around the y axis, elevation
 * in degrees above the horizon, vertical field of view in degrees (0 means orthographic), aspect =
 * width / height. */
SLV_API slv_camera slv_camera_orbit(const float bounds_min[3], const float bounds_max[3],
                                    float azimuth, float elevation, float fov, float aspect);

typedef enum slv_shading {
    SLV_SHADE_HEADLIGHT = 0, /* c * (kd * max(dot(n, -i), 0) + ka), i from the eye to the surface */
    SLV_SHADE_HEADLIGHT_ABS, /* c * kd * clamp(abs(dot(n, i)) + ka, 0, 1) */
    SLV_SHADE_UNLIT,         /* c */
    SLV_SHADE_FACES,         /* a colour per face, lit: where the faces are */
    SLV_SHADE_LEVELS         /* the level that a lookup uses, from 0 (red) to coarse (blue) */
} slv_shading;

SLV_API bool slv_shading_from_name(const char *name, slv_shading *out);

/* Zero means default. */
typedef struct slv_frame {
    slv_camera camera;
    uint32_t width, height; /* default 512 */
    uint32_t msaa; /* 1, 2, 4, 8; default 1. More than the driver has is SLV_ERROR_UNSUPPORTED */
    slv_strategy strategy;
    slv_shading shading;
    float ka, kd;        /* both zero means 0.2 and 0.8 */
    float background[4]; /* linear RGBA, colour multiplied by alpha */
    bool float_target;   /* render to 32-bit float instead of half */
} slv_frame;

typedef struct slv_gl_renderer slv_gl_renderer;

/* How many segments a face edge should have, a power of two from 2 to 64: at most about 3 pixels
 * each on the largest face of the mesh seen by `camera` at this size, but no more than two cells
 * for each pixel of the picture in all. */
SLV_API uint32_t slv_tessellation_for(const slv_mesh *mesh, const slv_camera *camera,
                                      uint32_t width, uint32_t height);

/* Tessellates every face into segments * segments quads (sub-faces into half as many each way, so
 * that vertices meet), with the vertices of edges that the mesh's faces share made identical: no
 * cracks. Holes are left out. `segments` is a power of two, 2 to 128. */
SLV_API slv_result slv_gl_renderer_create(slv_gl *gl, const slv_env *env, const slv_mesh *mesh,
                                          const slv_surface *surface, uint32_t segments,
                                          slv_gl_renderer **out);
SLV_API void slv_gl_renderer_destroy(slv_gl_renderer *renderer);

/* Draws one frame. `image` (may be NULL) receives linear RGBA with colour multiplied by alpha,
 * alpha the coverage of the pixel by the surface (an alpha channel of the texture is not looked
 * at). `seconds` (may be NULL) receives the time of drawing and resolving, without reading back: by
 * GL timer on hardware, by the clock around glFinish in software. Changes GL state as slv_gl_wrap
 * says. The texture may be another each time. */
SLV_API slv_result slv_gl_renderer_draw(slv_gl_renderer *renderer, const slv_env *env,
                                        slv_gl_texture *texture, const slv_frame *frame,
                                        slv_image *image, double *seconds);

#ifdef __cplusplus
}
#endif

#endif
