/* The demo's generator: the mesh is closed, the textures are what they should be, and a bad command
 * line is refused. */
#include "kit/test.h"

#include <selvage/ptx.h>

#include <sys/wait.h>
#include <unistd.h>

static int run(const char *program, const char *argument) {
    pid_t child = fork();
    if (child == 0) {
        if (!freopen("/dev/null", "w", stdout) || !freopen("/dev/null", "w", stderr))
            _exit(126);
        execl(program, program, argument, (char *)NULL);
        _exit(127);
    }
    int status = 0;
    return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status)
               ? WEXITSTATUS(status)
               : -1;
}

static const char *join(char *out, const char *folder, const char *name) {
    snprintf(out, 512, "%s/%s", folder, name);
    return out;
}

static void check_mesh(const slv_env *env, const slv_mesh *mesh, slv_adjacency **adjacency) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    slv_mesh_stats stats;
    REQUIRE(!slv_mesh_get_stats(env, mesh, &stats));
    REQUIRE(view->ngroups == 2);
    CHECK(!strcmp(view->group_names[0], "creature") && !strcmp(view->group_names[1], "ground"));
    int32_t ncreature = view->group_first[1];
    CHECK_MSG(ncreature >= 1421 && ncreature <= 1479, "%d quads", ncreature);
    CHECK(stats.npolys == (uint32_t)ncreature + 1024 && stats.nfaces == stats.npolys);
    CHECK(!stats.nnonmanifold_edges && !stats.nflipped_edges && !stats.nisolated_verts);
    CHECK(stats.nboundary_edges == 4 * 32);
    CHECK(stats.nvalence[3] > 20 && stats.nvalence[5] > 10 && stats.nvalence[6] > 10 &&
          stats.nvalence[8]);

    REQUIRE(!slv_mesh_adjacency(env, mesh, adjacency));
    double volume = 0;
    for (int32_t f = 0; f < ncreature; f++) {
        for (int e = 0; e < 4; e++) {
            int32_t other = slv_adjacency_faces(*adjacency)[f].face[e];
            CHECK(other >= 0 && other < ncreature);
        }
        const float *p[4];
        for (int k = 0; k < 4; k++) {
            p[k] = view->positions + 3 * view->poly_verts[4 * f + k];
            CHECK(p[k][1] > 0);
        }
        for (int t = 1; t < 3; t++) {
            const float *a = p[0], *b = p[t], *c = p[t + 1];
            volume += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                      a[2] * (b[0] * c[1] - b[1] * c[0]);
        }
    }
    CHECK_MSG(volume / 6 > 0.3, "volume %g: inside out?", volume / 6);
}

/* Returns how many different resolutions there are. */
static int check_texture(const slv_env *env, const char *path, const slv_mesh *mesh,
                         slv_texture **out) {
    slv_ptx *ptx = NULL;
    REQUIRE(!slv_ptx_open(env, path, &ptx));
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    CHECK(info->type == SLV_TYPE_U8 && info->nchannels == 3);
    CHECK_MSG(info->file_bytes < 10u << 20, "%llu bytes", (unsigned long long)info->file_bytes);
    CHECK(!slv_ptx_match_mesh(env, ptx, mesh));
    CHECK(slv_ptx_find_meta(ptx, "PtexFaceVertCounts") &&
          slv_ptx_find_meta(ptx, "PtexVertPositions"));
    int different = 0, square[32] = {0};
    bool seen[32][32] = {{false}};
    for (uint32_t f = 0; f < info->nfaces; f++) {
        slv_ptx_face face;
        REQUIRE(!slv_ptx_get_face(ptx, f, &face));
        different += !seen[face.res.u][face.res.v];
        seen[face.res.u][face.res.v] = true;
        square[face.res.u == face.res.v]++;
    }
    CHECK(square[0] > 100 && square[1] > 100);
    REQUIRE(!slv_ptx_load_texture(env, ptx, out));
    slv_ptx_close(ptx);
    return different;
}

/* The largest difference between texels on both sides of an edge between equal resolutions, taking
 * one per edge. */
static float largest_jump(const slv_texture *texture, const slv_adjacency *adjacency) {
    const slv_texture_desc *desc = slv_texture_get_desc(texture);
    float jump = 0;
    for (uint32_t f = 0; f < desc->nfaces; f++)
        for (unsigned e = 0; e < 4; e++) {
            static const float us[4] = {0.5f, 0.999f, 0.5f, 0.001f},
                               vs[4] = {0.001f, 0.5f, 0.999f, 0.5f};
            static const float du[4] = {0, 0.002f, 0, -0.002f}, dv[4] = {-0.002f, 0, 0.002f, 0};
            int32_t other = (int32_t)f;
            float u = us[e] + du[e], v = vs[e] + dv[e], a[3], b[3];
            if (!slv_adjacency_resolve(adjacency, false, &other, &u, &v))
                continue;
            slv_res here = desc->res[f], there = desc->res[other];
            slv_texture_fetch(texture, f, (uint32_t)(us[e] * (float)(1 << here.u)),
                              (uint32_t)(vs[e] * (float)(1 << here.v)), a);
            slv_texture_fetch(texture, (uint32_t)other, (uint32_t)(u * (float)(1 << there.u)),
                              (uint32_t)(v * (float)(1 << there.v)), b);
            for (int c = 0; c < 3; c++)
                jump = fmaxf(jump, fabsf(a[c] - b[c]));
        }
    return jump;
}

int main(void) {
    const char *bin = getenv("SELVAGE_BIN");
    slv_env env = test_env();
    CHECK(true);
    if (!bin)
        return test_end();
    char program[512], path[512], folder[128];
    static const char *const files[] = {"scene.obj", "scene.ptx", "scene_faces.ptx"};
    join(program, bin, "selvage-assets");
    CHECK(run(program, "--help") == 0);
    CHECK(run(program, "--nonsense") == 2);
    CHECK(run(program, NULL) == 2);
    CHECK(run(program, "/dev/null/not/a/folder") == 1);
    snprintf(folder, sizeof folder, "%s/selvage-scene-XXXXXX", test_parent());
    const char *made = mkdtemp(folder);
    REQUIRE(made);
    CHECK(run(program, folder) == 0);

    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    slv_texture *plain = NULL, *tinted = NULL;
    REQUIRE(!slv_mesh_load(&env, join(path, folder, files[0]), &mesh));
    check_mesh(&env, mesh, &adjacency);
    CHECK(check_texture(&env, join(path, folder, files[1]), mesh, &plain) >= 5);
    CHECK(check_texture(&env, join(path, folder, files[2]), mesh, &tinted) >= 5);
    float smooth = largest_jump(plain, adjacency), patchy = largest_jump(tinted, adjacency);
    CHECK_MSG(smooth < 0.35f && patchy > smooth, "jumps %g and %g", (double)smooth, (double)patchy);

    slv_texture_destroy(plain);
    slv_texture_destroy(tinted);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    for (int i = 0; i < 3; i++)
        remove(join(path, folder, files[i]));
    rmdir(folder);
    return test_end();
}
