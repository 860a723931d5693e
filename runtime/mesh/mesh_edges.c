/* The edges of a polygon mesh, and what follows from them: adjacency and statistics. */
#include "mesh/mesh_data.h"

#include "base/memory.h"

static uint64_t hash_pair(int32_t a, int32_t b) {
    uint64_t x = (uint64_t)(uint32_t)a << 32 | (uint32_t)b;
    x = (x ^ x >> 32) * UINT64_C(0xd6e8feb86659fd93);
    x = (x ^ x >> 32) * UINT64_C(0xd6e8feb86659fd93);
    return x ^ x >> 32;
}

/* The slot that holds the pair, or the empty one where it belongs. */
static uint32_t *find_slot(const slv_mesh_edges *edges, int32_t v0, int32_t v1) {
    uint32_t i = (uint32_t)hash_pair(v0, v1) & edges->table_mask;
    while (edges->table[i] != SLV_NO_EDGE &&
           (edges->edges[edges->table[i]].v0 != v0 || edges->edges[edges->table[i]].v1 != v1))
        i = (i + 1) & edges->table_mask;
    return &edges->table[i];
}

uint32_t slvi_mesh_edges_find(const slv_mesh_edges *edges, int32_t a, int32_t b) {
    return a < b ? *find_slot(edges, a, b) : *find_slot(edges, b, a);
}

static void add_side(const slv_mesh *mesh, slv_mesh_edges *edges, uint32_t poly, uint32_t side,
                     int32_t a, int32_t b) {
    edges->side_poly[side] = poly;
    edges->side_edge[side] = SLV_NO_EDGE;
    if (a == b)
        return;
    int32_t v0 = a < b ? a : b, v1 = a < b ? b : a;
    uint32_t *slot = find_slot(edges, v0, v1);
    if (*slot == SLV_NO_EDGE) {
        *slot = edges->count++;
        edges->edges[*slot].v0 = v0;
        edges->edges[*slot].v1 = v1;
    }
    slv_mesh_edge *edge = &edges->edges[*slot];
    if (edge->count < 2)
        edge->side[edge->count] = side;
    edge->count++;
    edge->hole |= mesh->poly_hole[poly] != 0;
    edges->side_edge[side] = *slot;
}

slv_result slvi_mesh_edges_create(const slv_env *env, const slv_mesh *mesh, slv_mesh_edges *out) {
    const slv_mesh_view *view = &mesh->view;
    slv_result result = SLV_OK;
    uint32_t nsides = mesh->poly_first[view->npolys];
    uint64_t capacity = 16;
    *out = (slv_mesh_edges){0};
    while (capacity < (uint64_t)nsides + nsides / 2)
        capacity *= 2;
    if ((result = slvi_alloc(env, "mesh edges", nsides, sizeof *out->edges, &out->edges)) ||
        (result = slvi_alloc(env, "mesh edges", nsides, sizeof *out->side_edge, &out->side_edge)) ||
        (result = slvi_alloc(env, "mesh edges", nsides, sizeof *out->side_poly, &out->side_poly)) ||
        (result = slvi_alloc(env, "mesh edges", capacity, sizeof *out->table, &out->table))) {
        slvi_mesh_edges_clear(out);
        return result;
    }
    out->table_mask = (uint32_t)(capacity - 1);
    for (uint64_t i = 0; i < capacity; i++)
        out->table[i] = SLV_NO_EDGE;
    for (uint32_t p = 0; p < view->npolys; p++) {
        uint32_t first = mesh->poly_first[p], end = mesh->poly_first[p + 1];
        for (uint32_t s = first; s < end; s++)
            add_side(mesh, out, p, s, view->poly_verts[s],
                     view->poly_verts[s + 1 < end ? s + 1 : first]);
    }
    return SLV_OK;
}

void slvi_mesh_edges_clear(slv_mesh_edges *edges) {
    slvi_free(edges->edges);
    slvi_free(edges->side_edge);
    slvi_free(edges->side_poly);
    slvi_free(edges->table);
    *edges = (slv_mesh_edges){0};
}

bool slvi_mesh_edge_is_flipped(const slv_mesh *mesh, const slv_mesh_edge *edge) {
    return edge->count == 2 &&
           mesh->view.poly_verts[edge->side[0]] == mesh->view.poly_verts[edge->side[1]];
}

/* A side of a polygon as faces: `near` holds its half at the start, `far` the one at the end. */
typedef struct side_faces {
    int32_t near, far;
    uint8_t near_edge, far_edge;
    bool whole;
} side_faces;

static side_faces faces_of_side(const slv_mesh *mesh, const slv_mesh_edges *edges, uint32_t side) {
    uint32_t poly = edges->side_poly[side];
    int32_t k = (int32_t)(side - mesh->poly_first[poly]), size = mesh->view.poly_sizes[poly];
    int32_t face = mesh->poly_face[poly];
    if (size == 4)
        return (side_faces){face, face, (uint8_t)k, (uint8_t)k, true};
    return (side_faces){face + k, face + (k + 1) % size, 0, 3, false};
}

static void link_to(slv_face_adjacency *faces, int32_t face, uint8_t edge, int32_t to,
                    uint8_t to_edge) {
    faces[face].face[edge] = to;
    faces[face].edge[edge] = to_edge;
}

