/* bench_layouts [--faces N] [--log2 N] [--frames N] [--size N] [--json] [--smoke]
 *
 * The comparison of Purnomo, Cohen and Kumar (2004, table 2): how long a frame takes where each
 * face has a texture of its own (separate), where faces of one size share an array, a layer each
 * (arrays), and where they share pages, all of one size (flat) or of several (packed); by filter. A
 * torus, with the two strategies whose lookups never leave their face's rectangle. Their stacked
 * style, levels of the driver's with coordinates that depend on the level, is here for comparison
 * only. Frames of all are interleaved; medians are printed, of the processor's time on a software
 * driver. */
#include "kit/bench_kit.h"

#include <selvage/border.h>
#include <selvage/edge_aligned.h>
#include <selvage/gl_renderer.h>

#include <string.h>

enum { FORMS = 2, SETS = 2, LAYOUTS = 4, FILTERS = 3, MAX_FRAMES = 99 };
enum { SEPARATE, ARRAYS, PAGES, STACKED };
enum { BILINEAR, TRILINEAR, ANISOTROPIC };

typedef struct options {
    uint32_t faces, frames, width;
    int log2;
    bool json;
} options;

/* The strategies of the library, and the same with one level for a lookup in place of two. */
static const slv_strategy bilinear[FORMS] = {
    {.name = "borders-bilinear",
     .form = slv_form_borders,
     .packing = SLV_GL_PAGES,
     .wrap = SLV_GL_WRAP_ZERO,
     .glsl = "#define SLV_ONE_LEVEL\n#include \"strategy/borders.glsl\"\n"},
    {.name = "edge-aligned-bilinear",
     .form = slv_form_edge_aligned,
     .packing = SLV_GL_PAGES,
     .wrap = SLV_GL_WRAP_ZERO,
     .glsl = "#define SLV_ONE_LEVEL\n#include \"strategy/edge_aligned.glsl\"\n"}};
/* Stacked samples: a level of 2^u texels has 2^u samples, the outermost on the edges, and not one
 * more, so that levels lie in OpenGL's. Those of one texel are looked up by nobody. */
static slv_result stacked_create(const slv_env *env, const slv_levels *levels,
                                 const slv_adjacency *adjacency, uint32_t border, void **out) {
    slv_edge_aligned *made = NULL;
    slv_result result = slv_edge_aligned_create(env, levels, adjacency, &made);
    (void)border;
    *out = made;
    return result;
}

static void stacked_destroy(void *made) {
    slv_edge_aligned_destroy(made);
}

static uint32_t stacked_count(const void *made) {
    return slv_edge_aligned_get_desc(made)->nfaces;
}

static slv_res stacked_res(const void *made, uint32_t item) {
    return slv_edge_aligned_get_desc(made)->res[item];
}

static uint32_t stacked_items(const void *made, uint32_t face, uint32_t out[SLV_FORM_ITEMS]) {
    (void)made;
    out[0] = face;
    return 1;
}

static slv_result stacked_read(const void *made, uint32_t item, uint32_t level, float *scratch,
                               slv_form_texels *out) {
    const slv_texture_desc *desc = slv_edge_aligned_get_desc(made);
    slv_res res = slv_res_level(desc->res[item], level);
    uint32_t nu = 1u << res.u, nv = 1u << res.v;
    for (uint32_t i = 0; i < nu * nv; i++)
        slv_edge_aligned_lookup(made, item, level,
                                nu > 1 ? (float)(i % nu) / (float)(nu - 1) : 0.5f,
                                nv > 1 ? (float)(i / nu) / (float)(nv - 1) : 0.5f,
                                scratch + (size_t)i * desc->nchannels);
    *out = (slv_form_texels){scratch, SLV_TYPE_FLOAT};
    return SLV_OK;
}

static const slv_form *stacked_form(void) {
    static const slv_form form = {.name = "stacked",
                                  .title = "samples on the edges, in OpenGL's levels",
                                  .item = "a face",
                                  .computed = true,
                                  .create = stacked_create,
                                  .destroy = stacked_destroy,
                                  .count = stacked_count,
                                  .res = stacked_res,
                                  .items = stacked_items,
                                  .read = stacked_read};
    return &form;
}

/* Their fragment program. A level of n samples shrinks coordinates by 1 - 1/n, and derivatives with
 * them, so that the level i for which a footprint is right is finer than the level l of the
 * coordinates given: i = l + log2(1 - 2^i / N), solved for i. (Their equation 2 has the second sign
 * wrong.) Trilinear lookups are two, each with the coordinates of its level. */
