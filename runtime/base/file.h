/* Whole files in, and atomic files out: written beside the target, renamed over it when complete.
 */
#ifndef SLV_BASE_FILE_H
#define SLV_BASE_FILE_H

#include "base/memory.h"

#include <selvage/result.h>

#include <stdio.h>

/* What a failed call to the operating system is, by errno: want of memory, or SLV_ERROR_IO. */
slv_result slvi_io_error(int reason);

/* Reads a regular file of at most env's max_bytes; *data has a NUL after its `size` bytes and is
 * released with slvi_free. */
slv_result slvi_file_read(const slv_env *env, const char *path, char **data, size_t *size);

/* A file being written beside `path`, under a name of its own. */
typedef struct slv_file_writer {
    FILE *stream;
    char *path, *temporary;
} slv_file_writer;

slv_result slvi_file_writer_open(const slv_env *env, const char *path, slv_file_writer *out);
slv_result slvi_file_writer_write(const slv_env *env, slv_file_writer *writer, const void *data,
                                  size_t size);
/* Renames over the target. On failure the target is untouched and the temporary gone. It does not
 * wait for the disk: a folder of images would take minutes. */
slv_result slvi_file_writer_commit(const slv_env *env, slv_file_writer *writer);
/* Removes the temporary. Does nothing after a commit, or on a zeroed struct. */
void slvi_file_writer_abandon(slv_file_writer *writer);

/* Writes `size` bytes atomically. */
slv_result slvi_file_write(const slv_env *env, const char *path, const void *data, size_t size);

#endif
