/* Recipes of bake: what sources make of sources, options that stand for a recipe, the schema, bad
 * recipes; and a bake that was ended and goes on. */
#include "kit/uv_kit.h"

#include <selvage/bake_recipe.h>

#include <jansson.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

/* The one texel that a recipe makes of every face. */
static void texel_of(const char *source, uint32_t n, float *out) {
    slv_env env = test_env();
    char text[2000];
    snprintf(text, sizeof text, "{\"source\": %s, \"size\": 2, \"type\": \"float\"}", source);
    slv_bake_recipe *recipe = NULL;
    slv_bake_source *made = NULL;
    slv_mesh *mesh = uv_parse("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n");
    uint8_t missed = 1;
    MUST(slv_bake_recipe_load(&env, NULL, text, &recipe));
    MUST(slv_bake_recipe_source(&env, recipe, mesh, &made));
    REQUIRE(slv_bake_source_get_desc(made)->nchannels == n);
    MUST(slv_bake_evaluate(made, &env, 0, (slv_res){1, 1}, (slv_rect){0, 1, 1, 1}, out, &missed));
    CHECK(!missed);
    slv_bake_source_destroy(made);
    slv_bake_recipe_destroy(recipe);
    slv_mesh_destroy(mesh);
}

static void check_texel(const char *source, uint32_t n, const float *want) {
    float got[4];
    texel_of(source, n, got);
    for (uint32_t c = 0; c < n; c++)
        CHECK_MSG(fabsf(got[c] - want[c]) < 1e-5f, "%s: channel %u is %g, not %g", source, c,
                  (double)got[c], (double)want[c]);
}

#define A "{\"constant\": [0.2, 0.5, 0.8]}"
#define B "{\"constant\": [0.5, 0.25, 1]}"

static void mixes(void) {
    static const struct {
        const char *blend;
        float want[3];
    } blends[] = {{"normal", {0.5f, 0.25f, 1}},         {"multiply", {0.1f, 0.125f, 0.8f}},
                  {"screen", {0.6f, 0.625f, 1}},        {"overlay", {0.2f, 0.25f, 1}},
                  {"add", {0.7f, 0.75f, 1.8f}},         {"subtract", {-0.3f, 0.25f, -0.2f}},
                  {"darken", {0.2f, 0.25f, 0.8f}},      {"lighten", {0.5f, 0.5f, 1}},
                  {"color", {0.529958f, 0.294937f, 1}}, {"replace", {0.5f, 0.25f, 1}}};
    static const float a[3] = {0.2f, 0.5f, 0.8f};
    char text[800];
    for (size_t i = 0; i < sizeof blends / sizeof *blends; i++)
        for (int masked = 0; masked < 2; masked++) {
            float want[3], weight = masked ? 0.5f * 0.4f : 1;
            for (int c = 0; c < 3; c++)
                want[c] = a[c] + weight * (blends[i].want[c] - a[c]);
            snprintf(text, sizeof text, "{\"blend\": \"%s\", \"bottom\": " A ", \"top\": " B "%s}",
                     blends[i].blend,
                     masked ? ", \"opacity\": 0.5, \"mask\": {\"constant\": [0.4]}" : "");
            check_texel(text, 3, want);
        }
    check_texel("{\"blend\": \"multiply\", \"bottom\": " A ", \"top\": {\"constant\": [0.5]}}", 3,
                (const float[]){0.1f, 0.25f, 0.4f});
    /* half of opaque green over half of red: three quarters covered */
    check_texel("{\"blend\": \"normal\", \"opacity\": 0.5, \"bottom\": {\"constant\": [1, 0, 0, "
                "0.5]}, \"top\": {\"constant\": [0, 1, 0, 1]}}",
                4, (const float[]){1 / 3.0f, 2 / 3.0f, 0, 0.75f});
    check_texel("{\"blend\": \"replace\", \"opacity\": 0.5, \"bottom\": {\"constant\": [1, 0, 0, "
                "0.5]}, \"top\": {\"constant\": [0, 1, 0, 1]}}",
                4, (const float[]){0.5f, 0.5f, 0, 0.75f});
    check_texel("{\"levels\": " A ", \"in\": [0.2, 0.6], \"out\": [1, 0]}", 3,
                (const float[]){1, 0.25f, 0});
    check_texel("{\"levels\": " A ", \"in\": [0.2, 0.6], \"clamp\": false}", 3,
                (const float[]){0, 0.75f, 1.5f});
    check_texel("{\"levels\": {\"constant\": [0.25]}, \"gamma\": 2}", 1, (const float[]){0.5f});
    check_texel("{\"channels\": [2, 0], \"of\": " A "}", 2, (const float[]){0.8f, 0.2f});
}

