/* What was changed of a texture goes to the GPU: from changes to stale items, from these to layers
 * and rows of tables. */
#include "base/log.h"
#include "gl/live/live.h"
#include "gl/live/move.h"
#include "gl/store/texture.h"

#include <selvage/border.h>
#include <selvage/gl_live.h>
#include <selvage/source.h>

struct update {
    slv_gl_texture *texture;
    slv_gl_live *live;
    const slv_env *env;
    slv_gl_update done;
};

static slv_result mark(void *user, uint32_t item) {
    slvi_gl_marks_add(user, item);
    return SLV_OK;
}

/* Lists the items of a form that depend on what was changed. */
static slv_result list_stale(slv_gl_live *live, const slv_form *form, const void *made,
                             slv_gl_marks *out) {
    slvi_gl_marks_clear(out);
    return form->stale(made, live->changes, live->nchanges, &live->room_of_forms, mark, out);
}

/* What of a level is another after a change of level 0 of an item that has nothing else in it. */
static slv_rect part_of_level(slv_rect rect, uint32_t level) {
    uint32_t end_x = rect.x + rect.width - 1, end_y = rect.y + rect.height - 1;
    uint32_t x = rect.x >> level, y = rect.y >> level;
    return (slv_rect){x, y, (end_x >> level) - x + 1, (end_y >> level) - y + 1};
}

/* A rectangle of an item that has nothing but its own texels. */
static slv_result upload_part(struct update *update, slv_gl_store *store, uint32_t item,
                              slv_rect rect) {
    const slv_gl_pools *pools = &store->pools;
    uint32_t nlevels = pools->pools[pools->pool_of[item]].nlevels;
    slv_result result = SLV_OK;
    for (uint32_t level = 0; !result && level < nlevels; level++) {
        slv_rect part = part_of_level(rect, level);
        result = slvi_gl_upload_rect(&update->live->source, pools, store->made, item, level, &part,
                                     &update->live->staging, &update->done.bytes);
    }
    return result;
}

static slv_result upload_rim(struct update *update, slv_gl_store *store, uint32_t item) {
    const slv_gl_pools *pools = &store->pools;
    uint32_t nlevels = pools->pools[pools->pool_of[item]].nlevels;
    slv_result result = SLV_OK;
    for (uint32_t level = 0; !result && level < nlevels; level++)
        result = slvi_gl_upload_rim(&update->live->source, pools, store->made, item, level,
                                    &update->live->staging, &update->done.bytes);
    return result;
}

/* Whether all of an item is to be uploaded. */
static bool goes_whole(const struct update *update, const slv_gl_store *store, uint32_t item) {
    const slv_gl_pools *pools = &store->pools;
    return store->stale.is_listed[item] &&
           (store->whole.is_listed[item] ||
            (pools->form != slv_form_bare() &&
             !slvi_gl_has_rim(&update->live->source, pools, store->made, item)));
}

/* Such an item, with those that go whole and are in the layers after its own; nothing, if it goes
 * with the one before. */
static slv_result upload_whole(struct update *update, slv_gl_store *store, uint32_t item) {
    const slv_gl_source *source = &update->live->source;
    const slv_gl_pools *pools = &store->pools;
    const slv_gl_pool *pool = &pools->pools[pools->pool_of[item]];
    uint32_t first = pools->layer_of[item], end = first + 1;
    slv_result result = SLV_OK;
    if (pools->format.block) {
        for (uint32_t level = 0; !result && level < pool->nlevels; level++)
            result = slvi_gl_upload_rect(source, pools, store->made, item, level, NULL,
                                         &update->live->staging, &update->done.bytes);
        return result;
    }
    if (!slvi_gl_begins_run(pools, pool, first) &&
        goes_whole(update, store, pool->items[first - 1]))
        return SLV_OK;
    while (end < pool->nlayers && !slvi_gl_begins_run(pools, pool, end) &&
           goes_whole(update, store, pool->items[end]))
        end++;
    return slvi_gl_upload_run(source, pools, store->made, pool, first, end - first,
                              &update->live->staging, &update->done.bytes);
}

