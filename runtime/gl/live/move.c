/* An item's new layer is the next one that is free in a pool of its class; what it leaves is filled
 * by the last of the pool, so that layers in use stay together. */
#include "gl/live/move.h"

#include "gl/store/tables.h"

enum { LEAST_CAPACITY = 8 };

/* A pool of a class with a layer to spare. A new one has a quarter of the layers that there are of
 * its class, so that there are few however many items move. */
static slv_result find_pool(const slv_gl_source *source, slv_gl_store *store, slv_res res,
                            bool wide, uint32_t *index) {
    slv_gl_pools *pools = &store->pools;
    slv_gl_pool *made = NULL;
    uint64_t layers = 0;
    slv_result result;
    for (*index = 0; *index < pools->npools; (*index)++) {
        const slv_gl_pool *pool = &pools->pools[*index];
        if (pool->res.u != res.u || pool->res.v != res.v || pool->wide != wide)
            continue;
        if (pool->nlayers < pool->capacity)
            return SLV_OK;
        layers += pool->capacity;
    }
    layers = layers / 4 > LEAST_CAPACITY ? layers / 4 : LEAST_CAPACITY;
    if ((result = slvi_gl_pools_add(
             source, res, wide, layers < UINT32_MAX ? (uint32_t)layers : UINT32_MAX, pools, &made)))
        return result;
    return slvi_gl_store_make_pool(source, store, made);
}

static bool is_wide(const slv_gl_store *store, uint32_t item) {
    return store->wide[item] && !store->pools.format.block;
}

bool slvi_gl_move_needed(const slv_gl_store *store, uint32_t item) {
    const slv_gl_pool *pool = &store->pools.pools[store->pools.pool_of[item]];
    slv_res res = store->pools.form->res(store->made, item);
    return pool->res.u != res.u || pool->res.v != res.v || pool->wide != is_wide(store, item);
}

slv_result slvi_gl_move_item(const slv_gl_source *source, slv_gl_store *store, uint32_t item,
                             uint32_t *filler) {
    slv_gl_pools *pools = &store->pools;
    uint32_t to = 0;
    slv_result result =
        find_pool(source, store, pools->form->res(store->made, item), is_wide(store, item), &to);
    if (result)
        return result;
    slvi_gl_pools_take(pools, item, filler);
    slvi_gl_pools_give(pools, item, to);
    return SLV_OK;
}

void slvi_gl_move_row(const slv_gl_source *source, const slv_gl_store *store, uint32_t face) {
    uint32_t row[2];
    slvi_gl_face_row(source, &store->pools, store->made, face, row);
    source->gl->api.NamedBufferSubData(store->table, (GLintptr)(face * sizeof row), sizeof row,
                                       row);
}

slv_result slvi_gl_move_end(const slv_gl_source *source, slv_gl_store *store) {
    slv_result result = slvi_gl_pools_list(source->env, &store->pools);
    if (result || store->pools.packing != SLV_GL_PAGES)
        return result;
    GLuint old = store->rects;
    uint64_t bytes = 0;
    if ((result = slvi_gl_level_table(source, &store->pools, &store->rects, &bytes)))
        return result;
    source->gl->api.DeleteBuffers(1, &old);
    store->bytes += bytes - store->rect_bytes;
    store->rect_bytes = bytes;
    return SLV_OK;
}
