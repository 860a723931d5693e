/* The tangents that triangles around a vertex share, and the frame at a place of a polygon. */
#include "uv/tangents_data.h"

#include "base/memory.h"

#include <string.h>

/* A corner of a triangle that belongs to a group. */
typedef struct member {
    uint32_t triangle, k;
} member;

static int corner_at(const slvi_tangents *t, const tangent_triangle *tri, uint32_t weld) {
    for (int k = 0; k < 3; k++)
        if (t->corners[tri->corners[k]].weld == weld)
            return k;
    return -1;
}

/* Adds a triangle around a vertex to a group that turns one way, if it can be one of it. */
static void add(const slvi_tangents *t, uint32_t at, uint32_t weld, bool keeps, member *members,
                uint32_t *count) {
    if (at == SLVI_TANGENT_NONE)
        return;
    tangent_triangle *tri = &t->triangles[at];
    const int k = corner_at(t, tri, weld);
    if (k < 0 || tri->grouped[k] || tri->dead)
        return;
    if (tri->any && !tri->grouped[0] && !tri->grouped[1] && !tri->grouped[2])
        tri->keeps = keeps;
    if (tri->keeps != keeps)
        return;
    tri->grouped[k] = true;
    members[(*count)++] = (member){at, (uint32_t)k};
}

/* The mean of what the triangles of a group have, at their vertex. */
static void share(slvi_tangents *t, const member *members, uint32_t count) {
    const tangent_triangle *first = &t->triangles[members[0].triangle];
    const float *n = t->corners[first->corners[members[0].k]].normal;
    float sum[3] = {0};
    for (uint32_t i = 0; i < count; i++) {
        const tangent_triangle *tri = &t->triangles[members[i].triangle];
        const uint32_t k = members[i].k;
        float own[3];
        if (tri->any)
            continue;
        memcpy(own, tri->tangent, sizeof own);
        slvi_tangent_project(n, own);
        const float weight = slvi_tangent_angle(t, tri->corners[(k + 2) % 3], tri->corners[k],
                                                tri->corners[(k + 1) % 3], n);
        for (int c = 0; c < 3; c++)
            sum[c] += weight * own[c];
    }
    slvi_normalise(sum);
    for (uint32_t i = 0; i < count; i++) {
        tangent_corner *to = &t->corners[t->triangles[members[i].triangle].corners[members[i].k]];
        for (int c = 0; c < 3; c++)
            to->tangent[c] += sum[c];
        to->sign = first->keeps ? 1 : -1;
    }
}

/* Corners that no group has take another's of their vertex, or else any tangent. */
static slv_result fill(const slv_env *env, slvi_tangents *t) {
    uint32_t *good = NULL;
    slv_result result = slvi_alloc(env, "tangents: vertices", t->ncorners, sizeof *good, &good);
    for (uint32_t i = 0; i < t->ncorners && !result; i++) {
        slvi_normalise(t->corners[i].tangent);
        if (slvi_dot(t->corners[i].tangent, t->corners[i].tangent) > 0)
            good[t->corners[i].weld] = i + 1;
    }
    for (uint32_t i = 0; i < t->ncorners && !result; i++) {
        tangent_corner *c = &t->corners[i];
        if (slvi_dot(c->tangent, c->tangent) > 0)
            continue;
        if (good[c->weld]) {
            memcpy(c->tangent, t->corners[good[c->weld] - 1].tangent, sizeof c->tangent);
            c->sign = t->corners[good[c->weld] - 1].sign;
            continue;
        }
        c->tangent[fabsf(c->normal[0]) < 0.9f ? 0 : 1] = 1;
        slvi_tangent_project(c->normal, c->tangent);
        c->sign = 1;
    }
    slvi_free(good);
    return result;
}

slv_result slvi_tangents_group(const slv_env *env, slvi_tangents *t) {
    member *members = NULL;
    slv_result result =
        slvi_alloc(env, "tangents: groups", 3 * (uint64_t)t->ntriangles, sizeof *members, &members);
    for (uint32_t i = 0; i < 3 * t->ntriangles && !result; i++) {
        const tangent_triangle *tri = &t->triangles[i / 3];
        const uint32_t weld = t->corners[tri->corners[i % 3]].weld;
        uint32_t count = 0;
        if (tri->any)
            continue;
        const bool keeps = tri->keeps;
        add(t, i / 3, weld, keeps, members, &count);
        for (uint32_t m = 0; m < count; m++) {
            const member at = members[m];
            const tangent_triangle *next = &t->triangles[at.triangle];
            add(t, next->across[at.k], weld, keeps, members, &count);
            add(t, next->across[(at.k + 2) % 3], weld, keeps, members, &count);
        }
        if (count)
            share(t, members, count);
    }
    slvi_free(members);
    return result ? result : fill(env, t);
}

/* The weights of a triangle's corners at a place in coordinates, beyond it too. */
static void weights_at(const slvi_tangents *t, const tangent_triangle *tri, const float place[2],
                       float weights[3]) {
    const float *p[3];
    for (int k = 0; k < 3; k++)
        p[k] = t->corners[tri->corners[k]].place;
    for (int k = 0; k < 3; k++) {
        const float *a = p[(k + 1) % 3], *b = p[(k + 2) % 3];
        weights[k] =
            ((a[0] - place[0]) * (b[1] - place[1]) - (a[1] - place[1]) * (b[0] - place[0])) /
            tri->twice_area;
    }
}

void slvi_tangents_turn(const slvi_tangents *t, int32_t poly, const float place[2],
                        float direction[3]) {
    const uint32_t from = t->first[poly], end = t->first[poly + 1];
    const tangent_triangle *in = &t->triangles[from];
    float best = -INFINITY, weights[3] = {1, 0, 0}, own[3], tangent[3] = {0}, normal[3] = {0};
    float sign = 0, sides[3][3], out[3];
    for (uint32_t i = from; i < end; i++) {
        const tangent_triangle *tri = &t->triangles[i];
        if (!(fabsf(tri->twice_area) > 0))
            continue;
        weights_at(t, tri, place, own);
        const float least = fminf(own[0], fminf(own[1], own[2]));
        if (least > best) {
            best = least;
            in = tri;
            memcpy(weights, own, sizeof weights);
        }
    }
    for (int k = 0; k < 3; k++) {
        const tangent_corner *c = &t->corners[in->corners[k]];
        for (int axis = 0; axis < 3; axis++) {
            tangent[axis] += weights[k] * c->tangent[axis];
            normal[axis] += weights[k] * c->normal[axis];
        }
        sign += weights[k] * c->sign;
    }
    float across[3];
    slvi_tangent_cross(normal, tangent, across);
    for (int axis = 0; axis < 3; axis++)
        across[axis] = sign < 0 ? -across[axis] : across[axis];
    /* the inverse of the three as columns; its determinant's sign is that of the frame */
    slvi_tangent_cross(across, normal, sides[0]);
    slvi_tangent_cross(normal, tangent, sides[1]);
    slvi_tangent_cross(tangent, across, sides[2]);
    const float turns = slvi_dot(tangent, sides[0]) < 0 ? -1.0f : 1.0f;
    for (int k = 0; k < 3; k++)
        out[k] = turns * slvi_dot(sides[k], direction);
    slvi_normalise(out);
    memcpy(direction, out, sizeof out);
}
