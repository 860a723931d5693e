/* Rays of a texel, step by step for many of them, so that compilers make several at a time of all
 * but the fetching of corners; compiled once for each kind of processor, by its name
 * SLVI_VARIANT_NAME. */
#include "rays/texel_rays.h"

#include <math.h>
#include <string.h>

#define JOIN(NAME, KIND) PASTE(NAME, KIND)
#define PASTE(NAME, KIND) NAME##_##KIND

typedef float batch[SLVI_TEXEL_RAYS];

/* Where rays begin: places on triangles of a face, and what is there. */
typedef struct places {
    uint32_t count;
    batch u, v;              /* of the face */
    batch b, c;              /* weights of a triangle's second and third corner */
    batch turn;              /* -1: its corners go round the other way */
    batch corners[3][6];     /* positions and normals */
    batch point[3], flat[3]; /* flat: the normal across the triangle, of length 1 */
    batch smooth[3];         /* the mean of its corners' */
} places;

static void find_corners(const slv_tessellation *t, uint32_t face, places *p) {
    const uint32_t n = t->segments[face];
    const slv_vertex *vertices = t->vertices + t->first[face];
    for (uint32_t i = 0; i < p->count; i++) {
        const float x = p->u[i] * (float)n, y = p->v[i] * (float)n;
        const uint32_t cx = (uint32_t)x < n ? (uint32_t)x : n - 1,
                       cy = (uint32_t)y < n ? (uint32_t)y : n - 1;
        const float fx = x - (float)cx, fy = y - (float)cy;
        const slv_vertex *a = vertices + (size_t)cy * (n + 1) + cx, *c = a + n + 2,
                         *b = fx > fy ? a + 1 : a + n + 1;
        const slv_vertex *corners[3] = {a, b, c};
        /* on the triangle a, c and the corner between them on this side of the diagonal */
        p->b[i] = fabsf(fx - fy);
        p->c[i] = fx < fy ? fx : fy;
        p->turn[i] = fx > fy ? 1.0f : -1.0f;
        for (int k = 0; k < 3; k++)
            for (int axis = 0; axis < 3; axis++) {
                p->corners[k][axis][i] = corners[k]->position[axis];
                p->corners[k][3 + axis][i] = corners[k]->normal[axis];
            }
    }
}

static void mix_corners(places *p) {
    for (int axis = 0; axis < 6; axis++) {
        const float *a = p->corners[0][axis], *b = p->corners[1][axis], *c = p->corners[2][axis];
        float *out = axis < 3 ? p->point[axis] : p->smooth[axis - 3];
        for (uint32_t i = 0; i < p->count; i++)
            out[i] = (1 - p->b[i] - p->c[i]) * a[i] + p->b[i] * b[i] + p->c[i] * c[i];
    }
}

/* What has no length is the other one. */
static void find_normals(places *p) {
    for (int axis = 0; axis < 3; axis++) {
        const int y = (axis + 1) % 3, z = (axis + 2) % 3;
        batch *a = p->corners[0], *b = p->corners[1], *c = p->corners[2];
        for (uint32_t i = 0; i < p->count; i++)
            p->flat[axis][i] = p->turn[i] * ((b[y][i] - a[y][i]) * (c[z][i] - a[z][i]) -
                                             (b[z][i] - a[z][i]) * (c[y][i] - a[y][i]));
    }
    for (uint32_t i = 0; i < p->count; i++) {
        const float fx = p->flat[0][i], fy = p->flat[1][i], fz = p->flat[2][i],
                    sx = p->smooth[0][i], sy = p->smooth[1][i], sz = p->smooth[2][i];
        const float across = sqrtf(fx * fx + fy * fy + fz * fz),
                    along = sqrtf(sx * sx + sy * sy + sz * sz),
                    by_across = across > 0 ? 1 / across : 0, by_along = along > 0 ? 1 / along : 0;
        p->flat[0][i] = across > 0 ? fx * by_across : sx * by_along;
        p->flat[1][i] = across > 0 ? fy * by_across : sy * by_along;
        p->flat[2][i] = across > 0 ? fz * by_across : sz * by_along;
        p->smooth[0][i] = along > 0 ? sx * by_along : fx * by_across;
        p->smooth[1][i] = along > 0 ? sy * by_along : fy * by_across;
        p->smooth[2][i] = along > 0 ? sz * by_along : fz * by_across;
    }
}

static void find_surface(const slv_tessellation *t, uint32_t face, places *p) {
    find_corners(t, face, p);
    mix_corners(p);
    find_normals(p);
}

