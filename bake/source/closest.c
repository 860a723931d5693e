/* The closest point of a surface: a tree of boxes over its triangles. */
#include "source/closest.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { LEAF = 4, MAX_DEPTH = 64, SEGMENTS = 8, FLAT_SEGMENTS = 4 };
#define MOST_TRIED 4096 /* triangles, in a search for one that faces a certain way */
#define FAR_AWAY 1024.0 /* diagonals; from there on only the direction matters */

struct triangle {
    uint32_t face, cell; /* cell: 2 * (y * segments + x) + which half */
};

struct node {
    float low[3], high[3];
    uint32_t first, count; /* a leaf: triangles; else count is 0, `first` is the left child, the
                              right one follows it */
    uint32_t lowest_face;
    float axis[3], spread; /* all normals are within an angle of the axis, of which this is the
                              cosine; -1: any direction */
};

struct slv_closest {
    uint32_t nfaces, segments, ntriangles, nnodes;
    float *points; /* (segments + 1)^2 a face */
    struct triangle *triangles;
    struct node *nodes;
};

static const float *corner_of(const slv_closest *c, const struct triangle *t, unsigned corner,
                              float uv[2]) {
    uint32_t cell = t->cell / 2, side = c->segments + 1;
    bool upper = t->cell & 1;
    /* lower half: (0,0) (1,0) (1,1); upper half: (0,0) (1,1) (0,1) */
    uint32_t x = cell % c->segments + (upper ? corner == 1 : corner > 0);
    uint32_t y = cell / c->segments + (upper ? corner > 0 : corner == 2);
    uv[0] = (float)x / (float)c->segments;
    uv[1] = (float)y / (float)c->segments;
    return c->points + 3 * ((size_t)t->face * side * side + (size_t)y * side + x);
}

static void bound(const slv_closest *c, uint32_t first, uint32_t count, float low[3],
                  float high[3]) {
    for (int k = 0; k < 3; k++) {
        low[k] = FLT_MAX;
        high[k] = -FLT_MAX;
    }
    for (uint32_t i = first; i < first + count; i++)
        for (unsigned corner = 0; corner < 3; corner++) {
            float uv[2];
            const float *p = corner_of(c, &c->triangles[i], corner, uv);
            for (int k = 0; k < 3; k++) {
                low[k] = fminf(low[k], p[k]);
                high[k] = fmaxf(high[k], p[k]);
            }
        }
}

static float middle(const slv_closest *c, const struct triangle *t, int axis) {
    float sum = 0, uv[2];
    for (unsigned corner = 0; corner < 3; corner++)
        sum += corner_of(c, t, corner, uv)[axis];
    return sum;
}

static bool before(const slv_closest *c, const struct triangle *a, const struct triangle *b,
                   int axis) {
    float x = middle(c, a, axis), y = middle(c, b, axis);
    if (x != y)
        return x < y;
    return a->face != b->face ? a->face < b->face : a->cell < b->cell;
}

/* Puts the smaller half of first..end-1 before the larger one (Hoare's selection). */
static void split(slv_closest *c, uint32_t first, uint32_t end, uint32_t at, int axis) {
    int64_t low = first, high = (int64_t)end - 1;
    while (low < high) {
        struct triangle pivot = c->triangles[(low + high) / 2];
        int64_t i = low, j = high;
        while (i <= j) {
            while (before(c, &c->triangles[i], &pivot, axis))
                i++;
            while (before(c, &pivot, &c->triangles[j], axis))
                j--;
            if (i <= j) {
                struct triangle swap = c->triangles[i];
                c->triangles[i++] = c->triangles[j];
                c->triangles[j--] = swap;
            }
        }
        if ((int64_t)at <= j)
            high = j;
        else if ((int64_t)at >= i)
            low = i;
        else
            return;
    }
}

/* In double: squares of lengths that float holds need not fit in one. */
static void subtract(const float *a, const float *b, double *out) {
    for (int k = 0; k < 3; k++)
        out[k] = (double)a[k] - (double)b[k];
}
static double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static bool normalise(double *v) {
    double length = sqrt(dot(v, v));
    for (int k = 0; k < 3 && length > 0; k++)
        v[k] /= length;
    return length > 0 && isfinite(length);
}

