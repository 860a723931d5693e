/* Textures on the GPU that follow their texels, for painting and previews:
 *
 *     slv_gl_texture_params params = {.live = true};
 *     slv_gl_texture_create(gl, env, texture, adjacency, &params, &on_gpu);
 *     ...
 *     slv_texture_set_rect(texture, face, rect, texels);   any number of changes
 *     slv_gl_texture_update(on_gpu, env, NULL);            once a frame
 *
 * The texture knows what was changed since the last time. Of that and of what depends on it, texels
 * are made anew and uploaded, and nothing else: levels, borders of the faces around, values of
 * corners, samples on edges, squares, compressed blocks, for each strategy that the texture was
 * made for. Afterwards the GPU holds the texels that a texture made afresh would hold, bit for bit;
 * a face that has come to be of one value, of which that would store a single texel, keeps its
 * place, so that painting changes no batches, and lookups there may differ in the last bits. A face
 * may also get another resolution (slv_texture_set_resolution); then batches and links are made
 * anew for all faces, texels only where they depend on it. */
#ifndef SELVAGE_GL_LIVE_H
#define SELVAGE_GL_LIVE_H

#include <selvage/gl_texture.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The first half of slv_gl_texture_create, on any thread and without a context: all that is
 * computed before anything is uploaded, limits of the driver checked. Until it is uploaded,
 * texture and adjacency must stay as they are, and there is nothing to draw or look up: no batches.
 * Its shader texts are there. Destroying it on the thread of the context, or on any if
 * slv_gl_texture_upload was not called yet, gives up. All strategies' forms are in memory at the
 * same time, which slv_gl_texture_create does without. */
SLV_NODISCARD SLV_API slv_result slv_gl_texture_prepare(slv_gl *gl, const slv_env *env,
                                                        const slv_texture *texture,
                                                        const slv_adjacency *adjacency,
                                                        const slv_gl_texture_params *params,
                                                        slv_gl_texture **out);

/* How far a texture is. */
typedef struct slv_gl_upload {
    bool ready;           /* it can be drawn, and is like one of slv_gl_texture_create */
    uint64_t done, total; /* bytes; 0 when it was ready before */
    uint64_t reserved[2];
} slv_gl_upload;

/* The second half, bit by bit, on the thread of the context: uploads at most max_bytes (but for a
 * single layer, which is uploaded whole), and less if that takes more than 16 ms, since texels are
 * converted on the way. What takes more than 1 MiB at once, an array or a table, is made in a call
 * of its own, and only there may the driver take longer: a software driver clears it, at 0.7 ms a
 * MiB. An array has at most 512 MiB, a table 16 MiB or a row of 8 bytes for each face.
 * `out` may be NULL. Once the texture is ready it does nothing. After a failure, or if `progress`
 * has cancelled it, there is nothing to do but to destroy it. Leaves GL state as it was. */
SLV_NODISCARD SLV_API slv_result slv_gl_texture_upload(slv_gl_texture *texture, const slv_env *env,
                                                       uint64_t max_bytes, slv_gl_upload *out);

/* What an update did. */
typedef struct slv_gl_update {
    uint32_t faces; /* whose own texels were changed */
    uint32_t items; /* faces and squares that were made anew, of all forms together */
    uint32_t moved; /* those of them that went to another array: batches may be others */
    uint64_t bytes; /* texels uploaded, as the GPU stores them */
    bool renewed;   /* all was made anew, and batches, variants and shader texts may be others: the
                       values of a float texture have become so large, or are no longer, that
                       lookups have to be made otherwise */
    uint64_t reserved[4];
} slv_gl_update;

/* Uploads what was changed of the texture since it was uploaded, or updated, last. On the thread of
 * the context; the texture and its adjacency must not change meanwhile. Takes time that goes with
 * what was changed and not with the number of faces, but after more changes than a texture
 * remembers (256 rectangles of other faces than the one before), when each face is asked whether it
 * was changed. `out` may be NULL. SLV_ERROR_ARGUMENT for a texture that was not made `live`, or is
 * not uploaded yet. If it fails nothing is lost: the next call does what this one did not; until
 * then there may be no batches. Leaves GL state as it was. */
SLV_NODISCARD SLV_API slv_result slv_gl_texture_update(slv_gl_texture *texture, const slv_env *env,
                                                       slv_gl_update *out);

/* Reads back a level of an item (gl_strategy.h; with most strategies a face) as the GPU holds it:
 * the texels or blocks of the format that was chosen, what lies around the item's own texels
 * included, tightly packed. *bytes is how many those are; `out` may be NULL, or has room for
 * `size`. For tests and for looking into what is drawn: it waits for the driver. */
SLV_NODISCARD SLV_API slv_result slv_gl_texture_read(const slv_gl_texture *texture,
                                                     const slv_env *env,
                                                     const slv_strategy *strategy, uint32_t item,
                                                     uint32_t level, uint64_t size, void *out,
                                                     uint64_t *bytes);

#ifdef __cplusplus
}
#endif

#endif
