/* Contexts: which kinds are tried, what the driver can do, and the state that this library relies
 * on. */
#include "gl/context/api.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/names.h"

#include <inttypes.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

static const char *const backends[] = {"auto", "egl", "osmesa", "host"};

const char *slv_gl_backend_name(slv_gl_backend backend) {
    return slvi_name_of(backends, SLVI_COUNT(backends), (int)backend);
}

bool slv_gl_backend_from_name(const char *name, slv_gl_backend *out) {
    int value = 0;
    bool found = slvi_name_find(backends, SLV_GL_HOST, name, &value);
    if (found)
        *out = (slv_gl_backend)value;
    return found;
}

static slv_result load_functions(const slv_env *env, slv_gl_api *api, slv_gl_get_proc get_proc,
                                 void *user) {
    const char *missing = NULL;
    slv_gl_proc proc;
#define SLV_GL_LOAD(type, name)                                                                    \
    proc = get_proc(user, "gl" #name);                                                             \
    if (!proc)                                                                                     \
        missing = "gl" #name;                                                                      \
    api->name = (type)proc;
    SLV_GL_HANDLE_FUNCTIONS(SLV_GL_LOAD)
    missing = NULL;
    SLV_GL_FUNCTIONS(SLV_GL_LOAD)
#undef SLV_GL_LOAD
    if (missing)
        return slvi_fail(env, SLV_ERROR_GL, "the driver lacks %s: OpenGL 4.5 is needed", missing);
    return SLV_OK;
}

static void copy_string(const slv_gl_api *api, GLenum name, char *out, size_t size) {
    const GLubyte *text = api->GetString(name);
    snprintf(out, size, "%s", text ? (const char *)text : "unknown");
}

static bool has_extension(const slv_gl_api *api, const char *wanted) {
    GLint count = 0;
    api->GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; i++) {
        const GLubyte *name = api->GetStringi(GL_EXTENSIONS, (GLuint)i);
        if (name && strcmp((const char *)name, wanted) == 0)
            return true;
    }
    return false;
}

static const GLenum target_formats[] = {GL_RGBA16F, GL_RGBA32F, GL_DEPTH_COMPONENT32F};
enum { TARGET_FORMATS = sizeof target_formats / sizeof *target_formats, MAX_COUNTS = 16 };

static void list_samples(const slv_gl_api *api, GLenum format, GLint counts[MAX_COUNTS]) {
    memset(counts, 0, MAX_COUNTS * sizeof *counts);
    api->GetInternalformativ(GL_RENDERBUFFER, format, GL_SAMPLES, MAX_COUNTS, counts);
}

static uint32_t max_samples(const slv_gl_api *api) {
    GLint counts[MAX_COUNTS], best = 1;
    for (size_t f = 0; f < TARGET_FORMATS; f++) {
        GLint found = 1;
        list_samples(api, target_formats[f], counts);
        for (size_t i = 0; i < MAX_COUNTS; i++)
            if (counts[i] > found)
                found = counts[i];
        best = f == 0 || found < best ? found : best;
    }
    return (uint32_t)best;
}

bool slv_gl_has_samples(const slv_gl *gl, uint32_t samples) {
    GLint counts[MAX_COUNTS];
    bool all = samples > 0 && samples <= INT32_MAX;
    for (size_t f = 0; f < TARGET_FORMATS && samples > 1; f++) {
        bool any = false;
        list_samples(&gl->api, target_formats[f], counts);
        for (size_t i = 0; i < MAX_COUNTS; i++)
            any |= counts[i] == (GLint)samples;
        all &= any;
    }
    return all;
}

enum { LABEL = 32 };

static void write_label(uint32_t number, char out[LABEL]) {
    snprintf(out, LABEL, "selvage %" PRIu32, number);
}

static void mark(slv_gl *gl) {
    static _Atomic(uint32_t) last;
    char label[LABEL];
    gl->label = atomic_fetch_add(&last, 1) + 1;
    gl->api.CreateRenderbuffers(1, &gl->marker);
    write_label(gl->label, label);
    gl->api.ObjectLabel(GL_RENDERBUFFER, gl->marker, -1, label);
}

