/* A form of a texture goes to the GPU: which items there are, how wide they are, their pools,
 * texels and tables. */
#include "gl/store/store.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "gl/store/tables.h"

#include <string.h>

static void free_items(slv_gl_items *items) {
    slvi_free(items->res);
    slvi_free(items->wide);
    slvi_free(items->order);
}

struct sizes {
    const slv_gl_source *source;
    const slv_form *form;
    const void *made;
    slv_res *res;
};

static slv_result find_sizes(void *user, uint64_t first, uint64_t end) {
    const struct sizes *sizes = user;
    slv_form_room room = {0};
    slv_result result = SLV_OK;
    for (uint64_t i = first; !result && i < end; i++)
        result = slvi_gl_item_res(sizes->source, sizes->form, sizes->made, (uint32_t)i, &room,
                                  &sizes->res[i]);
    slv_form_room_end(&room);
    return result;
}

/* Items in the order in which the faces, neighbours close together, first need them. */
static slv_result list_items(const slv_gl_source *source, const slv_form *form, const void *made,
                             slv_gl_items *out) {
    const slv_env *env = source->env;
    uint32_t nfaces = slv_levels_get_desc(source->levels)->nfaces, listed = 0, *faces = NULL;
    bool *seen = NULL;
    slv_result result;
    out->count = form->count(made);
    if ((result = slvi_alloc(env, "items", out->count, sizeof *out->res, &out->res)) ||
        (result = slvi_alloc(env, "items", out->count, 1, &out->wide)) ||
        (result = slvi_alloc(env, "items", out->count, sizeof *out->order, &out->order)) ||
        (result = slvi_alloc(env, "items", out->count, sizeof *seen, &seen)) ||
        (result = slvi_alloc(env, "face order", nfaces, sizeof *faces, &faces)) ||
        (result = slvi_gl_face_order(source, faces)))
        goto done;
    struct sizes sizes = {source, form, made, out->res};
    if ((result = slvi_parallel_for(&source->shared, out->count, 1024, find_sizes, &sizes)))
        goto done;
    for (uint32_t i = 0; i < nfaces; i++) {
        uint32_t items[SLV_FORM_ITEMS], count = form->items(made, faces[i], items);
        for (uint32_t k = 0; k < count; k++) {
            if (seen[items[k]])
                continue;
            seen[items[k]] = true;
            out->order[listed++] = items[k];
        }
    }
done:
    slvi_free(seen);
    slvi_free(faces);
    return result;
}

struct widen_job {
    const slv_gl_source *source;
    const slv_gl_store *store;
    uint8_t *wide;
};

static bool leaves(const float *values, size_t count) {
    bool any = false;
    for (size_t i = 0; i < count; i++)
        any |= !(values[i] >= -1e-6f && values[i] <= 1 + 1e-6f);
    return any;
}

/* Whether a value of an item lies outside of 0..1, which is the range of 8 bits whatever the range
 * of the colours that were decoded for them. */
static slv_result leaves_bytes(const slv_gl_source *source, const slv_gl_store *store,
                               uint32_t item, float *scratch, bool *out) {
    const slv_form *form = store->pools.form;
    uint32_t nchannels = slv_levels_get_desc(source->levels)->nchannels;
    slv_res res = form->res(store->made, item);
    slv_result result = SLV_OK;
    for (uint32_t level = 0; !result && !*out && level < slv_res_level_count(res); level++) {
        slv_form_texels texels;
        slv_form_extent extent = slvi_gl_extent(source, form, res, level);
        result = form->read_rim ? form->read_rim(store->made, item, level, scratch, &texels)
                                : form->read(store->made, item, level, scratch, &texels);
        if (result || texels.type != SLV_TYPE_FLOAT)
            break;
        /* own texels were bytes */
        uint32_t u = form->read_rim ? extent.border_u : extent.width;
        uint32_t v = form->read_rim ? extent.border_v : extent.height;
        for (uint32_t y = 0; y < extent.height; y++) {
            const float *row = (const float *)texels.texels + (size_t)y * extent.width * nchannels;
            bool all = y < v || y >= extent.height - v;
            *out |= leaves(row, (size_t)(all ? extent.width : u) * nchannels);
            if (!all)
                *out |= leaves(row + (size_t)(extent.width - u) * nchannels, (size_t)u * nchannels);
        }
    }
    return result;
}

