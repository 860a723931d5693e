/* What the files of UV images share: the source, a face of it, and samples at one place. */
#ifndef SLV_BAKE_UV_SOURCE_H
#define SLV_BAKE_UV_SOURCE_H

#include "source/source.h"
#include "uv/sample.h"

typedef struct uv_source {
    slv_bake_source base;
    uv_set set;
    float *corners; /* 8 a face */
    float *once;    /* those of a mesh with one value a vertex, if a coordinate goes round */
    bool round[2];
    int32_t *cells; /* 4 a face: u0, v0, u1, v1 of the cells that filters reach, both included */
    slv_uv_tile *squares;       /* of the tiles */
    slvi_uv_sum_line *sum_line; /* for this processor */
} uv_source;

/* A face as it is sampled. */
typedef struct uv_face {
    const uv_source *source;
    const float *corners;
    const int32_t *cells;
    int32_t own[4];  /* cells of the face itself */
    uint32_t nu, nv; /* samples a texel along each axis */
    uint32_t width, height;
} uv_face;

static inline const float *slvi_uv_corners_of(const uv_source *s, uint32_t face) {
    return s->corners + 8 * (size_t)face;
}

static inline int32_t slvi_uv_clamp(int32_t x, int32_t low, int32_t high) {
    return x < low ? low : x > high ? high : x;
}

/* uv_place.c. The cells that a face itself lies in: u0, v0, u1, v1, both included. */
void slvi_uv_own_cells(const float *corners, int32_t cells[4]);
/* A pixel next to a sample whose own tile is that of `cell`; (x, y) may be beyond it, by one
 * pixel where the image does not repeat. */
const uv_tile *slvi_uv_reach(const uv_face *f, const uv_tile *tile, const int32_t cell[2],
                             int32_t *x, int32_t *y);
/* The texture coordinates of a place on a face. */
void slvi_uv_place(const float *corners, double u, double v, double out[2]);
/* A sample at texture coordinates, added to `sum` if it is there. */
slv_bake_miss slvi_uv_sample_at(const uv_face *f, double u, double v, double *sum);
/* The mean of a texel of which some samples may be missing. */
slv_bake_miss slvi_uv_careful(const uv_face *f, uint32_t x, uint32_t y, float *out);

/* uv_blocks.c. The means of a rectangle of texels; `values` and `misses` are zero. */
slv_result slvi_uv_fill(const uv_face *f, const slv_env *env, slv_rect rect, float *values,
                        uint8_t *misses);

/* uv_images.c. The same as images for those who draw them; the squares are the source's. */
void slvi_uv_images(const slv_bake_source *source, slv_uv_images *out);

#endif
