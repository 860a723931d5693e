/* Buffers for the tables of each chunk of faces. */
#include "gl/store/parts.h"

#include "base/memory.h"
#include "gl/store/tables.h"

/* A software driver clears a buffer as it makes it, which takes 0.7 ms a MiB; but each part has
 * draws of its own. */
#define MOST_BYTES (UINT64_C(16) << 20)

uint64_t slvi_gl_parts_limit(const slv_gl *gl) {
    return gl->max_storage < MOST_BYTES ? gl->max_storage : MOST_BYTES;
}

slv_result slvi_gl_parts_make(const slv_gl_source *source, slv_gl_chunks chunks,
                              const slv_gl_part_rows *from, slv_gl_part **out) {
    uint64_t nfaces = slv_levels_get_desc(source->levels)->nfaces, face = 0;
    const unsigned char *rows = from->rows;
    slv_gl_part *parts = NULL;
    slv_result result = slvi_alloc(source->env, "tables", chunks.count, sizeof *parts, &parts);
    *out = parts;
    for (uint32_t c = 0; !result && c < chunks.count; c++) {
        slv_gl_part *part = &parts[c];
        uint64_t end = c + 1 < chunks.count ? (uint64_t)(c + 1) << chunks.log2 : nfaces;
        part->way_bytes = (end - face) * from->row_bytes;
        part->value_bytes = (from->first[c + 1] - from->first[c]) * 4 * sizeof *from->values;
        if (!(result = slvi_gl_table(source, "table of faces", rows + face * from->row_bytes,
                                     part->way_bytes, &part->ways)))
            result = slvi_gl_table(source, "corner table", from->values + 4 * from->first[c],
                                   part->value_bytes, &part->values);
        face = end;
    }
    return result;
}

void slvi_gl_parts_free(const slv_gl *gl, slv_gl_chunks chunks, slv_gl_part *parts) {
    for (uint32_t c = 0; parts && c < chunks.count; c++) {
        slvi_gl_delete(gl->api.DeleteBuffers, &parts[c].ways);
        slvi_gl_delete(gl->api.DeleteBuffers, &parts[c].values);
    }
    slvi_free(parts);
}
