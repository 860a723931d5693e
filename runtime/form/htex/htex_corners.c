/* The values that squares share where they meet in a corner. */
#include "form/htex/htex_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <string.h>

uint32_t slvi_htex_nodes_of(const slv_htex_mesh *mesh, uint32_t edge,
                            uint32_t nodes[SLV_HTEX_CORNERS]) {
    uint32_t half = mesh->half[edge][0], twin = mesh->half[edge][1];
    nodes[0] = slv_htex_centre(mesh, half);
    nodes[1] = mesh->root[half];
    nodes[2] = mesh->root[slv_htex_next(mesh, half)];
    if (twin == SLV_HTEX_NONE)
        return 3;
    nodes[3] = slv_htex_centre(mesh, twin);
    return 4;
}

/* Numbers the nodes that are used, and counts the squares around each. */
static void number_nodes(const slv_htex_mesh *mesh, slv_htex_around *out) {
    uint64_t nnodes = 5 * (uint64_t)mesh->nfaces;
    memset(out->number, 0xff, nnodes * sizeof *out->number);
    for (uint32_t edge = 0; edge < mesh->nedges; edge++) {
        uint32_t nodes[SLV_HTEX_CORNERS], n = slvi_htex_nodes_of(mesh, edge, nodes);
        for (uint32_t k = 0; k < n; k++) {
            uint32_t *number = &out->number[nodes[k]];
            if (*number == SLV_HTEX_NONE) {
                out->node[out->ncorners] = nodes[k];
                *number = out->ncorners++;
            }
            out->first[*number + 1]++;
        }
    }
}

/* How the axes of a node, which are those of the face that it is numbered after, are turned as
 * another face at one of its corners sees them. */
static unsigned node_turns(const slv_htex_mesh *mesh, const slv_adjacency *adjacency, uint32_t node,
                           uint32_t face, unsigned corner) {
    bool centre = node >= 4 * mesh->nfaces;
    uint32_t of = centre ? node - 4 * mesh->nfaces : node / 4, position;
    bool part = slv_htex_is_part(mesh, of);
    unsigned of_corner = centre ? 2 : part ? 0 : node & 3;
    if (of == face && (corner == of_corner || (centre && !part)))
        return 0;
    slv_ring ring = slv_adjacency_ring(adjacency, (int32_t)face, corner, &position);
    for (uint32_t i = 0; i < ring.count; i++)
        if ((uint32_t)ring.corners[i].face == of && ring.corners[i].corner == of_corner)
            return slvi_ring_turns(&ring, position, i);
    return 0; /* a vertex that is in several pieces */
}

/* How a square is turned as one of its corners sees it. */
static unsigned corner_turns(const slv_htex_mesh *mesh, const slv_adjacency *adjacency,
                             uint32_t edge, uint32_t k, uint32_t node) {
    uint32_t half = mesh->half[edge][k == 3], face = half / 4;
    bool part = slv_htex_is_part(mesh, face), end = k == 2, centre = k == 0 || k == 3;
    unsigned square = slvi_htex_square_turns(mesh, half, end);
    if (part && end)
        face = mesh->after[face];
    unsigned corner = centre ? 2 : part ? 0 : (half + end) & 3;
    return (square - node_turns(mesh, adjacency, node, face, corner)) & 3;
}

static slv_result find_turns(const slv_env *env, const slv_htex_mesh *mesh,
                             const slv_adjacency *adjacency, slv_htex_around *out) {
    slv_result result =
        slvi_alloc(env, "corners", out->first[out->ncorners], sizeof *out->turns, &out->turns);
    for (uint32_t corner = 0; !result && corner < out->ncorners; corner++)
        for (uint32_t i = out->first[corner]; i < out->first[corner + 1]; i++)
            out->turns[i] =
                (uint8_t)corner_turns(mesh, adjacency, out->squares[i] / SLV_HTEX_CORNERS,
                                      out->squares[i] % SLV_HTEX_CORNERS, out->node[corner]);
    return result;
}

