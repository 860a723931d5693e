/* Seam jumps of lookups on the GPU: vertices of every valence, sub-faces, open meshes, all types
 * and channel counts, textures of pure noise, where nothing but exact agreement of the two faces
 * hides an edge. */
#include "kit/seam_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/edge_aligned.h>

static slv_gl *gl;

static slv_gl_texture *upload(const kit *k, uint32_t anisotropy) {
    return seam_upload(gl, k, (slv_gl_texture_params){.anisotropy = anisotropy});
}

static slv_gl_seam jump(slv_gl_texture *texture, const kit *k, const slv_strategy *strategy,
                        uint32_t level) {
    return seam_jump(texture, k, strategy, (slv_gl_seam_params){.samples = 33, .level = level});
}

/* The coarsest level that every face has. */
static uint32_t coarsest(const kit *k) {
    uint32_t level = 3;
    for (uint32_t f = 0; f < k->nfaces; f++)
        level = (uint32_t)k->res[f].u < level ? (uint32_t)k->res[f].u : level;
    return level;
}

/* What must hold for faces whose texels are of one size, at the finest level and at every other. */
static void check_equal(const kit *k, const char *name, uint32_t anisotropy) {
    slv_gl_texture *texture = upload(k, anisotropy);
    for (uint32_t level = 0; level <= coarsest(k); level++) {
        slv_gl_seam clamp = jump(texture, k, kit_strategy("clamp"), level);
        slv_gl_seam borders = jump(texture, k, kit_strategy("borders"), level);
        slv_gl_seam traverse = jump(texture, k, kit_strategy("traverse"), level);
        slv_gl_seam full = jump(texture, k, kit_strategy("traverse-full"), level);
        slv_gl_seam aligned = jump(texture, k, kit_strategy("edge-aligned"), level);
        CHECK_MSG(
            aligned.max <= 1.0f / 255,
            "%s %s %u channels level %u aniso %u: edge-aligned jumps by %g at face %d edge %d "
            "t %g",
            name, slv_type_name(k->type), k->nchannels, level, anisotropy, (double)aligned.max,
            aligned.face, aligned.edge, (double)aligned.t);
        slv_gl_seam htex = jump(texture, k, kit_strategy("htex"), level);
        CHECK_MSG(htex.max <= 1.0f / 255,
                  "%s %s %u channels level %u aniso %u: htex jumps by %g at face %d edge %d t %g",
                  name, slv_type_name(k->type), k->nchannels, level, anisotropy, (double)htex.max,
                  htex.face, htex.edge, (double)htex.t);
        CHECK(clamp.nedges > 0 && clamp.nequal == clamp.nedges);
        CHECK_MSG(full.max <= 1.0f / 255, "%s level %u: traverse-full jumps by %g", name, level,
                  (double)full.max);
        if (level == 0) {
            slv_gl_seam hybrid = jump(texture, k, kit_strategy("hybrid"), 0);
            slv_gl_seam discard = jump(texture, k, kit_strategy("discard"), 0);
            CHECK_MSG(hybrid.max <= 1.0f / 255,
                      "%s %s %u channels aniso %u: hybrid jumps by %g at face %d edge %d t %g",
                      name, slv_type_name(k->type), k->nchannels, anisotropy, (double)hybrid.max,
                      hybrid.face, hybrid.edge, (double)hybrid.t);
            CHECK_MSG(discard.max > 0.2f, "%s: discard jumps by only %g when magnified", name,
                      (double)discard.max);
        }
        if (level == 0)
            CHECK_MSG(clamp.max > 0.2f,
                      "%s: clamp jumps by only %g: the measure does not see seams", name,
                      (double)clamp.max);
        CHECK_MSG(borders.max <= 1.0f / 255,
                  "%s %s level %u aniso %u: borders jump by %g at face %d edge %d t %g", name,
                  slv_type_name(k->type), level, anisotropy, (double)borders.max, borders.face,
                  borders.edge, (double)borders.t);
        CHECK_MSG(
            traverse.max <= 1.0f / 255,
            "%s %s %u channels level %u aniso %u: traverse jumps by %g at face %d edge %d t %g",
            name, slv_type_name(k->type), k->nchannels, level, anisotropy, (double)traverse.max,
            traverse.face, traverse.edge, (double)traverse.t);
    }
    slv_gl_texture_destroy(texture);
}

