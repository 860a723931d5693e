/* Small images and meshes with texture coordinates, for tests of baking. */
#ifndef SLV_UV_KIT_H
#define SLV_UV_KIT_H

#include "kit/mesh_shapes.h"
#include "kit/tool_kit.h"

#include <selvage/bake.h>
#include <selvage/image.h>

/* Two quads that share an edge but not its texture coordinates, a pentagon, a triangle beside it,
 * and a quad that has none. */
static const char uv_obj[] =
    "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nv 0 2 0\nv 1 2.5 0\nv 2 2 0\nv 3 0 0\n"
    "v 3 1 0\n"
    "vt .1 .1\nvt .4 .15\nvt .42 .4\nvt .12 .38\nvt .9 .1\nvt .9 .4\nvt .6 .45\nvt .55 .12\n"
    "vt .1 .5\nvt .3 .5\nvt .5 .55\nvt .45 .8\nvt .2 .9\nvt .6 .6\nvt .9 .6\nvt .7 .9\n"
    "f 1/1 2/2 5/3 4/4\nf 2/5 3/6 6/7 5/8\nf 4/9 5/10 6/11 9/12 7/13\nf 7/14 9/15 8/16\n"
    "f 3 10 11 6\n";
enum { UV_PENTAGON = 2, UV_TRIANGLE = 7, UV_BARE = 10, UV_FACES = 11 };

static inline slv_mesh *uv_parse(const char *text) {
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    MUST(slv_mesh_parse_obj(&env, "mesh", text, strlen(text), &mesh));
    return mesh;
}

/* A value for a channel at texture coordinates. */
typedef float uv_image_fn(uint32_t channel, float u, float v);

static inline float uv_ramp(uint32_t channel, float u, float v) {
    return channel == 0 ? u : channel == 1 ? v : 2 * u - v + 3;
}

static inline void uv_write_image(const char *name, uint32_t width, uint32_t height, uint32_t n,
                                  uv_image_fn *value, const slv_image_params *params) {
    slv_env env = test_env();
    slv_image image;
    MUST(slv_image_create(&env, width, height, n, &image));
    for (uint32_t i = 0; i < width * height; i++)
        for (uint32_t c = 0; c < n; c++)
            image.pixels[i * n + c] = value(c, ((float)(i % width) + 0.5f) / (float)width,
                                            1 - ((float)(i / width) + 0.5f) / (float)height);
    MUST(slv_image_save(&env, tool_path(name), &image, params));
    slv_image_free(&image);
}

static const slv_image_params uv_floats = {.bits = 32};
static const slv_image_params uv_raw = {.encoding = SLV_ENCODE_RAW};

static inline void uv_of_face(const float *corners, uint32_t face, float s, float t, float out[2]) {
    const float *c = corners + 8 * face;
    for (int axis = 0; axis < 2; axis++)
        out[axis] = (c[axis] * (1 - s) + c[2 + axis] * s) * (1 - t) +
                    (c[6 + axis] * (1 - s) + c[4 + axis] * s) * t;
}

static inline bool uv_same_files(const char *a, const char *b) {
    char line[2200];
    snprintf(line, sizeof line, "cmp -s '%s' '%s'", tool_path(a), tool_path(b));
    return system(line) == 0;
}

#endif
