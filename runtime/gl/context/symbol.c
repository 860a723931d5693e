/* Functions of libraries that are opened at run time. */
#include "gl/context/api.h"

#include <dlfcn.h>
#include <string.h>

bool slvi_gl_symbol(void *library, const char *name, void *out) {
    void *symbol = dlsym(library, name);
    memcpy(out, &symbol, sizeof symbol);
    return symbol != NULL;
}
