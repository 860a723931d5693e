/* Tables with a row for each face that are longer than a shader is shown at once. */
#ifndef SLV_GL_CHUNKS_H
#define SLV_GL_CHUNKS_H

#include <stdint.h>

/* A draw is shown the rows of the faces whose ids agree above the lowest `log2` bits. */
typedef struct slv_gl_chunks {
    uint32_t log2;  /* 32: all */
    uint32_t count; /* at least 1 */
} slv_gl_chunks;

static inline uint32_t slv_gl_chunk_of(slv_gl_chunks chunks, uint32_t face) {
    return (uint32_t)((uint64_t)face >> chunks.log2);
}

/* The largest chunks of at most 1 << log2 faces. */
static inline slv_gl_chunks slv_gl_chunks_of(uint32_t nfaces, uint32_t log2) {
    slv_gl_chunks chunks = {32, 1};
    if (log2 < 32 && (uint64_t)nfaces > UINT64_C(1) << log2) {
        chunks.log2 = log2;
        chunks.count = (uint32_t)(((uint64_t)nfaces + (UINT64_C(1) << log2) - 1) >> log2);
    }
    return chunks;
}

#endif