/* Which way a triangle faces; false if it has no extent. */
static bool facing_of(const slv_closest *c, const struct triangle *t, double out[3]) {
    float uv[2];
    double ab[3], ac[3];
    const float *a = corner_of(c, t, 0, uv);
    subtract(corner_of(c, t, 1, uv), a, ab);
    subtract(corner_of(c, t, 2, uv), a, ac);
    if (!normalise(ab) || !normalise(ac))
        return false;
    out[0] = ab[1] * ac[2] - ab[2] * ac[1];
    out[1] = ab[2] * ac[0] - ab[0] * ac[2];
    out[2] = ab[0] * ac[1] - ab[1] * ac[0];
    return normalise(out);
}

static void find_spread(const slv_closest *c, uint32_t first, uint32_t count, struct node *node) {
    double axis[3] = {0}, facing[3], least = 1;
    node->spread = -1;
    for (uint32_t i = first; i < first + count; i++) {
        if (!facing_of(c, &c->triangles[i], facing))
            return;
        for (int k = 0; k < 3; k++)
            axis[k] += facing[k];
    }
    if (!normalise(axis))
        return;
    for (uint32_t i = first; i < first + count; i++)
        if (facing_of(c, &c->triangles[i], facing))
            least = fmin(least, dot(axis, facing));
    for (int k = 0; k < 3; k++)
        node->axis[k] = (float)axis[k];
    node->spread = (float)least;
}

/* Whether a triangle of a box may face the same way. */
static bool may_face(const struct node *node, const float *normal) {
    double length = sqrt((double)normal[0] * normal[0] + (double)normal[1] * normal[1] +
                         (double)normal[2] * normal[2]);
    double along = (double)node->axis[0] * normal[0] + (double)node->axis[1] * normal[1] +
                   (double)node->axis[2] * normal[2];
    double spread = (double)node->spread;
    return spread <= 0 || !(along < -(sqrt(1 - fmin(spread * spread, 1)) + 1e-3) * length);
}

static void build(slv_closest *c, uint32_t index, uint32_t first, uint32_t count) {
    struct node *node = &c->nodes[index];
    int axis = 0;
    bound(c, first, count, node->low, node->high);
    node->lowest_face = UINT32_MAX;
    for (uint32_t i = first; i < first + count; i++)
        if (c->triangles[i].face < node->lowest_face)
            node->lowest_face = c->triangles[i].face;
    node->first = first;
    node->count = count;
    find_spread(c, first, count, node);
    if (count <= LEAF)
        return;
    for (int k = 1; k < 3; k++)
        if (node->high[k] - node->low[k] > node->high[axis] - node->low[axis])
            axis = k;
    split(c, first, first + count, first + count / 2, axis);
    node->first = c->nnodes;
    node->count = 0;
    c->nnodes += 2;
    build(c, node->first, first, count / 2);
    build(c, node->first + 1, first + count / 2, count - count / 2);
}

struct sampling {
    const slv_surface *surface;
    slv_closest *closest;
};

static slv_result sample(void *user, uint64_t first, uint64_t end) {
    struct sampling *s = user;
    slv_closest *c = s->closest;
    size_t side = c->segments + 1;
    slv_result result = SLV_OK;
    for (uint64_t face = first; face < end && !result; face++) {
        slv_surface_arrays arrays = {.positions = c->points + 3 * face * side * side};
        result =
            slv_surface_evaluate_grid(s->surface, (int32_t)face, c->segments, c->segments, &arrays);
    }
    return result;
}

/* A surface that is one point but for rounding becomes one: otherwise all its boxes overlap. */
static void collapse(slv_closest *c) {
    size_t side = c->segments + 1, npoints = c->nfaces * side * side;
    float away = 0, largest = 0;
    for (size_t i = 0; i < 3 * npoints; i++) {
        away = fmaxf(away, fabsf(c->points[i] - c->points[i % 3]));
        largest = fmaxf(largest, fabsf(c->points[i]));
    }
    for (size_t i = 3; i < 3 * npoints && away <= 16 * FLT_EPSILON * largest; i++)
        c->points[i] = c->points[i % 3];
}

/* Flat sub-faces are two triangles each; flat polygons of scans may be many. */
uint32_t slvi_closest_segments(const slv_mesh *mesh, slv_scheme scheme) {
    const uint8_t *flags = slv_mesh_face_flags(mesh);
    bool quads = false;
    for (uint32_t face = 0; face < slv_mesh_face_count(mesh); face++)
        quads = quads || !(flags[face] & SLV_FACE_SUBFACE);
    return scheme != SLV_SCHEME_BILINEAR ? SEGMENTS : quads ? FLAT_SEGMENTS : 1;
}

