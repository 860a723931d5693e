/* Adjacency made from polygons: against the positions, against the fans, and against OpenSubdiv's.
 */
#include "kit/edge_kit.h"
#include "kit/mesh_shapes.h"

#include <selvage/surface.h>

static void bilinear(const slv_mesh *mesh, int32_t face, float u, float v, float out[3]) {
    float c[4][3];
    for (unsigned k = 0; k < 4; k++)
        shape_corner(mesh, face, k, c[k]);
    for (int i = 0; i < 3; i++)
        out[i] =
            (1 - v) * ((1 - u) * c[0][i] + u * c[1][i]) + v * ((1 - u) * c[3][i] + u * c[2][i]);
}

static bool same_place(const float a[3], const float b[3]) {
    return fabsf(a[0] - b[0]) + fabsf(a[1] - b[1]) + fabsf(a[2] - b[2]) < 1e-5f;
}

/* Every point of a shared edge is the same point seen from the other side, and links are mutual. */
static void check_neighbours(const slv_mesh *mesh, const slv_adjacency *a) {
    for (int32_t f = 0; f < (int32_t)slv_mesh_face_count(mesh); f++)
        for (unsigned e = 0; e < 4; e++) {
            slv_neighbour n[2], back[2];
            uint32_t count = slv_adjacency_neighbours(a, f, e, n);
            for (uint32_t i = 0; i < count; i++) {
                for (int step = 0; step <= 2; step++) {
                    float t = n[i].t0 + (n[i].t1 - n[i].t0) * 0.5f * (float)step, u2, v2;
                    float u, v, here[3], there[3];
                    kit_edge_point_float(e, t, &u, &v);
                    slv_affine_apply(&n[i].map, u, v, &u2, &v2);
                    bilinear(mesh, f, u, v, here);
                    bilinear(mesh, n[i].face, u2, v2, there);
                    CHECK_MSG(same_place(here, there), "face %d edge %u", f, e);
                }
                uint32_t others = slv_adjacency_neighbours(a, n[i].face, n[i].edge, back), hits = 0;
                for (uint32_t j = 0; j < others; j++)
                    hits += back[j].face == f && back[j].edge == e;
                CHECK(hits == 1);
            }
        }
}

/* The fans around vertices, found slowly: two polygon corners at a vertex are joined if they share
 * a good edge there. */
typedef struct fans {
    uint32_t *parent, *side_poly;
    uint32_t nsides;
} fans;

static uint32_t fan_root(const fans *f, uint32_t side) {
    while (f->parent[side] != side)
        side = f->parent[side];
    return side;
}

static uint32_t next_side(const slv_mesh_view *view, const fans *f, uint32_t side) {
    bool last = side + 1 == f->nsides || f->side_poly[side + 1] != f->side_poly[side];
    return last ? side + 1 - (uint32_t)view->poly_sizes[f->side_poly[side]] : side + 1;
}

static fans find_fans(const slv_mesh_view *view) {
    fans f = {0};
    for (uint32_t p = 0; p < view->npolys; p++)
        f.nsides += (uint32_t)view->poly_sizes[p];
    f.parent = shape_grow(NULL, f.nsides, 4);
    f.side_poly = shape_grow(NULL, f.nsides, 4);
    uint32_t side = 0;
    for (uint32_t p = 0; p < view->npolys; p++)
        for (int32_t i = 0; i < view->poly_sizes[p]; i++, side++) {
            f.side_poly[side] = p;
            f.parent[side] = side;
        }
    const int32_t *v = view->poly_verts;
    for (uint32_t s = 0; s < f.nsides; s++) {
        uint32_t users = 0, mate = 0;
        int32_t a = v[s], b = v[next_side(view, &f, s)];
        bool hole = false;
        for (uint32_t t = 0; t < f.nsides; t++) {
            int32_t c = v[t], d = v[next_side(view, &f, t)];
            if (a == b || !((a == c && b == d) || (a == d && b == c)))
                continue;
            users++;
            if (t != s)
                mate = t;
            for (uint32_t h = 0; h < view->nholes; h++)
                hole |= view->hole_polys[h] == (int32_t)f.side_poly[t];
        }
        if (users != 2 || hole || v[mate] != b)
            continue;
        f.parent[fan_root(&f, s)] = fan_root(&f, next_side(view, &f, mate));
        f.parent[fan_root(&f, next_side(view, &f, s))] = fan_root(&f, mate);
    }
    return f;
}

