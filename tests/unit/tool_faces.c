/* Faces by their numbers: some of a file, a merge taken apart again, and numbers on the sheet. */
#include "kit/tool_kit.h"

#include "kit/ptx_same.h"

#include <selvage/exchange.h>
#include <selvage/image.h>

/* Face `face` of one file is face `place` of another, but for its neighbours. */
static void check_same_face(slv_ptx *a, uint32_t face, slv_ptx *b, uint32_t place) {
    uint8_t texels[2][256 * 3];
    slv_ptx_face one, two;
    REQUIRE(!slv_ptx_get_face(a, face, &one) && !slv_ptx_get_face(b, place, &two));
    REQUIRE(one.res.u == two.res.u && one.res.v == two.res.v && one.res.u + one.res.v <= 8);
    REQUIRE(!slv_ptx_read_face(a, face, one.res, texels[0]) &&
            !slv_ptx_read_face(b, place, two.res, texels[1]));
    CHECK(memcmp(texels[0], texels[1], (size_t)3 << (one.res.u + one.res.v)) == 0);
    CHECK(((one.flags ^ two.flags) & SLV_FACE_SUBFACE) == 0);
}

static uint32_t count_polygons(slv_ptx *ptx) {
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    REQUIRE(!slv_ptx_find_mesh(&env, ptx, &mesh, NULL));
    uint32_t count = mesh ? slv_mesh_get_view(mesh)->npolys : 0;
    slv_mesh_destroy(mesh);
    return count;
}

/* The grid is three by two, one of its polygons a pentagon of five faces. */
static void check_some(void) {
    slv_ptx *all = tool_open("a.ptx");
    uint32_t nfaces = slv_ptx_get_info(all)->nfaces, sub = nfaces;
    for (uint32_t f = nfaces; f-- > 0;) {
        slv_ptx_face face;
        REQUIRE(!slv_ptx_get_face(all, f, &face));
        sub = face.flags & SLV_FACE_SUBFACE ? f : sub;
    }
    REQUIRE(sub < nfaces && count_polygons(all) == nfaces - 4);
    uint32_t quad = sub ? 0 : 5;
    RUNS(0, "convert a.ptx some.ptx --faces %u-%u,%u,%u", sub, sub + 4, quad, quad);
    slv_ptx *some = tool_open("some.ptx");
    REQUIRE(slv_ptx_get_info(some)->nfaces == 6);
    uint32_t at = quad < sub; /* in the order of their numbers */
    for (uint32_t k = 0; k < 5; k++)
        check_same_face(all, sub + k, some, at + k);
    check_same_face(all, quad, some, at ? 0 : 5);
    for (uint32_t f = 0; f < 6; f++) {
        slv_ptx_face face, was;
        REQUIRE(!slv_ptx_get_face(some, f, &face));
        uint32_t from = f - at < 5 ? sub + f - at : quad;
        REQUIRE(!slv_ptx_get_face(all, from, &was));
        for (int edge = 0; edge < 4; edge++) {
            int32_t there = was.adjacency.face[edge], expected = -1;
            if (there >= (int32_t)sub && there < (int32_t)sub + 5)
                expected = there - (int32_t)sub + (int32_t)at;
            else if (there == (int32_t)quad)
                expected = at ? 0 : 5;
            CHECK_MSG(face.adjacency.face[edge] == expected, "face %u edge %d meets %d, not %d", f,
                      edge, face.adjacency.face[edge], expected);
        }
    }
    CHECK(count_polygons(some) == 2);
    slv_ptx_close(some);
    RUNS(0, "check some.ptx");
    RUNS(0, "convert a.ptx torn.ptx --faces %u", sub);
    HAS("only some are taken: the geometry inside is left out");
    some = tool_open("torn.ptx");
    CHECK(slv_ptx_get_info(some)->nfaces == 1 && count_polygons(some) == 0);
    slv_ptx_close(some);
    slv_ptx_close(all);
    RUNS(0, "convert a.ptx one.png --faces 2,3 --json");
    HAS("\"faces\": 2,");
    RUNS(0, "convert one.json again.ptx");
    LACKS("warning");
    RUNS(0, "convert a.ptx two.ptx --faces 2-3 --no-meta");
    RUNS(0, "diff again.ptx two.ptx");
    RUNS(0, "convert a.ptx big.ptx --faces 2-3 --res 2-3=32x8 --scale 0.5");
    RUNS(2, "convert a.ptx x.ptx --faces %u", nfaces);
    RUNS(2, "convert a.ptx x.ptx --faces 3-2");
    RUNS(1, "convert one.json x.ptx --faces 0");
    HAS("of images all faces are taken");
}

