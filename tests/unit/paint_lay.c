/* How paint is laid: images before a camera, stamps, gradients, clones, masks, the symmetry of a
 * mesh, and fills by colour, each against what it should leave at each texel. */
#include "kit/paint_kit.h"

#include <selvage/lay.h>
#include <selvage/script.h>

static const slv_paint paint = {.color = {0, 0, 0}, .opacity = 1};

/* 4 x 4 faces of the plane from 0 to 4, each turned otherwise. */
static paint_scene plane(const slv_env *env, uint32_t nchannels, int32_t alpha) {
    shape s = paint_plane(4, 4);
    return paint_scene_of(env, &s, SLV_SCHEME_BILINEAR, 4, SLV_TYPE_FLOAT, nchannels, alpha);
}

static void fetch(const paint_scene *s, slv_surface_point at, float *out) {
    slv_res res = slv_texture_get_desc(s->texture)->res[at.face];
    slv_texture_fetch(s->texture, (uint32_t)at.face, (uint32_t)(at.u * (float)(1 << res.u)),
                      (uint32_t)(at.v * (float)(1 << res.v)), out);
}

/* The middle of a texel, and its place on the plane. */
static slv_surface_point texel(const paint_scene *s, uint32_t face, uint32_t x, uint32_t y,
                               float place[3]) {
    slv_surface_point at = {(int32_t)face, ((float)x + 0.5f) / 16, ((float)y + 0.5f) / 16};
    CHECK(slv_paint_surface_at(s->surface, at, place, NULL, NULL));
    return at;
}

static void fill_all(const paint_scene *s, const slv_lay *lay) {
    uint8_t selected[64];
    uint32_t faces = 0;
    memset(selected, 1, sizeof selected);
    MUST(slv_painter_fill_with(s->painter, &s->canvas, selected, &paint, lay, &faces));
    CHECK(faces == s->nfaces);
}

/* Values that grow by 1/64 to the right and 1/16 downwards: what bilinear lookups and means of
 * squares of it are is known. */
static slv_image ramp(const slv_env *env, uint32_t width, uint32_t height) {
    slv_image image = {0};
    MUST(slv_image_create(env, width, height, 3, &image));
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            for (uint32_t c = 0; c < 3; c++)
                image.pixels[(y * width + x) * 3 + c] =
                    c ? (float)y / (float)height : (float)x / (float)width;
    return image;
}

/* An image twice as wide as high, before a camera that sees the plane: it is as wide as it is told
 * to be, half as high, and nothing beside it is painted. */
static void stencil(const slv_env *env) {
    paint_scene s = plane(env, 4, 3);
    slv_image image = ramp(env, 32, 16);
    const slv_lay lay = {.ink = {.kind = SLV_INK_IMAGE,
                                 .image = &image,
                                 .camera = paint_camera(4),
                                 .width = 400,
                                 .height = 400,
                                 .x = 150,
                                 .y = 250,
                                 .size = 200}};
    fill_all(&s, &lay);
    for (uint32_t face = 0; face < s.nfaces; face++)
        for (uint32_t i = 0; i < 256; i++) {
            float p[3], got[4];
            slv_surface_point at = texel(&s, face, i % 16, i / 16, p);
            fetch(&s, at, got);
            /* in the image, from its upper left corner, in parts of it */
            double x = ((double)p[0] * 100 - 50) / 200, y = (400 - (double)p[1] * 100 - 200) / 100;
            if (x > 0.04 && x < 0.96 && y > 0.08 && y < 0.92) {
                CHECK_MSG(fabs((double)got[0] - (x - 0.5 / 32)) < 2e-3 &&
                              fabs((double)got[1] - (y - 0.5 / 16)) < 2e-3 && got[3] > 0.999f,
                          "%g %g: %g %g %g", x, y, (double)got[0], (double)got[1], (double)got[3]);
            } else if (x < -0.04 || x > 1.04 || y < -0.08 || y > 1.08) {
                CHECK_MSG(got[3] == 0, "%g %g: %g", x, y, (double)got[3]);
            }
        }
    slv_image_free(&image);
    paint_scene_end(&s);
}

