/* Footprints of lookups from what moves in space: ray differentials (Igehy 1999). */
#include <selvage/filter.h>

#include <math.h>

static double dot(const float a[3], const float b[3]) {
    return (double)a[0] * (double)b[0] + (double)a[1] * (double)b[1] + (double)a[2] * (double)b[2];
}

/* One of the two: P' = (O' + t D') - ((O' + t D').N / D.N) D, equations 10 and 12. */
static void transfer(float origin_d[3], const float direction_d[3], const float direction[3],
                     float distance, const float normal[3]) {
    float moved[3];
    double along = dot(direction, normal);
    for (int c = 0; c < 3; c++)
        moved[c] = origin_d[c] + distance * direction_d[c];
    double back = along != 0 ? dot(moved, normal) / along : 0;
    for (int c = 0; c < 3; c++)
        origin_d[c] = (float)((double)moved[c] - back * (double)direction[c]);
}

void slv_ray_differential_transfer(slv_ray_differential *ray, float distance,
                                   const float normal[3]) {
    transfer(ray->origin_dx, ray->direction_dx, ray->direction, distance, normal);
    transfer(ray->origin_dy, ray->direction_dy, ray->direction, distance, normal);
    for (int c = 0; c < 3; c++)
        ray->origin[c] += distance * ray->direction[c];
}

bool slv_footprint_from_differentials(const float dx[3], const float dy[3], const float du[3],
                                      const float dv[3], slv_lookup *lookup) {
    /* The normal equations of the least squares: two unknowns, three coordinates. */
    double uu = dot(du, du), uv = dot(du, dv), vv = dot(dv, dv), det = uu * vv - uv * uv;
    const float *moves[2] = {dx, dy};
    float out[2][2];
    bool sound = det > 1e-12 * uu * vv;
    for (int i = 0; i < 2 && sound; i++) {
        double u = dot(du, moves[i]), v = dot(dv, moves[i]);
        out[i][0] = (float)((vv * u - uv * v) / det);
        out[i][1] = (float)((uu * v - uv * u) / det);
        sound = isfinite(out[i][0]) && isfinite(out[i][1]);
    }
    lookup->uw1 = sound ? out[0][0] : 1;
    lookup->vw1 = sound ? out[0][1] : 0;
    lookup->uw2 = sound ? out[1][0] : 0;
    lookup->vw2 = sound ? out[1][1] : 1;
    return sound;
}
