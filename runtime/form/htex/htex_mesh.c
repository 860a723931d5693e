/* Half-edges of the control mesh, put together from faces and sub-faces. */
#include "form/htex/htex_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <string.h>

/* The sub-face across `edge`, if the two share a side that ends at their polygon's centre. */
static uint32_t beside(const slv_adjacency *adjacency, uint32_t face, unsigned edge,
                       unsigned expected) {
    const slv_face_adjacency *links = &slv_adjacency_faces(adjacency)[face];
    int32_t to = links->face[edge];
    return to >= 0 && links->edge[edge] == expected && slv_adjacency_is_subface(adjacency, to)
               ? (uint32_t)to
               : SLV_HTEX_NONE;
}

/* Links that lead out of edge 1 and in at edge 2 are one to one: a walk along them comes back to
 * where it started, or ends. */
static void find_polygons(const slv_adjacency *adjacency, slv_htex_mesh *mesh, bool *seen) {
    for (uint32_t face = 0; face < mesh->nfaces; face++) {
        mesh->polygon[face] = face;
        mesh->after[face] = mesh->before[face] = SLV_HTEX_NONE;
    }
    for (uint32_t start = 0; start < mesh->nfaces; start++) {
        uint32_t count = 0, at = start;
        if (seen[start] || !slv_adjacency_is_subface(adjacency, (int32_t)start))
            continue;
        do {
            seen[at] = true;
            at = beside(adjacency, at, 1, 2);
            count++;
        } while (at != SLV_HTEX_NONE && at != start && !seen[at]);
        if (at != start || count < 3)
            continue;
        do {
            uint32_t next = beside(adjacency, at, 1, 2);
            mesh->polygon[at] = start;
            mesh->after[at] = next;
            mesh->before[next] = at;
            at = next;
        } while (at != start);
    }
}

/* The half-edge of which a neighbour's edge is a part. */
static uint32_t half_of(const slv_htex_mesh *mesh, uint32_t face, uint32_t edge) {
    if (!slv_htex_is_part(mesh, face))
        return 4 * face + edge;
    return edge == 0 ? 4 * face : edge == 3 ? 4 * mesh->before[face] : SLV_HTEX_NONE;
}

/* A polygon's half-edge is edge 0 of one sub-face and edge 3 of the next. */
static uint32_t across(const slv_adjacency *adjacency, const slv_htex_mesh *mesh, uint32_t half) {
    uint32_t face = half / 4;
    bool part = slv_htex_is_part(mesh, face);
    for (unsigned try = 0; try < (part ? 2u : 1u); try++) {
        slv_neighbour to[2];
        uint32_t from = try ? mesh->after[face] : face;
        uint32_t count = slv_adjacency_neighbours(adjacency, (int32_t)from, try ? 3 : half % 4, to);
        for (uint32_t i = 0; i < count; i++) {
            bool fits = to[i].scale == 1
                            ? slv_htex_is_part(mesh, (uint32_t)to[i].face) == part
                            : slv_htex_is_part(mesh, (uint32_t)to[i].face) == (to[i].scale > 1) &&
                                  part == (to[i].scale < 1);
            if (fits)
                return half_of(mesh, (uint32_t)to[i].face, to[i].edge);
        }
    }
    return SLV_HTEX_NONE;
}

static void find_twins(const slv_adjacency *adjacency, slv_htex_mesh *mesh) {
    uint32_t nhalves = 4 * mesh->nfaces;
    for (uint32_t h = 0; h < nhalves; h++)
        mesh->twin[h] =
            slv_htex_is_part(mesh, h / 4) && h % 4 ? SLV_HTEX_NONE : across(adjacency, mesh, h);
    for (uint32_t h = 0; h < nhalves; h++) {
        uint32_t twin = mesh->twin[h];
        if (twin != SLV_HTEX_NONE && (twin == h || mesh->twin[twin] != h))
            mesh->twin[h] = SLV_HTEX_NONE;
    }
}

static uint32_t find_root(uint32_t *root, uint32_t node) {
    while (root[node] != node)
        node = root[node] = root[root[node]];
    return node;
}

static void join(uint32_t *root, uint32_t a, uint32_t b) {
    a = find_root(root, a);
    b = find_root(root, b);
    root[a > b ? a : b] = a < b ? a : b;
}

static void find_edges(slv_htex_mesh *mesh) {
    uint32_t nhalves = 4 * mesh->nfaces;
    for (uint32_t h = 0; h < nhalves; h++) {
        mesh->root[h] = h;
        mesh->edge[h] = SLV_HTEX_NONE;
    }
    for (uint32_t h = 0; h < nhalves; h++) {
        uint32_t twin = mesh->twin[h];
        if ((slv_htex_is_part(mesh, h / 4) && h % 4) || mesh->edge[h] != SLV_HTEX_NONE)
            continue;
        mesh->half[mesh->nedges][0] = h;
        mesh->half[mesh->nedges][1] = twin;
        mesh->edge[h] = mesh->nedges;
        if (twin != SLV_HTEX_NONE) {
            mesh->edge[twin] = mesh->nedges;
            join(mesh->root, h, slv_htex_next(mesh, twin));
            join(mesh->root, twin, slv_htex_next(mesh, h));
        }
        mesh->nedges++;
    }
    for (uint32_t h = 0; h < nhalves; h++)
        mesh->root[h] = find_root(mesh->root, h);
}

slv_result slvi_htex_mesh_create(const slv_env *env, const slv_adjacency *adjacency,
                                 slv_htex_mesh *out) {
    slv_htex_mesh mesh = {.nfaces = slv_adjacency_face_count(adjacency)};
    uint64_t nfaces = mesh.nfaces, nhalves = 4 * nfaces;
    bool *seen = NULL;
    slv_result result;
    memset(out, 0, sizeof *out);
    if (nfaces > UINT32_MAX / 5)
        return slvi_fail(env, SLV_ERROR_LIMIT, "half-edges: %u faces are too many",
                         (unsigned)mesh.nfaces);
    if ((result = slvi_alloc(env, "polygons", nfaces, sizeof *seen, &seen)) ||
        (result = slvi_alloc(env, "polygons", nfaces, sizeof *mesh.after, &mesh.after)) ||
        (result = slvi_alloc(env, "polygons", nfaces, sizeof *mesh.before, &mesh.before)) ||
        (result = slvi_alloc(env, "polygons", nfaces, sizeof *mesh.polygon, &mesh.polygon)) ||
        (result = slvi_alloc(env, "half-edges", nhalves, sizeof *mesh.twin, &mesh.twin)) ||
        (result = slvi_alloc(env, "half-edges", nhalves, sizeof *mesh.edge, &mesh.edge)) ||
        (result = slvi_alloc(env, "half-edges", nhalves, sizeof *mesh.root, &mesh.root)) ||
        (result = slvi_alloc(env, "edges", nhalves, sizeof *mesh.half, &mesh.half)))
        goto done;
    find_polygons(adjacency, &mesh, seen);
    find_twins(adjacency, &mesh);
    find_edges(&mesh);
    *out = mesh;
    memset(&mesh, 0, sizeof mesh);
done:
    slvi_free(seen);
    slvi_htex_mesh_free(&mesh);
    return result;
}

void slvi_htex_mesh_free(slv_htex_mesh *mesh) {
    slvi_free(mesh->after);
    slvi_free(mesh->before);
    slvi_free(mesh->polygon);
    slvi_free(mesh->twin);
    slvi_free(mesh->edge);
    slvi_free(mesh->half);
    slvi_free(mesh->root);
    memset(mesh, 0, sizeof *mesh);
}
