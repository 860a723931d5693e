/* Environments: six faces that close a cube, in any turn, become the cube that they close; drawn
 * they are a sphere, by OpenGL as by rays. */
#include "kit/border_kit.h"
#include "kit/command_kit.h"

#include <selvage/bake.h>
#include <selvage/image.h>
#include <selvage/ptx.h>
#include <selvage/tessellation.h>

static kit_scratch scratch;
static kit_run run;
#define ARGUMENTS(...)                                                                             \
    (const char *const[]) {                                                                        \
        __VA_ARGS__, NULL                                                                          \
    }

/* +x -x +y -y +z -z as kit_cube has its corners. */
static const int32_t quads[6][4] = {{5, 1, 3, 7}, {0, 4, 6, 2}, {6, 7, 3, 2},
                                    {0, 1, 5, 4}, {4, 5, 7, 6}, {1, 0, 2, 3}};

static void check_cube(bool inwards, uint64_t *random) {
    slv_env env = test_env();
    slv_mesh *cube = NULL;
    slv_adjacency *adjacency = NULL;
    kit k = {0};
    for (int f = 0; f < 6; f++) {
        int32_t quad[4];
        for (int c = 0; c < 4; c++)
            quad[c] = quads[f][inwards ? 3 - c : c];
        kit_poly(&k, 4, quad, test_random(random) % 4);
    }
    kit_finish(&k);
    REQUIRE(slv_mesh_create_cube(&env, k.adjacency, &cube) == SLV_OK);
    REQUIRE(slv_mesh_adjacency(&env, cube, &adjacency) == SLV_OK);
    CHECK(memcmp(slv_adjacency_faces(adjacency), slv_adjacency_faces(k.adjacency),
                 6 * sizeof(slv_face_adjacency)) == 0);
    const slv_mesh_view *view = slv_mesh_get_view(cube);
    for (int32_t f = 0; f < 6; f++)
        for (int c = 0; c < 4; c++) {
            const float *at = view->positions + 3 * (size_t)view->poly_verts[4 * f + c];
            CHECK_MSG(at[f / 2] == (f % 2 ? -1.0f : 1.0f), "face %d: %g %g %g", f, (double)at[0],
                      (double)at[1], (double)at[2]);
        }
    const slv_displacement sphere = slv_sphere_displacement(cube);
    for (int32_t f = 0; f < 6; f++)
        for (int i = 0; i < 25; i++) {
            const float uv[2] = {(float)(i % 5) / 4, (float)(i / 5) / 4};
            const int32_t *verts = view->poly_verts + 4 * f;
            float by[3], length = 0;
            REQUIRE(sphere.evaluate(sphere.user, f, 0, 1, uv, by) == SLV_OK);
            for (int c = 0; c < 3; c++) {
                const float *p = view->positions + c;
                float at = (1 - uv[1]) * ((1 - uv[0]) * p[3 * verts[0]] + uv[0] * p[3 * verts[1]]) +
                           uv[1] * ((1 - uv[0]) * p[3 * verts[3]] + uv[0] * p[3 * verts[2]]);
                length += (at + by[c]) * (at + by[c]);
            }
            CHECK(fabsf(length - 1) < 1e-5f);
        }
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(cube);
    kit_free(&k);
}

static void check_others(uint64_t *random) {
    slv_env env = test_env();
    slv_mesh *cube = NULL;
    kit k;
    kit_grid(&k, 3, 2, true, 0, random, NULL); /* six, closed, and a torus */
    CHECK(slv_mesh_create_cube(&env, k.adjacency, &cube) == SLV_ERROR_MISMATCH && !cube);
    kit_free(&k);
    kit_grid(&k, 3, 2, false, 0, random, NULL);
    CHECK(slv_mesh_create_cube(&env, k.adjacency, &cube) == SLV_ERROR_MISMATCH && !cube);
    kit_free(&k);
    kit_pentagons(&k, random);
    CHECK(slv_mesh_create_cube(&env, k.adjacency, &cube) == SLV_ERROR_MISMATCH && !cube);
    kit_free(&k);
}

static slv_image draw(const char *const *arguments, const char *name) {
    char path[KIT_PATH];
    slv_image image = {0};
    kit_selvage(&scratch, NULL, arguments, &run);
    CHECK_MSG(run.code == 0 && !run.err[0], "exit code %d: %s", run.code, run.err);
    REQUIRE(slv_image_load(NULL, kit_join(path, scratch.folder, name), &image) == SLV_OK);
    return image;
}

/* Every point has the colour of its direction: red 1 at +x, 0 at -x, and so on. */
static void write_environment(const char *path) {
    slv_env env = test_env();
    slv_mesh *cube = NULL;
    const slv_ptx_write_params params = {0};
    kit k = {0};
    for (int f = 0; f < 6; f++)
        kit_poly(&k, 4, quads[f], (uint32_t)f % 4);
    kit_finish(&k);
    kit_equal(&k, 5);
    REQUIRE(slv_mesh_create_cube(&env, k.adjacency, &cube) == SLV_OK);
    const slv_mesh_view *view = slv_mesh_get_view(cube);
    kit_begin_texture(&k, SLV_TYPE_FLOAT, 3);
    for (uint32_t f = 0; f < 6; f++) {
        static float values[3 * 32 * 32];
        const int32_t *verts = view->poly_verts + 4 * f;
        for (int i = 0; i < 32 * 32; i++) {
            float u = ((float)(i % 32) + 0.5f) / 32, v = ((float)(i / 32) + 0.5f) / 32, at[3],
                  length = 0;
            for (int c = 0; c < 3; c++) {
                const float *p = view->positions + c;
                at[c] = (1 - v) * ((1 - u) * p[3 * verts[0]] + u * p[3 * verts[1]]) +
                        v * ((1 - u) * p[3 * verts[3]] + u * p[3 * verts[2]]);
                length += at[c] * at[c];
            }
            for (int c = 0; c < 3; c++)
                values[3 * i + c] = 0.5f + 0.5f * at[c] / sqrtf(length);
        }
        kit_set(&k, f, values);
    }
    REQUIRE(slv_ptx_save(&env, path, k.texture, k.adjacency, &params) == SLV_OK);
    slv_mesh_destroy(cube);
    kit_free(&k);
}

