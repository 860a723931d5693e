/* Squares made anew after a change of texels, and the values at their corners. */
#include "form/htex/htex_data.h"

#include "base/memory.h"

struct slv_htex_again {
    slv_env env;
    slv_htex_mesh mesh;
    slv_htex_around around;
    uint64_t *ends; /* as slv_htex_fill has them: of the squares at hand */
    float *tops;
    uint8_t *squares; /* per edge, face and corner: whether it is at hand */
    uint8_t *is_face, *is_corner;
    uint32_t *faces, *corners; /* those at hand */
    uint32_t nfaces, ncorners;
};

void slvi_htex_again_destroy(slv_htex_again *again) {
    if (!again)
        return;
    slvi_htex_mesh_free(&again->mesh);
    slvi_htex_around_free(&again->around);
    slvi_free(again->ends);
    slvi_free(again->tops);
    slvi_free(again->squares);
    slvi_free(again->is_face);
    slvi_free(again->is_corner);
    slvi_free(again->faces);
    slvi_free(again->corners);
    slvi_free(again);
}

slv_result slvi_htex_again_create(const slv_env *env, const slv_adjacency *adjacency,
                                  const slv_htex *htex, slv_htex_again **out) {
    uint64_t nfaces = htex->desc.nfaces, nedges = htex->nedges, ncorners = htex->ncorners;
    slv_htex_again *made = NULL;
    slv_result result = slvi_alloc(env, "squares", 1, sizeof *made, &made);
    *out = NULL;
    if (result)
        return result;
    made->env = *env;
    if ((result = slvi_htex_mesh_create(env, adjacency, &made->mesh)) ||
        (result = slvi_htex_around_create(env, &made->mesh, htex->vectors ? adjacency : NULL,
                                          &made->around)) ||
        (result = slvi_alloc(env, "squares", nedges, sizeof *made->ends, &made->ends)) ||
        (result = slvi_alloc_plain(env, "corners", 5 * nfaces * htex->desc.nchannels,
                                   sizeof *made->tops, &made->tops)) ||
        (result = slvi_alloc(env, "squares", nedges, 1, &made->squares)) ||
        (result = slvi_alloc(env, "faces", nfaces, 1, &made->is_face)) ||
        (result = slvi_alloc(env, "corners", ncorners, 1, &made->is_corner)) ||
        (result = slvi_alloc(env, "faces", nfaces, sizeof *made->faces, &made->faces)) ||
        (result = slvi_alloc(env, "corners", ncorners, sizeof *made->corners, &made->corners))) {
        slvi_htex_again_destroy(made);
        return result;
    }
    *out = made;
    return SLV_OK;
}

static void add_face(slv_htex_again *again, uint32_t face) {
    if (!again->is_face[face])
        again->faces[again->nfaces++] = face;
    again->is_face[face] = true;
}

/* The faces that have a part of a square, or that a corner of it takes its own value from, and its
 * corners. */
static void add_square(slv_htex_again *again, uint32_t edge) {
    const slv_htex_mesh *mesh = &again->mesh;
    uint32_t nodes[SLV_HTEX_CORNERS], count = slvi_htex_nodes_of(mesh, edge, nodes);
    for (uint32_t side = 0; side < 2; side++) {
        uint32_t half = mesh->half[edge][side];
        if (half == SLV_HTEX_NONE)
            continue;
        add_face(again, half / 4);
        if (slv_htex_is_part(mesh, half / 4))
            add_face(again, mesh->after[half / 4]);
    }
    for (uint32_t k = 0; k < count; k++) {
        uint32_t corner = again->around.number[nodes[k]];
        add_face(again, nodes[k] < 4 * mesh->nfaces ? nodes[k] / 4 : nodes[k] - 4 * mesh->nfaces);
        if (!again->is_corner[corner])
            again->corners[again->ncorners++] = corner;
        again->is_corner[corner] = true;
    }
}

/* How much the faces and squares at hand take to be filled. */
static void measure(const slv_htex_again *again, const slv_htex *htex, uint64_t *bordered,
                    uint64_t *width) {
    *bordered = *width = 0;
    for (uint32_t i = 0; i < again->nfaces; i++) {
        slv_res res = htex->res[again->faces[i]];
        uint64_t count = ((UINT64_C(1) << res.u) + 2) * ((UINT64_C(1) << res.v) + 2);
        *bordered = count > *bordered ? count : *bordered;
        for (uint32_t k = 0; k < 4; k++) {
            uint64_t side = UINT64_C(1) << htex->log2[htex->faces[again->faces[i]].edge[k]];
            *width = side > *width ? side : *width;
        }
    }
}

static void forget(slv_htex_again *again, const uint32_t *edges, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        again->squares[edges[i]] = false;
    for (uint32_t i = 0; i < again->nfaces; i++)
        again->is_face[again->faces[i]] = false;
    for (uint32_t i = 0; i < again->ncorners; i++)
        again->is_corner[again->corners[i]] = false;
    again->nfaces = again->ncorners = 0;
}

