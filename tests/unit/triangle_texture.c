/* Triangles as sub-faces: where points lie, how they meet, and what of a triangle texture their
 * texels show. */
#include "kit/ptx_kit.h"
#include "kit/triangle_kit.h"

#include <selvage/filter.h>
#include <selvage/ptx_writer.h>

static void test_points(uint64_t *random) {
    for (int i = 0; i < 1000; i++) {
        float u = (float)(test_random(random) % 1001) / 1000,
              v = (float)(test_random(random) % 1001) / 1000, s, t, back_u, back_v;
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        unsigned sub = slv_triangle_to_subface(u, v, &s, &t);
        const float weights[3] = {1 - u - v, u, v};
        REQUIRE(sub < 3 && s >= 0 && s <= 1 && t >= 0 && t <= 1);
        CHECK(weights[sub] >= fmaxf(weights[0], fmaxf(weights[1], weights[2])) - 1e-6f);
        slv_triangle_from_subface(sub, s, t, &back_u, &back_v);
        CHECK_MSG(fabsf(back_u - u) < 1e-3f && fabsf(back_v - v) < 1e-3f,
                  "%g %g: sub-face %u at %g %g is %g %g", (double)u, (double)v, sub, (double)s,
                  (double)t, (double)back_u, (double)back_v);
    }
    /* corners: a vertex, the middle of its edge, the centre, the middle of the edge before */
    static const float at[3][4][2] = {{{0, 0}, {0.5f, 0}, {1 / 3.0f, 1 / 3.0f}, {0, 0.5f}},
                                      {{1, 0}, {0.5f, 0.5f}, {1 / 3.0f, 1 / 3.0f}, {0.5f, 0}},
                                      {{0, 1}, {0, 0.5f}, {1 / 3.0f, 1 / 3.0f}, {0.5f, 0.5f}}};
    for (unsigned sub = 0; sub < 3; sub++)
        for (unsigned corner = 0; corner < 4; corner++) {
            float u, v;
            slv_triangle_from_subface(sub, corner == 1 || corner == 2, corner > 1, &u, &v);
            CHECK(fabsf(u - at[sub][corner][0]) < 1e-6f && fabsf(v - at[sub][corner][1]) < 1e-6f);
        }
}

/* The records that a file would have, by comparing vertices. */
static slv_face_adjacency *records_of(const slv_mesh_view *view) {
    slv_face_adjacency *records = calloc(view->npolys, sizeof *records);
    REQUIRE(records);
    for (uint32_t f = 0; f < view->npolys; f++)
        for (unsigned e = 0; e < 4; e++) {
            uint32_t hits = 0;
            records[f].face[e] = SLV_BOUNDARY;
            for (uint32_t g = 0; g < view->npolys && e < 3; g++)
                for (unsigned ge = 0; ge < 3; ge++) {
                    const int32_t *a = view->poly_verts + 3 * f, *b = view->poly_verts + 3 * g;
                    bool opposite = a[e] == b[(ge + 1) % 3] && a[(e + 1) % 3] == b[ge],
                         same = a[e] == b[ge] && a[(e + 1) % 3] == b[(ge + 1) % 3];
                    hits += opposite || same;
                    if (opposite) {
                        records[f].face[e] = (int32_t)g;
                        records[f].edge[e] = (uint8_t)ge;
                    }
                }
            if (hits != 2) {
                records[f].face[e] = SLV_BOUNDARY;
                records[f].edge[e] = 0;
            }
        }
    return records;
}

