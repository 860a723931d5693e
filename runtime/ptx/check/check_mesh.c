/* Whether the faces of a file meet as those of a mesh do. */
#include "ptx/check/check.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>

struct side {
    uint32_t low, high; /* the edge's vertices */
    int32_t face;
    uint8_t edge;
    bool upwards; /* from low to high */
};

static int compare_sides(const void *left, const void *right) {
    const struct side *a = left, *b = right;
    if (a->low != b->low)
        return a->low < b->low ? -1 : 1;
    if (a->high != b->high)
        return a->high < b->high ? -1 : 1;
    if (a->face != b->face)
        return a->face < b->face ? -1 : 1;
    return (a->edge > b->edge) - (a->edge < b->edge);
}

static slv_result triangle_adjacency(const slv_env *env, const slv_mesh *mesh,
                                     slv_face_adjacency *out) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    uint64_t nsides = (uint64_t)view->npolys * 3;
    struct side *sides = NULL;
    slv_result result = slvi_alloc(env, "edges", nsides, sizeof *sides, &sides);
    if (result)
        return result;
    for (uint64_t i = 0; i < nsides; i++) {
        uint64_t first = i / 3 * 3;
        uint32_t from = (uint32_t)view->poly_verts[i],
                 to = (uint32_t)view->poly_verts[first + (i + 1) % 3];
        bool upwards = from < to;
        sides[i] = (struct side){upwards ? from : to, upwards ? to : from, (int32_t)(i / 3),
                                 (uint8_t)(i % 3), upwards};
    }
    qsort(sides, nsides, sizeof *sides, compare_sides);
    for (uint32_t face = 0; face < view->npolys; face++)
        out[face] = (slv_face_adjacency){{-1, -1, -1, -1}, {0, 0, 0, 0}};
    for (uint64_t i = 0, end; i < nsides; i = end) {
        const struct side *a = &sides[i], *b = a + 1;
        for (end = i + 1; end < nsides && sides[end].low == a->low && sides[end].high == a->high;)
            end++;
        if (end != i + 2 || a->upwards == b->upwards)
            continue;
        out[a->face].face[a->edge] = b->face;
        out[a->face].edge[a->edge] = b->edge;
        out[b->face].face[b->edge] = a->face;
        out[b->face].edge[b->edge] = a->edge;
    }
    slvi_free(sides);
    return SLV_OK;
}

static void describe(char *out, size_t size, int32_t face, unsigned edge) {
    if (face < 0)
        snprintf(out, size, "a boundary");
    else
        snprintf(out, size, "face %d edge %u", face, edge);
}

struct comparison {
    check_context *check;
    const slv_mesh *mesh;
    const char *name; /* of the mesh, in messages */
    bool repairable;
    const slv_face_adjacency *expected;
    const slv_adjacency *quads; /* NULL: triangles */
};

static bool edge_matches(const struct comparison *c, uint32_t face, unsigned edge) {
    const slv_face_adjacency *file = &c->check->faces[face].adjacency;
    int32_t there = file->face[edge];
    slv_neighbour neighbours[2];
    uint32_t count = 0;
    if (!c->quads)
        return there == c->expected[face].face[edge] &&
               (there < 0 || file->edge[edge] == c->expected[face].edge[edge]);
    count = slv_adjacency_neighbours(c->quads, (int32_t)face, edge, neighbours);
    for (uint32_t i = 0; i < count; i++)
        if (neighbours[i].face == there && neighbours[i].edge == file->edge[edge])
            return true;
    /* the mesh's adjacency stops at holes, a painter's may not */
    return !count && (there < 0 || ((uint32_t)there < slv_mesh_face_count(c->mesh) &&
                                    slv_mesh_face_is_hole(c->mesh, there)));
}

