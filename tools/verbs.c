/* Finds the verb that the command line begins with, and runs it. */
#include "verbs.h"
#include "command/cli.h"

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
    fputs("\nselvage VERB --help shows a verb's options and examples.\n"
          "Exit codes: 0 success, 1 failure, 2 wrong usage.\n",
          stream);
}

static int run(int argc, char **argv) {
    if (argc < 2) {
        print_help(stderr);
        return EXIT_USAGE;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 ||
        strcmp(argv[1], "help") == 0) {
        print_help(stdout);
        return EXIT_OK;
    }
    if (strcmp(argv[1], "--version") == 0) {
        uint32_t version = slv_version();
        printf("selvage %u.%u.%u\n", version >> 16, version >> 8 & 255, version & 255);
        return EXIT_OK;
    }
    for (size_t i = 0; i < sizeof verbs / sizeof *verbs; i++)
        if (strcmp(argv[1], verbs[i].name) == 0)
            return verbs[i].run(argc - 1, argv + 1);
    fprintf(stderr, "selvage: unknown verb '%s' (see selvage --help)\n", argv[1]);
    return EXIT_USAGE;
}

int command_main(int argc, char **argv) {
    cli_begin();
    int code = run(argc, argv);
    cli_end();
    return cli_answered(code);
}
