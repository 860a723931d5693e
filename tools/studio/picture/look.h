/* How the surface is shown: all that a picture depends on but surface, texels and camera. */
#ifndef SELVAGE_STUDIO_LOOK_H
#define SELVAGE_STUDIO_LOOK_H

#include <selvage/camera.h>

#include <stdint.h>

typedef enum studio_compare {
    STUDIO_WHOLE = 0,  /* one strategy */
    STUDIO_SPLIT,      /* it on the left of a divider, the other one on the right */
    STUDIO_DIFFERENCE, /* how far they are apart */
    STUDIO_FLICKER,    /* one after the other */
    STUDIO_COMPARES
} studio_compare;

typedef enum studio_encoding {
    STUDIO_SRGB = 0,
    STUDIO_LINEAR, /* numbers as they are */
    STUDIO_DATA,   /* the mean of the channels as a colour of a map */
    STUDIO_ENCODINGS
} studio_encoding;

/* Drawn over the picture. */
typedef enum studio_overlay {
    STUDIO_OVERLAY_NONE = 0,
    STUDIO_OVERLAY_FACES,      /* a colour for each face */
    STUDIO_OVERLAY_RESOLUTION, /* a colour for each number of texels */
    STUDIO_OVERLAY_LEVELS,     /* the level that a lookup takes */
    STUDIO_OVERLAY_WIDENED,    /* faces for which the strategy needs a wider type */
    STUDIO_OVERLAY_DAMAGED,    /* faces that could not be read from the file */
    STUDIO_OVERLAYS
} studio_overlay;

typedef struct studio_look {
    uint32_t strategy, other; /* of slv_strategy_at */
    studio_compare compare;
    float divider, gain; /* 0..1 of the width; of the difference */
    bool second;         /* of flicker: the other one now */
    slv_shading shading;
    studio_overlay overlay;
    bool seams, wires; /* lines where faces meet, where the triangles do */
    studio_encoding encoding;
    float exposure;   /* stops */
    uint32_t channel; /* 0: colours; else that one, counted from 1 */
    uint32_t msaa, anisotropy;
    bool other_levels; /* even levels unless the file asks for them */
    float level_bias;  /* of slv_frame */
    uint32_t segments; /* along an edge; 0: by the size of faces */
    float light_turn;  /* degrees, of the light of an image */
} studio_look;

/* whole, split, difference, flicker; srgb, linear, data; none, faces, resolution, levels,
 * widened, damaged */
extern const char *const studio_compare_names[STUDIO_COMPARES];
extern const char *const studio_encoding_names[STUDIO_ENCODINGS];
extern const char *const studio_overlay_names[STUDIO_OVERLAYS];

studio_look studio_look_default(void);

/* An image before the picture, which is painted through. */
typedef struct studio_stencil {
    char *path;          /* NULL: there is none */
    float at[2];         /* its middle, in pixels from the picture's */
    float width, aspect; /* pixels; width / height */
    float angle;         /* degrees clockwise */
} studio_stencil;

#endif
