/* Every text that the library can hand to a shader is valid GLSL: for the reference compiler, which
 * must be installed, and for the driver of a real context, linked with the vertex shaders that it
 * is used with. The one file that is installed has the same texts in it. */
#include "kit/command_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_texture.h>

#include <GL/glcorearb.h>
#include <ctype.h>

#define FUNCTIONS(X)                                                                               \
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
    X(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)

/* each strategy with and without coverage of its own, two anisotropies, taps and vectors either way
 */
enum { MAX_TEXTS = KIT_STRATEGIES * 2 * 2 * 2 * 2 * SLV_GL_MAX_VARIANTS, STAGES = 2 };

static const char version[] = "#version 450 core\n";
static const char *const stage_names[STAGES] = {"surface", "lookup"};

static struct {
#define MEMBER(type, name) type name;
    FUNCTIONS(MEMBER)
#undef MEMBER
} api;

static slv_gl *gl;
static kit_scratch scratch;
static kit_run run;
static char *seen[MAX_TEXTS];
static int nseen, nfiles;
static char *vertex[STAGES], *fragment[STAGES], *installed;
static GLuint vertex_shaders[STAGES];

static char *read_shader(const char *name) {
    char folder[KIT_PATH], path[KIT_PATH];
    kit_join(folder, kit_variable("SELVAGE_TESTS"), "../shaders/draw");
    return kit_read(kit_join(path, folder, name), NULL);
}

static GLuint compile(GLenum stage, const char *name, const char *const *texts, int ntexts) {
    char words[1024] = "no log";
    GLint good = 0;
    GLuint shader = api.CreateShader(stage);
    api.ShaderSource(shader, ntexts, texts, NULL);
    api.CompileShader(shader);
    api.GetShaderiv(shader, GL_COMPILE_STATUS, &good);
    if (!good)
        api.GetShaderInfoLog(shader, sizeof words, NULL, words);
    CHECK_MSG(good, "%s does not compile: %s", name, words);
    return shader;
}

static void link_stage(int stage, const char *name, const char *lookups) {
    const char *texts[] = {version, lookups, fragment[stage]};
    char words[1024] = "no log";
    GLint good = 0;
    GLuint shader = compile(GL_FRAGMENT_SHADER, name, texts, 3), program = api.CreateProgram();
    api.AttachShader(program, vertex_shaders[stage]);
    api.AttachShader(program, shader);
    api.LinkProgram(program);
    api.GetProgramiv(program, GL_LINK_STATUS, &good);
    if (!good)
        api.GetProgramInfoLog(program, sizeof words, NULL, words);
    CHECK_MSG(good, "%s does not link: %s", name, words);
    api.DeleteProgram(program);
    api.DeleteShader(shader);
}

static void write_shader(const char *name, const char *lookups, const char *rest) {
    char path[KIT_PATH];
    FILE *stream = fopen(kit_join(path, scratch.folder, name), "w");
    REQUIRE(stream);
    fputs(version, stream);
    fputs(lookups, stream);
    fputs(rest, stream);
    REQUIRE(fclose(stream) == 0);
    nfiles++;
}

/* Links for the driver and, if asked, leaves a file for the reference compiler. */
static void check_text(const char *lookups, const char *name, bool reference) {
    for (int i = 0; i < nseen; i++)
        if (strcmp(seen[i], lookups) == 0)
            return;
    REQUIRE(nseen < MAX_TEXTS);
    seen[nseen] = strdup(lookups);
    REQUIRE(seen[nseen]);
    nseen++;
    for (int stage = 0; stage < STAGES; stage++) {
        char file[128];
        if (test_skip((uint32_t)(nseen + nseen / 2 + stage), 2))
            continue;
        snprintf(file, sizeof file, "%s_%s.frag", stage_names[stage], name);
        if (reference)
            write_shader(file, lookups, fragment[stage]);
        link_stage(stage, file, lookups);
    }
}

static char *flipped(const char *lookups, const char *define) {
    char *other = strdup(lookups);
    REQUIRE(other);
    char *at = strstr(other, define);
    REQUIRE(at);
    at += strlen(define);
    REQUIRE(*at == '0' || *at == '1');
    *at = *at == '0' ? '1' : '0';
    return other;
}

/* What the library decides by the driver is checked both ways on every driver; in a short run both
 * things at a time. */
static void check_all_ways(const char *lookups, const char *name, bool reference) {
    char other_name[96];
    char *vectors = flipped(lookups, "#define SLV_VECTORS ");
    char *taps = flipped(lookups, "#define SLV_TAPS ");
    char *both = flipped(vectors, "#define SLV_TAPS ");
    const bool either = nseen / 4 % 2; /* of two texts a short run gives one to the reference */
    check_text(lookups, name, reference && (!test_brief() || either));
    if (!test_brief()) {
        snprintf(other_name, sizeof other_name, "%s_othervectors", name);
        check_text(vectors, other_name, reference);
        snprintf(other_name, sizeof other_name, "%s_othertaps", name);
        check_text(taps, other_name, reference);
    }
    snprintf(other_name, sizeof other_name, "%s_otherboth", name);
    check_text(both, other_name, reference && (!test_brief() || !either));
    free(taps);
    free(both);
    free(vectors);
}

