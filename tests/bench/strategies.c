/* How long a frame takes with each strategy, as a ratio to clamp. Frames of all strategies are
 * interleaved, so that whatever else the machine does falls on all alike; medians are compared.
 * Uses the demo scene that selvage-assets makes. */
#include "kit/bench_scene.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_renderer.h>

#include <string.h>

enum { MAX_FRAMES = 999, MAX_STRATEGIES = 32 };

typedef struct options {
    const char *folder;
    uint32_t frames, width, height;
    uint32_t msaa, anisotropy; /* 0: several */
    bool json;
} options;

typedef struct scene {
    slv_mesh *mesh;
    slv_adjacency *adjacency;
    slv_surface *surface;
    slv_texture *texture;
    slv_mesh_stats stats;
    slv_gl *gl;
    slv_gl_renderer *renderer;
    uint32_t segments;
} scene;

typedef struct row {
    uint32_t msaa, anisotropy;
    double median[MAX_STRATEGIES], low[MAX_STRATEGIES], high[MAX_STRATEGIES]; /* ms */
    double ratio[MAX_STRATEGIES]; /* to clamp, the median of those of each frame */
    double to_full;               /* traverse to traverse-full, likewise */
} row;

static const slv_env env = {.log = bench_log};

static slv_frame frame_at(const scene *s, const options *o, float turn, uint32_t msaa) {
    slv_frame frame = {.width = o->width, .height = o->height, .msaa = msaa};
    frame.camera = slv_camera_orbit(s->stats.bounds_min, s->stats.bounds_max, 30 + 360 * turn, 20,
                                    35, (float)o->width / (float)o->height);
    return frame;
}

static slv_result load(const options *o, const char *folder, scene *s) {
    char obj[BENCH_PATH + 32], texture[BENCH_PATH + 32];
    slv_ptx *ptx = NULL;
    slv_result result;
    snprintf(obj, sizeof obj, "%s/scene.obj", folder);
    snprintf(texture, sizeof texture, "%s/scene.ptx", folder);
    if ((result = slv_mesh_load(&env, obj, &s->mesh)) ||
        (result = slv_ptx_open(&env, texture, &ptx)) ||
        (result = slv_ptx_match_mesh(&env, ptx, s->mesh)) ||
        (result = slv_ptx_load_texture(&env, ptx, &s->texture)) ||
        (result = slv_mesh_adjacency(&env, s->mesh, &s->adjacency)) ||
        (result = slv_mesh_get_stats(&env, s->mesh, &s->stats)) ||
        (result = slv_surface_create(&env, s->mesh, NULL, &s->surface)) ||
        (result = slv_gl_create(&env, SLV_GL_AUTO, &s->gl)))
        goto done;
    slv_frame first = frame_at(s, o, 0, 1);
    s->segments = slv_tessellation_for(s->mesh, &first.camera, o->width, o->height);
    result = slv_gl_renderer_create(s->gl, &env, s->mesh, s->surface, s->segments, &s->renderer);
done:
    slv_ptx_close(ptx);
    return result;
}

static void unload(scene *s) {
    slv_gl_renderer_destroy(s->renderer);
    slv_gl_destroy(s->gl);
    slv_texture_destroy(s->texture);
    slv_surface_destroy(s->surface);
    slv_adjacency_destroy(s->adjacency);
    slv_mesh_destroy(s->mesh);
}

static uint32_t place_of(const char *name) {
    uint32_t k = 0;
    while (strcmp(slv_strategy_at(k)->name, name) != 0)
        k++;
    return k;
}

static double median_ratio(const double *times, const double *to, uint32_t count) {
    double ratios[MAX_FRAMES];
    for (uint32_t i = 0; i < count; i++)
        ratios[i] = times[i] / to[i];
    return bench_median(ratios, count);
}

/* One round of frames is not counted: it compiles shaders. */
static slv_result measure(const scene *s, const options *o, slv_gl_texture *texture, row *out) {
    static double times[MAX_STRATEGIES][MAX_FRAMES];
    slv_result result = SLV_OK;
    for (uint32_t i = 0; !result && i <= o->frames; i++) {
        for (uint32_t k = 0; !result && k < slv_strategy_count(); k++) {
            double seconds = 0;
            slv_frame frame = frame_at(s, o, (float)i / (float)o->frames, out->msaa);
            uint32_t which = (k + i) % slv_strategy_count();
            frame.strategy = slv_strategy_at(which);
            result = slv_gl_renderer_draw(s->renderer, &env, texture, &frame, NULL, &seconds);
            if (i)
                times[which][i - 1] = seconds * 1e3;
        }
    }
    for (uint32_t k = 0; !result && k < slv_strategy_count(); k++)
        out->ratio[k] = median_ratio(times[k], times[place_of("clamp")], o->frames);
    if (!result)
        out->to_full =
            median_ratio(times[place_of("traverse")], times[place_of("traverse-full")], o->frames);
    for (uint32_t k = 0; !result && k < slv_strategy_count(); k++) {
        qsort(times[k], o->frames, sizeof times[k][0], bench_compare);
        out->median[k] = times[k][o->frames / 2];
        out->low[k] = times[k][o->frames / 10];
        out->high[k] = times[k][o->frames - 1 - o->frames / 10];
    }
    return result;
}

