/* Faces as cameras see them: a grid of points of each is projected, and rays say whether anything
 * stands before them. */
#include "rays/coverage.h"
#include "rays/ray_scene.h"

#include "base/log.h"
#include "base/parallel.h"
#include "base/progress.h"

#include <math.h>

enum { SEGMENTS = 8 };
#define OFF 1e-4f /* of the diagonal: how far from the surface rays begin */

typedef struct eye {
    const slv_bake_view *view;
    float at[3]; /* where it is, or, without perspective, the way to it */
} eye;

typedef struct coverage {
    const slv_tessellation *triangles;
    const ray_scene *scene;
    const slv_bake_job *job;
    float offset, *sizes;
    const slv_env *env;
    slvi_steps steps;
} coverage;

typedef struct seen_point {
    float x, y; /* pixels */
    bool before, inside;
} seen_point;

/* The upper left 3x3 of the camera's matrix turned back. False if it has none. */
static bool undo(const float *m, const double v[3], double out[3]) {
    double inverse[9], determinant = 0;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            int a = (i + 1) % 3, b = (i + 2) % 3, c = (k + 1) % 3, d = (k + 2) % 3;
            inverse[3 * k + i] = (double)m[4 * a + c] * (double)m[4 * b + d] -
                                 (double)m[4 * a + d] * (double)m[4 * b + c];
        }
    for (int k = 0; k < 3; k++)
        determinant += (double)m[k] * inverse[3 * k];
    for (int k = 0; k < 3; k++)
        out[k] = (inverse[3 * k] * v[0] + inverse[3 * k + 1] * v[1] + inverse[3 * k + 2] * v[2]) /
                 determinant;
    return isfinite(out[0] + out[1] + out[2]);
}

static bool make_eye(const slv_bake_view *view, eye *out) {
    const float *m = view->camera.world_to_camera;
    const double towards[3] = {0, 0, 1}, from[3] = {-(double)m[3], -(double)m[7], -(double)m[11]};
    double at[3];
    out->view = view;
    if (!undo(m, view->camera.perspective ? from : towards, at))
        return false;
    for (int k = 0; k < 3; k++)
        out->at[k] = (float)at[k];
    return true;
}

static seen_point project(const slv_bake_view *view, const float p[3]) {
    const float *m = view->camera.world_to_camera, *window = view->camera.window;
    float c[3];
    for (int k = 0; k < 3; k++)
        c[k] = m[4 * k] * p[0] + m[4 * k + 1] * p[1] + m[4 * k + 2] * p[2] + m[4 * k + 3];
    float depth = view->camera.perspective ? -c[2] : 1;
    seen_point s = {.before = depth > 0};
    if (!s.before)
        return s;
    s.x = (c[0] / depth - window[0]) / (window[1] - window[0]) * (float)view->width;
    s.y = (c[1] / depth - window[2]) / (window[3] - window[2]) * (float)view->height;
    s.inside = s.x >= 0 && s.x <= (float)view->width && s.y >= 0 && s.y <= (float)view->height;
    return s;
}

static bool is_open(const coverage *c, const eye *e, const float p[3]) {
    float direction[3], length = 0, origin[3];
    for (int k = 0; k < 3; k++) {
        direction[k] = e->view->camera.perspective ? e->at[k] - p[k] : e->at[k];
        length += direction[k] * direction[k];
    }
    length = sqrtf(length);
    for (int k = 0; k < 3; k++) {
        direction[k] /= length;
        origin[k] = p[k] + c->offset * direction[k];
    }
    float limit = e->view->camera.perspective ? length - c->offset : INFINITY;
    return !(limit > 0) || !slvi_ray_is_blocked(c->scene, origin, direction, limit);
}

