/* Long calls say how far they are, and end when the caller says so: with one line in the log,
 * nothing made and no file. */
#include "kit/progress_kit.h"

#include <selvage/bake.h>
#include <selvage/image.h>
#include <selvage/ptx_check.h>
#include <selvage/ptx_diff.h>
#include <selvage/ptx_writer.h>
#include <selvage/reference.h>
#include <selvage/transfer.h>

#include <unistd.h>

enum { SIDE = 12, NFACES = SIDE * SIDE };

static slv_mesh *mesh;
static slv_surface *surface;
static slv_adjacency *adjacency;
static slv_texture *texture;
static slv_image picture;
static char folder[128], file[160], out[160];

static void make_inputs(void) {
    static char obj[20000];
    size_t length = 0;
    slv_res res[NFACES];
    slv_env env = test_env();
    for (int i = 0; i <= SIDE; i++)
        for (int k = 0; k <= SIDE; k++)
            length += (size_t)snprintf(obj + length, sizeof obj - length, "v %d %d %d\n", k, i,
                                       (i * k) % 3);
    for (int i = 0; i < SIDE; i++)
        for (int k = 0; k < SIDE; k++) {
            int at = i * (SIDE + 1) + k + 1;
            length += (size_t)snprintf(obj + length, sizeof obj - length, "f %d %d %d %d\n", at,
                                       at + 1, at + SIDE + 2, at + SIDE + 1);
        }
    for (int i = 0; i < NFACES; i++)
        res[i] = (slv_res){3, 3};
    const slv_texture_desc desc = {NFACES, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res, SLV_TEXTURE_AUTO};
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE};
    REQUIRE(!slv_mesh_parse_obj(&env, "mesh", obj, length, &mesh));
    REQUIRE(!slv_mesh_adjacency(&env, mesh, &adjacency));
    REQUIRE(!slv_surface_create(&env, mesh, NULL, &surface));
    REQUIRE(!slv_texture_create(&env, &desc, &texture));
    REQUIRE(!slv_bake_procedural(&env, surface, &noise, NULL, texture));
    REQUIRE(!slv_image_create(&env, 64, 64, 3, &picture));
    snprintf(folder, sizeof folder, "%s/selvage_progress_XXXXXX", test_parent());
    REQUIRE(mkdtemp(folder));
    snprintf(file, sizeof file, "%s/in.ptx", folder);
    REQUIRE(!slv_ptx_save(&env, file, texture, adjacency, &(slv_ptx_write_params){.mesh = mesh}));
}

static void free_inputs(void) {
    slv_texture_destroy(texture);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    slv_image_free(&picture);
    unlink(file);
    REQUIRE(rmdir(folder) == 0);
}

/* A file is there after a call that was not stopped, and then only. */
static slv_result wrote(slv_result result) {
    CHECK_MSG((access(out, F_OK) == 0) == (result == SLV_OK), "%s", out);
    unlink(out);
    return result;
}

static slv_result bake(const slv_env *env, slv_progress progress) {
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE};
    return slv_bake_procedural(env, surface, &noise, &(slv_bake_params){.progress = progress},
                               texture);
}

static slv_result save(const slv_env *env, slv_progress progress) {
    const slv_ptx_write_params params = {.progress = progress};
    return wrote(slv_ptx_save(env, out, texture, adjacency, &params));
}

static slv_result rewrite(const slv_env *env, slv_progress progress) {
    slv_ptx *ptx = NULL;
    slv_result result = slv_ptx_open(env, file, &ptx);
    if (!result)
        result = slv_ptx_rewrite(env, ptx, out, &(slv_ptx_writer_params){.progress = progress});
    slv_ptx_close(ptx);
    return wrote(result);
}

static slv_result repair(const slv_env *env, slv_progress progress) {
    slv_ptx *ptx = NULL;
    slv_result result = slv_ptx_open(env, file, &ptx);
    if (!result)
        result =
            slv_ptx_repair(env, ptx, mesh, out, &(slv_ptx_writer_params){.progress = progress});
    slv_ptx_close(ptx);
    return wrote(result);
}

static slv_result finish(const slv_env *env, slv_progress progress) {
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                    .nchannels = 1,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = 5,
                                    .progress = progress};
    slv_ptx_writer *writer = NULL;
    slv_result result = slv_ptx_writer_create(env, out, &params, &writer);
    if (!result)
        result = slv_ptx_writer_finish(writer);
    slv_ptx_writer_destroy(writer);
    return wrote(result);
}

