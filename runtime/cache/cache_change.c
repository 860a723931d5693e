/* Forgetting what was changed: files, faces, rectangles. Hits go on meanwhile; those that begin
 * after it see what is there now. */
#include "cache/cache_data.h"

#include "base/log.h"
#include "base/memory.h"
#include "texture/texture_data.h"

#define MOST_CHANGES 65536 /* more than these, and everything is forgotten */

/* Under the lock. */
static slv_result forget_all(slv_cache *cache, cache_file *file) {
    file->identified = false;
    file->failure = SLV_OK;
    slvi_cache_failure_forget_all(&file->failures);
    slvi_cache_drop_tables(cache, file);
    if (file->changes)
        slvi_changes_add_all(file->changes);
    return SLV_OK;
}

/* Handles a file, or all that are open if `id` is 0, under the lock; the first error counts. */
static slv_result for_files(slv_cache *cache, slv_file_id id,
                            slv_result (*handle)(slv_cache *cache, cache_file *file)) {
    slv_result result = SLV_OK;
    pthread_mutex_lock(&cache->lock);
    uint32_t first = id ? id % CACHE_FILES : 0, end = id ? first + 1 : cache->file_end;
    for (uint32_t i = first; i < end; i++) {
        cache_file *any = cache_file_at(cache, i);
        slv_file_id which = id    ? id
                            : any ? atomic_load_explicit(&any->id, memory_order_relaxed)
                                  : 0;
        cache_file *file = slvi_cache_find_file(cache, which);
        slv_result one = file ? handle(cache, file)
                         : id ? slvi_cache_no_such_file(cache, id)
                              : SLV_OK;
        result = result ? result : one;
    }
    pthread_mutex_unlock(&cache->lock);
    return result;
}

slv_result slv_cache_invalidate(slv_cache *cache, slv_file_id id) {
    return for_files(cache, id, forget_all);
}

/* A rectangle where axes are coarser: all texels that any of it is in. */
static slv_rect coarser(slv_rect rect, int u, int v) {
    uint32_t x = rect.x >> u, y = rect.y >> v;
    return (slv_rect){x, y, ((rect.x + rect.width - 1) >> u) + 1 - x,
                      ((rect.y + rect.height - 1) >> v) + 1 - y};
}

/* What there is of a rectangle of the face at its own resolution. */
static void unlink_rect(slv_cache *cache, cache_tables *tables, uint32_t face, slv_rect rect) {
    cache_face *f = &tables->faces[face];
    slv_res res;
    atomic_store_explicit(&f->texels, 0, memory_order_seq_cst);
    for (res.u = 0; res.u <= f->res_u; res.u++)
        for (res.v = 0; res.v <= f->res_v; res.v++) {
            if (tables->triangle && res.u != res.v)
                continue;
            slv_res tile = slvi_cache_tile_res(tables, res.u, res.v);
            slv_rect tiles = coarser(rect, f->res_u - res.u + tile.u, f->res_v - res.v + tile.v);
            for (uint32_t y = tiles.y; y < tiles.y + tiles.height; y++)
                for (uint32_t x = tiles.x; x < tiles.x + tiles.width; x++)
                    slvi_cache_unlink_tile(cache, tables, face, res, (y << (res.u - tile.u)) + x);
        }
}

/* Under the lock. `now` is the face as its source has it, `rect` is in its texels. */
static void forget_rect(slv_cache *cache, cache_file *file, cache_tables *tables, uint32_t face,
                        const slv_source_face *now, slv_rect rect) {
    cache_face *f = &tables->faces[face];
    for (cache_load *load = cache->loads; load; load = load->next)
        load->stale |= load->tables == tables && load->face == face;
    slvi_cache_failure_forget(&file->failures, face);
    if (tables->triangle) /* reductions are made of mirror images too */
        rect = (slv_rect){0, 0, 1u << now->res.u, 1u << now->res.v};
    uint32_t cap = tables->origin->cap;
    rect = coarser(rect, (uint32_t)now->res.u > cap ? now->res.u - (int)cap : 0,
                   (uint32_t)now->res.v > cap ? now->res.v - (int)cap : 0);
    /* whoever learns of the face right now may have asked before it was changed */
    while (atomic_load_explicit(&f->state, memory_order_acquire) == CACHE_BUSY)
        ;
    if (atomic_load_explicit(&f->state, memory_order_acquire) == CACHE_KNOWN) {
        slvi_cache_set_flags(tables, f, now->flags);
        unlink_rect(cache, tables, face, rect);
    }
    if (file->changes)
        slvi_changes_add(file->changes, face, rect, false);
}

