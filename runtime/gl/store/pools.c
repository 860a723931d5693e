/* Size classes become pools: which item is in which layer of which array texture. */
#include "gl/store/pools.h"

#include "base/log.h"
#include "base/memory.h"
#include "gl/store/compress.h"
#include "gl/store/sheets.h"

#include <selvage/border.h>
#include <selvage/edge_aligned.h>

#include <string.h>

#define ARRAY_BYTES (UINT64_C(512) << 20) /* software drivers refuse textures above 1 GiB */
#define NCLASSES (1u << 11)
#define MOST_POOLS 0xffffu

static slv_result too_many(const slv_env *env, uint32_t npools) {
    return slvi_fail(env, SLV_ERROR_LIMIT, "%u array textures are needed, the limit is %u", npools,
                     MOST_POOLS);
}

static uint32_t class_of(slv_res res, bool wide) {
    return (uint32_t)wide << 10 | (uint32_t)res.u << 5 | (uint32_t)res.v;
}

static uint32_t whole_blocks(uint32_t texels, bool blocks) {
    return blocks ? (texels + 3) / 4 * 4 : texels;
}

uint32_t slvi_gl_border(const slv_gl_texture_params *params) {
    return whole_blocks(params->border, params->compression == SLV_GL_COMPRESSION_BLOCKS);
}

bool slvi_gl_is_even(const slv_gl_texture_params *params, const slv_form *form) {
    return params->even_levels && (form == slv_form_borders() || form == slv_form_edge_aligned());
}

const slv_levels *slvi_gl_levels_of(const slv_gl_source *source, const slv_form *form) {
    return slvi_gl_is_even(&source->params, form) ? source->even : source->levels;
}

slv_form_extent slvi_gl_extent(const slv_gl_source *source, const slv_form *form, slv_res res,
                               uint32_t level) {
    uint32_t border = slvi_gl_border(&source->params);
    return slvi_gl_is_even(&source->params, form) ? slv_form_even_extent(form, res, level, border)
                                                  : slv_form_level_extent(form, res, level, border);
}

/* Lays all levels of a size class out in a cell, side by side. */
static void pack_levels(const slv_gl_source *source, const slv_form *form, bool blocks,
                        slv_gl_pool *pool) {
    uint32_t x = 0, y = 0, shelf = 0;
    pool->width = 0;
    for (uint32_t level = 0; level < pool->nlevels; level++) {
        slv_form_extent extent = slvi_gl_extent(source, form, pool->res, level);
        slv_gl_rect *rect = &pool->rects[level];
        rect->bu = extent.border_u;
        rect->bv = extent.border_v;
        rect->width = extent.width - 2 * rect->bu - form->samples;
        rect->height = extent.height - 2 * rect->bv - form->samples;
        /* A level's own texels begin with a block, whatever the border. */
        uint32_t left = whole_blocks(rect->bu, blocks), low = whole_blocks(rect->bv, blocks);
        uint32_t w = left + whole_blocks(extent.width - rect->bu, blocks);
        uint32_t h = low + whole_blocks(extent.height - rect->bv, blocks);
        if (level == 0)
            pool->width = w;
        if (x + w > pool->width) { /* rows of levels below the first; each level is no taller than
                                      the one before */
            x = 0;
            y += shelf;
            shelf = 0;
        }
        rect->x = x + left - rect->bu;
        rect->y = y + low - rect->bv;
        x += w;
        shelf = h > shelf ? h : shelf;
    }
    pool->height = y + shelf;
}

struct alike {
    const slv_gl_source *source;
    uint32_t first;
    bool any;
};

/* Ends the visit at a face that is not as the first. */
static slv_result is_alike(void *user, uint32_t face) {
    struct alike *alike = user;
    const slv_texture *light = alike->source->light;
    if (!slv_texture_is_constant(light, face))
        return SLV_ERROR_CANCELLED;
    if (!alike->any)
        alike->first = face;
    alike->any = true;
    const slv_texture_desc *desc = slv_texture_get_desc(light);
    return memcmp(slv_texture_texels(light, face), slv_texture_texels(light, alike->first),
                  desc->nchannels * slv_type_size(desc->type))
               ? SLV_ERROR_CANCELLED
               : SLV_OK;
}

