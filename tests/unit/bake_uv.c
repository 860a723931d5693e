/* UV images on faces: the mean over each texel, whatever its polygon, seams and tiles; misses by
 * cause; and the same bytes for any number of threads and blocks. */
#include "kit/uv_kit.h"

#include <selvage/reference.h>

#include <float.h>

/* What is linear in texture coordinates comes out exactly: the mean of a texel is what lies at its
 * middle. */
static void linear(void) {
    slv_env env = test_env();
    slv_mesh *mesh = uv_parse(uv_obj);
    slv_bake_source *source = NULL;
    float *corners = NULL, values[32 * 16 * 3];
    uint8_t misses[32 * 16];
    uv_write_image("ramp.exr", 64, 48, 3, uv_ramp, &uv_floats);
    MUST(slv_mesh_face_texcoords(&env, mesh, &corners));
    MUST(slv_bake_from_uv(&env, mesh, tool_path("ramp.exr"), NULL, &source));
    const slv_bake_source_desc *desc = slv_bake_source_get_desc(source);
    CHECK(desc->type == SLV_TYPE_FLOAT && desc->nchannels == 3 && desc->alpha_channel < 0 &&
          desc->encoding == SLV_TEXTURE_LINEAR);
    for (uint32_t face = 0; face < UV_FACES; face++)
        for (int8_t size = 0; size < 5; size++) {
            const slv_res res = {(int8_t)(size + (size > 0)), size > 0 ? (int8_t)(size - 1) : 0};
            const slv_rect rect = {0, 0, 1u << res.u, 1u << res.v};
            MUST(slv_bake_evaluate(source, &env, face, res, rect, values, misses));
            for (uint32_t i = 0; i < rect.width * rect.height; i++) {
                float uv[2];
                CHECK(misses[i] == (face == UV_BARE ? SLV_BAKE_NO_UV : SLV_BAKE_HIT));
                uv_of_face(corners, face, ((float)(i % rect.width) + 0.5f) / (float)rect.width,
                           ((float)(i / rect.width) + 0.5f) / (float)rect.height, uv);
                for (uint32_t c = 0; c < 3; c++) {
                    float want = face == UV_BARE ? 0 : uv_ramp(c, uv[0], uv[1]),
                          got = values[3 * i + c];
                    CHECK_MSG(fabsf(got - want) < 1e-4f, "face %u texel %u: %g, not %g", face, i,
                              (double)got, (double)want);
                }
            }
        }
    slv_free(corners);
    slv_bake_source_destroy(source);
    slv_mesh_destroy(mesh);
}

/* The sub-faces of a pentagon and their neighbours have the same coordinates where they meet. */
static void sub_faces(void) {
    slv_env env = test_env();
    slv_mesh *mesh = uv_parse(uv_obj);
    float *corners = NULL;
    MUST(slv_mesh_face_texcoords(&env, mesh, &corners));
    CHECK(isnan(corners[8 * UV_BARE]) && !isnan(corners[8 * UV_TRIANGLE]));
    for (uint32_t k = 0; k < 5; k++) {
        const float *own = corners + 8 * (UV_PENTAGON + k),
                    *next = corners + 8 * (UV_PENTAGON + (k + 1) % 5);
        CHECK(own[2] == next[6] && own[3] == next[7]); /* the middle of the side between */
        CHECK(own[4] == next[4] && own[5] == next[5]); /* the centre */
    }
    slv_free(corners);
    slv_mesh_destroy(mesh);
}

static uint32_t noise_seed;
static float noise(uint32_t channel, float u, float v) {
    uint64_t state =
        (uint64_t)(u * 4096) * 7919 + (uint64_t)(v * 4096) * 104729 + channel + noise_seed;
    test_random(&state);
    return (float)(test_random(&state) % 256) / 255;
}

/* One pixel as light, multiplied by alpha. */
static void light_at(const slv_image *image, int32_t x, int32_t y, double out[4]) {
    uint32_t n = image->nchannels;
    float pixel[4];
    x = x < 0 ? 0 : x >= (int32_t)image->width ? (int32_t)image->width - 1 : x;
    y = y < 0 ? 0 : y >= (int32_t)image->height ? (int32_t)image->height - 1 : y;
    memcpy(pixel, image->pixels + ((size_t)y * image->width + (size_t)x) * n, n * sizeof *pixel);
    if (image->encoding == SLV_TEXTURE_SRGB)
        slv_texels_decode(n, n == 4 ? 3 : SLV_NO_ALPHA, pixel, 1);
    for (uint32_t c = 0; c < n; c++)
        out[c] = (double)pixel[c] * (n == 4 && c < 3 ? (double)pixel[3] : 1);
}

