/* seam_jump [--lookups N] [--json] [--smoke]
 *
 * How far a lookup just left of a shared edge is from one just right of it, for each filter and for
 * vertices of valence 3 to 12: discs of 32x32 faces around one vertex, float noise in 0..1, N
 * (20000) places on the edges of each disc. `near`: within three texels of the vertex; `far`: the
 * rest of its edges, up to their middle. Footprints from half a texel to four. */
#include "kit/bench_kit.h"

#include <selvage/filter.h>

#include <string.h>

enum { LOG2 = 5, SIZE = 1 << LOG2, FIRST = 3, LAST = 12 };

struct jumps {
    double most, sum;
    uint64_t count;
};

/* Quads around vertex 0, each of which begins there: edge 0 of one is edge 3 of the one before. */
static void write_disc(const slv_env *env, const char *path, int32_t valence) {
    float positions[3 * (2 * LAST + 1)] = {0}, texels[SIZE * SIZE];
    int32_t sizes[LAST], verts[4 * LAST];
    uint32_t state = 77;
    slv_mesh *mesh;
    slv_adjacency *adjacency;
    slv_texture *texture;
    slv_res res[LAST];
    for (int32_t i = 0; i < valence; i++) {
        int32_t quad[4] = {0, 1 + 2 * i, 2 + 2 * i, 1 + 2 * ((i + 1) % valence)};
        memcpy(verts + 4 * i, quad, sizeof quad);
        sizes[i] = 4;
        res[i] = (slv_res){LOG2, LOG2};
    }
    for (int32_t i = 0; i < 3 * (2 * valence + 1); i++)
        positions[i] = bench_random_unit(&state);
    slv_mesh_view view = {.nverts = (uint32_t)(2 * valence + 1),
                          .positions = positions,
                          .npolys = (uint32_t)valence,
                          .poly_sizes = sizes,
                          .poly_verts = verts};
    bench_stop(slv_mesh_create(env, &view, &mesh));
    bench_stop(slv_mesh_adjacency(env, mesh, &adjacency));
    slv_texture_desc desc = {(uint32_t)valence, SLV_TYPE_FLOAT, 1, SLV_NO_ALPHA, res,
                             SLV_TEXTURE_LINEAR};
    bench_stop(slv_texture_create(env, &desc, &texture));
    for (int32_t face = 0; face < valence; face++) {
        for (int i = 0; i < SIZE * SIZE; i++)
            texels[i] = bench_random_unit(&state);
        bench_stop(slv_texture_set_face(texture, (uint32_t)face, texels));
    }
    bench_stop(slv_ptx_save(env, path, texture, adjacency, NULL));
    slv_texture_destroy(texture);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
}

static void measure(slv_sampler *sampler, slv_file_id file, int32_t valence, uint32_t lookups,
                    bool near, struct jumps *out) {
    uint32_t state = 5;
    memset(out, 0, sizeof *out);
    for (uint32_t i = 0; i < lookups; i++) {
        const float aside = 1e-6f, corner = 3.0f / SIZE;
        uint32_t face = i % (uint32_t)valence,
                 before = (face + (uint32_t)valence - 1) % (uint32_t)valence;
        float t = near ? corner * bench_random_unit(&state)
                       : corner + (0.5f - corner) * bench_random_unit(&state);
        float width = powf(2, 3 * bench_random_unit(&state) - 1) / SIZE, a, b;
        /* along the edge and across it, whichever face sees it */
        slv_lookup l = {.file = file, .face = face, .u = t, .v = aside, .uw1 = width, .vw2 = width};
        slv_lookup r = {
            .file = file, .face = before, .u = aside, .v = t, .uw1 = width, .vw2 = width};
        bench_stop(slv_sample(sampler, &l, &a));
        bench_stop(slv_sample(sampler, &r, &b));
        double jump = fabs((double)a - (double)b);
        out->most = jump > out->most ? jump : out->most;
        out->sum += jump;
        out->count++;
    }
}

int main(int argc, char **argv) {
    uint32_t lookups = 20000;
    bool json = false;
    for (int i = 1; i < argc; i++)
        if (strcmp(argv[i], "--json") == 0)
            json = true;
        else if (strcmp(argv[i], "--smoke") == 0)
            lookups = 200;
        else if (strcmp(argv[i], "--lookups") == 0 && i + 1 < argc)
            lookups = (uint32_t)strtoul(argv[++i], NULL, 10);
        else {
            fprintf(stderr, "usage: bench_seam_jump [--lookups N] [--json] [--smoke]\n");
            return 2;
        }
    if (!lookups)
        return 2;
    slv_env env = {.log = bench_log};
    char path[64];
    bench_temporary(path);
    slv_cache *cache;
    slv_file_id id;
    bench_stop(slv_cache_create(&env, NULL, &cache));
    for (int32_t valence = FIRST; valence <= LAST; valence++) {
        write_disc(&env, path, valence);
        bench_stop(slv_cache_open(cache, path, &id));
        if (!json && valence == FIRST)
            printf("filter      valence  near: max   mean   far: max   mean\n");
        for (int filter = 0; filter < SLV_FILTER_COUNT; filter++) {
            slv_filter_params params = {.filter = (slv_filter)filter, .sharpness = 0.5f};
            struct jumps jumps[2];
            slv_sampler *sampler;
            bench_stop(slv_sampler_create(cache, &params, &sampler));
            for (int near = 0; near < 2; near++)
                measure(sampler, id, valence, lookups, near, &jumps[near]);
            slv_sampler_destroy(sampler);
            printf(json ? "{\"filter\":\"%s\",\"valence\":%d,\"near_max\":%.6f,\"near_mean\":%.6f,"
                          "\"far_max\":%.6f,\"far_mean\":%.6f}\n"
                        : "%-11s %7d %10.4f %6.4f %10.4f %6.4f\n",
                   slv_filter_name(params.filter), valence, jumps[1].most,
                   jumps[1].sum / (double)jumps[1].count, jumps[0].most,
                   jumps[0].sum / (double)jumps[0].count);
        }
        bench_stop(slv_cache_close(cache, id));
    }
    slv_cache_destroy(cache);
    unlink(path);
    return 0;
}
