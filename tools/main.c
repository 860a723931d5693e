#include "command/cli.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *name, *summary;
    int (*run)(int argc, char **argv);
} verbs[] = {
    {"render", "draw a .ptx on its subdivision surface into a PNG or EXR", verb_render},
    {"compare", "measure the seam strategies against each other and write a report", verb_compare},
    {"reference", "ray-cast a .ptx: the picture that strategies are measured against",
     verb_reference},
    {"info", "say what a .ptx or a mesh holds", verb_info},
    {"check", "say whether a .ptx is sound, naming face and edge of what is not", verb_check},
    {"diff", "say which faces of two .ptx files differ, how much and where", verb_diff},
    {"convert", "change type, channels or size of a .ptx; images in and out", verb_convert},
    {"merge", "join several .ptx files into one", verb_merge},
    {"transfer", "carry texels over to a changed model", verb_transfer},
    {"sample", "filtered lookups in a .ptx, a line each; how many a second", verb_sample},
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

int main(int argc, char **argv) {
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
