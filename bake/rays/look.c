/* The nearest thing along a normal that faces the same way: rays pass through what does not. */
#include "rays/look.h"
#include "source/vectors.h"

#include <math.h>
#include <string.h>

static void flat_normal(const ray_scene *s, const uint32_t *corners, float out[3]) {
    double ab[3], ac[3], across[3], length = 0;
    for (int k = 0; k < 3; k++) {
        double a = (double)s->points[3 * (size_t)corners[0] + (size_t)k];
        ab[k] = (double)s->points[3 * (size_t)corners[1] + (size_t)k] - a;
        ac[k] = (double)s->points[3 * (size_t)corners[2] + (size_t)k] - a;
    }
    for (int k = 0; k < 3; k++) {
        across[k] = ab[(k + 1) % 3] * ac[(k + 2) % 3] - ab[(k + 2) % 3] * ac[(k + 1) % 3];
        length += across[k] * across[k];
    }
    for (int k = 0; k < 3; k++)
        out[k] = length > 0 ? (float)(across[k] / sqrt(length)) : 0;
}

void slvi_ray_normal(const ray_scene *s, uint32_t triangle, const float weights[2], float out[3]) {
    const uint32_t *corners = s->triangles + 3 * (size_t)triangle;
    float w[3] = {1 - weights[0] - weights[1], weights[0], weights[1]}, own[3];
    out[0] = out[1] = out[2] = 0;
    if (!s->normals) {
        flat_normal(s, corners, out);
        return;
    }
    for (int c = 0; c < 3; c++) {
        const float *given = s->own_normals ? s->own_normals + 9 * (size_t)triangle + 3 * c : NULL;
        if (!given || slvi_dot(given, given) <= 0)
            given = s->normals + 3 * (size_t)corners[c];
        memcpy(own, given, sizeof own);
        slvi_normalise(own);
        for (int k = 0; k < 3; k++)
            out[k] += w[c] * own[k];
    }
    slvi_normalise(out);
}

/* One way; a ray begins a little behind the surface. */
static void one_way(const ray_look *l, const float p[3], const float n[3], float sign, float reach,
                    ray_found *best) {
    float direction[3] = {sign * n[0], sign * n[1], sign * n[2]}, origin[3], normal[3];
    float step = 1e-6f * l->size, from = -step;
    for (int tries = 0; tries < 32; tries++) {
        uint32_t triangle;
        float weights[2];
        for (int k = 0; k < 3; k++)
            origin[k] = p[k] + from * direction[k];
        float distance =
            from + slvi_ray_cast(l->scene, origin, direction, reach - from, &triangle, weights);
        if (!(distance <= reach))
            return;
        slvi_ray_normal(l->scene, triangle, weights, normal);
        if (slvi_dot(normal, n) > 0) {
            if (!best->any || fabsf(distance) < fabsf(best->distance))
                *best = (ray_found){
                    sign * distance, triangle, {weights[0], weights[1]}, true, best->behind};
            return;
        }
        best->behind = true;
        from = fmaxf(distance, from) + step;
    }
}

slv_bake_miss slvi_ray_look(const ray_look *l, const float p[3], const float n[3], ray_found *out) {
    *out = (ray_found){0};
    one_way(l, p, n, 1, l->front, out);
    one_way(l, p, n, -1, out->any ? fminf(l->back, fabsf(out->distance)) : l->back, out);
    if (out->any)
        return SLV_BAKE_HIT;
    if (out->behind)
        return SLV_BAKE_BACK_FACING;
    float backwards[3] = {-n[0], -n[1], -n[2]};
    bool beyond = slvi_ray_is_blocked(l->scene, p, n, INFINITY) ||
                  slvi_ray_is_blocked(l->scene, p, backwards, INFINITY);
    return beyond ? SLV_BAKE_TOO_FAR : SLV_BAKE_NO_HIT;
}

slv_bake_miss slvi_ray_look_from(const ray_look *l, const float cage[3], const float point[3],
                                 ray_found *out) {
    float outwards[3], inwards[3], length;
    *out = (ray_found){0};
    for (int k = 0; k < 3; k++)
        outwards[k] = cage[k] - point[k];
    length = sqrtf(slvi_dot(outwards, outwards));
    if (!(length > 0))
        return SLV_BAKE_NO_HIT; /* the cage touches the surface: there is no way to look */
    for (int k = 0; k < 3; k++) {
        outwards[k] /= length;
        inwards[k] = -outwards[k];
    }
    one_way(l, cage, outwards, -1, length + l->back, out);
    out->distance += length;
    if (out->any)
        return SLV_BAKE_HIT;
    if (out->behind)
        return SLV_BAKE_BACK_FACING;
    return slvi_ray_is_blocked(l->scene, cage, inwards, INFINITY) ? SLV_BAKE_TOO_FAR
                                                                  : SLV_BAKE_NO_HIT;
}