static void refused(const char *text, const char *why) {
    tool_write_file("bad.json", text, strlen(text));
    RUNS(1, "bake m.obj --recipe bad.json -o none.ptx");
    HAS(why);
    CHECK(access(tool_path("none.ptx"), F_OK) != 0);
}

static void refusals(void) {
    char deep[9000] = "{\"source\": ";
    for (int i = 0; i < 100; i++)
        strcat(deep, "{\"levels\": ");
    refused("{", "bad.json: line 1");
    refused("[]", "expected an object");
    refused("{}", "source: is missing");
    refused("{\"source\": {}}", "has none of uv");
    refused("{\"source\": {\"pattern\": \"dots\"}}", "expected one of stripes|noise");
    refused("{\"source\": {\"pattern\": \"noise\", \"seeds\": 3}}",
            "unknown field 'seeds'; did you mean 'seed'?");
    refused("{\"source\": {\"rays\": \"ao\", \"samples\": 0}}", "from 1 to 65536");
    refused("{\"source\": {\"rays\": \"ao\"}, \"size\": 3}", "power of two");
    refused("{\"source\": {\"rays\": \"ao\"}, \"size\": 4, \"density\": 2}", "one of them");
    refused("{\"source\": {\"blend\": \"add\", \"bottom\": " A "}}", "source: top: is missing");
    refused("{\"source\": {\"blend\": \"add\", \"bottom\": {\"levels\": 3}, \"top\": " A "}}",
            "source.bottom.levels: expected an object");
    refused("{\"source\": {\"blend\": \"add\", \"bottom\": " A ", \"top\": {\"channels\": [0, "
            "1], \"of\": " B "}}}",
            "2 colours over 3");
    refused("{\"source\": {\"channels\": [5], \"of\": " A "}}", "0 to 3");
    refused("{\"source\": {\"channels\": [3], \"of\": " A "}}", "there is no channel 3");
    refused("{\"source\": {\"uv\": \"missing.png\"}}", "missing.png");
    refused("{\"source\": {\"levels\": " A ", \"in\": [1, 1]}}", "two different");
    refused("{\"source\": {\"carry\": " A ", \"mesh\": \"m.obj\", \"front\": 1}}",
            "front: does nothing but by rays");
    refused("{\"source\": {\"carry\": " A ", \"mesh\": \"m.obj\", \"by\": \"rays\", "
            "\"distance\": 1}}",
            "distance: does nothing by rays");
    refused("{\"source\": {\"detail\": \"m.obj\", \"kind\": \"object-normal\", \"cage\": "
            "\"m.obj\", \"front\": 1}}",
            "front: does nothing with a cage");
    for (int i = 0; i < 100; i++)
        strcat(deep, i ? "}" : A "}");
    strcat(deep, "}");
    refused(deep, "nested deeper");
    RUNS(2, "bake m.obj --recipe bad.json --pattern noise -o none.ptx");
    RUNS(2, "bake m.obj --recipe bad.json --wrap none -o none.ptx");
    HAS("--wrap: a recipe says it in its source");
}

