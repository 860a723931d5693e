/* Levels with a border: the interior, sides and corners filled in. */
#include "form/borders/border_data.h"

#include "base/half.h"
#include "base/log.h"
#include "texture/bilinear.h"

#include <string.h>

/* One call of slv_border_build: the level, and where its texels go. */
typedef struct build {
    slv_border_view view;
    uint32_t face, level;
    slv_res res;
    int32_t bu, bv;
    ptrdiff_t pitch; /* floats from row to row of `out` */
    size_t nchannels, value_size;
    float *out;
} build;

static float *texel_at(const build *b, int32_t x, int32_t y) {
    return b->out + (y + b->bv) * b->pitch + (x + b->bu) * (ptrdiff_t)b->nchannels + b->view.first;
}

static void store(const build *b, int32_t x, int32_t y, const float *raw) {
    float *to = texel_at(b, x, y);
    for (uint32_t c = 0; c < b->view.count; c++)
        to[c] = raw[c] / b->view.one;
}

static void copy_interior(const build *b) {
    int32_t width = 1 << b->res.u, height = 1 << b->res.v;
    size_t row = (size_t)width * b->nchannels;
    const unsigned char *from = slv_levels_texels(b->view.levels, b->face, b->level);
    slv_type type = b->view.levels->desc.type;
    for (int32_t y = 0; y < height; y++, from += row * b->value_size)
        slv_type_to_float(type, from, row, texel_at(b, 0, y));
}

/* Copies `count` texels; steps are in values and floats, and may be negative. */
static void copy_run(const build *b, const unsigned char *from, ptrdiff_t from_step, float *to,
                     ptrdiff_t to_step, uint32_t count) {
    slv_type type = b->view.levels->desc.type;
    uint32_t channels = b->view.count;
    ptrdiff_t texel = (ptrdiff_t)b->nchannels;
    if (from_step == texel && to_step == texel && channels == b->nchannels) {
        slv_type_to_float(type, from, count * b->nchannels, to);
    } else if (type == SLV_TYPE_U8) {
        for (uint32_t i = 0; i < count; i++, from += from_step, to += to_step)
            for (uint32_t c = 0; c < channels; c++)
                to[c] = (float)from[c] / 255.0f;
    } else if (type == SLV_TYPE_U16) {
        const uint16_t *at = (const uint16_t *)(const void *)from;
        for (uint32_t i = 0; i < count; i++, at += from_step, to += to_step)
            for (uint32_t c = 0; c < channels; c++)
                to[c] = (float)at[c] / 65535.0f;
    } else if (type == SLV_TYPE_HALF) {
        const uint16_t *at = (const uint16_t *)(const void *)from;
        for (uint32_t i = 0; i < count; i++, at += from_step, to += to_step)
            for (uint32_t c = 0; c < channels; c++)
                to[c] = slvi_half_to_float(at[c]);
    } else {
        const float *at = (const float *)(const void *)from;
        for (uint32_t i = 0; i < count; i++, at += from_step, to += to_step)
            memcpy(to, at, channels * sizeof *to);
    }
}

/* Fills border row `depth` (1 is next to the edge) at indices j0..j1-1 with texels of a face, row
 * `from_depth` of edge `from_edge`, index from_j for j0 and on in direction `sign`. Both ends of
 * the copy count in their own way, which takes that many parameters. */
static void copy_strip(const build *b, uint32_t edge, int32_t depth, uint32_t j0, uint32_t j1,
                       uint32_t from_face, uint32_t from_level, uint32_t from_edge,
                       int32_t from_depth, uint32_t from_j, int sign) {
    slv_res res = slvi_level_res(b->view.levels, from_face, from_level);
    int32_t x, y, from_x, from_y;
    slvi_res_edge_texel(b->res, edge, (int32_t)j0, -depth, &x, &y);
    slvi_res_edge_texel(res, from_edge, (int32_t)from_j, from_depth, &from_x, &from_y);
    const unsigned char *from = slv_levels_texels(b->view.levels, from_face, from_level);
    size_t value = (((size_t)from_y << res.u) + (size_t)from_x) * b->nchannels + b->view.first;
    ptrdiff_t texel = (ptrdiff_t)b->nchannels, step = slvi_edge_step(edge, texel, b->pitch);
    float *to = texel_at(b, x, y);
    copy_run(b, from + value * b->value_size,
             sign * slvi_edge_step(from_edge, texel, texel << res.u), to, step, j1 - j0);
    if (sign < 0 && b->view.levels->vectors)
        for (uint32_t j = j0; j < j1; j++, to += step)
            slvi_border_turn(&b->view, slvi_edge_turns(edge, from_edge), to);
}