static void check_all_types(kit *k, const char *name, uint64_t *random) {
    static uint32_t turn;
    for (int type = 0; type < 4; type++) {
        if (test_skip(turn++, 3))
            continue;
        kit_noise(k, (slv_type)type, 1 + test_random(random) % 4, random);
        check_equal(k, name, 1);
    }
    kit_noise(k, SLV_TYPE_U8, 3, random);
    if (!test_brief())
        check_equal(k, name, 1);
    check_equal(k, name, 16);
}

/* Any mixture: the strategies must stay finite, and hide most of what clamp shows. */
static void check_mixed(kit *k, const char *name, uint64_t *random) {
    kit_mixed(k, 5, random);
    kit_noise(k, SLV_TYPE_U8, 3, random);
    slv_gl_texture *texture = upload(k, 1);
    slv_gl_seam clamp = jump(texture, k, kit_strategy("clamp"), 0);
    slv_gl_seam borders = jump(texture, k, kit_strategy("borders"), 0);
    slv_gl_seam traverse = jump(texture, k, kit_strategy("traverse"), 0);
    slv_gl_seam hybrid = jump(texture, k, kit_strategy("hybrid"), 0);
    CHECK_MSG(borders.mean < clamp.mean / 8, "%s mixed: borders %g clamp %g", name,
              (double)borders.mean, (double)clamp.mean);
    CHECK_MSG(traverse.mean < clamp.mean / 8, "%s mixed: traverse %g clamp %g", name,
              (double)traverse.mean, (double)clamp.mean);
    CHECK(isfinite(borders.max) && isfinite(traverse.max));
    /* These two alone agree everywhere, beside sub-faces of any sizes too; and htex, whose faces
     * look up the same texels, from any distance. */
    for (uint32_t level = 0; level < 6; level++) {
        slv_gl_seam htex = jump(texture, k, kit_strategy("htex"), level);
        CHECK_MSG(htex.max <= 1.0f / 255,
                  "%s mixed level %u: htex jumps by %g at face %d edge %d t %g", name, level,
                  (double)htex.max, htex.face, htex.edge, (double)htex.t);
    }
    slv_gl_seam aligned = jump(texture, k, kit_strategy("edge-aligned"), 0);
    CHECK_MSG(aligned.max <= 1.0f / 255,
              "%s mixed: edge-aligned jumps by %g at face %d edge %d t %g", name,
              (double)aligned.max, aligned.face, aligned.edge, (double)aligned.t);
    /* Edges between texels of one size stay exact even where a vertex has faces of other sizes.
     * Only beside two sub-faces of different sizes across one edge is agreement near and not exact.
     */
    bool subfaces = false;
    for (uint32_t f = 0; f < k->nfaces; f++)
        subfaces |= kit_sub(k, f);
    CHECK_MSG(subfaces || borders.equal_max <= 1.0f / 255,
              "%s mixed: borders jump by %g between equals", name, (double)borders.equal_max);
    CHECK_MSG(hybrid.mean < clamp.mean / 8, "%s mixed: hybrid %g clamp %g", name,
              (double)hybrid.mean, (double)clamp.mean);
    CHECK_MSG(subfaces || hybrid.equal_max <= 1.0f / 255,
              "%s mixed: hybrid jumps by %g between equals", name, (double)hybrid.equal_max);
    CHECK_MSG(subfaces || traverse.equal_max <= 1.0f / 255,
              "%s mixed: traverse jumps by %g between equals", name, (double)traverse.equal_max);
    slv_gl_texture_destroy(texture);
}

