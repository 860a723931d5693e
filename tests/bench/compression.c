/* bench_compression [--json] [--smoke]
 *
 * What compressed blocks take and lose with every strategy: bytes on the GPU before and after, the
 * error of the texels, and the seam jump of magnified lookups before and after. On a torus of 128
 * faces, of one resolution and of mixed ones, under noise, and under noise with a colour for each
 * face. */
#include "kit/bench_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/bake.h>
#include <selvage/gl_texture.h>

#include <string.h>

enum { AROUND = 16, ACROSS = 8, NFACES = AROUND * ACROSS };

typedef struct scene {
    bench_torus torus;
    slv_gl *gl;
} scene;

static const slv_env env = {.log = bench_log};

static slv_result report(const scene *s, slv_gl_texture *const textures[2], const char *name,
                         bool json) {
    for (uint32_t k = 0; k < slv_strategy_count(); k++) {
        const slv_strategy *strategy = slv_strategy_at(k);
        slv_gl_texture_stats stats[2];
        slv_gl_seam seams[2];
        double memory[2];
        for (int i = 0; i < 2; i++) {
            stats[i] = slv_gl_texture_get_stats(textures[i], strategy);
            memory[i] = (double)stats[i].gpu_bytes / (double)stats[i].texel_bytes;
            slv_result result = slv_gl_texture_seam_jump(textures[i], &env, strategy,
                                                         s->torus.adjacency, NULL, &seams[i]);
            if (result)
                return result;
        }
        if (json)
            printf("{\"texture\": \"%s\", \"strategy\": \"%s\", \"memory\": [%.4f, %.4f], "
                   "\"rms\": %.5f, \"max\": %.5f, \"clipped\": %u, \"jump_max\": [%.5f, %.5f], "
                   "\"jump_mean\": [%.6f, %.6f]}\n",
                   name, strategy->name, memory[0], memory[1], stats[1].block_rms,
                   stats[1].block_max, stats[1].clipped, (double)seams[0].max, (double)seams[1].max,
                   (double)seams[0].mean, (double)seams[1].mean);
        else
            printf("%-24s %-13s %6.2f %5.2f   %.4f %.3f   %.4f %.4f   %.5f %.5f\n", name,
                   strategy->name, memory[0], memory[1], stats[1].block_rms, stats[1].block_max,
                   (double)seams[0].max, (double)seams[1].max, (double)seams[0].mean,
                   (double)seams[1].mean);
    }
    return SLV_OK;
}

static slv_result measure(const scene *s, int log2, uint32_t nchannels, bool mixed, float tint,
                          bool json) {
    static slv_res res[NFACES];
    const slv_procedural noise = {
        .pattern = SLV_PATTERN_NOISE, .frequency = 2, .octaves = 3, .face_tint = tint};
    slv_texture_desc desc = {NFACES, SLV_TYPE_U8, nchannels, SLV_NO_ALPHA, res, SLV_TEXTURE_LINEAR};
    slv_texture *texture = NULL;
    slv_gl_texture *textures[2] = {NULL, NULL};
    char name[64];
    slv_result result;
    bench_res(NFACES, log2, mixed, res);
    snprintf(name, sizeof name, "%u channel%s %s%s", nchannels, nchannels > 1 ? "s" : "",
             mixed ? "mixed" : "equal", tint > 0 ? " tinted" : "");
    if ((result = slv_texture_create(&env, &desc, &texture)) ||
        (result = slv_bake_procedural(&env, s->torus.surface, &noise, NULL, texture)))
        goto done;
    for (int i = 0; i < 2 && !result; i++) {
        slv_gl_texture_params params = {KIT_ALL, .compression = i ? SLV_GL_COMPRESSION_BLOCKS
                                                                  : SLV_GL_COMPRESSION_NONE};
        result =
            slv_gl_texture_create(s->gl, &env, texture, s->torus.adjacency, &params, &textures[i]);
    }
    if (!result)
        result = report(s, textures, name, json);
done:
    slv_gl_texture_destroy(textures[0]);
    slv_gl_texture_destroy(textures[1]);
    slv_texture_destroy(texture);
    return result;
}

int main(int argc, char **argv) {
    bool json = false, smoke = false;
    int log2 = 6;
    for (int i = 1; i < argc; i++) {
        if (!strcmp(argv[i], "--json")) {
            json = true;
        } else if (!strcmp(argv[i], "--smoke")) {
            smoke = true;
            log2 = 3;
        } else {
            fprintf(stderr, "usage: bench_compression [--json] [--smoke]\n");
            return 2;
        }
    }
    if (!json)
        puts("                                           memory       error          largest jump"
             "     mean jump\n"
             "                                        before after   rms   max     before  after"
             "    before   after");
    scene s = {.torus = bench_torus_make(&env, AROUND, ACROSS)};
    slv_result result = slv_gl_create(&env, SLV_GL_AUTO, &s.gl);
    for (uint32_t nchannels = smoke ? 3 : 1; !result && nchannels <= 3; nchannels += 2)
        if (!(result = measure(&s, log2, nchannels, false, 0, json)) &&
            !(result = measure(&s, log2, nchannels, true, 0, json)))
            result = measure(&s, log2, nchannels, false, 0.5f, json);
    slv_gl_destroy(s.gl);
    bench_torus_free(&s.torus);
    return result ? 1 : 0;
}
