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
/* Copies all texels of a matching face, turned. */
slv_result slvi_transfer_copy(const slv_env *env, const slv_texture *from,
                              const slv_transfer_face *match, slv_texture *to, uint32_t face);
slv_res slvi_transfer_turned(slv_res res, const slv_transfer_face *match);

/* How long a face's texels are, in mesh units; infinite if the face is constant or has no extent.
 */
typedef struct transfer_size {
    float u, v, finest_around; /* the shortest of the face and those beside it */
} transfer_size;

/* The source as something to look up. */
typedef struct transfer_source {
    const slv_texture *texture;
    const slv_texture_desc *desc;
    slv_adjacency *adjacency;
    transfer_size *sizes;
} transfer_source;

/* To be ended whatever it returns. */
slv_result slvi_transfer_source_begin(const slv_env *env, const slv_mesh *mesh,
                                      const slv_texture *texture, const float *corners,
                                      transfer_source *out);
void slvi_transfer_source_end(transfer_source *source);
/* The side of the shortest texel that a footprint may meet. */
float slvi_transfer_finest_texel(const transfer_source *source, const slv_surface_point *at,
                                 float footprint);
/* Adds the colour around a point, multiplied by alpha, to `out`: interpolated, or where the
 * footprint (in mesh units) is longer than texels the mean of those of the point's face that it
 * covers. `scratch` holds nchannels floats. */
void slvi_transfer_look_up(const transfer_source *source, const slv_surface_point *at,
                           float footprint, float *scratch, float *out);

#endif
