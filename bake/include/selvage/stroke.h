/* Strokes: samples of a pen in, dabs on a surface out. */
#ifndef SELVAGE_STROKE_H
#define SELVAGE_STROKE_H

#include <selvage/brush.h>
#include <selvage/lay.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Where the pen is and what it does there. */
typedef struct slv_stroke_sample {
    slv_surface_point at; /* on the surface, or else */
    float x, y;           /* in the picture, pixels from its upper left corner */
    float pressure;       /* 0..1 */
    float tilt_x, tilt_y; /* -1..1 */
    double time;          /* seconds, from any moment on; never less than before */
} slv_stroke_sample;

/* What a radius is counted in: mesh units; pixels of the picture; texels of the face where a dab
 * is, along their longer side. */
typedef enum slv_size_unit { SLV_SIZE_WORLD = 0, SLV_SIZE_PIXELS, SLV_SIZE_TEXELS } slv_size_unit;
SLV_API const char *slv_size_unit_name(slv_size_unit unit); /* world, pixels, texels */
SLV_API bool slv_size_unit_from_name(const char *name, slv_size_unit *out);

/* A plane that paints on its other side too. */
typedef struct slv_mirror {
    float point[3], normal[3]; /* the normal of any length */
} slv_mirror;
enum { SLV_MIRRORS = 3 };

/* A dab that was made of a stroke, with all that it takes to make it again. */
typedef struct slv_stroke_dab {
    bool on_screen;
    float blur;  /* more than 0: blurs, so wide in mesh units, by the paint's opacity */
    slv_dab dab; /* unless on_screen */
    slv_screen_dab screen;
    slv_paint paint;
    bool laid; /* `lay` counts, but for its blur */
    slv_lay lay;
    slv_camera facing; /* room for the mask's camera where it is mirrored */
    uint64_t reserved[4];
} slv_stroke_dab;

/* Zero means default, but for brush, paint and radius. */
typedef struct slv_stroke_params {
    const slv_brush *brush; /* outlives the stroke */
    slv_paint paint;        /* its colour; its opacity times that of the brush's dabs */
    float radius;           /* 0: that of the brush, in pixels */
    slv_size_unit unit;
    /* Samples are places in a picture of width x height that this camera takes; else on the
     * surface. */
    bool in_picture;
    slv_camera camera;
    uint32_t width, height;
    bool project; /* of a picture: dabs are discs of it (slv_screen_dab), not of the surface */
    /* More than 0: dabs blur what is there, by so many radii, and the paint's colour does not
     * count. Not with `project`. */
    float blur;
    /* Inks, masks and symmetry, which all that the stroke leaves has; copied, and what it points to
     * outlives the stroke. NULL: none. Its blur does not count. A stamp is as large as a dab's
     * square; the source of a clone is for the first dab, and goes along with the others. */
    const slv_lay *lay;
    /* nmirrors of them, at most SLV_MIRRORS; copied. A round dab that is its own mirror is one. */
    const slv_mirror *mirrors;
    uint32_t nmirrors;
    /* May be NULL. Is told each dab before it is applied; a failure ends the stroke. */
    slv_result (*each)(void *user, const slv_stroke_dab *dab);
    void *user;
    uint64_t reserved[5];
} slv_stroke_params;

typedef struct slv_stroke_stats {
    uint64_t dabs;   /* that covered something */
    uint64_t missed; /* that found no surface */
    uint64_t texels; /* in the rectangles of all dabs */
    uint64_t reserved[4];
} slv_stroke_stats;

/* From pen down to pen up. The path runs through the samples as a smooth curve, whose points do not
 * depend on how often the pen was asked; dabs are placed along it, by a round brush at its spacing,
 * by one of MyPaint as libmypaint does. The last two samples' stretch waits for the next sample, or
 * the end.
 *
 * libmypaint works on one thread of a process at a time: others wait. */
typedef struct slv_stroke slv_stroke;

/* `canvas` is copied; the painter must outlive the stroke, and is used by nobody else meanwhile.
 * SLV_ERROR_ARGUMENT: pixels without a picture, and numbers that are not finite. */
SLV_NODISCARD SLV_API slv_result slv_stroke_begin(slv_painter *painter, const slv_canvas *canvas,
                                                  const slv_stroke_params *params,
                                                  slv_stroke **out);
/* Samples of the surface that cannot be reached from the one before begin the path anew there.
 * SLV_ERROR_ARGUMENT for one that is not finite or lies on no face; it is left out. */
SLV_NODISCARD SLV_API slv_result slv_stroke_add(slv_stroke *stroke,
                                                const slv_stroke_sample *samples, uint32_t count);
/* Paints what waits; a stroke that has left no dab leaves one where it began. `stats` may be NULL.
 */
SLV_NODISCARD SLV_API slv_result slv_stroke_end(slv_stroke *stroke, slv_stroke_stats *stats);
SLV_API void slv_stroke_destroy(slv_stroke *stroke);

/* Makes a dab again. `patches` (may be NULL) is what it covered. */
SLV_NODISCARD SLV_API slv_result slv_stroke_dab_apply(slv_painter *painter,
                                                      const slv_canvas *canvas,
                                                      const slv_stroke_dab *dab,
                                                      slv_patches *patches);

#ifdef __cplusplus
}
#endif

#endif
