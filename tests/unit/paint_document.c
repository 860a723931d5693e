/* Documents: what layers show together, at what resolutions, and that all that is done to them can
 * be undone to the bit, whatever runs out. */
#include "kit/document_kit.h"
#include "kit/memory_kit.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>

static slv_document *document_of(const slv_env *env, const paint_scene *s,
                                 slv_document_params params) {
    slv_document *d = NULL;
    params.flat = *slv_texture_get_desc(s->texture);
    MUST(slv_document_create(env, &params, slv_paint_surface_adjacency(s->surface), &d));
    return d;
}

/* A texel of the flattened document. */
static void texel_of(slv_document *d, uint32_t face, uint32_t x, uint32_t y, float *out) {
    MUST(slv_document_flatten(d));
    slv_texture *texture = slv_document_texture(d);
    bool constant = slv_texture_is_constant(texture, face);
    slv_texture_fetch(texture, face, constant ? 0 : x, constant ? 0 : y, out);
}

static void fill_layer(slv_document *d, uint32_t id, const float *color, float opacity) {
    slv_canvas canvas;
    slv_canvas_desc desc;
    float coverage[64 * 64];
    slv_patch patch = {.rect = {0, 0, 64, 64}, .coverage = coverage, .texel_area = 1};
    slv_patches patches = {1, &patch, 64 * 64};
    slv_paint paint = {.opacity = opacity};
    for (int i = 0; i < 64 * 64; i++)
        coverage[i] = 1;
    memcpy(paint.color, color, 3 * sizeof *color);
    MUST(slv_document_canvas(d, id, false, &canvas));
    MUST(canvas.fns->describe(canvas.user, &desc));
    patch.rect.width = 1u << desc.res[0].u;
    patch.rect.height = 1u << desc.res[0].v;
    slv_env env = test_env();
    shape cube = shape_cube();
    paint_scene s = paint_scene_of(&env, &cube, SLV_SCHEME_BILINEAR, 0, SLV_TYPE_U8, 3, -1);
    MUST(slv_painter_apply(s.painter, &canvas, &patches, &paint));
    paint_scene_end(&s);
}

static void layers_show(void) {
    slv_env env = test_env();
    shape cube = shape_cube();
    paint_scene s = paint_scene_of(&env, &cube, SLV_SCHEME_BILINEAR, 6, SLV_TYPE_U8, 3, -1);
    const float white[3] = {1, 1, 1}, red[3] = {1, 0, 0}, grey[3] = {0.5f, 0.5f, 0.5f};
    slv_document *d = document_of(&env, &s, (slv_document_params){.background = white});
    slv_layer_props props = {.opacity = 0.5f};
    uint32_t low, high, copy;
    float t[3];
    MUST(slv_document_add_layer(d, NULL, &low));
    MUST(slv_document_add_layer(d, &(slv_layer_params){.props = &props}, &high));
    texel_of(d, 0, 3, 5, t);
    CHECK(t[0] == 1 && t[1] == 1 && t[2] == 1);
    fill_layer(d, high, red, 1);
    texel_of(d, 0, 3, 5, t);
    CHECK(t[0] == 1 && fabsf(t[1] - 0.5f) < 0.003f && fabsf(t[2] - 0.5f) < 0.003f);
    texel_of(d, 1, 3, 5, t);
    CHECK(t[0] == 1 && t[1] == 1);
    props = (slv_layer_props){.opacity = 1, .blend = SLV_BLEND_MULTIPLY};
    MUST(slv_document_set_layer(d, high, &props));
    fill_layer(d, low, grey, 1);
    texel_of(d, 0, 63, 63, t);
    CHECK(fabsf(t[0] - 0.5f) < 0.003f && t[1] == 0);
    props.hidden = true;
    MUST(slv_document_set_layer(d, high, &props));
    texel_of(d, 0, 63, 63, t);
    CHECK(fabsf(t[1] - 0.5f) < 0.003f);
    props = (slv_layer_props){.opacity = 1};
    MUST(slv_document_set_layer(d, high, &props));
    MUST(slv_document_add_mask(d, high, 0.25f));
    texel_of(d, 0, 9, 9, t);
    CHECK(fabsf(t[0] - 0.625f) < 0.003f && fabsf(t[1] - 0.375f) < 0.003f);
    MUST(slv_document_duplicate_layer(d, high, &copy));
    texel_of(d, 0, 9, 9, t);
    CHECK(fabsf(t[1] - 0.28125f) < 0.003f);
    uint64_t before = document_texture_hash(slv_document_texture(d));
    MUST(slv_document_merge_down(d, high));
    texel_of(d, 0, 9, 9, t);
    CHECK(fabsf(t[1] - 0.28125f) < 0.003f && slv_document_layer_count(d) == 2);
    MUST(slv_document_undo(d));
    MUST(slv_document_flatten(d));
    CHECK(document_texture_hash(slv_document_texture(d)) == before);
    MUST(slv_document_move_layer(d, low, 2));
    texel_of(d, 0, 9, 9, t);
    CHECK(fabsf(t[0] - 0.5f) < 0.003f && fabsf(t[1] - 0.5f) < 0.003f);
    props.locked = true;
    MUST(slv_document_set_layer(d, low, &props));
    uint64_t random = 1;
    CHECK(document_dab(d, s.painter, low, false, &random) == SLV_ERROR_ARGUMENT);
    CHECK(strstr(test_last_log, "locked") != NULL);
    CHECK(document_dab(d, s.painter, 99, false, &random) == SLV_ERROR_ARGUMENT);
    slv_document_destroy(d);
    paint_scene_end(&s);
}

