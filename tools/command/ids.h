/* Face numbers as pictures: of a whole view, and as digits. */
#ifndef SELVAGE_TOOLS_IDS_H
#define SELVAGE_TOOLS_IDS_H

#include "command/scene.h"

/* The face that each pixel's middle shows. For an EXR one channel, the number, -1 where there is no
 * surface; else RGBA of bytes, alpha 0 there: with c = red + 256 green + 65536 blue, the face is
 * c * IDS_BACK mod 2^24, less 1, so that neighbours differ plainly and numbers come back exactly.
 */
enum { IDS_FACTOR = 0x9E3779, IDS_BACK = 0xB382C9 };
slv_result ids_draw(const slv_env *env, const scene_shot *shot, bool exr, slv_image *out);

/* Pixels that a number takes, at a whole number of pixels a dot. */
void ids_number_size(uint32_t number, uint32_t zoom, uint32_t *width, uint32_t *height);
/* Writes a number into a picture, white on a black ground; it must fit. */
void ids_number_draw(slv_image *image, uint32_t number, uint32_t left, uint32_t top, uint32_t zoom);

#endif