/* Bilinear inside a level, clamped to its outermost texel centres. */
static void sample(const build *b, uint32_t face, uint32_t level, float u, float v, float *out) {
    slv_res res = slvi_level_res(b->view.levels, face, level);
    slvi_bilinear at = slvi_bilinear_centred(res, u, v);
    float texel[4][SLV_BORDER_CHANNELS];
    const float *mixed[4] = {texel[0]};
    for (uint32_t k = 0; k < 4; k++) {
        if ((k & 1 && !(at.wx > 0.0f)) || (k & 2 && !(at.wy > 0.0f)))
            continue;
        slvi_border_fetch(&b->view, face, level, at.x + (k & 1), at.y + (k >> 1), texel[k]);
        mixed[k] = texel[k];
    }
    slvi_bilinear_mix(&at, mixed[0], mixed[1], mixed[2], mixed[3], b->view.count, out);
}

static float centre_u(const build *b, int32_t x) {
    return ((float)x + 0.5f) / (float)(1 << b->res.u);
}

static float centre_v(const build *b, int32_t y) {
    return ((float)y + 0.5f) / (float)(1 << b->res.v);
}

static void sample_strip(const build *b, const slv_border_edge *edge, const slv_border_link *link,
                         int32_t depth, uint32_t j0, uint32_t j1) {
    for (uint32_t j = j0; j < j1; j++) {
        int32_t x, y;
        float u, v, value[SLV_BORDER_CHANNELS];
        slvi_res_edge_texel(b->res, edge->edge, (int32_t)j, -depth, &x, &y);
        slv_affine_apply(&link->to.map, centre_u(b, x), centre_v(b, y), &u, &v);
        sample(b, (uint32_t)link->to.face, link->level, u, v, value);
        slvi_border_turn_across(&b->view, edge, link, value);
        store(b, x, y, value);
    }
}

/* The innermost row next to a coarser neighbour: 2E - own. */
static void mirror_strip(const build *b, const slv_border_edge *edge, const slv_border_link *link,
                         uint32_t j0, uint32_t j1) {
    slv_border_function function;
    slvi_border_function_begin(&b->view, link, &function);
    for (uint32_t j = j0; j < j1; j++) {
        int32_t x, y, own_x, own_y;
        float value[SLV_BORDER_CHANNELS], own[SLV_BORDER_CHANNELS];
        float t = ((float)j + 0.5f) / (float)(1u << edge->exponent);
        slvi_border_function_at(&b->view, &function, link->slope * t + link->offset, value);
        slvi_border_turn_across(&b->view, edge, link, value);
        slvi_res_edge_texel(b->res, edge->edge, (int32_t)j, -1, &x, &y);
        slvi_res_edge_texel(b->res, edge->edge, (int32_t)j, 0, &own_x, &own_y);
        slvi_border_fetch(&b->view, b->face, b->level, (uint32_t)own_x, (uint32_t)own_y, own);
        for (uint32_t c = 0; c < b->view.count; c++)
            value[c] = 2.0f * value[c] - own[c];
        store(b, x, y, value);
    }
}

/* The innermost row where the face's own texels that count on the edge are another level's. */
static void own_strip(const build *b, const slv_border_edge *edge, uint32_t j0, uint32_t j1) {
    for (uint32_t j = j0; j < j1; j++) {
        int32_t x, y;
        float value[SLV_BORDER_CHANNELS];
        slvi_border_across(&b->view, edge, j, value);
        slvi_res_edge_texel(b->res, edge->edge, (int32_t)j, -1, &x, &y);
        store(b, x, y, value);
    }
}

