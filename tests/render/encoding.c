/* Colours stored as sRGB: what lookups return is the light that they stand for, averaged as light,
 * by every strategy, from every type and number of channels. */
#include "kit/border_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_texture.h>

static slv_gl *gl;

enum { NPOINTS = 512 };

static int32_t faces[NPOINTS];
static float uv[2 * NPOINTS], dx[2 * NPOINTS], dy[2 * NPOINTS];

static float light(float x) {
    return x <= 0.04045f ? x / 12.92f : powf((x + 0.055f) / 1.055f, 2.4f);
}

static float curve(float x) {
    return x <= 0.0031308f ? 12.92f * x : 1.055f * powf(x, 1 / 2.4f) - 0.055f;
}

static void random_points(const kit *k, uint64_t *random) {
    for (int i = 0; i < NPOINTS; i++) {
        float texels = exp2f((float)(test_random(random) % 1000) / 150 - 4);
        faces[i] = (int32_t)(test_random(random) % k->nfaces);
        slv_res res = k->res[faces[i]];
        for (int c = 0; c < 2; c++)
            uv[2 * i + c] = (float)(test_random(random) % 1025) / 1024;
        dx[2 * i] = texels / (float)(1u << res.u);
        dy[2 * i + 1] = texels / (float)(1u << res.v);
    }
}

static slv_gl_texture_stats look_up(const slv_texture *texture, const kit *k,
                                    slv_gl_texture_params params, const slv_strategy *strategy,
                                    float *out) {
    slv_env env = test_env();
    slv_gl_texture *uploaded = NULL;
    params.strategies = &strategy;
    params.nstrategies = 1;
    REQUIRE(slv_gl_texture_create(gl, &env, texture, k->adjacency, &params, &uploaded) == SLV_OK);
    REQUIRE(slv_gl_texture_lookup(uploaded, &env, strategy, NPOINTS, faces, uv, dx, dy, out) ==
            SLV_OK);
    slv_gl_texture_stats stats = slv_gl_texture_get_stats(uploaded, strategy);
    slv_gl_texture_destroy(uploaded);
    return stats;
}

/* The same texture in floats of light, made here; alpha is the last of two or four channels. */
static slv_texture *copy(const kit *k, slv_texture_encoding encoding, slv_type type, bool decoded) {
    slv_env env = test_env();
    slv_texture *out = NULL;
    uint32_t n = k->nchannels;
    slv_texture_desc desc = {.nfaces = k->nfaces,
                             .type = decoded ? SLV_TYPE_FLOAT : type,
                             .nchannels = n,
                             .alpha_channel = n % 2 ? SLV_NO_ALPHA : (int32_t)n - 1,
                             .res = k->res,
                             .encoding = encoding};
    REQUIRE(slv_texture_create(&env, &desc, &out) == SLV_OK);
    for (uint32_t face = 0; face < k->nfaces; face++) {
        size_t count = kit_texels(k->res[face]);
        float *values = malloc(count * n * sizeof *values);
        REQUIRE(values);
        for (size_t i = 0; i < count; i++)
            slv_texture_fetch(k->texture, face, (uint32_t)i % (1u << k->res[face].u),
                              (uint32_t)i >> k->res[face].u, values + i * n);
        for (size_t i = 0; decoded && i < count * n; i++)
            if (n % 2 || i % n != n - 1)
                values[i] = light(values[i]);
        void *texels = malloc(count * n * sizeof(float));
        REQUIRE(texels);
        slv_type_from_float(desc.type, values, count * n, texels);
        REQUIRE(slv_texture_set_face(out, face, texels) == SLV_OK);
        free(texels);
        free(values);
    }
    return out;
}

