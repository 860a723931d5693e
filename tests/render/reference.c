/* The ray-cast reference against the renderer with so many pixels that its own filtering no longer
 * matters. */
#include "kit/reference_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/selvage.h>

/* Mitchell and Netravali's equation 8, for any B and C. */
static double cubic(double x, double b, double c) {
    x = fabs(x);
    double near = (12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + 6 - 2 * b,
           far = (-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x +
                 8 * b + 24 * c;
    return x < 1 ? near / 6 : x < 2 ? far / 6 : 0;
}

/* Filters down by a whole number; beyond the picture its rim goes on. */
static void average(const slv_image *large, uint32_t scale, slv_pixel_filter filter,
                    slv_image *out) {
    int s = (int)scale, reach = filter == SLV_PIXEL_BOX ? s / 2 : 2 * s;
    for (uint32_t i = 0; i < out->width * out->height; i++) {
        int x0 = (int)(i % out->width) * s + s / 2, y0 = (int)(i / out->width) * s + s / 2;
        double sum[4] = {0}, weights = 0;
        for (int y = y0 - reach; y < y0 + reach; y++) {
            double down = cubic((y + 0.5 - y0) / s, 1.0 / 3, 1.0 / 3);
            int row = y < 0 ? 0 : y < (int)large->height ? y : (int)large->height - 1;
            for (int x = x0 - reach; x < x0 + reach; x++) {
                int column = x < 0 ? 0 : x < (int)large->width ? x : (int)large->width - 1;
                double weight = filter == SLV_PIXEL_BOX
                                    ? 1
                                    : down * cubic((x + 0.5 - x0) / s, 1.0 / 3, 1.0 / 3);
                const float *from =
                    large->pixels + ((size_t)row * large->width + (size_t)column) * 4;
                for (int c = 0; c < 4; c++)
                    sum[c] += weight * (double)from[c];
                weights += weight;
            }
        }
        for (size_t c = 0; c < 4; c++)
            out->pixels[4 * (size_t)i + c] = (float)(sum[c] / weights);
    }
}

/* The renderer's picture of `scale` times the size, filtered down. */
static slv_image supersampled(slv_gl *gl, const model *m, const slv_reference_frame *given,
                              uint32_t scale) {
    slv_env env = test_env();
    slv_gl_texture_params params = {KIT_ONLY(kit_strategy("traverse"))};
    slv_gl_texture *texture = NULL;
    slv_gl_renderer *renderer = NULL;
    slv_image large, out;
    slv_frame frame = {.camera = given->camera,
                       .width = given->width * scale,
                       .height = given->height * scale,
                       .strategy = kit_strategy("traverse"),
                       .shading = given->shading,
                       .light = given->light,
                       .ka = given->ka,
                       .kd = given->kd,
                       .float_target = true};
    memcpy(frame.background, given->background, sizeof frame.background);
    REQUIRE(slv_gl_texture_create(gl, &env, m->texture, m->adjacency, &params, &texture) == SLV_OK);
    REQUIRE(slv_gl_renderer_create(gl, &env, m->mesh, m->surface, SEGMENTS, &renderer) == SLV_OK);
    REQUIRE(slv_gl_renderer_draw(renderer, &env, texture, &frame, &large, NULL) == SLV_OK);
    REQUIRE(slv_image_create(&env, given->width, given->height, 4, &out) == SLV_OK);
    average(&large, scale, given->filter, &out);
    slv_image_free(&large);
    slv_gl_renderer_destroy(renderer);
    slv_gl_texture_destroy(texture);
    return out;
}

static double psnr(const slv_image *a, const slv_image *b, uint32_t *inside) {
    double squares = 0;
    *inside = 0;
    for (size_t i = 0; i < (size_t)a->width * a->height; i++) {
        if (a->pixels[4 * i + 3] < 0.999f || b->pixels[4 * i + 3] < 0.999f)
            continue;
        (*inside)++;
        for (size_t c = 0; c < 3; c++) {
            double one = (double)(a->pixels[4 * i + c] - b->pixels[4 * i + c]);
            squares += one * one / 3;
        }
    }
    return squares > 0 ? -10 * log10(squares / *inside) : INFINITY;
}

static double largest_alpha_difference(const slv_image *a, const slv_image *b) {
    double largest = 0;
    for (size_t i = 0; i < (size_t)a->width * a->height; i++)
        largest = fmax(largest, fabs((double)(a->pixels[4 * i + 3] - b->pixels[4 * i + 3])));
    return largest;
}

static void check_renderer(void) {
    static const struct {
        const char *name;
        slv_shading shading;
        float azimuth, elevation, fov;
        uint32_t size, scale;
        bool mirrored;
        slv_pixel_filter filter;
        double least;
    } cases[] = {
        {"headlight", SLV_SHADE_HEADLIGHT, 30, 20, 35, 48, 32, false, SLV_PIXEL_BOX, 45},
        {"below", SLV_SHADE_UNLIT, 200, -50, 70, 48, 32, false, SLV_PIXEL_BOX, 45},
        {"orthographic", SLV_SHADE_HEADLIGHT, 120, 40, 0, 48, 16, false, SLV_PIXEL_BOX, 45},
        {"abs", SLV_SHADE_HEADLIGHT_ABS, 30, 20, 35, 48, 16, false, SLV_PIXEL_BOX, 45},
        {"cos2", SLV_SHADE_HEADLIGHT_COS2, 30, 20, 35, 48, 16, false, SLV_PIXEL_BOX, 45},
        {"mirrored", SLV_SHADE_HEADLIGHT, 30, 20, 35, 48, 16, true, SLV_PIXEL_BOX, 45},
        {"faces", SLV_SHADE_FACES, 250, 30, 20, 48, 16, false, SLV_PIXEL_BOX, 45},
        {"image", SLV_SHADE_IMAGE, 250, 30, 20, 48, 16, true, SLV_PIXEL_BOX, 45},
        {"mitchell", SLV_SHADE_HEADLIGHT, 30, 20, 35, 48, 32, false, SLV_PIXEL_MITCHELL, 45},
    };
    /* red from +x, green from above, blue from around the z axis */
    const slv_light light = {{{[3] = 0.2f, [12] = 0.2f, [15] = 0.5f},
                              {[7] = 0.2f, [13] = 0.2f, [15] = 0.3f},
                              {[10] = 0.4f, [15] = 0.2f}}};
    const slv_procedural noise = {
        .pattern = SLV_PATTERN_NOISE, .frequency = 2, .octaves = 2, .face_tint = 0.3f};
    slv_env env = test_env();
    model m = make_model(box_obj, SLV_SCHEME_CATMARK, &noise, 3, 0);
    slv_gl *gl = NULL;
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        slv_reference_frame frame = {.camera =
                                         look(cases[i].azimuth, cases[i].elevation, cases[i].fov),
                                     .width = cases[i].size,
                                     .height = cases[i].size,
                                     .samples = cases[i].filter == SLV_PIXEL_BOX ? 1024 : 4096,
                                     .filter = cases[i].filter,
                                     .shading = cases[i].shading,
                                     .light = &light,
                                     .ka = 0.15f,
                                     .kd = 0.7f,
                                     .background = {0.1f, 0.2f, 0.3f, 0.5f}};
        if (cases[i].mirrored)
            for (int k = 0; k < 4; k++)
                frame.camera.world_to_camera[k] *= -1;
        slv_image expected = supersampled(gl, &m, &frame, cases[i].scale);
        slv_image image = render(&m, &frame, 0);
        uint32_t inside;
        double score = psnr(&expected, &image, &inside),
               alpha = largest_alpha_difference(&expected, &image);
        fprintf(stderr, "%s: %.1f dB over %u pixels, alpha differs by %.4f\n", cases[i].name, score,
                inside, alpha);
        CHECK_MSG(inside > 200, "%s: %u pixels inside", cases[i].name, inside);
        CHECK_MSG(score >= cases[i].least, "%s: %.1f dB", cases[i].name, score);
        CHECK_MSG(alpha < 0.02, "%s: alpha differs by %g", cases[i].name, alpha);
        for (size_t c = 0; c < 4; c++)
            CHECK(fabsf(image.pixels[c] - frame.background[c]) < 1e-6f);
        slv_image_free(&image);
        slv_image_free(&expected);
    }
    slv_gl_destroy(gl);
    free_model(&m);
}

/* A surface that is divided anew is as one that was never divided otherwise; a mesh that is another
 * is refused, and nothing is lost. */
static void check_divided_anew(void) {
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE, .frequency = 2, .octaves = 2};
    slv_env env = test_env();
    model m = make_model(box_obj, SLV_SCHEME_CATMARK, &noise, 3, 0), other = {0};
    slv_reference *fresh = NULL;
    const slv_reference_frame frame = small_frame(SLV_PIXEL_BOX, 4);
    const slv_tessellation_params params = {
        .camera = &frame.camera, .width = frame.width, .height = frame.height};
    REQUIRE(slv_reference_create(&env, m.mesh, m.surface, m.texture, m.adjacency,
                                 &(slv_reference_params){.tessellation = &params},
                                 &fresh) == SLV_OK);
    slv_image even = render(&m, &frame, 1);
    REQUIRE(slv_reference_tessellate(m.reference, &env, m.mesh, m.surface, &params) == SLV_OK);
    slv_image anew = render(&m, &frame, 2);
    REQUIRE(slv_mesh_parse_obj(&env, "one", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 32,
                               &other.mesh) == SLV_OK);
    CHECK(slv_reference_tessellate(m.reference, &env, other.mesh, m.surface, &params) ==
          SLV_ERROR_MISMATCH);
    slv_reference_destroy(m.reference);
    m.reference = fresh;
    slv_image expected = render(&m, &frame, 1);
    size_t size = sizeof(float) * 4 * frame.width * frame.height;
    CHECK(memcmp(anew.pixels, expected.pixels, size) == 0);
    CHECK(memcmp(anew.pixels, even.pixels, size) != 0);
    slv_image_free(&even);
    slv_image_free(&anew);
    slv_image_free(&expected);
    slv_mesh_destroy(other.mesh);
    free_model(&m);
}

int main(void) {
    check_renderer();
    check_divided_anew();
    return test_end();
}
