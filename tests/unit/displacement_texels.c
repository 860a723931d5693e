/* What displacements are looked up in: triangles as their sub-faces, the neighbours that somebody
 * names in place of a file's, and values that are no numbers. */
#include "kit/displace_kit.h"
#include "kit/ptx_kit.h"
#include "kit/triangle_kit.h"

#include <selvage/ptx_writer.h>

#include <unistd.h>

enum { POINTS = 64 };

/* The other triangle at an edge, or SLV_BOUNDARY. */
static int32_t across(const shape *s, int32_t f, int e, uint8_t *edge) {
    const int32_t a = s->verts[3 * f + e], b = s->verts[3 * f + (e + 1) % 3];
    for (int32_t g = 0; g < (int32_t)s->npolys; g++)
        for (uint8_t k = 0; k < 3 && g != f; k++)
            if (s->verts[3 * g + k] == b && s->verts[3 * g + (k + 1) % 3] == a) {
                *edge = k;
                return g;
            }
    return SLV_BOUNDARY;
}

/* A triangle-mesh file of a texture, and its records. */
static void write_triangles(const char *path, const shape *s, const slv_texture *texture,
                            slv_face_adjacency *records) {
    slv_env env = test_env();
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_TRIANGLE,
                                    .type = desc->type,
                                    .nchannels = desc->nchannels,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = desc->nfaces};
    slv_ptx_writer *writer = NULL;
    MUST(slv_ptx_writer_create(&env, path, &params, &writer));
    for (uint32_t f = 0; f < desc->nfaces; f++) {
        slv_ptx_face info = {.res = desc->res[f], .adjacency.face = {-1, -1, -1, -1}};
        for (int e = 0; e < 3; e++)
            info.adjacency.face[e] = across(s, (int32_t)f, e, &info.adjacency.edge[e]);
        records[f] = info.adjacency;
        MUST(slv_ptx_writer_write_face(writer, f, &info, slv_texture_texels(texture, f)));
    }
    MUST(slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
}

/* The greatest difference of two displacements of the same faces. */
static float apart(const slv_displacement *a, const slv_displacement *b, uint32_t nfaces,
                   uint64_t *random) {
    float most = 0;
    for (uint32_t f = 0; f < nfaces; f++) {
        float uv[2 * POINTS], values[2][3 * POINTS] = {{0}};
        for (int i = 0; i < 2 * POINTS; i++)
            uv[i] = (float)(test_random(random) % 1025) / 1024;
        MUST(a->evaluate(a->user, (int32_t)f, 0, POINTS, uv, values[0]));
        MUST(b->evaluate(b->user, (int32_t)f, 0, POINTS, uv, values[1]));
        CHECK(a->detail(a->user, (int32_t)f) == b->detail(b->user, (int32_t)f));
        for (int i = 0; i < 3 * POINTS; i++)
            most = fmaxf(most, fabsf(values[0][i] - values[1][i]));
    }
    return most;
}

/* By a texture of quads with the neighbours of an adjacency, as it stands. */
static slv_displacement open_quads(slv_cache *cache, const slv_texture *texture,
                                   const slv_adjacency *adjacency) {
    const slv_displacement_params params = {.scale = 0.5f, .space = SLV_DISPLACE_OBJECT};
    slv_env env = test_env();
    slv_displacement out;
    slv_source source;
    slv_file_id file;
    MUST(slv_texture_as_source(&env, texture, adjacency, NULL, &source));
    MUST(slv_cache_open_source(cache, &source, NULL, &file));
    MUST(slv_displacement_open(cache, file, &params, &out));
    return out;
}