/* Moves an item that has another resolution, or needs another type, than before. */
static slv_result move(struct update *update, slv_gl_store *store, uint32_t item) {
    const slv_gl_source *source = &update->live->source;
    uint32_t fillers[2], items[SLV_FORM_ITEMS];
    slv_res res;
    bool waits, wide = false, blocks = store->pools.format.block;
    slv_result result = slvi_gl_store_is_wide(source, store, item, &update->live->staging, &wide);
    if (result)
        return result;
    if (wide != store->wide[item])
        *(blocks ? &store->nclipped : &store->nwide) += wide ? 1u : UINT32_MAX;
    store->wide[item] = wide;
    if ((result = slvi_gl_item_res(source, store->pools.form, store->made, item,
                                   &update->live->room_of_forms, &res)))
        return result;
    /* What has come to be of one colour keeps its place: under a brush faces do so one after the
     * other, and with each of them batches were others, for which drivers compile shaders anew. */
    const slv_res all = store->pools.form->res(store->made, item),
                  now = store->pools.pools[store->pools.pool_of[item]].res;
    if (!blocks && all.u == now.u && all.v == now.v)
        res = all;
    if (!slvi_gl_move_needed(store, item, res))
        return SLV_OK;
    if ((result =
             slvi_gl_move_item(source, store, item, res, &update->live->room, fillers, &waits)))
        return result;
    if (waits)
        slvi_gl_marks_add(&store->waiting, item);
    slvi_gl_marks_add(&store->whole, item);
    bool faces = store->pools.form->items(store->made, 0, items) == 1;
    if (faces)
        slvi_gl_move_row(source, store, item);
    for (uint32_t i = 0; i < 2; i++) { /* they are uploaded with those that are listed */
        if (faces)
            slvi_gl_move_row(source, store, fillers[i]);
        slvi_gl_marks_add(&store->stale, fillers[i]);
        slvi_gl_marks_add(&store->whole, fillers[i]);
    }
    store->moved = true;
    update->done.moved++;
    return SLV_OK;
}

/* Whether there is no rectangle of a face to be uploaded apart. */
static bool is_all(const slv_gl_live *live, const slv_form_change *change) {
    slv_res res = slv_levels_get_desc(live->levels)->res[change->face];
    return slvi_gl_is_constant(&live->source, change->face) ||
           (change->rect.width >> res.u && change->rect.height >> res.v);
}

static slv_result update_store(struct update *update, slv_gl_store *store) {
    slv_gl_live *live = update->live;
    const slv_form *form = store->pools.form;
    slv_gl_marks *stale = &store->stale;
    bool bare = form == slv_form_bare(); /* the rectangles are known */
    slv_result result;
    if ((result = list_stale(live, form, store->made, stale)))
        return result;
    for (uint32_t i = 0; i < store->waiting.count; i++) /* there may be room now */
        slvi_gl_marks_add(stale, store->waiting.listed[i]);
    slvi_gl_marks_clear(&store->waiting);
    slvi_gl_marks_clear(&store->whole);
    for (uint32_t i = 0; i < live->nchanges; i++)
        if (form->read_rim || (bare && is_all(live, &live->changes[i]))) /* items are faces */
            slvi_gl_marks_add(&store->whole, live->changes[i].face);
    update->done.items += stale->count;
    if (form->refresh && (result = form->refresh(store->made, stale->listed, stale->count)))
        return result;
    for (uint32_t i = 0, n = stale->count; !result && i < n; i++)
        result = move(update, store, stale->listed[i]);
    for (uint32_t i = 0; !result && i < stale->count; i++) {
        uint32_t item = stale->listed[i];
        if (goes_whole(update, store, item))
            result = upload_whole(update, store, item);
        else if (!bare)
            result = upload_rim(update, store, item);
    }
    for (uint32_t i = 0; !result && bare && i < live->nchanges; i++)
        if (!goes_whole(update, store, live->changes[i].face))
            result = upload_part(update, store, live->changes[i].face, live->changes[i].rect);
    if (result || !store->moved)
        return result;
    slvi_gl_texture_leave_handles(update->texture); /* of arrays that go, or lie elsewhere */
    return slvi_gl_move_end(&live->source, store);
}

