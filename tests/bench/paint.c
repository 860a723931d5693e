/* bench_paint [--threads N] [--faces N] [--smoke]
 *
 * Dabs on meshes of 10 thousand, 100 thousand and a million faces (or of N): one that covers 100
 * thousand texels, and one of two thousand; from the dab to the texels of a store. Medians, wall
 * time, and the processor's where others use the machine. And what is allocated a dab once it goes
 * on. */
#include "kit/bench_kit.h"

#include <selvage/canvas.h>
#include <selvage/threads.h>

#include <stdatomic.h>
#include <string.h>

static atomic_ulong allocations;

static void *count_allocation(void *user, size_t bytes) {
    (void)user;
    atomic_fetch_add(&allocations, 1);
    return malloc(bytes);
}

static void release(void *user, void *memory) {
    (void)user;
    free(memory);
}

/* side x side quads of a gentle wave, one unit each. */
static slv_mesh *make_mesh(const slv_env *env, uint32_t side) {
    slv_mesh_view view = {.nverts = (side + 1) * (side + 1), .npolys = side * side};
    float *positions = malloc(3 * sizeof *positions * view.nverts);
    int32_t *sizes = malloc(sizeof *sizes * view.npolys),
            *verts = malloc(4 * sizeof *verts * view.npolys);
    slv_mesh *mesh = NULL;
    if (!positions || !sizes || !verts)
        bench_stop(SLV_ERROR_MEMORY);
    for (uint32_t i = 0; i < view.nverts; i++) {
        float x = (float)(i % (side + 1)), y = (float)(i / (side + 1));
        positions[3 * (size_t)i] = x;
        positions[3 * (size_t)i + 1] = y;
        positions[3 * (size_t)i + 2] = 3 * sinf(0.05f * x) * cosf(0.04f * y);
    }
    for (uint32_t i = 0; i < view.npolys; i++) {
        int32_t a = (int32_t)(i / side * (side + 1) + i % side), row = (int32_t)side + 1;
        const int32_t quad[4] = {a, a + 1, a + row + 1, a + row};
        sizes[i] = 4;
        memcpy(verts + 4 * (size_t)i, quad, sizeof quad);
    }
    view.positions = positions;
    view.poly_sizes = sizes;
    view.poly_verts = verts;
    bench_stop(slv_mesh_create(env, &view, &mesh));
    free(positions);
    free(sizes);
    free(verts);
    return mesh;
}

typedef struct timing {
    double wall, processor, texels, allocated;
} timing;

/* Dabs of a radius in random places; 2^log2 texels along a face's side. */
static timing time_dabs(slv_painter *painter, slv_texture *texture, uint32_t side, float radius,
                        uint32_t count) {
    enum { MOST = 512 };
    static double wall[MOST], processor[MOST];
    const slv_canvas canvas = slv_texture_as_canvas(texture);
    const slv_res *res = slv_texture_get_desc(texture)->res;
    const slv_paint paint = {.color = {0.8f, 0.2f, 0.1f}, .opacity = 0.2f};
    uint32_t state = 7, warm = count / 2;
    timing out = {0};
    unsigned long before = 0;
    for (uint32_t i = 0; i < warm + count; i++) {
        /* the same places again: faces that were constant have room by then */
        if (i % warm == 0)
            state = 7;
        uint32_t x = (uint32_t)((float)side * (0.2f + 0.6f * bench_random_unit(&state))),
                 y = (uint32_t)((float)side * (0.2f + 0.6f * bench_random_unit(&state)));
        const slv_dab dab = {
            .at = {(int32_t)(y * side + x), bench_random_unit(&state), bench_random_unit(&state)},
            .radius = radius,
            .hardness = 0.6f};
        slv_patches patches;
        if (i == warm)
            before = atomic_load(&allocations);
        double w = bench_seconds(CLOCK_MONOTONIC), p = bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
        bench_stop(slv_painter_cover(painter, res, &dab, &patches));
        bench_stop(slv_painter_apply(painter, &canvas, &patches, &paint));
        if (i < warm)
            continue;
        wall[i - warm] = bench_seconds(CLOCK_MONOTONIC) - w;
        processor[i - warm] = bench_seconds(CLOCK_PROCESS_CPUTIME_ID) - p;
        for (uint32_t k = 0; k < patches.count; k++) {
            size_t n = (size_t)patches.list[k].rect.width * patches.list[k].rect.height;
            for (size_t t = 0; t < n; t++)
                out.texels += patches.list[k].coverage[t] > 0;
        }
    }
    out.texels /= count;
    out.allocated = (double)(atomic_load(&allocations) - before) / count;
    out.wall = 1e3 * bench_median(wall, count);
    out.processor = 1e3 * bench_median(processor, count);
    return out;
}

