/* bench_ptx [--faces N] [--log2 N] [--compression N] [--threads N] [--runs N] [--json] [--smoke]
 *
 * Writes and reads one file of N faces of uint8 RGB, in a noisy version (a smooth function plus
 * noise of a few units) and a smooth one, and opens one of a million faces. MB/s are of texels
 * without their reductions; medians of the runs. */
#include <selvage/ptx_writer.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

struct options {
    uint32_t nfaces, threads, runs, many;
    int log2, compression;
    bool json;
};

struct texels {
    uint8_t *data;
    size_t face_size;
};

static void log_line(void *user, slv_log_level level, const char *message) {
    (void)user;
    if (level == SLV_LOG_ERROR)
        fprintf(stderr, "bench_ptx: %s\n", message);
}

static void stop(slv_result result) {
    if (result) {
        fprintf(stderr, "bench_ptx: %s\n", slv_result_string(result));
        exit(1);
    }
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, uint32_t count) {
    qsort(values, count, sizeof *values, compare);
    return values[count / 2];
}

static uint32_t random_next(uint32_t *state) {
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

static struct texels make(const struct options *o, bool noisy) {
    size_t size = (size_t)1 << o->log2;
    struct texels t = {.face_size = 3 * size * size};
    t.data = malloc(t.face_size * o->nfaces);
    uint32_t state = 12345;
    if (!t.data)
        stop(SLV_ERROR_MEMORY);
    uint8_t *to = t.data;
    for (uint32_t face = 0; face < o->nfaces; face++)
        for (size_t y = 0; y < size; y++)
            for (size_t x = 0; x < size; x++)
                for (int c = 0; c < 3; c++) {
                    float u = (float)x / (float)size, v = (float)y / (float)size;
                    float value = 128.0f + 60.0f * sinf(3.0f * u + 0.1f * (float)face + (float)c) +
                                  50.0f * cosf(4.0f * v + 0.07f * (float)face - (float)c * u);
                    if (noisy)
                        value += (float)(random_next(&state) % 9) - 4.0f;
                    *to++ = (uint8_t)(value < 0.0f ? 0.0f : value > 255.0f ? 255.0f : value);
                }
    return t;
}

static void write_once(const slv_env *env, const struct options *o, const char *path,
                       slv_texture *texture) {
    slv_ptx_write_params params = {.compression = o->compression};
    stop(slv_ptx_save(env, path, texture, NULL, &params));
}

static slv_result drop(void *user, const slv_env *env, uint32_t face, const slv_ptx_face *info,
                       void *texels) {
    (void)user, (void)env, (void)face, (void)info, (void)texels;
    return SLV_OK;
}

static void read_once(const slv_env *env, const char *path) {
    slv_ptx *ptx = NULL;
    stop(slv_ptx_open(env, path, &ptx));
    stop(slv_ptx_visit_faces(env, ptx, drop, NULL));
    slv_ptx_close(ptx);
}

static uint64_t size_of(const char *path) {
    slv_ptx *ptx = NULL;
    stop(slv_ptx_open(NULL, path, &ptx));
    uint64_t size = slv_ptx_get_info(ptx)->file_bytes;
    slv_ptx_close(ptx);
    return size;
}

static void report(const struct options *o, const char *what, const char *unit, double value) {
    if (o->json)
        printf("{\"what\": \"%s\", \"unit\": \"%s\", \"value\": %.3f}\n", what, unit, value);
    else
        printf("%-40s %10.2f %s\n", what, value, unit);
    fflush(stdout);
}

static void texel_speed(const struct options *o, const char *path, bool noisy) {
    slv_env env = {.log = log_line, .threads = o->threads}, one = {.log = log_line, .threads = 1};
    const char *name = noisy ? "noisy" : "smooth";
    struct texels t = make(o, noisy);
    slv_res *res = malloc(o->nfaces * sizeof *res);
    double times[3][64], total = (double)t.face_size * o->nfaces / 1e6;
    slv_texture *texture = NULL;
    char what[80];
    if (!res)
        stop(SLV_ERROR_MEMORY);
    for (uint32_t face = 0; face < o->nfaces; face++)
        res[face] = (slv_res){(int8_t)o->log2, (int8_t)o->log2};
    slv_texture_desc desc = {o->nfaces, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res};
    stop(slv_texture_create(&env, &desc, &texture));
    for (uint32_t face = 0; face < o->nfaces; face++)
        stop(slv_texture_set_face(texture, face, t.data + face * t.face_size));
    free(t.data);
    for (uint32_t run = 0; run < o->runs; run++) {
        double start = now();
        write_once(&env, o, path, texture);
        times[0][run] = total / (now() - start);
        start = now();
        read_once(&one, path);
        times[1][run] = total / (now() - start);
        start = now();
        read_once(&env, path);
        times[2][run] = total / (now() - start);
    }
    static const char *const kinds[3] = {"write", "read, one thread", "read"};
    for (int i = 0; i < 3; i++) {
        snprintf(what, sizeof what, "%s: %s", name, kinds[i]);
        report(o, what, "MB/s", median(times[i], o->runs));
    }
    snprintf(what, sizeof what, "%s: file", name);
    report(o, what, "MB", (double)size_of(path) / 1e6);
    slv_texture_destroy(texture);
    free(res);
    remove(path);
}

/* Opening, and then looking at one face. */
static void open_speed(const struct options *o, const char *path) {
    slv_env env = {.log = log_line, .threads = o->threads};
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                    .type = SLV_TYPE_U8,
                                    .nchannels = 3,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = o->many};
    slv_ptx_writer *writer = NULL;
    double open_times[64], face_times[64];
    uint32_t columns = (uint32_t)sqrt((double)o->many), state = 1;
    stop(slv_ptx_writer_create(&env, path, &params, &writer));
    for (uint32_t face = 0; face < o->many; face++) {
        uint8_t texels[48];
        int32_t f = (int32_t)face, row = (int32_t)columns;
        slv_ptx_face info = {.res = {2, 2},
                             .adjacency = {{f - row, f + 1, f + row, f - 1}, {2, 3, 0, 1}}};
        for (int e = 0; e < 4; e++)
            if (info.adjacency.face[e] < 0 || info.adjacency.face[e] >= (int32_t)o->many)
                info.adjacency.face[e] = SLV_BOUNDARY;
        for (int i = 0; i < 48; i++)
            texels[i] = (uint8_t)(random_next(&state) % 16);
        stop(slv_ptx_writer_write_face(writer, face, &info, texels));
    }
    stop(slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
    for (uint32_t run = 0; run < o->runs; run++) {
        slv_ptx *ptx = NULL;
        uint8_t texels[48];
        double start = now();
        stop(slv_ptx_open(&env, path, &ptx));
        open_times[run] = 1e3 * (now() - start);
        stop(slv_ptx_read_face(ptx, o->many / 2, (slv_res){2, 2}, texels));
        face_times[run] = 1e3 * (now() - start);
        slv_ptx_close(ptx);
    }
    report(o, "open", "ms", median(open_times, o->runs));
    report(o, "open and read one face", "ms", median(face_times, o->runs));
    double start = now();
    read_once(&env, path);
    report(o, "open and read all faces", "ms", 1e3 * (now() - start));
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
