/* Fills by colour: texels that hang together and are alike, over edges of faces too. */
#include "canvas/lay_data.h"

#include "adjacency/edge.h"
#include "base/log.h"
#include "base/memory.h"

#include <string.h>

enum { TAKEN = 2 };

typedef struct texel {
    uint32_t face, x, y;
} texel;

typedef struct flood {
    slv_painter *p;
    const slv_canvas *canvas;
    slv_canvas_desc desc;
    float tolerance, color[64];
    uint8_t *
        *alike; /* per face, once it was reached: 1 alike, from TAKEN on taken from that seed */
    uint32_t *turns; /* per face: the seed that was last looked at with, from 1 on */
    uint32_t seed;
    float *texels; /* of one face */
    uint64_t texel_room;
    texel *stack;
    uint64_t count, room, taken;
} flood;

/* Which texels of a face are alike, when it is first reached. */
static slv_result reach(flood *f, uint32_t face) {
    slv_res res = f->desc.res[face];
    const slv_rect all = {0, 0, 1u << res.u, 1u << res.v};
    uint64_t count = (uint64_t)all.width * all.height, n = f->desc.nchannels;
    slv_result result;
    if (f->turns[face] == f->seed + 1)
        return SLV_OK;
    if ((result =
             slvi_painter_room(f->p, count * n, sizeof *f->texels, &f->texels, &f->texel_room)) ||
        (result = f->canvas->fns->read(f->canvas->user, face, all, f->texels)) ||
        (!f->alike[face] && (result = slvi_alloc(&f->p->env, "fill", count, 1, &f->alike[face]))))
        return result;
    f->turns[face] = f->seed + 1;
    for (uint64_t i = 0; i < count; i++) {
        bool same = true;
        for (uint64_t c = 0; c < n; c++)
            same &= fabsf(f->texels[i * n + c] - f->color[c]) <= f->tolerance;
        if (f->alike[face][i] < TAKEN)
            f->alike[face][i] = same;
    }
    return SLV_OK;
}

static slv_result take(flood *f, uint32_t face, uint32_t x, uint32_t y) {
    slv_result result = reach(f, face);
    uint8_t *alike = result ? NULL : &f->alike[face][((size_t)y << f->desc.res[face].u) + x];
    if (result || *alike != 1)
        return result;
    if ((result = slvi_painter_room(f->p, f->count + 1, sizeof *f->stack, &f->stack, &f->room)))
        return result;
    *alike = (uint8_t)(TAKEN + f->seed);
    f->taken++;
    f->stack[f->count++] = (texel){face, x, y};
    return SLV_OK;
}

/* The texels beyond an edge that touch one which lies at it, number j along it. */
static slv_result cross(flood *f, texel t, unsigned edge) {
    slv_res res = f->desc.res[t.face];
    int32_t n = slvi_edge_along(edge, 1 << res.u, 1 << res.v), j = 0, x, y;
    slv_neighbour list[2];
    slv_result result = SLV_OK;
    /* counter-clockwise along the edge */
    j = (int32_t)(edge & 1 ? t.y : t.x);
    if (edge > 1)
        j = n - 1 - j;
    uint32_t count =
        slv_adjacency_neighbours(f->p->surface->adjacency, (int32_t)t.face, edge, list);
    for (uint32_t k = 0; k < count && !result; k++) {
        uint32_t to = (uint32_t)list[k].face;
        slv_res other = f->desc.res[to];
        int32_t m = slvi_edge_along(list[k].edge, 1 << other.u, 1 << other.v);
        float ends[2], u, v;
        for (int i = 0; i < 2; i++) {
            float at = fminf(fmaxf((float)(j + i) / (float)n, list[k].t0), list[k].t1);
            slvi_edge_point(edge, at, &u, &v);
            slv_affine_apply(&list[k].map, u, v, &u, &v);
            ends[i] = slvi_edge_t(list[k].edge, u, v) * (float)m;
        }
        float low = fminf(ends[0], ends[1]), high = fmaxf(ends[0], ends[1]);
        if (!(high - low > 1e-4f))
            continue;
        for (int32_t i = (int32_t)fmaxf(low + 1e-3f, 0);
             i < m && (float)i < high - 1e-3f && !result; i++) {
            slvi_edge_texel(1 << other.u, 1 << other.v, list[k].edge, i, 0, &x, &y);
            result = take(f, to, (uint32_t)x, (uint32_t)y);
        }
    }
    return result;
}

static slv_result spread(flood *f) {
    slv_result result = SLV_OK;
    while (f->count && !result) {
        texel t = f->stack[--f->count];
        slv_res res = f->desc.res[t.face];
        uint32_t width = 1u << res.u, height = 1u << res.v;
        const struct {
            bool inside;
            int dx, dy;
        } ways[4] = {
            {t.y > 0, 0, -1}, {t.x + 1 < width, 1, 0}, {t.y + 1 < height, 0, 1}, {t.x > 0, -1, 0}};
        for (unsigned edge = 0; edge < 4 && !result; edge++)
            result = ways[edge].inside ? take(f, t.face, t.x + (uint32_t)ways[edge].dx,
                                              t.y + (uint32_t)ways[edge].dy)
                                       : cross(f, t, edge);
    }
    return result;
}

