/* selvage paint: scripts that paint, and scripts that are wrong. */
#include "kit/mesh_shapes.h"
#include "kit/tool_kit.h"

#include <selvage/image.h>

static const char box[] = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\n"
                          "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

static void write_script(const char *text) {
    tool_write_file("s.jsonl", text, strlen(text));
}

static void texel(uint32_t face, float u, float v, float out[3]) {
    slv_env env = test_env();
    slv_ptx *ptx = tool_open("out.ptx");
    slv_texture *texture = NULL;
    MUST(slv_ptx_load_texture(&env, ptx, &texture));
    slv_res res = slv_texture_get_desc(texture)->res[face];
    slv_texture_fetch(texture, face, (uint32_t)(u * (float)(1 << res.u)),
                      (uint32_t)(v * (float)(1 << res.v)), out);
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
}

static void paints(void) {
    float c[3];
    write_script("# red over an edge, then a fill\n"
                 "{\"op\": \"set\", \"radius\": 0.4, \"color\": [1, 0, 0]}\n\n"
                 "{\"brush\": {\"hardness\": 1, \"spacing\": 0.2}, \"samples\": "
                 "[[1, 0.5, 0.5], [1, 0.95, 0.5], [3, 0.5, 0.9]]}\n"
                 "{\"op\": \"fill\", \"face\": 0, \"color\": [0, 0, 1]}");
    RUNS(0, "paint box.ptx s.jsonl out.ptx --scheme bilinear --list-faces");
    HAS("2 operations");
    HAS("seams after");
    HAS("  face 3\n");
    LACKS("  face 5\n");
    texel(1, 0.97f, 0.5f, c);
    CHECK(c[0] > 0.99f && c[1] < 0.01f);
    texel(3, 0.5f, 0.95f, c);
    CHECK(c[0] > 0.99f && c[1] < 0.01f);
    texel(0, 0.5f, 0.5f, c);
    CHECK(c[2] > 0.99f && c[0] < 0.01f);
    texel(5, 0.5f, 0.5f, c);
    CHECK(fabsf(c[0] - 192.0f / 255) < 1e-6f);
    RUNS(0, "check out.ptx");
    write_script("{\"blur\": 0.5, \"radius\": 0.5, \"samples\": [[1, 0.8, 0.5]]}");
    RUNS(0, "paint out.ptx s.jsonl blurred.ptx --scheme bilinear");
    RUNS(1, "diff out.ptx blurred.ptx");
    /* the same on a mesh, on one thread and on four */
    RUNS(0, "paint box.obj s.jsonl a.ptx --threads 1 --json");
    HAS("\"touched\"");
    RUNS(0, "paint box.obj s.jsonl b.ptx --threads 4 --quiet");
    RUNS(0, "diff a.ptx b.ptx");
    RUNS(0, "paint box.ptx s.jsonl box.ptx --quiet");
}

/* A thin paint put on a hundred times adds up, though 8 bits would lose each of them. */
static void thin_paint(void) {
    static char text[16384];
    float c[3];
    size_t used = 0;
    for (int i = 0; i < 100; i++)
        used += (size_t)snprintf(text + used, sizeof text - used,
                                 "{\"op\": \"fill\", \"face\": 5, \"select\": \"connected\", "
                                 "\"color\": [0, 0, 0], \"opacity\": 0.001}\n");
    write_script(text);
    RUNS(0, "new box.obj box.ptx --size 64 --quiet");
    RUNS(0, "paint box.ptx s.jsonl out.ptx --quiet");
    texel(2, 0.5f, 0.5f, c);
    CHECK_MSG(fabs((double)c[0] - 192.0 / 255 * pow(0.999, 100)) < 1.0 / 255, "%g", (double)c[0]);
}

static bool same_files(const char *a, const char *b) {
    char path[512];
    snprintf(path, sizeof path, "%s", tool_path(a));
    FILE *one = fopen(path, "rb"), *other = fopen(tool_path(b), "rb");
    int x = 0;
    bool same = one && other;
    while (same && x != EOF)
        same = (x = getc(one)) == getc(other);
    if (one)
        fclose(one);
    if (other)
        fclose(other);
    return same;
}

