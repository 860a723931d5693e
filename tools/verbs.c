/* Finds the verb that the command line begins with, and runs it. */
#include "verbs.h"
#include "command/cli.h"
#include "command/words.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *name, *summary;
    int (*run)(int argc, char **argv);
} verbs[] = {
#define VERB(name, summary) {#name, summary, verb_##name},
    SELVAGE_VERBS(VERB)
#undef VERB
};

static void print_help(FILE *stream) {
    fputs("selvage - per-face (Ptex-style) textures: view, compare, inspect\n\n"
          "Usage: selvage VERB [arguments] [options]\n\nVerbs:\n",
          stream);
    for (size_t i = 0; i < sizeof verbs / sizeof *verbs; i++)
        fprintf(stream, "  %-9s %s\n", verbs[i].name, verbs[i].summary);
    fputs("\nselvage help VERB shows a verb's options and examples.\n"
          "Exit codes: 0 success, 1 failure, 2 wrong usage.\n",
          stream);
}

/* Calls the verb; if there is none of that name, says which one may have been meant. */
static int run_verb(int argc, char **argv) {
    char names[512] = "help|--help|--version", hint[SLV_WORDS_HINT];
    for (size_t i = 0; i < sizeof verbs / sizeof *verbs; i++) {
        if (strcmp(argv[0], verbs[i].name) == 0)
            return verbs[i].run(argc, argv);
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "|%s", verbs[i].name);
    }
    fprintf(stderr, "selvage: unknown verb '%s'%s (see selvage --help)\n", argv[0],
            slv_words_hint(argv[0], names, hint));
    return EXIT_USAGE;
}

/* What every verb says of itself to an option. */
static void ask_all(const char *asked) {
    for (size_t i = 0; i < sizeof verbs / sizeof *verbs; i++) {
        char name[32], option[32], *words[] = {name, option, NULL};
        snprintf(name, sizeof name, "%s", verbs[i].name);
        snprintf(option, sizeof option, "%s", asked);
        verbs[i].run(2, words);
    }
}

/* The last part of docs/verbs.md. */
static int print_table(void) {
    puts("| verb | reads | writes | exit codes |\n|---|---|---|---|");
    ask_all(CLI_ROW_OPTION);
    putchar('\n');
    ask_all(CLI_TABLE_OPTION);
    return EXIT_OK;
}

static int run_help(int argc, char **argv) {
    char help[] = "--help", *words[] = {argc > 2 ? argv[2] : NULL, help, NULL};
    if (argc > 3) {
        fprintf(stderr, "selvage help: unexpected argument '%s' (see selvage --help)\n", argv[3]);
        return EXIT_USAGE;
    }
    if (argc > 2 && strcmp(argv[2], "--table") == 0)
        return print_table();
    if (argc > 2 && strcmp(argv[2], "help") != 0 && strcmp(argv[2], "--help") != 0)
        return run_verb(2, words);
    print_help(stdout);
    return EXIT_OK;
}

static int run(int argc, char **argv) {
    if (argc < 2) {
        print_help(stderr);
        return EXIT_USAGE;
    }
    if (strcmp(argv[1], "help") == 0)
        return run_help(argc, argv);
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
        print_help(stdout);
        return EXIT_OK;
    }
    if (strcmp(argv[1], "--version") == 0) {
        uint32_t version = slv_version();
        printf("selvage %u.%u.%u\n", version >> 16, version >> 8 & 255, version & 255);
        return EXIT_OK;
    }
    return run_verb(argc - 1, argv + 1);
}

int command_main(int argc, char **argv) {
    cli_begin();
    int code = run(argc, argv);
    cli_end();
    return cli_answered(code);
}
