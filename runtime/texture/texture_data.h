/* What the files of this folder share: the inside of a chain of levels. */
#ifndef SLV_TEXTURE_STORE_H
#define SLV_TEXTURE_STORE_H

#include "adjacency/edge.h"
#include "base/parallel.h"

#include "texture/changes.h"

#include <selvage/source.h>

/* How much room a face has for levels of its own, each more than the one before: for those below
 * level 0; for a run of equal texels that all levels of a constant face share; for all levels. */
typedef enum slvi_level_room {
    SLVI_ROOM_NONE,
    SLVI_ROOM_REST,
    SLVI_ROOM_RUN,
    SLVI_ROOM_ALL
} slvi_level_room;

/* Of a face: all its levels are the one texel at the place of each; its texels stay as they are
 * where others are made to agree with their neighbours. */
enum { SLVI_LEVELS_SINGLE = 1, SLVI_LEVELS_STAYS = 2 };

/* Face f has its levels from first[f] on; at[] says where each is, in `texels` or, of level
 * 0, in the texture. */
struct slv_levels {
    slv_env env; /* its log is serialised: borders are built by many threads at once */
    slv_parallel_log *log;
    slv_texture_desc desc;
    slv_res *res;
    size_t texel_size;
    size_t *first;
    unsigned char **at;
    size_t nat;
    unsigned char *texels;
    uint64_t nbytes; /* of `texels` */
    bool borrowed;   /* level 0 of faces that are not constant is the texture's */
    bool vectors;    /* the first two channels are a vector in each face's own frame */
    bool even;       /* see slv_res_even_level */
    bool fixed;      /* filled from outside (levels.h): without `own`, never updated */
    uint8_t *kind;   /* of each face: SLVI_LEVELS_...; NULL: nothing special */
    uint8_t *room;   /* of each face: slvi_level_room */
    uint8_t *most;   /* levels that at[] has places for */
    /* where that is: in `texels`, or of its own since an update */
    unsigned char **own;
};

/* Checks everything that a description can get wrong; *bytes is the size of all its texels. */
slv_result slvi_texture_check_desc(const slv_env *env, const slv_texture_desc *desc,
                                   uint64_t *bytes);

/* Whether two textures have the same faces, type and channels. */
bool slvi_texture_desc_same(const slv_texture_desc *a, const slv_texture_desc *b);

/* One piece of memory for all faces of a new texture that are not constant in another of the same
 * resolutions. Each is then to be set before anybody looks. */
slv_result slvi_texture_reserve(slv_texture *texture, const slv_texture *like);

/* slv_texture_changed, and whether the face became constant, ceased to be it, or may have. */
typedef slv_result (*slvi_visit_change)(void *user, uint32_t face, slv_rect rect, bool constancy);
slv_result slvi_texture_visit_changes(const slv_texture *texture, uint64_t since,
                                      slvi_visit_change visit, void *user);

static inline size_t slv_res_texels(slv_res res) {
    return (size_t)1 << (res.u + res.v);
}

/* The resolution of a level, even ones or not. */
static inline slv_res slvi_res_level(slv_res res, uint32_t level, bool even) {
    return even ? slv_res_even_level(res, level) : slv_res_level(res, level);
}

static inline slv_res slvi_level_res(const slv_levels *levels, uint32_t face, uint32_t level) {
    return slvi_res_level(levels->res[face], level, levels->even);
}

/* Whether a rectangle has texels, all of which are among those of a resolution. */
static inline bool slvi_rect_is_within(slv_rect rect, slv_res res) {
    uint32_t width = 1u << res.u, height = 1u << res.v;
    return rect.width && rect.height && rect.x < width && rect.y < height &&
           rect.width <= width - rect.x && rect.height <= height - rect.y;
}

/* log2 of how many texels lie along an edge, and of how many rows of them there are. */
static inline int slvi_res_along(slv_res res, unsigned edge) {
    return slvi_edge_along(edge, res.u, res.v);
}

static inline int slvi_res_across(slv_res res, unsigned edge) {
    return slvi_edge_across(edge, res.u, res.v);
}

/* slvi_edge_texel and slvi_corner_texel of a resolution. */
static inline void slvi_res_edge_texel(slv_res res, unsigned edge, int32_t j, int32_t depth,
                                       int32_t *x, int32_t *y) {
    slvi_edge_texel(1 << res.u, 1 << res.v, edge, j, depth, x, y);
}

static inline void slvi_res_corner_texel(slv_res res, unsigned corner, int32_t *x, int32_t *y) {
    slvi_corner_texel(1 << res.u, 1 << res.v, corner, x, y);
}

#endif
