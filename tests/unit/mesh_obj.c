/* OBJ files: what is read, what is refused and where, writing them again; and arrays given to
 * slv_mesh_create. */
#include "kit/mesh_shapes.h"

#include <locale.h>
#include <unistd.h>

static slv_result parse(const char *text, slv_mesh **mesh) {
    slv_env env = test_env();
    test_last_log[0] = 0;
    return slv_mesh_parse_obj(&env, "t.obj", text, strlen(text), mesh);
}

static slv_mesh *good(const char *text) {
    slv_mesh *mesh = NULL;
    MUST(parse(text, &mesh));
    return mesh;
}

#define TRIANGLE "v 0 0 0\nv 1 0 0\nv 0 1 0\n"

static void test_forms(void) {
    slv_mesh *mesh =
        good("# a comment\r\nmtllib x.mtl\r\no thing one\r\nv 0 0 0\r\nv 1e0 0 0 1\r\n"
             "v +1.5E+0 1. -.5\r\nv 0 1 0\r\nvt 0.5\nvt 0 1 0\nvn 0 0 1\n"
             "g left\nf 1 2 3\ng right side\nf 1/1 2/2 \\\n 3/1\nf 1//1 2//1 3//1 4//1\n"
             "f -4/-2/-1 -3/2/1 -2/1/1\ng empty");
    const slv_mesh_view *v = slv_mesh_get_view(mesh);
    CHECK(v->nverts == 4 && v->npolys == 4 && v->ntexcoords == 2 && v->nnormals == 1);
    CHECK(v->positions[6] == 1.5f && v->positions[7] == 1 && v->positions[8] == -0.5f);
    CHECK(v->texcoords[0] == 0.5f && v->texcoords[1] == 0);
    CHECK(v->poly_texcoords[0] == -1 && v->poly_texcoords[4] == 1 && v->poly_texcoords[10] == 0);
    CHECK(v->poly_normals[0] == -1 && v->poly_normals[6] == 0 && v->poly_verts[10] == 0);
    static const char *const groups[] = {"thing one", "left", "right", "side"};
    static const int32_t first[] = {0, 0, 1, 1}, count[] = {4, 1, 3, 3};
    REQUIRE(v->ngroups == 4);
    for (int g = 0; g < 4; g++)
        CHECK_MSG(!strcmp(v->group_names[g], groups[g]) && v->group_first[g] == first[g] &&
                      v->group_count[g] == count[g],
                  "group %d is %s, %d polygons from %d", g, v->group_names[g], v->group_count[g],
                  v->group_first[g]);
    CHECK(slv_mesh_face_count(mesh) == 10);
    CHECK(slv_mesh_faces(mesh)[6].poly == 2 && slv_mesh_faces(mesh)[6].sub == -1 &&
          slv_mesh_faces(mesh)[9].sub == 2);
    CHECK(slv_mesh_face_flags(mesh)[0] == SLV_FACE_SUBFACE && slv_mesh_face_flags(mesh)[6] == 0);
    slv_mesh_destroy(mesh);

    mesh = good("f 1 2 3\n" TRIANGLE); /* a face before its vertices */
    CHECK(slv_mesh_get_view(mesh)->poly_texcoords == NULL);
    slv_mesh_destroy(mesh);
    mesh = good("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3"); /* line ends of old */
    slv_mesh_destroy(mesh);
}

static void test_tags(void) {
    slv_mesh *mesh =
        good(TRIANGLE "v 1 1 0\nf 1 2 4 3\nt crease 2/1/0 0 1 2.5\nt crease 4/2/0 1 3 3 2 1 4\n"
                      "t corner 1/1/0 2 10\nt corner 2/1 0 1 0.5\nt interpolateboundary 1/0/0 2\n"
                      "t hole 1/0/0 0\nt facevaryinginterpolateboundary 1/0/0 1\n"
                      "t creasemethod 0/0/1 chaikin\n");
    const slv_mesh_view *v = slv_mesh_get_view(mesh);
    CHECK(v->ncreases == 3 && v->crease_sharpness[0] == 2.5f && v->crease_sharpness[2] == 4);
    CHECK(v->crease_verts[2] == 1 && v->crease_verts[5] == 2);
    CHECK(v->ncorners == 3 && v->corner_verts[0] == 2 && v->corner_sharpness[2] == 0.5f);
    CHECK(v->boundary == SLV_BOUNDARY_EDGE_ONLY);
    CHECK(v->nholes == 1 && slv_mesh_face_is_hole(mesh, 0));
    CHECK(strstr(test_last_log, "t.obj:12: 2 tags") && strstr(test_last_log, "facevarying"));
    slv_mesh_destroy(mesh);
}