/* On a cube that the camera sees one side of, the other five stay as they are. */
static void hidden(const slv_env *env) {
    shape c = shape_cube();
    paint_scene s = paint_scene_of(env, &c, SLV_SCHEME_BILINEAR, 3, SLV_TYPE_FLOAT, 4, 3);
    slv_image image = ramp(env, 8, 8);
    float low[3], high[3], got[4];
    slv_paint_surface_bounds(s.surface, low, high);
    const slv_lay lay = {.ink = {.kind = SLV_INK_IMAGE,
                                 .image = &image,
                                 .camera = slv_camera_orbit(low, high, 0, 0, 0, 1),
                                 .width = 64,
                                 .height = 64,
                                 .x = 32,
                                 .y = 32,
                                 .size = 500}};
    int painted = 0;
    fill_all(&s, &lay);
    for (uint32_t face = 0; face < s.nfaces; face++)
        for (uint32_t i = 0; i < 64; i++) {
            float normal[3];
            slv_surface_point at = {(int32_t)face, ((float)(i % 8) + 0.5f) / 8,
                                    ((float)(i / 8) + 0.5f) / 8};
            CHECK(slv_paint_surface_at(s.surface, at, NULL, normal, NULL));
            fetch(&s, at, got);
            CHECK((got[3] > 0.9f) == (normal[2] > 0.9f));
            painted += got[3] > 0;
        }
    CHECK(painted == 64);
    slv_image_free(&image);
    paint_scene_end(&s);
}

/* A stamp over corners of faces lies as its dab does, whichever way the faces are turned; turned
 * over it is its own mirror image, and what is legible is so from left to right once more. */
static void stamp(const slv_env *env, bool flip, bool legible) {
    paint_scene s = plane(env, 4, 3);
    slv_image image = ramp(env, 16, 16);
    const double angle = 0.3;
    slv_dab dab = {.at = paint_below(&s, 2.1, 1.95),
                   .radius = 1.2f * 1.41421356f,
                   .hardness = 1,
                   .angle = (float)(angle * 180 / 3.14159265358979),
                   .axis = {1, 0, 0},
                   .unfold = true};
    const slv_lay lay = {
        .ink = {.kind = SLV_INK_STAMP, .image = &image, .flip = flip, .legible = legible}};
    slv_patches patches;
    dab.angle = flip ? -dab.angle : dab.angle;
    MUST(slv_painter_cover(s.painter, slv_texture_get_desc(s.texture)->res, &dab, &patches));
    MUST(slv_painter_lay(s.painter, &s.canvas, &patches, &paint, &lay, &dab, NULL));
    int inside = 0;
    for (uint32_t face = 0; face < s.nfaces; face++)
        for (uint32_t i = 0; i < 256; i++) {
            float p[3], got[4];
            slv_surface_point at = texel(&s, face, i % 16, i / 16, p);
            double dx = (double)p[0] - 2.1, dy = ((double)p[1] - 1.95) * (flip ? -1 : 1);
            double x = (cos(angle) * dx + sin(angle) * dy) / 2.4 + 0.5,
                   y = 0.5 - (cos(angle) * dy - sin(angle) * dx) / 2.4;
            x = flip && legible ? 1 - x : x;
            fetch(&s, at, got);
            if (x > 0.08 && x < 0.92 && y > 0.08 && y < 0.92) {
                inside++;
                CHECK_MSG(fabs((double)got[0] - (x - 0.5 / 16)) < 4e-3 &&
                              fabs((double)got[1] - (y - 0.5 / 16)) < 4e-3 && got[3] > 0.999f,
                          "%g %g: %g %g %g", x, y, (double)got[0], (double)got[1], (double)got[3]);
            } else if (x < -0.08 || x > 1.08 || y < -0.08 || y > 1.08) {
                CHECK(got[3] == 0);
            }
        }
    CHECK(inside > 800);
    slv_image_free(&image);
    paint_scene_end(&s);
}

static void gradient(const slv_env *env, bool radial) {
    paint_scene s = plane(env, 3, SLV_NO_ALPHA);
    const slv_lay lay = {.ink = {.kind = SLV_INK_GRADIENT,
                                 .from = {1, 1, 0},
                                 .to = {3, 1, 0},
                                 .radial = radial,
                                 .color = {1, 0.5f, 0.25f}}};
    fill_all(&s, &lay);
    for (uint32_t face = 0; face < s.nfaces; face++)
        for (uint32_t i = 0; i < 256; i += 5) {
            float p[3], got[3];
            slv_surface_point at = texel(&s, face, i % 16, i / 16, p);
            double t =
                radial ? hypot((double)p[0] - 1, (double)p[1] - 1) / 2 : ((double)p[0] - 1) / 2;
            t = t < 0 ? 0 : t > 1 ? 1 : t;
            fetch(&s, at, got);
            CHECK(fabs((double)got[0] - t) < 1e-5 && fabs((double)got[2] - t / 4) < 1e-5);
        }
    paint_scene_end(&s);
}

