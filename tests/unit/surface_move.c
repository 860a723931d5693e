/* Animated cages: a surface whose vertices are given other positions is the surface of the moved
 * mesh, to the bit, whatever its polygons, tags and scheme; it grows by nothing, and says what it
 * cannot take. */
#include "kit/mesh_shapes.h"

#include <selvage/camera.h>
#include <selvage/surface.h>
#include <selvage/tessellation.h>

#include <dirent.h>
#include <malloc.h>

/* Waves that go through a mesh. */
static void sway(const slv_mesh_view *view, float time, float *out) {
    for (uint32_t i = 0; i < view->nverts; i++)
        for (uint32_t c = 0; c < 3; c++) {
            const float *at = view->positions + 3 * (size_t)i;
            out[3 * i + c] = at[c] + 0.1f * sinf(3 * at[(c + 1) % 3] + time + (float)c);
        }
}

static slv_mesh *moved_mesh(const slv_mesh *mesh, const float *positions) {
    slv_env env = test_env();
    slv_mesh_view view = *slv_mesh_get_view(mesh);
    slv_mesh *made;
    view.positions = positions;
    MUST(slv_mesh_create(&env, &view, &made));
    return made;
}

static bool same_surface(const slv_surface *a, const slv_surface *b) {
    enum { N = 3, POINTS = (N + 1) * (N + 1) };
    uint32_t nfaces = slv_surface_face_count(a);
    bool same = nfaces == slv_surface_face_count(b);
    for (uint32_t f = 0; f < nfaces && same; f++) {
        static float values[2][4][3 * POINTS];
        for (int k = 0; k < 2; k++) {
            const slv_surface_arrays arrays = {values[k][0], values[k][1], values[k][2],
                                               values[k][3]};
            MUST(slv_surface_evaluate_grid(k ? b : a, (int32_t)f, N, N, &arrays));
        }
        same = memcmp(values[0], values[1], sizeof values[0]) == 0;
    }
    return same;
}

/* Their vertices: faces divided alike, and each as a picture needs it. */
static bool same_vertices(const slv_mesh *mesh, const slv_surface *a, const slv_surface *b) {
    slv_env env = test_env();
    slv_camera camera;
    slv_adjacency *adjacency;
    bool same = true;
    MUST(slv_mesh_adjacency(&env, mesh, &adjacency));
    for (uint32_t segments = 0; segments <= 4; segments += 2) {
        slv_tessellation t[2];
        slv_tessellation_params params = {.segments = segments};
        if (!segments) {
            const float low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
            camera = slv_camera_orbit(low, high, 30, 20, 40, 1);
            params = (slv_tessellation_params){
                .camera = &camera, .width = 64, .height = 64, .pixels = 4};
        }
        MUST(slv_tessellate_with(&env, mesh, a, adjacency, &params, &t[0]));
        MUST(slv_tessellate_with(&env, mesh, b, adjacency, &params, &t[1]));
        uint32_t count = t[0].first[t[0].nfaces];
        same = same && count == t[1].first[t[1].nfaces] &&
               memcmp(t[0].vertices, t[1].vertices, count * sizeof *t[0].vertices) == 0 &&
               memcmp(t[0].segments, t[1].segments, t[0].nfaces * sizeof *t[0].segments) == 0;
        slv_tessellation_free(&t[0]);
        slv_tessellation_free(&t[1]);
    }
    slv_adjacency_destroy(adjacency);
    return same;
}