#define STACKED_GLSL                                                                               \
    "#include \"lookup/interface.glsl\"\n#include \"lookup/footprint.glsl\"\n"                     \
    "vec4 slv_stacked_level(float layer, vec2 size, vec2 uv, slv_footprint f, float level) {\n"    \
    "    vec2 n = size * exp2(-level);\n"                                                          \
    "    vec2 fit = min(vec2(1.0), min(uv, 1.0 - uv) / max(0.5 * abs(f.axis), vec2(1e-12)));\n"    \
    "    vec4 sum = vec4(0.0);\n"                                                                  \
    "    int k = 1;\n"                                                                             \
    "    do {\n"                                                                                   \
    "        vec2 at = slv_inside(uv + slv_tap_offset(f, k) * fit);\n"                             \
    "        sum += textureLod(slv_pool[0], vec3((at * (n - 1.0) + 0.5) / n, layer), level);\n"    \
    "    } while (++k <= f.taps);\n"                                                               \
    "    return sum / float(f.taps);\n"                                                            \
    "}\n"                                                                                          \
    "vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {\n"                                \
    "    float layer = float(slv_store[SLV_ROW(face)].x >> 16);\n"                                 \
    "    vec2 size = slv_face_size(face);\n"                                                       \
    "    uv = slv_inside(uv);\n"                                                                   \
    "    slv_footprint f = slv_footprint_at(size, uv, dx, dy);\n"                                  \
    "    float i = f.level - log2(1.0 + exp2(f.level) / size.x), last = log2(size.x) - 1.0;\n"     \
    "    i = clamp(i, 0.0, last);\n"                                                               \
    "#ifdef SLV_ONE_LEVEL\n"                                                                       \
    "    return slv_value(slv_stacked_level(layer, size, uv, f, floor(i + 0.5)));\n"               \
    "#else\n"                                                                                      \
    "    vec4 a = slv_stacked_level(layer, size, uv, f, floor(i));\n"                              \
    "    vec4 b = slv_stacked_level(layer, size, uv, f, min(floor(i) + 1.0, last));\n"             \
    "    return slv_value(mix(a, b, fract(i)));\n"                                                 \
    "#endif\n"                                                                                     \
    "}\n"
static const slv_strategy stacked[2] = {
    {.name = "stacked", .form = stacked_form, .own_taps = true, .glsl = STACKED_GLSL},
    {.name = "stacked-bilinear",
     .form = stacked_form,
     .own_taps = true,
     .glsl = "#define SLV_ONE_LEVEL\n" STACKED_GLSL}};

static const char *const forms[FORMS] = {"borders", "edge-aligned"};
static const char *const filters[FILTERS] = {"bilinear", "trilinear", "16x anisotropic"};
static const char *const sets[SETS] = {"one size", "three sizes"};

static const char *layout_name(uint32_t set, uint32_t layout) {
    static const char *const names[LAYOUTS] = {"separate", "arrays", "flat", "stacked"};
    return set && layout == PAGES ? "packed" : names[layout];
}

/* Stacked are samples on edges of one size only. */
static bool is_there(uint32_t set, uint32_t form, uint32_t layout) {
    return layout != STACKED || (set == 0 && form == 1);
}

/* A texture of both forms in one layout, for one anisotropy. */
typedef struct made {
    slv_gl_texture *texture;
    slv_gl_renderer *renderer;
    const slv_strategy *strategies[2 * FORMS];
} made;

typedef struct scene {
    slv_env env;
    bench_torus torus;
    slv_texture *texels[SETS];
    slv_gl *gl;
    slv_mesh_stats stats;
    made made[SETS][LAYOUTS][2];
} scene;

typedef struct timing {
    double times[MAX_FRAMES], median, ratio, mib; /* ratio: the median of those of each frame */
    uint32_t draws;
} timing;

static slv_texture *make_texels(const slv_env *env, uint32_t nfaces, int log2, bool mixed) {
    slv_res *res = malloc(nfaces * sizeof *res);
    unsigned char *texels = malloc((size_t)3 << 2 * log2);
    slv_texture *texture = NULL;
    uint32_t random = 5;
    if (!res || !texels)
        bench_stop(SLV_ERROR_MEMORY);
    bench_res(nfaces, log2, mixed, res);
    slv_texture_desc desc = {.nfaces = nfaces,
                             .type = SLV_TYPE_U8,
                             .nchannels = 3,
                             .alpha_channel = SLV_NO_ALPHA,
                             .res = res};
    bench_stop(slv_texture_create(env, &desc, &texture));
    for (uint32_t f = 0; f < nfaces; f++) {
        for (size_t i = 0; i < (size_t)3 << (res[f].u + res[f].v); i++)
            texels[i] = (unsigned char)(bench_random(&random) >> 24);
        bench_stop(slv_texture_set_face(texture, f, texels));
    }
    free(texels);
    free(res);
    return texture;
}