/* What a stroke clones is as far from where it goes as at its beginning, over edges of faces. */
static void cloned(const slv_env *env) {
    paint_scene s = plane(env, 3, SLV_NO_ALPHA);
    slv_brush *brush = NULL;
    slv_stroke *stroke = NULL;
    const slv_lay pattern = {
        .ink = {.kind = SLV_INK_GRADIENT, .to = {4, 0, 0}, .color = {1, 1, 1}}};
    fill_all(&s, &pattern);
    /* 1.4 to the left and 0.5 below; what is there is never painted over */
    const slv_lay lay = {.ink = {.kind = SLV_INK_CLONE, .source = paint_below(&s, 0.8, 1.5)}};
    const slv_brush_params hard = {.hardness = 1, .spacing = 0.3f};
    MUST(slv_brush_create(env, &hard, &brush));
    const slv_stroke_params params = {.brush = brush, .paint = paint, .radius = 0.5f, .lay = &lay};
    const slv_stroke_sample samples[] = {{.at = paint_below(&s, 2.2, 2), .pressure = 1},
                                         {.at = paint_below(&s, 2.6, 2.4), .pressure = 1}};
    MUST(slv_stroke_begin(s.painter, &s.canvas, &params, &stroke));
    MUST(slv_stroke_add(stroke, samples, 2));
    MUST(slv_stroke_end(stroke, NULL));
    slv_stroke_destroy(stroke);
    int inside = 0;
    for (uint32_t face = 0; face < s.nfaces; face++)
        for (uint32_t i = 0; i < 256; i++) {
            float p[3], got[3];
            slv_surface_point at = texel(&s, face, i % 16, i / 16, p);
            double way = ((double)p[0] - 2.2 + (double)p[1] - 2) / 2, far[2];
            for (int k = 0; k < 2; k++) { /* the last dab is less than a step before the end */
                double along = fmin(fmax(way, 0), k ? 0.4 : 0.3);
                far[k] = hypot((double)p[0] - 2.2 - along, (double)p[1] - 2 - along);
            }
            fetch(&s, at, got);
            if (far[0] < 0.4) {
                inside++;
                CHECK_MSG(fabs((double)got[0] - ((double)p[0] - 1.4) / 4) < 3e-3, "%g %g: %g",
                          (double)p[0], (double)p[1], (double)got[0]);
            } else if (far[1] > 0.6) {
                CHECK(fabs((double)got[0] - (double)p[0] / 4) < 1e-5);
            }
        }
    CHECK(inside > 150);
    slv_brush_destroy(brush);
    paint_scene_end(&s);
}

static void masks(const slv_env *env) {
    shape c = shape_cube();
    paint_scene s =
        paint_scene_of(env, &c, SLV_SCHEME_BILINEAR, 3, SLV_TYPE_FLOAT, 1, SLV_NO_ALPHA);
    const float one = 1;
    float normal[3], got;
    uint8_t faces[6] = {1, 1, 1, 0, 1, 1};
    float low[3], high[3];
    slv_paint_surface_bounds(s.surface, low, high);
    const slv_camera camera = slv_camera_orbit(low, high, 30, 40, 35, 1);
    for (int kind = 0; kind < 3; kind++) {
        slv_lay lay = {.blur = 0};
        for (uint32_t f = 0; f < 6; f++)
            MUST(slv_texture_set_constant(s.texture, f, &one));
        if (kind == 0)
            lay.mask = (slv_mask){.towards = {0, 2, 0}, .degrees = 60};
        else if (kind == 1)
            lay.mask = (slv_mask){.facing = &camera};
        else
            lay.mask = (slv_mask){.faces = faces};
        fill_all(&s, &lay);
        for (uint32_t f = 0; f < 6; f++) {
            const slv_surface_point at = {(int32_t)f, 0.4f, 0.4f};
            CHECK(slv_paint_surface_at(s.surface, at, NULL, normal, NULL));
            bool takes = kind == 0   ? normal[1] > 0.9f
                         : kind == 1 ? normal[0] > 0.9f || normal[1] > 0.9f || normal[2] > 0.9f
                                     : f != 3;
            fetch(&s, at, &got);
            CHECK_MSG(got == (takes ? 0 : 1), "mask %d, face %u: %g", kind, f, (double)got);
        }
    }
    paint_scene_end(&s);
    /* a canvas of other resolutions: half as much paint on the right as on the left */
    paint_scene p = plane(env, 1, SLV_NO_ALPHA);
    shape again = paint_plane(4, 4);
    paint_scene m =
        paint_scene_of(env, &again, SLV_SCHEME_BILINEAR, 2, SLV_TYPE_FLOAT, 2, SLV_NO_ALPHA);
    for (uint32_t f = 0; f < p.nfaces; f++) {
        float values[2] = {9, f % 4 < 2 ? 1 : 0.5f};
        MUST(slv_texture_set_constant(m.texture, f, values));
        MUST(slv_texture_set_constant(p.texture, f, &one));
    }
    slv_lay lay = {.mask = {.canvas = &m.canvas, .channel = 1}};
    fill_all(&p, &lay);
    for (uint32_t f = 0; f < p.nfaces; f++) {
        fetch(&p, (slv_surface_point){(int32_t)f, 0.7f, 0.2f}, &got);
        CHECK(fabsf(got - (f % 4 < 2 ? 0 : 0.5f)) < 1e-6f);
    }
    lay.mask.channel = 2;
    CHECK(slv_painter_flood(p.painter, &p.canvas, (slv_surface_point){0, 0, 0}, 1, &paint, &lay,
                            NULL) == SLV_ERROR_MISMATCH);
    paint_scene_end(&m);
    paint_scene_end(&p);
}

