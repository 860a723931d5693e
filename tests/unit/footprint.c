/* Footprints from ray differentials are what the next ray's hit says: (u,v) of neighbouring rays on
 * a plane, found by solving for them. */
#include "kit/test.h"

#include <selvage/filter.h>

static float between(uint64_t *random, float low, float high) {
    return low + (high - low) * (float)(test_random(random) % 65536) / 65535;
}

static void random_vector(uint64_t *random, float size, float out[3]) {
    for (int c = 0; c < 3; c++)
        out[c] = between(random, -size, size);
}

static void cross(const float a[3], const float b[3], float out[3]) {
    for (int c = 0; c < 3; c++)
        out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static double dot(const float a[3], const float b[3]) {
    return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}

/* Where a ray meets the plane corner + u du + v dv, by Cramer's rule; returns the distance. */
static double meet(const float corner[3], const float du[3], const float dv[3],
                   const double origin[3], const double direction[3], double uv[2]) {
    float normal[3];
    double along = 0, away = 0, p[3], uu = dot(du, du), vv = dot(dv, dv), mixed = dot(du, dv);
    double u = 0, v = 0, det = uu * vv - mixed * mixed;
    cross(du, dv, normal);
    for (int c = 0; c < 3; c++) {
        along += direction[c] * (double)normal[c];
        away += ((double)corner[c] - origin[c]) * (double)normal[c];
    }
    for (int c = 0; c < 3; c++) {
        p[c] = origin[c] + away / along * direction[c] - (double)corner[c];
        u += p[c] * (double)du[c];
        v += p[c] * (double)dv[c];
    }
    uv[0] = (vv * u - mixed * v) / det;
    uv[1] = (uu * v - mixed * u) / det;
    return away / along;
}

/* `step`: how much of a sample the other rays are away. What is linear needs no small one. */
static void check_ray(uint64_t *random, bool perspective, double step) {
    float corner[3], du[3], dv[3], normal[3], target[3];
    slv_ray_differential ray = {0};
    slv_lookup lookup = {0};
    do {
        random_vector(random, 2, du);
        random_vector(random, 2, dv);
        random_vector(random, 5, corner);
        random_vector(random, 20, ray.origin);
        cross(du, dv, normal);
        float u = between(random, 0, 1), v = between(random, 0, 1);
        for (int c = 0; c < 3; c++) {
            target[c] = corner[c] + u * du[c] + v * dv[c];
            ray.direction[c] = (target[c] - ray.origin[c]) * 0.3f;
        }
        /* not edge-on, neither the plane nor its two directions */
    } while (fabs(dot(normal, ray.direction)) <
                 0.2 * sqrt(dot(normal, normal) * dot(ray.direction, ray.direction)) ||
             dot(normal, normal) < 0.1 * dot(du, du) * dot(dv, dv));
    random_vector(random, 0.01f, perspective ? ray.direction_dx : ray.origin_dx);
    random_vector(random, 0.01f, perspective ? ray.direction_dy : ray.origin_dy);
    slv_ray_differential at = ray;
    double hit[2], next[2][2], origin[3], direction[3];
    for (int c = 0; c < 3; c++) {
        origin[c] = (double)ray.origin[c];
        direction[c] = (double)ray.direction[c];
    }
    double distance = meet(corner, du, dv, origin, direction, hit);
    slv_ray_differential_transfer(&at, (float)distance, normal);
    for (int c = 0; c < 3; c++)
        CHECK(fabsf(at.origin[c] - target[c]) < 1e-4f);
    CHECK(slv_footprint_from_differentials(at.origin_dx, at.origin_dy, du, dv, &lookup));
    for (int i = 0; i < 2; i++) {
        for (int c = 0; c < 3; c++) {
            origin[c] =
                (double)ray.origin[c] + step * (double)(i ? ray.origin_dy : ray.origin_dx)[c];
            direction[c] = (double)ray.direction[c] +
                           step * (double)(i ? ray.direction_dy : ray.direction_dx)[c];
        }
        meet(corner, du, dv, origin, direction, next[i]);
    }
    double wanted[4] = {(next[0][0] - hit[0]) / step, (next[0][1] - hit[1]) / step,
                        (next[1][0] - hit[0]) / step, (next[1][1] - hit[1]) / step};
    float found[4] = {lookup.uw1, lookup.vw1, lookup.uw2, lookup.vw2};
    for (int i = 0; i < 4; i++)
        CHECK_MSG(fabs((double)found[i] - wanted[i]) < 2e-5 + 1e-3 * fabs(wanted[i]),
                  "%s: number %d is %g, and the next ray's hit says %g",
                  perspective ? "perspective" : "parallel", i, (double)found[i], wanted[i]);
}

static void check_degenerate(void) {
    const float x[3] = {1, 0, 0}, none[3] = {0, 0, 0}, odd[3] = {NAN, 0, 0}, y[3] = {0, 1, 0};
    const float far[3] = {3e38f, 3e38f, 0}, tiny[3] = {1e-30f, 0, 0};
    const float *wrong[][4] = {{x, y, x, x},   {x, y, none, y}, {x, y, none, none}, {odd, y, x, y},
                               {x, odd, x, y}, {x, y, odd, y},  {x, y, tiny, tiny}};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        slv_lookup lookup = {.face = 3, .u = 0.25f};
        CHECK(!slv_footprint_from_differentials(wrong[i][0], wrong[i][1], wrong[i][2], wrong[i][3],
                                                &lookup));
        CHECK(lookup.uw1 == 1 && lookup.vw1 == 0 && lookup.uw2 == 0 && lookup.vw2 == 1);
        CHECK(lookup.face == 3 && lookup.u == 0.25f);
    }
    slv_lookup lookup = {0};
    CHECK(slv_footprint_from_differentials(far, y, x, y, &lookup) && lookup.uw1 == 3e38f);
    slv_ray_differential along = {.direction = {1, 0, 0}, .direction_dx = {0, 1, 0}};
    slv_ray_differential_transfer(&along, 2, y);
    CHECK(along.origin[0] == 2 && along.origin_dx[1] == 2);
}

int main(void) {
    uint64_t random = 5;
    for (int i = 0; i < 2000; i++) {
        check_ray(&random, false, 1);
        check_ray(&random, true, 1e-4);
    }
    check_degenerate();
    return test_end();
}