static bool is_current(const slv_gl *gl) {
    char label[LABEL], found[LABEL] = "";
    if (!gl->api.IsRenderbuffer(gl->marker))
        return false;
    gl->api.GetObjectLabel(GL_RENDERBUFFER, gl->marker, LABEL, NULL, found);
    write_label(gl->label, label);
    return strcmp(label, found) == 0;
}

static slv_result fill_info(const slv_env *env, slv_gl *gl, slv_gl_backend backend) {
    const slv_gl_api *api = &gl->api;
    slv_gl_info *info = &gl->info;
    GLint major = 0, minor = 0, layers = 0, size = 0, units = 0, bindings = 0;
    GLint64 storage = 0;
    GLfloat anisotropy = 1;
    copy_string(api, GL_VENDOR, info->vendor, sizeof info->vendor);
    copy_string(api, GL_RENDERER, info->renderer, sizeof info->renderer);
    copy_string(api, GL_VERSION, info->version, sizeof info->version);
    api->GetIntegerv(GL_MAJOR_VERSION, &major);
    api->GetIntegerv(GL_MINOR_VERSION, &minor);
    if (!major)
        return slvi_fail(env, SLV_ERROR_GL, "no OpenGL context is current on this thread");
    if (major * 10 + minor < 45)
        return slvi_fail(env, SLV_ERROR_GL, "%s has OpenGL %d.%d: 4.5 is needed", info->renderer,
                         major, minor);
    api->GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &layers);
    api->GetIntegerv(GL_MAX_TEXTURE_SIZE, &size);
    api->GetIntegerv(GL_MAX_TEXTURE_IMAGE_UNITS, &units);
    api->GetIntegerv(GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, &bindings);
    if (has_extension(api, "GL_EXT_texture_filter_anisotropic") ||
        has_extension(api, "GL_ARB_texture_filter_anisotropic"))
        api->GetFloatv(GL_MAX_TEXTURE_MAX_ANISOTROPY, &anisotropy);
    api->GetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &storage);
    gl->max_storage = storage > 0 ? (uint64_t)storage : UINT64_C(1) << 27;
    gl->ballot = has_extension(api, "GL_ARB_shader_ballot");
    gl->handles = has_extension(api, "GL_ARB_bindless_texture") &&
                  has_extension(api, "GL_ARB_shader_draw_parameters");
    gl->s3tc = has_extension(api, "GL_EXT_texture_compression_s3tc");
    gl->narrow_srgb = has_extension(api, "GL_EXT_texture_sRGB_R8") &&
                      has_extension(api, "GL_EXT_texture_sRGB_RG8");
    info->backend = backend;
    info->software = strstr(info->renderer, "llvmpipe") || strstr(info->renderer, "softpipe") ||
                     strstr(info->renderer, "SWR");
    info->max_msaa = max_samples(api);
    info->max_anisotropy = (uint32_t)anisotropy;
    info->max_layers = (uint32_t)layers;
    info->max_texture_size = (uint32_t)size;
    info->texture_units = (uint32_t)units;
    gl->storage_bindings = (uint32_t)bindings;
    mark(gl);
    while (api->GetError() != GL_NO_ERROR) /* whatever the host left behind is not ours to report */
        continue;
    return SLV_OK;
}

static slv_result adopt(const slv_env *env, slv_gl_backend backend, slv_gl_platform platform,
                        slv_gl_get_proc get_proc, void *user, slv_gl **out) {
    slv_gl *gl = NULL;
    slv_result result = slvi_alloc(env, "GL context", 1, sizeof *gl, &gl);
    if (!result)
        result = load_functions(env, &gl->api, get_proc, user);
    if (!result)
        result = fill_info(env, gl, backend);
    if (result) {
        if (platform.destroy)
            platform.destroy(platform.state);
        slvi_free(gl);
        return result;
    }
    gl->platform = platform;
    gl->get_proc = backend == SLV_GL_HOST ? NULL : get_proc;
    *out = gl;
    return SLV_OK;
}