/* What a file says of triangles and what their mesh says of its sub-faces is the same. */
static void test_adjacency(uint64_t *random) {
    slv_env env = test_env();
    for (int kind = 0; kind < 3 * TRIANGLE_KINDS; kind++) {
        shape s = triangle_shape(kind, random);
        slv_mesh *mesh = shape_mesh(&env, &s);
        slv_adjacency *of_mesh = NULL, *of_file = NULL;
        const slv_mesh_view *view = slv_mesh_get_view(mesh);
        slv_face_adjacency *records = records_of(view);
        MUST(slv_mesh_adjacency(&env, mesh, &of_mesh));
        MUST(slv_adjacency_create_triangles(&env, view->npolys, records, &of_file));
        REQUIRE(slv_adjacency_face_count(of_file) == 3 * view->npolys);
        CHECK(slv_adjacency_cut_count(of_file) == 0);
        for (uint32_t f = 0; f < 3 * view->npolys; f++) {
            const slv_face_adjacency *a = slv_adjacency_faces(of_file) + f,
                                     *b = slv_adjacency_faces(of_mesh) + f;
            CHECK(slv_adjacency_is_subface(of_file, (int32_t)f));
            for (int e = 0; e < 4; e++)
                CHECK_MSG(a->face[e] == b->face[e] && (a->face[e] < 0 || a->edge[e] == b->edge[e]),
                          "kind %d: face %u edge %d: %d %d, the mesh says %d %d", kind, f, e,
                          a->face[e], a->edge[e], b->face[e], b->edge[e]);
        }
        free(records);
        slv_adjacency_destroy(of_mesh);
        slv_adjacency_destroy(of_file);
        slv_mesh_destroy(mesh);
        shape_clear(&s);
    }
}

/* The cell and half of a texel of a triangle's square. */
static void cell_of(int32_t n, int32_t x, int32_t y, float *u, float *v) {
    bool odd = x + y >= n;
    *u = ((float)(odd ? n - 1 - y : x) + (odd ? 2 : 1) / 3.0f) / (float)n;
    *v = ((float)(odd ? n - 1 - x : y) + (odd ? 2 : 1) / 3.0f) / (float)n;
}

/* Texels that are a linear function of their middles give samples that are the same function, but
 * where a border is near; of any resolutions side by side nearly, since a coarser neighbour's
 * texels are wide. */
static void test_linear(bool mixed, uint64_t *random) {
    shape s = shape_grid(4, 4, false, false);
    shape_cut(&s, random, 8, 0);
    shape_rotate_polygons(&s, random);
    int8_t log2[64] = {0};
    REQUIRE(s.npolys == 32);
    for (uint32_t f = 0; f < s.npolys; f++)
        log2[f] = (int8_t)(mixed ? 2 + test_random(random) % 4 : 4);
    slv_texture *triangles = triangle_noise(s.npolys, log2, SLV_TYPE_FLOAT, 2, random);
    for (uint32_t f = 0; f < s.npolys; f++) {
        int32_t n = 1 << log2[f];
        float *texels = calloc((size_t)n * (size_t)n, 2 * sizeof *texels);
        REQUIRE(texels);
        for (int32_t i = 0; i < n * n; i++) {
            float u, v;
            cell_of(n, i % n, i / n, &u, &v);
            for (int c = 0; c < 2; c++) {
                const float *p[3];
                for (int k = 0; k < 3; k++)
                    p[k] = s.positions + 3 * s.verts[3 * f + (uint32_t)k];
                texels[2 * i + c] = p[0][c] + u * (p[1][c] - p[0][c]) + v * (p[2][c] - p[0][c]);
            }
        }
        MUST(slv_texture_set_face(triangles, f, texels));
        free(texels);
    }
    kit k = triangle_kit(&s, triangles);
    uint32_t checked = 0;
    float worst = 0;
    for (uint32_t face = 0; face < k.nfaces; face++) {
        int32_t n = 1 << k.res[face].u;
        for (int32_t i = 0; i < n * n; i++) {
            float u, v, value[2], expected[2];
            slv_triangle_from_subface(face % 3, ((float)(i % n) + 0.5f) / (float)n,
                                      ((float)(i / n) + 0.5f) / (float)n, &u, &v);
            slv_texture_fetch(k.texture, face, (uint32_t)(i % n), (uint32_t)(i / n), value);
            const int32_t *verts = s.verts + 3 * (face / 3);
            bool near = false;
            for (int c = 0; c < 2; c++) {
                const float *p[3];
                for (int j = 0; j < 3; j++)
                    p[j] = s.positions + 3 * verts[j];
                expected[c] = p[0][c] + u * (p[1][c] - p[0][c]) + v * (p[2][c] - p[0][c]);
                near |= expected[c] < 0.7f || expected[c] > 3.3f;
            }
            if (near)
                continue;
            checked++;
            for (int c = 0; c < 2; c++)
                worst = fmaxf(worst, fabsf(value[c] - expected[c]));
        }
    }
    fprintf(stderr, "linear%s: %u samples, off by %g at most\n", mixed ? ", mixed" : "", checked,
            (double)worst);
    CHECK(checked > 1000);
    CHECK_MSG(worst < (mixed ? 0.13f : 0.002f), "off by %g", (double)worst);
    kit_free(&k);
    slv_texture_destroy(triangles);
    shape_clear(&s);
}

