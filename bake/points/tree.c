/* A tree of points without pointers (Bentley 1975): a range has its median, along the axis in which
 * it is widest, in its middle, smaller ones before it and larger ones behind. */
#include "points/tree.h"

#include "base/memory.h"

#include <selvage/texture.h>

#include <float.h>
#include <math.h>
#include <string.h>

enum { LEAF = 8 };

static void swap_points(point_tree *t, int64_t a, int64_t b) {
    float position[3], color[4];
    memcpy(position, t->positions + 3 * a, sizeof position);
    memcpy(color, t->colors + 4 * a, sizeof color);
    memcpy(t->positions + 3 * a, t->positions + 3 * b, sizeof position);
    memcpy(t->colors + 4 * a, t->colors + 4 * b, sizeof color);
    memcpy(t->positions + 3 * b, position, sizeof position);
    memcpy(t->colors + 4 * b, color, sizeof color);
}

/* Puts the smaller ones of first..end-1 before `at`, and the larger ones behind (Hoare's
 * selection). */
static void split(point_tree *t, int64_t first, int64_t end, int64_t at, int axis) {
    int64_t low = first, high = end - 1;
    while (low < high) {
        float pivot = t->positions[3 * ((low + high) / 2) + axis];
        int64_t i = low, j = high;
        while (i <= j) {
            while (t->positions[3 * i + axis] < pivot)
                i++;
            while (pivot < t->positions[3 * j + axis])
                j--;
            if (i <= j)
                swap_points(t, i++, j--);
        }
        if (at <= j)
            high = j;
        else if (at >= i)
            low = i;
        else
            return;
    }
}

static void bound(const point_tree *t, int64_t first, int64_t end, float low[3], float high[3]) {
    for (int k = 0; k < 3; k++) {
        low[k] = FLT_MAX;
        high[k] = -FLT_MAX;
        for (int64_t i = first; i < end; i++) {
            low[k] = fminf(low[k], t->positions[3 * i + k]);
            high[k] = fmaxf(high[k], t->positions[3 * i + k]);
        }
    }
}

/* Recursive, as deep as a range can be halved. */
static void build(point_tree *t, int64_t first, int64_t end) {
    float low[3], high[3];
    int axis = 0;
    if (end - first <= LEAF)
        return;
    bound(t, first, end, low, high);
    for (int k = 1; k < 3; k++)
        if (high[k] - low[k] > high[axis] - low[axis])
            axis = k;
    int64_t middle = first + (end - first) / 2;
    split(t, first, end, middle, axis);
    t->axes[middle] = (uint8_t)axis;
    build(t, first, middle);
    build(t, middle + 1, end);
}

slv_result slvi_point_tree_create(const slv_env *env, const slv_mesh *points,
                                  const double origin[3], bool srgb, point_tree *out) {
    const slv_mesh_view *view = slv_mesh_get_view(points);
    slv_result result;
    *out = (point_tree){0};
    if ((result = slvi_alloc(env, "points", view->nverts, 3 * sizeof(float), &out->positions)) ||
        (result = slvi_alloc(env, "points", view->nverts, 4 * sizeof(float), &out->colors)) ||
        (result = slvi_alloc(env, "points", view->nverts, 1, &out->axes)))
        return result;
    for (size_t i = 0; i < view->nverts; i++) {
        float *position = out->positions + 3 * (size_t)out->count,
              *color = out->colors + 4 * (size_t)out->count;
        memcpy(color, view->colors + 4 * i, 4 * sizeof *color);
        if (!isfinite(color[0] + color[1] + color[2] + color[3]))
            continue;
        if (srgb)
            slv_texels_decode(4, 3, color, 1);
        for (size_t k = 0; k < 3; k++) {
            color[k] *= color[3];
            position[k] = (float)((double)view->positions[3 * i + k] + view->origin[k] - origin[k]);
        }
        out->count++;
    }
    bound(out, 0, out->count, out->low, out->high);
    build(out, 0, out->count);
    return SLV_OK;
}

void slvi_point_tree_free(point_tree *tree) {
    slvi_free(tree->positions);
    slvi_free(tree->colors);
    slvi_free(tree->axes);
}

/* A search: of the nearest, or of all within `best`, which is squared. */
typedef struct search {
    const point_tree *tree;
    const float *at;
    uint32_t wanted, found;
    double best, nearest[POINT_NEAREST]; /* ascending */
    double weights, *sum;                /* NULL: the nearest */
} search;

static void try_point(search *s, int64_t i) {
    double squared = 0;
    for (int k = 0; k < 3; k++) {
        double away = (double)s->tree->positions[3 * i + k] - (double)s->at[k];
        squared += away * away;
    }
    if (squared > s->best)
        return;
    if (s->sum) {
        double weight = s->best > 0 ? 1 - squared / s->best : 0;
        weight *= weight;
        s->weights += weight;
        for (int c = 0; c < 4; c++)
            s->sum[c] += weight * (double)s->tree->colors[4 * i + c];
        return;
    }
    uint32_t to = s->found < s->wanted ? s->found++ : s->wanted - 1;
    for (; to && s->nearest[to - 1] > squared; to--)
        s->nearest[to] = s->nearest[to - 1];
    s->nearest[to] = squared;
    if (s->found == s->wanted)
        s->best = s->nearest[s->wanted - 1];
}

/* Recursive, as deep as `build`. */
static void visit(search *s, int64_t first, int64_t end) {
    if (end - first <= LEAF) {
        for (int64_t i = first; i < end; i++)
            try_point(s, i);
        return;
    }
    int64_t middle = first + (end - first) / 2;
    int axis = s->tree->axes[middle];
    double away = (double)s->at[axis] - (double)s->tree->positions[3 * middle + axis];
    bool left = away < 0;
    visit(s, left ? first : middle + 1, left ? middle : end);
    if (away * away > s->best)
        return;
    try_point(s, middle);
    visit(s, left ? middle + 1 : first, left ? end : middle);
}

uint32_t slvi_point_tree_nearest(const point_tree *tree, const float at[3], uint32_t wanted,
                                 float within, float *distance) {
    search s = {.tree = tree,
                .at = at,
                .wanted = wanted < POINT_NEAREST ? wanted : POINT_NEAREST,
                .best = (double)within * (double)within};
    visit(&s, 0, tree->count);
    *distance = s.found ? (float)sqrt(s.nearest[s.found - 1]) : INFINITY;
    return s.found;
}

double slvi_point_tree_gather(const point_tree *tree, const float at[3], float radius,
                              double sum[4]) {
    search s = {.tree = tree, .at = at, .best = (double)radius * (double)radius, .sum = sum};
    visit(&s, 0, tree->count);
    return s.weights;
}
