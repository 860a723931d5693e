/* Which texels of a lattice of triangles a sample of a sub-face is the mean of. */
#ifndef SLV_TEXTURE_TRIANGLE_TAPS_H
#define SLV_TEXTURE_TRIANGLE_TAPS_H

#include <selvage/triangle.h>

/* The most texels whose middle lies within the gaussian's reach, with some room. */
enum { SLVI_TAPS = 40, SLVI_TILE = 32 };

/* A window on the lattice of a triangle: cells u0..u0+width-1, v0..v0+height-1, two texels each,
 * the even one first; some are outside of the triangle. */
typedef struct slvi_lattice {
    int32_t u0, v0, width, height;
} slvi_lattice;

/* Samples x..x+width-1, y..y+height-1 of a sub-face of a triangle of 2^log2 texels. */
typedef struct slvi_tile {
    int log2;
    unsigned sub;
    uint32_t x, y, width, height;
} slvi_tile;

typedef struct slvi_tap {
    int32_t texel; /* of the window */
    float weight;
} slvi_tap;

/* The window that a tile's samples reach into. */
slvi_lattice slvi_triangle_window(const slvi_tile *tile);
/* The texels of each sample, row by row, SLVI_TAPS apart; count[] says how many. */
void slvi_triangle_taps(const slvi_tile *tile, const slvi_lattice *window, slvi_tap *taps,
                        uint8_t *counts);

#endif
