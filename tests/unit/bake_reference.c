/* The ray-cast reference against closed forms and against itself. */
#include "kit/edge_kit.h"
#include "kit/reference_kit.h"

static const char cube_obj[] =
    "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
    "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

/* One colour stays that colour with any filter and however few the samples. */
static void check_constant(void) {
    const slv_procedural grey = {.color0 = {0.25f, 0.5f, 0.75f, 1},
                                 .color1 = {0.25f, 0.5f, 0.75f, 1}};
    model m = make_model(box_obj, SLV_SCHEME_CATMARK, &grey, 3, 0);
    for (uint32_t samples = 1; samples <= 17; samples += 4) {
        for (int filter = 0; filter < 2; filter++) {
            slv_reference_frame frame = small_frame((slv_pixel_filter)filter, samples);
            frame.shading = SLV_SHADE_UNLIT;
            slv_image image = render(&m, &frame, 0);
            uint32_t inside = 0, outside = 0;
            for (uint32_t y = 3; y + 3 < image.height; y++) {
                for (uint32_t x = 3; x + 3 < image.width; x++) {
                    const float *p = image.pixels + 4 * ((size_t)y * image.width + x);
                    bool around = true;
                    for (int k = -3; k <= 3; k++)
                        around &= fabsf(p[4 * k + 3] - 1) < 1e-6f &&
                                  fabsf(p[4 * k * (int)image.width + 3] - 1) < 1e-6f;
                    outside += p[3] == 0;
                    if (!around)
                        continue;
                    inside++;
                    for (int c = 0; c < 3; c++)
                        CHECK_MSG(fabsf(p[c] - 0.25f * (float)(c + 1)) < 2e-6f,
                                  "filter %d, %u samples: %.7g", filter, samples, (double)p[c]);
                }
            }
            CHECK(inside > 80 && outside > 80);
            slv_image_free(&image);
        }
    }
    free_model(&m);
}

/* Where a ray of the orbit camera meets a cube of side 2: its position, which is its colour. */
static bool cast(const slv_camera *camera, float across, float up, float hit[3]) {
    const float *m = camera->world_to_camera, *w = camera->window;
    float x = w[0] + across * (w[1] - w[0]), y = w[3] - up * (w[3] - w[2]);
    float nearest = -INFINITY, farthest = INFINITY, origin[3], direction[3];
    for (int c = 0; c < 3; c++) {
        float eye[3] = {x - m[3], y - m[7], -m[11]};
        if (camera->perspective)
            eye[0] = -m[3], eye[1] = -m[7];
        origin[c] = m[c] * eye[0] + m[4 + c] * eye[1] + m[8 + c] * eye[2];
        direction[c] = camera->perspective ? m[c] * x + m[4 + c] * y - m[8 + c] : -m[8 + c];
        float a = (-1 - origin[c]) / direction[c], b = (1 - origin[c]) / direction[c];
        nearest = fmaxf(nearest, fminf(a, b));
        farthest = fminf(farthest, fmaxf(a, b));
    }
    for (int c = 0; c < 3; c++)
        hit[c] = origin[c] + nearest * direction[c];
    return farthest > nearest;
}

static void check_positions(void) {
    const slv_procedural position = {.pattern = SLV_PATTERN_POSITION};
    model m = make_model(cube_obj, SLV_SCHEME_BILINEAR, &position, 3, 5);
    for (int perspective = 0; perspective < 2; perspective++) {
        for (int filter = 0; filter < 2; filter++) {
            slv_reference_frame frame = {.camera = look(35, 25, perspective ? 50 : 0),
                                         .width = 64,
                                         .height = 48,
                                         .shading = SLV_SHADE_UNLIT,
                                         .filter = (slv_pixel_filter)filter,
                                         .samples = filter ? 1024 : 256};
            slv_image image = render(&m, &frame, 0);
            uint32_t inside = 0;
            double largest = 0;
            for (uint32_t y = 0; y < frame.height; y++) {
                for (uint32_t x = 0; x < frame.width; x++) {
                    float hit[3], corner[3];
                    int side = -1;
                    bool flat = true;
                    /* all of the filter, and of the texels that it reads, on one side of the cube
                     */
                    for (int k = 0; k < 4; k++) {
                        flat &= cast(&frame.camera, ((float)x + (k & 1 ? 2.5f : -1.5f)) / 64,
                                     ((float)y + (k & 2 ? 2.5f : -1.5f)) / 48, corner);
                        int on = -1;
                        for (int c = 0; c < 3; c++) {
                            if (fabsf(fabsf(corner[c]) - 1) < 1e-5f)
                                on = on < 0 ? 2 * c + (corner[c] > 0) : 6;
                            else
                                flat &= fabsf(corner[c]) < 0.96f;
                        }
                        flat &= on >= 0 && on < 6 && (side < 0 || side == on);
                        side = on;
                    }
                    if (!flat)
                        continue;
                    inside++;
                    cast(&frame.camera, ((float)x + 0.5f) / 64, ((float)y + 0.5f) / 48, hit);
                    for (int c = 0; c < 3; c++)
                        largest = fmax(
                            largest,
                            fabs((double)(hit[c] - image.pixels[4 * (y * 64 + x) + (uint32_t)c])));
                }
            }
            fprintf(stderr, "positions, %s, filter %d: off by %.5f at most, %u pixels\n",
                    perspective ? "perspective" : "orthographic", filter, largest, inside);
            CHECK(inside > 200);
            /* a pixel is 0.05 wide and more here; with perspective its mean lies a little off the
             * middle */
            CHECK_MSG(largest < 0.005, "off by %g", largest);
            slv_image_free(&image);
        }
    }
    free_model(&m);
}

