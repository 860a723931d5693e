/* The command against pictures that somebody else made: RenderMan's of the published samples where
 * they are at hand, and ray-cast ones of a cube whose colour is its position everywhere. */
#include "kit/command_kit.h"

#include <selvage/gl_strategy.h>

#include <selvage/bake.h>
#include <selvage/image.h>
#include <selvage/ptx.h>

typedef struct score {
    double psnr;
    uint32_t pixels, alpha_differs;
} score;

static kit_scratch scratch;
static kit_run run;

/* Whether a pixel and all within two pixels of it are covered in full. */
static bool well_inside(const slv_image *image, uint32_t x, uint32_t y) {
    if (x < 2 || y < 2 || x + 2 >= image->width || y + 2 >= image->height)
        return false;
    for (uint32_t j = y - 2; j <= y + 2; j++)
        for (uint32_t i = x - 2; i <= x + 2; i++)
            if (image->pixels[((size_t)j * image->width + i) * 4 + 3] < 0.999f)
                return false;
    return true;
}

static score compare(const slv_image *reference, const slv_image *image) {
    score s = {0};
    double squares = 0;
    REQUIRE(image->width == reference->width && image->height == reference->height);
    REQUIRE(image->nchannels == 4 && reference->nchannels == 4);
    for (uint32_t y = 0; y < image->height; y++) {
        for (uint32_t x = 0; x < image->width; x++) {
            const float *a = reference->pixels + ((size_t)y * image->width + x) * 4;
            const float *b = image->pixels + ((size_t)y * image->width + x) * 4;
            s.alpha_differs += (a[3] >= 0.5f) != (b[3] >= 0.5f);
            if (!well_inside(reference, x, y))
                continue;
            s.pixels++;
            for (int c = 0; c < 3; c++)
                squares += (double)(a[c] - b[c]) * (double)(a[c] - b[c]);
        }
    }
    REQUIRE(s.pixels > 0);
    s.psnr = squares > 0 ? -10 * log10(squares / 3 / s.pixels) : INFINITY;
    return s;
}

typedef enum change { MIRRORED_X, MIRRORED_Y, TRANSPOSED, CHANGES } change;

static slv_image changed(const slv_image *image, change how) {
    slv_image out;
    uint32_t last = image->width - 1;
    REQUIRE(image->width == image->height);
    REQUIRE(slv_image_create(NULL, image->width, image->height, 4, &out) == SLV_OK);
    for (uint32_t y = 0; y <= last; y++) {
        for (uint32_t x = 0; x <= last; x++) {
            uint32_t from_x = how == MIRRORED_X ? last - x : how == TRANSPOSED ? y : x;
            uint32_t from_y = how == MIRRORED_Y ? last - y : how == TRANSPOSED ? x : y;
            memcpy(out.pixels + ((size_t)y * image->width + x) * 4,
                   image->pixels + ((size_t)from_y * image->width + from_x) * 4, 4 * sizeof(float));
        }
    }
    return out;
}

/* A score that cannot tell left from right says nothing. */
static void check_score_sees(const char *name, const slv_image *reference, const slv_image *image,
                             double right) {
    for (int how = 0; how < CHANGES; how++) {
        slv_image other = changed(image, (change)how);
        score wrong = compare(reference, &other);
        CHECK_MSG(wrong.psnr < right - 10,
                  "%s: a wrong picture (%d) scores %.1f dB, the right one %.1f", name, how,
                  wrong.psnr, right);
        slv_image_free(&other);
    }
}

static slv_image render(const char *ptx, const char *mesh, const char *view, const char *strategy,
                        const char *scheme) {
    slv_env env = test_env();
    slv_image image = {0};
    char out[KIT_PATH];
    kit_join(out, scratch.folder, "picture.png");
    const char *arguments[] = {"render", ptx,          "--mesh", mesh,
                               "--view", view,         "--raw",  "-o",
                               out,      "--strategy", strategy, scheme ? "--scheme" : NULL,
                               scheme,   NULL};
    kit_selvage(&scratch, NULL, arguments, &run);
    CHECK_MSG(run.code == 0, "%s %s: exit code %d: %s", ptx, strategy, run.code, run.err);
    REQUIRE(run.code == 0 && kit_lines(run.err) == 0);
    REQUIRE(slv_image_load(&env, out, &image) == SLV_OK);
    unlink(out);
    return image;
}

