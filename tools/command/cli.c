/* Messages, interrupts and progress, as all verbs have them. */
#include "command/cli.h"

#include <selvage/threads.h>

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdio_ext.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>
#include <unistd.h>

/* An unfinished line of progress may stand there. */
static void begin_line(void) {
    if (isatty(STDERR_FILENO) == 1)
        fputs("\r\033[K", stderr);
}

/* Messages of libraries too say what they read by the name that it was opened by. */
static void print_line(const char *text) {
    while (*text) {
        const char *name = strstr(text, "/dev/");
        char path[32];
        size_t length = name ? 5 + strspn(name + 5, "/abcdefghijklmnopqrstuvwxyz0123456789") : 0;
        fprintf(stderr, "%.*s", (int)(name ? name - text : (ptrdiff_t)strlen(text)), text);
        if (!name)
            break;
        snprintf(path, sizeof path, "%.*s", (int)length, name);
        fputs(length < sizeof path ? cli_shown(path) : "/dev/", stderr);
        text = name + (length < sizeof path ? length : 5);
    }
    fputc('\n', stderr);
}

static void print_words(const char *format, va_list args) {
    char text[8192];
    vsnprintf(text, sizeof text, format, args);
    print_line(text);
}

int cli_usage(const cli_command *command, const char *format, ...) {
    va_list args;
    va_start(args, format);
    fprintf(stderr, "selvage %s: ", command->name);
    vfprintf(stderr, format, args);
    fprintf(stderr, " (see selvage %s --help)\n", command->name);
    va_end(args);
    return EXIT_USAGE;
}

int cli_error(const char *format, ...) {
    va_list args;
    va_start(args, format);
    begin_line();
    fputs("selvage: ", stderr);
    print_words(format, args);
    va_end(args);
    return EXIT_FAILED;
}

int cli_answered(int code) {
    bool failed = ferror(stdout) != 0;
    errno = 0;
    if (fflush(stdout) == 0 && !failed)
        return code;
    /* the reason of what failed earlier is known no more, but is still there */
    if (!errno && write(STDOUT_FILENO, "\n", 1) > 0)
        errno = ENOSPC;
    cli_error("cannot write the answer: %s", strerror(errno));
    __fpurge(stdout);
    clearerr(stdout);
    return code ? code : EXIT_FAILED;
}

int cli_standard_once(const cli_command *command, const char *const *paths, size_t count) {
    uint32_t found = 0;
    for (size_t i = 0; i < count; i++)
        found += paths[i] && strcmp(cli_input(paths[i]), cli_input("-")) == 0;
    return found < 2
               ? EXIT_OK
               : cli_usage(
                     command,
                     "of two inputs both are the standard input, which can be read only once");
}

bool cli_ends_with(const char *path, const char *extension) {
    size_t length = strlen(path), wanted = strlen(extension);
    return length > wanted && strcasecmp(path + length - wanted, extension) == 0;
}

void cli_warning(const char *format, ...) {
    va_list args;
    va_start(args, format);
    begin_line();
    fputs("selvage: warning: ", stderr);
    print_words(format, args);
    va_end(args);
}

/* Two parts of one job may find the same fault of a mesh, which is one to whoever reads it. */
static bool was_said(const char *message) {
    enum { KEPT = 64 };
    static uint64_t said[KEPT];
    static uint32_t count;
    uint64_t hash = UINT64_C(14695981039346656037);
    for (; *message; message++)
        hash = (hash ^ (unsigned char)*message) * UINT64_C(1099511628211);
    for (uint32_t i = 0; i < count && i < KEPT; i++)
        if (said[i] == hash)
            return true;
    said[count++ % KEPT] = hash;
    return false;
}

static void print_log(void *user, slv_log_level level, const char *message) {
    (void)user;
    if (level == SLV_LOG_INFO || (level == SLV_LOG_WARNING && was_said(message)))
        return;
    begin_line();
    fprintf(stderr, "selvage: %s", level == SLV_LOG_WARNING ? "warning: " : "");
    print_line(message);
}

/* Of the process, as its signals are: a verb runs once, so that there is one, which the first call
 * makes. It has the threads that this asked for; others may ask for fewer. */
static slv_threads *pool;

