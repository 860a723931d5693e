/* Processes that mpirun started together. What knows MPI is a module of its own, so that the
 * command needs no MPI where it is not used. */
#ifndef SELVAGE_TOOLS_TEAM_H
#define SELVAGE_TOOLS_TEAM_H

#include <selvage/bake.h>

/* What the module libselvage-mpi has under the name CLI_TEAM_SYMBOL. */
typedef struct cli_team_module {
    int (*begin)(uint32_t *rank, uint32_t *count); /* 0: all went well */
    int (*send)(void *user, uint32_t to, const void *bytes, uint64_t size);
    int (*receive)(void *user, uint32_t *from, void *bytes, uint64_t size);
    void (*end)(void);
    void (*abort)(void); /* ends all processes */
} cli_team_module;
#define CLI_TEAM_SYMBOL "selvage_team_module"

typedef struct cli_team {
    const cli_team_module *module; /* NULL: there is one process */
    slv_bake_team team;
    bool complete;     /* what they do together is done: a code other than 0 is no failure of it */
    char message[600]; /* the last error of a rank above 0, which rank 0 may have told too */
} cli_team;

/* Joins the processes that this one was started with, if there are any. Returns -1 to go on, or an
 * exit code. */
int cli_team_begin(cli_team *team);
/* What a rank should use: errors of ranks above 0 are kept, and processors are shared out. */
slv_env cli_team_env(cli_team *team, uint32_t threads);
/* Leaves them. After a failure all end, and the code is that of a failure. Returns the code. */
int cli_team_end(cli_team *team, int code);

#endif
