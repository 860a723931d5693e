/* The record that a merge leaves of its parts, and a split goes by. */
#ifndef SLV_BAKE_EXCHANGE_PARTS_H
#define SLV_BAKE_EXCHANGE_PARTS_H

#include "exchange/exchange_data.h"
#include "exchange/geometry.h"

/* An entry of metadata in a file that was merged, and where it is in the result. */
json_t *slvi_parts_entry(const slv_env *env, const char *key, const char *merged);
/* One file; takes over `meta`, a list of entries. NULL if there is no memory. */
json_t *slvi_parts_describe(const slv_env *env, const char *path,
                            const slv_ptx_writer_params *params, uint32_t nverts, json_t *meta);
/* All files, into the result; takes over `parts`. */
slv_result slvi_parts_record(const slv_env *env, const char *path,
                             const slv_ptx_writer_params *merged, json_t *parts,
                             slv_ptx_writer *writer);

/* A part of a file that is to be split. */
typedef struct slvi_part {
    char name[256]; /* of a file, safe within a folder */
    uint32_t first, count;
    slvi_vertices vertices;
    bool has_vertices;
    slv_exchange_params changes; /* to what it was */
    const json_t *meta;          /* entries, or NULL: all that the file has */
} slvi_part;

/* What a record says. For slvi_parts_free. */
typedef struct slvi_parts {
    json_t *root;
    slvi_part *list;
    uint32_t count;
} slvi_parts;

slv_result slvi_parts_read(const slv_env *env, const slv_ptx *ptx, slvi_parts *out);
/* The same of parts that begin at given faces. */
slv_result slvi_parts_at(const slv_env *env, const slv_ptx *ptx, const uint32_t *at,
                         uint32_t nparts, slvi_parts *out);
void slvi_parts_free(slvi_parts *parts);

#endif
