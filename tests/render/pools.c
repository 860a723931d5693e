/* More faces than an array has layers, more arrays than a stage has units, every resolution from
 * 1x1 up: the numbers that a lookup returns must not depend on how faces are spread over arrays and
 * batches. */
#include "kit/border_kit.h"
#include "kit/lookup_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_texture.h>

static slv_gl *gl;

static void look_up(const kit *k, const slv_gl_texture_params *params, const slv_strategy *strategy,
                    float *out, uint32_t *batches) {
    slv_env env = test_env();
    slv_gl_texture *texture = NULL;
    slv_result result = slv_gl_texture_create(gl, &env, k->texture, k->adjacency, params, &texture);
    REQUIRE(result == SLV_OK);
    *batches = slv_gl_texture_batch_count(texture, strategy);
    uint32_t drawn = 0;
    for (uint32_t b = 0; b < *batches; b++)
        drawn += slv_gl_texture_batch(texture, strategy, b).nfaces;
    CHECK(drawn == k->nfaces);
    result = slv_gl_texture_lookup(texture, &env, strategy, NPOINTS, faces, uv, dx, dy, out);
    REQUIRE(result == SLV_OK);
    slv_gl_texture_destroy(texture);
}

static float largest_difference(const float *a, const float *b) {
    float largest = 0;
    for (int i = 0; i < 4 * NPOINTS; i++)
        largest = fmaxf(largest, fabsf(a[i] - b[i]));
    return largest;
}

/* Faces that share pages are looked up as those that have a layer each, but for rounding, in few
 * batches, and take about the same memory: of many faces of any size, with few pages to an array,
 * too. */
static void check_pages(uint64_t *random) {
    static const char *const names[] = {"borders", "edge-aligned"};
    static float apart[4 * NPOINTS], together[4 * NPOINTS];
    for (uint32_t i = 0; i < 12; i++) {
        const slv_strategy *strategy = kit_strategy(names[i % 2]);
        uint32_t many, few, side = i / 2 % 3 == 2 ? 15 : 8;
        kit k;
        if (test_skip(i, 3))
            continue;
        kit_grid(&k, side, side, false, 0, random, NULL);
        kit_mixed(&k, side > 8 ? 4 : i / 6 ? 5 : 8, random);
        kit_noise(&k, SLV_TYPE_U8, 1 + i % 4, random);
        random_points(&k, random);
        slv_gl_texture_params params = {KIT_ONLY(strategy), .layout = SLV_GL_LAYOUT_SEPARATE,
                                        .anisotropy = 1 + i % 3 * 4};
        look_up(&k, &params, strategy, apart, &many);
        params.layout = SLV_GL_LAYOUT_PAGES;
        params.pool_layers = i % 4 ? 0 : 1;
        look_up(&k, &params, strategy, together, &few);
        CHECK_MSG(few < many && few <= (i % 4 ? 6 : 40), "%s: %u batches, %u with a layer each",
                  strategy->name, few, many);
        float largest = largest_difference(apart, together);
        CHECK_MSG(largest <= 2e-4f + 2 * kit_weight_step(gl), "%s: %g", strategy->name,
                  (double)largest);
        kit_free(&k);
    }
}

static void check_spread(kit *k, slv_type type, uint32_t nchannels, uint64_t *random) {
    static float whole[4 * NPOINTS], spread[4 * NPOINTS];
    kit_noise(k, type, nchannels, random);
    random_points(k, random);
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        const slv_strategy *strategy = slv_strategy_at(s);
        uint32_t few, many;
        if (test_brief() && s != 2)
            continue; /* programs for 32 arrays take a second each to compile */
        slv_gl_texture_params plain = {KIT_ONLY(strategy), .layout = SLV_GL_LAYOUT_SEPARATE};
        slv_gl_texture_params cut = plain;
        cut.pool_layers = 1;
        look_up(k, &plain, strategy, whole, &few);
        look_up(k, &cut, strategy, spread, &many);
        /* more arrays than units, in as many batches where each reads its own array first */
        CHECK(many > few && (many > 32 || strategy->reach == SLV_GL_REACH_SQUARES));
        for (int i = 0; i < 4 * NPOINTS; i++)
            CHECK(isfinite(whole[i]));
        float largest = largest_difference(whole, spread);
        CHECK_MSG(largest <= 1e-6f, "%s %s: %g", strategy->name, slv_type_name(type),
                  (double)largest);
    }
}

