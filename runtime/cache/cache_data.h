/* The cache from the inside. What lookups touch when all is there is inline here; the rest, which
 * locks, is in cache_*.c.
 *
 * Memory is one reserved range of addresses, cut into slabs. Blocks of texels are appended to the
 * open slab; a full slab is thrown away as a whole when room is needed and little of it was used
 * lately. A block is found through its face (an untiled face at full resolution) or through a hash
 * table (all else). Both hold offsets into the range, in units of 16 bytes, and are changed under
 * the lock only.
 *
 * Lookups run between cache_pin and cache_unpin, which write an epoch to the sampler's own memory.
 * A slab whose blocks were unlinked in some epoch is used anew, and tables are freed, when every
 * pinned sampler has a later one (epoch-based reclamation, Fraser 2004). */
#ifndef SLV_FILTER_CACHE_DATA_H
#define SLV_FILTER_CACHE_DATA_H

#include <selvage/cache.h>

#include "base/log.h"
#include "base/parallel.h"

#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

#define CACHE_UNIT 16          /* bytes */
#define CACHE_HEADER 32        /* bytes in front of a block's texels */
#define CACHE_PADDING 32       /* bytes behind them, which vectors may read */
#define CACHE_FILES 65536      /* a file id has its place in the low 16 bits */
#define CACHE_APRON UINT32_MAX /* instead of a tile: coarse texels with those around */
#define CACHE_WAYS 8           /* offsets in a bucket of the hash table: a line of memory */

/* Texels of a face at one resolution, or a tile of them, follow this. */
typedef struct cache_block {
    uint32_t serial; /* of the tables that it belongs to; 0: never came to be */
    uint32_t face, tile;
    int8_t res_u, res_v;
    _Atomic(uint8_t) used; /* since the slab was last looked over */
    bool direct;           /* found through its face, not through the hash table */
    uint32_t units;        /* its length, this included */
    uint32_t place;        /* of the file */
    uint32_t note;         /* of whoever made it */
    uint32_t unused;
} cache_block;

_Static_assert(sizeof(cache_block) == CACHE_HEADER, "texels are aligned");

enum { CACHE_UNKNOWN = 0, CACHE_KNOWN = 1, CACHE_BUSY = 2 };

/* A face: half a line of memory, which is all that a lookup needs besides texels. */
typedef struct cache_face {
    int32_t adjacent[4];
    uint8_t edges; /* adjacent edge e in bits 2e and 2e+1 */
    uint8_t flags; /* SLV_FACE_... */
    int8_t res_u, res_v;
    _Atomic(uint32_t) texels; /* where they are at full resolution, or 0 */
    _Atomic(uint32_t) apron;  /* where the apron is that was made last, or 0 */
    _Atomic(uint8_t) state, used;
    bool plain;              /* most lookups can be done quickly: no sub-face, and not constant */
    _Atomic(uint8_t) around; /* what the faces around it are like, once somebody asked */
} cache_face;

_Static_assert(sizeof(cache_face) == 32, "two faces to a line");

/* What is known of a file, texels excepted. Immutable while linked, but for the faces. */
typedef struct cache_tables {
    slv_ptx *ptx;
    struct cache_handle *handle;
    cache_face *faces; /* filled in one by one */
    const uint8_t *averages;
    slv_file_id id;
    uint32_t nfaces, nchannels, pixel_size, serial, place;
    slv_type type;
    slv_border_mode border_u, border_v;
    bool tanvec, triangle;
    bool simple;      /* quads of up to four channels, none of them vectors */
    int whole_log2;   /* more texels than 2^this come in tiles */
    float one, scale; /* what stands for 1, and its inverse */
    uint64_t bytes;
    _Atomic(uint32_t) users; /* threads that read from ptx */
    _Atomic(uint8_t) used;
    bool dropped; /* under the lock */
} cache_tables;

/* What tells a file from another that took its place, and from itself rewritten. */
typedef struct cache_identity {
    uint64_t device, inode, size;
    int64_t seconds, nanoseconds;
} cache_identity;