static void try_mesh(const char *name, const slv_mesh *mesh, slv_scheme scheme) {
    slv_env env = test_env();
    slv_surface_params params = {.scheme = scheme, .moves = true}, plain = {.scheme = scheme};
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    slv_surface *surface, *afresh;
    float *positions = shape_grow(NULL, 3 * (size_t)view->nverts, sizeof *positions);
    if (slv_surface_create(&env, mesh, &params, &surface)) {
        free(positions);
        return; /* Loop of quads */
    }
    for (int step = 1; step < 3; step++) {
        sway(view, (float)step, positions);
        slv_mesh *other = moved_mesh(mesh, positions);
        MUST(slv_surface_create(&env, other, &plain, &afresh));
        CHECK(!same_surface(surface, afresh));
        MUST(slv_surface_move(surface, view->nverts, positions));
        CHECK_MSG(same_surface(surface, afresh), "%s, %s: other values when moved", name,
                  slv_scheme_name(scheme));
        CHECK_MSG(same_vertices(mesh, surface, afresh), "%s, %s: other vertices when moved", name,
                  slv_scheme_name(scheme));
        slv_surface_destroy(afresh);
        slv_mesh_destroy(other);
    }
    CHECK(slv_surface_move(surface, view->nverts - 1, positions) == SLV_ERROR_ARGUMENT);
    positions[3 * view->nverts - 1] = INFINITY;
    MUST(slv_surface_create(&env, mesh, &plain, &afresh));
    MUST(slv_surface_move(surface, view->nverts, view->positions));
    CHECK(slv_surface_move(surface, view->nverts, positions) == SLV_ERROR_ARGUMENT);
    CHECK(same_surface(surface, afresh));
    CHECK(slv_surface_move(afresh, view->nverts, view->positions) == SLV_ERROR_ARGUMENT);
    slv_surface_destroy(afresh);
    slv_surface_destroy(surface);
    free(positions);
}

