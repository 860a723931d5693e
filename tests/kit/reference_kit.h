/* A small model with a texture, ready for rays. */
#ifndef REFERENCE_KIT_H
#define REFERENCE_KIT_H

#include "kit/test.h"

#include <selvage/bake.h>
#include <selvage/reference.h>

enum { SEGMENTS = 16 };

typedef struct model {
    slv_mesh *mesh;
    slv_adjacency *adjacency;
    slv_surface *surface;
    slv_texture *texture;
    slv_reference *reference;
} model;

/* A box with a five-sided roof, so that whole quads meet sub-faces. */
static const char box_obj[] = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\n"
                              "v -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\nv 0 1.4 1\n"
                              "f 1 4 3 2\nf 5 6 7 9 8\nf 1 2 6 5\nf 3 4 8 9\nf 3 9 7\n"
                              "f 1 5 8 4\nf 2 3 7 6\n";
/* Resolutions differ from face to face unless `log2` says how fine all are. */
static inline model make_model(const char *obj, slv_scheme scheme, const slv_procedural *pattern,
                               uint32_t nchannels, int log2) {
    static const slv_res mixed[5] = {{5, 5}, {4, 4}, {5, 4}, {3, 3}, {4, 5}};
    slv_env env = test_env();
    slv_surface_params params = {.scheme = scheme};
    slv_reference_params shown = {.segments = SEGMENTS};
    slv_res res[64];
    model m = {0};
    REQUIRE(slv_mesh_parse_obj(&env, "model", obj, strlen(obj), &m.mesh) == SLV_OK);
    REQUIRE(slv_mesh_adjacency(&env, m.mesh, &m.adjacency) == SLV_OK);
    REQUIRE(slv_surface_create(&env, m.mesh, &params, &m.surface) == SLV_OK);
    slv_texture_desc desc = {
        slv_mesh_face_count(m.mesh), SLV_TYPE_FLOAT, nchannels, SLV_NO_ALPHA, res,
        SLV_TEXTURE_LINEAR};
    REQUIRE(desc.nfaces <= 64);
    for (uint32_t f = 0; f < desc.nfaces; f++)
        res[f] = log2 ? (slv_res){(int8_t)log2, (int8_t)log2} : mixed[f % 5];
    REQUIRE(slv_texture_create(&env, &desc, &m.texture) == SLV_OK);
    REQUIRE(slv_bake_procedural(&env, m.surface, pattern, NULL, m.texture) == SLV_OK);
    REQUIRE(slv_reference_create(&env, m.mesh, m.surface, m.texture, m.adjacency, &shown,
                                 &m.reference) == SLV_OK);
    return m;
}

static inline void free_model(model *m) {
    slv_reference_destroy(m->reference);
    slv_texture_destroy(m->texture);
    slv_surface_destroy(m->surface);
    slv_adjacency_destroy(m->adjacency);
    slv_mesh_destroy(m->mesh);
}

static inline slv_camera look(float azimuth, float elevation, float fov) {
    const float low[3] = {-1, -1, -1}, high[3] = {1, 1.2f, 1};
    return slv_camera_orbit(low, high, azimuth, elevation, fov, 1);
}

static inline slv_image render(const model *m, const slv_reference_frame *frame, uint32_t threads) {
    slv_env env = test_env();
    slv_image image;
    env.threads = threads;
    REQUIRE(slv_reference_render(m->reference, &env, frame, &image, NULL, NULL) == SLV_OK);
    return image;
}

static inline slv_reference_frame small_frame(slv_pixel_filter filter, uint32_t samples) {
    return (slv_reference_frame){.camera = look(30, 20, 35),
                                 .width = 45,
                                 .height = 37,
                                 .samples = samples,
                                 .filter = filter};
}

#endif