/* A file of the triangles, for lookups on the CPU. */
static void save_triangles(const char *path, const shape *s, const slv_texture *triangles) {
    slv_env env = test_env();
    const slv_texture_desc *desc = slv_texture_get_desc(triangles);
    slv_mesh *mesh = shape_mesh(&env, s);
    slv_ptx_writer *writer = NULL;
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_TRIANGLE,
                                    .type = desc->type,
                                    .nchannels = desc->nchannels,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = desc->nfaces};
    MUST(slv_ptx_writer_create(&env, path, &params, &writer));
    for (uint32_t f = 0; f < desc->nfaces; f++) {
        slv_ptx_face face = {.res = desc->res[f]};
        MUST(slv_ptx_writer_write_face(writer, f, &face, slv_texture_texels(triangles, f)));
    }
    MUST(slv_ptx_writer_set_mesh(writer, mesh));
    MUST(slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
    slv_mesh_destroy(mesh);
}

/* Bilinear lookups of the sub-faces are the Ptex library's gaussian of the triangles. */
static void test_lookups(uint64_t *random) {
    slv_env env = test_env();
    for (int kind = 0; kind < TRIANGLE_KINDS; kind++)
        for (int log2 = 1 + kind % 2; log2 < (kind ? 5 : 7); log2 += 2) {
            shape s = triangle_shape(kind, random);
            int8_t all[256];
            REQUIRE(s.npolys < 256);
            memset(all, log2, sizeof all);
            slv_texture *triangles = triangle_noise(s.npolys, all, SLV_TYPE_FLOAT, 2, random);
            kit k = triangle_kit(&s, triangles);
            const char *path = scratch_path("triangle_texture.ptx");
            save_triangles(path, &s, triangles);
            slv_cache *cache = NULL;
            slv_sampler *sampler = NULL;
            slv_file_id file;
            slv_filter_params params = {.filter = SLV_FILTER_GAUSSIAN};
            MUST(slv_cache_create(&env, NULL, &cache));
            MUST(slv_cache_open(cache, path, &file));
            MUST(slv_sampler_create(cache, &params, &sampler));
            double squares = 0, worst = 0;
            uint32_t count = 0;
            kit_level level = {.values = NULL};
            uint32_t face = 0;
            for (int i = 0; i < 400; i++) {
                if (i % 50 == 0) {
                    free(level.values);
                    face = test_random(random) % k.nfaces;
                    level = kit_build(&k, face, 0, 1, 1);
                }
                float u = (float)(1 + test_random(random) % 999) / 1000,
                      v = (float)(1 + test_random(random) % 999) / 1000, expected[2];
                slv_lookup lookup = {.file = file, .face = face / 3};
                slv_triangle_from_subface(face % 3, u, v, &lookup.u, &lookup.v);
                /* around vertices of other valences than 6 the two unfold differently */
                float edge = fminf(fminf(lookup.u, lookup.v), 1 - lookup.u - lookup.v);
                if (edge * (float)(1 << log2) < 2)
                    continue;
                MUST(slv_sample(sampler, &lookup, expected));
                for (uint32_t c = 0; c < 2; c++) {
                    double off = fabs((double)kit_lookup(&level, (double)u, (double)v, c) -
                                      (double)expected[c]);
                    squares += off * off;
                    worst = fmax(worst, off);
                    count++;
                }
            }
            free(level.values);
            double rms = count ? sqrt(squares / count) : 0;
            CHECK_MSG(rms < (log2 <= SLV_TRIANGLE_FINE_LOG2 ? 0.004 : 0.01) && worst < 0.04,
                      "kind %d, %d texels: RMS %g, worst %g of %u", kind, 1 << log2, rms, worst,
                      count);
            slv_sampler_destroy(sampler);
            slv_cache_destroy(cache);
            slv_texture_destroy(triangles);
            kit_free(&k);
            shape_clear(&s);
            remove(path);
        }
}