/* What a face has of squares, corners and the centre, as it sees them. */
static void turn_face(const slv_htex_mesh *mesh, const slv_adjacency *adjacency, uint32_t face,
                      uint32_t half, slv_htex_face *row) {
    for (uint32_t k = 0; k < 4; k++, half = slv_htex_next(mesh, half)) {
        /* around the polygon each half-edge is a quarter further */
        unsigned along = row->part ? k + 2 : k;
        row->turns[k] = (uint8_t)((along + (row->second[k] ? 2 : 0)) & 3);
        if (!row->part || k == 2)
            row->turns[4 + k] =
                (uint8_t)node_turns(mesh, adjacency, mesh->root[half], face, row->part ? 0 : k);
    }
    row->turns[8] = (uint8_t)node_turns(mesh, adjacency, slv_htex_centre(mesh, 4 * face), face, 2);
}

slv_result slvi_htex_around_create(const slv_env *env, const slv_htex_mesh *mesh,
                                   const slv_adjacency *adjacency, slv_htex_around *out) {
    uint64_t nnodes = 5 * (uint64_t)mesh->nfaces;
    slv_result result;
    *out = (slv_htex_around){0};
    if ((result = slvi_alloc(env, "corners", nnodes, sizeof *out->number, &out->number)) ||
        (result = slvi_alloc(env, "corners", nnodes, sizeof *out->node, &out->node)) ||
        (result = slvi_alloc(env, "corners", nnodes + 2, sizeof *out->first, &out->first)))
        return result;
    number_nodes(mesh, out);
    for (uint32_t i = 0; i < out->ncorners; i++)
        out->first[i + 1] += out->first[i];
    if ((result = slvi_alloc(env, "corners", out->first[out->ncorners], sizeof *out->squares,
                             &out->squares)))
        return result;
    for (uint32_t edge = 0; edge < mesh->nedges; edge++) {
        uint32_t nodes[SLV_HTEX_CORNERS], n = slvi_htex_nodes_of(mesh, edge, nodes);
        for (uint32_t k = 0; k < n; k++)
            out->squares[out->first[out->number[nodes[k]]]++] = edge * SLV_HTEX_CORNERS + k;
    }
    memmove(out->first + 1, out->first, out->ncorners * sizeof *out->first);
    out->first[0] = 0;
    return adjacency ? find_turns(env, mesh, adjacency, out) : SLV_OK;
}

void slvi_htex_around_free(slv_htex_around *around) {
    slvi_free(around->number);
    slvi_free(around->node);
    slvi_free(around->first);
    slvi_free(around->squares);
    slvi_free(around->turns);
    *around = (slv_htex_around){0};
}

/* The least resolution around each corner, and where its values are. */
static slv_result lay_out(const slv_env *env, const slv_htex_around *around, slv_htex *htex) {
    uint64_t total = 0;
    slv_result result =
        slvi_alloc(env, "corners", around->ncorners, sizeof *htex->corners, &htex->corners);
    if (result)
        return result;
    htex->ncorners = around->ncorners;
    for (uint32_t i = 0; i < around->ncorners; i++) {
        slv_htex_corner *corner = &htex->corners[i];
        corner->log2 = UINT8_MAX;
        for (uint32_t k = around->first[i]; k < around->first[i + 1]; k++) {
            uint8_t log2 = htex->log2[around->squares[k] / SLV_HTEX_CORNERS];
            corner->log2 = log2 < corner->log2 ? log2 : corner->log2;
        }
        corner->first = (uint32_t)total;
        corner->room = corner->log2;
        total += corner->log2 + 1u;
    }
    if (total > UINT32_MAX)
        return slvi_fail(env, SLV_ERROR_LIMIT, "half-edges: too many corners for 32-bit indices");
    htex->nvalues = htex->values_capacity = (uint32_t)total;
    return SLV_OK;
}