/* Over the middle of the plane: whatever is covered on one side is on the other, once, and faces
 * that are turned otherwise have their texels where they should be. */
static void symmetry(const slv_env *env) {
    paint_scene s = plane(env, 1, SLV_NO_ALPHA);
    const slv_adjacency *adjacency = slv_paint_surface_adjacency(s.surface);
    slv_symmetry *mirror = NULL;
    slv_neighbour list[2];
    slv_patches patches;
    uint32_t faces, other;
    unsigned edge = 0;
    /* faces 1 and 2 meet in the middle line */
    while (edge < 4 &&
           (slv_adjacency_neighbours(adjacency, 1, edge, list) == 0 || list[0].face != 2))
        edge++;
    REQUIRE(edge < 4);
    other = (uint32_t)list[0].face;
    MUST(slv_symmetry_create(env, adjacency, (uint32_t[]){1, other},
                             (unsigned[]){edge, list[0].edge}, &mirror, &faces));
    CHECK(faces == 16);
    for (uint32_t f = 0; f < 16; f++) {
        slv_surface_point at = {(int32_t)f, 0.3f, 0.2f};
        float a[3], b[3];
        CHECK(slv_paint_surface_at(s.surface, at, a, NULL, NULL));
        CHECK(slv_symmetry_apply(mirror, &at));
        CHECK(slv_paint_surface_at(s.surface, at, b, NULL, NULL));
        CHECK(fabsf(a[0] + b[0] - 4) < 1e-5f && fabsf(a[1] - b[1]) < 1e-5f);
    }
    /* a dab that lies on both sides of the line */
    const slv_dab dab = {.at = paint_below(&s, 1.7, 2.3), .radius = 0.8f, .hardness = 0.4f};
    const slv_lay lay = {.symmetry = mirror};
    const slv_paint quarter = {.color = {1}, .opacity = 0.25f};
    MUST(slv_painter_cover(s.painter, slv_texture_get_desc(s.texture)->res, &dab, &patches));
    MUST(slv_painter_lay(s.painter, &s.canvas, &patches, &quarter, &lay, &dab, NULL));
    int painted = 0;
    for (uint32_t face = 0; face < s.nfaces; face++)
        for (uint32_t i = 0; i < 256; i++) {
            float p[3], got, image;
            slv_surface_point at = texel(&s, face, i % 16, i / 16, p);
            fetch(&s, at, &got);
            CHECK(slv_symmetry_apply(mirror, &at));
            fetch(&s, at, &image);
            CHECK(got == image && got <= 0.25f);
            painted += got > 0;
        }
    CHECK(painted > 500);
    slv_symmetry *none = mirror;
    CHECK(slv_symmetry_create(env, adjacency, (uint32_t[]){1, 99}, (unsigned[]){0, 0}, &none,
                              NULL) == SLV_ERROR_ARGUMENT &&
          !none);
    slv_symmetry_destroy(mirror);
    paint_scene_end(&s);
}

