/* What the files of a merge share. */
#ifndef SLV_BAKE_EXCHANGE_MERGE_H
#define SLV_BAKE_EXCHANGE_MERGE_H

#include "exchange/exchange_data.h"

typedef struct slvi_merge {
    const char *const *paths;
    uint32_t npaths;
    const char *out;
    slv_ptx **files;
    uint32_t *first_faces; /* of each file in the result */
    slv_ptx_writer_params target;
    slv_ptx_writer *writer;
    slvi_exchange_totals totals;
    slv_texture_encoding encoding; /* of the first file's colours */
    bool noted;                    /* some file says what its colours are */
    bool geometry;                 /* all files have it, and so has the result */
} slvi_merge;

/* Geometry joined into one mesh, other values kept once if they are equal, else under names of
 * their own. */
slv_result slvi_merge_meta(const slv_env *env, slvi_merge *m);

#endif
