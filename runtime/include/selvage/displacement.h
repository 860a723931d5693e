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
    /* Whose neighbours lookups go to, NULL means the file's; of triangles that of their sub-faces
     * (subface.h). It must outlive the displacement. */
    const slv_adjacency *adjacency;
    uint64_t reserved[3];
} slv_displacement_params;

/* A displacement by a file of a cache, which must outlive it, and whose log tells of what cannot be
 * read. A texture of triangles displaces their sub-faces, three for each of its faces, by what
 * slv_triangle_texture makes of it now; all its texels are then in memory. A channel that the file
 * lacks is SLV_ERROR_ARGUMENT, an adjacency of another number of faces SLV_ERROR_MISMATCH. Values
 * that are no numbers move nothing, and the first that is met is told of in a warning. With an
 * adjacency, or of triangles, up to 256 MiB of the file are remembered beside the cache.
 * slv_displacement_close releases what is in `out`. */
SLV_NODISCARD SLV_API slv_result slv_displacement_open(slv_cache *cache, slv_file_id file,
                                                       const slv_displacement_params *params,
                                                       slv_displacement *out);
/* Zeroes the struct; one that is zero already is fine. */
SLV_API void slv_displacement_close(slv_displacement *displacement);

#ifdef __cplusplus
}
#endif

#endif
