/* Files whose faces agree where they meet: what the writer stores is what
 * slv_levels_create_seamless makes in memory; with alpha colours agree multiplied by
 * it. */
#include "kit/border_kit.h"
#include "kit/tool_kit.h"

#include <selvage/ptx_check.h>
#include <selvage/seamless.h>

static const char *save(const kit *k, const slv_texture *texture, slv_ptx_seams seams,
                        uint32_t threads, const char *name) {
    slv_env env = test_env();
    const slv_ptx_write_params params = {.seams = seams};
    env.threads = threads;
    REQUIRE(!slv_ptx_save(&env, tool_path(name), texture, k->adjacency, &params));
    return tool_path(name);
}

/* Means are cut in files and rounded in memory, a unit a level, and where sizes differ levels of
 * neighbours have a say. */
static bool near(const kit *k, uint32_t level, size_t size, const uint8_t *a, const uint8_t *b) {
    static const float units[] = {1 / 255.0f, 1 / 65535.0f, 1 / 1024.0f, 1e-6f};
    bool is = true;
    for (size_t i = 0; i < size; i += slv_type_size(k->type)) {
        float x, y;
        slv_type_to_float(k->type, a + i, 1, &x);
        slv_type_to_float(k->type, b + i, 1, &y);
        is = is && fabsf(x - y) <= (float)(level + 4) * units[k->type] * 1.01f;
    }
    return is;
}

/* Every stored level against the chain in memory. */
static void compare(const kit *k, slv_ptx_seams seams, const char *what) {
    slv_env env = test_env();
    slv_levels *levels = NULL;
    slv_ptx *ptx = NULL;
    static uint8_t texels[(4 << 12) * 4];
    REQUIRE(!slv_levels_create_seamless(&env, k->texture, k->adjacency,
                                        seams == SLV_PTX_SEAMS_ALL ? 0 : 1, &levels));
    REQUIRE(!slv_ptx_open(&env, save(k, k->texture, seams, 0, "k.ptx"), &ptx));
    for (uint32_t f = 0; f < k->nfaces; f++) {
        slv_res res = k->res[f];
        for (uint32_t level = 0; level == 0 || (res.u >= 2 && res.v >= 2); level++) {
            if (level && (k->res[f].u < 2 + (int)level || k->res[f].v < 2 + (int)level))
                break;
            res = slv_res_level(k->res[f], level);
            size_t size = kit_texels(res) * k->nchannels * slv_type_size(k->type);
            REQUIRE(!slv_ptx_read_face(ptx, f, res, texels));
            CHECK_MSG(near(k, level, size, texels, slv_levels_texels(levels, f, level)),
                      "%s: face %u level %u", what, f, level);
        }
    }
    slv_ptx_close(ptx);
    slv_levels_destroy(levels);
}

static void sound(const char *name, bool agree, const char *what) {
    slv_env env = test_env();
    slv_ptx_report *report = NULL;
    const slv_ptx_check_params params = {.seams = true, .seam_tolerance = 10};
    REQUIRE(!slv_ptx_check(&env, tool_path(name), &params, &report));
    CHECK_MSG(report->nfindings == 0, "%s: %s", what,
              report->nfindings ? report->findings[0].message : "");
    CHECK_MSG(!agree || report->worst_seam.amount <= 0.51f / 255, "%s: the seam is %g", what,
              (double)report->worst_seam.amount);
    CHECK_MSG(agree || report->worst_seam.amount > 0.2f, "%s: the seam is only %g", what,
              (double)report->worst_seam.amount);
    slv_ptx_report_destroy(report);
}

