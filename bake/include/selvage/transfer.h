/* Texels from one model to a changed one. */
#ifndef SELVAGE_TRANSFER_H
#define SELVAGE_TRANSFER_H

#include <selvage/surface.h>
#include <selvage/texture.h>

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
    uint64_t reserved[4];
} slv_transfer_params;

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

#ifdef __cplusplus
}
#endif

#endif