static void bilinear(const slv_image *image, double u, double v, double out[4]) {
    double x = u * image->width - 0.5, y = (1 - v) * image->height - 0.5;
    int32_t left = (int32_t)floor(x), top = (int32_t)floor(y);
    double fx = x - left, fy = y - top;
    for (uint32_t c = 0; c < 4; c++)
        out[c] = 0;
    for (int k = 0; k < 4; k++) {
        double pixel[4], weight = (k & 1 ? fx : 1 - fx) * (k >> 1 ? fy : 1 - fy);
        light_at(image, left + (k & 1), top + (k >> 1), pixel);
        for (uint32_t c = 0; c < image->nchannels; c++)
            out[c] += weight * pixel[c];
    }
}

/* The mean of a texel by far more samples: it is approached, and noise of one pixel, than which
 * nothing is harder, averages out where texels are large. */
static void means(uint32_t n) {
    enum { MANY = 40 };
    slv_env env = test_env();
    slv_mesh *mesh = uv_parse(uv_obj);
    slv_bake_source *source = NULL;
    slv_image image;
    float *corners = NULL, values[16 * 16 * 4];
    uint8_t misses[16 * 16];
    uv_write_image("noise.png", 61, 67, n, noise, &uv_raw);
    MUST(slv_image_load(&env, tool_path("noise.png"), &image));
    CHECK(image.type == SLV_TYPE_U8);
    MUST(slv_mesh_face_texcoords(&env, mesh, &corners));
    MUST(slv_bake_from_uv(&env, mesh, tool_path("noise.png"), NULL, &source));
    for (uint32_t face = 0; face < UV_BARE; face++)
        for (int8_t size = 0; size < 5; size++) {
            const slv_rect rect = {0, 0, 1u << size, 1u << size};
            double worst = 0;
            MUST(
                slv_bake_evaluate(source, &env, face, (slv_res){size, size}, rect, values, misses));
            for (uint32_t i = 0; i < rect.width * rect.height; i += 1 + (uint32_t)size) {
                double sum[4] = {0}, one[4];
                for (int k = 0; k < MANY * MANY; k++) {
                    float uv[2];
                    uv_of_face(corners, face,
                               ((float)(i % rect.width) + ((float)(k % MANY) + 0.5f) / MANY) /
                                   (float)rect.width,
                               ((float)(i / rect.width) + ((float)k / MANY) / MANY) /
                                   (float)rect.height,
                               uv);
                    bilinear(&image, (double)uv[0], (double)uv[1], one);
                    for (uint32_t c = 0; c < n; c++)
                        sum[c] += one[c] / (MANY * MANY);
                }
                for (uint32_t c = 0; c < n; c++) {
                    double want = n == 4 && c < 3 ? sum[c] / sum[3] : sum[c];
                    worst = fmax(worst, fabs(want - (double)values[i * n + c]));
                }
            }
            CHECK_MSG(worst < (size < 2   ? 0.01
                               : size < 3 ? 0.03
                                          : 0.1),
                      "face %u size %d: %g", face, size, worst);
        }
    slv_image_free(&image);
    slv_free(corners);
    slv_bake_source_destroy(source);
    slv_mesh_destroy(mesh);
}

/* ---- tiles ---- */

static float constant_value;
static float constant(uint32_t channel, float u, float v) {
    (void)u;
    (void)v;
    return constant_value + (float)channel;
}

/* A strip of three quads along u: the first ends on the border of a tile, where the second goes on
 * with the same coordinates; the third crosses the next border into a tile that is not there. */
static const char strip[] = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
                            "v 3 1 0\n"
                            "vt 0 0\nvt 1 0\nvt 1.5 0\nvt 2.5 0\nvt 0 1\nvt 1 1\nvt 1.5 1\n"
                            "vt 2.5 1\n"
                            "f 1/1 2/2 6/6 5/5\nf 2/2 3/3 7/7 6/6\nf 3/3 4/4 8/8 7/7\n";
/* The same, but that the second lies on its own in the second tile. */
static const char apart[] = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
                            "v 3 1 0\n"
                            "vt 0 0\nvt 1 0\nvt 0 1\nvt 1 1\nvt 1.1 0\nvt 1.5 0\nvt 1.5 1\n"
                            "vt 1.1 1\n"
                            "f 1/1 2/2 6/4 5/3\nf 2/5 3/6 7/7 6/8\n";

