/* A layer as what paint is put on: blocks are copied before they are written to. */
#include "history/history.h"

#include "base/log.h"
#include "base/memory.h"

struct slvi_handle {
    slvi_handle *next;
    slv_document *document;
    uint32_t id;
    bool mask;
    uint64_t entry; /* of the last `begin` */
};

static slvi_plane *plane_of(const slvi_handle *handle) {
    const slvi_layer *layer = slvi_document_find(handle->document, handle->id, NULL);
    return !layer ? NULL : handle->mask ? layer->mask : layer->colour;
}

static slv_result missing(const slvi_handle *handle) {
    return slvi_fail(&handle->document->env, SLV_ERROR_ARGUMENT, "document: there is no %s %u",
                     handle->mask ? "mask of layer" : "layer", (unsigned)handle->id);
}

static slv_result describe(void *user, slv_canvas_desc *out) {
    const slvi_plane *plane = plane_of(user);
    if (!plane)
        return missing(user);
    *out = (slv_canvas_desc){plane->nfaces, plane->nchannels, plane->alpha, plane->res};
    return SLV_OK;
}

/* Whether a patch covers something of a block. */
static bool is_covered(const slv_patch *patch, slv_rect block) {
    slv_rect r = patch->rect;
    uint32_t x0 = block.x > r.x ? block.x : r.x, y0 = block.y > r.y ? block.y : r.y;
    uint32_t x1 = block.x + block.width, y1 = block.y + block.height;
    x1 = x1 < r.x + r.width ? x1 : r.x + r.width;
    y1 = y1 < r.y + r.height ? y1 : r.y + r.height;
    for (uint32_t y = y0; y < y1; y++)
        for (uint32_t x = x0; x < x1; x++)
            if (patch->coverage[(size_t)(y - r.y) * r.width + (x - r.x)] > 0)
                return true;
    return false;
}

/* Lists the blocks under a patch that are not yet the open entry's own. */
static slv_result list_blocks(slv_document *document, slvi_plane *plane, const slv_patch *patch,
                              uint64_t *count) {
    uint32_t face = patch->face;
    slv_res res = plane->res[face];
    slv_rect blocks = slvi_rect_blocks(res, patch->rect);
    uint64_t entry = document->history.open->serial;
    slv_result result = SLV_OK;
    if (!plane->tables[face] && (result = slvi_table_create(plane, res, &plane->tables[face])))
        return result;
    for (uint32_t y = blocks.y; y < blocks.y + blocks.height; y++)
        for (uint32_t x = blocks.x; x < blocks.x + blocks.width; x++) {
            uint32_t index = y * slvi_blocks_along(res.u) + x;
            const slvi_block *block = plane->tables[face]->blocks[index];
            if ((block && block->entry == entry && atomic_load(&block->refs) == 1) ||
                !is_covered(patch, slvi_block_rect(res, index)))
                continue;
            if (*count == document->made_room) {
                uint64_t room = *count + *count / 2 + 64;
                if ((result = slvi_grow(&document->env, "layer", room, sizeof *document->made,
                                        &document->made)))
                    return result;
                document->made_room = room;
            }
            document->made[(*count)++] = (slvi_old_block){face, index, NULL};
        }
    return SLV_OK;
}

static slv_result make_blocks(slv_document *document, slvi_plane *plane,
                              const slv_patches *patches) {
    uint64_t count = 0, made = 0;
    slv_result result = SLV_OK;
    for (uint32_t i = 0; !result && i < patches->count; i++)
        if (slv_document_selected(document, patches->list[i].face))
            result = list_blocks(document, plane, &patches->list[i], &count);
    if (!result)
        result = slvi_change_room_blocks(document, plane, count);
    for (; !result && made < count; made++) {
        slvi_old_block *to = &document->made[made];
        if ((result = slvi_block_copy(plane, plane->res[to->face],
                                      plane->tables[to->face]->blocks[to->index],
                                      document->history.open->serial, &to->block)))
            break;
    }
    for (uint64_t i = 0; i < made; i++) {
        slvi_old_block *to = &document->made[i];
        if (result)
            slvi_block_drop(to->block);
        else
            slvi_change_block(document, plane, to->face, to->index, to->block);
    }
    return result;
}

static slv_result begin(void *user, const slv_patches *patches) {
    slvi_handle *handle = user;
    slv_document *document = handle->document;
    const slvi_layer *layer = slvi_document_find(document, handle->id, NULL);
    slvi_plane *plane = plane_of(handle);
    slvi_edit edit;
    slv_result result;
    if (!plane)
        return missing(handle);
    if (layer->props.locked)
        return slvi_fail(&document->env, SLV_ERROR_ARGUMENT, "document: layer %u is locked",
                         (unsigned)handle->id);
    for (uint32_t i = 0; i < patches->count; i++) {
        const slv_patch *patch = &patches->list[i];
        slv_res res = patch->face < plane->nfaces ? plane->res[patch->face] : (slv_res){0, 0};
        if (patch->face >= plane->nfaces || !patch->rect.width || !patch->rect.height ||
            patch->rect.x + (uint64_t)patch->rect.width > (uint64_t)1 << res.u ||
            patch->rect.y + (uint64_t)patch->rect.height > (uint64_t)1 << res.v)
            return slvi_fail(&document->env, SLV_ERROR_ARGUMENT,
                             "document: layer %u: face %u has no such rectangle",
                             (unsigned)handle->id, (unsigned)patch->face);
    }
    if (document->watch.paint &&
        (result = document->watch.paint(document->watch.user, handle->id, handle->mask)))
        return result;
    if ((result = slvi_edit_begin(document, "paint", &edit)))
        return result;
    handle->entry = document->history.open->serial;
    if (!(result = make_blocks(document, plane, patches)))
        for (uint32_t i = 0; i < patches->count; i++)
            if (slv_document_selected(document, patches->list[i].face))
                slvi_document_touch(document, plane, patches->list[i].face, patches->list[i].rect);
    return slvi_edit_end(document, &edit, NULL, result);
}

static slv_result read_rect(void *user, uint32_t face, slv_rect rect, float *out) {
    const slvi_plane *plane = plane_of(user);
    if (!plane)
        return missing(user);
    slvi_plane_read(plane, face, rect, out);
    return SLV_OK;
}

static slv_result write_rect(void *user, uint32_t face, slv_rect rect, const float *texels) {
    const slvi_handle *handle = user;
    const slvi_plane *plane = plane_of(handle);
    if (!plane)
        return missing(handle);
    if (slv_document_selected(handle->document, face))
        slvi_table_write(plane, plane->res[face], plane->tables[face], rect, handle->entry, texels);
    return SLV_OK;
}

slv_result slv_document_canvas(slv_document *document, uint32_t id, bool mask, slv_canvas *out) {
    static const slv_canvas_fns fns = {
        .describe = describe, .begin = begin, .read = read_rect, .write = write_rect};
    slvi_handle *handle = document->handles;
    slv_result result = SLV_OK;
    while (handle && (handle->id != id || handle->mask != mask))
        handle = handle->next;
    if (!handle) {
        if ((result = slvi_alloc(&document->env, "layer", 1, sizeof *handle, &handle)))
            return result;
        *handle = (slvi_handle){document->handles, document, id, mask, 0};
        document->handles = handle;
    }
    *out = (slv_canvas){&fns, handle};
    return SLV_OK;
}

void slvi_document_free_handles(slv_document *document) {
    while (document->handles) {
        slvi_handle *next = document->handles->next;
        slvi_free(document->handles);
        document->handles = next;
    }
}