/* A session is painted on in its place, or as a copy; a .ptx of it leaves it as it was. */
static void sessions(void) {
    write_script("{\"op\": \"set\", \"radius\": 0.4, \"color\": [1, 0, 0]}\n"
                 "{\"brush\": {\"hardness\": 1}, \"samples\": [[1, 0.5, 0.5], [3, 0.5, 0.9]]}\n"
                 "# nothing\n"
                 "{\"op\": \"fill\", \"face\": 0, \"color\": [0, 0, 1]}");
    RUNS(0, "new box.obj blank.ptx --size 64 --quiet");
    RUNS(0, "paint blank.ptx s.jsonl out.ptx --quiet");
    RUNS(0, "paint blank.ptx s.jsonl a.selvage --list-faces");
    HAS("2 operations");
    HAS("  face 3\n");
    RUNS(0, "session a.selvage --export a.ptx");
    HAS("0 since it was saved");
    RUNS(1, "diff a.ptx blank.ptx");
    /* 16 bits and floats are rounded to 8 bits alike, but for a tie */
    RUNS(0, "diff a.ptx out.ptx --tolerance 0.004");
    RUNS(1, "paint blank.ptx s.jsonl a.selvage");
    HAS("is there already");
    write_script("{\"op\": \"fill\", \"face\": 5, \"color\": [0, 1, 0]}\n");
    RUNS(0, "paint a.selvage s.jsonl b.ptx --json");
    HAS("\"operations\": 1");
    RUNS(0, "session a.selvage --export c.ptx");
    HAS("0 since it was saved");
    RUNS(0, "diff a.ptx c.ptx");
    RUNS(0, "paint a.selvage s.jsonl b.selvage --quiet");
    RUNS(0, "session a.selvage --export c.ptx");
    RUNS(0, "diff a.ptx c.ptx");
    RUNS(0, "session b.selvage --export c.ptx");
    RUNS(0, "diff b.ptx c.ptx");
    RUNS(0, "paint a.selvage s.jsonl --layer 1");
    HAS("1 operations, 0 dabs, 1 of 6 faces touched");
    RUNS(0, "session a.selvage --export c.ptx");
    HAS("1 since it was saved; 1 to undo");
    RUNS(0, "diff b.ptx c.ptx");
    write_script("{\"op\": \"fill\", \"face\": 5}\n{\"op\": \"dance\"}\n");
    RUNS(1, "paint a.selvage s.jsonl e.selvage");
    HAS("s.jsonl: line 2: ");
    CHECK(access(tool_path("e.selvage"), F_OK) != 0);
    RUNS(1, "paint a.selvage s.jsonl");
    HAS("s.jsonl: line 2: ");
    RUNS(2, "paint blank.ptx s.jsonl");
    RUNS(2, "paint a.selvage s.jsonl --scheme loop");
    RUNS(2, "paint blank.ptx s.jsonl out.ptx --layer 1");
    RUNS(2, "paint blank.ptx s.jsonl out.ptx --azimuth 3");
    RUNS(2, "paint blank.ptx s.jsonl out.ptx --record stage.txt");
}

/* A picture before and after each stroke: the last shows what the written file does. Faces that had
 * one value go elsewhere on the GPU meanwhile. */