/* Options are a recipe: printed, and run, it makes the same file. */
static void options(void) {
    static const char *const lines[] = {
        "--pattern noise --frequency 3 --seed 5 --size 8 --type half",
        "--rays ao --samples 8 --texels 500 --reductions plain",
        "--uv ramp.exr --match 2 --wrap clamp --max-size 16 --no-reductions --max-miss 1",
        "--surface normal --density 9 --scheme bilinear --compression 12"};
    uv_write_image("ramp.exr", 32, 32, 3, uv_ramp, &uv_floats);
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        RUNS(0, "bake m.obj %s -o a.ptx", lines[i]);
        RUNS(0, "bake m.obj %s --print-recipe", lines[i]);
        tool_write_file("printed.json", tool_out, strlen(tool_out));
        RUNS(0, "bake m.obj --recipe printed.json -o b.ptx");
        CHECK_MSG(uv_same_files("a.ptx", "b.ptx"), "%s", lines[i]);
    }
    /* files are beside the recipe, and options take the place of its fields */
    MUST((slv_result)mkdir(tool_path("sub"), 0777));
    static const char recipe[] = "{\"source\": {\"uv\": \"../ramp.exr\"}, \"match\": 2}";
    tool_write_file("sub/r.json", recipe, sizeof recipe - 1);
    RUNS(0, "bake m.obj --recipe sub/r.json --size 8 --max-miss 1 -o c.ptx");
    RUNS(0, "bake m.obj --uv ramp.exr --size 8 --max-miss 1 -o d.ptx");
    CHECK(uv_same_files("c.ptx", "d.ptx"));
    CHECK(access(tool_path("none.ptx"), F_OK) != 0);
}

static float spots(uint32_t channel, float u, float v) {
    (void)channel;
    return u < 0.5f && v < 0.5f ? 0.5f + 0.5f * sinf(60 * u) * sinf(50 * v * v) : 0.5f;
}

static double json_of(const char *field) {
    json_error_t error;
    json_t *root = json_loads(tool_out, 0, &error);
    double value = json_number_value(json_object_get(root, field));
    json_decref(root);
    return value;
}

/* Within the budget, and no error that is a quarter smaller would be. */
static void least_error(void) {
    static const char all_levels[] =
        "{\"source\": {\"uv\": \"spots.exr\"}, \"error\": 0.1, \"reductions\": \"all\"}";
    uv_write_image("spots.exr", 128, 128, 1, spots, &uv_floats);
    RUNS(0, "bake m.obj --uv spots.exr --texels 3000 --least-error --json --quiet -o l.ptx");
    double texels = json_of("texels"), error = json_of("error");
    CHECK_MSG(texels <= 3000 && texels > 300 && error > 0, "%g texels, %g", texels, error);
    RUNS(0, "bake m.obj --uv spots.exr --error %g --json --quiet -o l.ptx", 0.75 * error);
    CHECK_MSG(json_of("texels") > 3000, "%g texels do", json_of("texels"));
    RUNS(2, "bake m.obj --uv spots.exr --least-error -o none.ptx");
    RUNS(2, "bake m.obj --uv spots.exr --error 0.1 --reductions all -o none.ptx");
    HAS("--reductions all changes full resolution");
    tool_write_file("all.json", all_levels, sizeof all_levels - 1);
    RUNS(1, "bake m.obj --recipe all.json -o none.ptx");
    HAS("another once faces agree");
    RUNS(1, "bake m.obj --uv spots.exr --texels 1 --least-error -o none.ptx");
    HAS("too few");
}

/* Every field of the schema is known to the reader, and what the schema leaves out is not. */
static void schema(void) {
    json_error_t error;
    char path[1000];
    REQUIRE(getenv("SELVAGE_TESTS"));
    snprintf(path, sizeof path, "%s/../docs/bake-recipe.schema.json", getenv("SELVAGE_TESTS"));
    json_t *root = json_load_file(path, 0, &error);
    json_t *kinds =
               json_object_get(json_object_get(json_object_get(root, "$defs"), "source"), "oneOf"),
           *kind;
    size_t i, fields = 0;
    REQUIRE(json_array_size(kinds) == 13);
    json_array_foreach(kinds, i, kind) {
        const char *first = json_string_value(json_array_get(json_object_get(kind, "required"), 0)),
                   *key;
        json_t *value;
        char text[400];
        json_object_foreach(json_object_get(kind, "properties"), key, value) {
            snprintf(text, sizeof text, "{\"source\": {\"%s\": {}, \"%s\": {}}}", first, key);
            if (strcmp(first, key) == 0)
                snprintf(text, sizeof text, "{\"source\": {\"%s\": {}}}", first);
            tool_write_file("field.json", text, strlen(text));
            RUNS(1, "bake m.obj --recipe field.json -o none.ptx");
            LACKS("unknown field");
            fields++;
        }
    }
    CHECK(fields > 30);
    json_decref(root);
}