/* Any faces of a sound file are a sound file, wherever that cuts polygons. */
static void check_subsets(const char *path) {
    static uint64_t state = 11;
    slv_env env = test_env();
    slv_ptx *ptx = NULL;
    slv_exchange *source = NULL;
    char first[512], part[512];
    uint32_t rounds = test_effort(4), kept[4096];
    snprintf(part, sizeof part, "%s", tool_path("subset.ptx"));
    if (count_findings(path, first, sizeof first))
        return;
    REQUIRE(!slv_ptx_open(&env, path, &ptx) && !slv_exchange_open_ptx(&env, ptx, &source));
    uint32_t nfaces = slv_ptx_get_info(ptx)->nfaces;
    for (uint32_t round = 0; round < rounds && nfaces <= 4096; round++) {
        uint32_t count = 0, odds = 2 + test_random(&state) % 12;
        for (uint32_t f = 0; f < nfaces; f++)
            if ((test_random(&state) % odds != 0) == (round % 4 != 0))
                kept[count++] = f;
        if (!count)
            kept[count++] = test_random(&state) % nfaces;
        const slv_exchange_params params = {.faces = kept, .nfaces = count, .no_meta = true};
        REQUIRE(!slv_exchange_to_ptx(&env, source, &params, part, NULL));
        CHECK_MSG(!count_findings(part, first, sizeof first), "%s, %u of %u faces: %s", path, count,
                  nfaces, first);
    }
    slv_exchange_close(source);
    slv_ptx_close(ptx);
}

/* Types, border modes and metadata that a merge makes one of come apart again. */
static void check_split(void) {
    RUNS(0, "convert a.ptx half.ptx --type half --border periodic --no-reductions");
    RUNS(0, "convert b.ptx wide.ptx --type uint16 --border black");
    RUNS(0, "merge a.ptx half.ptx wide.ptx all.ptx");
    RUNS(0, "split all.ptx parts --json");
    HAS("\"name\": \"half.ptx\"");
    static const char *const names[] = {"a.ptx", "half.ptx", "wide.ptx"};
    for (int i = 0; i < 3; i++) {
        char part[64], path[2][512];
        snprintf(part, sizeof part, "parts/%s", names[i]);
        RUNS(0, "diff %s %s", names[i], part);
        snprintf(path[0], sizeof path[0], "%s", tool_path(names[i]));
        snprintf(path[1], sizeof path[1], "%s", tool_path(part));
        same_content(path[0], path[1]);
    }
    /* merged again, also with what it was merged from: the same names come apart as they were */
    RUNS(0, "merge all.ptx a.ptx parts/a.ptx -o more.ptx");
    RUNS(0, "split more.ptx -o back");
    RUNS(0, "diff all.ptx back/all.ptx");
    RUNS(0, "diff a.ptx back/a.ptx");
    RUNS(0, "diff a.ptx back/part_0002.ptx");
    RUNS(0, "split back/all.ptx back2");
    RUNS(0, "diff wide.ptx back2/wide.ptx");
    /* whoever changed the whole wants its parts so */
    RUNS(0, "convert all.ptx changed.ptx --type half");
    RUNS(0, "split changed.ptx parts2");
    RUNS(0, "info parts2/a.ptx");
    HAS("half, 3 channels");
}

static void check_split_refused(void) {
    static const char *const names[] = {"../evil.ptx", "/tmp/evil.ptx", ".ptx", "evil.txt", ""};
    RUNS(1, "split a.ptx none");
    HAS("say with --at where they begin");
    RUNS(0, "split a.ptx pieces --at 2,4");
    HAS("faces 2 to 3: part_0001.ptx");
    RUNS(0, "check pieces/part_0001.ptx");
    RUNS(2, "split a.ptx none --at 4,2");
    RUNS(2, "split a.ptx none --at 2-4");
    RUNS(2, "split a.ptx none --at 99");
    RUNS(2, "split a.ptx");
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char record[512];
        snprintf(record, sizeof record, "{\"parts\": [{\"name\": \"%s\", \"faces\": 1}]}",
                 names[i]);
        slv_env env = test_env();
        slv_ptx_writer_params params = {
            .mesh_type = SLV_PTX_QUAD, .nchannels = 3, .alpha_channel = SLV_NO_ALPHA, .nfaces = 1};
        slv_ptx_meta meta = {"SelvageParts", SLV_META_STRING, (uint32_t)strlen(record), record};
        slv_ptx_writer *writer = NULL;
        REQUIRE(!slv_ptx_writer_create(&env, tool_path("evil.ptx"), &params, &writer) &&
                !slv_ptx_writer_set_meta(writer, &meta) && !slv_ptx_writer_finish(writer));
        slv_ptx_writer_destroy(writer);
        RUNS(0, "split evil.ptx evil%zu", i);
        HAS("faces 0 to 0: part_0000.ptx");
    }
    RUNS(0, "merge a.ptx b.ptx -o pair.ptx");
    RUNS(0, "convert pair.ptx fewer.ptx --faces 0-3"); /* its record would be of others */
    RUNS(1, "split fewer.ptx none");
    CHECK(access(tool_path("none"), F_OK) != 0);
}

