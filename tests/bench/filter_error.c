/* bench_filter_error [--lookups N] [--runs N] [--json] [--smoke]
 *
 * How far each filter is from exact integration, and what it costs: a flat grid of 4x4 faces of
 * 64x64 texels, each turned some way, holds three functions of which the texels are the means over
 * their squares: a smooth one, noise of equal power per octave up to half of what texels can hold,
 * and a checkerboard. N (2048) lookups for each shape of footprint: the longer side 1 to 16 times
 * the shorter, all between 0.5 and 32 texels, along u or v or diagonal; seams are crossed often.
 *
 * Exact is the integral of the function itself under two weights that a renderer may want:
 * `ellipse`, a gaussian whose standard deviations are half of the footprint's two vectors (the
 * width that the Ptex library gives its gaussians, and the usual one for pixels), and `box`,
 * constant over the parallelogram that the two vectors span. For sums of waves both are known; for
 * the checker they are summed over a fine grid, and that sum is checked on waves.
 *
 * Errors are RMS in percent of the function's standard deviation. The cost is the median time of a
 * batch relative to the bilinear filter's in the same run. Bicubic has a sharpness of 0.5. */
#include "kit/bench_kit.h"

#include <selvage/filter.h>

#include <string.h>

enum {
    LOG2 = 6,
    SIZE = 1 << LOG2,
    SIDE = 4,
    NFACES = SIDE * SIDE,
    TEXELS = SIDE * SIZE,
    SMOOTH_WAVES = 8,
    NOISE_WAVES = 64,
    FUNCTIONS = 3,
    IDEALS = 2,
    ELONGATIONS = 5,
    CELLS = 2 * ELONGATIONS,
    MAX_VARIANTS = 2 * SLV_FILTER_COUNT,
    MAX_RUNS = 99,
    MAX_LOOKUPS = 4096
};

static const char *const function_names[FUNCTIONS] = {"smooth", "noise", "checker"};
static const char *const ideal_names[IDEALS] = {"ellipse", "box"};
static const double pi = 3.14159265358979323846;

struct options {
    uint32_t lookups, runs;
    bool json;
};

/* Radians a texel, and where it begins; all have the same height. */
struct wave {
    double x, y, phase;
};

struct scene {
    struct wave smooth[SMOOTH_WAVES], noise[NOISE_WAVES];
    uint32_t turns[NFACES];
    double deviation[FUNCTIONS];
};

/* A place in texels of the whole grid, and the footprint's two vectors there. */
struct footprint {
    double x, y, a[2], b[2];
};

struct variant {
    char name[32];
    slv_sampler *sampler;
    float *values;
    double error[FUNCTIONS][IDEALS][CELLS]; /* sums of squares, then percents */
    double cost[CELLS], times[MAX_RUNS];
};

static double sinc(double x) {
    return fabs(x) < 1e-6 ? 1 - x * x / 6 : sin(x) / x;
}

/* The mean of waves under a weight: each keeps its phase and loses height. */
static double wave_mean(const struct wave *waves, uint32_t count, const struct footprint *f,
                        int ideal) {
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        const struct wave *w = &waves[i];
        double a = w->x * f->a[0] + w->y * f->a[1], b = w->x * f->b[0] + w->y * f->b[1];
        double kept = ideal ? sinc(a / 2) * sinc(b / 2) : exp(-(a * a + b * b) / 8);
        sum += kept * cos(w->x * f->x + w->y * f->y + w->phase);
    }
    return 0.5 + 0.1 * sum;
}

/* Black and white cells of ten texels, askew. */
static double checker(double x, double y) {
    const double c = 0.0955336489, s = 0.0295520207;
    int64_t i = (int64_t)floor(c * x + s * y), j = (int64_t)floor(c * y - s * x);
    return (double)((i + j) & 1);
}

/* The same as a sum over a grid, in which the vectors' directions are the axes; of the checker, or
 * of waves if there are any. */