static void check_type(kit *k, slv_type type, uint32_t nchannels, uint64_t *random) {
    static float given[4 * NPOINTS], wanted[4 * NPOINTS];
    kit_noise(k, type, nchannels, random);
    random_points(k, random);
    /* by the type alone where that says so */
    bool integers = type == SLV_TYPE_U8 || type == SLV_TYPE_U16;
    slv_texture *stored = copy(k, integers ? SLV_TEXTURE_AUTO : SLV_TEXTURE_SRGB, type, false);
    slv_texture *decoded = copy(k, SLV_TEXTURE_LINEAR, type, true);
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        const slv_strategy *strategy = slv_strategy_at(s);
        if ((type != SLV_TYPE_U8 || nchannels != 3) && strcmp(strategy->name, "borders") != 0)
            continue; /* the others find the same levels */
        slv_gl_texture_stats stats =
            look_up(stored, k, (slv_gl_texture_params){0}, strategy, given);
        look_up(decoded, k, (slv_gl_texture_params){0}, strategy, wanted);
        /* a unit of the curve's steep end, a few texels of which make up a lookup; where a border
         * leaves the range of 8 bits, its face has others */
        float allowed = type == SLV_TYPE_U8 ? 0.01f : 1e-4f, most = 0;
        for (int i = 0; i < 4 * NPOINTS; i++)
            most = fmaxf(most, fabsf(given[i] - wanted[i]));
        CHECK_MSG(most < allowed, "%s, %s of %u channels: off by %g", strategy->name,
                  slv_type_name(type), nchannels, (double)most);
        CHECK(stats.texel_bytes == slv_texture_bytes(stored));
        /* three and four channels of 8 bits are as small as they were */
        if (type == SLV_TYPE_U8 && nchannels > 2 && !strcmp(strategy->name, "traverse")) {
            slv_gl_texture_stats plain = look_up(
                stored, k, (slv_gl_texture_params){.encoding = SLV_TEXTURE_DATA}, strategy, given);
            CHECK(stats.gpu_bytes == plain.gpu_bytes);
        }
    }
    slv_texture_destroy(stored);
    slv_texture_destroy(decoded);
}

/* Every byte by itself comes back as that byte. */
static void check_bytes(uint64_t *random) {
    static float values[4 * NPOINTS];
    kit k;
    kit_grid(&k, 16, 16, false, 0, random, NULL);
    kit_equal(&k, 1);
    for (uint32_t nchannels = 1; nchannels <= 4; nchannels++)
        for (uint32_t blocks = 0; blocks < 2; blocks++) {
            if (test_skip(nchannels + 2 * blocks, 3))
                continue;
            slv_gl_texture_params params = {.compression = blocks ? SLV_GL_COMPRESSION_BLOCKS
                                                                  : SLV_GL_COMPRESSION_NONE,
                                            .encoding = SLV_TEXTURE_SRGB};
            kit_begin_texture(&k, SLV_TYPE_U8, nchannels);
            for (uint32_t face = 0; face < 256; face++) {
                float texels[16];
                for (uint32_t i = 0; i < 4 * nchannels; i++)
                    texels[i] = (float)face / 255;
                kit_set(&k, face, texels);
            }
            kit_end_texture(&k);
            for (int i = 0; i < NPOINTS; i++) {
                faces[i] = i % 256;
                uv[2 * i] = uv[2 * i + 1] = 0.5f;
                dx[2 * i] = dy[2 * i + 1] = 1e-3f;
            }
            look_up(k.texture, &k, params, kit_strategy("clamp"), values);
            float most = 0;
            for (int i = 0; i < 256; i++)
                most = fmaxf(most, fabsf(curve(values[4 * i]) * 255 - (float)i));
            /* blocks of one and two channels hold light in 8 bits, which is coarse where it is
             * dark; those of three have five bits for red */
            CHECK_MSG(most < (!blocks         ? 0.45f
                              : nchannels < 3 ? 7
                                              : 4.5f),
                      "%u channels, blocks %u: off by %g", nchannels, blocks, (double)most);
        }
    kit_free(&k);
}

int main(void) {
    uint64_t random = 31;
    slv_env env = test_env();
    kit k;
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    kit_grid(&k, 5, 4, false, 20, &random, NULL);
    kit_mixed(&k, 4, &random);
    for (int type = SLV_TYPE_U8; type <= SLV_TYPE_FLOAT; type++)
        for (uint32_t nchannels = type ? 4 : test_brief() ? 3 : 1; nchannels <= 4; nchannels++)
            check_type(&k, (slv_type)type, nchannels, &random);
    kit_free(&k);
    check_bytes(&random);
    slv_gl_texture_params wrong = {.encoding = (slv_texture_encoding)9};
    slv_gl_texture *texture = NULL;
    kit_grid(&k, 1, 1, false, 0, &random, NULL);
    kit_equal(&k, 1);
    kit_noise(&k, SLV_TYPE_U8, 3, &random);
    CHECK(slv_gl_texture_create(gl, &env, k.texture, k.adjacency, &wrong, &texture) ==
          SLV_ERROR_ARGUMENT);
    kit_free(&k);
    slv_gl_destroy(gl);
    return test_end();
}