/* A hundred coats of a thousandth, in a document of 8 bits. */
static void low_opacities_add_up(void) {
    slv_env env = test_env();
    shape cube = shape_cube();
    paint_scene s = paint_scene_of(&env, &cube, SLV_SCHEME_BILINEAR, 2, SLV_TYPE_U8, 3, -1);
    slv_document *d = document_of(&env, &s, (slv_document_params){0});
    const float white[3] = {1, 1, 1};
    uint32_t id;
    float t[3];
    MUST(slv_document_add_layer(d, &(slv_layer_params){.fill = (const float[4]){0, 0, 0, 1}}, &id));
    MUST(slv_document_begin(d, "coats"));
    for (int i = 0; i < 100; i++)
        fill_layer(d, id, white, 0.001f);
    MUST(slv_document_end(d));
    texel_of(d, 0, 1, 1, t);
    CHECK_MSG(fabs((double)t[0] - (1 - pow(0.999, 100))) < 0.004, "%g", (double)t[0]);
    slv_history_info info;
    slv_document_history(d, &info);
    CHECK(info.undos == 2 && strcmp(info.undo_name, "coats") == 0);
    MUST(slv_document_undo(d));
    CHECK(strcmp(slv_document_history_name(d, 0), "add layer") == 0);
    CHECK(strcmp(slv_document_history_name(d, 1), "coats") == 0); /* to be redone */
    CHECK(!slv_document_history_name(d, 2));
    slv_document_destroy(d);
    paint_scene_end(&s);
}

/* A layer that is a ramp of the plane, at a lower resolution than the document, is that ramp in it,
 * across edges of all kinds; and at a higher one its means. */