static void tiles(void) {
    slv_env env = test_env();
    slv_mesh *mesh = uv_parse(strip), *lone = uv_parse(apart);
    slv_bake_source *source = NULL;
    float values[16 * 4];
    uint8_t misses[16 * 4];
    uint32_t count = 0;
    constant_value = 10;
    uv_write_image("t.1001.exr", 4, 4, 1, constant, &uv_floats);
    constant_value = 20;
    uv_write_image("t.1002.exr", 8, 8, 1, constant, &uv_floats);
    MUST(slv_bake_from_uv(&env, mesh, tool_path("t.<UDIM>.exr"), NULL, &source));
    CHECK_MSG(strstr(test_last_log, "1 of 3") && strstr(test_last_log, "1003"), "%s",
              test_last_log);
    const slv_bake_tile *list = slv_bake_source_tiles(source, &count);
    REQUIRE(count == 3);
    CHECK(list[0].number == 1001 && list[0].width == 4 && list[0].faces == 1);
    CHECK(list[1].number == 1002 && list[1].width == 8 && list[1].faces == 2);
    CHECK(list[2].number == 1003 && list[2].width == 0 && list[2].faces == 1);
    const slv_rect row = {0, 0, 16, 4};
    /* the last texel of the first face is half a pixel of 1001 into the border: it takes from 1002
     */
    MUST(slv_bake_evaluate(source, &env, 0, (slv_res){4, 2}, row, values, misses));
    CHECK(values[0] == 10 && values[12] == 10 && values[15] > 10.5f && values[15] < 15.5f);
    MUST(slv_bake_evaluate(source, &env, 1, (slv_res){4, 2}, row, values, misses));
    CHECK(values[0] > 14 && values[0] < 20 && values[8] == 20);
    /* half of the third face is missing */
    MUST(slv_bake_evaluate(source, &env, 2, (slv_res){4, 2}, row, values, misses));
    for (int x = 0; x < 16; x++)
        CHECK_MSG(misses[x] == (x < 8 ? SLV_BAKE_HIT : SLV_BAKE_NO_TILE) &&
                      values[x] == (x < 8 ? 20 : 0),
                  "texel %d: %d, %g", x, misses[x], (double)values[x]);
    slv_bake_source_destroy(source);
    /* where the mesh does not go on, nothing comes from the next tile */
    MUST(slv_bake_from_uv(&env, lone, tool_path("t.<UDIM>.exr"), NULL, &source));
    MUST(slv_bake_evaluate(source, &env, 0, (slv_res){4, 2}, row, values, misses));
    for (int i = 0; i < 64; i++)
        CHECK(values[i] == 10);
    slv_bake_source_destroy(source);
    slv_bake_source *none = NULL;
    CHECK_MSG(slv_bake_from_uv(&env, mesh, tool_path("x.<UDIM>.exr"), NULL, &none) ==
                      SLV_ERROR_IO &&
                  !none && strstr(test_last_log, "1001, 1002, 1003"),
              "%s", test_last_log);
    slv_mesh_destroy(mesh);
    slv_mesh_destroy(lone);
}

static void wraps(void) {
    slv_env env = test_env();
    slv_mesh *mesh = uv_parse("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 2 0\nvt 2 1\nvt 0 1\n"
                              "f 1/1 2/2 3/3 4/4\n");
    float values[8 * 8];
    uint8_t misses[8 * 8];
    uv_write_image("r.exr", 4, 4, 1, uv_ramp, &uv_floats);
    static const slv_bake_wrap kinds[] = {SLV_BAKE_WRAP_AUTO, SLV_BAKE_WRAP_REPEAT,
                                          SLV_BAKE_WRAP_CLAMP, SLV_BAKE_WRAP_NONE};
    for (int k = 0; k < 4; k++) {
        const slv_bake_uv params = {.wrap = kinds[k]};
        slv_bake_source *source = NULL;
        test_last_log[0] = 0;
        MUST(slv_bake_from_uv(&env, mesh, tool_path("r.exr"), &params, &source));
        CHECK((strstr(test_last_log, "leave 0..1") != NULL) == (k == 0));
        const slv_rect rect = {0, 0, 8, 8};
        MUST(slv_bake_evaluate(source, &env, 0, (slv_res){3, 3}, rect, values, misses));
        bool repeats = k < 2;
        CHECK_MSG(misses[7] == (k == 3 ? SLV_BAKE_NO_TILE : SLV_BAKE_HIT), "%d", k);
        CHECK_MSG(k == 3 || fabsf(values[6] - (repeats ? values[2] : 0.875f)) < 1e-5f, "%d: %g", k,
                  (double)values[6]);
        slv_bake_source_destroy(source);
    }
    slv_mesh_destroy(mesh);
}

/* ---- files ---- */