static void make(scene *s, uint32_t set, uint32_t layout, uint32_t anisotropic, made *out) {
    uint32_t count = 0;
    if (!is_there(set, 1, layout))
        return;
    for (uint32_t form = 0; form < FORMS; form++)
        out->strategies[count++] = layout == STACKED ? &stacked[0] : slv_strategy_find(forms[form]);
    for (uint32_t form = 0; form < FORMS && !anisotropic; form++)
        out->strategies[count++] = layout == STACKED ? &stacked[1] : &bilinear[form];
    slv_gl_texture_params params = {.strategies = out->strategies,
                                    .nstrategies = count,
                                    .anisotropy = anisotropic ? 16 : 1,
                                    .pool_layers = layout == SEPARATE ? 1 : 0,
                                    .layout = layout == PAGES ? SLV_GL_LAYOUT_PAGES
                                                              : SLV_GL_LAYOUT_SEPARATE};
    bench_stop(slv_gl_texture_create(s->gl, &s->env, s->texels[set], s->torus.adjacency, &params,
                                     &out->texture));
    bench_stop(
        slv_gl_renderer_create(s->gl, &s->env, s->torus.mesh, s->torus.surface, 2, &out->renderer));
}

static void begin(const options *o, scene *s) {
    uint32_t around = 1;
    while (around * around < 2 * o->faces)
        around++;
    s->env = (slv_env){.log = bench_log};
    s->torus = bench_torus_make(&s->env, around, (o->faces + around - 1) / around);
    bench_stop(slv_mesh_get_stats(&s->env, s->torus.mesh, &s->stats));
    bench_stop(slv_gl_create(&s->env, SLV_GL_AUTO, &s->gl));
    for (uint32_t set = 0; set < SETS; set++) {
        s->texels[set] = make_texels(&s->env, s->stats.nfaces, o->log2, set);
        for (uint32_t k = 0; k < 2 * LAYOUTS; k++)
            make(s, set, k / 2, k % 2, &s->made[set][k / 2][k % 2]);
    }
}

static void end(scene *s) {
    for (uint32_t k = 0; k < SETS * LAYOUTS * 2; k++) {
        made *its = &s->made[k / (2 * LAYOUTS)][k / 2 % LAYOUTS][k % 2];
        slv_gl_renderer_destroy(its->renderer);
        slv_gl_texture_destroy(its->texture);
    }
    for (uint32_t set = 0; set < SETS; set++)
        slv_texture_destroy(s->texels[set]);
    slv_gl_destroy(s->gl);
    bench_torus_free(&s->torus);
}

static timing timings[SETS][FORMS][LAYOUTS][FILTERS];

/* One round of frames is not counted: it compiles shaders. */
static void draw(const options *o, scene *s, uint32_t which, uint32_t round) {
    uint32_t filter = which % FILTERS, layout = which / FILTERS % LAYOUTS;
    uint32_t form = which / (FILTERS * LAYOUTS) % FORMS, set = which / (FILTERS * LAYOUTS * FORMS);
    if (!is_there(set, form, layout))
        return;
    const made *its = &s->made[set][layout][filter == ANISOTROPIC];
    timing *cell = &timings[set][form][layout][filter];
    slv_frame frame = {.width = o->width, .height = o->width * 9 / 16};
    double seconds = 0;
    frame.strategy = its->strategies[form + (filter == BILINEAR ? FORMS : 0)];
    frame.camera = slv_camera_orbit(s->stats.bounds_min, s->stats.bounds_max,
                                    360 * (float)round / (float)o->frames, 30, 35, 16.0f / 9);
    bench_stop(slv_gl_renderer_draw(its->renderer, &s->env, its->texture, &frame, NULL, &seconds));
    if (round)
        cell->times[round - 1] = 1e3 * seconds;
    cell->draws = slv_gl_texture_batch_count(its->texture, frame.strategy);
    cell->mib =
        (double)slv_gl_texture_get_stats(its->texture, frame.strategy).gpu_bytes / (1 << 20);
}

