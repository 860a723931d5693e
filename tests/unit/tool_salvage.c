/* Damaged faces are filled from what is left of them, named, and the exit code says it; damaged
 * reductions are made anew. */
#include "kit/tool_kit.h"

static void spoil(const char *from, const char *to, uint64_t at, uint32_t count) {
    size_t size;
    uint8_t *bytes = read_whole(tool_path(from), &size);
    REQUIRE(bytes && at + count <= size);
    memset(bytes + at, 0xa5, count);
    tool_write_file(to, bytes, size);
    free(bytes);
}

/* A copy in which a block of a face cannot be unpacked. */
static void spoil_block(const char *from, const char *to, uint32_t face, uint32_t level) {
    slv_ptx *ptx = tool_open(from);
    slv_ptx_block block;
    REQUIRE(!slv_ptx_get_block(ptx, face, level, &block) && block.stored);
    slv_ptx_close(ptx);
    spoil(from, to, block.position, block.bytes < 40 ? block.bytes : 40);
}

/* The finest level that is there, of 8 bits and 3 channels, texels repeated. */
static void check_filled(const char *name, uint32_t face, int from) {
    uint8_t good[256 * 3], filled[256 * 3];
    slv_ptx *a = tool_open("good.ptx"), *b = tool_open(name);
    slv_res res = {(int8_t)from, (int8_t)from};
    REQUIRE(!slv_ptx_read_face(a, face, res, good));
    REQUIRE(!slv_ptx_read_face(b, face, (slv_res){4, 4}, filled));
    int shift = 4 - from, wrong = 0;
    for (int y = 0; y < 16; y++)
        for (int x = 0; x < 16; x++)
            for (int c = 0; c < 3; c++)
                wrong += filled[(y * 16 + x) * 3 + c] !=
                         good[((y >> shift << from) + (x >> shift)) * 3 + c];
    CHECK_MSG(wrong == 0, "%s: %d values are not those of the reduction", name, wrong);
    slv_ptx_close(a);
    slv_ptx_close(b);
}

static void reductions(void) {
    spoil_block("good.ptx", "reduced.ptx", 2, 1);
    RUNS(1, "check reduced.ptx");
    HAS("face 2: its texels do not unpack");
    HAS("(--repair can help)");
    RUNS(0, "check reduced.ptx --repair mended.ptx --strict");
    RUNS(0, "diff good.ptx mended.ptx");
    RUNS(0, "convert reduced.ptx again.ptx");
    RUNS(0, "check again.ptx --strict");
    /* the table of all reductions of a level */
    slv_ptx *ptx = tool_open("good.ptx");
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    uint64_t at = info->file_bytes;
    for (uint32_t face = 0; face < info->nfaces; face++) {
        slv_ptx_block block;
        REQUIRE(!slv_ptx_get_block(ptx, face, 1, &block));
        at = block.stored && block.position < at ? block.position : at;
    }
    slv_ptx_close(ptx);
    spoil("good.ptx", "table.ptx", at - 8, 8);
    RUNS(1, "check table.ptx");
    HAS("(--repair can help)");
    RUNS(0, "check table.ptx --repair mended2.ptx --strict");
    RUNS(0, "diff good.ptx mended2.ptx");
}

static void faces(void) {
    spoil_block("good.ptx", "hurt.ptx", 3, 0);
    RUNS(1, "convert hurt.ptx out.ptx");
    CHECK(access(tool_path("out.ptx"), F_OK) != 0);
    RUNS(1, "check hurt.ptx --repair out.ptx");
    RUNS(1, "convert hurt.ptx out.ptx --salvage");
    HAS("face 3 is filled from its reduction of 8 x 8");
    HAS("1 of 10 faces could not be read and are filled: 3");
    check_filled("out.ptx", 3, 3);
    RUNS(0, "check out.ptx --strict");
    RUNS(2, "diff good.ptx hurt.ptx");
    RUNS(1, "diff good.ptx hurt.ptx --salvage");
    HAS("faces: 1 of 10 differ");
    HAS("filled: 3");
    RUNS(1, "diff out.ptx hurt.ptx --salvage");
    HAS("equal");
    RUNS(0, "convert good.ptx out2.ptx --salvage");
    RUNS(0, "diff good.ptx out2.ptx --salvage");
    RUNS(0, "info good.ptx --json");

    spoil_block("hurt.ptx", "hurt2.ptx", 3, 1);
    spoil_block("hurt2.ptx", "hurt3.ptx", 4, 0);
    RUNS(1, "convert hurt3.ptx out3.ptx --salvage");
    HAS("filled: 3-4");
    check_filled("out3.ptx", 3, 2);
    check_filled("out3.ptx", 4, 3);
    RUNS(1, "transfer hurt3.ptx moved.ptx --to good.obj --salvage --quiet");
    HAS("filled: 3-4");
    RUNS(0, "diff out3.ptx moved.ptx --texels");
}

