/* The OpenGL functions that this library calls, loaded through a get_proc callback. */
#ifndef SLV_GL_API_H
#define SLV_GL_API_H

#include <selvage/gl_context.h>

#include <GL/glcorearb.h>

#ifndef GL_TEXTURE_MAX_ANISOTROPY
#define GL_TEXTURE_MAX_ANISOTROPY 0x84FE
#endif
#ifndef GL_MAX_TEXTURE_MAX_ANISOTROPY
#define GL_MAX_TEXTURE_MAX_ANISOTROPY 0x84FF
#endif

#define SLV_GL_RGBA_BC1 0x83F1
#define SLV_GL_RGBA_BC3 0x83F3
#define SLV_GL_SR8 0x8FBD
#define SLV_GL_SRG8 0x8FBE
#define SLV_GL_SRGB_BC1 0x8C4D
#define SLV_GL_SRGB_BC3 0x8C4F

#define SLV_GL_FUNCTIONS(X)                                                                        \
    X(PFNGLGETSTRINGPROC, GetString)                                                               \
    X(PFNGLGETSTRINGIPROC, GetStringi)                                                             \
    X(PFNGLGETINTEGERVPROC, GetIntegerv)                                                           \
    X(PFNGLGETFLOATVPROC, GetFloatv)                                                               \
    X(PFNGLGETERRORPROC, GetError)                                                                 \
    X(PFNGLFINISHPROC, Finish)                                                                     \
    X(PFNGLISRENDERBUFFERPROC, IsRenderbuffer)                                                     \
    X(PFNGLOBJECTLABELPROC, ObjectLabel)                                                           \
    X(PFNGLGETOBJECTLABELPROC, GetObjectLabel)                                                     \
    X(PFNGLENABLEPROC, Enable)                                                                     \
    X(PFNGLDISABLEPROC, Disable)                                                                   \
    X(PFNGLBINDBUFFERPROC, BindBuffer)                                                             \
    X(PFNGLCLIPCONTROLPROC, ClipControl)                                                           \
    X(PFNGLDEPTHRANGEFPROC, DepthRangef)                                                           \
    X(PFNGLPOINTSIZEPROC, PointSize)                                                               \
    X(PFNGLPOLYGONMODEPROC, PolygonMode)                                                           \
    X(PFNGLGETINTEGER64VPROC, GetInteger64v)                                                       \
    X(PFNGLSCISSORPROC, Scissor)                                                                   \
    X(PFNGLMEMORYBARRIERPROC, MemoryBarrier)                                                       \
    X(PFNGLVIEWPORTPROC, Viewport)                                                                 \
    X(PFNGLDEPTHFUNCPROC, DepthFunc)                                                               \
    X(PFNGLDEPTHMASKPROC, DepthMask)                                                               \
    X(PFNGLCOLORMASKPROC, ColorMask)                                                               \
    X(PFNGLPIXELSTOREIPROC, PixelStorei)                                                           \
    X(PFNGLREADPIXELSPROC, ReadPixels)                                                             \
    X(PFNGLREADBUFFERPROC, ReadBuffer)                                                             \
    X(PFNGLGETINTERNALFORMATIVPROC, GetInternalformativ)                                           \
    X(PFNGLCREATETEXTURESPROC, CreateTextures)                                                     \
    X(PFNGLDELETETEXTURESPROC, DeleteTextures)                                                     \
    X(PFNGLTEXTURESTORAGE3DPROC, TextureStorage3D)                                                 \
    X(PFNGLTEXTURESUBIMAGE3DPROC, TextureSubImage3D)                                               \
    X(PFNGLCOMPRESSEDTEXTURESUBIMAGE3DPROC, CompressedTextureSubImage3D)                           \
    X(PFNGLGETTEXTURESUBIMAGEPROC, GetTextureSubImage)                                             \
    X(PFNGLGETCOMPRESSEDTEXTURESUBIMAGEPROC, GetCompressedTextureSubImage)                         \
    X(PFNGLTEXTUREPARAMETERIPROC, TextureParameteri)                                               \
    X(PFNGLTEXTUREPARAMETERIVPROC, TextureParameteriv)                                             \
    X(PFNGLBINDTEXTURESPROC, BindTextures)                                                         \
    X(PFNGLCREATESAMPLERSPROC, CreateSamplers)                                                     \
    X(PFNGLDELETESAMPLERSPROC, DeleteSamplers)                                                     \
    X(PFNGLSAMPLERPARAMETERIPROC, SamplerParameteri)                                               \
    X(PFNGLSAMPLERPARAMETERFPROC, SamplerParameterf)                                               \
    X(PFNGLSAMPLERPARAMETERFVPROC, SamplerParameterfv)                                             \
    X(PFNGLBINDSAMPLERSPROC, BindSamplers)                                                         \
    X(PFNGLCREATEBUFFERSPROC, CreateBuffers)                                                       \
    X(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                                                       \
    X(PFNGLNAMEDBUFFERSUBDATAPROC, NamedBufferSubData)                                             \
    X(PFNGLCLEARNAMEDBUFFERSUBDATAPROC, ClearNamedBufferSubData)                                   \
    X(PFNGLGETNAMEDBUFFERSUBDATAPROC, GetNamedBufferSubData)                                       \
    X(PFNGLNAMEDBUFFERSTORAGEPROC, NamedBufferStorage)                                             \
    X(PFNGLBINDBUFFERSRANGEPROC, BindBuffersRange)                                                 \
    X(PFNGLCREATEVERTEXARRAYSPROC, CreateVertexArrays)                                             \
    X(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)                                             \
    X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)                                                   \
    X(PFNGLVERTEXARRAYVERTEXBUFFERPROC, VertexArrayVertexBuffer)                                   \
    X(PFNGLVERTEXARRAYELEMENTBUFFERPROC, VertexArrayElementBuffer)                                 \
    X(PFNGLENABLEVERTEXARRAYATTRIBPROC, EnableVertexArrayAttrib)                                   \
    X(PFNGLVERTEXARRAYATTRIBFORMATPROC, VertexArrayAttribFormat)                                   \
    X(PFNGLVERTEXARRAYATTRIBIFORMATPROC, VertexArrayAttribIFormat)                                 \
    X(PFNGLVERTEXARRAYATTRIBBINDINGPROC, VertexArrayAttribBinding)                                 \
    X(PFNGLCREATEFRAMEBUFFERSPROC, CreateFramebuffers)                                             \
    X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)                                             \
    X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)                                                   \
    X(PFNGLNAMEDFRAMEBUFFERRENDERBUFFERPROC, NamedFramebufferRenderbuffer)                         \
    X(PFNGLCHECKNAMEDFRAMEBUFFERSTATUSPROC, CheckNamedFramebufferStatus)                           \
    X(PFNGLCLEARNAMEDFRAMEBUFFERFVPROC, ClearNamedFramebufferfv)                                   \
    X(PFNGLCLEARTEXIMAGEPROC, ClearTexImage)                                                       \
    X(PFNGLBLITNAMEDFRAMEBUFFERPROC, BlitNamedFramebuffer)                                         \
    X(PFNGLCREATERENDERBUFFERSPROC, CreateRenderbuffers)                                           \
    X(PFNGLDELETERENDERBUFFERSPROC, DeleteRenderbuffers)                                           \
    X(PFNGLNAMEDRENDERBUFFERSTORAGEMULTISAMPLEPROC, NamedRenderbufferStorageMultisample)           \
    X(PFNGLCREATESHADERPROC, CreateShader)                                                         \
    X(PFNGLDELETESHADERPROC, DeleteShader)                                                         \
    X(PFNGLSHADERSOURCEPROC, ShaderSource)                                                         \
    X(PFNGLCOMPILESHADERPROC, CompileShader)                                                       \
    X(PFNGLGETSHADERIVPROC, GetShaderiv)                                                           \
    X(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog)                                                 \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram)                                                       \
    X(PFNGLDELETEPROGRAMPROC, DeleteProgram)                                                       \
    X(PFNGLATTACHSHADERPROC, AttachShader)                                                         \
    X(PFNGLLINKPROGRAMPROC, LinkProgram)                                                           \
    X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                                                         \
    X(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)                                               \
    X(PFNGLUSEPROGRAMPROC, UseProgram)                                                             \
    X(PFNGLPROGRAMUNIFORM1IPROC, ProgramUniform1i)                                                 \
    X(PFNGLPROGRAMUNIFORM1FPROC, ProgramUniform1f)                                                 \
    X(PFNGLPROGRAMUNIFORM2IPROC, ProgramUniform2i)                                                 \
    X(PFNGLPROGRAMUNIFORM2FPROC, ProgramUniform2f)                                                 \
    X(PFNGLPROGRAMUNIFORMMATRIX4FVPROC, ProgramUniformMatrix4fv)                                   \
    X(PFNGLPROGRAMUNIFORMMATRIX3FVPROC, ProgramUniformMatrix3fv)                                   \
    X(PFNGLPROGRAMUNIFORM4IPROC, ProgramUniform4i)                                                 \
    X(PFNGLPROGRAMUNIFORM4FVPROC, ProgramUniform4fv)                                               \
    X(PFNGLDRAWARRAYSPROC, DrawArrays)                                                             \
    X(PFNGLDRAWELEMENTSPROC, DrawElements)                                                         \
    X(PFNGLMULTIDRAWELEMENTSPROC, MultiDrawElements)                                               \
    X(PFNGLCREATEQUERIESPROC, CreateQueries)                                                       \
    X(PFNGLDELETEQUERIESPROC, DeleteQueries)                                                       \
    X(PFNGLQUERYCOUNTERPROC, QueryCounter)                                                         \
    X(PFNGLGETQUERYOBJECTUI64VPROC, GetQueryObjectui64v)