static void threads_and_blocks(void) {
    slv_env env = test_env();
    slv_mesh *mesh = uv_parse(uv_obj);
    slv_bake_source *source = NULL;
    slv_bake_report report;
    uv_write_image("four.png", 300, 200, 4, noise, &uv_raw);
    MUST(slv_bake_from_uv(&env, mesh, tool_path("four.png"), NULL, &source));
    for (uint32_t threads = 1; threads < 5; threads++) {
        slv_bake_job job = {.match = 1.7f, .memory = threads < 3 ? 0 : 1 << 10};
        env.threads = threads;
        MUST(slv_bake_save(&env, mesh, source, &job, tool_path("b.ptx"), &report));
        CHECK(report.texels > 10000 && report.faces == UV_FACES && report.constant_faces >= 1);
        CHECK(report.misses[SLV_BAKE_NO_UV] == 4 && report.type == SLV_TYPE_U8);
        CHECK(report.misses[SLV_BAKE_HIT] == report.texels - 4);
        if (threads == 1)
            CHECK(rename(tool_path("b.ptx"), tool_path("a.ptx")) == 0);
        else
            CHECK_MSG(uv_same_files("a.ptx", "b.ptx"), "%u threads", threads);
    }
    slv_bake_source_destroy(source);
    slv_mesh_destroy(mesh);
}

static float with_nan(uint32_t channel, float u, float v) {
    (void)channel;
    return u > 0.25f && v > 0.25f ? NAN : 7;
}

/* Pixels that are no numbers are left out of means; texels of nothing else are told, and have what
 * is next to them, so that reductions stay whole. */
static void not_numbers(void) {
    slv_env env = test_env();
    slv_mesh *mesh = uv_parse(uv_obj);
    slv_bake_source *source = NULL;
    slv_bake_report report;
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL;
    uv_write_image("nan.exr", 32, 32, 1, with_nan, &uv_floats);
    MUST(slv_bake_from_uv(&env, mesh, tool_path("nan.exr"), NULL, &source));
    const slv_bake_job job = {.uniform = true, .res = {4, 4}, .miss_map = tool_path("map.ptx")};
    MUST(slv_bake_save(&env, mesh, source, &job, tool_path("nan.ptx"), &report));
    CHECK(report.misses[SLV_BAKE_NAN] > 100 && report.misses[SLV_BAKE_NO_UV] == 256);
    MUST(slv_ptx_open(&env, tool_path("nan.ptx"), &ptx));
    MUST(slv_ptx_load_texture(&env, ptx, &texture));
    for (uint32_t i = 0; i < 256; i++) {
        float value;
        slv_texture_fetch(texture, 0, i % 16, i / 16, &value);
        CHECK(value == 7);
    }
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
    /* the map has a colour for each */
    uint64_t counts[SLV_BAKE_MISSES] = {0};
    MUST(slv_ptx_open(&env, tool_path("map.ptx"), &ptx));
    MUST(slv_ptx_load_texture(&env, ptx, &texture));
    for (uint32_t face = 0; face < UV_FACES; face++) {
        slv_res res = slv_texture_get_desc(texture)->res[face];
        for (uint32_t i = 0; i < 1u << (res.u + res.v); i++) {
            float value[3], color[3];
            slv_texture_fetch(texture, face, i & ((1u << res.u) - 1), i >> res.u, value);
            for (int miss = 0; miss < SLV_BAKE_MISSES; miss++) {
                slv_bake_miss_color((slv_bake_miss)miss, color);
                counts[miss] += fabsf(color[0] - value[0]) < 0.01f &&
                                fabsf(color[1] - value[1]) < 0.01f &&
                                fabsf(color[2] - value[2]) < 0.01f;
            }
        }
    }
    for (int miss = 0; miss < SLV_BAKE_MISSES; miss++)
        CHECK(counts[miss] == report.misses[miss]);
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
    slv_bake_source_destroy(source);
    slv_mesh_destroy(mesh);
}

/* ---- Spot ---- */

enum { SHOT = 384, SHOT_GRID = 4 }; /* pixels a side, samples of one along each axis */

/* What a pixel shows of the texture and of the image, by the same samples: the sum of squared
 * differences of the three encoded channels. */
