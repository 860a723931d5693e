/* What tests of painting share: a surface with a texture on it, and a stroke along a curve. */
#ifndef SLV_TEST_PAINT_KIT_H
#define SLV_TEST_PAINT_KIT_H

#include "kit/mesh_shapes.h"

#include <selvage/stroke.h>

typedef struct paint_scene {
    slv_mesh *mesh;
    slv_paint_surface *surface;
    slv_painter *painter;
    slv_texture *texture;
    slv_canvas canvas;
    uint32_t nfaces;
} paint_scene;

/* Takes the shape; every face has 2^log2 x 2^log2 texels of zeros. */
static inline paint_scene paint_scene_of(const slv_env *env, shape *s, slv_scheme scheme, int log2,
                                         slv_type type, uint32_t nchannels, int32_t alpha) {
    paint_scene out = {0};
    slv_mesh_view view = {.nverts = s->nverts,
                          .positions = s->positions,
                          .npolys = s->npolys,
                          .poly_sizes = s->sizes,
                          .poly_verts = s->verts};
    const slv_paint_surface_params params = {.scheme = scheme};
    MUST(slv_mesh_create(env, &view, &out.mesh));
    MUST(slv_paint_surface_create(env, out.mesh, &params, &out.surface));
    MUST(slv_painter_create(env, out.surface, &out.painter));
    out.nfaces = slv_mesh_face_count(out.mesh);
    slv_res *res = calloc(out.nfaces, sizeof *res);
    for (uint32_t i = 0; i < out.nfaces; i++)
        res[i] = (slv_res){(int8_t)log2, (int8_t)log2};
    const slv_texture_desc desc = {.nfaces = out.nfaces,
                                   .type = type,
                                   .nchannels = nchannels,
                                   .alpha_channel = alpha,
                                   .res = res};
    MUST(slv_texture_create(env, &desc, &out.texture));
    out.canvas = slv_texture_as_canvas(out.texture);
    free(res);
    shape_clear(s);
    return out;
}

static inline void paint_scene_end(paint_scene *s) {
    slv_texture_destroy(s->texture);
    slv_painter_destroy(s->painter);
    slv_paint_surface_destroy(s->surface);
    slv_mesh_destroy(s->mesh);
}

/* nx x ny quads of the plane from 0; with `turn` 1 each begins at another of its corners. */
static inline shape paint_rectangle(int nx, int ny, float width, float height, int turn) {
    shape s = {0};
    for (int j = 0; j <= ny; j++)
        for (int i = 0; i <= nx; i++)
            shape_vertex(&s, width * (float)i / (float)nx, height * (float)j / (float)ny, 0);
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++) {
            int32_t a = j * (nx + 1) + i, q[4] = {a, a + 1, a + nx + 2, a + nx + 1}, t[4];
            for (int k = 0; k < 4; k++)
                t[k] = q[(k + turn * (i + 2 * j + i * j)) & 3];
            shape_polygon(&s, 4, t);
        }
    return s;
}

static inline shape paint_plane(int n, float size) {
    return paint_rectangle(n, n, size, size, 1);
}

/* The place of a plane that lies below a point. */
static inline slv_surface_point paint_below(const paint_scene *s, double x, double y) {
    float o[3] = {(float)x, (float)y, 1}, d[3] = {0, 0, -1};
    slv_paint_hit hit = {.point.face = -1};
    CHECK(slv_paint_surface_hit(s->surface, o, d, &hit));
    return hit.point;
}

/* A camera that sees the square from 0 to `size` of the plane from above, y up. */
static inline slv_camera paint_camera(float size) {
    slv_camera c = {
        .world_to_camera = {1, 0, 0, -size / 2, 0, 1, 0, -size / 2, 0, 0, 1, -5, 0, 0, 0, 1},
        .window = {-size / 2, size / 2, -size / 2, size / 2}};
    return c;
}

#endif