static void pictures(void) {
    write_script("{\"radius\": 0.3, \"color\": [1, 0, 0], \"samples\": [[1, 0.5, 0.5]]}\n"
                 "{\"op\": \"set\", \"radius\": 0.2}\n"
                 "{\"color\": [0, 1, 0], \"samples\": [[3, 0.5, 0.5], [3, 0.8, 0.5]]}\n");
    RUNS(0, "paint blank.ptx s.jsonl p.selvage --record st.##.png --size 48x32 --certify --json");
    HAS("\"pictures\": 3");
    HAS("\"line\": 3");
    LACKS("\"line\": 2");
    CHECK(access(tool_path("st.02.png"), F_OK) == 0 && access(tool_path("st.03.png"), F_OK) != 0);
    RUNS(0, "session p.selvage --export p.ptx");
    write_script("# nothing\n");
    RUNS(0, "paint p.selvage s.jsonl --record again.png --size 48x32");
    CHECK(same_files("again.0000.png", "st.02.png"));
    CHECK(!same_files("st.01.png", "st.02.png") && !same_files("st.00.png", "st.01.png"));
    RUNS(1, "paint p.selvage s.jsonl --record missing/x.png");
}

/* A picture of 4 x 2 pixels, red but for its left quarter, which is clear. */
static void write_picture(const char *name) {
    slv_env env = test_env();
    slv_image image = {0};
    const slv_image_params raw = {.encoding = SLV_ENCODE_RAW};
    MUST(slv_image_create(&env, 4, 2, 4, &image));
    for (uint32_t i = 0; i < 8; i++) {
        image.pixels[4 * i] = 1;
        image.pixels[4 * i + 3] = i % 4 > 0;
    }
    MUST(slv_image_save(&env, tool_path(name), &image, &raw));
    slv_image_free(&image);
}

/* On the other side of a plane a stamp is turned over, and a legible one as it was. */
static void legible(void) {
    char line[512];
    float left[3], right[3];
    write_picture("red.png");
    for (int i = 0; i < 4; i++) {
        bool reads = i & 1, project = i & 2;
        snprintf(line, sizeof line,
                 "{\"stamp\": {\"file\": \"red.png\", \"legible\": %s}, \"mirror\": [{\"point\": "
                 "[1, 0, 0], \"normal\": [1, 0, 0]}], \"brush\": {\"hardness\": 1}, %s}\n",
                 reads ? "true" : "false",
                 project ? "\"size\": [64, 64], \"camera\": {\"azimuth\": 0, \"elevation\": 0}, "
                           "\"project\": true, \"unit\": \"pixels\", \"radius\": 8, \"samples\": "
                           "[[24, 32]]"
                         : "\"radius\": 0.4, \"samples\": [[1, 0.25, 0.5]]");
        write_script(line);
        RUNS(0, "paint blank.ptx s.jsonl out.ptx --scheme bilinear --quiet");
        texel(1, project ? 0.59f : 0.635f, 0.5f, left);
        texel(1, project ? 0.73f : 0.865f, 0.5f, right);
        CHECK_MSG((left[1] > 0.1f) == reads, "%d: %g", i, (double)left[1]);
        CHECK_MSG((right[1] > 0.1f) != reads, "%d: %g", i, (double)right[1]);
    }
}

/* Images, gradients, clones, masks, symmetry and fills by colour from scripts, and the same of a
 * session, which keeps the images that lines name. */
