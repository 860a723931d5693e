/* Whether a mesh that has the faces of the one inside also has them in the same places: textures
 * would be drawn on other faces, or turned, though all neighbours agree. */
#include "ptx/check/check.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>

#define TOLERANCE 1e-5f /* of the size of the mesh inside */

static float size_of(uint32_t nfaces, const float *corners) {
    float size = 0;
    for (int k = 0; nfaces && k < 3; k++) {
        float low = corners[k], high = corners[k];
        for (size_t i = 0; i < (size_t)4 * nfaces; i++) {
            low = fminf(low, corners[3 * i + (size_t)k]);
            high = fmaxf(high, corners[3 * i + (size_t)k]);
        }
        size = fmaxf(size, high - low);
    }
    return size;
}

/* The furthest that one of a face's corners is from where it was. */
static double moved_by(const float *a, const float *b) {
    double most = 0;
    for (int c = 0; c < 4; c++) {
        double x = (double)a[3 * c] - (double)b[3 * c],
               y = (double)a[3 * c + 1] - (double)b[3 * c + 1],
               z = (double)a[3 * c + 2] - (double)b[3 * c + 2];
        most = fmax(most, sqrt(x * x + y * y + z * z));
    }
    return most;
}

static void find_turned(check_context *check, uint32_t face, const slv_face_match *match) {
    const slv_check_finding finding = {
        .kind = SLV_CHECK_MESH, .warning = true, .face = (int32_t)face, .edge = -1, .level = -1};
    char how[48] = "";
    if (match->flipped)
        snprintf(how, sizeof how, ", the other way round");
    else if (match->turn)
        snprintf(how, sizeof how, ", turned by %u", match->turn);
    if (match->face == (int32_t)face)
        slvi_check_find(check->findings, &finding,
                        "face %u: its corners lie elsewhere than in the mesh inside: in the same "
                        "places%s",
                        face, how);
    else
        slvi_check_find(check->findings, &finding,
                        "face %u: its corners lie elsewhere than in the mesh inside: where those "
                        "of face %d are%s",
                        face, match->face, how);
}

/* Another shape is told of once: a pose of the same model is that. */
static void find_moved(check_context *check, uint32_t count, uint32_t first, double most) {
    const slv_check_finding finding = {
        .kind = SLV_CHECK_MESH, .warning = true, .face = (int32_t)first, .edge = -1, .level = -1};
    if (count == 1)
        slvi_check_find(check->findings, &finding,
                        "face %u: its corners lie elsewhere than in the mesh inside, by up to %g",
                        first, most);
    else if (count)
        slvi_check_find(check->findings, &finding,
                        "face %u: its corners lie elsewhere than in the mesh inside, and so do "
                        "those of %u other faces, by up to %g",
                        first, count - 1, most);
}

slv_result slvi_check_corners(check_context *check, const slv_mesh *inside) {
    const slv_mesh *mesh = check->params.mesh;
    uint32_t nfaces = slv_mesh_face_count(mesh), count = 0, first = 0;
    float *expected = NULL, *found = NULL;
    slv_face_match *matches = NULL;
    double most = 0;
    if (slv_mesh_face_count(inside) != nfaces)
        return SLV_OK; /* which is a finding already */
    slv_result result = slv_mesh_corners(&check->env, inside, NULL, &expected);
    if (result ||
        (result = slv_mesh_corners(&check->env, mesh, slv_mesh_get_view(inside)->origin, &found)) ||
        (result = slvi_alloc(&check->env, "corners", nfaces, sizeof *matches, &matches)) ||
        (result = slv_mesh_match_corners(&check->env, nfaces, expected, nfaces, found,
                                         TOLERANCE * size_of(nfaces, expected), matches)))
        goto done;
    for (uint32_t face = 0; face < nfaces; face++) {
        const slv_face_match *match = &matches[face];
        if (match->face == (int32_t)face && !match->turn && !match->flipped)
            continue;
        if (match->face >= 0) {
            find_turned(check, face, match);
            continue;
        }
        first = count++ ? first : face;
        most = fmax(most, moved_by(expected + (size_t)12 * face, found + (size_t)12 * face));
    }
    find_moved(check, count, first, most);
done:
    slvi_free(expected);
    slvi_free(found);
    slvi_free(matches);
    return result;
}