static void resolutions(int of_layer, int of_document) {
    slv_env env = test_env();
    shape plane = paint_plane(3, 3);
    paint_scene s =
        paint_scene_of(&env, &plane, SLV_SCHEME_BILINEAR, of_document, SLV_TYPE_FLOAT, 1, -1);
    slv_document *d = document_of(&env, &s, (slv_document_params){0});
    slv_res res[9];
    uint32_t id, size = 1u << of_layer;
    slv_texture *ramp;
    double worst = 0;
    for (int i = 0; i < 9; i++)
        res[i] = (slv_res){(int8_t)of_layer, (int8_t)of_layer};
    slv_texture_desc desc = {9, SLV_TYPE_FLOAT, 1, SLV_NO_ALPHA, res, 0};
    MUST(slv_texture_create(&env, &desc, &ramp));
    for (uint32_t face = 0; face < 9; face++)
        for (uint32_t y = 0; y < size; y++)
            for (uint32_t x = 0; x < size; x++) {
                float p[3], value;
                slv_surface_point at = {(int32_t)face, ((float)x + 0.5f) / (float)size,
                                        ((float)y + 0.5f) / (float)size};
                REQUIRE(slv_paint_surface_at(s.surface, at, p, NULL, NULL));
                value = p[0] + 2 * p[1];
                MUST(slv_texture_set_rect(ramp, face, (slv_rect){x, y, 1, 1}, &value));
            }
    MUST(slv_document_add_layer(d, NULL, &id));
    MUST(slv_document_load_layer(d, id, ramp));
    size = 1u << of_document;
    for (uint32_t face = 0; face < 9; face++)
        for (uint32_t y = 0; y < size; y++)
            for (uint32_t x = 0; x < size; x++) {
                float p[3], value;
                slv_surface_point at = {(int32_t)face, ((float)x + 0.5f) / (float)size,
                                        ((float)y + 0.5f) / (float)size};
                REQUIRE(slv_paint_surface_at(s.surface, at, p, NULL, NULL));
                float rim = of_layer < of_document ? ldexpf(0.5f, -of_layer) : 0;
                if (p[0] < rim || p[1] < rim || p[0] > 3 - rim || p[1] > 3 - rim)
                    continue; /* there is nothing beyond to go by */
                texel_of(d, face, x, y, &value);
                double error = fabs((double)value - (double)p[0] - 2 * (double)p[1]);
                worst = error > worst ? error : worst;
            }
    CHECK_MSG(worst < 1e-5, "a layer of %d in a document of %d: %g", of_layer, of_document, worst);
    slv_texture_destroy(ramp);
    slv_document_destroy(d);
    paint_scene_end(&s);
}

static uint64_t flat_hash(slv_document *d) {
    MUST(slv_document_flatten(d));
    return document_texture_hash(slv_document_texture(d));
}

/* What is flattened where it was changed is what would be flattened afresh: of a document that is
 * made to look away from its texture. */
static uint64_t flat_hash_afresh(slv_document *d) {
    const slv_texture_desc *flat = slv_document_get_desc(d);
    slv_res was = flat->res[0], other = {(int8_t)(was.u ? 0 : 1), was.v};
    MUST(slv_document_begin(d, NULL));
    MUST(slv_document_resize(d, 0, 1, NULL, &other));
    MUST(slv_document_resize(d, 0, 1, NULL, &was));
    slv_document_cancel(d);
    return flat_hash(d);
}

/* A prism: five quads, and of each pentagon five faces of half the edges. */
static shape prism(void) {
    shape s = {0};
    int32_t low[5] = {8, 6, 4, 2, 0}, high[5] = {1, 3, 5, 7, 9};
    for (int32_t i = 0; i < 10; i++)
        shape_vertex(&s, cosf(1.2566f * (float)(i / 2)), sinf(1.2566f * (float)(i / 2)),
                     (float)(i % 2));
    for (int32_t i = 0; i < 10; i += 2) {
        const int32_t quad[4] = {i, (i + 2) % 10, (i + 2) % 10 + 1, i + 1};
        shape_polygon(&s, 4, quad);
    }
    shape_polygon(&s, 5, low);
    shape_polygon(&s, 5, high);
    return s;
}