/* A face in one view: the longest steps of its grid, if a point of it is seen. */
static void measure(const coverage *c, const eye *e, uint32_t face, float size[2]) {
    const slv_vertex *vertices = c->triangles->vertices + c->triangles->first[face];
    uint32_t n = c->triangles->segments[face], side = n + 1;
    float most[2] = {0, 0};
    bool seen = false;
    for (uint32_t i = 0; n && i < side * side; i++) {
        seen_point here = project(e->view, vertices[i].position);
        if (!here.before)
            continue;
        seen = seen || (here.inside && is_open(c, e, vertices[i].position));
        for (int axis = 0; axis < 2; axis++) {
            uint32_t next = axis ? i + side : i + 1;
            if (axis ? i / side == n : i % side == n)
                continue;
            seen_point there = project(e->view, vertices[next].position);
            if (there.before && (here.inside || there.inside))
                most[axis] =
                    fmaxf(most[axis], (float)n * hypotf(there.x - here.x, there.y - here.y));
        }
    }
    for (int axis = 0; axis < 2 && seen; axis++)
        size[axis] = fmaxf(size[axis], most[axis]);
}

static slv_result measure_faces(void *user, uint64_t first, uint64_t end) {
    coverage *c = user;
    for (uint64_t face = first; face < end; face++) {
        float *size = c->sizes + 2 * face;
        size[0] = size[1] = 0;
        for (uint32_t i = 0; i < c->job->nviews; i++) {
            eye e;
            if (make_eye(&c->job->views[i], &e))
                measure(c, &e, (uint32_t)face, size);
        }
    }
    return slvi_steps_add(&c->steps, c->env, "bake", end - first);
}

static slv_result check(const slv_env *env, const slv_bake_view *views, uint32_t nviews) {
    for (uint32_t i = 0; i < nviews; i++) {
        const float *window = views[i].camera.window;
        eye e;
        if (!views[i].width || !views[i].height || !(window[1] > window[0]) ||
            !(window[3] > window[2]) || !make_eye(&views[i], &e))
            return slvi_fail(env, SLV_ERROR_ARGUMENT,
                             "bake: view %u: a camera that sees nothing, or a picture of %u x %u",
                             i, views[i].width, views[i].height);
    }
    return SLV_OK;
}

slv_result slvi_coverage(const slv_env *env, const slv_mesh *mesh, const slv_bake_job *job,
                         float *sizes) {
    const slv_surface_params how = {.scheme = job->scheme};
    slv_progress progress = job->progress;
    slv_surface *surface = NULL;
    slv_adjacency *adjacency = NULL;
    slv_tessellation triangles = {0};
    ray_scene scene = {0};
    coverage c = {&triangles, &scene, job, 0, sizes, env, {.done = 0}};
    double diagonal = 0;
    slv_result result = check(env, job->views, job->nviews);
    if (result || (result = slv_surface_create(env, mesh, &how, &surface)) ||
        (result = slv_mesh_adjacency(env, mesh, &adjacency)) ||
        (result = slvi_progress(&progress, env, "bake", 0, 1)) ||
        (result = slv_tessellate(env, mesh, surface, adjacency, SEGMENTS, &triangles)) ||
        (result = slvi_progress(&progress, env, "bake", 0, 1)) ||
        (result = slvi_ray_scene_of_surface(env, &triangles, &progress, &scene)))
        goto done;
    for (int k = 0; k < 3; k++) {
        double side = (double)triangles.bounds_max[k] - (double)triangles.bounds_min[k];
        diagonal += side * side;
    }
    c.offset = OFF * (float)sqrt(diagonal);
    slvi_steps_begin(&c.steps, slvi_progress_asking(&progress), slv_mesh_face_count(mesh));
    result = slvi_parallel_for(env, slv_mesh_face_count(mesh), 16, measure_faces, &c);
    slvi_steps_end(&c.steps);
done:
    slvi_ray_scene_free(&scene);
    slv_tessellation_free(&triangles);
    slv_adjacency_destroy(adjacency);
    slv_surface_destroy(surface);
    return result;
}
