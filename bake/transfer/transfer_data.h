/* The parts of a transfer. */
#ifndef SLV_BAKE_TRANSFER_H
#define SLV_BAKE_TRANSFER_H

#include <selvage/transfer.h>

double slvi_transfer_area(const float *corners);
/* Of two opposite sides, from a to b and from c to d. */
float slvi_transfer_mean_length(const float *a, const float *b, const float *c, const float *d);
/* Finds for every face of the target the face of the source with the same corners. Fills in source,
 * turn and flipped of those; the others get -1. */
slv_result slvi_transfer_match(const slv_env *env, uint32_t nsource, const float *source,
                               uint32_t ntarget, const float *target, float tolerance,
                               slv_transfer_face *faces);
/* All texels of a matching face, turned; `in` and `out` are in the source's resolution. */
void slvi_transfer_turn(const slv_transfer_face *match, slv_res source, size_t pixel,
                        const uint8_t *in, uint8_t *out);
slv_res slvi_transfer_turned(slv_res res, const slv_transfer_face *match);

/* How long a face's texels are, in mesh units; infinite if the face is constant or has no extent.
 */
typedef struct transfer_size {
    float u, v, finest_around; /* the shortest of the face and those beside it */
} transfer_size;

/* The source as something to look up. */
typedef struct transfer_source {
    slv_source texels;
    slv_source_desc desc;
    slv_source_face *faces;
    slv_adjacency *adjacency;
    transfer_size *sizes;
} transfer_source;

/* To be ended whatever it returns. `texels` stays its caller's. */
slv_result slvi_transfer_source_begin(const slv_env *env, const slv_mesh *mesh,
                                      const slv_source *texels, const float *corners,
                                      transfer_source *out);
void slvi_transfer_source_end(transfer_source *source);

/* transfer_tiles.c: what one thread has in memory of the source, as floats, colours multiplied by
 * alpha. */
typedef struct transfer_tile {
    int32_t face; /* -1: nothing */
    slv_res res;
    uint32_t x, y; /* in tiles */
    float *values;
} transfer_tile;

enum { TRANSFER_TILES = 64 };

typedef struct transfer_tiles {
    const slv_env *env;
    const transfer_source *source;
    int side_log2;
    transfer_tile tiles[TRANSFER_TILES];
    void *raw;
    slv_result result; /* the first failure: from then on texels are zero */
} transfer_tiles;

void slvi_transfer_tiles_begin(const slv_env *env, const transfer_source *source,
                               transfer_tiles *out);
void slvi_transfer_tiles_end(transfer_tiles *tiles);
/* The values of a texel of a face at `res`, valid until the next call; NULL if they cannot be read.
 */
const float *slvi_transfer_fetch(transfer_tiles *tiles, uint32_t face, slv_res res, uint32_t x,
                                 uint32_t y);

/* The side of the shortest texel that a footprint may meet. */
float slvi_transfer_finest_texel(const transfer_source *source, const slv_surface_point *at,
                                 float footprint);
/* Adds the colour around a point, multiplied by alpha, to `out`: interpolated, or where the
 * footprint (in mesh units) is longer than texels the mean of those of the point's face that it
 * covers. */
void slvi_transfer_look_up(transfer_tiles *tiles, const slv_surface_point *at, float footprint,
                           float *out);

#endif