slv_result slv_gl_create(const slv_env *env, slv_gl_backend backend, slv_gl **out) {
    char why[3][160] = {"", "", ""};
    slv_gl_platform platform = {0};
    slv_gl_get_proc get_proc = NULL;
    *out = NULL;
    if (backend == SLV_GL_HOST)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "a host's context is taken with slv_gl_wrap");
    if (backend != SLV_GL_OSMESA) {
        for (int software = 0; software < 2; software++) {
            slv_result result = slvi_gl_open_egl(env, !software, why[software],
                                                 sizeof why[software], &platform, &get_proc);
            if (!result)
                return adopt(env, SLV_GL_EGL, platform, get_proc, NULL, out);
            /* which has been logged */
            if (result != SLV_ERROR_GL)
                return result;
        }
    }
    if (backend != SLV_GL_EGL) {
        slv_result result = slvi_gl_open_osmesa(env, why[2], sizeof why[2], &platform, &get_proc);
        if (!result)
            return adopt(env, SLV_GL_OSMESA, platform, get_proc, NULL, out);
        if (result != SLV_ERROR_GL)
            return result;
    }
    if (backend == SLV_GL_OSMESA)
        return slvi_fail(env, SLV_ERROR_GL, "no usable OpenGL context: OSMesa: %s", why[2]);
    if (backend == SLV_GL_EGL)
        return slvi_fail(env, SLV_ERROR_GL, "no usable OpenGL context: EGL: %s; in software: %s",
                         why[0], why[1]);
    return slvi_fail(env, SLV_ERROR_GL,
                     "no usable OpenGL context: EGL: %s; in software: %s; OSMesa: %s", why[0],
                     why[1], why[2]);
}

slv_result slv_gl_wrap(const slv_env *env, slv_gl_get_proc get_proc, void *user, slv_gl **out) {
    slv_gl_platform none = {0};
    *out = NULL;
    return adopt(env, SLV_GL_HOST, none, get_proc, user, out);
}

void slv_gl_destroy(slv_gl *gl) {
    if (!gl)
        return;
    if (is_current(gl))
        gl->api.DeleteRenderbuffers(1, &gl->marker);
    if (gl->platform.destroy)
        gl->platform.destroy(gl->platform.state);
    slvi_free(gl);
}

const slv_gl_info *slv_gl_get_info(const slv_gl *gl) {
    return &gl->info;
}

slv_gl_proc slv_gl_get_function(const slv_gl *gl, const char *name) {
    return gl->get_proc ? gl->get_proc(NULL, name) : NULL;
}

static const GLenum pixels[SLV_GL_PIXELS] = {
    GL_UNPACK_ALIGNMENT, GL_UNPACK_ROW_LENGTH,  GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_PIXELS,
    GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_IMAGES, GL_UNPACK_SWAP_BYTES,   GL_PACK_ALIGNMENT,
    GL_PACK_ROW_LENGTH,  GL_PACK_IMAGE_HEIGHT,  GL_PACK_SKIP_PIXELS,    GL_PACK_SKIP_ROWS,
    GL_PACK_SKIP_IMAGES, GL_PACK_SWAP_BYTES};

static void set_transfer(const slv_gl *gl) {
    for (size_t i = 0; i < SLV_GL_PIXELS; i++)
        gl->api.PixelStorei(pixels[i],
                            pixels[i] == GL_UNPACK_ALIGNMENT || pixels[i] == GL_PACK_ALIGNMENT);
    gl->api.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    gl->api.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
}

slv_gl_transfer slvi_gl_transfer_begin(const slv_gl *gl) {
    slv_gl_transfer before;
    for (size_t i = 0; i < SLV_GL_PIXELS; i++)
        gl->api.GetIntegerv(pixels[i], &before.pixels[i]);
    gl->api.GetIntegerv(GL_PIXEL_UNPACK_BUFFER_BINDING, &before.unpack);
    gl->api.GetIntegerv(GL_PIXEL_PACK_BUFFER_BINDING, &before.pack);
    gl->api.GetIntegerv(GL_SHADER_STORAGE_BUFFER_BINDING, &before.storage);
    set_transfer(gl);
    return before;
}