slv_result slvi_gl_store_is_wide(const slv_gl_source *source, const slv_gl_store *store,
                                 uint32_t item, slv_gl_staging *staging, bool *out) {
    const slv_form *form = store->pools.form;
    *out = false;
    if (!form->leaves_range || (form->copies && form->copies(store->made, item)))
        return SLV_OK;
    slv_form_extent extent = slvi_gl_extent(source, form, form->res(store->made, item), 0);
    uint32_t width = extent.width - 2 * extent.border_u + 2,
             height = extent.height - 2 * extent.border_v + 2;
    width = width > extent.width ? width : extent.width;
    height = height > extent.height ? height : extent.height;
    slv_result result = slvi_gl_staging_scratch(
        source, (uint64_t)width * height * slv_levels_get_desc(source->levels)->nchannels, staging);
    if (result)
        return result;
    /* colours that were decoded become 8 bits again */
    return source->srgb && store->pools.format.type == SLV_TYPE_U8
               ? leaves_bytes(source, store, item, staging->scratch, out)
               : form->leaves_range(store->made, item, staging->scratch, out);
}

static slv_result find_wide(void *user, uint64_t first, uint64_t end) {
    struct widen_job *job = user;
    slv_gl_staging staging = {0};
    slv_result result = SLV_OK;
    for (uint64_t item = first; !result && item < end; item++) {
        bool wide = false;
        result = slvi_gl_store_is_wide(job->source, job->store, (uint32_t)item, &staging, &wide);
        job->wide[item] = wide;
    }
    slvi_gl_staging_free(&staging);
    return result;
}

/* Items whose values leave the range of the texture's type get a wider one, or are clipped where
 * there are only blocks. */
static slv_result widen(const slv_gl_source *source, slv_gl_items *items, slv_gl_store *store) {
    struct widen_job job = {source, store, items->wide};
    bool blocks = store->pools.format.block;
    slv_result result = slvi_parallel_for(&source->shared, items->count, 64, find_wide, &job);
    for (uint32_t i = 0; i < items->count; i++)
        *(blocks ? &store->nclipped : &store->nwide) += items->wide[i];
    if (store->wide)
        memcpy(store->wide, items->wide, items->count);
    if (blocks)
        memset(items->wide, 0, items->count);
    return result;
}

/* One layer that is 1 in every texel of every level, with the size and levels of the pool that it
 * normalises. */
static slv_result make_coverage(const slv_gl_source *source, slv_gl_pool *pool, uint64_t *bytes) {
    const slv_gl_api *api = &source->gl->api;
    unsigned char *ones = NULL;
    slv_result result =
        slvi_alloc(source->env, "coverage", (uint64_t)pool->width * pool->height, 1, &ones);
    if (result)
        return result;
    memset(ones, 255, (size_t)pool->width * pool->height);
    api->CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &pool->coverage);
    api->TextureStorage3D(pool->coverage, (GLsizei)pool->nlevels, GL_R8, (GLsizei)pool->width,
                          (GLsizei)pool->height, 1);
    for (uint32_t level = 0; level < pool->nlevels; level++) {
        slv_res r = slv_res_level(pool->res, level);
        api->TextureSubImage3D(pool->coverage, (GLint)level, 0, 0, 0, 1 << r.u, 1 << r.v, 1, GL_RED,
                               GL_UNSIGNED_BYTE, ones);
        *bytes += (uint64_t)1 << (r.u + r.v);
    }
    slvi_free(ones);
    return SLV_OK;
}

slv_result slvi_gl_store_make_pool(const slv_gl_source *source, slv_gl_store *store,
                                   slv_gl_pool *pool) {
    const slv_gl_api *api = &source->gl->api;
    const slv_gl_pools *pools = &store->pools;
    const slv_gl_format *format = slv_gl_pool_format(pools, pool);
    slv_gl_sheet array = slv_gl_pool_array(pools, pool);
    uint32_t nlevels = slv_gl_pool_levels(pools, pool);
    if (!array.texture) {
        api->CreateTextures(GL_TEXTURE_2D_ARRAY, 1, &array.texture);
        api->TextureStorage3D(array.texture, (GLsizei)nlevels, format->internal,
                              (GLsizei)array.width, (GLsizei)array.height, (GLsizei)array.npages);
        api->TextureParameteriv(array.texture, GL_TEXTURE_SWIZZLE_RGBA, format->swizzle);
        store->bytes += slvi_gl_array_bytes(pools, pool);
        if (pool->columns && !format->block) /* what is between cells */
            api->ClearTexImage(array.texture, 0, format->external, format->data, NULL);
    }
    pool->texture = array.texture;
    if (pool->columns)
        pools->sheets[pool->sheet].texture = array.texture;
    return store->coverage && format->own_alpha
               ? make_coverage(source, pool, &store->coverage_bytes)
               : SLV_OK;
}

