/* Bytes of any kind as an OBJ mesh, or as a PLY mesh if they begin so: parsed, connected,
 * subdivided, written and read again. */
#include "kit/fuzz_kit.h"

#include <selvage/surface.h>

#include <math.h>

/* A refined surface costs more than its text; what is looked at is whether it comes out. */
enum { MAX_SURFACE_POLYS = 64, MAX_SURFACE_SIDES = 600 };

static void check_surface(const slv_env *env, const slv_mesh *mesh, slv_scheme scheme) {
    slv_surface *surface = NULL;
    slv_surface_params params = {.scheme = scheme};
    float positions[27], normals[27];
    slv_surface_arrays out = {.positions = positions, .normals = normals};
    if (FUZZ_CALL(slv_surface_create(env, mesh, &params, &surface)))
        return;
    for (uint32_t face = 0; face < slv_surface_face_count(surface); face++) {
        FUZZ_REQUIRE(!FUZZ_CALL(slv_surface_evaluate_grid(surface, (int32_t)face, 2, 2, &out)),
                     "face %u", face);
        for (int i = 0; i < 27; i++)
            FUZZ_REQUIRE(!isnan(normals[i]), "face %u: a normal that is no number", face);
    }
    slv_surface_destroy(surface);
}

static void check_copy(const slv_env *env, const slv_mesh *mesh) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    slv_mesh *copy = NULL;
    FUZZ_REQUIRE(!FUZZ_CALL(slv_mesh_save_obj(env, mesh, fuzz_path("out.obj"))), "not written");
    FUZZ_REQUIRE(!FUZZ_CALL(slv_mesh_load(env, fuzz_path("out.obj"), &copy)), "not read: %s",
                 fuzz_last);
    const slv_mesh_view *again = slv_mesh_get_view(copy);
    FUZZ_REQUIRE(again->nverts == view->nverts && again->npolys == view->npolys &&
                     again->ncreases == view->ncreases && again->ncorners == view->ncorners &&
                     again->nholes == view->nholes && again->boundary == view->boundary,
                 "the copy differs");
    for (size_t i = 0; i < 3 * (size_t)view->nverts; i++) {
        double was = (double)view->positions[i] + view->origin[i % 3],
               is = (double)again->positions[i] + again->origin[i % 3];
        /* of a mesh far from zero fifteen digits are written, and of each vertex as many are kept
         */
        double slack = view->origin[i % 3] == 0 && again->origin[i % 3] == 0
                           ? 0
                           : 1e-14 * (fabs(view->origin[i % 3]) + fabs(was));
        FUZZ_REQUIRE(fabs(was - is) <= slack, "positions differ: %.17g, %.17g", was, is);
    }
    slv_mesh_destroy(copy);
    fuzz_clear(1);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    slv_env env = fuzz_env();
    slv_mesh *mesh = NULL;
    slv_mesh_stats stats;
    slv_adjacency *adjacency = NULL;
    bool ply = size >= 3 && memcmp(data, "ply", 3) == 0;
    if (FUZZ_CALL(ply ? slv_mesh_parse_ply(&env, "fuzz.ply", (const char *)data, size, &mesh)
                      : slv_mesh_parse_obj(&env, "fuzz.obj", (const char *)data, size, &mesh)))
        return 0;
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    uint64_t sides = 0;
    for (uint32_t p = 0; p < view->npolys; p++)
        sides += (uint64_t)view->poly_sizes[p];
    FUZZ_CALL(slv_mesh_get_stats(&env, mesh, &stats));
    if (!FUZZ_CALL(slv_mesh_adjacency(&env, mesh, &adjacency)))
        FUZZ_REQUIRE(slv_adjacency_face_count(adjacency) == slv_mesh_face_count(mesh) &&
                         slv_adjacency_cut_count(adjacency) == 0,
                     "a mesh whose neighbours do not agree");
    slv_adjacency_destroy(adjacency);
    check_copy(&env, mesh);
    if (view->npolys <= MAX_SURFACE_POLYS && sides <= MAX_SURFACE_SIDES) {
        check_surface(&env, mesh, SLV_SCHEME_CATMARK);
        check_surface(&env, mesh, SLV_SCHEME_BILINEAR);
    }
    slv_mesh_destroy(mesh);
    return 0;
}
