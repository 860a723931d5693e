/* Chains of levels that are filled from outside. */
#ifndef SLV_TEXTURE_LEVELS_H
#define SLV_TEXTURE_LEVELS_H

#include "texture/texture_data.h"

/* Bytes of all levels of all faces, constant ones too; SLV_ERROR_LIMIT if that is no number. */
slv_result slvi_levels_bytes(const slv_env *env, const slv_texture_desc *desc, uint64_t *out);
/* Levels that nobody filled yet, face after face and level after level in `memory`, which must
 * outlive them, or in memory of their own if it is NULL. They cannot be updated. */
slv_result slvi_levels_lay(const slv_env *env, const slv_texture_desc *desc, void *memory,
                           slv_levels **out);
/* The levels of a face one behind the other from `memory` on; with `single` that one texel is all
 * of them. `kind` of the levels is there if it is asked for. */
void slvi_levels_put(slv_levels *levels, uint32_t face, const void *memory, bool single);
slv_result slvi_levels_kinds(slv_levels *levels);
/* Where a level of such a chain is. */
void *slvi_levels_place(const slv_levels *levels, uint32_t face, uint32_t level);

#endif
