/* Triangles as faces: three sub-faces each, as any polygon but a quad is. */
#include "adjacency/triangle.h"

#include "base/log.h"
#include "base/memory.h"

#include <math.h>

void slv_triangle_from_subface(unsigned sub, float s, float t, float *u, float *v) {
    float weights[3], next = s * (3 - t) / 6, before = t * (3 - s) / 6;
    weights[sub % 3] = 1 - next - before;
    weights[(sub + 1) % 3] = next;
    weights[(sub + 2) % 3] = before;
    *u = weights[1];
    *v = weights[2];
}

unsigned slv_triangle_to_subface(float u, float v, float *s, float *t) {
    const float weights[3] = {1 - u - v, u, v};
    unsigned sub = weights[1] > weights[0] ? 1 : 0;
    sub = weights[2] > weights[sub] ? 2 : sub;
    float before = weights[(sub + 2) % 3], d = 2 * (weights[(sub + 1) % 3] - before);
    float root = sqrtf(fmaxf((3 - d) * (3 - d) - 24 * before, 0));
    *t = fminf(fmaxf((3 - d - root) / 2, 0), 1);
    *s = fminf(fmaxf(*t + d, 0), 1);
    return sub;
}

bool slvi_triangle_across(const slv_adjacency *subfaces, int32_t triangle, unsigned edge,
                          int32_t *to, unsigned *to_edge) {
    const slv_face_adjacency *first = slv_adjacency_faces(subfaces) + 3 * (size_t)triangle + edge;
    if (first->face[0] == SLV_BOUNDARY)
        return false;
    *to = first->face[0] / 3;
    *to_edge = ((unsigned)(first->face[0] % 3) + 2) % 3;
    return true;
}

slv_face_adjacency slvi_triangle_record(const slv_adjacency *subfaces, int32_t triangle) {
    slv_face_adjacency record = {{SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY, SLV_BOUNDARY}, {0}};
    for (unsigned edge = 0; edge < 3; edge++) {
        int32_t to;
        unsigned to_edge;
        if (!slvi_triangle_across(subfaces, triangle, edge, &to, &to_edge))
            continue;
        record.face[edge] = to;
        record.edge[edge] = (uint8_t)to_edge;
    }
    return record;
}

static void link_to(slv_face_adjacency *faces, uint32_t face, unsigned edge, uint32_t to,
                    uint8_t to_edge) {
    faces[face].face[edge] = (int32_t)to;
    faces[face].edge[edge] = to_edge;
}

static slv_result create(const slv_env *env, uint32_t ntriangles,
                         const slv_face_adjacency *triangles, slv_adjacency **out) {
    slv_face_adjacency *faces = NULL;
    uint8_t *flags = NULL;
    slv_result result;
    *out = NULL;
    if (ntriangles && !triangles)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "adjacency: no face records");
    if (ntriangles > INT32_MAX / 12)
        return slvi_fail(env, SLV_ERROR_LIMIT, "adjacency: %u triangles, at most %d are possible",
                         ntriangles, INT32_MAX / 12);
    if ((result = slvi_alloc(env, "adjacency", 3 * (uint64_t)ntriangles, sizeof *faces, &faces)) ||
        (result = slvi_alloc(env, "adjacency", 3 * (uint64_t)ntriangles, 1, &flags)))
        goto done;
    for (uint32_t f = 0; f < ntriangles; f++)
        for (unsigned e = 0; e < 3; e++) {
            uint32_t near = 3 * f + e, far = 3 * f + (e + 1) % 3;
            int32_t to = triangles[f].face[e];
            unsigned to_edge = triangles[f].edge[e] % 3;
            flags[near] = SLV_FACE_SUBFACE;
            link_to(faces, near, 1, far, 2);
            link_to(faces, far, 2, near, 1);
            faces[near].face[0] = faces[far].face[3] = SLV_BOUNDARY;
            /* edges run in opposite directions, so the first half of one meets the other's last */
            if (to >= 0 && (uint32_t)to < ntriangles) {
                link_to(faces, near, 0, 3 * (uint32_t)to + (to_edge + 1) % 3, 3);
                link_to(faces, far, 3, 3 * (uint32_t)to + to_edge, 0);
            }
        }
    result = slv_adjacency_create(env, 3 * ntriangles, faces, flags, out);
done:
    slvi_free(faces);
    slvi_free(flags);
    return result;
}

slv_result slv_adjacency_create_triangles(const slv_env *env, uint32_t ntriangles,
                                          const slv_face_adjacency *triangles,
                                          slv_adjacency **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, create(&own, ntriangles, triangles, out));
}
