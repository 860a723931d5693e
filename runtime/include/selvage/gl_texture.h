/* Per-face textures on the GPU, for the strategies by which a lookup crosses a seam
 * (gl_strategy.h).
 *
 * Each face is a layer of an array texture of its size class (a pool), or a cell of a page that it
 * shares with others (slv_gl_layout); a class with more faces than one array holds has several.
 * Draws go in batches: a batch is a set of faces whose pools, and for `traverse` and `hybrid` their
 * neighbours' pools, fit the texture units that it binds. A host draws every batch with a program
 * whose fragment shader contains the text of slv_gl_texture_glsl:
 *
 *     for (uint32_t i = 0; i < slv_gl_texture_batch_count(texture, strategy); i++) {
 *         slv_gl_batch batch = slv_gl_texture_batch(texture, strategy, i);
 *         glUseProgram(programs[batch.variant]);
 *         slv_gl_texture_bind(texture, strategy, i);
 *         draw the triangles of batch.faces
 *     }
 *
 * with the face id as a flat input and (u,v) in 0..1 as a smooth one, and calls slv_sample(face,
 * uv) or slv_sample_grad(face, uv, dx, dy); see shaders/lookup/interface.glsl. */
#ifndef SELVAGE_GL_TEXTURE_H
#define SELVAGE_GL_TEXTURE_H

#include <selvage/gl_context.h>
#include <selvage/gl_strategy.h>
#include <selvage/source.h>

