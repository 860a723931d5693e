/* selvage bake: what it writes, prints and refuses, and when it fails. */
#include "kit/tool_kit.h"

#include <selvage/image.h>

static const char quad[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                           "f 1/1 2/2 3/3 4/4\n";
static const char half[] = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 0 1 0\n"
                           "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 5/3 6/4\nf 2 3 4 5\n";
static const char bare[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
static const char flat[] = "v 0 0 0\nv 0 0 0\nv 0 0 0\nv 0 0 0\nvt .5 .5\n"
                           "f 1/1 2/1 3/1 4/1\n";

static const char three[] =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 0 0 -1\nv 1 0 -1\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\nf 1/1 2/2 6/3 5/4\nf 1/1 2/2 8/3 7/4\n";
static const char hole[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n"
                           "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\nf 2 5 6 3\n"
                           "t hole 1/0/0 1\n";
static const char nan_obj[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 nan\nvt 0 0\nf 1/1 2/1 3/1 4/1\n";
static const char far[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 1e30 0\nvt 0 1e30\n"
                          "f 1/1 2/2 3/1 4/2\n";

static const char huge[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1e38 0\nf 1 2 3 4\n";

/* a polygon that is at one of its vertices twice */
static const char twice[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\nf 1 2 3 4\n"
                            "f 2 5 2 6 3\n";

static void write_image(const char *name, uint32_t n, float last, uint32_t bits) {
    slv_env env = test_env();
    slv_image image;
    const slv_image_params params = {.encoding = SLV_ENCODE_RAW, .bits = bits};
    REQUIRE(!slv_image_create(&env, 16, 8, n, &image));
    for (uint32_t i = 0; i < 128; i++)
        for (uint32_t c = 0; c < n; c++)
            image.pixels[i * n + c] = c + 1 < n ? (float)(i % 16) / 15 : last;
    REQUIRE(!slv_image_save(&env, tool_path(name), &image, &params));
    slv_image_free(&image);
}

static void results(void) {
    RUNS(0, "bake quad.obj --uv rgb.png -o out.ptx");
    RUNS(0, "bake quad.obj --uv - -o piped.ptx <rgb.png");
    CHECK(same_bytes(tool_path("piped.ptx"), tool_path("out.ptx")));
    HAS("1 faces (0 constant), 3 channels of uint8, 128 texels");
    HAS("16x8 to 16x8");
    RUNS(0, "check out.ptx");
    RUNS(0, "info out.ptx --json");
    /* a face that is the image has its values */
    slv_env env = test_env();
    slv_ptx *ptx = tool_open("out.ptx");
    slv_texture *texture = NULL;
    REQUIRE(!slv_ptx_load_texture(&env, ptx, &texture));
    for (uint32_t x = 2; x < 14; x++) {
        float texel[3];
        slv_texture_fetch(texture, 0, x, 3, texel);
        CHECK_MSG(fabsf(texel[0] - (float)x / 15) < 0.02f && texel[2] == 1, "%u: %g", x,
                  (double)texel[0]);
    }
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
    RUNS(0, "bake quad.obj --uv rgb.png -o out.ptx --match 2 --json");
    HAS("\"texels\": 512");
    HAS("\"misses\"");
    RUNS(0, "bake quad.obj --uv rgb.png -o out.ptx --type half --json");
    HAS("\"encoding\": \"linear\"");
    RUNS(0, "bake quad.obj --uv wide.png -o out.ptx --json");
    HAS("\"type\": \"uint16\"");
    RUNS(0, "bake quad.obj --uv rgba.exr -o out.ptx --json --texture-encoding data");
    HAS("\"type\": \"half\"");
    HAS("\"encoding\": \"data\"");
    RUNS(0, "info out.ptx");
    HAS("data");
    RUNS(0, "bake quad.obj --uv rgb.png -o out.ptx --bytes 3k --json");
    HAS("\"texels\": 1024");
    RUNS(0, "bake flat.obj --uv rgb.png -o out.ptx --size 4 --quiet");
    /* edges of three faces, and a polygon that is a hole, which lacks nothing */
    RUNS(0, "bake three.obj --uv rgb.png -o out.ptx --size 4");
    RUNS(0, "bake hole.obj --uv rgb.png -o out.ptx --size 4");
    RUNS(1, "bake nan.obj --uv rgb.png -o none.ptx");
    HAS("nan.obj:4");
    RUNS(1, "bake far.obj --uv rgb.png -o none.ptx");
    HAS("texture coordinates");
    RUNS(0, "bake quad.obj --uv rgb.png --error 1/16 -o out.ptx --json");
    HAS("\"faces_over\": 0");
    RUNS(0, "bake bare.obj --pattern checker --frequency 3 --size 16 -o out.ptx");
    HAS("256 texels");
    /* a fault of the mesh that two parts of the job find is told once */
    RUNS(0, "bake twice.obj --pattern checker --density 4 -o out.ptx");
    HAS("no limit");
    CHECK(!strstr(strstr(tool_out, "no limit") + 1, "no limit"));
}

static void misses(void) {
    RUNS(1, "bake half.obj --uv rgb.png -o out.ptx --size 8");
    HAS("64 of 128 texels have no value (no-uv 64)");
    HAS("without a value: no-uv 64");
    RUNS(0, "check out.ptx");
    RUNS(0, "bake half.obj --uv rgb.png -o out.ptx --size 8 --max-miss 0.5 --miss-map map.ptx");
    RUNS(0, "check map.ptx");
    RUNS(1, "bake half.obj --uv rgb.png -o out.ptx --size 8 --max-miss 0.49 --json --quiet");
    HAS("\"no-uv\": 64");
    RUNS(1, "bake quad.obj --uv rgb.png --error 1/255 -o out.ptx");
    HAS("1 of 1 faces are not within 0.00392157 of the source");
    HAS("--max-over 0");
    RUNS(0, "check out.ptx");
    RUNS(0, "bake quad.obj --uv rgb.png --error 1/255 --max-over 1 -o out.ptx");
    RUNS(2, "bake quad.obj --uv rgb.png --max-over 1 -o none.ptx");
    RUNS(2, "bake quad.obj --uv rgb.png --error 1/255 --max-over 2 -o none.ptx");
    RUNS(1, "bake bare.obj --uv rgb.png -o none.ptx");
    HAS("no texture coordinates");
    CHECK(access(tool_path("none.ptx"), F_OK) != 0);
}

static void refused(void) {
    RUNS(2, "bake quad.obj -o none.ptx");
    RUNS(2, "bake quad.obj --uv rgb.png --pattern noise -o none.ptx");
    RUNS(2, "bake quad.obj --uv rgb.png -o none.png");
    RUNS(2, "bake quad.obj --uv rgb.png -o none.ptx --size 3");
    RUNS(2, "bake quad.obj --uv rgb.png -o none.ptx --match 0");
    RUNS(2, "bake quad.obj --uv rgb.png -o none.ptx --size 4 --match 2");
    RUNS(2, "bake quad.obj --uv rgb.png -o none.ptx --max-miss 2");
    static const char *const without[] = {"--uv rgb.png --samples 8",
                                          "--uv rgb.png --distance 2",
                                          "--uv rgb.png --seed 3",
                                          "--uv rgb.png --frequency 5",
                                          "--uv rgb.png --front 1",
                                          "--uv rgb.png --back 1",
                                          "--uv rgb.png --detail-kind face-vector",
                                          "--rays ao --wrap none",
                                          "--uv 'rgb.<UDIM>.png' --wrap clamp",
                                          "--rays ao --round u",
                                          "--rays ao --texture-encoding data",
                                          "--surface normal --samples 9",
                                          "--detail quad.obj --distance 2",
                                          "--detail quad.obj --detail-kind object-normal --cage "
                                          "quad.obj --front 1",
                                          "--from quad.obj --uv rgb.png --front 1",
                                          "--from quad.obj --uv rgb.png --by closest --back 1",
                                          "--from quad.obj --uv rgb.png --by rays --distance 1",
                                          "--from quad.obj --uv rgb.png --by rays --cage quad.obj "
                                          "--front 1",
                                          "--pattern checker --seed 3",
                                          "--pattern face-color --frequency 2"};
    for (size_t i = 0; i < sizeof without / sizeof *without; i++) {
        RUNS(2, "bake quad.obj %s --size 8 -o none.ptx", without[i]);
        HAS(": goes with --");
    }
    RUNS(0, "bake quad.obj --uv rgb.png --max-size 1 -o one.ptx");
    HAS("faces of 1x1 to 1x1");
    RUNS(0, "bake quad.obj --pattern noise --max-size 1x1 -o one.ptx");
    HAS("faces of 1x1 to 1x1");
    RUNS(0, "bake quad.obj --uv rgb.png --error 1/255 --max-size 1 --max-over 1 -o one.ptx");
    HAS("faces of 1x1 to 1x1");
    RUNS(2, "bake quad.obj --uv rgb.png --min-size 64 --max-size 8 -o none.ptx");
    HAS("contradict");
    RUNS(2, "bake quad.obj --uv rgb.png --size 8 --min-size 16 -o none.ptx");
    RUNS(2, "bake quad.obj --uv rgb.png --size 32 --max-size 8 -o none.ptx");
    /* rays that begin further out than any may reach */
    RUNS(1, "bake huge.obj --detail quad.obj --size 4 -o none.ptx");
    HAS("rays reach 1e+18");
    RUNS(1, "bake quad.obj --from quad.obj --uv rgb.png --by rays --cage huge.obj -o none.ptx");
    HAS("rays reach 1e+18");
    RUNS(1, "bake quad.obj --points nothing.obj -o none.ptx");
    HAS("nothing.obj: holds no points");
    RUNS(1, "bake quad.obj --points bare.obj -o none.ptx");
    HAS("bare.obj: its points have no colours");
    RUNS(1, "bake quad.obj --uv missing.png -o none.ptx");
    HAS("missing.png");
    RUNS(1, "bake quad.obj --uv quad.obj -o none.ptx");
    HAS("neither a PNG nor an OpenEXR");
    RUNS(1, "bake quad.obj --uv cut.png -o none.ptx");
    HAS("cut.png");
    RUNS(1, "bake quad.obj --uv 'rgb.<UDIM>.png' -o none.ptx");
    HAS("1001");
    RUNS(1, "bake quad.obj --uv 'mixed.<UDIM>.exr' -o none.ptx");
    HAS("mixed.1002.exr");
    HAS("channels");
    RUNS(1, "bake quad.obj --uv rgb.png -o nowhere/none.ptx");
    RUNS(1, "bake quad.obj --uv rgb.png -o none.ptx --miss-map none.ptx");
    CHECK(access(tool_path("none.ptx"), F_OK) != 0);
}

int main(void) {
    static const char two[] =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.5 0\nvt 1.5 0\nvt 1.5 1\nvt 0.5 1\n"
        "f 1/1 2/2 3/3 4/4\n";
    tool_begin();
    tool_write_file("quad.obj", quad, sizeof quad - 1);
    tool_write_file("half.obj", half, sizeof half - 1);
    tool_write_file("bare.obj", bare, sizeof bare - 1);
    tool_write_file("flat.obj", flat, sizeof flat - 1);
    tool_write_file("three.obj", three, sizeof three - 1);
    tool_write_file("hole.obj", hole, sizeof hole - 1);
    tool_write_file("nan.obj", nan_obj, sizeof nan_obj - 1);
    tool_write_file("far.obj", far, sizeof far - 1);
    tool_write_file("twice.obj", twice, sizeof twice - 1);
    tool_write_file("huge.obj", huge, sizeof huge - 1);
    tool_write_file("nothing.obj", "# nothing\n", 10);
    write_image("rgb.png", 3, 1, 8);
    write_image("wide.png", 1, 0.5f, 16);
    write_image("rgba.exr", 4, 0.5f, 16);
    results();
    misses();
    tool_write_file("cut.png", "\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
    write_image("mixed.1001.exr", 3, 1, 16);
    write_image("mixed.1002.exr", 4, 1, 16);
    tool_write_file("quad.obj", two, sizeof two - 1);
    refused();
    tool_end();
    return test_end();
}
