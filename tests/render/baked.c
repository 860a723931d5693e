/* Spot, baked by the command as it comes, drawn by borders and with the image that it was baked
 * from: from all around, in several sizes. Needs SELVAGE_SAMPLES. */
#include "kit/command_kit.h"

#include <selvage/image.h>

#include <math.h>
#include <stdlib.h>

static kit_scratch scratch;
static kit_run run;

#define RUN(...)                                                                                   \
    do {                                                                                           \
        kit_selvage(&scratch, NULL, (const char *const[]){__VA_ARGS__, NULL}, &run);               \
        REQUIRE_MSG(run.code == 0, "%d: %s", run.code, run.err);                                   \
    } while (0)
#define REQUIRE_MSG(condition, ...)                                                                \
    do {                                                                                           \
        CHECK_MSG(condition, __VA_ARGS__);                                                         \
        REQUIRE(condition);                                                                        \
    } while (0)

static slv_image load(const char *name) {
    char path[KIT_PATH];
    slv_image image = {0};
    REQUIRE(slv_image_load(NULL, kit_join(path, scratch.folder, name), &image) == SLV_OK);
    return image;
}

/* Of pixels that the surface covers in full, as they are stored. */
static double decibels(const char *name, const char *other) {
    slv_image a = load(name), b = load(other);
    double sum = 0;
    uint64_t count = 0;
    REQUIRE(a.nchannels == 4 && b.nchannels == 4 && a.width == b.width && a.height == b.height);
    for (size_t i = 0; i < (size_t)a.width * a.height; i++) {
        const float *p = a.pixels + 4 * i, *q = b.pixels + 4 * i;
        if (p[3] < 0.999f || q[3] < 0.999f)
            continue;
        count++;
        for (int c = 0; c < 3; c++)
            sum += ((double)p[c] - (double)q[c]) * ((double)p[c] - (double)q[c]);
    }
    REQUIRE(count > (size_t)a.width * a.height / 10);
    slv_image_free(&a);
    slv_image_free(&b);
    return -10 * log10(sum / (3 * (double)count));
}

static void look(const char *mesh, const char *image, const char *size, int azimuth,
                 const char *aniso) {
    char turned[16];
    snprintf(turned, sizeof turned, "%d", azimuth);
    RUN("render", "spot.ptx", "-m", mesh, "-s", "borders", "--size", size, "--azimuth", turned,
        "--aniso", aniso, "--shading", "unlit", "-q", "-o", "baked.png");
    RUN("render", mesh, "--uv", image, "--size", size, "--azimuth", turned, "--aniso", aniso,
        "--shading", "unlit", "-q", "-o", "direct.png");
    double is = decibels("baked.png", "direct.png");
    CHECK_MSG(is >= 34, "%s, azimuth %d, %sx: %.2f dB", size, azimuth, aniso, is);
}

int main(void) {
    static const char *const sizes[] = {"384", "512", "768"};
    const char *samples = getenv("SELVAGE_SAMPLES");
    char mesh[KIT_PATH], image[KIT_PATH];
    uint32_t turn = 0;
    if (!samples || !*samples)
        return 77; /* skipped */
    kit_scratch_make(&scratch);
    kit_join(mesh, samples, "spot/spot_control_mesh.obj");
    kit_join(image, samples, "spot/spot_texture.png");
    RUN("bake", mesh, "--uv", image, "-q", "-o", "spot.ptx");
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
        for (int azimuth = 0; azimuth < 360; azimuth += 45)
            for (int aniso = 0; aniso < 2; aniso++)
                if (!test_skip(turn++, 11))
                    look(mesh, image, sizes[s], azimuth, aniso ? "16" : "1");
    test_remove(scratch.root);
    return test_end();
}
