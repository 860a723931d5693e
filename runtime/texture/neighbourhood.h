/* Whether a constant face lies among nothing but its own value, by the rules of .ptx files. */
#ifndef SLV_TEXTURE_NEIGHBOURHOOD_H
#define SLV_TEXTURE_NEIGHBOURHOOD_H

#include <selvage/source.h>

typedef struct slv_neighbourhood {
    const void *user;
    /* of a face: its adjacency, and SLV_FACE_CONSTANT and SLV_FACE_SUBFACE in its flags */
    slv_source_face (*face)(const void *user, uint32_t face);
    /* whether a face is constant and has the value of another, which is */
    bool (*same)(const void *user, uint32_t face, uint32_t other);
    bool triangles;
    bool borders_clamp; /* on both axes */
} slv_neighbourhood;

bool slvi_neighbourhood_is_constant(const slv_neighbourhood *neighbourhood, uint32_t face);

#endif
