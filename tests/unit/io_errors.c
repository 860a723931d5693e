/* Each read and each write of each call fails once with an I/O error: that is SLV_ERROR_IO and one
 * line in the log, never damage or an absence, and the call leaves no file that is not whole. */
#include "kit/calls_kit.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <sys/syscall.h>

/* takes the place of the C library's for the libraries too */
#define INTERPOSED __attribute__((visibility("default"), noinline))

static bool armed, closing_fails;
static long asked, fails;

static bool fails_now(void) {
    if (!armed || ++asked != fails)
        return false;
    errno = EIO;
    return true;
}

/* Embree asks how many processors there are, and does without an answer. */
static bool is_of_system(int file) {
    char link[64], path[16] = "";
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    return readlink(link, path, sizeof path - 1) > 0 &&
           (strncmp(path, "/proc/", 6) == 0 || strncmp(path, "/sys/", 5) == 0);
}

INTERPOSED ssize_t pread(int file, void *to, size_t size, off_t at) {
    return fails_now() ? -1 : syscall(SYS_pread64, file, to, size, at);
}
INTERPOSED ssize_t pwrite(int file, const void *from, size_t size, off_t at) {
    return fails_now() ? -1 : syscall(SYS_pwrite64, file, from, size, at);
}
INTERPOSED ssize_t read(int file, void *to, size_t size) {
    return armed && !is_of_system(file) && fails_now() ? -1 : syscall(SYS_read, file, to, size);
}
INTERPOSED ssize_t write(int file, const void *from, size_t size) {
    return fails_now() ? -1 : syscall(SYS_write, file, from, size);
}
INTERPOSED int rename(const char *from, const char *to) {
    return fails_now() ? -1 : (int)syscall(SYS_rename, from, to);
}

/* Of the session: other folders are listed to tidy up, which need not succeed. */
INTERPOSED DIR *opendir(const char *path) {
    const char *name = strrchr(path, '/');
    if (name && strcmp(name, "/made.selvage") == 0 && fails_now())
        return NULL;
    int folder = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    return folder < 0 ? NULL : fdopendir(folder);
}

/* Where a disk is far away, closing is the first to say that it is full. */
INTERPOSED int close(int file) {
    int flags = fcntl(file, F_GETFL), result = (int)syscall(SYS_close, file);
    if (!closing_fails || (flags & O_ACCMODE) == O_RDONLY)
        return result;
    errno = EDQUOT;
    return -1;
}

static slv_result run(const calls_entry *entry, long at) {
    slv_env env = {.log = calls_log, .threads = 1};
    calls_prepare();
    calls_errors = 0;
    calls_message[0] = 0;
    asked = 0;
    fails = at;
    armed = true;
    slv_result result = entry->call(&env);
    armed = false;
    return result;
}

/* A folder that cannot be moved to its place as a whole is moved file by file. */
static bool gets_by(const calls_entry *entry) {
    slv_result (*const calls_that_do[])(const slv_env *) = {call_folder, call_folders, call_split};
    for (size_t i = 0; i < sizeof calls_that_do / sizeof *calls_that_do; i++)
        if (entry->call == calls_that_do[i])
            return true;
    return false;
}

/* NAME.0.selvage, and not a session's own name. */
static bool is_temporary(const char *name) {
    const char *ending = strstr(name, ".selvage");
    return ending && ending > name + 1 && ending[-1] >= '0' && ending[-1] <= '9';
}

/* No temporary file is left, and each .ptx is a whole one. */
static void look_at_files(const char *name) {
    slv_env env = {0};
    DIR *folder = opendir(calls.folder);
    REQUIRE(folder);
    for (struct dirent *entry; (entry = readdir(folder));) {
        const char *ending = strrchr(entry->d_name, '.');
        slv_ptx *ptx = NULL;
        char path[512];
        CHECK_MSG(!is_temporary(entry->d_name), "%s: %s is left", name, entry->d_name);
        if (!ending || strcmp(ending, ".ptx") != 0)
            continue;
        snprintf(path, sizeof path, "%s/%s", calls.folder, entry->d_name);
        CHECK_MSG(!slv_ptx_open(&env, path, &ptx) && !slv_ptx_load_tables(ptx),
                  "%s: %s is not whole", name, entry->d_name);
        slv_ptx_close(ptx);
    }
    closedir(folder);
}

/* What cannot be closed does not take the place of what was there. */
static void check_closing(void) {
    static const struct {
        slv_result (*call)(const slv_env *env);
        const char *out;
    } cases[] = {{call_ptx_save, "out.ptx"}, {call_png, "out.png"}, {call_exr, "out.exr"}};
    slv_env env = {.log = calls_log, .threads = 1};
    for (int i = 0; i < 3; i++) {
        char text[8] = "";
        FILE *old = fopen(calls_path(cases[i].out), "w");
        REQUIRE(old && fputs("old", old) >= 0 && fclose(old) == 0);
        calls_errors = 0;
        closing_fails = true;
        slv_result result = cases[i].call(&env);
        closing_fails = false;
        CHECK_MSG(result == SLV_ERROR_IO && calls_errors == 1, "%s: %s, %u lines", cases[i].out,
                  slv_result_string(result), calls_errors);
        old = fopen(calls_path(cases[i].out), "r");
        REQUIRE(old);
        CHECK_MSG(fgets(text, sizeof text, old) && strcmp(text, "old") == 0, "%s: %s", cases[i].out,
                  text);
        fclose(old);
        REQUIRE(remove(calls_path(cases[i].out)) == 0);
    }
}

int main(void) {
    long all = 0;
    calls_begin();
    check_closing();
    look_at_files("closing");
    for (int i = 0; i < CALLS_COUNT; i++) {
        const calls_entry *entry = &calls_all[i];
        run(entry, 0);
        long most = asked, step = most / 100 + 1;
        for (long at = 1 + i % step; at <= most; at += step, all++) {
            slv_result result = run(entry, at);
            CHECK_MSG(result == SLV_ERROR_IO || (gets_by(entry) && !result),
                      "%s, call %ld of %ld: %s, %s", entry->name, at, most,
                      slv_result_string(result), calls_message);
            CHECK_MSG(calls_errors == (result != SLV_OK), "%s, call %ld of %ld: %u lines, %s",
                      entry->name, at, most, calls_errors, calls_message);
            look_at_files(entry->name);
        }
        fprintf(stderr, "%-12s %ld calls of the system\n", entry->name, most);
    }
    CHECK(all > 100);
    calls_end();
    return test_end();
}
