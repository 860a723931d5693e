/* Seams between faces of any sizes, magnified: both faces must give the same value on the whole of
 * their edge, however near to a vertex, and no line may show inside a face where the influence of a
 * neighbour ends. Textures are noise, so that only exact agreement hides anything. */
#include "kit/border_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_texture.h>

static slv_gl *gl;

/* The second and third have the first one's lookups under magnification. */
static const char *const strategies[] = {"traverse", "traverse-full", "hybrid"};

static slv_gl_texture *upload(const kit *k, uint32_t anisotropy, slv_gl_branching branching) {
    slv_env env = test_env();
    slv_gl_texture_params params = {KIT_ALL, .anisotropy = anisotropy, .branching = branching};
    slv_gl_texture *texture = NULL;
    REQUIRE(slv_gl_texture_create(gl, &env, k->texture, k->adjacency, &params, &texture) == SLV_OK);
    return texture;
}

static void check_seams(const kit *k, slv_gl_texture *texture, int nstrategies, const char *name) {
    slv_env env = test_env();
    slv_gl_seam_params params = {.samples = 257};
    slv_gl_seam seam;
    for (int s = 0; s < nstrategies; s++) {
        REQUIRE(slv_gl_texture_seam_jump(texture, &env, kit_strategy(strategies[s]), k->adjacency,
                                         &params, &seam) == SLV_OK);
        CHECK_MSG(seam.max <= 0.1f / 255 + kit_weight_step(gl),
                  "%s: %s jumps by %g/255 at face %d edge %d t %g", name, strategies[s],
                  (double)seam.max * 255, seam.face, seam.edge, (double)seam.t);
    }
    REQUIRE(slv_gl_texture_seam_jump(texture, &env, kit_strategy("clamp"), k->adjacency, &params,
                                     &seam) == SLV_OK);
    CHECK_MSG(seam.max > 0.2f, "%s: clamp jumps by only %g", name, (double)seam.max);
}

/* Along a line through a face, near to one of its edges or not, in steps of a sixteenth of the
 * finest texel anywhere. */
static void check_line(const kit *k, slv_gl_texture *texture, uint32_t face, float across,
                       bool along_v, const char *name) {
    enum { STEPS = 1025 };
    static int32_t faces[STEPS];
    static float uv[2 * STEPS], dx[2 * STEPS], dy[2 * STEPS], values[4 * STEPS];
    slv_env env = test_env();
    for (int i = 0; i < STEPS; i++) {
        faces[i] = (int32_t)face;
        uv[2 * i + along_v] = (float)i / (STEPS - 1);
        uv[2 * i + !along_v] = across;
        dx[2 * i] = dy[2 * i + 1] = 1e-4f;
    }
    float steepest = 0;
    int where = 0;
    REQUIRE(slv_gl_texture_lookup(texture, &env, kit_strategy("traverse"), STEPS, faces, uv, dx, dy,
                                  values) == SLV_OK);
    for (int i = 1; i < STEPS; i++) {
        for (uint32_t c = 0; c < k->nchannels; c++) {
            float step = fabsf(values[4 * i + (int)c] - values[4 * i - 4 + (int)c]);
            where = step > steepest ? i : where;
            steepest = fmaxf(steepest, step);
        }
    }
    CHECK_MSG(steepest < 0.2f, "%s: a step of %g inside face %u (%d x %d) at %g, %g", name,
              (double)steepest, face, 1 << k->res[face].u, 1 << k->res[face].v,
              (double)uv[2 * where], (double)uv[2 * where + 1]);
}

static void check_lines(const kit *k, slv_gl_texture *texture, const char *name, uint64_t *random) {
    for (int i = 0; i < 4; i++) {
        uint32_t face = test_random(random) % k->nfaces;
        float texels = exp2f((float)(test_random(random) % 7));
        float across = (float)(test_random(random) % 1000) / 1000 / texels;
        across = test_random(random) % 2 ? across : 1 - across;
        check_line(k, texture, face, across, i % 2, name);
    }
}