slv_result slvi_closest_create(const slv_env *env, const slv_surface *surface, uint32_t segments,
                               slv_closest **out) {
    slv_closest *c = NULL;
    uint64_t nfaces = slv_surface_face_count(surface),
             ntriangles = nfaces * segments * segments * 2;
    *out = NULL;
    if (ntriangles > INT32_MAX)
        return slvi_fail(env, SLV_ERROR_LIMIT, "%llu triangles to search, the most is %d",
                         (unsigned long long)ntriangles, INT32_MAX);
    slv_result result = slvi_alloc(env, "surface search", 1, sizeof *c, &c);
    if (result)
        return result;
    *c = (slv_closest){.nfaces = (uint32_t)nfaces,
                       .segments = segments,
                       .ntriangles = (uint32_t)ntriangles,
                       .nnodes = 1};
    if ((result = slvi_alloc(env, "surface points", nfaces * (segments + 1) * (segments + 1),
                             3 * sizeof(float), &c->points)) ||
        (result = slvi_alloc(env, "triangles", ntriangles, sizeof *c->triangles, &c->triangles)) ||
        (result = slvi_alloc(env, "boxes", ntriangles + 1, sizeof *c->nodes, &c->nodes)))
        goto done;
    struct sampling sampling = {surface, c};
    if ((result = slvi_parallel_for(env, nfaces, 16, sample, &sampling)))
        goto done;
    collapse(c);
    for (uint32_t i = 0; i < c->ntriangles; i++)
        c->triangles[i] =
            (struct triangle){i / (segments * segments * 2), i % (segments * segments * 2)};
    build(c, 0, 0, c->ntriangles);
    *out = c;
    c = NULL;
done:
    slvi_closest_destroy(c);
    return result;
}

void slvi_closest_destroy(slv_closest *closest) {
    if (!closest)
        return;
    slvi_free(closest->points);
    slvi_free(closest->triangles);
    slvi_free(closest->nodes);
    slvi_free(closest);
}

float slvi_closest_diagonal(const slv_closest *closest) {
    const struct node *root = &closest->nodes[0];
    double size[3] = {0};
    if (closest->ntriangles)
        subtract(root->high, root->low, size);
    return (float)sqrt(dot(size, size));
}

/* The weights of b and c at the nearest point of a triangle (Ericson, Real-Time Collision
 * Detection, 5.1.5). */
static void nearest_weights(const double *p, const float *a, const float *b, const float *c,
                            double *wb, double *wc) {
    double ab[3], ac[3], ap[3], bp[3], cp[3];
    subtract(b, a, ab);
    subtract(c, a, ac);
    for (int k = 0; k < 3; k++) {
        ap[k] = p[k] - (double)a[k];
        bp[k] = p[k] - (double)b[k];
        cp[k] = p[k] - (double)c[k];
    }
    double d1 = dot(ab, ap), d2 = dot(ac, ap), d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp),
           d6 = dot(ac, cp);
    double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    *wb = *wc = 0;
    if (d1 <= 0 && d2 <= 0)
        return;
    if (d3 >= 0 && d4 <= d3)
        *wb = 1;
    else if (d6 >= 0 && d5 <= d6)
        *wc = 1;
    else if (vc <= 0 && d1 >= 0 && d3 <= 0)
        *wb = d1 - d3 > 0 ? d1 / (d1 - d3) : 0;
    else if (vb <= 0 && d2 >= 0 && d6 <= 0)
        *wc = d2 - d6 > 0 ? d2 / (d2 - d6) : 0;
    else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        double sum = d4 - d3 + d5 - d6;
        *wc = sum > 0 ? (d4 - d3) / sum : 0;
        *wb = 1 - *wc;
    } else if (va + vb + vc > 0) {
        *wb = vb / (va + vb + vc);
        *wc = vc / (va + vb + vc);
    }
}

struct search {
    const slv_closest *closest;
    double from[3], at[3], best; /* best: squared */
    const float *normal;
    uint32_t tried; /* triangles, with a normal */
    slv_surface_point point;
};

