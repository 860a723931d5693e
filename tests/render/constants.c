/* Faces of one value take one texel on the GPU: they look as they would with all of their texels,
 * with every strategy, at every size, and when they are painted on, filled again or resized. */
#include "kit/seam_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_live.h>

enum { POINTS = 4000 };

static slv_gl *gl;
static bool alike; /* all faces but one in a corner have one value */
static int32_t faces[POINTS];
static float uv[2 * POINTS], dx[2 * POINTS], dy[2 * POINTS];

static void place(const kit *k, uint64_t *random) {
    for (int i = 0; i < POINTS; i++) {
        float angle = (float)(test_random(random) % 628) / 100,
              width = ldexpf(1, 1 - (int)(test_random(random) % 9));
        faces[i] = (int32_t)(test_random(random) % k->nfaces);
        for (int c = 0; c < 2; c++) {
            float at = (float)(test_random(random) % 1001) / 1000, near = at * at * 0.2f;
            uv[2 * i + c] = i % 2 ? at : test_random(random) % 2 ? near : 1 - near;
        }
        dx[2 * i] = width * cosf(angle);
        dx[2 * i + 1] = width * sinf(angle);
        dy[2 * i] = -0.3f * dx[2 * i + 1];
        dy[2 * i + 1] = 0.3f * dx[2 * i];
    }
}

/* The same texels with a channel more, which is not shown, and in which no face is of one value. */
static slv_texture *spelled_out(const slv_texture *texture) {
    slv_env env = test_env();
    slv_texture_desc desc = *slv_texture_get_desc(texture);
    const size_t type = slv_type_size(desc.type), size = desc.nchannels * type;
    slv_texture *out = NULL;
    desc.nchannels++;
    REQUIRE(slv_texture_create(&env, &desc, &out) == SLV_OK);
    for (uint32_t f = 0; f < desc.nfaces; f++) {
        size_t count = kit_texels(desc.res[f]);
        unsigned char *texels = malloc(count * (size + type));
        const unsigned char *from = slv_texture_texels(texture, f);
        REQUIRE(texels);
        bool one = slv_texture_is_constant(texture, f);
        for (size_t i = 0; i < count; i++) {
            const float other = i ? 0.5f : 0.51f;
            memcpy(texels + i * (size + type), from + (one ? 0 : i * size), size);
            slv_type_from_float(desc.type, &other, 1, texels + i * (size + type) + size);
        }
        REQUIRE(slv_texture_set_face(out, f, texels) == SLV_OK);
        CHECK(count == 1 || !slv_texture_is_constant(out, f));
        free(texels);
    }
    return out;
}

static slv_gl_texture *upload(const kit *k, const slv_texture *texture,
                              slv_gl_texture_params params) {
    slv_env env = test_env();
    slv_gl_texture *out = NULL;
    REQUIRE(slv_gl_texture_create(gl, &env, texture, k->adjacency, &params, &out) == SLV_OK);
    return out;
}

/* How far lookups are from those of the same texels spelled out. */
static void check_same(const kit *k, slv_gl_texture *one, slv_gl_texture_params params,
                       bool changed, uint32_t turn) {
    const char *what = changed ? "changed" : "as they are";
    static float values[4 * POINTS], expected[4 * POINTS];
    slv_env env = test_env();
    slv_texture *full = spelled_out(k->texture);
    params.live = false;
    params.nchannels = k->nchannels;
    slv_gl_texture *all = upload(k, full, params);
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        const slv_strategy *strategy = slv_strategy_at(s);
        float most = 0;
        int worst = 0;
        if (test_skip(s + turn, 4))
            continue;
        REQUIRE(slv_gl_texture_lookup(one, &env, strategy, POINTS, faces, uv, dx, dy, values) ==
                SLV_OK);
        REQUIRE(slv_gl_texture_lookup(all, &env, strategy, POINTS, faces, uv, dx, dy, expected) ==
                SLV_OK);
        for (int i = 0; i < 4 * POINTS; i++)
            if (fabsf(values[i] - expected[i]) > most) {
                most = fabsf(values[i] - expected[i]);
                worst = i / 4;
            }
        CHECK_MSG(most < 1.0f / 255, "%s, %s: %g/255 at face %d, %g %g", what, strategy->name,
                  (double)most * 255, faces[worst], (double)uv[2 * worst],
                  (double)uv[2 * worst + 1]);
        const slv_gl_texture_stats few = slv_gl_texture_get_stats(one, strategy),
                                   many = slv_gl_texture_get_stats(all, strategy);
        /* changes leave room that had been taken; beside another value borders take texels */
        bool less = (strategy->form == slv_form_bare || alike) && !changed;
        CHECK_MSG(!less || few.gpu_bytes < many.gpu_bytes * 3 / 4, "%s, %s: %u and %u bytes", what,
                  strategy->name, (unsigned)few.gpu_bytes, (unsigned)many.gpu_bytes);
    }
    slv_gl_texture_destroy(all);
    slv_texture_destroy(full);
}