/* Single texels of a layer whose faces have all kinds of resolutions: seen from others or not. */
static void texels_beside(uint64_t seed) {
    enum { MOST_FACES = 15 };
    slv_env env = test_env();
    shape mesh = seed % 2 ? prism() : shape_cube();
    paint_scene s = paint_scene_of(&env, &mesh, SLV_SCHEME_BILINEAR, 4, SLV_TYPE_U16, 3, -1);
    slv_document *d = document_of(&env, &s, (slv_document_params){0});
    slv_res res[MOST_FACES];
    uint64_t random = seed;
    uint32_t id;
    slv_canvas canvas;
    REQUIRE(s.nfaces <= MOST_FACES);
    MUST(slv_document_add_layer(d, NULL, &id));
    for (int layer = 0; layer < 2; layer++) {
        for (uint32_t i = 0; i < s.nfaces; i++)
            res[i] =
                (slv_res){(int8_t)(test_random(&random) % 7), (int8_t)(test_random(&random) % 7)};
        MUST(slv_document_resize(d, layer ? id : 0, s.nfaces, NULL, res));
    }
    MUST(slv_document_canvas(d, id, false, &canvas));
    for (int i = 0; i < 60; i++) {
        const float one = 1;
        uint32_t face = test_random(&random) % s.nfaces;
        slv_patch patch = {.face = face, .rect = {0, 0, 1, 1}, .coverage = &one, .texel_area = 1};
        slv_patches patches = {1, &patch, 1};
        patch.rect.x = test_random(&random) % (1u << res[face].u);
        patch.rect.y = test_random(&random) % (1u << res[face].v);
        MUST(slv_painter_apply(s.painter, &canvas, &patches,
                               &(slv_paint){.color = {1, 0.5f, 0.25f}, .opacity = 1}));
        uint64_t flat = flat_hash(d);
        CHECK_MSG(flat_hash_afresh(d) == flat, "seed %u, texel %d: not as afresh", (unsigned)seed,
                  i);
    }
    slv_document_destroy(d);
    paint_scene_end(&s);
}

enum { MOST = 4096 };

static void random_histories(uint64_t seed, uint32_t steps, uint64_t memory, uint64_t disk) {
    static uint64_t states[MOST], flats[MOST];
    slv_env env = test_env();
    shape cube = shape_cube();
    paint_scene s = paint_scene_of(&env, &cube, SLV_SCHEME_BILINEAR, 5, SLV_TYPE_U8, 3, -1);
    slv_document *d =
        document_of(&env, &s, (slv_document_params){.history_bytes = memory, .disk_bytes = disk});
    uint32_t at = 0, end = 0;
    uint64_t random = seed, lost = 0;
    slv_history_info info;
    uint32_t id;
    MUST(slv_document_add_layer(d, NULL, &id));
    states[0] = document_state(d);
    flats[0] = flat_hash(d);
    for (uint32_t i = 0; i < steps && at + 1 < MOST; i++) {
        uint32_t what = test_random(&random) % 24;
        slv_document_history(d, &info);
        if (what >= 20 && info.undos && at) {
            for (uint32_t k = 1 + test_random(&random) % 4; k && info.undos && at; k--, at--) {
                MUST(slv_document_undo(d));
                slv_document_history(d, &info);
            }
        } else if (what >= 16 && info.redos) {
            for (uint32_t k = 1 + test_random(&random) % 4; k && info.redos; k--, at++) {
                MUST(slv_document_redo(d));
                slv_document_history(d, &info);
            }
        } else {
            bool group = what % 4 == 3, cancel = test_random(&random) % 8 == 0;
            if (group)
                MUST(slv_document_begin(d, "several"));
            for (int k = 0; k < (group ? 4 : 1); k++)
                test_ignore(
                    document_act(d, s.painter, test_random(&random) % DOCUMENT_ACTS, &random));
            if (group && cancel)
                slv_document_cancel(d);
            else if (group)
                MUST(slv_document_end(d));
            uint64_t undos = info.undos + info.lost;
            slv_document_history(d, &info);
            if (info.undos + info.lost > undos)
                end = ++at;
            else
                CHECK_MSG(document_state(d) == states[at], "step %u: a trace without an entry", i);
            states[at] = document_state(d);
            flats[at] = flat_hash(d);
            (void)end;
        }
        CHECK_MSG(document_state(d) == states[at], "seed %u, step %u: another state",
                  (unsigned)seed, i);
        CHECK_MSG(flat_hash(d) == flats[at], "seed %u, step %u: flattens to something else",
                  (unsigned)seed, i);
        if (i % 16 == 0)
            CHECK_MSG(flat_hash_afresh(d) == flats[at], "seed %u, step %u: not as afresh",
                      (unsigned)seed, i);
        slv_document_history(d, &info);
        CHECK_MSG(info.bytes <= memory && info.disk_bytes <= disk, "%llu bytes, %llu on disk",
                  (unsigned long long)info.bytes, (unsigned long long)info.disk_bytes);
        lost = info.lost;
    }
    while (info.undos && at) {
        MUST(slv_document_undo(d));
        at--;
        CHECK(document_state(d) == states[at]);
        slv_document_history(d, &info);
    }
    while (info.redos) {
        MUST(slv_document_redo(d));
        at++;
        CHECK(document_state(d) == states[at]);
        slv_document_history(d, &info);
    }
    CHECK(memory < (1 << 22) || !lost);
    slv_document_destroy(d);
    paint_scene_end(&s);
}

