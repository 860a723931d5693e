/* Memory for texels: slabs that are filled in turn and thrown away whole, and the epochs that say
 * when nobody looks at them any more. */
#include "cache/cache_data.h"

#include <sched.h>
#include <sys/mman.h>

#ifdef __linux__
#include <linux/membarrier.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

static size_t slab_bytes(const slv_cache *cache) {
    return (size_t)cache->slab_units * CACHE_UNIT;
}

uint64_t slvi_cache_used_bytes(const slv_cache *cache) {
    return (uint64_t)cache->nbacked * slab_bytes(cache) + cache->table_held + cache->fixed_bytes;
}

void slvi_cache_note_peak(slv_cache *cache) {
    uint64_t bytes = slvi_cache_used_bytes(cache);
    if (bytes > cache->stats.peak_bytes)
        cache->stats.peak_bytes = bytes;
}

uint64_t slvi_cache_begin_epoch(slv_cache *cache) {
    uint64_t epoch = atomic_fetch_add_explicit(&cache->view.epoch, 1, memory_order_seq_cst) + 1;
#ifdef __linux__
    if (!cache->view.fences)
        syscall(SYS_membarrier, MEMBARRIER_CMD_PRIVATE_EXPEDITED, 0, 0);
#endif
    return epoch;
}

void slvi_cache_wait_for_readers(slv_cache *cache, uint64_t epoch) {
    for (cache_thread *thread = cache->threads; thread; thread = thread->next) {
        uint64_t pinned;
        while ((pinned = atomic_load_explicit(&thread->epoch, memory_order_seq_cst)) != 0 &&
               pinned < epoch)
            sched_yield();
    }
}

static void push(slv_cache *cache, uint32_t slab) {
    cache->queue[(cache->queue_first + cache->queue_count++) % cache->nslabs] = slab;
}

static uint32_t pop(slv_cache *cache) {
    uint32_t slab = cache->queue[cache->queue_first];
    cache->queue_first = (cache->queue_first + 1) % cache->nslabs;
    cache->queue_count--;
    return slab;
}

static cache_block *block_at(const slv_cache *cache, uint32_t slab, uint32_t units) {
    return (cache_block *)(void *)(cache->view.arena + slab * slab_bytes(cache) +
                                   (size_t)units * CACHE_UNIT);
}

/* Whether a good part of a slab was used lately. */
static bool is_in_use(slv_cache *cache, uint32_t slab) {
    uint32_t used = 0, units = cache->slabs[slab].units;
    for (uint32_t at = 0; at < units;) {
        cache_block *block = block_at(cache, slab, at);
        if (slvi_cache_take_use(cache, block))
            used += block->units;
        at += block->units;
    }
    return used > units / 2;
}

static void retire(slv_cache *cache, uint32_t index) {
    cache_slab *slab = &cache->slabs[index];
    for (uint32_t at = 0; at < slab->units;) {
        cache_block *block = block_at(cache, index, at);
        slvi_cache_unlink(cache, block);
        at += block->units;
    }
    slab->state = SLAB_RETIRED;
    slab->epoch = slvi_cache_begin_epoch(cache);
}

/* Retires the oldest slab that was not much used since it was last asked. False if there is none
 * that could be retired. */
static bool retire_one(slv_cache *cache) {
    uint32_t chances = cache->queue_count;
    for (uint32_t left = 2 * cache->queue_count; left; left--) {
        uint32_t index = pop(cache);
        bool busy = cache->slabs[index].pending || index == cache->open_slab;
        if (busy || (chances && is_in_use(cache, index))) {
            chances -= chances > 0;
            push(cache, index);
            continue;
        }
        retire(cache, index);
        return true;
    }
    return false;
}

static uint32_t allowed_slabs(const slv_cache *cache) {
    uint64_t taken = cache->fixed_bytes + cache->table_bytes;
    uint64_t left = taken < cache->max_bytes ? cache->max_bytes - taken : 0;
    uint64_t allowed = left / slab_bytes(cache);
    return allowed < 4 ? 4 : allowed > cache->nslabs ? cache->nslabs : (uint32_t)allowed;
}

static uint32_t find_slab(const slv_cache *cache, uint8_t state, bool backed) {
    for (uint32_t i = 0; i < cache->nslabs; i++)
        if (cache->slabs[i].state == state && cache->slabs[i].backed == backed)
            return i;
    return cache->nslabs;
}

/* An empty slab, or nslabs if all are being filled. */
static uint32_t take_slab(slv_cache *cache) {
    uint32_t none = cache->nslabs, index = find_slab(cache, SLAB_EMPTY, true);
    if (index == none && cache->nbacked < allowed_slabs(cache) &&
        (index = find_slab(cache, SLAB_EMPTY, false)) != none) {
        cache->slabs[index].backed = true;
        cache->nbacked++;
    }
    if (index == none) {
        index = find_slab(cache, SLAB_RETIRED, true);
        if (index == none && retire_one(cache))
            index = find_slab(cache, SLAB_RETIRED, true);
        if (index != none)
            slvi_cache_wait_for_readers(cache, cache->slabs[index].epoch);
    }
    return index;
}

cache_block *slvi_cache_allocate(slv_cache *cache, uint32_t units) {
    while (cache->open_slab == cache->nslabs ||
           units > cache->slab_units - cache->slabs[cache->open_slab].units) {
        uint32_t index = take_slab(cache);
        if (index == cache->nslabs) {
            pthread_cond_wait(&cache->changed, &cache->lock);
            continue;
        }
        cache_slab *slab = &cache->slabs[index];
        slab->units = 0;
        slab->state = SLAB_FILLED;
        cache->open_slab = index;
        push(cache, index);
        /* the next one is emptied ahead, so that no reader has to be waited for then */
        if (cache->nbacked >= allowed_slabs(cache) &&
            find_slab(cache, SLAB_RETIRED, true) == cache->nslabs &&
            find_slab(cache, SLAB_EMPTY, true) == cache->nslabs)
            retire_one(cache);
    }
    cache_slab *slab = &cache->slabs[cache->open_slab];
    cache_block *block = block_at(cache, cache->open_slab, slab->units);
    memset(block, 0, sizeof *block);
    block->units = units;
    slab->units += units;
    slab->pending++;
    slvi_cache_note_peak(cache);
    return block;
}

void slvi_cache_settle(slv_cache *cache, const cache_block *block) {
    size_t offset = (size_t)((const uint8_t *)block - cache->view.arena);
    cache->slabs[offset / slab_bytes(cache)].pending--;
    pthread_cond_broadcast(&cache->changed);
}

void slvi_cache_trim_slabs(slv_cache *cache) {
    while (cache->nbacked > allowed_slabs(cache)) {
        uint32_t index = find_slab(cache, SLAB_EMPTY, true);
        if (index == cache->nslabs) {
            index = find_slab(cache, SLAB_RETIRED, true);
            if (index == cache->nslabs) {
                if (!retire_one(cache))
                    pthread_cond_wait(&cache->changed, &cache->lock);
                continue;
            }
            slvi_cache_wait_for_readers(cache, cache->slabs[index].epoch);
        }
        cache_slab *slab = &cache->slabs[index];
        madvise(cache->view.arena + index * slab_bytes(cache), slab_bytes(cache), MADV_DONTNEED);
        slab->state = SLAB_EMPTY;
        slab->backed = false;
        cache->nbacked--;
    }
}
