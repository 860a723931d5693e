/* What the calls of calls_kit.h work on: a mesh, a texture, and files of each kind in a folder. */
#ifndef CALLS_DATA_H
#define CALLS_DATA_H

#include "kit/remove_kit.h"
#include "kit/test.h"

#include <selvage/bake.h>
#include <selvage/exchange.h>
#include <selvage/image.h>

#include <unistd.h>

/* What calls work on. */
static struct {
    char folder[160], ptx[200], merged[200], png[200], exr[200], obj[200], out[200];
    slv_mesh *mesh;
    slv_adjacency *adjacency;
    slv_surface *surface;
    slv_texture *texture;
    slv_levels *levels;
    slv_image image;
} calls;

enum { CALLS_FACES = 7 };
/* Two quads and a triangle, tags and all. */
static const char calls_obj[] =
    "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 1\nv 3 1 0\nvt 0 0\nvn 0 0 1\ng one\nf "
    "1/1/1 2/1/1 5/1/1 4/1/1\n"
    "f 2 3 6 5\ng two\nf 3 7 6\nt crease 2/1/0 0 1 2.0\nt corner 1/1/0 3 4.0\nusemtl x\n";
static const char calls_uv_obj[] =
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt .1 .1\nvt .9 .1\nvt .9 .9\nvt .1 .9\n"
    "f 1/1 2/2 3/3 4/4\n";
static const char calls_ply[] =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\nelement face 1\n"
    "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
static const slv_procedural calls_noise = {.pattern = SLV_PATTERN_NOISE, .frequency = 3};

static inline void calls_begin(void) {
    static const slv_res res[5] = {{4, 4}, {3, 4}, {2, 2}, {3, 3}, {2, 2}};
    slv_env env = test_env();
    slv_texture_desc desc = {.type = SLV_TYPE_U8, .nchannels = 4, .alpha_channel = 3, .res = res};
    const int32_t count[3] = {1, -2, 3};
    const slv_ptx_meta meta[] = {
        {.key = "numbers", .type = SLV_META_INT32, .count = 3, .values = count},
        {.key = "words", .type = SLV_META_STRING, .count = 5, .values = "words"}};
    snprintf(calls.folder, sizeof calls.folder, "%s/selvage_calls_XXXXXX", test_parent());
    REQUIRE(mkdtemp(calls.folder));
    snprintf(calls.ptx, sizeof calls.ptx, "%s/in.ptx", calls.folder);
    snprintf(calls.png, sizeof calls.png, "%s/in.png", calls.folder);
    snprintf(calls.exr, sizeof calls.exr, "%s/in.exr", calls.folder);
    snprintf(calls.obj, sizeof calls.obj, "%s/in.obj", calls.folder);
    REQUIRE(!slv_mesh_parse_obj(&env, "mesh", calls_obj, sizeof calls_obj - 1, &calls.mesh));
    desc.nfaces = slv_mesh_face_count(calls.mesh);
    REQUIRE(desc.nfaces == 5);
    REQUIRE(!slv_mesh_save_obj(&env, calls.mesh, calls.obj));
    REQUIRE(!slv_mesh_adjacency(&env, calls.mesh, &calls.adjacency));
    REQUIRE(!slv_surface_create(&env, calls.mesh, NULL, &calls.surface));
    REQUIRE(!slv_texture_create(&env, &desc, &calls.texture));
    REQUIRE(!slv_bake_procedural(&env, calls.surface, &calls_noise, NULL, calls.texture));
    REQUIRE(!slv_levels_create(&env, calls.texture, &calls.levels));
    REQUIRE(!slv_ptx_save(&env, calls.ptx, calls.texture, calls.adjacency,
                          &(slv_ptx_write_params){.mesh = calls.mesh, .nmeta = 2, .meta = meta}));
    snprintf(calls.merged, sizeof calls.merged, "%s/two.ptx", calls.folder);
    REQUIRE(!slv_merge(&env, (const char *const[]){calls.ptx, calls.ptx}, 2, NULL, calls.merged,
                       NULL, NULL, NULL));
    REQUIRE(!slv_image_create(&env, 19, 21, 4, &calls.image));
    REQUIRE(!slv_image_save(&env, calls.png, &calls.image, NULL));
    REQUIRE(!slv_image_save(&env, calls.exr, &calls.image, NULL));
}

static inline void calls_end(void) {
    slv_image_free(&calls.image);
    slv_levels_destroy(calls.levels);
    slv_texture_destroy(calls.texture);
    slv_surface_destroy(calls.surface);
    slv_adjacency_destroy(calls.adjacency);
    slv_mesh_destroy(calls.mesh);
    test_remove(calls.folder);
}

static const char *calls_path(const char *name) {
    snprintf(calls.out, sizeof calls.out, "%s/%s", calls.folder, name);
    return calls.out;
}

#endif
