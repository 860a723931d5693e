/* Fills: which faces, and paint all over them. */
#include "canvas/lay_data.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/names.h"

#include <selvage/canvas.h>

/* Texels of a batch, unless one face has more. */
#define BATCH_TEXELS (UINT64_C(1) << 20)

static const char *const select_names[] = {"face", "connected", "angle"};

const char *slv_select_name(slv_select select) {
    return slvi_name_of(select_names, SLVI_COUNT(select_names), (int)select);
}

bool slv_select_from_name(const char *name, slv_select *out) {
    int value;
    if (!slvi_name_find(select_names, SLVI_COUNT(select_names), name, &value))
        return false;
    *out = (slv_select)value;
    return true;
}

/* How much the surface bends over an edge of a face: the largest angle between cells on its two
 * sides, as a cosine. */
static double bend(const slv_paint_surface *s, uint32_t face, unsigned edge, uint32_t to) {
    double least = 1;
    uint32_t n = s->segments[face];
    for (uint32_t j = 0; j < n; j++) {
        int32_t x, y;
        slvi_edge_texel((int32_t)n, (int32_t)n, edge, (int32_t)j, 0, &x, &y);
        uint32_t cell = s->first[face] + (uint32_t)y * n + (uint32_t)x,
                 beyond = s->cells[cell].across[edge];
        double a[3], b[3];
        if (beyond == SLVI_NONE || s->cells[beyond >> 2].face != to)
            continue;
        slvi_tri_normal(s, 2 * cell + (edge > 1), a);
        slvi_tri_normal(s, 2 * (beyond >> 2) + ((beyond & 3) > 1), b);
        least = fmin(least, slvi_dot(a, b));
    }
    return least;
}

slv_result slv_painter_select(slv_painter *painter, uint32_t face, slv_select select, float degrees,
                              uint8_t *selected) {
    const slv_paint_surface *s = painter->surface;
    uint32_t *queue = NULL, count = 0;
    if (face >= s->nfaces || (unsigned)select >= SLVI_COUNT(select_names) || !isfinite(degrees))
        return slvi_fail(&painter->env, SLV_ERROR_ARGUMENT, "selection: face %u of %u, %g degrees",
                         (unsigned)face, (unsigned)s->nfaces, (double)degrees);
    double least = cos(fmin(fmax((double)degrees, 0), 180) * 3.14159265358979 / 180) - 1e-6;
    uint8_t *seen = NULL;
    slv_result result = slvi_alloc(&painter->env, "selection", s->nfaces, 1, &seen);
    if (!result)
        result = slvi_alloc(&painter->env, "selection", s->nfaces, sizeof *queue, &queue);
    if (!result) {
        seen[face] = 1;
        queue[count++] = face;
    }
    for (uint32_t i = 0; i < count; i++) {
        selected[queue[i]] = 1;
        for (unsigned edge = 0; edge < 4 && select != SLV_SELECT_FACE; edge++) {
            slv_neighbour list[2];
            uint32_t n = slv_adjacency_neighbours(s->adjacency, (int32_t)queue[i], edge, list);
            for (uint32_t k = 0; k < n; k++) {
                uint32_t to = (uint32_t)list[k].face;
                if (!seen[to] &&
                    (select == SLV_SELECT_CONNECTED || bend(s, queue[i], edge, to) >= least)) {
                    seen[to] = 1;
                    queue[count++] = to;
                }
            }
        }
    }
    slvi_free(seen);
    slvi_free(queue);
    return result;
}

/* Patches of whole faces, from *face on, as many as make a batch. `alike`: they will stay covered
 * as they are, and can share that. */
static slv_result make_batch(slv_painter *p, const slv_canvas_desc *desc, const uint8_t *selected,
                             bool alike, uint32_t *face, slv_patches *out) {
    *out = (slv_patches){0};
    uint64_t largest = 0;
    for (; *face < desc->nfaces && out->ntexels < BATCH_TEXELS; ++*face) {
        if (!selected[*face])
            continue;
        slv_res res = desc->res[*face];
        slv_rect rect = {0, 0, 1u << res.u, 1u << res.v};
        uint64_t texels = (uint64_t)rect.width * rect.height, room = p->patch_room;
        slv_result result =
            slvi_painter_room(p, (uint64_t)out->count + 1, sizeof *p->patches, &p->patches, &room);
        if (!result)
            result = slvi_painter_room(p, (uint64_t)out->count + 1, sizeof *p->parts, &p->parts,
                                       &p->patch_room);
        if (result)
            return result;
        p->patches[out->count++] =
            (slv_patch){*face, rect, NULL, slv_paint_surface_texel_area(p->surface, *face, res)};
        out->ntexels += texels;
        largest = texels > largest ? texels : largest;
    }
    uint64_t room = alike ? largest : out->ntexels, at = 0;
    slv_result result =
        slvi_painter_room(p, room, sizeof *p->coverage, &p->coverage, &p->coverage_room);
    for (uint64_t i = 0; i < room && !result; i++)
        p->coverage[i] = 1;
    for (uint32_t i = 0; i < out->count && !result; i++) {
        p->patches[i].coverage = p->coverage + at;
        at += alike ? 0 : (uint64_t)p->patches[i].rect.width * p->patches[i].rect.height;
    }
    out->list = p->patches;
    return result;
}

slv_result slv_painter_fill(slv_painter *painter, const slv_canvas *canvas, const uint8_t *selected,
                            const slv_paint *paint, uint32_t *faces) {
    return slv_painter_fill_with(painter, canvas, selected, paint, NULL, faces);
}

slv_result slv_painter_fill_with(slv_painter *painter, const slv_canvas *canvas,
                                 const uint8_t *selected, const slv_paint *paint,
                                 const slv_lay *lay, uint32_t *faces) {
    slv_canvas_desc desc;
    slv_patches batch;
    uint32_t done = 0;
    slv_result result = canvas->fns->describe(canvas->user, &desc);
    if (!result && desc.nfaces != painter->surface->nfaces)
        result = slvi_fail(&painter->env, SLV_ERROR_MISMATCH, "fill: %u faces on a surface of %u",
                           (unsigned)desc.nfaces, (unsigned)painter->surface->nfaces);
    for (uint32_t face = 0; !result && face < desc.nfaces;) {
        if (!(result = make_batch(painter, &desc, selected, !lay, &face, &batch)) && batch.count)
            result = lay ? slv_painter_lay(painter, canvas, &batch, paint, lay, NULL, NULL)
                         : slv_painter_apply(painter, canvas, &batch, paint);
        done += batch.count;
    }
    if (faces)
        *faces = done;
    return result;
}
