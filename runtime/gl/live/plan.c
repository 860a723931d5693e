/* How fine faces are to be: what a camera can tell, as far as there is memory for it. */
#include "gl/live/residency.h"

#include <string.h>

enum { SPARE = 1, SPARE_OF_EXTRA = 4 }; /* sixteenths of memory */
enum { MOST_EXTRA = SLV_MAX_LOG2_RES };
#define TABLE_BYTES 32 /* that tables of values at corners grow by for a level of a face, about */
#define STAYS 1.25f    /* texels by which a finer level is kept longer than it is needed */

uint64_t slvi_residency_host_of(const slv_gl_residency *r, uint32_t face, uint32_t level) {
    return slvi_texels_in(slv_res_level(r->full[face], level)) * r->host_texel;
}

/* How much is kept that is not wanted, from as much as there is to nothing; and then by how many
 * levels less than what is wanted there is. Where there is room to spare, more than that is read of
 * what is seen. */
uint32_t slvi_residency_target(const slv_gl_residency *r, uint32_t face, uint32_t step) {
    uint32_t level = r->level[face], wanted = r->wanted[face], coarse = r->coarse[face];
    if (step == 0 && r->near[face]) {
        wanted = wanted > r->extra ? wanted - r->extra : 0;
        wanted = wanted > r->finest[face] ? wanted : r->finest[face];
    }
    if (step == 0 || (step == 1 && r->seen[face] && level + 1 == wanted))
        return level < wanted ? level : wanted;
    if (step > 2 && r->seen[face])
        wanted += step - 2;
    return wanted < coarse ? wanted : coarse;
}

/* Whether all faces fit, with so many sixteenths of the memory to spare, and of the host's some
 * more for what is being read. */
static bool fits(const slv_gl_residency *r, uint32_t step, uint32_t spare) {
    uint64_t gpu = r->gpu_coarse, host = r->host_coarse;
    for (uint32_t f = 0; f < r->nfaces; f++) {
        uint32_t target = slvi_residency_target(r, f, step);
        slv_res res = slv_res_level(r->full[f], target);
        if (target == r->coarse[f])
            continue;
        gpu += r->gpu_each[res.u][res.v] + TABLE_BYTES * (r->coarse[f] - target);
        host += slvi_residency_host_of(r, f, target);
    }
    return gpu <= r->params.gpu_bytes / 16 * (16 - spare) &&
           host <= r->params.host_bytes / 16 * (13 - spare);
}

/* The first step at which all faces fit. Layers that are free in arrays, and what moves, take a
 * part of the GPU's memory too, and what is being read of the host's. More than before is only
 * wanted where there is ample room, or what is kept would come and go. */
static uint32_t find_step(slv_gl_residency *r) {
    if (r->extra && !fits(r, 0, SPARE))
        r->extra = 0;
    uint32_t step = r->step > r->least ? r->step : r->least, before = step;
    while (step < SLVI_LAST_STEP && !fits(r, step, SPARE))
        step++;
    while (step > r->least && step <= before && fits(r, step - 1, SPARE + 1))
        step--;
    return step;
}

bool slvi_residency_want_more(slv_gl_residency *r) {
    uint32_t before = r->extra;
    if (r->step || r->sated)
        return false;
    r->sated = true;
    for (r->extra = MOST_EXTRA; r->extra > before && !fits(r, 0, SPARE_OF_EXTRA); r->extra--)
        ;
    for (uint32_t f = 0; r->extra > before && f < r->nfaces; f++)
        if (!r->failed[f] && slvi_residency_target(r, f, 0) < r->level[f])
            return true;
    r->extra = before;
    return false;
}

/* What is seen, and what meets it: on that depends what is around its texels, and their type. */
static void mark_near(slv_gl_residency *r) {
    const slv_adjacency *adjacency = r->texture->live->source.adjacency;
    memset(r->near, 0, r->nfaces);
    for (uint32_t f = 0; f < r->nfaces; f++) {
        r->near[f] |= r->seen[f];
        for (uint32_t k = 0; r->seen[f] && k < 4; k++) {
            slv_neighbour across[2];
            uint32_t count = slv_adjacency_neighbours(adjacency, (int32_t)f, k, across);
            slv_ring ring = slv_adjacency_ring(adjacency, (int32_t)f, k, NULL);
            for (uint32_t i = 0; i < count; i++)
                r->near[across[i].face] = 1;
            for (uint32_t i = 0; i < ring.count; i++)
                r->near[ring.corners[i].face] = 1;
        }
    }
}

void slvi_residency_plan(slv_gl_residency *r, const slv_camera *camera, uint32_t width,
                         uint32_t height) {
    slvi_view view = slvi_view_of(camera, width, height);
    bool changed = false;
    for (uint32_t f = 0; f < r->nfaces; f++) {
        const float *corners = r->corners + 12 * (size_t)f;
        uint32_t level = r->coarse[f], longer = level;
        bool seen = slvi_view_level(&view, corners, r->full[f], 1, &level);
        if (seen && r->seen[f] && level > r->wanted[f]) {
            slvi_view_level(&view, corners, r->full[f], STAYS, &longer);
            level = longer > r->wanted[f] ? level : r->wanted[f];
        }
        level = level < r->coarse[f] ? level : r->coarse[f];
        level = level > r->finest[f] ? level : r->finest[f];
        changed |= seen != r->seen[f] || level != r->wanted[f];
        r->seen[f] = seen;
        r->wanted[f] = (uint8_t)level;
    }
    if (changed) {
        r->least = r->stuck = r->extra = 0;
        r->sated = false;
        mark_near(r);
    }
    r->step = find_step(r);
}
