/* What the options of convert ask for, of the source that is there. */
#ifndef SELVAGE_TOOLS_CONVERT_OPTIONS_H
#define SELVAGE_TOOLS_CONVERT_OPTIONS_H

#include "command/cli.h"

#include <selvage/exchange.h>

typedef struct convert_options {
    const char *channels, *scale, *alpha, *res, *mesh, *faces;
    int type, border, border_u, border_v, edge_filter, format;
    int encoding;   /* slv_texture_encoding */
    int reductions; /* slv_ptx_seams */
    bool type_given, border_given, border_u_given, border_v_given, edge_filter_given, format_given;
    bool max_given, min_given;
    uint32_t max[2], min[2];
    bool premultiply, unmultiply, reductions_given, no_reductions, no_meta, json, progress, quiet,
        salvage;
    uint32_t compression, threads;
} convert_options;

/* Params that own their lists. */
typedef struct convert_request {
    const slv_ptx_writer_params *source;
    slv_exchange_params params;
    slv_exchange_channel *channels;
    slv_exchange_face_res *face_res;
    uint32_t *faces;
} convert_request;

/* Returns an exit code; a request is freed whatever that is. */
int convert_request_make(const cli_command *command, const convert_options *options,
                         const slv_ptx_writer_params *source, convert_request *out);
void convert_request_free(convert_request *request);

/* Warns of fields in the index of images that nobody reads. */
void convert_warn_of_index(const slv_env *env, const char *path, bool folder);

#endif
