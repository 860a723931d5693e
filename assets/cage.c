/* Points and quads of the cage, and the patches of quads that parts of the scene are made of. */
#include "cage.h"

#include <math.h>
#include <string.h>

int cage_add_point(struct cage *cage, point p) {
    if (cage->npoints == CAGE_MAX) {
        cage->full = true;
        return 0;
    }
    cage->points[cage->npoints] = p;
    return cage->npoints++;
}

int cage_add_quad(struct cage *cage, int a, int b, int c, int d) {
    if (cage->nquads == CAGE_MAX) {
        cage->full = true;
        return 0;
    }
    int32_t *quad = cage->quads[cage->nquads];
    quad[0] = a;
    quad[1] = b;
    quad[2] = c;
    quad[3] = d;
    return cage->nquads++;
}

static int patch_find(const struct patch *patch, int vertex) {
    for (int i = 0; i < patch->npoints; i++)
        if (patch->points[i] == vertex)
            return i;
    return -1;
}

struct patch patch_of(const struct cage *cage, const int *faces, int nfaces) {
    struct patch made = {.nfaces = nfaces < CAGE_MAX_PATCH ? nfaces : CAGE_MAX_PATCH};
    for (int i = 0; i < made.nfaces; i++) {
        made.faces[i] = faces[i];
        for (int k = 0; k < 4; k++) {
            int vertex = cage->quads[faces[i]][k];
            if (patch_find(&made, vertex) < 0)
                made.points[made.npoints++] = vertex;
        }
    }
    return made;
}

static void stretch_to_unit(float *values, int count) {
    float low = values[0], high = values[0];
    for (int i = 1; i < count; i++) {
        low = fminf(low, values[i]);
        high = fmaxf(high, values[i]);
    }
    for (int i = 0; i < count; i++)
        values[i] = high > low ? 2 * (values[i] - low) / (high - low) - 1 : 0;
}

void patch_measure(const struct cage *cage, struct patch *patch, point across, point up) {
    for (int i = 0; i < patch->npoints; i++) {
        patch->a[i] = point_dot(cage->points[patch->points[i]], across);
        patch->b[i] = point_dot(cage->points[patch->points[i]], up);
    }
    stretch_to_unit(patch->a, patch->npoints);
    stretch_to_unit(patch->b, patch->npoints);
}

void patch_place(struct cage *cage, const struct patch *patch, const section *where) {
    for (int i = 0; i < patch->npoints; i++) {
        point offset =
            point_add(point_scale(where->across, patch->a[i]), point_scale(where->up, patch->b[i]));
        cage->points[patch->points[i]] = point_add(where->centre, offset);
    }
}

void patch_shift(struct cage *cage, const struct patch *patch, point by, float scale) {
    point middle = {0, 0, 0};
    for (int i = 0; i < patch->npoints; i++)
        middle = point_add(middle, cage->points[patch->points[i]]);
    middle = point_scale(middle, 1 / (float)patch->npoints);
    for (int i = 0; i < patch->npoints; i++) {
        point *p = &cage->points[patch->points[i]];
        *p = point_add(point_add(middle, by), point_scale(point_sub(*p, middle), scale));
    }
}

/* True if the patch has a face with the edge from `to` to `from`, so that the edge is inside it. */
static bool patch_has_edge(const struct cage *cage, const struct patch *patch, int from, int to) {
    for (int i = 0; i < patch->nfaces; i++)
        for (int k = 0; k < 4; k++) {
            const int32_t *quad = cage->quads[patch->faces[i]];
            if (quad[k] == from && quad[(k + 1) % 4] == to)
                return true;
        }
    return false;
}

void patch_extrude(struct cage *cage, struct patch *patch) {
    struct {
        int from, to;
    } rim[4 * CAGE_MAX_PATCH];
    int nrim = 0;
    for (int i = 0; i < patch->nfaces; i++)
        for (int k = 0; k < 4; k++) {
            const int32_t *quad = cage->quads[patch->faces[i]];
            int from = quad[k], to = quad[(k + 1) % 4];
            if (!patch_has_edge(cage, patch, to, from)) {
                rim[nrim].from = from;
                rim[nrim++].to = to;
            }
        }
    /* Walk the rim in order, so that side number i of each extrusion lies on side i of the one
     * before. */
    for (int i = 1; i < nrim; i++)
        for (int k = i; k < nrim; k++)
            if (rim[k].from == rim[i - 1].to) {
                int from = rim[k].from, to = rim[k].to;
                rim[k] = rim[i];
                rim[i].from = from;
                rim[i].to = to;
                break;
            }

    int twin[4 * CAGE_MAX_PATCH];
    for (int i = 0; i < patch->npoints; i++) {
        bool on_rim = false;
        for (int k = 0; k < nrim; k++)
            on_rim = on_rim || rim[k].from == patch->points[i];
        twin[i] = on_rim ? cage_add_point(cage, cage->points[patch->points[i]]) : patch->points[i];
    }
    for (int i = 0; i < patch->nfaces; i++)
        for (int k = 0; k < 4; k++) {
            int32_t *corner = &cage->quads[patch->faces[i]][k];
            *corner = twin[patch_find(patch, *corner)];
        }
    patch->first_side = cage->nquads;
    patch->nsides = nrim;
    for (int k = 0; k < nrim; k++)
        cage_add_quad(cage, rim[k].from, rim[k].to, twin[patch_find(patch, rim[k].to)],
                      twin[patch_find(patch, rim[k].from)]);
    memcpy(patch->points, twin, (size_t)patch->npoints * sizeof *twin);
}

