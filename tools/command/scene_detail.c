/* How fine the texels of each face have to be for a picture: of a texture that is large, no more is
 * read. */
#include "command/output.h"
#include "command/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LARGE (UINT64_C(256) << 20) /* bytes of texels: what is less is read as it is */
#define FINENESS 2                  /* texels a pixel and axis */

struct view {
    const float *m;     /* world to camera */
    float window[4];    /* left, right, bottom, top */
    double per_unit[2]; /* pixels of a length 1 at distance 1, or anywhere without perspective */
    bool perspective;
    double nearest;
};

static double length_of(const float *a, const float *b) {
    double x = (double)a[0] - (double)b[0], y = (double)a[1] - (double)b[1],
           z = (double)a[2] - (double)b[2];
    return sqrt(x * x + y * y + z * z);
}

/* The ball around a face's corners, and as much again for what the limit surface does beside them,
 * in the eye's frame. */
static double ball_of(const struct view *v, const float *corners, double centre[3]) {
    double middle[3], radius = 0;
    for (int k = 0; k < 3; k++)
        middle[k] = 0.25 * ((double)corners[k] + (double)corners[3 + k] + (double)corners[6 + k] +
                            (double)corners[9 + k]);
    const float at[3] = {(float)middle[0], (float)middle[1], (float)middle[2]};
    for (int c = 0; c < 4; c++)
        radius = fmax(radius, length_of(corners + 3 * c, at));
    for (int r = 0; r < 3; r++)
        centre[r] = (double)v->m[4 * r] * middle[0] + (double)v->m[4 * r + 1] * middle[1] +
                    (double)v->m[4 * r + 2] * middle[2] + (double)v->m[4 * r + 3];
    return 2 * radius;
}

/* Whether all of a ball is beside the picture or behind the eye. */
static bool is_outside(const struct view *v, const double centre[3], double radius) {
    double depth = -centre[2];
    if (v->perspective && depth + radius < v->nearest)
        return true;
    double reach = v->perspective ? fmax(depth + radius, 0) : 1;
    for (int axis = 0; axis < 2; axis++) {
        double low = (double)v->window[2 * axis] * reach,
               high = (double)v->window[2 * axis + 1] * reach;
        /* a window beside the middle is further from the eye's axis the deeper it is looked at */
        if (v->perspective && low > 0)
            low = (double)v->window[2 * axis] * fmax(depth - radius, 0);
        if (v->perspective && high < 0)
            high = (double)v->window[2 * axis + 1] * fmax(depth - radius, 0);
        if (centre[axis] + radius < low || centre[axis] - radius > high)
            return true;
    }
    return false;
}

static int8_t log2_for(double texels, int8_t most) {
    double wanted = texels > 1 ? ceil(log2(texels)) : 0;
    return (int8_t)(wanted < most ? (int)wanted : most);
}

static slv_res res_for(const struct view *v, const float *c, slv_res most) {
    double centre[3], radius = ball_of(v, c, centre), scale = FINENESS;
    if (is_outside(v, centre, radius))
        return (slv_res){log2_for(1, most.u), log2_for(1, most.v)};
    scale *= fmax(v->per_unit[0], v->per_unit[1]);
    if (v->perspective)
        scale /= fmax(-centre[2] - radius, v->nearest);
    double u = fmax(length_of(c, c + 3), length_of(c + 9, c + 6)),
           w = fmax(length_of(c, c + 9), length_of(c + 3, c + 6));
    return (slv_res){log2_for(scale * u, most.u), log2_for(scale * w, most.v)};
}

static struct view view_of(const scene_shot *shot) {
    const slv_camera *camera = &shot->camera;
    float n, f;
    struct view v = {.m = camera->world_to_camera, .perspective = camera->perspective};
    memcpy(v.window, camera->window, sizeof v.window);
    v.per_unit[0] = shot->width / ((double)v.window[1] - (double)v.window[0]);
    v.per_unit[1] = shot->height / ((double)v.window[3] - (double)v.window[2]);
    slv_camera_depths(camera, shot->scene.bounds_min, shot->scene.bounds_max, &n, &f);
    v.nearest = camera->perspective ? (double)n : 0;
    return v;
}

static double gib(uint64_t bytes) {
    return (double)bytes / (1 << 30);
}

slv_result scene_check_memory(const slv_env *env, const slv_ptx *ptx, const slv_res *res) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    uint64_t pixel = slv_type_size(info->type) * info->nchannels, bytes = 0,
             most = slv_memory_available();
    slv_ptx_face face;
    slv_result result = SLV_OK;
    for (uint32_t i = 0; i < info->nfaces && !result; i++)
        if (!(result = slv_ptx_get_face(ptx, i, &face)) && !(face.flags & SLV_FACE_CONSTANT))
            bytes += pixel << (res ? res[i].u + res[i].v : face.res.u + face.res.v);
    if (!result && bytes >= most)
        result = output_fail(env, SLV_ERROR_LIMIT,
                             "%s: %.1f GiB of texels are needed in memory, where %.1f GiB are to "
                             "be had: convert --scale or --max makes it smaller",
                             slv_ptx_name(ptx), gib(bytes), gib(most));
    return result;
}

slv_result scene_choose_detail(const slv_env *env, const slv_ptx *ptx, const scene_shot *shot,
                               slv_res **out) {
    const slv_ptx_info *info = slv_ptx_get_info(ptx);
    uint64_t pixel = slv_type_size(info->type) * info->nchannels, whole = 0;
    struct view v = view_of(shot);
    float *corners = NULL;
    slv_ptx_face face;
    slv_result result = SLV_OK;
    *out = NULL;
    for (uint32_t i = 0; i < info->nfaces && !result; i++)
        if (!(result = slv_ptx_get_face(ptx, i, &face)) && !(face.flags & SLV_FACE_CONSTANT))
            whole += pixel << (face.res.u + face.res.v);
    if (result || whole <= LARGE || shot->shading == SLV_SHADE_LEVELS)
        return result;
    if ((result = slv_mesh_corners(env, shot->scene.mesh, NULL, &corners)))
        return result;
    *out = calloc(info->nfaces, sizeof **out);
    if (!*out)
        result = output_fail(env, SLV_ERROR_MEMORY, "%s: no memory for %u faces", slv_ptx_name(ptx),
                             info->nfaces);
    for (uint32_t i = 0; i < info->nfaces && !result; i++)
        if (!(result = slv_ptx_get_face(ptx, i, &face)))
            (*out)[i] = res_for(&v, corners + (size_t)12 * i, face.res);
    slv_free(corners);
    if (result) {
        free(*out);
        *out = NULL;
    }
    return result;
}
