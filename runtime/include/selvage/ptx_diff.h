/* How two .ptx files differ, face by face. */
#ifndef SELVAGE_PTX_DIFF_H
#define SELVAGE_PTX_DIFF_H

#include <selvage/ptx.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    SLV_DIFF_TEXELS = 1, /* some differ by more than the tolerance */
    SLV_DIFF_RES = 2,
    SLV_DIFF_ADJACENCY = 4,
    SLV_DIFF_SUBFACE = 8, /* a sub-face here, a whole quad there */
    SLV_DIFF_MISSING = 16 /* only one of the files has it */
};

/* Values of integer files count as 0..1; a value that is finite on one side only differs by
 * infinity, two that are not numbers by nothing. */
typedef struct slv_face_diff {
    uint8_t what;           /* SLV_DIFF_..., 0: equal */
    slv_res res[2];         /* of both files */
    int32_t edge;           /* the first whose neighbour differs, or -1 */
    slv_res compared;       /* where resolutions differ, both are reduced to the smaller sides */
    uint64_t ndifferent;    /* texels beyond the tolerance */
    float largest;          /* difference of two values */
    double mean;            /* of all differences that are finite */
    uint32_t x, y, channel; /* where the largest is */
} slv_face_diff;

/* Zero means default. */
typedef struct slv_ptx_diff_params {
    float tolerance;
    slv_progress progress; /* faces */
    uint64_t reserved[4];
} slv_ptx_diff_params;

/* Compares the channels that both have, on env->threads threads. `out` has room for as many faces
 * as the file with more of them has. Triangles with quads are SLV_ERROR_MISMATCH. */
SLV_NODISCARD SLV_API slv_result slv_ptx_diff(const slv_env *env, const slv_ptx *a,
                                              const slv_ptx *b, const slv_ptx_diff_params *params,
                                              slv_face_diff *out);

/* The differences of one face themselves: 2^u * 2^v * (channels that both have) values |a - b|, at
 * `diff->compared`. */
SLV_NODISCARD SLV_API slv_result slv_ptx_diff_texels(const slv_env *env, const slv_ptx *a,
                                                     const slv_ptx *b, uint32_t face,
                                                     const slv_face_diff *diff, float *out);

#ifdef __cplusplus
}
#endif

#endif