/* The sides run in opposite directions, so the start of one meets the end of the other. A whole
 * face's record gets the first half that it meets, which is the other side's far one. */
static void link_sides(slv_face_adjacency *faces, side_faces a, side_faces b) {
    link_to(faces, a.near, a.near_edge, b.far, b.far_edge);
    link_to(faces, b.near, b.near_edge, a.far, a.far_edge);
    if (!a.whole)
        link_to(faces, a.far, a.far_edge, b.near, b.near_edge);
    if (!b.whole)
        link_to(faces, b.far, b.far_edge, a.near, a.near_edge);
}

static slv_result link_all(const slv_env *env, const slv_mesh *mesh, slv_adjacency **out) {
    slv_result result = SLV_OK;
    slv_mesh_edges edges = {0};
    slv_face_adjacency *faces = NULL;
    *out = NULL;
    if ((result = slvi_mesh_edges_create(env, mesh, &edges)) ||
        (result = slvi_alloc(env, "adjacency", mesh->nfaces, sizeof *faces, &faces)))
        goto done;
    for (uint32_t f = 0; f < mesh->nfaces; f++) {
        slv_mesh_face face = mesh->faces[f];
        for (uint8_t e = 0; e < 4; e++)
            faces[f].face[e] = SLV_BOUNDARY;
        if (face.sub < 0)
            continue;
        int32_t first = mesh->poly_face[face.poly], size = mesh->view.poly_sizes[face.poly];
        link_to(faces, (int32_t)f, 1, first + (face.sub + 1) % size, 2);
        link_to(faces, (int32_t)f, 2, first + (face.sub + size - 1) % size, 1);
    }
    for (uint32_t i = 0; i < edges.count; i++) {
        const slv_mesh_edge *edge = &edges.edges[i];
        if (edge->count == 2 && !edge->hole && !slvi_mesh_edge_is_flipped(mesh, edge))
            link_sides(faces, faces_of_side(mesh, &edges, edge->side[0]),
                       faces_of_side(mesh, &edges, edge->side[1]));
    }
    result = slv_adjacency_create(env, mesh->nfaces, faces, mesh->flags, out);
done:
    slvi_free(faces);
    slvi_mesh_edges_clear(&edges);
    return result;
}

slv_result slv_mesh_adjacency(const slv_env *env, const slv_mesh *mesh, slv_adjacency **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, link_all(&own, mesh, out));
}

static void add_bounds(const slv_mesh_view *view, slv_mesh_stats *out) {
    for (uint32_t v = 0; v < view->nverts; v++)
        for (int c = 0; c < 3; c++) {
            float x = (float)((double)view->positions[3 * (size_t)v + (size_t)c] + view->origin[c]);
            if (v == 0 || x < out->bounds_min[c])
                out->bounds_min[c] = x;
            if (v == 0 || x > out->bounds_max[c])
                out->bounds_max[c] = x;
        }
}

slv_result slv_mesh_get_stats(const slv_env *env, const slv_mesh *mesh, slv_mesh_stats *out) {
    const slv_mesh_view *view = &mesh->view;
    slv_result result = SLV_OK;
    slv_mesh_edges edges = {0};
    uint32_t *valence = NULL, *last_poly = NULL;
    uint8_t *border = NULL;
    *out = (slv_mesh_stats){.npolys = view->npolys,
                            .nverts = view->nverts,
                            .nfaces = mesh->nfaces,
                            .nsubfaces = mesh->nsubfaces,
                            .ncreases = view->ncreases};
    if ((result = slvi_mesh_edges_create(env, mesh, &edges)) ||
        (result = slvi_alloc(env, "mesh statistics", view->nverts, 4, &valence)) ||
        (result = slvi_alloc(env, "mesh statistics", view->nverts, 4, &last_poly)) ||
        (result = slvi_alloc(env, "mesh statistics", view->nverts, 1, &border)))
        goto done;
    for (uint32_t p = 0; p < view->npolys; p++) {
        out->nholes += mesh->poly_hole[p];
        for (uint32_t s = mesh->poly_first[p]; s < mesh->poly_first[p + 1]; s++) {
            int32_t v = view->poly_verts[s];
            if (last_poly[v] != p + 1)
                valence[v]++;
            last_poly[v] = p + 1;
        }
    }
    out->nedges = edges.count;
    for (uint32_t i = 0; i < edges.count; i++) {
        const slv_mesh_edge *edge = &edges.edges[i];
        out->nboundary_edges += edge->count == 1;
        out->nnonmanifold_edges += edge->count > 2;
        out->nflipped_edges += slvi_mesh_edge_is_flipped(mesh, edge);
        if (edge->count == 1)
            border[edge->v0] = border[edge->v1] = 1;
    }
    for (uint32_t v = 0; v < view->nverts; v++) {
        out->nisolated_verts += valence[v] == 0;
        out->nvalence[valence[v] < 32 ? valence[v] : 32]++;
        out->nextraordinary += valence[v] && (border[v] ? valence[v] > 2 : valence[v] != 4);
    }
    add_bounds(view, out);
done:
    slvi_free(valence);
    slvi_free(last_poly);
    slvi_free(border);
    slvi_mesh_edges_clear(&edges);
    return result;
}
