/* Which face a place in a picture shows, where that can be told by hand: a flat grid seen from
 * above; and the same of a whole picture. */
#include "kit/bake_kit.h"
#include "kit/command_kit.h"

#include <selvage/camera.h>
#include <selvage/image.h>

#include <jansson.h>

enum { SIDE = 3, TEXELS = 8, PIXELS = 100, IDS_BACK = 0xB382C9 };

static kit_scratch scratch;
static kit_run run;
static char grid[KIT_PATH];

#define ARGUMENTS(...) ((const char *const[]){__VA_ARGS__, NULL})
#define FROM_ABOVE                                                                                 \
    "--scheme", "bilinear", "--size", "100", "--azimuth", "0", "--elevation", "90", "--fov", "0"

/* Where the middle of a pixel meets the grid: its face, or -1, and u and v there. */
static int expect(int x, int y, double uv[2]) {
    const float low[3] = {0, 0, 0}, high[3] = {SIDE, 0, SIDE};
    const slv_camera camera = slv_camera_orbit(low, high, 0, 90, 0, 1);
    const double size = (double)(camera.window[1] - camera.window[0]) / PIXELS;
    double right = SIDE / 2.0 + size * (x + 0.5 - PIXELS / 2),
           down = SIDE / 2.0 + size * (y + 0.5 - PIXELS / 2);
    if (right < 0 || right >= SIDE || down < 0 || down >= SIDE)
        return -1;
    uv[0] = down - floor(down);
    uv[1] = right - floor(right);
    return (int)down * SIDE + (int)right;
}

static void check_pick(int x, int y) {
    char words[2][16];
    double uv[2] = {0, 0};
    json_error_t error;
    int face = expect(x, y, uv);
    snprintf(words[0], sizeof words[0], "%d", x);
    snprintf(words[1], sizeof words[1], "%d", y);
    kit_selvage(&scratch, NULL, ARGUMENTS("pick", grid, words[0], words[1], FROM_ABOVE, "--json"),
                &run);
    json_t *root = json_loads(run.out, 0, &error);
    REQUIRE(root);
    if (face < 0) {
        CHECK_MSG(run.code == 1 && strstr(run.err, "nothing of the surface"), "%d: %s", run.code,
                  run.err);
        CHECK(json_is_null(json_object_get(root, "face")));
    } else {
        double u = json_number_value(json_object_get(root, "u")),
               v = json_number_value(json_object_get(root, "v"));
        const json_t *texel = json_object_get(root, "texel");
        CHECK(run.code == 0 && json_integer_value(json_object_get(root, "face")) == face);
        CHECK_MSG(fabs(u - uv[0]) < 1e-4 && fabs(v - uv[1]) < 1e-4, "%d,%d: %g,%g, not %g,%g", x, y,
                  u, v, uv[0], uv[1]);
        CHECK(json_integer_value(json_array_get(texel, 0)) == (json_int_t)(u * TEXELS) &&
              json_integer_value(json_array_get(texel, 1)) == (json_int_t)(v * TEXELS));
        slv_ptx *ptx = NULL;
        uint8_t texels[TEXELS * TEXELS][3];
        REQUIRE(!slv_ptx_open(NULL, grid, &ptx) &&
                !slv_ptx_read_face(ptx, (uint32_t)face, (slv_res){3, 3}, texels));
        slv_ptx_close(ptx);
        const uint8_t *value = texels[(int)(v * TEXELS) * TEXELS + (int)(u * TEXELS)];
        for (size_t c = 0; c < 3; c++)
            CHECK(fabs(json_number_value(json_array_get(json_object_get(root, "value"), c)) -
                       value[c] / 255.0) < 1e-6);
    }
    json_decref(root);
}

static slv_image draw_ids(const char *name) {
    char path[KIT_PATH];
    slv_image image = {0};
    kit_selvage(&scratch, NULL,
                ARGUMENTS("render", grid, "--pass", "ids", "-q", FROM_ABOVE, "-o", name), &run);
    CHECK_MSG(run.code == 0 && !run.err[0], "%d: %s", run.code, run.err);
    REQUIRE(!slv_image_load(NULL, kit_join(path, scratch.folder, name), &image));
    REQUIRE(image.width == PIXELS && image.height == PIXELS);
    return image;
}

static void check_pass(void) {
    slv_image exr = draw_ids("ids.exr"), png = draw_ids("ids.png");
    REQUIRE(png.nchannels == 4);
    for (int i = 0; i < PIXELS * PIXELS; i++) {
        double uv[2];
        int face = expect(i % PIXELS, i / PIXELS, uv);
        const float *p = png.pixels + 4 * i;
        uint32_t code = 0;
        for (int c = 0; c < 3; c++)
            code |= (uint32_t)lroundf(p[c] * 255) << 8 * c;
        CHECK_MSG((int)exr.pixels[exr.nchannels * (uint32_t)i] == face, "pixel %d: %g, not %d", i,
                  (double)exr.pixels[exr.nchannels * (uint32_t)i], face);
        CHECK((int)(code * IDS_BACK & 0xFFFFFF) - 1 == face && p[3] == (face >= 0 ? 1 : 0));
    }
    slv_image_free(&exr);
    slv_image_free(&png);
}

int main(void) {
    kit_scratch_make(&scratch);
    bake_write_grid(kit_join(grid, scratch.root, "grid.ptx"), SIDE);
    for (int i = 0; i < 10; i++)
        check_pick((i * 37 + 11) % PIXELS, (i * 53 + 29) % PIXELS);
    check_pick(0, 0);
    kit_selvage(&scratch, NULL, ARGUMENTS("pick", grid, "101", "3", FROM_ABOVE), &run);
    CHECK(run.code == 2 && strstr(run.err, "0 to 100"));
    kit_selvage(&scratch, NULL, ARGUMENTS("pick", grid, "1"), &run);
    CHECK(run.code == 2 && strstr(run.err, "FILE.ptx X Y"));
    check_pass();
    test_remove(scratch.root);
    return test_end();
}
