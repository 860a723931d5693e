/* Filtered lookups on the CPU, across every seam. */
#ifndef SELVAGE_FILTER_H
#define SELVAGE_FILTER_H

#include <selvage/cache.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The filters of Ptex (Burley and Lacewell 2008, as its library computes them): they take the
 * bounding box of the footprint; on triangle meshes all of them but point are one elliptical
 * gaussian. Their values are those of the Ptex library to 1e-5 wherever it defines any.
 *
 * The last one is Selvage's own. It weighs texels by a gaussian over the ellipse that the
 * footprint's vectors span, wherever it lies (Greene and Heckbert 1986, "Creating raster omnimax
 * images from multiple perspective views using the elliptical weighted average filter"): its
 * standard deviation along an axis is half the axis, as in SLV_FILTER_GAUSSIAN, and 0.7 texels are
 * added. Ellipses are made no longer than two faces and no thinner than 1 to 16. What straight
 * lines from (u,v) reach counts, over as many edges as it takes, so that values are the same from
 * both sides of every edge, whatever the valence, the resolutions and the kinds of the faces. What
 * lies beyond a border does not count, or is black. Interpolation between resolutions and sharpness
 * do not concern it. */
typedef enum slv_filter {
    SLV_FILTER_POINT,
    SLV_FILTER_BILINEAR,
    SLV_FILTER_BOX,
    SLV_FILTER_GAUSSIAN,
    SLV_FILTER_BICUBIC, /* with a sharpness */
    SLV_FILTER_BSPLINE,
    SLV_FILTER_CATMULL_ROM,
    SLV_FILTER_MITCHELL,
    SLV_FILTER_ANISOTROPIC, /* an ellipse, without seams */
    SLV_FILTER_COUNT
} slv_filter;

/* point, bilinear, box, gaussian, bicubic, bspline, catmullrom, mitchell, anisotropic */
SLV_API const char *slv_filter_name(slv_filter filter);
/* False if no filter has that name. */
SLV_API bool slv_filter_from_name(const char *name, slv_filter *out);

/* How to filter. Zero means default, but for `filter`. */
typedef struct slv_filter_params {
    slv_filter filter;
    /* these three are ignored on triangle meshes */
    bool lerp;          /* interpolate between resolutions (the gaussian and cubic filters) */
    bool no_edge_blend; /* stay on the face: its border texels continue outside, or are black */
    float sharpness;    /* 0..1: how sharp SLV_FILTER_BICUBIC is */
    float width;        /* the footprint is scaled by this, 0 means 1 */
    float blur;         /* and widened by this, in units of the face */
    uint32_t first_channel, nchannels; /* which channels; 0 channels means all from the first on */
    uint64_t reserved[4];
} slv_filter_params;

/* Where to look: a position on a face and the footprint's two vectors, each a change of (u,v) from
 * one sample to the next, in units of the face. The vectors may be turned around; to the filters
 * that take a bounding box no sign matters. By the file's border mode for that axis, a position
 * outside of 0..1 is moved to the edge (clamp), wrapped into the face (periodic), or sees what lies
 * around the face, as far as one more face (black). SLV_FILTER_POINT moves it to the edge always,
 * SLV_FILTER_ANISOTROPIC where a neighbour lies across. On a triangle mesh u and v are barycentric
 * coordinates, the third is 1-u-v. */
typedef struct slv_lookup {
    slv_file_id file;
    uint32_t face;
    float u, v;
    float uw1, vw1, uw2, vw2;
} slv_lookup;

/* A ray, and how it changes from one sample of the picture to the next, along x and along y (Igehy
 * 1999, "Tracing ray differentials"). From the eye of a camera the origins do not change; a
 * direction need not have length 1. */
typedef struct slv_ray_differential {
    float origin[3], direction[3];
    float origin_dx[3], origin_dy[3];
    float direction_dx[3], direction_dy[3];
} slv_ray_differential;

/* Carries a ray on to where it meets a surface, `distance` lengths of its direction away: `origin`
 * becomes the point, and `origin_dx` and `origin_dy` how that moves on the plane there (equations
 * 10 to 12). The normal's length and side do not matter; a ray along the plane leaves it as it
 * were. */
SLV_API void slv_ray_differential_transfer(slv_ray_differential *ray, float distance,
                                           const float normal[3]);

/* The footprint, into uw1 to vw2 of a lookup, of a point that moves by `dx` and by `dy` in space
 * where the surface has the derivatives `du` and `dv` (slv_surface_evaluate gives them): the
 * changes of (u,v) that come nearest. Where the surface has no two directions, or something is not
 * finite, it is the whole face, and the answer false. */
SLV_API bool slv_footprint_from_differentials(const float dx[3], const float dy[3],
                                              const float du[3], const float dv[3],
                                              slv_lookup *lookup);

/* Looks texels up by one set of parameters. For one thread at a time; each thread has its own. The
 * cache must outlive it. */
typedef struct slv_sampler slv_sampler;

/* SLV_ERROR_ARGUMENT if the parameters are out of range: an unknown filter, sharpness outside 0..1,
 * width or blur negative or not finite. */
SLV_NODISCARD SLV_API slv_result slv_sampler_create(slv_cache *cache,
                                                    const slv_filter_params *params,
                                                    slv_sampler **out);
SLV_API void slv_sampler_destroy(slv_sampler *sampler);

/* How many floats a lookup in this file gives: the parameters' channels as far as the file has
 * them, or 0 for no such file. */
SLV_API uint32_t slv_sampler_channels(slv_sampler *sampler, slv_file_id file);

/* One lookup: integers as 0..1, half and float as themselves, in the file's own colour space, into
 * `out`, which has room for all requested channels; those that the file lacks are 0.
 *
 * SLV_ERROR_ARGUMENT for a file or face that does not exist, u or v not finite, or a footprint that
 * is not a number (an infinite one counts as one of the size of the face); other errors if the file
 * cannot be read. `out` is then zeros, as many as the parameters ask for, or as the file has if
 * that is all: none where the file is not known. Wrong arguments are not logged; what
 * cannot be read is, once. */
SLV_NODISCARD SLV_API slv_result slv_sample(slv_sampler *sampler, const slv_lookup *lookup,
                                            float *out);

/* `count` lookups in one go, quicker than one by one: the same numbers. `out` is count rows of
 * `stride` floats, at least the number of requested channels (all of the widest file, if that is
 * 0): SLV_ERROR_ARGUMENT for the lookups that have no room. What a row has beyond the file's
 * channels may be set to 0. Returns the error of the first lookup that failed; all others are done.
 * `results` (count, may be NULL) says how each one went. */
SLV_NODISCARD SLV_API slv_result slv_sample_batch(slv_sampler *sampler, const slv_lookup *lookups,
                                                  size_t count, float *out, size_t stride,
                                                  slv_result *results);

/* The same for lookups in no order: visits them by file and face. `workspace` has room for
 * slv_sample_workspace(count) bytes, aligned as what malloc gives. */
SLV_NODISCARD SLV_API slv_result slv_sample_sorted(slv_sampler *sampler, const slv_lookup *lookups,
                                                   size_t count, float *out, size_t stride,
                                                   slv_result *results, void *workspace);
SLV_API size_t slv_sample_workspace(size_t count);

#ifdef __cplusplus
}
#endif

#endif
