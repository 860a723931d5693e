/* A texture larger than the memory that it may take, seen from a camera that moves.
 * bench_residency [--size MIB] [--gpu MIB] [--host MIB] [--strategy NAME] [--frames N] [--smoke]
 *
 * Writes a file of faces of 512 x 512 colours, 1024 MiB of texels or as many as are asked for, and
 * flies over it: close by, away, and with a cut every 100 frames. Then it rests. Printed are the
 * most bytes that the library says it took, what the operating system says the process took more
 * than before (a software driver's textures are in it), how long updates took, what the drawing
 * thread read itself, and how long it was until the picture was final. At last a texture that fits
 * is compared with one that is all there. */
#include "kit/bench_kit.h"

#include <selvage/cache.h>
#include <selvage/gl_renderer.h>
#include <selvage/gl_residency.h>
#include <selvage/mesh.h>
#include <selvage/ptx_writer.h>

#include <string.h>
#include <sys/syscall.h>

enum { CHANNELS = 3, SIZE = 128, MOST_FRAMES = 10000, CUT = 100 };

struct options {
    uint64_t size, gpu, host; /* MiB */
    const char *strategy;
    uint32_t frames;
    int log2; /* of a face's texels along a side */
    bool smoke;
};

/* A plane of side x side quads, and the texture of it in a file. */
struct scene {
    uint32_t side, nfaces;
    char path[64];
    slv_mesh *mesh;
    slv_surface *surface;
    slv_adjacency *adjacency;
    float *corners;
};

/* Bytes that this thread has asked the operating system for. */
static uint64_t thread_reads(void) {
    char path[64], line[64];
    unsigned long long bytes = 0;
    snprintf(path, sizeof path, "/proc/self/task/%ld/io", (long)syscall(SYS_gettid));
    FILE *file = fopen(path, "r");
    if (!file || !fgets(line, sizeof line, file) || sscanf(line, "rchar: %llu", &bytes) != 1)
        bytes = 0;
    if (file)
        fclose(file);
    return bytes;
}

static void write_texture(const slv_env *env, const struct scene *s, int log2) {
    uint32_t size = 1u << log2, random = 5;
    uint8_t *texels = malloc((size_t)size * size * CHANNELS);
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                    .type = SLV_TYPE_U8,
                                    .nchannels = CHANNELS,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = s->nfaces,
                                    .compression = 1};
    slv_ptx_writer *writer;
    if (!texels)
        bench_stop(SLV_ERROR_MEMORY);
    bench_stop(slv_ptx_writer_create(env, s->path, &params, &writer));
    for (uint32_t face = 0; face < s->nfaces; face++) {
        slv_ptx_face info = {.res = {(int8_t)log2, (int8_t)log2},
                             .adjacency = bench_grid_adjacency(face, s->side, s->nfaces)};
        uint32_t shift = bench_random(&random) % 5, base = bench_random(&random);
        for (uint32_t v = 0; v < size; v++)
            for (uint32_t u = 0; u < size; u++) {
                uint8_t *texel = texels + ((size_t)v * size + u) * CHANNELS;
                texel[0] = (uint8_t)(base + ((u >> shift) ^ (v >> shift)));
                texel[1] = (uint8_t)(u >> (log2 > 8 ? log2 - 8 : 0));
                texel[2] = (uint8_t)((base >> 8) + (v >> 3));
            }
        bench_stop(slv_ptx_writer_write_face(writer, face, &info, texels));
    }
    bench_stop(slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
    free(texels);
}

static struct scene make_scene(const slv_env *env, uint64_t mebibytes, int log2) {
    struct scene s = {.side = 1};
    uint64_t each = (uint64_t)CHANNELS << 2 * log2;
    while ((uint64_t)s.side * s.side * each < mebibytes << 20)
        s.side++;
    s.nfaces = s.side * s.side;
    uint32_t nverts = (s.side + 1) * (s.side + 1);
    float *positions = calloc(nverts, 3 * sizeof *positions);
    int32_t *sizes = calloc(s.nfaces, sizeof *sizes), *verts = calloc(s.nfaces, 4 * sizeof *verts);
    if (!positions || !sizes || !verts)
        bench_stop(SLV_ERROR_MEMORY);
    for (uint32_t i = 0; i < nverts; i++) {
        positions[3 * i] = (float)(i % (s.side + 1));
        positions[3 * i + 1] = (float)(i / (s.side + 1));
    }
    for (uint32_t f = 0; f < s.nfaces; f++) {
        int32_t row = (int32_t)s.side + 1, at = (int32_t)(f / s.side) * row + (int32_t)(f % s.side);
        const int32_t quad[4] = {at, at + 1, at + row + 1, at + row};
        sizes[f] = 4;
        memcpy(verts + 4 * (size_t)f, quad, sizeof quad);
    }
    const slv_mesh_view view = {.nverts = nverts,
                                .positions = positions,
                                .npolys = s.nfaces,
                                .poly_sizes = sizes,
                                .poly_verts = verts};
    bench_stop(slv_mesh_create(env, &view, &s.mesh));
    bench_stop(slv_mesh_adjacency(env, s.mesh, &s.adjacency));
    bench_stop(slv_surface_create(env, s.mesh, NULL, &s.surface));
    bench_stop(slv_mesh_corners(env, s.mesh, NULL, &s.corners));
    free(positions);
    free(sizes);
    free(verts);
    bench_temporary(s.path);
    write_texture(env, &s, log2);
    return s;
}