slv_result slvi_gl_item_res(const slv_gl_source *source, const slv_form *form, const void *made,
                            uint32_t item, slv_form_room *room, slv_res *out) {
    const slv_res one = {0, 0};
    struct alike alike = {.source = source};
    const bool may_be = !source->params.whole;
    bool single = may_be && form == slv_form_bare() && slvi_gl_is_constant(source, item);
    slv_result result = SLV_OK;
    /* one vector is another pair of numbers in the next face's frame */
    if (may_be && !single && form->needs && source->light && !source->bare_only &&
        !source->params.edge_filter) {
        result = form->needs(made, item, room, is_alike, &alike);
        single = !result && alike.any;
        result = result == SLV_ERROR_CANCELLED ? SLV_OK : result;
    }
    *out = single ? one : form->res(made, item);
    return result;
}

uint64_t slvi_gl_layer_bytes(const slv_gl_pools *pools, const slv_gl_pool *pool) {
    const slv_gl_format *format = slv_gl_pool_format(pools, pool);
    uint64_t bytes = 0;
    for (uint32_t level = 0; level < slv_gl_pool_levels(pools, pool); level++) {
        uint32_t width = pool->width >> level, height = pool->height >> level;
        width = width ? width : 1;
        height = height ? height : 1;
        bytes += format->block ? slv_gl_compressed_bytes(format->block, width, height)
                               : (uint64_t)width * height * format->texel_bytes;
    }
    return bytes;
}

uint64_t slvi_gl_array_bytes(const slv_gl_pools *pools, const slv_gl_pool *pool) {
    if (!pool->columns)
        return slvi_gl_layer_bytes(pools, pool) * pool->capacity;
    const slv_gl_sheet *sheet = &pools->sheets[pool->sheet];
    const slv_gl_pool page = {.wide = pool->wide, .width = sheet->width, .height = sheet->height};
    return slvi_gl_layer_bytes(pools, &page) * sheet->npages;
}

uint32_t slvi_gl_array_count(const slv_gl_pools *pools) {
    uint32_t count = pools->nsheets;
    for (uint32_t p = 0; p < pools->npools; p++)
        count += pools->pools[p].capacity && !pools->pools[p].columns;
    return count;
}

/* The size of a class's layers, and how many one array may have. */
static slv_result lay_out_class(const slv_gl_source *source, const slv_gl_pools *pools,
                                slv_gl_pool *pool) {
    const slv_gl_texture_params *params = &source->params;
    uint32_t limit = source->gl->info.max_texture_size;
    pool->nlevels = slv_res_level_count(pool->res);
    pool->width = 1u << pool->res.u;
    pool->height = 1u << pool->res.v;
    if (pools->packing == SLV_GL_PAGES)
        pack_levels(source, pools->form, slv_gl_pool_format(pools, pool)->block, pool);
    slv_type type = slv_gl_pool_format(pools, pool)->type;
    bool wild = type == SLV_TYPE_HALF || type == SLV_TYPE_FLOAT;
    if (pools->shares && pools->form->samples && wild) {
        /* A lookup of the last sample has next to nothing of the texel beyond, which in another
         * face may be huge or no number. */
        pool->width++;
        pool->height++;
    }
    if (pool->width > limit || pool->height > limit)
        return slvi_fail(
            source->env, SLV_ERROR_LIMIT,
            "%s of %u x %u texels needs a texture of %u x %u, the driver's limit is %u",
            pools->form->item, 1u << pool->res.u, 1u << pool->res.v, pool->width, pool->height,
            limit);
    uint64_t most = ARRAY_BYTES / slvi_gl_layer_bytes(pools, pool);
    most = most < params->pool_layers ? most : params->pool_layers;
    pool->nlayers = most ? (uint32_t)most : 1;
    return SLV_OK;
}