static void test_numbers(void) {
    static const char *const numbers[] = {"0.1",         "-0.30000001192092896",
                                          "1e-30",       "3.4028234e38",
                                          "123456789",   "0.000000000000000000000000000012345678",
                                          "1e-50",       "16777217",
                                          "1.17549e-38", "9999999999999999999999999",
                                          "0e999999999", "00000000000000000000000000001.5"};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        char text[200];
        snprintf(text, sizeof text, TRIANGLE "v %s 0 0\nf 1 2 3\n", numbers[i]);
        slv_mesh *mesh = good(text);
        float expected = strtof(numbers[i], NULL);
        CHECK_MSG(slv_mesh_get_view(mesh)->positions[9] == expected, "%s", numbers[i]);
        slv_mesh_destroy(mesh);
    }
}

static void test_refused(void) {
    static const struct {
        const char *text;
        int line;
    } bad[] = {
        {TRIANGLE "f 1 2 0\n", 4},
        {TRIANGLE "f 1 2 4\n", 4},
        {TRIANGLE "\nf 1 2 3\nf 1 2 -4\n", 6},
        {TRIANGLE "f 1 2 99999999999999999999\n", 4},
        {TRIANGLE "f 1 2 3000000000\n", 4},
        {TRIANGLE "f 1 2 3x\n", 4},
        {TRIANGLE "f 1 2 3/1/1/1\n", 4},
        {TRIANGLE "f a b c\n", 4},
        {"v 0 0\nv 0 0 0\n", 1},
        {"v 0 0 nan\n", 1},
        {"v 0 0 0\nv 0 inf 0\n", 2},
        {"v 0 0 1e39\n", 1},
        {"v 0 0 1e\n", 1},
        {"v 0 0 .\n", 1},
        {"v 0 0 1,5\n", 1},
        {"v 0 0 \\\n0x\n", 2},
        {"vt\n", 1},
        {"\x01\x02\x7f binary\n", 1},
        {"\x89PNG\r\n", 1},
        {TRIANGLE "f 1 2 3 \\\nf 1 2 3\n", 5},
        {TRIANGLE "f 1 2 3 f 1 2 3\n", 4},
        {TRIANGLE "vt 0 0 f 1 2 3\nf 1 2 3\n", 4},
        {TRIANGLE "vt 0 f 1 2 3\nf 1 2 3\n", 4},
        {TRIANGLE "vn 0 0 1 v 1 1 1\nf 1 2 3\n", 4},
        {TRIANGLE "v 0 0 1 1 1 1 v 1 1 1\nf 1 2 3\n", 4},
        {TRIANGLE "v 0 0 \\\nv 1 1 1\nf 1 2 3\n", 5},
        {TRIANGLE "t hole 1/0/0 1 f 1 2 3\nf 1 2 3\n", 4},
        {TRIANGLE "s off f 1 2 3\nf 1 2 3\n", 4},
        {TRIANGLE "l 1 2 f 1 2 3\nf 1 2 3\n", 4},
        {TRIANGLE "f 1 2 3\nt\n", 5},
        {TRIANGLE "f 1 2 3\nt crease\n", 5},
        {TRIANGLE "f 1 2 3\nt crease 2\n", 5},
        {TRIANGLE "f 1 2 3\nt crease 2/1/0 0 1\n", 5},
        {TRIANGLE "f 1 2 3\nt crease 2/1/0 0 7 1\n", 5},
        {TRIANGLE "f 1 2 3\nt crease 2/1/0 0 1 -1\n", 5},
        {TRIANGLE "f 1 2 3\nt crease 3/1/0 0 1 2 1\n", 5},
        {TRIANGLE "f 1 2 3\nt crease 9999999999/1/0 0 1 2 1\n", 5},
        {TRIANGLE "f 1 2 3\nt corner 1/1/0 -1 3\n", 5},
        {TRIANGLE "f 1 2 3\nt hole 1/0/0 1\n", 5},
        {TRIANGLE "f 1 2 3\nt interpolateboundary 1/0/0 3\n", 5},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        slv_mesh *mesh = NULL;
        char place[32];
        snprintf(place, sizeof place, "t.obj:%d:", bad[i].line);
        slv_result result = parse(bad[i].text, &mesh);
        CHECK_MSG(result == SLV_ERROR_FORMAT && !mesh, "case %zu was read", i);
        CHECK_MSG(strstr(test_last_log, place) != NULL, "case %zu: '%s'", i, test_last_log);
        slv_mesh_destroy(mesh);
    }
    slv_mesh *mesh = NULL;
    CHECK(parse("", &mesh) == SLV_ERROR_FORMAT);
    CHECK(parse(TRIANGLE, &mesh) == SLV_ERROR_FORMAT);
    CHECK(slv_mesh_load(NULL, "/nonexistent/x.obj", &mesh) == SLV_ERROR_IO);
    slv_env env = {.max_bytes = 1000};
    const char *text = TRIANGLE "f 1 2 3\n";
    CHECK(slv_mesh_parse_obj(&env, "t", text, strlen(text), &mesh) == SLV_ERROR_LIMIT && !mesh);
}