/* Of GL_ARB_bindless_texture, which not every driver has. */
#define SLV_GL_HANDLE_FUNCTIONS(X)                                                                 \
    X(PFNGLGETTEXTURESAMPLERHANDLEARBPROC, GetTextureSamplerHandleARB)                             \
    X(PFNGLMAKETEXTUREHANDLERESIDENTARBPROC, MakeTextureHandleResidentARB)                         \
    X(PFNGLMAKETEXTUREHANDLENONRESIDENTARBPROC, MakeTextureHandleNonResidentARB)                   \
    X(PFNGLISTEXTUREHANDLERESIDENTARBPROC, IsTextureHandleResidentARB)

typedef struct slv_gl_api {
#define SLV_GL_MEMBER(type, name) type name;
    SLV_GL_FUNCTIONS(SLV_GL_MEMBER)
    SLV_GL_HANDLE_FUNCTIONS(SLV_GL_MEMBER)
#undef SLV_GL_MEMBER
} slv_gl_api;

/* What a backend has to give back. */
typedef struct slv_gl_platform {
    void *state;
    void (*destroy)(void *state);
} slv_gl_platform;

struct slv_gl {
    slv_gl_api api;
    slv_gl_info info;
    slv_gl_platform platform;
    slv_gl_get_proc get_proc; /* NULL for a host's context */
    GLuint marker; /* an empty object of the context and those that share its objects: what
                      tells whether one is current, by its label, for others have the name */
    uint32_t label;
    uint64_t max_storage; /* bytes of a shader storage block */
    uint32_t storage_bindings;
    bool ballot;              /* has GL_ARB_shader_ballot */
    bool handles;             /* has GL_ARB_bindless_texture and GL_ARB_shader_draw_parameters */
    bool s3tc;                /* has GL_EXT_texture_compression_s3tc */
    bool narrow_srgb;         /* has GL_EXT_texture_sRGB_R8 and GL_EXT_texture_sRGB_RG8 */
    _Atomic(uint64_t) serial; /* of the last texture made, so that caches can tell textures apart */
};