static void check_threads(void) {
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE, .frequency = 3};
    slv_env env = test_env();
    model m = make_model(box_obj, SLV_SCHEME_CATMARK, &noise, 3, 0);
    for (int filter = 0; filter < 2; filter++) {
        slv_reference_frame frame = small_frame((slv_pixel_filter)filter, 10);
        slv_image images[3], errors[3];
        slv_reference_stats stats[3];
        for (uint32_t i = 0; i < 3; i++) {
            env.threads = i ? i + 1 : 1;
            frame.seed = i == 2;
            REQUIRE(slv_reference_render(m.reference, &env, &frame, &images[i], &errors[i],
                                         &stats[i]) == SLV_OK);
        }
        size_t bytes = 45 * 37 * sizeof(float);
        CHECK(images[0].width == 45 && images[0].height == 37 && images[0].nchannels == 4);
        CHECK(errors[0].width == 45 && errors[0].height == 37 && errors[0].nchannels == 1);
        CHECK(!memcmp(images[0].pixels, images[1].pixels, 4 * bytes));
        CHECK(!memcmp(errors[0].pixels, errors[1].pixels, bytes));
        CHECK(!memcmp(&stats[0], &stats[1], sizeof stats[0]));
        CHECK(stats[0].samples == 45 * 37 * 10 && stats[0].ncovered > 300);
        CHECK(stats[0].error > 0 && stats[0].worst >= stats[0].error);
        CHECK(memcmp(images[0].pixels, images[2].pixels, 4 * bytes)); /* another seed */
        for (int i = 0; i < 3; i++) {
            slv_image_free(&images[i]);
            slv_image_free(&errors[i]);
        }
    }
    free_model(&m);
}

static double distance(const slv_image *a, const slv_image *b) {
    double squares = 0;
    size_t npixels = (size_t)a->width * a->height;
    for (size_t i = 0; i < npixels; i++)
        for (size_t c = 0; c < 3; c++)
            squares += pow((double)(a->pixels[4 * i + c] - b->pixels[4 * i + c]), 2);
    return sqrt(squares / 3 / (double)npixels);
}

/* Four times the samples: half the error would be chance, and these do better. What a picture says
 * of itself is what a far better one says of it. */
static void check_convergence(void) {
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE, .frequency = 12, .octaves = 3};
    slv_env env = test_env();
    model m = make_model(box_obj, SLV_SCHEME_CATMARK, &noise, 3, 0);
    for (int filter = 0; filter < 2; filter++) {
        slv_reference_frame frame = small_frame((slv_pixel_filter)filter, 4096);
        slv_image best = render(&m, &frame, 0);
        double before = INFINITY;
        frame.seed = 1;
        for (uint32_t samples = 1; samples <= 256; samples *= 4) {
            slv_image image;
            slv_reference_stats stats;
            frame.samples = samples;
            REQUIRE(slv_reference_render(m.reference, &env, &frame, &image, NULL, &stats) ==
                    SLV_OK);
            double error = distance(&image, &best);
            fprintf(stderr, "filter %d, %4u samples: error %.6f, its own estimate %.6f\n", filter,
                    samples, error, stats.error);
            CHECK_MSG(error < before / 1.8, "%u samples: %g after %g", samples, error, before);
            if (samples == 1)
                CHECK(isnan(stats.error) && isnan(stats.worst));
            else
                CHECK_MSG(stats.error > 0.8 * error && stats.error < 1.25 * error,
                          "%u samples: estimated %g, but %g", samples, stats.error, error);
            before = error;
            slv_image_free(&image);
        }
        CHECK(before < 0.0015);
        slv_image_free(&best);
    }
    free_model(&m);
}

