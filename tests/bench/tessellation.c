/* What faces cost that are divided each as the picture needs, against all alike and the finest:
 * triangles, processor time of frames, and pixels that differ from the finest. Frames are
 * interleaved and medians compared. On the demo scene; and on a torus of many faces, near and far
 * away, beside one of few that covers the same pixels, and nothing at all. */
#include "kit/bench_scene.h"

#include <selvage/gl_renderer.h>

#include <string.h>

enum { MAX_FRAMES = 101, WAYS = 3 };

typedef struct options {
    uint32_t frames, few, width, height, faces, finest;
    bool json;
} options;

static const slv_env env = {.log = bench_log};

/* Ways to divide one surface, and how each does. */
typedef struct way {
    const char *name;
    uint32_t segments;
    slv_gl_renderer *renderer;
    double seconds[MAX_FRAMES], frame, made; /* of frames, their median, and of dividing */
    slv_image image;
} way;

static void report(const options *o, const char *scene, const way *w, const char *what,
                   const char *unit, double value) {
    char text[96];
    snprintf(text, sizeof text, "%s, %s: %s", scene, w->name, what);
    bench_report(o->json, text, unit, value);
}

static double off_pixels(const slv_image *a, const slv_image *b) {
    size_t count = 0, all = (size_t)a->width * a->height;
    for (size_t i = 0; i < all; i++) {
        float apart = 0;
        for (size_t c = 0; c < 3; c++)
            apart = fmaxf(apart, fabsf(a->pixels[4 * i + c] - b->pixels[4 * i + c]));
        count += apart > 2.0f / 255;
    }
    return 100 * (double)count / (double)all;
}

/* Processor time of a frame, all threads of the driver together. */
static double draw(slv_gl_renderer *renderer, slv_gl_texture *texture, const slv_frame *frame) {
    double start = bench_seconds(CLOCK_PROCESS_CPUTIME_ID), waited; /* until it is there */
    bench_stop(slv_gl_renderer_draw(renderer, &env, texture, frame, NULL, &waited));
    return bench_seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
}

static double covered(const slv_image *image) {
    size_t count = 0, all = (size_t)image->width * image->height;
    for (size_t i = 0; i < all; i++)
        count += image->pixels[4 * i + 3] > 0;
    return (double)count;
}

/* The last way is the one that pictures are held against; of it `o->few` frames are timed. */
static void measure(const options *o, slv_gl *gl, const char *scene, const slv_mesh *mesh,
                    const slv_surface *surface, slv_gl_texture *texture, const slv_frame *frame,
                    way ways[WAYS]) {
    for (uint32_t i = 0; i < WAYS; i++) {
        const slv_tessellation_params params = {.segments = ways[i].segments,
                                                .camera = &frame->camera,
                                                .width = frame->width,
                                                .height = frame->height};
        double start = bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
        bench_stop(
            slv_gl_renderer_create_with(gl, &env, mesh, surface, &params, &ways[i].renderer));
        ways[i].made = bench_seconds(CLOCK_PROCESS_CPUTIME_ID) - start;
        bench_stop(
            slv_gl_renderer_draw(ways[i].renderer, &env, texture, frame, &ways[i].image, NULL));
    }
    for (uint32_t f = 0; f < o->frames; f++)
        for (uint32_t i = 0; i < WAYS; i++)
            if (i + 1 < WAYS || f < o->few)
                ways[i].seconds[f] = draw(ways[i].renderer, texture, frame);
    for (uint32_t i = 0; i < WAYS; i++) {
        way *w = &ways[i];
        report(o, scene, w, "triangles", "", (double)slv_gl_renderer_triangles(w->renderer));
        report(o, scene, w, "processor time to divide", "ms", 1000 * w->made);
        w->frame = bench_median(w->seconds, i + 1 < WAYS ? o->frames : o->few);
        report(o, scene, w, "processor time of a frame", "ms", 1000 * w->frame);
        if (i + 1 < WAYS)
            report(o, scene, w, "pixels off by more than 2/255", "%",
                   off_pixels(&w->image, &ways[WAYS - 1].image));
    }
    report(o, scene, &ways[1], "pixels that it covers", "", covered(&ways[1].image));
    report(o, scene, &ways[1], "as fast as all alike", "times", ways[0].frame / ways[1].frame);
    report(o, scene, &ways[1], "as fast as the finest", "times",
           ways[WAYS - 1].frame / ways[1].frame);
    for (uint32_t i = 0; i < WAYS; i++) {
        slv_image_free(&ways[i].image);
        slv_gl_renderer_destroy(ways[i].renderer);
    }
}