/* What was edited stays as it was. */
static slv_result edit(const slv_env *env, slv_progress progress) {
    const slv_ptx_writer_params params = {.progress = progress};
    const slv_ptx_face face = {.adjacency.face = {-1, -1, -1, -1}};
    const uint8_t texel[3] = {1, 2, 3};
    slv_ptx_writer *writer = NULL;
    slv_ptx *ptx = NULL;
    REQUIRE(!slv_ptx_save(env, out, texture, adjacency, NULL));
    slv_result result = slv_ptx_writer_edit(env, out, &params, &writer);
    if (!result && !(result = slv_ptx_writer_write_face(writer, 3, &face, texel)))
        result = slv_ptx_writer_finish(writer);
    slv_ptx_writer_destroy(writer);
    REQUIRE(!slv_ptx_open(env, out, &ptx));
    CHECK(slv_ptx_get_info(ptx)->has_edits == (result == SLV_OK));
    slv_ptx_close(ptx);
    unlink(out);
    return result;
}

static slv_result check(const slv_env *env, slv_progress progress) {
    slv_ptx_report *report = NULL;
    slv_result result =
        slv_ptx_check(env, file, &(slv_ptx_check_params){.progress = progress}, &report);
    CHECK((report != NULL) == (result == SLV_OK));
    slv_ptx_report_destroy(report);
    return result;
}

static slv_result diff(const slv_env *env, slv_progress progress) {
    static slv_face_diff differences[NFACES];
    slv_ptx *ptx = NULL;
    slv_result result = slv_ptx_open(env, file, &ptx);
    if (!result)
        result =
            slv_ptx_diff(env, ptx, ptx, &(slv_ptx_diff_params){.progress = progress}, differences);
    slv_ptx_close(ptx);
    return result;
}

static slv_result load(const slv_env *env, slv_progress progress) {
    const slv_ptx_open_params params = {.progress = progress};
    slv_texture *loaded = NULL;
    slv_ptx *ptx = NULL;
    slv_result result = slv_ptx_open_with(env, file, &params, &ptx);
    if (!result)
        result = slv_ptx_load_texture(env, ptx, &loaded);
    CHECK((loaded != NULL) == (result == SLV_OK));
    slv_texture_destroy(loaded);
    slv_ptx_close(ptx);
    return result;
}

static slv_result transfer(const slv_env *env, slv_progress progress) {
    static slv_transfer_face faces[NFACES];
    slv_texture *moved = NULL;
    slv_result result =
        slv_transfer(env, mesh, texture, mesh, &(slv_transfer_params){.progress = progress}, faces,
                     NULL, &moved);
    CHECK((moved != NULL) == (result == SLV_OK));
    slv_texture_destroy(moved);
    return result;
}

static slv_result render(const slv_env *env, slv_progress progress) {
    const float low[3] = {0, 0, 0}, high[3] = {SIDE, SIDE, 3};
    const slv_reference_frame frame = {.width = 64,
                                       .height = 64,
                                       .samples = 1,
                                       .camera = slv_camera_orbit(low, high, 20, 30, 30, 1),
                                       .progress = progress};
    slv_reference *reference = NULL;
    slv_image image = {0};
    slv_result result = slv_reference_create(env, mesh, surface, texture, adjacency,
                                             &(slv_reference_params){.segments = 2}, &reference);
    if (!result)
        result = slv_reference_render(reference, env, &frame, &image, NULL, NULL);
    CHECK((image.pixels != NULL) == (result == SLV_OK));
    slv_image_free(&image);
    slv_reference_destroy(reference);
    return result;
}

static slv_result save_png(const slv_env *env, slv_progress progress) {
    snprintf(out, sizeof out, "%s/out.png", folder);
    return wrote(slv_image_save(env, out, &picture, &(slv_image_params){.progress = progress}));
}

static slv_result save_exr(const slv_env *env, slv_progress progress) {
    snprintf(out, sizeof out, "%s/out.exr", folder);
    return wrote(slv_image_save(env, out, &picture, &(slv_image_params){.progress = progress}));
}

int main(void) {
    make_inputs();
    snprintf(out, sizeof out, "%s/out.ptx", folder);
    progress_check("bake", bake);
    progress_check("save", save);
    progress_check("rewrite", rewrite);
    progress_check("repair", repair);
    progress_check("finish", finish);
    progress_check("edit", edit);
    progress_check("check", check);
    progress_check("diff", diff);
    progress_check("load", load);
    progress_check("transfer", transfer);
    progress_check("render", render);
    progress_check("PNG", save_png);
    progress_check("EXR", save_exr);
    free_inputs();
    return test_end();
}
