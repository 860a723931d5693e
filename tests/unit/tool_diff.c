/* The command `selvage diff`, on files whose differences are known. */
#include "kit/tool_kit.h"

#include <selvage/image.h>

static void same_as_itself(const char *path) {
    CHECK_MSG(tool("diff '%s' '%s'", path, path) == 0, "%s: %s", path, tool_out);
    CHECK(strcmp(tool_out, "equal\n") == 0);
}

static void keep(uint32_t face, slv_ptx_face *info, void *texels) {
    (void)face, (void)info, (void)texels;
}

/* Texel (3,2) of face 4, channel 1, by 20 of 255. */
static void change_texel(uint32_t face, slv_ptx_face *info, void *texels) {
    uint8_t *value = (uint8_t *)texels + (2 * 16 + 3) * 3 + 1;
    (void)info;
    if (face == 4)
        *value = *value > 100 ? *value - 20 : *value + 20;
}

static void change_table(uint32_t face, slv_ptx_face *info, void *texels) {
    (void)texels;
    if (face == 2)
        info->adjacency.face[2] = SLV_BOUNDARY;
    if (face == 3)
        info->res = (slv_res){3, 4};
}

static void check_texels(void) {
    slv_env env = test_env();
    slv_image image = {0};
    tool_copy("a.ptx", "b.ptx", true, change_texel);
    RUNS(1, "diff a.ptx b.ptx");
    HAS("face 4: 1 of 256 texels, by up to 0.0784314 (mean 0.000102), most at texel 3,2 channel 1");
    HAS("faces: 1 of 10 differ");
    RUNS(0, "diff a.ptx b.ptx --tolerance 0.08");
    HAS("equal within the tolerance; the largest difference is 0.0784314, at face 4");
    RUNS(1, "diff b.ptx a.ptx --tolerance 0.07 --json");
    HAS("\"equal\": false");
    HAS("\"different_faces\": 1");
    HAS("\"different_texels\": 1");
    RUNS(1, "diff a.ptx b.ptx --quiet");
    CHECK(!tool_out[0]);
    RUNS(1, "diff a.ptx b.ptx --images pictures");
    REQUIRE(!slv_image_load(&env, tool_path("pictures/face_000004.png"), &image));
    CHECK(image.width == 16 && image.height == 16 && image.nchannels == 3);
    CHECK(image.pixels[((15 - 2) * 16 + 3) * 3 + 1] == 1.0f);
    CHECK(image.pixels[0] == 0.0f);
    slv_image_free(&image);
    RUNS(1, "diff a.ptx b.ptx --images pictures --format exr");
    REQUIRE(!slv_image_load(&env, tool_path("pictures/face_000004.exr"), &image));
    CHECK(fabsf(image.pixels[((15 - 2) * 16 + 3) * 3 + 1] - 20 / 255.0f) < 1e-6f);
    slv_image_free(&image);
    CHECK(access(tool_path("pictures/face_000003.exr"), F_OK) != 0);
}

static void check_table(void) {
    tool_copy("a.ptx", "c.ptx", false, change_table);
    RUNS(1, "diff a.ptx c.ptx");
    HAS("metadata PtexFaceVertCounts: only in the first");
    HAS("face 2: edge 2 has another neighbour");
    HAS("face 3: 16 x 16 and 8 x 16 texels");
    LACKS("face 4");
    RUNS(1, "diff c.ptx a.ptx");
    HAS("metadata PtexFaceVertCounts: only in the second");
    RUNS(0, "diff b.ptx b.ptx --texels");
    tool_copy("a.ptx", "d.ptx", false, keep);
    RUNS(0, "diff a.ptx d.ptx --texels");
    RUNS(1, "diff a.ptx d.ptx");
}

static void check_kinds(void) {
    tool_write_noise("wide.ptx", SLV_TYPE_U16, 4, 3, 1);
    tool_write_noise("float.ptx", SLV_TYPE_FLOAT, 4, 3, 1);
    RUNS(1, "diff wide.ptx float.ptx");
    HAS("data type: uint16 and float");
    RUNS(0, "diff wide.ptx float.ptx --texels --tolerance 0.00001");
    RUNS(1, "diff a.ptx wide.ptx");
    HAS("channels: 3 and 4");
    HAS("alpha channel: -1 and 3");
    const char *data = data_folder();
    REQUIRE(data);
    RUNS(2, "diff '%s/tri_tiled_u8_1.ptx' a.ptx", data);
    HAS("triangles cannot be compared with quads");
    RUNS(1, "diff '%s/cube_u16_rgba.ptx' wide.ptx --threads 1 --json", data);
    HAS("\"missing\": true");
    static char first[sizeof tool_out];
    memcpy(first, tool_out, sizeof first);
    RUNS(1, "diff '%s/cube_u16_rgba.ptx' wide.ptx --threads 5 --json", data);
    CHECK(strcmp(first, tool_out) == 0);
}

static void check_usage(void) {
    RUNS(2, "diff a.ptx");
    RUNS(2, "diff a.ptx b.ptx c.ptx");
    RUNS(2, "diff a.ptx b.ptx --tolerance -1");
    RUNS(2, "diff a.ptx missing.ptx"); /* trouble, as diff(1) has it */
    HAS("selvage: missing.ptx: ");
    RUNS(2, "diff a.ptx a.ptx >/dev/full");
    HAS("cannot write the answer: No space left on device");
    RUNS(2, "diff a.ptx b.ptx --json >/dev/full");
    HAS("cannot write the answer: No space left on device");
    RUNS(1, "info a.ptx --list-faces --json >/dev/full");
    HAS("cannot write the answer: No space left on device");
    RUNS(2, "diff a.ptx b.ptx --images a.ptx");
    RUNS(0, "diff --help");
    HAS("Examples:");
}

int main(void) {
    tool_begin();
    CHECK(each_sample(same_as_itself) > 0);
    tool_write_noise("a.ptx", SLV_TYPE_U8, 3, SLV_NO_ALPHA, 1);
    check_texels();
    check_table();
    check_kinds();
    check_usage();
    tool_end();
    return test_end();
}
