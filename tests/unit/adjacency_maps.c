/* Maps across edges, rings and cutting, on tables made by hand and on hostile ones. */
#include "kit/edge_kit.h"
#include "kit/mesh_shapes.h"

static void test_orientations(void) {
    for (unsigned e = 0; e < 4; e++)
        for (unsigned f = 0; f < 4; f++) {
            slv_affine there = slv_orientation(e, f), back = slv_orientation(f, e);
            for (int i = 0; i <= 4; i++) {
                float t = (float)i / 4, u, v, u2, v2, u3, v3;
                kit_edge_point_float(e, t, &u, &v);
                slv_affine_apply(&there, u, v, &u2, &v2);
                kit_edge_point_float(f, 1 - t, &u3, &v3);
                CHECK(u2 == u3 && v2 == v3);
                slv_affine_apply(&there, 0.25f, t, &u2, &v2);
                slv_affine_apply(&back, u2, v2, &u3, &v3);
                CHECK(u3 == 0.25f && v3 == t);
            }
            /* what is inside one face is outside the other */
            float u, v;
            slv_affine_apply(&there, 0.5f, 0.5f, &u, &v);
            CHECK(u < 0 || u > 1 || v < 0 || v > 1);
            slv_affine again = slv_orientation(e + 4, f + 8);
            CHECK(memcmp(&again, &there, sizeof again) == 0);
        }
}

/* Quad 0 whose edge 1 meets the sub-faces 1..3 of a triangle: sub-face 2 by its edge 3, then 1 by
 * its edge 0. */
static const slv_face_adjacency mixed[4] = {{{-1, 2, -1, -1}, {0, 3, 0, 0}},
                                            {{0, 2, 3, -1}, {1, 2, 1, 0}},
                                            {{-1, 3, 1, 0}, {0, 2, 1, 1}},
                                            {{-1, 1, 2, -1}, {0, 2, 1, 0}}};
static const uint8_t mixed_flags[4] = {0, SLV_FACE_SUBFACE, SLV_FACE_SUBFACE, SLV_FACE_SUBFACE};

static void test_mixed(void) {
    slv_env env = test_env();
    slv_adjacency *a = NULL;
    slv_neighbour n[2];
    MUST(slv_adjacency_create(&env, 4, mixed, mixed_flags, &a));
    CHECK(slv_adjacency_cut_count(a) == 0 && slv_adjacency_face_count(a) == 4);
    CHECK(!slv_adjacency_is_subface(a, 0) && slv_adjacency_is_subface(a, 3) &&
          !slv_adjacency_is_subface(a, 4));
    REQUIRE(slv_adjacency_neighbours(a, 0, 1, n) == 2);
    CHECK(n[0].face == 2 && n[0].edge == 3 && n[0].t0 == 0 && n[0].t1 == 0.5f && n[0].scale == 2);
    CHECK(n[1].face == 1 && n[1].edge == 0 && n[1].t0 == 0.5f && n[1].t1 == 1);
    float u, v;
    slv_affine_apply(&n[0].map, 1, 0.5f, &u, &v);
    CHECK(u == 0 && v == 1);
    slv_affine_apply(&n[1].map, 1, 0.5f, &u, &v);
    CHECK(u == 1 && v == 0);
    slv_affine_apply(&n[1].map, 1.5f, 1, &u, &v);
    CHECK(u == 0 && v == 1);
    REQUIRE(slv_adjacency_neighbours(a, 1, 0, n) == 1);
    CHECK(n[0].face == 0 && n[0].edge == 1 && n[0].scale == 0.5f && n[0].t1 == 1);
    slv_affine_apply(&n[0].map, 0, 0, &u, &v);
    CHECK(u == 1 && v == 1);
    slv_affine_apply(&n[0].map, 1, -1, &u, &v);
    CHECK(u == 0.5f && v == 0.5f);
    CHECK(slv_adjacency_neighbours(a, 3, 3, n) == 0 && slv_adjacency_neighbours(a, -1, 0, n) == 0 &&
          slv_adjacency_neighbours(a, 4, 0, n) == 0);

    for (int f = 0; f < 4; f++)
        for (unsigned c = 0; c < 4; c++)
            CHECK(slv_adjacency_is_t_corner(a, f, c) == ((f == 1 && c == 1) || (f == 2 && c == 3)));
    uint32_t position;
    slv_ring ring = slv_adjacency_ring(a, 1, 1, &position);
    CHECK(ring.count == 2 && !ring.closed && ring.corners[position].face == 1);
    ring = slv_adjacency_ring(a, 3, 2, NULL);
    CHECK(ring.count == 3 && ring.closed);
    ring = slv_adjacency_ring(a, 0, 2, &position);
    CHECK(ring.count == 2 && !ring.closed && ring.corners[position].face == 0 &&
          ring.corners[1 - position].face == 1 && ring.corners[1 - position].corner == 0);
    ring = slv_adjacency_ring(a, 0, 1, &position);
    CHECK(ring.count == 2 && ring.corners[1 - position].face == 2);
    ring = slv_adjacency_ring(a, 9, 0, &position);
    CHECK(ring.count == 0 && position == 0);

    int32_t face = 0;
    u = 1.25f;
    v = 0.25f;
    CHECK(slv_adjacency_resolve(a, false, &face, &u, &v) && face == 2 && u == 0.5f && v == 0.5f);
    face = 0;
    u = 1.75f; /* deeper than a sub-face: beyond sub-face 2 lies sub-face 3 */
    v = 0.25f;
    CHECK(slv_adjacency_resolve(a, false, &face, &u, &v) && face == 3);
    face = 2;
    u = -0.5f;
    v = 0.5f;
    CHECK(slv_adjacency_resolve(a, true, &face, &u, &v) && face == 0 && u == 0.75f && v == 0.25f);
    face = 0;
    u = -0.25f;
    CHECK(!slv_adjacency_resolve(a, false, &face, &u, &v) && face == 0 && u == -0.25f);
    u = NAN;
    CHECK(!slv_adjacency_resolve(a, false, &face, &u, &v));
    slv_adjacency_destroy(a);
    slv_adjacency_destroy(NULL);
}