static void take_resolution(const slv_htex_again *again, const slv_levels *levels, uint32_t edge,
                            slv_htex *htex) {
    for (uint32_t side = 0; side < 2; side++) {
        uint32_t half = again->mesh.half[edge][side];
        if (half == SLV_HTEX_NONE)
            continue;
        htex->res[half / 4] = levels->res[half / 4];
        if (slv_htex_is_part(&again->mesh, half / 4))
            htex->res[again->mesh.after[half / 4]] = levels->res[again->mesh.after[half / 4]];
    }
}

/* A square of another size gets its own memory. */
static slv_result resize_square(const slv_htex_again *again, uint32_t edge, slv_htex *htex) {
    uint32_t log2 = slvi_htex_log2_for(&again->mesh, htex->res, edge), old = htex->log2[edge];
    unsigned char *own = NULL;
    slv_result result;
    if (log2 == old)
        return SLV_OK;
    uint64_t bytes = slvi_htex_square_bytes(htex, log2);
    if ((result = slvi_alloc_plain(&again->env, "square", bytes, 1, &own)))
        return result;
    slvi_htex_free_own(htex, edge);
    htex->at[edge] = own;
    htex->log2[edge] = (uint8_t)log2;
    htex->bytes += bytes - slvi_htex_square_bytes(htex, old);
    return SLV_OK;
}

/* The least size around a corner may be another: more values than before go behind all others. */
static slv_result resize_corner(const slv_htex_again *again, uint32_t index, slv_htex *htex) {
    slv_htex_corner *corner = &htex->corners[index];
    const slv_htex_around *around = &again->around;
    uint8_t least = UINT8_MAX;
    for (uint32_t i = around->first[index]; i < around->first[index + 1]; i++) {
        uint8_t log2 = htex->log2[around->squares[i] / SLV_HTEX_CORNERS];
        least = log2 < least ? log2 : least;
    }
    corner->log2 = least <= corner->room ? least : corner->log2;
    if (least <= corner->room)
        return SLV_OK;
    uint32_t needed = htex->nvalues + least + 1;
    if (needed > htex->values_capacity) {
        uint64_t n = htex->desc.nchannels, capacity = needed + (uint64_t)needed / 8;
        slv_result result =
            slvi_grow(&again->env, "corners", capacity * n, sizeof *htex->values, &htex->values);
        if (result)
            return result;
        htex->values_capacity = (uint32_t)capacity;
    }
    *corner = (slv_htex_corner){htex->nvalues, least, least};
    htex->nvalues = needed;
    return SLV_OK;
}

/* Sizes, and what is at hand. */
static slv_result begin(slv_htex_again *again, const slv_levels *levels, const uint32_t *edges,
                        uint32_t count, slv_htex *htex, uint64_t *length) {
    slv_result result = SLV_OK;
    for (uint32_t i = 0; i < count; i++)
        take_resolution(again, levels, edges[i], htex);
    for (uint32_t i = 0; !result && i < count; i++) {
        result = resize_square(again, edges[i], htex);
        again->squares[edges[i]] = true;
        again->ends[edges[i]] = *length;
        *length += UINT64_C(1) << htex->log2[edges[i]];
        add_square(again, edges[i]);
    }
    for (uint32_t i = 0; !result && i < again->ncorners; i++)
        result = resize_corner(again, again->corners[i], htex);
    return result;
}

slv_result slvi_htex_refresh(slv_htex_again *again, const slv_levels *levels,
                             const slv_adjacency *adjacency, const uint32_t *edges, uint32_t count,
                             slv_htex *htex) {
    const slv_env *env = &again->env;
    slv_htex_fill fill = {levels,         adjacency,   &again->mesh, htex,       *env,
                          again->squares, again->ends, NULL,         again->tops};
    uint64_t n = htex->desc.nchannels, length = 0, texels, width;
    float *bordered = NULL, *row = NULL;
    double *sums = NULL;
    slv_result result = begin(again, levels, edges, count, htex, &length);
    if (result)
        goto done;
    measure(again, htex, &texels, &width);
    if ((result = slvi_alloc_plain(env, "samples on edges", length * 2 * n, sizeof *fill.diagonals,
                                   &fill.diagonals)) ||
        (result = slvi_alloc_plain(env, "border", texels * n, sizeof *bordered, &bordered)) ||
        (result = slvi_alloc_plain(env, "texels", (2 * width + 1) * n, sizeof *row, &row)) ||
        (result = slvi_alloc_plain(env, "corners", SLV_HTEX_MOST_LOG2 * n, sizeof *sums, &sums)))
        goto done;
    for (uint32_t i = 0; !result && i < again->nfaces; i++)
        result = slvi_htex_fill_face(&fill, again->faces[i], bordered, row);
    for (uint32_t i = 0; !result && i < count; i++)
        slvi_htex_fill_edge(&fill, edges[i], row);
    for (uint32_t i = 0; !result && i < again->ncorners; i++)
        slvi_htex_corner_values(htex, &again->around, again->tops, again->corners[i], sums, row);
done:
    forget(again, edges, count);
    slvi_free(fill.diagonals);
    slvi_free(bordered);
    slvi_free(row);
    slvi_free(sums);
    return result;
}