static void fill_link(const build *b, const slv_border_edge *edge, const slv_border_link *link,
                      int32_t depth_count, uint32_t j0, uint32_t j1) {
    uint32_t from_j = slvi_border_link_index(edge, link, j0);
    int32_t last = (1 << slvi_res_across(link->res, link->to.edge)) - 1;
    for (int32_t depth = 1; depth <= depth_count; depth++) {
        bool exact = link->relation == SLV_BORDER_EXACT;
        if (link->aligned || (depth == 1 && exact && link->own == b->level))
            copy_strip(b, edge->edge, depth, j0, j1, (uint32_t)link->to.face, link->level,
                       link->to.edge, depth - 1 < last ? depth - 1 : last, from_j, -1);
        else if (depth == 1 && exact)
            own_strip(b, edge, j0, j1);
        else if (depth == 1)
            mirror_strip(b, edge, link, j0, j1);
        else
            sample_strip(b, edge, link, depth, j0, j1);
    }
}

static void fill_boundary(const build *b, const slv_border_edge *edge, int32_t depth_count,
                          uint32_t j0, uint32_t j1) {
    for (int32_t depth = 1; j0 < j1 && depth <= depth_count; depth++)
        copy_strip(b, edge->edge, depth, j0, j1, b->face, b->level, edge->edge, 0, j0, 1);
}

/* One texel along the edge, and two sub-faces across it: the mean of both. */
static void fill_single(const build *b, const slv_border_edge *edge, int32_t depth_count) {
    for (int32_t depth = 1; depth <= depth_count; depth++) {
        int32_t x, y;
        float value[SLV_BORDER_CHANNELS], half[SLV_BORDER_CHANNELS];
        slvi_res_edge_texel(b->res, edge->edge, 0, -depth, &x, &y);
        if (depth == 1) {
            slvi_border_across(&b->view, edge, 0, value);
        } else {
            memset(value, 0, sizeof value);
            for (uint32_t i = 0; i < edge->nlinks; i++) {
                const slv_border_link *link = &edge->links[i];
                float u, v;
                slv_affine_apply(&link->to.map, centre_u(b, x), centre_v(b, y), &u, &v);
                sample(b, (uint32_t)link->to.face, link->level, u, v, half);
                slvi_border_turn_across(&b->view, edge, link, half);
                for (uint32_t c = 0; c < b->view.count; c++)
                    value[c] += half[c] / (float)edge->nlinks;
            }
        }
        store(b, x, y, value);
    }
}

static void fill_side(const build *b, const slv_border_edge *edge) {
    int32_t depth_count = slvi_edge_across(edge->edge, b->bu, b->bv);
    uint32_t n = 1u << edge->exponent;
    if (edge->nlinks && edge->links[0].relation == SLV_BORDER_FINER) {
        fill_single(b, edge, depth_count);
        return;
    }
    uint32_t next = 0;
    for (uint32_t i = 0; i < edge->nlinks; i++) {
        const slv_border_link *link = &edge->links[i];
        uint32_t j0 = (uint32_t)(link->to.t0 * (float)n), j1 = (uint32_t)(link->to.t1 * (float)n);
        fill_boundary(b, edge, depth_count, next, j0);
        fill_link(b, edge, link, depth_count, j0, j1);
        next = j1;
    }
    fill_boundary(b, edge, depth_count, next, n);
}

/* The two ways around a corner: across its first edge and on, and across the other. */
typedef struct corner_path {
    bool leaves;    /* false: a boundary at once */
    unsigned turns; /* of the first face on it */
    slv_border_link link;
    slv_border_edge onward;
} corner_path;

static void path_begin(const build *b, const slv_border_edge *edge, bool at_end, corner_path *out) {
    out->leaves = false;
    for (uint32_t i = 0; i < edge->nlinks; i++) {
        if (at_end ? edge->links[i].to.t1 < 1.0f : edge->links[i].to.t0 > 0.0f)
            continue;
        out->leaves = true;
        out->link = edge->links[i];
        out->turns = slvi_edge_turns(edge->edge, out->link.to.edge);
        /* Counter-clockwise around the far side: past the end of this edge begins the edge before
         * the neighbour's. */
        uint32_t onward =
            at_end ? slvi_edge_before(out->link.to.edge) : slvi_edge_next(out->link.to.edge);
        out->onward =
            slvi_border_edge_at(&b->view, (uint32_t)out->link.to.face, out->link.level, onward);
    }
}

/* Looks a point up along a path. Returns 2 if it got around the corner, 1 if it stopped at a
 * boundary after the first edge, 0 if it could not leave. */