static void test_cutting(void) {
    slv_env env = test_env();
    slv_adjacency *a = NULL;
    slv_face_adjacency faces[4];
    slv_neighbour n[2];
    memcpy(faces, mixed, sizeof faces);
    faces[1].face[0] = -1; /* the second half does not know the quad: the first half stays */
    MUST(slv_adjacency_create(&env, 4, faces, mixed_flags, &a));
    CHECK(slv_adjacency_cut_count(a) == 0 && slv_adjacency_neighbours(a, 0, 1, n) == 1);
    slv_adjacency_destroy(a);
    memcpy(faces, mixed, sizeof faces);
    faces[2].face[3] = 7; /* outside; so the quad is not answered, nor the second half */
    MUST(slv_adjacency_create(&env, 4, faces, mixed_flags, &a));
    CHECK(slv_adjacency_cut_count(a) == 3 && slv_adjacency_neighbours(a, 0, 1, n) == 0 &&
          slv_adjacency_neighbours(a, 1, 0, n) == 0);
    CHECK(strstr(test_last_log, "face 0 edge 1") != NULL);
    slv_adjacency_destroy(a);
    slv_face_adjacency self = {{0, 0, 0, 0}, {0, 3, 2, 1}};
    MUST(slv_adjacency_create(&env, 1, &self, NULL, &a));
    CHECK(slv_adjacency_cut_count(a) == 2); /* an edge cannot meet itself; 1 and 3 roll up a tube */
    CHECK(slv_adjacency_neighbours(a, 0, 1, n) == 1 && n[0].face == 0 && n[0].edge == 3);
    slv_adjacency_destroy(a);
    MUST(slv_adjacency_create(&env, 0, NULL, NULL, &a));
    slv_adjacency_destroy(a);
    CHECK(slv_adjacency_create(&env, 1, NULL, NULL, &a) == SLV_ERROR_ARGUMENT && !a);
    CHECK(slv_adjacency_create(&env, UINT32_MAX, &self, NULL, &a) == SLV_ERROR_LIMIT && !a);
}

/* Whatever the records say, links come out mutual, every corner is in one ring, and nothing hangs.
 */
