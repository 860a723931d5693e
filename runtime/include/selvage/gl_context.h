/* OpenGL 4.5 contexts without a window: EGL, OSMesa, or the host application's own. */
#ifndef SELVAGE_GL_CONTEXT_H
#define SELVAGE_GL_CONTEXT_H

#include <selvage/result.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum slv_gl_backend {
    SLV_GL_AUTO = 0, /* EGL on a hardware device, then EGL on whatever there is, then OSMesa */
    SLV_GL_EGL,      /* device or surfaceless platform; no window system is touched */
    SLV_GL_OSMESA,   /* software, in this process */
    SLV_GL_HOST      /* the application's own context, see slv_gl_wrap */
} slv_gl_backend;

/* auto, egl, osmesa, host */
SLV_API const char *slv_gl_backend_name(slv_gl_backend backend);
/* Knows those that slv_gl_create takes: not `host`. */
SLV_API bool slv_gl_backend_from_name(const char *name, slv_gl_backend *out);

typedef struct slv_gl_info {
    slv_gl_backend backend;
    char vendor[128], renderer[128], version[128];
    bool software; /* shaded on the CPU: time frames by the clock, not by GL timers */
    uint32_t max_msaa;
    uint32_t max_anisotropy; /* 1 if the driver has no anisotropic filtering */
    uint32_t max_layers, max_texture_size, texture_units;
} slv_gl_info;

/* A context and its functions. Belongs to the thread on which it is current, with all objects made
 * from it. */
typedef struct slv_gl slv_gl;

typedef void (*slv_gl_proc)(void);
typedef slv_gl_proc (*slv_gl_get_proc)(void *user, const char *name);

/* Makes a headless OpenGL 4.5 core context and makes it current on the calling thread, in place of
 * what was. SLV_ERROR_GL says for each way that was tried why it failed. */
SLV_NODISCARD SLV_API slv_result slv_gl_create(const slv_env *env, slv_gl_backend backend,
                                               slv_gl **out);

/* Uses the context that is current now. `get_proc` is only called during this call
 * (eglGetProcAddress, glfwGetProcAddress, ...). Functions of this library that make, upload, update
 * or read textures leave all GL state as it was. Those that draw or look up set all that they
 * depend on, and do not restore it: pixel store and pixel buffer bindings, clip control, raster,
 * depth, stencil and blend state, the framebuffer (to 0 when done), viewport, program, vertex
 * array, and what slv_gl_texture_bind binds. They leave no error behind, and drop one that the
 * application left. Where neither the context nor one that shares its objects is current on the
 * calling thread, those that give a result do nothing: SLV_ERROR_GL; and those that destroy free
 * memory alone: the context keeps its objects, and no other context's are deleted for them. */
SLV_NODISCARD SLV_API slv_result slv_gl_wrap(const slv_env *env, slv_gl_get_proc get_proc,
                                             void *user, slv_gl **out);

/* Destroys the context, unless it is the host's; it need not be current. Objects made from it must
 * be gone. */
SLV_API void slv_gl_destroy(slv_gl *gl);

SLV_API const slv_gl_info *slv_gl_get_info(const slv_gl *gl);

/* Whether the driver draws with exactly so many samples per pixel. For a number up to max_msaa that
 * it does not have, it takes more without saying so. Changes no GL state. */
SLV_API bool slv_gl_has_samples(const slv_gl *gl, uint32_t samples);

/* An OpenGL function by its full name ("glClear"), for drawing of one's own in a context that
 * slv_gl_create made. NULL if the driver has none of that name (some drivers return a pointer for
 * every name), and in a wrapped context, whose application has a loader. */
SLV_API slv_gl_proc slv_gl_get_function(const slv_gl *gl, const char *name);

#ifdef __cplusplus
}
#endif

#endif
