/* max_bytes holds for all that an object holds together: many small things are no way around it.
 * What is replaced or given back does not count. */
#include "kit/memory_kit.h"
#include "kit/ptx_kit.h"

#include <selvage/adjacency.h>
#include <selvage/exchange.h>
#include <selvage/file.h>
#include <selvage/image.h>
#include <selvage/mesh.h>
#include <selvage/ptx_writer.h>
#include <selvage/texture.h>
#include <selvage/transfer.h>

enum { MIB = 1 << 20, BOMBS = 12 };

static unsigned errors;

static void count_errors(void *user, slv_log_level level, const char *line) {
    (void)user;
    errors += level == SLV_LOG_ERROR;
    snprintf(test_last_log, sizeof test_last_log, "%s", line);
}

static slv_env small_env(uint64_t max_bytes) {
    errors = 0;
    test_last_log[0] = 0;
    return (slv_env){.log = count_errors, .max_bytes = max_bytes, .threads = 1};
}

#define IS_OVER(call)                                                                              \
    do {                                                                                           \
        slv_result result_ = call;                                                                 \
        CHECK_MSG(result_ == SLV_ERROR_LIMIT && errors == 1, "%s: %u lines, %s",                   \
                  slv_result_string(result_), errors, test_last_log);                              \
    } while (0)

static slv_ptx_writer *begin(const char *path) {
    slv_env env = test_env();
    const slv_ptx_writer_params params = {
        .mesh_type = SLV_PTX_QUAD, .nchannels = 1, .alpha_channel = SLV_NO_ALPHA, .nfaces = 1};
    const slv_ptx_face face = {.flags = SLV_FACE_CONSTANT, .adjacency.face = {-1, -1, -1, -1}};
    slv_ptx_writer *writer = NULL;
    REQUIRE(!slv_ptx_writer_create(&env, path, &params, &writer));
    REQUIRE(!slv_ptx_writer_write_face(writer, 0, &face, "x"));
    return writer;
}

