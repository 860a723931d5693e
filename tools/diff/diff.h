/* The parts of `selvage diff`. */
#ifndef SELVAGE_TOOLS_DIFF_H
#define SELVAGE_TOOLS_DIFF_H

#include "command/output.h"

struct diff {
    const char *paths[2], *images;
    float tolerance;
    bool texels, json, quiet, progress, salvage;
    int format; /* 0 png, 1 exr */
    uint32_t show, threads;

    slv_ptx *files[2];
    slv_face_diff *faces;
    uint32_t nfaces; /* of the file with more */
    uint32_t ndifferent;
    float largest;
    int32_t largest_face;
    char **notes; /* what differs besides faces */
    uint32_t nnotes;
    bool equal;
};

/* Headers and metadata, into the notes; and a picture of every face that differs. Each returns an
 * exit code. */
int diff_files(struct diff *d);
int diff_save_images(const slv_env *env, const struct diff *d);

#endif
