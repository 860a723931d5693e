/* Patterns baked into textures on the limit surface: every type and channel count, neighbours that
 * agree, threads. */
#include "kit/test.h"

#include <selvage/bake.h>

/* A cube with a peak: quads, triangles and a pentagon, so that whole faces meet sub-faces. */
static const char shape[] =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nv 0.5 1.7 0.5\n"
    "f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 4 1 5 8\nf 5 6 7 9 8\nf 3 4 9\nf 3 9 7\nf 4 8 9\n";

static slv_mesh *mesh;
static slv_surface *surface;
static slv_adjacency *adjacency;

static slv_texture *make_texture(const slv_env *env, slv_type type, uint32_t nchannels, int low,
                                 int high) {
    uint64_t random = 5;
    slv_res res[64];
    uint32_t nfaces = slv_surface_face_count(surface);
    REQUIRE(nfaces <= 64);
    for (uint32_t i = 0; i < nfaces; i++) {
        uint32_t span = (uint32_t)(high - low) + 1;
        res[i].u = (int8_t)(low + (int)(test_random(&random) % span));
        res[i].v = (int8_t)(low + (int)(test_random(&random) % span));
    }
    slv_texture_desc desc = {.nfaces = nfaces,
                             .type = type,
                             .nchannels = nchannels,
                             .alpha_channel = SLV_NO_ALPHA,
                             .res = res};
    slv_texture *texture = NULL;
    REQUIRE(!slv_texture_create(env, &desc, &texture));
    return texture;
}

static bool same_textures(const slv_texture *a, const slv_texture *b) {
    const slv_texture_desc *desc = slv_texture_get_desc(a);
    for (uint32_t f = 0; f < desc->nfaces; f++) {
        size_t texels =
            slv_texture_is_constant(a, f) ? 1 : (size_t)1 << (desc->res[f].u + desc->res[f].v);
        size_t size = texels * desc->nchannels * slv_type_size(desc->type);
        if (slv_texture_is_constant(a, f) != slv_texture_is_constant(b, f) ||
            memcmp(slv_texture_texels(a, f), slv_texture_texels(b, f), size) != 0)
            return false;
    }
    return true;
}

static void position_at(uint32_t face, float u, float v, float out[3]) {
    slv_surface_point point = {(int32_t)face, u, v};
    REQUIRE(!slv_surface_evaluate(surface, 1, &point, &(slv_surface_arrays){.positions = out}));
}

/* Every texel is the pattern at its centre's limit position, for all types and channel counts. */
static void test_texels(const slv_env *env) {
    const slv_procedural pattern = {.pattern = SLV_PATTERN_NOISE,
                                    .frequency = 2,
                                    .color0 = {0.1f, 0.9f, 0.3f, 1},
                                    .color1 = {0.8f, 0.2f, 0.6f, 0.4f}};
    static const float tolerance[] = {0.51f / 255, 0.51f / 65535, 1e-3f, 1e-6f};
    for (int type = SLV_TYPE_U8; type <= SLV_TYPE_FLOAT; type++)
        for (uint32_t nchannels = 1; nchannels <= 4; nchannels++) {
            slv_texture *texture = make_texture(env, (slv_type)type, nchannels, 0, 4);
            const slv_texture_desc *desc = slv_texture_get_desc(texture);
            REQUIRE(!slv_bake_procedural(env, surface, &pattern, NULL, texture));
            for (uint32_t f = 0; f < desc->nfaces; f++)
                for (uint32_t y = 0; y < 1u << desc->res[f].v; y++)
                    for (uint32_t x = 0; x < 1u << desc->res[f].u; x++) {
                        float position[3], rgba[4], found[4];
                        position_at(f, ((float)x + 0.5f) / (float)(1 << desc->res[f].u),
                                    ((float)y + 0.5f) / (float)(1 << desc->res[f].v), position);
                        slv_procedural_evaluate(&pattern, (int32_t)f, position, rgba);
                        if (nchannels == 1)
                            rgba[0] = 0.2126f * rgba[0] + 0.7152f * rgba[1] + 0.0722f * rgba[2];
                        slv_texture_fetch(texture, f, x, y, found);
                        for (uint32_t c = 0; c < nchannels; c++)
                            CHECK(fabsf(found[c] - rgba[c]) <= tolerance[type]);
                    }
            slv_texture_destroy(texture);
        }
}

/* At points that two faces share the pattern is one; and texels on both sides of a seam differ no
 * more than texels within. */
