/* The one way in which files are written: beside their place, and moved there when they are
 * complete. */
#ifndef SLV_BASE_OUTPUT_H
#define SLV_BASE_OUTPUT_H

#include <selvage/file.h>

#include <stdint.h>
#include <sys/stat.h>

struct slv_output {
    slv_env env;
    char *path;     /* as it was given, for messages */
    char *target;   /* what will be replaced: links followed */
    char *beside;   /* NULL: a pipe or a device, written as it comes */
    int descriptor; /* of the file beside, where slvi_write_at may write; or of the pipe */
    FILE *stream;   /* NULL until slvi_output_stream was called */
};

/* A struct of the caller's. Does what slv_output_open does, but opens no stream yet. */
slv_result slvi_output_begin(const slv_env *env, const char *path, bool streams, slv_output *out);
slv_result slvi_output_stream(slv_output *output, FILE **stream);
/* Puts the file in its place; with `sync` not before it is on the disk. On failure the target is as
 * it was and nothing is left beside it. */
slv_result slvi_output_commit(slv_output *output, bool sync);
/* Removes what was written. Does nothing after a commit, or on a zeroed struct. */
void slvi_output_discard(slv_output *output);

/* Gives a new file or folder the mode of the one that it replaces, and its owner as far as we may
 * give it away. */
void slvi_output_keep(int descriptor, const struct stat *old);
/* Moves a complete file to where `path` leads, keeping links, mode and owner of what is there. */
slv_result slvi_output_move(const slv_env *env, const char *from, const char *path);
/* Writes `size` bytes as one file. */
slv_result slvi_output_write(const slv_env *env, const char *path, const void *data, size_t size);

#endif
