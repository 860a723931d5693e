/* Contexts from EGL, without a window system. */
#include "gl/context/api.h"

#include "base/memory.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

#ifndef EGL_PLATFORM_SURFACELESS_MESA
#define EGL_PLATFORM_SURFACELESS_MESA 0x31DD
#endif

typedef __eglMustCastToProperFunctionPointerType (*get_proc_fn)(const char *);

struct egl_functions {
    get_proc_fn GetProcAddress;
    EGLBoolean (*Initialize)(EGLDisplay, EGLint *, EGLint *);
    EGLBoolean (*BindAPI)(EGLenum);
    EGLBoolean (*ChooseConfig)(EGLDisplay, const EGLint *, EGLConfig *, EGLint, EGLint *);
    EGLContext (*CreateContext)(EGLDisplay, EGLConfig, EGLContext, const EGLint *);
    EGLBoolean (*DestroyContext)(EGLDisplay, EGLContext);
    EGLBoolean (*MakeCurrent)(EGLDisplay, EGLSurface, EGLSurface, EGLContext);
    const char *(*QueryString)(EGLDisplay, EGLint);
    EGLContext (*GetCurrentContext)(void);
};

struct egl_state {
    struct egl_functions egl;
    EGLDisplay display;
    EGLContext context;
};

static bool load_egl(struct egl_functions *egl) {
    /* never closed: drivers leave threads and thread-local destructors behind */
    void *library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    return library && slvi_gl_symbol(library, "eglGetProcAddress", &egl->GetProcAddress) &&
           slvi_gl_symbol(library, "eglInitialize", &egl->Initialize) &&
           slvi_gl_symbol(library, "eglBindAPI", &egl->BindAPI) &&
           slvi_gl_symbol(library, "eglChooseConfig", &egl->ChooseConfig) &&
           slvi_gl_symbol(library, "eglCreateContext", &egl->CreateContext) &&
           slvi_gl_symbol(library, "eglDestroyContext", &egl->DestroyContext) &&
           slvi_gl_symbol(library, "eglMakeCurrent", &egl->MakeCurrent) &&
           slvi_gl_symbol(library, "eglQueryString", &egl->QueryString) &&
           slvi_gl_symbol(library, "eglGetCurrentContext", &egl->GetCurrentContext);
}

static slv_gl_proc find_proc(void *user, const char *name) {
    get_proc_fn get_proc = NULL;
    void *library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD);
    (void)user;
    if (!library || !slvi_gl_symbol(library, "eglGetProcAddress", &get_proc))
        return NULL;
    return (slv_gl_proc)get_proc(name);
}

/* Displays are never terminated: the process has one of each kind, and the host may be using it
 * too. */
static void destroy(void *user) {
    struct egl_state *state = user;
    if (state->egl.GetCurrentContext() == state->context)
        state->egl.MakeCurrent(state->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    state->egl.DestroyContext(state->display, state->context);
    slvi_free(state);
}

static bool try_display(struct egl_state *state, EGLDisplay display, const char **why) {
    static const EGLint config_attributes[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE,
                                               EGL_OPENGL_BIT, EGL_NONE};
    static const EGLint context_attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                                4,
                                                EGL_CONTEXT_MINOR_VERSION,
                                                5,
                                                EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                EGL_NONE};
    const struct egl_functions *egl = &state->egl;
    EGLConfig config = NULL;
    EGLint major, minor, count = 0;
    if (display == EGL_NO_DISPLAY || !egl->Initialize(display, &major, &minor)) {
        *why = "no display could be initialised";
        return false;
    }
    if (!egl->BindAPI(EGL_OPENGL_API) ||
        !egl->ChooseConfig(display, config_attributes, &config, 1, &count)) {
        *why = "no OpenGL on this display";
    } else {
        state->context =
            egl->CreateContext(display, count ? config : NULL, EGL_NO_CONTEXT, context_attributes);
        if (state->context == EGL_NO_CONTEXT) {
            *why = "the driver makes no OpenGL 4.5 core context";
        } else if (!egl->MakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, state->context)) {
            *why = "the context cannot be current without a surface";
            egl->DestroyContext(display, state->context);
        } else {
            state->display = display;
            return true;
        }
    }
    return false;
}

/* Devices first: with a GPU and no window system, the device platform is the one that reaches it.
 */
static bool try_devices(struct egl_state *state, bool hardware, const char **why) {
    PFNEGLQUERYDEVICESEXTPROC query_devices =
        (PFNEGLQUERYDEVICESEXTPROC)state->egl.GetProcAddress("eglQueryDevicesEXT");
    PFNEGLQUERYDEVICESTRINGEXTPROC query_string =
        (PFNEGLQUERYDEVICESTRINGEXTPROC)state->egl.GetProcAddress("eglQueryDeviceStringEXT");
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_display =
        (PFNEGLGETPLATFORMDISPLAYEXTPROC)state->egl.GetProcAddress("eglGetPlatformDisplayEXT");
    EGLDeviceEXT devices[16];
    EGLint count = 0;
    if (!query_devices || !query_string || !get_display || !query_devices(16, devices, &count))
        return false;
    for (EGLint i = 0; i < count; i++) {
        const char *extensions = query_string(devices[i], EGL_EXTENSIONS);
        bool software = extensions && strstr(extensions, "EGL_MESA_device_software");
        if (software != hardware &&
            try_display(state, get_display(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL), why))
            return true;
    }
    return false;
}

static bool try_surfaceless(struct egl_state *state, const char **why) {
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_display =
        (PFNEGLGETPLATFORMDISPLAYEXTPROC)state->egl.GetProcAddress("eglGetPlatformDisplayEXT");
    const char *extensions = state->egl.QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (!get_display || !extensions || !strstr(extensions, "EGL_MESA_platform_surfaceless"))
        return false;
    return try_display(state, get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL),
                       why);
}

slv_result slvi_gl_open_egl(const slv_env *env, bool hardware, char *why, size_t why_size,
                            slv_gl_platform *out, slv_gl_get_proc *get_proc) {
    const char *reason = hardware ? "no hardware device" : "no device or surfaceless platform";
    struct egl_state *state = NULL;
    slv_result result = slvi_alloc(env, "EGL", 1, sizeof *state, &state);
    if (result)
        return result;
    if (!load_egl(&state->egl)) {
        reason = "libEGL.so.1 cannot be loaded";
    } else if (hardware ? try_devices(state, true, &reason)
                        : try_surfaceless(state, &reason) || try_devices(state, false, &reason)) {
        out->state = state;
        out->destroy = destroy;
        *get_proc = find_proc;
        return SLV_OK;
    }
    slvi_free(state);
    snprintf(why, why_size, "%s", reason);
    return SLV_ERROR_GL;
}
