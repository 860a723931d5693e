/* The symmetry of a mesh by how its faces meet: which face is another's mirror image, and patches
 * put onto both. Corner k of a face lies on corner turn - k of its image, modulo 4. */
#include "canvas/lay_data.h"

#include "base/log.h"
#include "base/memory.h"
#include "texture/bilinear.h"

#include <stdlib.h>
#include <string.h>

typedef struct image {
    uint32_t face; /* SLVI_NONE: it has none */
    uint8_t turn;
} image;

struct slv_symmetry {
    uint32_t nfaces;
    image images[];
};

/* Patches with their images, from dab to dab. */
struct slvi_mirrored {
    slv_patch *list;
    uint64_t room;
    float *coverage, *colors;
    uint64_t coverage_room, color_room;
    uint32_t *from; /* per face: one more than its patch, in `round` */
    uint32_t *rounds, round;
    uint32_t *index; /* per face: one more than the patch that is mirrored, 0 between dabs */
};

/* The images of the faces beyond the edges of a face and of its own image, if they meet alike. */
static void pair_neighbours(const slv_adjacency *adjacency, slv_symmetry *s, uint32_t face,
                            uint32_t *queue, uint32_t *count) {
    const image own = s->images[face];
    for (unsigned edge = 0; edge < 4; edge++) {
        slv_neighbour a[2], b[2];
        unsigned other = (own.turn - edge - 1) & 3;
        uint32_t n = slv_adjacency_neighbours(adjacency, (int32_t)face, edge, a);
        if (n != slv_adjacency_neighbours(adjacency, (int32_t)own.face, other, b))
            continue;
        for (uint32_t i = 0; i < n; i++) {
            const slv_neighbour *x = &a[i], *y = &b[n - 1 - i];
            uint32_t f = (uint32_t)x->face, g = (uint32_t)y->face;
            if (s->images[f].face != SLVI_NONE || s->images[g].face != SLVI_NONE ||
                slv_adjacency_is_subface(adjacency, x->face) !=
                    slv_adjacency_is_subface(adjacency, y->face))
                continue;
            uint8_t turn = (uint8_t)((x->edge + y->edge + 1) & 3);
            s->images[f] = (image){g, turn};
            s->images[g] = (image){f, turn};
            queue[(*count)++] = f;
        }
    }
}

slv_result slv_symmetry_create(const slv_env *env, const slv_adjacency *adjacency,
                               const uint32_t face[2], const unsigned edge[2], slv_symmetry **out,
                               uint32_t *faces) {
    uint32_t n = slv_adjacency_face_count(adjacency), *queue = NULL, count = 0, have = 0;
    slv_symmetry *s = NULL;
    *out = NULL;
    if (face[0] >= n || face[1] >= n || edge[0] > 3 || edge[1] > 3 ||
        slv_adjacency_is_subface(adjacency, (int32_t)face[0]) !=
            slv_adjacency_is_subface(adjacency, (int32_t)face[1]))
        return slvi_fail(env, SLV_ERROR_ARGUMENT,
                         "symmetry: edge %u of face %u and edge %u of face %u are no pair", edge[0],
                         (unsigned)face[0], edge[1], (unsigned)face[1]);
    slv_result result = slvi_alloc(env, "symmetry", n, sizeof *queue, &queue);
    if (!result)
        result = slvi_alloc(env, "symmetry", 1, sizeof *s + (uint64_t)n * sizeof *s->images, &s);
    if (result) {
        slvi_free(queue);
        return result;
    }
    s->nfaces = n;
    for (uint32_t f = 0; f < n; f++)
        s->images[f] = (image){SLVI_NONE, 0};
    uint8_t turn = (uint8_t)((edge[0] + edge[1] + 1) & 3);
    s->images[face[0]] = (image){face[1], turn};
    s->images[face[1]] = (image){face[0], turn};
    queue[count++] = face[0];
    for (uint32_t i = 0; i < count; i++)
        pair_neighbours(adjacency, s, queue[i], queue, &count);
    for (uint32_t f = 0; f < n; f++)
        have += s->images[f].face != SLVI_NONE;
    slvi_free(queue);
    if (faces)
        *faces = have;
    *out = s;
    return SLV_OK;
}

void slv_symmetry_destroy(slv_symmetry *symmetry) {
    slvi_free(symmetry);
}

