/* Linked into every program of a sanitizer build: drivers that stay loaded keep their names in leak
 * reports, so that their leaks can be told from ours (tests/kit/lsan.supp). */
#include <dlfcn.h>

__attribute__((visibility("default"))) int dlclose(void *handle);

int dlclose(void *handle) {
    (void)handle;
    return 0;
}
