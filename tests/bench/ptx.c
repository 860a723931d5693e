/* bench_ptx [--faces N] [--log2 N] [--compression N] [--threads N] [--runs N] [--json] [--smoke]
 *
 * Writes and reads one file of N faces of uint8 RGB, in a noisy version (a smooth function plus
 * noise of a few units) and a smooth one, and opens one of a million faces. MB/s are of texels
 * without their reductions; medians of the runs. */
#include "kit/bench_kit.h"

#include <selvage/ptx_writer.h>

#include <string.h>

struct options {
    uint32_t nfaces, threads, runs, many;
    int log2, compression;
    bool json;
};

struct texels {
    uint8_t *data;
    size_t face_size;
};

static struct texels make(const struct options *o, bool noisy) {
    size_t size = (size_t)1 << o->log2;
    struct texels t = {.face_size = 3 * size * size};
    t.data = malloc(t.face_size * o->nfaces);
    uint32_t state = 12345;
    if (!t.data)
        bench_stop(SLV_ERROR_MEMORY);
    uint8_t *to = t.data;
    for (uint32_t face = 0; face < o->nfaces; face++)
        for (size_t y = 0; y < size; y++)
            for (size_t x = 0; x < size; x++)
                for (int c = 0; c < 3; c++) {
                    float u = (float)x / (float)size, v = (float)y / (float)size;
                    float value = 128.0f + 60.0f * sinf(3.0f * u + 0.1f * (float)face + (float)c) +
                                  50.0f * cosf(4.0f * v + 0.07f * (float)face - (float)c * u);
                    if (noisy)
                        value += (float)(bench_random(&state) % 9) - 4.0f;
                    *to++ = (uint8_t)(value < 0.0f ? 0.0f : value > 255.0f ? 255.0f : value);
                }
    return t;
}

static void write_once(const slv_env *env, const struct options *o, const char *path,
                       slv_texture *texture) {
    slv_ptx_write_params params = {.compression = o->compression};
    bench_stop(slv_ptx_save(env, path, texture, NULL, &params));
}

static slv_result drop(void *user, const slv_env *env, uint32_t face, const slv_ptx_face *info,
                       void *texels) {
    (void)user, (void)env, (void)face, (void)info, (void)texels;
    return SLV_OK;
}

static void read_once(const slv_env *env, const char *path) {
    slv_ptx *ptx = NULL;
    bench_stop(slv_ptx_open(env, path, &ptx));
    bench_stop(slv_ptx_visit_faces(env, ptx, drop, NULL));
    slv_ptx_close(ptx);
}

static uint64_t size_of(const char *path) {
    slv_ptx *ptx = NULL;
    bench_stop(slv_ptx_open(NULL, path, &ptx));
    uint64_t size = slv_ptx_get_info(ptx)->file_bytes;
    slv_ptx_close(ptx);
    return size;
}

static void texel_speed(const struct options *o, const char *path, bool noisy) {
    slv_env env = {.log = bench_log, .threads = o->threads}, one = {.log = bench_log, .threads = 1};
    const char *name = noisy ? "noisy" : "smooth";
    struct texels t = make(o, noisy);
    slv_res *res = malloc(o->nfaces * sizeof *res);
    double times[3][64], total = (double)t.face_size * o->nfaces / 1e6;
    slv_texture *texture = NULL;
    char what[80];
    if (!res)
        bench_stop(SLV_ERROR_MEMORY);
    for (uint32_t face = 0; face < o->nfaces; face++)
        res[face] = (slv_res){(int8_t)o->log2, (int8_t)o->log2};
    slv_texture_desc desc = {o->nfaces, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res, SLV_TEXTURE_LINEAR};
    bench_stop(slv_texture_create(&env, &desc, &texture));
    for (uint32_t face = 0; face < o->nfaces; face++)
        bench_stop(slv_texture_set_face(texture, face, t.data + face * t.face_size));
    free(t.data);
    for (uint32_t run = 0; run < o->runs; run++) {
        double start = bench_seconds(CLOCK_MONOTONIC);
        write_once(&env, o, path, texture);
        times[0][run] = total / (bench_seconds(CLOCK_MONOTONIC) - start);
        start = bench_seconds(CLOCK_MONOTONIC);
        read_once(&one, path);
        times[1][run] = total / (bench_seconds(CLOCK_MONOTONIC) - start);
        start = bench_seconds(CLOCK_MONOTONIC);
        read_once(&env, path);
        times[2][run] = total / (bench_seconds(CLOCK_MONOTONIC) - start);
    }
    static const char *const kinds[3] = {"write", "read, one thread", "read"};
    for (int i = 0; i < 3; i++) {
        snprintf(what, sizeof what, "%s: %s", name, kinds[i]);
        bench_report(o->json, what, "MB/s", bench_median(times[i], o->runs));
    }
    snprintf(what, sizeof what, "%s: file", name);
    bench_report(o->json, what, "MB", (double)size_of(path) / 1e6);
    slv_texture_destroy(texture);
    free(res);
    remove(path);
}

