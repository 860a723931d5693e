/* Names of textures. */
#ifndef SELVAGE_TOOLS_PTX_NAME_H
#define SELVAGE_TOOLS_PTX_NAME_H

#include "command/cli.h"

/* slv_ptx_is_name. Nothing else is written
 * over by a texture: of several files on a command line it is most likely another one, which would
 * be lost. */
bool ptx_name_is_safe(const char *path);
/* One line about such a name; returns EXIT_USAGE. */
int ptx_name_usage(const cli_command *command, const char *path);

#endif