/* Of a triangle each texel of a reduction stands for three of the half that it lies in and one of
 * the other, turned around: what was filled from a reduction reduces to it again. */
static void triangles(void) {
    enum { FACES = 3, LOG2 = 5, TEXELS = 1 << 2 * LOG2 };
    slv_env env = test_env();
    uint64_t seed = 7;
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_TRIANGLE,
                                    .type = SLV_TYPE_FLOAT,
                                    .nchannels = 1,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = FACES};
    static float texels[TEXELS], reduced[2][TEXELS / 4], filled[TEXELS], again[TEXELS / 4];
    slv_ptx_writer *writer = NULL;
    REQUIRE(!slv_ptx_writer_create(&env, tool_path("tri.ptx"), &params, &writer));
    for (uint32_t face = 0; face < FACES; face++) {
        slv_ptx_face info = {.res = {LOG2, LOG2},
                             .adjacency = {.face = {-1, -1, -1, -1}, .edge = {0}}};
        for (int i = 0; i < TEXELS; i++)
            texels[i] = (float)(test_random(&seed) % 4096) / 4096;
        REQUIRE(!slv_ptx_writer_write_face(writer, face, &info, texels));
    }
    REQUIRE(!slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
    spoil_block("tri.ptx", "tri1.ptx", 1, 0);
    spoil_block("tri1.ptx", "tri2.ptx", 1, 1);
    for (int from = LOG2 - 1; from >= LOG2 - 2; from--) {
        const char *hurt = from == LOG2 - 1 ? "tri1.ptx" : "tri2.ptx";
        slv_res res = {(int8_t)from, (int8_t)from};
        RUNS(1, "convert %s tri_out.ptx --salvage", hurt);
        slv_ptx *good = tool_open("tri.ptx"), *out = tool_open("tri_out.ptx");
        REQUIRE(!slv_ptx_read_face(good, 1, res, reduced[0]));
        REQUIRE(!slv_ptx_read_face(out, 1, (slv_res){LOG2, LOG2}, filled));
        slv_ptx_close(good);
        slv_ptx_close(out);
        float *last = filled;
        for (int log2 = LOG2; log2 > from; log2--) {
            float *to = log2 == LOG2 ? reduced[1] : again;
            slv_ptx_reduce(SLV_PTX_TRIANGLE, SLV_TYPE_FLOAT, 1,
                           (slv_res){(int8_t)log2, (int8_t)log2}, last, to);
            last = to;
        }
        CHECK_MSG(memcmp(last, reduced[0], sizeof(float) << 2 * from) == 0,
                  "filled from %d x %d it is another texture", 1 << from, 1 << from);
    }
}

/* What is cut off at the end: metadata, reductions, the last faces. */
static void cut(void) {
    size_t size;
    uint8_t *bytes = read_whole(tool_path("good.ptx"), &size);
    slv_ptx *ptx = tool_open("good.ptx");
    slv_ptx_block last;
    REQUIRE(bytes && !slv_ptx_get_block(ptx, 9, 0, &last));
    tool_write_file("cut.ptx", bytes, (size_t)last.position + 5);
    free(bytes);
    slv_ptx_close(ptx);
    RUNS(1, "convert cut.ptx out4.ptx");
    RUNS(1, "convert cut.ptx out4.ptx --salvage");
    HAS("face 9 is filled from its average");
    RUNS(1, "diff good.ptx out4.ptx --texels");
    HAS("faces: 1 of 10 differ");
    RUNS(1, "render cut.ptx --mesh good.obj -o cut.png --size 32x32 --salvage --quiet");
    HAS("filled: 9");
    CHECK(access(tool_path("cut.png"), F_OK) == 0);
}

int main(void) {
    slv_env env = test_env();
    slv_mesh *mesh = grid_mesh(3, 2, true);
    tool_begin();
    tool_write_noise("good.ptx", SLV_TYPE_U8, 3, SLV_NO_ALPHA, 1);
    REQUIRE(!slv_mesh_save_obj(&env, mesh, tool_path("good.obj")));
    slv_mesh_destroy(mesh); /* forks end with what is there */
    reductions();
    faces();
    triangles();
    cut();
    tool_end();
    return test_end();
}
