/* Levels that agree where faces meet: on any topology, at any resolutions, in every type. */
#include "kit/border_kit.h"

#include <selvage/seamless.h>

#include <string.h>

/* The texel of a level that holds a point. */
static void texel_at(const slv_levels *levels, uint32_t face, uint32_t level, float u, float v,
                     float *out) {
    const slv_texture_desc *desc = slv_levels_get_desc(levels);
    slv_res res = slv_res_level(desc->res[face], level);
    uint32_t x = (uint32_t)(u * (float)(1u << res.u)), y = (uint32_t)(v * (float)(1u << res.v));
    size_t at = (((size_t)y << res.u) + x) * desc->nchannels;
    const char *texels = slv_levels_texels(levels, face, level);
    slv_type_to_float(desc->type, texels + at * slv_type_size(desc->type), desc->nchannels, out);
}

/* Across every edge between faces of one size the outermost texels are the same, found by the maps
 * between faces and not by what made them. */
static void check_by_maps(const kit *k, const slv_levels *levels, uint32_t level) {
    for (uint32_t f = 0; f < k->nfaces; f++)
        for (unsigned e = 0; e < 4; e++) {
            slv_neighbour to[2];
            slv_res res = k->res[f];
            if (slv_adjacency_neighbours(k->adjacency, (int32_t)f, e, to) != 1 ||
                to[0].scale != 1 || memcmp(&k->res[to[0].face], &res, sizeof res) != 0 ||
                res.u != res.v || (uint32_t)res.u < level + 1)
                continue;
            float texel = 1.0f / (float)(1u << (res.u - (int)level));
            for (float t = texel / 2; t < 1; t += texel) {
                float in = texel / 2, own[4], across[4], u, v;
                float inside[4][2] = {{t, in}, {1 - in, t}, {t, 1 - in}, {in, t}};
                float outside[4][2] = {{t, -in}, {1 + in, t}, {t, 1 + in}, {-in, t}};
                slv_affine_apply(&to[0].map, outside[e][0], outside[e][1], &u, &v);
                texel_at(levels, f, level, inside[e][0], inside[e][1], own);
                texel_at(levels, (uint32_t)to[0].face, level, u, v, across);
                CHECK(memcmp(own, across, k->nchannels * sizeof *own) == 0);
            }
        }
}

/* Around a vertex of faces of one size all have the same texel in it. */
static void check_rings(const kit *k, const slv_levels *levels, uint32_t level) {
    static const float at[4][2] = {{0, 0}, {0.999f, 0}, {0.999f, 0.999f}, {0, 0.999f}};
    for (uint32_t f = 0; f < k->nfaces; f++)
        for (unsigned c = 0; c < 4; c++) {
            slv_ring ring = slv_adjacency_ring(k->adjacency, (int32_t)f, c, NULL);
            float own[4], other[4];
            bool alike = k->res[f].u == k->res[f].v && (uint32_t)k->res[f].u > level;
            for (uint32_t i = 0; i < ring.count; i++) {
                uint32_t member = (uint32_t)ring.corners[i].face;
                alike = alike && !memcmp(&k->res[f], &k->res[member], sizeof *k->res) &&
                        kit_sub(k, f) == kit_sub(k, member);
            }
            for (uint32_t i = 0; i < ring.count && alike; i++) {
                slv_corner member = ring.corners[i];
                texel_at(levels, f, level, at[c][0], at[c][1], own);
                texel_at(levels, (uint32_t)member.face, level, at[member.corner][0],
                         at[member.corner][1], other);
                CHECK_MSG(memcmp(own, other, k->nchannels * sizeof *own) == 0,
                          "face %u corner %u and face %d corner %u", f, c, member.face,
                          member.corner);
            }
        }
}

static float plain_most; /* of all that were compared */

