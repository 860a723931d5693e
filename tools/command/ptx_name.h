/* What a texture may be written over. */
#ifndef SELVAGE_TOOLS_PTX_NAME_H
#define SELVAGE_TOOLS_PTX_NAME_H

#include "command/cli.h"

/* False for a name that does not end in .ptx: of several files on a command line it is most likely
 * another one, which would be lost. */
bool ptx_name_is_safe(const char *path);
/* One line about such a name; returns EXIT_USAGE. */
int ptx_name_usage(const cli_command *command, const char *path);

#endif
