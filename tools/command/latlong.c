/* Directions of a map of latitude and longitude, and where they meet the faces of a cube. */
#include "command/latlong.h"

#include "command/output.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define AT_ONCE 65536 /* points of one call, unless a row has more */

/* A face of the cube: its plane is where coordinate `axis` is `sign`. */
typedef struct side {
    int axis;
    float sign, start[3], u[3], v[3]; /* u and v: from corner 0 to corners 1 and 3 */
} side;

static void find_sides(const slv_mesh *cube, side out[6]) {
    const slv_mesh_view *view = slv_mesh_get_view(cube);
    for (int f = 0; f < 6; f++) {
        const int32_t *verts = view->poly_verts + 4 * f;
        const float *p[4];
        for (int c = 0; c < 4; c++)
            p[c] = view->positions + 3 * (size_t)verts[c];
        for (int c = 0; c < 3; c++) {
            out[f].start[c] = p[0][c];
            out[f].u[c] = p[1][c] - p[0][c];
            out[f].v[c] = p[3][c] - p[0][c];
            if (p[0][c] == p[1][c] && p[0][c] == p[3][c])
                out[f].axis = c;
        }
        out[f].sign = p[0][out[f].axis];
    }
}

static void direction(double x, double y, double out[3]) {
    double longitude = (0.5 - x) * 2 * PI, latitude = (0.5 - y) * PI;
    out[0] = sin(longitude) * cos(latitude);
    out[1] = sin(latitude);
    out[2] = cos(longitude) * cos(latitude);
}

/* Where a direction meets the plane of a face, which may be beside it. */
static void meet(const side *s, const double d[3], float uv[2]) {
    double depth = fmax(d[s->axis] * (double)s->sign, 1e-2), u = 0, v = 0;
    for (int c = 0; c < 3; c++) {
        double at = d[c] / depth - (double)s->start[c];
        u += at * (double)s->u[c];
        v += at * (double)s->v[c];
    }
    uv[0] = (float)(u / 4); /* edges are 2 long */
    uv[1] = (float)(v / 4);
}

static int32_t side_of(const side *sides, const double d[3]) {
    int32_t best = 0;
    for (int32_t f = 1; f < 6; f++)
        if (d[sides[f].axis] * (double)sides[f].sign >
            d[sides[best].axis] * (double)sides[best].sign)
            best = f;
    return best;
}

/* Point i: at (x,y) of the picture, with what a step of its own size changes. */
static void place(const side *sides, const double at[2], const double step[2], uint32_t i,
                  latlong_points *out) {
    double d[3];
    float a[2], b[2];
    direction(at[0], at[1], d);
    int32_t face = side_of(sides, d);
    out->faces[i] = face;
    meet(&sides[face], d, out->uv + 2 * (size_t)i);
    for (int axis = 0; axis < 2; axis++) {
        double half[2] = {axis ? 0 : step[0] / 2, axis ? step[1] / 2 : 0};
        float *to = (axis ? out->dy : out->dx) + 2 * (size_t)i;
        direction(at[0] - half[0], at[1] - half[1], d);
        meet(&sides[face], d, a);
        direction(at[0] + half[0], at[1] + half[1], d);
        meet(&sides[face], d, b);
        to[0] = b[0] - a[0];
        to[1] = b[1] - a[1];
    }
    for (int c = 0; c < 2; c++) {
        float *p = &out->uv[2 * (size_t)i + c];
        *p = fminf(fmaxf(*p, 0), 1);
    }
}

slv_result latlong_draw(const slv_env *env, const slv_mesh *cube, uint32_t width, uint32_t height,
                        uint32_t across, latlong_look look, void *user, slv_image *out) {
    const uint32_t row = width * across, rows = height * across;
    const uint32_t most = row < AT_ONCE ? AT_ONCE / row : 1;
    const double step[2] = {1.0 / row, 1.0 / rows};
    const size_t room = (size_t)row * most;
    side sides[6];
    int32_t *faces = malloc(room * sizeof *faces);
    float *floats = malloc(room * 10 * sizeof *floats);
    latlong_points p = {.faces = faces};
    slv_result result = faces && floats ? slv_image_create(env, width, height, 4, out)
                                        : output_fail(env, SLV_ERROR_MEMORY, "no memory for a map");
    find_sides(cube, sides);
    if (floats) {
        p.uv = floats;
        p.dx = floats + 2 * room;
        p.dy = floats + 4 * room;
        p.values = floats + 6 * room;
    }
    for (uint32_t first = 0; first < rows && !result; first += most) {
        uint32_t n = rows - first < most ? rows - first : most;
        p.count = n * row;
        for (uint32_t i = 0; i < p.count; i++) {
            const double at[2] = {(i % row + 0.5) * step[0], (first + i / row + 0.5) * step[1]};
            place(sides, at, step, i, &p);
        }
        result = look(user, env, &p);
        for (uint32_t i = 0; i < p.count && !result; i++) {
            size_t y = (first + i / row) / across, x = i % row / across;
            for (int c = 0; c < 4; c++)
                out->pixels[4 * (y * width + x) + c] +=
                    p.values[4 * (size_t)i + c] / (float)(across * across);
        }
    }
    free(faces);
    free(floats);
    if (result)
        slv_image_free(out);
    return result;
}
