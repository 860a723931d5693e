/* Classes are laid on pages by decreasing height, from left to right (Purnomo 2004, 3.4), as grids
 * of cells. What a grid leaves free beside and below it is kept for those that come after. */
#include "gl/store/sheets.h"

#include "base/memory.h"
#include "gl/store/compress.h"

#include <stdlib.h>

#define SHEET_BYTES (UINT64_C(32) << 20) /* which take a software driver 20 ms to clear */
#define MOST_CELLS 0xffffu

/* Of pages where there are several. */
enum { LEAST_SIDE = 512, MOST_SIDE = 2048 };

struct area {
    uint32_t page, x, y, width, height;
};

struct ranked {
    uint32_t class, width, height;
};

struct packer {
    const slv_env *env;
    slv_gl_class *classes;
    struct ranked *ranked; /* those that there are, by height */
    uint32_t nranked;
    slv_gl_plan *plan;
    uint32_t first;         /* grid of the plan that is to be */
    bool one;               /* page, if possible */
    uint32_t width, height; /* of a page */
    uint32_t npages, used_width, used_height;
    uint64_t texels; /* that pages, cut where there is one, and layers take */
    struct area free[64];
    uint32_t nfree;
};

/* Of too many the smallest is forgotten. */
static void add_free(struct packer *packer, struct area area) {
    const uint32_t most = sizeof packer->free / sizeof *packer->free;
    uint32_t least = 0;
    if (!area.width || !area.height)
        return;
    if (packer->nfree < most) {
        packer->free[packer->nfree++] = area;
        return;
    }
    for (uint32_t i = 1; i < most; i++)
        if (packer->free[i].width * packer->free[i].height <
            packer->free[least].width * packer->free[least].height)
            least = i;
    if (area.width * area.height > packer->free[least].width * packer->free[least].height)
        packer->free[least] = area;
}

/* The smallest that a cell fits in, or a new page. */
static struct area take_free(struct packer *packer, uint32_t width, uint32_t height) {
    uint32_t best = packer->nfree;
    for (uint32_t i = 0; i < packer->nfree; i++) {
        const struct area *area = &packer->free[i];
        if (area->width >= width && area->height >= height &&
            (best == packer->nfree ||
             area->width * area->height < packer->free[best].width * packer->free[best].height))
            best = i;
    }
    if (best == packer->nfree)
        return (struct area){packer->npages++, 0, 0, packer->width, packer->height};
    struct area taken = packer->free[best];
    packer->free[best] = packer->free[--packer->nfree];
    return taken;
}

static slv_result add_grid(struct packer *packer, const slv_gl_grid *grid) {
    slv_gl_plan *plan = packer->plan;
    if (plan->count == plan->capacity) {
        uint32_t capacity = plan->capacity ? 2 * plan->capacity : 64;
        slv_result result =
            slvi_grow(packer->env, "pages", capacity, sizeof *plan->grids, &plan->grids);
        if (result)
            return result;
        plan->capacity = capacity;
    }
    plan->grids[plan->count++] = *grid;
    return SLV_OK;
}

