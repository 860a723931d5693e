/* Texels from one model to a changed one. */
#ifndef SELVAGE_TRANSFER_H
#define SELVAGE_TRANSFER_H

#include <selvage/source.h>
#include <selvage/surface.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum slv_transfer_kind {
    SLV_TRANSFER_COPIED = 0, /* a face of the source has its corners: every texel as it was */
    SLV_TRANSFER_RESAMPLED,  /* each texel from the nearest point of the source's surface */
    SLV_TRANSFER_PARTLY,     /* the same, but some texels are too far from it */
    SLV_TRANSFER_FAR         /* all of them are */
} slv_transfer_kind;

/* copied, resampled, partly, far */
SLV_API const char *slv_transfer_kind_name(slv_transfer_kind kind);

typedef struct slv_transfer_face {
    slv_transfer_kind kind;
    int32_t source; /* the face copied, or the one nearest to this one's middle */
    uint8_t turn;   /* copied: the source's corner that is this face's corner 0 */
    bool flipped;   /* copied: the source goes round the other way */
    float covered;  /* 0..1: share of its texels near enough */
    float distance; /* the largest of a texel to the source, in mesh units */
    float area;     /* of its corners' quadrilateral */
} slv_transfer_face;

/* Zero means default. */
typedef struct slv_transfer_params {
    float max_distance; /* how near the source a texel must be; default 1/100 of its diagonal */
    bool blank;         /* texels further away stay zero instead of the nearest value */
    bool no_copies;     /* resample matching faces as well */
    slv_scheme scheme;
    slv_progress progress; /* faces */
    float source_scale;    /* what the source's coordinates are multiplied by, so that its units are
                              the target's; 0: 1 */
    uint64_t reserved[3];
} slv_transfer_params;

/* What the source's coordinates would have to be multiplied by for it to be as large as the target:
 * the ratio of their diagonals, or of two units of length that is within a twentieth of it. 1 if
 * one of them has no extent. */
SLV_API float slv_transfer_find_scale(const slv_mesh *source, const slv_mesh *target);

/* Where the faces of a transfer go. `begin` is called once, with the faces' resolutions, before
 * `face`, which is called for each of them, from several threads at once: with one texel if it is
 * constant, and with an environment whose log may be called from there. */
typedef struct slv_transfer_sink {
    slv_result (*begin)(void *user, const slv_texture_desc *desc);
    slv_result (*face)(void *user, const slv_env *env, uint32_t face, bool constant,
                       const void *texels);
    void *user;
} slv_transfer_sink;

/* Makes a texture for `target`, in the type and channels of `texture`, which belongs to `source`.
 * Copied faces keep their resolution (turned with them), others have the density of texels of the
 * source where they lie, up to twice its finest side (more if the target has fewer faces), or the
 * resolution of the nearest face if their middle is too far from it. Values are interpolated,
 * across edges too, at the nearest point of the limit surface; a texel that covers many of the
 * source is the mean of those. Colours are multiplied by alpha meanwhile. A warning says if one
 * model is ten times as large as the other. Of two sheets close together the one that faces the
 * same way is taken. `faces` has room for the target's faces,
 * `*covered` (may be NULL) is the share of the target's area. On env->threads threads; the same
 * bytes with any number of them. */
SLV_NODISCARD SLV_API slv_result slv_transfer(const slv_env *env, const slv_mesh *source,
                                              const slv_texture *texture, const slv_mesh *target,
                                              const slv_transfer_params *params,
                                              slv_transfer_face *faces, float *covered,
                                              slv_texture **out);

/* The same from any source of texels, face by face into a sink: a file behind a cache
 * (slv_cache_as_source) is never in memory as a whole, nor is the result. Texels that
 * cover more than eight of the source along an axis are made of its reductions. Sources of
 * triangles are SLV_ERROR_UNSUPPORTED. */
SLV_NODISCARD SLV_API slv_result slv_transfer_from(const slv_env *env, const slv_mesh *source,
                                                   const slv_source *texels, const slv_mesh *target,
                                                   const slv_transfer_params *params,
                                                   const slv_transfer_sink *sink,
                                                   slv_transfer_face *faces, float *covered);

#ifdef __cplusplus
}
#endif

#endif