/* A point on an edge has one value, seen from either face. */
static void check_seams(void) {
    const slv_procedural noise = {
        .pattern = SLV_PATTERN_NOISE, .frequency = 5, .octaves = 4, .face_tint = 0.8f};
    for (int log2 = 0; log2 <= 4; log2 += 4) {
        model m = make_model(box_obj, SLV_SCHEME_CATMARK, &noise, 3, log2);
        const slv_res *res = slv_texture_get_desc(m.texture)->res;
        double between = 0, centres = 0;
        uint32_t count = 0;
        for (int32_t face = 0; face < (int32_t)slv_mesh_face_count(m.mesh); face++) {
            for (unsigned edge = 0; edge < 4; edge++) {
                slv_neighbour to[2];
                uint32_t n = slv_adjacency_neighbours(m.adjacency, face, edge, to);
                for (uint32_t k = 0; k < n; k++) {
                    int own = edge & 1 ? res[face].v : res[face].u;
                    int theirs = to[k].edge & 1 ? res[to[k].face].v : res[to[k].face].u;
                    /* texels along the contact, on the finer side */
                    int fine = own;
                    if (to[k].scale > 1)
                        fine = own - 1 > theirs ? own - 1 : theirs;
                    else if (to[k].scale < 1)
                        fine = own > theirs - 1 ? own : theirs - 1;
                    else
                        fine = own > theirs ? own : theirs;
                    uint32_t steps = 1u << fine;
                    for (uint32_t i = 0; i <= 4 * steps; i++) {
                        float t = to[k].t0 + (to[k].t1 - to[k].t0) * (float)i / (float)(4 * steps);
                        slv_surface_point p[2] = {{face, 0, 0}, {to[k].face, 0, 0}};
                        float rgb[6];
                        kit_edge_point_float(edge, t, &p[0].u, &p[0].v);
                        slv_affine_apply(&to[k].map, p[0].u, p[0].v, &p[1].u, &p[1].v);
                        REQUIRE(slv_reference_lookup(m.reference, 2, p, rgb) == SLV_OK);
                        for (int c = 0; c < 3; c++) {
                            double jump = fabs((double)(rgb[c] - rgb[3 + c]));
                            between = fmax(between, jump);
                            if (i % 4 == 2)
                                centres = fmax(centres, jump);
                        }
                        count++;
                    }
                }
            }
        }
        fprintf(stderr, "seams, %s: %.2e at texel centres, %.2e anywhere, %u points\n",
                log2 ? "one resolution" : "mixed resolutions", centres, between, count);
        CHECK(count > 1000);
        CHECK_MSG(centres < 2e-6, "off by %g", centres);
        CHECK_MSG(between < 2e-6, "off by %g", between);
        free_model(&m);
    }
}

struct countdown {
    int calls, left;
    uint64_t done, total;
};

static bool count_down(void *user, uint64_t done, uint64_t total) {
    struct countdown *c = user;
    CHECK(done == c->done + 1 && done <= total);
    c->done = done;
    c->total = total;
    c->calls++;
    return --c->left > 0;
}

static void check_cancel(void) {
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE};
    slv_env env = test_env();
    model m = make_model(box_obj, SLV_SCHEME_CATMARK, &noise, 3, 0);
    struct countdown counter = {.left = 1000};
    slv_reference_frame frame = {.camera = look(30, 20, 35),
                                 .width = 100,
                                 .height = 60,
                                 .samples = 1,
                                 .progress = {count_down, &counter}};
    slv_image image;
    REQUIRE(slv_reference_render(m.reference, &env, &frame, &image, NULL, NULL) == SLV_OK);
    CHECK(counter.calls == 7 * 4 && counter.total == 7 * 4 && counter.done == counter.total);
    slv_image_free(&image);
    for (env.threads = 1; env.threads <= 2; env.threads++) {
        counter = (struct countdown){.left = 3};
        test_last_log[0] = 0;
        CHECK(slv_reference_render(m.reference, &env, &frame, &image, NULL, NULL) ==
              SLV_ERROR_CANCELLED);
        CHECK_MSG(counter.calls == 3, "%d calls", counter.calls);
        CHECK(strstr(test_last_log, "cancelled"));
    }
    free_model(&m);
}

static void refuse(const slv_reference *reference, const slv_reference_frame *frame,
                   slv_result expected, const char *words) {
    slv_env env = test_env();
    slv_image image;
    test_last_log[0] = 0;
    slv_result result = slv_reference_render(reference, &env, frame, &image, NULL, NULL);
    CHECK_MSG(result == expected, "%s: result %d", words, (int)result);
    CHECK_MSG(strstr(test_last_log, words), "no '%s' in '%s'", words, test_last_log);
}