/* A file's bytes, through handles that come and go. */
typedef struct cache_handle {
    struct slv_cache *cache;
    char *path;
    int descriptor; /* or -1 */
    uint32_t readers, owners;
    uint64_t turn; /* when it was last used */
    bool opened_before;
    _Atomic(bool) changed; /* it is not the file any more that it was */
    _Atomic(int) error;    /* why the last read failed: an errno, or 0 */
    cache_identity identity;
    struct cache_handle *next;
} cache_handle;

typedef struct cache_file {
    _Atomic(cache_tables *) tables; /* NULL until needed, and again after being thrown away */
    _Atomic(slv_file_id) id;        /* 0: closed */
    uint32_t generation;
    char *path;
    slv_ptx_info info;
    cache_identity identity; /* since it was first loaded, or invalidated */
    bool loading, loaded_before, identified;
} cache_file;

enum { SLAB_EMPTY, SLAB_FILLED, SLAB_RETIRED };

typedef struct cache_slab {
    uint32_t units;   /* filled */
    uint32_t pending; /* blocks that are being read */
    uint64_t epoch;   /* of its retirement */
    uint8_t state;
    bool backed; /* has memory behind it */
} cache_slab;

/* A block that some thread is reading. */
typedef struct cache_load {
    const cache_tables *tables;
    uint32_t face, tile;
    int8_t res_u, res_v;
    struct cache_load *next;
} cache_load;

/* A thread that may be pinned. */
typedef struct cache_thread {
    _Atomic(uint64_t) epoch; /* 0: not pinned */
    struct slv_cache *cache;
    uint64_t moves; /* how often it was unpinned on its way */
    _Atomic(uint64_t) lookups, slow, pieces, misses;
    slv_ptx_reader *reader;
    uint32_t reader_serial;
    struct cache_thread *next;
} cache_thread;

#define CACHE_REQUESTS 4096

typedef struct cache_request {
    slv_file_id file;
    uint32_t face;
} cache_request;

struct slv_cache {
    /* read by every lookup, written seldom */
    uint8_t *arena;
    _Atomic(uint64_t) epoch;
    bool fences; /* the operating system cannot make other threads' writes visible: fences must */
    uint64_t bucket_mask;
    _Atomic(uint64_t) *buckets; /* offset in the low half, hash in the high half */
    _Atomic(cache_file *) *files;

    void *mapped; /* holds the arena */
    size_t mapped_bytes;
    slv_env env;
    slv_parallel_log *log;
    bool premultiply;
    uint64_t max_bytes;
    uint32_t max_handles;

    pthread_mutex_t lock;
    pthread_cond_t changed;
    uint32_t slab_units, nslabs, open_slab; /* the open one is nslabs when there is none */
    cache_slab *slabs;
    uint32_t *queue; /* filled slabs, the oldest first: a ring */
    uint32_t queue_first, queue_count, queue_capacity, nbacked;
    cache_load *loads;
    cache_thread *threads;
    uint32_t nfiles, file_end, next_serial, file_hand;
    uint64_t table_bytes; /* promised to tables, of which those of table_held are there */
    uint64_t table_held, fixed_bytes;
    uint32_t table_waiters; /* threads that wait for room for tables */
    slv_cache_stats stats;

    pthread_mutex_t handle_lock;
    cache_handle *handles;
    uint32_t nhandles;
    uint64_t handle_turn, bytes_read, reopened;

    pthread_t worker;
    bool worker_runs, worker_stops;
    pthread_cond_t requested;
    cache_request *requests;
    uint32_t request_first, request_count;
    uint64_t requests_made, requests_done;
};

/* cache.c */
void slvi_cache_thread_begin(slv_cache *cache, cache_thread *thread);
void slvi_cache_thread_end(cache_thread *thread);

/* cache_slab.c; all under the lock, the caller not pinned */
/* Room for a block of `units`; its slab has one more pending, until it is settled. May let go of
 * the lock. */
