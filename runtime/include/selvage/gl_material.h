/* Several per-face textures of one surface in one shader: colour, roughness and displacement, say,
 * each with resolutions, a strategy and batches of its own. A draw can show the faces that are in
 * one batch of each; these common batches are listed here.
 *
 *     const slv_gl_lookup lookups[] = {{color, NULL}, {roughness, slv_strategy_find("borders")}};
 *     slv_gl_material_create(&env, lookups, 2, &material);
 *     ...
 *     slv_gl_material_update(material, &env, NULL);     after updates of textures that are `live`
 *     for (uint32_t i = 0; i < slv_gl_material_batch_count(material); i++) {
 *         slv_gl_common_batch batch = slv_gl_material_batch(material, i);
 *         glUseProgram(programs[batch.variants[0]][batch.variants[1]]);
 *         slv_gl_material_bind(material, i);
 *         draw the triangles of batch.faces
 *     }
 *
 * Each texture has a prefix of names, units and storage bindings of its own
 * (slv_gl_texture_params); the program's text is slv_gl_texture_extensions, once, and
 * slv_gl_texture_glsl of each with the variant that the batch has of it. */
#ifndef SELVAGE_GL_MATERIAL_H
#define SELVAGE_GL_MATERIAL_H

#include <selvage/gl_texture.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SLV_GL_MAX_LOOKUPS 8

typedef struct slv_gl_lookup {
    slv_gl_texture *texture;
    const slv_strategy *strategy; /* NULL means the texture's first */
} slv_gl_lookup;

typedef struct slv_gl_common_batch {
    const uint32_t *faces; /* owned by the material, until an update that changes batches */
    uint32_t nfaces;
    uint32_t batches[SLV_GL_MAX_LOOKUPS];  /* of each texture, the one that has all these faces */
    uint32_t variants[SLV_GL_MAX_LOOKUPS]; /* of each texture's text */
} slv_gl_common_batch;

typedef struct slv_gl_material slv_gl_material;

/* Of uploaded textures of as many faces each, which outlive it and share a context. Texture units
 * or storage bindings that two of them take are SLV_ERROR_ARGUMENT. */
SLV_NODISCARD SLV_API slv_result slv_gl_material_create(const slv_env *env,
                                                        const slv_gl_lookup *lookups,
                                                        uint32_t count, slv_gl_material **out);
SLV_API void slv_gl_material_destroy(slv_gl_material *material);
/* Lists common batches anew where those of a texture have become others; *changed (may be NULL)
 * says whether. After a failure there are none. */
SLV_NODISCARD SLV_API slv_result slv_gl_material_update(slv_gl_material *material,
                                                        const slv_env *env, bool *changed);

/* Every face is in one of them; they come in the order of the first texture's batches, those with
 * the same one in that of the second's, and so on. */
SLV_API uint32_t slv_gl_material_batch_count(const slv_gl_material *material);
SLV_API slv_gl_common_batch slv_gl_material_batch(const slv_gl_material *material, uint32_t index);

/* slv_gl_texture_bind of each texture, and slv_gl_texture_unbind. */
SLV_API void slv_gl_material_bind(const slv_gl_material *material, uint32_t index);
SLV_API void slv_gl_material_unbind(const slv_gl_material *material);

#ifdef __cplusplus
}
#endif

#endif