static bool same_texels(const slv_texture *a, const slv_texture *b) {
    const slv_texture_desc *desc = slv_texture_get_desc(a);
    size_t size = slv_type_size(desc->type) * desc->nchannels;
    for (uint32_t f = 0; f < desc->nfaces; f++) {
        bool constant = slv_texture_is_constant(a, f);
        if (constant != slv_texture_is_constant(b, f) ||
            memcmp(slv_texture_texels(a, f), slv_texture_texels(b, f),
                   constant ? size : size * kit_texels(desc->res[f])) != 0)
            return false;
    }
    return true;
}

/* Constants stay what they are, large triangles too; any number of threads makes the same. */
static void test_constants_and_threads(uint64_t *random) {
    slv_env env = test_env(), many = test_env();
    many.threads = 4;
    env.threads = 1;
    for (int kind = 0; kind < TRIANGLE_KINDS; kind++)
        for (int type = 0; type < 4; type++) {
            shape s = triangle_shape(kind, random);
            slv_texture *again = NULL;
            int8_t log2[256];
            for (uint32_t f = 0; f < s.npolys; f++)
                log2[f] = (int8_t)(test_random(random) % 7);
            slv_texture *triangles = triangle_noise(s.npolys, log2, (slv_type)type, 3, random);
            kit k = triangle_kit(&s, triangles);
            MUST(slv_triangle_texture(&many, triangles, k.adjacency, SLV_TEXTURE_AUTO, &again));
            CHECK(same_texels(k.texture, again));
            slv_texture_destroy(again);
            const float value[3] = {0.3f, 0.7f, 0.1f};
            char texel[12];
            slv_type_from_float((slv_type)type, value, 3, texel);
            for (uint32_t f = 0; f < s.npolys; f++)
                MUST(slv_texture_set_constant(triangles, f, texel));
            MUST(slv_triangle_texture(&env, triangles, k.adjacency,
                                      type < 2 ? SLV_TEXTURE_SRGB : SLV_TEXTURE_AUTO, &again));
            for (uint32_t f = 0; f < k.nfaces; f++)
                CHECK(slv_texture_is_constant(again, f) &&
                      memcmp(slv_texture_texels(again, f), texel, 3 * slv_type_size(type)) == 0);
            slv_texture_destroy(again);
            slv_texture_destroy(triangles);
            kit_free(&k);
            shape_clear(&s);
        }
}

