/* Template: kernels over edges, for most that cross any: the texels under one are copied to lie
 * side by side in a patch, turned as its face is, and summed up like those of one face. That is so
 * where all faces under it are plain and as fine, and four meet at a vertex; all others are taken
 * apart by seams_template.h. Which way a lookup takes depends on the file and the lookup alone,
 * never on what is cached. */
#ifndef SLV_FILTER_PATCH_TEMPLATE_H
#define SLV_FILTER_PATCH_TEMPLATE_H

#include "filter/seams_template.h"

/* Texels between the rows of a patch, which are copied in vectors. */
#define PATCH_GAP 16
#define PATCH_PIXEL 16 /* bytes of a texel at most */
/* How often texels of several faces are looked for, until all are there at once. A cache in which
 * they never are is too small for any other lookup, too. */
#define PATCH_TRIES 16

/* The texels start, ..., start + n - 1 of 2^res along an axis, and how many of them lie before the
 * face, on it and behind it. */
typedef struct patch_axis {
    int res, start;
    int parts[3];
} patch_axis;

/* Where a part's texels come from: the first, and how many bytes further the next are. */
typedef struct patch_source {
    const uint8_t *at;
    ptrdiff_t step_u, step_v;
} patch_source;

/* The nine parts of a patch; those along v of each along u. */
typedef struct patch {
    patch_axis a[2];
    patch_source parts[3][3];
} patch;

/* False if it reaches beyond the neighbours, or not onto the face. */
static inline bool patch_cut(int res, int start, int n, patch_axis *a) {
    int size = 1 << res, before = start < 0 ? -start : 0;
    int after = start + n > size ? start + n - size : 0;
    *a = (patch_axis){res, start, {before, n - before - after, after}};
    return before <= size && after <= size && a->parts[1] > 0;
}

/* Where a part begins in its own face as if that were turned alike. */
static inline ptrdiff_t patch_begin(const patch_axis *a, int part) {
    return part == 1 ? a->start + a->parts[0] : part ? 0 : (1 << a->res) - a->parts[0];
}

/* A part that lies on face `to`, whose axes are turned so many times. False if that has no such
 * texels, or when state says why. */
static inline bool patch_find_on(lookup_state *state, patch *p, int part_u, int part_v, uint32_t to,
                                 unsigned turns) {
    cache_face *g = lookup_face_at(state, to);
    int res_u = p->a[turns & 1].res, res_v = p->a[!(turns & 1)].res;
    if (!cache_is_plain(g) || res_u > g->res_u || res_v > g->res_v || res_u + res_v == 0 ||
        res_u + res_v > state->tables->whole_log2)
        return false;
    const uint8_t *texels = lookup_find_whole(state, to, g, res_u, res_v);
    if (!texels)
        return false;
    ptrdiff_t pixel = (ptrdiff_t)state->tables->pixel_size, row = pixel << res_u;
    ptrdiff_t x = patch_begin(&p->a[0], part_u), y = patch_begin(&p->a[1], part_v);
    ptrdiff_t last_x = (1 << p->a[0].res) - 1 - x, last_y = (1 << p->a[1].res) - 1 - y;
    patch_source *out = &p->parts[part_u][part_v];
    switch (turns & 3) {
    case 0:
        *out = (patch_source){texels + y * row + x * pixel, pixel, row};
        break;
    case 1:
        *out = (patch_source){texels + last_x * row + y * pixel, -row, pixel};
        break;
    case 2:
        *out = (patch_source){texels + last_y * row + last_x * pixel, -pixel, -row};
        break;
    default:
        *out = (patch_source){texels + x * row + last_y * pixel, row, -pixel};
    }
    return true;
}

/* A part beyond a border across an axis: what is beside it, over and over, or black. */
static inline void patch_find_border(const lookup_state *state, patch *p, int part_u, int part_v,
                                     bool across_v) {
    static const uint8_t black[PATCH_PIXEL];
    const cache_tables *t = state->tables;
    patch_source *out = &p->parts[part_u][part_v];
    if ((across_v ? t->border_v : t->border_u) == SLV_BORDER_BLACK) {
        *out = (patch_source){black, 0, 0};
        return;
    }
    *out = p->parts[across_v ? part_u : 1][across_v ? 1 : part_v];
    ptrdiff_t *step = across_v ? &out->step_v : &out->step_u;
    if ((across_v ? part_v : part_u) == 2)
        out->at += (p->a[across_v].parts[1] - 1) * *step;
    *step = 0;
}

/* The part behind a vertex that no border ends at. False if not four faces meet there. */
static bool patch_find_corner(lookup_state *state, patch *p, uint32_t face, const cache_face *f,
                              int part_u, int part_v) {
    unsigned corner = slvi_corner_at(part_u == 2, part_v == 2), leave = corner, turns = 0;
    const cache_face *at = f;
    uint32_t to = face, behind = face;
    for (int i = 0; i < 4; i++) {
        if (at->adjacent[leave] < 0 || !cache_is_plain(at) || (i && to == face && leave == corner))
            return false;
        to = (uint32_t)at->adjacent[leave];
        leave = slvi_edge_next((unsigned)adjacent_edge(at, (int)leave));
        at = lookup_face_at(state, to);
        if (i == 1) {
            behind = to;
            turns = slvi_edge_turns(corner, leave);
        }
    }
    return to == face && leave == corner && patch_find_on(state, p, part_u, part_v, behind, turns);
}

