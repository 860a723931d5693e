/* The verb pick: which face and texel a place in a picture shows. */
#include "command/numbers.h"
#include "command/output.h"
#include "command/scene.h"
#include "verbs.h"

#include <selvage/reference.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct pick {
    const char *arguments[3]; /* the texture, x, y */
    scene_options scene;
    bool json;
};

/* What is there. */
typedef struct found {
    slv_reference_hit hit;
    uint32_t x, y; /* of the texel, which `size` has so many of */
    uint32_t size[2], nchannels;
    float *values;
} found;

/* The camera's window of one pixel around a point of the picture, so that the one ray cast through
 * it is the pixel's own. */
static slv_camera look_at(const scene_shot *shot, const double at[2]) {
    slv_camera camera = shot->camera;
    const float *w = shot->camera.window;
    double across = ((double)w[1] - (double)w[0]) / shot->width,
           up = ((double)w[3] - (double)w[2]) / shot->height;
    double x = (double)w[0] + across * at[0], y = (double)w[3] - up * at[1];
    camera.window[0] = (float)(x - across / 2);
    camera.window[1] = (float)(x + across / 2);
    camera.window[2] = (float)(y - up / 2);
    camera.window[3] = (float)(y + up / 2);
    return camera;
}

/* From the scene's face to the file's, and the texel there. A triangle's square has the upper half
 * of a cell beyond the diagonal, mirrored at it. */
static void find_texel(const scene_data *scene, found *out) {
    const slv_texture *texture = scene->triangles ? scene->triangles : scene->texture;
    if (scene->triangles)
        slv_triangle_from_subface((unsigned)out->hit.face % 3, out->hit.u, out->hit.v, &out->hit.u,
                                  &out->hit.v);
    out->hit.face = scene_file_face(scene, out->hit.face);
    slv_res res = slv_texture_get_desc(texture)->res[out->hit.face];
    float within[2];
    for (int k = 0; k < 2; k++) {
        out->size[k] = 1u << (k ? res.v : res.u);
        float place = fminf(fmaxf(k ? out->hit.v : out->hit.u, 0), 1) * (float)out->size[k];
        uint32_t texel = (uint32_t)place < out->size[k] ? (uint32_t)place : out->size[k] - 1;
        within[k] = place - (float)texel;
        *(k ? &out->y : &out->x) = texel;
    }
    if (scene->triangles && within[0] + within[1] > 1 && out->x + out->y + 1 < out->size[0]) {
        uint32_t x = out->x;
        out->x = out->size[0] - 1 - out->y;
        out->y = out->size[0] - 1 - x;
    }
    slv_texture_fetch(texture, (uint32_t)out->hit.face, out->x, out->y, out->values);
}

/* Values are the file's numbers, or the light that they stand for if sRGB is asked for. */
static slv_result find(const slv_env *env, const scene_shot *shot, bool srgb, const double at[2],
                       found *out) {
    const slv_reference_params params = {.tessellation = &shot->tessellation,
                                         .encoding = SLV_TEXTURE_DATA};
    const slv_texture_desc *desc = slv_texture_get_desc(shot->scene.texture);
    slv_camera camera = look_at(shot, at);
    slv_reference *reference = NULL;
    slv_result result =
        slv_reference_create(env, shot->scene.mesh, shot->scene.surface, shot->scene.texture,
                             shot->scene.adjacency, &params, &reference);
    if (!result)
        result = slv_reference_trace(reference, env, &camera, 1, 1, &out->hit);
    slv_reference_destroy(reference);
    if (result || out->hit.face < 0)
        return result;
    out->nchannels = desc->nchannels;
    out->values = calloc(desc->nchannels, sizeof *out->values);
    if (!out->values)
        return output_fail(env, SLV_ERROR_MEMORY, "no memory for %u channels", desc->nchannels);
    find_texel(&shot->scene, out);
    if (srgb)
        slv_texels_decode(desc->nchannels, desc->alpha_channel, out->values, 1);
    return SLV_OK;
}

