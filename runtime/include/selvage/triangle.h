/* Triangle textures as textures of quads. */
#ifndef SELVAGE_TRIANGLE_H
#define SELVAGE_TRIANGLE_H

#include <selvage/subface.h>
#include <selvage/texture.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Along a side of a sub-face there are twice as many samples as the triangle has texels along its
 * edge, up to this log2 of texels; of larger triangles as many. */
#define SLV_TRIANGLE_FINE_LOG2 4

/* The log2 of samples along the sides of the three sub-faces of a triangle of 2^log2 texels. */
static inline int slv_triangle_subface_log2(int log2) {
    return log2 <= SLV_TRIANGLE_FINE_LOG2 ? log2 + 1 : log2;
}

/* The texture of sub-faces (slv_adjacency_create_triangles) that shows what a texture of triangles
 * holds. `triangles` has the texels of triangle f as face f, square, as .ptx files lay them out:
 * the even texel (i,j), i + j < n, at column i and row j, the odd one at column n-1-j and row
 * n-1-i. `adjacency` is that of the sub-faces. What comes out has three times the faces, in the
 * same type and channels, and looks up as the gaussian of the Ptex library's triangle filter: its
 * samples are means by a gaussian over the texels around them, across edges, that is narrower by
 * what bilinear lookups will add. A coarser neighbour's texels count by the area that lies under
 * the gaussian, a finer one's are reduced first. Lookups differ from slv_sample of the triangles by
 * less than 1 % of the range of the texels around, but next to other resolutions.
 *
 * Averages are of light where `encoding` or the texture says SLV_TEXTURE_SRGB. Where all texels
 * that a sub-face sees are the same it becomes constant. On env->threads threads; takes, besides
 * the result, a third of the triangles' memory where resolutions differ, and a copy for sRGB.
 * SLV_ERROR_ARGUMENT if a face is not square, SLV_ERROR_MISMATCH if the faces do not fit. */
SLV_NODISCARD SLV_API slv_result slv_triangle_texture(const slv_env *env,
                                                      const slv_texture *triangles,
                                                      const slv_adjacency *adjacency,
                                                      slv_texture_encoding encoding,
                                                      slv_texture **out);

#ifdef __cplusplus
}
#endif

#endif
