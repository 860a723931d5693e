/* Making a cache, and counting what happens in it. */
#include "cache/cache_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <sys/mman.h>

#ifdef __linux__
#include <linux/membarrier.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

#define MIN_BYTES (UINT64_C(8) << 20)
#define MAX_BYTES (UINT64_C(64) << 30)
#define MIN_SLAB (UINT64_C(512) << 10) /* a texel of 65535 channels fits */
#define MAX_SLAB (UINT64_C(1) << 20)
#define HUGE_PAGE (UINT64_C(2) << 20)

static bool needs_fences(void) {
#ifdef __linux__
    long commands = syscall(SYS_membarrier, MEMBARRIER_CMD_QUERY, 0, 0);
    if (commands >= 0 && (commands & MEMBARRIER_CMD_PRIVATE_EXPEDITED) &&
        syscall(SYS_membarrier, MEMBARRIER_CMD_REGISTER_PRIVATE_EXPEDITED, 0, 0) == 0)
        return false;
#endif
    return true;
}

/* Where address space is limited the cache is smaller than was asked for. */
static void make_do(slv_cache *cache) {
    uint64_t fits = slvi_cache_space(cache->max_bytes, MIN_BYTES);
    if (fits < cache->max_bytes)
        slvi_logf(&cache->env, SLV_LOG_WARNING,
                  "cache: of %llu MiB of address space %llu are to be had: it makes do with those",
                  (unsigned long long)(cache->max_bytes >> 20), (unsigned long long)(fits >> 20));
    cache->max_bytes = fits;
}

static slv_result make_arena(slv_cache *cache) {
    uint64_t slab = MIN_SLAB, buckets = 1;
    while (slab < MAX_SLAB && slab * 64 < cache->max_bytes)
        slab *= 2;
    /* an offset for every 512 bytes: more blocks than that are rare */
    while (buckets * CACHE_WAYS * 512 < cache->max_bytes)
        buckets *= 2;
    cache->slab_units = (uint32_t)(slab / CACHE_UNIT);
    cache->nslabs = (uint32_t)(cache->max_bytes / slab);
    cache->open_slab = cache->nslabs;
    cache->view.bucket_mask = buckets - 1;
    cache->fixed_bytes = sizeof *cache + buckets * CACHE_WAYS * sizeof *cache->view.buckets +
                         CACHE_FILES * sizeof *cache->view.places +
                         CACHE_REQUESTS * sizeof *cache->requests +
                         cache->nslabs * (sizeof *cache->slabs + sizeof *cache->queue);
    slv_env unlimited = cache->env;
    unlimited.max_bytes = UINT64_MAX;
    slv_result result;
    if ((result =
             slvi_alloc(&unlimited, "cache", cache->nslabs, sizeof *cache->slabs, &cache->slabs)) ||
        (result =
             slvi_alloc(&unlimited, "cache", cache->nslabs, sizeof *cache->queue, &cache->queue)) ||
        (result = slvi_alloc(&unlimited, "cache", CACHE_FILES, sizeof *cache->view.places,
                             &cache->view.places)) ||
        (result = slvi_alloc(&unlimited, "cache", CACHE_REQUESTS, sizeof *cache->requests,
                             &cache->requests)))
        return result;
    if ((result = slvi_alloc_aligned(&unlimited, "cache", 64, buckets * CACHE_WAYS,
                                     sizeof *cache->view.buckets, &cache->view.buckets)))
        return result;
    cache->mapped_bytes = cache->nslabs * slab + HUGE_PAGE;
    cache->mapped = mmap(NULL, cache->mapped_bytes, PROT_READ | PROT_WRITE,
                         MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (cache->mapped == MAP_FAILED) {
        cache->mapped = NULL;
        return slvi_fail(&cache->env, SLV_ERROR_MEMORY, "cache: %llu bytes cannot be reserved",
                         (unsigned long long)(cache->nslabs * slab));
    }
    cache->view.arena = (uint8_t *)cache->mapped + HUGE_PAGE - (uintptr_t)cache->mapped % HUGE_PAGE;
#ifdef MADV_HUGEPAGE
    /* lookups at random would miss the translation of small pages */
    madvise(cache->view.arena, cache->nslabs * slab, MADV_HUGEPAGE);
#endif
    return SLV_OK;
}

slv_result slv_cache_create(const slv_env *env, const slv_cache_params *params, slv_cache **out) {
    slv_cache_params p = params ? *params : (slv_cache_params){0};
    slv_cache *cache = NULL;
    *out = NULL;
    slv_result result = slvi_alloc(env, "cache", 1, sizeof *cache, &cache);
    if (result)
        return result;
    uint64_t bytes = p.max_bytes ? p.max_bytes : UINT64_C(1) << 30;
    cache->max_bytes = bytes < MIN_BYTES ? MIN_BYTES : bytes > MAX_BYTES ? MAX_BYTES : bytes;
    cache->max_handles = p.max_files ? p.max_files : 100;
    cache->premultiply = p.premultiply;
    cache->view.fences = needs_fences();
    atomic_init(&cache->view.epoch, 1);
    pthread_mutex_init(&cache->lock, NULL);
    pthread_mutex_init(&cache->handle_lock, NULL);
    pthread_cond_init(&cache->changed, NULL);
    pthread_cond_init(&cache->requested, NULL);
    if (!(result = slvi_parallel_env_begin(env, &cache->log, &cache->env))) {
        make_do(cache);
        result = make_arena(cache);
    }
    if (result) {
        slv_cache_destroy(cache);
        return result;
    }
    *out = cache;
    return SLV_OK;
}

void slv_cache_destroy(slv_cache *cache) {
    if (!cache)
        return;
    slvi_cache_stop_worker(cache);
    for (uint32_t i = 0; i < cache->file_end; i++) {
        cache_file *file = cache_file_at(cache, i);
        if (file)
            slvi_cache_file_free(cache, file);
    }
    if (cache->mapped)
        munmap(cache->mapped, cache->mapped_bytes);
    slvi_free(cache->slabs);
    slvi_free(cache->queue);
    slvi_free(cache->view.places);
    slvi_free(cache->requests);
    slvi_free(cache->view.buckets);
    slvi_parallel_env_end(cache->log);
    pthread_cond_destroy(&cache->requested);
    pthread_cond_destroy(&cache->changed);
    pthread_mutex_destroy(&cache->handle_lock);
    pthread_mutex_destroy(&cache->lock);
    slvi_free(cache);
}

void slv_cache_get_stats(slv_cache *cache, slv_cache_stats *out) {
    pthread_mutex_lock(&cache->lock);
    *out = cache->stats;
    for (cache_thread *t = cache->threads; t; t = t->next) {
        out->lookups += atomic_load_explicit(&t->lookups, memory_order_relaxed);
        out->hits += slvi_cache_count_pieces(t);
        out->misses += atomic_load_explicit(&t->misses, memory_order_relaxed);
    }
    out->hits = out->hits > out->misses ? out->hits - out->misses : 0;
    out->bytes = slvi_cache_used_bytes(cache);
    out->peak_bytes = out->peak_bytes > out->bytes ? out->peak_bytes : out->bytes;
    out->files = cache->nfiles;
    pthread_mutex_unlock(&cache->lock);
    pthread_mutex_lock(&cache->handle_lock);
    out->bytes_read = cache->bytes_read;
    out->handles = cache->nhandles;
    out->reopened = cache->reopened;
    pthread_mutex_unlock(&cache->handle_lock);
}