static void demo(const options *o, slv_gl *gl, const char *folder) {
    char obj[BENCH_PATH + 32], texels[BENCH_PATH + 32];
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL;
    slv_gl_texture *uploaded = NULL;
    slv_mesh_stats stats;
    const slv_strategy *strategy = slv_strategy_default();
    const slv_gl_texture_params params = {.strategies = &strategy, .nstrategies = 1};
    snprintf(obj, sizeof obj, "%s/scene.obj", folder);
    snprintf(texels, sizeof texels, "%s/scene.ptx", folder);
    bench_stop(slv_mesh_load(&env, obj, &mesh));
    bench_stop(slv_ptx_open(&env, texels, &ptx));
    bench_stop(slv_ptx_load_texture(&env, ptx, &texture));
    bench_stop(slv_mesh_adjacency(&env, mesh, &adjacency));
    bench_stop(slv_mesh_get_stats(&env, mesh, &stats));
    bench_stop(slv_surface_create(&env, mesh, NULL, &surface));
    bench_stop(slv_gl_texture_create(gl, &env, texture, adjacency, &params, &uploaded));
    const slv_frame frame = {.width = o->width,
                             .height = o->height,
                             .msaa = 4,
                             .camera = slv_camera_orbit(stats.bounds_min, stats.bounds_max, 30, 20,
                                                        35, (float)o->width / (float)o->height)};
    way ways[WAYS] = {
        {.name = "all alike",
         .segments = slv_tessellation_for(mesh, &frame.camera, frame.width, frame.height)},
        {.name = "face by face"},
        {.name = "the finest", .segments = o->finest}};
    measure(o, gl, "demo scene", mesh, surface, uploaded, &frame, ways);
    slv_gl_texture_destroy(uploaded);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
    slv_mesh_destroy(mesh);
}

/* A ring of `side` * `side` faces, so many times as far away as fills the picture. */
static void far_away(const options *o, slv_gl *gl, const char *name, uint32_t side, float away) {
    bench_torus torus = bench_torus_make(&env, side, side);
    const uint32_t nfaces = side * side;
    const float low[3] = {-3 * away, -away, -3 * away}, high[3] = {3 * away, away, 3 * away};
    slv_res *res = calloc(nfaces, sizeof *res);
    slv_texture *texture = NULL;
    slv_gl_texture *uploaded = NULL;
    const slv_strategy *strategy = slv_strategy_default();
    const slv_gl_texture_params params = {.strategies = &strategy, .nstrategies = 1};
    const slv_texture_desc desc = {nfaces, SLV_TYPE_U8, 1, SLV_NO_ALPHA, res, SLV_TEXTURE_LINEAR};
    const uint8_t grey = 128;
    if (!res)
        bench_stop(SLV_ERROR_MEMORY);
    bench_stop(slv_texture_create(&env, &desc, &texture));
    for (uint32_t f = 0; f < nfaces; f++)
        bench_stop(slv_texture_set_constant(texture, f, &grey));
    bench_stop(slv_gl_texture_create(gl, &env, texture, torus.adjacency, &params, &uploaded));
    const slv_frame frame = {
        .width = o->width,
        .height = o->height,
        .msaa = 4,
        .camera = slv_camera_orbit(low, high, 30, 40, 35, (float)o->width / (float)o->height)};
    way ways[WAYS] = {
        {.name = "all alike",
         .segments = slv_tessellation_for(torus.mesh, &frame.camera, frame.width, frame.height)},
        {.name = "face by face"},
        {.name = "the finest", .segments = 4}};
    measure(o, gl, name, torus.mesh, torus.surface, uploaded, &frame, ways);
    slv_gl_texture_destroy(uploaded);
    slv_texture_destroy(texture);
    bench_torus_free(&torus);
    free(res);
}

static bool parse(int argc, char **argv, options *o) {
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--json") == 0)
            o->json = true;
        else if (strcmp(argv[i], "--smoke") == 0)
            *o = (options){
                .frames = 1, .few = 1, .width = 96, .height = 54, .faces = 20, .finest = 8};
        else
            return false;
    }
    return true;
}

int main(int argc, char **argv) {
    options o = {.frames = 15, .few = 3, .width = 960, .height = 540, .faces = 320, .finest = 64};
    char folder[BENCH_PATH] = "";
    slv_gl *gl = NULL;
    if (!parse(argc, argv, &o)) {
        fputs("usage: " BENCH_NAME " [--json] [--smoke]\n", stderr);
        return 2;
    }
    bench_stop(slv_gl_create(&env, SLV_GL_AUTO, &gl));
    if (!bench_scene_make(argv[0], folder))
        return 1;
    demo(&o, gl, folder);
    far_away(&o, gl, "many faces", o.faces, 1);
    far_away(&o, gl, "many faces, 10 times as far", o.faces, 10);
    far_away(&o, gl, "few faces, 10 times as far", 32, 10);
    far_away(&o, gl, "many faces, 100 times as far", o.faces, 100);
    far_away(&o, gl, "nearly nothing", 4, 10000);
    bench_scene_remove(folder);
    slv_gl_destroy(gl);
    return 0;
}
