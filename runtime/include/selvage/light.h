/* Light from all around, as an image of latitude and longitude has it. */
#ifndef SELVAGE_LIGHT_H
#define SELVAGE_LIGHT_H

#include <selvage/image.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a white matt surface sends back of the light that falls onto it from one side: of channel c
 * max(0, n . matrices[c] n), with n the unit normal and 1 behind it. Spherical harmonics up to the
 * second band, which is within 3% of the whole on average (Ramamoorthi and Hanrahan 2001). */
typedef struct slv_light {
    float matrices[3][16]; /* of red, green and blue; symmetric */
} slv_light;

/* Of an image of all directions in the world of the mesh: +z is in the middle, +y at the top, and
 * +x a quarter to the left, as one who stands inside sees it and as OpenEXR has such maps. Colours
 * of sRGB (slv_image.encoding) are decoded; alpha, and values that are not finite, count for
 * nothing. An image of one colour is that colour from everywhere. */
SLV_API void slv_light_from_image(const slv_image *image, slv_light *out);
/* The same light, turned by so many degrees around the y axis, from +z towards +x. */
SLV_API slv_light slv_light_turn(const slv_light *light, float degrees);
/* What comes back from a surface with this unit normal. */
SLV_API void slv_light_at(const slv_light *light, const float normal[3], float rgb[3]);

#ifdef __cplusplus
}
#endif

#endif
