/* Each allocation of each call fails once: no crash, no leak, SLV_ERROR_MEMORY and one line in the
 * log. */
#include "kit/calls_kit.h"
#include "kit/memory_kit.h"

int main(void) {
    long all = 0;
    calls_begin();
    for (int i = 0; i < CALLS_COUNT; i++) {
        long failed = memory_sweep(calls_all[i].name, calls_all[i].call, calls_prepare);
        fprintf(stderr, "%-12s %ld allocations\n", calls_all[i].name, failed);
        all += failed;
    }
    CHECK(all > 500);
    calls_end();
    return test_end();
}
