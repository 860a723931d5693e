/* A mesh of more faces than 16 bits count: the strategies must agree on what is seen from afar. */
#include "kit/strategy_kit.h"
#include "kit/test.h"

#include <selvage/bake.h>
#include <selvage/gl_renderer.h>

#include <time.h>

#ifdef __SANITIZE_ADDRESS__
enum { AROUND = 128, THROUGH = 96 };
#else
enum { AROUND = 288, THROUGH = 240 };
#endif
enum { NFACES = AROUND * THROUGH, SIZE = 256, NPIXELS = SIZE * SIZE };

static const float pi = 3.14159265f;

/* Coarser on the inside of the ring and with oblong texels in places, so that every kind of
 * neighbourhood occurs. */
static slv_res face_resolution(uint32_t i, uint32_t j) {
    static const slv_res kinds[] = {{3, 3}, {2, 2}, {4, 3}, {3, 4}, {4, 4},
                                    {1, 3}, {2, 1}, {0, 0}, {5, 5}};
    uint32_t patch = i / 16 * 7 + j / 12 * 3;
    return kinds[patch % (sizeof kinds / sizeof *kinds)];
}

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + (double)time.tv_nsec * 1e-9;
}

static double step_started;

static void step(const char *name) {
    double time = now();
    fprintf(stderr, "%-28s %7.3f s\n", name, time - step_started);
    step_started = now();
}

/* A torus bent out of its plane, with waves on it. */
static slv_mesh *make_mesh(void) {
    slv_env env = test_env();
    float *positions = malloc(sizeof *positions * 3 * NFACES);
    int32_t *sizes = malloc(sizeof *sizes * NFACES), *verts = malloc(sizeof *verts * 4 * NFACES);
    slv_mesh *mesh = NULL;
    REQUIRE(positions && sizes && verts);
    for (int32_t j = 0; j < THROUGH; j++) {
        for (int32_t i = 0; i < AROUND; i++) {
            int32_t at = j * AROUND + i, i1 = (i + 1) % AROUND, j1 = (j + 1) % THROUGH;
            float a = 2 * pi * (float)i / AROUND, b = 2 * pi * (float)j / THROUGH;
            float thick = 0.4f + 0.05f * sinf(9 * a + 2 * b), radius = 1 + thick * cosf(b);
            positions[3 * at] = radius * cosf(a);
            positions[3 * at + 1] = thick * sinf(b) + 0.2f * sinf(3 * a);
            positions[3 * at + 2] = -radius * sinf(a);
            sizes[at] = 4;
            verts[4 * at] = at;
            verts[4 * at + 1] = j * AROUND + i1;
            verts[4 * at + 2] = j1 * AROUND + i1;
            verts[4 * at + 3] = j1 * AROUND + i;
        }
    }
    slv_mesh_view view = {.nverts = NFACES,
                          .positions = positions,
                          .npolys = NFACES,
                          .poly_sizes = sizes,
                          .poly_verts = verts};
    REQUIRE(slv_mesh_create(&env, &view, &mesh) == SLV_OK);
    free(positions);
    free(sizes);
    free(verts);
    return mesh;
}

static slv_texture *make_texture(const slv_surface *surface) {
    slv_env env = test_env();
    slv_res *res = malloc(sizeof *res * NFACES);
    slv_texture *texture = NULL;
    slv_texture_desc desc = {NFACES, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res, SLV_TEXTURE_LINEAR};
    slv_procedural bands = {.pattern = SLV_PATTERN_STRIPES,
                            .frequency = 2,
                            .color0 = {0.9f, 0.3f, 0.1f, 1},
                            .color1 = {0.1f, 0.4f, 0.8f, 1}};
    REQUIRE(res);
    for (uint32_t f = 0; f < NFACES; f++)
        res[f] = face_resolution(f % AROUND, f / AROUND);
    REQUIRE(slv_texture_create(&env, &desc, &texture) == SLV_OK);
    REQUIRE(slv_bake_procedural(&env, surface, &bands, NULL, texture) == SLV_OK);
    free(res);
    return texture;
}

static void check_picture(const slv_image *image, const char *name) {
    uint32_t covered = 0;
    float low = INFINITY, high = -INFINITY;
    for (uint32_t i = 0; i < NPIXELS; i++) {
        const float *pixel = image->pixels + 4 * (size_t)i;
        bool good =
            isfinite(pixel[0]) && isfinite(pixel[1]) && isfinite(pixel[2]) && isfinite(pixel[3]);
        CHECK_MSG(good, "%s: pixel %u is not finite", name, i);
        if (pixel[3] < 0.999f)
            continue;
        covered++;
        low = fminf(low, pixel[0]);
        high = fmaxf(high, pixel[0]);
    }
    fprintf(stderr, "%s: %u pixels covered, red from %.3f to %.3f\n", name, covered, (double)low,
            (double)high);
    CHECK(covered > NPIXELS / 5 && covered < NPIXELS);
    CHECK(low >= 0 && high <= 1 && high - low > 0.3f);
}

