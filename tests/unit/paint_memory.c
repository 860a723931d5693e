/* Each allocation of a call of the painting library fails once: an error, one line, nothing kept.
 */
#include "kit/memory_kit.h"
#include "kit/paint_kit.h"

#include <selvage/blank.h>
#include <selvage/script.h>

static const char script[] =
    "{\"radius\": 0.3, \"brush\": {\"hardness\": 0.7}, \"color\": [1, 0, 0], \"samples\": "
    "[[0, 0.2, 0.4], [0, 0.5, 0.6], [1, 0.4, 0.4]], \"mirror\": [{\"point\": [0, 0, 0], "
    "\"normal\": [1, 0, 0]}]}";

static slv_mesh *mesh;

/* All that a painter takes, and a line of a script; a surface is swept by itself, since Embree's
 * memory is not ours. */
static const slv_paint_surface *surface;

static slv_result make_surface(const slv_env *env) {
    slv_paint_surface *made = NULL;
    const slv_paint_surface_params params = {.segments = 2};
    slv_result result = slv_paint_surface_create(env, mesh, &params, &made);
    CHECK(!result == (made != NULL));
    slv_paint_surface_destroy(made);
    return result;
}

static slv_result with_painter(const slv_env *env,
                               slv_result (*call)(const slv_env *env, slv_painter *painter,
                                                  const slv_canvas *canvas)) {
    slv_painter *painter = NULL;
    slv_texture *texture = NULL;
    const slv_blank_params blank = {.uniform = true, .res = {3, 3}, .scheme = SLV_SCHEME_BILINEAR};
    slv_result result = slv_blank_create(env, mesh, &blank, &texture, NULL);
    if (!result)
        result = slv_painter_create(env, surface, &painter);
    if (!result) {
        const slv_canvas canvas = slv_texture_as_canvas(texture);
        result = call(env, painter, &canvas);
    }
    slv_painter_destroy(painter);
    slv_texture_destroy(texture);
    return result;
}

static slv_result run_script(const slv_env *env, slv_painter *painter, const slv_canvas *canvas) {
    slv_script *s = NULL;
    slv_result result = slv_script_create(painter, canvas, NULL, &s);
    (void)env;
    if (!result)
        result = slv_script_run(s, 1, script, strlen(script));
    slv_script_destroy(s);
    return result;
}

static slv_result fill_and_certify(const slv_env *env, slv_painter *painter,
                                   const slv_canvas *canvas) {
    slv_seam_certificate seams;
    uint8_t selected[6] = {0};
    const slv_paint paint = {.color = {1, 1, 1}, .opacity = 1};
    slv_result result = slv_painter_select(painter, 1, SLV_SELECT_CONNECTED, 0, selected);
    if (!result)
        result = slv_painter_fill(painter, canvas, selected, &paint, NULL);
    if (!result)
        result = slv_seam_certify(env, canvas, slv_paint_surface_adjacency(surface), &seams);
    return result;
}

static const char brush_text[] =
    "{\"version\": 3, \"settings\": {\"opaque\": {\"base_value\": 1, \"inputs\": {\"pressure\": "
    "[[0, 0], [1, 1]]}}, \"none\": {\"base_value\": 1}}}";

static slv_result parse_brush(const slv_env *env) {
    slv_brush *brush = NULL;
    slv_result result = slv_brush_parse(env, "brush", brush_text, strlen(brush_text), &brush);
    slv_brush_destroy(brush);
    return result;
}

static slv_result sweep_script(const slv_env *env) {
    return with_painter(env, run_script);
}

static slv_result sweep_fill(const slv_env *env) {
    return with_painter(env, fill_and_certify);
}

int main(void) {
    slv_env env = test_env();
    shape c = shape_cube();
    slv_mesh_view view = {.nverts = c.nverts,
                          .positions = c.positions,
                          .npolys = c.npolys,
                          .poly_sizes = c.sizes,
                          .poly_verts = c.verts};
    const slv_paint_surface_params params = {.scheme = SLV_SCHEME_BILINEAR, .segments = 2};
    slv_paint_surface *made = NULL;
    slv_brush *brush = NULL;
    MUST(slv_mesh_create(&env, &view, &mesh));
    MUST(slv_paint_surface_create(&env, mesh, &params, &made));
    surface = made;
    long all = memory_sweep("surface", make_surface, NULL);
    all += memory_sweep("script", sweep_script, NULL);
    all += memory_sweep("fill", sweep_fill, NULL);
    if (!slv_brush_parse(&env, "brush", brush_text, strlen(brush_text), &brush))
        all += memory_sweep("brush", parse_brush, NULL);
    slv_brush_destroy(brush);
    CHECK(all > 60);
    slv_paint_surface_destroy(made);
    slv_mesh_destroy(mesh);
    shape_clear(&c);
    return test_end();
}