static void make_some_constant(kit *k, uint64_t *random) {
    for (uint32_t f = 0; f < k->nfaces; f++) {
        unsigned char texel[64];
        if (alike ? f == 0 : test_random(random) % 3 == 0)
            continue;
        memcpy(texel, slv_texture_texels(k->texture, alike ? 1 : f),
               k->nchannels * slv_type_size(k->type));
        REQUIRE(slv_texture_set_constant(k->texture, f, texel) == SLV_OK);
    }
}

static void check(uint32_t turn, slv_type type, uint32_t nchannels, slv_gl_texture_params params,
                  uint64_t *random) {
    slv_env env = test_env();
    kit k;
    kit_grid(&k, alike ? 7 : 4, alike ? 6 : 3, false, 30, random, NULL);
    kit_mixed(&k, alike ? 4 : 5, random);
    kit_noise(&k, type, nchannels, random);
    make_some_constant(&k, random);
    place(&k, random);
    slv_gl_texture *one = upload(&k, k.texture, params);
    check_same(&k, one, params, false, turn);
    if (params.live) {
        static const float texels[16 * 4] = {0.25f, 0.5f, 1};
        unsigned char stored[sizeof texels];
        slv_type_from_float(type, texels, sizeof texels / sizeof *texels, stored);
        for (int round = 0; round < 12; round++) {
            uint32_t f = test_random(random) % k.nfaces;
            slv_res res = slv_texture_get_desc(k.texture)->res[f];
            const slv_rect rect = {0, 0, 1u << (res.u > 1), 1u << (res.v > 1)};
            if (round % 3 == 0)
                REQUIRE(slv_texture_set_rect(k.texture, f, rect, stored) == SLV_OK);
            else if (round % 3 == 1)
                REQUIRE(slv_texture_set_constant(k.texture, f, stored) == SLV_OK);
            else if (slv_texture_is_constant(k.texture, f))
                REQUIRE(slv_texture_set_resolution(k.texture, f, (slv_res){1, 1}, stored) ==
                        SLV_OK);
            REQUIRE(slv_gl_texture_update(one, &env, NULL) == SLV_OK);
            if (round > 8)
                check_same(&k, one, params, true, turn);
        }
    }
    slv_gl_texture_destroy(one);
    kit_free(&k);
}

int main(void) {
    uint64_t random = 3;
    slv_env env = test_env();
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    check(0, SLV_TYPE_U8, 3, (slv_gl_texture_params){KIT_ALL, .anisotropy = 8}, &random);
    if (!test_brief())
        check(0, SLV_TYPE_FLOAT, 4, (slv_gl_texture_params){KIT_ALL, .anisotropy = 1}, &random);
    check(1, SLV_TYPE_HALF, 1, (slv_gl_texture_params){KIT_ALL, .anisotropy = 4, .live = true},
          &random);
    check(2, SLV_TYPE_U8, 3,
          (slv_gl_texture_params){KIT_ALL, .branching = SLV_GL_BRANCHING_REAL, .live = true},
          &random);
    alike = true;
    check(0, SLV_TYPE_U8, 3, (slv_gl_texture_params){KIT_ALL, .anisotropy = 4}, &random);
    check(1, SLV_TYPE_U8, 4, (slv_gl_texture_params){KIT_ALL, .live = true}, &random);
    slv_gl_destroy(gl);
    return test_end();
}