static double pixel_error(const slv_reference *reference, const slv_image *image,
                          const float *corners, const slv_reference_hit *hit) {
    enum { COUNT = SHOT_GRID * SHOT_GRID };
    slv_surface_point points[COUNT];
    float rgb[COUNT * 3], mean[2][3] = {{0}};
    double sum = 0;
    for (int k = 0; k < COUNT; k++) {
        float a = ((float)(k % SHOT_GRID) + 0.5f) / SHOT_GRID - 0.5f,
              b = ((float)(k / SHOT_GRID) + 0.5f) / SHOT_GRID - 0.5f;
        float u = hit->u + a * hit->du[0] + b * hit->du[1],
              v = hit->v + a * hit->dv[0] + b * hit->dv[1];
        points[k] = (slv_surface_point){hit->face, fminf(fmaxf(u, 0), 1), fminf(fmaxf(v, 0), 1)};
    }
    MUST(slv_reference_lookup(reference, COUNT, points, rgb));
    for (int k = 0; k < COUNT; k++) {
        float uv[2];
        double light[4];
        uv_of_face(corners, (uint32_t)hit->face, points[k].u, points[k].v, uv);
        bilinear(image, (double)uv[0] - floor((double)uv[0]), (double)uv[1], light);
        for (int c = 0; c < 3; c++) {
            mean[0][c] += rgb[3 * k + c] / COUNT;
            mean[1][c] += (float)light[c] / COUNT;
        }
    }
    slv_texels_encode(3, SLV_NO_ALPHA, mean[0], 2);
    for (int c = 0; c < 3; c++)
        sum +=
            ((double)mean[0][c] - (double)mean[1][c]) * ((double)mean[0][c] - (double)mean[1][c]);
    return sum;
}

/* The cow drawn with the texture that was baked, as the border strategy interpolates it, and with
 * the image itself, from three sides. */
static void look_around(const slv_mesh *mesh, const slv_reference *reference,
                        const slv_image *image, const float *corners) {
    slv_env env = test_env();
    float low[3] = {FLT_MAX, FLT_MAX, FLT_MAX}, high[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    slv_reference_hit *hits = calloc(SHOT * SHOT, sizeof *hits);
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    for (uint32_t i = 0; i < 3 * view->nverts; i++) {
        low[i % 3] = fminf(low[i % 3], view->positions[i]);
        high[i % 3] = fmaxf(high[i % 3], view->positions[i]);
    }
    for (int turn = 0; turn < 3; turn++) {
        slv_camera camera = slv_camera_orbit(low, high, 35 + 120 * (float)turn, 15, 14, 1);
        double sum = 0;
        uint64_t count = 0;
        MUST(slv_reference_trace(reference, &env, &camera, SHOT, SHOT, hits));
        for (uint32_t i = 0; i < SHOT * SHOT; i++)
            if (hits[i].face >= 0) {
                sum += pixel_error(reference, image, corners, &hits[i]);
                count++;
            }
        double decibels = -10 * log10(sum / (3 * (double)count));
        fprintf(stderr, "spot, view %d: %.2f dB over %llu pixels\n", turn, decibels,
                (unsigned long long)count);
        CHECK_MSG(decibels >= 34 && count > 20000, "%.2f dB over %llu", decibels,
                  (unsigned long long)count);
    }
    free(hits);
}

static void spot(const char *samples) {
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    slv_bake_source *source = NULL;
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL;
    slv_reference *reference = NULL;
    slv_image image;
    float *corners = NULL;
    char path[1024];
    snprintf(path, sizeof path, "%s/spot/spot_control_mesh.obj", samples);
    MUST(slv_mesh_load(&env, path, &mesh));
    snprintf(path, sizeof path, "%s/spot/spot_texture.png", samples);
    MUST(slv_image_load(&env, path, &image));
    MUST(slv_bake_from_uv(&env, mesh, path, NULL, &source));
    MUST(slv_bake_save(&env, mesh, source, NULL, tool_path("spot.ptx"), NULL));
    MUST(slv_ptx_open(&env, tool_path("spot.ptx"), &ptx));
    MUST(slv_ptx_load_texture(&env, ptx, &texture));
    MUST(slv_mesh_adjacency(&env, mesh, &adjacency));
    MUST(slv_surface_create(&env, mesh, NULL, &surface));
    MUST(slv_mesh_face_texcoords(&env, mesh, &corners));
    MUST(slv_reference_create(&env, mesh, surface, texture, adjacency, NULL, &reference));
    look_around(mesh, reference, &image, corners);
    slv_free(corners);
    slv_image_free(&image);
    slv_reference_destroy(reference);
    slv_texture_destroy(texture);
    slv_ptx_close(ptx);
    slv_bake_source_destroy(source);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
}

int main(void) {
    const char *samples = getenv("SELVAGE_SAMPLES");
    tool_begin();
    sub_faces();
    linear();
    means(1);
    means(3);
    means(4);
    tiles();
    wraps();
    threads_and_blocks();
    not_numbers();
    if (samples)
        spot(samples);
    tool_end();
    return test_end();
}
