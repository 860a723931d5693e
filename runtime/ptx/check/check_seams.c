/* Whether the texels on both sides of a shared edge agree. */
#include "ptx/check/check.h"

#include "adjacency/edge.h"
#include "texture/bilinear.h"

#include <math.h>

/* The texels of a stretch of a face's edge, counter-clockwise. */
struct side {
    const uint8_t *texels;
    uint64_t length; /* of the whole edge, in texels */
    float t0, t1;    /* the stretch; t1 < t0 runs backwards */
};

static struct side edge_of(const check_context *check, int32_t face, unsigned edge, float t0,
                           float t1) {
    const slv_ptx_face *f = &check->faces[face];
    uint64_t w = UINT64_C(1) << f->res.u, h = UINT64_C(1) << f->res.v;
    uint64_t start = check->strip_starts[face];
    struct side side = {NULL, 1, t0, t1};
    if (!(f->flags & SLV_FACE_CONSTANT)) {
        start += check->nedges == 3 ? edge * w : slvi_edge_walked(edge, w, h);
        side.length = check->nedges == 3 || !slvi_edge_along_v(edge) ? w : h;
    }
    side.texels = check->strips + start * check->pixel_size;
    return side;
}

static uint64_t stretch_length(const struct side *side) {
    float length = fabsf(side->t1 - side->t0) * (float)side->length;
    return length < 1 ? 1 : (uint64_t)length;
}

/* A channel at `s` along the stretch, linear between texel centres. */
static float value_at(const check_context *check, const struct side *side, float s,
                      uint32_t channel) {
    float at = (side->t0 + (side->t1 - side->t0) * s) * (float)side->length - 0.5f;
    float weight, a, b;
    uint64_t low = slvi_linear_at(at, (uint32_t)side->length - 1, &weight);
    uint64_t high = low + 1 < side->length ? low + 1 : low;
    size_t value = slv_type_size(check->info->type);
    slv_type_to_float(check->info->type, side->texels + low * check->pixel_size + channel * value,
                      1, &a);
    slv_type_to_float(check->info->type, side->texels + high * check->pixel_size + channel * value,
                      1, &b);
    return weight > 0 ? a + (b - a) * weight : a;
}

static void compare_sides(check_context *check, const slv_check_finding *place,
                          const struct side *here, const struct side *there, int32_t other,
                          unsigned other_edge) {
    uint64_t a = stretch_length(here), b = stretch_length(there), n = a > b ? a : b;
    slv_check_finding finding = *place;
    float where = 0;
    uint32_t channel = 0;
    for (uint64_t i = 0; i < n; i++)
        for (uint32_t c = 0; c < check->info->nchannels; c++) {
            float s = ((float)i + 0.5f) / (float)n;
            float difference = fabsf(value_at(check, here, s, c) - value_at(check, there, s, c));
            if (difference > finding.amount) {
                finding.amount = difference;
                where = here->t0 + (here->t1 - here->t0) * s;
                channel = c;
            }
        }
    check->report->nseams++;
    bool worst = finding.amount > check->report->worst_seam.amount;
    if (worst)
        check->report->worst_seam = finding;
    if (finding.amount > check->params.seam_tolerance)
        slvi_check_find(
            check->findings, &finding,
            "face %d edge %d: differs by %g from face %d edge %u, at %.3g along the edge in "
            "channel %u",
            finding.face, finding.edge, (double)finding.amount, other, other_edge, (double)where,
            channel);
}

static void check_seam(check_context *check, int32_t face, unsigned edge) {
    const slv_face_adjacency *a = &check->faces[face].adjacency;
    int32_t there = a->face[edge];
    unsigned there_edge = a->edge[edge];
    slv_check_finding place = {
        .kind = SLV_CHECK_SEAMS, .warning = true, .face = face, .edge = (int32_t)edge, .level = -1};
    if (there < 0 || there_edge >= check->nedges || check->unread[face] || check->unread[there])
        return;
    bool sub = check->faces[face].flags & SLV_FACE_SUBFACE,
         there_sub = check->faces[there].flags & SLV_FACE_SUBFACE;
    if (sub == there_sub || check->nedges == 3) {
        const slv_face_adjacency *back = &check->faces[there].adjacency;
        bool mutual = back->face[there_edge] == face && back->edge[there_edge] == edge;
        if (mutual && (there < face || (there == face && there_edge < edge)))
            return;
        struct side here = edge_of(check, face, edge, 0, 1),
                    other = edge_of(check, there, there_edge, 1, 0);
        compare_sides(check, &place, &here, &other, there, there_edge);
    } else if (sub) {
        /* half of the whole quad's edge: the first half belongs to the sub-face that it names */
        const slv_face_adjacency *quad = &check->faces[there].adjacency;
        bool first = quad->face[there_edge] == face && quad->edge[there_edge] == edge;
        struct side here = edge_of(check, face, edge, 0, 1),
                    other = edge_of(check, there, there_edge, first ? 0.5f : 1, first ? 0 : 0.5f);
        compare_sides(check, &place, &here, &other, there, there_edge);
    }
}

slv_result slvi_check_seams(check_context *check) {
    for (uint32_t face = 0; face < check->info->nfaces; face++)
        for (unsigned edge = 0; edge < check->nedges; edge++)
            check_seam(check, (int32_t)face, edge);
    return SLV_OK;
}