/* A ring of another colour over many faces keeps the paint inside. */
static void flood(const slv_env *env) {
    paint_scene s = plane(env, 1, SLV_NO_ALPHA);
    slv_patches patches;
    uint64_t texels = 0, expected = 0;
    const slv_paint white = {.color = {1}, .opacity = 1}, grey = {.color = {0.5f}, .opacity = 1};
    const slv_res *res = slv_texture_get_desc(s.texture)->res;
    slv_dab dab = {.at = paint_below(&s, 2, 2), .radius = 1.5f, .hardness = 1};
    MUST(slv_painter_cover(s.painter, res, &dab, &patches));
    MUST(slv_painter_apply(s.painter, &s.canvas, &patches, &white));
    dab.radius = 1.2f;
    MUST(slv_painter_cover(s.painter, res, &dab, &patches));
    const slv_paint erase = {.opacity = 1, .color = {0}};
    MUST(slv_painter_apply(s.painter, &s.canvas, &patches, &erase));
    MUST(slv_painter_flood(s.painter, &s.canvas, paint_below(&s, 2.3, 1.8), 0.1f, &grey, NULL,
                           &texels));
    for (uint32_t face = 0; face < s.nfaces; face++)
        for (uint32_t i = 0; i < 256; i++) {
            float p[3], got;
            slv_surface_point at = texel(&s, face, i % 16, i / 16, p);
            double far = hypot((double)p[0] - 2, (double)p[1] - 2);
            fetch(&s, at, &got);
            expected += got == 0.5f;
            if (far < 1.1)
                CHECK(got == 0.5f);
            if (far > 1.3)
                CHECK(got != 0.5f);
        }
    CHECK(texels == expected);
    paint_scene_end(&s);
}

static void run_line(paint_scene *s, const char *line, slv_script_stats *stats) {
    slv_script *script = NULL;
    MUST(slv_script_create(s->painter, &s->canvas, NULL, &script));
    MUST(slv_script_run(script, 1, line, strlen(line)));
    slv_script_get_stats(script, stats);
    slv_script_destroy(script);
}

static float value_at(const paint_scene *s, double x, double y) {
    float got;
    fetch(s, paint_below(s, x, y), &got);
    return got;
}

/* Fills go to the other sides of planes as strokes do, each texel once; and a mask that leaves
 * nothing of a face leaves it untouched. */
static void mirrored_fills(const slv_env *env) {
#define ACROSS "\"mirror\":[{\"point\":[2,2,0],\"normal\":[1,0,0]}],"
    slv_script_stats stats;
    paint_scene s = plane(env, 1, SLV_NO_ALPHA);
    run_line(&s, "{\"op\":\"fill\"," ACROSS "\"face\":0,\"color\":[1],\"opacity\":0.5}", &stats);
    CHECK(stats.faces == 2 && stats.texels == 2 * 256 && stats.missed == 0);
    CHECK(value_at(&s, 0.5, 0.5) == 0.5f && value_at(&s, 3.5, 0.5) == 0.5f);
    CHECK(value_at(&s, 1.5, 0.5) == 0 && value_at(&s, 0.5, 3.5) == 0);
    /* all of one colour, from both sides: once */
    run_line(&s,
             "{\"op\":\"fill\"," ACROSS "\"face\":1,\"select\":\"color\",\"color\":[0.8],"
             "\"opacity\":0.5}",
             &stats);
    CHECK(stats.faces == 14 && stats.texels == 14 * 256);
    CHECK(fabsf(value_at(&s, 1.5, 0.5) - 0.4f) < 1e-6f && value_at(&s, 0.5, 0.5) == 0.5f);
    run_line(&s,
             "{\"op\":\"fill\"," ACROSS
             "\"face\":0,\"select\":\"connected\",\"color\":[1],\"opacity\":0.5}",
             &stats);
    CHECK(stats.faces == 16 && fabsf(value_at(&s, 3.5, 0.5) - 0.75f) < 1e-6f);
    /* what one has the other has too, if it is of another colour */
    run_line(&s, "{\"op\":\"fill\",\"face\":3,\"color\":[0],\"opacity\":1}", &stats);
    run_line(&s,
             "{\"op\":\"fill\"," ACROSS "\"face\":0,\"select\":\"color\",\"color\":[1],"
             "\"opacity\":1}",
             &stats);
    CHECK(stats.faces == 2 && value_at(&s, 0.5, 0.5) == 1 && value_at(&s, 3.5, 0.5) == 1);
    run_line(&s,
             "{\"op\":\"fill\",\"where\":{\"faces\":[]},\"face\":0,\"select\":\"connected\","
             "\"color\":[0]}",
             &stats);
    CHECK(stats.faces == 0 && value_at(&s, 0.5, 0.5) == 1);
    paint_scene_end(&s);
#undef ACROSS
}

int main(void) {
    slv_env env = test_env();
    stencil(&env);
    hidden(&env);
    stamp(&env, false, false);
    stamp(&env, true, false);
    stamp(&env, false, true);
    stamp(&env, true, true);
    gradient(&env, false);
    gradient(&env, true);
    cloned(&env);
    masks(&env);
    symmetry(&env);
    flood(&env);
    mirrored_fills(&env);
    return test_end();
}
