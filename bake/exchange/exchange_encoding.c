/* Colours between a .ptx and pictures. */
#include "exchange/exchange_data.h"

#include <string.h>

void slvi_exchange_change(slv_texture_encoding from, slv_texture_encoding to, uint32_t nchannels,
                          int32_t alpha, float *values, uint64_t count) {
    if (from == SLV_TEXTURE_SRGB && to == SLV_TEXTURE_LINEAR)
        slv_texels_decode(nchannels, alpha, values, count);
    else if (from == SLV_TEXTURE_LINEAR && to == SLV_TEXTURE_SRGB)
        slv_texels_encode(nchannels, alpha, values, count);
}

bool slvi_exchange_needs_note(const slvi_exchange_plan *plan) {
    const slv_ptx_writer_params *target = &plan->target;
    return plan->encoding != SLV_TEXTURE_AUTO &&
           plan->encoding != slv_type_encoding(target->type) &&
           !(plan->encoding == SLV_TEXTURE_DATA && target->edge_filter == SLV_EDGE_FILTER_TANVEC);
}

slv_result slvi_exchange_note_encoding(const slvi_exchange_plan *plan, slv_ptx_writer *writer) {
    const char *name = slv_texture_encoding_name(plan->encoding);
    const slv_ptx_meta meta = {.key = SLV_PTX_ENCODING_KEY,
                               .type = SLV_META_STRING,
                               .count = (uint32_t)strlen(name),
                               .values = name};
    return slv_ptx_writer_set_meta(writer, &meta);
}