static void check_same(const slv_mesh_view *a, const slv_mesh_view *b) {
    REQUIRE(a->nverts == b->nverts && a->npolys == b->npolys && a->ncreases == b->ncreases &&
            a->ncorners == b->ncorners && a->nholes == b->nholes && a->ngroups == b->ngroups);
    CHECK(a->boundary == b->boundary);
    CHECK(!memcmp(a->positions, b->positions, 12 * (size_t)a->nverts));
    size_t sides = 0;
    for (uint32_t p = 0; p < a->npolys; p++)
        sides += (size_t)a->poly_sizes[p];
    CHECK(!memcmp(a->poly_sizes, b->poly_sizes, 4 * (size_t)a->npolys) &&
          !memcmp(a->poly_verts, b->poly_verts, 4 * sides));
    for (uint32_t i = 0; i < a->ncreases; i++)
        CHECK(a->crease_sharpness[i] == b->crease_sharpness[i] &&
              a->crease_verts[2 * i] == b->crease_verts[2 * i]);
    for (uint32_t i = 0; i < a->ncorners; i++)
        CHECK(a->corner_sharpness[i] == b->corner_sharpness[i]);
    for (uint32_t i = 0; i < a->nholes; i++)
        CHECK(a->hole_polys[i] == b->hole_polys[i]);
    for (uint32_t i = 0; i < a->ngroups; i++)
        CHECK(!strcmp(a->group_names[i], b->group_names[i]) &&
              a->group_first[i] == b->group_first[i] && a->group_count[i] == b->group_count[i]);
}

static void test_round_trip(void) {
    slv_env env = test_env();
    uint64_t random = 11;
    char path[64];
    snprintf(path, sizeof path, "%s/selvage-mesh-%ld.obj", test_parent(), (long)getpid());
    setlocale(LC_ALL, "de_DE.UTF-8"); /* a decimal comma, where there is such a locale */
    for (int kind = 0; kind < SHAPE_KINDS; kind++) {
        shape s = shape_random(kind, &random);
        slv_mesh_view view = shape_view(&s);
        int32_t crease[4] = {0, 1, 1, 2}, corner = 2, hole = 0, first[2] = {0, 1};
        float sharpness[2] = {0.1f, 7}, corner_sharpness = 1.0f / 3;
        const char *names[2] = {"one\ntwo", "body"};
        view.ncreases = 2;
        view.crease_verts = crease;
        view.crease_sharpness = sharpness;
        view.ncorners = view.nholes = 1;
        view.corner_verts = &corner;
        view.corner_sharpness = &corner_sharpness;
        view.hole_polys = &hole;
        view.boundary = (slv_boundary)(kind % 4);
        view.ngroups = s.npolys > 1 ? 2 : 0;
        view.group_names = names;
        view.group_first = first;
        int32_t count[2] = {1, (int32_t)s.npolys - 1};
        slv_mesh *mesh = NULL, *again = NULL;
        view.group_count = kind % 2 ? count : NULL;
        MUST(slv_mesh_create(&env, &view, &mesh));
        view.group_count = count;
        MUST(slv_mesh_save_obj(&env, mesh, path));
        MUST(slv_mesh_load(&env, path, &again));
        names[0] = "one_two";
        check_same(&view, slv_mesh_get_view(again));
        slv_mesh_destroy(mesh);
        slv_mesh_destroy(again);
        shape_clear(&s);
    }
    setlocale(LC_ALL, "C");
    unlink(path);
    shape s = shape_cube();
    slv_mesh *mesh = shape_mesh(&env, &s);
    CHECK(slv_mesh_save_obj(&env, mesh, "/nonexistent/folder/x.obj") == SLV_ERROR_IO);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
}

