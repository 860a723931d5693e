/* Fills of scripts, on the other sides of mirrors too. */
#include "brush/mirror.h"
#include "canvas/lay_data.h"
#include "script/script_data.h"
#include "surface/painter_data.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

enum { MOST_SIDES = 1 << SLV_MIRRORS };

bool slvi_script_is_laid(const slv_lay *lay) {
    const slv_mask *mask = &lay->mask;
    return lay->ink.kind || lay->symmetry || mask->faces || mask->degrees > 0 || mask->facing ||
           mask->canvas;
}

/* Where a fill begins on each side, and how paint is laid there. */
typedef struct sides {
    slvi_seed seeds[MOST_SIDES];
    slv_lay lays[MOST_SIDES];
    slv_camera facing[MOST_SIDES];
    uint32_t count;
} sides;

static void find_sides(slv_script *s, const slvi_line *line, sides *out) {
    const slv_surface_point at = {(int32_t)line->face, line->by_color ? line->at[0] : 0.5f,
                                  line->by_color ? line->at[1] : 0.5f};
    const slvi_mirrors mirrors = {slv_painter_get_surface(s->painter), line->mirrors,
                                  line->stroke.nmirrors};
    float reach = 0; /* half as far as the face is wide */
    if (mirrors.count)
        reach = 0.5f * sqrtf(slv_paint_surface_texel_area(mirrors.surface, (uint32_t)at.face,
                                                          (slv_res){0, 0}));
    out->count = 0;
    for (unsigned which = 0; which < 1u << mirrors.count; which++) {
        uint32_t i = out->count;
        float axis[3] = {0};
        out->lays[i] = line->lay;
        out->seeds[i] = (slvi_seed){at, &out->lays[i]};
        if (which && (!slvi_mirror_point(&mirrors, which, reach, &out->seeds[i].at, axis) ||
                      !slvi_mirror_lay(&mirrors, which, reach, &out->lays[i], &out->facing[i])))
            s->stats.missed++;
        else
            out->count++;
    }
}

/* Faces of several sides are the first's. */
static slv_result fill_faces(slv_script *s, const slvi_line *line, const sides *all) {
    uint8_t *taken = NULL;
    slv_canvas_desc desc;
    slv_result result = s->inner.fns->describe(s->inner.user, &desc);
    if (!result)
        result = slvi_alloc(&s->env, "fill", s->nfaces, 1, &taken);
    for (uint32_t i = 0; i < all->count && !result; i++) {
        const slvi_seed *seed = &all->seeds[i];
        memset(s->selected, 0, s->nfaces);
        if ((result = slv_painter_select(s->painter, (uint32_t)seed->at.face, line->select,
                                         line->degrees, s->selected)))
            break;
        for (uint32_t f = 0; f < s->nfaces; f++) {
            s->selected[f] = s->selected[f] && !taken[f];
            taken[f] |= s->selected[f];
        }
        result = slv_painter_fill_with(s->painter, &s->canvas, s->selected, &line->stroke.paint,
                                       slvi_script_is_laid(seed->lay) ? seed->lay : NULL, NULL);
    }
    for (uint32_t f = 0; f < s->nfaces && !result; f++)
        if (taken[f])
            s->stats.texels += UINT64_C(1) << (desc.res[f].u + desc.res[f].v);
    slvi_free(taken);
    return result;
}

slv_result slvi_script_fill(slv_script *script, const slvi_line *line) {
    uint64_t texels = 0;
    sides all;
    find_sides(script, line, &all);
    if (!line->by_color)
        return fill_faces(script, line, &all);
    slv_result result = slvi_painter_flood(script->painter, &script->canvas, all.seeds, all.count,
                                           line->tolerance, &line->stroke.paint, &texels);
    script->stats.texels += texels;
    return result;
}
