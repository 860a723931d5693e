/* Functions of the GL context that EGL made current, as a host application gets them. */
#ifndef HOST_KIT_H
#define HOST_KIT_H

#include <selvage/gl_context.h>

#include <dlfcn.h>
#include <string.h>

/* `library` is libEGL, opened by dlopen. */
static slv_gl_proc host_proc(void *library, const char *name) {
    slv_gl_proc (*get_proc)(const char *) = NULL;
    void *symbol = dlsym(library, "eglGetProcAddress");
    memcpy(&get_proc, &symbol, sizeof symbol);
    return get_proc ? get_proc(name) : NULL;
}

#endif