/* A colour comes out of two faces of these sizes as it went in; with `few`, of the strategies that
 * keep the texture's own texels and no coverage. */
static void check_constant(slv_res left, slv_res right, bool few, uint64_t *random) {
    kit k;
    kit_grid(&k, 2, 1, false, 0, random, NULL);
    k.res[0] = left;
    k.res[1] = right;
    kit_begin_texture(&k, SLV_TYPE_U8, 3);
    const unsigned char color[3] = {10, 200, 90};
    static uint32_t turn;
    turn++;
    for (uint32_t f = 0; f < 2; f++) {
        slv_result result = slv_texture_set_constant(k.texture, f, color);
        REQUIRE(result == SLV_OK);
    }
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        const slv_strategy *strategy = slv_strategy_at(s);
        static float values[4 * NPOINTS];
        uint32_t batches;
        slv_gl_texture_params params = {KIT_ONLY(strategy), .anisotropy = 2};
        if ((few && (strategy->coverage || strategy->resampled)) || test_skip(s + turn, 2))
            continue;
        random_points(&k, random);
        look_up(&k, &params, strategy, values, &batches);
        float largest = 0;
        for (int i = 0; i < 4 * NPOINTS; i++)
            largest =
                fmaxf(largest, fabsf(values[i] - (i % 4 == 3 ? 1 : (float)color[i % 4] / 255)));
        CHECK_MSG(largest < 1.5f / 255, "%s %dx%d beside %dx%d: a constant comes out wrong by %g",
                  strategy->name, 1 << left.u, 1 << left.v, 1 << right.u, 1 << right.v,
                  (double)largest);
    }
    kit_free(&k);
}

/* One face of each of the extremes, alone and beside its opposite. The largest square takes as many
 * seconds as all others together: only with whole layers, and with a border around each level. */
static void check_extremes(void) {
    static const slv_res extremes[] = {{0, 0}, {8, 8}, {12, 0}, {0, 12}, {1, 9}, {7, 2}};
    uint64_t random = 5;
    slv_env env = test_env();
    for (uint32_t a = 0; a < sizeof extremes / sizeof *extremes; a++)
        if (!test_skip(a, 2))
            check_constant(extremes[a], extremes[(a + 1) % (sizeof extremes / sizeof *extremes)],
                           false, &random);
    if (!test_brief())
        check_constant((slv_res){12, 12}, (slv_res){0, 0}, true, &random);
    kit k;
    kit_grid(&k, 1, 1, false, 0, NULL, NULL);
    k.res[0] = (slv_res){15, 0};
    kit_noise(&k, SLV_TYPE_U8, 1, &random); /* one value would take one texel */
    slv_gl_texture *texture = NULL;
    const bool fits = slv_gl_get_info(gl)->max_texture_size >= 1u << 15;
    CHECK(slv_gl_texture_create(gl, &env, k.texture, k.adjacency, NULL, &texture) ==
          (fits ? SLV_OK : SLV_ERROR_LIMIT));
    CHECK(fits || (texture == NULL && strstr(test_last_log, "limit")));
    slv_gl_texture_destroy(texture);
    kit_free(&k);
}

/* A batch that may bind few arrays leaves neighbours out, and a whole quad may have lost one of the
 * two sub-faces beside it: what comes out is a boundary there, and never another face's texels.
 * Every face has its own value, so strangers would show. */
