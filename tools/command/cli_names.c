/* What inputs are called that have another name only to be read by. */
#include "command/cli.h"

#include <stdio.h>
#include <string.h>

enum { MOST_NAMES = 64 };

static struct {
    char name[sizeof CLI_DESCRIPTORS + 12];
    const char *shown;
} pipes[MOST_NAMES];
static int count;

const char *cli_input(const char *path) {
    return path && strcmp(path, "-") == 0 ? "/dev/stdin" : path;
}

const char *cli_name_pipe(int descriptor, const char *shown) {
    if (count == MOST_NAMES)
        return NULL;
    snprintf(pipes[count].name, sizeof pipes[0].name, CLI_DESCRIPTORS "%d", descriptor);
    pipes[count].shown = shown;
    return pipes[count++].name;
}

const char *cli_shown(const char *path) {
    if (strcmp(path, cli_input("-")) == 0)
        return "standard input";
    for (int i = 0; i < count; i++)
        if (strcmp(path, pipes[i].name) == 0)
            return pipes[i].shown;
    return path;
}