static void print_table(const scene *s, const options *o, const row *rows, uint32_t nrows) {
    const slv_gl_info *info = slv_gl_get_info(s->gl);
    printf("%s (%s, %s)\n", info->renderer, info->version,
           info->software ? "wall time" : "GPU time");
    printf(
        "%u x %u, %u faces of %u x %u segments, %u frames of an orbit, strategies interleaved\n\n",
        o->width, o->height, s->stats.nfaces, s->segments, s->segments, o->frames);
    for (uint32_t i = 0; i < nrows; i++) {
        printf("%ux MSAA, %ux anisotropy\n  %-14s %10s %10s\n", rows[i].msaa, rows[i].anisotropy,
               "", "ms", "to clamp");
        for (uint32_t k = 0; k < slv_strategy_count(); k++)
            printf("  %-14s %10.2f %10.2f\n", slv_strategy_at(k)->name, rows[i].median[k],
                   rows[i].ratio[k]);
        printf("  traverse to traverse-full: %.2f\n\n", rows[i].to_full);
    }
}

static void print_json(const scene *s, const options *o, const row *rows, uint32_t nrows) {
    const slv_gl_info *info = slv_gl_get_info(s->gl);
    printf("{\n  \"renderer\": \"");
    for (const char *c = info->renderer; *c; c++)
        if (*c >= ' ' && *c != '"' && *c != '\\')
            putchar(*c);
    printf("\",\n  \"software\": %s,\n  \"width\": %u, \"height\": %u, \"faces\": %u, "
           "\"segments\": %u, \"frames\": %u,\n"
           "  \"rows\": [",
           info->software ? "true" : "false", o->width, o->height, s->stats.nfaces, s->segments,
           o->frames);
    for (uint32_t i = 0; i < nrows; i++) {
        printf("%s\n    {\"msaa\": %u, \"anisotropy\": %u, \"strategies\": {", i ? "," : "",
               rows[i].msaa, rows[i].anisotropy);
        for (uint32_t k = 0; k < slv_strategy_count(); k++)
            printf("%s\n      \"%s\": {\"median_ms\": %.4f, \"p10_ms\": %.4f, \"p90_ms\": %.4f, "
                   "\"ratio\": %.4f}",
                   k ? "," : "", slv_strategy_at(k)->name, rows[i].median[k], rows[i].low[k],
                   rows[i].high[k], rows[i].ratio[k]);
        printf("\n    }, \"traverse_to_full\": %.4f}", rows[i].to_full);
    }
    printf("\n  ]\n}\n");
}

static slv_result run(const options *o, const char *folder) {
    static const uint32_t anisotropies[] = {1, 16};
    row rows[8];
    uint32_t nrows = 0;
    scene s = {0};
    slv_result result = load(o, folder, &s);
    for (uint32_t a = 0; !result && a < 2; a++) {
        const slv_gl_info *info = slv_gl_get_info(s.gl);
        uint32_t anisotropy =
            anisotropies[a] < info->max_anisotropy ? anisotropies[a] : info->max_anisotropy;
        slv_gl_texture_params params = {KIT_ALL, .anisotropy = anisotropy};
        slv_gl_texture *texture = NULL;
        if (o->anisotropy && o->anisotropy != anisotropies[a])
            continue;
        result = slv_gl_texture_create(s.gl, &env, s.texture, s.adjacency, &params, &texture);
        for (uint32_t msaa = 1; !result && msaa <= 8 && msaa <= info->max_msaa; msaa *= 2) {
            if (o->msaa && o->msaa != msaa)
                continue;
            rows[nrows] = (row){.msaa = msaa, .anisotropy = anisotropy};
            result = measure(&s, o, texture, &rows[nrows++]);
        }
        slv_gl_texture_destroy(texture);
    }
    if (!result)
        (o->json ? print_json : print_table)(&s, o, rows, nrows);
    unload(&s);
    return result;
}

static bool parse(int argc, char **argv, options *o) {
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--json") == 0) {
            o->json = true;
        } else if (strcmp(argv[i], "--smoke") == 0) {
            o->frames = 1;
            o->msaa = 4;
            o->width = 96;
            o->height = 54;
        } else if (strcmp(argv[i], "--frames") == 0 && i + 1 < argc) {
            int frames = atoi(argv[++i]);
            if (frames < 1 || frames > MAX_FRAMES)
                return false;
            o->frames = (uint32_t)frames;
        } else if (strcmp(argv[i], "--msaa") == 0 && i + 1 < argc) {
            o->msaa = (uint32_t)atoi(argv[++i]);
        } else if (strcmp(argv[i], "--aniso") == 0 && i + 1 < argc) {
            o->anisotropy = (uint32_t)atoi(argv[++i]);
        } else if (argv[i][0] != '-' && !o->folder) {
            o->folder = argv[i];
        } else {
            return false;
        }
    }
    return true;
}

int main(int argc, char **argv) {
    options o = {.frames = 31, .width = 960, .height = 540};
    char made[BENCH_PATH] = "";
    bool good = parse(argc, argv, &o);
    if (!good) {
        fputs("usage: bench_strategies [FOLDER] [--frames N] [--msaa N] [--aniso N] "
              "[--json] [--smoke]\n"
              "  FOLDER  where selvage-assets has written the demo scene; without it the scene is "
              "made for the while\n",
              stderr);
        return 2;
    }
    if (!o.folder)
        good = bench_scene_make(argv[0], made);
    good = good && run(&o, o.folder ? o.folder : made) == SLV_OK;
    if (made[0])
        bench_scene_remove(made);
    return good ? 0 : 1;
}
