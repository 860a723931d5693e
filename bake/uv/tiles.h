/* A UV image, or the tiles of a set, in memory as their files have them. */
#ifndef SLV_BAKE_UV_TILES_H
#define SLV_BAKE_UV_TILES_H

#include <selvage/bake.h>

/* Tiles lie in cells of one unit of texture coordinates. */
enum { UV_CELLS_U = 10, UV_CELLS_V = 900, UV_FIRST_TILE = 1001 };

typedef struct uv_tile {
    void *pixels; /* row 0 at the top; NULL: there is no file */
    slv_type type;
    uint32_t width, height;
    bool straight; /* colours are not multiplied by alpha */
    /* What the integers and halves of a channel stand for, as light; NULL of floats, which have
     * been decoded. */
    float *colors, *alphas;
} uv_tile;

typedef struct uv_set {
    uint32_t nchannels;
    int32_t alpha;
    slv_type type; /* that holds all of them */
    slv_texture_encoding encoding;
    bool udim;
    slv_bake_wrap wrap; /* of one image; never AUTO */
    bool ends[2];       /* a repeated image does not go on over these ends, which nothing crosses */
    uint32_t ntiles;
    uv_tile *tiles;
    slv_bake_tile *list; /* the same tiles, for the caller */
    int32_t *cells;      /* of a set: which tile lies in a cell, or -1 */
} uv_set;

/* How many faces come into each cell, UV_CELLS_V rows of UV_CELLS_U, for slvi_free. */
slv_result slvi_uv_count_cells(const slv_env *env, const float *corners, uint32_t nfaces,
                               int32_t **out);
/* The name of the tile of a cell. */
slv_result slvi_uv_tile_name(const slv_env *env, const char *path, int32_t cell, char *out,
                             size_t room);

/* Loads what the texture coordinates need. `corners` as slv_mesh_face_texcoords has them, the NaN
 * of a face that has none in the first. */
slv_result slvi_uv_set_load(const slv_env *env, const char *path, const slv_bake_uv *params,
                            const float *corners, uint32_t nfaces, uv_set *out);
void slvi_uv_set_free(uv_set *set);

/* The tile of a cell, in whose frame (0..1) it then is: `u`, `v` are its lower left corner. NULL:
 * there is none. */
static inline const uv_tile *slvi_uv_set_at(const uv_set *set, int32_t u, int32_t v) {
    if (set->udim) {
        if (u < 0 || v < 0 || u >= UV_CELLS_U || v >= UV_CELLS_V)
            return NULL;
        int32_t index = set->cells[v * UV_CELLS_U + u];
        return index >= 0 && set->tiles[index].pixels ? &set->tiles[index] : NULL;
    }
    return set->wrap == SLV_BAKE_WRAP_REPEAT || (u == 0 && v == 0) ? set->tiles : NULL;
}

#endif
