/* Seam jumps of textures with alpha, whose colours are multiplied by it before anything is
 * filtered: noise of which half has no paint, and what lies there shows nowhere, so that the jumps
 * are those of any other texture. Figures of every strategy on standard error. */
#include "kit/seam_kit.h"
#include "kit/strategy_kit.h"

static slv_gl *gl;

/* Paint of any colour and alpha on half of the texels, glaring colours under the others. */
static void paint(kit *k, slv_type type, slv_texture_encoding encoding, uint64_t *random) {
    slv_env env = test_env();
    const slv_texture_desc desc = {k->nfaces, type, 4, 3, k->res, encoding};
    slv_texture *straight = NULL;
    REQUIRE(slv_texture_create(&env, &desc, &straight) == SLV_OK);
    for (uint32_t f = 0; f < k->nfaces; f++) {
        size_t count = 4 * kit_texels(k->res[f]);
        float *values = calloc(count, sizeof *values);
        void *texels = calloc(count, slv_type_size(type));
        REQUIRE(values && texels);
        for (size_t i = 0; i < count; i++) {
            bool bare = test_random(random) % 2 && i % 4 == 3;
            values[i] = bare ? 0 : (float)(test_random(random) % 4096) / 4095;
        }
        slv_type_from_float(type, values, count, texels);
        REQUIRE(slv_texture_set_face(straight, f, texels) == SLV_OK);
        free(values);
        free(texels);
    }
    slv_texture_destroy(k->texture);
    k->texture = NULL;
    REQUIRE(slv_texture_premultiply(&env, straight, SLV_TEXTURE_AUTO, &k->texture) == SLV_OK);
    slv_texture_destroy(straight);
}

static slv_gl_seam jump(slv_gl_texture *texture, const kit *k, const char *strategy,
                        uint32_t level) {
    return seam_jump(texture, k, kit_strategy(strategy),
                     (slv_gl_seam_params){.samples = 33, .level = level});
}

/* Those that agree in edges between texels of one size; from EXACT on between any. */
enum { EXACT = 4, STRATEGIES = 6 };
static const char *const strategies[STRATEGIES] = {"hybrid",        "borders",      "traverse",
                                                   "traverse-full", "edge-aligned", "htex"};
static float worst[STRATEGIES];

static void check_seam(slv_gl_texture *texture, const kit *k, int first, uint32_t level,
                       const char *name) {
    for (int i = first; i < STRATEGIES; i++) {
        slv_gl_seam seam = jump(texture, k, strategies[i], level);
        worst[i] = fmaxf(worst[i], seam.max);
        CHECK_MSG(seam.max <= 1.0f / 255, "%s level %u: %s jumps by %g/255 at face %d edge %d t %g",
                  name, level, strategies[i], (double)seam.max * 255, seam.face, seam.edge,
                  (double)seam.t);
    }
}

/* The coarsest level that every face has: sub-faces have half of the texels along a side. */
static int coarsest(const kit *k) {
    int level = INT8_MAX;
    for (uint32_t f = 0; f < k->nfaces; f++)
        level = k->res[f].u < level ? k->res[f].u : level;
    return level;
}

static void check_equal(kit *k, int log2, slv_type type, slv_texture_encoding encoding,
                        const char *name, uint64_t *random) {
    kit_equal(k, log2);
    paint(k, type, encoding, random);
    slv_gl_texture *texture = seam_upload(gl, k, (slv_gl_texture_params){.anisotropy = 1});
    slv_gl_seam clamp = jump(texture, k, "clamp", 0);
    CHECK_MSG(clamp.nedges > 0 && clamp.max > 0.2f, "%s: clamp jumps by only %g", name,
              (double)clamp.max);
    for (int level = 0; level <= coarsest(k); level++)
        check_seam(texture, k, level > 0, (uint32_t)level, name); /* hybrid is discard there */
    slv_gl_texture_destroy(texture);
}

static void check_mixed(kit *k, slv_type type, const char *name, uint64_t *random) {
    kit_mixed(k, 5, random);
    paint(k, type, SLV_TEXTURE_LINEAR, random);
    slv_gl_texture *texture = seam_upload(gl, k, (slv_gl_texture_params){.anisotropy = 1});
    slv_gl_seam clamp = jump(texture, k, "clamp", 0);
    check_seam(texture, k, EXACT, 0, name);
    for (int i = 0; i < EXACT - 1; i++) {
        slv_gl_seam seam = jump(texture, k, strategies[i], 0);
        CHECK_MSG(seam.mean < clamp.mean / 8, "%s mixed: %s %g clamp %g", name, strategies[i],
                  (double)seam.mean, (double)clamp.mean);
    }
    slv_gl_texture_destroy(texture);
}

int main(void) {
    static const int valences[] = {3, 5, 8};
    uint64_t random = 41;
    slv_env env = test_env();
    kit k;
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    for (int i = 0; i < 6; i++) {
        const slv_type type = (slv_type)(i % 4);
        char name[64];
        if (i < 3)
            kit_disc(&k, valences[i], &random);
        else if (i == 3)
            kit_cube(&k, &random);
        else if (i == 4)
            kit_pentagons(&k, &random);
        else
            kit_grid(&k, 4, 3, true, 30, &random, NULL);
        snprintf(name, sizeof name, "mesh %d, %s", i, slv_type_name(type));
        check_equal(&k, 3, type, SLV_TEXTURE_LINEAR, name, &random);
        if (!test_brief() || i == 4)
            check_equal(&k, 2, SLV_TYPE_U8, SLV_TEXTURE_SRGB, "sRGB", &random);
        if (!test_skip((uint32_t)i, 2))
            check_mixed(&k, type, name, &random);
        kit_free(&k);
    }
    for (int i = 0; i < STRATEGIES; i++)
        fprintf(stderr, "%s: %.3f/255 at most\n", strategies[i], (double)worst[i] * 255);
    slv_gl_destroy(gl);
    return test_end();
}