static slv_result begin_following(const slv_gl_source *source, uint32_t nitems,
                                  slv_gl_store *store) {
    slv_result result = slvi_alloc(source->env, "items", nitems, 1, &store->wide);
    if (!result)
        result = slvi_gl_marks_begin(source->env, nitems, &store->stale);
    if (!result)
        result = slvi_gl_marks_begin(source->env, nitems, &store->whole);
    return result ? result : slvi_gl_marks_begin(source->env, nitems, &store->waiting);
}

slv_result slvi_gl_store_prepare(const slv_gl_source *source, const slv_form *form, void *made,
                                 slv_gl_packing packing, bool shares, bool coverage,
                                 slv_gl_store *out) {
    slv_type type = slv_levels_get_desc(source->levels)->type;
    const slv_gl_texture_params *params = &source->params;
    slv_gl_items items = {0};
    slv_gl_pools *pools = &out->pools;
    slv_result result = SLV_OK;
    bool blocks = source->params.compression == SLV_GL_COMPRESSION_BLOCKS;
    *out = (slv_gl_store){.pools = {.form = form, .packing = packing, .shares = shares},
                          .made = made,
                          .coverage = coverage};
    pools->format = source->srgb
                        ? slvi_gl_format_srgb(source->gl, source->srgb, params, coverage, blocks)
                        : slvi_gl_format_for(type, params, coverage);
    pools->wide_format = slvi_gl_format_for(
        source->type == SLV_TYPE_U8 ? SLV_TYPE_HALF : SLV_TYPE_FLOAT, params, coverage);
    if ((blocks && (result = slvi_gl_format_compress(source->gl, source->env, source->type,
                                                     &pools->format))) ||
        (result = list_items(source, form, made, &items)) ||
        (source->params.live && (result = begin_following(source, items.count, out))) ||
        (form->leaves_range && (result = widen(source, &items, out))) ||
        (result = slvi_gl_pools_assign(source, &items, pools)) ||
        (result = slvi_gl_face_table(source, pools, made, &out->table, &out->bytes)))
        goto done;
    if (packing == SLV_GL_PAGES)
        result = slvi_gl_level_table(source, pools, &out->rects, &out->rect_bytes);
    out->bytes += out->rect_bytes;
done:
    free_items(&items);
    if (result)
        slvi_gl_store_free(source->gl, out);
    return result;
}

void slvi_gl_store_let_go(slv_gl_store *store) {
    if (store->pools.form)
        store->pools.form->destroy(store->made);
    store->made = NULL;
    slvi_free(store->wide);
    store->wide = NULL;
    slvi_gl_marks_end(&store->stale);
    slvi_gl_marks_end(&store->whole);
    slvi_gl_marks_end(&store->waiting);
}

void slvi_gl_store_free(const slv_gl *gl, slv_gl_store *store) {
    for (uint32_t s = 0; s < store->pools.nsheets; s++)
        slvi_gl_delete(gl->api.DeleteTextures, &store->pools.sheets[s].texture);
    for (uint32_t p = 0; p < store->pools.npools; p++) {
        if (!store->pools.pools[p].columns)
            slvi_gl_delete(gl->api.DeleteTextures, &store->pools.pools[p].texture);
        slvi_gl_delete(gl->api.DeleteTextures, &store->pools.pools[p].coverage);
    }
    slvi_gl_store_let_go(store);
    slvi_gl_delete(gl->api.DeleteBuffers, &store->table);
    slvi_gl_delete(gl->api.DeleteBuffers, &store->rects);
    slvi_gl_pools_free(&store->pools);
    memset(store, 0, sizeof *store);
}
