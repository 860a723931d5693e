/* Compressed layers: lookups keep within what the encoder says it loses, and seams stay closed
 * where both sides decode the same texels. */
#include "kit/seam_kit.h"
#include "kit/strategy_kit.h"

static slv_gl *gl;

static slv_gl_texture *upload(const kit *k, slv_gl_compression compression) {
    return seam_upload(gl, k, (slv_gl_texture_params){.compression = compression});
}

static slv_gl_seam jump(slv_gl_texture *texture, const kit *k, const slv_strategy *strategy,
                        uint32_t level) {
    return seam_jump(texture, k, strategy, (slv_gl_seam_params){.level = level});
}

/* Every texel's centre, magnified, against the texture. */
static void check_values(const kit *k, slv_gl_texture *texture) {
    slv_env env = test_env();
    double most = slv_gl_texture_get_stats(texture, kit_strategy("clamp")).block_max;
    for (uint32_t face = 0; face < k->nfaces; face++) {
        uint32_t width = 1u << k->res[face].u, count = (uint32_t)kit_texels(k->res[face]);
        int32_t *faces = malloc(count * sizeof *faces);
        float *points = calloc(count, 10 * sizeof *points);
        REQUIRE(faces && points);
        float *uv = points, *dx = uv + 2 * count, *dy = dx + 2 * count, *values = dy + 2 * count;
        for (uint32_t i = 0; i < count; i++) {
            faces[i] = (int32_t)face;
            uv[2 * i] = ((float)(i % width) + 0.5f) / (float)width;
            uv[2 * i + 1] = ((float)(i / width) + 0.5f) / (float)(1u << k->res[face].v);
            dx[2 * i] = dy[2 * i + 1] = 1e-4f;
        }
        REQUIRE(slv_gl_texture_lookup(texture, &env, kit_strategy("clamp"), count, faces, uv, dx,
                                      dy, values) == SLV_OK);
        for (uint32_t i = 0; i < count; i++) {
            float texel[4];
            slv_texture_fetch(k->texture, face, i % width, i / width, texel);
            for (uint32_t c = 0; c < k->nchannels; c++)
                CHECK_MSG(fabs((double)values[4 * i + c] - (double)texel[c]) < most + 0.01,
                          "face %u texel %u channel %u: %g for %g, the encoder lost %g at most",
                          face, i, c, (double)values[4 * i + c], (double)texel[c], most);
        }
        free(faces);
        free(points);
    }
}

/* Something that blocks can hold: a slope and a little noise. */
static void paint(kit *k, uint32_t nchannels, uint64_t *random) {
    kit_begin_texture(k, SLV_TYPE_U8, nchannels);
    for (uint32_t face = 0; face < k->nfaces; face++) {
        size_t count = kit_texels(k->res[face]) * nchannels;
        float *values = malloc(count * sizeof *values);
        REQUIRE(values);
        float base = (float)(test_random(random) % 100) / 250 + 0.2f;
        for (size_t i = 0; i < count; i++)
            values[i] =
                base + (float)(test_random(random) % 100) / 400 + 0.1f * (float)(i % nchannels);
        kit_set(k, face, values);
        free(values);
    }
    kit_end_texture(k);
}

static void check_equal(kit *k, const char *name, bool regular, uint64_t *random) {
    for (uint32_t nchannels = 1; nchannels <= 4; nchannels++) {
        if (test_skip(nchannels - regular, 2))
            continue;
        paint(k, nchannels, random);
        slv_gl_texture *plain = upload(k, SLV_GL_COMPRESSION_NONE);
        slv_gl_texture *texture = upload(k, SLV_GL_COMPRESSION_BLOCKS);
        check_values(k, texture);
        for (uint32_t s = 0; s < slv_strategy_count(); s++) {
            const slv_strategy *strategy = slv_strategy_at(s);
            slv_gl_texture_stats before = slv_gl_texture_get_stats(plain, strategy);
            slv_gl_texture_stats after = slv_gl_texture_get_stats(texture, strategy);
            CHECK(before.block_rms == 0 && before.block_max == 0);
            CHECK_MSG(after.block_rms > 1e-4 && after.block_rms < 0.06, "%s %u channels: %g", name,
                      nchannels, after.block_rms);
            CHECK(after.block_max > after.block_rms && after.block_max < 0.25);
            CHECK_MSG(nchannels < 3 || after.gpu_bytes < 3 * before.gpu_bytes / 4,
                      "%s %u channels: %u bytes, %u before", name, nchannels,
                      (unsigned)after.gpu_bytes, (unsigned)before.gpu_bytes);
            CHECK(after.widened == 0);
        }
        for (uint32_t level = 0; level <= 2; level++) {
            slv_gl_seam clamp = jump(texture, k, kit_strategy("clamp"), level);
            slv_gl_seam borders = jump(texture, k, kit_strategy("borders"), level);
            slv_gl_seam traverse = jump(texture, k, kit_strategy("traverse"), level);
            slv_gl_seam aligned = jump(texture, k, kit_strategy("edge-aligned"), level);
            CHECK(level || clamp.max > 0.2f);
            CHECK_MSG(traverse.max <= 1.0f / 255, "%s level %u: traverse jumps by %g", name, level,
                      (double)traverse.max);
            /* around an extraordinary vertex the diagonal block is nobody's copy */
            CHECK_MSG(borders.max <= (regular ? 1.0f / 255 : 0.1f),
                      "%s %u channels level %u: borders jump by %g", name, nchannels, level,
                      (double)borders.max);
            CHECK_MSG(borders.mean < clamp.mean / (level < 2 ? 32 : 8),
                      "%s %u channels level %u: %g, clamp %g", name, nchannels, level,
                      (double)borders.mean, (double)clamp.mean);
            CHECK_MSG(aligned.max < 0.2f && aligned.mean < clamp.mean / 3,
                      "%s %u channels level %u: edge-aligned jumps by %g, mean %g", name, nchannels,
                      level, (double)aligned.max, (double)aligned.mean);
            slv_gl_seam htex = jump(texture, k, kit_strategy("htex"), level);
            CHECK_MSG(htex.max <= 1.0f / 255, "%s level %u: htex jumps by %g", name, level,
                      (double)htex.max);
        }
        slv_gl_texture_destroy(plain);
        slv_gl_texture_destroy(texture);
    }
}

