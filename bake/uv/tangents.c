/* The triangles and vertices that tangent frames are found from, in the order of a mesh's polygons.
 */
#include "uv/tangents_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* What welds corners: those that are alike in all of it are one vertex. */
typedef struct key {
    float value[8]; /* position, normal, coordinates */
    uint32_t corner;
} key;

typedef struct side {
    uint32_t low, high, triangle, edge;
} side;

/* ---- corners ---- */

/* Where the file has none: the mean of what meets at a vertex. */
static slv_result smooth_normals(const slv_env *env, const slv_mesh_view *view, slvi_tangents *t) {
    float *sums = NULL;
    slv_result result = slvi_alloc(env, "tangents: normals", view->nverts, 3 * sizeof *sums, &sums);
    uint32_t at = 0;
    for (uint32_t poly = 0; poly < view->npolys && !result; poly++) {
        const uint32_t n = (uint32_t)view->poly_sizes[poly];
        float normal[3] = {0}, a[3], b[3], c[3];
        for (uint32_t i = 1; i + 1 < n; i++) {
            slvi_tangent_subtract(slvi_tangent_position(t, at + i), slvi_tangent_position(t, at),
                                  a);
            slvi_tangent_subtract(slvi_tangent_position(t, at + i + 1),
                                  slvi_tangent_position(t, at), b);
            slvi_tangent_cross(a, b, c);
            for (int k = 0; k < 3; k++)
                normal[k] += c[k];
        }
        slvi_normalise(normal);
        for (uint32_t i = 0; i < n; i++) {
            const float weight =
                slvi_tangent_angle(t, at + (i + n - 1) % n, at + i, at + (i + 1) % n, NULL);
            for (int k = 0; k < 3; k++)
                sums[3 * (size_t)t->corners[at + i].vertex + (size_t)k] += weight * normal[k];
        }
        at += n;
    }
    for (uint32_t i = 0; i < t->ncorners && !result; i++) {
        const int32_t given = view->poly_normals ? view->poly_normals[i] : -1;
        memcpy(t->corners[i].normal,
               given >= 0 ? view->normals + 3 * (size_t)given
                          : sums + 3 * (size_t)t->corners[i].vertex,
               3 * sizeof(float));
        slvi_normalise(t->corners[i].normal);
    }
    slvi_free(sums);
    return result;
}

static int by_value(const void *a, const void *b) {
    const key *x = a, *y = b;
    for (int k = 0; k < 8; k++)
        if (x->value[k] != y->value[k])
            return x->value[k] < y->value[k] ? -1 : 1;
    return x->corner < y->corner ? -1 : 1;
}

static slv_result weld(const slv_env *env, slvi_tangents *t) {
    key *keys = NULL;
    slv_result result = slvi_alloc(env, "tangents: corners", t->ncorners, sizeof *keys, &keys);
    if (result)
        return result;
    for (uint32_t i = 0; i < t->ncorners; i++) {
        const tangent_corner *c = &t->corners[i];
        memcpy(keys[i].value, slvi_tangent_position(t, i), 3 * sizeof(float));
        memcpy(keys[i].value + 3, c->normal, 3 * sizeof(float));
        memcpy(keys[i].value + 6, c->place, 2 * sizeof(float));
        for (int k = 0; k < 8; k++) /* what is no number has no order */
            keys[i].value[k] = isnan(keys[i].value[k]) ? INFINITY : keys[i].value[k];
        keys[i].corner = i;
    }
    qsort(keys, t->ncorners, sizeof *keys, by_value);
    for (uint32_t i = 0; i < t->ncorners; i++) {
        bool same = i > 0;
        for (int k = 0; k < 8 && same; k++)
            same = keys[i].value[k] == keys[i - 1].value[k];
        t->corners[keys[i].corner].weld =
            same ? t->corners[keys[i - 1].corner].weld : keys[i].corner;
    }
    slvi_free(keys);
    return SLV_OK;
}

/* ---- triangles ---- */

