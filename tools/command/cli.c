/* Options, messages, interrupts and progress, as all verbs have them. */
#include "command/cli.h"
#include "command/numbers.h"
#include "command/words.h"

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

bool cli_both_standard(const char *a, const char *b) {
    const char *standard = cli_input("-");
    return a && b && strcmp(cli_input(a), standard) == 0 && strcmp(cli_input(b), standard) == 0;
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

static bool parse_value(const cli_option *option, const char *text) {
    const char *end = text + strlen(text);
    uint32_t *size = option->value;
    cli_list *list = option->value;
    double number;
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
        good = value_ratio(text, &number, &end) && isfinite((float)number);
        if (good)
            *(float *)option->value = (float)number;
        break;
    case CLI_SIZE:
        good = parse_uint(text, option->min, option->max, &size[0], &end);
        size[1] = size[0];
        if (good && *end == 'x')
            good = parse_uint(end + 1, option->min, option->max, &size[1], &end);
        break;
    case CLI_CHOICE:
        choice = words_index(option->choices, text, strlen(text));
        good = choice >= 0;
        *(int *)option->value = choice;
        break;
    case CLI_COLOR:
        good = value_color(text, option->value);
        break;
    }
    return good && *end == 0;
}

static int bad_value(const cli_command *command, const cli_option *option, const char *text) {
    int length = (int)strcspn(option->names, "|");
    char hint[WORDS_HINT];
    if (option->kind == CLI_CHOICE)
        return cli_usage(command, "%.*s: unknown word '%s', expected %s%s", length, option->names,
                         text, option->choices, words_hint(text, option->choices, hint));
    if (option->kind == CLI_COLOR)
        return cli_usage(command, "%.*s: '%s' is no colour: expected r,g,b[,a], #rrggbb or %s%s",
                         length, option->names, text, value_color_names,
                         words_hint(text, value_color_names, hint));
    if (option->kind == CLI_UINT || option->kind == CLI_SIZE)
        return cli_usage(command, "%.*s: '%s' is not a %s from %u to %u", length, option->names,
                         text, option->kind == CLI_UINT ? "number" : "size", option->min,
                         option->max);
    return cli_usage(command, "%.*s: cannot read '%s'", length, option->names, text);
}

static int unknown_option(const cli_command *command, const char *argument) {
    char names[4096] = "--help", hint[WORDS_HINT];
    size_t used = strlen(names);
    for (uint32_t k = 0; k < command->noptions; k++) {
        size_t more = strlen(command->options[k].names);
        if (used + more + 2 > sizeof names)
            break;
        names[used++] = '|';
        memcpy(names + used, command->options[k].names, more + 1);
        used += more;
    }
    return cli_usage(command, "unknown option '%s'%s", argument, words_hint(argument, names, hint));
}

static const cli_option *find_option(const cli_command *command, const char *name, size_t length) {
    for (uint32_t k = 0; k < command->noptions; k++)
        if (words_index(command->options[k].names, name, length) >= 0)
            return &command->options[k];
    return NULL;
}

/* Reads the option at argv[*at], and its value, which may be the next one. */
static int parse_option(const cli_command *command, int argc, char **argv, int *at) {
    const char *argument = argv[*at], *value = NULL;
    size_t length = strncmp(argument, "--", 2) == 0 ? strcspn(argument, "=") : strlen(argument);
    const cli_option *option = find_option(command, argument, length);
    if (!option)
        return unknown_option(command, argument);
    if (argument[length] == '=')
        value = argument + length + 1;
    if (option->kind == CLI_FLAG) {
        if (value)
            return cli_usage(command, "%.*s takes no value", (int)length, argument);
        *(bool *)option->value = true;
    } else {
        if (!value && *at + 1 < argc)
            value = argv[++*at];
        if (!value)
            return cli_usage(command, "%s needs a value", argument);
        if (!parse_value(option, value))
            return bad_value(command, option, value);
    }
    if (option->given)
        *option->given = true;
    return EXIT_OK;
}

static bool exists(const char *path) {
    return access(path, F_OK) == 0;
}

/* What is written may be named by an option or stand behind the inputs; `extra` is an argument that
 * no input has taken, or NULL. */
static int take_output(const cli_command *command, const char *extra) {
    uint32_t *count = command->npositional;
    bool many = command->min_arguments < command->max_arguments;
    if (extra && !command->output)
        return cli_usage(command, "unexpected argument '%s'", extra);
    if (!command->output)
        return EXIT_OK;
    if (extra && *command->output)
        return cli_usage(command, "two names for what is written: %s and %s", extra,
                         *command->output);
    /* of two names the second is more likely an input that is misspelt */
    if (!extra && !*command->output && many && *count > command->min_arguments + 1 &&
        !exists(command->positional[*count - 1]))
        extra = command->positional[--*count];
    if (extra && command->output_is_new && exists(extra))
        return cli_usage(command,
                         "unexpected argument '%s': it is there already, and only --out "
                         "writes over what is",
                         extra);
    if (extra)
        *command->output = extra;
    if (command->output_needed && !*command->output)
        return cli_usage(command,
                         "the output is missing: name it behind the inputs, or with --out%s",
                         many ? " if it exists" : "");
    return EXIT_OK;
}

int cli_parse(const cli_command *command, int argc, char **argv) {
    bool only_positional = false;
    const char *extra = NULL;
    *command->npositional = 0;
    for (int i = 1; i < argc; i++) {
        const char *argument = argv[i];
        int code;
        if (only_positional || argument[0] != '-' || !argument[1]) {
            if (!argument[0])
                return cli_usage(command, "an argument is empty, where a name is expected");
            if (*command->npositional < command->max_arguments)
                command->positional[(*command->npositional)++] = argument;
            else if (!extra)
                extra = argument;
            else
                return cli_usage(command, "unexpected argument '%s'", argument);
        } else if (strcmp(argument, "--") == 0) {
            only_positional = true;
        } else if (strcmp(argument, "--help") == 0 || strcmp(argument, "-h") == 0) {
            cli_print_help(command);
            return EXIT_OK;
        } else if (strcmp(argument, CLI_ROW_OPTION) == 0) {
            cli_print_row(command);
            return EXIT_OK;
        } else if (strcmp(argument, CLI_TABLE_OPTION) == 0) {
            cli_print_table(command);
            return EXIT_OK;
        } else if ((code = parse_option(command, argc, argv, &i))) {
            return code;
        }
    }
    int code = take_output(command, extra);
    if (code)
        return code;
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
