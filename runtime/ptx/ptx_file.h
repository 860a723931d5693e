/* An open .ptx file from the inside, shared by the files of this folder. */
#ifndef SLV_PTX_FILE_H
#define SLV_PTX_FILE_H

#include <selvage/ptx.h>

#include "base/log.h"
#include "base/parallel.h"

#include <libdeflate.h>
#include <pthread.h>
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

typedef struct ptx_level {
    uint32_t nfaces;
    uint32_t *headers;   /* face data headers; at level 0 by face, else by rank */
    uint64_t *positions; /* of the blocks in the file */
} ptx_level;

typedef struct ptx_meta {
    slv_ptx_meta entry;
    void *memory; /* the values, then the key */
} ptx_meta;

struct slv_ptx {
    slv_env env; /* its log is serialised: faces may be read on any thread */
    slv_parallel_log *log;
    slv_ptx_source source;
    char *name;
    slv_ptx_info info;
    size_t pixel_size;
    slv_ptx_face *faces;
    uint8_t *constants; /* pixel_size a face */
    ptx_level *levels;
    uint32_t *level_faces;
    uint32_t *ranks; /* place of each face in reduction order; NULL if nothing is reduced */
    ptx_meta *meta;
    uint32_t meta_capacity;
    uint32_t *meta_by_key; /* indices, sorted */
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
slv_result ptx_source_open(const slv_env *env, const char *path, slv_ptx_source *out);
/* Reads `size` bytes at `position`; `what` names the section in messages. */
slv_result ptx_read_bytes(const slv_env *env, const slv_ptx *ptx, const char *what,
                          uint64_t position, uint64_t size, void *out);
/* Whether a zlib stream of `zipped` bytes can hold `size`: deflate packs at most 1032 to 1. */
bool ptx_zip_is_plausible(uint64_t zipped, uint64_t size);
/* Unpacks the `zipped` bytes at `position`, which must give exactly `size`, into *out (for free()).
 */
slv_result ptx_read_zip(slv_ptx *ptx, struct libdeflate_decompressor *inflater, const char *what,
                        uint64_t position, uint64_t zipped, uint64_t size, void *out);

/* ptx_table.c */
slv_result ptx_parse_face(slv_ptx *ptx, uint32_t face, const uint8_t *record, slv_ptx_face *out);
slv_result ptx_read_tables(slv_ptx *ptx, struct libdeflate_decompressor *inflater,
                           const uint8_t *header, uint64_t position);

/* The place of each face in reduction order. */
void ptx_rank_faces(const slv_ptx_face *faces, uint32_t nfaces, uint32_t *ranks);

/* ptx_meta.c: entries are appended as they are met; ptx_meta_finish drops the replaced ones. */
slv_result ptx_meta_parse(slv_ptx *ptx, const char *what, const uint8_t *bytes, uint64_t size);
slv_result ptx_meta_read_large(slv_ptx *ptx, struct libdeflate_decompressor *inflater,
                               const uint8_t *headers, uint64_t size, uint64_t position,
                               uint64_t end);
slv_result ptx_meta_finish(slv_ptx *ptx);
void ptx_meta_free(slv_ptx *ptx);

/* ptx_edits.c */
slv_result ptx_read_edits(slv_ptx *ptx, struct libdeflate_decompressor *inflater, uint64_t position,
                          uint64_t end, bool open_ended);

/* What one thread needs to read faces; zeroed but for `env` at first. */
typedef struct ptx_buffer {
    uint8_t *bytes;
    size_t capacity;
} ptx_buffer;

typedef struct ptx_scratch {
    const slv_env *env;
    struct libdeflate_decompressor *inflater;
    size_t read_ahead; /* how much to read at a time when blocks are small and follow each other */
    ptx_buffer input, planes, tiles, work[2];
    uint64_t input_position;
    size_t input_size;
} ptx_scratch;

/* ptx_face.c */
slv_result ptx_scratch_reserve(ptx_scratch *scratch, const slv_ptx *ptx, ptx_buffer *buffer,
                               uint64_t size);
void ptx_scratch_free(ptx_scratch *scratch);
slv_result ptx_read_face_with(const slv_ptx *ptx, ptx_scratch *scratch, uint32_t face, slv_res res,
                              void *out);
/* Whether the block of a face at level 0 can hold as many texels as the face claims. */
bool ptx_face_is_plausible(const slv_ptx *ptx, uint32_t face);

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

/* An environment for the range that starts at `first`, which keeps its messages in `errors`. */
slv_env ptx_range_env(const slv_env *env, ptx_errors *errors, uint64_t first, ptx_range_log *log);
/* slv_parallel_for that logs the message of the lowest failing range. `errors` is where `fn` finds
 * it too. */
slv_result ptx_parallel_for(const slv_env *env, ptx_errors *errors, uint64_t count, uint64_t grain,
                            slv_range_fn fn, void *user);

static inline uint64_t ptx_texel_count(slv_res res) {
    return UINT64_C(1) << (res.u + res.v);
}
static inline int ptx_min_log2(slv_res res) {
    return res.u < res.v ? res.u : res.v;
}

#endif
