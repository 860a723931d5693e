/* What forms whose items are faces share: what is made of them, and which faces lie around others.
 */
#ifndef SLV_FORM_FACES_H
#define SLV_FORM_FACES_H

#include <selvage/form.h>

/* What a form over faces makes, or the start of it. */
typedef struct slv_form_faces {
    slv_env env;
    const slv_texture_desc *desc;
    const slv_levels *levels;
    const slv_adjacency *adjacency;
    uint32_t border;
} slv_form_faces;

/* Refuses an adjacency of another mesh. */
slv_result slvi_form_faces_begin(const slv_env *env, const slv_levels *levels,
                                 const slv_adjacency *adjacency, uint32_t border,
                                 slv_form_faces *out);
/* For slv_form: forms that make nothing else. */
slv_result slvi_form_faces_create(const slv_env *env, const slv_levels *levels,
                                  const slv_adjacency *adjacency, uint32_t border, void **out);
/* For slv_form, where `made` begins with slv_form_faces and was allocated. */
void slvi_form_faces_destroy(void *made);
uint32_t slvi_form_faces_count(const void *made);
slv_res slvi_form_faces_res(const void *made, uint32_t item);
uint32_t slvi_form_faces_items(const void *made, uint32_t face, uint32_t out[SLV_FORM_ITEMS]);

/* slv_form_level_extent, of a form that was made of even levels or not. */
slv_form_extent slvi_form_extent(const slv_form *form, slv_res res, uint32_t level, uint32_t border,
                                 bool even);

/* A set of faces that grows outward. Begins as zeroes. */
typedef struct slv_face_set {
    uint32_t *faces;
    uint32_t count, capacity;
    uint64_t *slots; /* faces and rings that are in, hashed, each with the turn it came in at: what
                        came in at an earlier one is as good as free */
    uint64_t nslots, nused, turn;
    bool t_corner; /* a vertex in the middle of a whole quad's edge was met */
} slv_face_set;

/* What is in a form's room: sets that are used again. */
typedef struct slvi_form_sets {
    slv_face_set around, items;
} slvi_form_sets;
/* Both are empty afterwards. */
slv_result slvi_form_sets_of(const slv_env *env, slv_form_room *room, slvi_form_sets **out);

void slvi_face_set_clear(slv_face_set *set);
slv_result slvi_face_set_add(const slv_env *env, slv_face_set *set, uint32_t face);
/* Adds every face that meets one from `first` on, at an edge or a vertex; the vertices in the
 * middle of a whole quad's edges are the quad's too. */
slv_result slvi_face_set_grow(const slv_env *env, const slv_adjacency *adjacency, uint32_t first,
                              slv_face_set *set);

/* The faces whose level 0, with a texel of border or more, depends on the texels of those changed,
 * or of which any level does; into an empty set. `samples`: as edge-aligned samples. Refuses a
 * rectangle that does not lie in its face. */
slv_result slvi_form_faces_around(const slv_form_faces *faces, const slv_form_change *changes,
                                  uint32_t count, bool samples, slv_face_set *out);
/* The same, visited. */
slv_result slvi_form_faces_stale(const slv_form_faces *faces, const slv_form_change *changes,
                                 uint32_t count, bool samples, slv_form_room *room,
                                 slv_visit_item visit, void *user);
/* The other way round, for slv_form's `needs`: the faces whose texels a face's item depends on, and
 * some more. Starts with those that are in `set`. */
slv_result slvi_form_faces_need(const slv_form_faces *faces, bool samples, slv_face_set *set,
                                slv_visit_item visit, void *user);
slv_result slvi_form_check(const slv_form_faces *faces, const slv_form_change *change);

#endif
