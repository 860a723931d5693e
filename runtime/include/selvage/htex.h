/* The half-edge form of a texture: a square texture for each edge of the control mesh in place of
 * one for each face (Barbier and Dupuy 2022, "Htex: Per-Halfedge Texturing for Arbitrary Mesh
 * Topologies").
 *
 * A polygon is cut from its centre into triangles, one for each of its half-edges: start, end,
 * centre. A point of a triangle has the coordinates (s,t) with start = (1,0), end = (0,1) and
 * centre = (0,0). The square of an edge has the triangle of one side in the half where s + t < 1,
 * and that of the other side, turned by 180 degrees, in the other half: the edge is its diagonal,
 * and both faces look up the same texels there. The other half of an edge of the boundary is the
 * mirror image of the first. A whole quad of a .ptx is a polygon of four half-edges; sub-faces are
 * put together to the polygon that they come from, whose half-edge triangles are each made of half
 * of one sub-face and half of the next, so that there are no edges at which one face meets two.
 *
 * Beyond the two sides of its square a half-edge's triangle goes on in the square of the half-edge
 * before it, at (-t, s), and of the one after it, at (t, -s). A lookup mixes one of these in within
 * half a texel of the side. The weights come from the coordinates alone and add up to one, whatever
 * they are. Around a point where many squares meet, a vertex or the centre of a polygon, the
 * squares at hand differ from triangle to triangle; so within half a texel of such a corner lookups
 * go over to one value that all squares around it share: for each size of texels the mean of their
 * corner texels, and for the smallest that they all have the texture's own value there.
 *
 * The texels are new ones: the function that the texture's texels and borders stand for (border.h),
 * at the centres of the square's. A square has as many texels along a side as the face, or as
 * 2^((u + v + 1) / 2) if the face is oblong; between sub-faces twice as many; and those of the
 * finer side if the two differ. Its levels are means of 2 x 2 texels, down to one. Floats beyond
 * 1e30 may overflow in the sums. */
#ifndef SELVAGE_HTEX_H
#define SELVAGE_HTEX_H

#include <selvage/border.h>

#ifdef __cplusplus
extern "C" {
#endif

/* All levels of the squares of all edges in the texture's own type. Immutable. */
typedef struct slv_htex slv_htex;

/* Neither argument is needed afterwards. On env->threads threads; the same bytes with any number of
 * them. `levels` and `adjacency` must have the same number of faces. Sub-faces that do not form a
 * polygon count as whole quads, and an edge at which the two sides do not fit together as one of
 * the boundary. */
SLV_NODISCARD SLV_API slv_result slv_htex_create(const slv_env *env, const slv_levels *levels,
                                                 const slv_adjacency *adjacency, slv_htex **out);
SLV_API void slv_htex_destroy(slv_htex *htex);

/* That of the texture. Owned by the object. */
SLV_API const slv_texture_desc *slv_htex_get_desc(const slv_htex *htex);
/* Bytes of all texels of all levels. */
SLV_API uint64_t slv_htex_bytes(const slv_htex *htex);

SLV_API uint32_t slv_htex_edge_count(const slv_htex *htex);
/* log2 of the side of an edge's square, which has one level more than that. */
SLV_API uint32_t slv_htex_log2(const slv_htex *htex, uint32_t edge);
/* The texels of a level: 2^(log2 - level) squared, t-major, row 0 at t = 0 as the edge's first
 * half-edge has it. Owned by the object. */
SLV_API const void *slv_htex_texels(const slv_htex *htex, uint32_t edge, uint32_t level);

/* What lookups in a face can need: of its four half-edges, those of edge 0 to 3; or, if it is part
 * of a polygon of several sub-faces, of the half-edges k - 2, k - 1, k and k + 1, where k starts at
 * its corner 0. Each is followed by the next around the polygon. */
typedef struct slv_htex_face {
    uint32_t edge[4];
    bool second[4];    /* the face is in the half of the square where s + t > 1 */
    uint32_t start[4]; /* the corners where these half-edges start */
    uint32_t centre;   /* and the polygon's centre */
    bool part;
    uint8_t turns[9]; /* of levels of vectors: by how many quarters the axes are turned, counter-
                         clockwise, in which those of these squares, corners and the centre are */
} slv_htex_face;
SLV_API slv_htex_face slv_htex_get_face(const slv_htex *htex, uint32_t face);

/* The values that squares share at their corners: all of them, `nchannels` floats each, and which
 * belong to a corner: first + i for squares of 2^i texels a side, i = 0 to log2, which is the least
 * of the squares around it. Owned by the object. */
SLV_API uint32_t slv_htex_value_count(const slv_htex *htex);
SLV_API const float *slv_htex_values(const slv_htex *htex);
SLV_API void slv_htex_get_corner(const slv_htex *htex, uint32_t corner, uint32_t *first,
                                 uint32_t *log2);

/* What a shader's lookup returns, at (u,v), which is clamped to the face: `nchannels` floats. The
 * footprint is a square in (u,v) with sides of `width`; 0 is magnified. Thread-safe. */
SLV_API void slv_htex_lookup(const slv_htex *htex, uint32_t face, float u, float v, float width,
                             float *out);

/* What the conversion loses at level 0, in the units of slv_type_to_float, over all channels:
 * lookups against the interpolated texels with the borders of border.h. Each texel counts the same.
 */
typedef struct slv_htex_error {
    double texel_rms, texel_max;       /* at the centres of texels */
    double function_rms, function_max; /* at 16 points of every texel of the face, or of its
                                          squares if theirs are smaller */
    uint64_t reserved[4];
} slv_htex_error;

/* `levels` and `adjacency` are those that `htex` was made from. */
SLV_NODISCARD SLV_API slv_result slv_htex_measure(const slv_env *env, const slv_htex *htex,
                                                  const slv_levels *levels,
                                                  const slv_adjacency *adjacency,
                                                  slv_htex_error *out);

/* All that as a form (form.h), whose items are the edges' squares. The values at corners are not
 * among them. */
SLV_API const slv_form *slv_form_htex(void);
/* The object behind what that form has made; NULL for any other form's. */
SLV_API const slv_htex *slv_form_get_htex(const slv_form *form, const void *made);

#ifdef __cplusplus
}
#endif

#endif