/* RenderMan took the texels for light, as they stand. */
static slv_image cast_rays(const char *ptx, const char *mesh, const char *view) {
    slv_image image = {0};
    char out[KIT_PATH];
    kit_join(out, scratch.folder, "picture.exr");
    const char *arguments[] = {
        "reference", ptx,  "--mesh", mesh, "--view",    view, "--texture-encoding",
        "linear",    "-o", out,      "-q", "--samples", "64", "--filter",
        "mitchell",  NULL};
    kit_selvage(&scratch, NULL, arguments, &run);
    REQUIRE(run.code == 0 && kit_lines(run.err) == 0);
    REQUIRE(slv_image_load(NULL, out, &image) == SLV_OK);
    unlink(out);
    return image;
}

/* How near pictures are at least, in dB. RenderMan's picture of nonquad is softer than the integral
 * of its small texels: blurred by 0.7 pixels the ray-cast one, which has nothing of a strategy in
 * it, is at 49.7 dB, with the box filter. */
typedef struct sample {
    const char *name;
    double least, ray_cast;
    struct {
        const char *strategy;
        double least;
    } others[3]; /* strategies that differ */
    uint32_t most_alpha;
} sample;

/* A short run has the advised strategies, and one that is another kind. */
static bool left_out(uint32_t strategy) {
    return test_brief() && strategy > 2 && strategy + 1 < slv_strategy_count();
}

static void check_picture(const sample *s, const char *drawn, double least,
                          const slv_image *reference, slv_image image) {
    score right = compare(reference, &image);
    fprintf(stderr, "%s %s: %.2f dB over %u pixels, %u differ in alpha\n", s->name, drawn,
            right.psnr, right.pixels, right.alpha_differs);
    CHECK(right.pixels > 20000);
    CHECK_MSG(right.psnr >= least, "%s %s: %.2f dB, expected %.0f", s->name, drawn, right.psnr,
              least);
    CHECK_MSG(right.alpha_differs <= s->most_alpha, "%s %s: %u pixels differ in alpha", s->name,
              drawn, right.alpha_differs);
    check_score_sees(s->name, reference, &image, right.psnr);
    slv_image_free(&image);
}

static void check_sample(const char *samples, const sample *s) {
    slv_env env = test_env();
    slv_image reference = {0};
    char folder[KIT_PATH], path[4][KIT_PATH], file[64];
    kit_join(folder, samples, s->name);
    kit_join(path[0], folder, "renderman.png");
    snprintf(file, sizeof file, "%s.ptx", s->name);
    kit_join(path[1], folder, file);
    snprintf(file, sizeof file, "%s.obj", s->name);
    kit_join(path[2], folder, file);
    kit_join(path[3], folder, "view.json");
    REQUIRE(slv_image_load(&env, path[0], &reference) == SLV_OK);
    for (uint32_t k = 0; k < slv_strategy_count(); k++) {
        const char *strategy = slv_strategy_at(k)->name;
        if (left_out(k))
            continue;
        double least = s->least;
        for (size_t i = 0; i < sizeof s->others / sizeof *s->others; i++)
            if (s->others[i].strategy && strcmp(s->others[i].strategy, strategy) == 0)
                least = s->others[i].least;
        check_picture(s, strategy, least, &reference,
                      render(path[1], path[2], path[3], strategy, NULL));
    }
    check_picture(s, "ray-cast", s->ray_cast, &reference, cast_rays(path[1], path[2], path[3]));
    slv_image_free(&reference);
}

/* The teapot moved by its own texture, as rays have it: RenderMan's picture of such a one is not at
 * hand. */
