/* The order in which faces are uploaded. */
#include "gl/store/source.h"

#include "base/memory.h"

/* Faces are walked through in blocks of so many, so that arrays have few faces of another part of
 * the tables (parts.h). */
enum { BLOCK_LOG2 = 17 };

slv_result slvi_gl_face_order(const slv_gl_source *source, uint32_t *order) {
    const slv_face_adjacency *adjacency = slv_adjacency_faces(source->adjacency);
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces;
    bool *seen = NULL;
    slv_result result = slvi_alloc(source->env, "face order", nfaces, sizeof *seen, &seen);
    if (result)
        return result;
    uint32_t head = 0, tail = 0;
    for (uint32_t start = 0; start < nfaces; start++) {
        if (seen[start])
            continue;
        seen[start] = true;
        order[tail++] = start;
        for (; head < tail; head++) {
            for (unsigned e = 0; e < 4; e++) {
                int32_t next = adjacency[order[head]].face[e];
                if (next >= 0 && !seen[next] &&
                    (uint32_t)next >> BLOCK_LOG2 == start >> BLOCK_LOG2) {
                    seen[next] = true;
                    order[tail++] = (uint32_t)next;
                }
            }
        }
    }
    slvi_free(seen);
    return SLV_OK;
}
