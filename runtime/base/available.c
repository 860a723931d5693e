/* How much memory there is to be had. */
#include <selvage/result.h>

#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

static uint64_t least(uint64_t a, uint64_t b) {
    return a < b ? a : b;
}

/* The first number of a file behind a word (NULL: at its beginning); `otherwise` if there is none.
 */
static uint64_t read_number(const char *path, const char *word, uint64_t otherwise) {
    char text[2048];
    FILE *stream = fopen(path, "re");
    if (!stream)
        return otherwise;
    text[fread(text, 1, sizeof text - 1, stream)] = 0;
    fclose(stream);
    const char *at = word ? strstr(text, word) : text;
    unsigned long long number;
    return at && sscanf(at + (word ? strlen(word) : 0), "%llu", &number) == 1 ? number : otherwise;
}

/* What programs can have without swapping, by the kernel's own estimate. */
static uint64_t of_machine(void) {
    long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    uint64_t all = pages > 0 && page > 0 ? (uint64_t)pages * (uint64_t)page : UINT64_MAX,
             kibibytes = read_number("/proc/meminfo", "MemAvailable:", UINT64_MAX >> 10);
    return least(all, kibibytes << 10);
}

static uint64_t of_group(void) {
    uint64_t most = read_number("/sys/fs/cgroup/memory.max", NULL, UINT64_MAX),
             used = read_number("/sys/fs/cgroup/memory.current", NULL, 0);
    return most > used ? most - used : 0;
}

uint64_t slv_memory_available(void) {
    struct rlimit limit;
    uint64_t most = least(of_machine(), of_group());
    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        most = least(most, limit.rlim_cur);
    return most;
}
