/* Displaced surfaces as they are drawn: nothing shows through a closed one, rays see what OpenGL
 * draws, and the command takes displacements from options and view files. */
#include "kit/command_kit.h"
#include "kit/cube_kit.h"
#include "kit/displace_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_renderer.h>

enum { SIZE = 48 };

static kit_scratch scratch;
static kit_run run;

#define ARGUMENTS(...) ((const char *const[]){__VA_ARGS__, NULL})

/* A closed shape of two poles where `valence` quads meet each, three everywhere else. */
static shape trapezohedron(int32_t valence) {
    shape s = {0};
    int32_t ring = 2 * valence;
    shape_vertex(&s, 0, 0, 1.6f);
    shape_vertex(&s, 0, 0, -1.6f);
    for (int32_t i = 0; i < ring; i++) {
        float a = 6.2831853f * (float)i / (float)ring;
        shape_vertex(&s, 1.5f * cosf(a), 1.5f * sinf(a), i & 1 ? -0.4f : 0.4f);
    }
    for (int32_t i = 0; i < ring; i += 2) {
        const int32_t r[4] = {2 + i, 2 + (i + 1) % ring, 2 + (i + 2) % ring, 2 + (i + 3) % ring};
        shape_polygon(&s, 4, (const int32_t[]){0, r[0], r[1], r[2]});
        shape_polygon(&s, 4, (const int32_t[]){1, r[3], r[2], r[1]});
    }
    return s;
}

static float unit(uint64_t *random) {
    return (float)(test_random(random) % 20001) / 10000 - 1;
}