static void free_scene(struct scene *s) {
    unlink(s->path);
    slv_free(s->corners);
    slv_surface_destroy(s->surface);
    slv_adjacency_destroy(s->adjacency);
    slv_mesh_destroy(s->mesh);
}

/* Over the plane, now and then somewhere else; from half a face to all of the plane away. */
static slv_camera camera_of(const struct scene *s, uint32_t frame) {
    float t = (float)frame / CUT, cut = (float)(frame / CUT), side = (float)s->side;
    float x = side * (0.5f + 0.4f * sinf(3 * cut + 0.7f * t));
    float y = side * (0.5f + 0.4f * cosf(2 * cut + 0.9f * t));
    float height = 0.5f * powf(2 * side, 0.5f - 0.5f * cosf(5 * t));
    return (slv_camera){.world_to_camera = {1, 0, 0, -x, 0, 1, 0, -y, 0, 0, 1, -height, 0, 0, 0, 1},
                        .perspective = true,
                        .window = {-0.5f, 0.5f, -0.5f, 0.5f}};
}

struct peaks {
    uint64_t gpu, host, resident, reads;
    double times[MOST_FRAMES];
    uint32_t ntimes, bias;
};

static bool step(slv_gl_residency *residency, const slv_env *env, const slv_camera *camera,
                 struct peaks *peaks) {
    slv_gl_residency_state state;
    uint64_t once = thread_reads(), reads = thread_reads(), resident; /* asking reads, too */
    double start = bench_seconds(CLOCK_THREAD_CPUTIME_ID);
    bench_stop(slv_gl_residency_update(residency, env, camera, 1920, 1080, &state));
    if (peaks->ntimes < MOST_FRAMES)
        peaks->times[peaks->ntimes++] = 1e3 * (bench_seconds(CLOCK_THREAD_CPUTIME_ID) - start);
    peaks->reads += thread_reads() - reads - (reads - once);
    resident = bench_status_bytes("VmRSS");
    peaks->gpu = state.gpu_bytes > peaks->gpu ? state.gpu_bytes : peaks->gpu;
    peaks->host = state.host_bytes > peaks->host ? state.host_bytes : peaks->host;
    peaks->resident = resident > peaks->resident ? resident : peaks->resident;
    peaks->bias = state.bias > peaks->bias ? state.bias : peaks->bias;
    return state.settled;
}

static slv_gl_residency *open_scene(slv_gl *gl, const slv_env *env, const struct scene *s,
                                    const struct options *o, slv_cache **cache) {
    static const slv_strategy *list[1];
    slv_cache_params held = {.max_bytes = o->host << 18};
    slv_gl_residency *residency = NULL;
    slv_source source;
    slv_file_id file;
    list[0] = slv_strategy_find(o->strategy);
    slv_gl_residency_params params = {.texture = {.strategies = list, .nstrategies = 1},
                                      .gpu_bytes = o->gpu << 20,
                                      .host_bytes = 3 * (o->host << 18)};
    bench_stop(slv_cache_create(env, &held, cache));
    bench_stop(slv_cache_open(*cache, s->path, &file));
    bench_stop(slv_cache_as_source(*cache, file, &source));
    bench_stop(
        slv_gl_residency_create(gl, env, &source, s->adjacency, s->corners, &params, &residency));
    return residency;
}

static void fly(slv_gl *gl, const slv_env *env, const struct options *o) {
    static struct peaks peaks;
    slv_cache *cache = NULL;
    struct scene s = make_scene(env, o->size, o->log2);
    uint64_t before = bench_status_bytes("VmRSS");
    double start = bench_seconds(CLOCK_MONOTONIC);
    slv_gl_residency *residency = open_scene(gl, env, &s, o, &cache);
    printf("%u faces of %u x %u: %llu MiB of texels; %s within %llu MiB of the GPU's memory and "
           "%llu of "
           "the host's\n",
           s.nfaces, 1u << o->log2, 1u << o->log2,
           (unsigned long long)((uint64_t)s.nfaces * CHANNELS << 2 * o->log2 >> 20), o->strategy,
           (unsigned long long)o->gpu, (unsigned long long)o->host);
    bench_report(false, "the coarse levels are there after", "s",
                 bench_seconds(CLOCK_MONOTONIC) - start);
    slv_camera camera = {0};
    for (uint32_t frame = 0; frame < o->frames; frame++) {
        camera = camera_of(&s, frame);
        step(residency, env, &camera, &peaks);
        nanosleep(&(struct timespec){.tv_nsec = o->smoke ? 0 : 10000000}, NULL);
    }
    bench_report(false, "levels lacked, at most", "levels", peaks.bias);
    start = bench_seconds(CLOCK_MONOTONIC);
    while (!step(residency, env, &camera, &peaks))
        nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
    bench_report(false, "final picture after a rest of", "s",
                 bench_seconds(CLOCK_MONOTONIC) - start);
    bench_report(false, "GPU, at most", "MiB", (double)peaks.gpu / (1 << 20));
    bench_report(false, "host, at most, but for the cache", "MiB", (double)peaks.host / (1 << 20));
    bench_report(false, "process, GPU's textures included", "MiB",
                 ((double)peaks.resident - (double)before) / (1 << 20));
    bench_report(false, "read by the drawing thread", "KiB", (double)peaks.reads / 1024);
    double longest = 0;
    for (uint32_t i = 0; i < peaks.ntimes; i++)
        longest = peaks.times[i] > longest ? peaks.times[i] : longest;
    bench_report(false, "an update, of the thread's time", "ms",
                 bench_median(peaks.times, peaks.ntimes));
    bench_report(false, "an update in a hundred takes", "ms", peaks.times[peaks.ntimes * 99 / 100]);
    bench_report(false, "the longest", "ms", longest);
    slv_gl_residency_destroy(residency);
    slv_cache_destroy(cache);
    free_scene(&s);
}

