/* What comes through a pipe is read as a file is, by every verb that reads one file: from standard
 * input, from a descriptor, and from a pipe that has a name. */
#include "kit/tool_kit.h"

#include <sys/stat.h>

static const char *const ways[] = {"-", "/dev/fd/3", "pipe"};
static const char *const redirections[] = {"<pipe", "3<pipe", ""};

/* Runs `selvage BEFORE input AFTER`, the input being the file through a pipe. */
static void feed(int code, size_t way, const char *before, const char *path, const char *after) {
    RUNS(code, "%s %s %s %s & cat '%s' >'%s'; wait $!", before, ways[way], after, redirections[way],
         path, tool_path("pipe"));
}

static void check_answers(size_t way, const char *path) {
    static const char *const verbs[][3] = {{"info --json", "", "\"faces\""},
                                           {"check", "", "sound"},
                                           {"sample -i lookups", "", "-> "},
                                           {"sample --texture-encoding srgb -i lookups", "", "-> "},
                                           {"diff same.ptx", "", "equal"}};
    for (size_t i = 0; i < sizeof verbs / sizeof *verbs; i++) {
        static char whole[sizeof tool_out];
        RUNS(0, "%s '%s' %s", verbs[i][0], path, verbs[i][1]);
        snprintf(whole, sizeof whole, "%s", tool_out);
        HAS(verbs[i][2]);
        feed(0, way, verbs[i][0], path, verbs[i][1]);
        HAS(verbs[i][2]);
        /* all but the name */
        const char *a = strchr(whole, '\n'), *b = strchr(tool_out, '\n');
        CHECK_MSG(i == 0 || (a && b && strcmp(a, b) == 0), "%s:\n%s\nbut\n%s", verbs[i][0], whole,
                  tool_out);
    }
}

static void check_files(size_t way, const char *path) {
    feed(0, way, "convert", path, "-o piped.ptx");
    CHECK(same_bytes(tool_path("piped.ptx"), tool_path("same.ptx")));
    feed(0, way, "info --sheet piped.png", path, "");
    CHECK(same_bytes(tool_path("piped.png"), tool_path("same.png")));
}

/* A mesh too; what is no texture is named, and nobody is waited for who never writes. */
static void check_others(const char *path) {
    RUNS(0, "info pipe & printf 'v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n' >'%s'; wait $!",
         tool_path("pipe"));
    HAS("control mesh");
    RUNS(1, "check - <pipe & printf 'Ptexx' >'%s'; wait $!", tool_path("pipe"));
    HAS("standard input\n");
    LACKS("/dev/");
    static const char *const nonsense[] = {"convert - -o never.ptx", "diff pipe '%s'",
                                           "render - --quiet", "info --json pipe"};
    for (size_t i = 0; i < sizeof nonsense / sizeof *nonsense; i++) {
        char line[1200];
        snprintf(line, sizeof line, nonsense[i], path);
        RUNS(strncmp(line, "diff", 4) == 0 ? 2 : 1, "%s %s & printf 'hello' >'%s'; wait $!", line,
             strchr(line, '-') && strstr(line, " -") && !strstr(line, "pipe") ? "<pipe" : "",
             tool_path("pipe"));
        HAS(strstr(line, "pipe") ? "selvage: pipe: " : "selvage: standard input: ");
        LACKS("/dev/");
    }
    feed(0, 0, "info --json", path, "");
    HAS("\"path\": \"standard input\"");
    RUNS(1, "convert pipe -o never.ptx");
    HAS("pipe: a pipe that nobody writes to\n");
    RUNS(2, "diff - - <'%s'", path);
    HAS("read only once");
    RUNS(2, "sample '-' </dev/null");
    HAS("name these with --queries");
    static const char *const twice[] = {
        "sample - -i -",   "bake - --uv - -o never.ptx", "bake - --recipe - -o never.ptx",
        "render - --uv -", "render - --view -",          "transfer - --to - -o never.ptx"};
    for (size_t i = 0; i < sizeof twice / sizeof *twice; i++) {
        RUNS(2, "%s </dev/null", twice[i]);
        HAS("read only once");
    }
    CHECK(access(tool_path("never.ptx"), F_OK) != 0);
}

int main(void) {
    char path[1024];
    tool_begin();
    REQUIRE(data_folder());
    snprintf(path, sizeof path, "%s/cube_u16_rgba.ptx", data_folder());
    REQUIRE(mkfifo(tool_path("pipe"), 0600) == 0);
    static const char lookup[] = "point 0 0 0 1 0 0 1 0 0.5 0.5 0 0 0 0\n";
    tool_write_file("lookups", lookup, sizeof lookup - 1);
    RUNS(0, "convert '%s' -o same.ptx", path);
    RUNS(0, "info '%s' --sheet same.png", path);
    for (size_t way = 0; way < sizeof ways / sizeof *ways; way++) {
        check_answers(way, path);
        check_files(way, path);
    }
    check_others(path);
    tool_end();
    return test_end();
}
