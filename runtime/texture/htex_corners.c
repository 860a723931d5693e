#include "texture/htex.h"

#include "base/log.h"

#include <stdlib.h>
#include <string.h>

/* The values on which squares agree at their corners. A node has one for each length of texels that
 * all squares around it have: log2 = 1 up to the least of theirs. */
struct corners {
    uint8_t *log2;   /* per node: the least around it */
    uint64_t *first; /* per node: the sum for log2 = 1 */
    uint32_t *count; /* per node: how many corners of squares lie there */
    double *sums;
};

enum { CORNERS = 4 };

/* The four nodes at a square's corners: at (0,0), (1,0), (0,1), (1,1). */
static void nodes_of(const slv_htex_mesh *mesh, uint32_t edge, uint32_t nodes[CORNERS]) {
    uint32_t half = mesh->half[edge][0], twin = mesh->half[edge][1];
    nodes[0] = slv_htex_centre(mesh, half);
    nodes[1] = mesh->root[half];
    nodes[2] = mesh->root[slv_htex_next(mesh, half)];
    nodes[3] = twin == SLV_HTEX_NONE ? nodes[0] : slv_htex_centre(mesh, twin);
}

static unsigned char *corner_texel(const slv_htex *htex, unsigned char *texels, uint32_t log2,
                                   uint32_t corner) {
    size_t width = (size_t)1 << log2;
    return texels +
           ((corner / 2) * (width - 1) * width + (corner % 2) * (width - 1)) * htex->texel_size;
}

static void find_least(const slv_htex *htex, const slv_htex_mesh *mesh, struct corners *corners) {
    for (uint32_t edge = 0; edge < htex->nedges; edge++) {
        uint32_t nodes[CORNERS];
        nodes_of(mesh, edge, nodes);
        for (uint32_t k = 0; k < CORNERS; k++) {
            uint8_t *least = &corners->log2[nodes[k]];
            *least = !*least || htex->log2[edge] < *least ? htex->log2[edge] : *least;
            corners->count[nodes[k]]++;
        }
    }
}

/* Visits the corner texels of all squares, at all levels: adds them to the sums, or sets them. */
static void visit(slv_htex *htex, const slv_htex_mesh *mesh, const struct corners *corners,
                  const float *tops, float *value) {
    size_t n = htex->desc.nchannels;
    for (uint32_t edge = 0; edge < htex->nedges; edge++) {
        unsigned char *texels = htex->texels + htex->offset[edge];
        uint32_t nodes[CORNERS];
        nodes_of(mesh, edge, nodes);
        for (uint32_t log2 = htex->log2[edge]; log2 > 0; log2--) {
            for (uint32_t k = 0; k < CORNERS; k++) {
                uint32_t node = nodes[k];
                unsigned char *texel = corner_texel(htex, texels, log2, k);
                double *sums = corners->sums + (corners->first[node] + log2 - 1) * n;
                if (log2 >= corners->log2[node]) {
                    if (tops)
                        slv_type_from_float(htex->desc.type, tops + node * n, n, texel);
                } else if (tops) {
                    for (size_t c = 0; c < n; c++)
                        value[c] = (float)(sums[c] / corners->count[node]);
                    slv_type_from_float(htex->desc.type, value, n, texel);
                } else {
                    slv_type_to_float(htex->desc.type, texel, n, value);
                    for (size_t c = 0; c < n; c++)
                        sums[c] += (double)value[c];
                }
            }
            texels += htex->texel_size << 2 * log2;
        }
    }
}

slv_result slv_htex_join_corners(const slv_env *env, slv_htex *htex, const slv_htex_mesh *mesh,
                                 const float *tops) {
    uint64_t nnodes = 5 * (uint64_t)mesh->nfaces, total = 0, n = htex->desc.nchannels;
    struct corners corners = {0};
    float *value = NULL;
    slv_result result;
    if ((result = slv_alloc(env, "corners", nnodes, sizeof *corners.log2, &corners.log2)) ||
        (result = slv_alloc(env, "corners", nnodes, sizeof *corners.first, &corners.first)) ||
        (result = slv_alloc(env, "corners", nnodes, sizeof *corners.count, &corners.count)) ||
        (result = slv_alloc(env, "corners", n, sizeof *value, &value)))
        goto done;
    find_least(htex, mesh, &corners);
    for (uint64_t node = 0; node < nnodes; node++) {
        corners.first[node] = total;
        total += corners.log2[node] ? corners.log2[node] - 1u : 0;
    }
    if ((result = slv_alloc(env, "corners", (total + 1) * n, sizeof *corners.sums, &corners.sums)))
        goto done;
    visit(htex, mesh, &corners, NULL, value);
    visit(htex, mesh, &corners, tops, value);
done:
    free(corners.log2);
    free(corners.first);
    free(corners.count);
    free(corners.sums);
    free(value);
    return result;
}