/* Black and white mean half the light, which is 188 of 255. */
static void test_light(void) {
    slv_env env = test_env();
    shape s = shape_tetrahedron();
    slv_mesh *mesh = shape_mesh(&env, &s);
    slv_adjacency *adjacency = NULL;
    slv_res res[4] = {{3, 3}, {3, 3}, {3, 3}, {3, 3}};
    slv_texture_desc desc = {4, SLV_TYPE_U8, 1, SLV_NO_ALPHA, res, SLV_TEXTURE_SRGB};
    slv_texture *triangles = NULL, *made = NULL;
    uint8_t texels[64];
    float middle;
    MUST(slv_mesh_adjacency(&env, mesh, &adjacency));
    MUST(slv_texture_create(&env, &desc, &triangles));
    for (int i = 0; i < 64; i++)
        texels[i] = i % 8 + i / 8 < 8 ? 255 : 0; /* even texels */
    for (uint32_t f = 0; f < 4; f++)
        MUST(slv_texture_set_face(triangles, f, texels));
    MUST(slv_triangle_texture(&env, triangles, adjacency, SLV_TEXTURE_AUTO, &made));
    slv_texture_fetch(made, 0, 15, 15, &middle);
    CHECK_MSG(fabsf(middle - 188.0f / 255) < 0.04f, "%g", (double)middle * 255);
    slv_texture_destroy(made);
    MUST(slv_triangle_texture(&env, triangles, adjacency, SLV_TEXTURE_DATA, &made));
    slv_texture_fetch(made, 0, 15, 15, &middle);
    CHECK_MSG(fabsf(middle - 0.5f) < 0.05f, "%g", (double)middle * 255);
    slv_texture_destroy(made);
    slv_texture_destroy(triangles);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
}

static void test_refusals(void) {
    slv_env env = test_env();
    shape s = shape_tetrahedron(), quads = shape_grid(3, 4, false, false);
    slv_mesh *mesh = shape_mesh(&env, &s), *other = shape_mesh(&env, &quads);
    slv_adjacency *adjacency = NULL, *wrong = NULL;
    slv_res res[4] = {{1, 1}, {1, 2}, {1, 1}, {1, 1}};
    slv_texture_desc desc = {4, SLV_TYPE_U8, 1, SLV_NO_ALPHA, res, SLV_TEXTURE_AUTO};
    slv_texture *triangles = NULL, *made = NULL;
    MUST(slv_mesh_adjacency(&env, mesh, &adjacency));
    MUST(slv_mesh_adjacency(&env, other, &wrong));
    MUST(slv_texture_create(&env, &desc, &triangles));
    CHECK(slv_triangle_texture(&env, triangles, adjacency, 0, &made) == SLV_ERROR_ARGUMENT &&
          !made);
    CHECK_MSG(strstr(test_last_log, "face 1: a triangle of 2^1 x 2^2 texels is not square"), "%s",
              test_last_log);
    slv_texture_destroy(triangles);
    res[1].v = 1;
    MUST(slv_texture_create(&env, &desc, &triangles));
    CHECK(slv_triangle_texture(&env, triangles, wrong, 0, &made) == SLV_ERROR_MISMATCH && !made);
    CHECK_MSG(strstr(test_last_log, "face 0 edge 1: "), "%s", test_last_log);
    slv_texture_destroy(triangles);
    desc.nfaces = 3;
    MUST(slv_texture_create(&env, &desc, &triangles));
    CHECK(slv_triangle_texture(&env, triangles, adjacency, 0, &made) == SLV_ERROR_MISMATCH);
    CHECK(strstr(test_last_log, "3 triangles"));
    slv_adjacency_destroy(wrong);
    CHECK(slv_adjacency_create_triangles(&env, 4, NULL, &wrong) == SLV_ERROR_ARGUMENT && !wrong);
    slv_texture_destroy(triangles);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    slv_mesh_destroy(other);
    shape_clear(&s);
    shape_clear(&quads);
}

int main(void) {
    uint64_t random = 11;
    test_points(&random);
    test_adjacency(&random);
    test_linear(false, &random);
    test_linear(true, &random);
    test_lookups(&random);
    test_constants_and_threads(&random);
    test_light();
    test_refusals();
    return test_end();
}