static void check_rings(const slv_mesh *mesh, const slv_adjacency *a) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    const slv_mesh_face *faces = slv_mesh_faces(mesh);
    fans fan = find_fans(view);
    uint32_t nfaces = slv_mesh_face_count(mesh);
    int32_t *side_of = shape_grow(NULL, 4 * (size_t)nfaces, sizeof *side_of);
    uint32_t *fan_size = calloc(fan.nsides + 1, sizeof *fan_size), first = 0;
    for (uint32_t s = 0; s < fan.nsides; s++)
        fan_size[fan_root(&fan, s)]++;
    for (uint32_t f = 0; f < nfaces; f++) {
        if (f && faces[f].poly != faces[f - 1].poly)
            first += (uint32_t)view->poly_sizes[faces[f - 1].poly];
        for (int c = 0; c < 4; c++)
            side_of[4 * f + (uint32_t)c] = faces[f].sub < 0 ? (int32_t)first + c
                                           : c == 0         ? (int32_t)first + faces[f].sub
                                                            : -1;
    }
    for (int32_t f = 0; f < (int32_t)nfaces; f++)
        for (unsigned c = 0; c < 4; c++) {
            uint32_t position;
            float here[3], there[3];
            slv_ring ring = slv_adjacency_ring(a, f, c, &position);
            shape_corner(mesh, f, c, here);
            CHECK(ring.corners[position].face == f && ring.corners[position].corner == c);
            int32_t side = side_of[4 * f + (int)c];
            for (uint32_t i = 0; i < ring.count; i++) {
                slv_corner k = ring.corners[i];
                shape_corner(mesh, k.face, k.corner, there);
                CHECK(same_place(here, there));
                int32_t other = side_of[4 * k.face + k.corner];
                CHECK((side < 0) == (other < 0));
                if (side >= 0 && other >= 0)
                    CHECK(fan_root(&fan, (uint32_t)side) == fan_root(&fan, (uint32_t)other));
            }
            if (side >= 0)
                CHECK_MSG(ring.count == fan_size[fan_root(&fan, (uint32_t)side)],
                          "face %d corner %u: ring of %u", f, c, ring.count);
            if (faces[f].sub >= 0 && c == 2)
                CHECK(ring.closed && (int32_t)ring.count == view->poly_sizes[faces[f].poly]);
            slv_neighbour n[2];
            bool beside_whole = faces[f].sub >= 0 && (c & 1) &&
                                slv_adjacency_neighbours(a, f, c == 1 ? 0 : 3, n) &&
                                n[0].scale == 0.5f;
            CHECK(slv_adjacency_is_t_corner(a, f, c) == beside_whole);
        }
    free(fan.parent);
    free(fan.side_poly);
    free(side_of);
    free(fan_size);
}

static void check_against_osd(const slv_env *env, const slv_mesh *mesh, const slv_adjacency *a) {
    slv_surface *surface = NULL;
    slv_surface_params params = {.scheme = SLV_SCHEME_BILINEAR};
    uint32_t nfaces = slv_mesh_face_count(mesh);
    slv_face_adjacency *theirs = shape_grow(NULL, nfaces, sizeof *theirs);
    const slv_face_adjacency *ours = slv_adjacency_faces(a);
    MUST(slv_surface_create(env, mesh, &params, &surface));
    MUST(slv_surface_osd_adjacency(surface, theirs));
    for (uint32_t f = 0; f < nfaces; f++)
        for (int e = 0; e < 4; e++)
            CHECK_MSG(ours[f].face[e] == theirs[f].face[e] &&
                          (ours[f].face[e] < 0 || ours[f].edge[e] == theirs[f].edge[e]),
                      "face %u edge %d: ours %d/%d, OpenSubdiv's %d/%d", f, e, ours[f].face[e],
                      ours[f].edge[e], theirs[f].face[e], theirs[f].edge[e]);
    slv_surface_destroy(surface);
    free(theirs);
}

