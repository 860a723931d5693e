/* What verbs write: each of them keeps links and modes, takes long names, says in one line what
 * cannot be written, and leaves nothing when it fails or is stopped. */
#include "kit/mesh_shapes.h"
#include "kit/tool_kit.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>

static const struct writer {
    const char *command; /* the output is put at its end */
    const char *ending;
    bool folder, prints, streams;
    bool again; /* the verb is there with another output: less is tried */
} writers[] = {
    {"render in.ptx --size 32x32 -o", ".png", .prints = true},
    {"render in.ptx --size 32x32 --bits 32 -o", ".exr", .prints = true, .again = true},
    {"reference in.ptx --size 24x24 --samples 1 --json -o", ".exr", .prints = true},
    {"reference in.ptx --size 24x24 --samples 2 --quiet -o kept.exr --error", ".exr",
     .again = true},
    {"info in.ptx --sheet", ".png", .prints = true},
    {"convert in.ptx --json", ".ptx", .prints = true},
    {"convert in.ptx --json", ".ptex", .prints = true, .again = true},
    {"convert in.ptx --json", ".png", .prints = true},
    {"merge in.ptx other.ptx -o", ".ptx", .prints = true},
    {"transfer in.ptx --to in.obj", ".ptx", .prints = true},
    {"new in.obj --json", ".ptx", .prints = true},
    {"wrap in.obj --json -o", ".obj", .prints = true},
    {"bake in.obj --pattern noise --size 16 --json -o", ".ptx", .prints = true},
    {"unbake uv.ptx --mesh uv.obj --size 64 --json -o", ".exr", .prints = true},
    {"bake uv.obj --uv uv.png --size 32 --quiet -o kept.ptx --miss-map", ".ptx", .prints = false},
    {"paint in.ptx s.jsonl --json", ".ptx", .prints = true},
    {"paint s.selvage s.jsonl --json -o", ".ptx", .prints = true, .again = true},
    {"check in.ptx --repair", ".ptx", .prints = true},
    {"session s.selvage --json --export", ".ptx", .prints = true},
    {"sample in.ptx --queries q.txt --out", ".txt", .streams = true},
    {"render in.ptx --size 24x24 --pass ids -o", ".PNG", .prints = true, .again = true},
    {"convert in.ptx", "", .folder = true},
    {"split merged.ptx --json -o", "", .folder = true, .prints = true},
    {"reference in.ptx --size 24x24 --samples 1 --quiet -o kept.exr --convergence", "",
     .folder = true, .again = true},
};
enum { WRITERS = sizeof writers / sizeof *writers };

/* How a process is made to fail. */
typedef struct trouble {
    rlim_t file_size; /* 0: no limit */
    bool full_stdout, nobody;
    int signal; /* after so many microseconds; 0: none */
    long microseconds;
} trouble;

