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
static slv_result list_stale(const slv_gl_live *live, const slv_form *form, const void *made,
                             slv_gl_marks *out) {
    slv_result result = SLV_OK;
    slvi_gl_marks_clear(out);
    for (uint32_t i = 0; !result && i < live->nchanges; i++)
        result = form->stale(made, live->changes[i].face, &live->changes[i].rect, mark, out);
    return result;
}

/* What of a level is another after a change of level 0 of an item that has nothing else in it. */
static slv_rect part_of_level(slv_rect rect, uint32_t level) {
    uint32_t end_x = rect.x + rect.width - 1, end_y = rect.y + rect.height - 1;
    uint32_t x = rect.x >> level, y = rect.y >> level;
    return (slv_rect){x, y, (end_x >> level) - x + 1, (end_y >> level) - y + 1};
}

static slv_result upload(struct update *update, slv_gl_store *store, uint32_t item,
                         const slv_rect *rect) {
    const slv_gl_source *source = &update->live->source;
    const slv_gl_pools *pools = &store->pools;
    uint32_t nlevels = pools->pools[pools->pool_of[item]].nlevels;
    slv_result result = SLV_OK;
    bool rim = !rect && pools->form->read_rim && !store->whole.is_listed[item];
    for (uint32_t level = 0; !result && rim && level < nlevels; level++)
        result = slvi_gl_upload_rim(source, pools, store->made, item, level, &update->live->staging,
                                    &update->done.bytes);
    for (uint32_t level = 0; !result && !rim && level < nlevels; level++) {
        slv_rect part = rect ? part_of_level(*rect, level) : (slv_rect){0};
        result = slvi_gl_upload_rect(source, pools, store->made, item, level, rect ? &part : NULL,
                                     &update->live->staging, &update->done.bytes);
    }
    return result;
}

/* Moves an item that has another resolution, or needs another type, than before. */
static slv_result move(struct update *update, slv_gl_store *store, uint32_t item) {
    const slv_gl_source *source = &update->live->source;
    uint32_t fillers[2], items[SLV_FORM_ITEMS];
    slv_res res;
    bool waits, wide = false, blocks = store->pools.format.block;
    slv_result result = slvi_gl_store_is_wide(source, store, item, &wide);
    if (result)
        return result;
    if (wide != store->wide[item])
        *(blocks ? &store->nclipped : &store->nwide) += wide ? 1u : UINT32_MAX;
    store->wide[item] = wide;
    if ((result = slvi_gl_item_res(source, store->pools.form, store->made, item, &res)) ||
        !slvi_gl_move_needed(store, item, res))
        return result;
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

static slv_result update_store(struct update *update, slv_gl_store *store) {
    const slv_gl_live *live = update->live;
    const slv_form *form = store->pools.form;
    slv_gl_marks *stale = &store->stale;
    slv_result result;
    if ((result = list_stale(live, form, store->made, stale)))
        return result;
    for (uint32_t i = 0; i < store->waiting.count; i++) /* there may be room now */
        slvi_gl_marks_add(stale, store->waiting.listed[i]);
    slvi_gl_marks_clear(&store->waiting);
    slvi_gl_marks_clear(&store->whole);
    for (uint32_t i = 0; form->read_rim && i < live->nchanges; i++) /* items are faces */
        slvi_gl_marks_add(&store->whole, live->changes[i].face);
    update->done.items += stale->count;
    if (form->refresh && (result = form->refresh(store->made, stale->listed, stale->count)))
        return result;
    for (uint32_t i = 0, n = stale->count; !result && i < n; i++)
        result = move(update, store, stale->listed[i]);
    if (!result && form == slv_form_bare() && !store->moved) { /* the rectangles are known */
        for (uint32_t i = 0; !result && i < live->nchanges; i++) {
            const slv_gl_change *change = &live->changes[i];
            bool constant = slvi_gl_is_constant(&live->source, change->face);
            result = upload(update, store, change->face, constant ? NULL : &change->rect);
        }
        return result;
    }
    for (uint32_t i = 0; !result && i < stale->count; i++)
        result = upload(update, store, stale->listed[i], NULL);
    return result || !store->moved ? result : slvi_gl_move_end(&live->source, store);
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
    if (!result && texture->nreaches)
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
                                       live->faces.listed, live->faces.count, &row->reach);
    }
    for (uint32_t i = 0; !result && i < texture->nstores; i++)
        texture->stores[i].moved = false;
    return result;
}

static slv_result update_within(struct update *update) {
    slv_gl_live *live = update->live;
    uint64_t version = slv_texture_version(live->texture);
    bool renew = false;
    slv_result result;
    if ((result = slvi_gl_live_follow(live, update->env, &renew)))
        return result;
    update->done.faces = live->nchanges;
    bool any = live->nchanges || live->half_done;
    for (uint32_t i = 0; i < update->texture->nstores; i++)
        any |= update->texture->stores[i].waiting.count > 0;
    if (!any)
        return SLV_OK;
    slvi_gl_set_state(live->source.gl);
    update->done.renewed = renew || live->half_done;
    live->half_done = true;
    result = update->done.renewed ? slvi_gl_texture_renew(update->texture) : update_all(update);
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
