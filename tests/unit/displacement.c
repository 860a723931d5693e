/* Displaced surfaces: they move by what was said, stay closed to the bit whatever the resolutions,
 * and their normals are those of what they became. */
#include "kit/displace_kit.h"

static slv_tessellation tessellate(const displaced *d, uint32_t segments) {
    const slv_tessellation_params params = {.segments = segments, .displacement = &d->displacement};
    slv_env env = test_env();
    slv_tessellation t;
    MUST(slv_tessellate_with(&env, d->mesh, d->surface, d->adjacency, &params, &t));
    return t;
}

/* The vertex of a face at (u,v). */
static const slv_vertex *vertex_at(const slv_tessellation *t, int32_t face, float u, float v) {
    uint32_t n = t->segments[face];
    return t->vertices + t->first[face] + (uint32_t)lrintf(v * (float)n) * (n + 1) +
           (uint32_t)lrintf(u * (float)n);
}

/* Points of an edge have one normal from both sides, but where the limit has two. */
static void check_normals(const displaced *d, const slv_tessellation *t,
                          const slv_tessellation *limit) {
    for (uint32_t f = 0; f < t->nfaces; f++)
        for (unsigned e = 0; e < 4; e++) {
            slv_neighbour other[2];
            uint32_t n = t->segments[f],
                     count = slv_adjacency_neighbours(d->adjacency, (int32_t)f, e, other);
            for (uint32_t i = 0; i < count; i++)
                for (uint32_t k = 0; k <= n; k++) {
                    float at = (float)k / (float)n, u = e == 1, v = e == 2, ou, ov;
                    *(e & 1 ? &v : &u) = e < 2 ? at : 1 - at;
                    if (at < other[i].t0 || at > other[i].t1)
                        continue;
                    slv_affine_apply(&other[i].map, u, v, &ou, &ov);
                    const slv_vertex *a = vertex_at(t, (int32_t)f, u, v),
                                     *b = vertex_at(t, other[i].face, ou, ov);
                    const float *na = vertex_at(limit, (int32_t)f, u, v)->normal,
                                *nb = vertex_at(limit, other[i].face, ou, ov)->normal;
                    float apart = 0, length = 0;
                    CHECK(memcmp(a->position, b->position, sizeof a->position) == 0);
                    for (int c = 0; c < 3; c++) {
                        apart = fmaxf(apart, fabsf(na[c] - nb[c]));
                        length += a->normal[c] * a->normal[c];
                    }
                    CHECK(fabsf(length - 1) < 1e-5f);
                    if (apart < 1e-4f && k > 0 && k < n)
                        CHECK_MSG(memcmp(a->normal, b->normal, sizeof a->normal) == 0,
                                  "face %u edge %u point %u of %u", f, e, k, n);
                }
        }
}

static void check_closed(void) {
    uint64_t random = 5;
    for (uint32_t i = 0; i < test_effort(2 * SHAPE_KINDS); i++) {
        slv_env env = test_env();
        shape s = shape_random((int)(i % SHAPE_KINDS), &random);
        const slv_filter_params filter = {.filter = (slv_filter)(i % SLV_FILTER_COUNT),
                                          .no_edge_blend = i & 1};
        const slv_displacement_params params = {.space = (slv_displacement_space)(i / 2 % 3),
                                                .scale = 0.2f,
                                                .filter = i % 5 ? &filter : NULL};
        displaced d =
            displaced_make(shape_mesh(NULL, &s), (slv_scheme)(i / 3 % 2), 4, &params, &random);
        for (uint32_t segments = 2; segments <= 16; segments *= 2) {
            slv_tessellation t = tessellate(&d, segments), limit;
            MUST(slv_tessellate(&env, d.mesh, d.surface, d.adjacency, segments, &limit));
            uint32_t open = displaced_open_sides(&t), boundary = displaced_boundary(&d, &t);
            CHECK_MSG(open == boundary, "shape %u, %u segments: %u open sides, %u of a boundary", i,
                      segments, open, boundary);
            check_normals(&d, &t, &limit);
            slv_tessellation_free(&t);
            slv_tessellation_free(&limit);
        }
        shape_clear(&s);
        displaced_free(&d);
    }
}

