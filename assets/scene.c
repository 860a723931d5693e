/* The demo scene put together: the creature on its ground, how finely each face is textured, with
 * what. */
#include "scene.h"

#include <selvage/file.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Texels per unit of length, before parts and places are made finer or coarser. */
#define CREATURE_DENSITY 300.0f
#define GROUND_WIDTH 8.0f
#define GROUND_CENTRE_X (-0.4f)

static point ground_point(int i, int j) {
    float step = GROUND_WIDTH / GROUND_SIDE;
    return point_make(GROUND_CENTRE_X - GROUND_WIDTH / 2 + (float)i * step, 0,
                      GROUND_WIDTH / 2 - (float)j * step);
}

static int8_t clamp_log2(int value, int low, int high) {
    return (int8_t)(value < low ? low : value > high ? high : value);
}

static float distance(point a, point b) {
    point d = point_sub(a, b);
    return sqrtf(point_dot(d, d));
}

/* Some parts deserve more texels and some less, which is also what puts unequal faces side by side.
 */
static int part_step(enum creature_part part) {
    switch (part) {
    case PART_HEAD:
        return 1;
    case PART_FOOT:
    case PART_HORN:
        return -1;
    case PART_BODY:
    case PART_TAIL:
    case PART_NECK:
    case PART_LEG:
    case PART_CREST:
        break;
    }
    return 0;
}

static slv_res creature_res(const struct scene *scene, int face) {
    const int32_t *quad = scene->creature.quads[face];
    float length[4];
    for (int k = 0; k < 4; k++)
        length[k] =
            distance(scene->creature.points[quad[k]], scene->creature.points[quad[(k + 1) % 4]]);
    float u = 0.5f * (length[0] + length[2]), v = 0.5f * (length[1] + length[3]);
    int step = part_step(scene->parts[face]);
    return (slv_res){clamp_log2((int)lrintf(log2f(u * CREATURE_DENSITY)) + step, 2, 6),
                     clamp_log2((int)lrintf(log2f(v * CREATURE_DENSITY)) + step, 2, 6)};
}

/* Fine under the creature, coarser in rings outwards; and in some blocks of 4 x 4 a step coarser
 * along one axis. */
static slv_res ground_res(int i, int j) {
    point middle = point_scale(point_add(ground_point(i, j), ground_point(i + 1, j + 1)), 0.5f);
    float x = (middle.x - GROUND_CENTRE_X) * 0.6f;
    float away = sqrtf(x * x + middle.z * middle.z);
    int base = away < 1.1f ? 6 : away < 2.4f ? 5 : 4;
    int block = (i / 4 * 5 + j / 4 * 3) % 7;
    return (slv_res){(int8_t)(base - (block == 1)), (int8_t)(base - (block == 4))};
}

bool scene_build(struct scene *scene) {
    if (!creature_build(&scene->creature, scene->parts))
        return false;
    int ncreature = scene->creature.nquads;
    scene->nfaces = (uint32_t)ncreature + GROUND_SIDE * GROUND_SIDE;
    scene->res = calloc(scene->nfaces, sizeof *scene->res);
    if (!scene->res)
        return false;
    for (int f = 0; f < ncreature; f++)
        scene->res[f] = creature_res(scene, f);
    for (int j = 0; j < GROUND_SIDE; j++)
        for (int i = 0; i < GROUND_SIDE; i++)
            scene->res[ncreature + j * GROUND_SIDE + i] = ground_res(i, j);
    for (int j = 0; j <= GROUND_SIDE; j++)
        for (int i = 0; i <= GROUND_SIDE; i++)
            scene->ground[j * (GROUND_SIDE + 1) + i] = ground_point(i, j);
    return true;
}

void scene_free(struct scene *scene) {
    if (scene)
        free(scene->res);
    free(scene);
}

static void write_point(FILE *file, point p) {
    fprintf(file, "v %.7g %.7g %.7g\n", (double)p.x, (double)p.y, (double)p.z);
}

slv_result scene_save_obj(const slv_env *env, const struct scene *scene, const char *path) {
    const struct cage *creature = &scene->creature;
    slv_output *output;
    slv_result result = slv_output_open(env, path, &output);
    if (result)
        return result;
    FILE *file = slv_output_stream(output);
    fprintf(file, "# %d quads of a creature and %d of ground; y is up, the creature faces +x\n",
            creature->nquads, GROUND_SIDE * GROUND_SIDE);
    for (int i = 0; i < creature->npoints; i++)
        write_point(file, creature->points[i]);
    fprintf(file, "g creature\n");
    for (int f = 0; f < creature->nquads; f++) {
        const int32_t *quad = creature->quads[f];
        fprintf(file, "f %d %d %d %d\n", quad[0] + 1, quad[1] + 1, quad[2] + 1, quad[3] + 1);
    }
    int row = GROUND_SIDE + 1;
    for (int i = 0; i < row * row; i++)
        write_point(file, scene->ground[i]);
    fprintf(file, "g ground\n");
    for (int j = 0; j < GROUND_SIDE; j++)
        for (int i = 0; i < GROUND_SIDE; i++) {
            int first = creature->npoints + j * row + i + 1;
            fprintf(file, "f %d %d %d %d\n", first, first + 1, first + row + 1, first + row);
        }
    return slv_output_end(output, SLV_OK);
}

slv_result scene_bake(const slv_env *env, const struct scene *scene, const slv_surface *surface,
                      float face_tint, slv_texture **out) {
    const slv_procedural hide = {.pattern = SLV_PATTERN_STRIPES,
                                 .frequency = 3.4f,
                                 .direction = {1.0f, 0.30f, 0.12f},
                                 .warp = 1.3f,
                                 .octaves = 5,
                                 .seed = 7,
                                 .color0 = {0.020f, 0.135f, 0.150f, 1},
                                 .color1 = {0.760f, 0.400f, 0.115f, 1},
                                 .face_tint = face_tint};
    const slv_procedural earth = {.pattern = SLV_PATTERN_NOISE,
                                  .frequency = 2.2f,
                                  .octaves = 5,
                                  .seed = 3,
                                  .color0 = {0.090f, 0.120f, 0.060f, 1},
                                  .color1 = {0.560f, 0.500f, 0.360f, 1},
                                  .face_tint = face_tint};
    const slv_texture_desc desc = {.nfaces = scene->nfaces,
                                   .type = SLV_TYPE_U8,
                                   .nchannels = 3,
                                   .alpha_channel = SLV_NO_ALPHA,
                                   .res = scene->res,
                                   .encoding = SLV_TEXTURE_LINEAR};
    uint32_t ncreature = (uint32_t)scene->creature.nquads;
    slv_texture *texture = NULL;
    slv_result result = slv_texture_create(env, &desc, &texture);
    if (result)
        goto done;
    result = slv_bake_procedural(env, surface, &hide, &(slv_bake_params){.face_count = ncreature},
                                 texture);
    if (result)
        goto done;
    result = slv_bake_procedural(env, surface, &earth, &(slv_bake_params){.first_face = ncreature},
                                 texture);
done:
    if (result) {
        slv_texture_destroy(texture);
        texture = NULL;
    }
    *out = texture;
    return result;
}