static double grid_mean(const struct wave *waves, uint32_t count, const struct footprint *f,
                        int ideal) {
    enum { MOST = 400 };
    double reach = ideal ? 0.5 : 2, sum = 0, total = 0; /* four standard deviations */
    double places[2][MOST], weights[2][MOST];
    uint32_t n[2];
    for (int k = 0; k < 2; k++) {
        const double *vector = k ? f->b : f->a;
        n[k] = (uint32_t)fmin(fmax(16 * reach * hypot(vector[0], vector[1]), 32), MOST);
        for (uint32_t i = 0; i < n[k]; i++) {
            places[k][i] = reach * (2 * (i + 0.5) / n[k] - 1);
            weights[k][i] = ideal ? 1 : exp(-2 * places[k][i] * places[k][i]);
        }
    }
    for (uint32_t j = 0; j < n[1]; j++)
        for (uint32_t i = 0; i < n[0]; i++) {
            double s = places[0][i], t = places[1][j], weight = weights[0][i] * weights[1][j];
            struct footprint at = {.x = f->x + s * f->a[0] + t * f->b[0],
                                   .y = f->y + s * f->a[1] + t * f->b[1]};
            sum += weight * (waves ? wave_mean(waves, count, &at, 0) : checker(at.x, at.y));
            total += weight;
        }
    return sum / total;
}

static void make_waves(struct wave *waves, uint32_t count, double longest, double shortest,
                       uint32_t *state) {
    for (uint32_t i = 0; i < count; i++) {
        double length = longest * pow(shortest / longest, (i + 0.5) / count);
        double angle = 2 * pi * (double)bench_random_unit(state);
        waves[i] = (struct wave){2 * pi / length * cos(angle), 2 * pi / length * sin(angle),
                                 2 * pi * (double)bench_random_unit(state)};
    }
}

/* From a place in a cell of the grid, or a vector, to the face that is turned there. */
static void turn(uint32_t turns, double x, double y, bool vector, double out[2]) {
    for (uint32_t i = 0; i < turns; i++) {
        double last = x;
        x = y;
        y = (vector ? 0 : 1) - last;
    }
    out[0] = x;
    out[1] = y;
}

static void write_scene(const slv_env *env, const char *path, struct scene *s) {
    static float texels[NFACES][SIZE * SIZE * FUNCTIONS];
    float positions[3 * (SIDE + 1) * (SIDE + 1)] = {0};
    int32_t sizes[NFACES], verts[4 * NFACES];
    double sums[FUNCTIONS] = {0}, squares[FUNCTIONS] = {0};
    slv_res res[NFACES];
    slv_mesh *mesh;
    slv_adjacency *adjacency;
    slv_texture *texture;
    uint32_t state = 20;
    make_waves(s->smooth, SMOOTH_WAVES, 160, 48, &state);
    make_waves(s->noise, NOISE_WAVES, 128, 4, &state);
    for (int32_t i = 0; i < (SIDE + 1) * (SIDE + 1); i++) {
        positions[3 * i] = (float)(i % (SIDE + 1));
        positions[3 * i + 1] = (float)(i / (SIDE + 1));
    }
    for (int32_t face = 0; face < NFACES; face++) {
        int32_t at = face / SIDE * (SIDE + 1) + face % SIDE;
        const int32_t corners[4] = {at, at + 1, at + SIDE + 2, at + SIDE + 1};
        s->turns[face] = bench_random(&state) % 4;
        sizes[face] = 4;
        for (uint32_t k = 0; k < 4; k++)
            verts[4 * face + (int32_t)k] = corners[(k + s->turns[face]) % 4];
    }
    for (uint32_t y = 0; y < TEXELS; y++)
        for (uint32_t x = 0; x < TEXELS; x++) {
            uint32_t face = y / SIZE * SIDE + x / SIZE;
            const struct footprint square = {x + 0.5, y + 0.5, {1, 0}, {0, 1}};
            const double values[FUNCTIONS] = {wave_mean(s->smooth, SMOOTH_WAVES, &square, 1),
                                              wave_mean(s->noise, NOISE_WAVES, &square, 1),
                                              grid_mean(NULL, 0, &square, 1)};
            double uv[2];
            turn(s->turns[face], (x % SIZE + 0.5) / SIZE, (y % SIZE + 0.5) / SIZE, false, uv);
            uint32_t texel = (uint32_t)(uv[1] * SIZE) * SIZE + (uint32_t)(uv[0] * SIZE);
            for (uint32_t k = 0; k < FUNCTIONS; k++) {
                texels[face][texel * FUNCTIONS + k] = (float)values[k];
                sums[k] += values[k];
                squares[k] += values[k] * values[k];
            }
        }
    for (int k = 0; k < FUNCTIONS; k++) {
        double mean = sums[k] / (TEXELS * TEXELS);
        s->deviation[k] = sqrt(squares[k] / (TEXELS * TEXELS) - mean * mean);
    }
    bench_res(NFACES, LOG2, false, res);
    slv_mesh_view view = {.nverts = (SIDE + 1) * (SIDE + 1),
                          .positions = positions,
                          .npolys = NFACES,
                          .poly_sizes = sizes,
                          .poly_verts = verts};
    slv_texture_desc desc = {NFACES, SLV_TYPE_FLOAT,    FUNCTIONS, SLV_NO_ALPHA,
                             res,    SLV_TEXTURE_LINEAR};
    bench_stop(slv_mesh_create(env, &view, &mesh));
    bench_stop(slv_mesh_adjacency(env, mesh, &adjacency));
    bench_stop(slv_texture_create(env, &desc, &texture));
    for (uint32_t face = 0; face < NFACES; face++)
        bench_stop(slv_texture_set_face(texture, face, texels[face]));
    bench_stop(slv_ptx_save(env, path, texture, adjacency, NULL));
    slv_texture_destroy(texture);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
}

