/* selvage studio where there is no window: its words and exit codes. */
#include "kit/tool_kit.h"

int main(void) {
    tool_begin();
    RUNS(0, "studio --help");
    HAS("--log");
    RUNS(2, "studio a.ptx b.ptx");
    RUNS(2, "studio --nothing");
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    /* the program says that there is no display; where it was not built, the verb says that */
    RUNS(1, "studio a.ptx");
    HAS("studio: ");
    HAS("selvage paint");
    tool_end();
    return test_end();
}