static json_t *found_json(const struct pick *p, const found *f) {
    json_t *values = json_array();
    if (f->hit.face < 0) {
        json_decref(values);
        return json_pack("{s:i, s:o, s:n}", "schema", 1, "path", output_json_name(p->arguments[0]),
                         "face");
    }
    for (uint32_t c = 0; c < f->nchannels; c++)
        if (json_array_append_new(values, output_json_number((double)f->values[c]))) {
            json_decref(values);
            return NULL;
        }
    return json_pack("{s:i, s:o, s:i, s:f, s:f, s:[I,I], s:[I,I], s:o}", "schema", 1, "path",
                     output_json_name(p->arguments[0]), "face", (int)f->hit.face, "u",
                     (double)f->hit.u, "v", (double)f->hit.v, "texel", (json_int_t)f->x,
                     (json_int_t)f->y, "size", (json_int_t)f->size[0], (json_int_t)f->size[1],
                     "value", values);
}

static void print_found(const found *f) {
    printf("face %d\nu %.6g\nv %.6g\ntexel %u,%u of %u x %u\nvalue", f->hit.face, (double)f->hit.u,
           (double)f->hit.v, f->x, f->y, f->size[0], f->size[1]);
    for (uint32_t c = 0; c < f->nchannels; c++)
        printf(" %.6g", (double)f->values[c]);
    putchar('\n');
}

static int run_pick(const cli_command *command, const struct pick *p) {
    slv_env env = cli_env(p->scene.threads);
    scene_shot shot;
    found f = {.values = NULL};
    double at[2];
    int code = scene_load_shot(command, &env, p->arguments[0], &p->scene, &shot);
    const uint32_t size[2] = {shot.width, shot.height};
    for (int k = 0; k < 2 && !code; k++) {
        const char *end = p->arguments[1 + k];
        if (!value_ratio(p->arguments[1 + k], &at[k], &end) || *end || at[k] < 0 || at[k] > size[k])
            code = cli_usage(command, "%c: '%s' does not lie in the picture, 0 to %u", "XY"[k],
                             p -> arguments[1 + k], size[k]);
        /* whole numbers are pixels, and mean their middle */
        else if (at[k] == floor(at[k]) && at[k] < size[k])
            at[k] += 0.5;
    }
    if (!code)
        code = find(&env, &shot, p->scene.encoding == SLV_TEXTURE_SRGB, at, &f) ? EXIT_FAILED
                                                                                : EXIT_OK;
    scene_free(&shot.scene);
    if (!code && p->json)
        code = output_print_json(p->arguments[0], found_json(p, &f));
    else if (!code && f.hit.face >= 0)
        print_found(&f);
    if (!code && f.hit.face < 0)
        code = cli_error("%s: nothing of the surface is at %s %s", p->arguments[0], p->arguments[1],
                         p->arguments[2]);
    free(f.values);
    return code;
}

int verb_pick(int argc, char **argv) {
    enum { OWN = 1 };
    struct pick p = {.scene = scene_options_default()};
    uint32_t narguments = 0;
    cli_option options[OWN + SCENE_OPTION_ROWS] = {CLI_JSON(&p.json)};
    const cli_command command = {
        .name = "pick",
        .summary = "say which face and texel a place in a picture shows",
        .arguments = "FILE.ptx X Y",
        .reads = "a texture; a mesh and a view file if they are named",
        .exits = "0 a face is there, 1 none is, or failure, 2 wrong usage",
        .examples = "  selvage pick teapot.ptx 300 120 --view view.json\n"
                    "  selvage pick cow.ptx --mesh cow.obj --azimuth 60 256 256 --json\n",
        CLI_TAKES(options, 3, 3, p.arguments, &narguments)};
    scene_options_rows(&p.scene, options + OWN);
    int code = cli_parse(&command, argc, argv);
    if (code >= 0)
        return code;
    const char *problem = scene_options_problem(&p.scene);
    if (problem)
        return cli_usage(&command, "%s", problem);
    return run_pick(&command, &p);
}
