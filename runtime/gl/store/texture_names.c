/* Words for the choices of a texture on the GPU. */
#include "base/names.h"

#include <selvage/gl_texture.h>

const char *slv_gl_taps_name(slv_gl_taps taps) {
    static const char *const names[] = {"auto", "sampler", "shader"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)taps);
}

const char *slv_gl_layout_name(slv_gl_layout layout) {
    static const char *const names[] = {"auto", "separate", "pages"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)layout);
}

const char *slv_gl_binding_name(slv_gl_binding binding) {
    static const char *const names[] = {"auto", "units", "handles"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)binding);
}

const char *slv_gl_branching_name(slv_gl_branching branching) {
    static const char *const names[] = {"auto", "real", "vectors"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)branching);
}

const char *slv_gl_compression_name(slv_gl_compression compression) {
    static const char *const names[] = {"none", "blocks"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)compression);
}
