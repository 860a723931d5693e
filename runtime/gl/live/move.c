/* An item's new layer is the next one that is free in a pool of its class; what it leaves is filled
 * by the last of the pool, so that layers in use stay together, and that by one of a pool that has
 * few, so that arrays empty and go. */
#include "gl/live/move.h"

#include "base/log.h"
#include "gl/store/tables.h"

enum { LEAST_LAYERS = 8 };
#define NO_POOL UINT32_MAX
#define LEAST_BYTES (UINT64_C(128) << 10)

static bool is_of_class(const slv_gl_pool *pool, slv_res res, bool wide) {
    return pool->capacity && pool->res.u == res.u && pool->res.v == res.v && pool->wide == wide;
}

/* A pool of a class with a layer to spare, or the number of pools; and how many layers a new one
 * gets: an eighth of those that there are of its class, so that there are few pools however many
 * items move. */
static slv_result look_for_pool(const slv_gl_source *source, const slv_gl_store *store, slv_res res,
                                bool wide, uint32_t *index, uint32_t *capacity) {
    const slv_gl_pools *pools = &store->pools;
    uint64_t layers = 0, bytes = 0;
    *capacity = 0;
    for (*index = 0; *index < pools->npools; (*index)++) {
        const slv_gl_pool *pool = &pools->pools[*index];
        if (!is_of_class(pool, res, wide))
            continue;
        if (pool->nlayers + pool->reserved < pool->capacity)
            return SLV_OK;
        layers += pool->capacity;
    }
    slv_result result = slvi_gl_class_bytes(source, pools, res, wide, &bytes);
    if (result)
        return result;
    uint64_t little = source->array_bytes ? source->array_bytes : LEAST_BYTES;
    uint64_t least = LEAST_LAYERS * bytes <= little ? LEAST_LAYERS : 1 + little / bytes;
    layers = layers / 8 > least ? layers / 8 : least;
    *capacity = layers < UINT32_MAX ? (uint32_t)layers : UINT32_MAX;
    return SLV_OK;
}

/* What one more pool takes besides its layers: coverage, and a row of the table of levels. */
static uint64_t pool_bytes(const slv_gl_store *store, slv_res res) {
    uint64_t bytes = store->pools.packing == SLV_GL_PAGES ? 16 * SLV_GL_LEVEL_ROWS : 0;
    for (uint32_t level = 0; store->coverage && level < slv_res_level_count(res); level++)
        bytes += slvi_texels_in(slv_res_level(res, level));
    return bytes;
}

/* Makes a pool of a class, of at most `capacity` layers, within *room bytes; if there is none
 * *index is as it was. */
static slv_result add_pool(const slv_gl_source *source, slv_gl_store *store, slv_res res, bool wide,
                           uint32_t capacity, uint64_t *room, uint32_t *index) {
    slv_gl_pools *pools = &store->pools;
    slv_gl_pool *pool = NULL;
    uint64_t each, extra = pool_bytes(store, res);
    slv_result result = slvi_gl_class_bytes(source, pools, res, wide, &each);
    if (result || *room < extra + each)
        return result;
    uint64_t most = (*room - extra) / each;
    capacity = most < capacity ? (uint32_t)most : capacity;
    if ((result = slvi_gl_pools_add(source, res, wide, capacity, pools, &pool)) ||
        (result = slvi_gl_store_make_pool(source, store, pool)))
        return result;
    *index = (uint32_t)(pool - pools->pools);
    if (*room != UINT64_MAX)
        *room -= extra + each * pool->capacity;
    return SLV_OK;
}

/* A pool of a class for an item, also of layers that are reserved if it is one of those that they
 * are reserved for; NO_POOL if there is no room. */
static slv_result find_pool(const slv_gl_source *source, slv_gl_store *store, slv_res res,
                            bool wide, bool reserved, uint64_t *room, uint32_t *index) {
    uint32_t none, capacity;
    for (*index = 0; *index < store->pools.npools; (*index)++) {
        const slv_gl_pool *pool = &store->pools.pools[*index];
        if (is_of_class(pool, res, wide) &&
            pool->nlayers + (reserved ? 0 : pool->reserved) < pool->capacity)
            return SLV_OK;
    }
    *index = NO_POOL;
    slv_result result = look_for_pool(source, store, res, wide, &none, &capacity);
    return result ? result : add_pool(source, store, res, wide, capacity, room, index);
}

