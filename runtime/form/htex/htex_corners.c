/* The values that squares share where they meet in a corner. */
#include "form/htex/htex_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <string.h>

enum { CORNERS = 4 };

/* The nodes at a square's corners: at (0,0), (1,0), (0,1), (1,1). */
static uint32_t nodes_of(const slv_htex_mesh *mesh, uint32_t edge, uint32_t nodes[CORNERS]) {
    uint32_t half = mesh->half[edge][0], twin = mesh->half[edge][1];
    nodes[0] = slv_htex_centre(mesh, half);
    nodes[1] = mesh->root[half];
    nodes[2] = mesh->root[slv_htex_next(mesh, half)];
    if (twin == SLV_HTEX_NONE)
        return 3;
    nodes[3] = slv_htex_centre(mesh, twin);
    return 4;
}

/* Numbers the nodes that are used, and finds the least resolution around each. */
static slv_result number_nodes(const slv_env *env, slv_htex *htex, const slv_htex_mesh *mesh,
                               uint32_t *number, uint32_t *count) {
    uint64_t nnodes = 5 * (uint64_t)mesh->nfaces, total = 0;
    slv_result result;
    memset(number, 0xff, nnodes * sizeof *number);
    for (uint32_t edge = 0; edge < htex->nedges; edge++) {
        uint32_t nodes[CORNERS], n = nodes_of(mesh, edge, nodes);
        for (uint32_t k = 0; k < n; k++)
            if (number[nodes[k]] == SLV_HTEX_NONE)
                number[nodes[k]] = htex->ncorners++;
    }
    if ((result =
             slvi_alloc(env, "corners", htex->ncorners, sizeof *htex->corners, &htex->corners)))
        return result;
    for (uint32_t edge = 0; edge < htex->nedges; edge++) {
        uint32_t nodes[CORNERS], n = nodes_of(mesh, edge, nodes);
        for (uint32_t k = 0; k < n; k++) {
            uint32_t at = number[nodes[k]];
            slv_htex_corner *corner = &htex->corners[at];
            if (!count[at]++ || htex->log2[edge] < corner->log2)
                corner->log2 = htex->log2[edge];
        }
    }
    for (uint32_t i = 0; i < htex->ncorners; i++) {
        htex->corners[i].first = (uint32_t)total;
        total += htex->corners[i].log2 + 1u;
    }
    if (total > UINT32_MAX)
        return slvi_fail(env, SLV_ERROR_LIMIT, "half-edges: too many corners for 32-bit indices");
    htex->nvalues = (uint32_t)total;
    return SLV_OK;
}

static void add_texels(const slv_htex *htex, const slv_htex_mesh *mesh, const uint32_t *number,
                       double *sums, float *value) {
    size_t n = htex->desc.nchannels;
    for (uint32_t edge = 0; edge < htex->nedges; edge++) {
        const unsigned char *texels = htex->texels + htex->offset[edge];
        uint32_t nodes[CORNERS], ncorners = nodes_of(mesh, edge, nodes);
        for (uint32_t level = 0; level <= htex->log2[edge]; level++) {
            uint32_t log2 = htex->log2[edge] - level;
            size_t last = ((size_t)1 << log2) - 1;
            for (uint32_t k = 0; k < ncorners; k++) {
                const slv_htex_corner *corner = &htex->corners[number[nodes[k]]];
                size_t texel = (k / 2 * last << log2) + k % 2 * last;
                if (log2 >= corner->log2)
                    continue;
                slv_type_to_float(htex->desc.type, texels + texel * htex->texel_size, n, value);
                for (size_t c = 0; c < n; c++)
                    sums[(corner->first + log2) * n + c] += (double)value[c];
            }
            texels += htex->texel_size << 2 * log2;
        }
    }
}

static void take_means(slv_htex *htex, uint64_t nnodes, const uint32_t *number,
                       const uint32_t *count, const double *sums, const float *tops) {
    size_t n = htex->desc.nchannels;
    for (uint64_t node = 0; node < nnodes; node++) {
        if (number[node] == SLV_HTEX_NONE)
            continue;
        const slv_htex_corner *corner = &htex->corners[number[node]];
        float *values = htex->values + corner->first * n;
        for (size_t i = 0; i < corner->log2 * n; i++)
            values[i] = (float)(sums[corner->first * n + i] / count[number[node]]);
        memcpy(values + corner->log2 * n, tops + node * n, n * sizeof *tops);
    }
}

slv_result slvi_htex_find_corners(const slv_env *env, slv_htex *htex, const slv_htex_mesh *mesh,
                                  const float *tops) {
    uint64_t nnodes = 5 * (uint64_t)mesh->nfaces, n = htex->desc.nchannels;
    uint32_t *number = NULL, *count = NULL;
    double *sums = NULL;
    float *value = NULL;
    slv_result result;
    if ((result = slvi_alloc(env, "corners", nnodes, sizeof *number, &number)) ||
        (result = slvi_alloc(env, "corners", nnodes, sizeof *count, &count)) ||
        (result = number_nodes(env, htex, mesh, number, count)) ||
        (result = slvi_alloc(env, "corners", htex->nvalues * n, sizeof *sums, &sums)) ||
        (result = slvi_alloc(env, "corners", n, sizeof *value, &value)) ||
        (result =
             slvi_alloc(env, "corners", htex->nvalues * n, sizeof *htex->values, &htex->values)))
        goto done;
    add_texels(htex, mesh, number, sums, value);
    take_means(htex, nnodes, number, count, sums, tops);
    for (uint32_t face = 0; face < mesh->nfaces; face++) {
        slv_htex_face *row = &htex->faces[face];
        uint32_t half = row->part ? 4 * mesh->before[mesh->before[face]] : 4 * face;
        row->centre = number[slv_htex_centre(mesh, half)];
        for (uint32_t k = 0; k < 4; k++, half = slv_htex_next(mesh, half))
            row->start[k] = number[mesh->root[half]];
    }
done:
    slvi_free(number);
    slvi_free(count);
    slvi_free(sums);
    slvi_free(value);
    return result;
}