static void shapes(void) {
    static const struct {
        int nx, ny;
        bool roll_x, roll_y;
    } grids[] = {{4, 3, false, false}, {5, 4, true, false}, {6, 5, true, true}};
    slv_env env = test_env();
    for (size_t i = 0; i < sizeof grids / sizeof *grids; i++) {
        shape s = shape_grid(grids[i].nx, grids[i].ny, grids[i].roll_x, grids[i].roll_y);
        static const int32_t crease[] = {0, 1, 1, 2}, corner[] = {0};
        static const float sharp[] = {1.5f, 10}, corner_sharp[] = {10};
        /* a triangle and a pentagon on an edge that has two polygons: not manifold */
        int32_t tip = shape_vertex(&s, 0, 2, 1), other = shape_vertex(&s, 1, 2, 2);
        shape_polygon(&s, 3, (int32_t[]){0, 1, tip});
        shape_polygon(&s, 5, (int32_t[]){2, 1, 0, tip, other});
        slv_mesh_view view = {.nverts = s.nverts,
                              .positions = s.positions,
                              .npolys = s.npolys,
                              .poly_sizes = s.sizes,
                              .poly_verts = s.verts,
                              .ncreases = 2,
                              .crease_verts = crease,
                              .crease_sharpness = sharp,
                              .ncorners = 1,
                              .corner_verts = corner,
                              .corner_sharpness = corner_sharp};
        slv_mesh *mesh;
        MUST(slv_mesh_create(&env, &view, &mesh));
        try_mesh("grid", mesh, SLV_SCHEME_CATMARK);
        try_mesh("grid", mesh, SLV_SCHEME_BILINEAR);
        slv_mesh_destroy(mesh);
        shape_clear(&s);
    }
    static const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const int32_t sizes[] = {3, 3, 3, 3}, verts[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    const slv_mesh_view view = {
        .nverts = 4, .positions = corners, .npolys = 4, .poly_sizes = sizes, .poly_verts = verts};
    slv_mesh *mesh;
    MUST(slv_mesh_create(&env, &view, &mesh));
    try_mesh("tetrahedron", mesh, SLV_SCHEME_LOOP);
    try_mesh("tetrahedron", mesh, SLV_SCHEME_CATMARK);
    slv_mesh_destroy(mesh);
}

static size_t held(void) {
    struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
}

static void note_held(void *user, slv_log_level level, const char *message) {
    (void)message;
    if (level == SLV_LOG_ERROR)
        *(size_t *)user = held();
}

/* What is more than allowed is refused before it is there. */
static void within(const slv_mesh *mesh) {
    const slv_surface_params params = {.moves = true};
    slv_env env = test_env(), small = env;
    size_t before = held(), when_refused = 0;
    slv_surface *surface = NULL;
    MUST(slv_surface_create(&env, mesh, &params, &surface));
    const size_t whole = held() - before;
    slv_surface_destroy(surface);
    surface = NULL;
    before = held();
    small.max_bytes = 1 << 20;
    small.log = note_held;
    small.log_user = &when_refused;
    CHECK(slv_surface_create(&small, mesh, &params, &surface) == SLV_ERROR_LIMIT && !surface);
    if (!TEST_SANITIZED)
        CHECK_MSG(when_refused > 0 && when_refused - before < whole / 2,
                  "%zu bytes were there when refused, of %zu", when_refused - before, whole);
}

/* Two fans back to back: so many polygons around a vertex that their weights are not kept. */
static void crowded(void) {
    enum { AROUND = 210 };
    slv_env env = test_env();
    shape s = {0};
    slv_mesh *mesh;
    for (int i = 0; i < AROUND; i++) {
        float a = 6.2831853f * (float)i / AROUND;
        shape_vertex(&s, cosf(a), 0, sinf(a));
    }
    const int32_t top = shape_vertex(&s, 0, 1, 0), bottom = shape_vertex(&s, 0, -1, 0);
    for (int32_t i = 0; i < AROUND; i++) {
        shape_polygon(&s, 3, (int32_t[]){(i + 1) % AROUND, i, top});
        shape_polygon(&s, 3, (int32_t[]){i, (i + 1) % AROUND, bottom});
    }
    const slv_mesh_view view = {.nverts = s.nverts,
                                .positions = s.positions,
                                .npolys = s.npolys,
                                .poly_sizes = s.sizes,
                                .poly_verts = s.verts};
    MUST(slv_mesh_create(&env, &view, &mesh));
    try_mesh("fans", mesh, SLV_SCHEME_CATMARK);
    within(mesh);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
}

/* OpenSubdiv's own shapes, all kinds of tags and corners. */
static void shapes_of_others(const char *folder) {
    slv_env env = test_env();
    char path[600];
    snprintf(path, sizeof path, "%s/osd", folder);
    DIR *dir = opendir(path);
    uint32_t count = 0;
    for (struct dirent *entry; dir && (entry = readdir(dir));) {
        slv_mesh *mesh;
        if (!strstr(entry->d_name, ".obj"))
            continue;
        snprintf(path, sizeof path, "%s/osd/%s", folder, entry->d_name);
        MUST(slv_mesh_load(&env, path, &mesh));
        try_mesh(entry->d_name, mesh,
                 strncmp(entry->d_name, "loop", 4) ? SLV_SCHEME_CATMARK : SLV_SCHEME_LOOP);
        slv_mesh_destroy(mesh);
        count++;
    }
    if (dir)
        closedir(dir);
    CHECK(count > 30);
}

/* Frame after frame, what is allocated stays the same. */
static void many_frames(void) {
    slv_env env = test_env();
    shape s = shape_grid(12, 10, true, false);
    slv_mesh_view view = {.nverts = s.nverts,
                          .positions = s.positions,
                          .npolys = s.npolys,
                          .poly_sizes = s.sizes,
                          .poly_verts = s.verts};
    const slv_surface_params params = {.moves = true};
    slv_mesh *mesh;
    slv_surface *surface;
    slv_adjacency *adjacency;
    float *positions = shape_grow(NULL, 3 * (size_t)s.nverts, sizeof *positions);
    size_t before = 0;
    MUST(slv_mesh_create(&env, &view, &mesh));
    MUST(slv_mesh_adjacency(&env, mesh, &adjacency));
    MUST(slv_surface_create(&env, mesh, &params, &surface));
    for (int frame = 0; frame < 110; frame++) {
        slv_tessellation t;
        sway(&view, (float)frame * 0.1f, positions);
        MUST(slv_surface_move(surface, s.nverts, positions));
        MUST(slv_tessellate(&env, mesh, surface, adjacency, 4, &t));
        slv_tessellation_free(&t);
        if (frame == 9)
            before = mallinfo2().uordblks;
    }
    if (!TEST_SANITIZED)
        CHECK_MSG(mallinfo2().uordblks <= before + 4096, "%zu bytes became %zu", before,
                  mallinfo2().uordblks);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    free(positions);
    shape_clear(&s);
}

int main(void) {
    const char *meshes = getenv("SELVAGE_MESHES");
    shapes();
    crowded();
    if (meshes && *meshes)
        shapes_of_others(meshes);
    many_frames();
    return test_end();
}