/* Pixels of a point of the mesh. */
static void project(const slv_tessellation_params *p, const float at[3], float out[2]) {
    const float *m = p->camera->world_to_camera, *w = p->camera->window;
    float eye[3];
    for (int r = 0; r < 3; r++)
        eye[r] = m[4 * r] * at[0] + m[4 * r + 1] * at[1] + m[4 * r + 2] * at[2] + m[4 * r + 3];
    out[0] = eye[0] / -eye[2] * (float)p->width / (w[1] - w[0]);
    out[1] = eye[1] / -eye[2] * (float)p->height / (w[3] - w[2]);
}

/* The middles of cells are no pixel from where the limit has them. */
static void check_error(const displaced *d, const slv_tessellation_params *p,
                        const slv_tessellation *t) {
    float worst = 0;
    for (uint32_t f = 0; f < t->nfaces; f++) {
        uint32_t n = t->segments[f];
        const slv_vertex *v = t->vertices + t->first[f];
        for (uint32_t i = 0; n > 2 && i < (n - 2) * (n - 2); i++) {
            uint32_t x = 1 + i % (n - 2), y = 1 + i / (n - 2);
            const slv_vertex *a = v + y * (n + 1) + x, *b = a + n + 2;
            const slv_surface_point point = {(int32_t)f, ((float)x + 0.5f) / (float)n,
                                             ((float)y + 0.5f) / (float)n};
            float limit[3], here[2], there[2], middle[3];
            const slv_surface_arrays arrays = {.positions = limit};
            MUST(slv_surface_evaluate(d->surface, 1, &point, &arrays));
            for (int c = 0; c < 3; c++)
                middle[c] = 0.5f * (a->position[c] + b->position[c]);
            project(p, limit, here);
            project(p, middle, there);
            worst = fmaxf(worst, hypotf(here[0] - there[0], here[1] - there[1]));
        }
    }
    CHECK_MSG(worst < 1, "%g pixels", (double)worst);
}

/* Face by face: closed, and neighbours do differ. */
static void check_rates(void) {
    uint64_t random = 9;
    uint32_t differ = 0;
    for (uint32_t i = 0; i < test_effort(SHAPE_KINDS + 1); i++) {
        slv_env env = test_env();
        shape s = shape_random((int)(i % SHAPE_KINDS), &random);
        const slv_displacement_params moved = {.scale = 0.1f};
        displaced d = displaced_make(shape_mesh(NULL, &s), SLV_SCHEME_CATMARK, 5, &moved, &random);
        slv_mesh_stats stats;
        MUST(slv_mesh_get_stats(&env, d.mesh, &stats));
        for (uint32_t k = 0; k < 3; k++) {
            slv_camera camera =
                slv_camera_orbit(stats.bounds_min, stats.bounds_max,
                                 (float)(test_random(&random) % 360), 20, k ? 40 : 0, 1);
            for (int side = 0; side < 4 && k == 1; side++)
                camera.window[side] = 0.3f * camera.window[side] + (side < 2 ? 0.1f : 0);
            const slv_tessellation_params params = {.displacement = i & 1 ? &d.displacement : NULL,
                                                    .camera = &camera,
                                                    .width = 16u << (k + k / 2),
                                                    .height = 16u << (k + k / 2)};
            slv_tessellation t;
            MUST(slv_tessellate_with(&env, d.mesh, d.surface, d.adjacency, &params, &t));
            uint32_t open = displaced_open_sides(&t), boundary = displaced_boundary(&d, &t);
            CHECK_MSG(open == boundary, "shape %u: %u open sides, %u of a boundary", i, open,
                      boundary);
            for (uint32_t f = 0; f < 4 * t.nfaces; f++)
                differ += t.edges[f] != t.segments[f / 4];
            if (!params.displacement && camera.perspective)
                check_error(&d, &params, &t);
            slv_tessellation_free(&t);
        }
        shape_clear(&s);
        displaced_free(&d);
    }
    CHECK(differ > (test_brief() ? 30 : 100));
}

/* A picture of few pixels needs few triangles, however many faces there are; a large one more, but
 * not where nothing is seen. */
