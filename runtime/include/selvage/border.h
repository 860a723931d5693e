/* What lies just outside a face: border texels and corner values that make interpolation continuous
 * across edges and around vertices of any valence (Purnomo, Cohen, Kumar 2004, section 3; Burley
 * and Lacewell 2008).
 *
 * A border texel is whatever makes the interpolated value *on* the edge the one that both faces
 * agree on. Between equal resolutions that is the neighbour's own texel, for the agreed value is
 * (own + neighbour)/2. Between different ones the agreed edge function E is that of the coarser
 * side, and the finer side's border is 2E - own at its texel centres. Around a vertex all faces
 * agree on one value M; with a the face's corner texel, b and e the border texels beside it, the
 * diagonal border texel is d = 4M - a - b - e. Beyond a boundary the border repeats the face's own
 * texels.
 *
 * Faces meet level to level: a face at level l meets its neighbour at the level whose texels are as
 * long as its own along the shared edge, or at level 0 where the neighbour is coarser. What they
 * agree on holds everywhere between equal texels, and at vertices and the finer side's texel
 * centres otherwise. Two places can only be met nearly: the middle of a whole quad's edge where one
 * of the two sub-faces there is coarser than the quad, and a vertex around which oblong resolutions
 * contradict each other, so that going once around it from level to level ends at another one. */
#ifndef SELVAGE_BORDER_H
#define SELVAGE_BORDER_H

#include <selvage/form.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One level of one face with bu texels to the left and right and bv below and above: writes
 * (2^u + 2 bu) * (2^v + 2 bv) * nchannels floats, v-major, row 0 lowest. bu and bv are at least 1
 * and at most the level's own width and height. The innermost ring of border texels is exact in the
 * sense above; those further out are looked up in the neighbours, bilinear, one face away at most.
 * `*out_of_range` (may be NULL) says whether an integer texture's border fell outside 0..1, or a
 * half texture's beyond 65504, which 2E - own and d can do: such a face needs a wider type on its
 * way to a sampler. Thread-safe. `levels` and `adjacency` must have the same number of faces. */
SLV_NODISCARD SLV_API slv_result slv_border_build(const slv_levels *levels,
                                                  const slv_adjacency *adjacency, uint32_t face,
                                                  uint32_t level, uint32_t bu, uint32_t bv,
                                                  float *out, bool *out_of_range);

/* The value M (`nchannels` floats) that all faces around a corner agree on at a level: the mean of
 * their corner texels, or around a pole of more than 256 faces that of every n-th, so that its cost
 * stays bounded. In integer textures M is moved, where possible, to where no d leaves 0..1. */
SLV_API void slv_border_vertex(const slv_levels *levels, const slv_adjacency *adjacency,
                               uint32_t face, uint32_t level, unsigned corner, float *out);

/* How a face shares a corner's values with the others around it, level to level: each ring
 * (slv_adjacency_ring) has one list of values, or two where densities differ by half a level, and
 * the value at a face's level is number max(level - skip, 0) of it. Around a pole of more than 256
 * faces each has a list of its own. */
typedef struct slv_vertex_share {
    uint32_t skip; /* levels of the face that all have the first value */
    bool half;     /* the second of the two lists */
    bool alone;
} slv_vertex_share;
SLV_API slv_vertex_share slv_border_vertex_share(const slv_levels *levels,
                                                 const slv_adjacency *adjacency, uint32_t face,
                                                 unsigned corner);

/* Every level of every face with a border from its neighbours, as a form (form.h). */
SLV_API const slv_form *slv_form_borders(void);

#ifdef __cplusplus
}
#endif

#endif
