/* selvage new, and slv_blank in C: sizes, types, colours, and what is refused. */
#include "kit/mesh_shapes.h"
#include "kit/tool_kit.h"

#include <selvage/blank.h>

static const char box[] = "v 0 0 0\nv 8 0 0\nv 8 1 0\nv 0 1 0\nv 0 0 2\nv 8 0 2\nv 8 1 2\nv 0 1 2\n"
                          "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
static const char four[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
static const char five[] = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 3 1 0\nf 1 2 5 3 4\n";

static void sizes(void) {
    RUNS(0, "new box.obj out.ptx --density 4 --scheme bilinear --json");
    slv_ptx *ptx = tool_open("out.ptx");
    slv_ptx_face face;
    MUST(slv_ptx_get_face(ptx, 0, &face)); /* 8 x 1 */
    CHECK(face.res.u + face.res.v == 7 && abs(face.res.u - face.res.v) == 3);
    CHECK(face.flags & SLV_FACE_CONSTANT);
    MUST(slv_ptx_get_face(ptx, 3, &face)); /* 1 x 2 */
    CHECK(face.res.u == 2 && face.res.v == 3);
    slv_env env = test_env();
    slv_mesh *mesh = NULL, *inside = NULL;
    MUST(slv_mesh_load(&env, tool_path("box.obj"), &mesh));
    MUST(slv_ptx_find_mesh(&env, ptx, &inside, NULL));
    REQUIRE(inside != NULL);
    CHECK(slv_mesh_face_count(inside) == 6);
    MUST(slv_ptx_match_mesh(&env, ptx, mesh));
    slv_mesh_destroy(inside);
    slv_mesh_destroy(mesh);
    slv_ptx_close(ptx);
    RUNS(0, "check out.ptx");
    RUNS(0, "new five.obj out.ptx --size 32x8");
    ptx = tool_open("out.ptx");
    MUST(slv_ptx_get_face(ptx, 4, &face));
    CHECK(face.res.u == 4 && face.res.v == 2 && face.flags & SLV_FACE_SUBFACE);
    slv_ptx_close(ptx);
    RUNS(0, "new box.obj out.ptx --square --min-size 16x16 --max-size 32x32 --json");
    HAS("\"smallest\"");
    ptx = tool_open("out.ptx");
    for (uint32_t i = 0; i < 6; i++) {
        MUST(slv_ptx_get_face(ptx, i, &face));
        CHECK(face.res.u == face.res.v && face.res.u == 5);
    }
    slv_ptx_close(ptx);
}

/* A number of texels is kept within, and half of it is reached. */
static void budgets(void) {
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    MUST(slv_mesh_load(&env, tool_path("box.obj"), &mesh));
    for (uint64_t most = 8; most < 10000000; most *= 3) {
        const slv_blank_params params = {.max_texels = most, .scheme = SLV_SCHEME_BILINEAR};
        slv_blank_stats stats;
        slv_res *res = NULL;
        MUST(slv_blank_plan(&env, mesh, &params, &res, &stats));
        CHECK_MSG(stats.texels <= most && stats.texels * 4 >= most, "%llu of %llu",
                  (unsigned long long)stats.texels, (unsigned long long)most);
        slv_free(res);
    }
    const slv_blank_params both = {.max_texels = 8, .density = 1};
    slv_res *res = NULL;
    CHECK(slv_blank_plan(&env, mesh, &both, &res, NULL) == SLV_ERROR_ARGUMENT && !res);
    slv_mesh_destroy(mesh);
    /* what cannot be is said */
    RUNS(0, "new four.obj out.ptx --scheme bilinear --density 100000 --json");
    HAS("1 of 1 faces, the first 0, take more than 4096x4096 texels");
    HAS("\"limited\": 1");
    RUNS(0, "new box.obj out.ptx --min-size 64 --texels 10");
    HAS("24576 texels where 10 were asked for: no face is smaller than 64x64");
    RUNS(0, "new four.obj out.ptx --scheme bilinear --texels 1G --max-size 64");
    HAS("64x64 texels, 45.25 texels a unit");
    LACKS("warning");
    RUNS(0, "new four.obj out.ptx --max-size 1");
    HAS("faces of 1x1 to 1x1 texels");
    RUNS(0, "new four.obj out.ptx --min-size 8192x1 --texels 9000");
    LACKS("warning");
    RUNS(0, "new box.obj out.ptx --bytes 6k --quiet");
    RUNS(0, "info out.ptx --json");
}

static void expect_texel(uint32_t n, const float *want, double tolerance) {
    slv_env env = test_env();
    slv_ptx *ptx = tool_open("out.ptx");
    slv_texture *texture = NULL;
    float texel[8];
    MUST(slv_ptx_load_texture(&env, ptx, &texture));
    REQUIRE(slv_texture_get_desc(texture)->nchannels == n);
    for (uint32_t face = 0; face < 6; face++) {
        slv_texture_fetch(texture, face, 0, 0, texel);
        for (uint32_t c = 0; c < n; c++)
            CHECK_MSG(fabs((double)(texel[c] - want[c])) <= tolerance, "channel %u: %g, not %g", c,
                      (double)texel[c], (double)want[c]);
    }
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
}

static void colours(void) {
    RUNS(0, "new box.obj out.ptx --size 4 --fill '#804020'");
    expect_texel(3, (float[]){128.0f / 255, 64.0f / 255, 32.0f / 255}, 0);
    RUNS(0, "new box.obj out.ptx --size 4 --fill '#804020' --type float");
    expect_texel(3, (float[]){0.215861f, 0.0512695f, 0.0144438f}, 1e-6);
    RUNS(0, "new box.obj out.ptx --size 4 --fill red --channels 4 --alpha 3");
    RUNS(0, "new box.obj named.ptx --size 4 --fill red --channels r,g,b,a");
    CHECK(same_bytes(tool_path("named.ptx"), tool_path("out.ptx")));
    RUNS(2, "new box.obj named.ptx --channels rgbb");
    expect_texel(4, (float[]){1, 0, 0, 1}, 0);
    RUNS(0, "new box.obj out.ptx --size 4 --channels 1 --type half --fill 0.25");
    expect_texel(1, (float[]){0.25f}, 0);
    RUNS(0, "new box.obj out.ptx --size 4 --channels 5 --type float --fill 1,2,3,4,5");
    expect_texel(5, (float[]){1, 2, 3, 4, 5}, 0);
    RUNS(0, "new box.obj out.ptx --size 4");
    expect_texel(3, (float[]){192.0f / 255, 192.0f / 255, 192.0f / 255}, 0);
    RUNS(0, "new box.obj out.ptx --size 4 --texture-encoding data --fill 0.5,0.5,1");
    expect_texel(3, (float[]){128.0f / 255, 128.0f / 255, 1}, 0);
    slv_texture_encoding encoding;
    slv_ptx *ptx = tool_open("out.ptx");
    MUST(slv_ptx_get_encoding(ptx, &encoding));
    CHECK(encoding == SLV_TEXTURE_DATA);
    slv_ptx_close(ptx);
}

static void refused(void) {
    RUNS(2, "new box.obj out.obj");
    RUNS(2, "new box.obj out.ptx --size 3x4");
    HAS("powers of two");
    RUNS(2, "new box.obj out.ptx --size 4 --density 3");
    RUNS(2, "new box.obj out.ptx --density 0");
    RUNS(2, "new box.obj out.ptx --bytes lots");
    RUNS(2, "new box.obj out.ptx --alpha 3");
    RUNS(2, "new box.obj out.ptx --fill 1,2");
    RUNS(2, "new box.obj out.ptx --min-size 64 --max-size 8");
    HAS("--min-size 64x64 is larger than --max-size 8x8");
    RUNS(1, "new missing.obj out.ptx");
    RUNS(1, "new box.obj nowhere/out.ptx");
    RUNS(0, "new four.obj other.ptx --size 65536x1 --json");
    HAS("65536");
}

int main(void) {
    tool_begin();
    tool_write_file("box.obj", box, sizeof box - 1);
    tool_write_file("five.obj", five, sizeof five - 1);
    tool_write_file("four.obj", four, sizeof four - 1);
    sizes();
    budgets();
    colours();
    refused();
    tool_end();
    return test_end();
}
