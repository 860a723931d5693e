/* Triangles for Embree, out of a tessellation or of polygons. */
#include "rays/ray_scene.h"

#include "base/log.h"
#include "base/memory.h"

#include <float.h>
#include <math.h>
#include <string.h>

static slv_result commit(const slv_env *env, const slv_progress *progress, ray_scene *s) {
    for (int k = 0; k < 3; k++) {
        s->low[k] = FLT_MAX;
        s->high[k] = -FLT_MAX;
        for (uint64_t i = 0; i < s->nvertices; i++) {
            s->low[k] = fminf(s->low[k], s->points[3 * i + (uint64_t)k]);
            s->high[k] = fmaxf(s->high[k], s->points[3 * i + (uint64_t)k]);
        }
    }
    embree_faces faces = {.what = "rays",
                          .type = RTC_GEOMETRY_TYPE_TRIANGLE,
                          .points = s->points,
                          .stride = 3 * sizeof *s->points,
                          .npoints = s->nvertices,
                          .corners = s->triangles,
                          .count = s->ntriangles,
                          .low = s->low,
                          .high = s->high,
                          .progress = progress};
    return embree_build(env, &faces, &s->device, &s->scene);
}

static slv_result reserve(const slv_env *env, uint64_t nvertices, uint64_t ntriangles,
                          ray_scene *s) {
    slv_result result;
    s->nvertices = nvertices;
    s->ntriangles = ntriangles;
    if (ntriangles > INT32_MAX || nvertices > INT32_MAX)
        return slvi_fail(env, SLV_ERROR_LIMIT, "rays: %llu triangles, the most is %d",
                         (unsigned long long)ntriangles, INT32_MAX);
    if ((result =
             slvi_alloc(env, "rays: vertices", nvertices + 1, 3 * sizeof *s->points, &s->points)))
        return result;
    return slvi_alloc(env, "rays: triangles", ntriangles, 3 * sizeof *s->triangles, &s->triangles);
}

slv_result slvi_ray_scene_of_surface(const slv_env *env, const slv_tessellation *tessellation,
                                     const slv_progress *progress, ray_scene *out) {
    uint64_t nvertices = tessellation->first[tessellation->nfaces], ntriangles = 0;
    *out = (ray_scene){0};
    for (uint32_t face = 0; face < tessellation->nfaces; face++)
        ntriangles += slv_tessellation_indices(tessellation, face, NULL) / 3;
    slv_result result = reserve(env, nvertices, ntriangles, out);
    if (result)
        return result;
    for (uint64_t i = 0; i < nvertices; i++)
        memcpy(out->points + 3 * i, tessellation->vertices[i].position, 3 * sizeof *out->points);
    uint32_t *to = out->triangles;
    for (uint32_t face = 0; face < tessellation->nfaces; face++)
        to += slv_tessellation_indices(tessellation, face, to);
    return commit(env, progress, out);
}

/* A triangle's normal to each of its corners, by the angle there (Thürmer and Wüthrich 1998), so
 * that how polygons were cut does not show. */
static void add_normal(ray_scene *s, const uint32_t *triangle) {
    double at[3][3], across[3], length = 0;
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            at[c][k] = (double)s->points[3 * (size_t)triangle[c] + (size_t)k];
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        across[k] = (at[1][i] - at[0][i]) * (at[2][j] - at[0][j]) -
                    (at[1][j] - at[0][j]) * (at[2][i] - at[0][i]);
        length += across[k] * across[k];
    }
    length = sqrt(length);
    for (int c = 0; c < 3 && length > 0; c++) {
        double cosine = 0;
        for (int k = 0; k < 3; k++)
            cosine += (at[(c + 1) % 3][k] - at[c][k]) * (at[(c + 2) % 3][k] - at[c][k]);
        double angle = atan2(length, cosine);
        for (int k = 0; k < 3; k++)
            s->normals[3 * (size_t)triangle[c] + (size_t)k] += (float)(angle * across[k] / length);
    }
}