static void laid(void) {
    static const char *const lines[] = {
        "{\"stamp\": \"red.png\", \"radius\": 0.5, \"samples\": [[1, 0.5, 0.5]]}",
        "{\"op\": \"fill\", \"face\": 1, \"select\": \"connected\", \"size\": [64, 64], "
        "\"camera\": {\"azimuth\": 0, \"elevation\": 0}, \"image\": {\"file\": \"red.png\", "
        "\"at\": [32, 32], \"width\": 90, \"angle\": 20}}",
        "{\"op\": \"fill\", \"face\": 1, \"color\": [1, 0, 0], \"gradient\": {\"from\": [0, 0, 0], "
        "\"to\": [2, 2, 2], \"color\": [0, 0, 1], \"radial\": true}}",
        "{\"clone\": [1, 0.5, 0.5], \"radius\": 0.4, \"samples\": [[3, 0.5, 0.5], [3, 0.5, "
        "0.7]]}",
        "{\"op\": \"fill\", \"face\": 1, \"select\": \"connected\", \"color\": [0, 1, 0], "
        "\"where\": {\"towards\": [0, 1, 0], \"degrees\": 30}}",
        "{\"op\": \"fill\", \"face\": 1, \"select\": \"connected\", \"color\": [0, 1, 1], "
        "\"opacity\": 0.5, \"where\": {\"channel\": 1, \"inverse\": true, \"faces\": [0, 1, "
        "2]}}",
        "{\"op\": \"set\", \"symmetry\": {\"face\": 1, \"edge\": 1}}",
        "{\"radius\": 0.2, \"color\": [1, 1, 0], \"samples\": [[1, 0.2, 0.3]]}",
        "{\"op\": \"fill\", \"face\": 5, \"select\": \"color\", \"at\": [0.1, 0.1], "
        "\"tolerance\": 0.02, \"color\": [0, 0, 0], \"symmetry\": null}"};
    static char text[4096];
    size_t used = 0;
    float c[3];
    write_picture("red.png");
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, "%s\n", lines[i]);
    write_script(lines[0]);
    RUNS(0, "paint blank.ptx s.jsonl out.ptx --scheme bilinear --quiet");
    texel(1, 0.55f, 0.5f, c);
    CHECK(c[0] > 0.99f && c[1] < 0.01f);
    texel(1, 0.5f, 0.7f, c); /* beside it: it is half as high as wide */
    CHECK(c[1] > 0.5f);
    write_script(text);
    RUNS(0, "paint blank.ptx s.jsonl out.ptx --scheme bilinear");
    HAS("8 operations");
    RUNS(0, "paint blank.ptx s.jsonl four.ptx --scheme bilinear --threads 4 --quiet");
    RUNS(0, "diff out.ptx four.ptx");
    texel(5, 0.1f, 0.1f, c);
    CHECK(c[0] < 0.01f && c[2] < 0.01f);
    RUNS(0, "paint blank.ptx s.jsonl l.selvage --scheme bilinear --quiet");
    RUNS(0, "paint l.selvage s.jsonl look.ptx --quiet");
    CHECK(unlink(tool_path("red.png")) == 0);
    RUNS(0, "session l.selvage --export l.ptx");
    write_script("{\"op\": \"fill\", \"face\": 2, \"color\": [0, 0, 1], \"where\": {\"layer\": 2, "
                 "\"channel\": 3}}");
    RUNS(0, "paint l.selvage s.jsonl --layer 1");
    RUNS(1, "paint blank.ptx s.jsonl out.ptx");
    HAS("where: expected no layer");
    RUNS(0, "new box.obj bytes.ptx --size 16");
    write_script("{\"op\": \"fill\", \"face\": 2, \"color\": [0, 255, 0]}\n"
                 "{\"op\": \"fill\", \"face\": 3, \"color\": [0, 1, 0]}");
    RUNS(0, "paint bytes.ptx s.jsonl out.ptx");
    HAS("line 1: color: 255 becomes 1");
    LACKS("line 2");
    write_script("{\"op\": \"fill\", \"face\": 2, \"color\": [0, -3, 0]}");
    RUNS(0, "paint bytes.ptx s.jsonl out.ptx");
    HAS("line 1: color: -3 becomes 0");
    RUNS(0, "new box.obj half.ptx --size 16 --type half");
    RUNS(0, "paint half.ptx s.jsonl out.ptx");
    LACKS("becomes");
}

