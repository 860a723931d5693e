/* Reading ahead, by a thread of the cache's own. */
#include "cache/cache_data.h"

#include "base/log.h"
#include "base/parallel.h"

static bool is_stopping(slv_cache *cache) {
    pthread_mutex_lock(&cache->lock);
    bool stops = cache->worker_stops;
    pthread_mutex_unlock(&cache->lock);
    return stops;
}

/* Reads a face tile by tile. Tables that are thrown away meanwhile are made anew. */
static void fetch(cache_thread *thread, cache_request request) {
    slv_cache *cache = thread->cache;
    uint64_t tile = 0, ntiles = 1;
    while (tile < ntiles && !is_stopping(cache) && !slvi_cache_load_tables(cache, request.file)) {
        slv_result result = SLV_OK;
        cache_pin(thread);
        cache_tables *tables = cache_find_tables(thread->view, request.file);
        if (tables && request.face >= tables->nfaces)
            ntiles = 0;
        else if (tables) {
            cache_face *f = cache_find_face(tables, request.face);
            slv_res res = {f->res_u, f->res_v};
            slv_res part = slvi_cache_tile_res(tables, res.u, res.v);
            bool direct = res.u + res.v <= tables->whole_log2;
            ntiles = UINT64_C(1) << (res.u - part.u + res.v - part.v);
            if ((cache_flags(f) & SLV_FACE_CONSTANT) || res.u + res.v == 0)
                ntiles = 0;
            else if ((direct ? cache_find_full(thread->view, f)
                             : cache_find_hashed(thread->view, tables, request.face, res.u, res.v,
                                                 (uint32_t)tile)) ||
                     slvi_cache_load_block(thread, tables, request.face, res.u, res.v,
                                           (uint32_t)tile, &result))
                tile++;
        }
        cache_unpin(thread);
        if (result)
            return;
    }
}

static void *work(void *user) {
    slv_cache *cache = user;
    cache_thread thread;
    slvi_cache_thread_begin(cache, &thread);
    pthread_mutex_lock(&cache->lock);
    while (!cache->worker_stops) {
        if (!cache->request_count) {
            pthread_cond_wait(&cache->requested, &cache->lock);
            continue;
        }
        cache_request request = cache->requests[cache->request_first];
        cache->request_first = (cache->request_first + 1) % CACHE_REQUESTS;
        cache->request_count--;
        pthread_mutex_unlock(&cache->lock);
        fetch(&thread, request);
        pthread_mutex_lock(&cache->lock);
        cache->requests_done++;
        pthread_cond_broadcast(&cache->changed);
    }
    pthread_mutex_unlock(&cache->lock);
    slvi_cache_thread_end(&thread);
    return NULL;
}

slv_result slv_cache_prefetch(slv_cache *cache, slv_file_id file, uint32_t face) {
    slv_result result = SLV_OK;
    slv_ptx_info info;
    if ((result = slv_cache_get_info(cache, file, &info)))
        return result;
    if (face >= info.nfaces)
        return slvi_fail(&cache->env, SLV_ERROR_ARGUMENT,
                         "cache: file %u: face %u: there are %u faces", (unsigned)file,
                         (unsigned)face, (unsigned)info.nfaces);
    pthread_mutex_lock(&cache->lock);
    if (!cache->worker_runs) {
        if (slvi_thread_start(&cache->worker, work, cache) == 0)
            cache->worker_runs = true;
        else
            result = slvi_fail(&cache->env, SLV_ERROR_MEMORY, "no thread to read ahead");
    }
    if (!result && cache->request_count < CACHE_REQUESTS) {
        uint32_t at = (cache->request_first + cache->request_count++) % CACHE_REQUESTS;
        cache->requests[at] = (cache_request){file, face};
        cache->requests_made++;
        pthread_cond_signal(&cache->requested);
    }
    pthread_mutex_unlock(&cache->lock);
    return result;
}

void slv_cache_wait(slv_cache *cache) {
    pthread_mutex_lock(&cache->lock);
    uint64_t made = cache->requests_made;
    while (cache->requests_done < made)
        pthread_cond_wait(&cache->changed, &cache->lock);
    pthread_mutex_unlock(&cache->lock);
}

void slvi_cache_stop_worker(slv_cache *cache) {
    pthread_mutex_lock(&cache->lock);
    cache->worker_stops = true;
    pthread_cond_signal(&cache->requested);
    bool runs = cache->worker_runs;
    pthread_mutex_unlock(&cache->lock);
    if (runs)
        pthread_join(cache->worker, NULL);
}
