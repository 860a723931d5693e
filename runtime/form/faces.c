/* Forms whose items are faces, and the faces that depend on another one's texels. */
#include "form/faces.h"

#include "base/log.h"
#include "base/memory.h"
#include "texture/texture_data.h"

#include <string.h>

slv_result slvi_form_faces_begin(const slv_env *env, const slv_levels *levels,
                                 const slv_adjacency *adjacency, uint32_t border,
                                 slv_form_faces *out) {
    const slv_texture_desc *desc = slv_levels_get_desc(levels);
    if (slv_adjacency_face_count(adjacency) != desc->nfaces)
        return slvi_fail(env, SLV_ERROR_MISMATCH, "form: %u faces of texture, %u of adjacency",
                         desc->nfaces, slv_adjacency_face_count(adjacency));
    *out = (slv_form_faces){
        .desc = desc, .levels = levels, .adjacency = adjacency, .border = border ? border : 1};
    if (env)
        out->env = *env;
    return SLV_OK;
}

slv_result slvi_form_faces_create(const slv_env *env, const slv_levels *levels,
                                  const slv_adjacency *adjacency, uint32_t border, void **out) {
    slv_form_faces *made = NULL;
    slv_result result = slvi_alloc(env, "form", 1, sizeof *made, &made);
    if (!result && (result = slvi_form_faces_begin(env, levels, adjacency, border, made))) {
        slvi_free(made);
        made = NULL;
    }
    *out = made;
    return result;
}

void slvi_form_faces_destroy(void *made) {
    slvi_free(made);
}

uint32_t slvi_form_faces_count(const void *made) {
    return ((const slv_form_faces *)made)->desc->nfaces;
}

slv_res slvi_form_faces_res(const void *made, uint32_t item) {
    return ((const slv_form_faces *)made)->desc->res[item];
}

uint32_t slvi_form_faces_items(const void *made, uint32_t face, uint32_t out[SLV_FORM_ITEMS]) {
    (void)made;
    out[0] = face;
    return 1;
}

slv_result slvi_form_check(const slv_form_faces *faces, const slv_form_change *change) {
    uint32_t face = change->face;
    const slv_rect *rect = &change->rect;
    if (face >= faces->desc->nfaces)
        return slvi_fail(&faces->env, SLV_ERROR_ARGUMENT, "form: there is no face %u", face);
    if (!slvi_rect_is_within(*rect, faces->desc->res[face]))
        return slvi_fail(&faces->env, SLV_ERROR_ARGUMENT,
                         "form: face %u has no texels %u,%u to %u x %u from there", face, rect->x,
                         rect->y, rect->width, rect->height);
    return SLV_OK;
}

enum { KEY_BITS = 36 }; /* a slot's key; the turn is above */

/* Whether a key was new. */
static bool mark(slv_face_set *set, uint64_t key) {
    uint64_t at = key * UINT64_C(0x9e3779b97f4a7c15) >> 20, own = set->turn << KEY_BITS | key;
    for (;; at++) {
        uint64_t *slot = &set->slots[at & (set->nslots - 1)];
        if (*slot == own)
            return false;
        if (*slot >> KEY_BITS != set->turn) {
            *slot = own;
            set->nused++;
            return true;
        }
    }
}

static slv_result make_room(const slv_env *env, slv_face_set *set) {
    slv_face_set wider = *set;
    slv_result result;
    if (2 * (set->nused + 1) <= set->nslots)
        return SLV_OK;
    wider.nslots = set->nslots ? 4 * set->nslots : 256;
    wider.nused = 0;
    wider.turn = 1;
    if ((result = slvi_alloc(env, "faces around", wider.nslots, sizeof *wider.slots, &wider.slots)))
        return result;
    for (uint64_t i = 0; i < set->nslots; i++)
        if (set->slots[i] >> KEY_BITS == set->turn)
            mark(&wider, set->slots[i] & ((UINT64_C(1) << KEY_BITS) - 1));
    slvi_free(set->slots);
    *set = wider;
    return SLV_OK;
}