static void check_size(void) {
    slv_env env = test_env();
    shape s = shape_grid(40, 40, true, true);
    uint64_t random = 1;
    displaced d = displaced_make(shape_mesh(NULL, &s), SLV_SCHEME_CATMARK, 0, NULL, &random);
    const float low[3] = {-4, -4, -1}, high[3] = {4, 4, 1};
    slv_camera camera = slv_camera_orbit(low, high, 30, 30, 30, 1);
    slv_tessellation_params params = {.camera = &camera, .width = 8, .height = 8};
    slv_tessellation t;
    uint64_t count[3];
    for (int k = 0; k < 3; k++) {
        if (k)
            params.width = params.height = 8192;
        for (int side = 0; side < 4 && k == 2; side++)
            camera.window[side] = 0.01f * camera.window[side];
        params.width = params.height = k ? 2048 : 8;
        MUST(slv_tessellate_with(&env, d.mesh, d.surface, d.adjacency, &params, &t));
        count[k] = t.first[t.nfaces];
        slv_tessellation_free(&t);
    }
    CHECK(count[0] == 4 * 1600);
    CHECK_MSG(count[1] > 16 * 1600 && count[2] < count[1] / 2, "%u, and %u of a part",
              (uint32_t)count[1], (uint32_t)count[2]);
    const slv_tessellation_params bad[] = {{.width = 8, .height = 8},
                                           {.camera = &camera, .width = 8},
                                           {.segments = 3},
                                           {.segments = 256}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        CHECK(slv_tessellate_with(&env, d.mesh, d.surface, d.adjacency, &bad[i], &t) ==
              SLV_ERROR_ARGUMENT);
    shape_clear(&s);
    displaced_free(&d);
}

static uint32_t count_triangles(const slv_tessellation *t) {
    uint32_t count = 0;
    for (uint32_t f = 0; f < t->nfaces; f++)
        count += slv_tessellation_indices(t, f, NULL) / 3;
    return count;
}

/* Many faces on few pixels: a surface as closed as it was, of as many triangles as there are
 * pixels, none of whose vertices moved by more than one of them; displaced or not, and where some
 * faces are larger than pixels. */
static void check_many(void) {
    const float low[3] = {-4, -4, -1}, high[3] = {4, 4, 1};
    slv_env env = test_env();
    uint64_t random = 3;
    for (uint32_t i = 0; i < 6; i++) {
        shape s = shape_grid(i < 4 ? 100 : 8, i < 4 ? 60 : 500, true, true);
        const slv_displacement_params moved = {.scale = 0.05f};
        displaced d = displaced_make(shape_mesh(NULL, &s), SLV_SCHEME_CATMARK, 0, &moved, &random);
        const slv_camera camera = slv_camera_orbit(low, high, 30, 40, i & 2 ? 0 : 30, 1);
        const slv_tessellation_params params = {.displacement = i & 1 ? &d.displacement : NULL,
                                                .camera = &camera,
                                                .width = 24,
                                                .height = 24},
                                      even = {.segments = 2, .displacement = params.displacement};
        slv_tessellation t, whole;
        MUST(slv_tessellate_with(&env, d.mesh, d.surface, d.adjacency, &params, &t));
        MUST(slv_tessellate_with(&env, d.mesh, d.surface, d.adjacency, &even, &whole));
        uint32_t triangles = count_triangles(&t);
        CHECK_MSG(displaced_open_sides(&t) == 0, "%u: %u open sides", i, displaced_open_sides(&t));
        if (i < 4) /* others have long faces */
            CHECK_MSG(triangles > 200 && triangles < 10 * 24 * 24, "%u: %u triangles", i,
                      triangles);
        for (uint32_t f = 0; f < t.nfaces && !params.displacement && camera.perspective; f++)
            for (uint32_t k = 0; k < 4; k++) {
                const slv_vertex *a = t.vertices + t.first[f] + k,
                                 *b = vertex_at(&whole, (int32_t)f, (float)(k & 1), (float)(k / 2));
                float here[2], there[2];
                if (t.segments[f] != 1)
                    continue;
                project(&params, a->position, here);
                project(&params, b->position, there);
                CHECK(hypotf(here[0] - there[0], here[1] - there[1]) < 1);
            }
        slv_tessellation_free(&t);
        slv_tessellation_free(&whole);
        shape_clear(&s);
        displaced_free(&d);
    }
}

/* z = f(u,v) of one flat square, and vectors. */
typedef struct formula {
    slv_displacement_space space;
    float constant[3];
} formula;

static slv_result evaluate(void *user, int32_t face, float spacing, size_t count, const float *uv,
                           float *out) {
    const formula *f = user;
    (void)face, (void)spacing;
    for (size_t i = 0; i < count; i++) {
        if (f->space)
            memcpy(out + 3 * i, f->constant, sizeof f->constant);
        else
            out[i] = 0.1f * sinf(5 * uv[2 * i]) + 0.05f * cosf(7 * uv[2 * i + 1]);
    }
    return SLV_OK;
}

static void check_formula(slv_displacement_space space, const float constant[3],
                          const float moved[3]) {
    /* u runs along y, v against x */
    static const float positions[12] = {0, 0, 0, 0, 2, 0, -2, 2, 0, -2, 0, 0};
    static const int32_t size = 4, verts[4] = {0, 1, 2, 3};
    const slv_mesh_view view = {
        .nverts = 4, .positions = positions, .npolys = 1, .poly_sizes = &size, .poly_verts = verts};
    const slv_surface_params bilinear = {.scheme = SLV_SCHEME_BILINEAR};
    formula f = {.space = space};
    const slv_displacement displacement = {.space = space, .evaluate = evaluate, .user = &f};
    const slv_tessellation_params params = {.segments = 128, .displacement = &displacement};
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    slv_tessellation t;
    memcpy(f.constant, constant, sizeof f.constant);
    MUST(slv_mesh_create(NULL, &view, &mesh));
    MUST(slv_mesh_adjacency(NULL, mesh, &adjacency));
    MUST(slv_surface_create(NULL, mesh, &bilinear, &surface));
    MUST(slv_tessellate_with(NULL, mesh, surface, adjacency, &params, &t));
    for (uint32_t i = 0; i < 129 * 129; i++) {
        const slv_vertex *p = t.vertices + i;
        float u = (float)(i % 129) / 128, v = (float)(i / 129) / 128;
        float height = space ? moved[2] : 0.1f * sinf(5 * u) + 0.05f * cosf(7 * v);
        float slope_y = space ? 0 : 0.25f * cosf(5 * u), slope_x = space ? 0 : 0.175f * sinf(7 * v);
        float length = sqrtf(1 + slope_x * slope_x + slope_y * slope_y);
        CHECK(fabsf(p->position[0] - (-2 * v + moved[0])) < 1e-5f &&
              fabsf(p->position[1] - (2 * u + moved[1])) < 1e-5f &&
              fabsf(p->position[2] - height) < 1e-5f);
        /* one-sided at the boundary */
        CHECK_MSG(fabsf(p->normal[0] + slope_x / length) < 0.01f &&
                      fabsf(p->normal[1] + slope_y / length) < 0.01f &&
                      fabsf(p->normal[2] - 1 / length) < 0.01f,
                  "at %g %g: %g %g %g", (double)u, (double)v, (double)p->normal[0],
                  (double)p->normal[1], (double)p->normal[2]);
    }
    slv_tessellation_free(&t);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
}

/* Of a texture that is one value everywhere: scale, bias and channel. */
static void check_constant(void) {
    uint64_t random = 1;
    shape s = shape_cube();
    const slv_displacement_params params = {.channel = 2, .scale = 0.5f, .bias = -0.25f};
    displaced d = displaced_make(shape_mesh(NULL, &s), SLV_SCHEME_CATMARK, 0, &params, &random);
    slv_tessellation limit;
    static const float value[3] = {9, 9, 0.75f};
    for (uint32_t f = 0; f < 6; f++)
        MUST(slv_texture_set_constant(d.texture, f, value));
    MUST(slv_cache_refresh(d.cache, 0));
    slv_tessellation t = tessellate(&d, 8);
    MUST(slv_tessellate(NULL, d.mesh, d.surface, d.adjacency, 8, &limit));
    for (uint32_t i = 0; i < t.first[t.nfaces]; i++)
        for (int c = 0; c < 3; c++) {
            const slv_vertex *a = t.vertices + i, *b = limit.vertices + i;
            CHECK(fabsf(a->position[c] - b->position[c] - 0.25f * b->normal[c]) < 1e-5f);
            CHECK(fabsf(a->normal[c] - b->normal[c]) < 0.05f);
        }
    slv_tessellation_free(&t);
    slv_tessellation_free(&limit);
    shape_clear(&s);
    displaced_free(&d);
}

static slv_result wave(void *user, int32_t face, float spacing, size_t count, const float *uv,
                       float *out) {
    (void)user;
    (void)face;
    (void)spacing;
    for (size_t i = 0; i < count; i++)
        out[i] = 0.1f * sinf(6.2831853f * uv[2 * i]) + 0.05f * uv[2 * i + 1];
    return SLV_OK;
}

/* Slopes are those of half a segment to both sides of a point: of a wave of eight segments all but
 * 2.6 % is there, where from neighbour to neighbour a tenth would be missing. */
static void check_slopes(void) {
    slv_env env = test_env();
    shape s = {0};
    for (int k = 0; k < 4; k++)
        shape_vertex(&s, k == 1 || k == 2, k > 1, 0);
    shape_polygon(&s, 4, (const int32_t[]){0, 1, 2, 3});
    slv_mesh *mesh = shape_mesh(NULL, &s);
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    slv_tessellation t;
    const slv_surface_params bilinear = {.scheme = SLV_SCHEME_BILINEAR};
    const slv_displacement moved = {.space = SLV_DISPLACE_NORMAL, .evaluate = wave};
    const slv_tessellation_params params = {.segments = 8, .displacement = &moved};
    MUST(slv_mesh_adjacency(&env, mesh, &adjacency));
    MUST(slv_surface_create(&env, mesh, &bilinear, &surface));
    MUST(slv_tessellate_with(&env, mesh, surface, adjacency, &params, &t));
    for (int i = 1; i < 8; i++) {
        const float *normal = vertex_at(&t, 0, (float)i / 8, 0.5f)->normal;
        float expected = 0.62831853f * cosf(6.2831853f * (float)i / 8),
              slope = -normal[0] / normal[2];
        CHECK_MSG(fabsf(slope - expected) < 0.03f * fabsf(expected) + 1e-4f,
                  "point %d: slope %g, not %g", i, (double)slope, (double)expected);
        CHECK(fabsf(normal[1] / normal[2] + 0.05f) < 1e-4f);
    }
    slv_tessellation_free(&t);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    shape_clear(&s);
}

static void check_refused(void) {
    uint64_t random = 1;
    shape s = shape_cube();
    displaced d = displaced_make(shape_mesh(NULL, &s), SLV_SCHEME_CATMARK, 1, NULL, &random);
    slv_displacement other;
    slv_source source;
    slv_file_id file;
    const slv_displacement_params bad[] = {{.channel = 3},
                                           {.space = SLV_DISPLACE_OBJECT, .channel = 1},
                                           {.scale = INFINITY},
                                           {.bias = NAN},
                                           {.space = (slv_displacement_space)3}};
    MUST(slv_texture_as_source(NULL, d.texture, d.adjacency, NULL, &source));
    MUST(slv_cache_open_source(d.cache, &source, NULL, &file));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        CHECK(slv_displacement_open(d.cache, file, &bad[i], &other) == SLV_ERROR_ARGUMENT);
    CHECK(slv_displacement_open(d.cache, file + 1, NULL, &other) == SLV_ERROR_ARGUMENT);
    const slv_displacement_params far_away = {.scale = 1e30f};
    MUST(slv_displacement_open(d.cache, file, &far_away, &other));
    const slv_tessellation_params params = {.segments = 2, .displacement = &other};
    slv_env env = test_env();
    slv_tessellation t;
    CHECK(slv_tessellate_with(&env, d.mesh, d.surface, d.adjacency, &params, &t) ==
          SLV_ERROR_LIMIT);
    CHECK(strstr(test_last_log, "out of reach"));
    slv_displacement_close(&other);
    shape_clear(&s);
    displaced_free(&d);
}

int main(void) {
    static const float none[3], vector[3] = {0.3f, -0.2f, 0.1f};
    check_closed();
    check_rates();
    check_size();
    check_many();
    check_formula(SLV_DISPLACE_NORMAL, none, none);
    check_formula(SLV_DISPLACE_OBJECT, vector, vector);
    check_formula(SLV_DISPLACE_TANGENT, vector, (const float[]){0.2f, 0.3f, 0.1f});
    check_constant();
    check_slopes();
    check_refused();
    return test_end();
}