static void try_triangle(struct search *s, const struct triangle *t) {
    float uv[3][2];
    double wb, wc, ab[3], ac[3], at[3], away[3];
    const float *corners[3];
    for (unsigned k = 0; k < 3; k++)
        corners[k] = corner_of(s->closest, t, k, uv[k]);
    if (s->normal) {
        const double normal[3] = {(double)s->normal[0], (double)s->normal[1], (double)s->normal[2]};
        subtract(corners[1], corners[0], ab);
        subtract(corners[2], corners[0], ac);
        const double facing[3] = {ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2],
                                  ab[0] * ac[1] - ab[1] * ac[0]};
        if (dot(facing, normal) < 0)
            return;
    }
    nearest_weights(s->from, corners[0], corners[1], corners[2], &wb, &wc);
    for (int k = 0; k < 3; k++) {
        at[k] = (double)corners[0][k] * (1 - wb - wc) + (double)corners[1][k] * wb +
                (double)corners[2][k] * wc;
        away[k] = at[k] - s->from[k];
    }
    double distance = dot(away, away);
    if (distance > s->best ||
        (distance == s->best && s->point.face >= 0 && s->point.face <= (int32_t)t->face))
        return;
    s->best = distance;
    memcpy(s->at, at, sizeof at);
    s->point = (slv_surface_point){
        (int32_t)t->face,
        (float)((double)uv[0][0] * (1 - wb - wc) + (double)uv[1][0] * wb + (double)uv[2][0] * wc),
        (float)((double)uv[0][1] * (1 - wb - wc) + (double)uv[1][1] * wb + (double)uv[2][1] * wc)};
}

static double box_distance(const struct node *node, const double *p) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double below = (double)node->low[k] - p[k], above = p[k] - (double)node->high[k];
        double outside = below > above ? below : above;
        sum += outside > 0 ? outside * outside : 0;
    }
    return sum;
}

/* Seen from very far all boxes are equally near as far as numbers can tell, and none would be left
 * out: the search begins nearer, in the same direction. */
static void begin_near(struct search *s, const float position[3]) {
    const struct node *root = &s->closest->nodes[0];
    double centre[3], away[3], size[3];
    subtract(root->high, root->low, size);
    for (int k = 0; k < 3; k++) {
        centre[k] = 0.5 * ((double)root->low[k] + (double)root->high[k]);
        away[k] = (double)position[k] - centre[k];
    }
    double distance = sqrt(dot(away, away)), most = FAR_AWAY * sqrt(dot(size, size));
    double scale = distance > most ? most / distance : 1;
    for (int k = 0; k < 3; k++)
        s->from[k] = scale < 1 ? centre[k] + scale * away[k] : (double)position[k];
}

slv_closest_hit slvi_closest_find(const slv_closest *closest, const float position[3],
                                  const float *normal, float within) {
    struct search s = {.closest = closest,
                       .best = (double)within * (double)within,
                       .normal = normal,
                       .point = {-1, 0, 0}};
    uint32_t stack[2 * MAX_DEPTH], depth = 0;
    if (!closest->ntriangles || !isfinite(position[0]) || !isfinite(position[1]) ||
        !isfinite(position[2]))
        return (slv_closest_hit){{-1, 0, 0}, INFINITY, {0}};
    begin_near(&s, position);
    stack[depth++] = 0;
    while (depth) {
        const struct node *node = &closest->nodes[stack[--depth]];
        double distance = box_distance(node, s.from);
        if (distance > s.best ||
            (distance == s.best && s.point.face >= 0 &&
             s.point.face <= (int32_t)node->lowest_face) ||
            (normal && !may_face(node, normal)))
            continue;
        if (normal && (s.tried += node->count) > MOST_TRIED)
            break;
        if (node->count) {
            for (uint32_t i = node->first; i < node->first + node->count; i++)
                try_triangle(&s, &closest->triangles[i]);
            continue;
        }
        bool left_first = box_distance(&closest->nodes[node->first], s.from) <=
                          box_distance(&closest->nodes[node->first + 1], s.from);
        stack[depth++] = node->first + left_first;
        stack[depth++] = node->first + !left_first;
    }
    if (s.point.face < 0)
        return (slv_closest_hit){s.point, INFINITY, {0}};
    const double away[3] = {s.at[0] - (double)position[0], s.at[1] - (double)position[1],
                            s.at[2] - (double)position[2]};
    return (slv_closest_hit){
        s.point, (float)sqrt(dot(away, away)), {(float)s.at[0], (float)s.at[1], (float)s.at[2]}};
}