void slvi_gl_transfer_end(const slv_gl *gl, const slv_gl_transfer *before) {
    for (size_t i = 0; i < SLV_GL_PIXELS; i++)
        gl->api.PixelStorei(pixels[i], before->pixels[i]);
    gl->api.BindBuffer(GL_PIXEL_UNPACK_BUFFER, (GLuint)before->unpack);
    gl->api.BindBuffer(GL_PIXEL_PACK_BUFFER, (GLuint)before->pack);
    gl->api.BindBuffer(GL_SHADER_STORAGE_BUFFER, (GLuint)before->storage);
}

void slvi_gl_set_state(const slv_gl *gl) {
    static const GLenum off[] = {GL_BLEND,
                                 GL_COLOR_LOGIC_OP,
                                 GL_CULL_FACE,
                                 GL_DEPTH_CLAMP,
                                 GL_POLYGON_OFFSET_FILL,
                                 GL_PROGRAM_POINT_SIZE,
                                 GL_RASTERIZER_DISCARD,
                                 GL_SAMPLE_ALPHA_TO_COVERAGE,
                                 GL_SAMPLE_ALPHA_TO_ONE,
                                 GL_SAMPLE_COVERAGE,
                                 GL_SAMPLE_MASK,
                                 GL_SAMPLE_SHADING,
                                 GL_SCISSOR_TEST,
                                 GL_STENCIL_TEST,
                                 GL_PRIMITIVE_RESTART,
                                 GL_PRIMITIVE_RESTART_FIXED_INDEX};
    const slv_gl_api *api = &gl->api;
    for (size_t i = 0; i < sizeof off / sizeof *off; i++)
        api->Disable(off[i]);
    for (GLenum i = 0; i < 8; i++)
        api->Disable(GL_CLIP_DISTANCE0 + i);
    set_transfer(gl);
    api->Enable(GL_MULTISAMPLE);
    api->ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    api->PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    api->PointSize(1);
    api->DepthRangef(0, 1);
    api->DepthFunc(GL_LESS);
    api->DepthMask(1);
    api->ColorMask(1, 1, 1, 1);
}

slv_result slvi_gl_need_current(const slv_gl *gl, const slv_env *env) {
    if (!is_current(gl))
        return slvi_fail(env, SLV_ERROR_GL, "the OpenGL context is not current on this thread");
    while (gl->api.GetError() != GL_NO_ERROR)
        continue;
    return SLV_OK;
}

static void APIENTRY keep(GLsizei count, const GLuint *names) {
    (void)count, (void)names;
}

static void APIENTRY keep_program(GLuint program) {
    (void)program;
}

static void APIENTRY keep_binding(GLenum target, GLuint buffer) {
    (void)target, (void)buffer;
}

static void APIENTRY tell_nothing(GLenum what, GLint *out) {
    (void)what, (void)out;
}

static GLboolean APIENTRY is_elsewhere(GLuint64 handle) {
    (void)handle;
    return GL_FALSE;
}

slv_gl *slvi_gl_for_deleting(slv_gl *gl, slv_gl *keeping) {
    if (is_current(gl))
        return gl;
    *keeping = (slv_gl){.api = {.DeleteBuffers = keep,
                                .DeleteFramebuffers = keep,
                                .DeleteProgram = keep_program,
                                .DeleteQueries = keep,
                                .DeleteRenderbuffers = keep,
                                .DeleteSamplers = keep,
                                .DeleteTextures = keep,
                                .DeleteVertexArrays = keep,
                                .IsTextureHandleResidentARB = is_elsewhere,
                                .BindBuffer = keep_binding,
                                .GetIntegerv = tell_nothing}};
    return keeping;
}

slv_result slvi_gl_check(const slv_gl *gl, const slv_env *env, const char *what) {
    GLenum error = gl->api.GetError();
    if (error == GL_NO_ERROR)
        return SLV_OK;
    while (gl->api.GetError() != GL_NO_ERROR)
        continue;
    return slvi_fail(env, error == GL_OUT_OF_MEMORY ? SLV_ERROR_MEMORY : SLV_ERROR_GL,
                     "%s: the driver reports %s (0x%04x)", what,
                     error == GL_OUT_OF_MEMORY ? "out of memory" : "an error", error);
}