cache_block *slvi_cache_allocate(slv_cache *cache, uint32_t units);
void slvi_cache_settle(slv_cache *cache, const cache_block *block);
/* Gives slabs back, as far as tables need the room. May let go of the lock. */
void slvi_cache_trim_slabs(slv_cache *cache);
/* All that counts against the limit. */
uint64_t slvi_cache_used_bytes(const slv_cache *cache);
void slvi_cache_note_peak(slv_cache *cache);
/* Begins an epoch after something was unlinked; returns it. */
uint64_t slvi_cache_begin_epoch(slv_cache *cache);
/* Waits until no thread can see what was unlinked before that epoch. */
void slvi_cache_wait_for_readers(slv_cache *cache, uint64_t epoch);

/* cache_tables.c; those that take an id lock by themselves, the others are called under the lock.
 */
/* Makes the tables of a file. */
slv_result slvi_cache_load_tables(slv_cache *cache, slv_file_id id);
void slvi_cache_drop_tables(slv_cache *cache, cache_file *file);
void slvi_cache_learn_face(cache_tables *tables, uint32_t face);
/* How texels of this resolution are cut. */
slv_res slvi_cache_tile_res(const cache_tables *tables, int res_u, int res_v);

/* cache_load.c */
/* What cache_find_block did not find: unpins, reads and pins again. NULL with SLV_OK in *result if
 * the tables were dropped meanwhile: they must not be looked at again. */
const uint8_t *slvi_cache_load_block(cache_thread *thread, cache_tables *tables, uint32_t face,
                                     int res_u, int res_v, uint32_t tile, slv_result *result);
/* Puts in texels that the caller made of others: lets go of its pin as slvi_cache_load_block does.
 * NULL if the tables were dropped. */
const uint8_t *slvi_cache_publish(cache_thread *thread, cache_tables *tables, uint32_t face,
                                  int res_u, int res_v, uint32_t tile, const void *texels,
                                  size_t bytes, uint32_t note);
/* Whether a block can be found, and was looked at since this was last asked. */
bool slvi_cache_take_use(slv_cache *cache, cache_block *block);
void slvi_cache_unlink(slv_cache *cache, cache_block *block);

/* cache_handle.c */
/* A handle, and a source that opens the file when it is read from and closes it when others need
 * the handle. `identity` (may be NULL) is what the file must be. The source owns the handle too. */
slv_result slvi_cache_handle_create(slv_cache *cache, const char *path,
                                    const cache_identity *identity, slv_ptx_source *source,
                                    cache_handle **out);
void slvi_cache_handle_release(cache_handle *handle);
/* An environment whose log says of reads that failed why they did. */
slv_env slvi_cache_handle_env(cache_handle *handle);
/* What a result means that came of reading through a handle. */
slv_result slvi_cache_handle_result(const cache_handle *handle, slv_result result);

/* cache_prefetch.c */
void slvi_cache_stop_worker(slv_cache *cache);

static inline void cache_pin(cache_thread *thread) {
    slv_cache *cache = thread->cache;
    /* acquire: who shows this epoch must not see what was unlinked before it */
    uint64_t epoch = atomic_load_explicit(&cache->epoch, memory_order_acquire);
    if (cache->fences)
        atomic_exchange_explicit(&thread->epoch, epoch, memory_order_seq_cst);
    else
        atomic_store_explicit(&thread->epoch, epoch, memory_order_relaxed);
    atomic_signal_fence(memory_order_seq_cst);
}

static inline void cache_unpin(cache_thread *thread) {
    atomic_store_explicit(&thread->epoch, 0, memory_order_release);
}

/* A counter that one thread writes and others may read. */
static inline void cache_count(_Atomic(uint64_t) *counter, uint64_t more) {
    atomic_store_explicit(counter, atomic_load_explicit(counter, memory_order_relaxed) + more,
                          memory_order_relaxed);
}

/* The tables of a file, or NULL: not there yet, or no such file. */
static inline cache_tables *cache_find_tables(const slv_cache *cache, slv_file_id id) {
    cache_file *file = atomic_load_explicit(&cache->files[id % CACHE_FILES], memory_order_acquire);
    if (!file)
        return NULL;
    /* by the tables' own id: the place may have gone to another file a moment ago */
    cache_tables *tables = atomic_load_explicit(&file->tables, memory_order_acquire);
    if (!tables || tables->id != id)
        return NULL;
    if (!atomic_load_explicit(&tables->used, memory_order_relaxed))
        atomic_store_explicit(&tables->used, 1, memory_order_relaxed);
    return tables;
}

