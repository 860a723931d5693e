/* Sizes of faces by cameras: as many texels as pixels, of faces that are seen. */
#include "kit/uv_kit.h"

#include <selvage/ptx.h>

/* Five unit squares: one that faces +z, one behind it, one beside them that leans by 60 degrees,
 * one far to the right, and one whose back is shown. */
static const char obj[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                          "v 0.1 0.1 -1\nv 0.9 0.1 -1\nv 0.9 0.9 -1\nv 0.1 0.9 -1\n"
                          "v -2 0 0\nv -1 0 0\nv -1 0.5 -0.8660254\nv -2 0.5 -0.8660254\n"
                          "v 9 0 0\nv 10 0 0\nv 10 1 0\nv 9 1 0\n"
                          "v 0 -2 0\nv 0 -1 0\nv 1 -1 0\nv 1 -2 0\n"
                          "f 1 2 3 4\nf 5 6 7 8\nf 9 10 11 12\nf 13 14 15 16\nf 17 18 19 20\n";

static void expect(const char *what, const char *view, const char *more, const int want[5][2]) {
    tool_write_file("view.json", view, strlen(view));
    RUNS(0, "bake m.obj --surface position --scheme bilinear --views view.json -o v.ptx %s", more);
    slv_ptx *ptx = tool_open("v.ptx");
    for (uint32_t face = 0; face < 5; face++) {
        slv_ptx_face info;
        REQUIRE(!slv_ptx_get_face(ptx, face, &info));
        CHECK_MSG(info.res.u == want[face][0] && info.res.v == want[face][1],
                  "%s: face %u has 2^%d x 2^%d, not 2^%d x 2^%d", what, face, info.res.u,
                  info.res.v, want[face][0], want[face][1]);
    }
    slv_ptx_close(ptx);
}

#define WINDOW "\"screen_window\": [-4, 4, -4, 4]"
#define FLAT "\"size\": [512, 512], \"projection\": \"orthographic\", " WINDOW
#define FRONT "\"world_to_camera\": [[1,0,0,0],[0,1,0,0],[0,0,1,-8],[0,0,0,1]]"
#define BACK "\"world_to_camera\": [[-1,0,0,0],[0,1,0,0],[0,0,-1,-8],[0,0,0,1]]"

int main(void) {
    tool_begin();
    tool_write_file("m.obj", obj, sizeof obj - 1);
    /* 64 pixels a unit; what leans is half as high */
    expect("front", "{" FLAT ", " FRONT "}", "",
           (const int[5][2]){{6, 6}, {1, 1}, {6, 5}, {1, 1}, {6, 6}});
    expect("twice", "{" FLAT ", " FRONT "}", "--texels-per-pixel 2 --min-size 8",
           (const int[5][2]){{7, 7}, {3, 3}, {7, 6}, {3, 3}, {7, 7}});
    /* from behind the second one is seen, as much smaller as it is; together all but the far one */
    expect("two", "{" FLAT ", \"cameras\": [{" FRONT "}, {" BACK "}]}", "",
           (const int[5][2]){{6, 6}, {6, 6}, {6, 5}, {1, 1}, {6, 6}});
    /* eight units away, a window of 1 at distance 1: 16 pixels a unit in 256 */
    expect("perspective",
           "{\"size\": [256, 256], \"projection\": \"perspective\", \"screen_window\": [-1, 1, -1, "
           "1], " FRONT "}",
           "", (const int[5][2]){{4, 4}, {1, 1}, {4, 3}, {1, 1}, {4, 4}});
    /* a recipe says the same, its file beside it */
    const char *recipe = "{\"source\": {\"surface\": \"position\"}, \"scheme\": \"bilinear\", "
                         "\"views\": \"view.json\", \"texels-per-pixel\": 2}";
    tool_write_file("r.json", recipe, strlen(recipe));
    RUNS(0,
         "bake m.obj --surface position --scheme bilinear --views view.json --texels-per-pixel 2 "
         "-o v.ptx");
    RUNS(0, "bake m.obj --recipe r.json -o r.ptx");
    CHECK(uv_same_files("v.ptx", "r.ptx"));
    RUNS(0, "bake m.obj --surface position --views view.json -o none.ptx --print-recipe");
    HAS("\"views\": \"view.json\"");
    RUNS(0, "bake m.obj --recipe r.json --size 4 -o four.ptx");
    HAS("faces of 4x4");
    const char *wrong = "{\"source\": {\"surface\": \"position\"}, \"views\": 3}";
    tool_write_file("r.json", wrong, strlen(wrong));
    RUNS(1, "bake m.obj --recipe r.json -o none.ptx");
    HAS("view file");
    RUNS(2, "bake m.obj --surface position --views view.json --size 4 -o none.ptx");
    RUNS(2, "bake m.obj --surface position --texels-per-pixel 2 -o none.ptx");
    tool_write_file("view.json", "{}", 2);
    RUNS(1, "bake m.obj --surface position --views view.json -o none.ptx");
    HAS("no camera");
    RUNS(1, "bake m.obj --surface position --views missing.json -o none.ptx");
    CHECK(access(tool_path("none.ptx"), F_OK) != 0);
    tool_end();
    return test_end();
}
