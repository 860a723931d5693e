/* Whether the edges of the face table lead back to each other. */
#include "ptx/check/check.h"

#include "adjacency/edge.h"
#include "base/memory.h"
#include "ptx/format/ptx_file.h"

#include <stdio.h>
#include <string.h>

enum { MAX_POLYGON = 1 << 16 };

static bool is_sub(const check_context *check, int32_t face) {
    return check->faces[face].flags & SLV_FACE_SUBFACE;
}

static bool leads_to(const check_context *check, int32_t face, unsigned edge, int32_t to,
                     unsigned to_edge) {
    const slv_face_adjacency *a = &check->faces[face].adjacency;
    return a->face[edge] == to && a->edge[edge] == to_edge;
}

/* The neighbour inside the polygon over edge 1 (the next sub-face) or 2 (the one before). */
static bool step_inside(const check_context *check, int32_t *face, unsigned *edge) {
    const slv_face_adjacency *a = &check->faces[*face].adjacency;
    unsigned over = *edge;
    *edge = a->edge[over];
    *face = a->face[over];
    return *face >= 0 && is_sub(check, *face);
}

/* Of the two sub-faces along a whole quad's edge, the record of the quad names the first; the
 * second is across that one's edge before. */
static bool is_second_of(const check_context *check, int32_t sub, unsigned sub_edge, int32_t quad,
                         unsigned quad_edge) {
    int32_t face = check->faces[quad].adjacency.face[quad_edge];
    unsigned edge = slvi_edge_before(check->faces[quad].adjacency.edge[quad_edge]);
    if (face < 0 || !is_sub(check, face) || !step_inside(check, &face, &edge))
        return false;
    return face == sub && slvi_edge_before(edge) == sub_edge;
}

static void describe(const check_context *check, int32_t face, unsigned edge, char *out,
                     size_t size) {
    const slv_face_adjacency *a = &check->faces[face].adjacency;
    if (a->face[edge] < 0)
        snprintf(out, size, "is a boundary");
    else
        snprintf(out, size, "leads to face %d edge %u", a->face[edge], a->edge[edge]);
}

static void check_edge(check_context *check, int32_t face, unsigned edge) {
    const slv_face_adjacency *a = &check->faces[face].adjacency;
    int32_t there = a->face[edge];
    unsigned there_edge = a->edge[edge];
    slv_check_finding finding = {
        .kind = SLV_CHECK_ADJACENCY, .face = face, .edge = (int32_t)edge, .level = -1};
    char back[64];
    if (slvi_ptx_edge_is_lost(check->ptx, (uint32_t)face, edge, &there)) {
        finding.repairable = true;
        slvi_check_find(
            check->findings, &finding,
            "face %d edge %u: leads to face %d, but there are %u faces: readers refuse the "
            "file",
            face, edge, there, check->info->nfaces);
        return;
    }
    if (there < 0)
        return;
    if (there_edge >= check->nedges) {
        slvi_check_find(check->findings, &finding,
                        "face %d edge %u: leads to edge %u of face %d, a triangle", face, edge,
                        there_edge, there);
        return;
    }
    if (leads_to(check, there, there_edge, face, edge))
        return;
    if (is_sub(check, face) && !is_sub(check, there) &&
        is_second_of(check, face, edge, there, there_edge))
        return;
    describe(check, there, there_edge, back, sizeof back);
    for (unsigned other = 0; other < check->nedges; other++)
        if (other != there_edge && leads_to(check, there, other, face, edge)) {
            slvi_check_find(
                check->findings, &finding,
                "face %d edge %u: leads to face %d edge %u, which %s: it is that face's "
                "edge %u that leads back",
                face, edge, there, there_edge, back, other);
            return;
        }
    slvi_check_find(check->findings, &finding,
                    "face %d edge %u: leads to face %d edge %u, which %s", face, edge, there,
                    there_edge, back);
}

/* A whole quad's edge to two sub-faces needs the second as well, and it must know the quad. */
static void check_second(check_context *check, int32_t face, unsigned edge) {
    const slv_face_adjacency *a = &check->faces[face].adjacency;
    int32_t second = a->face[edge];
    unsigned second_edge = slvi_edge_before(a->edge[edge]);
    slv_check_finding finding = {
        .kind = SLV_CHECK_SUBFACES, .face = face, .edge = (int32_t)edge, .level = -1};
    if (second < 0 || is_sub(check, face) || !is_sub(check, second))
        return;
    if (!step_inside(check, &second, &second_edge)) {
        slvi_check_find(
            check->findings, &finding,
            "face %d edge %u: meets sub-face %d, beside which the second one is missing "
            "(over its edge %u)",
            face, edge, a->face[edge], slvi_edge_before(a->edge[edge]));
        return;
    }
    second_edge = slvi_edge_before(second_edge);
    if (!leads_to(check, second, second_edge, face, edge))
        slvi_check_find(
            check->findings, &finding,
            "face %d edge %u: meets sub-faces %d and %d, but edge %u of the second does not "
            "lead back",
            face, edge, a->face[edge], second, second_edge);
}