/* What defines the strategy in the installed file. */
static char *strategy_symbol(const slv_strategy *strategy, char *out, size_t size) {
    snprintf(out, size, "SLV_STRATEGY_%s", strategy->name);
    for (char *c = out; *c; c++)
        *c = *c == '-' ? '_' : (char)toupper((unsigned char)*c);
    return out;
}

/* A shader of the installed file, with `defines` before it. */
static void write_installed(const char *kind, const slv_strategy *strategy, const char *name,
                            const char *defines, size_t length) {
    char file[128], symbol[64];
    size_t size = length + strlen(installed) + 128;
    char *text = malloc(size);
    REQUIRE(text);
    snprintf(text, size, "#define %s\n%.*s%s", strategy_symbol(strategy, symbol, sizeof symbol),
             (int)length, defines, installed);
    snprintf(file, sizeof file, "%s_%s.frag", kind, name);
    write_shader(file, text, fragment[0]);
    free(text);
}

/* The text of the library, and what the installed file makes of the same definitions. */
static void write_both(const char *lookups, const slv_strategy *strategy, const char *name) {
    char file[128];
    size_t defines = 0;
    while (strncmp(lookups + defines, "#define ", 8) == 0)
        defines += strcspn(lookups + defines, "\n") + 1;
    write_installed("installed", strategy, name, lookups, defines);
    snprintf(file, sizeof file, "assembled_%s.frag", name);
    write_shader(file, lookups, fragment[0]);
}

/* One pool, four without and eight with two sub-faces are what a short run takes. */
static bool is_taken(uint32_t variant) {
    return !test_brief() || variant == 0 || variant == 5 || variant + 1 == SLV_GL_MAX_VARIANTS;
}

static void check_texture(uint32_t nchannels, uint32_t anisotropy) {
    slv_env env = test_env();
    slv_texture *texture = NULL;
    slv_adjacency *adjacency = NULL;
    slv_gl_texture *uploaded = NULL;
    const slv_res res[1] = {{3, 2}};
    slv_texture_desc desc = {1, SLV_TYPE_U8, nchannels, SLV_NO_ALPHA, res, SLV_TEXTURE_LINEAR};
    slv_face_adjacency alone = {{-1, -1, -1, -1}, {0}};
    slv_gl_texture_params params = {KIT_ALL, .anisotropy = anisotropy,
                                    .binding = SLV_GL_BINDING_UNITS}; /* as the installed file */
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    REQUIRE(slv_adjacency_create(&env, 1, &alone, NULL, &adjacency) == SLV_OK);
    REQUIRE(slv_gl_texture_create(gl, &env, texture, adjacency, &params, &uploaded) == SLV_OK);
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        for (uint32_t v = 0; v < SLV_GL_MAX_VARIANTS; v++) {
            char name[64];
            if (!is_taken(v))
                continue;
            snprintf(name, sizeof name, "%s_variant%u_channels%u_aniso%u", slv_strategy_at(s)->name,
                     v, nchannels, anisotropy);
            const char *lookups = NULL;
            REQUIRE(slv_gl_texture_glsl(uploaded, slv_strategy_at(s), v, &lookups) == SLV_OK);
            CHECK_MSG(strstr(lookups, "slv_sample_grad") != NULL, "%s: no text", name);
            /* in between only the number of pools differs, which the driver sees */
            check_all_ways(lookups, name, test_brief() || v < 2 || v + 2 >= SLV_GL_MAX_VARIANTS);
            /* one pool and four, with and without two sub-faces */
            if (v == 0 || v == 5)
                write_both(lookups, slv_strategy_at(s), name);
        }
        const char *none = "";
        CHECK(slv_gl_texture_glsl(uploaded, slv_strategy_at(s), SLV_GL_MAX_VARIANTS, &none) ==
                  SLV_ERROR_ARGUMENT &&
              !none);
    }
    slv_gl_texture_destroy(uploaded);
    slv_adjacency_destroy(adjacency);
    slv_texture_destroy(texture);
}

/* What the reference compiler complains about, without the names of the files that it accepts. */
static void print_complaints(const char *text) {
    for (const char *line = text; *line;) {
        int length = (int)strcspn(line, "\n");
        if (strncmp(line, "ERROR", 5) == 0 || strncmp(line, "WARNING", 7) == 0 ||
            strncmp(line, "sh:", 3) == 0)
            fprintf(stderr, "%.*s\n", length, line);
        line += length + (line[length] == '\n');
    }
}