/* Ended by a signal after some blocks; the same command then bakes only the rest. */
static void resume(void) {
    static const char line[] =
        "bake big.obj --rays ao --samples 1024 --size 16 --threads 2 --quiet -o r.ptx";
    struct stat status = {0};
    char folder[600];
    size_t used = 0;
    static char obj[9000];
    for (int i = 0; i <= 48; i++)
        used += (size_t)snprintf(obj + used, sizeof obj - used, "v %d 0 0\nv %d 1 %g\n", i, i,
                                 (double)(i % 3) / 4);
    for (int i = 0; i < 48; i++)
        used += (size_t)snprintf(obj + used, sizeof obj - used, "f %d %d %d %d\n", 2 * i + 1,
                                 2 * i + 3, 2 * i + 4, 2 * i + 2);
    tool_write_file("big.obj", obj, used);
    RUNS(0, "%s", line);
    RUNS(0, "diff r.ptx r.ptx");
    REQUIRE(rename(tool_path("r.ptx"), tool_path("whole.ptx")) == 0);
    snprintf(folder, sizeof folder, "%s", tool_path("."));
    pid_t child = fork();
    REQUIRE(child >= 0);
    if (!child) {
        char *arguments[] = {(char *)(uintptr_t) "bake",
                             "big.obj",
                             "--rays",
                             "ao",
                             "--samples",
                             "1024",
                             "--size",
                             "16",
                             "--threads",
                             "2",
                             "--quiet",
                             "-o",
                             "r.ptx",
                             "--resume",
                             NULL};
        _exit(chdir(folder) ? 9 : verb_bake(14, arguments));
    }
    for (int i = 0; i < 6000 && status.st_size < 8000; i++) {
        usleep(5000);
        if (stat(tool_path("r.ptx.part"), &status))
            status.st_size = 0;
    }
    kill(child, SIGKILL);
    int how;
    REQUIRE(waitpid(child, &how, 0) == child && WIFSIGNALED(how));
    CHECK(access(tool_path("r.ptx"), F_OK) != 0 && status.st_size >= 8000);
    /* a torn end, as a machine leaves it that stops */
    FILE *part = fopen(tool_path("r.ptx.part"), "ab");
    REQUIRE(part && fputs("torn", part) >= 0 && fclose(part) == 0);
    RUNS(0, "%s --resume", line);
    CHECK(uv_same_files("r.ptx", "whole.ptx"));
    CHECK(access(tool_path("r.ptx.part"), F_OK) != 0);
    tool_write_file("r.ptx.part", "something else altogether", 25);
    RUNS(1, "%s --resume", line);
    HAS("no bake that was begun");
    CHECK(uv_same_files("r.ptx", "whole.ptx"));
}

/* A recipe is read as every text is. */
static void texts(void) {
    static const char text[] = "\xef\xbb\xbf{\"source\": {\"constant\": [0.5]}, \"size\": 2}\r\n";
    tool_write_file("marked.json", text, sizeof text - 1);
    RUNS(0, "bake m.obj --recipe marked.json -o marked.ptx");
    char line[300];
    snprintf(line, sizeof line, "gzip -nk '%s'", tool_path("marked.json"));
    CHECK(system(line) == 0);
    RUNS(0, "bake m.obj --recipe marked.json.gz -o packed.ptx");
    RUNS(0, "diff marked.ptx packed.ptx");
    tool_write_file("wide.json", "\xff\xfe{\0}\0", 6);
    RUNS(1, "bake m.obj --recipe wide.json -o none.ptx");
    HAS("UTF-16");
}

int main(void) {
    static const char obj[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 .5\nv 2 1 .5\n"
                              "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n"
                              "f 2/1 5/2 6/3 3/4\n";
    tool_begin();
    tool_write_file("m.obj", obj, sizeof obj - 1);
    mixes();
    refusals();
    texts();
    options();
    schema();
    least_error();
    resume();
    tool_end();
    return test_end();
}
