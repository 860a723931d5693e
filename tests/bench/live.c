/* Textures that live: CPU time of one changed rectangle, for each strategy, on few faces and on
 * many; the calls that upload the texture bit by bit, with `--making`, and `--mixed` where each
 * face has one of 16 resolutions at random; and one face that grows, with `--growing`. */
#include "kit/bench_kit.h"

#include <selvage/gl_live.h>

#include <string.h>

enum { ROUNDS = 100, SIDE = 6, CACHES = 64 << 20 };

typedef struct scene {
    uint32_t nfaces;
    slv_texture *texture;
    slv_adjacency *adjacency;
} scene;

static scene make_scene(const slv_env *env, uint32_t nfaces, int side, bool mixed) {
    scene s = {.nfaces = nfaces};
    slv_res *res = calloc(nfaces, sizeof *res);
    slv_face_adjacency *faces = calloc(nfaces, sizeof *faces);
    size_t size = ((size_t)3 << 2 * side);
    unsigned char *texels = malloc(size);
    uint32_t random = 7, columns = 1;
    if (!res || !faces || !texels)
        bench_stop(SLV_ERROR_MEMORY);
    while (columns * columns < nfaces)
        columns++;
    for (uint32_t f = 0; f < nfaces; f++) {
        res[f] = (slv_res){(int8_t)side, (int8_t)side};
        if (mixed) {
            res[f].u = (int8_t)(bench_random(&random) >> 16 & 3);
            res[f].v = (int8_t)(bench_random(&random) >> 16 & 3);
        }
        faces[f] = bench_grid_adjacency(f, columns, nfaces);
    }
    slv_texture_desc desc = {.nfaces = nfaces,
                             .type = SLV_TYPE_U8,
                             .nchannels = 3,
                             .alpha_channel = SLV_NO_ALPHA,
                             .res = res};
    bench_stop(slv_adjacency_create(env, nfaces, faces, NULL, &s.adjacency));
    bench_stop(slv_texture_create(env, &desc, &s.texture));
    for (uint32_t f = 0; f < nfaces; f++) {
        for (size_t i = 0; i < size; i++)
            texels[i] = (unsigned char)bench_random(&random);
        bench_stop(slv_texture_set_face(s.texture, f, texels));
    }
    free(res);
    free(faces);
    free(texels);
    return s;
}

/* A texture on the GPU that follows one of the scenes. */
typedef struct follower {
    slv_gl_texture *made;
    double creation, times[ROUNDS]; /* ms of CPU */
} follower;

static void follow(slv_gl *gl, const slv_env *env, const scene *s, const slv_strategy *strategy,
                   slv_texture_encoding encoding, follower *out) {
    const slv_strategy *const list[] = {strategy};
    slv_gl_texture_params params = {
        .strategies = list, .nstrategies = 1, .live = true, .encoding = encoding};
    double start = bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
    bench_stop(slv_gl_texture_create(gl, env, s->texture, s->adjacency, &params, &out->made));
    out->creation = 1e3 * (bench_seconds(CLOCK_PROCESS_CPUTIME_ID) - start);
}

/* The CPU time of an update of another face, in ms. */
static double update(const slv_env *env, const scene *s, const follower *f, int side,
                     uint32_t *random) {
    static unsigned char texels[3 << 2 * SIDE];
    uint32_t face = (uint32_t)((uint64_t)bench_random(random) * s->nfaces >> 32);
    slv_rect all = {0, 0, 1u << side, 1u << side};
    for (size_t k = 0; k < (size_t)3 << 2 * side; k++)
        texels[k] = (unsigned char)bench_random(random);
    bench_stop(slv_texture_set_rect(s->texture, face, all, texels));
    double start = bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
    bench_stop(slv_gl_texture_update(f->made, env, NULL));
    return 1e3 * (bench_seconds(CLOCK_PROCESS_CPUTIME_ID) - start);
}

/* Leaves nothing of the scenes in the processor's caches. */
static void empty_caches(void) {
    static volatile unsigned char other[CACHES];
    for (size_t i = 0; i < CACHES; i += 64)
        other[i]++;
}

