/* The verb studio: starts the window, which is a program of its own, so that the command needs no
 * toolkit. */
#include "command/output.h"
#include "verbs.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Beside the command in a build, else where it is installed. */
static bool find_program(char *out, size_t size) {
    static const char *const places[] = {"selvage-studio", "../libexec/selvage/selvage-studio"};
    char own[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", own, sizeof own - 1);
    char *slash = NULL;
    if (length > 0) {
        own[length] = 0;
        slash = strrchr(own, '/');
    }
    for (size_t i = 0; slash && i < sizeof places / sizeof *places; i++) {
        int used = snprintf(out, size, "%.*s%s", (int)(slash + 1 - own), own, places[i]);
        if (used > 0 && (size_t)used < size && access(out, X_OK) == 0)
            return true;
    }
    return false;
}

int verb_studio(int argc, char **argv) {
    const char *file = NULL, *mesh = NULL, *log = NULL, *pen = NULL;
    char size[32];
    uint32_t area[2];
    bool size_given = false;
    char program[PATH_MAX + 64];
    uint32_t narguments = 0;
    const cli_option options[] = {
        CLI_MESH(&mesh),
        {"--size", CLI_SIZE, area, "of the picture in the window", "WxH", 64, 16384, &size_given},
        {"--log", CLI_TEXT, &log, "write what happens into a file, JSON lines", "FILE", 0, 0, NULL},
        {"--pen", CLI_TEXT, &pen, "play the log of a pen, as it is read from a file or pipe",
         "FILE", 0, 0, NULL},
    };
    const cli_command command = {.name = "studio",
                                 .summary = "see, compare and paint a .ptx in a window",
                                 .arguments = "[FILE.ptx|MESH.obj|NAME.selvage]",
                                 .reads = "a texture of quads, a mesh, or a painting session",
                                 .writes = "what is saved in the window",
                                 .examples = "  selvage studio cow.ptx\n"
                                             "  selvage studio cow.obj\n"
                                             "  selvage studio cow.selvage\n",
                                 .options = options,
                                 .noptions = sizeof options / sizeof *options,
                                 .max_arguments = 1,
                                 .positional = &file,
                                 .npositional = &narguments};
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    if (!find_program(program, sizeof program))
        return cli_error("studio: was not built: it takes GTK 4 (libgtk-4-dev and libepoxy-dev on "
                         "Debian) where Selvage is built; without a window, selvage render draws, "
                         "and selvage paint and selvage session paint");
    snprintf(size, sizeof size, "%ux%u", area[0], area[1]);
    const struct {
        const char *option, *value;
    } given[] = {
        {"--mesh", mesh}, {"--log", log}, {"--pen", pen}, {"--size", size_given ? size : NULL}};
    const char *arguments[16] = {program};
    int n = 1;
    for (size_t i = 0; i < sizeof given / sizeof *given; i++)
        if (given[i].value) {
            arguments[n++] = given[i].option;
            arguments[n++] = given[i].value;
        }
    if (file)
        arguments[n++] = file;
    cli_end();
    execv(program, (char *const *)(uintptr_t)arguments);
    return cli_error("studio: %s: %s", program, strerror(errno));
}