/* Across a whole face, from one edge to the other and beyond into a neighbour of another
 * resolution: no lookup may jump anywhere, not on the edge and not inside. Steps are a sixteenth of
 * the finest texel. */
static void check_no_inner_line(uint64_t *random) {
    enum { STEPS = 1025 };
    static int32_t faces[STEPS];
    static float uv[2 * STEPS], tiny[2 * STEPS], zero[2 * STEPS], values[4 * STEPS];
    slv_env env = test_env();
    for (uint32_t round = 0; round < test_effort(12); round++) {
        kit k;
        kit_grid(&k, 3, 3, false, round % 2 ? 40 : 0, random, NULL);
        for (uint32_t f = 0; f < k.nfaces; f++)
            k.res[f].u = k.res[f].v =
                (int8_t)(round % 3 ? 6 - 2 * (int)(f % 3) : (int)(test_random(random) % 7));
        kit_noise(&k, SLV_TYPE_FLOAT, 3, random);
        slv_gl_texture *texture = upload(&k, 1);
        for (uint32_t f = 0; f < k.nfaces; f++) {
            float across = (float)(test_random(random) % 1000) / 1000, steepest = 0;
            for (int i = 0; i < STEPS; i++) {
                faces[i] = (int32_t)f;
                uv[2 * i + (int)(f % 2)] = (float)i / (STEPS - 1);
                uv[2 * i + 1 - (int)(f % 2)] = across;
                tiny[2 * i] = 1e-4f;
                zero[2 * i + 1] = 1e-4f;
            }
            const slv_strategy *strategy =
                f % 4 < 2 ? kit_strategy("traverse") : kit_strategy("hybrid");
            slv_result result = slv_gl_texture_lookup(texture, &env, strategy, STEPS, faces, uv,
                                                      tiny, zero, values);
            REQUIRE(result == SLV_OK);
            for (int i = 1; i < STEPS; i++)
                for (int c = 0; c < 3; c++)
                    steepest = fmaxf(steepest, fabsf(values[4 * i + c] - values[4 * i - 4 + c]));
            CHECK_MSG(steepest < 0.2f, "round %d: a step of %g inside face %u of %d texels", round,
                      (double)steepest, f, 1 << k.res[f].u);
        }
        slv_gl_texture_destroy(texture);
        kit_free(&k);
    }
}

/* The GPU's samples are those of slv_edge_aligned, at every level and in every corner of a face. */
static void check_samples(uint64_t *random) {
    enum { POINTS = 1024 };
    static int32_t faces[POINTS];
    static float uv[2 * POINTS], dx[2 * POINTS], dy[2 * POINTS], values[4 * POINTS];
    slv_env env = test_env();
    for (int type = 0; type < 4; type++) {
        kit k;
        slv_edge_aligned *aligned = NULL;
        uint32_t level[POINTS], n = 1 + (uint32_t)type;
        kit_pentagons(&k, random);
        for (uint32_t f = 0; f < k.nfaces; f++)
            k.res[f] =
                (slv_res){(int8_t)(test_random(random) % 5), (int8_t)(test_random(random) % 5)};
        kit_noise(&k, (slv_type)type, n, random);
        REQUIRE(slv_edge_aligned_create(&env, k.levels, k.adjacency, &aligned) == SLV_OK);
        slv_gl_texture *texture = upload(&k, 1);
        for (int i = 0; i < POINTS; i++) {
            uint32_t f = test_random(random) % k.nfaces;
            slv_res res = k.res[f];
            level[i] = test_random(random) % slv_res_level_count(res);
            faces[i] = (int32_t)f;
            uv[2 * i] = (float)(test_random(random) % 17) / 16;
            uv[2 * i + 1] = (float)(test_random(random) % 17) / 16;
            dx[2 * i] = ldexpf(1, (int)level[i] - res.u);
            dy[2 * i + 1] = ldexpf(1, (int)level[i] - res.v);
        }
        REQUIRE(slv_gl_texture_lookup(texture, &env, kit_strategy("edge-aligned"), POINTS, faces,
                                      uv, dx, dy, values) == SLV_OK);
        for (int i = 0; i < POINTS; i++) {
            float expected[4];
            slv_edge_aligned_lookup(aligned, (uint32_t)faces[i], level[i], uv[2 * i], uv[2 * i + 1],
                                    expected);
            for (uint32_t c = 0; c < n; c++)
                CHECK_MSG(fabsf(values[4 * i + (int)c] - expected[c]) < 2e-3f,
                          "%s face %d level %u (%g, %g): %g for %g", slv_type_name(k.type),
                          faces[i], level[i], (double)uv[2 * i], (double)uv[2 * i + 1],
                          (double)values[4 * i + (int)c], (double)expected[c]);
        }
        slv_gl_texture_destroy(texture);
        slv_edge_aligned_destroy(aligned);
        kit_free(&k);
    }
}