void slvi_face_set_clear(slv_face_set *set) {
    set->count = 0;
    set->nused = 0;
    set->t_corner = false;
    if (++set->turn >> (64 - KEY_BITS)) { /* the first turns come again */
        memset(set->slots, 0, set->nslots * sizeof *set->slots);
        set->turn = 1;
    }
}

slv_result slvi_form_sets_of(const slv_env *env, slv_form_room *room, slvi_form_sets **out) {
    slv_result result = SLV_OK;
    if (!room->memory)
        result = slvi_alloc(env, "faces around", 1, sizeof **out, &room->memory);
    if (result)
        return result;
    *out = room->memory;
    slvi_face_set_clear(&(*out)->around);
    slvi_face_set_clear(&(*out)->items);
    return SLV_OK;
}

static void free_set(slv_face_set *set) {
    slvi_free(set->faces);
    slvi_free(set->slots);
}

void slv_form_room_end(slv_form_room *room) {
    slvi_form_sets *sets = room->memory;
    if (sets) {
        free_set(&sets->around);
        free_set(&sets->items);
    }
    slvi_free(sets);
    room->memory = NULL;
}

slv_result slvi_face_set_add(const slv_env *env, slv_face_set *set, uint32_t face) {
    slv_result result;
    if (set->count == set->capacity) {
        uint32_t capacity = set->capacity ? 2 * set->capacity : 64;
        if ((result = slvi_grow(env, "faces around", capacity, sizeof *set->faces, &set->faces)))
            return result;
        set->capacity = capacity;
    }
    if ((result = make_room(env, set)))
        return result;
    if (mark(set, 2 * (uint64_t)face + 1))
        set->faces[set->count++] = face;
    return SLV_OK;
}

/* A ring is walked once, however many of its faces are in the set: a pole may have very many. */
static slv_result add_ring(const slv_env *env, const slv_adjacency *adjacency, int32_t face,
                           unsigned corner, slv_face_set *set) {
    slv_ring ring = slv_adjacency_ring(adjacency, face, corner, NULL);
    slv_result result = make_room(env, set);
    /* the corner that a ring begins with is of no other */
    uint64_t key = 4 * (uint64_t)ring.corners[0].face + ring.corners[0].corner;
    if (result || !mark(set, 2 * key + 2))
        return result;
    for (uint32_t i = 0; !result && i < ring.count; i++)
        result = slvi_face_set_add(env, set, (uint32_t)ring.corners[i].face);
    if (result || !slv_adjacency_is_t_corner(adjacency, face, corner))
        return result;
    const slv_corner *ends[2] = {&ring.corners[0], &ring.corners[ring.count - 1]};
    const unsigned edges[2] = {ends[0]->corner, (ends[1]->corner + 3u) % 4};
    set->t_corner = true;
    for (uint32_t i = 0; !result && i < 2; i++) {
        slv_neighbour to[2];
        if (slv_adjacency_neighbours(adjacency, ends[i]->face, edges[i], to) && to[0].scale < 0.75f)
            result = slvi_face_set_add(env, set, (uint32_t)to[0].face);
    }
    return result;
}

slv_result slvi_face_set_grow(const slv_env *env, const slv_adjacency *adjacency, uint32_t first,
                              slv_face_set *set) {
    uint32_t end = set->count;
    slv_result result = SLV_OK;
    for (uint32_t i = first; i < end; i++) {
        int32_t face = (int32_t)set->faces[i];
        for (unsigned e = 0; e < 4; e++) {
            slv_neighbour to[2];
            uint32_t count = slv_adjacency_neighbours(adjacency, face, e, to);
            if ((result = add_ring(env, adjacency, face, e, set)))
                return result;
            for (uint32_t k = 0; k < count; k++) {
                /* edges that meet run in opposite directions */
                unsigned middle = (to[k].edge + (to[k].t0 > 0.25f ? 1u : 0u)) % 4;
                if ((result = slvi_face_set_add(env, set, (uint32_t)to[k].face)) ||
                    (to[k].scale > 1.5f &&
                     (result = add_ring(env, adjacency, to[k].face, middle, set))))
                    return result;
            }
        }
    }
    return SLV_OK;
}

