/* Finding layers, and what of a document is to be flattened again. */
#include "layer/document_data.h"

#include "adjacency/edge.h"
#include "base/memory.h"

void slvi_layer_drop(slvi_layer *layer) {
    if (!layer || --layer->refs)
        return;
    slvi_plane_drop(layer->colour);
    slvi_plane_drop(layer->mask);
    slvi_free(layer);
}

slvi_layer *slvi_document_find(const slv_document *document, uint32_t id, uint32_t *index) {
    for (uint32_t i = 0; i < document->nlayers; i++)
        if (document->stack[i]->id == id) {
            if (index)
                *index = i;
            return document->stack[i];
        }
    return NULL;
}

bool slv_document_selected(const slv_document *document, uint32_t face) {
    return face < document->flat.nfaces &&
           (!document->selected || document->selected[face / 64] >> face % 64 & 1);
}

static void mark(slv_document *document, uint32_t face, slv_rect rect) {
    slv_rect *old = &document->dirty[face];
    if (!old->width) {
        document->dirty_faces[document->ndirty++] = face;
        *old = rect;
        return;
    }
    uint32_t x1 = rect.x + rect.width, y1 = rect.y + rect.height;
    uint32_t ox1 = old->x + old->width, oy1 = old->y + old->height;
    old->x = rect.x < old->x ? rect.x : old->x;
    old->y = rect.y < old->y ? rect.y : old->y;
    old->width = (x1 > ox1 ? x1 : ox1) - old->x;
    old->height = (y1 > oy1 ? y1 : oy1) - old->y;
}

/* Where texels first..first+count of 2^from along an axis show among 2^to: where they are larger,
 * one texel further to both sides. */
static void stretch(int from, int to, uint32_t *first, uint32_t *count) {
    uint32_t begin = *first, end = begin + *count, whole = 1u << from;
    if (from < to) {
        begin = (begin ? begin - 1 : 0) << (to - from);
        end = (end < whole ? end + 1 : whole) << (to - from);
    } else {
        begin >>= from - to;
        end = ((end - 1) >> (from - to)) + 1;
    }
    *first = begin;
    *count = end - begin;
}

/* How far from the edges texels of 2^size along a face can be told in faces beside it, which see
 * others at 2^least x 2^most or the other way round: half of theirs away, twice as far where one
 * face has half the other's edge, in one that may be a mean. */
static uint32_t reach(int size, int least, int most) {
    return (size > least ? 1u << (size - least) : 1) + (size > most ? 1u << (size - most) : 1);
}

static bool shows_beside(slv_res res, slv_rect rect, slv_res seen) {
    int least = seen.u < seen.v ? seen.u : seen.v, most = seen.u < seen.v ? seen.v : seen.u;
    uint32_t u = reach(res.u, least, most), v = reach(res.v, least, most);
    return rect.x < u || rect.x + rect.width + u > 1u << res.u || rect.y < v ||
           rect.y + rect.height + v > 1u << res.v;
}

/* Of the faces around one those in which texels of `face` may show, since theirs are larger there.
 * That is the same face, or one beside it: half of a quad with a single texel is the whole of a
 * sub-face, and behind that is another. */
static void mark_around(slv_document *document, const slvi_plane *plane, uint32_t around,
                        uint32_t face, slv_rect rect) {
    const slv_adjacency *adjacency = document->adjacency;
    for (unsigned corner = 0; corner < 4; corner++) {
        slv_ring ring = slv_adjacency_ring(adjacency, (int32_t)around, corner, NULL);
        slv_neighbour across[2];
        uint32_t count = slv_adjacency_neighbours(adjacency, (int32_t)around, corner, across);
        for (uint32_t i = 0; i < ring.count + count; i++) {
            uint32_t other =
                (uint32_t)(i < ring.count ? ring.corners[i].face : across[i - ring.count].face);
            slv_res from = plane->res[other], to = document->res[other];
            slv_res seen = {from.u < to.u ? from.u : to.u, from.v < to.v ? from.v : to.v};
            if (other != face && (from.u < to.u || from.v < to.v) &&
                (around == face || !seen.u || !seen.v) &&
                shows_beside(plane->res[face], rect, seen))
                mark(document, other, slvi_res_rect(to));
            if (other != face && around == face &&
                slv_adjacency_is_subface(adjacency, (int32_t)face) &&
                slv_adjacency_is_subface(adjacency, (int32_t)other))
                mark_around(document, plane, other, face, rect);
        }
    }
}

void slvi_document_touch(slv_document *document, const slvi_plane *plane, uint32_t face,
                         slv_rect rect) {
    slv_res from = plane->res[face], to = document->res[face];
    if (document->mixed && document->adjacency)
        mark_around(document, plane, face, face, rect);
    stretch(from.u, to.u, &rect.x, &rect.width);
    stretch(from.v, to.v, &rect.y, &rect.height);
    mark(document, face, rect);
}

void slvi_document_touch_all(slv_document *document) {
    for (uint32_t face = 0; face < document->flat.nfaces; face++)
        mark(document, face, slvi_res_rect(document->res[face]));
}

void slvi_document_touch_layer(slv_document *document, const slvi_layer *layer) {
    const slvi_plane *plane = layer->colour;
    if (plane->filled) {
        slvi_document_touch_all(document);
        return;
    }
    for (uint32_t face = 0; face < plane->nfaces; face++)
        if (plane->tables[face])
            slvi_document_touch(document, plane, face, slvi_res_rect(plane->res[face]));
}
