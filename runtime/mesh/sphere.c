/* Environments: six faces that close a cube, blown up to the sphere that their texels are seen on.
 */
#include "base/log.h"

#include <selvage/mesh.h>
#include <selvage/tessellation.h>

#include <math.h>
#include <string.h>

enum { SIDES = 6 };

/* The face that has no edge in common with `face`; -1 if the six are no cube. */
static int32_t opposite(const slv_face_adjacency *faces, int32_t face) {
    unsigned seen = 1u << face;
    for (unsigned e = 0; e < 4; e++) {
        int32_t to = faces[face].face[e];
        if (to < 0 || to >= SIDES || seen >> to & 1)
            return -1;
        seen |= 1u << to;
    }
    for (int32_t other = 0; other < SIDES; other++)
        if (!(seen >> other & 1))
            return other;
    return -1;
}

/* Which way each face looks: an axis for each pair of opposite faces in the order of their first,
 * which looks along it, and the second against it. */
static bool find_axes(const slv_adjacency *adjacency, int axis[SIDES], float sign[SIDES]) {
    const slv_face_adjacency *faces = slv_adjacency_faces(adjacency);
    int naxes = 0;
    if (slv_adjacency_face_count(adjacency) != SIDES)
        return false;
    memset(sign, 0, SIDES * sizeof *sign);
    for (int32_t f = 0; f < SIDES; f++) {
        int32_t other = opposite(faces, f);
        if (other < 0 || slv_adjacency_is_subface(adjacency, f) || opposite(faces, other) != f)
            return false;
        if (sign[f] != 0)
            continue;
        axis[f] = axis[other] = naxes++;
        sign[f] = 1;
        sign[other] = -1;
    }
    return naxes == 3;
}

/* A corner lies in three faces, one of each axis; its number has a bit for each. */
static bool find_corner(const slv_adjacency *adjacency, const int axis[SIDES],
                        const float sign[SIDES], int32_t face, unsigned corner, int32_t *out) {
    uint32_t position;
    slv_ring ring = slv_adjacency_ring(adjacency, face, corner, &position);
    unsigned axes = 0;
    *out = 0;
    if (!ring.closed || ring.count != 3)
        return false;
    for (uint32_t i = 0; i < 3; i++) {
        int32_t f = ring.corners[i].face;
        axes |= 1u << axis[f];
        *out |= (sign[f] > 0) << axis[f];
    }
    return axes == 7;
}

slv_result slv_mesh_create_cube(const slv_env *env, const slv_adjacency *adjacency,
                                slv_mesh **out) {
    static const int32_t sizes[SIDES] = {4, 4, 4, 4, 4, 4};
    int axis[SIDES];
    float sign[SIDES], positions[8][3];
    int32_t verts[SIDES][4];
    bool fits = find_axes(adjacency, axis, sign);
    *out = NULL;
    for (int32_t f = 0; f < SIDES && fits; f++)
        for (unsigned c = 0; c < 4 && fits; c++)
            fits = find_corner(adjacency, axis, sign, f, c, &verts[f][c]);
    if (!fits)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "%u faces that do not make a cube",
                         slv_adjacency_face_count(adjacency));
    for (int32_t v = 0; v < 8; v++)
        for (int c = 0; c < 3; c++)
            positions[v][c] = v >> c & 1 ? 1.0f : -1.0f;
    const slv_mesh_view view = {.nverts = 8,
                                .positions = positions[0],
                                .npolys = SIDES,
                                .poly_sizes = sizes,
                                .poly_verts = verts[0]};
    return slv_mesh_create(env, &view, out);
}

static slv_result to_sphere(void *user, int32_t face, float spacing, size_t count, const float *uv,
                            float *out) {
    const slv_mesh_view *view = slv_mesh_get_view(user);
    const int32_t *verts = view->poly_verts + 4 * (size_t)face;
    (void)spacing;
    for (size_t i = 0; i < count; i++, uv += 2, out += 3) {
        float at[3], length = 0;
        for (int c = 0; c < 3; c++) {
            const float *p = view->positions + c;
            float low = p[3 * verts[0]] + uv[0] * (p[3 * verts[1]] - p[3 * verts[0]]);
            float high = p[3 * verts[3]] + uv[0] * (p[3 * verts[2]] - p[3 * verts[3]]);
            at[c] = low + uv[1] * (high - low);
            length += at[c] * at[c];
        }
        length = sqrtf(length);
        for (int c = 0; c < 3; c++)
            out[c] = length > 0 ? at[c] / length - at[c] : 0;
    }
    return SLV_OK;
}

static uint32_t sphere_detail(void *user, int32_t face) {
    (void)user;
    (void)face;
    return 64;
}

slv_displacement slv_sphere_displacement(const slv_mesh *cube) {
    return (slv_displacement){.space = SLV_DISPLACE_OBJECT,
                              .evaluate = to_sphere,
                              .detail = sphere_detail,
                              .user = (void *)(uintptr_t)cube};
}
