/* Faces of the target that are those of the source, turned or flipped, and their texels. */
#include "transfer/transfer_data.h"

#include "adjacency/edge.h"
#include "base/memory.h"
#include "base/names.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *slv_transfer_kind_name(slv_transfer_kind kind) {
    static const char *const names[] = {"copied", "resampled", "partly", "far"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)kind);
}

/* In double: squares of lengths that float holds need not fit in one. */
static double triangle_area(const float *a, const float *b, const float *c) {
    double x[3], y[3];
    for (int k = 0; k < 3; k++) {
        x[k] = (double)b[k] - (double)a[k];
        y[k] = (double)c[k] - (double)a[k];
    }
    double n[3] = {x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]};
    return 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

double slvi_transfer_area(const float *corners) {
    return triangle_area(corners, corners + 3, corners + 6) +
           triangle_area(corners, corners + 6, corners + 9);
}

static double length_of(const float *a, const float *b) {
    double x = (double)b[0] - (double)a[0], y = (double)b[1] - (double)a[1],
           z = (double)b[2] - (double)a[2];
    return sqrt(x * x + y * y + z * z);
}

float slvi_transfer_mean_length(const float *a, const float *b, const float *c, const float *d) {
    return (float)(0.5 * (length_of(a, b) + length_of(c, d)));
}

slv_result slvi_transfer_match(const slv_env *env, uint32_t nsource, const float *source,
                               uint32_t ntarget, const float *target, float tolerance,
                               slv_transfer_face *faces) {
    slv_face_match *matches = NULL;
    slv_result result = slvi_alloc_plain(env, "faces to match", ntarget, sizeof *matches, &matches);
    if (!result)
        result = slv_mesh_match_corners(env, nsource, source, ntarget, target, tolerance, matches);
    for (uint32_t face = 0; !result && face < ntarget; face++)
        faces[face] = (slv_transfer_face){.source = matches[face].face,
                                          .turn = matches[face].turn,
                                          .flipped = matches[face].flipped};
    slvi_free(matches);
    return result;
}

static unsigned source_corner(const slv_transfer_face *face, unsigned corner) {
    const slv_face_match match = {face->source, face->turn, face->flipped};
    return slv_face_match_corner(&match, corner);
}

slv_res slvi_transfer_turned(slv_res res, const slv_transfer_face *match) {
    /* a flip at corner 0 swaps the axes, and every quarter turn does */
    bool swapped = (match->turn % 2 != 0) != match->flipped;
    return swapped ? (slv_res){res.v, res.u} : res;
}

void slvi_transfer_turn(const slv_transfer_face *match, slv_res source, size_t pixel,
                        const uint8_t *in, uint8_t *out) {
    slv_res res = slvi_transfer_turned(source, match);
    int64_t w = INT64_C(1) << res.u, h = INT64_C(1) << res.v;
    int64_t sw = INT64_C(1) << source.u, sh = INT64_C(1) << source.v;
    unsigned c0 = source_corner(match, 0), c1 = source_corner(match, 1),
             c3 = source_corner(match, 3);
    /* how the source's (u,v) goes along this face's u (towards corner 1) and v (towards corner 3)
     */
    int uu = slvi_corner_u(c1) - slvi_corner_u(c0), uv = slvi_corner_u(c3) - slvi_corner_u(c0),
        vu = slvi_corner_v(c1) - slvi_corner_v(c0), vv = slvi_corner_v(c3) - slvi_corner_v(c0);
    int64_t u0 = slvi_corner_u(c0) * (sw - 1), v0 = slvi_corner_v(c0) * (sh - 1);
    for (int64_t y = 0; y < h; y++)
        for (int64_t x = 0; x < w; x++) {
            int64_t sx = u0 + uu * x + uv * y, sy = v0 + vu * x + vv * y;
            memcpy(out + (size_t)(y * w + x) * pixel, in + (size_t)(sy * sw + sx) * pixel, pixel);
        }
}
