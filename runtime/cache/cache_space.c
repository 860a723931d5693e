/* How much address space a cache can reserve where that is limited. */
#include "cache/cache_data.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

/* Bytes of address space and of data that the process has; zero where nobody says. */
static void measure(uint64_t *all, uint64_t *data) {
    char text[128] = "";
    unsigned long long size = 0, pages = 0;
    int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    ssize_t got = file < 0 ? -1 : read(file, text, sizeof text - 1);
    long page = sysconf(_SC_PAGESIZE);
    if (file >= 0)
        close(file);
    if (got > 0)
        (void)sscanf(text, "%llu %*u %*u %*u %*u %llu", &size, &pages);
    *all = size * (uint64_t)(page > 0 ? page : 4096);
    *data = pages * (uint64_t)(page > 0 ? page : 4096);
}

/* Half of what a limit leaves: the rest is for whoever looks things up. */
static uint64_t within(int resource, uint64_t used, uint64_t wanted) {
    struct rlimit limit;
    if (getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
        return wanted;
    uint64_t left = limit.rlim_cur > used ? ((uint64_t)limit.rlim_cur - used) / 2 : 0;
    return left < wanted ? left : wanted;
}

static bool is_limited(int resource) {
    struct rlimit limit;
    return getrlimit(resource, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
}

uint64_t slvi_cache_space(uint64_t wanted, uint64_t least) {
    uint64_t all, data;
    if (is_limited(RLIMIT_AS) || is_limited(RLIMIT_DATA)) {
        measure(&all, &data);
        wanted = within(RLIMIT_AS, all, wanted);
        wanted = within(RLIMIT_DATA, data, wanted);
    }
    /* systems that promise no more memory than they have refuse without a limit */
    for (; wanted > least; wanted /= 2) {
        void *probe = mmap(NULL, wanted, PROT_READ | PROT_WRITE,
                           MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        if (probe != MAP_FAILED) {
            munmap(probe, wanted);
            break;
        }
    }
    return wanted > least ? wanted : least;
}
