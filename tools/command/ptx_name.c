/* Names that textures may be written over. */
#include "command/ptx_name.h"

bool ptx_name_is_safe(const char *path) {
    return cli_ends_with(path, ".ptx");
}

int ptx_name_usage(const cli_command *command, const char *path) {
    return cli_usage(command, "%s: what is written is a .ptx file, so its name must end in .ptx",
                     path);
}
