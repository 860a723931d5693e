/* A picture that owes nothing to any strategy: rays cast through every pixel at the tessellated
 * limit surface, the texture taken as a continuous function where they land, and the result
 * weighted by a pixel filter. No level, footprint or lookup of the GPU is involved; with samples
 * without end it is the integral of the shaded texture under the filter.
 *
 * For the same mesh, segments, camera and shading it shows what slv_gl_renderer_draw shows, pixel
 * for pixel. Rays are cast by Embree. */
#ifndef SELVAGE_REFERENCE_H
#define SELVAGE_REFERENCE_H

#include <selvage/light.h>
#include <selvage/source.h>
#include <selvage/tessellation.h>
#include <selvage/texture.h>
#include <selvage/uv_images.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Zero means default. */
typedef struct slv_reference_params {
    uint32_t segments;      /* as slv_tessellate takes them; default 32 */
    uint32_t first_channel; /* of the texture, shown as red */
    uint32_t nchannels;     /* 1 (shown as grey) to 4; 0 means as many as there are, up to 4 */
    slv_texture_encoding encoding; /* of the colours, which become light before they are
                                      interpolated; default: as slv_texture_get_encoding has it */
    const slv_tessellation_params *tessellation; /* in place of `segments`, if it is not NULL */
    const slv_uv_images *images; /* NULL, or what is shown in place of the texture, which is NULL
                                    then: it is looked at as long as the reference is there */
    slv_border_mode border_u, border_v; /* as slv_gl_texture_params has them */
    slv_alpha_mode alpha;        /* as slv_frame has it: rays go on through what is not opaque */
    slv_edge_filter edge_filter; /* as slv_gl_texture_params has it */
    uint64_t reserved[1];
} slv_reference_params;

/* A surface and its texture, ready for rays. Immutable; any number of threads may use it. */
typedef struct slv_reference slv_reference;

/* Copies what it needs: every texel of level 0 as a float for each shown channel (alpha if it is
 * looked at), with a border of one texel (slv_border_build), and the triangles. `adjacency`, the
 * texture's, must have as many faces as the mesh, the surface and the texture. */
SLV_NODISCARD SLV_API slv_result slv_reference_create(const slv_env *env, const slv_mesh *mesh,
                                                      const slv_surface *surface,
                                                      const slv_texture *texture,
                                                      const slv_adjacency *adjacency,
                                                      const slv_reference_params *params,
                                                      slv_reference **out);
/* Divides the surface anew, for another camera say, and keeps the texture; after a failure the
 * reference is as it was. Nobody else may use it meanwhile. */
SLV_NODISCARD SLV_API slv_result slv_reference_tessellate(slv_reference *reference,
                                                          const slv_env *env, const slv_mesh *mesh,
                                                          const slv_surface *surface,
                                                          const slv_tessellation_params *params);
SLV_API void slv_reference_destroy(slv_reference *reference);

/* The texture as a function: texels of level 0, bilinear between their centres, with the borders of
 * border.h. Continuous everywhere: on an edge a face of shorter texels follows its neighbour
 * between its own texel centres too, and all faces around a vertex have one value there. Writes
 * RGB, three floats a point. A face id out of range is SLV_ERROR_ARGUMENT; (u,v) is clamped to the
 * face. */
SLV_NODISCARD SLV_API slv_result slv_reference_lookup(const slv_reference *reference, size_t count,
                                                      const slv_surface_point *points, float *rgb);

/* How much the surroundings of a pixel's centre count. */
typedef enum slv_pixel_filter {
    SLV_PIXEL_BOX = 0, /* the pixel's own square, evenly: what multisampling resolves to */
    SLV_PIXEL_MITCHELL /* Mitchell and Netravali 1988 with B = C = 1/3, two pixels to each side; its
                          negative lobes may take values out of range beside strong edges */
} slv_pixel_filter;

SLV_API const char *slv_pixel_filter_name(slv_pixel_filter filter); /* box, mitchell */
SLV_API bool slv_pixel_filter_from_name(const char *name, slv_pixel_filter *out);
/* How much counts what is `x` pixels away from the centre along an axis; the integral is 1. */
SLV_API double slv_pixel_filter_weight(slv_pixel_filter filter, double x);

/* Zero means default. Camera, shading, light, ka, kd and background are those of slv_frame. */
typedef struct slv_reference_frame {
    slv_camera camera;
    uint32_t width, height; /* default 512 */
    slv_shading shading; /* SLV_SHADE_LEVELS, which knows no reference, is SLV_ERROR_UNSUPPORTED */
    float ka, kd;        /* both zero means 0.2 and 0.8 */
    float background[4]; /* linear RGBA, colour multiplied by alpha */
    slv_pixel_filter filter;
    uint32_t samples; /* per pixel, to SLV_REFERENCE_MAX_SAMPLES; default 64; powers of two converge
                         best */
    uint32_t seed;    /* another one makes errors that have nothing to do with this one's */
    slv_progress progress; /* tiles */
    const slv_light *light;
    uint64_t reserved[3];
} slv_reference_frame;

#define SLV_REFERENCE_MAX_SAMPLES (UINT32_C(1) << 20)

/* What a picture is worth. Errors are NaN with one sample. */
typedef struct slv_reference_stats {
    uint64_t samples;  /* in all */
    double error;      /* the RMS of the estimated error, over all pixels and RGB */
    double worst;      /* the largest of a pixel */
    uint64_t ncovered; /* pixels at least half covered by the surface */
    uint64_t reserved[4];
} slv_reference_stats;

/* Renders linear RGBA with colour multiplied by alpha, alpha the coverage of the pixel. The samples
 * of a pixel are two Owen-scrambled Sobol sequences of half their number each, the halves
 * independent of each other and of those of any other pixel; half the difference of the two is the
 * estimate of the pixel's error. `error` (may be NULL) receives its RMS over RGB as an image of one
 * channel; with one sample that is zero. `stats` may be NULL. On env->threads threads; the same
 * bytes with any number of them. */
SLV_NODISCARD SLV_API slv_result slv_reference_render(const slv_reference *reference,
                                                      const slv_env *env,
                                                      const slv_reference_frame *frame,
                                                      slv_image *image, slv_image *error,
                                                      slv_reference_stats *stats);

/* What the ray through a pixel's centre meets. Derivatives are by one pixel to the right [0] and
 * one down [1], along the plane of the triangle that was hit: the footprint of the pixel is the
 * parallelogram of the two. */
typedef struct slv_reference_hit {
    int32_t face; /* -1: nothing is hit, and the rest is zero */
    float u, v;
    float du[2], dv[2];
    float depth, ddepth[2]; /* distance along the eye's -z; with an orthographic camera from the
                               nearest depth that is drawn */
} slv_reference_hit;

/* Casts one ray through the centre of each of width * height pixels, row 0 at the top. On
 * env->threads threads; the same bytes with any number of them. */
SLV_NODISCARD SLV_API slv_result slv_reference_trace(const slv_reference *reference,
                                                     const slv_env *env, const slv_camera *camera,
                                                     uint32_t width, uint32_t height,
                                                     slv_reference_hit *hits);

#ifdef __cplusplus
}
#endif

#endif
