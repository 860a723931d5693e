/* What the ray through the middle of each pixel hits. */
#include "rays/reference_data.h"

#include "base/log.h"
#include "base/parallel.h"

#include <selvage/half.h>

#include <math.h>
#include <string.h>

enum { ROW_GRAIN = 4 };

typedef struct trace {
    const slv_reference *reference;
    reference_eye eye;
    uint32_t width, height;
    slv_reference_hit *hits;
} trace;

/* The triangle of a quad that a hit lies in, and the (u,v) of its three vertices. */
typedef struct triangle {
    float points[3][3], uv[3][2];
    uint32_t face;
} triangle;

static triangle find_triangle(const slv_reference *reference, const struct RTCHit *hit) {
    static const unsigned halves[2][3] = {{0, 1, 3}, {2, 3, 1}};
    const slv_tessellation *mesh = &reference->mesh;
    const uint32_t *quad = reference->quads + 4 * (size_t)hit->primID;
    const unsigned *which = halves[hit->u + hit->v > 1];
    triangle out = {.face = (uint32_t)mesh->vertices[quad[3]].face};
    for (int k = 0; k < 3; k++) {
        const slv_vertex *vertex = mesh->vertices + quad[which[k]];
        memcpy(out.points[k], vertex->position, sizeof out.points[k]);
        for (int axis = 0; axis < 2; axis++)
            out.uv[k][axis] = slv_half_to_float(vertex->uv[axis]);
    }
    return out;
}

/* Where a ray meets the triangle's plane: u, v and depth, which need not lie inside. False if it
 * runs along the plane. */
static bool meet(const triangle *t, const float origin[3], const float direction[3],
                 double out[3]) {
    double e1[3], e2[3], p[3], q[3], s[3];
    for (int k = 0; k < 3; k++) {
        e1[k] = (double)t->points[1][k] - (double)t->points[0][k];
        e2[k] = (double)t->points[2][k] - (double)t->points[0][k];
        s[k] = (double)origin[k] - (double)t->points[0][k];
    }
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        p[k] = (double)direction[a] * e2[b] - (double)direction[b] * e2[a];
        q[k] = s[a] * e1[b] - s[b] * e1[a];
    }
    double determinant = e1[0] * p[0] + e1[1] * p[1] + e1[2] * p[2];
    double b1 = (s[0] * p[0] + s[1] * p[1] + s[2] * p[2]) / determinant;
    double b2 =
        ((double)direction[0] * q[0] + (double)direction[1] * q[1] + (double)direction[2] * q[2]) /
        determinant;
    for (int k = 0; k < 2; k++)
        out[k] = (double)t->uv[0][k] + b1 * (double)(t->uv[1][k] - t->uv[0][k]) +
                 b2 * (double)(t->uv[2][k] - t->uv[0][k]);
    out[2] = (e2[0] * q[0] + e2[1] * q[1] + e2[2] * q[2]) / determinant;
    return isfinite(out[0]) && isfinite(out[1]) && isfinite(out[2]);
}

/* The ray through a point of the picture, in pixels from its upper left corner. */
static void ray_through(const trace *t, float x, float y, float origin[3], float direction[3]) {
    const float *w = t->eye.window;
    reference_eye_ray(&t->eye, w[0] + x / (float)t->width * (w[1] - w[0]),
                      w[3] - y / (float)t->height * (w[3] - w[2]), origin, direction);
}

static slv_reference_hit trace_pixel(const trace *t, uint32_t x, uint32_t y) {
    slv_reference_hit hit = {.face = -1};
    struct RTCRay ray;
    struct RTCHit met;
    float origin[3], direction[3];
    double here[3], beside[2][3];
    ray_through(t, (float)x + 0.5f, (float)y + 0.5f, origin, direction);
    ray = embree_ray(origin, direction, INFINITY);
    ray.tnear = t->eye.perspective ? t->eye.nearest : 0;
    if (!embree_hit(t->reference->scene, &ray, &met))
        return hit;
    triangle under = find_triangle(t->reference, &met);
    if (!meet(&under, origin, direction, here))
        return hit;
    hit.face = (int32_t)under.face;
    hit.u = reference_clamp((float)here[0], 1.0f);
    hit.v = reference_clamp((float)here[1], 1.0f);
    hit.depth = ray.tfar;
    for (int k = 0; k < 2; k++) {
        ray_through(t, (float)x + (k ? 0.5f : 1.5f), (float)y + (k ? 1.5f : 0.5f), origin,
                    direction);
        if (!meet(&under, origin, direction, beside[k])) /* seen edge on */
            memcpy(beside[k], here, sizeof here);
        hit.du[k] = (float)(beside[k][0] - here[0]);
        hit.dv[k] = (float)(beside[k][1] - here[1]);
        hit.ddepth[k] = (float)(beside[k][2] - here[2]);
    }
    return hit;
}

static slv_result trace_rows(void *user, uint64_t first, uint64_t end) {
    const trace *t = user;
    for (uint64_t y = first; y < end; y++)
        for (uint32_t x = 0; x < t->width; x++)
            t->hits[y * t->width + x] = trace_pixel(t, x, (uint32_t)y);
    return SLV_OK;
}

slv_result slv_reference_trace(const slv_reference *reference, const slv_env *env,
                               const slv_camera *camera, uint32_t width, uint32_t height,
                               slv_reference_hit *hits) {
    trace t = {.reference = reference, .width = width, .height = height, .hits = hits};
    if (!width || !height)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "reference: a picture of %u x %u pixels", width,
                         height);
    slv_result result = slvi_reference_eye_make(env, reference, camera, &t.eye);
    return result ? result : slvi_parallel_for(env, height, ROW_GRAIN, trace_rows, &t);
}