static void check_mesh(const slv_env *env, const slv_mesh *mesh, bool manifold) {
    slv_adjacency *a = NULL;
    MUST(slv_mesh_adjacency(env, mesh, &a));
    CHECK(slv_adjacency_cut_count(a) == 0);
    check_neighbours(mesh, a);
    check_rings(mesh, a);
    if (manifold)
        check_against_osd(env, mesh, a);
    slv_adjacency_destroy(a);
}

static void test_random_meshes(void) {
    slv_env env = test_env();
    uint64_t random = 7;
    for (int round = 0; round < 12 * SHAPE_KINDS; round++) {
        int kind = round % SHAPE_KINDS;
        shape s = shape_random(kind, &random);
        slv_mesh *mesh = shape_mesh(&env, &s);
        check_mesh(&env, mesh, true);
        slv_mesh_destroy(mesh);
        shape_flip_polygon(&s, test_random(&random) % s.npolys);
        mesh = shape_mesh(&env, &s);
        check_mesh(&env, mesh, false);
        slv_mesh_destroy(mesh);
        shape_scramble(&s, &random, 1 + test_random(&random) % 6);
        slv_mesh_view view = shape_view(&s);
        int32_t hole = (int32_t)(test_random(&random) % s.npolys);
        view.nholes = 1;
        view.hole_polys = &hole;
        MUST(slv_mesh_create(&env, &view, &mesh));
        CHECK(slv_mesh_face_is_hole(mesh, 0) == (hole == 0) && !slv_mesh_face_is_hole(mesh, -1));
        check_mesh(&env, mesh, false);
        slv_mesh_destroy(mesh);
        shape_clear(&s);
    }
}

/* Three quads on one edge, and two fans that meet in one vertex. */
static void test_non_manifold(void) {
    slv_env env = test_env();
    shape s = shape_grid(2, 1, false, false);
    int32_t a = shape_vertex(&s, 1, 0, 2), b = shape_vertex(&s, 1, 1, 2);
    int32_t fin[4] = {1, 4, b, a};
    shape_polygon(&s, 4, fin);
    slv_mesh *mesh = shape_mesh(&env, &s);
    slv_mesh_stats stats;
    slv_neighbour n[2];
    slv_adjacency *adjacency = NULL;
    MUST(slv_mesh_get_stats(&env, mesh, &stats));
    CHECK(stats.nnonmanifold_edges == 1 && stats.nflipped_edges == 0);
    MUST(slv_mesh_adjacency(&env, mesh, &adjacency));
    CHECK(slv_adjacency_neighbours(adjacency, 0, 1, n) == 0);
    slv_adjacency_destroy(adjacency);
    check_mesh(&env, mesh, false);
    slv_mesh_destroy(mesh);
    shape_clear(&s);

    s = shape_grid(2, 2, false, false);
    int32_t bow[2][4] = {{0, 1, 4, 3}, {4, 5, 8, 7}};
    s.npolys = s.nsides = 0;
    shape_polygon(&s, 4, bow[0]);
    shape_polygon(&s, 4, bow[1]);
    mesh = shape_mesh(&env, &s);
    MUST(slv_mesh_adjacency(&env, mesh, &adjacency));
    CHECK(slv_adjacency_ring(adjacency, 0, 2, NULL).count == 1);
    slv_adjacency_destroy(adjacency);
    check_mesh(&env, mesh, true);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
}

/* A pole of 720 triangles, as rings have to be found in linear time. */
static void test_pole(void) {
    slv_env env = test_env();
    shape s = shape_fan(720, 3);
    slv_mesh *mesh = shape_mesh(&env, &s);
    slv_adjacency *a = NULL;
    MUST(slv_mesh_adjacency(&env, mesh, &a));
    slv_ring ring = slv_adjacency_ring(a, 0, 0, NULL);
    CHECK(ring.count == 720 && ring.closed);
    slv_adjacency_destroy(a);
    check_mesh(&env, mesh, true);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
}

int main(void) {
    test_random_meshes();
    test_non_manifold();
    test_pole();
    return test_end();
}