static int reference_compiler(const char *pattern) {
    char command[256];
    snprintf(command, sizeof command, "exec glslangValidator %s", pattern);
    const char *argv[] = {"/bin/sh", "-c", command, NULL};
    kit_run_program(&scratch, NULL, argv, &run);
    return run.code;
}

/* What the preprocessor makes of all files that match, without spaces. */
static char *preprocessed(const char *pattern) {
    char command[256], path[KIT_PATH];
    snprintf(command, sizeof command, "-E %s >preprocessed", pattern);
    CHECK_MSG(reference_compiler(command) == 0, "glslangValidator -E fails on %s", pattern);
    char *text = kit_read(kit_join(path, scratch.folder, "preprocessed"), NULL), *to = text;
    for (const char *from = text; *from; from++)
        if (!isspace((unsigned char)*from))
            *to++ = *from;
    *to = 0;
    return text;
}

/* The installed file has the text of each strategy, and needs no definition but that of a strategy:
 * then it is the simplest program. */
static void check_installed(void) {
    char *assembled = preprocessed("assembled_*.frag");
    char *joined = preprocessed("installed_*.frag");
    size_t same = 0;
    while (assembled[same] && assembled[same] == joined[same])
        same++;
    CHECK_MSG(strstr(joined, "slv_sample_grad") && !assembled[same] && !joined[same],
              "the installed file differs: %.60s in place of %.60s", joined + same,
              assembled + same);
    free(assembled);
    free(joined);
    for (uint32_t s = 0; s < slv_strategy_count(); s++)
        write_installed("plain", slv_strategy_at(s), slv_strategy_at(s)->name, "", 0);
    CHECK(reference_compiler("plain_*.frag") == 0);
    print_complaints(run.out);
}

int main(void) {
    slv_env env = test_env();
    kit_scratch_make(&scratch);
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    CHECK(slv_gl_get_info(gl)->backend != SLV_GL_HOST);
#define LOAD(type, name)                                                                           \
    api.name = (type)slv_gl_get_function(gl, "gl" #name);                                          \
    REQUIRE(api.name != NULL);
    FUNCTIONS(LOAD)
#undef LOAD
    installed = kit_read(kit_variable("SELVAGE_SAMPLE_GLSL"), NULL);
    for (int stage = 0; stage < STAGES; stage++) {
        char name[64];
        snprintf(name, sizeof name, "%s.vert", stage_names[stage]);
        vertex[stage] = read_shader(name);
        const char *texts[] = {version, vertex[stage]};
        vertex_shaders[stage] = compile(GL_VERTEX_SHADER, name, texts, 2);
        write_shader(name, "", vertex[stage]);
        snprintf(name, sizeof name, "%s.frag", stage_names[stage]);
        fragment[stage] = read_shader(name);
    }
    for (uint32_t nchannels = 3; nchannels <= 4; nchannels++) {
        check_texture(nchannels, 1);
        check_texture(nchannels, 16);
    }
    /* with and without coverage of their own for those that have it; two anisotropies; taps made by
     * either; with branches and in vectors */
    int nways = 0;
    for (uint32_t s = 0; s < slv_strategy_count(); s++)
        nways += slv_strategy_at(s)->coverage ? 2 : 1;
    CHECK_MSG(nseen == nways * 2 * (test_brief() ? 2 * 3 : 4 * SLV_GL_MAX_VARIANTS), "%d texts",
              nseen);
    CHECK(kit_count_files(scratch.folder) == nfiles);

    for (int stage = 0; stage < STAGES; stage++) {
        for (uint32_t s = 0; s < slv_strategy_count(); s++) {
            char pattern[64];
            snprintf(pattern, sizeof pattern, "%s_%s_*.frag", stage_names[stage],
                     slv_strategy_at(s)->name);
            int code = reference_compiler(pattern);
            CHECK_MSG(code == 0, "glslangValidator (Debian: glslang-tools) ended with %d on %s",
                      code, pattern);
            CHECK_MSG(!strstr(run.out, "WARNING"), "glslangValidator warns");
            if (code)
                print_complaints(run.out);
            fputs(run.err, stderr);
        }
    }
    check_installed();
    CHECK(reference_compiler("*.vert") == 0);
    /* the test of the test: an error is an error for both */
    write_shader("broken.frag", seen[0], "void main() { slv_sample(0.5); }\n");
    CHECK(reference_compiler("broken.frag") != 0 && strstr(run.out, "ERROR"));
    write_shader("undecided.frag", installed, fragment[0]);
    CHECK(reference_compiler("undecided.frag") != 0 && strstr(run.out, "define the strategy"));

    for (int stage = 0; stage < STAGES; stage++) {
        api.DeleteShader(vertex_shaders[stage]);
        free(vertex[stage]);
        free(fragment[stage]);
    }
    while (nseen)
        free(seen[--nseen]);
    free(installed);
    slv_gl_destroy(gl);
    test_remove(scratch.root);
    return test_end();
}