static int exponent(slv_res res, unsigned edge) {
    return edge & 1 ? res.v : res.u;
}

/* Whether a face takes nothing from faces that it does not meet. It does next to longer texels,
 * where the values on the edge are those that the neighbour shares with its own neighbours, and
 * where sub-faces meet whole quads. */
static bool is_simple(const slv_form_faces *faces, uint32_t face) {
    const slv_adjacency *adjacency = faces->adjacency;
    for (unsigned e = 0; e < 4; e++) {
        slv_neighbour to[2], onward[2];
        uint32_t count = slv_adjacency_neighbours(adjacency, (int32_t)face, e, to);
        if (slv_adjacency_is_t_corner(adjacency, (int32_t)face, e))
            return false;
        if (!count)
            continue;
        if (to[0].scale != 1 || exponent(faces->desc->res[to[0].face], to[0].edge) <
                                    exponent(faces->desc->res[face], e))
            return false;
        for (unsigned k = 0; k < 4; k++)
            if (slv_adjacency_neighbours(adjacency, to[0].face, k, onward) && onward[0].scale > 1)
                return false;
    }
    return true;
}

slv_result slvi_form_faces_around(const slv_form_faces *faces, const slv_form_change *changes,
                                  uint32_t count, bool samples, slv_face_set *out) {
    const slv_env *env = &faces->env;
    slv_result result = SLV_OK;
    for (uint32_t i = 0; !result && i < count; i++)
        if (!(result = slvi_form_check(faces, &changes[i])))
            result = slvi_face_set_add(env, out, changes[i].face);
    uint32_t changed = out->count;
    if (result || (result = slvi_face_set_grow(env, faces->adjacency, 0, out)))
        return result;
    uint32_t meeting = out->count, kept = meeting;
    if ((result = slvi_face_set_grow(env, faces->adjacency, changed, out)))
        return result;
    /* past such a vertex an edge-aligned sample lies on a line between two others */
    if (samples && out->t_corner &&
        (result = slvi_face_set_grow(env, faces->adjacency, meeting, out)))
        return result;
    for (uint32_t i = meeting; i < out->count; i++)
        if (!is_simple(faces, out->faces[i]))
            out->faces[kept++] = out->faces[i];
    out->count = kept;
    return SLV_OK;
}

slv_result slvi_form_faces_stale(const slv_form_faces *faces, const slv_form_change *changes,
                                 uint32_t count, bool samples, slv_form_room *room,
                                 slv_visit_item visit, void *user) {
    slvi_form_sets *sets;
    slv_result result = slvi_form_sets_of(&faces->env, room, &sets);
    if (!result)
        result = slvi_form_faces_around(faces, changes, count, samples, &sets->around);
    for (uint32_t i = 0; !result && i < sets->around.count; i++)
        result = visit(user, sets->around.faces[i]);
    return result;
}

slv_result slvi_form_faces_need(const slv_form_faces *faces, bool samples, slv_face_set *set,
                                slv_visit_item visit, void *user) {
    slv_result result = SLV_OK;
    uint32_t own = set->count, rings = 1;
    for (uint32_t i = 0; !result && i < own; i++) /* which may be enough to know */
        result = visit(user, set->faces[i]);
    for (uint32_t i = 0; i < own; i++)
        if (!is_simple(faces, set->faces[i]))
            rings = samples ? 3 : 2;
    for (uint32_t i = 0; !result && i < rings; i++)
        result = slvi_face_set_grow(&faces->env, faces->adjacency, 0, set);
    for (uint32_t i = own; !result && i < set->count; i++)
        result = visit(user, set->faces[i]);
    return result;
}