/* A pool of a class that is full, with `count` of the items from `first`. */
static void add_full(const slv_gl_pool *class, uint32_t first, uint32_t count, slv_gl_pools *out) {
    slv_gl_pool *pool = &out->pools[out->npools];
    *pool = *class;
    pool->items = out->items + first;
    pool->nlayers = pool->capacity = count;
    for (uint32_t layer = 0; layer < count; layer++) {
        out->pool_of[pool->items[layer]] = out->npools;
        out->layer_of[pool->items[layer]] = layer;
    }
    out->npools++;
}

/* `classes` have pools with as many layers as they may have, `start` where a class ends in the
 * order. */
static void cut_classes(const slv_gl_class *classes, const slv_gl_plan *plan, const uint32_t *start,
                        slv_gl_pools *out) {
    for (uint32_t c = 0; c < NCLASSES; c++) {
        uint32_t end = start[c], first = c ? start[c - 1] : 0;
        uint32_t most = classes[c].pool.columns ? 0 : classes[c].pool.nlayers;
        for (; most && first < end; first += most)
            add_full(&classes[c].pool, first, end - first < most ? end - first : most, out);
    }
    for (uint32_t g = 0, first = 0; g < plan->count; g++) {
        const slv_gl_grid *grid = &plan->grids[g];
        slv_gl_pool pool = classes[grid->class].pool;
        if (!g || grid->class != grid[-1].class)
            first = grid->class ? start[grid->class - 1] : 0;
        pool.columns = grid->columns;
        pool.sheet = grid->sheet;
        pool.page = grid->page;
        pool.x = grid->x;
        pool.y = grid->y;
        add_full(&pool, first, grid->columns * grid->rows, out);
        first += grid->columns * grid->rows;
    }
}

slv_result slvi_gl_pools_assign(const slv_gl_source *source, const slv_gl_items *items,
                                slv_gl_pools *out) {
    const slv_env *env = source->env;
    slv_result result = SLV_OK;
    uint32_t count_all = out->nitems = items->count, npools = 0, *start = NULL;
    slv_gl_class *classes = NULL;
    slv_gl_plan plan = {0};
    if ((result = slvi_alloc(env, "size classes", NCLASSES + 1, sizeof *start, &start)) ||
        (result = slvi_alloc(env, "size classes", NCLASSES, sizeof *classes, &classes)) ||
        (result = slvi_alloc(env, "layers", count_all, sizeof *out->items, &out->items)) ||
        (result = slvi_alloc(env, "pools", count_all, sizeof *out->pool_of, &out->pool_of)) ||
        (result = slvi_alloc(env, "layers", count_all, sizeof *out->layer_of, &out->layer_of)))
        goto done;
    for (uint32_t i = 0; i < count_all; i++)
        start[class_of(items->res[i], items->wide[i]) + 1]++;
    for (uint32_t c = 0; c < NCLASSES; c++) {
        slv_gl_pool *pool = &classes[c].pool;
        classes[c].count = start[c + 1];
        if (classes[c].count) {
            pool->res = (slv_res){(int8_t)(c >> 5 & 31), (int8_t)(c & 31)};
            pool->wide = c >> 10;
            if ((result = lay_out_class(source, out, pool)))
                goto done;
        }
        start[c + 1] += start[c];
    }
    if (out->shares && (result = slvi_gl_sheets_plan(source, classes, NCLASSES, out, &plan)))
        goto done;
    npools = plan.count;
    for (uint32_t c = 0; c < NCLASSES; c++)
        if (classes[c].count && !classes[c].pool.columns)
            npools += (classes[c].count + classes[c].pool.nlayers - 1) / classes[c].pool.nlayers;
    if (npools > MOST_POOLS) {
        result = too_many(env, npools);
        goto done;
    }
    if ((result = slvi_alloc(env, "pools", npools, sizeof *out->pools, &out->pools)))
        goto done;
    for (uint32_t i = 0; i < count_all; i++) {
        uint32_t item = items->order[i];
        out->items[start[class_of(items->res[item], items->wide[item])]++] = item;
    }
    out->order = out->items;
    /* start[c] is now where class c ends */
    cut_classes(classes, &plan, start, out);
done:
    slvi_free(start);
    slvi_free(classes);
    slvi_gl_plan_free(&plan);
    return result;
}

