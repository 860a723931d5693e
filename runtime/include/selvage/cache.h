/* Texels of many open .ptx files and other sources, in bounded memory, for lookups from any number
 * of threads. */
#ifndef SELVAGE_CACHE_H
#define SELVAGE_CACHE_H

#include <selvage/ptx.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Zero means default. */
typedef struct slv_cache_params {
    uint64_t
        max_bytes;      /* texels and tables together; 0 means 1 GiB, less than 8 MiB means 8 MiB,
                           more than 64 GiB means that. Reserved at once, used when needed; where address
                           space is limited (ulimit -v) it is as much as can be had, with a warning */
    uint32_t max_files; /* file handles open at a time, which lookups that miss at once may exceed
                           by one a thread; 0 means 100 */
    bool premultiply;   /* files with alpha are read premultiplied, see slv_ptx_read_face; sources
                           are read as they are */
    uint64_t reserved[4];
} slv_cache_params;

/* A cache holds what lookups touched, tile by tile: full faces of less than 128 KiB in one piece.
 * What was not used lately goes first. A hit takes no lock. Any thread may call any function of a
 * cache at any time. What could not be read, but for want of memory, is remembered until it is
 * invalidated: it is tried once and told in one line of the log, and each lookup that needs it
 * gives the error. */
typedef struct slv_cache slv_cache;

/* Which file, in lookups: never 0, and never given out twice by one cache (but after 65535
 * files opened and closed). */
typedef uint32_t slv_file_id;

SLV_NODISCARD SLV_API slv_result slv_cache_create(const slv_env *env,
                                                  const slv_cache_params *params, slv_cache **out);
/* All samplers must have been destroyed. */
SLV_API void slv_cache_destroy(slv_cache *cache);

/* Adds a file. Opening the same path twice gives two ids. The file is read when something first
 * needs it, but for its header, so that what is not a .ptx file is refused here. At most 65535
 * files are open at a time. */
SLV_NODISCARD SLV_API slv_result slv_cache_open(slv_cache *cache, const char *path,
                                                slv_file_id *out);

/* How to open. Zero means default. */
typedef struct slv_cache_open_params {
    /* log2 of the most texels along an axis of a face, 0 means as many as it has. Lookups see a
     * face that has more as if it had this many: the reduction. */
    uint32_t max_log2_res;
    uint64_t reserved[4];
} slv_cache_open_params;

SLV_NODISCARD SLV_API slv_result slv_cache_open_with(slv_cache *cache, const char *path,
                                                     const slv_cache_open_params *params,
                                                     slv_file_id *out);
/* Adds a source, which the cache takes: it is closed with its number or the cache, and also if this
 * fails. `params` may be NULL. What was read of the source stays until slv_cache_refresh, or a
 * function that invalidates, is called. */
SLV_NODISCARD SLV_API slv_result slv_cache_open_source(slv_cache *cache, const slv_source *source,
                                                       const slv_cache_open_params *params,
                                                       slv_file_id *out);
/* A file or source of the cache as a source: what lookups see, capped as they see it. Its versions
 * are those of what the cache was told to forget. Close it before the cache is destroyed; once the
 * file is closed it fails. What is remembered as failed fails without a further line. */
SLV_NODISCARD SLV_API slv_result slv_cache_as_source(slv_cache *cache, slv_file_id file,
                                                     slv_source *out);
/* Forgets a file. Lookups by its id give SLV_ERROR_ARGUMENT from now on; those under way on other
 * threads end with either. */
SLV_NODISCARD SLV_API slv_result slv_cache_close(slv_cache *cache, slv_file_id file);
/* Forgets what is known of a file, or of every file if `file` is 0, so that the next lookups read
 * it anew: call it when the file was changed. Without it, what is read of a file that
 * was changed gives SLV_ERROR_MISMATCH, never a mix; but a file that another was renamed over stays
 * what it was while its handle is open. */
SLV_NODISCARD SLV_API slv_result slv_cache_invalidate(slv_cache *cache, slv_file_id file);
/* The same for a face, or a rectangle of its texels at full resolution, unless `rect` is NULL.
 * Other texels stay where they are. Lookups that begin after it see the face as it is now; those
 * under way on other threads may see some of both. */
SLV_NODISCARD SLV_API slv_result slv_cache_invalidate_face(slv_cache *cache, slv_file_id file,
                                                           uint32_t face, const slv_rect *rect);
/* Asks the source what was changed since it was opened or asked last, and forgets that; of a file,
 * whether it is the one that it was, and forgets all of it if not. Of every file if `file` is 0. */
SLV_NODISCARD SLV_API slv_result slv_cache_refresh(slv_cache *cache, slv_file_id file);
/* A description of a file. `level_faces` and `level_bytes` are NULL; of a source, what it says of
 * itself. */
SLV_NODISCARD SLV_API slv_result slv_cache_get_info(slv_cache *cache, slv_file_id file,
                                                    slv_ptx_info *out);

/* Asks for the texels of a face at full resolution, in the background; returns at once. Requests
 * beyond 4096 waiting ones are dropped in silence. */
SLV_NODISCARD SLV_API slv_result slv_cache_prefetch(slv_cache *cache, slv_file_id file,
                                                    uint32_t face);
/* Waits until all that was asked for before is there. */
SLV_API void slv_cache_wait(slv_cache *cache);

/* What happened since the cache was made. */
typedef struct slv_cache_stats {
    uint64_t lookups;    /* of all samplers, those destroyed included */
    uint64_t hits;       /* pieces of faces that a lookup needed and found */
    uint64_t misses;     /* that had to be read, or made from finer ones */
    uint64_t evictions;  /* pieces thrown away to stay within the limit */
    uint64_t bytes_read; /* from files */
    uint64_t bytes;      /* now in use */
    uint64_t peak_bytes; /* most ever in use */
    uint32_t files;      /* now open by slv_cache_open */
    uint32_t handles;    /* file handles open now */
    uint64_t reopened;   /* handles opened again after they were given up */
    uint64_t reloaded;   /* tables of files read again after they were thrown away */
    uint64_t reserved[4];
} slv_cache_stats;

/* Numbers of samplers at work are a little behind. */
SLV_API void slv_cache_get_stats(slv_cache *cache, slv_cache_stats *out);

#ifdef __cplusplus
}
#endif

#endif
