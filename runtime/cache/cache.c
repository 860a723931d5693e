/* Making a cache, and the list of its files. */
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
    cache->bucket_mask = buckets - 1;
    cache->fixed_bytes = sizeof *cache + buckets * CACHE_WAYS * sizeof *cache->buckets +
                         CACHE_FILES * sizeof *cache->files +
                         CACHE_REQUESTS * sizeof *cache->requests +
                         cache->nslabs * (sizeof *cache->slabs + sizeof *cache->queue);
    slv_env unlimited = cache->env;
    unlimited.max_bytes = UINT64_MAX;
    slv_result result;
    if ((result =
             slvi_alloc(&unlimited, "cache", cache->nslabs, sizeof *cache->slabs, &cache->slabs)) ||
        (result =
             slvi_alloc(&unlimited, "cache", cache->nslabs, sizeof *cache->queue, &cache->queue)) ||
        (result =
             slvi_alloc(&unlimited, "cache", CACHE_FILES, sizeof *cache->files, &cache->files)) ||
        (result = slvi_alloc(&unlimited, "cache", CACHE_REQUESTS, sizeof *cache->requests,
                             &cache->requests)))
        return result;
    if ((result = slvi_alloc_aligned(&unlimited, "cache", 64, buckets * CACHE_WAYS,
                                     sizeof *cache->buckets, &cache->buckets)))
        return result;
    cache->mapped_bytes = cache->nslabs * slab + HUGE_PAGE;
    cache->mapped = mmap(NULL, cache->mapped_bytes, PROT_READ | PROT_WRITE,
                         MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (cache->mapped == MAP_FAILED) {
        cache->mapped = NULL;
        return slvi_fail(&cache->env, SLV_ERROR_MEMORY, "cache: %llu bytes cannot be reserved",
                         (unsigned long long)(cache->nslabs * slab));
    }
    cache->arena = (uint8_t *)cache->mapped + HUGE_PAGE - (uintptr_t)cache->mapped % HUGE_PAGE;
#ifdef MADV_HUGEPAGE
    /* lookups at random would miss the translation of small pages */
    madvise(cache->arena, cache->nslabs * slab, MADV_HUGEPAGE);
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
    cache->fences = needs_fences();
    atomic_init(&cache->epoch, 1);
    pthread_mutex_init(&cache->lock, NULL);
    pthread_mutex_init(&cache->handle_lock, NULL);
    pthread_cond_init(&cache->changed, NULL);
    pthread_cond_init(&cache->requested, NULL);
    if ((result = slvi_parallel_env_begin(env, &cache->log, &cache->env)) ||
        (result = make_arena(cache))) {
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
        cache_file *file = atomic_load(&cache->files[i]);
        if (file) {
            pthread_mutex_lock(&cache->lock);
            slvi_cache_drop_tables(cache, file);
            pthread_mutex_unlock(&cache->lock);
            slvi_free(file->path);
            slvi_free(file);
        }
    }
    if (cache->mapped)
        munmap(cache->mapped, cache->mapped_bytes);
    slvi_free(cache->slabs);
    slvi_free(cache->queue);
    slvi_free(cache->files);
    slvi_free(cache->requests);
    slvi_free(cache->buckets);
    slvi_parallel_env_end(cache->log);
    pthread_cond_destroy(&cache->requested);
    pthread_cond_destroy(&cache->changed);
    pthread_mutex_destroy(&cache->handle_lock);
    pthread_mutex_destroy(&cache->lock);
    slvi_free(cache);
}

/* Under the lock: a place for a file, closed ones first; or NULL. */
static cache_file *take_place(slv_cache *cache, const char *path, uint32_t *place,
                              slv_result *result) {
    cache_file *file = NULL;
    *result = SLV_OK;
    if (cache->nfiles < cache->file_end)
        for (uint32_t i = 0; i < cache->file_end && !file; i++) {
            cache_file *other = atomic_load_explicit(&cache->files[i], memory_order_relaxed);
            if (!atomic_load_explicit(&other->id, memory_order_relaxed) && !other->loading) {
                file = other;
                *place = i;
            }
        }
    if (file)
        return file;
    if (cache->file_end >= CACHE_FILES - 1) {
        *result = slvi_fail(&cache->env, SLV_ERROR_LIMIT, "%s: %d files are open already", path,
                            CACHE_FILES - 1);
        return NULL;
    }
    if ((*result = slvi_alloc(&cache->env, path, 1, sizeof *file, &file)))
        return NULL;
    *place = cache->file_end++;
    atomic_store_explicit(&cache->files[*place], file, memory_order_release);
    return file;
}

