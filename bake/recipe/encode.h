/* From light in floats to the texels that a file holds. */
#ifndef SLV_BAKE_ENCODE_H
#define SLV_BAKE_ENCODE_H

#include <selvage/texture.h>

typedef struct encoder {
    slv_type type;
    uint32_t nchannels;
    int32_t alpha;
    bool srgb;
    /* Of sRGB in bytes: the least light of each value, and by the upper half of a float's bits the
     * value of the least float that has them. */
    float least[257];
    uint8_t guess[32768];
} encoder;

void slvi_encoder_begin(encoder *e, slv_type type, uint32_t nchannels, int32_t alpha, bool srgb);
/* Encodes in place where it has to, and converts: the same as slv_texels_encode and
 * slv_type_from_float. */
void slvi_encoder_run(const encoder *e, float *values, uint64_t count, void *out);
/* And back. */
void slvi_encoder_undo(const encoder *e, const void *texels, uint64_t count, float *out);

#endif
