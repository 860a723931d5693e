/* What is undone and redone by swapping it with what is there. */
#include "history/history.h"

#include "base/memory.h"

static void swap_block(slv_document *document, const slvi_change *change, uint64_t i) {
    slvi_old_block *old = &change->blocks[i];
    slvi_plane *plane = change->plane;
    slvi_block **at = &plane->tables[old->face]->blocks[old->index], *now = *at;
    *at = old->block;
    old->block = now;
    slvi_document_touch(document, plane, old->face,
                        slvi_block_rect(plane->res[old->face], old->index));
}

static void swap_face(slv_document *document, const slvi_change *change, uint64_t i) {
    slvi_old_face *old = &change->faces[i];
    slvi_plane *plane = change->plane;
    slv_res *res = plane ? &plane->res[old->face] : &document->res[old->face], now = *res;
    if (!plane) {
        *res = old->res;
        old->res = now;
        document->remake = true;
        return;
    }
    slvi_table *table = plane->tables[old->face];
    *res = old->res;
    old->res = now;
    plane->tables[old->face] = old->table;
    old->table = table;
    slvi_document_touch(document, plane, old->face, slvi_res_rect(*res));
}

/* Layers below and above those that moved show as they did. */
static void swap_stack(slv_document *document, slvi_change *change) {
    slvi_layer **now = document->stack;
    uint32_t count = document->nlayers, other = (uint32_t)change->count, low = 0, high = 0;
    while (low < count && low < other && now[low] == change->stack[low])
        low++;
    while (low + high < count && low + high < other &&
           now[count - 1 - high] == change->stack[other - 1 - high])
        high++;
    for (uint32_t i = low; i + high < count; i++)
        slvi_document_touch_layer(document, now[i]);
    for (uint32_t i = low; i + high < other; i++)
        slvi_document_touch_layer(document, change->stack[i]);
    document->stack = change->stack;
    document->nlayers = other;
    change->stack = now;
    change->count = count;
}

static void swap_layer(slv_document *document, slvi_change *change) {
    slvi_layer *layer = change->layer;
    slv_layer_props props = layer->props, *to = &change->props;
    slvi_plane *mask = layer->mask;
    bool shows = props.opacity != to->opacity || props.blend != to->blend ||
                 props.hidden != to->hidden || mask != change->mask;
    layer->props = change->props;
    layer->mask = change->mask;
    change->props = props;
    change->mask = mask;
    if (shows)
        slvi_document_touch_layer(document, layer);
}

void slvi_change_swap(slv_document *document, slvi_change *change, uint64_t from, bool forward) {
    uint64_t count = change->count - from;
    uint64_t *bits = document->selected;
    switch (change->kind) {
    case SLVI_CHANGE_BLOCKS:
        for (uint64_t i = 0; i < count; i++)
            swap_block(document, change, from + (forward ? i : count - 1 - i));
        break;
    case SLVI_CHANGE_FACES:
        for (uint64_t i = 0; i < count; i++)
            swap_face(document, change, from + (forward ? i : count - 1 - i));
        break;
    case SLVI_CHANGE_STACK:
        swap_stack(document, change);
        break;
    case SLVI_CHANGE_LAYER:
        swap_layer(document, change);
        break;
    case SLVI_CHANGE_SELECTION:
        document->selected = change->bits;
        change->bits = bits;
        break;
    }
}

void slvi_change_free(slvi_change *change) {
    for (uint64_t i = 0; change->blocks && i < change->count; i++)
        slvi_block_drop(change->blocks[i].block);
    for (uint64_t i = 0; change->faces && i < change->count; i++)
        slvi_table_drop(change->faces[i].table);
    for (uint64_t i = 0; change->stack && i < change->count; i++)
        slvi_layer_drop(change->stack[i]);
    slvi_free(change->blocks);
    slvi_free(change->faces);
    slvi_free(change->stack);
    slvi_free(change->bits);
    slvi_plane_drop(change->plane);
    slvi_plane_drop(change->mask);
    slvi_layer_drop(change->layer);
    *change = (slvi_change){.kind = change->kind};
}

static slv_result make_room(slv_document *document) {
    slvi_entry *entry = document->history.open;
    return slvi_grow(&document->env, "history", entry->nchanges + (uint64_t)1,
                     sizeof *entry->changes, &entry->changes);
}

static void commit(slv_document *document, const slvi_change *change) {
    slvi_entry *entry = document->history.open;
    entry->changes[entry->nchanges++] = *change;
    document->history.open_room = change->count;
}

slv_result slvi_change_put(slv_document *document, slvi_change *change) {
    slv_result result = make_room(document);
    if (result)
        return result;
    slvi_change_swap(document, change, 0, true);
    commit(document, change);
    *change = (slvi_change){.kind = change->kind};
    return SLV_OK;
}

/* The last change of the open entry, if it is one of this plane's blocks. */
static slvi_change *last_blocks(slv_document *document, const slvi_plane *plane) {
    slvi_entry *entry = document->history.open;
    slvi_change *last = entry->nchanges ? &entry->changes[entry->nchanges - 1] : NULL;
    return last && last->kind == SLVI_CHANGE_BLOCKS && last->plane == plane ? last : NULL;
}

slv_result slvi_change_room_blocks(slv_document *document, slvi_plane *plane, uint64_t count) {
    slvi_history *history = &document->history;
    slvi_change *last = last_blocks(document, plane), change = {.kind = SLVI_CHANGE_BLOCKS};
    slv_result result;
    if (!count || (last && last->count + count <= history->open_room))
        return SLV_OK;
    if (last) {
        uint64_t room = last->count + count + last->count / 8; /* what is left over is lost */
        if (!(result =
                  slvi_grow(&document->env, "history", room, sizeof *last->blocks, &last->blocks)))
            history->open_room = room;
        return result;
    }
    if ((result = make_room(document)) ||
        (result =
             slvi_alloc(&document->env, "history", count, sizeof *change.blocks, &change.blocks)))
        return result;
    change.plane = slvi_plane_hold(plane);
    commit(document, &change);
    history->open_room = count;
    return SLV_OK;
}

void slvi_change_block(slv_document *document, slvi_plane *plane, uint32_t face, uint32_t index,
                       slvi_block *block) {
    slvi_change *last = last_blocks(document, plane);
    slvi_block **at = &plane->tables[face]->blocks[index];
    last->blocks[last->count++] = (slvi_old_block){face, index, *at};
    *at = block;
}

void slvi_entry_measure(slvi_entry *entry) {
    entry->bytes = sizeof *entry + entry->nchanges * sizeof *entry->changes;
    entry->block_bytes = 0;
    for (uint32_t k = 0; k < entry->nchanges; k++) {
        const slvi_change *change = &entry->changes[k];
        for (uint64_t i = 0; change->blocks && i < change->count; i++)
            if (change->blocks[i].block)
                entry->block_bytes += sizeof(slvi_block) + change->blocks[i].block->bytes;
        for (uint64_t i = 0; change->faces && i < change->count; i++)
            entry->block_bytes += slvi_table_bytes(change->faces[i].table);
        entry->bytes += change->count * (change->blocks  ? sizeof *change->blocks
                                         : change->faces ? sizeof *change->faces
                                                         : sizeof(void *));
        for (uint64_t i = 0; change->stack && i < change->count; i++)
            if (change->stack[i]->refs == 1)
                entry->block_bytes += slvi_plane_bytes(change->stack[i]->colour) +
                                      slvi_plane_bytes(change->stack[i]->mask);
    }
    entry->bytes += entry->block_bytes;
}
