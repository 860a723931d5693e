/* Whole texts in, and files out that appear complete or not at all. */
#ifndef SELVAGE_FILE_H
#define SELVAGE_FILE_H

#include <selvage/result.h>

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reads a text whole, as meshes, indices and view files are read: from a regular file, a pipe that
 * somebody writes to, or "/dev/stdin"; unpacked if gzip packed it, without the byte order mark that
 * some editors begin UTF-8 with. UTF-16 and UTF-32 are SLV_ERROR_UNSUPPORTED. At most env's
 * max_bytes. `*text` has a NUL after its `*size` bytes and is released with slv_free. */
SLV_NODISCARD SLV_API slv_result slv_text_load(const slv_env *env, const char *path, char **text,
                                               size_t *size);

/* A file that is being written. */
typedef struct slv_output slv_output;

/* Begins a file beside the place where it will be, under a name of its own, and refuses what cannot
 * be written. Links are followed: what they lead to is replaced, and keeps its mode and, where the
 * process may give it away, its owner. What killed writers of the same place left is removed. */
SLV_NODISCARD SLV_API slv_result slv_output_open(const slv_env *env, const char *path,
                                                 slv_output **out);
/* The same for what can be written from its beginning to its end: pipes and devices too, and "-",
 * which is standard output. Those are written as it comes. */
SLV_NODISCARD SLV_API slv_result slv_output_open_stream(const slv_env *env, const char *path,
                                                        slv_output **out);
/* Where to write it; belongs to the output. */
SLV_API FILE *slv_output_stream(slv_output *output);
/* With `result` SLV_OK puts the file in its place if all of it was written; with any other removes
 * it. Releases the output, which may be NULL, and returns `result` or what went wrong. */
SLV_NODISCARD SLV_API slv_result slv_output_end(slv_output *output, slv_result result);
/* Whether a file could be begun there: for those who write at the end of long work. */
SLV_NODISCARD SLV_API slv_result slv_output_try(const slv_env *env, const char *path);

/* "UTF-16" or "UTF-32" if a text that begins with these bytes is encoded so, by its mark or by the
 * zeros between its letters; else NULL. */
SLV_API const char *slv_text_encoding(const void *bytes, size_t size);

#ifdef __cplusplus
}
#endif

#endif
