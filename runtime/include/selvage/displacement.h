/* Displacements out of textures: what slv_tessellate_with moves surfaces by. */
#ifndef SELVAGE_DISPLACEMENT_H
#define SELVAGE_DISPLACEMENT_H

#include <selvage/filter.h>
#include <selvage/tessellation.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Zero means default. A point moves by scale * (value + bias), value being what the texture says,
 * integers as 0..1, as they stand: no colour is decoded. */
typedef struct slv_displacement_params {
    slv_displacement_space space;
    uint32_t channel; /* the first of one, or of three */
    float scale;      /* mesh units; 0 means 1 */
    float bias;       /* before scaling: -0.5 makes the middle of an integer type stay in place */
    const slv_filter_params *filter; /* NULL: SLV_FILTER_BSPLINE, between resolutions too. Its
                                        channels are not looked at. Footprints are what is between
                                        two vertices */
    uint64_t reserved[4];
} slv_displacement_params;

/* A displacement by a file of a cache, which must outlive it, and whose log tells of what cannot be
 * read. A channel that the file lacks is SLV_ERROR_ARGUMENT, and a texture of triangles
 * SLV_ERROR_UNSUPPORTED. Values that are no numbers move nothing. slv_displacement_close releases
 * what is in `out`. */
SLV_NODISCARD SLV_API slv_result slv_displacement_open(slv_cache *cache, slv_file_id file,
                                                       const slv_displacement_params *params,
                                                       slv_displacement *out);
/* Zeroes the struct; one that is zero already is fine. */
SLV_API void slv_displacement_close(slv_displacement *displacement);

#ifdef __cplusplus
}
#endif

#endif
