/* Faces in array textures: size classes, layers, batches, and the two kinds of store that the
 * strategies share. */
#ifndef SLV_GL_STORE_H
#define SLV_GL_STORE_H

#include "gl/context/api.h"

#include "base/memory.h"
#include "base/progress.h"
#include "gl/store/compress.h"

#include <selvage/gl_texture.h>
#include <selvage/htex.h>

#define SLV_GL_LEVELS (SLV_MAX_LOG2_RES + 1)

/* How texels are laid out for a sampler: `nsource` channels from `first`, padded to `ncomponents`.
 */
typedef struct slv_gl_format {
    slv_type type;
    uint32_t first, nsource, ncomponents;
    bool coverage; /* the last component is 1 in every texel */
    GLenum internal, external, data;
    GLint swizzle[4];
    size_t texel_bytes; /* before compression */
    slv_gl_block block;
} slv_gl_format;

typedef struct slv_gl_rect {
    uint32_t x, y;          /* of the bordered level's first texel in the layer */
    uint32_t bu, bv;        /* border */
    uint32_t width, height; /* inside, without border; of edge-aligned levels the intervals between
                               samples, of which there is one more */
} slv_gl_rect;

typedef struct slv_gl_pool {
    GLuint texture, coverage;
    slv_res res;
    bool wide;
    uint32_t nlayers, width, height, nlevels;
    const uint32_t *faces;            /* of each layer; half-edge stores: the edges */
    slv_gl_rect rects[SLV_GL_LEVELS]; /* packed pools only */
} slv_gl_pool;

/* Bare: plain texels with OpenGL's own levels. Bordered and edge-aligned are packed, all levels
 * side by side in one layer: each with its border, or as samples that lie on the edges. Half-edge
 * stores have squares of edges for layers, with OpenGL's levels. */
typedef enum slv_gl_layout {
    SLV_GL_BARE = 0,
    SLV_GL_BORDERED,
    SLV_GL_EDGE_ALIGNED,
    SLV_GL_HALF_EDGE,
    SLV_GL_LAYOUT_COUNT
} slv_gl_layout;

static inline bool slv_gl_is_packed(slv_gl_layout layout) {
    return layout == SLV_GL_BORDERED || layout == SLV_GL_EDGE_ALIGNED;
}

/* A store: every face, or edge, in a layer of one pool. */
typedef struct slv_gl_store {
    slv_gl_layout layout;
    slv_gl_format format, wide_format;
    slv_gl_pool *pools;
    uint32_t npools, nwide, nclipped;
    slv_gl_block_error error;
    uint32_t *order; /* faces, or edges, in the order of pools and layers */
    uint32_t *pool_of, *layer_of;
    GLuint table;                   /* per face: pool | layer << 16, res */
    GLuint squares;                 /* half-edge only; per face: the squares that it looks up */
    GLuint corners;                 /* and the values that they share where they meet */
    GLuint rects;                   /* packed only */
    uint64_t bytes, coverage_bytes; /* coverage apart, for not every strategy binds it */
} slv_gl_store;

typedef struct slv_gl_batch_range {
    uint32_t first, count; /* in the batch list's faces */
    uint32_t variant, npools;
    uint32_t pools[16]; /* number 0 is the batch's own */
} slv_gl_batch_range;

typedef struct slv_gl_batches {
    slv_gl_batch_range *ranges;
    uint32_t count, capacity;
    uint32_t *faces;
} slv_gl_batches;

typedef struct slv_gl_source {
    const slv_env *env;
    slv_gl *gl;
    const slv_levels *levels;
    const slv_adjacency *adjacency;
    slv_gl_texture_params params; /* defaults filled in */
    slvi_steps *steps;            /* as many as there are faces for each store */
} slv_gl_source;

/* Variants: the number of pools a shader can reach, 1 << (variant >> 1), and whether a link to two
 * sub-faces occurs. */
static inline uint32_t slv_gl_variant_pools(uint32_t variant) {
    return 1u << (variant >> 1);
}

slv_gl_format slvi_gl_format_for(slv_type type, uint32_t first, uint32_t nchannels, bool coverage);
/* One row-major block of `count` texels, from all channels of the store's type to the format. */
void slvi_gl_convert(const slv_gl_format *format, const void *texels, uint32_t nchannels,
                     size_t count, bool constant, void *out);
/* The same from floats of `nchannels`. */
void slvi_gl_convert_float(const slv_gl_format *format, const float *texels, uint32_t nchannels,
                           size_t count, void *out);

