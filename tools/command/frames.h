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
    uint32_t *numbers;   /* of the pictures */
} frames_list;

void frames_free(frames_list *frames);

/* `count` cameras around the middle of a box, the first one `camera`. */
slv_result frames_turntable(const slv_env *env, const slv_camera *camera, const float low[3],
                            const float high[3], uint32_t count, frames_list *out);
/* The files of a name in which #### stands for a number, in the order of the numbers; one file if
 * there is no # in it. */
slv_result frames_find(const slv_env *env, const char *pattern, frames_list *out);
/* Moves a surface of `mesh` to where a file has its vertices, which must be the same polygons. */
slv_result frames_move(const slv_env *env, const char *path, const slv_mesh *mesh,
                       slv_surface *surface);

#define FRAMES_PATH 4096
/* The name of a picture: its number in place of #### in `out`, or .NNNN before the ending. False if
 * that is too long. */
bool frames_name(const char *out, uint32_t number, char path[FRAMES_PATH]);

#endif
