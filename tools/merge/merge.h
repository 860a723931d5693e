/* The parts of `selvage merge`. */
#ifndef SELVAGE_TOOLS_MERGE_H
#define SELVAGE_TOOLS_MERGE_H

#include "convert/convert.h"

enum { MERGE_MAX_FILES = 1024 };

struct merge {
    const char *paths[MERGE_MAX_FILES];
    uint32_t npaths;
    const char *out;
    int type;
    bool type_given, json, progress, quiet, no_reductions;
    uint32_t compression, threads;
    slv_ptx *files[MERGE_MAX_FILES];
    uint32_t first_face[MERGE_MAX_FILES]; /* of each file in the result */
    slv_ptx_writer_params target;
    slv_ptx_writer *writer;
    convert_totals totals;
    bool geometry; /* all files have it, and so has the result */
};

/* Joins m->paths into m->out; exit code. */
int merge_files(const cli_command *command, const slv_env *env, struct merge *m);
/* merge_meta.c: geometry joined into one mesh, other values kept once if they are equal, else under
 * names of their own. */
slv_result merge_meta(const slv_env *env, struct merge *m);

#endif