static void enter(const trouble *t) {
    if (t->file_size) {
        struct rlimit limit = {t->file_size, t->file_size};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    if (t->full_stdout) {
        int full = open("/dev/full", O_WRONLY);
        dup2(full, STDOUT_FILENO);
    }
    if (t->nobody && geteuid() == 0 && (setgid(65534) != 0 || setuid(65534) != 0))
        _exit(126);
    if (t->nobody)
        prctl(PR_SET_DUMPABLE, 1); /* or the leak sanitizer cannot look at it */
}

/* The command in a fork of this process, with trouble; -1 if a signal killed it. */
static int run(const trouble *t, const char *format, ...) __attribute__((format(printf, 2, 3)));
static int run(const trouble *t, const char *format, ...) {
    char line[2048], *words[32] = {"selvage"};
    int ends[2], status = 0;
    va_list args;
    va_start(args, format);
    vsnprintf(line, sizeof line, format, args);
    va_end(args);
    int count = tool_words(line, words + 1, 30);
    REQUIRE(count > 0 && pipe(ends) == 0);
    fflush(NULL);
    pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        dup2(ends[1], STDOUT_FILENO);
        dup2(ends[1], STDERR_FILENO);
        close(ends[0]);
        close(ends[1]);
        if (chdir(test_folder) != 0)
            _exit(127);
        enter(t);
        exit(command_main(count + 1, words));
    }
    close(ends[1]);
    if (t->signal) {
        struct timespec wait = {t->microseconds / 1000000, t->microseconds % 1000000 * 1000};
        nanosleep(&wait, NULL);
        kill(child, t->signal);
    }
    size_t size = 0;
    for (ssize_t got; (got = read(ends[0], tool_out + size, sizeof tool_out - 1 - size)) > 0;)
        size += (size_t)got;
    tool_out[size] = 0;
    close(ends[0]);
    REQUIRE(waitpid(child, &status, 0) == child);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static const trouble none = {0};

#define EXPECT(code, t, ...)                                                                       \
    do {                                                                                           \
        int code_ = run(t, __VA_ARGS__);                                                           \
        CHECK_MSG(code_ == (code), "%s: exit code %d, expected %d:\n%s", w->command, code_, code,  \
                  tool_out);                                                                       \
    } while (0)

/* How many files and folders there are in a folder. */
static int entries(const char *folder) {
    DIR *stream = opendir(tool_path(folder));
    int count = 0;
    REQUIRE(stream);
    while (readdir(stream))
        count++;
    closedir(stream);
    return count - 2;
}

static int lines_of_error(void) {
    int count = 0;
    for (const char *at = tool_out; (at = strstr(at, "selvage: ")); at++)
        count += (at == tool_out || at[-1] == '\n') && strncmp(at + 9, "warning", 7) != 0;
    return count;
}

static mode_t mode_of(const char *name) {
    struct stat status;
    return lstat(tool_path(name), &status) == 0 ? status.st_mode & 07777 : 0;
}

static bool is_link(const char *name) {
    struct stat status;
    return lstat(tool_path(name), &status) == 0 && S_ISLNK(status.st_mode);
}

static void make_old(const struct writer *w, const char *name, mode_t mode) {
    if (w->folder)
        REQUIRE(mkdir(tool_path(name), 0777) == 0);
    else
        tool_write_file(name, "old", 3);
    REQUIRE(chmod(tool_path(name), mode) == 0);
}

static bool is_old(const struct writer *w, const char *name) {
    struct stat status;
    if (w->folder)
        return entries(name) == 0;
    return stat(tool_path(name), &status) == 0 && status.st_size == 3;
}

/* A folder of its own for what is tried, so that what is left there is seen. */
static void begin(void) {
    test_remove(tool_path("w"));
    test_remove(tool_path("real"));
    REQUIRE(mkdir(tool_path("w"), 0777) == 0 && mkdir(tool_path("real"), 0777) == 0);
}

/* A sheet has an index beside it. */
static int others(const struct writer *w) {
    return strncmp(w->command, "convert", 7) == 0 && strcmp(w->ending, ".png") == 0;
}

static void check_links(const struct writer *w) {
    char at[300], there[300], to[304];
    begin();
    snprintf(at, sizeof at, "w/x%s", w->ending);
    snprintf(there, sizeof there, "real/y%s", w->ending);
    snprintf(to, sizeof to, "../%s", there);
    mode_t mode = w->folder ? 0700 : 0640;
    make_old(w, there, mode);
    REQUIRE(symlink(to, tool_path(at)) == 0);
    EXPECT(0, &none, "%s %s", w->command, at);
    CHECK_MSG(is_link(at) && !is_old(w, there) && mode_of(there) == mode, "%s: mode %o", w->command,
              mode_of(there));
    CHECK(entries("w") == 1 + others(w) && entries("real") == 1);
    /* and where nothing is yet */
    begin();
    REQUIRE(symlink(to, tool_path(at)) == 0);
    EXPECT(0, &none, "%s %s", w->command, at);
    CHECK_MSG(is_link(at) && mode_of(there), "%s", w->command);
    CHECK(entries("w") == 1 + others(w) && entries("real") == 1);
    /* a link in a circle */
    begin();
    REQUIRE(symlink("x", tool_path("w/x")) == 0);
    EXPECT(1, &none, "%s w/x/y%s", w->command, w->ending);
    CHECK(lines_of_error() == 1 && entries("w") == 1);
}

static void check_modes(const struct writer *w) {
    char at[300];
    begin();
    snprintf(at, sizeof at, "w/x%s", w->ending);
    mode_t mask = umask(027), mode = w->folder ? 0711 : 0604;
    EXPECT(0, &none, "%s %s", w->command, at);
    CHECK_MSG(mode_of(at) == (w->folder ? 0750 : 0640), "%s: %o", w->command, mode_of(at));
    umask(mask);
    CHECK(entries("w") == 1 + others(w));
    begin();
    make_old(w, at, mode);
    EXPECT(0, &none, "%s %s", w->command, at);
    CHECK_MSG(mode_of(at) == mode && !is_old(w, at), "%s: %o", w->command, mode_of(at));
    CHECK(entries("w") == 1 + others(w));
}

static void check_names(const struct writer *w) {
    char at[300], name[256];
    begin();
    /* the name of a sheet's index is a byte longer */
    size_t length = 255 - (size_t)others(w), ending = strlen(w->ending);
    memset(name, 'n', length - ending);
    snprintf(name + length - ending, sizeof name - length + ending, "%s", w->ending);
    snprintf(at, sizeof at, "w/%s", name);
    EXPECT(0, &none, "%s %s", w->command, at);
    CHECK_MSG(mode_of(at), "%s", w->command);
    CHECK(entries("w") == 1 + others(w));
    begin();
    EXPECT(1, &none, "%s w/too_long_%s", w->command, name);
    CHECK_MSG(lines_of_error() == 1 && entries("w") == 0, "%s", tool_out);
}

/* Folders in which nothing can be made, and things that are no files. */
static void check_refusals(const struct writer *w) {
    const trouble nobody = {.nobody = true};
    char at[300];
    begin();
    const char *const closed[] = {"in.ptx/x", "nowhere/x", "/proc/x", "w/x"};
    REQUIRE(chmod(tool_path("w"), 0555) == 0);
    for (int i = 0; i < 4; i++) {
        EXPECT(1, i == 3 ? &nobody : &none, "%s %s%s", w->command, closed[i], w->ending);
        CHECK_MSG(lines_of_error() == 1 && strstr(tool_out, closed[i]), "%s: %s", w->command,
                  tool_out);
    }
    REQUIRE(chmod(tool_path("w"), 01777) == 0);
    CHECK(entries("w") == 0);
    snprintf(at, sizeof at, "w/x%s", w->ending);
    if (!w->folder && geteuid() == 0) {
        make_old(w, at, 0666);
        EXPECT(1, &nobody, "%s %s", w->command, at);
        CHECK_MSG(lines_of_error() == 1 && strstr(tool_out, "not permitted") && is_old(w, at),
                  "%s: %s", w->command, tool_out);
        REQUIRE(remove(tool_path(at)) == 0 && entries("w") == 0);
    }
    if (w->folder)
        tool_write_file(at, "old", 3);
    else
        REQUIRE(mkdir(tool_path(at), 0777) == 0);
    EXPECT(1, &none, "%s %s", w->command, at);
    CHECK_MSG(lines_of_error() == 1 && strstr(tool_out, at), "%s: %s", w->command, tool_out);
    CHECK(entries("w") == 1);
    if (!w->streams) {
        begin();
        REQUIRE(mkfifo(tool_path(at), 0666) == 0);
        EXPECT(1, &none, "%s %s", w->command, at);
        CHECK_MSG(lines_of_error() == 1 && strstr(tool_out, at), "%s: %s", w->command, tool_out);
        CHECK(entries("w") == 1);
    }
    /* under another name it is what is read */
    begin();
    char input[64];
    struct stat read;
    REQUIRE(sscanf(w->command, "%*s %63s", input) == 1 && stat(tool_path(input), &read) == 0);
    if (!w->folder && S_ISREG(read.st_mode)) { /* a session is a folder, which no link can be */
        REQUIRE(link(tool_path(input), tool_path(at)) == 0);
        EXPECT(1, &none, "%s %s", w->command, at);
        HAS("would be lost");
        CHECK(lines_of_error() == 1 && entries("w") == 1);
    }
}

static void check_full(const struct writer *w) {
    const trouble full = {.file_size = 1}, deaf = {.full_stdout = true};
    char at[300];
    snprintf(at, sizeof at, "w/x%s", w->ending);
    for (int old = 0; old < 2; old++) {
        begin();
        if (old)
            make_old(w, at, 0700);
        EXPECT(1, &full, "%s %s", w->command, at);
        CHECK_MSG(lines_of_error() == 1 &&
                      (strstr(tool_out, "File too large") || strstr(tool_out, "may be full")),
                  "%s: %s", w->command, tool_out);
        CHECK_MSG(entries("w") == old && (!old || is_old(w, at)), "%s: %d files", w->command,
                  entries("w"));
    }
    begin();
    if (w->prints) {
        EXPECT(1, &deaf, "%s %s", w->command, at);
        CHECK_MSG(lines_of_error() == 1 && strstr(tool_out, "cannot write the answer"), "%s: %s",
                  w->command, tool_out);
    }
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void check_signals(const struct writer *w) {
    static const int signals[] = {SIGTERM, SIGINT, SIGHUP, SIGKILL};
    static uint64_t seed = 5;
    char at[300];
    snprintf(at, sizeof at, "w/x%s", w->ending);
    begin();
    double start = now();
    EXPECT(0, &none, "%s %s", w->command, at);
    long whole = (long)((now() - start) * 1e6);
    for (uint32_t i = 0; i < test_effort(4); i++) {
        trouble t = {.signal = signals[i % 4],
                     .microseconds = whole * (long)(test_random(&seed) % 1000) / 1000};
        begin();
        if (!w->folder)
            make_old(w, at, 0600);
        int code = run(&t, "%s %s", w->command, at);
        CHECK_MSG(code == 0 || code == 1 || code == -1, "%s: %d", w->command, code);
        CHECK_MSG(code != 1 || lines_of_error() == 1, "%s: %s", w->command, tool_out);
        if (t.signal == SIGKILL)
            EXPECT(0, &none, "%s %s", w->command, at); /* which tidies */
        int left = entries("w");
        CHECK_MSG(left == 1 || (w->folder && left == 0) || left == 1 + others(w),
                  "%s: %d files after signal %d", w->command, left, t.signal);
    }
}

/* A report's frames stay, for --resume. */
static void check_report(void) {
    static const struct writer report = {
        "compare in.ptx --quick --frames 1 --size 48x48 --strategies clamp --msaa 1 "
        "--reference none --out",
        "", .folder = true, .prints = true};
    check_links(&report);
    check_modes(&report);
    check_names(&report);
    check_refusals(&report);
    check_full(&report);
    static const struct writer images = {"diff in.ptx other.ptx --images", "", .folder = true};
    const struct writer *w = &images;
    begin();
    EXPECT(1, &none, "%s w/x", w->command);
    CHECK(entries("w") == 1 && entries("w/x") > 0);
    begin();
    const trouble full = {.file_size = 1};
    run(&full, "%s w/x", w->command);
    CHECK_MSG(lines_of_error() == 1 && entries("w") == 0, "%s", tool_out);
}

int main(void) {
    slv_env env = test_env();
    tool_begin();
    REQUIRE(chmod(test_folder, 0777) == 0);
    tool_write_noise("in.ptx", SLV_TYPE_U8, 3, SLV_NO_ALPHA, 1);
    tool_write_noise("other.ptx", SLV_TYPE_U8, 3, SLV_NO_ALPHA, 2);
    slv_mesh *mesh = grid_mesh(3, 2, true);
    REQUIRE(slv_mesh_save_obj(&env, mesh, tool_path("in.obj")) == SLV_OK);
    slv_mesh_destroy(mesh);
    tool_write_file("q.txt", "point 0 0 0 1 0 0 0 0 .25 .25 0 0 0 0\n", 38);
    static const char fill[] = "{\"op\": \"fill\", \"face\": 0, \"color\": [1]}\n";
    tool_write_file("s.jsonl", fill, sizeof fill - 1);
    static const char uv[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                             "f 1/1 2/2 3/3 4/4\n";
    tool_write_file("uv.obj", uv, sizeof uv - 1);
    const struct writer *w = &writers[0];
    EXPECT(0, &none, "info in.ptx --sheet uv.png");
    EXPECT(0, &none, "bake uv.obj --uv uv.png --size 16 -o uv.ptx");
    EXPECT(0, &none, "merge in.ptx other.ptx -o merged.ptx");
    EXPECT(0, &none, "session s.selvage --new in.ptx -q");
    for (int i = 0; i < WRITERS; i++) {
        if (!test_skip((uint32_t)i, 2))
            check_links(&writers[i]);
        else
            check_full(&writers[i]);
        if (writers[i].again)
            continue;
        static void (*const checks[])(const struct writer *) = {check_modes, check_names,
                                                                check_refusals, check_signals};
        for (uint32_t c = 0; c < sizeof checks / sizeof *checks; c++)
            if (!test_skip(c + (uint32_t)i, 4))
                checks[c](&writers[i]);
    }
    check_report();
    tool_end();
    return test_end();
}