static int path_sample(const build *b, const corner_path *path, float u, float v, float *out) {
    if (!path->leaves)
        return 0;
    const slv_border_edge *onward = &path->onward;
    slv_affine_apply(&path->link.to.map, u, v, &u, &v);
    /* From the middle of a whole quad's edge, the quad goes straight on. */
    if (!(slvi_edge_depth(onward->edge, u, v) < 0.0f)) {
        sample(b, (uint32_t)path->link.to.face, path->link.level, u, v, out);
        slvi_border_turn(&b->view, path->turns, out);
        return 2;
    }
    float t = slvi_edge_t(onward->edge, u, v);
    const slv_border_link *link = NULL;
    for (uint32_t i = 0; i < onward->nlinks; i++) {
        const slv_neighbour *to = &onward->links[i].to;
        if ((t >= to->t0 || to->t0 <= 0.0f) && (t < to->t1 || to->t1 >= 1.0f))
            link = &onward->links[i];
    }
    if (!link) {
        sample(b, (uint32_t)path->link.to.face, path->link.level, u, v, out);
        slvi_border_turn(&b->view, path->turns, out);
        return 1;
    }
    slv_affine_apply(&link->to.map, u, v, &u, &v);
    sample(b, (uint32_t)link->to.face, link->level, u, v, out);
    slvi_border_turn(&b->view, path->turns + slvi_edge_turns(onward->edge, link->to.edge), out);
    return 2;
}

/* A border texel beyond a corner, where the two ways around may lead to different places. */
static void fill_beyond(const build *b, const corner_path paths[2], const float *own, int32_t x,
                        int32_t y) {
    float value[2][SLV_BORDER_CHANNELS];
    float u = centre_u(b, x), v = centre_v(b, y);
    int got[2] = {path_sample(b, &paths[0], u, v, value[0]),
                  path_sample(b, &paths[1], u, v, value[1])};
    if (got[0] == 0 && got[1] == 0) {
        store(b, x, y, own);
        return;
    }
    for (uint32_t c = 0; got[0] == got[1] && c < b->view.count; c++)
        value[0][c] = 0.5f * (value[0][c] + value[1][c]);
    store(b, x, y, got[0] >= got[1] ? value[0] : value[1]);
}

static void fill_corner(const build *b, const slv_border_edge edges[4], uint32_t corner) {
    const slv_border_edge *starts = &edges[corner], *ends = &edges[slvi_edge_before(corner)];
    int32_t own_x, own_y;
    int32_t step_x = slvi_corner_u(corner) ? 1 : -1, step_y = slvi_corner_v(corner) ? 1 : -1;
    float own[SLV_BORDER_CHANNELS], m[SLV_BORDER_CHANNELS], d[SLV_BORDER_CHANNELS],
        across[2][SLV_BORDER_CHANNELS];
    slvi_res_corner_texel(b->res, corner, &own_x, &own_y);
    slvi_border_fetch(&b->view, b->face, b->level, (uint32_t)own_x, (uint32_t)own_y, own);
    if (b->bu > 1 || b->bv > 1) {
        corner_path paths[2];
        path_begin(b, starts, false, &paths[0]);
        path_begin(b, ends, true, &paths[1]);
        for (int32_t y = 1; y <= b->bv; y++)
            for (int32_t x = 1; x <= b->bu; x++)
                if (x > 1 || y > 1)
                    fill_beyond(b, paths, own, own_x + step_x * x, own_y + step_y * y);
    }
    const slv_corner *opposite =
        slvi_border_opposite(b->view.levels, b->view.adjacency, b->face, corner);
    if (opposite) {
        int32_t x, y;
        slvi_res_corner_texel(b->res, opposite->corner, &x, &y);
        slvi_border_fetch(&b->view, (uint32_t)opposite->face, b->level, (uint32_t)x, (uint32_t)y,
                          d);
    } else if (!slvi_border_vertex_value(&b->view, b->face, b->level, corner, m, d)) {
        slvi_border_across(&b->view, starts, 0, across[0]);
        slvi_border_across(&b->view, ends, (1u << ends->exponent) - 1, across[1]);
        for (uint32_t c = 0; c < b->view.count; c++)
            d[c] = slv_border_diagonal(m[c], own[c], across[0][c], across[1][c]);
    }
    store(b, own_x + step_x, own_y + step_y, d);
}

#define HALF_MOST 65504.0f

