/* Files read whole, and bytes at places in open files. */
#ifndef SLV_BASE_FILE_H
#define SLV_BASE_FILE_H

#include "base/memory.h"

#include <selvage/result.h>

/* What a failed call to the operating system is, by errno: want of memory, or SLV_ERROR_IO. */
slv_result slvi_io_error(int reason);

/* Reads a regular file, a pipe that somebody writes to or "/dev/stdin", at most env's max_bytes;
 * *data has a NUL after its `size` bytes and is released with slvi_free. */
slv_result slvi_file_read(const slv_env *env, const char *path, char **data, size_t *size);

/* Whether a name ends in an extension with its dot, in any case, behind something else. */
bool slvi_name_ends(const char *path, const char *extension);
/* Whether there is a folder of this name, or a link to one. */
bool slvi_is_folder(const char *path);
/* Whether two names are of one file that is there. */
bool slvi_same_file(const char *a, const char *b);

/* Returns 0, or errno; EIO where the file ends too early. */
int slvi_read_at(int descriptor, void *data, uint64_t size, uint64_t position);
/* `path` is the file in messages. */
slv_result slvi_write_at(const slv_env *env, const char *path, int descriptor, const void *data,
                         uint64_t size, uint64_t position);

#endif