slv_result slv_cache_open(slv_cache *cache, const char *path, slv_file_id *out) {
    slv_ptx *ptx = NULL;
    char *copy = NULL;
    uint32_t place = 0;
    *out = 0;
    slv_result result = slv_ptx_open(&cache->env, path, &ptx);
    if (result)
        return result;
    slv_ptx_info info = *slv_ptx_get_info(ptx);
    slv_ptx_close(ptx);
    info.level_faces = NULL;
    info.level_bytes = NULL;
    if ((result = slvi_alloc(&cache->env, path, strlen(path) + 1, 1, &copy)))
        return result;
    memcpy(copy, path, strlen(path) + 1);
    pthread_mutex_lock(&cache->lock);
    cache_file *file = take_place(cache, path, &place, &result);
    if (file) {
        slvi_free(file->path);
        file->path = copy;
        copy = NULL;
        file->info = info;
        file->loaded_before = false;
        file->identified = false;
        file->generation = (file->generation & 0xffff) + 1;
        if (file->generation > 0xffff)
            file->generation = 1;
        *out = file->generation << 16 | place;
        atomic_store_explicit(&file->id, *out, memory_order_release);
        cache->nfiles++;
    }
    pthread_mutex_unlock(&cache->lock);
    slvi_free(copy);
    return result;
}

/* Under the lock: a file that is open and that nobody is loading, or NULL. */
static cache_file *find_file(slv_cache *cache, slv_file_id id) {
    for (;;) {
        cache_file *file =
            atomic_load_explicit(&cache->files[id % CACHE_FILES], memory_order_relaxed);
        if (!id || !file || atomic_load_explicit(&file->id, memory_order_relaxed) != id)
            return NULL;
        if (!file->loading)
            return file;
        pthread_cond_wait(&cache->changed, &cache->lock);
    }
}

slv_result slv_cache_close(slv_cache *cache, slv_file_id id) {
    pthread_mutex_lock(&cache->lock);
    cache_file *file = find_file(cache, id);
    if (file) {
        atomic_store_explicit(&file->id, 0, memory_order_relaxed);
        /* the place is not given out before its tables are gone */
        file->loading = true;
        slvi_cache_drop_tables(cache, file);
        file->loading = false;
        cache->nfiles--;
        pthread_cond_broadcast(&cache->changed);
    }
    pthread_mutex_unlock(&cache->lock);
    return file ? SLV_OK : SLV_ERROR_ARGUMENT;
}

slv_result slv_cache_invalidate(slv_cache *cache, slv_file_id id) {
    slv_result result = SLV_OK;
    pthread_mutex_lock(&cache->lock);
    for (uint32_t i = id ? id % CACHE_FILES : 0; i < (id ? id % CACHE_FILES + 1 : cache->file_end);
         i++) {
        cache_file *any = atomic_load_explicit(&cache->files[i], memory_order_relaxed);
        slv_file_id which = id    ? id
                            : any ? atomic_load_explicit(&any->id, memory_order_relaxed)
                                  : 0;
        cache_file *file = find_file(cache, which);
        if (file) {
            file->identified = false;
            slvi_cache_drop_tables(cache, file);
        } else if (id)
            result = SLV_ERROR_ARGUMENT;
    }
    pthread_mutex_unlock(&cache->lock);
    return result;
}

slv_result slv_cache_get_info(slv_cache *cache, slv_file_id id, slv_ptx_info *out) {
    pthread_mutex_lock(&cache->lock);
    cache_file *file = atomic_load_explicit(&cache->files[id % CACHE_FILES], memory_order_relaxed);
    bool found = id && file && atomic_load_explicit(&file->id, memory_order_relaxed) == id;
    *out = found ? file->info : (slv_ptx_info){0};
    pthread_mutex_unlock(&cache->lock);
    return found ? SLV_OK : SLV_ERROR_ARGUMENT;
}

/* A quick lookup is one piece, and not counted as such. */
static uint64_t count_pieces(const cache_thread *thread) {
    uint64_t lookups = atomic_load_explicit(&thread->lookups, memory_order_relaxed);
    uint64_t slow = atomic_load_explicit(&thread->slow, memory_order_relaxed);
    uint64_t pieces = atomic_load_explicit(&thread->pieces, memory_order_relaxed);
    return pieces + (lookups > slow ? lookups - slow : 0);
}

void slv_cache_get_stats(slv_cache *cache, slv_cache_stats *out) {
    pthread_mutex_lock(&cache->lock);
    *out = cache->stats;
    for (cache_thread *t = cache->threads; t; t = t->next) {
        out->lookups += atomic_load_explicit(&t->lookups, memory_order_relaxed);
        out->hits += count_pieces(t);
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

void slvi_cache_thread_begin(slv_cache *cache, cache_thread *thread) {
    memset(thread, 0, sizeof *thread);
    thread->cache = cache;
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
    cache->stats.hits += count_pieces(thread);
    cache->stats.misses += atomic_load_explicit(&thread->misses, memory_order_relaxed);
    pthread_mutex_unlock(&cache->lock);
    slv_ptx_reader_destroy(thread->reader);
}