/* Footprints of one elongation, around the middle of the grid, so that nothing reaches its border.
 */
static void make_footprints(int elongation, bool diagonal, uint32_t count, struct footprint *out) {
    uint32_t state = 99;
    double ratio = 1 << elongation;
    for (uint32_t i = 0; i < count; i++) {
        double narrow = 0.5 * pow(64 / ratio, (i + (double)bench_random_unit(&state)) / count);
        double angle = pi / 4 * (2 * (bench_random(&state) % 4) + (diagonal ? 1 : 0));
        double c = narrow * cos(angle), s = narrow * sin(angle);
        out[i] = (struct footprint){.a = {ratio * c, ratio * s}, .b = {-s, c}};
        out[i].x = TEXELS / 2.0 + 96 * ((double)bench_random_unit(&state) - 0.5);
        out[i].y = TEXELS / 2.0 + 96 * ((double)bench_random_unit(&state) - 0.5);
    }
}

static slv_lookup lookup_at(const struct scene *s, slv_file_id file, const struct footprint *f) {
    double x = f->x / SIZE, y = f->y / SIZE, at[2], a[2], b[2];
    uint32_t face = (uint32_t)y * SIDE + (uint32_t)x;
    turn(s->turns[face], x - floor(x), y - floor(y), false, at);
    turn(s->turns[face], f->a[0] / SIZE, f->a[1] / SIZE, true, a);
    turn(s->turns[face], f->b[0] / SIZE, f->b[1] / SIZE, true, b);
    return (slv_lookup){.file = file,
                        .face = face,
                        .u = (float)at[0],
                        .v = (float)at[1],
                        .uw1 = (float)a[0],
                        .vw1 = (float)a[1],
                        .uw2 = (float)b[0],
                        .vw2 = (float)b[1]};
}