/* Transparent black beside opaque colour: the colour stays what it is, and alpha is halved. */
static void alpha(void) {
    slv_env env = test_env();
    kit k;
    uint64_t random = 3;
    slv_ptx *ptx = NULL;
    kit_grid(&k, 2, 1, false, 0, NULL, NULL);
    kit_equal(&k, 3);
    slv_texture_desc desc = {k.nfaces, SLV_TYPE_U8, 4, 3, k.res, SLV_TEXTURE_AUTO};
    slv_texture *texture = NULL;
    uint8_t texels[64 * 4];
    REQUIRE(!slv_texture_create(&env, &desc, &texture));
    for (int i = 0; i < 64; i++) {
        const uint8_t texel[4] = {200, 100, 50, (uint8_t)(255 - (test_random(&random) & 1))};
        memcpy(texels + 4 * i, texel, 4);
    }
    REQUIRE(!slv_texture_set_face(texture, 0, texels));
    REQUIRE(!slv_ptx_open(&env, save(&k, texture, SLV_PTX_SEAMS_ALL, 0, "alpha.ptx"), &ptx));
    for (uint32_t face = 0; face < 2; face++) {
        REQUIRE(!slv_ptx_read_face(ptx, face, (slv_res){3, 3}, texels));
        uint32_t x = face ? 0 : 7;
        for (uint32_t y = 1; y < 7; y++) {
            const uint8_t *t = texels + 4 * (8 * y + x);
            CHECK_MSG(abs(t[0] - 200) <= 1 && abs(t[1] - 100) <= 1 && abs(t[2] - 50) <= 1 &&
                          abs(t[3] - 128) <= 1,
                      "face %u row %u: %d %d %d %d", face, y, t[0], t[1], t[2], t[3]);
        }
    }
    slv_ptx_close(ptx);
    slv_texture_destroy(texture);
    sound("alpha.ptx", true, "alpha");
    kit_free(&k);
}

/* Constant faces: left alone where full resolution is, else they take part. */
static void constants(void) {
    slv_env env = test_env();
    kit k;
    slv_ptx *ptx = NULL;
    slv_ptx_face info;
    kit_grid(&k, 3, 1, false, 0, NULL, NULL);
    kit_equal(&k, 4);
    kit_begin_texture(&k, SLV_TYPE_U8, 1);
    for (uint32_t f = 0; f < 3; f++)
        REQUIRE(!slv_texture_set_constant(k.texture, f, f < 2 ? "a" : "y"));
    REQUIRE(!slv_ptx_open(&env, save(&k, k.texture, SLV_PTX_SEAMS_REDUCTIONS, 0, "c.ptx"), &ptx));
    for (uint32_t f = 0; f < 3; f++)
        CHECK(!slv_ptx_get_face(ptx, f, &info) && info.flags & SLV_FACE_CONSTANT);
    slv_ptx_close(ptx);
    REQUIRE(!slv_ptx_open(&env, save(&k, k.texture, SLV_PTX_SEAMS_ALL, 0, "c.ptx"), &ptx));
    for (uint32_t f = 0; f < 3; f++)
        CHECK(!slv_ptx_get_face(ptx, f, &info) && !(info.flags & SLV_FACE_CONSTANT) == (f != 0));
    slv_ptx_close(ptx);
    sound("c.ptx", true, "constant faces");
    kit_free(&k);
}

/* A constant face whose neighbour continues it in the row beside it only: coarser levels of the two
 * would differ, so that it is not stored as constant; one whose neighbour goes on alike is. */
static void constant_beside_detail(void) {
    slv_env env = test_env();
    kit k;
    slv_ptx *ptx = NULL;
    slv_ptx_face info;
    uint8_t texels[32 * 32];
    kit_grid(&k, 3, 1, false, 0, NULL, NULL);
    kit_equal(&k, 5);
    kit_begin_texture(&k, SLV_TYPE_U8, 1);
    for (int i = 0; i < 32 * 32; i++)
        texels[i] = i % 32 ? 255 : 0;
    REQUIRE(slv_texture_set_constant(k.texture, 0, "") == SLV_OK);
    REQUIRE(slv_texture_set_face(k.texture, 1, texels) == SLV_OK);
    REQUIRE(slv_texture_set_constant(k.texture, 2, "\xff") == SLV_OK);
    compare(&k, SLV_PTX_SEAMS_ALL, "constant beside detail");
    REQUIRE(!slv_ptx_open(&env, tool_path("k.ptx"), &ptx));
    for (uint32_t f = 0; f < 3; f++)
        CHECK(!slv_ptx_get_face(ptx, f, &info) && !(info.flags & SLV_FACE_CONSTANT) == (f != 2));
    slv_ptx_close(ptx);
    kit_free(&k);
}