void patch_extrude_to(struct cage *cage, struct patch *patch, const section *where) {
    patch_extrude(cage, patch);
    patch_place(cage, patch, where);
}

int patch_side(const struct patch *patch, const struct cage *cage, float a, float b) {
    int best = patch->first_side;
    float nearest = INFINITY;
    for (int side = patch->first_side; side < patch->first_side + patch->nsides; side++) {
        /* Corners 2 and 3 are the ones that the patch still has. */
        int i = patch_find(patch, cage->quads[side][2]),
            k = patch_find(patch, cage->quads[side][3]);
        if (i < 0 || k < 0)
            continue;
        float da = 0.5f * (patch->a[i] + patch->a[k]) - a,
              db = 0.5f * (patch->b[i] + patch->b[k]) - b;
        if (da * da + db * db < nearest) {
            nearest = da * da + db * db;
            best = side;
        }
    }
    return best;
}

point cage_face_centre(const struct cage *cage, int face) {
    point sum = {0, 0, 0};
    for (int k = 0; k < 4; k++)
        sum = point_add(sum, cage->points[cage->quads[face][k]]);
    return point_scale(sum, 0.25f);
}

point cage_face_normal(const struct cage *cage, int face) {
    const int32_t *quad = cage->quads[face];
    return point_cross(point_sub(cage->points[quad[2]], cage->points[quad[0]]),
                       point_sub(cage->points[quad[3]], cage->points[quad[1]]));
}

/* The vertex in the middle of the edge a-b, found through a chain of edges per lower end. */
static int edge_vertex(struct cage *fine, int32_t *head, int32_t (*edges)[3], int *nedges, int a,
                       int b) {
    int low = a < b ? a : b, high = a < b ? b : a;
    for (int32_t e = head[low]; e >= 0; e = edges[e][2])
        if (edges[e][0] == high)
            return edges[e][1];
    if (*nedges == 2 * CAGE_MAX) {
        fine->full = true;
        return 0;
    }
    int32_t *edge = edges[*nedges];
    edge[0] = high;
    edge[1] = cage_add_point(fine, (point){0, 0, 0});
    edge[2] = head[low];
    head[low] = (*nedges)++;
    return edge[1];
}

void cage_refine(const struct cage *coarse, struct cage *fine) {
    int32_t head[CAGE_MAX], edges[2 * CAGE_MAX][3];
    int valence[CAGE_MAX] = {0}, nedges = 0;
    memset(fine, 0, sizeof *fine);
    fine->full = coarse->full;
    for (int i = 0; i < coarse->npoints; i++) {
        cage_add_point(fine, (point){0, 0, 0});
        head[i] = -1;
    }
    /* Sum up, over all faces, what each gives to its vertices and edges: on a closed mesh every
     * edge is met twice and every vertex as often as its valence. */
    for (int f = 0; f < coarse->nquads && !fine->full; f++) {
        const int32_t *quad = coarse->quads[f];
        point centre = cage_face_centre(coarse, f);
        int middle[4], face_vertex = cage_add_point(fine, centre);
        for (int k = 0; k < 4; k++) {
            int from = quad[k], to = quad[(k + 1) % 4];
            point p = coarse->points[from], q = coarse->points[to];
            middle[k] = edge_vertex(fine, head, edges, &nedges, from, to);
            point half =
                point_add(point_scale(point_add(p, q), 0.125f), point_scale(centre, 0.25f));
            fine->points[middle[k]] = point_add(fine->points[middle[k]], half);
            valence[from]++;
            point given = point_add(centre, q);
            fine->points[from] = point_add(fine->points[from], given);
        }
        for (int k = 0; k < 4; k++)
            cage_add_quad(fine, quad[k], middle[k], face_vertex, middle[(k + 3) % 4]);
    }
    for (int i = 0; i < coarse->npoints; i++) {
        float n = (float)valence[i];
        if (n > 0)
            fine->points[i] = point_add(point_scale(fine->points[i], 1 / (n * n)),
                                        point_scale(coarse->points[i], (n - 2) / n));
    }
}