static void check_triangles(int kind, const char *path, uint64_t *random) {
    slv_env env = test_env();
    shape s = triangle_shape(kind, random);
    int8_t log2[64];
    slv_face_adjacency records[64], alone[64];
    slv_file_id file;
    slv_cache *cache = NULL;
    slv_texture *cut = NULL;
    slv_adjacency *apiece = NULL, *none = NULL;
    REQUIRE(s.npolys <= 64);
    for (uint32_t f = 0; f < s.npolys; f++) {
        log2[f] = (int8_t)(test_random(random) % 4);
        alone[f] = (slv_face_adjacency){.face = {-1, -1, -1, -1}};
    }
    slv_texture *triangles = triangle_noise(s.npolys, log2, SLV_TYPE_FLOAT, 3, random);
    kit k = triangle_kit(&s, triangles);
    write_triangles(path, &s, triangles, records);
    MUST(slv_adjacency_create_triangles(&env, s.npolys, records, &apiece));
    MUST(slv_adjacency_create_triangles(&env, s.npolys, alone, &none));
    MUST(slv_triangle_texture(&env, triangles, none, SLV_TEXTURE_DATA, &cut));
    MUST(slv_cache_create(&env, NULL, &cache));
    MUST(slv_cache_open(cache, path, &file));
    const slv_adjacency *given[] = {NULL, k.adjacency, apiece, none};
    slv_displacement expected[2] = {open_quads(cache, k.texture, k.adjacency),
                                    open_quads(cache, cut, none)};
    for (int i = 0; i < 4; i++) {
        const slv_displacement_params params = {
            .scale = 0.5f, .space = SLV_DISPLACE_OBJECT, .adjacency = given[i]};
        slv_displacement own;
        MUST(slv_displacement_open(cache, file, &params, &own));
        float same = apart(&own, &expected[i == 3], k.nfaces, random),
              other = apart(&own, &expected[i != 3], k.nfaces, random);
        CHECK_MSG(same == 0 && other > 0.01f, "kind %d, adjacency %d: %g and %g apart", kind, i,
                  (double)same, (double)other);
        slv_displacement_close(&own);
    }
    const slv_displacement_params channel = {.channel = 3};
    slv_displacement bad;
    CHECK(slv_displacement_open(cache, file, &channel, &bad) == SLV_ERROR_ARGUMENT);
    slv_adjacency *fewer = NULL;
    MUST(slv_adjacency_create_triangles(&env, 1, alone, &fewer));
    const slv_displacement_params small = {.adjacency = fewer};
    CHECK(s.npolys == 1 || slv_displacement_open(cache, file, &small, &bad) == SLV_ERROR_MISMATCH);
    slv_adjacency_destroy(fewer);
    slv_displacement_close(&expected[0]);
    slv_displacement_close(&expected[1]);
    slv_cache_destroy(cache);
    slv_texture_destroy(cut);
    slv_texture_destroy(triangles);
    slv_adjacency_destroy(apiece);
    slv_adjacency_destroy(none);
    kit_free(&k);
    shape_clear(&s);
    unlink(path);
}

/* Quads whose lookups go to other neighbours than the file has. */
static void check_quads(uint64_t *random) {
    slv_env env = test_env();
    shape s = shape_cube();
    shape_cut(&s, random, 2, 0);
    const slv_displacement_params params = {.scale = 0.5f, .space = SLV_DISPLACE_OBJECT};
    displaced d = displaced_make(shape_mesh(NULL, &s), SLV_SCHEME_CATMARK, 3, &params, random);
    const uint32_t nfaces = slv_mesh_face_count(d.mesh);
    slv_face_adjacency *alone = calloc(nfaces, sizeof *alone);
    slv_adjacency *none = NULL;
    slv_source source;
    slv_file_id file;
    REQUIRE(alone);
    for (uint32_t f = 0; f < nfaces; f++)
        alone[f] = (slv_face_adjacency){.face = {-1, -1, -1, -1}};
    MUST(slv_adjacency_create(&env, nfaces, alone, NULL, &none));
    slv_displacement cut = open_quads(d.cache, d.texture, none);
    MUST(slv_texture_as_source(&env, d.texture, d.adjacency, NULL, &source));
    MUST(slv_cache_open_source(d.cache, &source, NULL, &file));
    for (int i = 0; i < 2; i++) {
        slv_displacement_params own = params;
        own.adjacency = i ? none : d.adjacency;
        slv_displacement made;
        MUST(slv_displacement_open(d.cache, file, &own, &made));
        CHECK(apart(&made, i ? &cut : &d.displacement, nfaces, random) == 0);
        CHECK(apart(&made, i ? &d.displacement : &cut, nfaces, random) > 0.01f);
        slv_displacement_close(&made);
    }
    slv_displacement_close(&cut);
    slv_adjacency_destroy(none);
    free(alone);
    shape_clear(&s);
    displaced_free(&d);
}

/* A face that is no number stays where the limit is, and is named once. */
static void check_no_number(uint64_t *random) {
    shape s = shape_cube();
    const slv_displacement_params params = {.scale = 1, .bias = 1};
    displaced d = displaced_make(shape_mesh(NULL, &s), SLV_SCHEME_CATMARK, 0, &params, random);
    static const float none[3] = {NAN, INFINITY, NAN}, zero[3];
    const float uv[4] = {0.5f, 0.5f, 0.25f, 0.5f};
    float out[2];
    for (uint32_t f = 0; f < 6; f++)
        MUST(slv_texture_set_constant(d.texture, f, f == 3 ? none : zero));
    MUST(slv_cache_refresh(d.cache, 0));
    for (int32_t f = 0; f < 6; f++) {
        test_last_log[0] = 0;
        MUST(d.displacement.evaluate(d.displacement.user, f, 0, 2, uv, out));
        CHECK(out[0] == (f == 3 ? 0 : 1) && out[1] == out[0]);
        CHECK((f == 3) ==
              (strstr(test_last_log, "face 3: displaces by what is no number") != NULL));
    }
    test_last_log[0] = 0;
    MUST(d.displacement.evaluate(d.displacement.user, 3, 0, 2, uv, out));
    CHECK(!test_last_log[0]);
    shape_clear(&s);
    displaced_free(&d);
}

int main(void) {
    uint64_t random = 31;
    char path[1100];
    snprintf(path, sizeof path, "%s", scratch_path("triangles.ptx"));
    for (int kind = 0; kind < TRIANGLE_KINDS; kind++)
        check_triangles(kind, path, &random);
    check_quads(&random);
    check_no_number(&random);
    return test_end();
}