/* The middle times of updating few faces and many by turns, so that what else the machine does
 * slows both; `cold` where caches are emptied before each change. */
static void compare(const slv_env *env, const scene scenes[2], follower followers[2], int side,
                    bool cold, double ms[2]) {
    uint32_t random = cold ? 13 : 11;
    for (uint32_t i = 0; i < ROUNDS + 2; i++)
        for (uint32_t k = 0; k < 2; k++) {
            if (cold)
                empty_caches();
            double took = update(env, &scenes[k], &followers[k], side, &random);
            if (i >= 2) /* the first make what later ones need */
                followers[k].times[i - 2] = took;
        }
    for (uint32_t k = 0; k < 2; k++)
        ms[k] = bench_median(followers[k].times, ROUNDS);
}

/* Makes a texture at once; then uploads one with a budget of 16 MiB a call, and prints how long
 * the calls were. */
static void show_making(slv_gl *gl, const slv_env *env, const scene *s,
                        const slv_strategy *strategy) {
    const slv_strategy *const list[] = {strategy};
    slv_gl_texture_params params = {.strategies = list, .nstrategies = 1};
    slv_gl_texture *made = NULL;
    slv_gl_upload upload = {0};
    double longest = 0, at = 0, total = 0, created = bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
    uint32_t calls = 0;
    bench_stop(slv_gl_texture_create(gl, env, s->texture, s->adjacency, &params, &made));
    created = bench_seconds(CLOCK_PROCESS_CPUTIME_ID) - created;
    slv_gl_texture_destroy(made);
    double prepared = bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
    bench_stop(slv_gl_texture_prepare(gl, env, s->texture, s->adjacency, &params, &made));
    prepared = bench_seconds(CLOCK_PROCESS_CPUTIME_ID) - prepared;
    for (; !upload.ready; calls++) {
        double start = bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
        bench_stop(slv_gl_texture_upload(made, env, UINT64_C(16) << 20, &upload));
        double took = bench_seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
        total += took;
        if (took > longest) {
            longest = took;
            at = upload.total ? (double)upload.done / (double)upload.total : 1;
        }
    }
    printf("%-14s %.2f s at once; %.2f s to prepare, %.2f s in %u calls, the longest %.1f ms (50) "
           "at %.1f %%; %u draws\n",
           strategy->name, created, prepared, total, calls, 1e3 * longest, 100 * at,
           slv_gl_texture_batch_count(made, strategy));
    fflush(stdout);
    slv_gl_texture_destroy(made);
}

/* The middle processor time of an update after one face, of one texel, has got four, in ms. */
static void show_growing(slv_gl *gl, const slv_env *env, const scene *s,
                         const slv_strategy *strategy) {
    enum { GROWN = 7 };
    static uint32_t random = 17; /* other faces for each strategy */
    unsigned char texels[12];
    follower f;
    double times[GROWN];
    follow(gl, env, s, strategy, SLV_TEXTURE_DATA, &f);
    for (uint32_t i = 0; i < GROWN; i++) {
        uint32_t face = (uint32_t)((uint64_t)bench_random(&random) * s->nfaces >> 32);
        for (size_t k = 0; k < sizeof texels; k++)
            texels[k] = (unsigned char)bench_random(&random);
        bench_stop(slv_texture_set_resolution(s->texture, face, (slv_res){1, 1}, texels));
        double start = bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
        bench_stop(slv_gl_texture_update(f.made, env, NULL));
        times[i] = 1e3 * (bench_seconds(CLOCK_PROCESS_CPUTIME_ID) - start);
    }
    printf("%-14s %8.2f ms\n", strategy->name, bench_median(times, GROWN));
    fflush(stdout);
    slv_gl_texture_destroy(f.made);
}

static bool is_left_out(const slv_strategy *strategy, const char *only) {
    return strategy->comparison || (only && strcmp(only, strategy->name) != 0);
}

enum mode { CHANGES, MAKING, MIXED, GROWING };

