/* Items of a form in array textures: size classes, pools and layers. */
#ifndef SLV_GL_POOLS_H
#define SLV_GL_POOLS_H

#include "gl/store/format.h"
#include "gl/store/source.h"

#define SLV_GL_LEVELS (SLV_MAX_LOG2_RES + 1)
#define SLV_GL_LEVEL_ROWS (SLV_GL_LEVELS + 1) /* of a pool, in the table of levels */

typedef struct slv_gl_rect {
    uint32_t x, y;          /* of the bordered level's first texel in the item's cell */
    uint32_t bu, bv;        /* border */
    uint32_t width, height; /* inside, without border; of samples on edges the intervals between
                               them, of which there is one less */
} slv_gl_rect;

/* Cells for items of one class: layers of an array of its own, or a grid on a page. Of a grid, too,
 * a cell is called a layer where it is all the same. */
typedef struct slv_gl_pool {
    GLuint texture; /* of a grid: its sheet's */
    GLuint coverage;
    slv_res res;
    bool wide;
    uint32_t nlayers, width, height, nlevels;
    uint32_t columns;     /* of a grid; 0: its own layers */
    uint32_t sheet, page; /* which a grid is on */
    uint32_t x, y;        /* of a grid's first texel */
    uint32_t capacity;    /* layers of the array, of which the first nlayers are in use */
    uint32_t reserved;    /* of those that are free: for items that are about to move */
    uint32_t *items;      /* of each layer */
    bool own_items;       /* no part of slv_gl_pools.items */
    slv_gl_rect rects[SLV_GL_LEVELS]; /* of levels side by side only */
} slv_gl_pool;

/* An array texture whose layers are pages, of grids of one type. */
typedef struct slv_gl_sheet {
    GLuint texture;
    bool wide;
    uint32_t width, height, npages;
} slv_gl_sheet;

static inline uint64_t slvi_texels_in(slv_res res) {
    return UINT64_C(1) << (res.u + res.v);
}

/* What gets layers. */
typedef struct slv_gl_items {
    uint32_t count;
    slv_res *res;
    uint8_t *wide;   /* needs a wider type than the texture's */
    uint32_t *order; /* those close together that meet */
} slv_gl_items;

/* Every item in a layer of one pool. */
typedef struct slv_gl_pools {
    const slv_form *form;
    slv_gl_packing packing;
    bool shares; /* several items lie on a page, where they are small enough */
    slv_gl_format format, wide_format;
    slv_gl_sheet *sheets;
    uint32_t nsheets;
    slv_gl_pool *pools;
    uint32_t npools, nitems;
    uint32_t *items; /* of the layers of the first pools */
    uint32_t *order; /* items in the order of pools and layers; may be `items` */
    uint32_t *pool_of, *layer_of;
} slv_gl_pools;

/* Sorts items into classes, keeping their order, and cuts the classes into pools, whose textures
 * are still to be made. `out` has form, packing, shares and formats; on failure it is to be freed
 * too. */
slv_result slvi_gl_pools_assign(const slv_gl_source *source, const slv_gl_items *items,
                                slv_gl_pools *out);
/* Adds a pool of a class without layers in use, to be made with `capacity` of them or as many as
 * one may have; *out holds until the next. */
slv_result slvi_gl_pools_add(const slv_gl_source *source, slv_res res, bool wide, uint32_t capacity,
                             slv_gl_pools *pools, slv_gl_pool **out);
/* Bytes that an item of a class takes in its layer. */
slv_result slvi_gl_class_bytes(const slv_gl_source *source, const slv_gl_pools *pools, slv_res res,
                               bool wide, uint64_t *bytes);
/* Forgets a pool without layers in use, whose number goes to one that is added later. */
void slvi_gl_pools_drop(slv_gl_pool *pool);
/* Takes an item out of its pool, whose layers in use stay the first: *filler is the item that is
 * in its place now, and has to be uploaded there; or the item itself. */
void slvi_gl_pools_take(slv_gl_pools *pools, uint32_t item, uint32_t *filler);
/* Gives it the next layer of a pool that has one. */
void slvi_gl_pools_give(slv_gl_pools *pools, uint32_t item, uint32_t pool);
/* Lists the items in the order of pools and layers again. */
slv_result slvi_gl_pools_list(const slv_env *env, slv_gl_pools *pools);
void slvi_gl_pools_free(slv_gl_pools *pools);

/* The class that an item belongs in: one texel, if all that it is made of has one value. */
slv_result slvi_gl_item_res(const slv_gl_source *source, const slv_form *form, const void *made,
                            uint32_t item, slv_form_room *room, slv_res *out);
/* Which level of its form an item has at a level of its pool: the last, if it has one texel. */
static inline uint32_t slvi_gl_stored_level(const slv_gl_pools *pools, const void *made,
                                            uint32_t item, uint32_t level) {
    return level + slv_res_level_count(pools->form->res(made, item)) -
           pools->pools[pools->pool_of[item]].nlevels;
}

static inline const slv_gl_format *slv_gl_pool_format(const slv_gl_pools *pools,
                                                      const slv_gl_pool *pool) {
    return pool->wide ? &pools->wide_format : &pools->format;
}

/* The border that forms are asked for. */
uint32_t slvi_gl_border(const slv_gl_texture_params *params);

/* Whether a form is made of even levels where there are any: the library's that have something of
 * the neighbours in each level. Those of bare faces are levels of OpenGL's, which halves both
 * sides. */
bool slvi_gl_is_even(const slv_gl_texture_params *params, const slv_form *form);
const slv_levels *slvi_gl_levels_of(const slv_gl_source *source, const slv_form *form);
/* slv_form_level_extent of what is made of them. */
slv_form_extent slvi_gl_extent(const slv_gl_source *source, const slv_form *form, slv_res res,
                               uint32_t level);

/* Levels that OpenGL knows of: one of a page. */
static inline uint32_t slv_gl_pool_levels(const slv_gl_pools *pools, const slv_gl_pool *pool) {
    return pools->packing == SLV_GL_PAGES ? 1 : pool->nlevels;
}
uint64_t slvi_gl_layer_bytes(const slv_gl_pools *pools, const slv_gl_pool *pool);
/* Bytes of the array that a pool is in. */
uint64_t slvi_gl_array_bytes(const slv_gl_pools *pools, const slv_gl_pool *pool);
/* How many arrays there are. */
uint32_t slvi_gl_array_count(const slv_gl_pools *pools);

/* The size of the layers of a pool's array. */
static inline slv_gl_sheet slv_gl_pool_array(const slv_gl_pools *pools, const slv_gl_pool *pool) {
    return pool->columns ? pools->sheets[pool->sheet]
                         : (slv_gl_sheet){.texture = pool->texture,
                                          .wide = pool->wide,
                                          .width = pool->width,
                                          .height = pool->height,
                                          .npages = pool->capacity};
}

#endif