static inline bool patch_find_part(lookup_state *state, patch *p, uint32_t face,
                                   const cache_face *f, int part_u, int part_v) {
    if (part_u == 1 && part_v == 1)
        return patch_find_on(state, p, 1, 1, face, 0);
    unsigned across_u = slvi_edge_at(false, part_u == 2),
             across_v = slvi_edge_at(true, part_v == 2);
    if (part_u != 1 && f->adjacent[across_u] < 0)
        patch_find_border(state, p, part_u, part_v, false);
    else if (part_v != 1 && f->adjacent[across_v] < 0)
        patch_find_border(state, p, part_u, part_v, true);
    else if (part_u != 1 && part_v != 1)
        return patch_find_corner(state, p, face, f, part_u, part_v);
    else {
        int edge = (int)(part_u != 1 ? across_u : across_v);
        return patch_find_on(state, p, part_u, part_v, (uint32_t)f->adjacent[edge],
                             slvi_edge_turns((unsigned)edge, (unsigned)adjacent_edge(f, edge)));
    }
    return true;
}

/* Finds the parts of a patch on a plain face and around it. False if it is none of those that can
 * be made, or when state says why. */
static bool patch_find(lookup_state *state, uint32_t face, const cache_face *f, patch *p) {
    static const int order[3] = {1, 0, 2}; /* borders repeat what is beside them */
    const cache_thread *thread = &state->sampler->thread;
    for (int tries = 0; tries < PATCH_TRIES; tries++) {
        uint64_t moves = thread->moves;
        for (int i = 0; i < 3; i++) {
            if (!p->a[0].parts[order[i]])
                continue;
            for (int j = 0; j < 3; j++)
                if (p->a[1].parts[order[j]] &&
                    !patch_find_part(state, p, face, f, order[i], order[j]))
                    return false;
        }
        /* what was found is worth nothing once the pin was let go */
        if (thread->moves == moves)
            return true;
    }
    return false;
}

#define PATCH_COPY(BYTES)                                                                          \
    for (int y = 0; y < height; y++)                                                               \
    memcpy(to + (size_t)y * row, at + y * from->step_v, BYTES)

/* Copies a part to rows that are `row` bytes apart, and up to 15 bytes more behind each. */
static inline __attribute__((always_inline)) void patch_copy_part(const patch_source *from,
                                                                  size_t pixel, int width,
                                                                  int height, size_t row,
                                                                  uint8_t *to) {
    const uint8_t *at = from->at, *end = to + (size_t)width * pixel;
    if (from->step_u == (ptrdiff_t)pixel)
        for (; to < end; to += 16, at += 16)
            PATCH_COPY(16);
    else if (pixel <= 8)
        for (; to < end; to += pixel, at += from->step_u)
            PATCH_COPY(8);
    else
        for (; to < end; to += pixel, at += from->step_u)
            PATCH_COPY(16);
}

/* Copies its texels to rows `pitch` texels apart, from left to right: what is too much of a part is
 * overwritten by the next, or lies between the rows. */
static void patch_copy(const patch *p, size_t pixel, size_t pitch, uint8_t *to) {
    const int *width = p->a[0].parts, *height = p->a[1].parts;
    size_t row = pitch * pixel;
    for (int part_v = !height[0]; part_v < 3 && height[part_v]; part_v++) {
        uint8_t *part = to;
        for (int part_u = !width[0]; part_u < 3 && width[part_u]; part_u++) {
            patch_copy_part(&p->parts[part_u][part_v], pixel, width[part_u], height[part_v], row,
                            part);
            part += (size_t)width[part_u] * pixel;
        }
        to += (size_t)height[part_v] * row;
    }
}

/* Sums up the texels under a kernel that reaches beyond a plain face. False, and nothing was
 * summed, if it must be taken apart, or when state says why. */
static bool patch_apply(lookup_state *state, uint32_t face, const cache_face *f, kernel *k) {
    uint8_t texels[(KERNEL_MAX + PATCH_GAP) * KERNEL_MAX * PATCH_PIXEL + CACHE_PADDING];
    patch p;
    if (!patch_cut(k->a[0].res, k->a[0].start, k->a[0].n, &p.a[0]) ||
        !patch_cut(k->a[1].res, k->a[1].start, k->a[1].n, &p.a[1]) ||
        !patch_find(state, face, f, &p))
        return false;
    size_t pitch = (size_t)k->a[0].n + PATCH_GAP;
    patch_copy(&p, state->tables->pixel_size, pitch, texels);
    k->a[0].start = k->a[1].start = 0;
    v4f sum = gather_few(state->tables, texels, pitch, k);
    for (uint32_t c = 0; c < state->count; c++)
        state->sum[c] += sum[state->first + c];
    return true;
}

#endif