/* `--making [FACES [STRATEGY]]`: faces of 8 x 8 texels, or fewer; of one texel with `--growing`. */
static int run(slv_gl *gl, const slv_env *env, uint32_t nfaces, const char *only, enum mode mode) {
    scene s = make_scene(env, nfaces, mode == GROWING ? 0 : 3, mode == MIXED);
    for (uint32_t i = 0; i < slv_strategy_count(); i++)
        if (!is_left_out(slv_strategy_at(i), only))
            (mode == GROWING ? show_growing : show_making)(gl, env, &s, slv_strategy_at(i));
    slv_texture_destroy(s.texture);
    slv_adjacency_destroy(s.adjacency);
    slv_gl_destroy(gl);
    return 0;
}

static enum mode mode_of(const char *argument) {
    static const char *const names[] = {
        [MAKING] = "--making", [MIXED] = "--mixed", [GROWING] = "--growing"};
    for (enum mode mode = MAKING; argument && mode <= GROWING; mode++)
        if (strcmp(argument, names[mode]) == 0)
            return mode;
    return CHANGES;
}

int main(int argc, char **argv) {
    bool smoke = argc > 1 && strcmp(argv[1], "--smoke") == 0;
    int side = smoke ? 3 : SIDE;
    uint32_t counts[] = {smoke ? 16 : 1000, smoke      ? 64
                                            : argc > 2 ? (uint32_t)atoi(argv[2])
                                                       : 100000};
    slv_env env = {.log = bench_log, .max_bytes = UINT64_C(64) << 30};
    slv_gl *gl = NULL;
    scene scenes[2];
    bench_bars bars = {0};
    bench_stop(slv_gl_create(&env, SLV_GL_AUTO, &gl));
    enum mode mode = mode_of(argv[1]);
    if (mode)
        return run(gl, &env, argc > 2 ? (uint32_t)atoi(argv[2]) : 1000000,
                   argc > 3 ? argv[3] : NULL, mode);
    for (uint32_t k = 0; k < 2; k++)
        scenes[k] = make_scene(&env, counts[k], side, false);
    printf("a rectangle of %u x %u texels, ms of CPU; in brackets making the texture\n", 1u << side,
           1u << side);
    for (uint32_t i = 0; i < slv_strategy_count(); i++) {
        const slv_strategy *strategy = slv_strategy_at(i);
        if (is_left_out(strategy, argc > 1 && !smoke ? argv[1] : NULL))
            continue;
        for (uint32_t e = 0; e < 2; e++) {
            slv_texture_encoding encoding = e ? SLV_TEXTURE_SRGB : SLV_TEXTURE_DATA;
            follower followers[2];
            double ms[2], cold[2];
            for (uint32_t k = 0; k < 2; k++)
                follow(gl, &env, &scenes[k], strategy, encoding, &followers[k]);
            compare(&env, scenes, followers, side, false, ms);
            compare(&env, scenes, followers, side, true, cold);
            printf("%-14s %-5s %8.3f on %u faces (%.0f), %8.3f on %u (%.0f)\n", strategy->name,
                   slv_texture_encoding_name(encoding), ms[0], counts[0], followers[0].creation,
                   ms[1], counts[1], followers[1].creation);
            bench_bar(&bars, false, "  on many", "ms", ms[1],
                      strategy->reach == SLV_GL_REACH_SQUARES ? 5 : 2, true);
            bench_bar(&bars, false, "  of that on few", "times", ms[1] / ms[0], 1.3, true);
            bench_bar(&bars, false, "  the same, caches empty before each", "times",
                      cold[1] / cold[0], 1.3, true);
            for (uint32_t k = 0; k < 2; k++)
                slv_gl_texture_destroy(followers[k].made);
            fflush(stdout);
        }
    }
    bench_bars_end(&bars, false);
    for (uint32_t k = 0; k < 2; k++) {
        slv_texture_destroy(scenes[k].texture);
        slv_adjacency_destroy(scenes[k].adjacency);
    }
    slv_gl_destroy(gl);
    return 0;
}
