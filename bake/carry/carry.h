/* A texture, or any source of another mesh, as texels that are looked up between and across faces.
 */
#ifndef SLV_BAKE_CARRY_H
#define SLV_BAKE_CARRY_H

#include "source/source.h"
#include "transfer/transfer_data.h"

#include <pthread.h>

/* Tiles of texels for as many threads as look up at once. */
typedef struct carry_pool {
    pthread_mutex_t lock;
    transfer_source source;
    transfer_tiles *free[64];
    uint32_t nfree;
    bool begun;
} carry_pool;

/* Takes `texels`, also if it fails. `mesh` is not kept. */
slv_result slvi_carry_pool_begin(const slv_env *env, const slv_mesh *mesh, slv_source *texels,
                                 carry_pool *out);
void slvi_carry_pool_end(carry_pool *pool);
/* Tiles for one thread until they are put back; `env` is what they read with. */
slv_result slvi_carry_take(carry_pool *pool, const slv_env *env, transfer_tiles **out);
void slvi_carry_put(carry_pool *pool, transfer_tiles *tiles);

/* source_texels.c: a source of a mesh as texels: floats, light, at the resolutions `res` of its
 * faces, or at the source's own if it has some. NaN where it has no value. Neither is taken. */
slv_result slvi_carry_texels_of(const slv_env *env, const slv_mesh *mesh,
                                const slv_bake_source *source, slv_source *out);

#endif
