/* What the verbs that go on past damage share. */
#ifndef SELVAGE_TOOLS_SALVAGE_H
#define SELVAGE_TOOLS_SALVAGE_H

#include "command/cli.h"

#define CLI_SALVAGE(value)                                                                         \
    {                                                                                              \
        "--salvage", CLI_FLAG, value,                                                              \
            "go on past faces that cannot be read: fill them from a reduction, name them, exit "   \
            "with 1",                                                                              \
            NULL, 0, 0, NULL                                                                       \
    }

/* Opens a file, past damage if that is asked for. */
slv_result salvage_open(const slv_env *env, const char *path, bool salvage, slv_ptx **out);
/* Says in one line which faces of a file were filled; the exit code, EXIT_OK if none was and
 * nothing else left out. */
int salvage_tell(const slv_ptx *ptx);

#endif