bool slv_symmetry_apply(const slv_symmetry *symmetry, slv_surface_point *point) {
    if (point->face < 0 || (uint32_t)point->face >= symmetry->nfaces ||
        symmetry->images[point->face].face == SLVI_NONE)
        return false;
    const image to = symmetry->images[point->face];
    float u = point->u, v = point->v;
    *point = (slv_surface_point){(int32_t)to.face, 0, 0};
    for (unsigned k = 0; k < 4; k++) {
        float share = slvi_bilinear_share(u, v, slvi_corner_u(k) | slvi_corner_v(k) << 1);
        point->u += share * (float)slvi_corner_u(to.turn - k);
        point->v += share * (float)slvi_corner_v(to.turn - k);
    }
    return true;
}

static void end_mirrored(struct slvi_mirrored *m) {
    slvi_free(m->list);
    slvi_free(m->coverage);
    slvi_free(m->colors);
    slvi_free(m->from);
    slvi_free(m->rounds);
    slvi_free(m->index);
    slvi_free(m);
}

static slv_result begin_mirrored(slv_painter *p) {
    struct slvi_mirrored *m = NULL;
    slv_result result;
    if (p->mirrored)
        return SLV_OK;
    if ((result = slvi_alloc(&p->env, "symmetry", 1, sizeof *m, &m)))
        return result;
    if ((result = slvi_alloc(&p->env, "symmetry", p->surface->nfaces, sizeof *m->from, &m->from)) ||
        (result =
             slvi_alloc(&p->env, "symmetry", p->surface->nfaces, sizeof *m->rounds, &m->rounds)) ||
        (result =
             slvi_alloc(&p->env, "symmetry", p->surface->nfaces, sizeof *m->index, &m->index))) {
        end_mirrored(m);
        return result;
    }
    p->mirrored = m;
    p->end_mirrored = end_mirrored;
    return SLV_OK;
}

/* The rectangle of a face's texels whose middles are images of those of another one's. */
static slv_rect mirror_rect(const slvi_laying *w, const slv_patch *patch, uint32_t to) {
    slv_res from = w->res[patch->face], res = w->res[to];
    slv_rect r = patch->rect;
    slv_surface_point a = {(int32_t)patch->face, ldexpf((float)r.x, -from.u),
                           ldexpf((float)r.y, -from.v)},
                      b = {(int32_t)patch->face, ldexpf((float)(r.x + r.width), -from.u),
                           ldexpf((float)(r.y + r.height), -from.v)};
    if (!slv_symmetry_apply(w->lay->symmetry, &a) || !slv_symmetry_apply(w->lay->symmetry, &b))
        return (slv_rect){0};
    float u0 = ldexpf(fminf(a.u, b.u), res.u), u1 = ldexpf(fmaxf(a.u, b.u), res.u),
          v0 = ldexpf(fminf(a.v, b.v), res.v), v1 = ldexpf(fmaxf(a.v, b.v), res.v);
    /* middles within, with room for rounding */
    int64_t x0 = (int64_t)ceilf(u0 - 0.501f), x1 = (int64_t)floorf(u1 - 0.499f) + 1,
            y0 = (int64_t)ceilf(v0 - 0.501f), y1 = (int64_t)floorf(v1 - 0.499f) + 1;
    x0 = x0 > 0 ? x0 : 0;
    y0 = y0 > 0 ? y0 : 0;
    x1 = x1 < (int64_t)1 << res.u ? x1 : (int64_t)1 << res.u;
    y1 = y1 < (int64_t)1 << res.v ? y1 : (int64_t)1 << res.v;
    if (x1 <= x0 || y1 <= y0)
        return (slv_rect){0};
    return (slv_rect){(uint32_t)x0, (uint32_t)y0, (uint32_t)(x1 - x0), (uint32_t)(y1 - y0)};
}

static void enclose(slv_rect *r, slv_rect with) {
    if (!r->width) {
        *r = with;
        return;
    }
    uint32_t x1 = r->x + r->width, y1 = r->y + r->height, wx = with.x + with.width,
             wy = with.y + with.height;
    r->x = r->x < with.x ? r->x : with.x;
    r->y = r->y < with.y ? r->y : with.y;
    r->width = (x1 > wx ? x1 : wx) - r->x;
    r->height = (y1 > wy ? y1 : wy) - r->y;
}

/* Notes a face with texels that are painted on. */
static slv_result add(slvi_laying *w, uint32_t face, slv_rect rect, slv_patches *out) {
    slv_painter *p = w->p;
    struct slvi_mirrored *m = p->mirrored;
    if (!rect.width || w->p->surface->segments[face] == 0)
        return SLV_OK;
    if (m->rounds[face] != m->round) {
        slv_result result =
            slvi_painter_room(p, (uint64_t)out->count + 1, sizeof *m->list, &m->list, &m->room);
        if (result)
            return result;
        m->rounds[face] = m->round;
        m->list[out->count++] = (slv_patch){
            face, {0}, NULL, slv_paint_surface_texel_area(p->surface, face, w->res[face])};
        m->from[face] = out->count;
    }
    enclose(&m->list[m->from[face] - 1].rect, rect);
    return SLV_OK;
}

