/* What the tests of the command's verbs share: a folder, and the command run in it. */
#ifndef SLV_TOOL_KIT_H
#define SLV_TOOL_KIT_H

#include "kit/folder_kit.h"
#include "kit/ptx_kit.h"

#include "verbs.h"

#include <selvage/ptx_writer.h>

#include <stdarg.h>
#include <sys/wait.h>

static char tool_out[65536]; /* what the last run printed, both streams */

static inline void tool_begin(void) {
    test_folder_begin();
}

static inline void tool_end(void) {
    test_folder_end();
}

/* The words of a command line, quotes removed, into `line`'s own bytes. Returns how many, or -1 if
 * it takes a shell to understand it. */
static inline int tool_words(char *line, char *words[], int room) {
    int count = 0;
    for (char *from = line; *(from += strspn(from, " "));) {
        char *to = from, quote = 0; /* which one is open */
        if (count == room)
            return -1;
        words[count++] = from;
        for (; *from && (quote || *from != ' '); from++) {
            if (quote ? *from == quote : *from == '\'' || *from == '"')
                quote = quote ? 0 : *from;
            else if (quote != '\'' && strchr("<>|&;$\\`*?\n", *from))
                return -1;
            else
                *to++ = *from;
        }
        from += *from == ' ';
        *to = 0;
    }
    words[count] = NULL;
    return count;
}

/* The command in a process that need not be started: a fork of this one. `words` has room for a
 * first one. */
static inline pid_t tool_fork(char *words[], int count, FILE **out) {
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    fflush(NULL);
    pid_t child = fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        close(ends[0]);
        dup2(ends[1], STDOUT_FILENO);
        dup2(ends[1], STDERR_FILENO);
        close(ends[1]);
        words[0] = "selvage";
        exit(chdir(test_folder) == 0 ? command_main(count + 1, words) : 127);
    }
    close(ends[1]);
    *out = fdopen(ends[0], "r");
    REQUIRE(*out);
    return child;
}

/* Runs `selvage ARGUMENTS` in the folder and returns the exit code. What takes a shell starts the
 * installed command; the rest calls it. */
static inline int tool(const char *format, ...) __attribute__((format(printf, 1, 2)));
static inline int tool(const char *format, ...) {
    enum { ROOM = 64 };
    const char *bin = getenv("SELVAGE_BIN");
    char line[4096], arguments[2048], *words[ROOM + 2];
    int status = -1;
    FILE *out = NULL;
    va_list args;
    va_start(args, format);
    vsnprintf(arguments, sizeof arguments, format, args);
    va_end(args);
    snprintf(line, sizeof line, "cd '%s' && '%s/selvage' 2>&1 %s", test_folder, bin ? bin : "bin",
             arguments);
    int count = tool_words(arguments, words + 1, ROOM);
    pid_t child = count < 0 ? 0 : tool_fork(words, count, &out);
    if (count < 0)
        out = popen(line, "r");
    if (!out)
        return -1;
    size_t got = fread(tool_out, 1, sizeof tool_out - 1, out);
    tool_out[got] = 0;
    if (count < 0) {
        status = pclose(out);
    } else {
        fclose(out);
        REQUIRE(waitpid(child, &status, 0) == child);
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

#define HAS(text) CHECK_MSG(strstr(tool_out, text), "'%s' in:\n%s", text, tool_out)
#define LACKS(text) CHECK_MSG(!strstr(tool_out, text), "no '%s' in:\n%s", text, tool_out)
#define RUNS(code, ...)                                                                            \
    do {                                                                                           \
        int code_ = tool(__VA_ARGS__);                                                             \
        CHECK_MSG(code_ == (code), "exit code %d, expected %d:\n%s", code_, code, tool_out);       \
    } while (0)

static inline const char *tool_path(const char *name) {
    return test_path(name);
}

static inline slv_ptx *tool_open(const char *name) {
    slv_env env = test_env();
    slv_ptx *ptx = NULL;
    REQUIRE(!slv_ptx_open(&env, tool_path(name), &ptx));
    return ptx;
}

/* Noise on a mesh of quads and one pentagon, 16x16 texels a face, its geometry inside. */
static inline void tool_write_noise(const char *name, slv_type type, uint32_t nchannels,
                                    int32_t alpha, uint64_t seed) {
    slv_env env = test_env();
    slv_mesh *mesh = grid_mesh(3, 2, true);
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                    .type = type,
                                    .nchannels = nchannels,
                                    .alpha_channel = alpha,
                                    .nfaces = slv_mesh_face_count(mesh)};
    slv_ptx_writer *writer = NULL;
    REQUIRE(!slv_ptx_writer_create(&env, tool_path(name), &params, &writer));
    REQUIRE(!slv_ptx_writer_set_mesh(writer, mesh));
    uint32_t count = 16 * 16 * nchannels;
    float *values = calloc(count, sizeof *values);
    void *texels = calloc(count, slv_type_size(type));
    for (uint32_t face = 0; face < params.nfaces; face++) {
        slv_ptx_face info = {.res = {4, 4}};
        for (uint32_t i = 0; i < count; i++)
            values[i] = (float)(test_random(&seed) % 65536) / 65535;
        slv_type_from_float(type, values, count, texels);
        REQUIRE(!slv_ptx_writer_write_face(writer, face, &info, texels));
    }
    REQUIRE(!slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
    slv_mesh_destroy(mesh);
    free(values);
    free(texels);
}

/* A copy in which `change` may alter each face before it is written. */
static inline void tool_copy(const char *from, const char *to, bool meta,
                             void (*change)(uint32_t face, slv_ptx_face *info, void *texels)) {
    slv_env env = test_env();
    slv_ptx *ptx = tool_open(from);
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    slv_ptx_writer_params params = slv_ptx_writer_params_like(ptx);
    slv_ptx_writer *writer = NULL;
    REQUIRE(!slv_ptx_writer_create(&env, tool_path(to), &params, &writer));
    for (uint32_t i = 0; meta && i < info->nmeta; i++)
        REQUIRE(!slv_ptx_writer_set_meta(writer, slv_ptx_get_meta(ptx, i)));
    for (uint32_t face = 0; face < info->nfaces; face++) {
        slv_ptx_face f;
        REQUIRE(!slv_ptx_get_face(ptx, face, &f));
        void *texels = malloc((slv_type_size(info->type) * info->nchannels) << (f.res.u + f.res.v));
        REQUIRE(!slv_ptx_read_face(ptx, face, f.res, texels));
        f.flags &= (uint8_t)~SLV_FACE_CONSTANT;
        change(face, &f, texels);
        REQUIRE(!slv_ptx_writer_write_face(writer, face, &f, texels));
        free(texels);
    }
    REQUIRE(!slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
    slv_ptx_close(ptx);
}

static inline void tool_write_file(const char *name, const void *bytes, size_t size) {
    FILE *stream = fopen(tool_path(name), "wb");
    REQUIRE(stream);
    CHECK(fwrite(bytes, 1, size, stream) == size);
    CHECK(fclose(stream) == 0);
}

#endif