/* 1 to 64 texels wide, with rows of taps 4 to 32: the footprint is a 64th of the largest texel and
 * must not be more than a quarter of the smallest. A whole quad of one texel along an edge with two
 * sub-faces across meets them only nearly. */
static void random_sizes(kit *k, bool oblong, bool rows, uint64_t *random) {
    bool subfaces = false;
    uint32_t sizes = rows ? 6 : 7;
    for (uint32_t f = 0; f < k->nfaces; f++)
        subfaces |= kit_sub(k, f);
    for (uint32_t f = 0; f < k->nfaces; f++) {
        int8_t least = rows ? 2 : subfaces && !kit_sub(k, f);
        int8_t u = (int8_t)(test_random(random) % sizes), v = (int8_t)(test_random(random) % sizes);
        k->res[f].u = u > least ? u : least;
        k->res[f].v = !oblong ? k->res[f].u : v > least ? v : least;
    }
}

static void check(kit *k, const char *name, uint64_t *random) {
    static uint32_t turn;
    for (int round = 0; round < 4; round++) {
        if (test_skip(turn++, 5))
            continue;
        char what[64];
        uint32_t anisotropy = round == 3 ? 16 : 1, channels = round == 2 ? 4 : 3;
        snprintf(what, sizeof what, "%s, %s, %u channels, aniso %u", name,
                 round % 2 ? "oblong" : "square", channels, anisotropy);
        random_sizes(k, round % 2, anisotropy > 1, random);
        kit_noise(k, SLV_TYPE_FLOAT, channels, random);
        slv_gl_texture *texture =
            upload(k, anisotropy, round % 2 ? SLV_GL_BRANCHING_REAL : SLV_GL_BRANCHING_AUTO);
        check_seams(k, texture, round ? 1 : 3, what);
        check_lines(k, texture, what, random);
        slv_gl_texture_destroy(texture);
    }
}

/* One coarse face among fine ones, and one fine face among coarse ones. */
static void check_pairs(kit *k, const char *name, uint64_t *random) {
    static uint32_t turn;
    for (uint32_t odd = 0; odd < 2; odd++) {
        if (test_skip(turn++, 5))
            continue;
        for (uint32_t f = 0; f < k->nfaces; f++)
            k->res[f].u = k->res[f].v = (int8_t)(odd ? 5 : 2);
        uint32_t f = test_random(random) % k->nfaces;
        k->res[f].u = k->res[f].v = (int8_t)(odd ? 2 : 5);
        kit_noise(k, SLV_TYPE_FLOAT, 3, random);
        slv_gl_texture *texture = upload(k, 1, SLV_GL_BRANCHING_AUTO);
        check_seams(k, texture, 1, name);
        slv_gl_texture_destroy(texture);
    }
}

int main(void) {
    uint64_t random = 23;
    slv_env env = test_env();
    char name[32];
    kit k;
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    for (int32_t valence = 3; valence <= 8; valence++) {
        snprintf(name, sizeof name, "valence %d", valence);
        kit_disc(&k, valence, &random);
        check(&k, name, &random);
        check_pairs(&k, name, &random);
        kit_free(&k);
    }
    kit_cube(&k, &random);
    check(&k, "cube", &random);
    check_pairs(&k, "cube", &random);
    kit_free(&k);
    kit_pentagons(&k, &random);
    check(&k, "pentagons", &random);
    check_pairs(&k, "pentagons", &random);
    kit_free(&k);
    for (int i = 0; i < 3; i++) {
        kit_grid(&k, 5, 4, i == 1, i == 2 ? 30 : 0, &random, NULL);
        check(&k, i == 0 ? "open grid" : i == 1 ? "torus" : "split grid", &random);
        kit_free(&k);
    }
    slv_gl_destroy(gl);
    return test_end();
}
