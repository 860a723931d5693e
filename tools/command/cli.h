/* What the verbs share: options, messages, progress, and the loading of a scene. */
#ifndef SELVAGE_TOOLS_CLI_H
#define SELVAGE_TOOLS_CLI_H

#include "command/names.h"

#include <selvage/selvage.h>

#include <stdatomic.h>

enum { EXIT_OK = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };

typedef enum cli_kind {
    CLI_FLAG,   /* bool */
    CLI_TEXT,   /* const char * */
    CLI_TEXTS,  /* cli_list: may be given more than once */
    CLI_UINT,   /* uint32_t within min..max */
    CLI_FLOAT,  /* float, finite; 1/2 is one too */
    CLI_SIZE,   /* uint32_t[2]: WxH or one number */
    CLI_CHOICE, /* int: index into choices, a list "a|b|c" */
    CLI_MODE,   /* the same, and the first of them if the next argument is none */
    CLI_COLOR   /* float[4]: r,g,b or r,g,b,a, #rrggbb, or a name */
} cli_kind;

enum { CLI_LIST_ROOM = 16 };

typedef struct cli_list {
    const char *items[CLI_LIST_ROOM];
    uint32_t count;
} cli_list;

typedef struct cli_option {
    const char *names; /* "--out|-o"; the first is shown. Behind two bars, "--list-faces||--faces",
                          are spellings of earlier versions, which are read and not shown. */
    cli_kind kind;
    void *value;
    const char *help;
    const char *choices; /* CLI_CHOICE: the words; others: what to call the value */
    uint32_t min, max;
    bool *given; /* may be NULL */
} cli_option;

/* Rows that more than one verb has. */
#define CLI_OUT(value, help, what)                                                                 \
    { "--out|-o|--output", CLI_TEXT, value, help, what, 0, 0, NULL }
#define CLI_MESH(value)                                                                            \
    {                                                                                              \
        "--mesh|-m", CLI_TEXT, value, "control mesh; default: the geometry inside the .ptx",       \
            "FILE.obj", 0, 0, NULL                                                                 \
    }
#define CLI_THREADS(value)                                                                         \
    { "--threads", CLI_UINT, value, "worker threads (one per processor)", NULL, 1, 256, NULL }
#define CLI_PROGRESS(value)                                                                        \
    {                                                                                              \
        "--progress", CLI_FLAG, value, "say on stderr how far it is, terminal or not", NULL, 0, 0, \
            NULL                                                                                   \
    }
#define CLI_JSON(value)                                                                            \
    { "--json", CLI_FLAG, value, "print JSON, for scripts", NULL, 0, 0, NULL }
#define CLI_QUIET(value, help)                                                                     \
    { "--quiet|-q", CLI_FLAG, value, help, NULL, 0, 0, NULL }
#define CLI_TEXTURE_ENCODING(value)                                                                \
    {                                                                                              \
        "--texture-encoding", CLI_CHOICE, value,                                                   \
            "what colours are (auto: what the file says, else srgb of integers)",                  \
            names_encodings(), 0, 0, NULL                                                          \
    }
#define CLI_COMPRESSION(value)                                                                     \
    { "--compression", CLI_UINT, value, "1 (fast) to 12 (small)", NULL, 1, 12, NULL }

#define CLI_REDUCTIONS(value, help, given)                                                         \
    { "--reductions", CLI_MODE, value, help, names_seams(), 0, 0, given }

#define CLI_TYPE(value, help, given)                                                               \
    { "--type|-t", CLI_CHOICE, value, help, names_types(), 0, 0, given }

typedef struct cli_command {
    const char *name, *summary, *arguments, *examples;
    const cli_option *options;
    uint32_t noptions;
    uint32_t min_arguments, max_arguments;
    const char **positional; /* inputs: room for max_arguments */
    uint32_t *npositional;
    /* Where the name of what is written goes, if the verb writes: from an option that has it as
     * its value (CLI_OUT), or from an argument behind the inputs. */
    const char **output;
    bool output_needed;
    const bool *output_spared; /* an option with which nothing is written after all; or NULL */
    bool output_is_new; /* one more argument may be meant as an input: it must not exist yet */
    const char *reads, *writes; /* in words */
    const char *exits; /* what exit codes mean; NULL: 0 success, 1 failure, 2 wrong usage */
} cli_command;

