/* Faces sorted into few batches by the pools that they need. */
#ifndef SLV_GL_GROUP_H
#define SLV_GL_GROUP_H

#include "gl/store/batches.h"

/* The most pools that one face needs: its own and two neighbours' across each edge. */
#define SLV_GL_MOST_NEEDED 9

/* A face and its pools, no pool twice. */
typedef struct slv_gl_need {
    uint32_t face, npools;
    uint32_t pools[SLV_GL_MOST_NEEDED];
} slv_gl_need;

/* Adds batches of at most `most` pools that hold what each of these faces needs; faces that meet
 * should be close together. The first pool of all faces, if it is the same, is number 0 in every
 * batch. Batches get the narrowest variant that reaches their pools. */
slv_result slvi_gl_group(const slv_env *env, slv_gl_batches *batches, const slv_gl_need *needs,
                         uint32_t count, uint32_t npools, uint32_t most, bool subfaces,
                         uint32_t *batch_of);

#endif