/* What is undone of a stroke is the blocks that it touched, and next to nothing else. */
static void undo_memory(void) {
    slv_env env = test_env();
    shape cube = shape_cube();
    paint_scene s = paint_scene_of(&env, &cube, SLV_SCHEME_BILINEAR, 9, SLV_TYPE_U8, 3, -1);
    slv_document *d = document_of(&env, &s, (slv_document_params){0});
    const float white[4] = {1, 1, 1, 1};
    uint64_t random = 5, touched = 0;
    slv_history_info info;
    slv_canvas canvas;
    uint32_t id;
    float *before = malloc(sizeof(float) * 4 * 512 * 512 * 6), *after = malloc(4 * 4 * 512 * 512);
    MUST(slv_document_add_layer(d, &(slv_layer_params){.fill = white}, &id));
    MUST(slv_document_canvas(d, id, false, &canvas));
    for (int i = 0; i < 40; i++)
        MUST(document_dab(d, s.painter, id, false, &random));
    slv_document_history(d, &info);
    uint64_t bytes = info.bytes;
    for (uint32_t face = 0; face < 6; face++)
        MUST(canvas.fns->read(canvas.user, face, (slv_rect){0, 0, 512, 512},
                              before + face * 4 * 512 * 512));
    MUST(slv_document_begin(d, "stroke"));
    for (int i = 0; i < 20; i++) {
        slv_canvas_desc desc;
        slv_patches patches;
        slv_dab dab = {.at = {i % 6, 0.03f * (float)i, 0.7f}, .radius = 0.4f, .hardness = 0.9f};
        MUST(canvas.fns->describe(canvas.user, &desc));
        MUST(slv_painter_cover(s.painter, desc.res, &dab, &patches));
        MUST(slv_painter_apply(s.painter, &canvas, &patches,
                               &(slv_paint){.color = {0.1f, 0.2f, 0.3f}, .opacity = 0.5f}));
    }
    MUST(slv_document_end(d));
    slv_document_history(d, &info);
    for (uint32_t face = 0; face < 6; face++) {
        MUST(canvas.fns->read(canvas.user, face, (slv_rect){0, 0, 512, 512}, after));
        for (uint32_t block = 0; block < 256; block++) {
            bool differs = false;
            for (uint32_t y = 0; y < 32 && !differs; y++) {
                size_t at = ((block / 16 * 32 + y) * 512 + block % 16 * 32) * 4;
                differs = memcmp(before + face * 4 * 512 * 512 + at, after + at, 32 * 16) != 0;
            }
            touched += differs;
        }
    }
    CHECK_MSG((double)(info.bytes - bytes) <= 1.05 * (double)touched * 32 * 32 * 8,
              "%llu bytes for %llu blocks", (unsigned long long)(info.bytes - bytes),
              (unsigned long long)touched);
    CHECK(touched > 100);
    free(before);
    free(after);
    slv_document_destroy(d);
    paint_scene_end(&s);
}

