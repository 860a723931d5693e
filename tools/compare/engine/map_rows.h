/* What the rows of a comparison of maps look up, and what a mesh has to store for them. */
#ifndef SELVAGE_TOOLS_MAP_ROWS_H
#define SELVAGE_TOOLS_MAP_ROWS_H

#include "compare/engine/report.h"

#include <selvage/uv_images.h>
#include <selvage/wrap.h>

/* Bits 0 to 3: the map is cut at this edge of a face. */
enum { MAP_OVER_END = 1 << 4 /* and one value a vertex is wrong within the face */ };

/* Texture coordinates of the corners of faces, 8 a face, as a mesh with duplicated vertices has
 * them and with one value a vertex. */
typedef struct map_coordinates {
    float *twice, *once;
    uint8_t *cut; /* a face */
    uint32_t nfaces;
} map_coordinates;

slv_result map_coordinates_make(const slv_env *env, const slv_mesh *mesh,
                                const slv_adjacency *adjacency, slv_wrap_round round,
                                map_coordinates *out);
void map_coordinates_free(map_coordinates *c);

/* Fills in the rows: which there are, and what they store; strategies come last. */
slv_result map_rows_make(const slv_env *env, const slv_mesh *mesh, const slv_adjacency *adjacency,
                         const map_coordinates *c, report_data *report);
/* What a row draws: `given` with other coordinates. */
slv_uv_images map_row_images(const report_map *row, const slv_uv_images *given,
                             const map_coordinates *c);

#endif