/* An item has got what was reserved for it, in a pool or instead of it. */
static void end_reservation(slv_gl_pools *pools, slv_res res, slv_gl_pool *in) {
    for (uint32_t p = 0; p < pools->npools && !in->reserved; p++)
        if (is_of_class(&pools->pools[p], res, false) && pools->pools[p].reserved)
            in = &pools->pools[p];
    in->reserved -= in->reserved > 0;
}

enum { MOST_RESERVED = 64 };

struct reservation {
    const slv_gl_source *source;
    slv_gl_store *store;
    uint64_t room;
    uint32_t pools[MOST_RESERVED], count; /* each for a layer */
    slv_res from, to;                     /* what squares may become, both included */
    bool exact;                           /* and nothing else */
    bool fits;
};

/* Makes sure of a layer of a class, in a new array if need be. */
static slv_result reserve(struct reservation *r, slv_res res) {
    uint32_t index, capacity;
    slv_result result = look_for_pool(r->source, r->store, res, false, &index, &capacity);
    if (!result && capacity) {
        index = NO_POOL;
        result = add_pool(r->source, r->store, res, false, capacity, &r->room, &index);
    }
    r->fits = !result && index != NO_POOL && r->count < MOST_RESERVED;
    if (!r->fits)
        return result;
    r->store->pools.pools[index].reserved++;
    r->pools[r->count++] = index;
    return SLV_OK;
}

static int8_t side_for(slv_res res) {
    return (int8_t)((res.u + res.v + 1) / 2);
}

/* Of a square what it may become: from the least that its face asks for to the most, or to what it
 * is. */
static slv_result reserve_square(void *user, uint32_t item) {
    struct reservation *r = user;
    slv_res own = r->store->pools.pools[r->store->pools.pool_of[item]].res;
    slv_res to = own.u > r->to.u && !r->exact ? own : r->to;
    slv_result result = SLV_OK;
    for (slv_res res = r->from; !result && r->fits && res.u <= to.u; res.u++, res.v++)
        if (res.u != own.u)
            result = reserve(r, res);
    return result;
}

/* Squares are as large as the larger of their two faces asks for. */
static slv_result reserve_squares(struct reservation *r, const slv_texture_desc *desc,
                                  uint32_t face, slv_res res) {
    const slv_form *form = r->store->pools.form;
    const slv_adjacency *adjacency = r->source->adjacency;
    slv_res old = slv_levels_get_desc(r->source->levels)->res[face];
    uint32_t items[SLV_FORM_ITEMS], count = form->items(r->store->made, face, items);
    slv_form_room room = {0};
    slv_form_change change = {face, {0, 0, 1u << old.u, 1u << old.v}};
    slv_result result = SLV_OK;
    int8_t side = side_for(res);
    r->from = r->to = (slv_res){side, side};
    if (slv_adjacency_is_subface(adjacency, (int32_t)face)) {
        r->to.u = ++r->to.v; /* its squares are larger, and so may those around it be */
        result = form->stale(r->store->made, &change, 1, &room, reserve_square, r);
        slv_form_room_end(&room);
        return result;
    }
    for (uint32_t edge = 0; !result && r->fits && edge < count; edge++) {
        slv_neighbour across[2];
        uint32_t n = slv_adjacency_neighbours(adjacency, (int32_t)face, edge, across);
        int8_t other = n ? side_for(desc->res[across[0].face]) : side;
        r->exact = n == 0 || (n == 1 && across[0].scale == 1);
        r->from.u = r->from.v = r->exact && other > side ? other : side;
        r->to = r->from;
        result = reserve_square(r, items[edge]);
    }
    return result;
}

slv_result slvi_gl_move_reserve(const slv_gl_live *live, slv_gl_store *store, uint32_t face,
                                slv_res res, uint64_t room, bool *fits) {
    struct reservation r = {.source = &live->source, .store = store, .room = room, .fits = true};
    uint32_t items[SLV_FORM_ITEMS];
    slv_result result = store->pools.form->items(store->made, face, items) == 1
                            ? reserve(&r, res)
                            : reserve_squares(&r, slv_texture_get_desc(live->texture), face, res);
    while (!r.fits && r.count)
        store->pools.pools[r.pools[--r.count]].reserved--;
    *fits = r.fits;
    return result;
}