enum { WRITTEN = 300, OF_MEMORY = 1 << 20 };

static void check_steps(slv_document *d, const uint64_t *states, uint32_t undos, bool redo) {
    for (uint32_t i = 0; i < undos; i++) {
        MUST(redo ? slv_document_redo(d) : slv_document_undo(d));
        CHECK(document_state(d) == states[redo ? i + 1 : undos - 1 - i]);
    }
}

/* Old entries are written to the disk before the memory is full, while others are made, undone and
 * redone; by a fork, too, that has no thread of its own for it. */
static void written_meanwhile(void) {
    static uint64_t states[WRITTEN + 1];
    slv_env env = test_env();
    shape cube = shape_cube();
    paint_scene s = paint_scene_of(&env, &cube, SLV_SCHEME_BILINEAR, 6, SLV_TYPE_U8, 3, -1);
    slv_document *d = document_of(&env, &s, (slv_document_params){.history_bytes = OF_MEMORY});
    uint64_t random = 11;
    slv_history_info info;
    bool ahead = false;
    uint32_t id;
    MUST(slv_document_add_layer(d, NULL, &id));
    slv_document_history(d, &info);
    const uint32_t before = info.undos;
    states[0] = document_state(d);
    for (uint32_t i = 0; i < WRITTEN; i++) {
        MUST(document_dab(d, s.painter, id, false, &random));
        states[i + 1] = document_state(d);
        slv_document_history(d, &info);
        CHECK(info.bytes <= OF_MEMORY && info.undos == before + i + 1);
        ahead |= info.disk_bytes > 0 && info.bytes > OF_MEMORY - OF_MEMORY / 8;
        if (i % 7 == 6) {
            check_steps(d, states + i - 2, 3, false);
            check_steps(d, states + i - 2, 3, true);
        }
    }
    CHECK(ahead && info.disk_bytes > OF_MEMORY && !info.lost);
    pid_t child = fork();
    if (child == 0) {
        check_steps(d, states, WRITTEN, false);
        slv_document_destroy(d);
        _exit(test_end());
    }
    int status = 1;
    CHECK(child > 0 && waitpid(child, &status, 0) == child && status == 0);
    check_steps(d, states, WRITTEN, false);
    slv_document_history(d, &info);
    CHECK(info.bytes <= OF_MEMORY && info.undos == before && info.redos > 20);
    check_steps(d, states, info.redos < WRITTEN ? info.redos : WRITTEN, true);
    slv_document_destroy(d);
    paint_scene_end(&s);
}

static uint64_t warnings;

static void count_warnings(void *user, slv_log_level level, const char *message) {
    (void)user;
    warnings += level == SLV_LOG_WARNING && strstr(message, "old entries are lost") != NULL;
}

/* The oldest entries are lost then, and said to be; nothing else is. */
static void disk_fails(void) {
    slv_env env = test_env();
    shape cube = shape_cube();
    paint_scene s = paint_scene_of(&env, &cube, SLV_SCHEME_BILINEAR, 6, SLV_TYPE_U8, 3, -1);
    env.log = count_warnings;
    slv_document *d = document_of(&env, &s, (slv_document_params){.history_bytes = OF_MEMORY});
    struct rlimit old, little = {1 << 19, 0};
    uint64_t random = 11, first = 0, state;
    slv_history_info info;
    uint32_t id;
    REQUIRE(getrlimit(RLIMIT_FSIZE, &old) == 0);
    little.rlim_max = old.rlim_max;
    signal(SIGXFSZ, SIG_IGN);
    REQUIRE(setrlimit(RLIMIT_FSIZE, &little) == 0);
    MUST(slv_document_add_layer(d, NULL, &id));
    for (uint32_t i = 0; i < WRITTEN; i++) {
        MUST(document_dab(d, s.painter, id, false, &random));
        slv_document_history(d, &info);
        CHECK(info.bytes <= OF_MEMORY);
        if (info.lost && !first)
            first = warnings;
    }
    state = document_state(d);
    REQUIRE(setrlimit(RLIMIT_FSIZE, &old) == 0);
    CHECK(first && info.lost && info.undos > 20);
    for (uint32_t i = 0; i < 20; i++)
        MUST(slv_document_undo(d));
    CHECK(document_state(d) != state);
    for (uint32_t i = 0; i < 20; i++)
        MUST(slv_document_redo(d));
    CHECK(document_state(d) == state);
    slv_document_destroy(d);
    paint_scene_end(&s);
}

