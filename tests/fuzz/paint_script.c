/* Lines of a script of strokes, of any bytes; or, after a first byte that is 'b', a brush. */
#include "kit/fuzz_kit.h"

#include <selvage/script.h>

#include <math.h>

enum { FACES = 2, MOST_LINES = 8 };

static slv_mesh *mesh;
static slv_paint_surface *surface;

static void drop_surface(void) {
    slv_paint_surface_destroy(surface);
    slv_mesh_destroy(mesh);
}

/* Two squares that meet, made once. */
static void make_surface(void) {
    static const float positions[] = {0, 0, 0, 1, 0, 0, 2, 0, 0.5f, 0, 1, 0, 1, 1, 0, 2, 1, 0.5f};
    static const int32_t sizes[] = {4, 4}, verts[] = {0, 1, 4, 3, 1, 2, 5, 4};
    const slv_mesh_view view = {.nverts = 6,
                                .positions = positions,
                                .npolys = FACES,
                                .poly_sizes = sizes,
                                .poly_verts = verts};
    const slv_paint_surface_params params = {.scheme = SLV_SCHEME_BILINEAR, .segments = 2};
    slv_env env = fuzz_env();
    FUZZ_REQUIRE(!slv_mesh_create(&env, &view, &mesh) &&
                     !slv_paint_surface_create(&env, mesh, &params, &surface),
                 "no surface: %s", fuzz_last);
    atexit(drop_surface);
}

static void try_brush(const uint8_t *data, size_t size) {
    slv_env env = fuzz_env();
    slv_brush *brush = NULL;
    slv_result result = FUZZ_CALL(slv_brush_parse(&env, "brush", (const char *)data, size, &brush));
    FUZZ_REQUIRE(!result == (brush != NULL), "a brush after an error");
    if (brush)
        FUZZ_REQUIRE(slv_brush_radius(brush) >= 0.2f && slv_brush_radius(brush) <= 1000,
                     "a radius of %g", (double)slv_brush_radius(brush));
    slv_brush_destroy(brush);
}

static void try_script(const char *text, size_t size) {
    static const slv_res res[FACES] = {{3, 3}, {2, 4}};
    const slv_texture_desc desc = {
        .nfaces = FACES, .type = SLV_TYPE_U8, .nchannels = 4, .alpha_channel = 3, .res = res};
    slv_env env = fuzz_env();
    slv_painter *painter = NULL;
    slv_texture *texture = NULL;
    slv_script *script = NULL;
    FUZZ_REQUIRE(!slv_texture_create(&env, &desc, &texture) &&
                     !slv_painter_create(&env, surface, &painter),
                 "no painter: %s", fuzz_last);
    const slv_canvas canvas = slv_texture_as_canvas(texture);
    FUZZ_REQUIRE(!slv_script_create(painter, &canvas, NULL, &script), "%s", fuzz_last);
    for (uint64_t line = 1; line <= MOST_LINES && size; line++) {
        const char *end = memchr(text, '\n', size);
        size_t length = end ? (size_t)(end - text) : size;
        if (FUZZ_CALL(slv_script_run(script, line, text, length)))
            break;
        size -= length + (end != NULL);
        text += length + (end != NULL);
    }
    slv_script_destroy(script);
    slv_painter_destroy(painter);
    slv_texture_destroy(texture);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    if (!surface)
        make_surface();
    if (size && data[0] == 'b')
        try_brush(data + 1, size - 1);
    else
        try_script((const char *)data, size);
    return 0;
}
