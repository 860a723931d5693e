/* Tiles that outlive the call that filled them, since the next one often needs the same. */
#include "carry/carry.h"

#include "base/memory.h"

slv_result slvi_carry_pool_begin(const slv_env *env, const slv_mesh *mesh, slv_source *texels,
                                 carry_pool *out) {
    float *corners = NULL;
    *out = (carry_pool){.begun = true};
    pthread_mutex_init(&out->lock, NULL);
    slv_result result = slv_mesh_corners(env, mesh, NULL, &corners);
    if (result)
        slv_source_close(texels);
    else
        result = slvi_transfer_source_begin(env, mesh, texels, corners, &out->source);
    slv_free(corners);
    return result;
}

void slvi_carry_pool_end(carry_pool *pool) {
    if (!pool->begun)
        return;
    while (pool->nfree) {
        slvi_transfer_tiles_end(pool->free[--pool->nfree]);
        slvi_free(pool->free[pool->nfree]);
    }
    slvi_transfer_source_end(&pool->source);
    slv_source_close(&pool->source.texels);
    pthread_mutex_destroy(&pool->lock);
}

slv_result slvi_carry_take(carry_pool *pool, const slv_env *env, transfer_tiles **out) {
    *out = NULL;
    pthread_mutex_lock(&pool->lock);
    if (pool->nfree)
        *out = pool->free[--pool->nfree];
    pthread_mutex_unlock(&pool->lock);
    if (*out) {
        (*out)->env = env;
        return SLV_OK;
    }
    slv_result result = slvi_alloc(env, "bake: tiles", 1, sizeof **out, out);
    if (!result)
        slvi_transfer_tiles_begin(env, &pool->source, *out);
    return result;
}

void slvi_carry_put(carry_pool *pool, transfer_tiles *tiles) {
    bool kept = false;
    if (!tiles)
        return;
    pthread_mutex_lock(&pool->lock);
    if (!tiles->result && pool->nfree < sizeof pool->free / sizeof *pool->free) {
        pool->free[pool->nfree++] = tiles;
        kept = true;
    }
    pthread_mutex_unlock(&pool->lock);
    if (kept)
        return;
    slvi_transfer_tiles_end(tiles);
    slvi_free(tiles);
}