static void measure(const struct options *o, const struct scene *s, slv_file_id file,
                    struct variant *variants, uint32_t nvariants) {
    static struct footprint footprints[MAX_LOOKUPS];
    static slv_lookup lookups[MAX_LOOKUPS];
    for (int cell = 0; cell < CELLS; cell++) {
        uint32_t count = o->lookups;
        make_footprints(cell % ELONGATIONS, cell >= ELONGATIONS, count, footprints);
        for (uint32_t i = 0; i < count; i++)
            lookups[i] = lookup_at(s, file, &footprints[i]);
        for (uint32_t run = 0; run < o->runs; run++) {
            double bilinear = 1;
            for (uint32_t k = 0; k < nvariants; k++) {
                double start = bench_seconds(CLOCK_THREAD_CPUTIME_ID);
                bench_stop(slv_sample_batch(variants[k].sampler, lookups, count, variants[k].values,
                                            FUNCTIONS, NULL));
                variants[k].times[run] = bench_seconds(CLOCK_THREAD_CPUTIME_ID) - start;
                if (strcmp(variants[k].name, slv_filter_name(SLV_FILTER_BILINEAR)) == 0)
                    bilinear = variants[k].times[run];
            }
            for (uint32_t k = 0; k < nvariants; k++)
                variants[k].times[run] /= bilinear;
        }
        for (uint32_t i = 0; i < count; i++)
            for (int ideal = 0; ideal < IDEALS; ideal++) {
                const struct footprint *f = &footprints[i];
                const double exact[FUNCTIONS] = {wave_mean(s->smooth, SMOOTH_WAVES, f, ideal),
                                                 wave_mean(s->noise, NOISE_WAVES, f, ideal),
                                                 grid_mean(NULL, 0, f, ideal)};
                for (uint32_t k = 0; k < nvariants; k++)
                    for (uint32_t c = 0; c < FUNCTIONS; c++) {
                        double error = (double)variants[k].values[i * FUNCTIONS + c] - exact[c];
                        variants[k].error[c][ideal][cell] += error * error;
                    }
            }
        for (uint32_t k = 0; k < nvariants; k++) {
            variants[k].cost[cell] = bench_median(variants[k].times, o->runs);
            for (int c = 0; c < FUNCTIONS; c++)
                for (int ideal = 0; ideal < IDEALS; ideal++) {
                    double *error = &variants[k].error[c][ideal][cell];
                    *error = 100 * sqrt(*error / count) / s->deviation[c];
                }
        }
    }
}

/* Every filter, and with interpolation between resolutions where that changes anything. */
static uint32_t make_variants(slv_cache *cache, const struct options *o, const struct scene *s,
                              slv_file_id file, struct variant *out) {
    static struct footprint probes[MAX_LOOKUPS];
    static slv_lookup lookups[MAX_LOOKUPS];
    uint32_t nvariants = 0, count = o->lookups;
    size_t bytes = (size_t)count * FUNCTIONS * sizeof(float);
    make_footprints(1, true, count, probes);
    for (uint32_t i = 0; i < count; i++)
        lookups[i] = lookup_at(s, file, &probes[i]);
    for (int filter = 0; filter < SLV_FILTER_COUNT; filter++)
        for (int lerp = 0; lerp < 2; lerp++) {
            slv_filter_params params = {
                .filter = (slv_filter)filter, .lerp = lerp, .sharpness = 0.5f};
            struct variant *v = &out[nvariants];
            memset(v, 0, sizeof *v);
            snprintf(v->name, sizeof v->name, "%s%s", slv_filter_name(params.filter),
                     lerp ? " lerp" : "");
            if (!(v->values = calloc(1, bytes)))
                bench_stop(SLV_ERROR_MEMORY);
            bench_stop(slv_sampler_create(cache, &params, &v->sampler));
            bench_stop(slv_sample_batch(v->sampler, lookups, count, v->values, FUNCTIONS, NULL));
            if (lerp && memcmp(v->values, v[-1].values, bytes) == 0) {
                slv_sampler_destroy(v->sampler);
                free(v->values);
            } else
                nvariants++;
        }
    return nvariants;
}

static void print_rows(const char *title, const struct variant *variants, uint32_t nvariants,
                       size_t offset, int decimals) {
    printf("%s\n%-18s     along u or v                      diagonal\n%-18s", title, "", "filter");
    for (int cell = 0; cell < CELLS; cell++)
        printf(cell == ELONGATIONS ? "   %6d" : "%6d", 1 << cell % ELONGATIONS);
    for (uint32_t k = 0; k < nvariants; k++) {
        const double *row = (const double *)(const void *)((const char *)&variants[k] + offset);
        printf("\n%-18s", variants[k].name);
        for (int cell = 0; cell < CELLS; cell++)
            printf(cell == ELONGATIONS ? "   %6.*f" : "%6.*f", decimals, row[cell]);
    }
    puts("\n");
}