/* Bytes changed at random: read or refused, never worse. */
static void test_mutations(void) {
    static const char text[] = "# mesh\no body\n" TRIANGLE "v 1 1 0.5\nvt 0 0\nvt 1 1\nvn 0 0 1\n"
                               "f 1/1/1 2/2/1 4/1/1 3/2/1\nf 1 3 \\\n 4\nf -1 -2 -3\n"
                               "t crease 2/1/0 0 1 3.5\nt corner 1/1/0 2 10\nt hole 1/0/0 1\n"
                               "t interpolateboundary 1/0/0 1\ng tail\nf 1//1 2//1 3//1\n";
    static const char likely[] = "0123456789-+./\\ \n\r\tvfgte#\0\xff";
    slv_env env = test_env();
    uint64_t random = 13;
    int read = 0;
    for (int round = 0; round < 20000; round++) {
        size_t size = sizeof text - 1;
        char *copy = shape_grow(NULL, size, 1); /* of the exact size, for the sanitizer's sake */
        memcpy(copy, text, size);
        if (test_random(&random) % 4 == 0)
            size = test_random(&random) % (uint32_t)size;
        for (uint32_t n = 1 + test_random(&random) % 6; n && size; n--)
            copy[test_random(&random) % (uint32_t)size] =
                test_random(&random) % 4 ? likely[test_random(&random) % (sizeof likely - 1)]
                                         : (char)test_random(&random);
        char *exact = malloc(size ? size : 1);
        REQUIRE(exact != NULL);
        memcpy(exact, copy, size);
        slv_mesh *mesh = NULL;
        slv_adjacency *adjacency = NULL;
        slv_mesh_stats stats;
        slv_result result = slv_mesh_parse_obj(&env, "t.obj", exact, size, &mesh);
        CHECK(result == SLV_OK || (result == SLV_ERROR_FORMAT && !mesh));
        if (!result) {
            read++;
            CHECK(slv_mesh_adjacency(&env, mesh, &adjacency) == SLV_OK);
            CHECK(slv_mesh_get_stats(&env, mesh, &stats) == SLV_OK);
            CHECK(slv_adjacency_cut_count(adjacency) == 0);
            slv_adjacency_destroy(adjacency);
            slv_mesh_destroy(mesh);
        }
        free(exact);
        free(copy);
    }
    CHECK(read > 1000 && read < 19000);
}

static void test_create(void) {
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    shape s = shape_cube();
    slv_mesh_view view = shape_view(&s);
    s.verts[9] = 8;
    CHECK(slv_mesh_create(&env, &view, &mesh) == SLV_ERROR_FORMAT);
    CHECK(strstr(test_last_log, "polygon 2") != NULL);
    s.verts[9] = -1;
    CHECK(slv_mesh_create(&env, &view, &mesh) == SLV_ERROR_FORMAT);
    s.verts[9] = 5;
    s.positions[4] = NAN;
    CHECK(slv_mesh_create(&env, &view, &mesh) == SLV_ERROR_FORMAT);
    s.positions[4] = 0;
    s.sizes[1] = 2;
    CHECK(slv_mesh_create(&env, &view, &mesh) == SLV_ERROR_FORMAT && !mesh);
    s.sizes[1] = INT32_MAX;
    s.sizes[2] = INT32_MAX;
    CHECK(slv_mesh_create(&env, &view, &mesh) == SLV_ERROR_LIMIT && !mesh);
    view.poly_sizes = NULL;
    CHECK(slv_mesh_create(&env, &view, &mesh) == SLV_ERROR_ARGUMENT && !mesh);
    slv_mesh_view empty = {0};
    MUST(slv_mesh_create(&env, &empty, &mesh));
    CHECK(slv_mesh_face_count(mesh) == 0);
    slv_mesh_destroy(mesh);
    slv_mesh_destroy(NULL);
    shape_clear(&s);
}

