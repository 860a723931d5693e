/* Numbered pictures: a camera that goes round, cameras that a view file lists, meshes that move. */
#ifndef SELVAGE_TOOLS_FRAMES_H
#define SELVAGE_TOOLS_FRAMES_H

#include "command/cli.h"

#include <selvage/surface.h>

enum { FRAMES_MOST = 1000000 };

/* What is to be shown, one after the other; nothing of it if `count` is 0. */
typedef struct frames_list {
    uint32_t count;
    slv_camera *cameras; /* NULL: the same for all */
    char **meshes;       /* NULL: the same for all */
    float **positions;   /* of their vertices, those that were kept; see frames_check */
    uint32_t *numbers;   /* of the pictures */
} frames_list;

void frames_free(frames_list *frames);

/* `count` cameras around the middle of a box, the first one `camera`. */
slv_result frames_turntable(const slv_env *env, const slv_camera *camera, const float low[3],
                            const float high[3], uint32_t count, frames_list *out);
/* The files of a name in which #### stands for a number, in the order of the numbers; one file if
 * there is no # in it. Warns of numbers between them that are not there, and of files that only
 * the width of their numbers keeps out. */
slv_result frames_find(const slv_env *env, const char *pattern, frames_list *out);
/* Reads the files, each of which must have the polygons of `mesh`; keeps where their vertices are,
 * of as many as 256 MiB hold. The last two are those of cli_progress_fleeting. */
slv_result frames_check(const slv_env *env, const slv_mesh *mesh, frames_list *frames, bool forced,
                        bool quiet);
/* Moves a surface of `mesh` to where file `index` has its vertices. */
slv_result frames_move(const slv_env *env, const frames_list *frames, uint32_t index,
                       const slv_mesh *mesh, slv_surface *surface);

#define FRAMES_PATH 4096
/* The name of a picture: its number in place of #### in `out`, or .NNNN before the ending. False if
 * that is too long. */
bool frames_name(const char *out, uint32_t number, char path[FRAMES_PATH]);

#endif
