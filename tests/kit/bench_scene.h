/* The demo scene for benchmarks. */
#ifndef BENCH_SCENE_H
#define BENCH_SCENE_H

#include "kit/bench_kit.h"

#include <libgen.h>
#include <sys/wait.h>

enum { BENCH_PATH = 1024 };

/* Makes it in a new temporary folder, by the program that lies beside this one. */
static inline bool bench_scene_make(const char *self, char folder[BENCH_PATH]) {
    char copy[BENCH_PATH], program[BENCH_PATH + 32];
    int status = 0;
    snprintf(copy, sizeof copy, "%s", self);
    snprintf(program, sizeof program, "%s/selvage-assets", dirname(copy));
    snprintf(folder, BENCH_PATH, "/tmp/selvage-bench-XXXXXX");
    if (!mkdtemp(folder))
        return false;
    pid_t child = fork();
    if (child == 0) {
        if (freopen("/dev/null", "w", stdout))
            execl(program, program, folder, (char *)NULL);
        _exit(127);
    }
    if (child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) &&
        WEXITSTATUS(status) == 0)
        return true;
    fprintf(stderr, BENCH_NAME ": %s could not make the demo scene\n", program);
    return false;
}

static inline void bench_scene_remove(const char *folder) {
    static const char *const files[] = {"scene.obj", "scene.ptx", "scene_faces.ptx"};
    char path[BENCH_PATH + 32];
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, files[i]);
        unlink(path);
    }
    rmdir(folder);
}

#endif