/* A command's part of this that says what it takes: a table of options, and so many inputs. */
#define CLI_TAKES(table, least, most, inputs, ninputs)                                             \
    .options = table, .noptions = sizeof table / sizeof *table, .min_arguments = least,            \
    .max_arguments = most, .positional = inputs, .npositional = ninputs

/* Fills the values. Returns -1 to go on, or the exit code: help was asked for, or the usage is
 * wrong. */
int cli_parse(const cli_command *command, int argc, char **argv);
/* What `selvage VERB --help` prints; and for the table of all verbs its row and its options. */
#define CLI_ROW_OPTION "--help-row"
#define CLI_TABLE_OPTION "--help-table"
void cli_print_help(const cli_command *command);
void cli_print_row(const cli_command *command);
void cli_print_table(const cli_command *command);
/* One line about wrong usage; returns EXIT_USAGE. */
int cli_usage(const cli_command *command, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* One line about a failure; returns EXIT_FAILED. */
int cli_error(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Before any verb: what it may rely on. */
void cli_begin(void);
/* After every verb: returns `code`, unless its answer could not be written, which is said, once. */
int cli_answered(int code);
/* Usage (2) if two of the names, some of which may be NULL, are of the standard input, which can be
 * read once; else 0. */
int cli_standard_once(const cli_command *command, const char *const *paths, size_t count);
#define CLI_STANDARD_ONCE(command, ...)                                                            \
    cli_standard_once(command, (const char *const[]){__VA_ARGS__},                                 \
                      sizeof((const char *const[]){__VA_ARGS__}) / sizeof(const char *))
/* The name under which "-" is read, standard input; another is as it was, NULL too. */
const char *cli_input(const char *path);
/* What to call an input that has another name only to be read by: the standard input, a pipe. All
 * lines on stderr have these words by themselves. */
const char *cli_shown(const char *path);
/* The name by which an open descriptor is read, as long as the process lasts; `shown` is what to
 * call it, and stays the caller's. NULL if there are too many. */
#define CLI_DESCRIPTORS "/dev/fd/"
const char *cli_name_pipe(int descriptor, const char *shown);
/* A texture is read here and there, and a pipe only once: if `*path` is "-" or the name of a pipe,
 * what comes through it is put into a file that has no name and is gone with the process, and
 * `*path` becomes the name to open it by. Other names stay. Returns an exit code. */
int cli_settle_input(const char **path);
/* Whether a name ends in an extension, ".ptx" in any case, and has something before it. */
bool cli_ends_with(const char *path, const char *extension);

/* One line that begins with "warning". */
void cli_warning(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* An environment that prints warnings and errors to stderr, "selvage: ..." a line, and has the
 * threads that the whole run of a verb shares. */
slv_env cli_env(uint32_t threads);
/* Ends the threads that environments share; nothing that was made with one is there any more. */
void cli_end(void);

/* Progress on stderr: rewritten in place on a terminal, otherwise a line each time a tenth is done.
 * `quiet` shows nothing. */
typedef struct cli_progress {
    const char *what;
    uint64_t total;
    bool quiet, terminal, fleeting;
    double started, shown;
    int tenths;
    atomic_uint_fast64_t done; /* by steps */
    atomic_flag busy;          /* a step is being shown */
} cli_progress;
/* Unless it is `forced`, nothing that is `quiet` or goes anywhere but to a terminal. */
cli_progress cli_progress_begin(const char *what, uint64_t total, bool forced, bool quiet);
/* The same, and nothing in the first moment of the work. Leaves nothing on a terminal. */
cli_progress cli_progress_fleeting(const char *what, bool forced, bool quiet);
void cli_progress_update(cli_progress *progress, uint64_t done);
/* The same as the callback that libraries take, `user` being the progress; false, to stop, after an
 * interrupt that cli_interrupted tells of. */
bool cli_progress_report(void *user, uint64_t done, uint64_t total);
/* One more of the total is done; from any thread. */
void cli_progress_step(cli_progress *progress);
void cli_progress_end(cli_progress *progress);

double cli_now(void); /* seconds */

/* From now on an interrupt (Ctrl-C, a polite kill, a terminal that is closed) only sets a flag, so
 * that long work can end tidily; a second one kills. */
void cli_catch_interrupts(void);
bool cli_interrupted(void);

#endif
