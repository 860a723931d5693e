/* Joining the processes of an mpirun, by a module that is opened where it is needed. */
#include "command/team.h"
#include "command/cli.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* How many processes there are, by what Open MPI and MPICH tell each. */
static unsigned long number_of(const char *ompi, const char *pmi, unsigned long otherwise) {
    const char *text = getenv(ompi);
    text = text ? text : getenv(pmi);
    return text ? strtoul(text, NULL, 10) : otherwise;
}

int cli_team_begin(cli_team *team) {
    *team = (cli_team){.module = NULL};
    if (number_of("OMPI_COMM_WORLD_SIZE", "PMI_SIZE", 1) < 2)
        return -1;
    void *library = dlopen("libselvage-mpi.so", RTLD_NOW | RTLD_GLOBAL);
    const cli_team_module *module = library ? dlsym(library, CLI_TEAM_SYMBOL) : NULL;
    if (!module) {
        if (number_of("OMPI_COMM_WORLD_RANK", "PMI_RANK", 0) == 0)
            cli_error("several processes were started, but this build has no MPI: install "
                      "libopenmpi-dev and build it again");
        return EXIT_FAILED;
    }
    if (module->begin(&team->team.rank, &team->team.count))
        return cli_error("MPI could not be started");
    team->module = module;
    team->team.send = module->send;
    team->team.receive = module->receive;
    return -1;
}

static void keep_error(void *user, slv_log_level level, const char *message) {
    cli_team *team = user;
    if (level == SLV_LOG_ERROR)
        snprintf(team->message, sizeof team->message, "%s", message);
}

slv_env cli_team_env(cli_team *team, uint32_t threads) {
    unsigned long here = number_of("OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS", 1);
    if (!team->module)
        return cli_env(threads);
    if (!threads) {
        long all = sysconf(_SC_NPROCESSORS_ONLN);
        threads = all > (long)here ? (uint32_t)(all / (long)here) : 1;
    }
    slv_env env = cli_env(threads);
    if (team->team.rank) {
        env.log = keep_error;
        env.log_user = team;
    }
    return env;
}

int cli_team_end(cli_team *team, int code) {
    enum { PATIENCE = 500000 };
    if (!team->module)
        return code;
    if (code && !team->complete) {
        /* what is wrong for all rank 0 says, and ends the others before they do */
        if (team->team.rank) {
            usleep(PATIENCE);
            if (team->message[0])
                cli_error("rank %u: %s", team->team.rank, team->message);
        }
        fflush(stdout);
        team->module->abort();
    }
    team->module->end();
    return code;
}