static void check_agreement(const slv_image *a, const slv_image *b, const char *name) {
    double sum = 0;
    float largest = 0;
    uint32_t covered = 0;
    for (uint32_t i = 0; i < NPIXELS; i++) {
        const float *one = a->pixels + 4 * (size_t)i, *other = b->pixels + 4 * (size_t)i;
        CHECK(fabsf(one[3] - other[3]) < 1e-3f);
        if (one[3] < 0.999f)
            continue;
        covered++;
        for (int c = 0; c < 3; c++) {
            sum += (double)fabsf(one[c] - other[c]) / 3;
            largest = fmaxf(largest, fabsf(one[c] - other[c]));
        }
    }
    fprintf(stderr, "%s differs from clamp by %.4f on average, %.4f at most\n", name, sum / covered,
            (double)largest);
    CHECK_MSG(sum / covered < 0.01, "%s differs from clamp by %g on average", name, sum / covered);
    /* faces are smaller than pixels here, and a footprint that misses its face altogether would be
     * black */
    CHECK_MSG(largest < 0.08f, "%s differs from clamp by %g at a pixel", name, (double)largest);
}

int main(void) {
    slv_env env = test_env();
    slv_mesh_stats stats;
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    slv_gl *gl = NULL;
    slv_gl_renderer *renderer = NULL;
    slv_image first = {0};
    double start = now();
    step_started = start;
    slv_mesh *mesh = make_mesh();
    REQUIRE(slv_mesh_get_stats(&env, mesh, &stats) == SLV_OK);
    CHECK(stats.nfaces == NFACES && stats.nboundary_edges == 0 && stats.nextraordinary == 0);
    step("mesh");
    REQUIRE(slv_mesh_adjacency(&env, mesh, &adjacency) == SLV_OK);
    step("adjacency");
    REQUIRE(slv_surface_create(&env, mesh, NULL, &surface) == SLV_OK);
    step("surface");
    slv_texture *texture = make_texture(surface);
    step("baking");
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    step("context");
    REQUIRE(slv_gl_renderer_create(gl, &env, mesh, surface, 2, &renderer) == SLV_OK);
    step("tessellation");
    slv_frame frame = {.width = SIZE,
                       .height = SIZE,
                       .msaa = 4,
                       .camera =
                           slv_camera_orbit(stats.bounds_min, stats.bounds_max, 30, 40, 35, 1)};
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        const slv_strategy *strategy = slv_strategy_at(s);
        const char *name = strategy->name;
        if (strategy->resampled || strategy->comparison || test_skip(s, 2))
            continue; /* other texels take other limits, and a plain form the same as its own */
        slv_gl_texture_params params = {KIT_ONLY(strategy), .anisotropy = 4};
        slv_gl_texture *uploaded = NULL;
        slv_image image = {0};
        REQUIRE(slv_gl_texture_create(gl, &env, texture, adjacency, &params, &uploaded) == SLV_OK);
        step("upload");
        frame.strategy = strategy;
        REQUIRE(slv_gl_renderer_draw(renderer, &env, uploaded, &frame, &image, NULL) == SLV_OK);
        step("first frame");
        slv_gl_texture_stats sizes = slv_gl_texture_get_stats(uploaded, strategy);
        fprintf(stderr, "%s: %.1f MB of texels, %.1f MB on the GPU, %u pools, %u batches\n", name,
                (double)sizes.texel_bytes / 1e6, (double)sizes.gpu_bytes / 1e6, sizes.pools,
                sizes.batches);
        CHECK(sizes.texel_bytes > 0 && sizes.gpu_bytes > sizes.texel_bytes);
        CHECK(sizes.batches > 0 && sizes.batches < 2000);
        check_picture(&image, name);
        slv_gl_texture_destroy(uploaded);
        if (s == 0) {
            first = image;
        } else {
            check_agreement(&first, &image, name);
            slv_image_free(&image);
        }
        step("checks");
    }
    fprintf(stderr, "%d faces: %.1f s in all\n", NFACES, now() - start);
    slv_image_free(&first);
    slv_gl_renderer_destroy(renderer);
    slv_gl_destroy(gl);
    slv_texture_destroy(texture);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    return test_end();
}
