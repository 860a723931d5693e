/* Even levels: seams of minified lookups between faces of any shapes, whose values are noise. */
#include "kit/seam_kit.h"
#include "kit/strategy_kit.h"

enum { STRATEGIES = 4, LAST_LEVEL = 4, LARGEST = 6 };
static const char *const names[STRATEGIES] = {"borders", "edge-aligned", "traverse",
                                              "traverse-full"};
static slv_gl *gl;
static const slv_strategy *strategies[STRATEGIES];

static slv_gl_texture *upload(const kit *k, bool even, uint32_t anisotropy) {
    return seam_upload(gl, k,
                       (slv_gl_texture_params){.strategies = strategies,
                                               .nstrategies = STRATEGIES,
                                               .anisotropy = anisotropy,
                                               .even_levels = even});
}

/* Faces of 2^(level + 1) to 64 texels a side: a footprint of 2^level is half of a face at most. */
static void any_shapes(kit *k, uint32_t level, uint64_t *random) {
    uint32_t least = level + 1, sizes = LARGEST + 1 - least;
    for (uint32_t f = 0; f < k->nfaces; f++)
        k->res[f] = (slv_res){(int8_t)(least + test_random(random) % sizes),
                              (int8_t)(least + test_random(random) % sizes)};
}

/* Minified, at one footprint, and magnified, where what held without even levels holds. */
static void check(kit *k, const char *name, uint64_t *random) {
    static uint32_t turn;
    bool subfaces = false;
    for (uint32_t f = 0; f < k->nfaces; f++)
        subfaces |= kit_sub(k, f);
    for (uint32_t i = 0; i < 2 * LAST_LEVEL; i++) {
        uint32_t level = i / 2 + 1, anisotropy = i % 2 ? 16 : 1;
        if (test_skip(turn++, 12))
            continue;
        any_shapes(k, level, random);
        kit_noise(k, level % 2 ? SLV_TYPE_U8 : SLV_TYPE_FLOAT, level == 2 ? 4 : 3, random);
        slv_gl_texture *texture = upload(k, true, anisotropy);
        for (uint32_t j = 0; j < 2 * STRATEGIES; j++) {
            uint32_t s = j / 2, at = j % 2 ? level : 0;
            slv_gl_seam seam = seam_jump(texture, k, strategies[s],
                                         (slv_gl_seam_params){.samples = 33, .level = at});
            /* borders meet texels of another size, and sub-faces of two sizes, only nearly */
            CHECK_MSG(seam.max <= 1.0f / 255 || (s == 0 && (subfaces || at == 0)),
                      "%s, footprint of %u, %ux: %s jumps by %g/255 at face %d edge %d t %g", name,
                      at ? 1u << at : 0, anisotropy, names[s], (double)seam.max * 255, seam.face,
                      seam.edge, (double)seam.t);
        }
        slv_gl_texture_destroy(texture);
    }
}

/* The measure sees that plain levels jump. */
static void check_plain(uint64_t *random) {
    kit k;
    kit_grid(&k, 5, 4, true, 0, random, NULL);
    any_shapes(&k, 2, random);
    kit_noise(&k, SLV_TYPE_U8, 3, random);
    slv_gl_texture *texture = upload(&k, false, 1);
    for (uint32_t s = 0; s < STRATEGIES; s++) {
        slv_gl_seam seam = seam_jump(texture, &k, strategies[s], (slv_gl_seam_params){.level = 2});
        CHECK_MSG(seam.max > 10.0f / 255, "%s jumps by only %g/255 with plain levels", names[s],
                  (double)seam.max * 255);
    }
    slv_gl_texture_destroy(texture);
    kit_free(&k);
}

/* Squares have the same levels either way, and lookups in them the same values. */
static void check_squares(uint64_t *random) {
    enum { POINTS = 512 };
    static int32_t faces[POINTS];
    static float uv[2 * POINTS], dx[2 * POINTS], dy[2 * POINTS], values[2][4 * POINTS];
    slv_env env = test_env();
    kit k;
    kit_pentagons(&k, random);
    kit_mixed(&k, 5, random);
    kit_noise(&k, SLV_TYPE_FLOAT, 3, random);
    slv_gl_texture *textures[2] = {upload(&k, false, 1), upload(&k, true, 1)};
    for (int i = 0; i < POINTS; i++) {
        faces[i] = (int32_t)(test_random(random) % k.nfaces);
        for (int c = 0; c < 2; c++)
            uv[2 * i + c] = (float)(test_random(random) % 1001) / 1000;
        dx[2 * i] = exp2f((float)(test_random(random) % 800) / 100 - 7);
        dy[2 * i + 1] = dx[2 * i] * (float)(1 + test_random(random) % 100) / 100;
    }
    for (uint32_t s = 0; s < STRATEGIES; s++) {
        for (int even = 0; even < 2; even++)
            REQUIRE(!slv_gl_texture_lookup(textures[even], &env, strategies[s], POINTS, faces, uv,
                                           dx, dy, values[even]));
        for (int i = 0; i < 4 * POINTS; i++)
            CHECK_MSG(fabsf(values[0][i] - values[1][i]) < 2e-3f + kit_weight_step(gl),
                      "%s, face %d: %g, with even levels %g", names[s], faces[i / 4],
                      (double)values[0][i], (double)values[1][i]);
    }
    slv_gl_texture_destroy(textures[0]);
    slv_gl_texture_destroy(textures[1]);
    kit_free(&k);
}

int main(void) {
    uint64_t random = 29;
    slv_env env = test_env();
    char name[32];
    kit k;
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    for (uint32_t s = 0; s < STRATEGIES; s++)
        strategies[s] = kit_strategy(names[s]);
    for (int32_t valence = 3; valence <= 8; valence++) {
        snprintf(name, sizeof name, "valence %d", valence);
        kit_disc(&k, valence, &random);
        check(&k, name, &random);
        kit_free(&k);
    }
    kit_cube(&k, &random);
    check(&k, "cube", &random);
    kit_free(&k);
    kit_pentagons(&k, &random);
    check(&k, "pentagons", &random);
    kit_free(&k);
    for (int i = 0; i < 3; i++) {
        kit_grid(&k, 5, 4, i == 1, i == 2 ? 30 : 0, &random, NULL);
        check(&k, i == 0 ? "open grid" : i == 1 ? "torus" : "split grid", &random);
        kit_free(&k);
    }
    check_plain(&random);
    check_squares(&random);
    slv_gl_destroy(gl);
    return test_end();
}
