/* The cache from the inside. What lookups see is in cache_lookup.h; the rest, which locks, is in
 * cache_*.c.
 *
 * Memory is one reserved range of addresses, cut into slabs. Blocks of texels are appended to the
 * open slab; a full slab is thrown away as a whole when room is needed and little of it was used
 * lately. */
#ifndef SLV_CACHE_DATA_H
#define SLV_CACHE_DATA_H

#include "cache/cache_lookup.h"

#include "base/log.h"
#include "base/parallel.h"
#include "texture/changes.h"

#include <pthread.h>

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

/* Where the texels of tables come from, and what becomes of the tables. */
typedef struct cache_origin {
    slv_source source;
    slv_ptx *ptx;                /* that it reads, or NULL */
    struct cache_handle *handle; /* of that */
    slv_source_desc desc;
    uint32_t place, cap; /* cap: log2 of the most texels along an axis */
    uint64_t bytes;
    _Atomic(uint32_t) users; /* threads that read from it */
    bool dropped;            /* under the lock */
} cache_origin;

/* A block that could not be read. */
typedef struct cache_failure {
    uint32_t face, tile;
    int8_t res_u, res_v;
    bool taken;
    slv_result result; /* SLV_OK: forgotten since */
} cache_failure;

/* All of a file: a hash table. */
typedef struct cache_failures {
    cache_failure *slots;
    uint32_t taken, capacity; /* a power of two */
} cache_failures;

/* A file or a source. */
typedef struct cache_file {
    cache_place place;       /* first: it is what lookups see */
    _Atomic(slv_file_id) id; /* 0: closed */
    uint32_t generation, cap;
    char *path;        /* of a file; NULL for a source */
    slv_source source; /* zero for a file */
    uint64_t version;  /* of the source, up to which it is known what was changed */
    slv_ptx_info info;
    cache_identity identity; /* since it was first loaded, or invalidated */
    bool loading, loaded_before, identified;
    slv_result failure; /* of its tables, or of all of it: not tried again, nor told again */
    cache_failures failures;
    slv_changes *changes; /* of what was read, for those who read the cache as a source; or NULL */
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
    bool stale; /* what is read was changed meanwhile */
    struct cache_load *next;
} cache_load;

#define CACHE_REQUESTS 4096

typedef struct cache_request {
    slv_file_id file;
    uint32_t face;
} cache_request;

struct slv_cache {
    cache_view view;

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

/* cache_space.c: of `wanted` bytes of address space as many as can be reserved with room left for
 * others, and no fewer than `least`. */
uint64_t slvi_cache_space(uint64_t wanted, uint64_t least);

/* cache_tables.c */
/* Throws the tables of a file away; under the lock. */
void slvi_cache_drop_tables(slv_cache *cache, cache_file *file);
/* What a source says of a face's constancy. */
void slvi_cache_set_flags(const cache_tables *tables, cache_face *f, uint8_t flags);

/* cache_index.c: which blocks can be found; all under the lock. */
void slvi_cache_link(slv_cache *cache, cache_tables *tables, cache_block *block);
/* Whether a block can be found, and was looked at since this was last asked. */
bool slvi_cache_take_use(slv_cache *cache, cache_block *block);
/* Lets a block not be found any more. */
void slvi_cache_unlink(slv_cache *cache, cache_block *block);
/* The same for what there is of a face at a resolution: a tile. */
void slvi_cache_unlink_tile(slv_cache *cache, cache_tables *tables, uint32_t face, slv_res res,
                            uint32_t tile);

/* cache_failure.c; all under the lock. What is remembered, or SLV_OK. */
slv_result slvi_cache_failure_find(const cache_failures *failures, uint32_t face, slv_res res,
                                   uint32_t tile);
void slvi_cache_failure_add(const slv_env *env, cache_failures *failures, uint32_t face,
                            slv_res res, uint32_t tile, slv_result failure);
void slvi_cache_failure_forget(cache_failures *failures, uint32_t face);
void slvi_cache_failure_forget_all(cache_failures *failures);

/* cache_file.c: under the lock, a file that is open and that nobody is loading, or NULL. */
cache_file *slvi_cache_find_file(slv_cache *cache, slv_file_id id);
slv_result slvi_cache_no_such_file(const slv_cache *cache, slv_file_id id);
/* When the cache is destroyed. */
void slvi_cache_file_free(slv_cache *cache, cache_file *file);

/* cache_thread.c */
uint64_t slvi_cache_count_pieces(const cache_thread *thread);

/* cache_handle.c */
/* A handle, and a source that opens the file when it is read from and closes it when others need
 * the handle. `identity` (may be NULL) is what the file must be. The source owns the handle too. */
slv_result slvi_cache_handle_create(slv_cache *cache, const char *path,
                                    const cache_identity *identity, slv_stream_in *source,
                                    cache_handle **out);
void slvi_cache_handle_release(cache_handle *handle);
/* An environment whose log says of reads that failed why they did. */
slv_env slvi_cache_handle_env(cache_handle *handle);
/* Whether the file is there and is what it was when the identity was taken. */
bool slvi_cache_handle_is_current(const char *path, const cache_identity *identity);
/* What a result means that came of reading through a handle. */
slv_result slvi_cache_handle_result(const cache_handle *handle, slv_result result);

/* cache_prefetch.c */
void slvi_cache_stop_worker(slv_cache *cache);

static inline cache_file *cache_file_at(const slv_cache *cache, uint32_t place) {
    /* a place is the first member of a file */
    return (cache_file *)atomic_load_explicit(&cache->view.places[place], memory_order_acquire);
}

static inline cache_tables *cache_tables_of(const cache_file *file) {
    return atomic_load_explicit(&file->place.tables, memory_order_relaxed);
}

#endif