static void test_continuity(const slv_env *env) {
    const slv_procedural pattern = {.pattern = SLV_PATTERN_NOISE, .octaves = 2};
    slv_texture *texture = make_texture(env, SLV_TYPE_FLOAT, 1, 5, 5);
    REQUIRE(!slv_bake_procedural(env, surface, &pattern, NULL, texture));
    const uint32_t size = 32;
    float inside = 0, across = 0;
    int shared = 0;
    for (uint32_t f = 0; f < slv_surface_face_count(surface); f++) {
        for (uint32_t i = 0; i < size * (size - 1); i++) {
            float a, b, c;
            slv_texture_fetch(texture, f, i % size, i / size, &a);
            slv_texture_fetch(texture, f, i % size, i / size + 1, &b);
            inside = fmaxf(inside, fabsf(a - b));
            slv_texture_fetch(texture, f, i / size, i % size, &a);
            slv_texture_fetch(texture, f, i / size + 1, i % size, &c);
            inside = fmaxf(inside, fabsf(a - c));
        }
        for (unsigned e = 0; e < 4; e++) {
            slv_neighbour n[2];
            uint32_t count = slv_adjacency_neighbours(adjacency, (int32_t)f, e, n);
            for (uint32_t k = 0; k < count; k++)
                for (uint32_t i = 0; i < size; i++) {
                    static const float eu[4] = {0, 1, 0, 0}, ev[4] = {0, 0, 1, 0};
                    float t = ((float)i + 0.5f) / (float)size;
                    t = n[k].t0 + t * (n[k].t1 - n[k].t0);
                    float s = e < 2 ? t : 1 - t, u2, v2, here[3], there[3], a[4], b[4];
                    float u = e & 1 ? eu[e] : s, v = e & 1 ? s : ev[e];
                    slv_affine_apply(&n[k].map, u, v, &u2, &v2);
                    position_at(f, u, v, here);
                    position_at((uint32_t)n[k].face, u2, v2, there);
                    slv_procedural_evaluate(&pattern, (int32_t)f, here, a);
                    slv_procedural_evaluate(&pattern, n[k].face, there, b);
                    CHECK_MSG(fabsf(a[0] - b[0]) < 1e-4f, "face %u edge %u t %g: %g, %g", f, e,
                              (double)t, (double)a[0], (double)b[0]);
                    uint32_t x = (uint32_t)fminf(u * 32, 31), y = (uint32_t)fminf(v * 32, 31);
                    uint32_t x2 = (uint32_t)fminf(u2 * 32, 31), y2 = (uint32_t)fminf(v2 * 32, 31);
                    slv_texture_fetch(texture, f, x, y, a);
                    slv_texture_fetch(texture, (uint32_t)n[k].face, x2, y2, b);
                    across = fmaxf(across, fabsf(a[0] - b[0]));
                    shared++;
                }
        }
    }
    CHECK(shared > 1000);
    CHECK_MSG(across < 1.5f * inside, "%g across seams, %g within faces", (double)across,
              (double)inside);
    slv_texture_destroy(texture);
}

static void test_threads(const slv_env *env) {
    slv_env one = *env, four = *env;
    one.threads = 1;
    four.threads = 4;
    for (int pattern = SLV_PATTERN_STRIPES; pattern <= SLV_PATTERN_POSITION; pattern++) {
        slv_procedural p = {
            .pattern = (slv_pattern)pattern, .frequency = 3, .warp = 0.5f, .face_tint = 0.3f};
        slv_bake_params params = {.samples = pattern == SLV_PATTERN_CHECKER ? 3 : 1};
        slv_texture *a = make_texture(env, SLV_TYPE_HALF, 3, 0, 6);
        slv_texture *b = make_texture(env, SLV_TYPE_HALF, 3, 0, 6);
        REQUIRE(!slv_bake_procedural(&one, surface, &p, &params, a));
        REQUIRE(!slv_bake_procedural(&four, surface, &p, &params, b));
        CHECK(same_textures(a, b));
        if (pattern == SLV_PATTERN_FACE_COLOR)
            CHECK(slv_texture_is_constant(a, 3));
        slv_texture_destroy(a);
        slv_texture_destroy(b);
    }
}

/* More samples: hard edges become greys in proportion, and the mean of a linear function stays what
 * it was. */