/* Each allocation of each thing that can be done fails once: nothing has changed then. */
static void out_of_memory(void) {
    slv_env env = test_env();
    shape cube = shape_cube();
    paint_scene s = paint_scene_of(&env, &cube, SLV_SCHEME_BILINEAR, 4, SLV_TYPE_U8, 3, -1);
    memory_count count = {.fails = 0};
    slv_env counting = memory_env(&count);
    slv_document *d = document_of(&counting, &s, (slv_document_params){.history_bytes = 30000});
    uint64_t random = 3;
    uint32_t id;
    long failures = 0;
    MUST(slv_document_add_layer(d, NULL, &id));
    for (uint32_t i = 0; i < test_effort(60); i++) {
        uint32_t act = i % (DOCUMENT_ACTS + 3);
        uint64_t before = document_state(d), flat = flat_hash(d), begin = random;
        slv_result result = SLV_ERROR_MEMORY;
        for (long at = 1; result == SLV_ERROR_MEMORY; at++) {
            random = begin;
            count.errors = 0;
            count.asked = 0;
            count.fails = at;
            result = act < DOCUMENT_ACTS        ? document_act(d, s.painter, act, &random)
                     : act == DOCUMENT_ACTS + 1 ? slv_document_redo(d)
                                                : slv_document_undo(d);
            count.fails = 0;
            if (result != SLV_ERROR_MEMORY)
                break;
            failures++;
            CHECK(count.errors == 1);
            CHECK_MSG(document_state(d) == before, "act %u fails at %ld: another state", act, at);
            CHECK_MSG(flat_hash(d) == flat, "act %u fails at %ld: another look", act, at);
        }
    }
    CHECK(failures > (test_brief() ? 30 : 100));
    slv_document_destroy(d);
    CHECK(count.live == 0);
    paint_scene_end(&s);
}

static slv_result sweep_flatten(const slv_env *env) {
    const slv_res res[2] = {{3, 3}, {4, 2}};
    slv_document *d = NULL;
    slv_document_params params = {.flat = {2, SLV_TYPE_U8, 3, SLV_NO_ALPHA, res, 0},
                                  .scratch = test_parent()};
    slv_source source = {0};
    slv_result result = slv_document_create(env, &params, NULL, &d);
    if (!result && !(result = slv_document_add_layer(d, NULL, NULL)))
        result = slv_document_as_source(d, "flat", &source);
    slv_source_close(&source);
    slv_document_destroy(d);
    return result;
}

int main(void) {
    layers_show();
    low_opacities_add_up();
    for (int i = 1; i <= 5; i++)
        resolutions(i, 4);
    for (uint32_t seed = 1; seed <= test_effort(6); seed++)
        texels_beside(seed);
    undo_memory();
    for (uint32_t seed = 1; seed <= test_effort(2); seed++) {
        random_histories(seed, 80, (uint64_t)1 << 30, (uint64_t)1 << 30);
        random_histories(100 + seed, 80, 120000, (uint64_t)1 << 30);
        random_histories(200 + seed, 80, 60000, 200000);
        random_histories(300 + seed, 80, 400000, 800000);
    }
    written_meanwhile();
    disk_fails();
    out_of_memory();
    memory_sweep("a document, flattened", sweep_flatten, NULL);
    return test_end();
}
