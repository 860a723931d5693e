/* How paint is laid: colours that differ from texel to texel, masks, and the symmetry of a mesh.
 *
 * All of it works on patches, after a dab has said what it covers and before anything is painted,
 * so that dabs of any kind and fills have it alike: a mask takes coverage away, an ink gives each
 * texel a colour of its own, and a symmetry puts both onto the faces of the other side, too. */
#ifndef SELVAGE_LAY_H
#define SELVAGE_LAY_H

#include <selvage/canvas.h>
#include <selvage/image.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum slv_ink_kind {
    SLV_INK_PLAIN = 0, /* the paint's colour */
    SLV_INK_GRADIENT,  /* from the paint's colour to another, along a line or around a place */
    SLV_INK_IMAGE,     /* an image that stands before the camera (a stencil), on what it sees */
    SLV_INK_STAMP,     /* an image that is as large as the dab, and lies where it does */
    SLV_INK_CLONE      /* what the canvas has around another place */
} slv_ink_kind;
SLV_API const char *slv_ink_kind_name(slv_ink_kind kind); /* plain, gradient, image, stamp, clone */

/* Images give colours as the texture stores them; where they have alpha, coverage is multiplied by
 * it, and it is 0 beside them. One of RGB on a canvas of one colour counts by its luminosity. Their
 * pixels are square: an image is never stretched. */
typedef struct slv_ink {
    slv_ink_kind kind;
    const slv_image *image; /* must outlive what is painted with it */
    /* SLV_INK_IMAGE: the picture that the camera takes, in its pixels the middle of the image and
     * its width, from the left upper corner; what is hidden, or faces away, is not painted */
    slv_camera camera;
    uint32_t width, height;
    float x, y, size;
    float angle; /* of images, degrees clockwise */
    /* SLV_INK_GRADIENT: places in mesh units. `radial`: by the distance from `from`, at `to` the
     * other colour. Beyond the two it goes on as it is there */
    float from[3], to[3];
    bool radial;
    float color[SLV_PAINT_CHANNELS];
    /* SLV_INK_CLONE: where the middle of the dab takes its colour from, and the direction there
     * that the dab's axis is here (zeros: where u grows) */
    slv_surface_point source;
    float axis[3];
    bool legible; /* stamps that are turned over are so once more from left to right, so that what
                     is written can be read, and upright, on the other side of a mirror too */
    bool flip;    /* stamps and clones are turned over along the dab's axis; mirrors do so */
    uint64_t reserved[4];
} slv_ink;

/* What takes paint: all of the conditions that are given. Zero means that there is none. */
typedef struct slv_mask {
    const uint8_t *faces; /* one byte for each; NULL: all */
    /* Where the surface faces by less than so many degrees from a direction; half of it a tenth
     * further. 0: everywhere */
    float towards[3], degrees;
    /* Where it faces the camera. NULL: everywhere */
    const slv_camera *facing;
    /* As much as a channel of another canvas says, whose faces may have other resolutions. NULL:
     * all. `inverse`: as much as it does not */
    const slv_canvas *canvas;
    uint32_t channel;
    bool inverse;
    uint64_t reserved[4];
} slv_mask;

/* Which face is another one's mirror image, found by how faces meet alone: places do not count.
 * Immutable. */
typedef struct slv_symmetry slv_symmetry;

/* From a pair of edges, which are each other's images, on over all faces that hang together: with
 * an edge on the middle line the pair is its two sides, `face` being the face across it. Faces
 * whose neighbourhoods do not correspond have no image. SLV_ERROR_ARGUMENT: an edge that there is
 * not, or faces of different kinds. `faces` (may be NULL) is how many have an image. */
SLV_NODISCARD SLV_API slv_result slv_symmetry_create(const slv_env *env,
                                                     const slv_adjacency *adjacency,
                                                     const uint32_t face[2], const unsigned edge[2],
                                                     slv_symmetry **out, uint32_t *faces);
SLV_API void slv_symmetry_destroy(slv_symmetry *symmetry);
/* The image of a point of a face; false if it has none. */
SLV_API bool slv_symmetry_apply(const slv_symmetry *symmetry, slv_surface_point *point);

/* Zero means that there is nothing of it. */
typedef struct slv_lay {
    slv_ink ink;
    slv_mask mask;
    const slv_symmetry *symmetry;
    float blur; /* more than 0: blurs, so wide in mesh units, instead of painting */
    uint64_t reserved[4];
} slv_lay;

/* Puts paint through the patches of this painter's last slv_painter_cover, slv_painter_cover_screen
 * or whole faces: masked, with an ink, and mirrored. `dab` or `screen` (one of them, or none) is
 * what they are of: stamps and clones take one. A mirrored face with another resolution takes for
 * each texel what its image's has there. SLV_ERROR_ARGUMENT: what the ink needs is missing. */
SLV_NODISCARD SLV_API slv_result slv_painter_lay(slv_painter *painter, const slv_canvas *canvas,
                                                 const slv_patches *patches, const slv_paint *paint,
                                                 const slv_lay *lay, const slv_dab *dab,
                                                 const slv_screen_dab *screen);

/* slv_painter_fill with all of it. `lay` may be NULL. */
SLV_NODISCARD SLV_API slv_result slv_painter_fill_with(slv_painter *painter,
                                                       const slv_canvas *canvas,
                                                       const uint8_t *selected,
                                                       const slv_paint *paint, const slv_lay *lay,
                                                       uint32_t *faces);

/* Fills what hangs together with a place, over edges of faces too, and has its colour: no channel
 * differs by more than `tolerance`. `texels` (may be NULL) is how many. */
SLV_NODISCARD SLV_API slv_result slv_painter_flood(slv_painter *painter, const slv_canvas *canvas,
                                                   slv_surface_point at, float tolerance,
                                                   const slv_paint *paint, const slv_lay *lay,
                                                   uint64_t *texels);

#ifdef __cplusplus
}
#endif

#endif
