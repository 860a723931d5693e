/* Resolution by error: few texels where there is little to see, and a bound that no finer
 * measurement exceeds. */
#include "kit/uv_kit.h"

enum { SIDE = 8, PIXELS = 512 };

/* A plane of 8 x 8 faces over the whole image. */
static slv_mesh *plane(void) {
    static char text[16384];
    size_t used = 0;
    for (int i = 0; i <= SIDE; i++)
        for (int j = 0; j <= SIDE; j++)
            used += (size_t)snprintf(text + used, sizeof text - used, "v %d %d 0\nvt %g %g\n", j, i,
                                     (double)j / SIDE, (double)i / SIDE);
    for (int i = 0; i < SIDE; i++)
        for (int j = 0; j < SIDE; j++) {
            int a = i * (SIDE + 1) + j + 1, b = a + SIDE + 1;
            used += (size_t)snprintf(text + used, sizeof text - used, "f %d/%d %d/%d %d/%d %d/%d\n",
                                     a, a, a + 1, a + 1, b + 1, b + 1, b, b);
        }
    REQUIRE(used < sizeof text);
    return uv_parse(text);
}

static bool is_fine(int x, int y) {
    return (x == 2 && y == 5) || (x == 6 && y == 1);
}

/* Fine waves on two faces, which fade towards their edges, slow ones along u everywhere else but
 * where u is small. */
static float waves(uint32_t channel, float u, float v) {
    float x = u * SIDE, y = v * SIDE, value = 0.5f + 0.02f * (float)channel;
    value += 0.05f * sinf(6 * fmaxf(0, u - 0.15f));
    if (is_fine((int)x, (int)y)) {
        float s = sinf(3.14159265f * (x - floorf(x))), t = sinf(3.14159265f * (y - floorf(y)));
        value += 0.4f * s * s * t * t * sinf(u * 200) * cosf(v * 150 + (float)channel);
    }
    return value;
}

/* The image as a function, bilinear between the middles of pixels, as light. */
static void look(const slv_image *image, double u, double v, double out[3]) {
    double x = u * image->width - 0.5, y = (1 - v) * image->height - 0.5, most = PIXELS - 1;
    x = x < 0 ? 0 : x > most ? most : x;
    y = y < 0 ? 0 : y > most ? most : y;
    uint32_t left = (uint32_t)x, top = (uint32_t)y, right = left + (left < PIXELS - 1),
             bottom = top + (top < PIXELS - 1);
    double fx = x - left, fy = y - top;
    for (uint32_t c = 0; c < 3; c++) {
        double a = (double)image->pixels[(top * PIXELS + left) * 3 + c],
               b = (double)image->pixels[(top * PIXELS + right) * 3 + c],
               d = (double)image->pixels[(bottom * PIXELS + left) * 3 + c],
               e = (double)image->pixels[(bottom * PIXELS + right) * 3 + c];
        out[c] = (a + (b - a) * fx) * (1 - fy) + (d + (e - d) * fx) * fy;
    }
}

static float light_of[256];

static void texel_light(const slv_texture *texture, uint32_t face, int64_t x, int64_t y,
                        float out[3]) {
    slv_res res = slv_texture_get_desc(texture)->res[face];
    int64_t w = INT64_C(1) << res.u, h = INT64_C(1) << res.v;
    slv_texture_fetch(texture, face,
                      (uint32_t)(x < 0    ? 0
                                 : x >= w ? w - 1
                                          : x),
                      (uint32_t)(y < 0    ? 0
                                 : y >= h ? h - 1
                                          : y),
                      out);
    slv_texels_decode(3, SLV_NO_ALPHA, out, 1);
}

/* The largest difference of stored values on a lattice that has nothing to do with the one that the
 * library measures on. */
