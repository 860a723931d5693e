/* Edges and corners from first principles: every function of adjacency/edge.h against a unit square
 * that is walked around by hand, for all edges, all 16 pairs of edges and several resolutions. */
#include "kit/edge_kit.h"
#include "kit/test.h"

#include "texture/texture_data.h"

#include <math.h>

static void test_corners(void) {
    for (unsigned corner = 0; corner < 8; corner++) {
        double u, v;
        kit_edge_point(corner % 4, 0, &u, &v);
        CHECK(slvi_corner_u(corner) == u && slvi_corner_v(corner) == v);
        CHECK(slvi_corner_at(u > 0, v > 0) == corner % 4);
    }
}

static void test_walk(void) {
    for (unsigned edge = 0; edge < 4; edge++) {
        double end[2], start[2];
        /* an edge ends where the next one starts, and starts where the one before ends */
        kit_edge_point(edge, 1, &end[0], &end[1]);
        kit_edge_point(slvi_edge_next(edge), 0, &start[0], &start[1]);
        CHECK(end[0] == start[0] && end[1] == start[1]);
        kit_edge_point(edge, 0, &start[0], &start[1]);
        kit_edge_point(slvi_edge_before(edge), 1, &end[0], &end[1]);
        CHECK(end[0] == start[0] && end[1] == start[1]);
        CHECK(slvi_edge_opposite(edge) == slvi_edge_next(slvi_edge_next(edge)));
        CHECK(slvi_edge_next(edge + 4) == slvi_edge_next(edge));
        CHECK(slvi_edge_before(edge + 4) == slvi_edge_before(edge));
        CHECK(slvi_edge_opposite(edge + 4) == slvi_edge_opposite(edge));
        /* which axis it follows, which way, and where it lies along the other one */
        kit_edge_point(edge, 0, &start[0], &start[1]);
        kit_edge_point(edge, 1, &end[0], &end[1]);
        bool along_v = end[0] == start[0];
        CHECK(slvi_edge_along_v(edge) == along_v);
        CHECK(slvi_edge_is_rising(edge) == (end[along_v] > start[along_v]));
        CHECK(slvi_edge_is_far(edge) == (start[!along_v] == 1));
        CHECK(slvi_edge_at(!along_v, start[!along_v] == 1) == edge);
        CHECK(slvi_edge_along(edge, 5, 7) == (along_v ? 7 : 5));
        CHECK(slvi_edge_across(edge, 5, 7) == (along_v ? 5 : 7));
        CHECK(slvi_edge_step(edge, 3, 100) ==
              (ptrdiff_t)(3 * (end[0] - start[0])) + (ptrdiff_t)(100 * (end[1] - start[1])));
    }
}

/* Along the edge and inwards, the latter a quarter turn counter-clockwise from the former. */
static void directions(unsigned edge, double along[2], double inwards[2]) {
    double start[2], end[2];
    kit_edge_point(edge, 0, &start[0], &start[1]);
    kit_edge_point(edge, 1, &end[0], &end[1]);
    along[0] = end[0] - start[0];
    along[1] = end[1] - start[1];
    inwards[0] = -along[1];
    inwards[1] = along[0];
}

static void test_points(void) {
    for (unsigned edge = 0; edge < 4; edge++) {
        double along[2], inwards[2], start[2];
        directions(edge, along, inwards);
        kit_edge_point(edge, 0, &start[0], &start[1]);
        for (int i = -4; i <= 12; i++) {
            float t = (float)i / 8, u, v;
            slvi_edge_point(edge, t, &u, &v);
            CHECK((double)u == start[0] + (double)t * along[0]);
            CHECK((double)v == start[1] + (double)t * along[1]);
            for (int j = -4; j <= 12; j++) {
                float depth = (float)j / 8;
                float x = (float)(start[0] + (double)t * along[0] + (double)depth * inwards[0]);
                float y = (float)(start[1] + (double)t * along[1] + (double)depth * inwards[1]);
                CHECK(slvi_edge_t(edge, x, y) == t && slvi_edge_depth(edge, x, y) == depth);
                slvi_edge_project(edge, &x, &y);
                CHECK(x == u && y == v);
            }
        }
        float x = (float)inwards[0], y = (float)inwards[1];
        slvi_edge_turn(edge, &x, &y);
        CHECK(x == 0 && y == 1);
        x = (float)along[0], y = (float)along[1];
        slvi_edge_turn(edge, &x, &y);
        CHECK(x == 1 && y == 0);
    }
}

