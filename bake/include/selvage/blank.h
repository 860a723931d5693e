/* A new texture for a mesh that has none. */
#ifndef SELVAGE_BLANK_H
#define SELVAGE_BLANK_H

#include <selvage/ptx_writer.h>
#include <selvage/surface.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Zero means default. How large faces are is said by one of the first three: by none of them it is
 * max_texels = 4 Mi. Sizes are powers of two; lengths are of the limit surface. */
typedef struct slv_blank_params {
    bool uniform;             /* every whole face has the resolution `res`, sub-faces half of it */
    slv_res res;              /* of `uniform` */
    float density;            /* texels per unit of length: to the nearest power of two */
    uint64_t max_texels;      /* in all: the largest density that keeps within, or else min_res */
    slv_res min_res, max_res; /* what faces are kept within; default 1x1 and 4096x4096 */
    bool max_given;           /* max_res counts though it is 1x1 */
    bool square;              /* faces as wide as high, though their sides differ */

    slv_type type;         /* default uint8 */
    uint32_t nchannels;    /* default 3 */
    int32_t alpha_channel; /* an index plus 1; 0: none */
    slv_texture_encoding encoding;
    const float *fill;     /* nchannels values as the texture has them; NULL: 1 for alpha, 0 else */
    slv_scheme scheme;     /* of the surface whose lengths count */
    int compression;       /* of a file, as in slv_ptx_writer_params */
    slv_progress progress; /* of a file: faces */
    uint64_t reserved[6];
} slv_blank_params;

typedef struct slv_blank_stats {
    uint64_t texels, bytes;    /* of all faces, as if none was constant */
    slv_res smallest, largest; /* faces, by their number of texels */
    float density;             /* that was used; 0 with `uniform` */
    uint32_t nlimited;         /* faces that max_res made coarser than that */
    uint32_t first_limited;    /* the first of those, or 0 */
    uint64_t reserved[3];
} slv_blank_stats;

/* The resolution of each face, for slv_free. `stats` may be NULL in all three. SLV_ERROR_ARGUMENT
 * for a min_res larger than max_res; a warning where max_res limits a density that was asked for,
 * or min_res needs more texels than max_texels. */
SLV_NODISCARD SLV_API slv_result slv_blank_plan(const slv_env *env, const slv_mesh *mesh,
                                                const slv_blank_params *params, slv_res **out,
                                                slv_blank_stats *stats);
/* A store whose faces are constant. */
SLV_NODISCARD SLV_API slv_result slv_blank_create(const slv_env *env, const slv_mesh *mesh,
                                                  const slv_blank_params *params, slv_texture **out,
                                                  slv_blank_stats *stats);
/* A .ptx with the mesh inside. */
SLV_NODISCARD SLV_API slv_result slv_blank_save(const slv_env *env, const slv_mesh *mesh,
                                                const slv_blank_params *params, const char *path,
                                                slv_blank_stats *stats);

#ifdef __cplusplus
}
#endif

#endif