static double densely(const slv_image *image, const char *name, uint32_t samples,
                      uint64_t *texels) {
    slv_env env = test_env();
    slv_ptx *ptx = tool_open(name);
    slv_texture *texture = NULL;
    double worst = 0;
    MUST(slv_ptx_load_texture(&env, ptx, &texture));
    *texels = 0;
    for (uint32_t face = 0; face < SIDE * SIDE; face++) {
        slv_res res = slv_texture_get_desc(texture)->res[face];
        *texels += UINT64_C(1) << (res.u + res.v);
        if (face % 9 && !is_fine((int)(face % SIDE), (int)(face / SIDE)))
            continue; /* some of the others will do */
        for (uint32_t k = 0; k < samples * samples; k++) {
            double s = (k % samples + 0.31) / samples, t = ((double)(k / samples) + 0.73) / samples;
            double x = s * exp2(res.u) - 0.5, y = t * exp2(res.v) - 0.5, want[3];
            int64_t left = (int64_t)floor(x), low = (int64_t)floor(y);
            float fx = (float)(x - (double)left), fy = (float)(y - (double)low), at[4][3], got[3],
                  there[3];
            for (int i = 0; i < 4; i++)
                texel_light(texture, face, left + (i & 1), low + (i >> 1), at[i]);
            look(image, (face % SIDE + s) / SIDE, ((double)(face / SIDE) + t) / SIDE, want);
            for (int c = 0; c < 3; c++) {
                float a = at[0][c] + (at[1][c] - at[0][c]) * fx,
                      b = at[2][c] + (at[3][c] - at[2][c]) * fx;
                got[c] = a + (b - a) * fy;
                there[c] = (float)want[c];
            }
            slv_texels_encode(3, SLV_NO_ALPHA, got, 1);
            slv_texels_encode(3, SLV_NO_ALPHA, there, 1);
            for (int c = 0; c < 3; c++)
                worst = fmax(worst, fabs((double)got[c] - (double)there[c]));
        }
    }
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
    return worst;
}

int main(void) {
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    slv_bake_source *source = NULL;
    slv_image image;
    uint64_t texels = 0, uniform = 0;
    for (int i = 0; i < 256; i++)
        light_of[i] = (float)i / 255;
    slv_texels_decode(1, SLV_NO_ALPHA, light_of, 256);
    tool_begin();
    mesh = plane();
    uv_write_image("waves.png", PIXELS, PIXELS, 3, waves, &uv_raw);
    MUST(slv_image_load(&env, tool_path("waves.png"), &image));
    slv_texels_decode(3, SLV_NO_ALPHA, image.pixels, PIXELS * PIXELS);
    MUST(slv_bake_from_uv(&env, mesh, tool_path("waves.png"), NULL, &source));
    /* 2.3 times as many samples along each axis as the library takes; ten times as many with effort
     */
    uint32_t samples = test_effort(1) > 1 ? 2560 : 590;
    for (int k = 0; k < 2; k++) {
        static const float errors[] = {0.06f, 0.02f};
        slv_bake_job job = {.max_error = errors[k]};
        slv_bake_report report, coarse;
        MUST(slv_bake_save(&env, mesh, source, &job, tool_path("fit.ptx"), &report));
        double found = densely(&image, "fit.ptx", samples, &texels);
        CHECK(texels == report.texels);
        CHECK_MSG(found <= (double)report.error_bound, "%g, more than %g", found,
                  (double)report.error_bound);
        CHECK_MSG(!report.faces_over && report.error <= errors[k], "%llu faces, %g",
                  (unsigned long long)report.faces_over, (double)report.error);
        CHECK(report.smallest.u == 0 && report.smallest.v == 0 && report.constant_faces >= 1);
        /* the uniform size that is as good */
        for (int8_t log2 = 0; log2 <= 6; log2++) {
            slv_bake_job even = {.uniform = true, .res = {log2, log2}};
            MUST(slv_bake_save(&env, mesh, source, &even, tool_path("even.ptx"), &coarse));
            if (densely(&image, "even.ptx", 128, &uniform) <= found)
                break;
        }
        CHECK_MSG(4 * texels <= uniform, "error %g: %llu texels, uniform %llu", (double)errors[k],
                  (unsigned long long)texels, (unsigned long long)uniform);
    }
    const slv_bake_job two = {.max_error = 0.1f, .match = 2};
    CHECK(slv_bake_save(&env, mesh, source, &two, tool_path("no.ptx"), NULL) == SLV_ERROR_ARGUMENT);
    slv_image_free(&image);
    slv_bake_source_destroy(source);
    slv_mesh_destroy(mesh);
    tool_end();
    return test_end();
}