static void test_stats(void) {
    slv_env env = test_env();
    slv_mesh_stats stats;
    shape s = shape_cube();
    shape_vertex(&s, 9, 9, 9);
    slv_mesh *mesh = shape_mesh(&env, &s);
    MUST(slv_mesh_get_stats(&env, mesh, &stats));
    CHECK(stats.nedges == 12 && stats.nboundary_edges == 0 && stats.nisolated_verts == 1);
    CHECK(stats.nvalence[3] == 8 && stats.nvalence[0] == 1 && stats.nextraordinary == 8);
    CHECK(stats.nfaces == 6 && stats.nsubfaces == 0);
    CHECK(stats.bounds_min[0] == -1 && stats.bounds_max[2] == 9);
    slv_mesh_destroy(mesh);
    shape_flip_polygon(&s, 0);
    mesh = shape_mesh(&env, &s);
    MUST(slv_mesh_get_stats(&env, mesh, &stats));
    CHECK(stats.nflipped_edges == 4 && stats.nnonmanifold_edges == 0);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
    s = shape_grid(4, 4, false, false);
    mesh = shape_mesh(&env, &s);
    MUST(slv_mesh_get_stats(&env, mesh, &stats));
    CHECK(stats.nboundary_edges == 16 && stats.nextraordinary == 0 && stats.nvalence[4] == 9);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
    s = shape_fan(40, 3);
    mesh = shape_mesh(&env, &s);
    MUST(slv_mesh_get_stats(&env, mesh, &stats));
    CHECK(stats.nvalence[32] == 1 && stats.nextraordinary == 1 && stats.nsubfaces == 120);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
}

#define QUADS "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n"

static int warnings;
static char all_warnings[1024];

static void count_warning(void *user, slv_log_level level, const char *message) {
    (void)user;
    CHECK(level == SLV_LOG_WARNING);
    warnings++;
    strncat(all_warnings, message, sizeof all_warnings - strlen(all_warnings) - 2);
    strcat(all_warnings, "\n");
}

/* Read, with these polygons and one warning that has these words; without one if they are NULL. */
static void check_read(const char *text, uint32_t npolys, const char *words) {
    slv_env env = {.log = count_warning};
    slv_mesh *mesh = NULL;
    warnings = 0;
    all_warnings[0] = 0;
    CHECK_MSG(slv_mesh_parse_obj(&env, "t.obj", text, strlen(text), &mesh) == SLV_OK, "%s", text);
    if (!mesh)
        return;
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    CHECK_MSG(view->npolys == npolys, "%u polygons of %s", view->npolys, text);
    CHECK_MSG(warnings == (words != NULL), "%d warnings: %s", warnings, all_warnings);
    CHECK_MSG(!words || strstr(all_warnings, words), "'%s' without '%s'", all_warnings, words);
    for (int32_t p = 0, side = 0; (uint32_t)p < view->npolys; p++)
        for (int32_t i = 0; i < view->poly_sizes[p]; i++, side++)
            CHECK((!view->poly_texcoords || view->poly_texcoords[side] < (int)view->ntexcoords) &&
                  (!view->poly_normals || view->poly_normals[side] < (int)view->nnormals));
    slv_mesh_destroy(mesh);
}