slv_env cli_env(uint32_t threads) {
    slv_env env = {.log = print_log, .threads = threads};
    /* without a pool each call starts threads of its own */
    if (pool || slv_threads_create(&env, &pool) == SLV_OK)
        slv_threads_use(pool, &env);
    return env;
}

void cli_end(void) {
    slv_threads_destroy(pool);
    pool = NULL;
}

static volatile sig_atomic_t interrupted;

static void note_interrupt(int signal) {
    (void)signal;
    interrupted = 1;
}

void cli_catch_interrupts(void) {
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};
    const struct sigaction action = {.sa_handler = note_interrupt, .sa_flags = (int)SA_RESETHAND};
    struct sigaction before;
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        /* nohup and its kin have them ignored */
        if (sigaction(signals[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            sigaction(signals[i], &action, NULL);
    /* who reads no more of what is said shall not leave half a file */
    signal(SIGPIPE, SIG_IGN);
}

void cli_begin(void) {
    /* a file that is opened must not become standard output */
    for (int descriptor = 0; descriptor <= STDERR_FILENO; descriptor++)
        if (fcntl(descriptor, F_GETFD) < 0 && open("/dev/null", O_RDONLY) < 0)
            break;
    /* a limit of sizes is an error of the call that hits it */
    signal(SIGXFSZ, SIG_IGN);
}

bool cli_interrupted(void) {
    return interrupted != 0;
}

double cli_now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + (double)time.tv_nsec * 1e-9;
}

static cli_progress begin_progress(const char *what, uint64_t total, bool quiet) {
    return (cli_progress){.what = what,
                          .total = total ? total : 1,
                          .quiet = quiet,
                          .terminal = isatty(STDERR_FILENO) == 1,
                          .started = cli_now(),
                          .busy = ATOMIC_FLAG_INIT};
}

cli_progress cli_progress_begin(const char *what, uint64_t total, bool forced, bool quiet) {
    cli_progress progress = begin_progress(what, total, quiet);
    progress.quiet = !forced && (quiet || !progress.terminal);
    if (!progress.quiet && !progress.terminal)
        fprintf(stderr, "%s\n", what);
    return progress;
}

cli_progress cli_progress_fleeting(const char *what, bool forced, bool quiet) {
    cli_progress progress = begin_progress(what, 1, quiet);
    progress.fleeting = true;
    progress.quiet = !forced && (quiet || !progress.terminal);
    if (!forced)
        progress.shown = progress.started + 0.4;
    return progress;
}

void cli_progress_update(cli_progress *progress, uint64_t done) {
    if (progress->quiet)
        return;
    double time = cli_now(), spent = time - progress->started;
    int tenths = (int)(done * 10 / progress->total);
    bool last = done == progress->total && !progress->fleeting;
    if (progress->terminal && (time - progress->shown > 0.1 || last)) {
        double left = done ? spent / (double)done * (double)(progress->total - done) : 0;
        fprintf(stderr, "\r\033[K%s: %llu of %llu, %.0f s left", progress->what,
                (unsigned long long)done, (unsigned long long)progress->total, left);
        progress->shown = time;
    } else if (!progress->terminal && tenths > progress->tenths && progress->total >= 10) {
        fprintf(stderr, "%s: %d%% after %.0f s\n", progress->what, tenths * 10, spent);
    }
    progress->tenths = tenths;
}

bool cli_progress_report(void *user, uint64_t done, uint64_t total) {
    cli_progress *progress = user;
    progress->total = total ? total : 1;
    cli_progress_update(progress, done);
    return !cli_interrupted();
}

void cli_progress_step(cli_progress *progress) {
    if (progress->quiet)
        return;
    uint64_t done = atomic_fetch_add(&progress->done, 1) + 1;
    /* who finds another thread at it leaves the showing to that one, but for the last step */
    while (atomic_flag_test_and_set(&progress->busy))
        if (done != progress->total)
            return;
    cli_progress_update(progress, atomic_load(&progress->done));
    atomic_flag_clear(&progress->busy);
}

void cli_progress_end(cli_progress *progress) {
    if (progress->quiet || !progress->terminal)
        return;
    if (progress->fleeting)
        fputs("\r\033[K", stderr);
    else
        fprintf(stderr, "\r\033[K%s: done in %.1f s\n", progress->what,
                cli_now() - progress->started);
    progress->quiet = true;
}
