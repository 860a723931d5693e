/* The list of those who look things up. */
#include "cache/cache_data.h"

/* A quick lookup is one piece, and not counted as such. */
uint64_t slvi_cache_count_pieces(const cache_thread *thread) {
    uint64_t lookups = atomic_load_explicit(&thread->lookups, memory_order_relaxed);
    uint64_t slow = atomic_load_explicit(&thread->slow, memory_order_relaxed);
    uint64_t pieces = atomic_load_explicit(&thread->pieces, memory_order_relaxed);
    return pieces + (lookups > slow ? lookups - slow : 0);
}

void slvi_cache_thread_begin(slv_cache *cache, cache_thread *thread) {
    memset(thread, 0, sizeof *thread);
    thread->cache = cache;
    thread->view = &cache->view;
    pthread_mutex_lock(&cache->lock);
    thread->next = cache->threads;
    cache->threads = thread;
    pthread_mutex_unlock(&cache->lock);
}

void slvi_cache_thread_end(cache_thread *thread) {
    slv_cache *cache = thread->cache;
    pthread_mutex_lock(&cache->lock);
    cache_thread **at = &cache->threads;
    while (*at != thread)
        at = &(*at)->next;
    *at = thread->next;
    cache->stats.lookups += atomic_load_explicit(&thread->lookups, memory_order_relaxed);
    cache->stats.hits += slvi_cache_count_pieces(thread);
    cache->stats.misses += atomic_load_explicit(&thread->misses, memory_order_relaxed);
    pthread_mutex_unlock(&cache->lock);
}

const slv_env *slvi_cache_env(const slv_cache *cache) {
    return &cache->env;
}
