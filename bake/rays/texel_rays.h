/* Rays that begin all over a texel of a tessellated surface. */
#ifndef SLV_BAKE_TEXEL_RAYS_H
#define SLV_BAKE_TEXEL_RAYS_H

#include "rays/ray_scene.h"
#include "rays/reference_data.h"

enum { SLVI_TEXEL_RAYS = 64 }; /* at once */

/* What rays begin on, and how. */
typedef struct ray_ground {
    const slv_tessellation *tessellation;
    const reference_sampler *sampler; /* a box's */
    float offset;                     /* from the surface, where rays begin */
    float limit;                      /* where they end */
    bool inwards;
} ray_ground;

typedef struct ray_texel {
    uint32_t face, x, y;
    slv_res res;
} ray_texel;

/* Rays number first..first+count-1 of a texel, at most SLVI_TEXEL_RAYS: from points spread evenly
 * over it, on the triangles of the tessellation, so that none begins behind them, as likely as
 * their cosine to the smooth normal. A texel has sequences of its own. */
typedef void slvi_texel_rays(const ray_ground *ground, const ray_texel *texel, uint32_t first,
                             uint32_t count, struct RTCRay *out);

/* Kinds of processor that this is compiled for, the best first; the same bits by each. */
#ifdef SLV_HAVE_AVX2
#define SLVI_RAYS_PROCESSORS(RAYS) RAYS(avx2) RAYS(portable)
#else
#define SLVI_RAYS_PROCESSORS(RAYS) RAYS(portable)
#endif
#define SLVI_RAYS_DECLARE(KIND) slvi_texel_rays slvi_texel_rays_##KIND;
SLVI_RAYS_PROCESSORS(SLVI_RAYS_DECLARE)

#endif
