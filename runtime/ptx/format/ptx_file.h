/* An open .ptx file from the inside, shared by the files of this folder. */
#ifndef SLV_PTX_FILE_H
#define SLV_PTX_FILE_H

#include <selvage/ptx.h>

#include "base/memory.h"
#include "base/parallel.h"

#include <libdeflate.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "texels and metadata are read and written without swapping bytes"
#endif

#define PTX_HEADER_SIZE 64
#define PTX_EXTENDED_HEADER_SIZE 40
#define PTX_FACE_INFO_SIZE 20
#define PTX_LEVEL_INFO_SIZE 16
#define PTX_BARRIER_SIZE 8
#define PTX_MAX_LEVELS 32
#define PTX_LARGE_META 1024 /* longer values have a zlib stream of their own */
#define PTX_MAX_KEY 254
#define PTX_EDIT_HEADER_SIZE 5

/* A face data header: 30 bits of size below 2 of encoding. */
enum { PTX_CONSTANT = 0, PTX_ZIPPED = 1, PTX_DIFFZIPPED = 2, PTX_TILED = 3 };
#define PTX_BLOCK_SIZE(header) ((header)&0x3fffffffu)
#define PTX_BLOCK_ENCODING(header) ((header) >> 30)
#define PTX_MAX_BLOCK 0x3fffffffu

/* Only every so many blocks of a level have their position kept: the others are a few additions
 * away. */
#define PTX_POSITION_STEP 32

typedef struct ptx_level {
    uint64_t position, size; /* the whole level in the file */
    uint32_t zipped;         /* its table, at its start */
    uint32_t nfaces;
    uint32_t *headers;   /* face data headers; at level 0 by face, else by rank */
    uint64_t *positions; /* of every PTX_POSITION_STEP-th block */
} ptx_level;

typedef struct ptx_meta {
    slv_ptx_meta entry;
    void *memory;              /* a small value, then the key */
    void *large;               /* a large value, once it has been read */
    uint64_t position;         /* where it is in the file */
    uint32_t zipped, unpacked; /* its sizes */
    _Atomic(bool) loaded;
} ptx_meta;

/* A face edit: what it replaces. */
typedef struct ptx_edit {
    uint32_t face, turn, header;
    uint64_t position; /* of the block */
    uint8_t record[PTX_FACE_INFO_SIZE];
} ptx_edit;

/* What is read when it is first needed, as bits. */
#define PTX_FACES UINT64_C(1)
#define PTX_CONSTANTS UINT64_C(2)
#define PTX_RANKS UINT64_C(4)
#define PTX_LEVEL(level) (UINT64_C(8) << (level))

/* Tables come into being under the lock, and are immutable once their bit is set. */
typedef struct ptx_tables {
    pthread_mutex_t lock;
    _Atomic(uint64_t) ready;
    uint64_t lost; /* of a file opened for salvage: parts that cannot be read, since then */
    uint64_t faces_position, constants_position;
    uint32_t faces_zipped, constants_zipped;
    uint8_t *records;   /* PTX_FACE_INFO_SIZE a face, edits included */
    uint8_t *constants; /* pixel_size a face, edits included */
    uint32_t *ranks;    /* place of each face in reduction order */
    ptx_level levels[PTX_MAX_LEVELS];
} ptx_tables;

struct slv_ptx {
    slv_env env; /* its log is serialised: faces may be read on any thread */
    slv_parallel_log *log;
    slv_stream_in source;
    char *name;
    slv_ptx_info info;
    bool premultiply, lenient, salvage;
    slv_progress progress; /* of loading all texels */
    size_t pixel_size;
    uint32_t level_faces[PTX_MAX_LEVELS];
    uint64_t level_bytes[PTX_MAX_LEVELS];
    ptx_tables *tables;
    ptx_edit *edits; /* by face, one each */
    uint8_t *edit_values;
    uint32_t nedits, edit_capacity;
    uint64_t edit_position, edit_end; /* where the edits begin and end */
    ptx_meta *meta;
    uint32_t meta_capacity;
    uint32_t *meta_by_key; /* indices, sorted */
    uint32_t *meta_slots;  /* while the file is opened: a hash table of indices + 1 */
    uint32_t meta_slot_count;
    _Atomic(bool) *salvaged; /* nfaces, of a file opened for salvage */
    _Atomic(uint32_t) nsalvaged;
    uint32_t nleft_out; /* parts that are no faces */
};