/* Where the polygon of a sub-face begins: at any, or at the first of what is left of it. */
static int32_t find_first(const check_context *check, int32_t start) {
    int32_t face = start;
    for (uint32_t count = 0; count < MAX_POLYGON; count++) {
        int32_t before = face;
        unsigned edge = 2;
        if (!step_inside(check, &face, &edge))
            return face < 0 ? before : start;
        if (edge != 1 || face == start)
            break;
    }
    return start;
}

/* The sub-faces of a polygon go round its middle, each one's edge 1 at the next one's edge 2. Those
 * of a part of a file may lack some, with boundaries there. */
static void check_polygon(check_context *check, int32_t start, uint8_t *seen) {
    slv_check_finding finding = {
        .kind = SLV_CHECK_SUBFACES, .warning = true, .face = start, .edge = 1, .level = -1};
    uint32_t count = 0;
    if (seen[start])
        return;
    int32_t face = start = find_first(check, start);
    do {
        unsigned edge = 1;
        int32_t from = face;
        seen[face] = 1;
        finding.face = from;
        if (!step_inside(check, &face, &edge) || edge != 2) {
            if (face < 0 && check->faces[start].adjacency.face[2] < 0)
                return;
            slvi_check_find(check->findings, &finding,
                            "face %d edge 1: is a sub-face, but no other's edge 2 follows it",
                            from);
            return;
        }
        if (seen[face] && face != start) {
            slvi_check_find(check->findings, &finding,
                            "face %d edge 1: the sub-faces from face %d on do not come back to it",
                            from, start);
            return;
        }
    } while (++count < MAX_POLYGON && face != start);
    finding.face = start;
    finding.edge = -1;
    if (count < 3 || count == 4)
        slvi_check_find(check->findings, &finding,
                        "face %d: is a sub-face of a polygon of %u, which would not be split",
                        start, count);
}

static bool same_value(const uint8_t *values, size_t size, int32_t a, int32_t b) {
    return memcmp(values + (size_t)a * size, values + (size_t)b * size, size) == 0;
}

/* Filters do not look further than a face whose flag says that all around it is the same. */
static void check_flag(check_context *check, int32_t face, const uint8_t *values) {
    slv_check_finding finding = {.kind = SLV_CHECK_FLAGS,
                                 .warning = true,
                                 .repairable = true,
                                 .face = face,
                                 .edge = -1,
                                 .level = -1};
    const slv_ptx_face *f = &check->faces[face];
    if (!(f->flags & SLV_FACE_NEIGHBOURS_CONSTANT))
        return;
    if (!(f->flags & SLV_FACE_CONSTANT)) {
        slvi_check_find(check->findings, &finding,
                        "face %d: is flagged as lying among its own value, but is not constant",
                        face);
        return;
    }
    for (unsigned edge = 0; edge < check->nedges; edge++) {
        int32_t there = f->adjacency.face[edge];
        finding.edge = (int32_t)edge;
        if (there < 0 || ((check->faces[there].flags & SLV_FACE_CONSTANT) &&
                          same_value(values, check->pixel_size, face, there)))
            continue;
        slvi_check_find(
            check->findings, &finding,
            "face %d edge %u: is flagged as lying among its own value, but face %d differs", face,
            edge, there);
    }
}

slv_result slvi_check_adjacency(check_context *check) {
    uint32_t nfaces = check->info->nfaces;
    bool quads = check->info->mesh_type == SLV_PTX_QUAD;
    uint8_t *seen = NULL, *values = NULL;
    check_log log;
    slv_env quiet = slvi_check_log_env(&check->env, &log, slv_ptx_name(check->ptx));
    slv_ptx_reader *reader = NULL;
    slv_result result = slvi_alloc(&check->env, "faces", nfaces, 1, &seen);
    if (result || (result = slvi_alloc(&check->env, "values of the faces", nfaces,
                                       check->pixel_size, &values)))
        goto done;
    result = slv_ptx_reader_create(&quiet, check->ptx, &reader);
    for (uint32_t face = 0; face < nfaces && !result; face++)
        result =
            slv_ptx_reader_read(reader, face, (slv_res){0, 0}, values + face * check->pixel_size);
    if (result) {
        slvi_fail(&check->env, result, "%s: %s", slv_ptx_name(check->ptx), log.message);
        goto done;
    }
    for (uint32_t i = 0; i < nfaces; i++) {
        int32_t face = (int32_t)i;
        for (unsigned edge = 0; edge < check->nedges; edge++) {
            check_edge(check, face, edge);
            if (quads)
                check_second(check, face, edge);
        }
        if (quads && is_sub(check, face))
            check_polygon(check, face, seen);
        check_flag(check, face, values);
    }
done:
    slv_ptx_reader_destroy(reader);
    slvi_free(values);
    slvi_free(seen);
    return result;
}
