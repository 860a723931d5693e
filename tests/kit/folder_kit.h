/* The folder that a test works in. */
#ifndef FOLDER_KIT_H
#define FOLDER_KIT_H

#include "kit/remove_kit.h"
#include "kit/test.h"

static char test_folder[256];

static inline void test_folder_begin(void) {
    snprintf(test_folder, sizeof test_folder, "%s/selvage-test-XXXXXX", test_parent());
    REQUIRE(mkdtemp(test_folder));
}

static inline void test_folder_end(void) {
    test_remove(test_folder);
    CHECK(access(test_folder, F_OK) != 0);
}

/* A path in it; four are valid at a time. */
static inline const char *test_path(const char *name) {
    static char paths[4][1024];
    static int turn;
    char *path = paths[turn = (turn + 1) % 4];
    snprintf(path, sizeof paths[0], "%s/%s", test_folder, name);
    return path;
}

#endif