static void check_missing_neighbours(uint64_t *random) {
    for (int round = 0; round < 8; round += test_brief() ? 5 : 1) {
        kit k;
        kit_pentagons(&k, random);
        if (round >= 4) {
            slv_env env = test_env();
            slv_face_adjacency *records = malloc(k.nfaces * sizeof *records);
            uint8_t *flags = malloc(k.nfaces);
            slv_adjacency *cut = NULL;
            REQUIRE(records && flags);
            memcpy(records, slv_adjacency_faces(k.adjacency), k.nfaces * sizeof *records);
            memcpy(flags, slv_mesh_face_flags(k.mesh), k.nfaces);
            for (unsigned e = 0; e < 4;
                 e++) /* a sub-face of the first pentagon loses all its neighbours */
                records[round - 4].face[e] = SLV_BOUNDARY;
            slv_result result = slv_adjacency_create(&env, k.nfaces, records, flags, &cut);
            REQUIRE(result == SLV_OK);
            slv_adjacency_destroy(k.adjacency);
            k.adjacency = cut;
            free(records);
            free(flags);
        }
        kit_equal(&k, 3);
        kit_begin_texture(&k, SLV_TYPE_FLOAT, 1);
        for (uint32_t f = 0; f < k.nfaces; f++) {
            float value = exp2f((float)f);
            slv_result result = slv_texture_set_constant(k.texture, f, &value);
            REQUIRE(result == SLV_OK);
        }
        for (uint32_t most = 1; most <= 8; most *= test_brief() ? 4 : 2) {
            static float values[4 * NPOINTS];
            uint32_t batches;
            slv_gl_texture_params params = {KIT_ONLY(kit_strategy("traverse")), .pool_layers = 1,
                                            .batch_pools = most};
            random_points(&k, random);
            for (int i = 0; i < NPOINTS;
                 i++) /* magnified, on the middle of an edge: two or three faces take part */
                dx[2 * i] = dy[2 * i + 1] = 1e-4f;
            look_up(&k, &params, kit_strategy("traverse"), values, &batches);
            for (int i = 0; i < NPOINTS; i++) {
                float least = exp2f((float)k.nfaces), greatest = 0;
                for (uint32_t f = 0; f < k.nfaces; f++) {
                    bool near = (int32_t)f == faces[i];
                    for (unsigned corner = 0; corner < 4; corner++) {
                        slv_ring ring = slv_adjacency_ring(k.adjacency, faces[i], corner, NULL);
                        slv_neighbour across[2];
                        uint32_t count =
                            slv_adjacency_neighbours(k.adjacency, faces[i], corner, across);
                        for (uint32_t n = 0; n < count; n++)
                            near |= across[n].face == (int32_t)f;
                        for (uint32_t n = 0; n < ring.count; n++)
                            near |= ring.corners[n].face == (int32_t)f;
                    }
                    if (near) {
                        least = fminf(least, exp2f((float)f));
                        greatest = fmaxf(greatest, exp2f((float)f));
                    }
                }
                CHECK_MSG(values[4 * i] > least * 0.999f && values[4 * i] < greatest * 1.001f,
                          "%u pools: %g on face %d is none of its neighbours' (%g to %g)", most,
                          (double)values[4 * i], faces[i], (double)least, (double)greatest);
            }
        }
        kit_free(&k);
    }
}

static void check_refusals(void) {
    slv_env env = test_env();
    uint64_t random = 1;
    kit k;
    kit_grid(&k, 3, 3, false, 0, &random, NULL);
    kit_equal(&k, 2);
    kit_noise(&k, SLV_TYPE_U8, 3, &random);
    slv_gl_texture_params params = {KIT_ONLY(kit_strategy("clamp"))};
    slv_gl_texture *texture = NULL;
    slv_result result = slv_gl_texture_create(gl, &env, k.texture, k.adjacency, &params, &texture);
    REQUIRE(result == SLV_OK);
    float zero[2] = {0, 0}, value[4];
    int32_t outside = 9;
    CHECK(slv_gl_texture_lookup(texture, &env, kit_strategy("clamp"), 1, &outside, zero, zero, zero,
                                value) == SLV_ERROR_ARGUMENT);
    CHECK(strstr(test_last_log, "face 9"));
    outside = 0;
    CHECK(slv_gl_texture_lookup(texture, &env, kit_strategy("borders"), 1, &outside, zero, zero,
                                zero, value) == SLV_ERROR_ARGUMENT);
    CHECK(strstr(test_last_log, "borders"));
    slv_gl_texture_destroy(texture);
    params = (slv_gl_texture_params){.first_channel = 3};
    CHECK(slv_gl_texture_create(gl, &env, k.texture, k.adjacency, &params, &texture) ==
          SLV_ERROR_ARGUMENT);
    kit_free(&k);
}

int main(void) {
    uint64_t random = 11;
    slv_env env = test_env();
    kit k;
    slv_result result = slv_gl_create(&env, SLV_GL_AUTO, &gl);
    REQUIRE(result == SLV_OK);
    kit_grid(&k, 6, 6, false, 20, &random, NULL);
    kit_mixed(&k, 4, &random);
    check_spread(&k, SLV_TYPE_HALF, 4, &random);
    kit_free(&k);
    check_pages(&random);
    check_extremes();
    check_missing_neighbours(&random);
    check_refusals();
    slv_gl_destroy(gl);
    return test_end();
}
