/* Names of textures. */
#include "command/ptx_name.h"

bool ptx_name_is_safe(const char *path) {
    return slv_ptx_is_name(path);
}

int ptx_name_usage(const cli_command *command, const char *path) {
    return cli_usage(command,
                     "%s: what is written is a .ptx file, so its name must end in .ptx (or .ptex)",
                     path);
}