static void print_json(const struct variant *variants, uint32_t nvariants) {
    for (uint32_t k = 0; k < nvariants; k++)
        for (int cell = 0; cell < CELLS; cell++) {
            printf("{\"filter\":\"%s\",\"anisotropy\":%d,\"diagonal\":%s,\"cost\":%.3f",
                   variants[k].name, 1 << cell % ELONGATIONS, cell < ELONGATIONS ? "false" : "true",
                   variants[k].cost[cell]);
            for (int c = 0; c < FUNCTIONS; c++)
                for (int ideal = 0; ideal < IDEALS; ideal++)
                    printf(",\"%s_%s\":%.3f", function_names[c], ideal_names[ideal],
                           variants[k].error[c][ideal][cell]);
            puts("}");
        }
}

/* The largest difference between what is known of waves and their sum over the grid, to the
 * deviation of the noise. */
static double check_grid(const struct scene *s) {
    struct footprint footprints[3];
    double most = 0;
    for (int cell = 0; cell < CELLS; cell++) {
        make_footprints(cell % ELONGATIONS, cell >= ELONGATIONS, 3, footprints);
        for (int i = 0; i < 3; i++)
            for (int ideal = 0; ideal < IDEALS; ideal++) {
                double exact = wave_mean(s->noise, NOISE_WAVES, &footprints[i], ideal);
                double sum = grid_mean(s->noise, NOISE_WAVES, &footprints[i], ideal);
                most = fmax(most, fabs(exact - sum));
            }
    }
    return most / s->deviation[1];
}

int main(int argc, char **argv) {
    static struct variant variants[MAX_VARIANTS];
    static struct scene scene;
    struct options o = {.lookups = 2048, .runs = 15};
    for (int i = 1; i < argc; i++) {
        const char *value = i + 1 < argc ? argv[i + 1] : "";
        if (strcmp(argv[i], "--smoke") == 0)
            o.lookups = 16, o.runs = 1;
        else if (strcmp(argv[i], "--json") == 0)
            o.json = true;
        else if (strcmp(argv[i], "--lookups") == 0 && ++i)
            o.lookups = (uint32_t)strtoul(value, NULL, 10);
        else if (strcmp(argv[i], "--runs") == 0 && ++i)
            o.runs = (uint32_t)strtoul(value, NULL, 10);
        else {
            fprintf(stderr, "usage: bench_filter_error [--lookups N] [--runs N] [--json] "
                            "[--smoke]\n");
            return 2;
        }
    }
    if (!o.lookups || o.lookups > MAX_LOOKUPS || !o.runs || o.runs > MAX_RUNS)
        return 2;
    slv_env env = {.log = bench_log};
    slv_cache *cache;
    slv_file_id file;
    char path[64];
    bench_temporary(path);
    write_scene(&env, path, &scene);
    bench_stop(slv_cache_create(&env, NULL, &cache));
    bench_stop(slv_cache_open(cache, path, &file));
    uint32_t nvariants = make_variants(cache, &o, &scene, file, variants);
    double wrong = check_grid(&scene);
    measure(&o, &scene, file, variants, nvariants);
    if (o.json)
        print_json(variants, nvariants);
    for (int c = 0; c < FUNCTIONS && !o.json; c++)
        for (int ideal = 0; ideal < IDEALS; ideal++) {
            char title[64];
            snprintf(title, sizeof title, "%s, error to the %s, %%", function_names[c],
                     ideal_names[ideal]);
            print_rows(title, variants, nvariants, offsetof(struct variant, error[c][ideal]), 1);
        }
    if (!o.json)
        print_rows("time, bilinear = 1", variants, nvariants, offsetof(struct variant, cost), 2);
    for (uint32_t k = 0; k < nvariants; k++) {
        slv_sampler_destroy(variants[k].sampler);
        free(variants[k].values);
    }
    slv_cache_destroy(cache);
    unlink(path);
    if (wrong > 1e-3)
        fprintf(stderr, BENCH_NAME ": sums over the grid are wrong by %.2g\n", wrong);
    return wrong > 1e-3;
}