/* Lays one size class's levels out in a layer; fills rects, width and height. */
void slvi_gl_pack_levels(slv_res res, slv_gl_layout layout, uint32_t border, bool blocks,
                         slv_gl_pool *pool);
/* Makes a format of 8-bit texels one of blocks. */
slv_result slvi_gl_format_compress(const slv_gl *gl, const slv_env *env, slv_gl_format *format);

/* What is made from a texture for some layouts, NULL for the others, while they are uploaded. */
typedef struct slv_gl_forms {
    slv_edge_aligned *aligned;
    slv_htex *htex;
} slv_gl_forms;

/* The batches are those of lookups that stay in the own layer, and of half-edge squares. */
slv_result slvi_gl_store_build(const slv_gl_source *source, slv_gl_layout layout, slv_gl_store *out,
                               slv_gl_batches *batches);
void slvi_gl_store_free(const slv_gl *gl, slv_gl_store *store);

/* Fills and uploads one level of every layer (packed: the whole layer), as many layers at a time as
 * the staging holds; `*staging` grows as needed and is released with slvi_free. `env` logs one at a
 * time. */
slv_result slvi_gl_upload_level(const slv_gl_source *source, const slv_env *env,
                                slv_gl_store *store, const slv_gl_forms *forms,
                                const slv_gl_pool *pool, uint32_t level, unsigned char **staging,
                                uint64_t *capacity);

/* One batch a pool. */
slv_result slvi_gl_batches_by_pool(const slv_gl_source *source, const slv_gl_store *store,
                                   slv_gl_batches *out);
/* Batches whose pools hold all squares that their faces look up, and the table of these. `order`
 * has the faces so that those which meet are close together. */
slv_result slvi_gl_batches_of_squares(const slv_gl_source *source, slv_gl_store *store,
                                      const slv_htex *htex, const uint32_t *order,
                                      slv_gl_batches *out);
/* A batch looks up a face's squares, which can lie in four pools, however few a host asks for. */
static inline uint32_t slv_gl_square_pools(const slv_gl_texture_params *params) {
    return params->batch_pools < 4 ? 4 : params->batch_pools;
}
/* Batches whose pools hold the neighbours too, the link table that goes with them, and the corner
 * values. */
slv_result slvi_gl_batches_with_neighbours(const slv_gl_source *source, const slv_gl_store *store,
                                           slv_gl_batches *out, GLuint *links, GLuint *corners,
                                           uint64_t *bytes);
void slvi_gl_batches_free(slv_gl_batches *batches);

/* Shaders multiply what they return by this where the texture was divided by it. */
#define SLV_GL_SCALE 16777216.0f
/* A copy of a float texture with values so large that sums of a few would overflow, divided by
 * SLV_GL_SCALE; NULL for any other. */
slv_result slvi_gl_scale_down(const slv_env *env, const slv_texture *texture, slv_texture **out);

slv_result slvi_gl_buffer(const slv_gl *gl, const slv_env *env, const char *what, const void *data,
                          uint64_t bytes, GLuint *out);
/* A buffer that shaders read: refused above the driver's limit for storage blocks. */
slv_result slvi_gl_table(const slv_gl_source *source, const char *what, const void *data,
                         uint64_t bytes, GLuint *out);

struct slv_gl_texture {
    slv_gl *gl;
    uint64_t serial;
    slv_gl_texture_params params;
    uint32_t nfaces;
    slv_res *res; /* of each face */
    uint64_t texel_bytes;
    bool scaled; /* see slvi_gl_scale_down */
    slv_gl_store stores[SLV_GL_LAYOUT_COUNT];
    slv_gl_batches own[SLV_GL_LAYOUT_COUNT]; /* clamp and discard; borders; edge-aligned; htex */
    slv_gl_batches reach;                    /* traverse */
    GLuint links, corners;
    uint64_t reach_bytes;
    GLuint samplers[4]; /* clamped, zero border, packed, squares */
    char *glsl[SLV_STRATEGY_COUNT][SLV_GL_MAX_VARIANTS];
    char *lookups[SLV_STRATEGY_COUNT]; /* the text of a strategy without a variant's definitions */
    GLuint lookup_programs[SLV_STRATEGY_COUNT][SLV_GL_MAX_VARIANTS];
};

const slv_gl_batches *slvi_gl_texture_batches(const slv_gl_texture *texture, slv_strategy strategy);

#endif
