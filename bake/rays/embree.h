/* What all that cast rays by Embree share: its versions' differences, a tree of triangles or quads,
 * one ray. Inline, since painting is a library of its own. */
#ifndef SLV_BAKE_EMBREE_H
#define SLV_BAKE_EMBREE_H

#include "base/log.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#if SLV_EMBREE_VERSION >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

/* Embree ends the process at coordinates, of faces or rays, whose squares overflow a float. */
#define EMBREE_FARTHEST 1e18f

/* The faces and their vertices, which outlive the tree unless `copied`. Embree reads 16 bytes of a
 * vertex: what follows the last one's 12 must be readable, or the vertices are copied. */
typedef struct embree_faces {
    const char *what; /* the subject of messages */
    enum RTCGeometryType type;
    float *points;
    size_t stride;
    uint64_t npoints;
    uint32_t *corners; /* 3 or 4 a face */
    uint64_t count;
    const float *low, *high; /* the box of the points */
    bool copied;
    const slv_progress *progress; /* asked whether to go on; or NULL */
} embree_faces;

static inline slv_result embree_result(const slv_env *env, const char *what, RTCDevice device) {
    enum RTCError error = rtcGetDeviceError(device);
    if (device && error == RTC_ERROR_NONE)
        return SLV_OK;
    if (error == RTC_ERROR_CANCELLED)
        return slvi_fail(env, SLV_ERROR_CANCELLED, "%s: cancelled", what);
    if (error == RTC_ERROR_OUT_OF_MEMORY)
        return slvi_fail(env, SLV_ERROR_MEMORY, "%s: Embree has no memory", what);
    return slvi_fail(env, SLV_ERROR_UNSUPPORTED, "%s: Embree fails with its error %d", what,
                     (int)error);
}

/* The box of what rays are cast at, or from. */
static inline slv_result embree_check_box(const slv_env *env, const char *what, const float low[3],
                                          const float high[3]) {
    for (int k = 0; k < 3; k++)
        if (!(low[k] > -EMBREE_FARTHEST && high[k] < EMBREE_FARTHEST))
            return slvi_fail(env, SLV_ERROR_LIMIT,
                             "%s: the surface goes from %g to %g along axis %d, and rays reach %g "
                             "at most",
                             what, (double)low[k], (double)high[k], k, (double)EMBREE_FARTHEST);
    return SLV_OK;
}

static inline bool embree_ask(void *user, double share) {
    const slv_progress *progress = user;
    (void)share;
    return progress->report(progress->user, 0, 1);
}

/* Both are released by embree_release, after a failure too. One thread builds the tree, so that
 * which of two faces a ray along their edge hits does not depend on how many there are. */
static inline slv_result embree_build(const slv_env *env, const embree_faces *faces,
                                      RTCDevice *device, RTCScene *scene) {
    bool quads = faces->type == RTC_GEOMETRY_TYPE_QUAD;
    slv_result result =
        faces->npoints ? embree_check_box(env, faces->what, faces->low, faces->high) : SLV_OK;
    if (result)
        return result;
    if (!(*device = rtcNewDevice("threads=1")))
        return embree_result(env, faces->what, NULL);
    *scene = rtcNewScene(*device);
    rtcSetSceneFlags(*scene, RTC_SCENE_FLAG_ROBUST);
    if (faces->count) {
        RTCGeometry geometry = rtcNewGeometry(*device, faces->type);
        void *to = NULL;
        if (!faces->copied)
            rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                       faces->points, 0, faces->stride, faces->npoints);
        else if ((to = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                               RTC_FORMAT_FLOAT3, faces->stride, faces->npoints)))
            memcpy(to, faces->points, faces->stride * faces->npoints);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                   quads ? RTC_FORMAT_UINT4 : RTC_FORMAT_UINT3, faces->corners, 0,
                                   (quads ? 4 : 3) * sizeof *faces->corners, faces->count);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(*scene, geometry);
        rtcReleaseGeometry(geometry);
    }
    slv_progress asked = {0};
    if (faces->progress && faces->progress->report) {
        asked = *faces->progress;
        rtcSetSceneProgressMonitorFunction(*scene, embree_ask, &asked);
    }
    rtcCommitScene(*scene);
    rtcSetSceneProgressMonitorFunction(*scene, NULL, NULL);
    return embree_result(env, faces->what, *device);
}

static inline void embree_release(RTCDevice device, RTCScene scene) {
    if (scene)
        rtcReleaseScene(scene);
    if (device)
        rtcReleaseDevice(device);
}

static inline struct RTCRay embree_ray(const float origin[3], const float direction[3], float far) {
    struct RTCRay ray;
    memset(&ray, 0, sizeof ray);
    ray.org_x = origin[0];
    ray.org_y = origin[1];
    ray.org_z = origin[2];
    ray.dir_x = direction[0];
    ray.dir_y = direction[1];
    ray.dir_z = direction[2];
    ray.tfar = far;
    ray.mask = UINT32_MAX;
    return ray;
}

/* Whether the ray meets anything; if so it ends there. */
static inline bool embree_hit(RTCScene scene, struct RTCRay *ray, struct RTCHit *hit) {
    struct RTCRayHit both;
    memset(&both, 0, sizeof both);
    both.ray = *ray;
    both.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    both.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if SLV_EMBREE_VERSION >= 4
    rtcIntersect1(scene, &both, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &both);
#endif
    *ray = both.ray;
    *hit = both.hit;
    return hit->geomID != RTC_INVALID_GEOMETRY_ID;
}

#endif
