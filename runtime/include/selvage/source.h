/* Where texels come from: one small interface for a store in memory, a .ptx file, a cache, and
 * whatever else has texels on faces. */
#ifndef SELVAGE_SOURCE_H
#define SELVAGE_SOURCE_H

#include <selvage/texture.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What lies beyond an edge without a neighbour. The values are those of the .ptx file. */
typedef enum slv_border_mode {
    SLV_BORDER_CLAMP = 0,
    SLV_BORDER_BLACK = 1,
    SLV_BORDER_PERIODIC = 2
} slv_border_mode;
/* What crosses an edge: values, or values of which the first two are a vector in the face's own
 * frame. */
typedef enum slv_edge_filter {
    SLV_EDGE_FILTER_NONE = 0,
    SLV_EDGE_FILTER_TANVEC = 1
} slv_edge_filter;

/* All of it holds for as long as the source is open. Zero means default, but for the numbers. */
typedef struct slv_source_desc {
    const char *name; /* for messages. Owned by the source */
    uint32_t nfaces;
    slv_type type;
    uint32_t nchannels;    /* 1.. */
    int32_t alpha_channel; /* SLV_NO_ALPHA or an index */
    bool triangles;        /* faces of three edges, square, u and v barycentric; else quads */
    slv_border_mode border_u, border_v;
    slv_edge_filter edge_filter;
} slv_source_desc;

/* A face. Resolution, adjacency and SLV_FACE_SUBFACE hold for as long as the source is open.
 * SLV_FACE_CONSTANT (all texels are the same, to the bit) and SLV_FACE_NEIGHBOURS_CONSTANT (so are
 * those of all faces around it) may come and go with a change of this face that is reported. They
 * make lookups quicker, and need never be set. */
typedef struct slv_source_face {
    slv_res res;
    uint8_t flags; /* SLV_FACE_... */
    slv_face_adjacency adjacency;
} slv_source_face;

/* Is told a face and a rectangle of its texels at full resolution. Anything but SLV_OK ends the
 * visit, which then returns it. */
typedef slv_result (*slv_visit_rect)(void *user, uint32_t face, slv_rect rect);

/* What a source does. All but `close` may be called from any number of threads at once, `face` and
 * `read` with any arguments: what does not exist is SLV_ERROR_ARGUMENT. A call that fails has told
 * why in one line of SLV_LOG_ERROR, by the environment that the source was made with. None may wait
 * for anything that is held by a thread that calls a cache in which the source is open. */
typedef struct slv_source_fns {
    slv_result (*describe)(void *user, slv_source_desc *out);
    /* Quick, from memory: lookups call it. Cannot fail for faces that exist. */
    slv_result (*face)(void *user, uint32_t face, slv_source_face *out);
    /* Reads a rectangle of a face at resolution `res`, no finer than the face's on either axis and
     * on triangles square: u and v are reduced apart, as filters want them. What is coarser than
     * the face is made of it by averaging; 1x1 is the mean of all. slv_source_reduce does it for
     * sources that have nothing better; then lookups are those in a .ptx file of the same texels,
     * bit for bit. `out` has room for width x height texels of the type, tightly packed, v-major,
     * row 0 at the lowest v. */
    slv_result (*read)(void *user, uint32_t face, slv_res res, slv_rect rect, void *out);
    /* Grows with every change. NULL: texels never change. */
    uint64_t (*version)(void *user);
    /* Visits all that was changed since the source had version `since`, and maybe more: every face
     * if too much was changed to know, or if `since` is 0. May be NULL if `version` is. */
    slv_result (*changed)(void *user, uint64_t since, slv_visit_rect visit, void *visitor);
    /* Releases what belongs to the source; nothing else is called after it. NULL: there is nothing
     * to release. */
    void (*close)(void *user);
    uint64_t reserved[4];
} slv_source_fns;

/* A source, copied as it is: who is handed one and says that it takes it closes it. `fns` outlives
 * it. */
typedef struct slv_source {
    const slv_source_fns *fns;
    void *user;
} slv_source;

/* These call a function of a source, or do without it where it is NULL. */
SLV_API uint64_t slv_source_version(const slv_source *source);
SLV_NODISCARD SLV_API slv_result slv_source_changed(const slv_source *source, uint64_t since,
                                                    slv_visit_rect visit, void *visitor);
/* Zeroes the source; one that is zero already is fine. */
SLV_API void slv_source_close(slv_source *source);

/* For those who write `read`: says in one line what is wrong with its arguments, if anything is;
 * else *face is filled. */
SLV_NODISCARD SLV_API slv_result slv_source_check(const slv_env *env, const slv_source *source,
                                                  uint32_t index, slv_res res, slv_rect rect,
                                                  slv_source_face *face);
/* For those who write `read`: a rectangle of a reduction out of what the source gives at full
 * resolution, which it asks for in rectangles of at most about 64 KiB (or a texel, or a row of
 * 4x4). The arithmetic is that of .ptx files: where alpha is, texels at full resolution and means
 * are as painted, and reductions premultiplied. The arguments have been checked. */
SLV_NODISCARD SLV_API slv_result slv_source_reduce(const slv_env *env, const slv_source *source,
                                                   uint32_t face, slv_res res, slv_rect rect,
                                                   void *out);

/* The colours of a source as light, in floats, for lookups that average light: what of `encoding`
 * is SLV_TEXTURE_SRGB is decoded, and reductions are made of that. SLV_TEXTURE_AUTO goes by the
 * source's type and edge filter; for a .ptx ask slv_ptx_get_encoding, which also knows what the
 * file says. Anything else is the source as it is. Takes `inner`, also if it fails, and zeroes it.
 */
SLV_NODISCARD SLV_API slv_result slv_source_decode(const slv_env *env, slv_source *inner,
                                                   slv_texture_encoding encoding, slv_source *out);

/* What crosses an edge in all that is derived from levels (border.h, form.h): with
 * SLV_EDGE_FILTER_TANVEC the first two channels, if there are two, are turned from the neighbour's
 * frame to the face's own. Before anything is made of them; integers, which have no sign, lose what
 * becomes negative where it is stored in their type. */
SLV_API void slv_levels_set_edge_filter(slv_levels *levels, slv_edge_filter filter);

/* The version of a store, which grows with every change; it begins as 1. */
SLV_API uint64_t slv_texture_version(const slv_texture *texture);
/* Visits what was changed of a store since it had version `since`, and maybe more: of a face, where
 * too much was changed to remember its rectangles, all texels; every face if `since` is 0. */
SLV_NODISCARD SLV_API slv_result slv_texture_changed(const slv_texture *texture, uint64_t since,
                                                     slv_visit_rect visit, void *visitor);

/* How a store is looked at. Zero means default. */
typedef struct slv_texture_source_params {
    const char *name; /* for messages; NULL means "texture" */
    slv_border_mode border_u, border_v;
    slv_edge_filter edge_filter;
    uint64_t reserved[4];
} slv_texture_source_params;

/* A store as a source; it, and `adjacency`, must outlive it. NULL for an adjacency means that no
 * face has neighbours. What slv_ptx_save would write of the store is what it reads. It follows the
 * store: each change of a face, or of a rectangle, is a new version. The store is still to be left
 * alone while it changes: no call may come from the cache or anybody else then. What a cache holds
 * already can be looked up meanwhile. */
SLV_NODISCARD SLV_API slv_result slv_texture_as_source(const slv_env *env,
                                                       const slv_texture *texture,
                                                       const slv_adjacency *adjacency,
                                                       const slv_texture_source_params *params,
                                                       slv_source *out);

#ifdef __cplusplus
}
#endif

#endif
