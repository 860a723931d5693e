/* What the files of an exchange share: an open source, what becomes of its faces, and the sums. */
#ifndef SLV_BAKE_EXCHANGE_DATA_H
#define SLV_BAKE_EXCHANGE_DATA_H

#include "base/log.h"
#include "base/memory.h"
#include "base/progress.h"

#include <selvage/exchange.h>

#include <jansson.h>
#include <stdatomic.h>

enum { SLVI_INDEX_NAME = 1024 };

struct slv_exchange {
    char *path;         /* as it was given */
    const slv_ptx *ptx; /* NULL: images */
    slv_ptx *own;       /* the same if it was opened here */
    json_t *index;      /* of images */
    char index_path[SLVI_INDEX_NAME], index_folder[SLVI_INDEX_NAME]; /* the folder with its slash */
    slv_ptx_writer_params params;
    slv_texture_encoding encoding; /* of its colours; of an index that does not say AUTO, and then
                                      values are taken as they stand */
    slv_texture_encoding images_encoding; /* of PNGs that do not say it */
};

/* What was done so far; faces are counted by many threads. */
typedef struct slvi_exchange_totals {
    atomic_uint_fast64_t faces, resized, texels, clipped;
    slvi_steps steps; /* one a face */
} slvi_exchange_totals;

/* What becomes of every face, once parameters have met the source. */
typedef struct slvi_exchange_plan {
    const char *path;                     /* the source, as messages name it */
    slv_ptx_writer_params source, target; /* alike but for what is asked for */
    slv_exchange_channel *channels;       /* target.nchannels */
    bool same_channels, premultiply, unmultiply;
    slv_texture_encoding encoding; /* of the colours: the source's, unless parameters say so */
    int shift;
    int8_t max[2], min[2];
    slv_exchange_face_res *face_res; /* sorted by face */
    uint32_t nface_res;
    uint32_t *faces; /* of the source that are taken, target.nfaces, sorted; NULL: all */
    slvi_exchange_totals *totals;
} slvi_exchange_plan;

/* A plan is released whatever this returns. `totals` is begun by the caller. */
slv_result slvi_exchange_plan_make(const slv_env *env, const slv_exchange_params *params,
                                   const char *path, const slv_ptx_writer_params *source,
                                   slvi_exchange_totals *totals, slvi_exchange_plan *plan);
void slvi_exchange_plan_free(slvi_exchange_plan *plan);
/* The size of a face of the source in the result. */
slv_res slvi_exchange_plan_res(const slvi_exchange_plan *plan, uint32_t face, slv_res res);
/* Where a face of the source is in the result, or -1; and the reverse. */
int32_t slvi_exchange_plan_place(const slvi_exchange_plan *plan, int32_t face);
uint32_t slvi_exchange_plan_source(const slvi_exchange_plan *plan, uint32_t place);
/* Neighbours of a face of the source by their numbers in the result; those that are not there
 * become boundary, and where one of two sub-faces along an edge is not, both and the edge do. */
slv_result slvi_exchange_plan_move(const slvi_exchange_plan *plan, const slv_ptx *ptx,
                                   slv_ptx_face *face);
/* Visits the faces of the source that are taken. */
slv_result slvi_exchange_visit(const slv_env *env, const slvi_exchange_plan *plan,
                               const slv_ptx *ptx, slv_ptx_visit_fn visit, void *user);

void slvi_exchange_begin(slvi_exchange_totals *totals, slv_progress progress, uint64_t nfaces);
/* Says in one warning how many values were clipped, if any were and `result` is a success; fills
 * `stats`, which may be NULL. */
void slvi_exchange_end(const slv_env *env, slvi_exchange_totals *totals, slv_result result,
                       const slv_ptx_writer_params *wrote, slv_exchange_stats *stats);

/* A face of the source, one texel if it is constant, as a face of the target; it is added to the
 * totals. `*texels` is then the same memory, or memory of its own that `*own` names, for slvi_free.
 * SLV_ERROR_CANCELLED is not logged: slvi_exchange_visited does that. */
slv_result slvi_exchange_face(const slv_env *env, const slvi_exchange_plan *plan, uint32_t face,
                              slv_ptx_face *info, const void **texels, void **own);
/* Says at once that a face needs more memory than there is; where several at a time would, fewer
 * threads do. */
slv_result slvi_exchange_check_memory(slv_env *env, const slvi_exchange_plan *plan,
                                      const slv_ptx *ptx);
/* All faces that are taken, into the result. */
slv_result slvi_exchange_write_faces(const slv_env *env, const slvi_exchange_plan *plan,
                                     const slv_ptx *ptx, slv_ptx_writer *writer);
/* Colours between a texture and a picture, which has them as LINEAR (OpenEXR) or as SRGB (PNG).
 * Those that are no light (DATA), and those of which nothing is known (AUTO), stay as they are.
 * Alpha is a channel or SLV_NO_ALPHA. */
void slvi_exchange_change(slv_texture_encoding from, slv_texture_encoding to, uint32_t nchannels,
                          int32_t alpha, float *values, uint64_t count);
/* Whether metadata is to say what the colours of the target are, since its type does not. */
bool slvi_exchange_needs_note(const slvi_exchange_plan *plan);
slv_result slvi_exchange_note_encoding(const slvi_exchange_plan *plan, slv_ptx_writer *writer);
/* Passes on what a visit of faces ended with; threads that hear of a cancellation at once make one
 * line of it here. */
slv_result slvi_exchange_visited(const slv_env *env, const slvi_exchange_plan *plan,
                                 slv_result result);

#endif