/* Under the lock, after texels were unlinked: no apron shows what it shows any more. */
static void forget_aprons(cache_tables *tables) {
    uint32_t now = cache_apron_now(tables);
    atomic_store_explicit(&tables->apron, CACHE_APRON | (now + 1), memory_order_seq_cst);
}

slv_result slv_cache_invalidate_face(slv_cache *cache, slv_file_id id, uint32_t face,
                                     const slv_rect *rect) {
    slv_source_face now;
    slv_result result = SLV_OK;
    pthread_mutex_lock(&cache->lock);
    cache_file *file = slvi_cache_find_file(cache, id);
    cache_tables *tables = file ? cache_tables_of(file) : NULL;
    if (!file)
        result = slvi_cache_no_such_file(cache, id);
    else if (face >= file->info.nfaces)
        result = slvi_fail(&cache->env, SLV_ERROR_ARGUMENT,
                           "cache: file %u: face %u: there are %u faces", (unsigned)id,
                           (unsigned)face, (unsigned)file->info.nfaces);
    else if (tables) {
        const slv_source *source = &tables->origin->source;
        result = source->fns->face(source->user, face, &now);
        if (!result && rect && !slvi_rect_is_within(*rect, now.res))
            result = slvi_fail(&cache->env, SLV_ERROR_ARGUMENT,
                               "cache: file %u: face %u: the rectangle is not within it",
                               (unsigned)id, (unsigned)face);
        if (!result) {
            slv_rect all = {0, 0, 1u << now.res.u, 1u << now.res.v};
            forget_rect(cache, file, tables, face, &now, rect ? *rect : all);
            forget_aprons(tables);
        }
    } else if (file->changes)
        slvi_changes_add_all(file->changes);
    if (!result)
        file->failure = SLV_OK;
    pthread_mutex_unlock(&cache->lock);
    return result;
}

/* What a source says was changed. */
typedef struct change_list {
    slv_env env;
    slv_change *changes;
    uint32_t count, capacity;
    bool all; /* it is too much, or not known */
} change_list;

static slv_result collect(void *user, uint32_t face, slv_rect rect) {
    change_list *list = user;
    if (list->count == list->capacity) {
        uint32_t capacity = list->capacity ? 2 * list->capacity : 64;
        list->all = capacity > MOST_CHANGES || slvi_grow(&list->env, "changes", capacity,
                                                         sizeof *list->changes, &list->changes);
        if (list->all)
            return SLV_ERROR_CANCELLED;
        list->capacity = capacity;
    }
    list->changes[list->count++] = (slv_change){.face = face, .rect = rect};
    return SLV_OK;
}

/* Under the lock. */
static void forget_listed(slv_cache *cache, cache_file *file, const change_list *list) {
    cache_tables *tables = cache_tables_of(file);
    for (uint32_t i = 0; tables && i < list->count; i++) {
        const slv_change *change = &list->changes[i];
        const slv_source *source = &tables->origin->source;
        slv_source_face now;
        if (change->face < tables->nfaces && !source->fns->face(source->user, change->face, &now) &&
            slvi_rect_is_within(change->rect, now.res))
            forget_rect(cache, file, tables, change->face, &now, change->rect);
    }
    if (tables && list->count)
        forget_aprons(tables);
    if (list->count)
        file->failure = SLV_OK;
    if (!tables && list->count && file->changes)
        slvi_changes_add_all(file->changes);
}

/* Under the lock, which it lets go while it asks. Nothing of the file is closed meanwhile. */
static slv_result refresh(slv_cache *cache, cache_file *file) {
    change_list list = {.env = cache->env};
    slv_result result = SLV_OK;
    uint64_t version = file->version;
    list.env.log = NULL; /* without room for a list everything is forgotten: nothing fails */
    file->loading = true;
    pthread_mutex_unlock(&cache->lock);
    if (file->path)
        list.all = file->failure ||
                   (file->identified && !slvi_cache_handle_is_current(file->path, &file->identity));
    else if ((version = slv_source_version(&file->source)) != file->version) {
        result = slv_source_changed(&file->source, file->version, collect, &list);
        if (list.all)
            result = SLV_OK;
        list.all |= result != SLV_OK;
    }
    pthread_mutex_lock(&cache->lock);
    if (list.all)
        (void)forget_all(cache, file); /* which cannot fail */
    else
        forget_listed(cache, file, &list);
    if (!result)
        file->version = version;
    file->loading = false;
    pthread_cond_broadcast(&cache->changed);
    slvi_free(list.changes);
    return result;
}

slv_result slv_cache_refresh(slv_cache *cache, slv_file_id id) {
    return for_files(cache, id, refresh);
}
