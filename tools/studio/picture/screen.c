/* Onto the screen: one pass, with a program for each way in which it is needed. Software drivers
 * run all branches of a shader, so that one for all ways cost several times as much. */
#include "studio/picture/screen.h"

#include "command/output.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PROGRAMS = STUDIO_COMPARES * STUDIO_ENCODINGS * 2 * 2 * 2 };

struct studio_screen {
    GLuint programs[PROGRAMS]; /* 0: not needed yet */
    GLuint array, stencil;
    char *stencil_path; /* of the image that is in it */
};

static const char vertex_text[] = "#version 450 core\n"
                                  "void main() {\n"
                                  "    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, "
                                  "gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);\n"
                                  "}\n";

/* After the definitions of COMPARE and ENCODING as in look.h, SAME_SIZE, STENCIL and CURSOR. */
static const char fragment_text[] =
    "layout(binding = 0) uniform sampler2D first;\n"
    "layout(binding = 1) uniform sampler2D second;\n"
    "layout(binding = 2) uniform sampler2D stencil;\n"
    "layout(location = 1) uniform vec4 numbers; // divider, gain, factor of the exposure, -\n"
    "layout(location = 2) uniform vec2 size;\n"
    "layout(location = 3) uniform vec3 cursor; // where, and how far around\n"
    "layout(location = 4) uniform vec4 before; // where the stencil is, its width, and turned how\n"
    "layout(location = 5) uniform float aspect;\n"
    "layout(location = 0) out vec4 color;\n"
    "vec4 at(sampler2D picture) {\n"
    "#if SAME_SIZE\n"
    "    return texelFetch(picture, ivec2(gl_FragCoord.xy), 0);\n"
    "#else\n"
    "    return texture(picture, gl_FragCoord.xy / size);\n"
    "#endif\n"
    "}\n"
    "vec3 map(float t) { // from dark blue to yellow, evenly\n"
    "    t = clamp(t, 0.0, 1.0);\n"
    "    const vec3 c[5] = vec3[](vec3(0.27, 0.0, 0.33), vec3(0.23, 0.32, 0.55),\n"
    "        vec3(0.13, 0.57, 0.55), vec3(0.37, 0.79, 0.38), vec3(0.99, 0.91, 0.14));\n"
    "    int i = min(int(t * 4.0), 3);\n"
    "    return mix(c[i], c[i + 1], t * 4.0 - float(i));\n"
    "}\n"
    "vec3 encode(vec3 c) {\n"
    "    c = clamp(c, 0.0, 1.0);\n"
    "    return mix(12.92 * c, 1.055 * pow(max(c, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055,\n"
    "               greaterThan(c, vec3(0.0031308)));\n"
    "}\n"
    "void main() {\n"
    "    vec4 a = at(first);\n"
    "#if COMPARE == 1\n"
    "    if (gl_FragCoord.x >= numbers.x * size.x)\n"
    "        a = at(second);\n"
    "#elif COMPARE == 2\n"
    "    a.rgb = abs(a.rgb - at(second).rgb) * numbers.y;\n"
    "#endif\n"
    "    a.rgb *= numbers.z;\n"
    "#if ENCODING == 2\n"
    "    a.rgb = a.a > 0.0 ? map(dot(a.rgb, vec3(1.0 / 3.0))) : vec3(0.0);\n"
    "#elif ENCODING == 0\n"
    "    a.rgb = encode(a.rgb);\n"
    "#endif\n"
    "#if COMPARE == 1\n"
    "    if (abs(gl_FragCoord.x - numbers.x * size.x) < 1.0)\n"
    "        a.rgb = vec3(1.0);\n"
    "#endif\n"
    "#if STENCIL\n"
    "    vec2 p = (gl_FragCoord.xy - before.xy) * vec2(1.0, -1.0);\n"
    "    float s = sin(before.w), c = cos(before.w);\n"
    "    vec2 there = vec2(c * p.x + s * p.y, c * p.y - s * p.x) * vec2(1.0, aspect) / before.z;\n"
    "    vec4 over = textureLod(stencil, there + 0.5, 0.0);\n"
    "    if (all(lessThan(abs(there), vec2(0.5))))\n"
    "        a.rgb = mix(a.rgb, over.rgb, 0.5 * over.a);\n"
    "#endif\n"
    "#if CURSOR\n"
    "    float off = abs(distance(gl_FragCoord.xy, cursor.xy) - cursor.z);\n"
    "    if (off < 1.5)\n"
    "        a.rgb = vec3(off < 0.75 ? 1.0 : 0.0);\n"
    "#endif\n"
    "    color = vec4(a.rgb, 1.0);\n"
    "}\n";