static void compare_face(const struct comparison *c, uint32_t face) {
    slv_check_finding finding = {.kind = SLV_CHECK_MESH,
                                 .repairable = c->repairable,
                                 .face = (int32_t)face,
                                 .edge = -1,
                                 .level = -1};
    const slv_ptx_face *f = &c->check->faces[face];
    bool sub = f->flags & SLV_FACE_SUBFACE;
    if (c->quads && sub != slv_adjacency_is_subface(c->quads, (int32_t)face))
        slvi_check_find(c->check->findings, &finding, "face %u: is %s, but %s has %s", face,
                        sub ? "a sub-face" : "a whole quad", c->name,
                        sub ? "a whole quad" : "a sub-face");
    if (c->quads && slv_mesh_face_is_hole(c->mesh, (int32_t)face))
        return;
    for (unsigned edge = 0; edge < c->check->nedges; edge++) {
        char there[64], expected[64];
        if (edge_matches(c, face, edge))
            continue;
        finding.edge = (int32_t)edge;
        describe(there, sizeof there, f->adjacency.face[edge], f->adjacency.edge[edge]);
        describe(expected, sizeof expected, c->expected[face].face[edge],
                 c->expected[face].edge[edge]);
        slvi_check_find(c->check->findings, &finding, "face %u edge %u: is at %s, but in %s at %s",
                        face, edge, there, c->name, expected);
    }
}

static bool has_adjacency(const check_context *check) {
    for (uint32_t face = 0; face < check->info->nfaces; face++)
        for (unsigned edge = 0; edge < check->nedges; edge++)
            if (check->faces[face].adjacency.face[edge] >= 0)
                return true;
    return false;
}

/* A table without any neighbour says nothing about the mesh, and is worth one line, not thousands.
 */
static void compare_faces(const struct comparison *c, uint32_t mesh_faces) {
    check_context *check = c->check;
    uint32_t nfaces = check->info->nfaces, common = nfaces < mesh_faces ? nfaces : mesh_faces;
    slv_check_finding finding = {.kind = SLV_CHECK_MESH, .face = -1, .edge = -1, .level = -1};
    uint64_t inner = 0;
    if (nfaces != mesh_faces)
        slvi_check_find(check->findings, &finding, "the file has %u faces, %s has %u", nfaces,
                        c->name, mesh_faces);
    for (uint32_t face = 0; face < mesh_faces; face++)
        for (unsigned edge = 0; edge < check->nedges; edge++)
            inner += c->expected[face].face[edge] >= 0;
    if (inner && !has_adjacency(check)) {
        finding.warning = true;
        finding.repairable = c->repairable;
        slvi_check_find(check->findings, &finding,
                        "no face has a neighbour, but %s has %llu shared edges", c->name,
                        (unsigned long long)inner / 2);
        return;
    }
    for (uint32_t face = 0; face < common; face++)
        compare_face(c, face);
}

slv_result slvi_check_mesh(check_context *check, const slv_mesh *mesh, bool inside) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    bool triangles = check->info->mesh_type == SLV_PTX_TRIANGLE;
    uint32_t count = triangles ? view->npolys : slv_mesh_face_count(mesh);
    struct comparison c = {.check = check,
                           .mesh = mesh,
                           .name = inside ? "the mesh inside" : "the mesh",
                           .repairable = count == check->info->nfaces};
    slv_check_finding finding = {.kind = SLV_CHECK_MESH, .face = -1, .edge = -1, .level = -1};
    slv_adjacency *quads = NULL;
    slv_face_adjacency *expected = NULL;
    slv_result result = SLV_OK;
    check->mesh_fits = false;
    for (uint32_t poly = 0; triangles && poly < view->npolys; poly++)
        if (view->poly_sizes[poly] != 3) {
            slvi_check_find(check->findings, &finding,
                            "the file is of triangles, but polygon %u of %s has %d vertices", poly,
                            c.name, view->poly_sizes[poly]);
            return SLV_OK;
        }
    if (triangles) {
        if ((result = slvi_alloc(&check->env, "edges", count, sizeof *expected, &expected)) ||
            (result = triangle_adjacency(&check->env, mesh, expected)))
            goto done;
        c.expected = expected;
    } else {
        if ((result = slv_mesh_adjacency(&check->env, mesh, &quads)))
            goto done;
        c.quads = quads;
        c.expected = slv_adjacency_faces(quads);
    }
    check->mesh_fits = c.repairable;
    compare_faces(&c, count);
done:
    slv_adjacency_destroy(quads);
    slvi_free(expected);
    return result;
}
