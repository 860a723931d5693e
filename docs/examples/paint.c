/* paint MESH.obj OUT.ptx: a new texture for a mesh, and a red stroke over its middle.
 * cc paint.c $(pkg-config --cflags --libs selvage-paint selvage-bake) */
#include <selvage/blank.h>
#include <selvage/stroke.h>
#include <stdio.h>

/* A stroke across a picture of 600 x 600 pixels that a camera takes. */
static slv_result stroke(slv_painter *painter, const slv_canvas *canvas, const slv_brush *brush) {
    float low[3], high[3];
    slv_paint_surface_bounds(slv_painter_get_surface(painter), low, high);
    const slv_stroke_params params = {.brush = brush,
                                      .paint = {.color = {0.8f, 0.1f, 0.1f}, .opacity = 0.7f},
                                      .radius = 25,
                                      .unit = SLV_SIZE_PIXELS,
                                      .in_picture = true,
                                      .camera = slv_camera_orbit(low, high, 30, 20, 35, 1),
                                      .width = 600,
                                      .height = 600};
    slv_stroke *s = NULL;
    slv_stroke_stats stats;
    slv_result result = slv_stroke_begin(painter, canvas, &params, &s);
    for (int i = 0; i <= 20 && !result; i++) {
        const slv_stroke_sample sample = {
            .x = 150 + 15 * (float)i, .y = 280 + (float)((i * i) % 40), .pressure = 1};
        result = slv_stroke_add(s, &sample, 1);
    }
    if (!result && !(result = slv_stroke_end(s, &stats)))
        printf("%u dabs, %u beside the surface\n", (unsigned)stats.dabs, (unsigned)stats.missed);
    slv_stroke_destroy(s);
    return result;
}

int main(int argc, char **argv) {
    slv_mesh *mesh = NULL;
    slv_paint_surface *surface = NULL;
    slv_painter *painter = NULL;
    slv_texture *texture = NULL;
    slv_brush *brush = NULL;
    slv_seam_certificate seams;
    const float grey[3] = {0.8f, 0.8f, 0.8f};
    const slv_blank_params blank = {.max_texels = 1 << 20, .fill = grey};
    if (argc != 3 || slv_mesh_load(NULL, argv[1], &mesh) ||
        slv_blank_create(NULL, mesh, &blank, &texture, NULL) ||
        slv_paint_surface_create(NULL, mesh, NULL, &surface) ||
        slv_painter_create(NULL, surface, &painter) || slv_brush_create(NULL, NULL, &brush))
        return 1;
    const slv_adjacency *adjacency = slv_paint_surface_adjacency(surface);
    const slv_canvas canvas = slv_texture_as_canvas(texture);
    const slv_ptx_write_params write = {.mesh = mesh};
    if (stroke(painter, &canvas, brush) || slv_seam_certify(NULL, &canvas, adjacency, &seams) ||
        slv_ptx_save(NULL, argv[2], texture, adjacency, &write))
        return 1;
    printf("edges differ by %g at most\n", seams.largest);
    slv_brush_destroy(brush);
    slv_painter_destroy(painter);
    slv_paint_surface_destroy(surface);
    slv_texture_destroy(texture);
    slv_mesh_destroy(mesh);
    return 0;
}
