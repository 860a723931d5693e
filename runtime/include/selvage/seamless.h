/* Reductions that agree where faces meet (Purnomo, Cohen, Kumar 2004, section 4.5): texels in the
 * outermost row along an edge have the same values on both sides, at every level, and those in the
 * corners the same from all faces around a vertex, so that even a lookup that knows nothing of
 * neighbours shows no seam there.
 *
 * A level starts as the plain mean of the one above. Then its outermost texels become those of a
 * filter that is symmetric about the boundary: along an edge the mean of the own texel and the one
 * across, in a corner the mean of all corners around the vertex (slv_border_vertex), and beside the
 * middle of a whole quad's edge, where two sub-faces meet, that of the vertex there. Where the
 * neighbour is coarser its outermost row decides, and the finer side takes what is interpolated
 * between the coarser texels at its own texels' middles. Levels meet as in border.h.
 *
 * Two kinds of texels cannot agree. Those of a level that is a single texel along an axis, and so
 * has two opposite edges, stay as they are, and neighbours take them over. And where a whole quad
 * has two texels along its edge and two finer sub-faces across, the texels of these beside the
 * middle are the mean of the two. Constant faces stay constant where the texture stays as it is;
 * its neighbours take them over. At a boundary, where nothing is across, only corners change.
 * Values are averaged as they are stored, alpha too. */
#ifndef SELVAGE_SEAMLESS_H
#define SELVAGE_SEAMLESS_H

#include <selvage/border.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Levels of which those from `first` on agree: 1 leaves the texture itself as it is, 0 does not.
 * Neither argument is needed afterwards. They cannot be updated: slv_levels_update is
 * SLV_ERROR_UNSUPPORTED. On env->threads threads; the same bytes with any number of them.
 * SLV_ERROR_MISMATCH if `adjacency` has another number of faces. */
SLV_NODISCARD SLV_API slv_result slv_levels_create_seamless(const slv_env *env,
                                                            const slv_texture *texture,
                                                            const slv_adjacency *adjacency,
                                                            uint32_t first, slv_levels **out);

/* How far the two sides of edges are apart in what is stored, in the units of slv_type_to_float. */
typedef struct slv_seam_agreement {
    uint32_t edges, mixed; /* that were compared, of texels of one length and of different ones */
    float equal_max;       /* between texels that face each other */
    float mixed_max;       /* between a texel of the finer side and the line through those of the
                              coarser one, at its middle */
    uint64_t reserved[4];
} slv_seam_agreement;

/* Compares a level of every face with what it meets across its edges, level to level as in
 * border.h; faces that do not have so many levels, and what cannot agree, are left out. */
SLV_API void slv_levels_agreement(const slv_levels *levels, const slv_adjacency *adjacency,
                                  uint32_t level, slv_seam_agreement *out);

#ifdef __cplusplus
}
#endif

#endif
