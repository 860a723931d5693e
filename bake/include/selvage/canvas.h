/* What paint is put on, and how: blend modes over any channels of any type.
 *
 * A canvas is a small interface, so that a store in memory, a layer of a document and whatever else
 * keeps texels can be painted on alike. */
#ifndef SELVAGE_CANVAS_H
#define SELVAGE_CANVAS_H

#include <selvage/blend.h>
#include <selvage/paint.h>
#include <selvage/source.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct slv_canvas_desc {
    uint32_t nfaces;
    uint32_t nchannels;
    int32_t alpha_channel; /* SLV_NO_ALPHA or an index; colours are not multiplied by it */
    const slv_res *res;    /* nfaces. Owned by the canvas, as it is until the next change */
} slv_canvas_desc;

/* `begin` is called once for a dab or fill, on the caller's thread, before any of its texels is
 * read: there a canvas makes room, keeps old blocks for its history, and may fail, which leaves
 * everything as it was. `read` and `write` then have rectangles of the faces that it was told, from
 * several threads at once but of different faces. `write` must not fail after a `begin` that did
 * not. */
typedef struct slv_canvas_fns {
    slv_result (*describe)(void *user, slv_canvas_desc *out);
    slv_result (*begin)(void *user, const slv_patches *patches); /* may be NULL */
    /* width x height texels as floats, tightly packed: integers as 0..1, as the texture stores
     * them */
    slv_result (*read)(void *user, uint32_t face, slv_rect rect, float *out);
    slv_result (*write)(void *user, uint32_t face, slv_rect rect, const float *texels);
    uint64_t reserved[4];
} slv_canvas_fns;

/* Copied as it is; `fns` outlives it. */
typedef struct slv_canvas {
    const slv_canvas_fns *fns;
    void *user;
} slv_canvas;

/* Paints right on a store: values are rounded to its type at each dab, and nothing can be taken
 * back. The texture must outlive it. */
SLV_API slv_canvas slv_texture_as_canvas(slv_texture *texture);

enum { SLV_PAINT_CHANNELS = 8 };

/* What goes through the patches. Zero means default, but for the colour and opacity. */
typedef struct slv_paint {
    float color[SLV_PAINT_CHANNELS];   /* of the channels from first_channel on; where the alpha
                                          channel is among them, its value counts with
                                          SLV_BLEND_REPLACE only */
    uint32_t first_channel, nchannels; /* 0 channels: all from the first on, as many as fit */
    float opacity;                     /* 0..1, times the coverage */
    slv_blend blend;
    bool lock_alpha; /* colour only: alpha stays */
    /* Takes alpha away, down to `1 - opacity` of it; without an alpha channel colours go to 0. The
     * colour does not count. */
    bool erase;
    uint64_t reserved[4];
} slv_paint;

/* Puts a paint on a canvas, on the painter's threads. Patches of this painter, or others. Either
 * all of it is done or (SLV_ERROR_...) nothing. */
SLV_NODISCARD SLV_API slv_result slv_painter_apply(slv_painter *painter, const slv_canvas *canvas,
                                                   const slv_patches *patches,
                                                   const slv_paint *paint);
/* The mean of a canvas under patches, weighed by coverage and by area, colours by alpha too: what a
 * brush picks up. `out` has room for the canvas's channels; zeros where nothing is covered, which
 * returns false in `*any` (may be NULL). */
SLV_NODISCARD SLV_API slv_result slv_painter_mean(slv_painter *painter, const slv_canvas *canvas,
                                                  const slv_patches *patches, float *out,
                                                  bool *any);
/* Blurs a canvas under patches: each texel goes towards the mean of what lies around it, across
 * seams, by a gaussian as wide as `width` mesh units (SLV_FILTER_ANISOTROPIC of filter.h), as far
 * as `opacity` times the coverage says. All channels. */
SLV_NODISCARD SLV_API slv_result slv_painter_blur(slv_painter *painter, const slv_canvas *canvas,
                                                  const slv_patches *patches, float width,
                                                  float opacity);

/* Which faces a fill takes, from one of them on. */
typedef enum slv_select {
    SLV_SELECT_FACE = 0,  /* that face; of an n-gon, that sub-face */
    SLV_SELECT_CONNECTED, /* all that hang together with it over edges */
    SLV_SELECT_ANGLE      /* the same, but over edges only where the surface bends by less */
} slv_select;
SLV_API const char *slv_select_name(slv_select select); /* face, connected, angle */
SLV_API bool slv_select_from_name(const char *name, slv_select *out);

/* Sets selected[f] (one byte for each face) to 1 for the faces that are taken, and leaves others.
 * `degrees` is for SLV_SELECT_ANGLE. */
SLV_NODISCARD SLV_API slv_result slv_painter_select(slv_painter *painter, uint32_t face,
                                                    slv_select select, float degrees,
                                                    uint8_t *selected);
/* Puts a paint all over the selected faces, a batch of them after the other, each of which is done
 * or not: `begin` is called for each batch. `faces` (may be NULL) is how many there were. */
SLV_NODISCARD SLV_API slv_result slv_painter_fill(slv_painter *painter, const slv_canvas *canvas,
                                                  const uint8_t *selected, const slv_paint *paint,
                                                  uint32_t *faces);

/* How well a canvas holds together. At each texel centre along each shared edge (of the side that
 * has more of them) both sides say what is on the edge: something between their outermost
 * texels there and what these and the ones behind them lead to. Where these two ranges overlap the
 * sides agree; else they differ by what is between. Where there is alpha, colours count by as much
 * of them as is there: what nobody sees is no seam. */
typedef struct slv_seam_certificate {
    double largest, mean; /* of all places and channels */
    uint64_t places;      /* along edges */
    int32_t face;         /* where the largest is; -1: the sides agree everywhere */
    uint8_t edge;
    uint32_t channel;
    float t; /* along the edge, counter-clockwise */
    uint64_t reserved[4];
} slv_seam_certificate;
SLV_NODISCARD SLV_API slv_result slv_seam_certify(const slv_env *env, const slv_canvas *canvas,
                                                  const slv_adjacency *adjacency,
                                                  slv_seam_certificate *out);
/* How well two canvases of one mesh fit to each other, as layers (slv_document_canvas) or textures
 * of two sessions: of each shared edge one side as the first has it, the other as the second, and
 * the other way round. Their faces may have other resolutions; channels and alpha are the same. */
SLV_NODISCARD SLV_API slv_result slv_seam_certify_two(const slv_env *env, const slv_canvas *a,
                                                      const slv_canvas *b,
                                                      const slv_adjacency *adjacency,
                                                      slv_seam_certificate *out);

#ifdef __cplusplus
}
#endif

#endif
