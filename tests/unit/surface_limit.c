/* Limit surfaces: faces agree along shared edges, derivatives are those of the positions, normals
 * are sound. */
#include "kit/edge_kit.h"
#include "kit/mesh_shapes.h"
#include "kit/triangle_kit.h"

#include <selvage/surface.h>

#include <pthread.h>

static slv_surface *make_surface(const slv_env *env, const slv_mesh *mesh, slv_scheme scheme) {
    slv_surface *surface = NULL;
    slv_surface_params params = {.scheme = scheme};
    MUST(slv_surface_create(env, mesh, &params, &surface));
    CHECK(slv_surface_face_count(surface) == slv_mesh_face_count(mesh));
    return surface;
}

static void at(const slv_surface *s, int32_t face, float u, float v, float p[3], float du[3],
               float dv[3], float n[3]) {
    slv_surface_point point = {face, u, v};
    slv_surface_arrays arrays = {p, du, dv, n};
    CHECK(slv_surface_evaluate(s, 1, &point, &arrays) == SLV_OK);
}

static float distance(const float a[3], const float b[3]) {
    return sqrtf((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                 (a[2] - b[2]) * (a[2] - b[2]));
}

static float length(const float a[3]) {
    static const float zero[3] = {0, 0, 0};
    return distance(a, zero);
}

static float mesh_size(const slv_mesh *mesh) {
    slv_mesh_stats stats;
    MUST(slv_mesh_get_stats(NULL, mesh, &stats));
    return distance(stats.bounds_min, stats.bounds_max);
}

static void check_edges(const slv_mesh *mesh, const slv_surface *s) {
    slv_adjacency *a = NULL;
    float size = mesh_size(mesh);
    MUST(slv_mesh_adjacency(NULL, mesh, &a));
    for (int32_t f = 0; f < (int32_t)slv_mesh_face_count(mesh); f++)
        for (unsigned e = 0; e < 4; e++) {
            slv_neighbour n[2];
            uint32_t count = slv_adjacency_neighbours(a, f, e, n);
            for (uint32_t i = 0; i < count; i++)
                for (int step = 0; step <= 8; step++) {
                    float t = n[i].t0 + (n[i].t1 - n[i].t0) * (float)step / 8, u2, v2;
                    float u, v, here[3], there[3], n1[3], n2[3];
                    kit_edge_point_float(e, t, &u, &v);
                    slv_affine_apply(&n[i].map, u, v, &u2, &v2);
                    at(s, f, u, v, here, NULL, NULL, n1);
                    at(s, n[i].face, u2, v2, there, NULL, NULL, n2);
                    CHECK_MSG(distance(here, there) <= 1e-5f * size,
                              "face %d edge %u to %d at %g: %g apart", f, e, n[i].face, (double)t,
                              (double)distance(here, there));
                    CHECK(fabsf(length(n1) - 1) < 1e-5f && fabsf(length(n2) - 1) < 1e-5f);
                }
        }
    slv_adjacency_destroy(a);
}

/* Central differences, away from the joints of the patches that an irregular face is made of. */
static void check_derivatives(const slv_mesh *mesh, const slv_surface *s) {
    static const float places[] = {0.15f, 0.3f, 0.45f, 0.7f, 0.9f};
    const float h = 0.01f;
    for (int32_t f = 0; f < (int32_t)slv_mesh_face_count(mesh); f++)
        for (int i = 0; i < 25; i++) {
            float u = places[i / 5], v = places[i % 5];
            float p[3], du[3], dv[3], n[3], a[3], b[3], fu[3], fv[3];
            at(s, f, u, v, p, du, dv, n);
            at(s, f, u - h, v, a, NULL, NULL, NULL);
            at(s, f, u + h, v, b, NULL, NULL, NULL);
            for (int c = 0; c < 3; c++)
                fu[c] = (b[c] - a[c]) / (2 * h);
            at(s, f, u, v - h, a, NULL, NULL, NULL);
            at(s, f, u, v + h, b, NULL, NULL, NULL);
            for (int c = 0; c < 3; c++)
                fv[c] = (b[c] - a[c]) / (2 * h);
            float scale = length(fu) + length(fv);
            CHECK_MSG(distance(du, fu) < 0.02f * scale && distance(dv, fv) < 0.02f * scale,
                      "face %d at %g %g: %g %g of %g", f, (double)u, (double)v,
                      (double)distance(du, fu), (double)distance(dv, fv), (double)scale);
            float cross[3] = {du[1] * dv[2] - du[2] * dv[1], du[2] * dv[0] - du[0] * dv[2],
                              du[0] * dv[1] - du[1] * dv[0]};
            float along = (cross[0] * n[0] + cross[1] * n[1] + cross[2] * n[2]) / length(cross);
            CHECK(along > 0.999f);
        }
}

/* Flat meshes stay where they are in their inside, so the parameters can be checked against the
 * plane. */
static void test_flat(void) {
    slv_env env = test_env();
    shape s = shape_grid(4, 4, false, false);
    for (uint32_t v = 0; v < s.nverts; v++)
        s.positions[3 * v + 2] = 0;
    slv_mesh *mesh = shape_mesh(&env, &s);
    slv_surface *surface = make_surface(&env, mesh, SLV_SCHEME_CATMARK);
    float p[3], du[3], dv[3], n[3];
    at(surface, 0, 0, 0, p, du, dv, n);
    CHECK(length(p) < 1e-6f);
    at(surface, 5, 0.25f, 0.75f, p, du, dv, n);
    CHECK(fabsf(p[0] - 1.25f) < 1e-6f && fabsf(p[1] - 1.75f) < 1e-6f && p[2] == 0);
    CHECK(fabsf(du[0] - 1) < 1e-5f && fabsf(dv[1] - 1) < 1e-5f && fabsf(du[1]) < 1e-5f);
    CHECK(n[2] == 1);
    at(surface, 5, -3, 7, p, NULL, NULL, NULL); /* clamped */
    CHECK(fabsf(p[0] - 1) < 1e-6f && fabsf(p[1] - 2) < 1e-6f);
    slv_surface_destroy(surface);
    surface = make_surface(&env, mesh, SLV_SCHEME_BILINEAR);
    at(surface, 15, 0.5f, 1, p, du, dv, n);
    CHECK(p[0] == 3.5f && p[1] == 4 && n[2] == 1);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
}

/* Vertices of the cube have limits at a known place: (corner + 4 edge ends + face vertices) in the
 * usual mask. */
static void test_known_limits(void) {
    slv_env env = test_env();
    shape s = shape_cube();
    slv_mesh *mesh = shape_mesh(&env, &s);
    slv_surface *surface = make_surface(&env, mesh, SLV_SCHEME_CATMARK);
    float p[3];
    /* After one step the vertex is at 5/9, edge points at 0.75 0.75 0 and face points at 0 0 1; the
     * limit mask of valence 3 is (9 vertex + 4 edges + faces) / 24. */
    at(surface, 0, 1, 1, p, NULL, NULL, NULL);
    float expected = (9 * 5.0f / 9 + 4 * (0.75f + 0.75f) + 1) / 24;
    for (int c = 0; c < 3; c++)
        CHECK_MSG(fabsf(p[c] - expected) < 1e-5f, "%g, expected %g", (double)p[c],
                  (double)expected);
    slv_surface_destroy(surface);

    slv_mesh_view view = shape_view(&s);
    int32_t corner = 3, crease[2] = {1, 3};
    float sharp = 10;
    view.ncorners = 1;
    view.corner_verts = &corner;
    view.corner_sharpness = &sharp;
    slv_mesh_destroy(mesh);
    MUST(slv_mesh_create(&env, &view, &mesh));
    surface = make_surface(&env, mesh, SLV_SCHEME_CATMARK);
    at(surface, 0, 1, 1, p, NULL, NULL, NULL);
    CHECK(fabsf(p[0] - 1) + fabsf(p[1] - 1) + fabsf(p[2] - 1) < 1e-5f);
    check_edges(mesh, surface);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    view.ncorners = 0;
    view.ncreases = 1;
    view.crease_verts = crease;
    for (sharp = 0.5f; sharp < 20; sharp *= 1.7f) {
        view.crease_sharpness = &sharp;
        MUST(slv_mesh_create(&env, &view, &mesh));
        surface = make_surface(&env, mesh, SLV_SCHEME_CATMARK);
        check_edges(mesh, surface);
        slv_surface_destroy(surface);
        slv_mesh_destroy(mesh);
    }
    crease[1] = 6; /* the cube has no such edge: nothing happens */
    MUST(slv_mesh_create(&env, &view, &mesh));
    surface = make_surface(&env, mesh, SLV_SCHEME_CATMARK);
    at(surface, 0, 1, 1, p, NULL, NULL, NULL);
    CHECK(fabsf(p[0] - expected) < 1e-5f);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
}

static void test_random_meshes(void) {
    slv_env env = test_env();
    uint64_t random = 3;
    for (int round = 0; round < 2 * SHAPE_KINDS; round++) {
        shape s = shape_random(round % SHAPE_KINDS, &random);
        slv_mesh *mesh = shape_mesh(&env, &s);
        for (int scheme = 0; scheme < 2; scheme++) {
            slv_surface *surface = make_surface(&env, mesh, (slv_scheme)scheme);
            check_edges(mesh, surface);
            check_derivatives(mesh, surface);
            slv_surface_destroy(surface);
        }
        slv_mesh_destroy(mesh);
        shape_clear(&s);
    }
}

/* Loop's limit: alike on both sides of edges, derivatives those of the positions; in the plane, the
 * plane. Vertices of valence n lie where Loop's mask has them. */
static void test_loop(void) {
    slv_env env = test_env();
    uint64_t random = 5;
    float p[3], du[3], dv[3], n[3];
    for (int kind = 0; kind < 2 * TRIANGLE_KINDS; kind++) {
        shape s = triangle_shape(kind, &random);
        slv_mesh *mesh = shape_mesh(&env, &s);
        slv_surface *surface = make_surface(&env, mesh, SLV_SCHEME_LOOP);
        check_edges(mesh, surface);
        check_derivatives(mesh, surface);
        slv_surface_destroy(surface);
        slv_mesh_destroy(mesh);
        shape_clear(&s);
    }
    shape s = shape_tetrahedron();
    slv_mesh *mesh = shape_mesh(&env, &s);
    slv_surface *surface = make_surface(&env, mesh, SLV_SCHEME_LOOP);
    /* valence 3: beta is 3/16, and the limit 1 / (1 + 8/3 beta n) of the vertex */
    at(surface, 0, 0, 0, p, du, dv, n);
    const float *own = s.positions + 3 * s.verts[0];
    for (int c = 0; c < 3; c++) {
        float others = 0, beta = 3 / 16.0f, share = 1 / (3 + 3 / (8 * beta));
        for (uint32_t v = 0; v < 4; v++)
            others += (int32_t)v == s.verts[0] ? 0 : s.positions[3 * v + (uint32_t)c];
        float expected = (1 - 3 * share) * own[c] + share * others;
        CHECK_MSG(fabsf(p[c] - expected) < 1e-5f, "%g, expected %g", (double)p[c],
                  (double)expected);
    }
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
    s = shape_grid(4, 4, false, false);
    mesh = shape_mesh(&env, &s);
    surface = NULL;
    const slv_surface_params loop = {.scheme = SLV_SCHEME_LOOP};
    CHECK(slv_surface_create(&env, mesh, &loop, &surface) == SLV_ERROR_UNSUPPORTED && !surface);
    CHECK_MSG(strstr(test_last_log, "polygon 0 has 4 vertices, and the Loop scheme"), "%s",
              test_last_log);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
}

static void check_finite(const slv_mesh *mesh, const slv_surface *surface) {
    float p[25 * 3], du[25 * 3], dv[25 * 3], n[25 * 3];
    slv_surface_arrays arrays = {p, du, dv, n};
    for (int32_t f = 0; f < (int32_t)slv_mesh_face_count(mesh); f++) {
        REQUIRE(slv_surface_evaluate_grid(surface, f, 4, 4, &arrays) == SLV_OK);
        for (int i = 0; i < 75; i++)
            CHECK(isfinite(p[i]) && isfinite(du[i]) && isfinite(dv[i]) && isfinite(n[i]));
        for (int i = 0; i < 25; i++)
            CHECK(fabsf(length(n + 3 * i) - 1) < 1e-4f);
    }
}

/* Polygons with doubled vertices, flipped ones, fins and fans of anything. */
static void test_spoilt_meshes(void) {
    slv_env env = test_env();
    uint64_t random = 5;
    for (int round = 0; round < 20 * SHAPE_KINDS; round++) {
        shape s = shape_random(round % SHAPE_KINDS, &random);
        shape_flip_polygon(&s, test_random(&random) % s.npolys);
        shape_scramble(&s, &random, test_random(&random) % 10);
        if (round & 1)
            for (uint32_t v = 0; v < s.nverts; v++)
                s.positions[3 * v + v % 3] = s.positions[0];
        slv_mesh_view view = shape_view(&s);
        int32_t creases[8], corner = (int32_t)(test_random(&random) % s.nverts);
        float sharpness[4] = {0.7f, 2.5f, 5, 40};
        for (int i = 0; i < 8; i++)
            creases[i] = s.verts[test_random(&random) % s.nsides];
        view.ncreases = 4;
        view.crease_verts = creases;
        view.crease_sharpness = sharpness;
        view.ncorners = 1;
        view.corner_verts = &corner;
        view.corner_sharpness = &sharpness[round % 4];
        view.boundary = (slv_boundary)(round % 4);
        slv_mesh *mesh = NULL;
        MUST(slv_mesh_create(&env, &view, &mesh));
        slv_surface *surface = make_surface(&env, mesh, SLV_SCHEME_CATMARK);
        slv_face_adjacency *theirs = shape_grow(NULL, slv_mesh_face_count(mesh), sizeof *theirs);
        check_finite(mesh, surface);
        CHECK(!slv_surface_osd_adjacency(surface, theirs));
        free(theirs);
        slv_surface_destroy(surface);
        slv_mesh_destroy(mesh);
        shape_clear(&s);
    }
}

static void test_degenerate(void) {
    slv_env env = test_env();
    float n[3];
    shape s = shape_grid(3, 3, false, false);
    for (uint32_t v = 0; v < s.nverts; v++)
        for (int c = 0; c < 3; c++)
            s.positions[3 * v + (uint32_t)c] = 2;
    slv_mesh *mesh = shape_mesh(&env, &s);
    slv_surface *surface = make_surface(&env, mesh, SLV_SCHEME_CATMARK);
    at(surface, 4, 0.5f, 0.5f, NULL, NULL, NULL, n);
    CHECK(n[0] == 0 && n[1] == 0 && n[2] == 1);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    shape_clear(&s);

    /* one edge of a flat quad shrunk to a point: its normal comes from beside it */
    s = shape_grid(1, 1, false, false);
    memcpy(s.positions + 3, s.positions, 3 * sizeof(float));
    for (uint32_t v = 0; v < 4; v++)
        s.positions[3 * v + 2] = 0;
    mesh = shape_mesh(&env, &s);
    surface = make_surface(&env, mesh, SLV_SCHEME_BILINEAR);
    at(surface, 0, 0.5f, 0, NULL, NULL, NULL, n);
    CHECK(fabsf(n[2] - 1) < 1e-5f);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
}

/* A crowded pole must not take the square of its valence in time and memory. */
static void test_crowded(void) {
    slv_env env = test_env();
    shape s = shape_fan(20000, 3);
    slv_mesh *mesh = shape_mesh(&env, &s);
    slv_surface *surface = make_surface(&env, mesh, SLV_SCHEME_CATMARK);
    CHECK(strstr(test_last_log, "20000 polygon") != NULL);
    float p[3];
    at(surface, 0, 0, 0, p, NULL, NULL, NULL);
    CHECK(p[2] == 0.5f);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
}

static void test_arguments(void) {
    slv_env env = test_env();
    shape s = shape_cube();
    slv_mesh *mesh = shape_mesh(&env, &s);
    slv_surface *surface = NULL;
    slv_surface_params wrong = {.scheme = (slv_scheme)7};
    slv_surface_point point = {6, 0, 0};
    slv_surface_arrays none = {NULL, NULL, NULL, NULL};
    CHECK(slv_surface_create(&env, mesh, &wrong, &surface) == SLV_ERROR_ARGUMENT && !surface);
    slv_env small = env;
    small.max_bytes = 2000;
    CHECK(slv_surface_create(&small, mesh, NULL, &surface) == SLV_ERROR_LIMIT && !surface);
    MUST(slv_surface_create(&env, mesh, NULL, &surface));
    CHECK(slv_surface_evaluate(surface, 1, &point, &none) == SLV_ERROR_ARGUMENT);
    point.face = -1;
    CHECK(slv_surface_evaluate(surface, 1, &point, &none) == SLV_ERROR_ARGUMENT);
    point = (slv_surface_point){0, NAN, NAN};
    CHECK(slv_surface_evaluate(surface, 1, &point, &none) == SLV_OK);
    CHECK(slv_surface_evaluate_grid(surface, 6, 1, 1, &none) == SLV_ERROR_ARGUMENT);
    CHECK(slv_surface_evaluate_grid(surface, 0, 0, 1, &none) == SLV_ERROR_ARGUMENT);
    slv_surface_destroy(surface);
    slv_surface_destroy(NULL);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
}

enum { THREADS = 4, SAMPLES = 81 };
typedef struct thread_job {
    const slv_surface *surface;
    uint32_t nfaces;
    float *out; /* positions and normals */
    bool failed;
} thread_job;

static void *evaluate_all(void *user) {
    thread_job *job = user;
    for (uint32_t f = 0; f < job->nfaces; f++) {
        float *p = job->out + (size_t)f * SAMPLES * 6;
        slv_surface_arrays arrays = {.positions = p, .normals = p + 3 * SAMPLES};
        job->failed |= slv_surface_evaluate_grid(job->surface, (int32_t)f, 8, 8, &arrays) != SLV_OK;
    }
    return NULL;
}

/* Built by one thread or by several, evaluated by several at once, a surface is the same to the
 * bit. */
static void test_threads(void) {
    slv_env env = test_env();
    uint64_t random = 9;
    shape s = shape_grid(40, 20, true, true);
    shape_cut(&s, &random, 1, 1);
    shape_rotate_polygons(&s, &random);
    slv_mesh *mesh = shape_mesh(&env, &s);
    uint32_t nfaces = slv_mesh_face_count(mesh);
    size_t floats = (size_t)nfaces * SAMPLES * 6;
    float *results[THREADS + 1];
    for (int i = 0; i <= THREADS; i++)
        results[i] = shape_grow(NULL, floats, sizeof(float));
    env.threads = 1;
    slv_surface *surface = make_surface(&env, mesh, SLV_SCHEME_CATMARK);
    thread_job alone = {surface, nfaces, results[THREADS], false};
    evaluate_all(&alone);
    slv_surface_destroy(surface);
    env.threads = THREADS;
    surface = make_surface(&env, mesh, SLV_SCHEME_CATMARK);
    pthread_t threads[THREADS];
    thread_job jobs[THREADS];
    for (int i = 0; i < THREADS; i++) {
        jobs[i] = (thread_job){surface, nfaces, results[i], false};
        REQUIRE(pthread_create(&threads[i], NULL, evaluate_all, &jobs[i]) == 0);
    }
    for (int i = 0; i < THREADS; i++) {
        pthread_join(threads[i], NULL);
        CHECK(!jobs[i].failed);
        CHECK(memcmp(results[i], results[THREADS], floats * sizeof(float)) == 0);
    }
    for (int i = 0; i <= THREADS; i++)
        free(results[i]);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
}

/* Reading the same points one by one, in any order, gives the same as the grid. */
static void test_order(void) {
    slv_env env = test_env();
    shape s = shape_grid(5, 4, true, false);
    slv_mesh *mesh = shape_mesh(&env, &s);
    slv_surface *surface = make_surface(&env, mesh, SLV_SCHEME_CATMARK);
    float grid[SAMPLES * 3], du[SAMPLES * 3], dv[SAMPLES * 3], p[3], a[3], b[3];
    slv_surface_arrays arrays = {grid, du, dv, NULL};
    REQUIRE(slv_surface_evaluate_grid(surface, 7, 8, 8, &arrays) == SLV_OK);
    for (int i = SAMPLES - 1; i >= 0; i--) {
        at(surface, 7, (float)(i % 9) / 8, (float)(i / 9) / 8, p, a, b, NULL);
        CHECK(memcmp(p, grid + 3 * i, sizeof p) == 0 && memcmp(a, du + 3 * i, sizeof a) == 0 &&
              memcmp(b, dv + 3 * i, sizeof b) == 0);
    }
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
}

int main(void) {
    test_flat();
    test_known_limits();
    test_random_meshes();
    test_loop();
    test_spoilt_meshes();
    test_degenerate();
    test_crowded();
    test_arguments();
    test_threads();
    test_order();
    return test_end();
}
