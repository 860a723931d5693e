/* A cube whose six faces have textures of different sizes, as a .ptx with its mesh inside. */
#ifndef CUBE_KIT_H
#define CUBE_KIT_H

#include "kit/bake_kit.h"

static const char cube_obj[] =
    "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
    "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

static inline void cube_write(const char *path) {
    const slv_res res[6] = {{5, 5}, {5, 4}, {4, 4}, {4, 5}, {5, 5}, {3, 3}};
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE, .frequency = 2, .face_tint = 0.5f};
    bake_write(path, cube_obj, SLV_SCHEME_CATMARK, 6, res, &noise);
}

#endif