/* A patch of each face with the texels that were taken from a seed. */
static slv_result gather(flood *f, uint32_t seed, slv_patches *out) {
    const uint8_t taken = (uint8_t)(TAKEN + seed);
    slv_painter *p = f->p;
    slv_result result = SLV_OK;
    uint64_t at = 0, total = 0;
    for (uint32_t face = 0; face < f->desc.nfaces; face++)
        if (f->alike[face])
            total += UINT64_C(1) << (f->desc.res[face].u + f->desc.res[face].v);
    result = slvi_painter_room(p, total + 1, sizeof *p->coverage, &p->coverage, &p->coverage_room);
    for (uint32_t face = 0; face < f->desc.nfaces && !result; face++) {
        slv_res res = f->desc.res[face];
        uint64_t count = UINT64_C(1) << (res.u + res.v), room = p->patch_room;
        if (!f->alike[face] || !memchr(f->alike[face], taken, count))
            continue;
        if ((result = slvi_painter_room(p, (uint64_t)out->count + 1, sizeof *p->patches,
                                        &p->patches, &room)) ||
            (result = slvi_painter_room(p, (uint64_t)out->count + 1, sizeof *p->parts, &p->parts,
                                        &p->patch_room)))
            break;
        for (uint64_t i = 0; i < count; i++)
            p->coverage[at + i] = f->alike[face][i] == taken;
        p->patches[out->count++] = (slv_patch){face,
                                               {0, 0, 1u << res.u, 1u << res.v},
                                               p->coverage + at,
                                               slv_paint_surface_texel_area(p->surface, face, res)};
        at += count;
    }
    out->ntexels = at;
    out->list = p->patches;
    return result;
}

static slv_result check(const flood *f, slv_surface_point at) {
    const slv_painter *p = f->p;
    if (f->desc.nfaces != p->surface->nfaces || f->desc.nchannels > 64)
        return slvi_fail(
            &p->env, SLV_ERROR_MISMATCH, "fill: %u faces of %u channels, on a surface of %u",
            (unsigned)f->desc.nfaces, (unsigned)f->desc.nchannels, (unsigned)p->surface->nfaces);
    if (at.face < 0 || (uint32_t)at.face >= f->desc.nfaces || !p->surface->segments[at.face] ||
        !(at.u >= 0 && at.u <= 1) || !(at.v >= 0 && at.v <= 1) || !(f->tolerance >= 0))
        return slvi_fail(&p->env, SLV_ERROR_ARGUMENT, "fill: face %d, %g %g, a tolerance of %g",
                         (int)at.face, (double)at.u, (double)at.v, (double)f->tolerance);
    return SLV_OK;
}

/* All that hangs together with a seed, and is of its colour, but for what others took. */
static slv_result grow(flood *f, slv_surface_point at) {
    slv_result result = check(f, at);
    if (result)
        return result;
    slv_res res = f->desc.res[at.face];
    uint32_t face = (uint32_t)at.face, x = (uint32_t)ldexpf(at.u, res.u),
             y = (uint32_t)ldexpf(at.v, res.v);
    x -= x == 1u << res.u;
    y -= y == 1u << res.v;
    result = f->canvas->fns->read(f->canvas->user, face, (slv_rect){x, y, 1, 1}, f->color);
    if (!result && !(result = take(f, face, x, y)))
        result = spread(f);
    return result;
}

slv_result slvi_painter_flood(slv_painter *painter, const slv_canvas *canvas,
                              const slvi_seed *seeds, uint32_t count, float tolerance,
                              const slv_paint *paint, uint64_t *texels) {
    flood f = {.p = painter, .canvas = canvas, .tolerance = tolerance};
    slv_result result = canvas->fns->describe(canvas->user, &f.desc);
    *texels = 0;
    if (result || (result = check(&f, seeds[0].at)) ||
        (result = slvi_alloc(&painter->env, "fill", f.desc.nfaces, sizeof *f.alike, &f.alike)) ||
        (result = slvi_alloc(&painter->env, "fill", f.desc.nfaces, sizeof *f.turns, &f.turns)))
        goto done;
    for (; f.seed < count && !result; f.seed++) /* all before any of it is painted */
        result = grow(&f, seeds[f.seed].at);
    for (uint32_t i = 0; i < count && !result; i++) {
        slv_patches patches = {0};
        if (!(result = gather(&f, i, &patches)))
            result = slv_painter_lay(painter, canvas, &patches, paint, seeds[i].lay, NULL, NULL);
    }
    if (!result)
        *texels = f.taken;
done:
    for (uint32_t i = 0; f.alike && i < f.desc.nfaces; i++)
        slvi_free(f.alike[i]);
    slvi_free(f.alike);
    slvi_free(f.turns);
    slvi_free(f.texels);
    slvi_free(f.stack);
    return result;
}

slv_result slv_painter_flood(slv_painter *painter, const slv_canvas *canvas, slv_surface_point at,
                             float tolerance, const slv_paint *paint, const slv_lay *lay,
                             uint64_t *texels) {
    static const slv_lay plain = {0};
    const slvi_seed seed = {at, lay ? lay : &plain};
    uint64_t count;
    slv_result result = slvi_painter_flood(painter, canvas, &seed, 1, tolerance, paint, &count);
    if (texels)
        *texels = count;
    return result;
}
