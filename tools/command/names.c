/* Lists of words out of the library's names of values. */
#include "command/names.h"

#include <selvage/bake.h>
#include <selvage/reference.h>
#include <selvage/selvage.h>

#include <stdio.h>
#include <string.h>

enum { SIZE = 128 };

/* The names of the values from 0 to before `end`, or to the last there is. The text is the same
 * each time, so that it may be kept in place. */
static const char *list(char text[SIZE], const char *(*name_of)(int), int end) {
    size_t used = 0;
    for (int value = 0; value < end; value++) {
        const char *name = name_of(value);
        if (strcmp(name, slv_type_name((slv_type)-1)) == 0)
            break; /* a value that is none */
        used += (size_t)snprintf(text + used, SIZE - used, "%s%s", value ? "|" : "", name);
    }
    return text;
}

#define DEFINE_NAMES(words, type, name_of, end)                                                    \
    static const char *words##_one(int value) {                                                    \
        return name_of((type)value);                                                               \
    }                                                                                              \
    const char *names_##words(void) {                                                              \
        static char text[SIZE];                                                                    \
        return list(text, words##_one, end);                                                       \
    }

DEFINE_NAMES(types, slv_type, slv_type_name, SIZE)
DEFINE_NAMES(encodings, slv_texture_encoding, slv_texture_encoding_name, SIZE)
DEFINE_NAMES(borders, slv_border_mode, slv_border_mode_name, SIZE)
DEFINE_NAMES(edge_filters, slv_edge_filter, slv_edge_filter_name, SIZE)
DEFINE_NAMES(schemes, slv_scheme, slv_scheme_name, SIZE)
DEFINE_NAMES(boundaries, slv_boundary, slv_boundary_name, SIZE)
DEFINE_NAMES(shadings, slv_shading, slv_shading_name, SIZE)
DEFINE_NAMES(alpha_modes, slv_alpha_mode, slv_alpha_mode_name, SIZE)
DEFINE_NAMES(contexts, slv_gl_backend, slv_gl_backend_name, SLV_GL_HOST)
DEFINE_NAMES(pixel_filters, slv_pixel_filter, slv_pixel_filter_name, SIZE)
DEFINE_NAMES(filters, slv_filter, slv_filter_name, SIZE)
DEFINE_NAMES(spaces, slv_displacement_space, slv_displacement_space_name, SIZE)
DEFINE_NAMES(wraps, slv_bake_wrap, slv_bake_wrap_name, SIZE)
DEFINE_NAMES(rounds, slv_wrap_round, slv_wrap_round_name, SIZE)
DEFINE_NAMES(patterns, slv_pattern, slv_pattern_name, SIZE)
DEFINE_NAMES(bake_surfaces, slv_bake_surface_kind, slv_bake_surface_kind_name, SIZE)
DEFINE_NAMES(bake_rays, slv_bake_rays_kind, slv_bake_rays_kind_name, SIZE)
DEFINE_NAMES(seams, slv_ptx_seams, slv_ptx_seams_name, SIZE)
DEFINE_NAMES(unbake_normals, slv_unbake_normals, slv_unbake_normals_name, SIZE)
DEFINE_NAMES(bake_details, slv_bake_detail_kind, slv_bake_detail_kind_name, SIZE)