/* Opening, and then looking at one face. */
static void open_speed(const struct options *o, const char *path) {
    slv_env env = {.log = bench_log, .threads = o->threads};
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                    .type = SLV_TYPE_U8,
                                    .nchannels = 3,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = o->many};
    slv_ptx_writer *writer = NULL;
    double open_times[64], face_times[64];
    uint32_t columns = (uint32_t)sqrt((double)o->many), state = 1;
    bench_stop(slv_ptx_writer_create(&env, path, &params, &writer));
    for (uint32_t face = 0; face < o->many; face++) {
        uint8_t texels[48];
        slv_ptx_face info = {.res = {2, 2},
                             .adjacency = bench_grid_adjacency(face, columns, o->many)};
        for (int i = 0; i < 48; i++)
            texels[i] = (uint8_t)(bench_random(&state) % 16);
        bench_stop(slv_ptx_writer_write_face(writer, face, &info, texels));
    }
    bench_stop(slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
    for (uint32_t run = 0; run < o->runs; run++) {
        slv_ptx *ptx = NULL;
        uint8_t texels[48];
        double start = bench_seconds(CLOCK_MONOTONIC);
        bench_stop(slv_ptx_open(&env, path, &ptx));
        open_times[run] = 1e3 * (bench_seconds(CLOCK_MONOTONIC) - start);
        bench_stop(slv_ptx_read_face(ptx, o->many / 2, (slv_res){2, 2}, texels));
        face_times[run] = 1e3 * (bench_seconds(CLOCK_MONOTONIC) - start);
        slv_ptx_close(ptx);
    }
    bench_report(o->json, "open", "ms", bench_median(open_times, o->runs));
    bench_report(o->json, "open and read one face", "ms", bench_median(face_times, o->runs));
    double start = bench_seconds(CLOCK_MONOTONIC);
    read_once(&env, path);
    bench_report(o->json, "open and read all faces", "ms",
                 1e3 * (bench_seconds(CLOCK_MONOTONIC) - start));
    remove(path);
}

int main(int argc, char **argv) {
    struct options o = {.nfaces = 4096, .runs = 5, .many = 1000000, .log2 = 7};
    char path[1024];
    for (int i = 1; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : "0";
        if (!strcmp(argv[i], "--json"))
            o.json = true;
        else if (!strcmp(argv[i], "--smoke")) {
            o.nfaces = 64;
            o.runs = 1;
            o.many = 10000;
        } else if (!strcmp(argv[i], "--faces"))
            o.nfaces = (uint32_t)atoi(value), i++;
        else if (!strcmp(argv[i], "--log2"))
            o.log2 = atoi(value), i++;
        else if (!strcmp(argv[i], "--compression"))
            o.compression = atoi(value), i++;
        else if (!strcmp(argv[i], "--threads"))
            o.threads = (uint32_t)atoi(value), i++;
        else if (!strcmp(argv[i], "--runs"))
            o.runs = (uint32_t)atoi(value), i++;
        else {
            fprintf(stderr, "usage: bench_ptx [--faces N] [--log2 N] [--compression N] "
                            "[--threads N] [--runs N] [--json] [--smoke]\n");
            return 2;
        }
    }
    if (o.runs < 1 || o.runs > 64 || o.nfaces < 1 || o.log2 < 0 || o.log2 > 12)
        return 2;
    snprintf(path, sizeof path, "%s/selvage-bench-%ld.ptx",
             getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp", (long)getpid());
    texel_speed(&o, path, true);
    texel_speed(&o, path, false);
    open_speed(&o, path);
    return 0;
}