static slv_image draw(slv_gl_renderer *renderer, const slv_env *env, slv_gl_texture *texture,
                      const slv_camera *camera) {
    slv_image image = {0};
    const slv_frame frame = {
        .camera = *camera, .width = SIZE, .height = SIZE, .shading = SLV_SHADE_UNLIT};
    bench_stop(slv_gl_renderer_draw(renderer, env, texture, &frame, &image, NULL));
    slv_texels_encode(4, 3, image.pixels, SIZE * SIZE);
    return image;
}

/* A texture that fits, against all of it. */
static void compare(slv_gl *gl, const slv_env *env, const struct options *o) {
    static struct peaks peaks;
    slv_cache *cache = NULL;
    struct scene s = make_scene(env, o->size < 16 ? o->size : 16, o->log2);
    slv_gl_residency *residency = open_scene(gl, env, &s, o, &cache);
    const slv_strategy *list[] = {slv_strategy_find(o->strategy)};
    const slv_gl_texture_params params = {.strategies = list, .nstrategies = 1};
    slv_gl_renderer *renderer = NULL;
    slv_gl_texture *whole = NULL;
    slv_texture *texels = NULL;
    float most = 0;
    slv_ptx *ptx = NULL;
    bench_stop(slv_gl_renderer_create(gl, env, s.mesh, s.surface, 2, &renderer));
    bench_stop(slv_ptx_open(env, s.path, &ptx));
    bench_stop(slv_ptx_load_texture(env, ptx, &texels));
    bench_stop(slv_gl_texture_create(gl, env, texels, s.adjacency, &params, &whole));
    for (uint32_t i = 0; i < 4; i++) {
        slv_camera camera = camera_of(&s, CUT * i + 23 * i);
        while (!step(residency, env, &camera, &peaks))
            ;
        slv_image a = draw(renderer, env, slv_gl_residency_texture(residency), &camera);
        slv_image b = draw(renderer, env, whole, &camera);
        for (size_t k = 0; k < (size_t)4 * SIZE * SIZE; k++)
            most = fmaxf(most, fabsf(a.pixels[k] - b.pixels[k]));
        slv_image_free(&a);
        slv_image_free(&b);
    }
    bench_report(false, "that fits, differs from the whole by", "/ 255", 255 * (double)most);
    slv_gl_texture_destroy(whole);
    slv_texture_destroy(texels);
    slv_ptx_close(ptx);
    slv_gl_renderer_destroy(renderer);
    slv_gl_residency_destroy(residency);
    slv_cache_destroy(cache);
    free_scene(&s);
}

int main(int argc, char **argv) {
    struct options o = {1024, 256, 512, "borders", 600, 9, false};
    slv_env env = {.log = bench_log, .max_bytes = UINT64_C(64) << 30};
    slv_gl *gl = NULL;
    for (int i = 1; i < argc; i++) {
        bool value = i + 1 < argc;
        if (strcmp(argv[i], "--smoke") == 0)
            o = (struct options){1, 1, 32, "borders", 20, 5, true};
        else if (value && strcmp(argv[i], "--size") == 0)
            o.size = strtoull(argv[++i], NULL, 10);
        else if (value && strcmp(argv[i], "--gpu") == 0)
            o.gpu = strtoull(argv[++i], NULL, 10);
        else if (value && strcmp(argv[i], "--host") == 0)
            o.host = strtoull(argv[++i], NULL, 10);
        else if (value && strcmp(argv[i], "--strategy") == 0)
            o.strategy = argv[++i];
        else if (value && strcmp(argv[i], "--frames") == 0)
            o.frames = (uint32_t)strtoul(argv[++i], NULL, 10);
        else
            return 2;
    }
    if (!slv_strategy_find(o.strategy) || !o.size)
        return 2;
    bench_stop(slv_gl_create(&env, SLV_GL_AUTO, &gl));
    fly(gl, &env, &o);
    compare(gl, &env, &o);
    slv_gl_destroy(gl);
    return 0;
}
