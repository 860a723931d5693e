#include "command/ptx_name.h"

#include <string.h>
#include <strings.h>

bool ptx_name_is_safe(const char *path) {
    size_t length = strlen(path);
    return length > 4 && strcasecmp(path + length - 4, ".ptx") == 0;
}

int ptx_name_usage(const cli_command *command, const char *path) {
    return cli_usage(command, "%s: what is written is a .ptx file, so its name must end in .ptx",
                     path);
}