static void check_displaced(const char *samples) {
    char folder[KIT_PATH], ptx[KIT_PATH], mesh[KIT_PATH], path[KIT_PATH], view[KIT_PATH],
        text[2 * KIT_PATH];
    size_t length = 0;
    kit_join(folder, samples, "teapot");
    kit_join(ptx, folder, "teapot.ptx");
    kit_join(mesh, folder, "teapot.obj");
    char *file = kit_read(kit_join(path, folder, "view.json"), &length), *end;
    REQUIRE(file && (end = memchr(file, '{', length)));
    int size = snprintf(text, sizeof text,
                        "{\"displacement\": {\"texture\": \"%s\", \"channel\": 0, \"scale\": "
                        "0.02, \"bias\": 0, \"filter\": \"bspline\", \"lerp\": true}, %.*s",
                        ptx, (int)(file + length - end - 1), end + 1);
    REQUIRE(size < (int)sizeof text);
    kit_write(kit_join(view, scratch.root, "displaced.json"), text, (size_t)size);
    free(file);
    slv_image rays = cast_rays(ptx, mesh, view);
    static const char *const strategies[] = {"borders", "traverse"};
    for (int i = 0; i < 2; i++) {
        slv_image drawn = render(ptx, mesh, view, strategies[i], NULL);
        score right = compare(&rays, &drawn);
        fprintf(stderr, "displaced teapot %s: %.2f dB over %u pixels\n", strategies[i], right.psnr,
                right.pixels);
        CHECK_MSG(right.psnr >= 45, "displaced teapot %s: %.2f dB", strategies[i], right.psnr);
        slv_image_free(&drawn);
    }
    slv_image_free(&rays);
}

/* The eye's orthonormal frame, rows as in the view file. */
static const float eye[3][3] = {{0.8f, 0, -0.6f}, {-0.36f, 0.8f, -0.48f}, {0.48f, 0.6f, 0.64f}};
static const float window = 2;

static const char cube_obj[] =
    "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
    "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

static void make_cube(const char *obj, const char *ptx, const char *view) {
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    slv_texture *texture = NULL;
    slv_surface_params bilinear = {.scheme = SLV_SCHEME_BILINEAR};
    const slv_res res[6] = {{6, 6}, {6, 6}, {6, 6}, {6, 6}, {6, 6}, {6, 6}};
    slv_texture_desc desc = {6, SLV_TYPE_U16, 3, SLV_NO_ALPHA, res, SLV_TEXTURE_LINEAR};
    slv_procedural position = {
        .pattern = SLV_PATTERN_POSITION, .frequency = 0.5f, .offset = {-1, -1, -1}};
    char text[1024];
    kit_write(obj, cube_obj, sizeof cube_obj - 1);
    REQUIRE(slv_mesh_load(&env, obj, &mesh) == SLV_OK);
    REQUIRE(slv_mesh_adjacency(&env, mesh, &adjacency) == SLV_OK);
    REQUIRE(slv_surface_create(&env, mesh, &bilinear, &surface) == SLV_OK);
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    REQUIRE(slv_bake_procedural(&env, surface, &position, NULL, texture) == SLV_OK);
    REQUIRE(slv_ptx_save(&env, ptx, texture, adjacency, NULL) == SLV_OK);
    int length =
        snprintf(text, sizeof text,
                 "{\"size\": [256, 256], \"projection\": \"orthographic\",\n"
                 " \"screen_window\": [-2, 2, -2, 2], \"shading\": {\"model\": \"unlit\"},\n"
                 " \"world_to_camera\": [[%g, %g, %g, 0], [%g, %g, %g, 0], [%g, %g, %g, -5], [0, "
                 "0, 0, 1]]}\n",
                 (double)eye[0][0], (double)eye[0][1], (double)eye[0][2], (double)eye[1][0],
                 (double)eye[1][1], (double)eye[1][2], (double)eye[2][0], (double)eye[2][1],
                 (double)eye[2][2]);
    kit_write(view, text, (size_t)length);
    slv_texture_destroy(texture);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
}

