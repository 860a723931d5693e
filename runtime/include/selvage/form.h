/* Forms: what can be derived from a texture and its adjacency, without OpenGL. A form is a list of
 * items, faces or squares of edges, each with a chain of levels, and says which of them a change of
 * texels makes stale. The forms of the library are a table; an application may pass one of its own
 * wherever a form is taken. */
#ifndef SELVAGE_FORM_H
#define SELVAGE_FORM_H

#include <selvage/texture.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The most items that lookups in one face can need. */
#define SLV_FORM_ITEMS 4

/* A level of an item as `read` hands it out: width x height texels with all channels, v-major, of
 * which the border takes the outermost border_u columns and border_v rows on either side. */
typedef struct slv_form_extent {
    uint32_t width, height, border_u, border_v;
} slv_form_extent;

typedef struct slv_form_texels {
    const void *texels;
    slv_type type; /* the texture's own, or SLV_TYPE_FLOAT */
} slv_form_texels;

typedef slv_result (*slv_visit_item)(void *user, uint32_t item);

/* Texels of a face's level 0 that are others than before. */
typedef struct slv_form_change {
    uint32_t face;
    slv_rect rect;
} slv_form_change;

/* Memory that `stale` and `needs` work in, so that calls one after the other allocate nothing.
 * Begins as zeroes, and goes from form to form; of one thread at a time. */
typedef struct slv_form_room {
    void *memory;
} slv_form_room;
SLV_API void slv_form_room_end(slv_form_room *room);

/* The functions of a form. What `create` makes is immutable but for `refresh`, so that the
 * others may be called by many threads at once; it refers to the levels and the adjacency, which
 * must outlive it. */
typedef struct slv_form {
    const char *name;  /* one word */
    const char *title; /* what is stored, for a reader */
    const char *item;  /* what messages call an item: "a face" */
    bool borders;      /* levels have the border that `create` is given, cut to the level's size */
    bool samples;      /* samples that lie on the edges: one more along each axis than texels */
    bool computed;     /* `read` needs the memory for a level's floats */

    slv_result (*create)(const slv_env *env, const slv_levels *levels,
                         const slv_adjacency *adjacency, uint32_t border, void **out);
    void (*destroy)(void *made); /* NULL is fine */
    uint32_t (*count)(const void *made);
    slv_res (*res)(const void *made, uint32_t item);
    /* The items that lookups in a face need; returns how many. */
    uint32_t (*items)(const void *made, uint32_t face, uint32_t out[SLV_FORM_ITEMS]);
    /* A level of an item, of the extent that slv_form_level_extent says. Owned by the form, or in
     * `scratch`, which holds that many texels as floats where `computed` asks for it. */
    slv_result (*read)(const void *made, uint32_t item, uint32_t level, float *scratch,
                       slv_form_texels *out);
    /* The same of an item whose own face's texels are as they were, where of such an item nothing
     * but the border, or the samples on edges, can be another; what is in between may be anything.
     * Items are then faces, and within a border lie the texels of their levels. NULL: all of an
     * item can be another. */
    slv_result (*read_rim)(const void *made, uint32_t item, uint32_t level, float *scratch,
                           slv_form_texels *out);
    /* Whether all that lies around an item's own texels are copies of others' texels: then none of
     * its values leaves a range that these are in. May say no where it is so. NULL: not known. */
    bool (*copies)(const void *made, uint32_t item);
    /* Whether any value of an item leaves the range of the texture's type; NULL if none can.
     * `scratch` is as for `read`, and holds at least a texel of border around level 0. */
    slv_result (*leaves_range)(const void *made, uint32_t item, float *scratch, bool *out);
    /* Calls `visit` once for each item of which any level may be another after the changes, of
     * which a face may have several. Stops at what `visit` returns other than SLV_OK. */
    slv_result (*stale)(const void *made, const slv_form_change *changes, uint32_t count,
                        slv_form_room *room, slv_visit_item visit, void *user);
    /* Makes `count` items anew from the levels, which were changed (slv_levels_update): all that
     * `stale` visits for the changes, once each; `res` of them may be another afterwards, where
     * faces have got other resolutions. Nobody else may use the form meanwhile. NULL if nothing is
     * kept of items. */
    slv_result (*refresh)(void *made, const uint32_t *items, uint32_t count);
    /* Visits all faces of whose texels an item can have something, and maybe others around them:
     * where they have one value, all levels of the item have it. NULL: that is not known. Stops at
     * what `visit` returns other than SLV_OK. */
    slv_result (*needs)(const void *made, uint32_t item, slv_form_room *room, slv_visit_item visit,
                        void *user);
    uint64_t reserved[4];
} slv_form;

/* The extent of a level of an item; `border` is what `create` was given. */
SLV_API slv_form_extent slv_form_level_extent(const slv_form *form, slv_res res, uint32_t level,
                                              uint32_t border);
/* The same of a form that was made of even levels (slv_levels_create_even), for which borders and
 * edge-aligned are ready. */
SLV_API slv_form_extent slv_form_even_extent(const slv_form *form, slv_res res, uint32_t level,
                                             uint32_t border);

/* The forms of the library. slv_form_at is NULL past the last, slv_form_find if there is none of
 * that name. */
SLV_API uint32_t slv_form_count(void);
SLV_API const slv_form *slv_form_at(uint32_t index);
SLV_API const slv_form *slv_form_find(const char *name);

/* The levels of faces as they are. */
SLV_API const slv_form *slv_form_bare(void);

#ifdef __cplusplus
}
#endif

#endif
