/* What a lookup sees of the cache, all of it inline: no lock is taken when all is there. What is
 * not there is read by the functions declared here.
 *
 * A block of texels is found through its face (an untiled face at full resolution) or through a
 * hash table (all else). Both hold offsets into one range of memory, in units of 16 bytes, and are
 * changed under the cache's lock only.
 *
 * Lookups run between cache_pin and cache_unpin, which write an epoch to the sampler's own memory.
 * Memory whose blocks were unlinked in some epoch is used anew, and tables are freed, when every
 * pinned sampler has a later one (epoch-based reclamation, Fraser 2004). */
#ifndef SLV_CACHE_LOOKUP_H
#define SLV_CACHE_LOOKUP_H

#include <selvage/cache.h>

#include <stdatomic.h>
#include <string.h>

#define CACHE_UNIT 16     /* bytes */
#define CACHE_HEADER 32   /* bytes in front of a block's texels */
#define CACHE_PADDING 32  /* bytes behind them, which vectors may read */
#define CACHE_FILES 65536 /* a file id has its place in the low 16 bits */
#define CACHE_WAYS 8      /* offsets in a bucket of the hash table: a line of memory */
/* Set in the place of a tile's number: coarse texels with those around, by the state of all faces
 * that the other bits number. */
#define CACHE_APRON UINT32_C(0x80000000)

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
    uint8_t edges;          /* adjacent edge e in bits 2e and 2e+1 */
    _Atomic(uint8_t) flags; /* SLV_FACE_...; those of constancy may change */
    int8_t res_u, res_v;
    _Atomic(uint32_t) texels; /* where they are at full resolution, or 0 */
    _Atomic(uint32_t) apron;  /* where the apron is that was made last, or 0 */
    _Atomic(uint8_t) state, used;
    _Atomic(bool) plain;     /* most lookups can be done quickly: no sub-face, and not constant */
    _Atomic(uint8_t) around; /* what the faces around it are like, once somebody asked */
} cache_face;

_Static_assert(sizeof(cache_face) == 32, "two faces to a line");

/* What is known of a file or source, texels excepted. Immutable while linked, but for the faces. */
typedef struct cache_tables {
    cache_face *faces; /* filled in one by one */
    /* a texel a face; NULL: they are blocks of 1x1 texels, as they may change */
    const uint8_t *averages;
    slv_file_id id;
    uint32_t nfaces, nchannels, pixel_size, serial;
    slv_type type;
    slv_border_mode border_u, border_v;
    bool tanvec, triangle;
    bool simple;             /* quads of up to four channels, none of them vectors */
    int whole_log2;          /* more texels than 2^this come in tiles */
    float one, scale;        /* what stands for 1, and its inverse */
    _Atomic(uint32_t) apron; /* in the place of a tile's number, of aprons that are still right */
    _Atomic(uint8_t) used;
    struct cache_origin *origin; /* where texels come from */
} cache_tables;

/* Where a file's tables are. */
typedef struct cache_place {
    _Atomic(cache_tables *) tables; /* NULL until needed, and again after being thrown away */
} cache_place;

/* What is read by every lookup, and written seldom. */
typedef struct cache_view {
    uint8_t *arena;
    _Atomic(uint64_t) epoch;
    bool fences; /* the operating system cannot make other threads' writes visible: fences must */
    uint64_t bucket_mask;
    _Atomic(uint64_t) *buckets; /* offset in the low half, hash in the high half */
    _Atomic(cache_place *) *places;
} cache_view;

/* A thread that may be pinned. */
typedef struct cache_thread {
    _Atomic(uint64_t) epoch; /* 0: not pinned */
    cache_view *view;
    struct slv_cache *cache;
    uint64_t moves; /* how often it was unpinned on its way */
    _Atomic(uint64_t) lookups, slow, pieces, misses;
    struct cache_thread *next;
} cache_thread;

/* cache_thread.c */
void slvi_cache_thread_begin(slv_cache *cache, cache_thread *thread);
void slvi_cache_thread_end(cache_thread *thread);
/* Where the cache's words go. */
const slv_env *slvi_cache_env(const slv_cache *cache);

/* cache_file.c: false if no file has the number. */
bool slvi_cache_info(slv_cache *cache, slv_file_id id, slv_ptx_info *out);

/* cache_tables.c */
/* Makes the tables of a file. */
slv_result slvi_cache_load_tables(slv_cache *cache, slv_file_id id);
void slvi_cache_learn_face(cache_tables *tables, uint32_t face);
/* How texels of this resolution are cut. */
slv_res slvi_cache_tile_res(const cache_tables *tables, int res_u, int res_v);