/* An array that nothing is in any more. */
static void drop(const slv_gl_source *source, slv_gl_store *store, slv_gl_pool *pool) {
    slvi_gl_delete(source->gl->api.DeleteTextures, &pool->texture);
    for (uint32_t level = 0; pool->coverage && level < pool->nlevels; level++) {
        slv_res res = slv_res_level(pool->res, level);
        store->coverage_bytes -= (uint64_t)1 << (res.u + res.v);
    }
    slvi_gl_delete(source->gl->api.DeleteTextures, &pool->coverage);
    store->bytes -= slvi_gl_layer_bytes(&store->pools, pool) * pool->capacity;
    slvi_gl_pools_drop(pool);
}

static bool is_wide(const slv_gl_store *store, uint32_t item) {
    return store->wide[item] && !store->pools.format.block;
}

bool slvi_gl_move_needed(const slv_gl_store *store, uint32_t item, slv_res res) {
    const slv_gl_pool *pool = &store->pools.pools[store->pools.pool_of[item]];
    return pool->res.u != res.u || pool->res.v != res.v || pool->wide != is_wide(store, item);
}

/* The pool of a class that is soonest empty, of those that were not made with the texture. */
static slv_gl_pool *soonest_empty(slv_gl_pools *pools, const slv_gl_pool *of) {
    slv_gl_pool *soonest = NULL;
    for (uint32_t p = 0; p < pools->npools; p++) {
        slv_gl_pool *pool = &pools->pools[p];
        if (pool->own_items && pool->nlayers && is_of_class(pool, of->res, of->wide) &&
            (!soonest || pool->nlayers < soonest->nlayers))
            soonest = pool;
    }
    return soonest;
}

/* The parameters are what moves where, and what becomes of it. */
slv_result slvi_gl_move_item(const slv_gl_source *source, slv_gl_store *store, uint32_t item,
                             slv_res res, uint64_t *room, uint32_t fillers[2], bool *waits) {
    slv_gl_pools *pools = &store->pools;
    slv_res old = pools->pools[pools->pool_of[item]].res;
    uint32_t to = NO_POOL;
    bool wide = is_wide(store, item), resized = res.u != old.u || res.v != old.v;
    slv_result result = find_pool(source, store, res, wide, resized && !wide, room, &to);
    fillers[0] = fillers[1] = item;
    *waits = !result && to == NO_POOL;
    if (*waits && !resized)
        return SLV_OK;
    if (*waits) /* narrow layers are reserved where room is short */
        result = find_pool(source, store, res, false, true, room, &to);
    if (!result && to == NO_POOL)
        return slvi_fail(source->env, SLV_ERROR_LIMIT, "no room on the GPU for %s %u",
                         pools->form->item, item);
    if (result)
        return result;
    if (resized)
        end_reservation(pools, res, &pools->pools[to]);
    uint32_t from = pools->pool_of[item], none;
    slvi_gl_pools_take(pools, item, &fillers[0]);
    slvi_gl_pools_give(pools, item, to);
    slv_gl_pool *left = &pools->pools[from], *other = soonest_empty(pools, left);
    if (!left->nlayers || !other || other == left)
        return SLV_OK;
    fillers[1] = other->items[other->nlayers - 1];
    slvi_gl_pools_take(pools, fillers[1], &none);
    slvi_gl_pools_give(pools, fillers[1], from);
    return SLV_OK;
}

void slvi_gl_move_sweep(const slv_gl_source *source, slv_gl_store *store) {
    for (uint32_t p = 0; p < store->pools.npools; p++) {
        slv_gl_pool *pool = &store->pools.pools[p];
        pool->reserved = 0;
        if (pool->own_items && !pool->nlayers)
            drop(source, store, pool);
    }
}

void slvi_gl_move_row(const slv_gl_source *source, const slv_gl_store *store, uint32_t face) {
    uint32_t row[2];
    slvi_gl_face_row(source, &store->pools, store->made, face, row);
    source->gl->api.NamedBufferSubData(store->table, (GLintptr)(face * sizeof row), sizeof row,
                                       row);
}

slv_result slvi_gl_move_end(const slv_gl_source *source, slv_gl_store *store) {
    slvi_gl_move_sweep(source, store);
    slv_result result = slvi_gl_pools_list(source->env, &store->pools);
    if (result || store->pools.packing != SLV_GL_PAGES)
        return result;
    store->bytes -= store->rect_bytes;
    store->rect_bytes = 0;
    slvi_gl_delete(source->gl->api.DeleteBuffers, &store->rects);
    result = slvi_gl_level_table(source, &store->pools, &store->rects, &store->rect_bytes);
    store->bytes += store->rect_bytes;
    return result;
}