/* Beside a seam, while the view goes from magnified to minified: what hybrid shows goes over from
 * traverse's value to discard's without a jump, in half a level, which is 64 steps here. */
static void check_transition(uint64_t *random) {
    enum { STEPS = 257, PLACES = 16 };
    static int32_t faces[STEPS];
    static float uv[2 * STEPS], dx[2 * STEPS], dy[2 * STEPS];
    static float values[3][4 * STEPS];
    const slv_strategy *const strategies[3] = {kit_strategy("traverse"), kit_strategy("discard"),
                                               kit_strategy("hybrid")};
    slv_env env = test_env();
    kit k;
    kit_disc(&k, 5, random);
    kit_equal(&k, 4);
    kit_noise(&k, SLV_TYPE_FLOAT, 3, random);
    slv_gl_texture *texture = upload(&k, 1);
    float apart = 0;
    int blended = 0;
    for (int place = 0; place < PLACES; place++) {
        float u = (float)(test_random(random) % 1000) / 1000;
        for (int i = 0; i < STEPS; i++) {
            float texels = exp2f(-1 + 2 * (float)i / (STEPS - 1));
            faces[i] = place % 5;
            uv[2 * i] = u;
            uv[2 * i + 1] = 0.2f / 16;
            dx[2 * i] = dy[2 * i + 1] = texels / 16;
            dx[2 * i + 1] = dy[2 * i] = 0;
        }
        for (int s = 0; s < 3; s++)
            REQUIRE(slv_gl_texture_lookup(texture, &env, strategies[s], STEPS, faces, uv, dx, dy,
                                          values[s]) == SLV_OK);
        for (int i = 0; i < STEPS; i++) {
            float level = -1 + 2 * (float)i / (STEPS - 1);
            for (int c = 0; c < 3; c++) {
                float traverse = values[0][4 * i + c], discard = values[1][4 * i + c];
                float hybrid = values[2][4 * i + c];
                apart = fmaxf(apart, fabsf(traverse - discard));
                CHECK(hybrid >= fminf(traverse, discard) - 1e-5f &&
                      hybrid <= fmaxf(traverse, discard) + 1e-5f);
                if (level < -0.01f)
                    CHECK_MSG(fabsf(hybrid - traverse) < 1e-6f, "level %g: %g, traverse has %g",
                              (double)level, (double)hybrid, (double)traverse);
                if (level > 0.51f)
                    CHECK_MSG(fabsf(hybrid - discard) < 1e-6f, "level %g: %g, discard has %g",
                              (double)level, (double)hybrid, (double)discard);
                float allowed = 0.03f * fabsf(traverse - discard) + 1e-4f, step = 0;
                for (int s = 0; i && s < 3; s++) {
                    step = fabsf(values[s][4 * i + c] - values[s][4 * i - 4 + c]);
                    allowed += s < 2 ? step : 0;
                }
                CHECK_MSG(step <= allowed, "level %g: a step of %g, allowed %g", (double)level,
                          (double)step, (double)allowed);
                blended += fabsf(hybrid - traverse) > 1e-4f && fabsf(hybrid - discard) > 1e-4f;
            }
        }
    }
    CHECK(blended > 0);
    CHECK_MSG(apart > 0.1f, "traverse and discard are only %g apart", (double)apart);
    slv_gl_texture_destroy(texture);
    kit_free(&k);
}