/* What other programs write and no face needs is left out with a word; no face is lost silently. */
static void test_tolerated(void) {
    check_read(QUADS "f 1//1 2//1 3//1 4//1\nf 2//2 5//2 6//2 3//2\n", 2,
               "t.obj:7: 8 indices of nor");
    check_read(QUADS "f 1/1 2/2 3/3 4/4\nf 2/5 5/6 6/7 3/8\n", 2, "8 indices of texture");
    check_read(QUADS "vt 0 0\nvt 1 0\nf 1/1 2/2 3/2 4/2\nf 2/5 5/-6 6/0 3/8\n", 2,
               "t.obj:10: 4 indices of texture");
    check_read(QUADS "f 1/0 2/0 3/0 4/0\n", 1, "t.obj:7: 4 indices of texture");
    check_read(QUADS "f 1 2\nf 1 2 3 4\nf 3\nf\n", 1, "t.obj:7: 3 faces of fewer");
    check_read(QUADS "hair 1\nf 1 2 3 4\nfur 2\n", 1, "t.obj:7: 2 statements not known");
    check_read("call other.obj\n" QUADS "f 1 2 3 4\n", 1, "t.obj:1: 1 statements not known");
    check_read(QUADS "f 1 2 3 4\ncstype bezier\ndeg 3\ncurv 0 1 1 2\nend\n", 1,
               "t.obj:8: 4 statements not known");
    check_read(QUADS "vn nan -NaN nan(ind)\nvn 0 -inf 1.#QNAN\nf 1//1 2//2 3//1 4//1\n", 1,
               "t.obj:7: 5 values of normals are no numbers");
    check_read(QUADS "# C:\\rocks\\\nf 1 2 3 4\nf 2 5 6 3\n", 2,
               "t.obj:7: 1 lines end in a backslash");
    check_read(QUADS "mtllib C:\\rocks\\\nf 1 2 3 4\nf 2 5 6 3\n", 2, "t.obj:7: 1 lines end in");
    check_read(QUADS "usemtl C:\\rocks\\\r\nf 1 2 3 4\r\nf 2 5 6 3\r\n", 2,
               "1 lines end in a backslash");
    check_read(QUADS "g a\\\nf 1 2 3 4\ng b\nf 2 5 6 3\n", 2, "1 lines end in a backslash");
    check_read(QUADS "o a\\\nf 1 2 3 4\no b\nf 2 5 6 3\n", 2, "1 lines end in a backslash");
    check_read(QUADS "f 1 2 3 4 # \\\nf 2 5 6 3\n", 2, "1 lines end in a backslash");
    check_read(QUADS "l 1 2 \\\n3 4\nf 1 2 3 4\n", 1, NULL);
    check_read(QUADS "l 1 2 \\\nf 1 2 3 4\n", 1, "1 lines end in a backslash");
    check_read(QUADS "f 1 2 \\\n3 4\nf 2 \\\r\n5 6 3\n", 2, NULL);
    check_read(QUADS "s 1\nusemtl a\nf 1 2 3 4\ns off\n", 1, NULL);
    static const char *const joining[] = {
        "vn 0 0 1",          "vt 0 0", "v 9 9 9", "t hole 1/0/0 1", "v 9 9 9 0.5 0.5 0.5", "vt 0",
        "v 9 9 9 1 \\\n 2 3"};
    for (size_t i = 0; i < sizeof joining / sizeof *joining; i++) {
        char text[256];
        snprintf(text, sizeof text, QUADS "%s\\\nf 1 2 3 4\nf 2 5 6 3\n", joining[i]);
        check_read(text, 2,
                   strstr(joining[i], "2 3") ? "t.obj:8: 1 lines end in a b"
                                             : "t.obj:7: 1 lines end in a b");
    }
    check_read("v 9 9 9\\\r\n" QUADS "f -6 -5 -4 -3\n", 1, "t.obj:1: 1 lines end in a backslash");
    check_read(QUADS "vn 0 0 1 1 hair\nvt 0 0 x\nf 1 2 3 4\n", 1, "t.obj:7: 3 words");
    check_read(QUADS "v 0 0 0 9 9 9 9 9 9\nf 1 2 3 4\n", 1, "t.obj:7: 1 words");
    check_read("v 9 9 9 1 1 1\nv 9 9 9 1\nv 9 9 9 1 1 1 1 # f\n" QUADS "f 1 2 3 4\n", 1, NULL);
    check_read(QUADS "vt 0 0 0\nt hole 1/1/1 1 0.5 x\nf 1 2 3 4\nf 2 5 6 3\n", 2, NULL);
    slv_mesh *mesh = NULL;
    CHECK(parse("\xff\xfev\0", &mesh) == SLV_ERROR_FORMAT && strstr(test_last_log, "UTF-16"));
}

/* g ends at the next g or o, o at the next o, and names without polygons are no groups. */
static void test_groups(void) {
    slv_mesh *mesh = good(QUADS "o Cube\ng Mat1\nf 1 2 3 4\ng Mat2 both\nf 2 5 6 3\ng empty\ng\n"
                                "f 1 2 3\no Next\nf 1 2 3\ng Mat1\nf 1 2 3\no end");
    static const struct {
        const char *name;
        int32_t first, count;
    } wanted[] = {{"Cube", 0, 3}, {"Mat1", 0, 1}, {"Mat2", 1, 1},
                  {"both", 1, 1}, {"Next", 3, 2}, {"Mat1", 4, 1}};
    const slv_mesh_view *v = slv_mesh_get_view(mesh);
    REQUIRE(v->ngroups == sizeof wanted / sizeof *wanted);
    for (uint32_t g = 0; g < v->ngroups; g++)
        CHECK_MSG(!strcmp(v->group_names[g], wanted[g].name) &&
                      v->group_first[g] == wanted[g].first && v->group_count[g] == wanted[g].count,
                  "group %u is %s", g, v->group_names[g]);
    slv_mesh_destroy(mesh);
}

int main(void) {
    test_forms();
    test_tags();
    test_numbers();
    test_refused();
    test_tolerated();
    test_groups();
    test_round_trip();
    test_mutations();
    test_create();
    test_stats();
    return test_end();
}
