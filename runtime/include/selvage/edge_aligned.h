/* The edge-aligned form of a texture: samples on the edges of faces in place of borders outside
 * them (Purnomo, Cohen, Kumar 2004, section 3.2). A level of 2^u x 2^v texels becomes a grid of
 * (2^u + 1) x (2^v + 1) samples, the outermost of which lie exactly on the edges: sample (i,j) is
 * at (i / 2^u, j / 2^v). Bilinear interpolation between them needs nothing from beyond the face.
 *
 * A sample is the value there of the function that the centred texels and their borders stand for
 * (border.h): inside, the mean of the four texels around it; on an edge, the agreed value E; at a
 * vertex, M. Each edge sample and each vertex has one value, computed to the same bits from every
 * face that has it. Where resolutions differ, the finer side's edge samples lie on the straight
 * lines between those of the coarser side, so that both sides agree on the whole edge and not only
 * at samples. In integer types such samples are rounded: the sides are then within half a unit of
 * each other. Where a whole quad of one texel along its edge meets two sub-faces, the vertex
 * between these takes its value from the quad's edge.
 *
 * Levels meet as in border.h. Level 0 of all faces agrees on every edge. At further levels one
 * place is left out: a vertex around which oblong resolutions contradict each other. */
#ifndef SELVAGE_EDGE_ALIGNED_H
#define SELVAGE_EDGE_ALIGNED_H

#include <selvage/border.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Samples of a level of 2^res.u x 2^res.v texels. */
SLV_API uint64_t slv_edge_aligned_count(slv_res res);

/* One level of one face: writes slv_edge_aligned_count * nchannels floats, v-major, row 0 at v=0.
 * Thread-safe. `levels` and `adjacency` must have the same number of faces. */
SLV_NODISCARD SLV_API slv_result slv_edge_aligned_build(const slv_levels *levels,
                                                        const slv_adjacency *adjacency,
                                                        uint32_t face, uint32_t level, float *out);

/* All levels of all faces in the texture's own type. Immutable. */
typedef struct slv_edge_aligned slv_edge_aligned;

/* Neither argument is needed afterwards. On env->threads threads; the same bytes with any number of
 * them. */
SLV_NODISCARD SLV_API slv_result slv_edge_aligned_create(const slv_env *env,
                                                         const slv_levels *levels,
                                                         const slv_adjacency *adjacency,
                                                         slv_edge_aligned **out);
SLV_API void slv_edge_aligned_destroy(slv_edge_aligned *aligned);

/* That of the texture; `res` counts texels, not samples. Owned by the object. */
SLV_API const slv_texture_desc *slv_edge_aligned_get_desc(const slv_edge_aligned *aligned);
/* Bytes of all samples of all levels. */
SLV_API uint64_t slv_edge_aligned_bytes(const slv_edge_aligned *aligned);
/* The samples of a level, laid out as slv_edge_aligned_build writes them. Owned by the object. */
SLV_API const void *slv_edge_aligned_samples(const slv_edge_aligned *aligned, uint32_t face,
                                             uint32_t level);
/* Bilinear at (u,v), which is clamped to the face: `nchannels` floats. Thread-safe. */
SLV_API void slv_edge_aligned_lookup(const slv_edge_aligned *aligned, uint32_t face, uint32_t level,
                                     float u, float v, float *out);

/* Back: the interpolated values at the centres of a level's texels, 2^u * 2^v * nchannels floats.
 * Thread-safe. Centred texels that went forth and back have been averaged with their neighbours,
 * by 1/4, 1/2, 1/4 along each axis. */
SLV_NODISCARD SLV_API slv_result slv_edge_aligned_centred(const slv_edge_aligned *aligned,
                                                          uint32_t face, uint32_t level,
                                                          float *out);
/* Level 0 of every face as a texture of centred texels, rounded to the type. */
SLV_NODISCARD SLV_API slv_result slv_edge_aligned_to_texture(const slv_env *env,
                                                             const slv_edge_aligned *aligned,
                                                             slv_texture **out);

/* What the conversion loses at level 0, in the units of slv_type_to_float, over all channels. Each
 * texel counts the same. */
typedef struct slv_edge_aligned_error {
    double round_trip_rms, round_trip_max; /* texels against texels that went forth and back */
    double function_rms, function_max;     /* interpolated samples against interpolated texels with
                                              the borders of border.h: exact integrals over the faces
                                              and the exact maximum, not sampled */
    uint64_t reserved[4];
} slv_edge_aligned_error;

/* `levels` and `adjacency` are those that `aligned` was made from. */
SLV_NODISCARD SLV_API slv_result slv_edge_aligned_measure(const slv_env *env,
                                                          const slv_edge_aligned *aligned,
                                                          const slv_levels *levels,
                                                          const slv_adjacency *adjacency,
                                                          slv_edge_aligned_error *out);

/* All that as a form (form.h). */
SLV_API const slv_form *slv_form_edge_aligned(void);

#ifdef __cplusplus
}
#endif

#endif