/* Texel j of an edge has its centre at t = (j + 1/2) / n, and depth (row + 1/2) / rows. */
static void test_texels(slv_res res) {
    int32_t width = 1 << res.u, height = 1 << res.v, x, y;
    uint64_t walked = 0;
    for (unsigned edge = 0; edge < 4; edge++) {
        double along[2], inwards[2], start[2];
        directions(edge, along, inwards);
        kit_edge_point(edge, 0, &start[0], &start[1]);
        int32_t n = along[0] != 0 ? width : height, rows = along[0] != 0 ? height : width;
        CHECK(1 << slvi_res_along(res, edge) == n && 1 << slvi_res_across(res, edge) == rows);
        CHECK(slvi_edge_walked(edge, (uint64_t)width, (uint64_t)height) == walked);
        walked += (uint64_t)n;
        CHECK(slvi_edge_walked(edge + 1, (uint64_t)width, (uint64_t)height) == walked);
        for (int32_t j = 0; j < n; j++)
            for (int32_t depth = -2; depth < rows; depth++) {
                double t = (j + 0.5) / n, d = (depth + 0.5) / rows;
                slvi_edge_texel(width, height, edge, j, depth, &x, &y);
                CHECK((x + 0.5) / width == start[0] + t * along[0] + d * inwards[0]);
                CHECK((y + 0.5) / height == start[1] + t * along[1] + d * inwards[1]);
                int32_t same_x, same_y, next_x, next_y;
                slvi_res_edge_texel(res, edge, j, depth, &same_x, &same_y);
                CHECK(same_x == x && same_y == y);
                slvi_edge_texel(width, height, edge, j + 1, depth, &next_x, &next_y);
                CHECK(slvi_edge_step(edge, 1, width) == (next_y - y) * width + (next_x - x));
            }
        slvi_corner_texel(width, height, edge, &x, &y);
        CHECK(x == (start[0] > 0 ? width - 1 : 0) && y == (start[1] > 0 ? height - 1 : 0));
        int32_t same_x, same_y;
        slvi_res_corner_texel(res, edge, &same_x, &same_y);
        CHECK(same_x == x && same_y == y);
    }
}

/* Of a triangle's texels with a side on an edge, j is the one whose side has j / n..(j + 1) / n. */
static void test_triangle_texels(int32_t n) {
    static const double start[3][2] = {{0, 0}, {1, 0}, {0, 1}};
    for (unsigned edge = 0; edge < 3; edge++) {
        const double *a = start[edge], *b = start[(edge + 1) % 3];
        for (int32_t j = 0; j < n; j++) {
            int32_t x, y;
            slvi_edge_triangle_texel(n, edge, j, &x, &y);
            double t = (j + 0.5) / n, u = a[0] + t * (b[0] - a[0]), v = a[1] + t * (b[1] - a[1]);
            /* the middle of the side, moved a little towards the triangle's own middle */
            u += 1e-3 / n * (1.0 / 3 - u);
            v += 1e-3 / n * (1.0 / 3 - v);
            CHECK(x == (int32_t)(u * n) && y == (int32_t)(v * n));
        }
    }
}

/* Crossing an edge t becomes t_shift - scale t along the other, and the depth -scale times it. */
static void test_maps(void) {
    static const float scales[3][3] = {{1, 1, 1}, {2, 1, 2}, {0.5f, 0.5f, 1}};
    for (unsigned edge = 0; edge < 4; edge++)
        for (unsigned other = 0; other < 4; other++) {
            slv_affine map = slv_orientation(edge, other), same = slvi_edge_map(edge, other, 1, 1);
            CHECK(memcmp(&map, &same, sizeof map) == 0);
            same = slvi_edge_map(edge + 4, other + 8, 1, 1);
            CHECK(memcmp(&map, &same, sizeof map) == 0);
            /* so many turns of (x,y) to (y,-x) make the neighbour's frame of this one's */
            for (int k = 0; k < 2; k++) {
                float x = !k, y = (float)k;
                for (unsigned turn = 0; turn < slvi_edge_turns(edge, other); turn++) {
                    float before = x;
                    x = y;
                    y = -before;
                }
                CHECK((k ? map.uv : map.uu) == x && (k ? map.vv : map.vu) == y);
            }
            for (int s = 0; s < 3; s++)
                for (int shift = 1; shift < 3; shift++) {
                    float scale = scales[s][0], t_shift = scales[s][shift], u, v;
                    map = slvi_edge_map(edge, other, scale, t_shift);
                    for (int i = -4; i <= 12; i++)
                        for (int j = -4; j <= 4; j++) {
                            double along[2], inwards[2], start[2];
                            double t = i / 8.0, depth = j / 8.0;
                            directions(edge, along, inwards);
                            kit_edge_point(edge, 0, &start[0], &start[1]);
                            slv_affine_apply(
                                &map, (float)(start[0] + t * along[0] + depth * inwards[0]),
                                (float)(start[1] + t * along[1] + depth * inwards[1]), &u, &v);
                            CHECK(slvi_edge_t(other, u, v) == t_shift - scale * (float)t);
                            CHECK(slvi_edge_depth(other, u, v) == -scale * (float)depth);
                        }
                }
        }
}

static void test_halvings(void) {
    static const float scales[3] = {0.5f, 1, 2};
    for (int i = 0; i < 3; i++) {
        slv_neighbour to = {.scale = scales[i]};
        CHECK(slvi_neighbour_halvings(&to) == i - 1);
        CHECK(ldexpf(1, slvi_neighbour_halvings(&to)) == to.scale);
    }
}

int main(void) {
    test_corners();
    test_walk();
    test_points();
    for (int8_t u = 0; u <= 4; u++)
        for (int8_t v = 0; v <= 4; v++)
            test_texels((slv_res){u, v});
    for (int32_t n = 1; n <= 16; n *= 2)
        test_triangle_texels(n);
    test_maps();
    test_halvings();
    return test_end();
}
