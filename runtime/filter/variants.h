/* What the templates of this folder are made into. A *_template.h holds functions that are compiled
 * several times over: for each kind of processor by the sources lookup_KIND.c and
 * anisotropic_KIND.c, with the compiler's options for it in CMakeLists.txt, and within these for
 * each filter. All kinds of processor and all filters are listed here; other headers of this folder
 * are plain ones. */
#ifndef SLV_FILTER_VARIANTS_H
#define SLV_FILTER_VARIANTS_H

#include "filter/sampler.h"

/* Kinds of processor, the best first. */
#ifdef SLV_HAVE_AVX2
#define SLVI_FILTER_PROCESSORS(ROW) ROW(avx2) ROW(portable)
#else
#define SLVI_FILTER_PROCESSORS(ROW) ROW(portable)
#endif

/* Filters: the name, and which of the codes below looks it up. */
#define SLVI_FILTER_KINDS(ROW)                                                                     \
    ROW(SLV_FILTER_POINT, "point", point)                                                          \
    ROW(SLV_FILTER_BILINEAR, "bilinear", bilinear)                                                 \
    ROW(SLV_FILTER_BOX, "box", box)                                                                \
    ROW(SLV_FILTER_GAUSSIAN, "gaussian", gaussian)                                                 \
    ROW(SLV_FILTER_BICUBIC, "bicubic", cubic)                                                      \
    ROW(SLV_FILTER_BSPLINE, "bspline", cubic)                                                      \
    ROW(SLV_FILTER_CATMULL_ROM, "catmullrom", cubic)                                               \
    ROW(SLV_FILTER_MITCHELL, "mitchell", cubic)                                                    \
    ROW(SLV_FILTER_ANISOTROPIC, "anisotropic", anisotropic)

/* Lookups are compiled for each of these, the filter being a constant there. */
#define SLVI_FILTER_CODES(ROW)                                                                     \
    ROW(point, SLV_FILTER_POINT)                                                                   \
    ROW(bilinear, SLV_FILTER_BILINEAR)                                                             \
    ROW(box, SLV_FILTER_BOX)                                                                       \
    ROW(gaussian, SLV_FILTER_GAUSSIAN)                                                             \
    ROW(cubic, SLV_FILTER_BICUBIC)                                                                 \
    ROW(anisotropic, SLV_FILTER_ANISOTROPIC)

/* A name as the source file's own kind of processor, SLVI_VARIANT_NAME, has it. */
#define SLVI_VARIANT(NAME) SLVI_VARIANT_JOIN(NAME, SLVI_VARIANT_NAME)
#define SLVI_VARIANT_JOIN(NAME, KIND) SLVI_VARIANT_PASTE(NAME, KIND)
#define SLVI_VARIANT_PASTE(NAME, KIND) NAME##_##KIND

/* Of each kind: the lookups by filter, and the sum of the anisotropic filter on quad meshes, for
 * which u and v are finite and the footprint is a number. */
#define SLVI_FILTER_DECLARE(KIND)                                                                  \
    extern const lookup_functions slvi_lookup_##KIND[SLV_FILTER_COUNT];                            \
    void slvi_anisotropic_sum_##KIND(lookup_state *state, const slv_lookup *lookup);
SLVI_FILTER_PROCESSORS(SLVI_FILTER_DECLARE)

#endif