/* Where the ray of a pixel's centre meets the cube; false if it misses. */
static bool cast(uint32_t x, uint32_t y, uint32_t size, float hit[3]) {
    float across = (((float)x + 0.5f) / (float)size * 2 - 1) * window;
    float up = (1 - ((float)y + 0.5f) / (float)size * 2) * window;
    float nearest = -INFINITY, farthest = INFINITY, origin[3];
    for (int c = 0; c < 3; c++) {
        origin[c] = across * eye[0][c] + up * eye[1][c];
        float a = (-1 - origin[c]) / eye[2][c], b = (1 - origin[c]) / eye[2][c];
        nearest = fmaxf(nearest, fminf(a, b));
        farthest = fminf(farthest, fmaxf(a, b));
    }
    /* the eye is far along its own +z, so the face that it sees is the one with the largest
     * parameter */
    for (int c = 0; c < 3; c++)
        hit[c] = origin[c] + farthest * eye[2][c];
    return farthest > nearest;
}

static void check_cube(void) {
    char obj[KIT_PATH], ptx[KIT_PATH], view[KIT_PATH];
    kit_join(obj, scratch.root, "cube.obj");
    kit_join(ptx, scratch.root, "cube.ptx");
    kit_join(view, scratch.root, "view.json");
    make_cube(obj, ptx, view);
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        const char *strategy = slv_strategy_at(s)->name;
        if (left_out(s))
            continue;
        slv_image image = render(ptx, obj, view, strategy, "bilinear"), expected;
        float largest = 0;
        double sum = 0;
        uint32_t count = 0;
        REQUIRE(slv_image_create(NULL, 256, 256, 4, &expected) == SLV_OK);
        for (uint32_t y = 0; y < 256; y++) {
            for (uint32_t x = 0; x < 256; x++) {
                float *pixel = expected.pixels + ((size_t)y * 256 + x) * 4, hit[3];
                if (!cast(x, y, 256, hit))
                    continue;
                for (int c = 0; c < 3; c++)
                    pixel[c] = (hit[c] + 1) / 2;
                pixel[3] = 1;
            }
        }
        for (uint32_t y = 0; y < 256; y++) {
            for (uint32_t x = 0; x < 256; x++) {
                size_t at = ((size_t)y * 256 + x) * 4;
                if (!well_inside(&expected, x, y))
                    continue;
                for (int c = 0; c < 3; c++) {
                    float difference =
                        fabsf(expected.pixels[at + (size_t)c] - image.pixels[at + (size_t)c]);
                    largest = fmaxf(largest, difference);
                    sum += (double)difference;
                }
                count += 3;
            }
        }
        score right = compare(&expected, &image);
        fprintf(stderr, "cube %s: largest error %.2f/255, mean %.3f/255, %.1f dB\n", strategy,
                (double)largest * 255, sum / count * 255, right.psnr);
        /* half a texel is 2/255 here, and beside an edge no lookup is nearer than that to the edge
         * itself */
        CHECK_MSG(largest < 2.5f / 255, "cube %s: off by %g/255", strategy, (double)largest * 255);
        CHECK_MSG(sum / count < 0.5 / 255, "cube %s: off by %g/255 on average", strategy,
                  sum / count * 255);
        CHECK_MSG(right.alpha_differs < 60, "cube %s: %u pixels differ in alpha", strategy,
                  right.alpha_differs);
        check_score_sees("cube", &expected, &image, right.psnr);
        slv_image_free(&image);
        slv_image_free(&expected);
    }
}

int main(void) {
    const char *samples = getenv("SELVAGE_SAMPLES");
    static const sample all[] = {
        {"teapot", 42, 48, {{"clamp", 40}, {"discard", 40}, {"hybrid", 40}}, 2000},
        {"nonquad", 40, 40, {{"clamp", 37}, {"discard", 37}, {"hybrid", 37}}, 1000},
        /* texels of some hundred pixels, of which edge-aligned lookups see means */
        {"triangle", 50, 50, {{"clamp", 45}, {"discard", 45}, {"edge-aligned", 47}}, 1000}};
    kit_scratch_make(&scratch);
    check_cube();
    if (samples && *samples) {
        for (size_t i = 0; i < sizeof all / sizeof *all; i++)
            check_sample(samples, &all[i]);
        if (!test_brief())
            check_displaced(samples);
    } else {
        fprintf(stderr, "SELVAGE_SAMPLES is not set: the published samples were not compared\n");
    }
    test_remove(scratch.root);
    return test_end();
}
