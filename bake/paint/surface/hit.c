/* Rays at the painted surface, by Embree, and the rays of a camera. */
#include "rays/embree.h"
#include "surface/surface_data.h"

#include "base/memory.h"

struct slvi_rays {
    RTCDevice device;
    RTCScene scene;
    uint32_t *quads;
};

static slv_result make(const slv_paint_surface *s, struct slvi_rays *rays) {
    slv_result result = slvi_alloc(&s->env, "rays", s->ncells, 4 * 4, &rays->quads);
    if (result)
        return result;
    /* Embree splits a quad between its second and fourth vertex. */
    for (size_t i = 0; i < 4 * (size_t)s->ncells; i++)
        rays->quads[i] = s->cells[i / 4].corners[slvi_edge_next((unsigned)i)];
    /* What follows the last vertex need not be readable: Embree keeps a copy. */
    embree_faces faces = {.what = "paint surface",
                          .type = RTC_GEOMETRY_TYPE_QUAD,
                          .points = s->positions,
                          .stride = 3 * sizeof *s->positions,
                          .npoints = s->nverts,
                          .corners = rays->quads,
                          .count = s->ncells,
                          .low = s->low,
                          .high = s->high,
                          .copied = true};
    return embree_build(&s->env, &faces, &rays->device, &rays->scene);
}

slv_result slvi_rays_create(const slv_paint_surface *s, struct slvi_rays **out) {
    struct slvi_rays *rays = NULL;
    slv_result result = slvi_alloc(&s->env, "rays", 1, sizeof *rays, &rays);
    if (!result && (result = make(s, rays))) {
        slvi_rays_destroy(rays);
        rays = NULL;
    }
    *out = rays;
    return result;
}

void slvi_rays_destroy(struct slvi_rays *rays) {
    if (!rays)
        return;
    embree_release(rays->device, rays->scene);
    slvi_free(rays->quads);
    slvi_free(rays);
}

static bool is_in_reach(const float v[3]) {
    return fabsf(v[0]) < EMBREE_FARTHEST && fabsf(v[1]) < EMBREE_FARTHEST &&
           fabsf(v[2]) < EMBREE_FARTHEST;
}

bool slv_paint_surface_hit(const slv_paint_surface *surface, const float origin[3],
                           const float direction[3], slv_paint_hit *out) {
    if (!is_in_reach(origin) || !is_in_reach(direction))
        return false;
    struct RTCRay ray = embree_ray(origin, direction, INFINITY);
    struct RTCHit hit;
    if (!embree_hit(surface->rays->scene, &ray, &hit))
        return false;
    /* of a quad that begins at corner 1, v runs from there to corner 0 and u to corner 2 */
    double x = 1 - (double)hit.v, y = (double)hit.u;
    uint32_t tri = 2 * hit.primID + (y > x);
    out->point = slvi_surface_point_of(surface, tri, x, y);
    out->distance = ray.tfar;
    return slv_paint_surface_at(surface, out->point, out->position, NULL, NULL);
}

bool slv_paint_surface_ray(const slv_paint_surface *surface, const slv_camera *camera,
                           uint32_t width, uint32_t height, float x, float y, float origin[3],
                           float direction[3]) {
    const float *m = camera->world_to_camera, *window = camera->window;
    double columns[3][3], determinant = 0, eye[3];
    float nearest, farthest;
    for (int c = 0; c < 3; c++) /* of the inverse */
        for (int r = 0; r < 3; r++) {
            int r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
            columns[c][r] = (double)m[4 * c1 + r1] * (double)m[4 * c2 + r2] -
                            (double)m[4 * c1 + r2] * (double)m[4 * c2 + r1];
        }
    for (int r = 0; r < 3; r++)
        determinant += (double)m[r] * columns[0][r];
    double px = (double)window[0] + (double)x / width * ((double)window[1] - (double)window[0]);
    double py = (double)window[3] - (double)y / height * ((double)window[3] - (double)window[2]);
    slv_camera_depths(camera, surface->low, surface->high, &nearest, &farthest);
    for (int r = 0; r < 3; r++) {
        eye[r] = 0;
        for (int c = 0; c < 3; c++) {
            columns[c][r] /= determinant;
            eye[r] -= columns[c][r] * (double)m[4 * c + 3];
        }
    }
    for (int r = 0; r < 3; r++) {
        double across = px * columns[0][r] + py * columns[1][r];
        double towards = camera->perspective ? across - columns[2][r] : -columns[2][r];
        double from = camera->perspective ? eye[r] : eye[r] + across;
        origin[r] = (float)(from + ((double)nearest -
                                    (camera->perspective ? 0 : 1e-3) * fabs((double)farthest)) *
                                       towards);
        direction[r] = (float)towards;
    }
    return width && height && is_in_reach(origin) && is_in_reach(direction) &&
           (direction[0] != 0 || direction[1] != 0 || direction[2] != 0);
}