/* Faces that have got another resolution: their rows in the tables of faces. */
static void resize_faces(struct update *update) {
    slv_gl_texture *texture = update->texture;
    const slv_texture_desc *desc = slv_levels_get_desc(update->live->levels);
    uint64_t texel = texture->params.nchannels * slv_type_size(update->live->source.type);
    for (uint32_t i = 0; i < update->live->nchanges; i++) {
        uint32_t face = update->live->changes[i].face;
        slv_res *old = &texture->res[face], res = desc->res[face];
        if (old->u == res.u && old->v == res.v)
            continue;
        texture->texel_bytes += (texel << (res.u + res.v)) - (texel << (old->u + old->v));
        *old = res;
        for (uint32_t k = 0; k < texture->nstores; k++) {
            slvi_gl_move_row(&update->live->source, &texture->stores[k], face);
            /* links say how large it is, and it may stay where it lies */
            texture->stores[k].moved |= slvi_gl_is_constant(&update->live->source, face);
        }
    }
}

static slv_result update_all(struct update *update) {
    slv_gl_texture *texture = update->texture;
    slv_gl_live *live = update->live;
    slv_result result = SLV_OK;
    resize_faces(update);
    for (uint32_t i = 0; !result && i < texture->nstores; i++)
        result = update_store(update, &texture->stores[i]);
    bool values = false;
    for (uint32_t i = 0; i < texture->nreaches; i++)
        values |= slvi_gl_reach_has_values(texture->reaches[i].kind);
    if (!result && values)
        result = list_stale(live, slv_form_borders(), live->around, &live->faces);
    for (uint32_t i = 0; !result && i < texture->nreaches; i++) {
        slv_gl_reach_row *row = &texture->reaches[i];
        const slv_gl_store *store = &texture->stores[row->store];
        if (store->moved) { /* batches are of pools, and triangles are sorted by batches */
            texture->serial = ++texture->gl->serial;
            slvi_gl_reach_free(texture->gl, &row->reach);
            result = slvi_gl_reach_build(&live->source, row->kind, &store->pools, store->made,
                                         &row->reach);
            continue;
        }
        result = slvi_gl_reach_refresh(&live->source, row->kind, &store->pools, store->made,
                                       &live->faces, &row->reach);
    }
    for (uint32_t i = 0; !result && i < texture->nstores; i++)
        texture->stores[i].moved = false;
    return result ? result : slvi_gl_texture_take_handles(texture);
}

static slv_result update_within(struct update *update) {
    slv_gl_live *live = update->live;
    uint64_t version = slv_texture_version(live->texture);
    bool renew = false;
    slv_result result;
    if ((result = slvi_gl_texture_need_ready(update->texture, update->env)) ||
        (result = slvi_gl_live_follow(live, update->env, &renew)))
        return result;
    update->done.faces = live->nchanges;
    bool any = live->nchanges || live->half_done;
    for (uint32_t i = 0; i < update->texture->nstores; i++)
        any |= update->texture->stores[i].waiting.count > 0;
    if (!any)
        return SLV_OK;
    update->done.renewed = renew || live->half_done;
    live->half_done = true;
    slv_gl_transfer before = slvi_gl_transfer_begin(update->texture->gl);
    result = update->done.renewed ? slvi_gl_texture_renew(update->texture) : update_all(update);
    slvi_gl_transfer_end(update->texture->gl, &before);
    if (result || (result = slvi_gl_check(update->texture->gl, update->env, "GL texture update")))
        return result;
    if (update->done.renewed) /* and with it what follows changes */
        return SLV_OK;
    live->half_done = false;
    live->seen = version;
    return SLV_OK;
}

slv_result slv_gl_texture_update(slv_gl_texture *texture, const slv_env *env, slv_gl_update *out) {
    struct update update = {.texture = texture, .live = texture->live, .env = env};
    slv_result result = texture->live
                            ? update_within(&update)
                            : slvi_fail(env, SLV_ERROR_ARGUMENT,
                                        "the texture was not made to follow changes (`live`)");
    if (out)
        *out = update.done;
    return result;
}