/* From +z: red to the right, green up, and blue most in the middle; by OpenGL and by rays. */
static void check_picture(void) {
    char ptx[KIT_PATH];
    write_environment(kit_join(ptx, scratch.root, "env.ptx"));
#define FROM_Z "--azimuth", "0", "--elevation", "0", "--fov", "0", "--size", "65", "--bits", "32"
    slv_image gl = draw(ARGUMENTS("render", ptx, FROM_Z, "-q", "-o", "a.exr"), "a.exr");
    slv_image rays = draw(ARGUMENTS("reference", ptx, FROM_Z, "-q", "-o", "b.exr"), "b.exr");
    slv_image asked =
        draw(ARGUMENTS("render", ptx, FROM_Z, "--environment", "-q", "-o", "c.exr"), "c.exr");
    const slv_image *images[] = {&gl, &rays};
    CHECK(memcmp(gl.pixels, asked.pixels, sizeof(float) * 4 * 65 * 65) == 0);
    for (int i = 0; i < 2; i++) {
        const float *pixels = images[i]->pixels, *middle = pixels + 4 * (32 * 65 + 32);
        float before = 0, after = 0;
        uint32_t inside = 0;
        for (uint32_t x = 1; x < 64; x++) {
            const float *at = pixels + 4 * (32 * 65 + x);
            if (at[3] < 1)
                continue;
            after = at[0];
            CHECK(after > before); /* red grows to the right */
            before = after;
            inside++;
            CHECK(fabsf(at[1] - 0.5f) < 0.02f);
            float red = 2 * at[0] - 1, blue = 2 * at[2] - 1;
            CHECK_MSG(fabsf(red * red + blue * blue - 1) < 0.01f, "%g %g", (double)red,
                      (double)blue);
        }
        CHECK(inside > 40);
        CHECK(fabsf(middle[0] - 0.5f) < 0.02f && fabsf(middle[2] - 1) < 0.01f);
        CHECK(pixels[4 * (16 * 65 + 32) + 1] > 0.6f && pixels[4 * (48 * 65 + 32) + 1] < 0.4f);
    }
    slv_image_free(&gl);
    slv_image_free(&rays);
    slv_image_free(&asked);
    kit_selvage(&scratch, NULL, ARGUMENTS("render", ptx, "--displacement-channel", "0", "x.png"),
                &run);
    CHECK(run.code == 1 && strstr(run.err, "an environment is a sphere"));
}

/* All directions at once: +z in the middle, +y at the top, +x to the left, by OpenGL and by rays.
 */
static void check_map(void) {
    enum { WIDTH = 48, HEIGHT = 24 };
    char ptx[KIT_PATH];
    kit_join(ptx, scratch.root, "env.ptx");
#define MAP ptx, "--latlong", "--size", "48x24", "-q", "-o"
    slv_image images[] = {
        draw(ARGUMENTS("render", MAP, "m.exr", "--bits", "32"), "m.exr"),
        draw(ARGUMENTS("render", MAP, "n.exr", "--bits", "32", "-s", "borders", "--msaa", "1"),
             "n.exr"),
        draw(ARGUMENTS("reference", MAP, "o.exr", "--samples", "16"), "o.exr"),
    };
    for (int i = 0; i < 3; i++) {
        float most = 0;
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++) {
                const float *at = images[i].pixels + 4 * (y * WIDTH + x);
                double longitude = (0.5 - (x + 0.5) / WIDTH) * 2 * 3.14159265358979,
                       latitude = (0.5 - (y + 0.5) / HEIGHT) * 3.14159265358979;
                double d[3] = {sin(longitude) * cos(latitude), sin(latitude),
                               cos(longitude) * cos(latitude)};
                for (int c = 0; c < 3; c++)
                    most = fmaxf(most, fabsf(at[c] - (float)(0.5 + 0.5 * d[c])));
                CHECK(at[3] == 1);
            }
        CHECK_MSG(most < 0.01f, "picture %d: %g", i, (double)most);
        slv_image_free(&images[i]);
    }
    slv_image whole = draw(ARGUMENTS("render", ptx, "--latlong", "-q", "-o", "p.exr"), "p.exr");
    CHECK(whole.width == 512 && whole.height == 256);
    slv_image_free(&whole);
    static const char *const refused[][2] = {
        {"--azimuth", "3"}, {"--shading", "unlit"}, {"--tess", "4"}, {"--pass", "ids"}};
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        kit_selvage(&scratch, NULL, ARGUMENTS("render", MAP, "q.png", refused[i][0], refused[i][1]),
                    &run);
        CHECK_MSG(run.code == 2 && strstr(run.err, "--latlong"), "%s: %d: %s", refused[i][0],
                  run.code, run.err);
    }
}

int main(void) {
    uint64_t random = 8;
    for (int i = 0; i < 8; i++)
        check_cube(i % 2, &random);
    check_others(&random);
    kit_scratch_make(&scratch);
    check_picture();
    check_map();
    test_remove(scratch.root);
    return test_end();
}
