/* Built from the records of faces: links that are not returned are cut, rings are found. */
#include "adjacency/adjacency_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <string.h>

static bool link_is_mutual(const slv_adjacency *a, slv_half_edge from) {
    slv_half_edge to = slvi_adjacency_across(a, from);
    if (!slvi_adjacency_has(a, to.face) || slvi_half_edge_same(from, to))
        return false;
    slv_half_edge back = slvi_adjacency_across(a, to);
    if (slvi_half_edge_same(back, from))
        return true;
    /* A sub-face may also be the one that its whole neighbour does not name. */
    if (!a->subface[from.face] || a->subface[to.face])
        return false;
    if (!slvi_adjacency_has(a, back.face) || !a->subface[back.face] ||
        !slvi_half_edge_same(slvi_adjacency_across(a, back), to))
        return false;
    return slvi_half_edge_same(slvi_adjacency_secondary(a, to, back), from);
}

/* Every link is judged on the records as they came, so the order of the faces does not matter; and
 * no verdict depends on a link that is itself cut, so one pass is enough. */
static slv_result cut_one_sided_links(const slv_env *env, slv_adjacency *a) {
    uint8_t *keep = NULL;
    int32_t first_face = 0;
    unsigned first_edge = 0;
    slv_result result = slvi_alloc(env, "adjacency", a->nfaces, 1, &keep);
    if (result)
        return result;
    for (uint32_t f = 0; f < a->nfaces; f++)
        for (unsigned e = 0; e < 4; e++)
            if (a->faces[f].face[e] != SLV_BOUNDARY &&
                link_is_mutual(a, (slv_half_edge){(int32_t)f, (uint8_t)e}))
                keep[f] |= (uint8_t)(1u << e);
    for (uint32_t f = 0; f < a->nfaces; f++)
        for (unsigned e = 0; e < 4; e++) {
            if (keep[f] >> e & 1)
                continue;
            if (a->faces[f].face[e] != SLV_BOUNDARY && !a->ncut++) {
                first_face = (int32_t)f;
                first_edge = e;
            }
            a->faces[f].face[e] = SLV_BOUNDARY;
            a->faces[f].edge[e] = 0;
        }
    if (a->ncut)
        slvi_logf(
            env, SLV_LOG_WARNING,
            "adjacency: %u link(s) that the other side does not return were cut, the first at "
            "face %d edge %u",
            a->ncut, first_face, first_edge);
    slvi_free(keep);
    return SLV_OK;
}

static slv_result create(const slv_env *env, uint32_t nfaces, const slv_face_adjacency *faces,
                         const uint8_t *flags, slv_adjacency **out) {
    slv_result result = SLV_OK;
    slv_adjacency *a = NULL;
    *out = NULL;
    if (nfaces && !faces)
        return slvi_fail(env, SLV_ERROR_ARGUMENT, "adjacency: no face records");
    if (nfaces > SLV_MAX_FACES)
        return slvi_fail(env, SLV_ERROR_LIMIT, "adjacency: %u faces, at most %d are possible",
                         nfaces, SLV_MAX_FACES);
    if ((result = slvi_alloc(env, "adjacency", 1, sizeof *a, &a)))
        return result;
    a->nfaces = nfaces;
    if ((result = slvi_alloc(env, "adjacency", nfaces, sizeof *a->faces, &a->faces)) ||
        (result = slvi_alloc(env, "adjacency", nfaces, 1, &a->subface)))
        goto done;
    for (uint32_t f = 0; f < nfaces; f++) {
        a->subface[f] = flags && flags[f] & SLV_FACE_SUBFACE ? 1 : 0;
        for (int e = 0; e < 4; e++) {
            a->faces[f].face[e] = faces[f].face[e];
            a->faces[f].edge[e] = faces[f].edge[e] & 3;
        }
    }
    if ((result = cut_one_sided_links(env, a)) || (result = slvi_adjacency_build_rings(env, a)))
        goto done;
    *out = a;
    a = NULL;
done:
    slv_adjacency_destroy(a);
    return result;
}

slv_result slv_adjacency_create(const slv_env *env, uint32_t nfaces,
                                const slv_face_adjacency *faces, const uint8_t *flags,
                                slv_adjacency **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, create(&own, nfaces, faces, flags, out));
}

void slv_adjacency_destroy(slv_adjacency *a) {
    if (!a)
        return;
    slvi_free(a->faces);
    slvi_free(a->subface);
    slvi_free(a->ring_corners);
    slvi_free(a->ring_first);
    slvi_free(a->ring_closed);
    slvi_free(a->corner_ring);
    slvi_free(a->corner_position);
    slvi_free(a);
}

uint32_t slv_adjacency_face_count(const slv_adjacency *a) {
    return a->nfaces;
}

const slv_face_adjacency *slv_adjacency_faces(const slv_adjacency *a) {
    return a->faces;
}

bool slv_adjacency_is_subface(const slv_adjacency *a, int32_t face) {
    return slvi_adjacency_has(a, face) && a->subface[face];
}

uint32_t slv_adjacency_cut_count(const slv_adjacency *a) {
    return a->ncut;
}
