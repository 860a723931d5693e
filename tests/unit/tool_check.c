/* The command `selvage check`, on sound files and on files spoilt one way at a time. */
#include "kit/tool_kit.h"

static void sound(const char *path) {
    CHECK_MSG(tool("check --strict '%s'", path) == 0, "%s: %s", path, tool_out);
    HAS("verdict: sound\n");
}

static void keep(uint32_t face, slv_ptx_face *info, void *texels) {
    (void)face, (void)info, (void)texels;
}

/* Face 4's edge 1 leads to the wrong edge of the right face, face 0's edge 1 to nothing. */
static void spoil_adjacency(uint32_t face, slv_ptx_face *info, void *texels) {
    (void)texels;
    if (face == 0)
        info->adjacency.face[1] = SLV_BOUNDARY;
    if (face == 4)
        info->adjacency.edge[0] ^= 1;
}

static void spoil_subface(uint32_t face, slv_ptx_face *info, void *texels) {
    (void)texels;
    if (face == 6)
        info->adjacency.face[1] = SLV_BOUNDARY;
}

static void spoil_values(uint32_t face, slv_ptx_face *info, void *texels) {
    (void)info;
    if (face == 3)
        ((float *)texels)[7] = NAN;
}

static void flatten(uint32_t face, slv_ptx_face *info, void *texels) {
    (void)face;
    memset(texels, 100, (size_t)3 << (info->res.u + info->res.v));
}

static void check_adjacency(void) {
    tool_copy("good.ptx", "adjacency.ptx", true, spoil_adjacency);
    RUNS(1, "check adjacency.ptx");
    HAS("face 1 edge 3: leads to face 0 edge 1, which is a boundary");
    HAS("face 4 edge 0: leads to face 1 edge 3, which leads to face 0 edge 1: it is that face's "
        "edge 2 that leads back (--repair can help)");
    HAS("face 0 edge 1: is at a boundary, but in the mesh inside at face 1 edge 3 (--repair can "
        "help)");
    HAS("verdict: damaged (");
    RUNS(0, "check adjacency.ptx --repair mended.ptx");
    HAS("mended.ptx\n  verdict: sound\n");
    RUNS(0, "check --strict mended.ptx");
    tool_copy("good.ptx", "bare.ptx", false, spoil_adjacency);
    RUNS(1, "check bare.ptx --repair bare2.ptx");
    LACKS("(--repair can help)");
    tool_copy("good.ptx", "subface.ptx", false, spoil_subface);
    RUNS(1, "check subface.ptx --json");
    HAS("\"kind\": \"sub-faces\"");
    HAS("face 6 edge 1: is a sub-face, but no other's edge 2 follows it");
    LACKS("\"repairable\": true");
    tool_copy("good.ptx", "subface2.ptx", true, spoil_subface);
    RUNS(1, "check subface2.ptx --json");
    HAS("\"kind\": \"sub-faces\"");
    LACKS("\"repairable\": false");
    RUNS(0, "check subface2.ptx --repair mended.ptx");
    RUNS(0, "check --strict mended.ptx");
}

/* Swaps the blocks of two faces at a level: still readable, but not the faces' own. */
static bool swap_blocks(const char *from, const char *to, uint32_t level) {
    slv_ptx *ptx = tool_open(from);
    size_t size = 0;
    uint8_t *bytes = read_whole(tool_path(from), &size);
    bool found = false;
    REQUIRE(bytes);
    for (uint32_t a = 0; a < slv_ptx_get_info(ptx)->nfaces && !found; a++)
        for (uint32_t b = a + 1; b < slv_ptx_get_info(ptx)->nfaces && !found; b++) {
            slv_ptx_block one, two;
            uint8_t spare[4096];
            REQUIRE(!slv_ptx_get_block(ptx, a, level, &one));
            REQUIRE(!slv_ptx_get_block(ptx, b, level, &two));
            found = one.stored && one.bytes == two.bytes && one.bytes <= sizeof spare;
            if (!found)
                continue;
            memcpy(spare, bytes + one.position, one.bytes);
            memcpy(bytes + one.position, bytes + two.position, one.bytes);
            memcpy(bytes + two.position, spare, one.bytes);
        }
    tool_write_file(to, bytes, size);
    free(bytes);
    slv_ptx_close(ptx);
    return found;
}

static void check_reductions(void) {
    REQUIRE(swap_blocks("good.ptx", "swapped.ptx", 1));
    RUNS(1, "check swapped.ptx");
    HAS("its reduction at level 1 is off by 0.");
    HAS("reductions: 2 findings");
    RUNS(0, "check swapped.ptx --tables");
    RUNS(0, "check swapped.ptx --repair mended.ptx --json");
    HAS("\"repaired\": {");
    RUNS(0, "check --strict mended.ptx");
    tool_write_noise("wide.ptx", SLV_TYPE_U16, 4, 3, 2);
    RUNS(0, "check --strict wide.ptx");
    REQUIRE(swap_blocks("wide.ptx", "averages.ptx", 0));
    RUNS(1, "check averages.ptx");
    HAS("its average is off by ");
}

