/* A painter: memory that is used from dab to dab, and what all kinds of dabs do with it. */
#include "surface/painter_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <string.h>

/* From how many texels on work is shared out. */
#define SHARED_TEXELS 32768

slv_result slvi_painter_grow(slv_painter *p, uint64_t count, uint64_t size, void *memory,
                             uint64_t *room) {
    uint64_t wanted = count + count / 2 + 64;
    slv_result result = slvi_grow(&p->env, "painter", wanted, size, memory);
    if (!result)
        *room = wanted;
    return result;
}

slv_result slv_painter_create(const slv_env *env, const slv_paint_surface *surface,
                              slv_painter **out) {
    slv_painter *p = NULL;
    *out = NULL;
    slv_result result = slvi_alloc(env, "painter", 1, sizeof *p, &p);
    if (result)
        return result;
    p->env = slvi_env_or_default(env);
    p->surface = surface;
    if ((result = slvi_alloc(env, "painter", surface->nverts, sizeof *p->vertices, &p->vertices)) ||
        (result = slvi_alloc(env, "painter", 2 * (uint64_t)surface->ncells, sizeof *p->tri_round,
                             &p->tri_round))) {
        slv_painter_destroy(p);
        return result;
    }
    for (int k = 0; k < 3 && surface->ncells; k++)
        p->size = fmaxf(p->size, surface->high[k] - surface->low[k]);
    *out = p;
    return SLV_OK;
}

void slv_painter_destroy(slv_painter *painter) {
    if (!painter)
        return;
    if (painter->blur)
        painter->end_blur(painter->blur);
    if (painter->mirrored)
        painter->end_mirrored(painter->mirrored);
    slvi_free(painter->colors);
    slvi_free(painter->starts);
    slvi_free(painter->vertices);
    slvi_free(painter->tri_round);
    slvi_free(painter->queue.list);
    slvi_free(painter->touched);
    slvi_free(painter->sorted);
    slvi_free(painter->patches);
    slvi_free(painter->parts);
    slvi_free(painter->coverage);
    slvi_free(painter->texels);
    slvi_free(painter->sums);
    slvi_free(painter);
}

const slv_env *slvi_painter_env(const slv_painter *p) {
    return &p->env;
}

const slv_paint_surface *slv_painter_get_surface(const slv_painter *painter) {
    return painter->surface;
}

/* Which of 2^size texels have their centres in part `at` of 2^parts. */
static void find_part(uint32_t at, int parts, int size, uint32_t *first, uint32_t *end) {
    if (size >= parts) {
        *first = at << (size - parts);
        *end = (at + 1) << (size - parts);
        return;
    }
    /* texels are wider than parts: one has its centre where the second half of its parts begins */
    uint32_t wide = 1u << (parts - size);
    *first = at >> (parts - size);
    *end = *first + ((at & (wide - 1)) == wide / 2);
}

slvi_cell_texels slvi_find_cell_texels(uint32_t n, uint32_t local, slv_res res) {
    slvi_cell_texels out;
    int parts = 0;
    while (n >> parts > 1) /* a power of two */
        parts++;
    find_part(local & (n - 1), parts, res.u, &out.x0, &out.x1);
    find_part(local >> parts, parts, res.v, &out.y0, &out.y1);
    return out;
}

slvi_profile slvi_profile_make(double radius, double hardness, double edge, double texel) {
    double r = radius, least = 0.75 * texel, rim;
    slvi_profile f = {.hardness = fmax(hardness, 0.02), .opacity = 1};
    if (r < least) {
        f.opacity = r / least * (r / least);
        r = least;
    }
    double width = fmax(fmin(edge, 2 * r), 1e-6 * r);
    rim = r * (1 - sqrt(f.hardness));
    if (rim < width) { /* the rim grows to both sides */
        r += (width - rim) / 2;
        rim = fmin(width, r);
    }
    f.radius = r;
    f.radius2 = r * r;
    f.inner2 = (r - rim) * (r - rim);
    f.slope = f.hardness / (f.radius2 - f.inner2);
    return f;
}