/* An eye near the middle that looks anywhere. */
static slv_camera inside(uint64_t *random) {
    slv_camera camera = {.perspective = true};
    float q[4], length = 0, eye[3];
    do {
        length = 0;
        for (int k = 0; k < 4; k++) {
            q[k] = unit(random);
            length += q[k] * q[k];
        }
    } while (length > 1 || length < 0.01f);
    for (int k = 0; k < 4; k++)
        q[k] /= sqrtf(length);
    for (int k = 0; k < 3; k++)
        eye[k] = 0.3f * unit(random);
    const float x = q[0], y = q[1], z = q[2], w = q[3];
    const float turn[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                              {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                              {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
    for (int r = 0; r < 3; r++) {
        float *row = camera.world_to_camera + 4 * r;
        memcpy(row, turn[r], sizeof turn[r]);
        row[3] = -(row[0] * eye[0] + row[1] * eye[1] + row[2] * eye[2]);
    }
    camera.world_to_camera[15] = 1;
    for (int side = 0; side < 4; side++)
        camera.window[side] = (side & 1 ? 1 : -1) * (1.05f + unit(random));
    return camera;
}

/* Every pixel that an eye inside sees is covered in full. */
static void check_nothing_shows(slv_gl *gl, const displaced *d,
                                const slv_tessellation_params *given, int number,
                                uint64_t *random) {
    slv_env env = test_env();
    const slv_strategy *clamp = kit_strategy("clamp");
    const slv_gl_texture_params upload = {.strategies = &clamp, .nstrategies = 1};
    slv_gl_texture *texture = NULL;
    slv_gl_renderer *renderer = NULL;
    slv_tessellation_params params = *given;
    MUST(slv_gl_texture_create(gl, &env, d->texture, d->adjacency, &upload, &texture));
    for (uint32_t i = 0; i < 4; i++) {
        const slv_frame frame = {
            .camera = inside(random), .width = SIZE, .height = SIZE, .msaa = 4};
        slv_image image = {0};
        uint32_t shown = 0;
        params.camera = &frame.camera;
        params.width = params.height = SIZE;
        if (!renderer)
            MUST(slv_gl_renderer_create_with(gl, &env, d->mesh, d->surface, &params, &renderer));
        else if (!given->segments) /* what is seen says how it is divided */
            MUST(slv_gl_renderer_tessellate(renderer, &env, d->mesh, d->surface, &params));
        MUST(slv_gl_renderer_draw(renderer, &env, texture, &frame, &image, NULL));
        for (size_t k = 0; k < SIZE * SIZE; k++)
            shown += image.pixels[4 * k + 3] < 1;
        CHECK_MSG(shown == 0, "shape %d: background in %u pixels", number, shown);
        slv_image_free(&image);
    }
    slv_gl_renderer_destroy(renderer);
    slv_gl_texture_destroy(texture);
}

/* 32 cameras, or 1,000 with SELVAGE_TEST_EFFORT=32. */
static void check_closed(slv_gl *gl) {
    uint64_t random = 11;
    for (uint32_t i = 0; i < test_effort(8); i++) {
        const slv_displacement_params params = {.space = (slv_displacement_space)(i % 3),
                                                .scale = 0.15f};
        /* every other one face by face */
        const slv_tessellation_params even = {.segments = i & 1 ? 0 : 2u << i / 2 % 4};
        shape s = trapezohedron(3 + (int32_t)(i % 6));
        shape_cut(&s, &random, i % 3 * 2, 0);
        shape_rotate_polygons(&s, &random);
        displaced d =
            displaced_make(shape_mesh(NULL, &s), (slv_scheme)(i / 2 % 2), 4, &params, &random);
        slv_tessellation_params chosen = even;
        chosen.displacement = &d.displacement;
        check_nothing_shows(gl, &d, &chosen, (int)i, &random);
        shape_clear(&s);
        displaced_free(&d);
    }
}

static double psnr(const slv_image *a, const slv_image *b) {
    double squares = 0;
    for (size_t i = 0; i < (size_t)4 * a->width * a->height; i++)
        squares += (double)(a->pixels[i] - b->pixels[i]) * (double)(a->pixels[i] - b->pixels[i]);
    return -10 * log10(squares / (4.0 * a->width * a->height));
}

static slv_image load(const char *name) {
    char path[KIT_PATH];
    slv_image image = {0};
    REQUIRE(slv_image_load(NULL, kit_join(path, scratch.folder, name), &image) == SLV_OK);
    return image;
}

static slv_image draw(const char *const *arguments, const char *name) {
    kit_selvage(&scratch, NULL, arguments, &run);
    CHECK_MSG(run.code == 0 && !run.err[0], "exit code %d: %s", run.code, run.err);
    REQUIRE(run.code == 0);
    return load(name);
}

#define DISPLACED "--tess", "16", "--displacement", ptx, "--displacement-scale", "0.5"

/* A picture by OpenGL, one by rays, and one of what was not displaced; in grey, which is the same
 * light everywhere. */
static void check_rays(const char *ptx) {
    slv_image gl = draw(ARGUMENTS("render", ptx, "--size", "64", "--msaa", "4", "--shading",
                                  "headlight-cos2", DISPLACED, "--bits", "32", "-o", "gl.exr"),
                        "gl.exr");
    slv_image rays = draw(ARGUMENTS("reference", ptx, "--size", "64", "--samples", "64",
                                    "--shading", "headlight-cos2", DISPLACED, "-q", "-o", "r.exr"),
                          "r.exr");
    slv_image flat = draw(ARGUMENTS("reference", ptx, "--size", "64", "--samples", "64",
                                    "--shading", "headlight-cos2", "-q", "-o", "f.exr"),
                          "f.exr");
    CHECK_MSG(psnr(&gl, &rays) > 30, "rays see something else: %.1f dB", psnr(&gl, &rays));
    CHECK_MSG(psnr(&flat, &rays) < 20, "nothing is displaced: %.1f dB", psnr(&flat, &rays));
    slv_image_free(&gl);
    slv_image_free(&rays);
    slv_image_free(&flat);
}

/* Of pixels that the surface covers, with all those around them. */
static double psnr_inside(const slv_image *a, const slv_image *b) {
    double squares = 0, count = 0;
    for (uint32_t y = 2; y + 2 < a->height; y++)
        for (uint32_t x = 2; x + 2 < a->width; x++) {
            const size_t at = (size_t)y * a->width + x, row = a->width;
            const size_t around[] = {at, at - 2, at + 2, at - 2 * row, at + 2 * row};
            bool inside = true;
            for (int i = 0; i < 5; i++)
                inside &= b->pixels[4 * around[i] + 3] > 0.999f;
            for (size_t c = 0; c < 3 && inside; c++, count++)
                squares += (double)(a->pixels[4 * at + c] - b->pixels[4 * at + c]) *
                           (double)(a->pixels[4 * at + c] - b->pixels[4 * at + c]);
        }
    return -10 * log10(squares / count);
}

/* Triangles smaller than a pixel, of a bumpy surface: each sample that one covers sees its light
 * and not what lies beyond it. */
static void check_small(void) {
    static const char obj[] =
        "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
        "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
    const slv_res res[6] = {{5, 5}, {5, 5}, {5, 5}, {5, 5}, {5, 5}, {5, 5}};
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE, .frequency = 3, .octaves = 3};
    char ptx[KIT_PATH];
    bake_write(kit_join(ptx, scratch.root, "bumps.ptx"), obj, SLV_SCHEME_CATMARK, 6, res, &noise);
#define BUMPY                                                                                      \
    "--size", "64", "--shading", "headlight-cos2", "--displacement", ptx, "--displacement-scale",  \
        "0.5"
    slv_image gl = draw(
        ARGUMENTS("render", ptx, BUMPY, "--msaa", "4", "--bits", "32", "-o", "gl.exr"), "gl.exr");
    slv_image rays =
        draw(ARGUMENTS("reference", ptx, BUMPY, "--samples", "64", "-q", "-o", "r.exr"), "r.exr");
    CHECK_MSG(psnr_inside(&gl, &rays) > 40.5, "small triangles: %.2f dB", psnr_inside(&gl, &rays));
    slv_image_free(&gl);
    slv_image_free(&rays);
}

/* Two triangles, moved by their own texture, as OpenGL and rays have them. */
static void check_triangles(void) {
    static const char obj[] = "v 0 0 0\nv 1 0 0\nv 1 1 0.3\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
    char mesh[KIT_PATH], ptx[KIT_PATH];
    kit_write(kit_join(mesh, scratch.root, "two.obj"), obj, sizeof obj - 1);
    kit_join(ptx, kit_variable("SELVAGE_TESTS"), "conformance/data/tri_tiled_u8_1.ptx");
#define TRIANGLES "-m", mesh, "--size", "64", "--shading", "headlight-cos2", "--channels", "r"
    slv_image gl = draw(ARGUMENTS("render", ptx, TRIANGLES, DISPLACED, "-o", "gl.exr"), "gl.exr");
    slv_image rays =
        draw(ARGUMENTS("reference", ptx, TRIANGLES, DISPLACED, "-q", "-o", "r.exr"), "r.exr");
    slv_image flat = draw(ARGUMENTS("reference", ptx, TRIANGLES, "-q", "-o", "f.exr"), "f.exr");
    CHECK_MSG(psnr(&gl, &rays) > 30, "triangles: rays see something else: %.1f dB",
              psnr(&gl, &rays));
    CHECK_MSG(psnr(&flat, &rays) < 20, "no triangle is displaced: %.1f dB", psnr(&flat, &rays));
    slv_image_free(&gl);
    slv_image_free(&rays);
    slv_image_free(&flat);
    /* the same where they do not meet: by the neighbours that are asked for */
    static const char apart[] =
        "v 0 0 0\nv 1 0 0\nv 1 1 0.3\nv 0 1 0\nv 0 0 0\nv 1 1 0.3\nf 1 2 3\nf 5 6 4\n";
    kit_write(mesh, apart, sizeof apart - 1);
    kit_selvage(&scratch, NULL, ARGUMENTS("render", ptx, TRIANGLES, DISPLACED, "-o", "no.exr"),
                &run);
    CHECK_MSG(run.code == 1 && strstr(run.err, "does not fit the mesh"), "%s", run.err);
    gl = draw(ARGUMENTS("render", ptx, TRIANGLES, DISPLACED, "--adjacency", "mesh", "m.exr"),
              "m.exr");
    flat = draw(ARGUMENTS("render", ptx, TRIANGLES, DISPLACED, "--adjacency", "ptx", "p.exr"),
                "p.exr");
    CHECK_MSG(psnr(&gl, &flat) < 40, "neighbours say nothing: %.1f dB", psnr(&gl, &flat));
    slv_image_free(&gl);
    slv_image_free(&flat);
}

#define SMALL "render", ptx, "--size", "32", "--msaa", "1", "--tess", "4"

static bool same(const slv_image *a, const slv_image *b) {
    return memcmp(a->pixels, b->pixels, sizeof(float) * 4 * a->width * a->height) == 0;
}

/* A view file names a file beside itself, and options come first. */
static void check_views(const char *ptx) {
    static const char text[] = "{\"displacement\": {\"texture\": \"cube.ptx\", \"channel\": 1, "
                               "\"scale\": 0.3, \"bias\": -0.5, \"filter\": \"bilinear\", "
                               "\"lerp\": true}}";
    char view[KIT_PATH];
    kit_write(kit_join(view, scratch.root, "displaced.json"), text, sizeof text - 1);
    slv_image options = draw(ARGUMENTS(SMALL, "--displacement", ptx, "--displacement-channel", "g",
                                       "--displacement-scale", "0.3", "--displacement-bias", "-0.5",
                                       "--displacement-filter", "bilinear", "a.exr"),
                             "a.exr");
    slv_image own = draw(ARGUMENTS(SMALL, "--displacement-channel", "1", "--displacement-scale",
                                   "0.3", "--displacement-offset", "-0.5", "--displacement-filter",
                                   "bilinear", "b.exr"),
                         "b.exr");
    slv_image file = draw(ARGUMENTS(SMALL, "--view", view, "c.exr"), "c.exr");
    slv_image scaled =
        draw(ARGUMENTS(SMALL, "--view", view, "--displacement-scale", "0.5", "d.exr"), "d.exr");
    slv_image off =
        draw(ARGUMENTS(SMALL, "--view", view, "--displacement-scale", "0", "e.exr"), "e.exr");
    slv_image none = draw(ARGUMENTS(SMALL, "f.exr"), "f.exr");
    CHECK(same(&options, &file) && same(&own, &file));
    CHECK(!same(&scaled, &file) && !same(&none, &file) && same(&off, &none));
    slv_image *all[] = {&options, &own, &file, &scaled, &off, &none};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        slv_image_free(all[i]);
}

/* The view's channel is of the view's file: another file's is the first, unless it is named. */
static void check_other_file(const char *ptx) {
    static const char text[] = "{\"displacement\": {\"texture\": \"steps.ptx\", \"channel\": 1}}";
    char view[KIT_PATH], steps[KIT_PATH], mesh[KIT_PATH];
    kit_write(kit_join(view, scratch.root, "steps.json"), text, sizeof text - 1);
    kit_join(steps, scratch.root, "steps.ptx");
    kit_write(kit_join(mesh, scratch.root, "cube.obj"), cube_obj, sizeof cube_obj - 1);
    kit_selvage(&scratch, NULL,
                ARGUMENTS("new", mesh, "-o", steps, "--channels", "3", "--fill", "0.2,0.8,0.5",
                          "--size", "1x1"),
                &run);
    REQUIRE(run.code == 0);
    slv_image second = draw(ARGUMENTS(SMALL, "--view", view, "a.exr"), "a.exr");
    slv_image other =
        draw(ARGUMENTS(SMALL, "--view", view, "--displacement", steps, "b.exr"), "b.exr");
    slv_image first = draw(ARGUMENTS(SMALL, "--displacement", steps, "c.exr"), "c.exr");
    slv_image named = draw(ARGUMENTS(SMALL, "--view", view, "--displacement", steps,
                                     "--displacement-channel", "g", "d.exr"),
                           "d.exr");
    CHECK(same(&other, &first) && same(&named, &second) && !same(&first, &second));
    slv_image *all[] = {&second, &other, &first, &named};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        slv_image_free(all[i]);
}

static void check_refused(const char *const *arguments, int code, const char *text) {
    kit_selvage(&scratch, NULL, arguments, &run);
    CHECK_MSG(run.code == code && strstr(run.err, text) && kit_lines(run.err) == 1,
              "exit code %d, no '%s' in: %s", run.code, text, run.err);
}

static void check_bad(const char *ptx) {
    static const struct {
        const char *view, *text;
    } views[] = {{"{\"displacement\": 3}", "displacement is not an object"},
                 {"{\"displacement\": {}}", "texture is not the name of a file"},
                 {"{\"displacement\": {\"texture\": \"none.ptx\"}}", "none.ptx"},
                 {"{\"displacement\": {\"texture\": \"cube.ptx\", \"scale\": \"x\"}}", "scale"},
                 {"{\"displacement\": {\"texture\": \"cube.ptx\", \"filter\": \"bsplin\"}}",
                  "did you mean 'bspline'"},
                 {"{\"displacement\": {\"texture\": \"cube.ptx\", \"lerp\": 1}}", "lerp"},
                 {"{\"displacement\": {\"texture\": \"cube.ptx\", \"space\": \"world\"}}", "space"},
                 {"{\"displacement\": {\"texture\": \"cube.ptx\", \"channel\": []}}", "channel"}};
    char path[KIT_PATH];
    kit_join(path, scratch.root, "bad.json");
    for (size_t i = 0; i < sizeof views / sizeof *views; i++) {
        kit_write(path, views[i].view, strlen(views[i].view));
        check_refused(ARGUMENTS(SMALL, "--view", path, "x.png"), 1, views[i].text);
    }
    check_refused(ARGUMENTS(SMALL, "--displacement-scale", "2", "x.png"), 2, "--displacement FILE");
    check_refused(ARGUMENTS(SMALL, "--displacement", ptx, "--displacement-channel", "3", "x.png"),
                  2, "displaces from channel '3' on");
    check_refused(ARGUMENTS(SMALL, "--displacement", ptx, "--displacement-space", "object",
                            "--displacement-channel", "1", "x.png"),
                  2, "has not 3 there");
    /* as many faces with other neighbours */
    char apart[1024] = "";
    for (int v = 0; v < 12; v++)
        snprintf(apart + strlen(apart), sizeof apart - strlen(apart), "v %d %d 0\n", v % 4, v / 4);
    for (int f = 0; f < 6; f++) {
        const int a = 1 + f % 3 + f / 3 * 4;
        snprintf(apart + strlen(apart), sizeof apart - strlen(apart), "f %d %d %d %d\n", a, a + 1,
                 a + 5, a + 4);
    }
    const slv_res res[6] = {{0, 0}};
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE, .frequency = 2};
    bake_write(kit_join(path, scratch.root, "apart.ptx"), apart, SLV_SCHEME_BILINEAR, 6, res,
               &noise);
    check_refused(ARGUMENTS(SMALL, "--displacement", path, "x.png"), 1,
                  "apart.ptx does not fit the mesh");
    kit_join(path, kit_variable("SELVAGE_TESTS"), "conformance/data/tri_tiled_u8_1.ptx");
    check_refused(ARGUMENTS(SMALL, "--displacement", path, "x.png"), 1, "triangle-mesh texture");
}

int main(void) {
    slv_env env = test_env();
    slv_gl *gl = NULL;
    char ptx[KIT_PATH];
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    check_closed(gl);
    slv_gl_destroy(gl);
    kit_scratch_make(&scratch);
    cube_write(kit_join(ptx, scratch.root, "cube.ptx"));
    check_rays(ptx);
    check_small();
    check_triangles();
    check_views(ptx);
    check_other_file(ptx);
    check_bad(ptx);
    test_remove(scratch.root);
    return test_end();
}