/* Deletes an object if there is one: what was never made can go where there is no context. */
static inline void slvi_gl_delete(void(APIENTRY *of_kind)(GLsizei, const GLuint *),
                                  const GLuint *name) {
    if (*name)
        of_kind(1, name);
}

/* Each makes a context current and returns how to find functions; the message says why not. */
slv_result slvi_gl_open_egl(const slv_env *env, bool hardware, char *why, size_t why_size,
                            slv_gl_platform *out, slv_gl_get_proc *get_proc);
slv_result slvi_gl_open_osmesa(const slv_env *env, char *why, size_t why_size, slv_gl_platform *out,
                               slv_gl_get_proc *get_proc);

/* The address of a function in an open library, written to the function pointer that `out` points
 * to. */
bool slvi_gl_symbol(void *library, const char *name, void *out);

enum { SLV_GL_PIXELS = 14 }; /* of glPixelStore, that transfers depend on */

/* A host's state of transfers, and of what making and changing tables touches beside. */
typedef struct slv_gl_transfer {
    GLint pixels[SLV_GL_PIXELS], unpack, pack;
    GLint storage; /* which a driver may unbind with a table that is replaced while it is bound */
} slv_gl_transfer;

/* Puts what uploading and reading depend on, and nothing else, into the state that a fresh context
 * has; and back into what it was. */
slv_gl_transfer slvi_gl_transfer_begin(const slv_gl *gl);
void slvi_gl_transfer_end(const slv_gl *gl, const slv_gl_transfer *before);

/* Puts what drawing and transfers depend on into the state that a fresh context has, whatever a
 * host left behind: pixel store and pixel buffers, clip control, raster, depth and per-fragment
 * state. */
void slvi_gl_set_state(const slv_gl *gl);

/* Before any function of the driver is called for a host: SLV_ERROR_GL if the context, or one that
 * shares its objects, is not current on this thread. Errors that the host left behind are dropped,
 * since they would be taken for the library's. */
slv_result slvi_gl_need_current(const slv_gl *gl, const slv_env *env);

/* The context, for what deletes its objects; where it is not current on this thread `keeping`, in
 * which nothing is deleted: the same names are of another context's objects. */
slv_gl *slvi_gl_for_deleting(slv_gl *gl, slv_gl *keeping);

/* SLV_ERROR_GL with `what` in the message if the driver has an error pending. */
slv_result slvi_gl_check(const slv_gl *gl, const slv_env *env, const char *what);

/* Compiles and links shaders/draw/NAME.vert with shaders/draw/NAME.frag, `lookups`
 * (slv_gl_texture_glsl) in front of the latter and `hand_on`, unless it is NULL, in front of the
 * former. The compiler's first words go to the log. */
slv_result slvi_gl_program(const slv_gl *gl, const slv_env *env, const char *name,
                           const char *hand_on, const char *lookups, GLuint *out);

/* The text of a file in shaders/; from SELVAGE_SHADER_DIR if that is set, else as embedded at
 * build. `*owned` is to be freed by the caller (NULL when embedded). */
slv_result slvi_gl_shader_text(const slv_env *env, const char *name, const char **text,
                               char **owned);

/* The same, or `glsl` if it is not NULL, with the text of a file in place of each line `#include
 * "NAME"`, the name being that of a file in shaders/ too. Parts have no such lines of their own.
 * Released with slvi_free. */
slv_result slvi_gl_shader_with_parts(const slv_env *env, const char *name, const char *glsl,
                                     char **out);

#endif