/* Samples of a box, as slvi_reference_sample has them. */
static void find_samples(const reference_sampler *sampler, const reference_sequence *sequence,
                         uint32_t first, uint32_t count, float *x, float *y) {
    const uint32_t *second = sampler->sobol + first;
    for (uint32_t i = 0; i < count; i++)
        x[i] = reference_scramble(first + i, sequence->scramble[0]);
    for (uint32_t i = 0; i < count; i++)
        y[i] = reference_scramble(second[i], sequence->scramble[1]);
}

/* So in an order that has nothing to do with the others'. */
static void find_shuffled(const reference_sampler *sampler, const reference_sequence *sequence,
                          uint32_t first, uint32_t count, float *x, float *y) {
    const uint32_t seed = sequence->scramble[0] ^ sequence->scramble[1];
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t number = reference_shuffle(first + i, seed, sampler->mask);
        x[i] = reference_scramble(number, sequence->scramble[0]);
        y[i] = reference_scramble(sampler->sobol[number], sequence->scramble[1]);
    }
}

/* Of a share of a full turn; off by less than 3e-7. */
static inline void turn_by(float share, float *cosine, float *sine) {
    const float whole = (float)(int32_t)(4 * share + 0.5f),
                x = (share - 0.25f * whole) * 6.28318531f, z = x * x;
    const int32_t quarter = (int32_t)whole;
    const float s = x + x * z * (-1.6666655e-1f + z * (8.3321609e-3f + z * -1.9515296e-4f)),
                c = 1 - 0.5f * z +
                    z * z * (4.16666460e-2f + z * (-1.3887316e-3f + z * 2.4433157e-5f));
    const float up = quarter & 1 ? s : c, side = quarter & 1 ? c : s;
    *cosine = (quarter + 1) & 2 ? -up : up;
    *sine = quarter & 2 ? -side : side;
}

/* Two directions across a normal (Duff et al. 2017, "Building an Orthonormal Basis, Revisited"),
 * and of them, and it, one as likely as its cosine. */
static void find_directions(const places *p, float side, batch random[2], batch out[3]) {
    for (uint32_t i = 0; i < p->count; i++) {
        const float nx = side * p->smooth[0][i], ny = side * p->smooth[1][i],
                    nz = side * p->smooth[2][i];
        const float sign = copysignf(1.0f, nz), h = -1.0f / (sign + nz), q = nx * ny * h;
        const float radius = sqrtf(random[0][i]), z = sqrtf(1 - random[0][i]);
        float x, y;
        turn_by(random[1][i], &x, &y);
        x *= radius;
        y *= radius;
        out[0][i] = x * (1.0f + sign * nx * nx * h) + y * q + z * nx;
        out[1][i] = x * (sign * q) + y * (sign + ny * ny * h) + z * ny;
        out[2][i] = x * (-sign * nx) - y * ny + z * nz;
    }
}

void JOIN(slvi_texel_rays, SLVI_VARIANT_NAME)(const ray_ground *ground, const ray_texel *texel,
                                              uint32_t first, uint32_t count, struct RTCRay *out) {
    const uint32_t number = texel->y << texel->res.u | texel->x;
    const float du = 1 / (float)(1u << texel->res.u), dv = 1 / (float)(1u << texel->res.v),
                side = ground->inwards ? -1.0f : 1.0f;
    const reference_sequence place = slvi_reference_sequence_begin(ground->sampler, number,
                                                                   texel->face, 0),
                             way = slvi_reference_sequence_begin(ground->sampler, number,
                                                                 texel->face, 1);
    places p;
    batch random[2], direction[3];
    p.count = count;
    find_samples(ground->sampler, &place, first, count, p.u, p.v);
    find_shuffled(ground->sampler, &way, first, count, random[0], random[1]);
    for (uint32_t i = 0; i < count; i++) {
        p.u[i] = ((float)texel->x + p.u[i]) * du;
        p.v[i] = ((float)texel->y + p.v[i]) * dv;
    }
    find_surface(ground->tessellation, texel->face, &p);
    find_directions(&p, side, random, direction);
    for (int axis = 0; axis < 3; axis++)
        for (uint32_t i = 0; i < count; i++)
            p.point[axis][i] += side * ground->offset * p.flat[axis][i];
    for (uint32_t i = 0; i < count; i++)
        out[i] = embree_ray((const float[3]){p.point[0][i], p.point[1][i], p.point[2][i]},
                            (const float[3]){direction[0][i], direction[1][i], direction[2][i]},
                            ground->limit);
}
