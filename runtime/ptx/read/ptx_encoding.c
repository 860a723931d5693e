/* What a file says of its colours. */
#include "ptx/format/ptx_file.h"

#include <ctype.h>
#include <string.h>

/* Ours, and those under which other programs note the colour space. */
static const char *const keys[] = {SLV_PTX_ENCODING_KEY, "oiio:ColorSpace", "ColorSpace",
                                   "colorSpace", "colorspace"};

/* Parts of the names that colour spaces go by, in lower case; of "Linear sRGB" the first counts,
 * since primaries are of no account here. */
static const struct {
    const char *part;
    slv_texture_encoding encoding;
} parts[] = {{"lin", SLV_TEXTURE_LINEAR}, {"acescg", SLV_TEXTURE_LINEAR},
             {"srgb", SLV_TEXTURE_SRGB},  {"raw", SLV_TEXTURE_DATA},
             {"data", SLV_TEXTURE_DATA},  {"non-color", SLV_TEXTURE_DATA}};

/* SLV_TEXTURE_AUTO: a name that is not known. */
static slv_texture_encoding find(const slv_ptx_meta *meta) {
    const char *text = meta->values;
    char name[64] = "";
    for (uint32_t i = 0; i < meta->count && i + 1 < sizeof name; i++)
        name[i] = (char)tolower((unsigned char)text[i]);
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (strstr(name, parts[i].part))
            return parts[i].encoding;
    return SLV_TEXTURE_AUTO;
}

slv_result slvi_ptx_stated_encoding(const slv_ptx *ptx, slv_texture_encoding *out) {
    *out = SLV_TEXTURE_AUTO;
    for (size_t i = 0; i < sizeof keys / sizeof *keys && *out == SLV_TEXTURE_AUTO; i++) {
        const slv_ptx_meta *value;
        ptx_meta *meta = slvi_ptx_meta_lookup(ptx, keys[i]);
        slv_result result = meta ? slvi_ptx_meta_load(ptx, meta, &value) : SLV_OK;
        if (result)
            return result;
        if (meta && value->type == SLV_META_STRING)
            *out = find(value);
    }
    if (*out == SLV_TEXTURE_AUTO && ptx->info.edge_filter == SLV_EDGE_FILTER_TANVEC)
        *out = SLV_TEXTURE_DATA;
    return SLV_OK;
}

slv_result slv_ptx_get_encoding(const slv_ptx *ptx, slv_texture_encoding *out) {
    slv_result result = slvi_ptx_stated_encoding(ptx, out);
    if (!result && *out == SLV_TEXTURE_AUTO)
        *out = slv_type_encoding(ptx->info.type);
    return result;
}
