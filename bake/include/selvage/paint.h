/* Painting on a surface: the surface as paint sees it, dabs on it, and which texels they cover.
 *
 * A dab is a function of the surface: the place of a texel's centre in, coverage out. It knows
 * nothing of texels until it is asked for those of a resolution, and nothing of colours ever. The
 * path of a dab is: slv_painter_cover makes patches (face, rectangle, coverage of each texel) of
 * it, and slv_painter_apply (canvas.h) puts a paint through them onto a canvas, which is whatever
 * keeps texels: a store, or a stack of layers with a history. */
#ifndef SELVAGE_PAINT_H
#define SELVAGE_PAINT_H

#include <selvage/camera.h>
#include <selvage/tessellation.h>
#include <selvage/texture.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The limit surface (or, with the bilinear scheme, the polygons) as flat triangles, as the renderer
 * draws it: what is painted is what is seen. A texel's centre lies on these triangles, and
 * distances are measured along them. Immutable; any number of threads may use it. */
typedef struct slv_paint_surface slv_paint_surface;

/* Zero means default. */
typedef struct slv_paint_surface_params {
    slv_scheme scheme;
    slv_boundary boundary;
    uint32_t segments; /* along an edge of a whole face, a power of two, 2 to 128; default: 8 to 2,
                          fewer the more faces there are */
    /* Moves it, as slv_tessellate_with does: what is picked is then what is seen so. Asked only
     * while the surface is made. NULL: nothing does. */
    const slv_displacement *displacement;
    uint64_t reserved[3];
} slv_paint_surface_params;

SLV_NODISCARD SLV_API slv_result slv_paint_surface_create(const slv_env *env, const slv_mesh *mesh,
                                                          const slv_paint_surface_params *params,
                                                          slv_paint_surface **out);
SLV_API void slv_paint_surface_destroy(slv_paint_surface *surface);
/* How its faces meet. Owned by the surface. */
SLV_API const slv_adjacency *slv_paint_surface_adjacency(const slv_paint_surface *surface);
SLV_API void slv_paint_surface_bounds(const slv_paint_surface *surface, float low[3],
                                      float high[3]);

/* Where a point lies and, both of length 1, how the surface faces and which way u grows there. Each
 * may be NULL. False for a face that there is not or that is a hole; (u,v) is clamped. */
SLV_API bool slv_paint_surface_at(const slv_paint_surface *surface, slv_surface_point point,
                                  float position[3], float normal[3], float u_axis[3]);
/* The mean area of a texel of a face at a resolution, in mesh units squared. */
SLV_API float slv_paint_surface_texel_area(const slv_paint_surface *surface, uint32_t face,
                                           slv_res res);

/* Walks straight ahead: from a point in a direction (projected into the surface there) for a
 * distance along the surface, straight on over every edge. `direction` becomes the one at the end.
 * Returns how far it came, less than `distance` at a boundary. */
SLV_API float slv_paint_surface_walk(const slv_paint_surface *surface, slv_surface_point *point,
                                     float direction[3], float distance);

typedef struct slv_paint_hit {
    slv_surface_point point;
    float position[3];
    float distance; /* in lengths of `direction` */
} slv_paint_hit;

/* The first point of the surface along a ray, from either side. False if there is none, or if the
 * ray is not finite. */
SLV_API bool slv_paint_surface_hit(const slv_paint_surface *surface, const float origin[3],
                                   const float direction[3], slv_paint_hit *out);
/* The ray through a place in a picture, in pixels from its upper left corner, which begins before
 * all of the surface that the camera sees; its direction has length 1 along the eye's -z. False for
 * a camera that is none. */
SLV_API bool slv_paint_surface_ray(const slv_paint_surface *surface, const slv_camera *camera,
                                   uint32_t width, uint32_t height, float x, float y,
                                   float origin[3], float direction[3]);