static void check_texels(void) {
    slv_ptx *ptx = tool_open("good.ptx");
    slv_ptx_block block;
    size_t size = 0;
    uint8_t *bytes = read_whole(tool_path("good.ptx"), &size);
    REQUIRE(bytes && !slv_ptx_get_block(ptx, 5, 0, &block));
    bytes[block.position + block.bytes - 1] ^= 0x55;
    tool_write_file("texels.ptx", bytes, size);
    RUNS(1, "check texels.ptx");
    HAS("texels: 1 finding\n    face 5");
    RUNS(1, "check texels.ptx --repair mended2.ptx");
    HAS("what cannot be read cannot be repaired: face 5");
    CHECK(access(tool_path("mended2.ptx"), F_OK) != 0);
    tool_write_file("short.ptx", bytes, size / 2);
    tool_write_file("empty.ptx", bytes, 0);
    RUNS(1, "check short.ptx --repair mended2.ptx");
    HAS("verdict: unreadable");
    HAS("what cannot be read cannot be repaired: truncated: ");
    RUNS(1, "check empty.ptx --json");
    HAS("\"verdict\": \"unreadable\"");
    free(bytes);
    slv_ptx_close(ptx);
    tool_write_noise("float.ptx", SLV_TYPE_FLOAT, 2, 1, 3);
    RUNS(0, "check --strict float.ptx");
    tool_copy("float.ptx", "nan.ptx", true, spoil_values);
    RUNS(0, "check nan.ptx");
    HAS("warning: face 3: 1 of 512 values are not finite, the first in texel 3 channel 1");
    RUNS(1, "check nan.ptx --strict");
}

/* The file's face table with the first edge of face 4 leading to a face that is not there: the
 * table is packed anew, stored, and all that follows moves. */
static void lose_neighbour(const char *from, const char *to) {
    size_t size = 0;
    uint8_t *bytes = read_whole(tool_path(from), &size);
    slv_ptx *ptx = tool_open(from);
    uint32_t nfaces = slv_ptx_get_info(ptx)->nfaces, old, length = 20 * nfaces;
    REQUIRE(bytes && length < 65536);
    memcpy(&old, bytes + 32, 4);
    uint8_t *table = malloc(length + 11), *out = malloc(size + length + 11);
    uint32_t a = 1, b = 0;
    for (uint32_t face = 0; face < nfaces; face++) {
        slv_ptx_face f;
        REQUIRE(!slv_ptx_get_face(ptx, face, &f));
        uint8_t *record = table + 7 + 20 * face;
        record[0] = (uint8_t)f.res.u;
        record[1] = (uint8_t)f.res.v;
        record[2] = 0;
        record[3] = f.flags;
        for (int edge = 0; edge < 4; edge++)
            record[2] |= (uint8_t)(f.adjacency.edge[edge] << (2 * edge));
        if (face == 4)
            f.adjacency.face[0] = 999;
        memcpy(record + 4, f.adjacency.face, 16);
    }
    const uint8_t head[7] = {0x78,
                             0x01,
                             1,
                             (uint8_t)length,
                             (uint8_t)(length >> 8),
                             (uint8_t)~length,
                             (uint8_t)(~length >> 8)};
    memcpy(table, head, sizeof head);
    for (uint32_t i = 0; i < length; i++) {
        a = (a + table[7 + i]) % 65521;
        b = (b + a) % 65521;
    }
    const uint8_t sum[4] = {(uint8_t)(b >> 8), (uint8_t)b, (uint8_t)(a >> 8), (uint8_t)a};
    memcpy(table + 7 + length, sum, sizeof sum);
    uint32_t zipped = length + 11;
    uint64_t edits;
    memcpy(out, bytes, 104);
    memcpy(out + 32, &zipped, 4);
    memcpy(&edits, out + 96, 8);
    edits += zipped - old;
    memcpy(out + 96, &edits, 8);
    memcpy(out + 104, table, zipped);
    memcpy(out + 104 + zipped, bytes + 104 + old, size - 104 - old);
    tool_write_file(to, out, size + zipped - old);
    slv_ptx_close(ptx);
    free(bytes);
    free(table);
    free(out);
}

static void check_lost_neighbours(void) {
    lose_neighbour("good.ptx", "lost.ptx");
    RUNS(1, "info lost.ptx");
    HAS("the adjacent face is 999, but there are 10 faces");
    RUNS(1, "check lost.ptx");
    HAS("face 4 edge 0: leads to face 999, but there are 10 faces: readers refuse the file "
        "(--repair can help)");
    HAS("verdict: damaged");
    RUNS(0, "check lost.ptx --repair found.ptx");
    RUNS(0, "diff good.ptx found.ptx");
    RUNS(0, "convert good.ptx bare4.ptx --no-meta");
    lose_neighbour("bare4.ptx", "lost4.ptx");
    RUNS(1, "check lost4.ptx --repair cut.ptx");
    HAS("face 1 edge 2: leads to face 4 edge 0, which is a boundary");
    RUNS(0, "info cut.ptx");
}

