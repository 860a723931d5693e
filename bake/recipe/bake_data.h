/* A bake under way: what the files that share its work know of it. */
#ifndef SLV_BAKE_DATA_H
#define SLV_BAKE_DATA_H

#include "recipe/encode.h"
#include "source/source.h"

#include "base/progress.h"

#include <selvage/ptx_writer.h>

#include <pthread.h>

enum { BAKE_MAP_CHANNELS = 3 };

/* What a thread bakes at once of a face, hearing no interrupt meanwhile: rows, or a part of one. */
typedef struct bake_band {
    uint32_t face;
    slv_rect rect;
    uint64_t at; /* of its first texel, in the block */
} bake_band;

/* Faces first..end-1, and their texels and causes of misses one behind the other. */
typedef struct bake_block {
    uint32_t first, end;
    uint64_t *offsets; /* of each face, and one past the last */
    uint8_t *texels, *misses;
} bake_block;

typedef struct bake_part bake_part;

typedef struct bake {
    const slv_bake_source *source;
    const slv_mesh *mesh;
    const slv_bake_job *job;
    const slv_res *res;
    slv_env env; /* its log is serialised */
    encoder encoder;
    size_t texel_size;
    slv_ptx_writer *writer, *map;
    slvi_steps steps;
    uint64_t total; /* texels */
    uint8_t map_colors[SLV_BAKE_MISSES][BAKE_MAP_CHANNELS];

    uint8_t *done; /* of each face, whether it is in a block that was begun */
    uint32_t next; /* all faces before it are */
    bake_part *part;
    bake_block block; /* that is evaluated or written */
    bake_band *bands;
    uint32_t nbands;
    pthread_mutex_t lock;
    slv_bake_report *report;
} bake;

static inline uint64_t slvi_bake_texels_of(slv_res res) {
    return UINT64_C(1) << (res.u + res.v);
}

/* ---- bake_block.c ---- */

/* The next faces that are not done, as many as may be in memory and are not too much work to be
 * done again; false after the last. */
bool slvi_bake_next_block(bake *b, uint32_t *first, uint32_t *end);
/* Room for a block of b->block; what was in it is released. */
slv_result slvi_bake_begin_block(bake *b, uint32_t first, uint32_t end);
void slvi_bake_end_block(bake *b);
slv_result slvi_bake_evaluate_block(bake *b);
/* Packs the faces of a block that has its texels, and counts their misses. */
slv_result slvi_bake_write_block(bake *b);

/* ---- bake_part.c: blocks that were baked, in a file, for a bake that goes on later ---- */

/* Takes in what there is in the file that the job names, if it is of this very bake; everything in
 * it is written, and done. */
slv_result slvi_bake_part_open(bake *b);
/* Keeps the block that was evaluated. */
slv_result slvi_bake_part_keep(bake *b);
/* The bake is complete: the file goes. */
void slvi_bake_part_remove(bake *b);
void slvi_bake_part_close(bake *b);

/* ---- bake_team.c: the ranks of a job ---- */

/* Rank 0 hands out blocks and writes what comes back; the others bake until there is no more. */
slv_result slvi_bake_lead(bake *b, slv_result begun);
slv_result slvi_bake_serve(bake *b);
/* The resolutions, which rank 0 has found, to all others. */
slv_result slvi_bake_share_plan(const slv_env *env, const slv_bake_job *job, slv_res *res,
                                uint32_t nfaces, slv_result planned);

#endif