/* What the command bakes agrees unless it is told otherwise, or values have no mean. */
static void command(void) {
    static const char obj[] = "v 0 0 0\nv 1 0 0\nv 3 0 0\nv 0 1 0\nv 1 1 0\nv 3 1 1\nv 4 0 0\n"
                              "f 1 2 5 4\nf 2 3 6 5\nf 3 7 6\n";
    tool_write_file("m.obj", obj, sizeof obj - 1);
    RUNS(0, "bake m.obj --pattern noise --frequency 9 --density 16 -o b.ptx");
    RUNS(0, "check --strict b.ptx --seams 0.00197");
    RUNS(0, "bake m.obj --pattern noise --frequency 9 --density 16 --reductions plain -o p.ptx");
    RUNS(1, "check --strict p.ptx --seams 0.00197");
    RUNS(0, "convert p.ptx c.ptx --reductions all");
    RUNS(0, "diff b.ptx c.ptx");
    RUNS(0, "convert b.ptx d.ptx --reductions");
    RUNS(0, "check --strict d.ptx");
    RUNS(0, "bake m.obj --pattern face-color --size 8 -o f.ptx");
    HAS("5 constant");
    RUNS(2, "convert b.ptx sheet.png --reductions seamless");
    HAS("only a .ptx has any");
    RUNS(2, "convert b.ptx e.ptx --reductions=smooth");
}

static void refusals(void) {
    slv_env env = test_env();
    slv_ptx_writer *writer = NULL;
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_TRIANGLE,
                                    .nchannels = 1,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = 1,
                                    .seams = SLV_PTX_SEAMS_REDUCTIONS};
    CHECK(slv_ptx_writer_create(&env, tool_path("t.ptx"), &params, &writer) ==
          SLV_ERROR_UNSUPPORTED);
    params.mesh_type = SLV_PTX_QUAD;
    params.seams = (slv_ptx_seams)7;
    CHECK(slv_ptx_writer_create(&env, tool_path("t.ptx"), &params, &writer) == SLV_ERROR_ARGUMENT);
    CHECK(!writer && strcmp(slv_ptx_seams_name(SLV_PTX_SEAMS_REDUCTIONS), "seamless") == 0);
}

int main(void) {
    uint64_t random = 29;
    kit k;
    tool_begin();
    for (int round = 0; round < 4; round++) {
        if (round % 2)
            kit_pentagons(&k, &random);
        else
            kit_grid(&k, 5, 4, round == 2, 30, &random, NULL);
        for (uint32_t f = 0; f < k.nfaces; f++)
            k.res[f] = (slv_res){(int8_t)(2 + test_random(&random) % 4),
                                 (int8_t)(2 + test_random(&random) % 4)};
        kit_noise(&k, (slv_type)round, 1 + (uint32_t)round % 3, &random);
        compare(&k, SLV_PTX_SEAMS_REDUCTIONS, "reductions");
        sound("k.ptx", false, "reductions");
        compare(&k, SLV_PTX_SEAMS_ALL, "all levels");
        sound("k.ptx", true, "all levels");
        save(&k, k.texture, SLV_PTX_SEAMS_ALL, 1, "one.ptx");
        RUNS(0, "diff k.ptx one.ptx");
        /* written again plain, a file forgets that it was */
        RUNS(0, "convert k.ptx again.ptx");
        sound("again.ptx", true, "again");
        RUNS(0, "info again.ptx");
        CHECK(!strstr(tool_out, "TextureReductions"));
        kit_free(&k);
    }
    alpha();
    constants();
    constant_beside_detail();
    command();
    refusals();
    tool_end();
    return test_end();
}
