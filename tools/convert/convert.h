/* The parts of `selvage convert`. */
#ifndef SELVAGE_TOOLS_CONVERT_H
#define SELVAGE_TOOLS_CONVERT_H

#include "command/output.h"

/* A channel of the result: one of the source's, or a value. */
typedef struct convert_channel {
    int32_t source; /* -1: `value` */
    float value;
} convert_channel;

typedef struct convert_face_res {
    uint32_t face;
    slv_res res;
} convert_face_res;

typedef struct convert_options {
    const char *channels, *scale, *alpha, *res, *mesh;
    int type, border, border_u, border_v, edge_filter, format;
    bool type_given, border_given, border_u_given, border_v_given, edge_filter_given, format_given;
    bool max_given, min_given;
    uint32_t max[2], min[2];
    bool premultiply, unmultiply, reductions, no_reductions, no_meta, json, progress, quiet;
    uint32_t compression, threads;
} convert_options;

/* What was done so far; faces are counted by many threads. */
typedef struct convert_totals {
    atomic_uint_fast64_t faces, resized, texels;
    atomic_uint_fast64_t clipped; /* values that the new type could not hold */
    cli_progress progress;        /* steps once a face */
} convert_totals;

/* What becomes of every face, once options have met the source. */
typedef struct convert_plan {
    const char *path;                     /* the source, as messages name it */
    slv_ptx_writer_params source, target; /* alike but for what is asked for */
    convert_channel *channels;            /* target.nchannels */
    bool same_channels, premultiply, unmultiply;
    int shift; /* log2 of the scale */
    int8_t max[2], min[2];
    convert_face_res *face_res; /* sorted by face */
    uint32_t nface_res;
    convert_totals *totals;
} convert_plan;

/* convert_plan.c. Returns an exit code; a plan is freed whatever that is. */
int convert_plan_make(const cli_command *command, const convert_options *options, const char *path,
                      const slv_ptx_writer_params *source, convert_totals *totals,
                      convert_plan *plan);
void convert_plan_free(convert_plan *plan);
slv_res convert_plan_res(const convert_plan *plan, uint32_t face, slv_res res);

/* convert_face.c: a face of the source, one texel if it is constant, as a face of the target; it is
 * added to the totals. `*texels` is then the same memory, or memory of its own that `*own` names,
 * for free(). */
slv_result convert_face(const slv_env *env, const convert_plan *plan, uint32_t face,
                        slv_ptx_face *info, const void **texels, void **own);

/* convert_ptx.c, convert_export.c, convert_import.c: each returns an exit code. */
int convert_to_ptx(const slv_env *env, const convert_options *options, const convert_plan *plan,
                   const slv_ptx *ptx, const slv_mesh *mesh, const char *path);
int convert_to_folder(const slv_env *env, const convert_options *options, const convert_plan *plan,
                      const slv_ptx *ptx, const char *folder);
int convert_to_sheet(const slv_env *env, const convert_options *options, const convert_plan *plan,
                     const slv_ptx *ptx, const char *path);
int convert_from_index(const cli_command *command, const slv_env *env,
                       const convert_options *options, const slv_mesh *mesh, const char *index,
                       const char *path, convert_totals *totals, convert_plan *plan);

/* Says in one warning how many values were clipped, if any were. */
void convert_warn_clipped(const convert_totals *totals, slv_type type);

/* The words of options and of the index, in the order of the enumerations. */
#define CONVERT_TYPES "uint8|uint16|half|float"
#define CONVERT_BORDERS "clamp|black|periodic"
#define CONVERT_FILTERS "none|tanvec"
int convert_word(const char *words, const char *word); /* its index, or -1 */
const char *convert_border_name(slv_border_mode mode);
const char *convert_filter_name(slv_edge_filter filter);
const char *convert_meta_name(slv_meta_type type);
#define CONVERT_METAS "string|int8|int16|int32|float|double"

#endif
