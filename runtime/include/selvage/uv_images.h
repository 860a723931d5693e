/* Images that a mesh's texture coordinates look up, as functions: what the renderer draws and what
 * the reference casts rays at, whoever has read them. slv_bake_source_images (bake.h) makes one of
 * files. */
#ifndef SELVAGE_UV_IMAGES_H
#define SELVAGE_UV_IMAGES_H

#include <selvage/adjacency.h>

#ifdef __cplusplus
extern "C" {
#endif

/* An image on one unit square of texture coordinates. */
typedef struct slv_uv_tile {
    int32_t u, v;           /* its lower left corner */
    uint32_t width, height; /* 0: there is none */
} slv_uv_tile;

/* Texture coordinates are bilinear in a face's (u,v), as slv_mesh_face_texcoords has them; u is to
 * the right of the images, v up. Colours are linear, multiplied by alpha. Its owner keeps all that
 * it points to; its functions may be called by any number of threads. */
typedef struct slv_uv_images {
    uint32_t nfaces;
    const float *texcoords; /* 8 a face; NaN in the first: it has none */
    bool round_u, round_v;  /* the coordinate goes round, with one value a vertex: within a face it
                               takes the short way (wrap.h) */
    bool tiled; /* many images, each on its square; otherwise the first is everywhere: */
    bool repeat_u, repeat_v; /* again on each square, or by its outermost pixels */
    bool wide;               /* half floats do not hold all values */
    bool narrow;             /* 8 bits do, of sRGB unless `data`, and alpha is 1 */
    bool data;
    uint32_t ntiles;
    const slv_uv_tile *tiles;
    float none[4]; /* the colour where there is no image or no texture coordinates */
    /* RGBA of `count` pixels of a row from (x, y) on, row 0 at the top. */
    void (*pixels)(const void *user, uint32_t tile, uint32_t x, uint32_t y, uint32_t count,
                   float *rgba);
    /* RGBA at a place of a face, bilinear between pixels; `none` where there is nothing. */
    void (*color)(const void *user, uint32_t face, float u, float v, float rgba[4]);
    const void *user;
    uint64_t reserved[4];
} slv_uv_images;

/* Whether a face and its neighbour over an edge have the same texture coordinates along the part of
 * it that they share, to 1e-4; those that go round may be whole numbers apart. Both are the eight
 * numbers of a face. */
SLV_API bool slv_uv_continues(const float *corners, unsigned edge, const slv_neighbour *next,
                              const float *others, bool round_u, bool round_v);

#ifdef __cplusplus
}
#endif

#endif