/* A face, which must be in range. */
static inline cache_face *cache_find_face(cache_tables *tables, uint32_t face) {
    cache_face *f = &tables->faces[face];
    if (atomic_load_explicit(&f->state, memory_order_acquire) != CACHE_KNOWN)
        slvi_cache_learn_face(tables, face);
    return f;
}

static inline bool is_subface(const cache_face *f) {
    return (f->flags & SLV_FACE_SUBFACE) != 0;
}

static inline int adjacent_edge(const cache_face *f, int edge) {
    return f->edges >> (2 * edge) & 3;
}

static inline uint64_t cache_hash(uint32_t serial, uint32_t face, int res_u, int res_v,
                                  uint32_t tile) {
    uint64_t key = ((uint64_t)serial << 32 | face) * UINT64_C(0x9e3779b97f4a7c15);
    key ^= ((uint64_t)tile << 12 | (uint64_t)(res_u << 6) | (uint64_t)res_v) *
           UINT64_C(0xc2b2ae3d27d4eb4f);
    key = (key ^ key >> 29) * UINT64_C(0xbf58476d1ce4e5b9);
    return key ^ key >> 32;
}

static inline bool cache_block_is(const cache_block *block, uint32_t serial, uint32_t face,
                                  int res_u, int res_v, uint32_t tile) {
    return block->face == face && block->tile == tile && block->serial == serial &&
           block->res_u == res_u && block->res_v == res_v;
}

/* The texels of a block in the hash table, or NULL. */
static inline const uint8_t *cache_find_hashed(const slv_cache *cache, const cache_tables *tables,
                                               uint32_t face, int res_u, int res_v, uint32_t tile) {
    uint64_t hash = cache_hash(tables->serial, face, res_u, res_v, tile);
    _Atomic(uint64_t) *bucket = cache->buckets + (hash & cache->bucket_mask) * CACHE_WAYS;
    for (int i = 0; i < CACHE_WAYS; i++) {
        uint64_t entry = atomic_load_explicit(&bucket[i], memory_order_acquire);
        if (entry >> 32 != hash >> 32 || !(uint32_t)entry)
            continue;
        uint8_t *texels = cache->arena + (entry & 0xffffffffu) * CACHE_UNIT;
        cache_block *block = (cache_block *)(void *)(texels - CACHE_HEADER);
        if (!cache_block_is(block, tables->serial, face, res_u, res_v, tile))
            continue;
        if (!atomic_load_explicit(&block->used, memory_order_relaxed))
            atomic_store_explicit(&block->used, 1, memory_order_relaxed);
        return texels;
    }
    return NULL;
}

/* The apron of a face at a resolution if it is the one that was made last, or NULL. */
static inline const uint8_t *cache_find_apron(const slv_cache *cache, const cache_face *f,
                                              int res_u, int res_v) {
    uint32_t at = atomic_load_explicit(&f->apron, memory_order_acquire);
    uint8_t *texels = cache->arena + (uint64_t)at * CACHE_UNIT;
    cache_block *block = (cache_block *)(void *)(texels - CACHE_HEADER);
    if (!at || block->res_u != res_u || block->res_v != res_v)
        return NULL;
    if (!atomic_load_explicit(&block->used, memory_order_relaxed))
        atomic_store_explicit(&block->used, 1, memory_order_relaxed);
    return texels;
}

static inline uint32_t cache_block_note(const uint8_t *texels) {
    return ((const cache_block *)(const void *)(texels - CACHE_HEADER))->note;
}

/* The texels of a face at full resolution, if they come in one piece and are there; or NULL. */
static inline const uint8_t *cache_find_full(const slv_cache *cache, cache_face *f) {
    uint32_t at = atomic_load_explicit(&f->texels, memory_order_acquire);
    if (!at)
        return NULL;
    if (!atomic_load_explicit(&f->used, memory_order_relaxed))
        atomic_store_explicit(&f->used, 1, memory_order_relaxed);
    return cache->arena + (uint64_t)at * CACHE_UNIT;
}

#endif
