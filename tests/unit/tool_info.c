/* The command `selvage info`, run as a user runs it. */
#include <selvage/mesh.h>
#include <selvage/ptx.h>

#include "kit/test.h"

#include <sys/wait.h>
#include <unistd.h>

static char folder[128];
static const char *command_folder;

/* Runs `selvage info ARGUMENTS` in the folder; both streams land in `out`. Returns the exit code.
 */
static int info(const char *arguments, char *out, size_t size) {
    char line[1024];
    snprintf(line, sizeof line, "cd '%s' && '%s/selvage' info 2>&1 %s", folder, command_folder,
             arguments);
    FILE *pipe = popen(line, "r");
    if (!pipe)
        return -1;
    size_t got = fread(out, 1, size - 1, pipe);
    out[got] = 0;
    int status = pclose(pipe);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void write_file(const char *name, const void *bytes, size_t size) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *stream = fopen(path, "wb");
    REQUIRE(stream);
    CHECK(fwrite(bytes, 1, size, stream) == size);
    CHECK(fclose(stream) == 0);
}

/* A quad and a triangle: four faces, three of them sub-faces. */
static void write_mesh(void) {
    static const char text[] = "g \x1b[31m\xffred\n"
                               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0.5 0\n"
                               "f 1 2 3 4\nf 2 5 3\n";
    write_file("mesh.obj", text, sizeof text - 1);
}

static void write_ptx(void) {
    static const slv_res res[4] = {{3, 2}, {1, 1}, {1, 1}, {2, 2}};
    static const double reals[3] = {1.0 / 3, NAN, 2};
    static const char rude[] = "bell \a and \xff";
    const slv_ptx_meta meta[] = {
        {.key = "reals", .type = SLV_META_DOUBLE, .count = 3, .values = reals},
        {.key = "rude\x1b", .type = SLV_META_STRING, .count = sizeof rude - 1, .values = rude}};
    slv_env env = test_env();
    slv_texture_desc desc = {
        .nfaces = 4, .nchannels = 3, .alpha_channel = SLV_NO_ALPHA, .res = res};
    slv_texture *texture = NULL;
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    char path[256];
    snprintf(path, sizeof path, "%s/mesh.obj", folder);
    REQUIRE(!slv_mesh_load(&env, path, &mesh));
    REQUIRE(!slv_mesh_adjacency(&env, mesh, &adjacency));
    REQUIRE(!slv_texture_create(&env, &desc, &texture));
    uint8_t texels[32 * 3];
    for (size_t i = 0; i < sizeof texels; i++)
        texels[i] = (uint8_t)i;
    for (uint32_t f = 0; f < 3; f++)
        REQUIRE(!slv_texture_set_face(texture, f, texels));
    slv_ptx_write_params params = {.mesh = mesh, .nmeta = 2, .meta = meta};
    snprintf(path, sizeof path, "%s/texture.data", folder);
    REQUIRE(!slv_ptx_save(&env, path, texture, adjacency, &params));
    slv_texture_destroy(texture);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
}

#define HAS(text) CHECK_MSG(strstr(out, text), "'%s' in:\n%s", text, out)

static void check_mesh(void) {
    char out[16384];
    CHECK(info("mesh.obj --faces", out, sizeof out) == 0);
    HAS("4, of them 3 sub-faces");
    HAS("6, of them 5 boundary, 0 non-manifold, 0 flipped");
    HAS("\\x1b[31m\\xffred");
    CHECK(!strchr(out, '\x1b'));
    CHECK(info("mesh.obj --json -f", out, sizeof out) == 0);
    HAS("\"kind\": \"mesh\"");
    HAS("\"boundary_edges\": 5");
    HAS("\"face_table\": [");
    HAS("\\u001B[31m\xEF\xBF\xBDred");
    CHECK(info("mesh.obj --meta", out, sizeof out) == 2);
    static const char ply[] = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                              "property float y\nproperty float z\nelement face 1\n"
                              "property list uchar int vertex_indices\nend_header\n"
                              "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    write_file("mesh.PLY", ply, sizeof ply - 1);
    CHECK(info("mesh.PLY", out, sizeof out) == 0);
    HAS("3, of them 3 sub-faces");
}

static void check_ptx(void) {
    char out[16384];
    CHECK(info("texture.data --list-faces --meta", out, sizeof out) == 0);
    HAS("uint8, 3 channels, no alpha");
    HAS("4, of them 1 constant, 3 sub-faces");
    HAS("8 x 4");
    HAS("0: 3 faces, 120 bytes of texels in ");
    HAS(": 3 diff-zipped");
    HAS("inside: 2 polygons, 5 vertices");
    HAS("0.333333333333333 nan 2");
    HAS("bell \\x07 and \\xff");
    CHECK(!strchr(out, '\x1b') && !strchr(out, '\a'));
    CHECK(info("texture.data --json --meta", out, sizeof out) == 0);
    HAS("\"texels\": 56");
    HAS("\"level_table\": [");
    HAS("\"texel_bytes\": 120,");
    HAS("\"diff-zipped\": 3");
    HAS("\"alpha_channel\": null");
    HAS("0.33333333333333331");
    HAS("bell \\u0007 and \xEF\xBF\xBD");
    CHECK(!strstr(out, "nan") && !strstr(out, "NaN"));
}

static void check_errors(void) {
    char out[4096];
    write_file("short.ptx", "Ptex", 4);
    write_file("other.txt", "hello", 5);
    static const char *const failing[] = {"missing.ptx", ".", "other.txt", "short.ptx",
                                          "mesh.obj >/dev/full"};
    for (size_t i = 0; i < sizeof failing / sizeof *failing; i++) {
        CHECK_MSG(info(failing[i], out, sizeof out) == 1, "exit code of: info %s", failing[i]);
        char *end = strchr(out, '\n');
        CHECK_MSG(end && !end[1], "one line for: info %s, found: %s", failing[i], out);
    }
    CHECK(info("", out, sizeof out) == 2);
    CHECK(info("mesh.obj mesh.obj", out, sizeof out) == 2);
}

int main(void) {
    command_folder = getenv("SELVAGE_BIN");
    if (!command_folder)
        command_folder = "bin";
    snprintf(folder, sizeof folder, "%s/selvage_info_XXXXXX", test_parent());
    REQUIRE(mkdtemp(folder));
    write_mesh();
    write_ptx();
    check_mesh();
    check_ptx();
    check_errors();
    static const char *const names[] = {"mesh.obj", "mesh.PLY", "texture.data", "short.ptx",
                                        "other.txt"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char path[256];
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        remove(path);
    }
    rmdir(folder);
    return test_end();
}
