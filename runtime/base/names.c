/* The words for the values of an enumeration. */
#include "base/names.h"

#include <string.h>

const char *slvi_name_of(const char *const *names, uint32_t count, int value) {
    return value >= 0 && (uint32_t)value < count ? names[value] : "unknown";
}

bool slvi_name_find(const char *const *names, uint32_t count, const char *name, int *value) {
    for (uint32_t i = 0; name && i < count; i++) {
        if (strcmp(name, names[i]) == 0) {
            *value = (int)i;
            return true;
        }
    }
    return false;
}