static uint32_t least_of(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

static uint32_t most_of(uint32_t a, uint32_t b) {
    return a > b ? a : b;
}

static slv_result place_class(struct packer *packer, const slv_gl_class *class, uint32_t index) {
    uint32_t width = class->pool.width, height = class->pool.height, left = class->count;
    slv_result result = SLV_OK;
    while (!result && left) {
        struct area area = take_free(packer, width, height);
        uint32_t columns = least_of(area.width / width, left);
        uint32_t rows =
            least_of(least_of(area.height / height, left / columns), MOST_CELLS / columns);
        slv_gl_grid grid = {.class = index,
                            .columns = columns,
                            .rows = rows,
                            .page = area.page,
                            .x = area.x,
                            .y = area.y};
        struct area beside = {area.page, area.x + columns * width, area.y,
                              area.width - columns * width, rows * height};
        struct area below = {area.page, area.x, area.y + rows * height, area.width,
                             area.height - rows * height};
        result = add_grid(packer, &grid);
        add_free(packer, beside);
        add_free(packer, below);
        packer->used_width = most_of(packer->used_width, beside.x);
        packer->used_height = most_of(packer->used_height, below.y);
        left -= columns * rows;
    }
    return result;
}

static slv_result add_sheets(const slv_gl_source *source, const struct packer *packer, bool wide,
                             slv_gl_pools *pools) {
    const slv_gl_format *format = wide ? &pools->wide_format : &pools->format;
    bool cut = packer->npages == 1;
    uint32_t width = cut ? packer->used_width : packer->width;
    uint32_t height = cut ? packer->used_height : packer->height;
    uint64_t bytes = format->block ? slv_gl_compressed_bytes(format->block, width, height)
                                   : (uint64_t)width * height * format->texel_bytes;
    uint64_t fitting = packer->npages && SHEET_BYTES / bytes ? SHEET_BYTES / bytes : 1;
    uint32_t most =
        fitting < source->params.pool_layers ? (uint32_t)fitting : source->params.pool_layers;
    uint32_t first = pools->nsheets, count = (packer->npages + most - 1) / most;
    slv_result result = count ? slvi_grow(source->env, "pages", first + (uint64_t)count,
                                          sizeof *pools->sheets, &pools->sheets)
                              : SLV_OK;
    if (result)
        return result;
    for (uint32_t i = 0; i < count; i++)
        pools->sheets[pools->nsheets++] =
            (slv_gl_sheet){.wide = wide,
                           .width = width,
                           .height = height,
                           .npages = least_of(most, packer->npages - i * most)};
    for (uint32_t g = packer->first; g < packer->plan->count; g++) {
        slv_gl_grid *grid = &packer->plan->grids[g];
        grid->sheet = first + grid->page / most;
        grid->page %= most;
    }
    return SLV_OK;
}

static int by_height(const void *a, const void *b) {
    const struct ranked *x = a, *y = b;
    if (x->height != y->height)
        return x->height > y->height ? -1 : 1;
    if (x->width != y->width)
        return x->width > y->width ? -1 : 1;
    return x->class < y->class ? -1 : 1;
}

/* Large cells that would leave much of a page empty have layers of their own. */
static bool goes_on_page(const struct packer *packer, const struct ranked *class) {
    uint32_t width = packer->width / class->width * class->width;
    uint32_t height = packer->height / class->height * class->height;
    return packer->one
               ? width && height
               : 4 * (uint64_t)width * height >= 3 * (uint64_t)packer->width * packer->height;
}

/* All classes on pages of a size, anew. */
static slv_result pack(struct packer *packer, uint32_t width, uint32_t height) {
    slv_result result = SLV_OK;
    packer->width = width;
    packer->height = height;
    packer->npages = packer->used_width = packer->used_height = packer->nfree = 0;
    packer->plan->count = packer->first;
    packer->texels = 0;
    for (uint32_t i = 0; !result && i < packer->nranked; i++) {
        const struct ranked *class = &packer->ranked[i];
        slv_gl_class *its = &packer->classes[class->class];
        its->pool.columns = goes_on_page(packer, class);
        if (its->pool.columns)
            result = place_class(packer, its, class->class);
        else
            packer->texels += (uint64_t) class->width * class->height * its->count;
    }
    packer->texels += packer->npages == 1
                          ? (uint64_t)packer->used_width * packer->used_height
                          : (uint64_t)packer->width * packer->height * packer->npages;
    return result;
}

/* What of a side a number of cells fill exactly. */
static uint32_t filled(uint32_t side, uint32_t cell) {
    return cell > side ? side : side / cell * cell;
}

/* Few items lie on one page, as wide as takes least. */
static slv_result pack_one(struct packer *packer, uint32_t most) {
    uint32_t widest = 1, width = most;
    uint64_t least = UINT64_MAX;
    slv_result result = SLV_OK;
    for (uint32_t i = 0; i < packer->nranked; i++)
        widest = most_of(widest, packer->ranked[i].width);
    for (uint32_t try = widest; !result && try <= most; try += widest) {
        result = pack(packer, try, most);
        if (packer->texels < least) {
            least = packer->texels;
            width = try;
        }
    }
    return result ? result : pack(packer, width, most);
}

/* More lie on pages that cells of the class with most texels fill exactly, of about the side that
 * takes least. */
static slv_result pack_many(struct packer *packer, uint32_t most) {
    uint32_t width = most, height = most;
    uint64_t least = UINT64_MAX;
    slv_result result = SLV_OK;
    for (uint32_t side = LEAST_SIDE; !result && side <= most; side *= 2) {
        struct ranked main = {0, 1, 1};
        uint64_t texels = 0;
        for (uint32_t i = 0; i < packer->nranked; i++) {
            const struct ranked *class = &packer->ranked[i];
            uint64_t its =
                (uint64_t) class->width * class->height * packer->classes[class->class].count;
            if (class->width <= side && class->height <= side && its > texels) {
                main = *class;
                texels = its;
            }
        }
        uint32_t try_width = filled(side, main.width), try_height = filled(side, main.height);
        result = pack(packer, try_width, try_height);
        if (packer->texels < least) {
            least = packer->texels;
            width = try_width;
            height = try_height;
        }
    }
    return result ? result : pack(packer, width, height);
}

/* The classes of one type. */
static slv_result plan_type(const slv_gl_source *source, slv_gl_class *classes, uint32_t nclasses,
                            bool wide, slv_gl_pools *pools, slv_gl_plan *plan) {
    struct packer packer = {
        .env = source->env, .classes = classes, .plan = plan, .first = plan->count};
    uint32_t most = least_of(MOST_SIDE, source->gl->info.max_texture_size);
    uint64_t texels = 0;
    slv_result result =
        slvi_alloc(source->env, "size classes", nclasses, sizeof *packer.ranked, &packer.ranked);
    if (result)
        return result;
    for (uint32_t c = 0; c < nclasses; c++) {
        const slv_gl_pool *pool = &classes[c].pool;
        if (!classes[c].count || pool->wide != wide)
            continue;
        texels += (uint64_t)pool->width * pool->height * classes[c].count;
        packer.ranked[packer.nranked++] = (struct ranked){c, pool->width, pool->height};
    }
    qsort(packer.ranked, packer.nranked, sizeof *packer.ranked, by_height);
    packer.one = texels <= 8 * (uint64_t)LEAST_SIDE * LEAST_SIDE;
    if (packer.nranked)
        result = packer.one ? pack_one(&packer, most) : pack_many(&packer, most);
    if (!result)
        result = add_sheets(source, &packer, wide, pools);
    slvi_free(packer.ranked);
    return result;
}

slv_result slvi_gl_sheets_plan(const slv_gl_source *source, slv_gl_class *classes,
                               uint32_t nclasses, slv_gl_pools *pools, slv_gl_plan *out) {
    slv_result result = plan_type(source, classes, nclasses, false, pools, out);
    return result ? result : plan_type(source, classes, nclasses, true, pools, out);
}

void slvi_gl_plan_free(slv_gl_plan *plan) {
    slvi_free(plan->grids);
}
