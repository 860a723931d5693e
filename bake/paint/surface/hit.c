/* Rays at the painted surface, by Embree, and the rays of a camera. */
#include "surface/surface_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <string.h>

#if SLV_EMBREE_VERSION >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

struct slvi_rays {
    RTCDevice device;
    RTCScene scene;
    uint32_t *quads;
};

static slv_result embree_result(const slv_env *env, RTCDevice device) {
    enum RTCError error = rtcGetDeviceError(device);
    if (device && error == RTC_ERROR_NONE)
        return SLV_OK;
    if (error == RTC_ERROR_OUT_OF_MEMORY)
        return slvi_fail(env, SLV_ERROR_MEMORY, "paint surface: Embree has no memory");
    return slvi_fail(env, SLV_ERROR_UNSUPPORTED, "paint surface: Embree fails with its error %d",
                     (int)error);
}

static slv_result make(const slv_paint_surface *s, struct slvi_rays *rays) {
    slv_result result = slvi_alloc(&s->env, "rays", s->ncells, 4 * 4, &rays->quads);
    if (result)
        return result;
    /* Embree splits a quad between its second and fourth vertex. */
    for (size_t i = 0; i < 4 * (size_t)s->ncells; i++)
        rays->quads[i] = s->cells[i / 4].corners[(i + 1) & 3];
    if (!(rays->device = rtcNewDevice("threads=1")))
        return embree_result(&s->env, NULL);
    rays->scene = rtcNewScene(rays->device);
    rtcSetSceneFlags(rays->scene, RTC_SCENE_FLAG_ROBUST);
    if (s->ncells) {
        RTCGeometry geometry = rtcNewGeometry(rays->device, RTC_GEOMETRY_TYPE_QUAD);
        /* Embree reads 16 bytes of a vertex, and the last one has 12: it keeps a copy. */
        float *to = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                            3 * sizeof(float), s->nverts);
        if (to)
            memcpy(to, s->positions, 3 * sizeof(float) * s->nverts);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4,
                                   rays->quads, 0, 4 * 4, s->ncells);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(rays->scene, geometry);
        rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(rays->scene);
    return embree_result(&s->env, rays->device);
}

slv_result slvi_rays_create(const slv_paint_surface *s, struct slvi_rays **out) {
    struct slvi_rays *rays = NULL;
    for (int k = 0; k < 3 && s->ncells; k++)
        if (!(s->low[k] > -SLVI_FARTHEST && s->high[k] < SLVI_FARTHEST))
            return slvi_fail(&s->env, SLV_ERROR_LIMIT,
                             "paint surface: it goes from %g to %g along axis %d, and rays reach "
                             "%g at most",
                             (double)s->low[k], (double)s->high[k], k, (double)SLVI_FARTHEST);
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
    if (rays->scene)
        rtcReleaseScene(rays->scene);
    if (rays->device)
        rtcReleaseDevice(rays->device);
    slvi_free(rays->quads);
    slvi_free(rays);
}

static bool is_in_reach(const float v[3]) {
    return fabsf(v[0]) < SLVI_FARTHEST && fabsf(v[1]) < SLVI_FARTHEST &&
           fabsf(v[2]) < SLVI_FARTHEST;
}

bool slv_paint_surface_hit(const slv_paint_surface *surface, const float origin[3],
                           const float direction[3], slv_paint_hit *out) {
    struct RTCRayHit ray;
    if (!is_in_reach(origin) || !is_in_reach(direction))
        return false;
    memset(&ray, 0, sizeof ray);
    ray.ray.org_x = origin[0];
    ray.ray.org_y = origin[1];
    ray.ray.org_z = origin[2];
    ray.ray.dir_x = direction[0];
    ray.ray.dir_y = direction[1];
    ray.ray.dir_z = direction[2];
    ray.ray.tfar = INFINITY;
    ray.ray.mask = UINT32_MAX;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if SLV_EMBREE_VERSION >= 4
    rtcIntersect1(surface->rays->scene, &ray, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(surface->rays->scene, &context, &ray);
#endif
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID)
        return false;
    /* of a quad that begins at corner 1, v runs from there to corner 0 and u to corner 2 */
    double x = 1 - (double)ray.hit.v, y = (double)ray.hit.u;
    uint32_t tri = 2 * ray.hit.primID + (y > x);
    out->point = slvi_surface_point_of(surface, tri, x, y);
    out->distance = ray.ray.tfar;
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