/* Any sizes, sub-faces, levels of less than a block: close, and finite. */
static void check_mixed(kit *k, const char *name, uint64_t *random) {
    kit_mixed(k, 5, random);
    paint(k, 3, random);
    slv_gl_texture *texture = upload(k, SLV_GL_COMPRESSION_BLOCKS);
    slv_gl_seam clamp = jump(texture, k, kit_strategy("clamp"), 0);
    slv_gl_seam borders = jump(texture, k, kit_strategy("borders"), 0);
    slv_gl_seam traverse = jump(texture, k, kit_strategy("traverse"), 0);
    slv_gl_seam aligned = jump(texture, k, kit_strategy("edge-aligned"), 0);
    CHECK_MSG(borders.mean < clamp.mean / 3, "%s: borders %g clamp %g", name, (double)borders.mean,
              (double)clamp.mean);
    CHECK_MSG(traverse.mean < clamp.mean / 8, "%s: traverse %g clamp %g", name,
              (double)traverse.mean, (double)clamp.mean);
    CHECK_MSG(aligned.mean < clamp.mean / 3, "%s: edge-aligned %g clamp %g", name,
              (double)aligned.mean, (double)clamp.mean);
    slv_gl_seam htex = jump(texture, k, kit_strategy("htex"), 0);
    CHECK_MSG(htex.max <= 1.0f / 255, "%s: htex jumps by %g", name, (double)htex.max);
    slv_gl_texture_destroy(texture);
}

/* One thread and many upload the same blocks: errors are sums over all of them. */
static void check_threads(const kit *k) {
    slv_gl_texture_stats stats[2];
    for (uint32_t i = 0; i < 2; i++) {
        slv_env env = test_env();
        slv_gl_texture_params params = {KIT_ALL, .compression = SLV_GL_COMPRESSION_BLOCKS};
        slv_gl_texture *texture = NULL;
        env.threads = i ? 5 : 1;
        REQUIRE(slv_gl_texture_create(gl, &env, k->texture, k->adjacency, &params, &texture) ==
                SLV_OK);
        stats[i] = slv_gl_texture_get_stats(texture, kit_strategy("borders"));
        slv_gl_texture_destroy(texture);
    }
    CHECK(stats[0].block_rms == stats[1].block_rms && stats[0].block_max == stats[1].block_max);
    CHECK(stats[0].gpu_bytes == stats[1].gpu_bytes);
}

static void check_refused(kit *k, uint64_t *random) {
    slv_env env = test_env();
    slv_gl_texture_params params = {.compression = SLV_GL_COMPRESSION_BLOCKS};
    for (int type = SLV_TYPE_U16; type <= SLV_TYPE_FLOAT; type++) {
        slv_gl_texture *texture = NULL;
        kit_noise(k, (slv_type)type, 3, random);
        CHECK(slv_gl_texture_create(gl, &env, k->texture, k->adjacency, &params, &texture) ==
              SLV_ERROR_UNSUPPORTED);
        CHECK(!texture && strstr(test_last_log, slv_type_name((slv_type)type)));
    }
}

int main(void) {
    uint64_t random = 21;
    slv_env env = test_env();
    kit k;
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    kit_grid(&k, 4, 3, true, 0, &random, NULL);
    kit_equal(&k, 4);
    check_equal(&k, "torus", true, &random);
    check_threads(&k);
    check_refused(&k, &random);
    check_mixed(&k, "torus", &random);
    kit_free(&k);
    kit_disc(&k, 5, &random);
    kit_equal(&k, 4);
    check_equal(&k, "valence 5", false, &random);
    check_mixed(&k, "valence 5", &random);
    kit_free(&k);
    kit_pentagons(&k, &random);
    kit_equal(&k, 4);
    check_equal(&k, "pentagons", false, &random);
    check_mixed(&k, "pentagons", &random);
    kit_free(&k);
    slv_gl_destroy(gl);
    return test_end();
}