/* An edit leaves the flags of the faces around it as they were. */
static void check_flags(void) {
    slv_env env = test_env();
    slv_ptx_writer *writer = NULL;
    slv_ptx_face info;
    const uint8_t value[3] = {101, 100, 100};
    tool_copy("good.ptx", "flat.ptx", true, flatten);
    RUNS(0, "check flat.ptx --strict --seams 0");
    slv_ptx *ptx = tool_open("flat.ptx");
    REQUIRE(!slv_ptx_get_face(ptx, 1, &info));
    slv_ptx_close(ptx);
    REQUIRE(!slv_ptx_writer_edit(&env, tool_path("flat.ptx"), NULL, &writer));
    REQUIRE(!slv_ptx_writer_write_face(writer, 1, &info, value));
    REQUIRE(!slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
    RUNS(0, "check flat.ptx");
    HAS("face 0 edge 1: is flagged as lying among its own value, but face 1 differs");
    HAS("verdict: sound, with warnings");
    RUNS(0, "check flat.ptx --strict --repair flat2.ptx");
    RUNS(0, "check flat2.ptx --seams 0.001");
    HAS("warning: face 0 edge 1: differs by 0.00392157 from face 1 edge 3");
    HAS("seams: ");
    HAS("verdict: sound, with seams");
    RUNS(1, "check flat2.ptx --seams 0.001 --strict");
    RUNS(0, "check flat2.ptx --seams 0.004");
}

static void check_mesh(void) {
    slv_env env = test_env();
    slv_mesh *same = grid_mesh(3, 2, true), *other = grid_mesh(3, 3, false);
    REQUIRE(!slv_mesh_save_obj(&env, same, tool_path("same.obj")));
    REQUIRE(!slv_mesh_save_obj(&env, other, tool_path("other.obj")));
    slv_mesh_destroy(same);
    slv_mesh_destroy(other);
    RUNS(0, "check good.ptx --mesh same.obj");
    RUNS(1, "check good.ptx --mesh other.obj");
    HAS("the file has 10 faces, the mesh has 9");
    HAS("face 5: is a sub-face, but the mesh has a whole quad");
    RUNS(1, "check good.ptx --mesh other.obj --repair mended3.ptx");
    HAS("has 10 faces, the mesh has 9");
    RUNS(1, "check bare.ptx --mesh same.obj");
    HAS("it is that face's edge 2 that leads back (--repair can help)");
    RUNS(1, "check bare.ptx --mesh other.obj");
    LACKS("(--repair can help)");
    RUNS(0, "check bare.ptx --mesh same.obj --repair bare3.ptx");
    RUNS(0, "check --strict bare3.ptx");
}

static void check_threads(void) {
    static char first[sizeof tool_out];
    RUNS(1, "check swapped.ptx --seams 0.1 --threads 1 --json");
    memcpy(first, tool_out, sizeof first);
    RUNS(1, "check swapped.ptx --seams 0.1 --threads 5 --json");
    CHECK(strcmp(first, tool_out) == 0);
}

static void check_usage(void) {
    RUNS(2, "check");
    RUNS(2, "check good.ptx --seams -1");
    RUNS(2, "check good.ptx --seams 1 --tables");
    RUNS(2, "check good.ptx --nonsense");
    RUNS(2, "check good.ptx --repair same.obj");
    HAS("same.obj: what is written is a .ptx file");
    RUNS(1, "check missing.ptx");
    HAS("selvage: missing.ptx: ");
    RUNS(1, "check good.ptx --mesh missing.obj");
    RUNS(1, "check good.ptx --repair nowhere/x.ptx");
    RUNS(1, "check good.ptx >/dev/full");
    RUNS(0, "check good.ptx --quiet");
    CHECK(!tool_out[0]);
    RUNS(0, "check good.ptx --quiet --progress");
    HAS("check: 100% after");
    RUNS(0, "check --help");
    HAS("Examples:");
}

int main(void) {
    tool_begin();
    CHECK(each_sample(sound) > 0);
    tool_write_noise("good.ptx", SLV_TYPE_U8, 3, SLV_NO_ALPHA, 1);
    sound("good.ptx");
    tool_copy("good.ptx", "same.ptx", true, keep);
    sound("same.ptx");
    check_adjacency();
    check_reductions();
    check_texels();
    check_lost_neighbours();
    check_flags();
    check_mesh();
    check_threads();
    check_usage();
    tool_end();
    return test_end();
}
