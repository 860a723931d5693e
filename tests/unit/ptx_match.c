/* Files and meshes that do and do not belong together. */
#include "kit/ptx_kit.h"

#include <selvage/ptx_writer.h>

static void save_grid(const char *path, const slv_mesh *mesh, const slv_face_adjacency *faces,
                      const uint8_t *flags, uint32_t nfaces) {
    slv_env env = test_env();
    slv_adjacency *adjacency = NULL;
    slv_texture *texture = NULL;
    slv_res *res = calloc(nfaces, sizeof *res);
    slv_texture_desc desc = {nfaces, SLV_TYPE_U8, 1, SLV_NO_ALPHA, res, SLV_TEXTURE_AUTO};
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    if (faces)
        REQUIRE(slv_adjacency_create(&env, nfaces, faces, flags, &adjacency) == SLV_OK);
    else if (mesh)
        REQUIRE(slv_mesh_adjacency(&env, mesh, &adjacency) == SLV_OK);
    REQUIRE(slv_ptx_save(&env, path, texture, adjacency, NULL) == SLV_OK);
    slv_adjacency_destroy(adjacency);
    slv_texture_destroy(texture);
    free(res);
}

static slv_result match(const char *path, const slv_mesh *mesh) {
    slv_env env = test_env();
    slv_ptx *ptx = NULL;
    REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
    test_last_log[0] = 0;
    slv_result result = slv_ptx_match_mesh(&env, ptx, mesh);
    CHECK(!result == !test_last_log[0]);
    slv_ptx_close(ptx);
    return result;
}

static void grids(void) {
    slv_mesh *mesh = grid_mesh(3, 2, false), *longer = grid_mesh(3, 3, false);
    slv_mesh *other = grid_mesh(2, 3, false), *pentagon = grid_mesh(3, 2, true);
    const char *path = scratch_path("match.ptx");
    save_grid(path, mesh, NULL, NULL, 6);
    CHECK(match(path, mesh) == SLV_OK);
    CHECK(match(path, other) == SLV_ERROR_MISMATCH);
    CHECK_MSG(strstr(test_last_log, "does not fit the mesh: face 0 edge 2: the file says face 3 "
                                    "edge 0, the mesh says face 2 edge 0"),
              "%s", test_last_log);
    CHECK(match(path, longer) == SLV_ERROR_MISMATCH);
    CHECK_MSG(strstr(test_last_log, "has 6 faces, the mesh has 9: face 3 edge 2: the file says a "
                                    "boundary, the mesh says face 6 edge 0"),
              "%s", test_last_log);
    CHECK(match(path, pentagon) == SLV_ERROR_MISMATCH);
    CHECK_MSG(strstr(test_last_log, "it has 6 faces, the mesh has 10: face 5, "), "%s",
              test_last_log);
    save_grid(path, NULL, NULL, NULL, 6);
    CHECK(match(path, mesh) == SLV_OK && match(path, other) == SLV_OK);
    CHECK(match(path, longer) == SLV_ERROR_MISMATCH);
    CHECK_MSG(strstr(test_last_log, "face 6 edge 0 is the first that the file lacks"), "%s",
              test_last_log);
    save_grid(path, pentagon, NULL, NULL, 10);
    CHECK(match(path, pentagon) == SLV_OK);
    slv_mesh_destroy(mesh);
    slv_mesh_destroy(longer);
    slv_mesh_destroy(other);
    slv_mesh_destroy(pentagon);
    remove(path);
}