/* Numbers are drawn into the cells, and cells are large enough for them. */
static void check_sheet(void) {
    slv_image plain = {0}, numbered = {0};
    RUNS(0, "info a.ptx plain.png");
    RUNS(0, "info a.ptx -o ids.png --ids");
    REQUIRE(!slv_image_load(NULL, tool_path("plain.png"), &plain) &&
            !slv_image_load(NULL, tool_path("ids.png"), &numbered));
    REQUIRE(plain.width == numbered.width && plain.height == numbered.height);
    /* 256 pixels a cell, 5 a dot: the number 1 in the second cell stands on black, white in its
     * middle column */
    const uint32_t zoom = 5, left = 256 + 2, n = numbered.nchannels;
    static const char one[5][4] = {".#.", "##.", ".#.", ".#.", "###"};
    for (uint32_t y = 0; y < 7 * zoom; y++)
        for (uint32_t x = 0; x < 5 * zoom; x++) {
            uint32_t dx = x / zoom, dy = y / zoom;
            bool white = dx && dy && dx < 4 && dy < 6 && one[dy - 1][dx - 1] == '#';
            CHECK(numbered.pixels[((size_t)y * numbered.width + left + x) * n] == (white ? 1 : 0));
        }
    size_t differ = 0;
    for (size_t i = 0; i < (size_t)plain.width * plain.height * n; i++)
        differ += plain.pixels[i] != numbered.pixels[i];
    CHECK(differ > 100 && differ < (size_t)plain.width * plain.height * n / 10);
    slv_image_free(&plain);
    slv_image_free(&numbered);
    RUNS(0, "info a.ptx -o small.png --ids --cell 4");
    HAS("do not fit into cells of 4 pixels");
    RUNS(2, "info a.ptx --ids");
    RUNS(2, "info a.ptx plain.png");
    HAS("only --out writes over");
}

/* Words of options and of view files are the same, and all of the library's. */
static void check_words(void) {
    static const char *const schemes[] = {"catmark", "catmull-clark", "bilinear"},
                             *const boundaries[] = {"default", "none", "edge-only",
                                                    "edge-and-corner"};
    char view[128];
    for (int scheme = 0; scheme < 3; scheme++)
        for (int boundary = 0; boundary < 4; boundary++) {
            snprintf(view, sizeof view, "{\"scheme\": \"%s\", \"boundary\": \"%s\"}",
                     schemes[scheme], boundaries[boundary]);
            tool_write_file("words.json", view, strlen(view));
            RUNS(0, "pick a.ptx 256 256 --view words.json");
            static char found[sizeof tool_out];
            memcpy(found, tool_out, sizeof found);
            RUNS(0, "pick a.ptx 256 256 --scheme %s --boundary %s", schemes[scheme],
                 boundaries[boundary]);
            CHECK_MSG(!strcmp(found, tool_out), "%s: %s, %s", view, found, tool_out);
        }
    tool_write_file("words.json", "{\"scheme\": \"lopp\"}", 18);
    RUNS(1, "pick a.ptx 256 256 --view words.json");
    HAS("expected catmark|bilinear|loop");
    RUNS(2, "pick a.ptx 256 256 --scheme catmul-clark");
    HAS("expected catmark|bilinear|loop");
    tool_write_file("words.json", "{\"boundary\": \"edge-ony\"}", 24);
    RUNS(1, "pick a.ptx 256 256 --view words.json");
    HAS("expected default|none|edge-only|edge-and-corner; did you mean 'edge-only'?");
}

int main(void) {
    tool_begin();
    tool_write_noise("a.ptx", SLV_TYPE_U8, 3, SLV_NO_ALPHA, 1);
    tool_write_noise("b.ptx", SLV_TYPE_U8, 3, SLV_NO_ALPHA, 2);
    check_some();
    CHECK(each_sample(check_subsets) >= 10);
    check_split();
    check_split_refused();
    check_sheet();
    check_words();
    tool_end();
    return test_end();
}