static void summarise(const options *o) {
    for (uint32_t k = 0; k < SETS * FORMS * LAYOUTS * FILTERS; k++) {
        uint32_t set = k / (FILTERS * LAYOUTS * FORMS), form = k / (FILTERS * LAYOUTS) % FORMS;
        timing *cell = &timings[set][form][k / FILTERS % LAYOUTS][k % FILTERS];
        double ratios[MAX_FRAMES];
        for (uint32_t i = 0; i < o->frames; i++)
            ratios[i] = cell->times[i] / timings[set][form][PAGES][TRILINEAR].times[i];
        cell->ratio = bench_median(ratios, o->frames);
    }
    for (uint32_t k = 0; k < SETS * FORMS * LAYOUTS * FILTERS; k++) /* sorts the times */
        (&timings[0][0][0][0])[k].median = bench_median((&timings[0][0][0][0])[k].times, o->frames);
}

static void print_row(const options *o, uint32_t set, uint32_t form, uint32_t layout) {
    const timing *row = timings[set][form][layout];
    const char *name = layout_name(set, layout);
    if (!o->json) {
        printf("  %-9s", name);
        for (uint32_t f = 0; f < FILTERS; f++)
            printf(" %8.2f %5.2f", row[f].median, row[f].ratio);
        printf(" %7u %8.2f %8.2f\n", row[TRILINEAR].draws, row[TRILINEAR].mib,
               row[ANISOTROPIC].mib);
        return;
    }
    for (uint32_t f = 0; f < FILTERS; f++)
        printf("%s\n  {\"texels\": \"%s\", \"strategy\": \"%s\", \"layout\": \"%s\", \"filter\": "
               "\"%s\", \"median_ms\": %.4f, \"draws\": %u, \"mib\": %.3f}",
               set + form + layout + f ? "," : "", sets[set], forms[form], name, filters[f],
               row[f].median, row[f].draws, row[f].mib);
}

static void print(const options *o, const scene *s) {
    const slv_gl_info *info = slv_gl_get_info(s->gl);
    if (!o->json)
        printf("%s, %u faces of %u x %u texels at most, %u x %u, %u frames\n"
               "ms of %s, and to pages trilinear; draws; MiB at 1x and 16x anisotropy\n",
               info->renderer, s->stats.nfaces, 1u << o->log2, 1u << o->log2, o->width,
               o->width * 9 / 16, o->frames, info->software ? "the processor" : "the GPU");
    fputs(o->json ? "[" : "", stdout);
    for (uint32_t k = 0; k < SETS * FORMS * LAYOUTS; k++) {
        uint32_t set = k / (FORMS * LAYOUTS), form = k / LAYOUTS % FORMS;
        if (k % LAYOUTS == 0 && !o->json)
            printf("\n%s, %s:\n  %-9s %14s %14s %14s %7s %8s %8s\n", forms[form], sets[set], "",
                   filters[0], filters[1], filters[2], "draws", "1x", "16x");
        if (is_there(set, form, k % LAYOUTS))
            print_row(o, set, form, k % LAYOUTS);
    }
    fputs(o->json ? "\n]\n" : "", stdout);
}

static bool parse(int argc, char **argv, options *o) {
    for (int i = 1; i < argc; i++) {
        int value = i + 1 < argc ? atoi(argv[i + 1]) : 0;
        if (strcmp(argv[i], "--json") == 0)
            o->json = true;
        else if (strcmp(argv[i], "--smoke") == 0)
            *o = (options){.faces = 32, .frames = 1, .width = 96, .log2 = 3};
        else if (strcmp(argv[i], "--faces") == 0 && value > 8 && value < 60000)
            o->faces = (uint32_t)value, i++;
        else if (strcmp(argv[i], "--log2") == 0 && value > 1 && value < 10)
            o->log2 = value, i++;
        else if (strcmp(argv[i], "--frames") == 0 && value > 0 && value <= MAX_FRAMES)
            o->frames = (uint32_t)value, i++;
        else if (strcmp(argv[i], "--size") == 0 && value > 15 && value < 8192)
            o->width = (uint32_t)value, i++;
        else
            return false;
    }
    return true;
}

int main(int argc, char **argv) {
    options o = {.faces = 2048, .frames = 9, .width = 480, .log2 = 5};
    scene s = {0};
    if (!parse(argc, argv, &o)) {
        fputs("usage: bench_layouts [--faces N] [--log2 N] [--frames N] [--size N] [--json] "
              "[--smoke]\n",
              stderr);
        return 2;
    }
    begin(&o, &s);
    for (uint32_t round = 0; round <= o.frames; round++)
        for (uint32_t which = 0; which < SETS * FORMS * LAYOUTS * FILTERS; which++)
            draw(&o, &s, which, round);
    summarise(&o);
    print(&o, &s);
    end(&s);
    return 0;
}