static void check_refusals(void) {
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE};
    slv_env env = test_env();
    model m = make_model(box_obj, SLV_SCHEME_CATMARK, &noise, 2, 0),
          cube = make_model(cube_obj, SLV_SCHEME_CATMARK, &noise, 1, 3);
    const slv_reference_frame good = small_frame(SLV_PIXEL_BOX, 4);
    slv_reference_frame bad = good;
    bad.samples = SLV_REFERENCE_MAX_SAMPLES + 1;
    refuse(m.reference, &bad, SLV_ERROR_ARGUMENT, "samples per pixel");
    bad = good;
    bad.shading = SLV_SHADE_LEVELS;
    refuse(m.reference, &bad, SLV_ERROR_UNSUPPORTED, "levels");
    bad.shading = (slv_shading)9;
    refuse(m.reference, &bad, SLV_ERROR_ARGUMENT, "shading 9");
    bad.shading = SLV_SHADE_IMAGE;
    refuse(m.reference, &bad, SLV_ERROR_ARGUMENT, "has no light");
    bad = good;
    bad.filter = (slv_pixel_filter)7;
    refuse(m.reference, &bad, SLV_ERROR_ARGUMENT, "filter");
    bad = good;
    memset(bad.camera.world_to_camera, 0, sizeof bad.camera.world_to_camera);
    refuse(m.reference, &bad, SLV_ERROR_ARGUMENT, "inverted");
    bad = good;
    bad.camera.window[1] = bad.camera.window[0];
    refuse(m.reference, &bad, SLV_ERROR_ARGUMENT, "window");
    bad = good;
    bad.camera.window[1] = NAN;
    refuse(m.reference, &bad, SLV_ERROR_ARGUMENT, "window");

    static const slv_reference_params params[] = {{.segments = 5},
                                                  {.first_channel = 2},
                                                  {.nchannels = 3},
                                                  {.first_channel = 1, .nchannels = 2}};
    slv_reference *reference = cube.reference;
    for (size_t i = 0; i < 4; i++) {
        test_last_log[0] = 0;
        CHECK(slv_reference_create(&env, m.mesh, m.surface, m.texture, m.adjacency, &params[i],
                                   &reference) == SLV_ERROR_ARGUMENT);
        CHECK(!reference && strstr(test_last_log, i ? "channels" : "segments"));
    }
    CHECK(slv_reference_create(&env, m.mesh, m.surface, cube.texture, m.adjacency, NULL,
                               &reference) == SLV_ERROR_MISMATCH);
    CHECK(!reference && strstr(test_last_log, "faces"));
    env.max_bytes = 4096;
    CHECK(slv_reference_create(&env, m.mesh, m.surface, m.texture, m.adjacency, NULL, &reference) ==
          SLV_ERROR_LIMIT);

    slv_surface_point nowhere = {99, 0, 0};
    float rgb[6];
    CHECK(slv_reference_lookup(m.reference, 1, &nowhere, rgb) == SLV_ERROR_ARGUMENT);
    CHECK(strstr(test_last_log, "face 99"));
    /* one channel is grey, two are red and green; outside is the edge */
    const slv_surface_point points[2] = {{0, 1, 0.5f}, {0, 7, 0.5f}};
    REQUIRE(slv_reference_lookup(cube.reference, 2, points, rgb) == SLV_OK);
    CHECK(rgb[0] == rgb[1] && rgb[1] == rgb[2] && !memcmp(rgb, rgb + 3, 3 * sizeof *rgb));
    REQUIRE(slv_reference_lookup(m.reference, 1, points, rgb) == SLV_OK);
    CHECK(rgb[0] > 0 && rgb[2] == 0);
    slv_reference_destroy(NULL);
    free_model(&m);
    free_model(&cube);
}

/* Nothing to hit is nothing but background. */
static void check_holes(void) {
    slv_env env = test_env();
    static const char obj[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nt hole 1/0/0 0\n";
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE};
    model m = make_model(obj, SLV_SCHEME_BILINEAR, &noise, 3, 2);
    CHECK(slv_mesh_face_is_hole(m.mesh, 0));
    slv_reference_frame frame = small_frame(SLV_PIXEL_MITCHELL, 4);
    slv_reference_stats stats;
    slv_image image;
    frame.background[1] = 0.5f;
    REQUIRE(slv_reference_render(m.reference, &env, &frame, &image, NULL, &stats) == SLV_OK);
    CHECK(stats.ncovered == 0 && stats.error < 1e-7);
    CHECK(fabsf(image.pixels[4 * 800 + 1] - 0.5f) < 1e-6f && image.pixels[4 * 800 + 3] == 0);
    slv_image_free(&image);
    free_model(&m);
}

int main(void) {
    check_constant();
    check_positions();
    check_threads();
    check_convergence();
    check_seams();
    check_cancel();
    check_refusals();
    check_holes();
    return test_end();
}