static void check_sound(const slv_adjacency *a) {
    uint32_t nfaces = slv_adjacency_face_count(a);
    uint64_t listed = 0;
    for (int32_t f = 0; f < (int32_t)nfaces; f++)
        for (unsigned e = 0; e < 4; e++) {
            slv_neighbour n[2], back[2];
            uint32_t count = slv_adjacency_neighbours(a, f, e, n), position;
            for (uint32_t i = 0; i < count; i++) {
                uint32_t others = slv_adjacency_neighbours(a, n[i].face, n[i].edge, back), hits = 0;
                for (uint32_t j = 0; j < others; j++) {
                    if (back[j].face != f || back[j].edge != e)
                        continue;
                    hits++;
                    CHECK(back[j].scale * n[i].scale == 1);
                    float u, v, x, y;
                    slv_affine_apply(&n[i].map, 0.25f, 0.75f, &u, &v);
                    slv_affine_apply(&back[j].map, u, v, &x, &y);
                    CHECK(x == 0.25f && y == 0.75f);
                }
                CHECK(hits == 1);
            }
            slv_ring ring = slv_adjacency_ring(a, f, e, &position);
            REQUIRE(position < ring.count);
            CHECK(ring.corners[position].face == f && ring.corners[position].corner == e);
            listed += position == 0 ? ring.count : 0;
            float u = e & 1 ? 1.5f : 0.5f, v = e & 2 ? -0.75f : 1.25f;
            int32_t face = f;
            if (slv_adjacency_resolve(a, e & 1, &face, &u, &v))
                CHECK(face >= 0 && face < (int32_t)nfaces && u >= 0 && u <= 1 && v >= 0 && v <= 1);
        }
    CHECK(listed == 4 * (uint64_t)nfaces);
}

static void test_hostile(void) {
    slv_env env = test_env();
    uint64_t random = 1;
    enum { MOST = 12 };
    for (int round = 0; round < 4000; round++) {
        slv_face_adjacency faces[MOST];
        uint8_t flags[MOST];
        uint32_t nfaces = 1 + test_random(&random) % MOST;
        for (uint32_t f = 0; f < nfaces; f++) {
            flags[f] = test_random(&random) % 3 ? 0 : SLV_FACE_SUBFACE;
            for (int e = 0; e < 4; e++) {
                faces[f].face[e] = (int32_t)(test_random(&random) % (nfaces + 2)) - 1;
                faces[f].edge[e] = (uint8_t)(test_random(&random) % (round & 1 ? 256 : 4));
            }
        }
        /* make most links mutual, so that few are cut */
        for (uint32_t f = 0; f < nfaces; f++)
            for (int e = 0; e < 4; e++) {
                int32_t to = faces[f].face[e];
                if (to >= 0 && to < (int32_t)nfaces && test_random(&random) % 8) {
                    faces[to].face[faces[f].edge[e] & 3] = (int32_t)f;
                    faces[to].edge[faces[f].edge[e] & 3] = (uint8_t)e;
                }
            }
        slv_adjacency *a = NULL;
        MUST(slv_adjacency_create(&env, nfaces, faces, flags, &a));
        check_sound(a);
        /* what came out is sound: going through again changes nothing */
        slv_adjacency *b = NULL;
        MUST(slv_adjacency_create(&env, nfaces, slv_adjacency_faces(a), flags, &b));
        CHECK(slv_adjacency_cut_count(b) == 0);
        slv_adjacency_destroy(a);
        slv_adjacency_destroy(b);
    }
}

/* Around a regular vertex the order of crossing does not matter. */
static void test_resolve_corner(void) {
    slv_env env = test_env();
    enum { N = 3 };
    slv_face_adjacency faces[N * N];
    for (int j = 0; j < N; j++)
        for (int i = 0; i < N; i++)
            faces[j * N + i] = (slv_face_adjacency){{(j + N - 1) % N * N + i, j * N + (i + 1) % N,
                                                     (j + 1) % N * N + i, j * N + (i + N - 1) % N},
                                                    {2, 3, 0, 1}};
    slv_adjacency *a = NULL;
    MUST(slv_adjacency_create(&env, N * N, faces, NULL, &a));
    for (int first = 0; first < 2; first++) {
        int32_t face = 0;
        float u = 1.25f, v = -0.125f;
        CHECK(slv_adjacency_resolve(a, first, &face, &u, &v));
        CHECK(face == 2 * N + 1 && u == 0.25f && v == 0.875f);
    }
    slv_ring ring = slv_adjacency_ring(a, 4, 0, NULL);
    CHECK(ring.count == 4 && ring.closed);
    slv_adjacency_destroy(a);
}

int main(void) {
    test_orientations();
    test_mixed();
    test_cutting();
    test_hostile();
    test_resolve_corner();
    return test_end();
}
