/* Stripes, noise and cubes over a row of texels. */
#ifndef SLV_BAKE_PATTERN_ROW_H
#define SLV_BAKE_PATTERN_ROW_H

#include "procedural/pattern.h"

/* Texels of a row, and numbers that rows are filled up with, since they are taken by so many. */
enum {
    SLVI_ROW_TEXELS = 256,
    SLVI_ROW_AT_ONCE = 8,
    SLVI_ROW_ROOM = SLVI_ROW_TEXELS + SLVI_ROW_AT_ONCE
};

typedef float slvi_row[SLVI_ROW_ROOM];
typedef slvi_row slvi_row_places[3]; /* one coordinate after the other, as they enter the pattern */

/* Two rows of corners, below and above texels by turns, and what is found between them. */
typedef struct slvi_pattern_rows {
    slvi_row_places corners[2];
    bool has_noise[SLVI_MAX_OCTAVES][2]; /* of corners; to be made false for new ones */
    slvi_row means, squares;             /* of the value, and of its square */
    /* the rest is the means' own */
    slvi_row_places middle, grid[4];
    slvi_row corner_noise[SLVI_MAX_OCTAVES][2], noise[5], own[4], sizes, phases[2], sums;
} slvi_pattern_rows;

/* The means of the value, 0..1, and of its square over `width` texels above corners[lower] and
 * below the others. */
typedef void slvi_pattern_means(const slv_procedural *resolved, const slvi_octave *octaves,
                                slvi_pattern_rows *rows, unsigned lower, uint32_t width);

/* Kinds of processor that these are compiled for, the best first; the same bits by each. */
#ifdef SLV_HAVE_AVX2
#define SLVI_ROW_PROCESSORS(ROW) ROW(avx2) ROW(portable)
#else
#define SLVI_ROW_PROCESSORS(ROW) ROW(portable)
#endif
#define SLVI_ROW_DECLARE(KIND) slvi_pattern_means slvi_pattern_means_##KIND;
SLVI_ROW_PROCESSORS(SLVI_ROW_DECLARE)

#endif
