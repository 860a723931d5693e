/* The control mesh inside a .ptx: three entries of its metadata. */
#ifndef SLV_BAKE_EXCHANGE_GEOMETRY_H
#define SLV_BAKE_EXCHANGE_GEOMETRY_H

#include <selvage/ptx_writer.h>

/* Positions come first: their number bounds that of the vertices, which indices count. */
enum { SLVI_POSITIONS, SLVI_COUNTS, SLVI_INDICES, SLVI_GEOMETRY_KEYS };

extern const char *const slvi_geometry_keys[SLVI_GEOMETRY_KEYS];
/* Which of these a key is, or -1. */
int slvi_geometry_key(const char *key);

/* Vertices first..first+count-1 of a file. */
typedef struct slvi_vertices {
    uint32_t first, count;
} slvi_vertices;

/* Writes the polygons of these faces, which are sorted, with all of `vertices` or (NULL) those that
 * they use. Nothing if the file has no mesh; a warning and nothing if some faces of a polygon are
 * missing. */
slv_result slvi_geometry_select(const slv_env *env, const slv_ptx *ptx, const uint32_t *faces,
                                uint32_t nfaces, const slvi_vertices *vertices,
                                slv_ptx_writer *writer);

#endif