static void finish(slv_ptx_writer *writer) {
    REQUIRE(!slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
}

/* A file with many edits of metadata that unpack to a MiB each, under one key or each its own. */
static void write_edits(const char *path, bool one_key) {
    slv_env env = test_env();
    char *zeros = calloc(1, MIB);
    finish(begin(path));
    for (int i = 0; i < BOMBS; i++) {
        char key[16];
        slv_ptx_writer *writer = NULL;
        const slv_ptx_meta meta = {
            .key = key, .type = SLV_META_INT8, .count = MIB, .values = zeros};
        snprintf(key, sizeof key, "k%d", one_key ? 0 : i);
        zeros[0] = (char)i;
        REQUIRE(!slv_ptx_writer_edit(&env, path, NULL, &writer));
        REQUIRE(!slv_ptx_writer_set_meta(writer, &meta));
        finish(writer);
    }
    free(zeros);
}

static void edits(void) {
    const char *path = scratch_path("edits.ptx");
    slv_ptx *ptx = NULL;
    slv_env env = small_env(8 * MIB);
    write_edits(path, false);
    IS_OVER(slv_ptx_open(&env, path, &ptx));
    env = small_env(0);
    REQUIRE(!slv_ptx_open(&env, path, &ptx));
    CHECK(slv_ptx_get_info(ptx)->nmeta == BOMBS);
    slv_ptx_close(ptx);

    write_edits(path, true);
    env = small_env(4 * MIB);
    REQUIRE(!slv_ptx_open(&env, path, &ptx));
    CHECK(slv_ptx_get_info(ptx)->nmeta == 1);
    const slv_ptx_meta *last = slv_ptx_find_meta(ptx, "k0");
    REQUIRE(last && last->count == MIB);
    CHECK(((const int8_t *)last->values)[0] == BOMBS - 1);
    slv_ptx_close(ptx);
}

/* Large values that are read when they are asked for. */
static void large_values(void) {
    const char *path = scratch_path("large.ptx");
    char *zeros = calloc(1, MIB);
    slv_ptx_writer *writer = begin(path);
    for (int i = 0; i < BOMBS; i++) {
        char key[16];
        const slv_ptx_meta meta = {
            .key = key, .type = SLV_META_INT8, .count = MIB, .values = zeros};
        snprintf(key, sizeof key, "k%d", i);
        REQUIRE(!slv_ptx_writer_set_meta(writer, &meta));
    }
    finish(writer);
    free(zeros);
    slv_env env = small_env(8 * MIB);
    slv_ptx *ptx = NULL;
    REQUIRE(!slv_ptx_open(&env, path, &ptx));
    IS_OVER(slv_ptx_load_tables(ptx));
    slv_ptx_close(ptx);
}

/* Each array of the mesh is within the limit, all of them are not. */
static void meshes(void) {
    enum { VERTICES = 60000, LINE = 48 };
    char *text = malloc(VERTICES * 3 * LINE);
    size_t size = 0;
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    REQUIRE(text);
    for (int i = 0; i < VERTICES; i++)
        size += (size_t)snprintf(text + size, LINE, "v %d 0 %d\nvt 0 0\nvn 0 0 1\n", i % 2, i);
    for (int i = 1; i + 4 < VERTICES; i += 2)
        size += (size_t)snprintf(text + size, LINE, "f %d %d %d %d\n", i, i + 1, i + 3, i + 2);
    slv_env env = small_env(3 * MIB);
    IS_OVER(slv_mesh_parse_obj(&env, "mesh", text, size, &mesh));
    env = small_env(64 * MIB);
    REQUIRE(!slv_mesh_parse_obj(&env, "mesh", text, size, &mesh));
    env = small_env(2 * MIB);
    IS_OVER(slv_mesh_adjacency(&env, mesh, &adjacency));
    slv_mesh_destroy(mesh);
    free(text);
}

/* What is set anew takes the place of what was there. */
static void textures(void) {
    enum { FACES = 16 };
    static const slv_res res[FACES] = {{8, 8}, {8, 8}, {8, 8}, {8, 8}, {8, 8}, {8, 8},
                                       {8, 8}, {8, 8}, {8, 8}, {8, 8}, {8, 8}, {8, 8},
                                       {8, 8}, {8, 8}, {8, 8}, {8, 8}};
    static uint8_t texels[1 << 16];
    const slv_texture_desc desc = {
        .nfaces = FACES, .type = SLV_TYPE_U8, .nchannels = 1, .alpha_channel = -1, .res = res};
    slv_env env = small_env(MIB / 2);
    slv_texture *texture = NULL;
    slv_result result = SLV_OK;
    for (size_t i = 0; i < sizeof texels; i++)
        texels[i] = (uint8_t)i;
    REQUIRE(!slv_texture_create(&env, &desc, &texture));
    for (int turn = 0; turn < 20; turn++)
        CHECK(!slv_texture_set_face(texture, 0, texels));
    for (uint32_t face = 0; face < FACES && !result; face++)
        result = slv_texture_set_face(texture, face, texels);
    IS_OVER(result);
    slv_texture_destroy(texture);
}

/* ---- objects of which each piece is small ---- */

static const char *in_gz, *in_png, *in_exr, *in_ptx;
static slv_mesh *grid;

static slv_result text_call(const slv_env *env) {
    char *text = NULL;
    size_t size;
    slv_result result = slv_text_load(env, in_gz, &text, &size);
    slv_free(text);
    return result;
}

static slv_result mesh_call(const slv_env *env) {
    slv_mesh *mesh = NULL;
    slv_result result = slv_mesh_load(env, in_gz, &mesh);
    slv_mesh_destroy(mesh);
    return result;
}

static slv_result image_call(const slv_env *env, const char *path) {
    slv_image image = {0};
    slv_result result = slv_image_load(env, path, &image);
    slv_image_free(&image);
    return result;
}

static slv_result png_call(const slv_env *env) {
    return image_call(env, in_png);
}

static slv_result exr_call(const slv_env *env) {
    return image_call(env, in_exr);
}

static slv_result adjacency_call(const slv_env *env) {
    slv_adjacency *adjacency = NULL;
    slv_result result = slv_mesh_adjacency(env, grid, &adjacency);
    slv_adjacency_destroy(adjacency);
    return result;
}

static slv_result transfer_call(const slv_env *env) {
    static slv_transfer_face faces[1024];
    slv_env plain = test_env();
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL, *moved = NULL;
    REQUIRE(!slv_ptx_open(&plain, in_ptx, &ptx) && !slv_ptx_load_texture(&plain, ptx, &texture));
    slv_result result = slv_transfer(env, grid, texture, grid, NULL, faces, NULL, &moved);
    slv_texture_destroy(moved);
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
    return result;
}

static slv_result convert_call(const slv_env *env, const char *from, const char *to,
                               slv_result (*how)(const slv_env *, const slv_exchange *,
                                                 const slv_exchange_params *, const char *,
                                                 slv_exchange_stats *)) {
    slv_env plain = test_env();
    slv_exchange *source = NULL;
    char out[256], in[256];
    snprintf(in, sizeof in, "%s", scratch_path(from));
    snprintf(out, sizeof out, "%s", scratch_path(to));
    REQUIRE(!slv_exchange_open(&plain, in, &source));
    slv_result result = how(env, source, NULL, out, NULL);
    slv_exchange_close(source);
    return result;
}

static slv_result sheet_call(const slv_env *env) {
    return convert_call(env, "limits.ptx", "limits_sheet.png", slv_exchange_to_sheet);
}

static slv_result import_call(const slv_env *env) {
    return convert_call(env, "limits_sheet.json", "limits_back.ptx", slv_exchange_to_ptx);
}

static void objects(void) {
    static char paths[4][256];
    const char *const names[4] = {"limits.obj.gz", "limits.png", "limits.exr", "limits.ptx"};
    slv_env env = test_env();
    slv_image image = {0};
    char line[1024];
    for (int i = 0; i < 4; i++)
        snprintf(paths[i], sizeof paths[i], "%s", scratch_path(names[i]));
    in_gz = paths[0], in_png = paths[1], in_exr = paths[2], in_ptx = paths[3];
    grid = grid_mesh(30, 30, false);
    REQUIRE(!slv_mesh_save_obj(&env, grid, scratch_path("limits.obj")));
    snprintf(line, sizeof line, "gzip -nf '%s'", scratch_path("limits.obj"));
    REQUIRE(system(line) == 0);
    REQUIRE(!slv_image_create(&env, 200, 150, 4, &image));
    REQUIRE(!slv_image_save(&env, in_png, &image, NULL) &&
            !slv_image_save(&env, in_exr, &image, NULL));
    slv_image_free(&image);

    slv_ptx_writer *writer = NULL;
    const slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                          .nchannels = 1,
                                          .alpha_channel = SLV_NO_ALPHA,
                                          .nfaces = slv_mesh_face_count(grid)};
    static uint8_t texels[256];
    REQUIRE(!slv_ptx_writer_create(&env, in_ptx, &params, &writer));
    REQUIRE(!slv_ptx_writer_set_mesh(writer, grid));
    for (uint32_t face = 0; face < params.nfaces; face++) {
        const slv_ptx_face info = {.res = {4, 4}};
        texels[face % 256]++;
        REQUIRE(!slv_ptx_writer_write_face(writer, face, &info, texels));
    }
    finish(writer);

    memory_within("a text that is packed", text_call);
    memory_within("a mesh from a file", mesh_call);
    memory_within("a PNG image", png_call);
    memory_within("an OpenEXR image", exr_call);
    memory_within("the adjacency of a mesh", adjacency_call);
    memory_within("a transfer", transfer_call);
    memory_within("a sheet", sheet_call);
    REQUIRE(!sheet_call(&env));
    memory_within("an import", import_call);
    slv_mesh_destroy(grid);
    snprintf(line, sizeof line, "rm -f '%s'*", scratch_path("limits"));
    CHECK(system(line) == 0);
}

int main(void) {
    objects();
    edits();
    large_values();
    meshes();
    textures();
    unlink(scratch_path("edits.ptx"));
    unlink(scratch_path("large.ptx"));
    return test_end();
}
