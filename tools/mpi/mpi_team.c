/* The module that knows MPI: messages between the processes of an mpirun. */
#include "command/team.h"

#include <mpi.h>

#include <unistd.h>

#define PIECE (UINT64_C(1) << 30) /* MPI counts in int */

static int begin(uint32_t *rank, uint32_t *count) {
    int own = 0, all = 0, level = 0;
    if (MPI_Init_thread(NULL, NULL, MPI_THREAD_FUNNELED, &level) != MPI_SUCCESS ||
        level < MPI_THREAD_FUNNELED || MPI_Comm_rank(MPI_COMM_WORLD, &own) != MPI_SUCCESS ||
        MPI_Comm_size(MPI_COMM_WORLD, &all) != MPI_SUCCESS)
        return 1;
    *rank = (uint32_t)own;
    *count = (uint32_t)all;
    return 0;
}

static int send_to(void *user, uint32_t to, const void *bytes, uint64_t size) {
    const char *at = bytes;
    (void)user;
    for (uint64_t part; size; at += part, size -= part) {
        part = size < PIECE ? size : PIECE;
        if (MPI_Send(at, (int)part, MPI_BYTE, (int)to, 0, MPI_COMM_WORLD) != MPI_SUCCESS)
            return 1;
    }
    return 0;
}

/* Asks now and then instead of waiting in MPI, which would take a processor from a thread. */
static int wait_for(int from, MPI_Status *status) {
    int there = 0;
    for (;;) {
        if (MPI_Iprobe(from, 0, MPI_COMM_WORLD, &there, status) != MPI_SUCCESS)
            return 1;
        if (there)
            return 0;
        usleep(200);
    }
}

static int receive_from(void *user, uint32_t *from, void *bytes, uint64_t size) {
    int source = *from == SLV_BAKE_ANY_RANK ? MPI_ANY_SOURCE : (int)*from;
    char *at = bytes;
    MPI_Status status;
    (void)user;
    for (uint64_t part; size; at += part, size -= part) {
        part = size < PIECE ? size : PIECE;
        if (wait_for(source, &status))
            return 1;
        source = status.MPI_SOURCE;
        if (MPI_Recv(at, (int)part, MPI_BYTE, source, 0, MPI_COMM_WORLD, &status) != MPI_SUCCESS)
            return 1;
    }
    if (source >= 0)
        *from = (uint32_t)source;
    return 0;
}

static void end(void) {
    MPI_Finalize();
}

static void end_all(void) {
    MPI_Abort(MPI_COMM_WORLD, 1);
}

__attribute__((visibility("default"))) extern const cli_team_module selvage_team_module;
const cli_team_module selvage_team_module = {begin, send_to, receive_from, end, end_all};