/* The mesh's own normal at a polygon's corner, if it has one. */
static void own_normal(const slv_mesh_view *view, size_t corner, float out[3]) {
    int32_t at = view->poly_normals[corner];
    for (int k = 0; at >= 0 && k < 3; k++)
        out[k] = view->normals[3 * (size_t)at + (size_t)k];
    if (at >= 0 && !(isfinite(out[0]) && isfinite(out[1]) && isfinite(out[2])))
        out[0] = out[1] = out[2] = 0;
}

slv_result slvi_ray_scene_of_polygons(const slv_env *env, const slv_mesh *mesh,
                                      const double origin[3], ray_scene *out) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    const slv_mesh_face *faces = slv_mesh_faces(mesh);
    uint32_t nfaces = slv_mesh_face_count(mesh);
    uint64_t ntriangles = 0;
    *out = (ray_scene){0};
    for (uint32_t poly = 0; poly < view->npolys; poly++)
        ntriangles += (uint64_t)view->poly_sizes[poly] - 2;
    slv_result result = reserve(env, view->nverts, ntriangles, out);
    if (result ||
        (result = slvi_alloc(env, "rays: normals", (uint64_t)view->nverts + 1,
                             3 * sizeof *out->normals, &out->normals)) ||
        (view->poly_normals && (result = slvi_alloc(env, "rays: normals", ntriangles + 1,
                                                    9 * sizeof(float), &out->own_normals))))
        return result;
    for (uint32_t i = 0; i < 3 * view->nverts; i++)
        out->points[i] = (float)((double)view->positions[i] + view->origin[i % 3] - origin[i % 3]);
    uint32_t *to = out->triangles, face = 0;
    const int32_t *verts = view->poly_verts;
    for (uint32_t poly = 0; poly < view->npolys; verts += view->poly_sizes[poly], poly++) {
        while (face < nfaces && faces[face].poly < (int32_t)poly)
            face++;
        if (face < nfaces && slv_mesh_face_is_hole(mesh, (int32_t)face))
            continue;
        for (int32_t k = 1; k + 1 < view->poly_sizes[poly]; k++, to += 3) {
            to[0] = (uint32_t)verts[0];
            to[1] = (uint32_t)verts[k];
            to[2] = (uint32_t)verts[k + 1];
            add_normal(out, to);
            for (int c = 0; out->own_normals && c < 3; c++)
                own_normal(view, (size_t)(verts - view->poly_verts) + (size_t)(c ? k + c - 1 : 0),
                           out->own_normals + 3 * (to - out->triangles) + 3 * c);
        }
    }
    out->ntriangles = (uint64_t)(to - out->triangles) / 3;
    return commit(env, NULL, out);
}

void slvi_ray_scene_free(ray_scene *scene) {
    embree_release(scene->device, scene->scene);
    slvi_free(scene->points);
    slvi_free(scene->normals);
    slvi_free(scene->own_normals);
    slvi_free(scene->triangles);
}

void slvi_rays_block(const ray_scene *scene, struct RTCRay *rays, uint32_t count) {
#if SLV_EMBREE_VERSION >= 4
    for (uint32_t i = 0; i < count; i++)
        rtcOccluded1(scene->scene, &rays[i], NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (uint32_t i = 0; i < count; i++)
        rtcOccluded1(scene->scene, &context, &rays[i]);
#endif
}

bool slvi_ray_is_blocked(const ray_scene *scene, const float origin[3], const float direction[3],
                         float distance) {
    struct RTCRay ray = embree_ray(origin, direction, distance);
    slvi_rays_block(scene, &ray, 1);
    return ray.tfar < 0;
}

float slvi_ray_cast(const ray_scene *scene, const float origin[3], const float direction[3],
                    float distance, uint32_t *triangle, float weights[2]) {
    struct RTCRay ray = embree_ray(origin, direction, distance);
    struct RTCHit hit;
    if (!embree_hit(scene->scene, &ray, &hit))
        return INFINITY;
    if (triangle)
        *triangle = hit.primID;
    if (weights) {
        weights[0] = hit.u;
        weights[1] = hit.v;
    }
    return ray.tfar;
}