static bool outside(const float *from, size_t count, float low, float high) {
    float least = 0.0f, most = 1.0f;
    for (size_t i = 0; i < count; i++) {
        least = from[i] < least ? from[i] : least;
        most = from[i] > most ? from[i] : most;
    }
    return least < low || most > high;
}

/* Whether a value of the innermost border, which alone can, is outside of a range. */
static bool rim_outside(const build *b, float low, float high) {
    int32_t width = 1 << b->res.u, height = 1 << b->res.v;
    size_t row = (size_t)(width + 2) * b->nchannels, n = b->nchannels;
    bool is = outside(texel_at(b, -1, -1), row, low, high) ||
              outside(texel_at(b, -1, height), row, low, high);
    for (int32_t y = 0; !is && y < height; y++)
        is = outside(texel_at(b, -1, y), n, low, high) ||
             outside(texel_at(b, width, y), n, low, high);
    return is;
}

/* The parameters are those of slv_border_build, and whether own texels are wanted, too. */
static slv_result build_level(const slv_levels *levels, const slv_adjacency *adjacency,
                              uint32_t face, uint32_t level, slv_form_extent extent, bool interior,
                              float *out, bool *out_of_range) {
    uint32_t bu = extent.border_u, bv = extent.border_v;
    const slv_texture_desc *desc = &levels->desc;
    if (slv_adjacency_face_count(adjacency) != desc->nfaces)
        return slvi_fail(&levels->env, SLV_ERROR_MISMATCH,
                         "border: %u faces of texture, %u of adjacency", (unsigned)desc->nfaces,
                         (unsigned)slv_adjacency_face_count(adjacency));
    if (face >= desc->nfaces || level >= slv_levels_count(levels, face))
        return slvi_fail(&levels->env, SLV_ERROR_ARGUMENT, "border: face %u of %u has no level %u",
                         (unsigned)face, (unsigned)desc->nfaces, (unsigned)level);
    slv_res res = slvi_level_res(levels, face, level);
    uint32_t width = 1u << res.u, height = 1u << res.v;
    if (bu < 1 || bv < 1 || bu > width || bv > height)
        return slvi_fail(&levels->env, SLV_ERROR_ARGUMENT,
                         "border: face %u level %u: a border of %u x %u around %u x %u texels",
                         (unsigned)face, (unsigned)level, (unsigned)bu, (unsigned)bv,
                         (unsigned)width, (unsigned)height);
    build b = {.view = slvi_border_view_begin(levels, adjacency),
               .face = face,
               .level = level,
               .res = res,
               .bu = (int32_t)bu,
               .bv = (int32_t)bv,
               .pitch = (ptrdiff_t)(width + 2 * bu) * (ptrdiff_t)desc->nchannels,
               .nchannels = desc->nchannels,
               .value_size = slv_type_size(desc->type),
               .out = out};
    slv_border_edge edges[4];
    for (uint32_t edge = 0; edge < 4; edge++)
        edges[edge] = slvi_border_edge_at(&b.view, face, level, edge);
    if (interior)
        copy_interior(&b);
    while (slvi_border_view_next(&b.view)) {
        for (uint32_t edge = 0; edge < 4; edge++)
            fill_side(&b, &edges[edge]);
        for (uint32_t corner = 0; corner < 4; corner++)
            fill_corner(&b, edges, corner);
    }
    if (out_of_range) {
        bool integers = desc->type == SLV_TYPE_U8 || desc->type == SLV_TYPE_U16;
        float low = integers ? -1e-6f : -HALF_MOST, high = integers ? 1 + 1e-6f : HALF_MOST;
        b.view.first = 0;
        *out_of_range = desc->type != SLV_TYPE_FLOAT && rim_outside(&b, low, high);
    }
    return SLV_OK;
}

slv_result slv_border_build(const slv_levels *levels, const slv_adjacency *adjacency, uint32_t face,
                            uint32_t level, uint32_t bu, uint32_t bv, float *out,
                            bool *out_of_range) {
    const slv_form_extent extent = {.border_u = bu, .border_v = bv};
    return build_level(levels, adjacency, face, level, extent, true, out, out_of_range);
}

slv_result slvi_border_build_rim(const slv_levels *levels, const slv_adjacency *adjacency,
                                 uint32_t face, uint32_t level, slv_form_extent extent, float *out,
                                 bool *out_of_range) {
    return build_level(levels, adjacency, face, level, extent, false, out, out_of_range);
}