static void run(slv_env *env, uint32_t faces, bool smoke) {
    static const struct {
        int log2;
        float radius;
    } dabs[] = {{5, 5.58f}, {5, 0.79f}, {2, 44.6f}};
    uint32_t side = (uint32_t)sqrt((double)faces);
    double begin = bench_seconds(CLOCK_MONOTONIC);
    slv_mesh *mesh = make_mesh(env, side);
    slv_paint_surface *surface = NULL;
    slv_painter *painter = NULL;
    bench_stop(slv_paint_surface_create(env, mesh, NULL, &surface));
    bench_stop(slv_painter_create(env, surface, &painter));
    printf("%u faces: surface made in %.1f s\n", side * side,
           bench_seconds(CLOCK_MONOTONIC) - begin);
    for (size_t d = 0; d < sizeof dabs / sizeof *dabs; d++) {
        slv_res *res = malloc(sizeof *res * side * side);
        slv_texture *texture = NULL;
        if (!res)
            bench_stop(SLV_ERROR_MEMORY);
        for (uint32_t i = 0; i < side * side; i++)
            res[i] = (slv_res){(int8_t)dabs[d].log2, (int8_t)dabs[d].log2};
        const slv_texture_desc desc = {.nfaces = side * side,
                                       .type = SLV_TYPE_U16,
                                       .nchannels = 4,
                                       .alpha_channel = 3,
                                       .res = res};
        bench_stop(slv_texture_create(env, &desc, &texture));
        timing t = time_dabs(painter, texture, side, dabs[d].radius, smoke ? 4 : 64);
        printf("  %3dx%-3d texels a face, radius %5.2f faces: %9.0f texels, %7.3f ms (processor "
               "%7.3f ms), %.2f allocations\n",
               1 << dabs[d].log2, 1 << dabs[d].log2, (double)dabs[d].radius, t.texels, t.wall,
               t.processor, t.allocated);
        fflush(stdout);
        slv_texture_destroy(texture);
        free(res);
    }
    slv_painter_destroy(painter);
    slv_paint_surface_destroy(surface);
    slv_mesh_destroy(mesh);
}

int main(int argc, char **argv) {
    slv_env env = {.log = bench_log, .allocate = count_allocation, .release = release};
    slv_threads *threads = NULL;
    uint32_t faces = 0;
    bool smoke = false;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--smoke") == 0)
            smoke = true;
        else if (strcmp(argv[i], "--threads") == 0 && i + 1 < argc)
            env.threads = (uint32_t)strtoul(argv[++i], NULL, 10);
        else if (strcmp(argv[i], "--faces") == 0 && i + 1 < argc)
            faces = (uint32_t)strtoul(argv[++i], NULL, 10);
        else
            return fprintf(stderr, "usage: " BENCH_NAME " [--threads N] [--faces N] [--smoke]\n"),
                   2;
    }
    bench_stop(slv_threads_create(&env, &threads));
    slv_threads_use(threads, &env);
    printf("%ld processors, %u threads\n", sysconf(_SC_NPROCESSORS_ONLN), env.threads);
    if (smoke) {
        run(&env, 400, true);
    } else if (faces) {
        run(&env, faces, false);
    } else {
        for (uint32_t n = 10000; n <= 1000000; n *= 10)
            run(&env, n, false);
    }
    slv_threads_destroy(threads);
    return 0;
}
