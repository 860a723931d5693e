/* Measuring what a resampled form of a texture loses: face by face, on threads. */
#ifndef SLV_TEXTURE_RESAMPLE_ERROR_H
#define SLV_TEXTURE_RESAMPLE_ERROR_H

#include "texture/texture_data.h"

#include <selvage/adjacency.h>

/* Sums over one face; added up in the order of faces, so that threads do not matter. */
typedef struct slv_face_error {
    double texel_sum, function_sum; /* of squares */
    double texel_max, function_max;
} slv_face_error;

typedef struct slv_resample_measure {
    const void *resampled; /* the caller's */
    const slv_levels *levels;
    const slv_adjacency *adjacency;
    slv_env env; /* for the function below */
    slv_face_error *faces;
} slv_resample_measure;

/* Calls `faces` (slvi_parallel_for's function; its user is the measure) for all faces. `desc` is
 * that of the resampled form, which `name` is said to be in messages. *out is the sum over all
 * faces, the sums as root mean squares, each texel counting the same. */
slv_result slvi_resample_measure_all(const slv_env *env, slv_resample_measure *measure,
                                     const slv_texture_desc *desc, const char *name,
                                     slv_range_fn faces, slv_face_error *out);

#endif