GLuint studio_program(const slv_env *env, const char *vertex, const char *fragment) {
    const char *texts[2] = {vertex, fragment};
    char log[512] = "";
    GLint fine = 0;
    GLuint program = glCreateProgram();
    for (int i = 0; i < 2; i++) {
        GLuint shader = glCreateShader(i ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
        glShaderSource(shader, 1, &texts[i], NULL);
        glCompileShader(shader);
        glAttachShader(program, shader);
        glGetShaderiv(shader, GL_COMPILE_STATUS, &fine);
        if (!fine)
            glGetShaderInfoLog(shader, sizeof log, NULL, log);
        glDeleteShader(shader);
    }
    glLinkProgram(program);
    glGetProgramiv(program, GL_LINK_STATUS, &fine);
    if (fine)
        return program;
    if (!*log)
        glGetProgramInfoLog(program, sizeof log, NULL, log);
    (void)output_fail(env, SLV_ERROR_GL, "the driver refuses a shader: %s", log);
    glDeleteProgram(program);
    return 0;
}

/* The stencil's image, as it is on the screen. */
static slv_result need_stencil(studio_screen *s, const slv_env *env,
                               const studio_stencil *stencil) {
    slv_image image = {0};
    GLint most = 0;
    if (s->stencil_path && strcmp(s->stencil_path, stencil->path) == 0)
        return SLV_OK;
    slv_result result = slv_image_load(env, stencil->path, &image);
    if (result)
        return result;
    const size_t npixels = (size_t)image.width * image.height;
    const uint32_t n = image.nchannels;
    uint8_t *pixels = malloc(4 * npixels + 1);
    char *path = strdup(stencil->path);
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
    if (image.width > (uint32_t)most || image.height > (uint32_t)most)
        result = output_fail(env, SLV_ERROR_LIMIT, "%s: more than %d pixels wide or high",
                             stencil->path, most);
    else if (!pixels || !path)
        result = output_fail(env, SLV_ERROR_MEMORY, "%s: no memory", stencil->path);
    for (size_t i = 0; !result && i < npixels; i++)
        for (uint32_t c = 0; c < 4; c++) {
            const float *from = image.pixels + i * n;
            float value = c == 3 ? (n == 2 || n == 4 ? from[n - 1] : 1) : from[n < 3 ? 0 : c];
            pixels[4 * i + c] = (uint8_t)(fminf(fmaxf(value, 0), 1) * 255 + 0.5f);
        }
    if (!result) {
        glDeleteTextures(1, &s->stencil);
        glCreateTextures(GL_TEXTURE_2D, 1, &s->stencil);
        glTextureStorage2D(s->stencil, 1, GL_RGBA8, (GLsizei)image.width, (GLsizei)image.height);
        glTextureParameteri(s->stencil, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTextureParameteri(s->stencil, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
        glTextureParameteri(s->stencil, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
        glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
        glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
        glTextureSubImage2D(s->stencil, 0, 0, 0, (GLsizei)image.width, (GLsizei)image.height,
                            GL_RGBA, GL_UNSIGNED_BYTE, pixels);
        free(s->stencil_path);
        s->stencil_path = path;
        path = NULL;
    }
    free(path);
    free(pixels);
    slv_image_free(&image);
    return result;
}

slv_result studio_screen_create(const slv_env *env, studio_screen **out) {
    studio_screen *s = *out = calloc(1, sizeof *s);
    if (!s)
        return output_fail(env, SLV_ERROR_MEMORY, "no memory for a picture");
    glCreateVertexArrays(1, &s->array);
    return SLV_OK;
}

void studio_screen_destroy(studio_screen *s) {
    if (!s)
        return;
    for (int i = 0; i < PROGRAMS; i++)
        glDeleteProgram(s->programs[i]);
    glDeleteVertexArrays(1, &s->array);
    glDeleteTextures(1, &s->stencil);
    free(s->stencil_path);
    free(s);
}

/* Flickering is one picture after the other, each whole. */
static slv_result need_program(studio_screen *s, const slv_env *env, const studio_shot *shot,
                               bool same_size, GLuint *out) {
    const studio_look *look = &shot->look;
    studio_compare compare = look->compare == STUDIO_FLICKER ? STUDIO_WHOLE : look->compare;
    const int stencil = shot->stencil != NULL, cursor = shot->cursor[2] > 0;
    int index = (int)compare * STUDIO_ENCODINGS + (int)look->encoding;
    index = ((2 * index + same_size) * 2 + stencil) * 2 + cursor;
    char text[sizeof fragment_text + 160];
    snprintf(text, sizeof text,
             "#version 450 core\n#define COMPARE %d\n#define ENCODING %d\n#define SAME_SIZE %d\n"
             "#define STENCIL %d\n#define CURSOR %d\n%s",
             (int)compare, (int)look->encoding, same_size, stencil, cursor, fragment_text);
    if (!s->programs[index])
        s->programs[index] = studio_program(env, vertex_text, text);
    *out = s->programs[index];
    return *out ? SLV_OK : SLV_ERROR_GL;
}

static void set_stencil(GLuint program, const studio_screen *s, const studio_shot *shot) {
    const studio_stencil *stencil = shot->stencil;
    glBindTextures(2, 1, &s->stencil);
    glBindSampler(2, 0);
    glProgramUniform4f(program, 4, 0.5f * (float)shot->width + stencil->at[0],
                       0.5f * (float)shot->height - stencil->at[1], stencil->width,
                       stencil->angle * 3.14159265f / 180);
    glProgramUniform1f(program, 5, stencil->aspect);
}

slv_result studio_screen_put(studio_screen *s, const slv_env *env, const studio_shot *shot,
                             const unsigned pictures[2], bool same_size, unsigned framebuffer) {
    const studio_look *look = &shot->look;
    const bool second = look->compare == STUDIO_FLICKER && look->second;
    const GLuint textures[2] = {pictures[second], pictures[1]};
    GLuint program;
    slv_result result = shot->stencil ? need_stencil(s, env, shot->stencil) : SLV_OK;
    if (result || (result = need_program(s, env, shot, same_size, &program)))
        return result;
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, (GLsizei)shot->width, (GLsizei)shot->height);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_FRAMEBUFFER_SRGB);
    glUseProgram(program);
    glBindVertexArray(s->array);
    glBindTextures(0, 2, textures);
    glBindSampler(0, 0);
    glBindSampler(1, 0);
    glProgramUniform4f(program, 1, look->divider, look->gain, exp2f(look->exposure), 0);
    glProgramUniform2f(program, 2, (float)shot->width, (float)shot->height);
    glProgramUniform3f(program, 3, shot->cursor[0], (float)shot->height - shot->cursor[1],
                       shot->cursor[2]);
    if (shot->stencil)
        set_stencil(program, s, shot);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
    glUseProgram(0);
    return SLV_OK;
}