/* Sorts the touched triangles by as many of their digits of 11 bits as there are. */
static slv_result sort_touched(slv_painter *p) {
    enum { BITS = 11, DIGITS = 1 << BITS };
    uint32_t counts[DIGITS], all = 0, n = p->ntouched;
    slv_result result = slvi_painter_room(p, n, sizeof *p->sorted, &p->sorted, &p->sorted_room);
    for (uint32_t i = 0; i < n; i++)
        all |= p->touched[i];
    for (int shift = 0; !result && shift < 32 && all >> shift; shift += BITS) {
        memset(counts, 0, sizeof counts);
        for (uint32_t i = 0; i < n; i++)
            counts[p->touched[i] >> shift & (DIGITS - 1)]++;
        for (uint32_t k = 0, sum = 0; k < DIGITS; k++) {
            uint32_t count = counts[k];
            counts[k] = sum;
            sum += count;
        }
        for (uint32_t i = 0; i < n; i++)
            p->sorted[counts[p->touched[i] >> shift & (DIGITS - 1)]++] = p->touched[i];
        uint32_t *list = p->touched;
        uint64_t room = p->touched_room;
        p->touched = p->sorted;
        p->touched_room = p->sorted_room;
        p->sorted = list;
        p->sorted_room = room;
    }
    return result;
}

/* Of the touched triangles, which are sorted, those of one face make a patch, unless none of their
 * texels may be covered. */
static slv_result add_patch(slv_painter *p, const slv_res *res, slvi_texels_fn fn, const void *user,
                            slvi_part part, slv_patches *out) {
    const slv_paint_surface *s = p->surface;
    uint32_t face = s->cells[p->touched[part.first] / 2].face;
    slvi_cell_texels all = {UINT32_MAX, 0, UINT32_MAX, 0};
    for (uint32_t i = part.first; i < part.first + part.count; i++) {
        slvi_cell_texels t;
        if (!fn(p, user, p->touched[i], &t) || t.x0 >= t.x1 || t.y0 >= t.y1)
            continue;
        all.x0 = t.x0 < all.x0 ? t.x0 : all.x0;
        all.y0 = t.y0 < all.y0 ? t.y0 : all.y0;
        all.x1 = t.x1 > all.x1 ? t.x1 : all.x1;
        all.y1 = t.y1 > all.y1 ? t.y1 : all.y1;
    }
    if (all.x1 <= all.x0)
        return SLV_OK;
    slv_result result;
    uint64_t room = p->patch_room;
    if ((result = slvi_painter_room(p, (uint64_t)out->count + 1, sizeof *p->patches, &p->patches,
                                    &room)) ||
        (result = slvi_painter_room(p, (uint64_t)out->count + 1, sizeof *p->parts, &p->parts,
                                    &p->patch_room)))
        return result;
    slv_rect rect = {all.x0, all.y0, all.x1 - all.x0, all.y1 - all.y0};
    p->patches[out->count] =
        (slv_patch){face, rect, NULL, slv_paint_surface_texel_area(s, face, res[face])};
    part.texel = out->ntexels;
    p->parts[out->count++] = part;
    out->ntexels += (uint64_t)rect.width * rect.height;
    return SLV_OK;
}

slv_result slvi_painter_gather(slv_painter *p, const slv_res *res, slvi_texels_fn fn,
                               const void *user, slv_patches *out) {
    const slv_paint_surface *s = p->surface;
    slv_result result = sort_touched(p);
    if (result)
        return result;
    for (uint32_t first = 0, end; first < p->ntouched; first = end) {
        uint32_t face = s->cells[p->touched[first] / 2].face;
        for (end = first; end < p->ntouched && p->touched[end] / 2 < s->first[face + 1];)
            end++;
        const slvi_part part = {.first = first, .count = end - first};
        if ((result = add_patch(p, res, fn, user, part, out)))
            return result;
    }
    result =
        slvi_painter_room(p, out->ntexels, sizeof *p->coverage, &p->coverage, &p->coverage_room);
    for (uint32_t i = 0; i < out->count && !result; i++)
        p->patches[i].coverage = p->coverage + p->parts[i].texel;
    out->list = p->patches;
    return result;
}

slv_result slvi_painter_share(const slv_painter *p, const slv_patches *patches, slv_range_fn fn,
                              void *user) {
    if (patches->ntexels < SHARED_TEXELS || patches->count < 2)
        return fn(user, 0, patches->count);
    return slvi_parallel_for(&p->env, patches->count, 1 + patches->count / 64, fn, user);
}

void slvi_painter_keep_covered(slv_painter *p, slv_patches *patches) {
    uint32_t kept = 0;
    patches->ntexels = 0;
    for (uint32_t i = 0; i < patches->count; i++) {
        if (!p->parts[i].covered)
            continue;
        patches->ntexels += (uint64_t)p->patches[i].rect.width * p->patches[i].rect.height;
        p->patches[kept++] = p->patches[i];
    }
    patches->count = kept;
}
