/* Options, messages, interrupts and progress, as all verbs have them. */
#include "command/cli.h"

#include <selvage/threads.h>

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
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
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
    return EXIT_FAILED;
}

int cli_answered(int code) {
    bool failed = ferror(stdout) != 0;
    errno = 0;
    if (fflush(stdout) == 0 && !failed)
        return code;
    cli_error("cannot write the answer: %s", errno ? strerror(errno) : "the disk may be full");
    return code ? code : EXIT_FAILED;
}

const char *cli_input(const char *path) {
    return path && strcmp(path, "-") == 0 ? "/dev/stdin" : path;
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
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
}

static void print_log(void *user, slv_log_level level, const char *message) {
    (void)user;
    if (level == SLV_LOG_INFO)
        return;
    begin_line();
    fprintf(stderr, "selvage: %s%s\n", level == SLV_LOG_WARNING ? "warning: " : "", message);
}

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

/* Whether `name` is one of the words of "a|b|c"; its index, or -1. */
static int word_index(const char *words, const char *name, size_t length) {
    int index = 0;
    for (const char *word = words; *word; index++) {
        size_t here = strcspn(word, "|");
        if (here == length && strncmp(word, name, length) == 0)
            return index;
        word += here + (word[here] == '|');
    }
    return -1;
}

static void print_help(const cli_command *command) {
    printf("selvage %s - %s\n\nUsage: selvage %s %s [options]\n\nOptions:\n", command->name,
           command->summary, command->name, command->arguments);
    for (uint32_t i = 0; i < command->noptions; i++) {
        const cli_option *option = &command->options[i];
        char left[64];
        int length = (int)strcspn(option->names, "|");
        snprintf(left, sizeof left, "%.*s%s%s", length, option->names,
                 option->kind == CLI_FLAG ? "" : " ",
                 option->kind == CLI_FLAG                        ? ""
                 : option->choices && option->kind != CLI_CHOICE ? option->choices
                 : option->kind == CLI_CHOICE                    ? "WORD"
                 : option->kind == CLI_SIZE                      ? "WxH"
                 : option->kind == CLI_COLOR                     ? "R,G,B[,A]"
                                                                 : "N");
        printf("  %-22s %s", left, option->help);
        if (option->kind == CLI_CHOICE)
            printf(": %s", option->choices);
        putchar('\n');
    }
    printf("  %-22s %s\n\nExamples:\n%s", "--help", "this text", command->examples);
}

static bool parse_uint(const char *text, uint32_t min, uint32_t max, uint32_t *out,
                       const char **end) {
    char *after;
    errno = 0;
    unsigned long long value = strtoull(text, &after, 10);
    if (after == text || text[0] < '0' || text[0] > '9' || errno || value < min || value > max)
        return false;
    *out = (uint32_t)value;
    *end = after;
    return true;
}

static bool parse_float(const char *text, float *out, const char **end) {
    char *after;
    float value = strtof(text, &after);
    if (after == text || !isfinite(value))
        return false;
    *out = value;
    *end = after;
    return true;
}

static bool parse_color(const char *text, float *out, const char **end) {
    int count = 0;
    float color[4] = {0, 0, 0, 1};
    *end = text;
    do {
        if (count)
            (*end)++;
        if (!parse_float(*end, &color[count], end))
            return false;
    } while (++count < 4 && **end == ',');
    memcpy(out, color, sizeof color);
    return count >= 3;
}

static bool parse_value(const cli_option *option, const char *text) {
    const char *end = text + strlen(text);
    uint32_t *size = option->value;
    cli_list *list = option->value;
    int choice;
    bool good = true;
    switch (option->kind) {
    case CLI_FLAG:
        break;
    case CLI_TEXT:
        *(const char **)option->value = text;
        good = *text != 0;
        break;
    case CLI_TEXTS:
        good = *text && list->count < CLI_LIST_ROOM;
        if (good)
            list->items[list->count++] = text;
        break;
    case CLI_UINT:
        good = parse_uint(text, option->min, option->max, option->value, &end);
        break;
    case CLI_FLOAT:
        good = parse_float(text, option->value, &end);
        break;
    case CLI_SIZE:
        good = parse_uint(text, option->min, option->max, &size[0], &end);
        size[1] = size[0];
        if (good && *end == 'x')
            good = parse_uint(end + 1, option->min, option->max, &size[1], &end);
        break;
    case CLI_CHOICE:
        choice = word_index(option->choices, text, strlen(text));
        good = choice >= 0;
        *(int *)option->value = choice;
        break;
    case CLI_COLOR:
        good = parse_color(text, option->value, &end);
        break;
    }
    return good && *end == 0;
}

static int bad_value(const cli_command *command, const cli_option *option, const char *text) {
    int length = (int)strcspn(option->names, "|");
    if (option->kind == CLI_CHOICE)
        return cli_usage(command, "%.*s: unknown word '%s', expected %s", length, option->names,
                         text, option->choices);
    if (option->kind == CLI_UINT || option->kind == CLI_SIZE)
        return cli_usage(command, "%.*s: '%s' is not a %s from %u to %u", length, option->names,
                         text, option->kind == CLI_UINT ? "number" : "size", option->min,
                         option->max);
    return cli_usage(command, "%.*s: cannot read '%s'", length, option->names, text);
}

int cli_parse(const cli_command *command, int argc, char **argv) {
    bool only_positional = false;
    *command->npositional = 0;
    for (int i = 1; i < argc; i++) {
        const char *argument = argv[i], *value = NULL;
        if (only_positional || argument[0] != '-' || !argument[1]) {
            if (*command->npositional == command->max_arguments)
                return cli_usage(command, "unexpected argument '%s'", argument);
            if (!argument[0])
                return cli_usage(command, "an argument is empty, where a name is expected");
            command->positional[(*command->npositional)++] = argument;
            continue;
        }
        if (strcmp(argument, "--") == 0) {
            only_positional = true;
            continue;
        }
        if (strcmp(argument, "--help") == 0 || strcmp(argument, "-h") == 0) {
            print_help(command);
            return EXIT_OK;
        }
        size_t length = strncmp(argument, "--", 2) == 0 ? strcspn(argument, "=") : strlen(argument);
        const cli_option *option = NULL;
        for (uint32_t k = 0; !option && k < command->noptions; k++)
            if (word_index(command->options[k].names, argument, length) >= 0)
                option = &command->options[k];
        if (!option)
            return cli_usage(command, "unknown option '%s'", argument);
        if (argument[length] == '=')
            value = argument + length + 1;
        if (option->kind == CLI_FLAG) {
            if (value)
                return cli_usage(command, "%.*s takes no value", (int)length, argument);
            *(bool *)option->value = true;
        } else {
            if (!value && i + 1 < argc)
                value = argv[++i];
            if (!value)
                return cli_usage(command, "%s needs a value", argument);
            if (!parse_value(option, value))
                return bad_value(command, option, value);
        }
        if (option->given)
            *option->given = true;
    }
    if (*command->npositional < command->min_arguments)
        return cli_usage(command, "expected %s", command->arguments);
    return -1;
}

static cli_progress begin_progress(const char *what, uint64_t total, bool quiet) {
    return (cli_progress){.what = what,
                          .total = total ? total : 1,
                          .quiet = quiet,
                          .terminal = isatty(STDERR_FILENO) == 1,
                          .started = cli_now(),
                          .busy = ATOMIC_FLAG_INIT};
}

cli_progress cli_progress_begin(const char *what, uint64_t total, bool quiet) {
    cli_progress progress = begin_progress(what, total, quiet);
    if (!quiet && !progress.terminal)
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
