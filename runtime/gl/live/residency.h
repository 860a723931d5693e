/* Which faces have how many texels on the GPU, and who reads them. */
#ifndef SLV_GL_RESIDENCY_DATA_H
#define SLV_GL_RESIDENCY_DATA_H

#include "base/parallel.h"
#include "gl/store/texture.h"

#include <selvage/gl_residency.h>

#include <pthread.h>

enum { SLVI_LOADS = 64, SLVI_MOST_READERS = 16, SLVI_CLASSES = SLV_MAX_LOG2_RES + 1 };
enum { SLVI_LAST_STEP = 2 + SLV_MAX_LOG2_RES }; /* at which there are coarse levels only */

typedef enum slvi_load_state {
    SLVI_LOAD_FREE = 0,
    SLVI_LOAD_WAITING, /* for a reader */
    SLVI_LOAD_READING,
    SLVI_LOAD_READ,
    SLVI_LOAD_FAILED
} slvi_load_state;

/* A level of a face on its way. */
typedef struct slvi_load {
    slvi_load_state state;
    uint32_t face, level;
    slv_res full;
    void *texels;
    uint64_t bytes;
} slvi_load;

/* Threads that read levels of faces as the store has them. */
typedef struct slvi_readers {
    slv_env env;
    slv_source source;
    slv_type type;                /* of the source */
    bool encoded;                 /* colours, which the store has as light */
    const slv_texture_desc *desc; /* of the store: type and channels do not change */
    pthread_mutex_t lock;
    pthread_cond_t more;
    bool begun, stop;
    pthread_t threads[SLVI_MOST_READERS];
    uint32_t nthreads;
    slvi_load loads[SLVI_LOADS];
} slvi_readers;

slv_result slvi_readers_begin(uint32_t count, slvi_readers *readers);
void slvi_readers_end(slvi_readers *readers);
/* Reads one level at once, out of all texels of level 0: what a level of the whole texture would
 * hold, as the store has it. Any thread. */
slv_result slvi_readers_read(const slvi_readers *readers, uint32_t face, slv_res full,
                             uint32_t level, void *out);
/* The same out of what reductions the source has. */
slv_result slvi_readers_read_rough(const slvi_readers *readers, uint32_t face, slv_res res,
                                   void *out);
/* A level of a face as it is in the store. */
slv_result slvi_readers_coarsen(const slvi_readers *readers, const slv_texture *store,
                                uint32_t face, uint32_t level, void *out);

/* The coarsest level that still shows all that a camera can tell of a face, and whether it can see
 * it. */
typedef struct slvi_view {
    const slv_camera *camera;
    float pixel; /* its size on the plane at distance 1, or anywhere without perspective */
} slvi_view;
bool slvi_camera_is_finite(const slv_camera *camera);
slvi_view slvi_view_of(const slv_camera *camera, uint32_t width, uint32_t height);
/* `closer` times as many texels as are needed. */
bool slvi_view_level(const slvi_view *view, const float corners[12], slv_res res, float closer,
                     uint32_t *level);

/* A store that holds of each face a level, a texture on the GPU that follows it, and who decides
 * which. */
struct slv_gl_residency {
    slv_env env;
    slv_parallel_log *log;
    slv_gl_residency_params params;
    slvi_readers readers;
    slv_texture *store;
    slv_gl_texture *texture;
    uint32_t nfaces;
    float *corners;
    slv_res *full;        /* of the source */
    uint8_t *level;       /* that the store has */
    uint8_t *coarse;      /* that it has at least */
    uint8_t *finest;      /* that a driver takes */
    uint8_t *wanted;      /* of a face that is seen; else its coarse one */
    uint8_t *rough;       /* what there is of the level is no exact mean */
    uint8_t *seen, *near; /* near: seen, or next to what is */
    uint8_t *loading, *failed;
    uint64_t gpu_each[SLVI_CLASSES][SLVI_CLASSES]; /* bytes of a face, about */
    uint64_t gpu_coarse, host_coarse;              /* what the coarse levels took */
    uint64_t host_texel; /* bytes of a texel in memory, with all that is made of it */
    uint64_t loading_bytes;
    uint32_t nfailed;
    uint32_t step;  /* see slvi_residency_target */
    uint32_t least; /* what that is at least: layers that are free in arrays took the rest */
    uint32_t extra; /* levels by which faces are finer than wanted, since there is room */
    bool sated;     /* that can be no more */
    uint32_t stuck; /* updates since something that was read could be taken */
};

uint64_t slvi_residency_gpu_bytes(const slv_gl_residency *residency);
uint64_t slvi_residency_host_bytes(const slv_gl_residency *residency);
/* What a face takes in memory at a level. */
uint64_t slvi_residency_host_of(const slv_gl_residency *residency, uint32_t face, uint32_t level);

/* Decides what is wanted for a camera, and how much of it there can be. */
void slvi_residency_plan(slv_gl_residency *residency, const slv_camera *camera, uint32_t width,
                         uint32_t height);
/* All that is wanted is there: whether there is room for more of what is seen, so that a texture
 * that fits comes to be there as a whole. */
bool slvi_residency_want_more(slv_gl_residency *residency);
/* The level that a face is to have. */
uint32_t slvi_residency_target(const slv_gl_residency *residency, uint32_t face, uint32_t step);

#endif
