/* Random lookups: places on all faces, often on an edge or in a corner, and footprints from a
 * sixteenth of a texel to many. */
#ifndef LOOKUP_KIT_H
#define LOOKUP_KIT_H

#include "kit/border_kit.h"

enum { NPOINTS = 4096 };

static int32_t faces[NPOINTS];
static float uv[2 * NPOINTS], dx[2 * NPOINTS], dy[2 * NPOINTS];

static inline void random_points(const kit *k, uint64_t *random) {
    for (int i = 0; i < NPOINTS; i++) {
        float texels = exp2f((float)(test_random(random) % 1000) / 100 - 4);
        faces[i] = (int32_t)(test_random(random) % k->nfaces);
        slv_res res = k->res[faces[i]];
        for (int c = 0; c < 2; c++)
            uv[2 * i + c] = test_random(random) % 3 ? (float)(test_random(random) % 1025) / 1024
                                                    : (float)(test_random(random) % 2);
        dx[2 * i] = texels / (float)(1u << res.u);
        dy[2 * i + 1] = texels / (float)(1u << res.v);
    }
}

#endif