void slvi_htex_corner_values(slv_htex *htex, const slv_htex_around *around, const float *tops,
                             uint32_t index, double *sums, float *value) {
    const slv_htex_corner *corner = &htex->corners[index];
    uint32_t first = around->first[index], end = around->first[index + 1];
    size_t n = htex->desc.nchannels;
    float *values = htex->values + corner->first * n;
    memset(sums, 0, corner->log2 * n * sizeof *sums);
    for (uint32_t i = first; i < end; i++) {
        uint32_t edge = around->squares[i] / SLV_HTEX_CORNERS;
        uint32_t k = around->squares[i] % SLV_HTEX_CORNERS;
        const unsigned char *texels = htex->at[edge];
        for (uint32_t log2 = htex->log2[edge] + 1; log2-- > 0;) {
            size_t last = ((size_t)1 << log2) - 1, texel = (k / 2 * last << log2) + k % 2 * last;
            if (log2 < corner->log2) {
                slv_type_to_float(htex->desc.type, texels + texel * htex->texel_size, n, value);
                if (around->turns)
                    slvi_edge_turn_vector(around->turns[i], &value[0], &value[1]);
                for (size_t c = 0; c < n; c++)
                    sums[log2 * n + c] += (double)value[c];
            }
            texels += htex->texel_size << 2 * log2;
        }
    }
    for (size_t i = 0; i < corner->log2 * n; i++)
        values[i] = (float)(sums[i] / (end - first));
    memcpy(values + corner->log2 * n, tops + around->node[index] * n, n * sizeof *tops);
}

struct corner_job {
    slv_htex *htex;
    const slv_htex_around *around;
    const float *tops;
    const slv_env *env;
};

static slv_result fill_corners(void *user, uint64_t first, uint64_t end) {
    const struct corner_job *job = user;
    uint64_t n = job->htex->desc.nchannels;
    double *sums = NULL;
    float *value = NULL;
    slv_result result;
    if ((result =
             slvi_alloc_plain(job->env, "corners", SLV_HTEX_MOST_LOG2 * n, sizeof *sums, &sums)) ||
        (result = slvi_alloc_plain(job->env, "corners", n, sizeof *value, &value)))
        goto done;
    for (uint64_t corner = first; corner < end; corner++)
        slvi_htex_corner_values(job->htex, job->around, job->tops, (uint32_t)corner, sums, value);
done:
    slvi_free(sums);
    slvi_free(value);
    return result;
}

slv_result slvi_htex_find_corners(const slv_env *env, slv_htex *htex, const slv_htex_mesh *mesh,
                                  const slv_adjacency *adjacency, const float *tops) {
    slv_htex_around around = {0};
    struct corner_job job = {htex, &around, tops, env};
    slv_result result;
    if ((result = slvi_htex_around_create(env, mesh, htex->vectors ? adjacency : NULL, &around)) ||
        (result = lay_out(env, &around, htex)) ||
        (result = slvi_alloc(env, "corners", (uint64_t)htex->nvalues * htex->desc.nchannels,
                             sizeof *htex->values, &htex->values)) ||
        (result = slvi_parallel_for(env, htex->ncorners, 512, fill_corners, &job)))
        goto done;
    for (uint32_t face = 0; face < mesh->nfaces; face++) {
        slv_htex_face *row = &htex->faces[face];
        uint32_t half = row->part ? 4 * mesh->before[mesh->before[face]] : 4 * face;
        row->centre = around.number[slv_htex_centre(mesh, half)];
        if (htex->vectors)
            turn_face(mesh, adjacency, face, half, row);
        for (uint32_t k = 0; k < 4; k++, half = slv_htex_next(mesh, half))
            row->start[k] = around.number[mesh->root[half]];
    }
done:
    slvi_htex_around_free(&around);
    return result;
}