#ifdef __cplusplus
extern "C" {
#endif

/* How shaders leave out the work that a fragment does not need. A GPU branches. Software drivers
 * run both sides of a branch for all fragments of a vector, and only a loop ends when none of them
 * needs another round. Values are the same. */
typedef enum slv_gl_branching {
    SLV_GL_BRANCHING_AUTO = 0, /* by the driver */
    SLV_GL_BRANCHING_REAL,
    SLV_GL_BRANCHING_VECTORS /* as REAL where the driver lacks GL_ARB_shader_ballot */
} slv_gl_branching;

SLV_API const char *slv_gl_branching_name(slv_gl_branching branching); /* auto, real, vectors */

/* Blocks of 4 x 4 texels that the GPU decodes, for 8-bit textures: one channel as BC4 (BC5 where a
 * strategy stores coverage), two as BC5 (BC1 where it does), three as BC1, four as BC3.
 *
 * Borders are made to agree after compression: they are at least four texels wide, levels lie on
 * whole blocks, and a block gives the same texels however the faces are turned, so that between
 * texels of one size a border decodes to exactly what the neighbour decodes to. Levels of fewer
 * than four texels, other sizes and extraordinary vertices agree as far as the error of compression
 * goes. A border that leaves 0..1 is clipped, not widened. `traverse` and its kin read the
 * neighbour itself and need none of this; the two sides of an `edge-aligned` seam are compressed
 * apart. */
typedef enum slv_gl_compression {
    SLV_GL_COMPRESSION_NONE = 0,
    SLV_GL_COMPRESSION_BLOCKS
} slv_gl_compression;

SLV_API const char *slv_gl_compression_name(slv_gl_compression compression); /* none, blocks */

/* Who takes the taps of a long anisotropic footprint: shaders one by one, or the sampler. Samplers
 * place them as they like, which both sides of a seam do not know, and software ones do not go by
 * the derivatives that they are given. With an H200's, seams of oblong faces jumped by up to 8/255,
 * and faces much smaller than a footprint could be missed by all taps, and be black with strategies
 * of coverage; in return traverse, hybrid and borders took 0.74 to 0.84 of the time at 16x
 * (docs/measuring.md). */
typedef enum slv_gl_taps {
    SLV_GL_TAPS_AUTO = 0, /* shaders */
    SLV_GL_TAPS_SAMPLER,
    SLV_GL_TAPS_SHADER
} slv_gl_taps;

SLV_API const char *slv_gl_taps_name(slv_gl_taps taps); /* auto, sampler, shader */

/* How many faces share a layer, where lookups never leave a level of their own face (borders,
 * edge-aligned): one, in an array for each size; or as many as fit on a page, whatever their size
 * (Purnomo 2004, 3.3 and 3.4), so that a mesh is a draw or a few. Faces that would leave much of a
 * page empty have a layer each then, too, as have those that get another size while they are drawn.
 * Texels are the same. */
typedef enum slv_gl_layout {
    SLV_GL_LAYOUT_AUTO = 0, /* pages */
    SLV_GL_LAYOUT_SEPARATE,
    SLV_GL_LAYOUT_PAGES
} slv_gl_layout;

SLV_API const char *slv_gl_layout_name(slv_gl_layout layout); /* auto, separate, pages */

/* How draws find array textures: bound to texture units, one batch at a time; or by handles
 * (GL_ARB_bindless_texture, and GL_ARB_shader_draw_parameters) that stand in a table, so that no
 * units are taken and one multi-draw shows many batches (slv_gl_texture_run). What is drawn is the
 * same. Handles are resident in the contexts where the texture is bound, until an update after
 * which arrays are others, or until it is destroyed. */
typedef enum slv_gl_binding {
    SLV_GL_BINDING_AUTO = 0, /* handles where the driver has them, unless it is one in software */
    SLV_GL_BINDING_UNITS,
    SLV_GL_BINDING_HANDLES /* SLV_ERROR_UNSUPPORTED where it has not */
} slv_gl_binding;

SLV_API const char *slv_gl_binding_name(slv_gl_binding binding); /* auto, units, handles */

/* Zero means default. */
typedef struct slv_gl_texture_params {
    const slv_strategy *const *strategies; /* those that will be drawn, which must outlive the
                                              texture */
    uint32_t nstrategies;                  /* 0 means slv_strategy_default alone: traverse, which
                                              hides seams and stores texels once. htex and borders
                                              take several times its memory */
    uint32_t first_channel;                /* of the texture, shown as red */
    uint32_t nchannels;   /* 1 (shown as grey) to 4; 0 means as many as there are, up to 4 */
    uint32_t anisotropy;  /* 1 to 16, cut to what the driver has; 0 means 1: trilinear */
    uint32_t border;      /* texels of border per level, cut to the level's size; 0 means what the
                             anisotropy needs */
    uint32_t batch_pools; /* most array textures that a batch binds, rounded down to a power of two;
                             0 means 16, or what the driver has units for; below 9 a face can have
                             neighbours that do not fit. htex binds 4 at least */
    uint32_t pool_layers; /* most layers, or pages, in one array; 0 means what the driver has */
    slv_gl_branching branching;
    slv_gl_compression compression; /* of textures other than 8-bit: SLV_ERROR_UNSUPPORTED */
    slv_texture_encoding encoding; /* of the colours; default: as slv_texture_get_encoding has it */
    bool live; /* slv_gl_texture_update (gl_live.h) will be called: the texture and the adjacency
                  outlive this one, which keeps levels and forms in memory, and a decoded copy of
                  encoded colours */
    slv_progress progress; /* faces, once for each form in which they are stored; on this thread */
    slv_gl_taps taps;
    slv_gl_layout layout;
    /* For a host that has bindings of its own, or several textures in one shader: */
    uint32_t first_unit;    /* texture unit; 0 means SLV_GL_FIRST_UNIT */
    uint32_t first_storage; /* storage binding; 0 means SLV_GL_FIRST_STORAGE */
    const char *prefix; /* of all names in the text, in place of slv_ (and, in capitals, of SLV_): a
                           letter and up to 31 letters, digits and _. With one of its own a text has
                           no #extension line (slv_gl_texture_extensions). NULL means slv_ */
    bool explicit_only; /* the text is for stages without derivatives, vertex and compute shaders:
                           slv_sample is left out */
    bool grey_alpha; /* of two channels the first is shown as grey, and the second is alpha: so they
                        are also where nchannels and first_channel are 0 and the texture says so */
    /* What lies beyond an edge without a neighbour, as lookups on the CPU have it: nothing that
       counts, or with SLV_BORDER_BLACK zero. In lookups within a face SLV_BORDER_PERIODIC is the
       same as SLV_BORDER_CLAMP. */
    slv_border_mode border_u, border_v;
    /* With SLV_EDGE_FILTER_TANVEC the first two channels are a vector in each face's own frame, and
       what crosses an edge is turned, as lookups on the CPU do it. Integers become half (8 bit) or
       float then, which have a sign. traverse and hybrid need both channels shown. */
    slv_edge_filter edge_filter;
    /* Levels whose texels are as long in u as in v, as far as the face has texels so short: the
     * longer side of an oblong face is halved first, until the face is square, and lookups choose
     * levels by the length of their footprint in (u,v). Both sides of an edge then average over the
     * same, whatever their shapes. Footprints that are longer in one of u and v than in the other
     * are blurred along the other one, as far as there are no taps (anisotropy) for it; taps are
     * made by shaders and stay within the face, on its edges as a single one, so that borders need
     * no more than one texel; oblong faces take several lookups with traverse and hybrid. Textures
     * of which all faces are squares of one size, none or all sub-faces, are looked up as ever,
     * unless they are live or resident, and so are all textures with the other strategies.
     * (SLV_PTX_REDUCTIONS_KEY of ptx.h says what a file asks for.) */
    bool even_levels;
    /* Faces of one value get room for all their texels, too, in place of one: with `live` painting
     * on them then moves nothing, and needs no batches and shaders but those that there are. */
    bool whole;
    slv_gl_binding binding;
    /* Texels go to the driver in pixel buffers that it may copy later, while the thread goes on,
     * and not from memory. On software drivers that is slower (docs/measuring.md); on hardware it
     * has not been tried. */
    bool pixel_buffers;
    uint64_t reserved[2];
} slv_gl_texture_params;

/* Programs are needed for each variant that occurs; see slv_gl_batch. */
#define SLV_GL_MAX_VARIANTS 10

/* The first texture unit and shader storage binding that a bound texture uses: batch_pools units,
 * twice as many where alpha is a channel of the texels, and 4 bindings. */
#define SLV_GL_FIRST_UNIT 0
#define SLV_GL_FIRST_STORAGE 4

typedef struct slv_gl_batch {
    const uint32_t *faces; /* owned by the texture */
    uint32_t nfaces;
    uint32_t variant; /* which shader text it needs, below SLV_GL_MAX_VARIANTS */
} slv_gl_batch;

/* Wherever a strategy is taken, NULL means the first that the texture was made for. */
typedef struct slv_gl_texture slv_gl_texture;

/* Uploads. Types keep their range: 8 and 16 bit as normalised integers, half and float as such; a
 * face whose border leaves the range goes to a pool of half (8 bit) or float (16 bit, half).
 *
 * Colours of SLV_TEXTURE_SRGB are decoded first, so that reductions, borders and lookups are of
 * light, and lookups return it. 8 bits stay 8 bits, in the GPU's sRGB formats, also of
 * blocks; but one or two channels become half where the driver lacks GL_EXT_texture_sRGB_R8 and its
 * like for two, and their blocks hold light in 8 bits. 16 bits and others become float.
 *
 * Neither argument is needed afterwards, but for `live`. `adjacency` must have as many faces as
 * `texture`. Leaves GL state as it was. */
SLV_NODISCARD SLV_API slv_result slv_gl_texture_create(slv_gl *gl, const slv_env *env,
                                                       const slv_texture *texture,
                                                       const slv_adjacency *adjacency,
                                                       const slv_gl_texture_params *params,
                                                       slv_gl_texture **out);
SLV_API void slv_gl_texture_destroy(slv_gl_texture *texture);

typedef struct slv_gl_texture_stats {
    uint64_t texel_bytes; /* level 0 of every face: the shown channels in the texture's own type */
    uint64_t gpu_bytes;   /* all arrays and tables that the strategy binds */
    uint32_t pools, batches;
    uint32_t widened;            /* faces whose borders needed a wider type */
    uint32_t clipped;            /* faces whose borders needed one and were compressed without */
    double block_rms, block_max; /* what compression loses: of all texels that the strategy stores,
                                    borders included, as the encoder sees it */
    uint64_t reserved[4];
} slv_gl_texture_stats;
SLV_API slv_gl_texture_stats slv_gl_texture_get_stats(const slv_gl_texture *texture,
                                                      const slv_strategy *strategy);
/* Whether lookups of a strategy in a face need a wider type than the texture's, stored or, with
 * compression, clipped: one of stats.widened or stats.clipped. Of `live` textures, which know it as
 * of the last update; false of others. */
SLV_API bool slv_gl_texture_is_widened(const slv_gl_texture *texture, const slv_strategy *strategy,
                                       uint32_t face);

/* The strategies that the texture was made for; NULL past the last. */
SLV_API uint32_t slv_gl_texture_strategy_count(const slv_gl_texture *texture);
SLV_API const slv_strategy *slv_gl_texture_strategy(const slv_gl_texture *texture, uint32_t index);

SLV_API uint32_t slv_gl_texture_face_count(const slv_gl_texture *texture);
SLV_API uint32_t slv_gl_texture_batch_count(const slv_gl_texture *texture,
                                            const slv_strategy *strategy);
SLV_API slv_gl_batch slv_gl_texture_batch(const slv_gl_texture *texture,
                                          const slv_strategy *strategy, uint32_t index);

/* As many batches as one draw can show, from batch `first` on: one, or, of a texture that is found
 * by handles, all, unless its tables are longer than a draw may be shown. All have one variant.
 * Where there are more than one they are bound as the first of them is, and a glMultiDraw* of
 * `nbatches` draws has the faces of batch first + gl_DrawID in each: its shader says `slv_draw = `,
 * which is handed on from the vertex shader's gl_DrawID, before it looks up. Batches can as well be
 * drawn one by one.
 *
 *     for (uint32_t i = 0; (run = slv_gl_texture_run(texture, strategy, i)).nbatches;
 *          i += run.nbatches) {
 *         glUseProgram(programs[run.variant]);
 *         slv_gl_texture_bind(texture, strategy, i);
 *         glMultiDrawElements(GL_TRIANGLES, counts + i, GL_UNSIGNED_INT, at + i, run.nbatches);
 *     }
 */
typedef struct slv_gl_run {
    uint32_t nbatches; /* 0: there is no batch `first` */
    uint32_t variant;
} slv_gl_run;
SLV_API slv_gl_run slv_gl_texture_run(const slv_gl_texture *texture, const slv_strategy *strategy,
                                      uint32_t first);

/* The GLSL that a fragment shader includes, after `#version 450 core` and before its own code: the
 * definitions of a variant, and the parts of shaders/ that the strategy names. It depends on the
 * strategy, the variant, and the texture's channels and anisotropy; only strategies that reach
 * other faces have variants other than 0. Owned by the texture. A variant or a strategy that is not
 * there is SLV_ERROR_ARGUMENT; messages go to the log that the texture was made with. */
SLV_NODISCARD SLV_API slv_result slv_gl_texture_glsl(slv_gl_texture *texture,
                                                     const slv_strategy *strategy, uint32_t variant,
                                                     const char **out);

/* Programs with texts of the same key can be the same. */
SLV_NODISCARD SLV_API slv_result slv_gl_texture_key(slv_gl_texture *texture,
                                                    const slv_strategy *strategy, uint32_t variant,
                                                    uint64_t *out);
/* The #extension lines that a text with a prefix of its own needs before any declaration; the same
 * for all textures of a context that are branched and bound alike, once. May be "". */
SLV_API const char *slv_gl_texture_extensions(const slv_gl_texture *texture);

/* Binds what a batch needs: array textures and samplers from the first unit, unless they are found
 * by handles, and tables from the first storage binding. Changes nothing else. A batch that does
 * not exist binds nothing. */
SLV_API void slv_gl_texture_bind(slv_gl_texture *texture, const slv_strategy *strategy,
                                 uint32_t batch);
/* The same in two parts, for a frame of many batches: what all batches of a strategy share,
 * samplers and tables, and then for each batch its array textures, in one call of OpenGL's. */
SLV_API void slv_gl_texture_bind_shared(slv_gl_texture *texture, const slv_strategy *strategy);
SLV_API void slv_gl_texture_bind_batch(slv_gl_texture *texture, const slv_strategy *strategy,
                                       uint32_t batch);
/* Takes the samplers off again, which would otherwise override the host's own texture parameters.
 */
SLV_API void slv_gl_texture_unbind(slv_gl_texture *texture);

/* Lookups on the GPU, exactly as a fragment shader makes them: point i is (faces[i], uv[2i..]) with
 * the footprint dx[2i..], dy[2i..]; `out` gets 4 floats each. Changes GL state as slv_gl_wrap says.
 */
SLV_NODISCARD SLV_API slv_result slv_gl_texture_lookup(slv_gl_texture *texture, const slv_env *env,
                                                       const slv_strategy *strategy, uint32_t count,
                                                       const int32_t *faces, const float *uv,
                                                       const float *dx, const float *dy,
                                                       float *out);

/* The seam jump: the largest difference of any channel between a lookup just left and one just
 * right of a shared edge, alpha included. Single lookups are compared: what multisampling blends
 * afterwards (`discard`) is not in it. Zero means default. */
typedef struct slv_gl_seam_params {
    uint32_t samples; /* along each edge, its ends included; default 17 */
    uint32_t
        level; /* footprint: 2^level texels of the coarser face; 0 is magnified, 1/64 of a texel */
    /* Only edges that these faces name: each shared edge is named by one face, so that parts of a
     * mesh, measured one after the other, are together the whole. nfaces 0: all from there on. */
    uint32_t first_face, nfaces;
    uint64_t reserved[3];
} slv_gl_seam_params;

typedef struct slv_gl_seam {
    float max, mean;             /* over all samples of all shared edges */
    float equal_max, equal_mean; /* over those edges whose two faces have texels of one size */
    int32_t face, edge;          /* where the largest jump is; -1 if there are no shared edges */
    float t;
    uint32_t nedges, nequal;
    uint64_t reserved[4];
} slv_gl_seam;

SLV_NODISCARD SLV_API slv_result slv_gl_texture_seam_jump(
    slv_gl_texture *texture, const slv_env *env, const slv_strategy *strategy,
    const slv_adjacency *adjacency, const slv_gl_seam_params *params, slv_gl_seam *out);

#ifdef __cplusplus
}
#endif

#endif