static inline uint16_t ptx_get_u16(const uint8_t *p) {
    return (uint16_t)(p[0] | p[1] << 8);
}
static inline uint32_t ptx_get_u32(const uint8_t *p) {
    return (uint32_t)ptx_get_u16(p) | (uint32_t)ptx_get_u16(p + 2) << 16;
}
static inline uint64_t ptx_get_u64(const uint8_t *p) {
    return (uint64_t)ptx_get_u32(p) | (uint64_t)ptx_get_u32(p + 4) << 32;
}
static inline void ptx_put_u16(uint8_t *p, uint32_t v) {
    p[0] = (uint8_t)v;
    p[1] = (uint8_t)(v >> 8);
}
static inline void ptx_put_u32(uint8_t *p, uint32_t v) {
    ptx_put_u16(p, v & 0xffff);
    ptx_put_u16(p + 2, v >> 16);
}
static inline void ptx_put_u64(uint8_t *p, uint64_t v) {
    ptx_put_u32(p, (uint32_t)v);
    ptx_put_u32(p + 4, (uint32_t)(v >> 32));
}

/* ptx_source.c */
slv_result slvi_ptx_source_open(const slv_env *env, const char *path, slv_stream_in *out);
/* Reads `size` bytes at `position`; `what` names the section in messages. */
slv_result slvi_ptx_read_bytes(const slv_env *env, const slv_ptx *ptx, const char *what,
                               uint64_t position, uint64_t size, void *out);
/* Whether a zlib stream of `zipped` bytes can hold `size`: deflate packs at most 1032 to 1. */
bool slvi_ptx_zip_is_plausible(uint64_t zipped, uint64_t size);
/* Unpacks the `zipped` bytes at `position`, which must give exactly `size`, into *out (for
 * slvi_free). A NUL follows them. */
slv_result slvi_ptx_read_zip(const slv_ptx *ptx, struct libdeflate_decompressor *inflater,
                             const char *what, uint64_t position, uint64_t zipped, uint64_t size,
                             void *out);

/* ptx_table.c */
/* The list of levels; the tables themselves are put off. */
slv_result slvi_ptx_read_levels(slv_ptx *ptx, const uint8_t *header, uint64_t position);
slv_result slvi_ptx_load_parts(const slv_ptx *ptx, uint64_t parts);
/* Tries all tables of a file that is being opened for salvage, and tells which are lost. */
slv_result slvi_ptx_salvage_tables(slv_ptx *ptx);
/* Sees that tables are there. */
static inline slv_result ptx_need(const slv_ptx *ptx, uint64_t parts) {
    uint64_t ready = atomic_load_explicit(&ptx->tables->ready, memory_order_acquire);
    return (ready & parts) == parts ? SLV_OK : slvi_ptx_load_parts(ptx, parts);
}
/* Says what is wrong with a record of the face table. */
slv_result slvi_ptx_check_record(const slv_ptx *ptx, uint32_t face, const uint8_t *record);
/* A face; PTX_FACES must be there. */
slv_ptx_face slvi_ptx_face_at(const slv_ptx *ptx, uint32_t face);
/* The edge leads to a face that the file does not have: only in one opened leniently. */
bool slvi_ptx_edge_is_lost(const slv_ptx *ptx, uint32_t face, unsigned edge, int32_t *to);
void slvi_ptx_unpack_record(const uint8_t *record, bool triangle, slv_ptx_face *out);
void slvi_ptx_pack_record(const slv_ptx_face *face, uint8_t *record);
/* Where a level keeps a block, by face or rank; PTX_LEVEL(level) must be there. */
uint64_t slvi_ptx_block_position(const ptx_level *level, uint32_t index);
/* The edit of a face, or NULL. */
const ptx_edit *slvi_ptx_find_edit(const slv_ptx *ptx, uint32_t face);

