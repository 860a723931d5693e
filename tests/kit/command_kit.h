/* Runs programs, and looks at what they say and leave behind. */
#ifndef COMMAND_KIT_H
#define COMMAND_KIT_H

#include "kit/remove_kit.h"
#include "kit/test.h"

#ifdef KIT_VERBS /* linked with the verbs themselves */
#include "verbs.h"
#endif

#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { KIT_TEXT = 1 << 17, KIT_PATH = 1024, KIT_ARGUMENTS = 48 };

typedef struct kit_scratch {
    char folder[KIT_PATH]; /* where programs run */
    char logs[KIT_PATH];   /* beside it, so that what is counted is only what programs leave */
    char root[KIT_PATH];
} kit_scratch;

typedef struct kit_run {
    int code; /* exit status; 1000 + the signal that ended it */
    char out[KIT_TEXT], err[KIT_TEXT];
} kit_run;

static inline char *kit_join(char *out, const char *folder, const char *name) {
    int length = snprintf(out, KIT_PATH, "%s/%s", folder, name);
    REQUIRE(length > 0 && length < KIT_PATH);
    return out;
}

static inline const char *kit_variable(const char *name) {
    const char *value = getenv(name);
    if (!value || !*value) {
        fprintf(stderr, "the environment variable %s is not set\n", name);
        exit(1);
    }
    return value;
}

/* Mesa's driver, and the compiler that it brings along, where they are: a fork that finds them
 * loaded need not load them. Nothing of them is called here. */
static inline void kit_load_driver(void) {
#ifdef KIT_VERBS
    void *egl = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    void *any = egl ? dlsym(egl, "eglGetDisplay") : NULL;
    char path[KIT_PATH];
    Dl_info where;
    if (any && dladdr(any, &where)) {
        snprintf(path, sizeof path, "%.*s/dri/swrast_dri.so",
                 (int)(strrchr(where.dli_fname, '/') - where.dli_fname), where.dli_fname);
        (void)dlopen(path, RTLD_NOW | RTLD_LOCAL);
    }
#endif
}

static inline void kit_scratch_make(kit_scratch *scratch) {
    kit_join(scratch->root, test_parent(), "selvage-test-XXXXXX");
    REQUIRE(mkdtemp(scratch->root));
    REQUIRE(mkdir(kit_join(scratch->folder, scratch->root, "here"), 0777) == 0);
    REQUIRE(mkdir(kit_join(scratch->logs, scratch->root, "logs"), 0777) == 0);
}

/* How many entries a folder has. */
static inline int kit_count_files(const char *path) {
    int count = 0;
    DIR *folder = opendir(path);
    REQUIRE(folder);
    for (struct dirent *entry; (entry = readdir(folder));)
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    closedir(folder);
    return count;
}

static inline bool kit_exists(const char *folder, const char *name) {
    char path[KIT_PATH];
    return access(kit_join(path, folder, name), F_OK) == 0;
}

static inline void kit_write(const char *path, const void *data, size_t size) {
    FILE *stream = fopen(path, "wb");
    REQUIRE(stream);
    REQUIRE(fwrite(data, 1, size, stream) == size);
    REQUIRE(fclose(stream) == 0);
}

/* The caller frees; a NUL follows the last byte. */
static inline char *kit_read(const char *path, size_t *size) {
    struct stat status;
    FILE *stream = fopen(path, "rb");
    REQUIRE(stream && fstat(fileno(stream), &status) == 0);
    char *data = malloc((size_t)status.st_size + 1);
    REQUIRE(data);
    REQUIRE(fread(data, 1, (size_t)status.st_size, stream) == (size_t)status.st_size);
    data[status.st_size] = 0;
    fclose(stream);
    if (size)
        *size = (size_t)status.st_size;
    return data;
}

static inline void kit_read_log(const char *path, char out[KIT_TEXT]) {
    FILE *stream = fopen(path, "rb");
    REQUIRE(stream);
    out[fread(out, 1, KIT_TEXT - 1, stream)] = 0;
    fclose(stream);
}

/* A program takes the place of this process. The command is there already in tests that are linked
 * with it, where nothing must be loaded for it. */
static inline void kit_become(char **arguments, bool changed) {
#ifdef KIT_VERBS
    const char *name = strrchr(arguments[0], '/');
    int count = 0;
    while (arguments[count])
        count++;
    if (!changed && name && strcmp(name, "/selvage") == 0)
        exit(command_main(count, arguments));
#endif
    (void)changed;
    execv(arguments[0], arguments);
}

/* Runs argv[0] (a path) in the scratch folder; `environment` is NAME=VALUE and so on, ended by
 * NULL, or NULL. */
static inline void kit_run_program(const kit_scratch *scratch, const char *const *environment,
                                   const char *const *argv, kit_run *run) {
    char out[KIT_PATH], err[KIT_PATH];
    int status = 0;
    kit_join(out, scratch->logs, "out");
    kit_join(err, scratch->logs, "err");
    pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        char *arguments[KIT_ARGUMENTS + 1] = {NULL};
        for (int i = 0; i < KIT_ARGUMENTS && argv[i]; i++)
            arguments[i] = strdup(argv[i]);
        for (int i = 0; environment && environment[i]; i++)
            putenv(strdup(environment[i]));
        if (chdir(scratch->folder) != 0 || !freopen("/dev/null", "r", stdin) ||
            !freopen(out, "w", stdout) || !freopen(err, "w", stderr))
            _exit(127);
        kit_become(arguments, environment != NULL);
        _exit(127);
    }
    REQUIRE(waitpid(child, &status, 0) == child);
    run->code = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    kit_read_log(out, run->out);
    kit_read_log(err, run->err);
}

/* Runs the selvage command with these arguments, ended by NULL. */
static inline void kit_selvage(const kit_scratch *scratch, const char *const *environment,
                               const char *const *arguments, kit_run *run) {
    char program[KIT_PATH];
    const char *argv[KIT_ARGUMENTS + 1] = {
        kit_join(program, kit_variable("SELVAGE_BIN"), "selvage")};
    for (int i = 0; i < KIT_ARGUMENTS - 1 && arguments[i]; i++)
        argv[i + 1] = arguments[i];
    kit_run_program(scratch, environment, argv, run);
}

/* Lines of a text that are no warnings. */
static inline int kit_lines(const char *text) {
    int count = 0;
    for (const char *line = text; *line;) {
        size_t length = strcspn(line, "\n");
        count += strncmp(line, "selvage: warning:", 17) != 0;
        line += length + (line[length] == '\n');
    }
    return count;
}

#endif