/* A disc measured along the surface from its middle. The profile is that of MyPaint's brushes: with
 * r the distance in radii, it falls linearly in r squared, from 1 in the middle to `hardness` at r
 * squared = hardness, and on to 0 at 1; the rim is at least as wide as a texel where the dab is.
 */
typedef struct slv_dab {
    slv_surface_point at;
    float radius;   /* in mesh units */
    float hardness; /* 0..1; less than 0.02 counts as that */
    float aspect;   /* 1.. : how much longer than wide; 0 is 1 */
    float angle;    /* degrees, counter-clockwise from `axis` to the long axis */
    float axis[3];  /* a direction, projected into the surface at `at`; zeros: where u grows */
    bool unfold;    /* slv_painter_unfolded will be asked */
    uint64_t reserved[4];
} slv_dab;

/* A disc of the picture: what the camera sees inside it, first along its ray and facing it, is
 * covered. In pixels from the upper left corner of a picture of width x height. */
typedef struct slv_screen_dab {
    slv_camera camera;
    uint32_t width, height;
    float x, y, radius;            /* pixels */
    float hardness, aspect, angle; /* as above, the axis being the picture's, to the right */
    uint64_t reserved[4];
} slv_screen_dab;

/* What a dab covers of one face: a rectangle of its texels, v-major, u fastest. */
typedef struct slv_patch {
    uint32_t face;
    slv_rect rect;
    const float *coverage; /* rect.width * rect.height; 0..1 */
    float texel_area;      /* mean, in mesh units squared */
} slv_patch;

/* By face, ascending, each once. Texels of no coverage may be among them. */
typedef struct slv_patches {
    uint32_t count;
    const slv_patch *list;
    uint64_t ntexels; /* in all rectangles */
} slv_patches;

/* What it takes to paint on a surface: memory that is used again from dab to dab, so that none is
 * allocated once the largest dab has been seen. For one thread at a time; work is shared out over
 * the threads of the environment that it was made with, and its bytes do not depend on them. */
typedef struct slv_painter slv_painter;

/* The surface must outlive it. */
SLV_NODISCARD SLV_API slv_result slv_painter_create(const slv_env *env,
                                                    const slv_paint_surface *surface,
                                                    slv_painter **out);
SLV_API void slv_painter_destroy(slv_painter *painter);
SLV_API const slv_paint_surface *slv_painter_get_surface(const slv_painter *painter);

/* Which texels a dab covers, of faces with the resolutions `res` (one for each face): every texel
 * in one patch at most, with the value of the dab at its centre. Texels that are wider than the dab
 * are covered by the share that it has of them. `*out` belongs to the painter and holds until its
 * next call. SLV_ERROR_ARGUMENT: a number that is not finite, a radius that is not more than 0, a
 * face that there is not. */
SLV_NODISCARD SLV_API slv_result slv_painter_cover(slv_painter *painter, const slv_res *res,
                                                   const slv_dab *dab, slv_patches *out);
SLV_NODISCARD SLV_API slv_result slv_painter_cover_screen(slv_painter *painter, const slv_res *res,
                                                          const slv_screen_dab *dab,
                                                          slv_patches *out);

/* Where a point lies as seen from the middle of the last dab, which was to `unfold`: in the plane
 * into which the surface around it is unfolded, in mesh units, (1,0) being its axis. False where
 * the dab has not been. */
SLV_API bool slv_painter_unfolded(const slv_painter *painter, slv_surface_point point,
                                  float out[2]);

/* Where `to` lies as seen from `from`: the vector in the plane into which the surface around `from`
 * is unfolded, (1,0) being `axis` there (as in slv_dab). `*reached` is false if it is further than
 * `limit`, or one of the two is no place. */
SLV_NODISCARD SLV_API slv_result slv_painter_locate(slv_painter *painter, slv_surface_point from,
                                                    const float axis[3], slv_surface_point to,
                                                    float limit, float out[2], bool *reached);

#ifdef __cplusplus
}
#endif

#endif