/* The place in reduction order of faces whose table is `records`, made in two passes. */
void slvi_ptx_rank_faces(const uint8_t *records, uint32_t nfaces, uint32_t *ranks);

/* ptx_meta.c: entries are kept as they are met: of those with one key the first gives the place and
 * the last the value. slvi_ptx_meta_finish sorts the keys. */
slv_result slvi_ptx_meta_parse(slv_ptx *ptx, const char *what, const uint8_t *bytes, uint64_t size);
/* Large values stay in the file until they are asked for. */
slv_result slvi_ptx_meta_read_large(slv_ptx *ptx, const uint8_t *headers, uint64_t size,
                                    uint64_t position, uint64_t end);
slv_result slvi_ptx_meta_finish(slv_ptx *ptx);
void slvi_ptx_meta_free(slv_ptx *ptx);
/* Bytes of memory that the entries take, or would take once all large values were read. */
uint64_t slvi_ptx_meta_bytes(const slv_ptx *ptx, bool all);
/* The entry of a key, its value read or not, or NULL. */
ptx_meta *slvi_ptx_meta_lookup(const slv_ptx *ptx, const char *key);
/* Its value, read if that was put off. */
/* What the file says of its colours, SLV_TEXTURE_AUTO if nothing. */
slv_result slvi_ptx_stated_encoding(const slv_ptx *ptx, slv_texture_encoding *out);
slv_result slvi_ptx_meta_load(const slv_ptx *ptx, ptx_meta *meta, const slv_ptx_meta **out);

/* Drops large values that cannot be read, of a file opened for salvage; before _finish. */
slv_result slvi_ptx_meta_salvage(slv_ptx *ptx);

/* Of a file opened for salvage: whether a result is a damage that it goes on past. */
static inline bool ptx_goes_on(const slv_ptx *ptx, slv_result result) {
    return ptx->salvage && (result == SLV_ERROR_FORMAT || result == SLV_ERROR_IO);
}

/* ptx_edits.c */
slv_result slvi_ptx_read_edits(slv_ptx *ptx, struct libdeflate_decompressor *inflater,
                               uint64_t position, uint64_t end, bool open_ended);

/* ptx_face.c */
/* Whether a face has one value, kept with the averages. */
static inline bool ptx_is_one_texel(const slv_ptx_face *face) {
    return (face->flags & SLV_FACE_CONSTANT) || (face->res.u == 0 && face->res.v == 0);
}
/* Whether the block of a face at level 0 can hold as many texels as the face claims. */
bool slvi_ptx_face_is_plausible(const slv_ptx *ptx, uint32_t face, const slv_ptx_face *f);

/* ptx_errors.c: workers that fail at once, and the one line that says why. */
typedef struct ptx_errors {
    pthread_mutex_t lock;
    bool any;
    uint64_t range;
    char message[1024];
} ptx_errors;

typedef struct ptx_range_log {
    ptx_errors *errors;
    uint64_t range;
} ptx_range_log;

/* One line kept instead of told. */
typedef struct ptx_kept_line {
    char text[1024];
} ptx_kept_line;
slv_env slvi_ptx_keep_line(const slv_env *env, ptx_kept_line *line);

/* An environment for the range that starts at `first`, which keeps its messages in `errors`. */
slv_env slvi_ptx_range_env(const slv_env *env, ptx_errors *errors, uint64_t first,
                           ptx_range_log *log);
/* slvi_parallel_for that logs the message of the lowest failing range. `errors` is where `fn` finds
 * it too. */
slv_result slvi_ptx_parallel_for(const slv_env *env, ptx_errors *errors, uint64_t count,
                                 uint64_t grain, slv_range_fn fn, void *user);

static inline uint64_t ptx_texel_count(slv_res res) {
    return UINT64_C(1) << (res.u + res.v);
}
static inline int ptx_min_log2(slv_res res) {
    return res.u < res.v ? res.u : res.v;
}

#endif