static void check(const kit *k, const char *name) {
    slv_env env = test_env();
    slv_levels *levels = NULL, *again = NULL, *upper = NULL;
    float unit = k->type == SLV_TYPE_U8 ? 1 / 255.0f : k->type == SLV_TYPE_U16 ? 1 / 65535.0f : 0;
    float most = k->type == SLV_TYPE_HALF ? 1 / 2048.0f : 0.51f * unit + 1e-5f;
    REQUIRE(!slv_levels_create_seamless(&env, k->texture, k->adjacency, 0, &levels));
    REQUIRE(!slv_levels_create_seamless(&env, k->texture, k->adjacency, 1, &upper));
    env.threads = 1;
    REQUIRE(!slv_levels_create_seamless(&env, k->texture, k->adjacency, 0, &again));
    for (uint32_t level = 0; level < 6; level++) {
        slv_seam_agreement now, plain;
        slv_levels_agreement(levels, k->adjacency, level, &now);
        slv_levels_agreement(k->levels, k->adjacency, level, &plain);
        CHECK_MSG(now.equal_max == 0, "%s level %u: equal texels are %g apart", name, level,
                  (double)now.equal_max);
        CHECK_MSG(now.mixed_max <= most, "%s level %u: mixed texels are %g apart", name, level,
                  (double)now.mixed_max);
        plain_most = fmaxf(plain_most, fmaxf(plain.equal_max, plain.mixed_max));
        check_by_maps(k, levels, level);
        check_rings(k, levels, level);
    }
    for (uint32_t f = 0; f < k->nfaces; f++)
        for (uint32_t level = 0; level < slv_levels_count(levels, f); level++) {
            size_t size =
                kit_texels(slv_res_level(k->res[f], level)) * k->nchannels * slv_type_size(k->type);
            CHECK(!memcmp(slv_levels_texels(levels, f, level), slv_levels_texels(again, f, level),
                          size));
            CHECK(!memcmp(slv_levels_texels(upper, f, level),
                          slv_levels_texels(level ? levels : k->levels, f, level), size));
        }
    slv_levels_destroy(levels);
    slv_levels_destroy(again);
    slv_levels_destroy(upper);
}

static void sizes(kit *k, int round, uint64_t *random) {
    if (round == 0)
        kit_equal(k, 4);
    else
        for (uint32_t f = 0; f < k->nfaces; f++) {
            k->res[f].u = (int8_t)(test_random(random) % 6);
            k->res[f].v = round == 1 ? k->res[f].u : (int8_t)(test_random(random) % 6);
        }
}

static void run(kit *k, const char *name, uint64_t *random) {
    int rounds = (int)test_effort(6);
    for (int round = 0; round < rounds; round++) {
        sizes(k, round % 3, random);
        kit_noise(k, (slv_type)(round % 4), 1 + (uint32_t)round % 4, random);
        check(k, name);
    }
    kit_free(k);
}

/* What cannot be done is said, and a chain that agrees is not updated. */
static void refusals(uint64_t *random) {
    slv_env env = test_env();
    slv_levels *levels = NULL;
    kit k, other;
    kit_cube(&k, random);
    kit_equal(&k, 3);
    kit_noise(&k, SLV_TYPE_U8, 3, random);
    kit_disc(&other, 5, random);
    CHECK(slv_levels_create_seamless(&env, k.texture, other.adjacency, 1, &levels) ==
              SLV_ERROR_MISMATCH &&
          !levels);
    CHECK(slv_levels_create_seamless(&env, k.texture, NULL, 1, &levels) == SLV_ERROR_ARGUMENT);
    REQUIRE(!slv_levels_create_seamless(&env, k.texture, k.adjacency, 1, &levels));
    CHECK(slv_levels_update(levels, k.texture, 0, (slv_rect){0, 0, 1, 1}) == SLV_ERROR_UNSUPPORTED);
    slv_levels_destroy(levels);
    kit_free(&k);
    kit_free(&other);
}

int main(void) {
    uint64_t random = 17;
    char name[32];
    kit k;
    for (int32_t valence = 3; valence <= 8; valence++) {
        snprintf(name, sizeof name, "valence %d", valence);
        kit_disc(&k, valence, &random);
        run(&k, name, &random);
    }
    kit_cube(&k, &random);
    run(&k, "cube", &random);
    kit_pentagons(&k, &random);
    run(&k, "pentagons", &random);
    for (int i = 0; i < 3; i++) {
        kit_grid(&k, 5, 4, i == 1, i == 2 ? 40 : 0, &random, NULL);
        run(&k, i == 0 ? "open grid" : i == 1 ? "torus" : "split grid", &random);
    }
    CHECK_MSG(plain_most > 0.5f, "plain levels are only %g apart", (double)plain_most);
    refusals(&random);
    return test_end();
}
