/* Points of edges, written down once more for the tests: what adjacency/edge.h says is judged by
 * this, so this must not be made of that. */
#ifndef EDGE_KIT_H
#define EDGE_KIT_H

/* Corner c is where edge c starts: counter-clockwise around the unit square. */
static const double kit_corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

/* The point at t of an edge, counter-clockwise. */
static inline void kit_edge_point(unsigned edge, double t, double *u, double *v) {
    const double *start = kit_corners[edge % 4], *end = kit_corners[(edge + 1) % 4];
    *u = start[0] + t * (end[0] - start[0]);
    *v = start[1] + t * (end[1] - start[1]);
}

static inline void kit_edge_point_float(unsigned edge, float t, float *u, float *v) {
    double x, y;
    kit_edge_point(edge, (double)t, &x, &y);
    *u = (float)x;
    *v = (float)y;
}

#endif
