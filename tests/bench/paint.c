/* bench_paint [--threads N] [--faces N] [--strokes N] [--smoke]
 *
 * Dabs on meshes of 10 thousand, 100 thousand and a million faces (or of N): one that covers 100
 * thousand texels, and one of two thousand. First from the dab to the texels of a store; then the
 * whole way, from the dab on a layer of a document to what the GPU holds (levels, borders, corners;
 * the software driver's threads count), on faces that were painted before and on faces that had one
 * value; and its undo. Then strokes of two sessions in turns: the last of N (10 thousand) beside
 * the tenth on. And layers of other resolutions than the document's, flattened beside one of its
 * own. Medians of the processor's time, since others may use the machine. And what is allocated a
 * dab once it goes on. */
#include "kit/bench_kit.h"
#include "kit/count_kit.h"

#include <selvage/document.h>
#include <selvage/gl_live.h>
#include <selvage/gl_strategy.h>
#include <selvage/lay.h>
#include <selvage/session.h>
#include <selvage/threads.h>

#include <string.h>

static double now(void) {
    return 1e3 * bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
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

typedef struct scene {
    const slv_env *env;
    slv_gl *gl;
    uint32_t side;
    slv_painter *painter;
    const slv_adjacency *adjacency;
    slv_res *res;
    float radius;
} scene;

/* The i-th of the places, which are the same each time; of the faces' middle part. */
static slv_dab dab_at(const scene *s, uint32_t i, float wider) {
    uint32_t state = 7 + 7919 * i;
    for (int k = 0; k < 8; k++)
        bench_random(&state);
    uint32_t x = (uint32_t)((float)s->side * (0.2f + 0.6f * bench_random_unit(&state))),
             y = (uint32_t)((float)s->side * (0.2f + 0.6f * bench_random_unit(&state)));
    float u = bench_random_unit(&state), v = bench_random_unit(&state);
    return (slv_dab){
        .at = {(int32_t)(y * s->side + x), u, v}, .radius = wider * s->radius, .hardness = 0.6f};
}

static slv_patches put_dab(const scene *s, const slv_res *res, const slv_canvas *canvas, uint32_t i,
                           float wider) {
    /* another one each time, or what lies in many ends as one value */
    const slv_paint paint = {.color = {0.8f, 0.2f, (float)(i % 7) / 7}, .opacity = 0.2f};
    const slv_dab dab = dab_at(s, i, wider);
    slv_patches patches;
    bench_stop(slv_painter_cover(s->painter, res, &dab, &patches));
    bench_stop(slv_painter_apply(s->painter, canvas, &patches, &paint));
    return patches;
}

enum { MOST = 64 };

/* From the dab to a store. */
static void time_store(const scene *s, uint32_t count) {
    static double times[MOST];
    slv_texture *texture = NULL;
    const slv_texture_desc desc = {.nfaces = s->side * s->side,
                                   .type = SLV_TYPE_U16,
                                   .nchannels = 4,
                                   .alpha_channel = 3,
                                   .res = s->res};
    double texels = 0;
    uint32_t faces = 0;
    unsigned long before = 0;
    bench_stop(slv_texture_create(s->env, &desc, &texture));
    const slv_canvas canvas = slv_texture_as_canvas(texture);
    for (uint32_t i = 0; i < 2 * count; i++) {
        /* the same places again: faces that were constant have room by then */
        if (i == count)
            before = atomic_load(&allocations);
        double begin = now();
        slv_patches patches = put_dab(s, desc.res, &canvas, i % count, 1);
        if (i < count)
            continue;
        times[i - count] = now() - begin;
        faces += patches.count;
        for (uint32_t k = 0; k < patches.count; k++) {
            size_t n = (size_t)patches.list[k].rect.width * patches.list[k].rect.height;
            for (size_t t = 0; t < n; t++)
                texels += patches.list[k].coverage[t] > 0;
        }
    }
    printf("  %ux%u texels a face, radius %.2f faces: %.0f texels on %u faces\n", 1u << s->res->u,
           1u << s->res->v, (double)s->radius, texels / count, faces / count);
    printf("    to a store                  %8.3f ms, %.2f allocations\n",
           bench_median(times, count), (double)(atomic_load(&allocations) - before) / count);
    fflush(stdout);
    slv_texture_destroy(texture);
}

/* What is allocated for dabs with an image, a mask of faces and of an angle, and a symmetry, once
 * places have been painted. */
static void count_laid(const scene *s) {
    static float pixels[3 * 16 * 16];
    const slv_image image = {.width = 16, .height = 16, .nchannels = 3, .pixels = pixels};
    const uint32_t faces[2] = {0, s->side}, nfaces = s->side * s->side;
    const unsigned edges[2] = {2, 0};
    const slv_paint paint = {.opacity = 0.2f};
    uint8_t *masked = malloc(nfaces);
    slv_symmetry *symmetry = NULL;
    slv_texture *texture = NULL;
    const slv_texture_desc desc = {.nfaces = nfaces,
                                   .type = SLV_TYPE_HALF,
                                   .nchannels = 3,
                                   .alpha_channel = -1,
                                   .res = s->res};
    unsigned long before = 0;
    if (!masked)
        bench_stop(SLV_ERROR_MEMORY);
    memset(masked, 1, nfaces);
    for (uint32_t i = 0; i < 3 * 16 * 16; i++)
        pixels[i] = (float)(i * 7 % 16) / 16;
    bench_stop(slv_texture_create(s->env, &desc, &texture));
    bench_stop(slv_symmetry_create(s->env, s->adjacency, faces, edges, &symmetry, NULL));
    const slv_canvas canvas = slv_texture_as_canvas(texture);
    const slv_lay lay = {.ink = {.kind = SLV_INK_STAMP, .image = &image},
                         .mask = {.faces = masked, .towards = {0, 0, 1}, .degrees = 60},
                         .symmetry = symmetry};
    for (uint32_t i = 0; i < 16; i++) {
        slv_dab dab = dab_at(s, i % 8, 1);
        slv_patches patches;
        dab.unfold = true;
        if (i == 8)
            before = atomic_load(&allocations);
        bench_stop(slv_painter_cover(s->painter, desc.res, &dab, &patches));
        bench_stop(slv_painter_lay(s->painter, &canvas, &patches, &paint, &lay, &dab, NULL));
    }
    printf("    stamped, masked, mirrored: %.2f allocations\n",
           (double)(atomic_load(&allocations) - before) / 8);
    slv_texture_destroy(texture);
    slv_symmetry_destroy(symmetry);
    free(masked);
}

/* A document of two layers, and what the GPU has of it. */
typedef struct way {
    const scene *s;
    slv_document *document;
    slv_canvas canvas[2];
    slv_gl_texture *texture;
    void (*finish)(void);
} way;

enum { DAB, FLATTEN, UPDATE, ALL, STEPS };

static way begin_way(const scene *s) {
    way w = {.s = s, .finish = slv_gl_get_function(s->gl, "glFinish")};
    const slv_strategy *const list[] = {slv_strategy_find("borders")};
    const slv_gl_texture_params params = {.strategies = list, .nstrategies = 1, .live = true};
    const slv_document_params flat = {.flat = {.nfaces = s->side * s->side,
                                               .type = SLV_TYPE_U8,
                                               .nchannels = 3,
                                               .alpha_channel = SLV_NO_ALPHA,
                                               .res = s->res}};
    bench_stop(slv_document_create(s->env, &flat, s->adjacency, &w.document));
    for (int i = 0; i < 2; i++) {
        uint32_t layer;
        bench_stop(slv_document_add_layer(w.document, NULL, &layer));
        bench_stop(slv_document_canvas(w.document, layer, false, &w.canvas[i]));
    }
    bench_stop(slv_document_flatten(w.document));
    bench_stop(slv_gl_texture_create(s->gl, s->env, slv_document_texture(w.document), s->adjacency,
                                     &params, &w.texture));
    return w;
}

/* What follows a change of layers, until the driver has it; adds up in times[..][i]. */
static void show(const way *w, double times[STEPS][MOST], uint32_t i) {
    double begin = now();
    bench_stop(slv_document_flatten(w->document));
    times[FLATTEN][i] = now() - begin;
    begin = now();
    bench_stop(slv_gl_texture_update(w->texture, w->s->env, NULL));
    w->finish();
    times[UPDATE][i] = now() - begin;
    times[ALL][i] = times[DAB][i] + times[FLATTEN][i] + times[UPDATE][i];
}

static void print_times(const char *what, double times[STEPS][MOST], uint32_t count) {
    double median[STEPS];
    for (int k = 0; k < STEPS; k++)
        median[k] = bench_median(times[k], count);
    printf("    %-27s %8.3f ms: %.3f, flattened %.3f, to the GPU %.3f", what, median[ALL],
           median[DAB], median[FLATTEN], median[UPDATE]);
}

/* A dab to the GPU on a layer: which of the two, where it is new and where others were before. */
static void time_way(const scene *s, uint32_t count) {
    static double first[STEPS][MOST], again[STEPS][MOST], undo[STEPS][MOST];
    way w = begin_way(s);
    const slv_res *res = slv_document_get_desc(w.document)->res;
    unsigned long before, allocated = 0;
    for (uint32_t i = 0; i < count; i++) {
        double begin = now();
        bench_stop(slv_document_begin(w.document, "dab"));
        put_dab(s, res, &w.canvas[0], i, 1);
        bench_stop(slv_document_end(w.document));
        first[DAB][i] = now() - begin;
        show(&w, first, i);
        /* so that all faces of the next dab there, and those around it, have more than one value */
        put_dab(s, res, &w.canvas[0], i, 1.2f);
        show(&w, again, i);
    }
    for (uint32_t i = 0; i < count; i++) {
        double begin = now();
        bench_stop(slv_document_begin(w.document, "dab"));
        put_dab(s, res, &w.canvas[1], i, 1);
        again[DAB][i] = now() - begin;
        show(&w, again, i);
        before = atomic_load(&allocations); /* a stroke goes on there */
        put_dab(s, res, &w.canvas[1], i, 1);
        bench_stop(slv_document_flatten(w.document));
        bench_stop(slv_gl_texture_update(w.texture, s->env, NULL));
        allocated += atomic_load(&allocations) - before;
        bench_stop(slv_document_end(w.document));
        begin = now();
        bench_stop(slv_document_undo(w.document));
        undo[DAB][i] = now() - begin;
        show(&w, undo, i);
    }
    print_times("on blank faces", first, count);
    print_times("\n    on a layer over others", again, count);
    printf(", %.2f allocations\n", (double)allocated / count);
    print_times("undo", undo, count);
    printf("\n");
    fflush(stdout);
    slv_gl_texture_destroy(w.texture);
    slv_document_destroy(w.document);
}

static void run(const slv_env *env, slv_gl *gl, uint32_t faces, bool smoke) {
    static const struct {
        int8_t log2;
        float radius;
    } dabs[] = {{5, 5.58f}, {5, 0.79f}, {2, 44.6f}};
    scene s = {.env = env, .gl = gl, .side = (uint32_t)sqrt((double)faces)};
    double begin = bench_seconds(CLOCK_MONOTONIC);
    slv_mesh *mesh = make_mesh(env, s.side);
    slv_paint_surface *surface = NULL;
    bench_stop(slv_paint_surface_create(env, mesh, NULL, &surface));
    bench_stop(slv_painter_create(env, surface, &s.painter));
    s.adjacency = slv_paint_surface_adjacency(surface);
    printf("%u faces: surface made in %.1f s\n", s.side * s.side,
           bench_seconds(CLOCK_MONOTONIC) - begin);
    if (!(s.res = malloc(sizeof *s.res * s.side * s.side)))
        bench_stop(SLV_ERROR_MEMORY);
    for (size_t d = 0; d < sizeof dabs / sizeof *dabs; d++) {
        for (uint32_t i = 0; i < s.side * s.side; i++)
            s.res[i] = (slv_res){dabs[d].log2, dabs[d].log2};
        s.radius = dabs[d].radius;
        time_store(&s, smoke ? 2 : MOST);
        if (d == 0)
            count_laid(&s);
        time_way(&s, smoke ? 2 : MOST / 2);
    }
    free(s.res);
    slv_painter_destroy(s.painter);
    slv_paint_surface_destroy(surface);
    slv_mesh_destroy(mesh);
}

/* Of the thread that paints, of all threads, and on the wall. */
enum { CLOCKS = 3 };

/* Since `begin`; of that as zeros, what the clocks say. */
static void time_since(const double begin[CLOCKS], double out[CLOCKS]) {
    static const clockid_t clocks[CLOCKS] = {CLOCK_THREAD_CPUTIME_ID, CLOCK_PROCESS_CPUTIME_ID,
                                             CLOCK_MONOTONIC};
    for (int k = 0; k < CLOCKS; k++)
        out[k] = 1e3 * bench_seconds(clocks[k]) - begin[k];
}

/* A stroke of a session, as a window makes it: told in samples, shown, and in the journal. */
static void time_stroke(slv_session *session, uint32_t i, uint32_t side, double times[CLOCKS]) {
    static const char line[] = "{\"radius\":0.79,\"color\":[0.8,0.3,0.2],\"opacity\":0.3}";
    uint32_t state = 7 + 7919 * i, face;
    for (int k = 0; k < 8; k++)
        bench_random(&state);
    face = (uint32_t)((float)(side * side) * bench_random_unit(&state));
    double begin[CLOCKS] = {0};
    time_since(begin, begin);
    bench_stop(slv_session_stroke_begin(session, 2, false, NULL, line, sizeof line - 1));
    for (int k = 0; k < 3; k++) {
        const slv_stroke_sample sample = {
            .at = {(int32_t)face, 0.2f + 0.3f * (float)k, 0.5f}, .pressure = 1, .time = 0.01 * k};
        bench_stop(slv_session_stroke_add(session, &sample, 1));
        bench_stop(slv_document_flatten(slv_session_document(session)));
    }
    bench_stop(slv_session_stroke_end(session, NULL));
    bench_stop(slv_document_flatten(slv_session_document(session)));
    time_since(begin, times);
}

/* Saved and opened again, so that nothing is left to undo. */
static slv_result reopen(const slv_env *env, const char *path, const slv_session_params *params,
                         slv_session **session) {
    slv_result result = slv_session_save(*session);
    slv_session_destroy(*session);
    *session = NULL;
    return result ? result : slv_session_open(env, path, params, session);
}

/* Whether strokes take longer the more there were: in turns in a session of few and in one of very
 * many, so that whatever else the machine does meets both; the undo of the last ones, too. Both
 * have the same texels, or it would be the processor's caches that are compared. */
static void run_strokes(const slv_env *env, uint32_t side, uint32_t count) {
    enum { AROUND = 400, FEW = 10, PLACES = 1000000 };
    static double times[2][CLOCKS][AROUND], undo[AROUND];
    double took[CLOCKS];
    static const char *const clocks[CLOCKS] = {"of the thread that paints", "of all threads",
                                               "on the wall"};
    const uint32_t nfaces = side * side, some = count / 4 < AROUND ? count / 4 : AROUND;
    char folder[64], path[96], remove[96];
    slv_res *res = malloc(sizeof *res * nfaces);
    slv_mesh *mesh = make_mesh(env, side);
    slv_texture *texture = NULL;
    slv_session *sessions[2] = {NULL};
    const slv_session_params params = {.relaxed = true}; /* the disk is nobody's processor */
    snprintf(folder, sizeof folder, "/tmp/" BENCH_NAME "_XXXXXX");
    if (!res || !mkdtemp(folder))
        bench_stop(SLV_ERROR_IO);
    for (uint32_t i = 0; i < nfaces; i++)
        res[i] = (slv_res){5, 5};
    const slv_texture_desc desc = {
        .nfaces = nfaces, .type = SLV_TYPE_U8, .nchannels = 3, .alpha_channel = -1, .res = res};
    bench_stop(slv_texture_create(env, &desc, &texture));
    for (int k = 0; k < 2; k++) {
        snprintf(path, sizeof path, "%s/%d.selvage", folder, k);
        bench_stop(slv_session_create_from(env, path, mesh, texture, &params, &sessions[k]));
        for (uint32_t i = 0; i < some; i++)
            time_stroke(sessions[k], PLACES + i, side, took);
        for (uint32_t i = 0; i < count - 2 * some; i++)
            time_stroke(sessions[k], i, side, took);
        if (k == 0) { /* the texels are the same, the history has FEW */
            bench_stop(reopen(env, path, &params, &sessions[k]));
            for (uint32_t i = 0; i < FEW; i++)
                time_stroke(sessions[k], i, side, took);
        }
    }
    for (uint32_t i = 0; i < 2 * some; i++) {
        uint32_t which = (i + i / 2) % 2; /* either first */
        time_stroke(sessions[which], PLACES + i / 2, side, took);
        for (int k = 0; k < CLOCKS; k++)
            times[which][k][i / 2] = took[k];
    }
    for (uint32_t i = 0; i < some; i++) {
        double begin = now();
        bench_stop(slv_document_undo(slv_session_document(sessions[1])));
        bench_stop(slv_document_flatten(slv_session_document(sessions[1])));
        undo[i] = now() - begin;
    }
    printf("strokes of a session of %u faces, %u in turns from the %uth on and up to the %uth; "
           "undo of the last %.3f ms\n",
           nfaces, some, FEW, count, bench_median(undo, some));
    for (int k = 0; k < CLOCKS; k++) {
        double first = bench_median(times[0][k], some), last = bench_median(times[1][k], some);
        double sums[2] = {0};
        for (uint32_t i = 0; i < 2 * some; i++)
            sums[i % 2] += times[i % 2][k][i / 2];
        printf("    %-25s %8.3f ms, %.3f ms: %.2f times; in the mean %.2f\n", clocks[k], first,
               last, last / first, sums[1] / sums[0]);
    }
    for (int k = 0; k < 2; k++)
        slv_session_destroy(sessions[k]);
    slv_texture_destroy(texture);
    slv_mesh_destroy(mesh);
    free(res);
    snprintf(remove, sizeof remove, "rm -rf %s", folder);
    if (system(remove) != 0)
        bench_stop(SLV_ERROR_IO);
}

/* Random texels in all faces of a layer, which is shown and hidden; the median for one that has the
 * document's resolution is returned, and what the others take of it is printed. */
static double time_layer(const slv_env *env, const slv_adjacency *adjacency, int8_t log2,
                         const slv_res own[9], double same) {
    slv_res res[9];
    slv_document *document = NULL;
    slv_texture *texture = NULL;
    slv_layer_props props = {.opacity = 1};
    uint32_t layer, state = 7;
    double times[MOST];
    for (int i = 0; i < 9; i++)
        res[i] = (slv_res){log2, log2};
    const slv_document_params params = {.flat = {.nfaces = 9,
                                                 .type = SLV_TYPE_U8,
                                                 .nchannels = 3,
                                                 .alpha_channel = SLV_NO_ALPHA,
                                                 .res = res}};
    slv_texture_desc desc = params.flat;
    desc.res = own;
    uint8_t *texels = malloc((size_t)3 << 2 * (log2 + 1));
    if (!texels)
        bench_stop(SLV_ERROR_MEMORY);
    for (size_t i = 0; i < (size_t)3 << 2 * (log2 + 1); i++)
        texels[i] = (uint8_t)(bench_random(&state) >> 24);
    bench_stop(slv_texture_create(env, &desc, &texture));
    for (uint32_t face = 0; face < 9; face++)
        bench_stop(slv_texture_set_rect(
            texture, face, (slv_rect){0, 0, 1u << own[face].u, 1u << own[face].v}, texels));
    bench_stop(slv_document_create(env, &params, adjacency, &document));
    bench_stop(slv_document_add_layer(document, NULL, &layer));
    bench_stop(slv_document_load_layer(document, layer, texture));
    bench_stop(slv_document_flatten(document));
    for (uint32_t i = 0; i < 9; i++) {
        props.opacity = i % 2 ? 1 : 0.5f;
        bench_stop(slv_document_set_layer(document, layer, &props));
        double begin = now();
        bench_stop(slv_document_flatten(document));
        times[i] = now() - begin;
    }
    const double median = bench_median(times, 9);
    printf("    a layer of %4d x %-4d and %4d x %-4d %8.2f ms, %.2f times\n", 1 << own[0].u,
           1 << own[0].v, 1 << own[1].u, 1 << own[1].v, median, same > 0 ? median / same : 1);
    slv_document_destroy(document);
    slv_texture_destroy(texture);
    free(texels);
    return median;
}

static void run_resolutions(const slv_env *env, int8_t log2) {
    static const int8_t by[][2] = {{0, 0}, {-1, -1}, {-3, -3}, {1, 1}, {-6, -1}};
    slv_mesh *mesh = make_mesh(env, 3);
    slv_adjacency *adjacency = NULL;
    double same = 0;
    bench_stop(slv_mesh_adjacency(env, mesh, &adjacency));
    printf("9 faces of %d x %d flattened\n", 1 << log2, 1 << log2);
    for (size_t k = 0; k < sizeof by / sizeof *by; k++) {
        slv_res own[9];
        for (int i = 0; i < 9; i++) /* every other face */
            own[i] = (slv_res){(int8_t)(log2 + by[k][i % 2]), (int8_t)(log2 + by[k][i % 2])};
        const double median = time_layer(env, adjacency, log2, own, same);
        same = k ? same : median;
    }
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
}

int main(int argc, char **argv) {
    slv_env env = {.log = bench_log, .allocate = count_allocation, .release = count_release};
    slv_threads *threads = NULL;
    slv_gl *gl = NULL;
    uint32_t faces = 0, strokes = 10000;
    bool smoke = false;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--smoke") == 0)
            smoke = true;
        else if (strcmp(argv[i], "--threads") == 0 && i + 1 < argc)
            env.threads = (uint32_t)strtoul(argv[++i], NULL, 10);
        else if (strcmp(argv[i], "--faces") == 0 && i + 1 < argc)
            faces = (uint32_t)strtoul(argv[++i], NULL, 10);
        else if (strcmp(argv[i], "--strokes") == 0 && i + 1 < argc)
            strokes = (uint32_t)strtoul(argv[++i], NULL, 10);
        else
            return fprintf(stderr, "usage: " BENCH_NAME
                                   " [--threads N] [--faces N] [--strokes N] [--smoke]\n"),
                   2;
    }
    bench_stop(slv_threads_create(&env, &threads));
    slv_threads_use(threads, &env);
    bench_stop(slv_gl_create(&env, SLV_GL_AUTO, &gl));
    printf("%ld processors, %u threads; milliseconds of processor time\n",
           sysconf(_SC_NPROCESSORS_ONLN), env.threads);
    if (smoke) {
        run(&env, gl, 400, true);
        run_strokes(&env, 10, 24);
    } else if (faces) {
        run(&env, gl, faces, false);
        run_strokes(&env, (uint32_t)sqrt((double)faces), strokes);
    } else {
        for (uint32_t n = 10000; n <= 1000000; n *= 10)
            run(&env, gl, n, false);
        run_strokes(&env, 100, strokes);
    }
    run_resolutions(&env, smoke ? 6 : 9);
    slv_gl_destroy(gl);
    slv_threads_destroy(threads);
    return 0;
}