/* Parts of a mesh, of any sizes, are together the whole; and beyond its faces there is nothing. */
static void check_parts(uint64_t *random) {
    slv_env env = test_env();
    const slv_strategy *strategy = kit_strategy("clamp");
    kit k;
    kit_pentagons(&k, random); /* with sub-faces */
    kit_mixed(&k, 4, random);
    kit_noise(&k, SLV_TYPE_U8, 3, random);
    slv_gl_texture *texture = upload(&k, 1);
    const slv_gl_seam whole = seam_jump(texture, &k, strategy, (slv_gl_seam_params){0});
    slv_gl_seam sum = {0};
    double mean = 0;
    for (uint32_t f = 0, n; f < k.nfaces; f += n) {
        n = 1 + test_random(random) % (k.nfaces - f);
        const slv_gl_seam part =
            seam_jump(texture, &k, strategy, (slv_gl_seam_params){.first_face = f, .nfaces = n});
        if (part.nedges && (!sum.nedges || part.max > sum.max)) {
            sum.max = part.max;
            sum.face = part.face;
            sum.edge = part.edge;
        }
        sum.nedges += part.nedges;
        sum.nequal += part.nequal;
        mean += (double)part.mean * part.nedges;
    }
    CHECK(whole.nedges > 0 && sum.nedges == whole.nedges && sum.nequal == whole.nequal);
    CHECK(sum.max == whole.max && sum.face == whole.face && sum.edge == whole.edge);
    CHECK(fabs(mean / sum.nedges - (double)whole.mean) < 1e-6);
    slv_gl_seam_params beyond = {.first_face = 1, .nfaces = k.nfaces};
    slv_gl_seam none;
    CHECK(slv_gl_texture_seam_jump(texture, &env, strategy, k.adjacency, &beyond, &none) ==
          SLV_ERROR_ARGUMENT);
    slv_gl_texture_destroy(texture);
    kit_free(&k);
}

int main(void) {
    static const int32_t valences[] = {3, 4, 5, 6, 8, 12};
    uint64_t random = 7;
    slv_env env = test_env();
    char name[32];
    kit k;
    slv_result result = slv_gl_create(&env, SLV_GL_AUTO, &gl);
    REQUIRE(result == SLV_OK);
    for (uint32_t i = 0; i < sizeof valences / sizeof *valences; i++) {
        if (test_skip(i, 3))
            continue;
        snprintf(name, sizeof name, "valence %d", valences[i]);
        kit_disc(&k, valences[i], &random);
        kit_equal(&k, 3);
        check_all_types(&k, name, &random);
        check_mixed(&k, name, &random);
        kit_free(&k);
    }
    kit_cube(&k, &random);
    kit_equal(&k, 4);
    check_all_types(&k, "cube", &random);
    check_mixed(&k, "cube", &random);
    kit_equal(&k, 0);
    kit_noise(&k, SLV_TYPE_FLOAT, 3, &random);
    check_equal(&k, "cube of single texels", 1);
    kit_free(&k);
    kit_pentagons(&k, &random);
    kit_equal(&k, 4);
    check_all_types(&k, "pentagons", &random);
    check_mixed(&k, "pentagons", &random);
    kit_free(&k);
    for (int i = test_brief(); i < 3; i += test_brief() ? 2 : 1) {
        kit_grid(&k, 5, 4, i == 1, i == 2 ? 30 : 0, &random, NULL);
        kit_equal(&k, 3);
        check_all_types(&k, i == 0 ? "open grid" : i == 1 ? "torus" : "split grid", &random);
        check_mixed(&k, "grid", &random);
        kit_free(&k);
    }
    check_no_inner_line(&random);
    check_transition(&random);
    check_samples(&random);
    check_parts(&random);
    slv_gl_destroy(gl);
    return test_end();
}