static void test_samples(const slv_env *env) {
    slv_procedural checker = {
        .pattern = SLV_PATTERN_CHECKER, .frequency = 2, .offset = {0.1f, 0.1f, 0.1f}};
    slv_texture *once = make_texture(env, SLV_TYPE_FLOAT, 1, 3, 3);
    slv_texture *often = make_texture(env, SLV_TYPE_FLOAT, 1, 3, 3);
    REQUIRE(!slv_bake_procedural(env, surface, &checker, NULL, once));
    REQUIRE(!slv_bake_procedural(env, surface, &checker, &(slv_bake_params){.samples = 8}, often));
    int greys = 0;
    for (uint32_t f = 0; f < slv_surface_face_count(surface); f++)
        for (uint32_t i = 0; i < 64; i++) {
            float a, b;
            slv_texture_fetch(once, f, i % 8, i / 8, &a);
            slv_texture_fetch(often, f, i % 8, i / 8, &b);
            CHECK(fabsf(a) < 1e-5f || fabsf(a - 1) < 1e-5f);
            CHECK(b >= 0 && b <= 1.00001f && fabsf(b * 64 - roundf(b * 64)) < 1e-2f);
            greys += b > 0.01f && b < 0.99f;
        }
    CHECK(greys > 10);
    slv_texture_destroy(often);

    slv_procedural position = {.pattern = SLV_PATTERN_POSITION};
    slv_texture *largest = make_texture(env, SLV_TYPE_FLOAT, 1, 3, 3);
    REQUIRE(!slv_bake_procedural(env, surface, &position, NULL, once));
    REQUIRE(
        !slv_bake_procedural(env, surface, &position, &(slv_bake_params){.samples = 64}, largest));
    for (uint32_t i = 0; i < 64; i++) {
        float a, b;
        slv_texture_fetch(once, 0, i % 8, i / 8, &a);
        slv_texture_fetch(largest, 0, i % 8, i / 8, &b);
        CHECK(fabsf(a - b) < 0.02f);
    }
    slv_texture_destroy(once);
    slv_texture_destroy(largest);
}

static void test_faces_left_alone(const slv_env *env) {
    slv_procedural pattern = {.pattern = SLV_PATTERN_FACE_COLOR};
    slv_texture *texture = make_texture(env, SLV_TYPE_U8, 3, 2, 2);
    slv_bake_params some = {.first_face = 2, .face_count = 3};
    REQUIRE(!slv_bake_procedural(env, surface, &pattern, &some, texture));
    for (uint32_t f = 0; f < slv_surface_face_count(surface); f++) {
        float rgb[3];
        slv_texture_fetch(texture, f, 1, 1, rgb);
        CHECK((rgb[0] + rgb[1] + rgb[2] > 0) == (f >= 2 && f < 5));
    }
    slv_texture_destroy(texture);
}

static int errors;

static void count_errors(void *user, slv_log_level level, const char *message) {
    errors += level == SLV_LOG_ERROR;
    test_log(user, level, message);
}

static void test_refusals(const slv_env *env) {
    slv_env counting = {.log = count_errors};
    slv_procedural pattern = {0}, unknown = {.pattern = (slv_pattern)99};
    slv_res res[3] = {{0, 0}, {0, 0}, {0, 0}};
    slv_texture_desc desc = {
        .nfaces = 3, .type = SLV_TYPE_U8, .nchannels = 1, .alpha_channel = SLV_NO_ALPHA};
    desc.res = res;
    slv_texture *few = NULL, *wide = make_texture(env, SLV_TYPE_U8, 5, 1, 1);
    slv_texture *good = make_texture(env, SLV_TYPE_U8, 1, 1, 1);
    REQUIRE(!slv_texture_create(env, &desc, &few));

    errors = 0;
    CHECK(slv_bake_procedural(&counting, surface, &pattern, NULL, few) == SLV_ERROR_MISMATCH);
    CHECK(strstr(test_last_log, "3") && errors == 1);
    CHECK(slv_bake_procedural(&counting, surface, &pattern, NULL, wide) == SLV_ERROR_UNSUPPORTED);
    CHECK(slv_bake_procedural(&counting, surface, &unknown, NULL, good) == SLV_ERROR_ARGUMENT);
    slv_bake_params params = {.samples = 65};
    CHECK(slv_bake_procedural(&counting, surface, &pattern, &params, good) == SLV_ERROR_ARGUMENT);
    params = (slv_bake_params){.first_face = 1, .face_count = slv_surface_face_count(surface)};
    CHECK(slv_bake_procedural(&counting, surface, &pattern, &params, good) == SLV_ERROR_ARGUMENT);
    counting.max_bytes = 1000;
    CHECK(slv_bake_procedural(&counting, surface, &pattern, NULL, good) == SLV_ERROR_LIMIT);
    CHECK(errors == 6);
    slv_texture_destroy(few);
    slv_texture_destroy(wide);
    slv_texture_destroy(good);
}

int main(void) {
    slv_env env = test_env();
    REQUIRE(!slv_mesh_parse_obj(&env, "shape", shape, sizeof shape - 1, &mesh));
    REQUIRE(!slv_surface_create(&env, mesh, NULL, &surface));
    REQUIRE(!slv_mesh_adjacency(&env, mesh, &adjacency));
    test_texels(&env);
    test_continuity(&env);
    test_threads(&env);
    test_samples(&env);
    test_faces_left_alone(&env);
    test_refusals(&env);
    slv_adjacency_destroy(adjacency);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    return test_end();
}
