/* Contexts from OSMesa, drawn in this process. */
#include "gl/context/api.h"

#include "base/memory.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

/* From <GL/osmesa.h>, which cannot be included beside the core profile header. */
enum {
    OSMESA_FORMAT = 0x22,
    OSMESA_DEPTH_BITS = 0x30,
    OSMESA_PROFILE = 0x33,
    OSMESA_CORE_PROFILE = 0x34,
    OSMESA_CONTEXT_MAJOR_VERSION = 0x36,
    OSMESA_CONTEXT_MINOR_VERSION = 0x37
};

struct osmesa_state {
    void *(*create)(const int *attributes, void *share);
    GLboolean (*make_current)(void *context, void *buffer, GLenum type, GLsizei width,
                              GLsizei height);
    void (*destroy)(void *context);
    void *context;
    unsigned char pixel[16 * 4]; /* OSMesa cannot be current without somewhere to draw */
};

static void *open_library(int flags) {
    static const char *const names[] = {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"};
    void *library = NULL;
    for (size_t i = 0; !library && i < sizeof names / sizeof *names; i++)
        library = dlopen(names[i], RTLD_NOW | RTLD_LOCAL | flags);
    return library;
}

static slv_gl_proc find_proc(void *user, const char *name) {
    slv_gl_proc (*get_proc)(const char *) = NULL;
    void *library = open_library(RTLD_NOLOAD);
    (void)user;
    if (!library || !slvi_gl_symbol(library, "OSMesaGetProcAddress", &get_proc))
        return NULL;
    return get_proc(name);
}

static void destroy(void *user) {
    struct osmesa_state *state = user;
    state->make_current(NULL, NULL, 0, 0, 0);
    state->destroy(state->context);
    slvi_free(state);
}

slv_result slvi_gl_open_osmesa(const slv_env *env, char *why, size_t why_size, slv_gl_platform *out,
                               slv_gl_get_proc *get_proc) {
    static const int attributes[] = {OSMESA_FORMAT,
                                     GL_RGBA,
                                     OSMESA_DEPTH_BITS,
                                     24,
                                     OSMESA_PROFILE,
                                     OSMESA_CORE_PROFILE,
                                     OSMESA_CONTEXT_MAJOR_VERSION,
                                     4,
                                     OSMESA_CONTEXT_MINOR_VERSION,
                                     5,
                                     0,
                                     0};
    const char *reason;
    struct osmesa_state *state = NULL;
    slv_result result = slvi_alloc(env, "OSMesa", 1, sizeof *state, &state);
    if (result)
        return result;
    void *library = open_library(0);
    if (!library) {
        reason = "libOSMesa.so cannot be loaded";
    } else if (!slvi_gl_symbol(library, "OSMesaCreateContextAttribs", &state->create) ||
               !slvi_gl_symbol(library, "OSMesaMakeCurrent", &state->make_current) ||
               !slvi_gl_symbol(library, "OSMesaDestroyContext", &state->destroy)) {
        reason = "the library is too old";
    } else if (!(state->context = state->create(attributes, NULL))) {
        reason = "it makes no OpenGL 4.5 core context";
    } else if (!state->make_current(state->context, state->pixel, GL_UNSIGNED_BYTE, 4, 4)) {
        reason = "the context cannot be made current";
        state->destroy(state->context);
    } else {
        out->state = state;
        out->destroy = destroy;
        *get_proc = find_proc;
        return SLV_OK;
    }
    slvi_free(state);
    snprintf(why, why_size, "%s", reason);
    return SLV_ERROR_GL;
}