slv_result slvi_gl_pools_add(const slv_gl_source *source, slv_res res, bool wide, uint32_t capacity,
                             slv_gl_pools *pools, slv_gl_pool **out) {
    slv_gl_pool pool = {.res = res, .wide = wide, .own_items = true};
    slv_result result = lay_out_class(source, pools, &pool);
    if (result)
        return result;
    pool.capacity = capacity < pool.nlayers ? capacity : pool.nlayers;
    pool.nlayers = 0;
    uint32_t index = 0;
    while (index < pools->npools && pools->pools[index].capacity)
        index++;
    if (index == MOST_POOLS)
        return too_many(source->env, index + 1);
    if (index == pools->npools && (result = slvi_grow(source->env, "pools", index + (uint64_t)1,
                                                      sizeof *pools->pools, &pools->pools)))
        return result;
    if ((result =
             slvi_alloc(source->env, "layers", pool.capacity, sizeof *pool.items, &pool.items)))
        return result;
    pools->npools += index == pools->npools;
    *out = &pools->pools[index];
    **out = pool;
    return SLV_OK;
}

void slvi_gl_pools_drop(slv_gl_pool *pool) {
    if (pool->own_items)
        slvi_free(pool->items);
    memset(pool, 0, sizeof *pool);
}

slv_result slvi_gl_class_bytes(const slv_gl_source *source, const slv_gl_pools *pools, slv_res res,
                               bool wide, uint64_t *bytes) {
    slv_gl_pool pool = {.res = res, .wide = wide};
    slv_result result = lay_out_class(source, pools, &pool);
    *bytes = result ? 0 : slvi_gl_layer_bytes(pools, &pool);
    return result;
}

void slvi_gl_pools_take(slv_gl_pools *pools, uint32_t item, uint32_t *filler) {
    slv_gl_pool *pool = &pools->pools[pools->pool_of[item]];
    uint32_t layer = pools->layer_of[item], last = pool->items[--pool->nlayers];
    pool->items[layer] = last;
    pools->layer_of[last] = layer;
    *filler = last;
}

void slvi_gl_pools_give(slv_gl_pools *pools, uint32_t item, uint32_t index) {
    slv_gl_pool *pool = &pools->pools[index];
    pools->pool_of[item] = index;
    pools->layer_of[item] = pool->nlayers;
    pool->items[pool->nlayers++] = item;
}

slv_result slvi_gl_pools_list(const slv_env *env, slv_gl_pools *pools) {
    uint32_t *order = pools->order;
    slv_result result = SLV_OK;
    if (order == pools->items)
        result = slvi_alloc(env, "layers", pools->nitems, sizeof *order, &order);
    if (result)
        return result;
    pools->order = order;
    for (uint32_t p = 0; p < pools->npools; p++) {
        if (pools->pools[p].nlayers) /* else there may be no list at all */
            memcpy(order, pools->pools[p].items, pools->pools[p].nlayers * sizeof *order);
        order += pools->pools[p].nlayers;
    }
    return SLV_OK;
}

void slvi_gl_pools_free(slv_gl_pools *pools) {
    for (uint32_t p = 0; p < pools->npools; p++)
        if (pools->pools[p].own_items)
            slvi_free(pools->pools[p].items);
    if (pools->order != pools->items)
        slvi_free(pools->order);
    slvi_free(pools->items);
    slvi_free(pools->sheets);
    slvi_free(pools->pools);
    slvi_free(pools->pool_of);
    slvi_free(pools->layer_of);
}
