/* Words for what a .ptx file says of itself. */
#include "base/file.h"
#include "base/names.h"

#include <selvage/ptx.h>

static const char *const mesh_types[] = {"triangle", "quad"};
static const char *const border_modes[] = {"clamp", "black", "periodic"};
static const char *const edge_filters[] = {"none", "tanvec"};
static const char *const meta_types[] = {"string", "int8", "int16", "int32", "float", "double"};
static const char *const encodings[] = {"constant", "zipped", "diff-zipped", "tiled"};

const char *slv_ptx_mesh_type_name(slv_ptx_mesh_type type) {
    return slvi_name_of(mesh_types, SLVI_COUNT(mesh_types), (int)type);
}

const char *slv_border_mode_name(slv_border_mode mode) {
    return slvi_name_of(border_modes, SLVI_COUNT(border_modes), (int)mode);
}

const char *slv_edge_filter_name(slv_edge_filter filter) {
    return slvi_name_of(edge_filters, SLVI_COUNT(edge_filters), (int)filter);
}

const char *slv_meta_type_name(slv_meta_type type) {
    return slvi_name_of(meta_types, SLVI_COUNT(meta_types), (int)type);
}

const char *slv_ptx_encoding_name(slv_ptx_encoding encoding) {
    return slvi_name_of(encodings, SLVI_COUNT(encodings), (int)encoding);
}

bool slv_ptx_is_name(const char *path) {
    return slvi_name_ends(path, ".ptx") || slvi_name_ends(path, ".ptex");
}