/* Triangles, with and without their mesh inside, against the mesh, another of as many, and more. */
static void triangles(void) {
    slv_env env = test_env();
    static const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 1, 0};
    static const int32_t sizes[3] = {3, 3, 3}, verts[9] = {0, 1, 2, 1, 3, 2, 1, 4, 3},
                         turned[6] = {0, 1, 2, 3, 2, 1};
    slv_mesh_view view = {
        .nverts = 5, .positions = positions, .npolys = 2, .poly_sizes = sizes, .poly_verts = verts};
    slv_ptx_writer_params params = {
        .mesh_type = SLV_PTX_TRIANGLE, .nchannels = 1, .alpha_channel = SLV_NO_ALPHA, .nfaces = 2};
    slv_mesh *mesh = NULL, *other = NULL, *more = NULL;
    slv_ptx_writer *writer = NULL;
    const char *path = scratch_path("triangles.ptx");
    REQUIRE(slv_mesh_create(&env, &view, &mesh) == SLV_OK);
    view.npolys = 3;
    REQUIRE(slv_mesh_create(&env, &view, &more) == SLV_OK);
    view.npolys = 2;
    view.poly_verts = turned;
    REQUIRE(slv_mesh_create(&env, &view, &other) == SLV_OK);
    REQUIRE(slv_ptx_writer_create(&env, path, &params, &writer) == SLV_OK);
    REQUIRE(slv_ptx_writer_set_mesh(writer, mesh) == SLV_OK);
    REQUIRE(slv_ptx_writer_finish(writer) == SLV_OK);
    slv_ptx_writer_destroy(writer);
    CHECK(match(path, mesh) == SLV_OK);
    CHECK(match(path, other) == SLV_ERROR_MISMATCH);
    CHECK_MSG(strstr(test_last_log, "face 0 edge 1: the file says face 1 edge 2, the mesh says "
                                    "face 1 edge 1"),
              "%s", test_last_log);
    CHECK(match(path, more) == SLV_ERROR_MISMATCH);
    CHECK_MSG(strstr(test_last_log, "has 2 faces, the mesh has 3: face 1 edge 0: the file says a "
                                    "boundary, the mesh says face 2 edge 2"),
              "%s", test_last_log);
    slv_mesh_destroy(mesh);
    slv_mesh_destroy(other);
    slv_mesh_destroy(more);
    remove(path);
}

/* A sub-face flag that is missing, and a file of triangles. */
static void kinds(void) {
    slv_env env = test_env();
    slv_mesh *mesh = grid_mesh(3, 2, true);
    slv_adjacency *adjacency = NULL;
    char path[2048];
    const char *flat = scratch_path("flat.ptx");
    REQUIRE(slv_mesh_adjacency(&env, mesh, &adjacency) == SLV_OK);
    save_grid(flat, NULL, slv_adjacency_faces(adjacency), NULL, 10);
    CHECK(match(flat, mesh) == SLV_ERROR_MISMATCH);
    CHECK_MSG(strstr(test_last_log, "face "), "%s", test_last_log);
    snprintf(path, sizeof path, "%s/tri_closed_half_4.ptx", data_folder());
    CHECK(match(path, mesh) == SLV_ERROR_MISMATCH);
    CHECK_MSG(strstr(test_last_log, "is a triangle-mesh texture, and polygon 0 of the mesh has 4 "
                                    "vertices (face 0 edge 3)"),
              "%s", test_last_log);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    remove(flat);
}

/* Published files with the meshes that they were painted on, where the folder with them is given.
 */
static void samples(void) {
    static const char *const names[] = {"teapot", "nonquad", "triangle"};
    const char *folder = getenv("SELVAGE_SAMPLES");
    slv_env env = test_env();
    for (int i = 0; folder && i < 3; i++) {
        char path[2048], obj[2048];
        slv_ptx *ptx = NULL;
        slv_mesh *mesh = NULL, *inside = NULL;
        slv_texture *texture = NULL;
        snprintf(path, sizeof path, "%s/%s/%s.ptx", folder, names[i], names[i]);
        snprintf(obj, sizeof obj, "%s/%s/%s.obj", folder, names[i], names[i]);
        REQUIRE(slv_ptx_open(&env, path, &ptx) == SLV_OK);
        REQUIRE(slv_ptx_load_texture(&env, ptx, &texture) == SLV_OK);
        REQUIRE(slv_mesh_load(&env, obj, &mesh) == SLV_OK);
        CHECK_MSG(slv_ptx_match_mesh(&env, ptx, mesh) == SLV_OK, "%s", test_last_log);
        if (i < 2) { /* the third holds none */
            REQUIRE(slv_ptx_load_mesh(&env, ptx, &inside) == SLV_OK);
            CHECK_MSG(slv_ptx_match_mesh(&env, ptx, inside) == SLV_OK, "%s", test_last_log);
        }
        slv_texture_destroy(texture);
        slv_mesh_destroy(inside);
        slv_mesh_destroy(mesh);
        slv_ptx_close(ptx);
    }
}

int main(void) {
    REQUIRE(data_folder() != NULL);
    grids();
    kinds();
    triangles();
    samples();
    return test_end();
}
