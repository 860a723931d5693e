/* The command `selvage merge`: every face of every file is there, neighbours and geometry moved
 * along. */
#include "kit/tool_kit.h"

static void check_faces(const char *part, const char *whole, uint32_t first) {
    slv_ptx *a = tool_open(part), *b = tool_open(whole);
    uint8_t texels[2][256 * 3];
    for (uint32_t face = 0; face < slv_ptx_get_info(a)->nfaces; face++) {
        slv_ptx_face one, two;
        REQUIRE(!slv_ptx_get_face(a, face, &one));
        REQUIRE(!slv_ptx_get_face(b, first + face, &two));
        REQUIRE(one.res.u == two.res.u && one.res.v == two.res.v && one.res.u + one.res.v <= 8);
        REQUIRE(!slv_ptx_read_face(a, face, one.res, texels[0]));
        REQUIRE(!slv_ptx_read_face(b, first + face, two.res, texels[1]));
        CHECK(memcmp(texels[0], texels[1], (size_t)3 << (one.res.u + one.res.v)) == 0);
        CHECK(((one.flags ^ two.flags) & SLV_FACE_SUBFACE) == 0);
        for (int edge = 0; edge < 4; edge++) {
            int32_t there = one.adjacency.face[edge];
            CHECK(two.adjacency.face[edge] == (there < 0 ? there : there + (int32_t)first));
            CHECK(there < 0 || one.adjacency.edge[edge] == two.adjacency.edge[edge]);
        }
    }
    slv_ptx_close(a);
    slv_ptx_close(b);
}

/* A file of one value under the key "name", and one under a key of its own. */
static void write_named(const char *path, const char *name, const char *own) {
    slv_env env = test_env();
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                    .type = SLV_TYPE_HALF,
                                    .nchannels = 3,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = 2};
    slv_ptx_writer *writer = NULL;
    slv_ptx_meta meta = {"name", SLV_META_STRING, (uint32_t)strlen(name), name};
    slv_ptx_meta other = {own, SLV_META_STRING, 1, "x"};
    REQUIRE(!slv_ptx_writer_create(&env, tool_path(path), &params, &writer));
    REQUIRE(!slv_ptx_writer_set_meta(writer, &meta) && !slv_ptx_writer_set_meta(writer, &other));
    REQUIRE(!slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
}

static void check_meta(void) {
    write_named("one.ptx", "first", "a");
    write_named("two.ptx", "second", "b");
    write_named("three.ptx", "first", "a");
    RUNS(0, "merge one.ptx two.ptx three.ptx -o named.ptx");
    slv_ptx *ptx = tool_open("named.ptx");
    CHECK(slv_ptx_get_info(ptx)->nmeta == 5); /* and the record of the parts */
    const slv_ptx_meta *name = slv_ptx_find_meta(ptx, "name"),
                       *second = slv_ptx_find_meta(ptx, "name.2");
    REQUIRE(name && second && slv_ptx_find_meta(ptx, "b"));
    CHECK(strcmp(name->values, "first") == 0 && strcmp(second->values, "second") == 0);
    slv_ptx_close(ptx);
    RUNS(0, "merge a.ptx one.ptx -o mixed.ptx");
    HAS("1 of 2 files have no usable geometry inside");
    RUNS(0, "merge mixed.ptx b.ptx one.ptx mixed.ptx -o nested.ptx");
    RUNS(0, "split nested.ptx outer");
    RUNS(0, "diff mixed.ptx outer/mixed.ptx");
    RUNS(0, "diff b.ptx outer/b.ptx");
    RUNS(0, "split outer/mixed.ptx inner");
    RUNS(0, "diff a.ptx inner/a.ptx"); /* with its geometry */
    RUNS(0, "diff one.ptx inner/one.ptx");
    ptx = tool_open("mixed.ptx");
    CHECK(slv_ptx_get_info(ptx)->type == SLV_TYPE_HALF);
    CHECK(!slv_ptx_find_meta(ptx, "PtexFaceVertCounts"));
    slv_ptx_close(ptx);
    write_named("four.ptx", "third", "name.2");
    RUNS(1, "merge one.ptx two.ptx four.ptx -o taken.ptx");
    HAS("the name name.2 is taken");
    CHECK(access(tool_path("taken.ptx"), F_OK) != 0);
}

static void check_usage(void) {
    const char *data = data_folder();
    RUNS(2, "merge a.ptx b.ptx");
    RUNS(2, "merge -o x.ptx");
    RUNS(2, "merge a.ptx b.ptx -o x.obj");
    HAS("x.obj: what is written is a .ptx file");
    CHECK(access(tool_path("x.obj"), F_OK) != 0);
    RUNS(1, "merge a.ptx missing.ptx -o x.ptx");
    RUNS(1, "merge a.ptx '%s/tri_tiled_u8_1.ptx' -o x.ptx", data);
    HAS("is of triangles, a.ptx is not");
    RUNS(1, "merge a.ptx '%s/cube_u16_rgba.ptx' -o x.ptx", data);
    HAS("convert it first");
    RUNS(0, "merge --help");
    HAS("Examples:");
    CHECK(access(tool_path("x.ptx"), F_OK) != 0);
}

int main(void) {
    tool_begin();
    tool_write_noise("a.ptx", SLV_TYPE_U8, 3, SLV_NO_ALPHA, 1);
    tool_write_noise("b.ptx", SLV_TYPE_U8, 3, SLV_NO_ALPHA, 2);
    RUNS(0, "merge a.ptx b.ptx a.ptx -o all.ptx");
    HAS("faces 10 to 19: b.ptx");
    RUNS(0, "check all.ptx --strict");
    check_faces("a.ptx", "all.ptx", 0);
    check_faces("b.ptx", "all.ptx", 10);
    check_faces("a.ptx", "all.ptx", 20);
    RUNS(0, "merge a.ptx -o alone.ptx --json");
    HAS("\"first_face\": 0");
    HAS("\"texels\": 2560");
    HAS("\"texel_bytes\": 7680");
    HAS("\"clipped_values\": 0");
    LACKS("merge: ");
    RUNS(0, "merge a.ptx b.ptx -o both.ptx --quiet --progress");
    HAS("merge: 100% after");
    RUNS(0, "diff a.ptx alone.ptx");
    RUNS(0, "merge a.ptx b.ptx behind.ptx");
    RUNS(0, "diff both.ptx behind.ptx");
    RUNS(2, "merge a.ptx b.ptx behind.ptx"); /* it is there now, and may be an input */
    HAS("the output is missing");
    RUNS(2, "merge a.ptx misspelt.ptx");
    CHECK(access(tool_path("misspelt.ptx"), F_OK) != 0);
    check_meta();
    check_usage();
    tool_end();
    return test_end();
}
