/* Shaders: their texts, put together from parts, and programs of them. */
#include "gl/context/api.h"

#include "base/file.h"
#include "base/log.h"
#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct slv_shader_table_row {
    const char *name, *text;
};
extern const struct slv_shader_table_row slvi_shader_table[];

slv_result slvi_gl_shader_text(const slv_env *env, const char *name, const char **text,
                               char **owned) {
    const char *folder = getenv("SELVAGE_SHADER_DIR");
    *owned = NULL;
    if (folder && *folder) {
        char path[1024];
        size_t size;
        snprintf(path, sizeof path, "%s/%s", folder, name);
        slv_result result = slvi_file_read(env, path, owned, &size);
        *text = *owned;
        return result;
    }
    for (const struct slv_shader_table_row *row = slvi_shader_table; row->name; row++) {
        if (strcmp(row->name, name) == 0) {
            *text = row->text;
            return SLV_OK;
        }
    }
    return slvi_fail(env, SLV_ERROR_ARGUMENT, "there is no shader %s", name);
}

/* A text that grows. */
struct joined {
    char *text;
    size_t length;
};

static slv_result append(const slv_env *env, struct joined *to, const char *text, size_t length) {
    slv_result result = slvi_grow(env, "shader text", to->length + length + 1, 1, &to->text);
    if (result)
        return result;
    memcpy(to->text + to->length, text, length);
    to->length += length;
    to->text[to->length] = 0;
    return SLV_OK;
}

/* Where the next line that names a part begins, or the end. */
static const char *next_include(const char *text) {
    static const char word[] = "#include ";
    while (*text && strncmp(text, word, sizeof word - 1) != 0) {
        text += strcspn(text, "\n");
        text += *text == '\n';
    }
    return text;
}

enum { MOST_NESTED = 4 };

/* A text with its parts, and theirs. */
static slv_result append_all(const slv_env *env, const char *name, const char *glsl, uint32_t depth,
                             struct joined *to) {
    const char *text = glsl;
    char *owned = NULL, part[64];
    slv_result result = glsl ? SLV_OK : slvi_gl_shader_text(env, name, &text, &owned);
    while (!result && *text) {
        const char *line = next_include(text);
        result = append(env, to, text, (size_t)(line - text));
        text = line;
        if (result || !*line)
            continue;
        if (sscanf(text, "#include \"%63[^\"\n]\"", part) != 1)
            result = slvi_fail(env, SLV_ERROR_ARGUMENT, "shader %s: #include without a name", name);
        else if (depth == MOST_NESTED)
            result = slvi_fail(env, SLV_ERROR_ARGUMENT, "shader %s: parts of parts of parts", name);
        else
            result = append_all(env, part, NULL, depth + 1, to);
        text += strcspn(text, "\n");
    }
    slvi_free(owned);
    return result;
}

slv_result slvi_gl_shader_with_parts(const slv_env *env, const char *name, const char *glsl,
                                     char **out) {
    struct joined joined = {0};
    slv_result result = append_all(env, name, glsl, 0, &joined);
    if (result)
        slvi_free(joined.text);
    *out = result ? NULL : joined.text;
    return result;
}

static void first_line(char *text) {
    text[strcspn(text, "\n")] = 0;
}

static slv_result compile(const slv_gl *gl, const slv_env *env, const char *name, GLenum stage,
                          const char *const *texts, uint32_t ntexts, GLuint *out) {
    const slv_gl_api *api = &gl->api;
    GLint compiled = 0;
    char words[512] = "no log";
    *out = api->CreateShader(stage);
    api->ShaderSource(*out, (GLsizei)ntexts, texts, NULL);
    api->CompileShader(*out);
    api->GetShaderiv(*out, GL_COMPILE_STATUS, &compiled);
    if (compiled)
        return SLV_OK;
    api->GetShaderInfoLog(*out, sizeof words, NULL, words);
    first_line(words);
    return slvi_fail(env, SLV_ERROR_GL, "shader %s does not compile: %s", name, words);
}

static slv_result link_shaders(const slv_gl *gl, const slv_env *env, const char *name,
                               const GLuint shaders[2], GLuint *out) {
    const slv_gl_api *api = &gl->api;
    GLint linked = 0;
    char words[512] = "no log";
    GLuint program = api->CreateProgram();
    api->AttachShader(program, shaders[0]);
    api->AttachShader(program, shaders[1]);
    api->LinkProgram(program);
    api->GetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked) {
        *out = program;
        return SLV_OK;
    }
    api->GetProgramInfoLog(program, sizeof words, NULL, words);
    first_line(words);
    api->DeleteProgram(program);
    return slvi_fail(env, SLV_ERROR_GL, "shader %s does not link: %s", name, words);
}

slv_result slvi_gl_program(const slv_gl *gl, const slv_env *env, const char *name,
                           const char *hand_on, const char *lookups, GLuint *out) {
    static const char version[] = "#version 450 core\n";
    static const GLenum stages[2] = {GL_VERTEX_SHADER, GL_FRAGMENT_SHADER};
    GLuint shaders[2] = {0, 0};
    slv_result result = SLV_OK;
    *out = 0;
    for (int stage = 0; !result && stage < 2; stage++) {
        const char *texts[3] = {version, stage ? lookups : hand_on ? hand_on : "", NULL};
        char file[64], *owned = NULL;
        snprintf(file, sizeof file, "draw/%s.%s", name, stage ? "frag" : "vert");
        if (!(result = slvi_gl_shader_text(env, file, &texts[2], &owned)))
            result = compile(gl, env, file, stages[stage], texts, 3, &shaders[stage]);
        slvi_free(owned);
    }
    if (!result)
        result = link_shaders(gl, env, name, shaders, out);
    gl->api.DeleteShader(shaders[0]);
    gl->api.DeleteShader(shaders[1]);
    return result;
}
