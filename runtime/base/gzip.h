/* Files that gzip packed, unpacked in memory. */
#ifndef SLV_BASE_GZIP_H
#define SLV_BASE_GZIP_H

#include <selvage/result.h>

/* Replaces the `*size` bytes in *data (for slvi_free) by what they are the packed form of, with a
 * NUL behind it, if they begin as a gzip file does; leaves all others alone. A file of several
 * members is all of them. What does not unpack is SLV_ERROR_FORMAT, more than env's max_bytes
 * SLV_ERROR_LIMIT; *data stays as it was. */
slv_result slvi_gunzip(const slv_env *env, const char *path, char **data, size_t *size);

#endif