static int by_face(const void *a, const void *b) {
    uint32_t x = ((const slv_patch *)a)->face, y = ((const slv_patch *)b)->face;
    return (x > y) - (x < y);
}

/* Which texel of the patches holds a point, or -1. */
static int64_t find_texel(const slvi_laying *w, slv_surface_point at, const uint32_t *index) {
    if (index[at.face] == 0)
        return -1;
    const slv_patch *patch = &w->patches->list[index[at.face] - 1];
    slv_res res = w->res[at.face];
    int64_t x = (int64_t)floorf(ldexpf(at.u, res.u)) - patch->rect.x,
            y = (int64_t)floorf(ldexpf(at.v, res.v)) - patch->rect.y;
    if (x < 0 || y < 0 || x >= patch->rect.width || y >= patch->rect.height)
        return -1;
    return (int64_t)w->starts[index[at.face] - 1] + y * patch->rect.width + x;
}

/* The larger of what a texel and its image have. `index`: one more than each face's patch. */
static void fill(const slvi_laying *w, const slv_patch *patch, const uint32_t *index,
                 float *coverage, float *colors) {
    const slv_patch *list = w->patches->list;
    for (uint32_t i = 0; i < patch->rect.width * patch->rect.height; i++) {
        slv_surface_point at[2];
        at[0] = slvi_texel_point(patch->face, w->res[patch->face],
                                 patch->rect.x + i % patch->rect.width,
                                 patch->rect.y + i / patch->rect.width);
        at[1] = at[0];
        bool has = slv_symmetry_apply(w->lay->symmetry, &at[1]);
        coverage[i] = 0;
        for (int k = 0; k < 1 + has; k++) {
            int64_t texel = find_texel(w, at[k], index);
            if (texel < 0)
                continue;
            uint32_t which = index[at[k].face] - 1;
            float c = list[which].coverage[texel - (int64_t)w->starts[which]];
            if (!(c > coverage[i]))
                continue;
            coverage[i] = c;
            if (w->colors)
                memcpy(colors + (size_t)i * SLV_PAINT_CHANNELS,
                       w->colors + texel * SLV_PAINT_CHANNELS, SLV_PAINT_CHANNELS * sizeof *colors);
        }
    }
}

slv_result slvi_lay_mirror(slvi_laying *w, slv_patches *out, float **colors) {
    slv_painter *p = w->p;
    const slv_symmetry *s = w->lay->symmetry;
    *out = (slv_patches){0};
    if (s->nfaces != w->desc.nfaces)
        return slvi_fail(&p->env, SLV_ERROR_MISMATCH, "symmetry: of %u faces, for %u",
                         (unsigned)s->nfaces, (unsigned)w->desc.nfaces);
    slv_result result = begin_mirrored(p);
    if (result)
        return result;
    struct slvi_mirrored *m = p->mirrored;
    m->round++;
    for (uint32_t i = 0; i < w->patches->count && !result; i++) {
        const slv_patch *patch = &w->patches->list[i];
        const image to = s->images[patch->face];
        m->index[patch->face] = i + 1;
        result = add(w, patch->face, patch->rect, out);
        if (!result && to.face != SLVI_NONE)
            result = add(w, to.face, mirror_rect(w, patch, to.face), out);
    }
    for (uint32_t i = 0; i < out->count; i++)
        out->ntexels += (uint64_t)m->list[i].rect.width * m->list[i].rect.height;
    if (!result && out->count)
        qsort(m->list, out->count, sizeof *m->list, by_face);
    if (!result)
        result = slvi_painter_room(p, out->ntexels + 1, sizeof *m->coverage, &m->coverage,
                                   &m->coverage_room);
    if (!result && w->colors)
        result = slvi_painter_room(p, out->ntexels * SLV_PAINT_CHANNELS + 1, sizeof *m->colors,
                                   &m->colors, &m->color_room);
    uint64_t at = 0;
    for (uint32_t i = 0; i < out->count && !result; i++) {
        m->list[i].coverage = m->coverage + at;
        fill(w, &m->list[i], m->index, m->coverage + at,
             w->colors ? m->colors + at * SLV_PAINT_CHANNELS : NULL);
        at += (uint64_t)m->list[i].rect.width * m->list[i].rect.height;
    }
    out->list = m->list;
    *colors = w->colors ? m->colors : NULL;
    for (uint32_t i = 0; i < w->patches->count; i++)
        m->index[w->patches->list[i].face] = 0;
    return result;
}