/* cache_load.c */
/* What cache_find_block did not find: unpins, reads and pins again. NULL with SLV_OK in *result if
 * the tables were dropped meanwhile: they must not be looked at again. */
const uint8_t *slvi_cache_load_block(cache_thread *thread, cache_tables *tables, uint32_t face,
                                     int res_u, int res_v, uint32_t tile, slv_result *result);
/* Puts in texels that the caller made of others: lets go of its pin as slvi_cache_load_block does.
 * NULL if the tables were dropped. Of the nine arguments six say which block it is. */
const uint8_t *slvi_cache_publish(cache_thread *thread, cache_tables *tables, uint32_t face,
                                  int res_u, int res_v, uint32_t tile, const void *texels,
                                  size_t bytes, uint32_t note);

static inline void cache_pin(cache_thread *thread) {
    cache_view *view = thread->view;
    /* acquire: who shows this epoch must not see what was unlinked before it */
    uint64_t epoch = atomic_load_explicit(&view->epoch, memory_order_acquire);
    if (view->fences)
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
static inline cache_tables *cache_find_tables(const cache_view *view, slv_file_id id) {
    cache_place *place =
        atomic_load_explicit(&view->places[id % CACHE_FILES], memory_order_acquire);
    if (!place)
        return NULL;
    /* by the tables' own id: the place may have gone to another file a moment ago */
    cache_tables *tables = atomic_load_explicit(&place->tables, memory_order_acquire);
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

static inline unsigned cache_flags(const cache_face *f) {
    return atomic_load_explicit(&f->flags, memory_order_relaxed);
}

static inline bool cache_is_plain(const cache_face *f) {
    return atomic_load_explicit(&f->plain, memory_order_relaxed);
}

static inline bool is_subface(const cache_face *f) {
    return (cache_flags(f) & SLV_FACE_SUBFACE) != 0;
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
static inline const uint8_t *cache_find_hashed(const cache_view *view, const cache_tables *tables,
                                               uint32_t face, int res_u, int res_v, uint32_t tile) {
    uint64_t hash = cache_hash(tables->serial, face, res_u, res_v, tile);
    _Atomic(uint64_t) *bucket = view->buckets + (hash & view->bucket_mask) * CACHE_WAYS;
    for (int i = 0; i < CACHE_WAYS; i++) {
        uint64_t entry = atomic_load_explicit(&bucket[i], memory_order_acquire);
        if (entry >> 32 != hash >> 32 || !(uint32_t)entry)
            continue;
        uint8_t *texels = view->arena + (entry & 0xffffffffu) * CACHE_UNIT;
        cache_block *block = (cache_block *)(void *)(texels - CACHE_HEADER);
        if (!cache_block_is(block, tables->serial, face, res_u, res_v, tile))
            continue;
        if (!atomic_load_explicit(&block->used, memory_order_relaxed))
            atomic_store_explicit(&block->used, 1, memory_order_relaxed);
        return texels;
    }
    return NULL;
}

/* What stands in the place of a tile's number for aprons that show all faces as they are now. Asked
 * before any texel of a new one is looked at. */
static inline uint32_t cache_apron_now(const cache_tables *tables) {
    return atomic_load_explicit(&tables->apron, memory_order_acquire);
}

/* The apron of a face at a resolution if it is the one that was made last, or NULL. */
static inline const uint8_t *cache_find_apron(const cache_view *view, const cache_tables *tables,
                                              const cache_face *f, int res_u, int res_v) {
    uint32_t at = atomic_load_explicit(&f->apron, memory_order_acquire);
    uint8_t *texels = view->arena + (uint64_t)at * CACHE_UNIT;
    cache_block *block = (cache_block *)(void *)(texels - CACHE_HEADER);
    if (!at || block->res_u != res_u || block->res_v != res_v ||
        block->tile != cache_apron_now(tables))
        return NULL;
    if (!atomic_load_explicit(&block->used, memory_order_relaxed))
        atomic_store_explicit(&block->used, 1, memory_order_relaxed);
    return texels;
}

static inline uint32_t cache_block_note(const uint8_t *texels) {
    return ((const cache_block *)(const void *)(texels - CACHE_HEADER))->note;
}

/* The texels of a face at full resolution, if they come in one piece and are there; or NULL. */
static inline __attribute__((always_inline)) const uint8_t *cache_find_full(const cache_view *view,
                                                                            cache_face *f) {
    uint32_t at = atomic_load_explicit(&f->texels, memory_order_acquire);
    if (!at)
        return NULL;
    if (!atomic_load_explicit(&f->used, memory_order_relaxed))
        atomic_store_explicit(&f->used, 1, memory_order_relaxed);
    return view->arena + (uint64_t)at * CACHE_UNIT;
}

#endif
