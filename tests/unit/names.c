/* Every value of every enumeration has a word of its own, a value that is none is "unknown", and
 * words lead back to values. And the headers' version is the project's. */
#include "kit/test.h"

#include <selvage/bake.h>
#include <selvage/camera.h>
#include <selvage/exchange.h>
#include <selvage/filter.h>
#include <selvage/gl_strategy.h>
#include <selvage/gl_texture.h>
#include <selvage/image.h>
#include <selvage/lay.h>
#include <selvage/ptx_check.h>
#include <selvage/reference.h>
#include <selvage/stroke.h>
#include <selvage/surface.h>
#include <selvage/tessellation.h>
#include <selvage/transfer.h>
#include <selvage/wrap.h>

/* Checks the words of the values 0..LAST; `back` is an expression that is true if `name` leads back
 * to `i`. */
#define CHECK_NAMES(type, last, name_of, back)                                                     \
    do {                                                                                           \
        for (int i = 0; i <= (int)(last); i++) {                                                   \
            const char *name = name_of((type)i);                                                   \
            REQUIRE(name &&name[0]);                                                               \
            CHECK_MSG(strcmp(name, "unknown") != 0, #type " %d has no name", i);                   \
            for (int k = 0; k < i; k++)                                                            \
                CHECK_MSG(strcmp(name, name_of((type)k)) != 0, #type " %d and %d: %s", k, i,       \
                          name);                                                                   \
            CHECK_MSG(back, #type ": %s does not lead back", name);                                \
        }                                                                                          \
        CHECK(!strcmp(name_of((type)((int)(last) + 1)), "unknown"));                               \
        CHECK(!strcmp(name_of((type)0x7fffffff), "unknown"));                                      \
    } while (0)
#define DEFINE_LEADS_BACK(type, from_name)                                                         \
    static bool leads_back_##type(const char *name, int value) {                                   \
        type found = (type)99, none = (type)99;                                                    \
        return from_name(name, &found) && (int)found == value && !from_name("no such", &none) &&   \
               (int)none == 99;                                                                    \
    }

DEFINE_LEADS_BACK(slv_type, slv_type_from_name)
DEFINE_LEADS_BACK(slv_texture_encoding, slv_texture_encoding_from_name)
DEFINE_LEADS_BACK(slv_shading, slv_shading_from_name)
DEFINE_LEADS_BACK(slv_boundary, slv_boundary_from_name)
DEFINE_LEADS_BACK(slv_scheme, slv_scheme_from_name)
DEFINE_LEADS_BACK(slv_displacement_space, slv_displacement_space_from_name)
DEFINE_LEADS_BACK(slv_filter, slv_filter_from_name)
DEFINE_LEADS_BACK(slv_pattern, slv_pattern_from_name)
DEFINE_LEADS_BACK(slv_blend, slv_blend_from_name)
DEFINE_LEADS_BACK(slv_select, slv_select_from_name)
DEFINE_LEADS_BACK(slv_size_unit, slv_size_unit_from_name)
DEFINE_LEADS_BACK(slv_pixel_filter, slv_pixel_filter_from_name)
DEFINE_LEADS_BACK(slv_gl_backend, slv_gl_backend_from_name)
DEFINE_LEADS_BACK(slv_wrap_map, slv_wrap_map_from_name)

static void check_results(void) {
    for (int i = 0; i <= (int)SLV_ERROR_CANCELLED; i++) {
        const char *words = slv_result_string((slv_result)i);
        REQUIRE(words && words[0]);
        CHECK(strcmp(words, "unknown result") != 0);
    }
    CHECK(!strcmp(slv_result_string((slv_result)(SLV_ERROR_CANCELLED + 1)), "unknown result"));
}

int main(void) {
    check_results();
    CHECK_NAMES(slv_blend, SLV_BLEND_SUBTRACT, slv_blend_name, leads_back_slv_blend(name, i));
    CHECK_NAMES(slv_select, SLV_SELECT_ANGLE, slv_select_name, leads_back_slv_select(name, i));
    CHECK_NAMES(slv_size_unit, SLV_SIZE_TEXELS, slv_size_unit_name,
                leads_back_slv_size_unit(name, i));
    CHECK_NAMES(slv_log_level, SLV_LOG_ERROR, slv_log_level_name, true);
    CHECK_NAMES(slv_type, SLV_TYPE_FLOAT, slv_type_name, leads_back_slv_type(name, i));
    CHECK_NAMES(slv_texture_encoding, SLV_TEXTURE_DATA, slv_texture_encoding_name,
                leads_back_slv_texture_encoding(name, i));
    CHECK_NAMES(slv_shading, SLV_SHADE_IMAGE, slv_shading_name, leads_back_slv_shading(name, i));
    CHECK_NAMES(slv_alpha_mode, SLV_ALPHA_MASK, slv_alpha_mode_name, true);
    CHECK_NAMES(slv_boundary, SLV_BOUNDARY_EDGE_AND_CORNER, slv_boundary_name,
                leads_back_slv_boundary(name, i));
    CHECK_NAMES(slv_scheme, SLV_SCHEME_LOOP, slv_scheme_name, leads_back_slv_scheme(name, i));
    CHECK_NAMES(slv_displacement_space, SLV_DISPLACE_TANGENT, slv_displacement_space_name,
                leads_back_slv_displacement_space(name, i));
    CHECK_NAMES(slv_filter, SLV_FILTER_COUNT - 1, slv_filter_name, leads_back_slv_filter(name, i));
    CHECK_NAMES(slv_ptx_mesh_type, SLV_PTX_QUAD, slv_ptx_mesh_type_name, true);
    CHECK_NAMES(slv_border_mode, SLV_BORDER_PERIODIC, slv_border_mode_name, true);
    CHECK_NAMES(slv_edge_filter, SLV_EDGE_FILTER_TANVEC, slv_edge_filter_name, true);
    CHECK_NAMES(slv_meta_type, SLV_META_DOUBLE, slv_meta_type_name, true);
    CHECK_NAMES(slv_ptx_encoding, SLV_PTX_TILED, slv_ptx_encoding_name, true);
    CHECK_NAMES(slv_check_kind, SLV_CHECK_KINDS - 1, slv_check_kind_name, true);
    CHECK_NAMES(slv_image_encoding, SLV_ENCODE_LINEAR, slv_image_encoding_name, true);
    CHECK_NAMES(slv_pattern, SLV_PATTERN_POSITION, slv_pattern_name,
                leads_back_slv_pattern(name, i));
    CHECK_NAMES(slv_pixel_filter, SLV_PIXEL_MITCHELL, slv_pixel_filter_name,
                leads_back_slv_pixel_filter(name, i));
    CHECK_NAMES(slv_transfer_kind, SLV_TRANSFER_FAR, slv_transfer_kind_name, true);
    CHECK_NAMES(slv_exchange_images, SLV_EXCHANGE_EXR, slv_exchange_images_name, true);
    CHECK_NAMES(slv_gl_backend, SLV_GL_HOST, slv_gl_backend_name,
                i == SLV_GL_HOST || leads_back_slv_gl_backend(name, i));
    CHECK_NAMES(slv_gl_binding, SLV_GL_BINDING_HANDLES, slv_gl_binding_name, true);
    CHECK_NAMES(slv_gl_branching, SLV_GL_BRANCHING_VECTORS, slv_gl_branching_name, true);
    CHECK_NAMES(slv_gl_compression, SLV_GL_COMPRESSION_BLOCKS, slv_gl_compression_name, true);
    CHECK_NAMES(slv_gl_layout, SLV_GL_LAYOUT_PAGES, slv_gl_layout_name, true);
    CHECK_NAMES(slv_gl_taps, SLV_GL_TAPS_SHADER, slv_gl_taps_name, true);
    CHECK_NAMES(slv_gl_packing, SLV_GL_PAGES, slv_gl_packing_name, true);
    CHECK_NAMES(slv_gl_wrapping, SLV_GL_WRAP_MIRROR, slv_gl_wrapping_name, true);
    CHECK_NAMES(slv_gl_reach_kind, SLV_GL_REACH_COUNT - 1, slv_gl_reach_kind_name, true);
    CHECK_NAMES(slv_image_format, SLV_IMAGE_EXR, slv_image_format_name, true);
    CHECK_NAMES(slv_ptx_seams, SLV_PTX_SEAMS_ALL, slv_ptx_seams_name, true);
    CHECK_NAMES(slv_wrap_map, SLV_WRAP_SPHERE, slv_wrap_map_name, leads_back_slv_wrap_map(name, i));
    CHECK_NAMES(slv_wrap_round, SLV_WRAP_ROUND_BOTH, slv_wrap_round_name, true);
    CHECK_NAMES(slv_ink_kind, SLV_INK_CLONE, slv_ink_kind_name, true);
    CHECK_NAMES(slv_bake_miss, SLV_BAKE_NAN, slv_bake_miss_name, true);
    CHECK_NAMES(slv_bake_wrap, SLV_BAKE_WRAP_NONE, slv_bake_wrap_name, true);
    CHECK_NAMES(slv_bake_surface_kind, SLV_BAKE_CURVATURE, slv_bake_surface_kind_name, true);
    CHECK_NAMES(slv_bake_rays_kind, SLV_BAKE_THICKNESS, slv_bake_rays_kind_name, true);
    CHECK_NAMES(slv_bake_detail_kind, SLV_BAKE_FACE_VECTOR, slv_bake_detail_kind_name, true);
    CHECK_NAMES(slv_unbake_normals, SLV_UNBAKE_FACE_NORMALS, slv_unbake_normals_name, true);
    slv_scheme scheme = SLV_SCHEME_BILINEAR; /* by its whole name, too */
    CHECK(slv_scheme_from_name("catmull-clark", &scheme) && scheme == SLV_SCHEME_CATMARK);
    slv_gl_backend host;
    CHECK(!slv_gl_backend_from_name("host", &host)); /* not one that can be asked for */
    CHECK(slv_version() == SLV_VERSION);
    char version[32];
    snprintf(version, sizeof version, "%d.%d.%d", SLV_VERSION_MAJOR, SLV_VERSION_MINOR,
             SLV_VERSION_PATCH);
    CHECK_MSG(!strcmp(version, PROJECT_VERSION), "%s, but " PROJECT_VERSION, version);
    return test_end();
}