/* As many lines as there are ways to be wrong, since they are one table. */
static void wrong_scripts(void) {
    static const struct {
        const char *text, *says;
    } scripts[] = {
        {"{", "line 1"},
        {"{\"samples\": [[0, 0.5, 0.5]], \"unit\": \"pixels\", \"radius\": 3}",
         "line 1: unit: expected world or texels"},
        {"{\"samples\": [[0, 0.5, 0.5]], \"unit\": \"texels\"}", "line 1: radius: expected one"},
        {"{\"samples\": [[0, 0.5, 0.5]], \"radius\": 1, \"mirror\": [{\"point\": [0,0,0], "
         "\"normal\": [0,0,0]}]}",
         "mirror: expected normals of some length"},
        {"{\"samples\": [[0, 0.5, 0.5]], \"radius\": 1, \"where\": {\"faces\": [0, 99]}}",
         "where: there is no face 99, they are 0 to 5"},
        {"{\"samples\": [[0, 0.5, 0.5]], \"radius\": 1, \"where\": {\"channel\": 7}}",
         "where: there is no channel 7, they are 0 to 2"},
        {"{\"samples\": [[0, 0.5, 0.5]], \"radius\": 1, \"where\": {\"towards\": [0,0,0], "
         "\"degrees\": 30}}",
         "where: expected towards as three numbers"},
        {"{\"samples\": [[0, 0.5, 0.5]], \"radius\": 1, \"where\": {\"degrees\": 300}}",
         "where: expected degrees as a number, more than 0"},
        {"{\"samples\": [[0, 0.5, 0.5]], \"radius\": 1, \"symmetry\": {\"face\": 0, \"edge\": 7}}",
         "symmetry: there is no edge 7, they are 0 to 3"},
        {"{\"samples\": [[0, 0.5, 0.5]], \"radius\": 1, \"symmetry\": {\"pair\": [[0, 1], [77, "
         "1]]}}",
         "symmetry: there is no face 77"},
        {"{\"camera\": {\"fov\": 175}, \"size\": [9, 9], \"samples\": [[1, 1]]}",
         "fov: expected degrees, up to 170"},
        {"\n\n[]", "line 3"},
        {"{\"op\": \"dance\"}", "op: expected"},
        {"{\"radious\": 1, \"samples\": [[0, 0, 0]]}",
         "unknown key 'radious'; did you mean 'radius'?"},
        {"{\"samples\": [[0, 0, 0]]}", "radius"},
        {"{\"radius\": 1}", "samples"},
        {"{\"radius\": -1, \"samples\": [[0, 0, 0]]}", "radius"},
        {"{\"radius\": 1, \"samples\": [[6, 0, 0]]}", "sample 0"},
        {"{\"radius\": 1, \"samples\": [[0, 0, 0], [0, 2, 0]]}", "sample 1"},
        {"{\"radius\": 1, \"samples\": [[0, 0]]}", "sample 0"},
        {"{\"op\": \"fill\", \"face\": 1, \"gradient\": {}}", "gradient: expected"},
        {"{\"op\": \"fill\", \"face\": 1, \"image\": \"no.png\"}", "no.png"},
        {"{\"op\": \"fill\", \"face\": 1, \"clone\": [0, 0, 0]}", "clones are for"},
        {"{\"op\": \"fill\", \"face\": 1, \"where\": {\"degrees\": 3}}", "towards"},
        {"{\"op\": \"fill\", \"face\": 1, \"where\": {\"facing\": true}}", "camera"},
        {"{\"op\": \"fill\", \"face\": 1, \"symmetry\": {\"face\": 1}}", "symmetry"},
        {"{\"op\": \"fill\"}", "face"},
        {"{\"op\": \"fill\", \"face\": 6}", "face"},
        {"{\"op\": \"fill\", \"face\": 1, \"opacity\": 2}", "opacity"},
        {"{\"radius\": 1, \"brush\": 7, \"samples\": [[0, 0, 0]]}", "brush"},
        {"{\"radius\": 1, \"brush\": \"no.myb\", \"samples\": [[0, 0, 0]]}", "no.myb"},
        {"{\"radius\": 1, \"brush\": {\"hard\": 1}, \"samples\": [[0, 0, 0]]}", "hard"},
        {"{\"brush\": {\"hardnes\": 1}}", "brush: unknown key 'hardnes'; did you mean 'hardness'?"},
        {"{\"brush\": {\"hardness\": 2}}", "brush: hardness: expected a number from 0 to 1"},
        {"{\"brush\": {\"aspect\": 0.5}}", "brush: aspect: expected a number from 1 to 1000"},
        {"{\"brush\": {\"follow\": 1}}", "brush: follow: expected true or false"},
        {"{\"radius\": 1, \"camera\": {}, \"samples\": [[0, 0]]}", "size"},
        {"{\"radius\": 1, \"size\": [9, 9], \"camera\": {\"azimut\": 3}, \"samples\": [[1, 1]]}",
         "camera: expected world_to_camera"},
        {"{\"radius\": 1, \"size\": [9, 9], \"camera\": {\"world_to_camera\": [0,0,0,0,0,0,0,0,0,0,"
         "0,0,0,0,0,1], \"window\": [-1,1,-1,1]}, \"samples\": [[1, 1]]}",
         "that turn and move"},
        {"{\"radius\": 1, \"channels\": [0.7, 1.9], \"samples\": [[0, 0, 0]]}", "channels"},
        {"{\"radius\": 1, \"face\": 1, \"samples\": [[0, 0, 0]]}", "face: expected a fill"},
        {"{\"radius\": 1, \"mirror\": [{\"point\": [0,0,0], \"normal\": [1,0,0], \"foo\": 1}], "
         "\"samples\": [[0, 0, 0]]}",
         "planes with a point"},
        {"{\"radius\": 1e30, \"samples\": [[0, 0, 0]]}", "at most 1e18"},
        {"{\"radius\": 1, \"samples\": [[0, 0, 0, 7]]}", "pressures from 0 to 1"},
        {"{\"radius\": 1, \"samples\": [[0, 0, 0, 1, 0, 2]]}", "tilts from -1 to 1"},
        {"{\"radius\": 1, \"samples\": [[0, 0, 0, 1, 2], [0, 1, 0, 1, 1]]}",
         "sample 1: at 1 seconds, after one at 2"},
        {"{\"radius\": 1, \"samples\": [[7, 0, 0]]}", "of 6 faces"},
        {"{\"radius\": 1, \"channels\": [3, 1], \"samples\": [[0, 0, 0]]}",
         "no channels 3 to 3, the last is 2"},
        {"{\"radius\": 1, \"channels\": [0, 4], \"samples\": [[0, 0, 0]]}",
         "no channels 0 to 3, the last is 2"},
        {"{\"radius\": 1, \"project\": true, \"samples\": [[0, 0, 0]]}", "a camera"},
        {"{\"op\": \"set\", \"radius\": 1, \"samples\": [[0, 0, 0]]}", "samples: expected"},
        {"{\"op\": \"fill\", \"face\": 1, \"samples\": [[0, 0, 0]]}", "samples: expected"},
        {"{\"radius\": 1, \"samples\": [[0, 0, 0]], \"mirror\": [{\"point\": [0, 0, 0], "
         "\"normal\": [0, 0, 0]}]}",
         "mirror: expected normals of some length"}};
    for (size_t i = 0; i < sizeof scripts / sizeof *scripts; i++) {
        write_script(scripts[i].text);
        unlink(tool_path("out.ptx"));
        RUNS(1, "paint box.ptx s.jsonl out.ptx");
        HAS(scripts[i].says);
        const char *named = strstr(tool_out, "s.jsonl: line ");
        CHECK_MSG(named && !strstr(named + 1, "s.jsonl"), "%s", tool_out);
        CHECK(access(tool_path("out.ptx"), F_OK) != 0);
        CHECK_MSG(strchr(tool_out, '\n') == tool_out + strlen(tool_out) - 1, "%s", tool_out);
    }
    RUNS(2, "paint box.ptx s.jsonl out.obj");
    RUNS(2, "paint box.ptx");
    RUNS(1, "paint box.ptx missing.jsonl out.ptx");
}

int main(void) {
    tool_begin();
    tool_write_file("box.obj", box, sizeof box - 1);
    RUNS(0, "new box.obj box.ptx --size 64 --quiet");
    paints();
    thin_paint();
    sessions();
    pictures();
    laid();
    legible();
    wrong_scripts();
    tool_end();
    return test_end();
}
