/* The list of files and sources that are open in a cache. */
#include "cache/cache_data.h"

#include "base/log.h"
#include "base/memory.h"

/* Under the lock: a place for a file, closed ones first; or NULL. */
static cache_file *take_place(slv_cache *cache, const char *name, uint32_t *place,
                              slv_result *result) {
    cache_file *file = NULL;
    *result = SLV_OK;
    if (cache->nfiles < cache->file_end)
        for (uint32_t i = 0; i < cache->file_end && !file; i++) {
            cache_file *other = cache_file_at(cache, i);
            if (!atomic_load_explicit(&other->id, memory_order_relaxed) && !other->loading) {
                file = other;
                *place = i;
            }
        }
    if (file)
        return file;
    if (cache->file_end >= CACHE_FILES - 1) {
        *result = slvi_fail(&cache->env, SLV_ERROR_LIMIT, "%s: %d files are open already", name,
                            CACHE_FILES - 1);
        return NULL;
    }
    if ((*result = slvi_alloc(&cache->env, name, 1, sizeof *file, &file)))
        return NULL;
    *place = cache->file_end++;
    atomic_store_explicit(&cache->view.places[*place], &file->place, memory_order_release);
    return file;
}

/* Gives a file its place; `path` and `source` are then its own. */
static slv_result add_file(slv_cache *cache, const char *name, const cache_file *what,
                           const slv_cache_open_params *params, slv_file_id *out) {
    uint32_t place = 0;
    slv_result result;
    pthread_mutex_lock(&cache->lock);
    cache_file *file = take_place(cache, name, &place, &result);
    if (file) {
        file->path = what->path;
        file->source = what->source;
        file->version = what->version;
        file->info = what->info;
        file->cap = params && params->max_log2_res ? params->max_log2_res : SLV_MAX_LOG2_RES;
        file->loaded_before = false;
        file->identified = false;
        file->failure = SLV_OK;
        file->generation = (file->generation & 0xffff) + 1;
        if (file->generation > 0xffff)
            file->generation = 1;
        *out = file->generation << 16 | place;
        atomic_store_explicit(&file->id, *out, memory_order_release);
        cache->nfiles++;
    }
    pthread_mutex_unlock(&cache->lock);
    return result;
}

slv_result slv_cache_open_with(slv_cache *cache, const char *path,
                               const slv_cache_open_params *params, slv_file_id *out) {
    slv_ptx *ptx = NULL;
    cache_file what = {.path = NULL};
    *out = 0;
    slv_result result = slv_ptx_open(&cache->env, path, &ptx);
    if (result)
        return result;
    what.info = *slv_ptx_get_info(ptx);
    what.info.level_faces = NULL;
    what.info.level_bytes = NULL;
    slv_ptx_close(ptx);
    if ((result = slvi_alloc(&cache->env, path, strlen(path) + 1, 1, &what.path)))
        return result;
    memcpy(what.path, path, strlen(path) + 1);
    if ((result = add_file(cache, path, &what, params, out)))
        slvi_free(what.path);
    return result;
}

slv_result slv_cache_open(slv_cache *cache, const char *path, slv_file_id *out) {
    return slv_cache_open_with(cache, path, NULL, out);
}

slv_result slv_cache_open_source(slv_cache *cache, const slv_source *source,
                                 const slv_cache_open_params *params, slv_file_id *out) {
    cache_file what = {.source = *source};
    slv_source_desc desc;
    *out = 0;
    slv_result result = source->fns->describe(source->user, &desc);
    if (!result && (!desc.nchannels || desc.nchannels > 65535 || !slv_type_size(desc.type)))
        result = slvi_fail(&cache->env, SLV_ERROR_ARGUMENT, "%s: a source of %u channels of %s",
                           desc.name, (unsigned)desc.nchannels, slv_type_name(desc.type));
    if (!result) {
        what.version = slv_source_version(source);
        what.info = (slv_ptx_info){
            .mesh_type = desc.triangles ? SLV_PTX_TRIANGLE : SLV_PTX_QUAD,
            .type = desc.type,
            .nchannels = desc.nchannels,
            .alpha_channel = desc.alpha_channel,
            .nfaces = desc.nfaces,
            .nlevels = 1,
            .border_u = desc.border_u,
            .border_v = desc.border_v,
            .edge_filter = desc.edge_filter,
        };
        result = add_file(cache, desc.name, &what, params, out);
    }
    if (result)
        slv_source_close(&what.source);
    return result;
}

cache_file *slvi_cache_find_file(slv_cache *cache, slv_file_id id) {
    for (;;) {
        cache_file *file = cache_file_at(cache, id % CACHE_FILES);
        if (!id || !file || atomic_load_explicit(&file->id, memory_order_relaxed) != id)
            return NULL;
        if (!file->loading)
            return file;
        pthread_cond_wait(&cache->changed, &cache->lock);
    }
}

slv_result slvi_cache_no_such_file(const slv_cache *cache, slv_file_id id) {
    return slvi_fail(&cache->env, SLV_ERROR_ARGUMENT, "cache: no file has the number %u",
                     (unsigned)id);
}

/* Under the lock: lets go of all that a file has, but for its source. */
static slv_source empty_file(slv_cache *cache, cache_file *file) {
    slv_source source = file->source;
    slvi_cache_drop_tables(cache, file);
    slvi_cache_failure_forget_all(&file->failures);
    if (file->changes)
        slvi_changes_end(file->changes);
    slvi_free(file->changes);
    slvi_free(file->path);
    file->changes = NULL;
    file->path = NULL;
    file->source = (slv_source){0};
    return source;
}

slv_result slv_cache_close(slv_cache *cache, slv_file_id id) {
    slv_source source = {0};
    pthread_mutex_lock(&cache->lock);
    cache_file *file = slvi_cache_find_file(cache, id);
    if (file) {
        atomic_store_explicit(&file->id, 0, memory_order_relaxed);
        /* the place is not given out before its tables are gone */
        file->loading = true;
        source = empty_file(cache, file);
        file->loading = false;
        cache->nfiles--;
        pthread_cond_broadcast(&cache->changed);
    }
    pthread_mutex_unlock(&cache->lock);
    slv_source_close(&source);
    return file ? SLV_OK : slvi_cache_no_such_file(cache, id);
}

void slvi_cache_file_free(slv_cache *cache, cache_file *file) {
    pthread_mutex_lock(&cache->lock);
    slv_source source = empty_file(cache, file);
    pthread_mutex_unlock(&cache->lock);
    slv_source_close(&source);
    slvi_free(file);
}

bool slvi_cache_info(slv_cache *cache, slv_file_id id, slv_ptx_info *out) {
    pthread_mutex_lock(&cache->lock);
    cache_file *file = cache_file_at(cache, id % CACHE_FILES);
    bool found = id && file && atomic_load_explicit(&file->id, memory_order_relaxed) == id;
    *out = found ? file->info : (slv_ptx_info){0};
    pthread_mutex_unlock(&cache->lock);
    return found;
}

slv_result slv_cache_get_info(slv_cache *cache, slv_file_id id, slv_ptx_info *out) {
    return slvi_cache_info(cache, id, out) ? SLV_OK : slvi_cache_no_such_file(cache, id);
}
