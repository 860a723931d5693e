/* OpenSubdiv's regression shapes, if SELVAGE_MESHES names the folder that holds them as
 * osd/NAME.obj: each is read or refused with words, its adjacency is mutual, and both schemes
 * evaluate to something finite everywhere. */
#include "kit/edge_kit.h"
#include "kit/mesh_shapes.h"

#include <selvage/surface.h>

#include <dirent.h>

enum { SIDE = 8, POINTS = (SIDE + 1) * (SIDE + 1) };

static void check_surface(const slv_env *env, const slv_mesh *mesh, slv_scheme scheme,
                          const char *name) {
    float p[3 * POINTS], du[3 * POINTS], dv[3 * POINTS], n[3 * POINTS];
    slv_surface_arrays arrays = {p, du, dv, n};
    slv_surface_params params = {.scheme = scheme};
    slv_surface *surface = NULL;
    MUST(slv_surface_create(env, mesh, &params, &surface));
    for (int32_t f = 0; f < (int32_t)slv_mesh_face_count(mesh); f++) {
        bool finite = true;
        REQUIRE(slv_surface_evaluate_grid(surface, f, SIDE, SIDE, &arrays) == SLV_OK);
        for (int i = 0; i < 3 * POINTS; i++)
            finite = finite && isfinite(p[i]) && isfinite(du[i]) && isfinite(dv[i]);
        for (int i = 0; i < POINTS; i++) {
            float *a = n + 3 * i;
            finite = finite && fabsf(a[0] * a[0] + a[1] * a[1] + a[2] * a[2] - 1) < 1e-4f;
        }
        CHECK_MSG(finite, "%s: face %d", name, f);
    }
    slv_surface_destroy(surface);
}

/* Both sides of every shared edge in the same place. */
static void check_edges(const slv_env *env, const slv_mesh *mesh, const slv_adjacency *a,
                        const char *name) {
    slv_surface *surface = NULL;
    slv_mesh_stats stats;
    test_last_log[0] = 0;
    MUST(slv_surface_create(env, mesh, NULL, &surface));
    MUST(slv_mesh_get_stats(env, mesh, &stats));
    bool flat = strstr(test_last_log, "stay flat") != NULL;
    float size = 0, worst = 0;
    for (int c = 0; c < 3; c++)
        size = fmaxf(size, stats.bounds_max[c] - stats.bounds_min[c]);
    for (int32_t f = 0; f < (int32_t)slv_mesh_face_count(mesh) && !flat; f++)
        for (unsigned e = 0; e < 4; e++) {
            slv_neighbour n[2];
            uint32_t count = slv_adjacency_neighbours(a, f, e, n);
            for (uint32_t i = 0; i < count; i++)
                for (int step = 0; step <= 4; step++) {
                    float t = n[i].t0 + (n[i].t1 - n[i].t0) * (float)step / 4, p[6];
                    slv_surface_point points[2] = {{f, 0, 0}, {n[i].face, 0, 0}};
                    slv_surface_arrays arrays = {.positions = p};
                    kit_edge_point_float(e, t, &points[0].u, &points[0].v);
                    slv_affine_apply(&n[i].map, points[0].u, points[0].v, &points[1].u,
                                     &points[1].v);
                    CHECK(slv_surface_evaluate(surface, 2, points, &arrays) == SLV_OK);
                    for (int c = 0; c < 3; c++)
                        worst = fmaxf(worst, fabsf(p[c] - p[3 + c]));
                }
        }
    CHECK_MSG(worst <= 1e-5f * size, "%s: edges are %g of %g apart", name, (double)worst,
              (double)size);
    slv_surface_destroy(surface);
}

static void check_file(const char *path, const char *name) {
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    slv_adjacency *a = NULL, *again = NULL;
    test_last_log[0] = 0;
    if (slv_mesh_load(&env, path, &mesh)) {
        CHECK_MSG(test_last_log[0] != 0, "%s was refused without a word", name);
        fprintf(stderr, "refused: %s\n", test_last_log);
        return;
    }
    MUST(slv_mesh_adjacency(&env, mesh, &a));
    CHECK(slv_adjacency_cut_count(a) == 0);
    MUST(slv_adjacency_create(&env, slv_mesh_face_count(mesh), slv_adjacency_faces(a),
                              slv_mesh_face_flags(mesh), &again));
    CHECK(slv_adjacency_cut_count(again) == 0);
    check_surface(&env, mesh, SLV_SCHEME_CATMARK, name);
    check_surface(&env, mesh, SLV_SCHEME_BILINEAR, name);
    check_edges(&env, mesh, a, name);
    slv_adjacency_destroy(a);
    slv_adjacency_destroy(again);
    slv_mesh_destroy(mesh);
}

int main(void) {
    const char *folder = getenv("SELVAGE_MESHES");
    char path[1024];
    shape s = shape_cube();
    slv_mesh *mesh = shape_mesh(NULL, &s);
    check_surface(NULL, mesh, SLV_SCHEME_CATMARK, "cube");
    slv_mesh_destroy(mesh);
    shape_clear(&s);
    snprintf(path, sizeof path, "%s/osd", folder ? folder : "");
    DIR *dir = folder ? opendir(path) : NULL;
    int files = 0;
    CHECK_MSG(!folder || dir, "no folder %s", path);
    for (struct dirent *entry; dir && (entry = readdir(dir)) != NULL;) {
        size_t length = strlen(entry->d_name);
        if (length < 4 || strcmp(entry->d_name + length - 4, ".obj") != 0)
            continue;
        snprintf(path, sizeof path, "%s/osd/%s", folder, entry->d_name);
        check_file(path, entry->d_name);
        files++;
    }
    if (dir)
        closedir(dir);
    fprintf(stderr, "%d files\n", files);
    return test_end();
}
