/* Charts and the values at their vertices as a graph of whole numbers: each polygon is as far from
 * its chart's first as sums along the way say, and where two ways differ the map goes round. */
#include "mesh/wrap/round.h"

#include <string.h>

/* The first of those that are joined, with the sum of the way there. */
static int32_t find(slvi_wrap_node *nodes, int32_t node, uint32_t sum[2]) {
    int32_t root = node;
    sum[0] = sum[1] = 0;
    for (; nodes[root].parent != root; root = nodes[root].parent) {
        sum[0] += nodes[root].shift[0];
        sum[1] += nodes[root].shift[1];
    }
    uint32_t rest[2] = {sum[0], sum[1]};
    while (nodes[node].parent != root && node != root) {
        slvi_wrap_node *n = &nodes[node];
        int32_t next = n->parent;
        for (int axis = 0; axis < 2; axis++) {
            uint32_t step = n->shift[axis];
            n->shift[axis] = rest[axis];
            rest[axis] -= step;
        }
        n->parent = root;
        node = next;
    }
    return root;
}

void slvi_wrap_find_round(const slvi_weld *w, slvi_wrap_values *c, slvi_wrap_node *nodes) {
    uint32_t s = 0;
    for (uint32_t i = 0; i < w->npolys + c->count; i++)
        nodes[i] = (slvi_wrap_node){(int32_t)i, {0, 0}};
    c->round[0] = c->round[1] = false;
    for (uint32_t p = 0; p < w->npolys; p++)
        for (uint32_t end = s + (uint32_t)w->sizes[p]; s < end; s++) {
            const float *at = c->at + 2 * (size_t)s;
            uint32_t from[2], to[2], apart[2];
            if (c->index[s] < 0 || slvi_wrap_is_far(at))
                continue;
            int32_t a = find(nodes, (int32_t)p, from),
                    b = find(nodes, (int32_t)w->npolys + c->index[s], to);
            for (int axis = 0; axis < 2; axis++) {
                float whole = rintf(at[axis] - c->values[2 * c->index[s] + axis]);
                apart[axis] = (uint32_t)(int32_t)whole + to[axis] - from[axis];
                if (a == b)
                    c->round[axis] |= apart[axis] != 0;
                else
                    nodes[a].shift[axis] = apart[axis];
            }
            nodes[a].parent = b;
        }
}

/* Along which axis two values are apart, by what is no whole number, and not along the other; -1 if
 * not so. */
static int end_axis(const slvi_wrap_values *c, int32_t i, int32_t j, float *apart) {
    int axis = -1;
    for (int k = 0; k < 2; k++) {
        float d = fabsf(c->values[2 * i + k] - c->values[2 * j + k]);
        if (d < SLVI_WRAP_SAME)
            continue;
        if (axis >= 0 || c->round[k] || fabsf(slv_wrap_step(0, d)) < SLVI_WRAP_SAME)
            return -1;
        axis = k;
        *apart = d;
    }
    return axis;
}

void slvi_wrap_find_ends(const slvi_weld *w, const slvi_wrap_values *c, slvi_wrap_node *nodes,
                         const int32_t *poly_from, int32_t *user, slv_wrap_report *report) {
    uint32_t s = 0, sum[2];
    for (uint32_t p = 0; p < w->npolys; p++)
        for (uint32_t end = s + (uint32_t)w->sizes[p]; s < end; s++)
            if (c->index[s] >= 0)
                user[c->index[s]] = (int32_t)p;
    for (uint32_t v = 0; v < w->nverts; v++) {
        int32_t i = c->head[v], j = i >= 0 ? c->next[i] : -1;
        float apart = 0;
        if (j < 0 || c->next[j] >= 0)
            continue;
        int axis = end_axis(c, i, j, &apart);
        if (axis < 0 || slvi_wrap_is_far(c->values + 2 * (size_t)i) ||
            slvi_wrap_is_far(c->values + 2 * (size_t)j) ||
            find(nodes, user[i], sum) != find(nodes, user[j], sum))
            continue;
        if (!report->nends) {
            report->first_end = (int32_t)v;
            report->end_poly = poly_from[user[i]];
            report->end_axis = axis;
            report->end_apart = apart;
        }
        report->nends += axis == report->end_axis && fabsf(apart - report->end_apart) < 1e-3f;
    }
    if (report->nends < 2) /* a map ends along an edge */
        report->nends = 0;
}