static float square_apart(const float *a, const float *b, int count) {
    float sum = 0;
    for (int k = 0; k < count; k++)
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

/* Whether a quad is split between its corners 0 and 2. */
static bool splits_at_first(const slvi_tangents *t, uint32_t at) {
    const tangent_corner *c = t->corners + at;
    float even = square_apart(c[0].place, c[2].place, 2),
          odd = square_apart(c[1].place, c[3].place, 2);
    if (even == odd) {
        even = square_apart(slvi_tangent_position(t, at), slvi_tangent_position(t, at + 2), 3);
        odd = square_apart(slvi_tangent_position(t, at + 1), slvi_tangent_position(t, at + 3), 3);
    }
    return !(odd < even);
}

static void measure(const slvi_tangents *t, tangent_triangle *tri) {
    const tangent_corner *c[3];
    const float *p[3];
    float a[3], b[3];
    for (int k = 0; k < 3; k++) {
        c[k] = &t->corners[tri->corners[k]];
        p[k] = slvi_tangent_position(t, tri->corners[k]);
    }
    slvi_tangent_subtract(p[1], p[0], a);
    slvi_tangent_subtract(p[2], p[0], b);
    const float s1 = c[1]->place[0] - c[0]->place[0], t1 = c[1]->place[1] - c[0]->place[1],
                s2 = c[2]->place[0] - c[0]->place[0], t2 = c[2]->place[1] - c[0]->place[1];
    tri->twice_area = s1 * t2 - t1 * s2;
    tri->keeps = tri->twice_area > 0;
    tri->any = !(fabsf(tri->twice_area) > 0);
    tri->dead = isnan(tri->twice_area) || square_apart(p[0], p[1], 3) == 0 ||
                square_apart(p[1], p[2], 3) == 0 || square_apart(p[2], p[0], 3) == 0;
    for (int k = 0; k < 3; k++)
        tri->tangent[k] = (tri->keeps ? 1.0f : -1.0f) * (t2 * a[k] - t1 * b[k]);
    slvi_normalise(tri->tangent);
}

/* The halves of a quad turn the same way, that of the larger. */
static void agree(tangent_triangle *a, tangent_triangle *b) {
    if (a->dead || b->dead || a->keeps == b->keeps)
        return;
    const bool first = b->any || (!a->any && fabsf(a->twice_area) >= fabsf(b->twice_area));
    *(first ? &b->keeps : &a->keeps) = first ? a->keeps : b->keeps;
}

static void cut(slvi_tangents *t, const slv_mesh_view *view) {
    uint32_t at = 0, next = 0;
    for (uint32_t poly = 0; poly < view->npolys; poly++) {
        const uint32_t n = (uint32_t)view->poly_sizes[poly];
        const uint32_t from = n == 4 && !splits_at_first(t, at) ? 1 : 0;
        t->first[poly] = next;
        for (uint32_t i = 1; i + 1 < n; i++) {
            tangent_triangle *tri = &t->triangles[next++];
            *tri = (tangent_triangle){
                .corners = {at + from, at + (from + i) % n, at + (from + i + 1) % n},
                .across = {SLVI_TANGENT_NONE, SLVI_TANGENT_NONE, SLVI_TANGENT_NONE}};
            measure(t, tri);
        }
        if (n == 4)
            agree(&t->triangles[next - 2], &t->triangles[next - 1]);
        at += n;
    }
    t->first[view->npolys] = next;
}

static int by_ends(const void *a, const void *b) {
    const side *x = a, *y = b;
    if (x->low != y->low)
        return x->low < y->low ? -1 : 1;
    if (x->high != y->high)
        return x->high < y->high ? -1 : 1;
    if (x->triangle != y->triangle)
        return x->triangle < y->triangle ? -1 : 1;
    return x->edge < y->edge ? -1 : 1;
}

static uint32_t weld_of(const slvi_tangents *t, uint32_t tri, uint32_t k) {
    return t->corners[t->triangles[tri].corners[k % 3]].weld;
}

/* Pairs the sides that run between the same two vertices in opposite directions. */
static slv_result join(const slv_env *env, slvi_tangents *t) {
    side *sides = NULL;
    const uint32_t count = 3 * t->ntriangles;
    slv_result result = slvi_alloc(env, "tangents: edges", count, sizeof *sides, &sides);
    if (result)
        return result;
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t a = weld_of(t, i / 3, i % 3), b = weld_of(t, i / 3, i % 3 + 1);
        sides[i] = (side){a < b ? a : b, a < b ? b : a, i / 3, i % 3};
    }
    qsort(sides, count, sizeof *sides, by_ends);
    for (uint32_t i = 0; i < count; i++) {
        const side *a = &sides[i];
        if (t->triangles[a->triangle].across[a->edge] != SLVI_TANGENT_NONE || a->low == a->high)
            continue;
        for (uint32_t k = i + 1;
             k < count && k < i + 64 && sides[k].low == a->low && sides[k].high == a->high; k++) {
            const side *b = &sides[k];
            if (t->triangles[b->triangle].across[b->edge] != SLVI_TANGENT_NONE ||
                weld_of(t, a->triangle, a->edge) == weld_of(t, b->triangle, b->edge))
                continue;
            t->triangles[a->triangle].across[a->edge] = b->triangle;
            t->triangles[b->triangle].across[b->edge] = a->triangle;
            break;
        }
    }
    slvi_free(sides);
    return SLV_OK;
}

slv_result slvi_tangents_create(const slv_env *env, const slv_mesh *mesh, slvi_tangents **out) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    slvi_tangents *t = NULL;
    uint32_t at = 0;
    *out = NULL;
    slv_result result = slvi_alloc(env, "tangents", 1, sizeof *t, &t);
    if (result)
        return result;
    t->positions = view->positions;
    for (uint32_t poly = 0; poly < view->npolys; poly++) {
        t->ncorners += (uint32_t)view->poly_sizes[poly];
        t->ntriangles += (uint32_t)view->poly_sizes[poly] - 2;
    }
    if ((result =
             slvi_alloc(env, "tangents: corners", t->ncorners, sizeof *t->corners, &t->corners)) ||
        (result = slvi_alloc(env, "tangents: triangles", t->ntriangles, sizeof *t->triangles,
                             &t->triangles)) ||
        (result = slvi_alloc(env, "tangents: polygons", (uint64_t)view->npolys + 1,
                             sizeof *t->first, &t->first)))
        goto done;
    for (; at < t->ncorners; at++) {
        const int32_t place = view->poly_texcoords ? view->poly_texcoords[at] : -1;
        t->corners[at].vertex = (uint32_t)view->poly_verts[at];
        for (int k = 0; k < 2; k++)
            t->corners[at].place[k] =
                place >= 0 ? view->texcoords[2 * (size_t)place + (size_t)k] : NAN;
    }
    if ((result = smooth_normals(env, view, t)) || (result = weld(env, t)))
        goto done;
    cut(t, view);
    if ((result = join(env, t)) || (result = slvi_tangents_group(env, t)))
        goto done;
    *out = t;
    t = NULL;
done:
    slvi_tangents_destroy(t);
    return result;
}

void slvi_tangents_destroy(slvi_tangents *t) {
    if (!t)
        return;
    slvi_free(t->corners);
    slvi_free(t->triangles);
    slvi_free(t->first);
    slvi_free(t);
}
