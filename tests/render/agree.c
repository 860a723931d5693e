/* What strategies share: traverse and its plain form draw the same pictures, all but those that
 * have other texels give the same value in the middle of a face, and none ever returns what is not
 * a finite number. */
#include "kit/border_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/gl_renderer.h>

enum { POINTS = 4096 };

static slv_gl *gl;
static int32_t faces[POINTS];
static float uv[2 * POINTS], dx[2 * POINTS], dy[2 * POINTS];
static float values[KIT_STRATEGIES][4 * POINTS];

static float uniform(uint64_t *random) {
    return (float)(test_random(random) % 65536) / 65535;
}

static slv_gl_texture *upload(const kit *k, uint32_t anisotropy, slv_gl_branching branching) {
    slv_env env = test_env();
    slv_gl_texture_params params = {KIT_ALL, .anisotropy = anisotropy, .branching = branching};
    slv_gl_texture *texture = NULL;
    REQUIRE(slv_gl_texture_create(gl, &env, k->texture, k->adjacency, &params, &texture) == SLV_OK);
    return texture;
}

/* Into `values` of a strategy's place in the table. */
static float *look_up(slv_gl_texture *texture, uint32_t s) {
    slv_env env = test_env();
    REQUIRE(slv_gl_texture_lookup(texture, &env, slv_strategy_at(s), POINTS, faces, uv, dx, dy,
                                  values[s]) == SLV_OK);
    return values[s];
}

static uint32_t place_of(const char *name) {
    uint32_t s = 0;
    while (slv_strategy_at(s) != kit_strategy(name))
        s++;
    return s;
}

static void random_footprints(const kit *k, uint64_t *random) {
    for (int i = 0; i < POINTS; i++) {
        uint32_t face = test_random(random) % k->nfaces;
        float angle = 6.2831853f * uniform(random);
        float longest = exp2f(-6 + 10 * uniform(random)), shape = exp2f(-5 * uniform(random));
        float texel[2] = {exp2f(-(float)k->res[face].u), exp2f(-(float)k->res[face].v)};
        faces[i] = (int32_t)face;
        for (int c = 0; c < 2; c++) {
            float at = uniform(random);
            uint32_t where = test_random(random) % 8;
            uv[2 * i + c] = where == 0 ? 0 : where == 1 ? 1 : where == 2 ? at * texel[c] : at;
            dx[2 * i + c] = longest * texel[c] * (c ? sinf(angle) : cosf(angle));
            dy[2 * i + c] = longest * shape * texel[c] * (c ? cosf(angle) : -sinf(angle));
        }
    }
}

/* The mesh with a shape, so that it can be drawn. */
static void place(kit *k, const float *positions) {
    slv_env env = test_env();
    slv_mesh_view view = {.nverts = k->nverts,
                          .positions = positions,
                          .npolys = k->npolys,
                          .poly_sizes = k->sizes,
                          .poly_verts = k->verts};
    slv_mesh_destroy(k->mesh);
    REQUIRE(slv_mesh_create(&env, &view, &k->mesh) == SLV_OK);
}

static void place_grid(kit *k, uint32_t across, float bump, uint64_t *random) {
    static float positions[3 * KIT_VERTS];
    for (uint32_t i = 0; i < k->nverts; i++) {
        positions[3 * i] = (float)(i % across);
        positions[3 * i + 1] = bump * uniform(random);
        positions[3 * i + 2] = (float)(i / across);
    }
    place(k, positions);
}

static void place_cube(kit *k) {
    float positions[24];
    for (int i = 0; i < 24; i++)
        positions[i] = (float)(i / 3 >> i % 3 & 1);
    place(k, positions);
}

static slv_image draw(slv_gl_renderer *renderer, slv_gl_texture *texture, slv_frame frame,
                      const slv_strategy *strategy) {
    slv_env env = test_env();
    slv_image image = {0};
    frame.strategy = strategy;
    REQUIRE(slv_gl_renderer_draw(renderer, &env, texture, &frame, &image, NULL) == SLV_OK);
    return image;
}

static float largest_difference(const float *a, const float *b, size_t count) {
    float largest = 0;
    for (size_t i = 0; i < count; i++)
        largest = fmaxf(largest, isfinite(a[i]) && isfinite(b[i]) ? fabsf(a[i] - b[i]) : INFINITY);
    return largest;
}

/* How much pixels differ from those at their left, summed up. */
static double contrast_of(slv_gl_renderer *renderer, slv_gl_texture *texture, slv_frame frame,
                          const slv_strategy *strategy, float bias) {
    frame.level_bias = bias;
    frame.shading = SLV_SHADE_UNLIT;
    slv_image image = draw(renderer, texture, frame, strategy);
    double sum = 0;
    for (uint32_t i = 4; i < image.width * image.height * 4; i++)
        if (i % 4 == 0 && image.pixels[i + 3] > 0 && image.pixels[i - 1] > 0)
            sum += fabs((double)image.pixels[i] - (double)image.pixels[i - 4]);
    slv_image_free(&image);
    return sum;
}

/* The coarser the levels, the smoother the picture, with every strategy. */
static void check_bias(slv_gl_renderer *renderer, slv_gl_texture *texture, slv_frame frame,
                       const slv_strategy *strategy) {
    static const float biases[] = {0, 1, 2, 12};
    double before = INFINITY, first = 0;
    for (int i = 0; i < 4; i++) {
        double contrast = contrast_of(renderer, texture, frame, strategy, biases[i]);
        CHECK_MSG(contrast < before, "%s: a bias of %g levels: %g after %g", strategy->name,
                  (double)biases[i], contrast, before);
        before = contrast;
        first = i ? first : contrast;
    }
    CHECK_MSG(before < 0.5 * first, "%s: %g of %g left", strategy->name, before, first);
}

/* From close by, from above, and along the ground. */
static const float views[][4] = {{30, 60, 6, 1}, {200, 80, 50, 1}, {45, 3, 25, 1}};

static void check_pictures(const kit *k, slv_gl_texture *const textures[2], const char *name,
                           float most) {
    slv_env env = test_env();
    slv_surface *surface = NULL;
    slv_gl_renderer *renderer = NULL;
    slv_mesh_stats stats;
    float visible = 0;
    REQUIRE(slv_mesh_get_stats(&env, k->mesh, &stats) == SLV_OK);
    REQUIRE(slv_surface_create(&env, k->mesh, NULL, &surface) == SLV_OK);
    REQUIRE(slv_gl_renderer_create(gl, &env, k->mesh, surface, 4, &renderer) == SLV_OK);
    for (size_t v = 0; v < sizeof views / sizeof *views; v++) {
        for (uint32_t msaa = 1; msaa <= 4; msaa *= 4) {
            if (test_skip((uint32_t)v + (msaa > 1), 2))
                continue;
            slv_frame frame = {.width = 96,
                               .height = 64,
                               .msaa = msaa,
                               .float_target = true,
                               .shading = SLV_SHADE_UNLIT,
                               .camera =
                                   slv_camera_orbit(stats.bounds_min, stats.bounds_max, views[v][0],
                                                    views[v][1], views[v][2], 1.5f)};
            slv_image full = draw(renderer, textures[0], frame, kit_strategy("traverse-full"));
            slv_image clamp = draw(renderer, textures[0], frame, kit_strategy("clamp"));
            size_t count = (size_t)96 * 64 * 4;
            for (int t = 0; t < 2; t++) {
                slv_image cheap = draw(renderer, textures[t], frame, kit_strategy("traverse"));
                float apart = largest_difference(full.pixels, cheap.pixels, count);
                CHECK_MSG(apart <= most, "%s view %zu msaa %u %s: traverse is %g off its full form",
                          name, v, msaa, t ? "vectors" : "branches", (double)apart);
                slv_image_free(&cheap);
            }
            visible = fmaxf(visible, largest_difference(full.pixels, clamp.pixels, count));
            slv_image_free(&full);
            slv_image_free(&clamp);
        }
    }
    const slv_frame near = {
        .width = 96,
        .height = 64,
        .camera = slv_camera_orbit(stats.bounds_min, stats.bounds_max, 30, 60, 6, 1.5f)};
    int finest = 0;
    for (uint32_t f = 0; f < k->nfaces; f++)
        finest = finest > k->res[f].u ? finest : k->res[f].u;
    for (uint32_t s = 0; s < slv_strategy_count(); s++)
        /* faces of one texel have no other level */
        if (finest > 0 && !test_skip(s + k->nfaces, 8))
            check_bias(renderer, textures[0], near, slv_strategy_at(s));
    CHECK_MSG(visible > 0.05f, "%s: clamp is only %g off: there are no seams to see", name,
              (double)visible);
    slv_gl_renderer_destroy(renderer);
    slv_surface_destroy(surface);
}

static void check_full(const kit *k, uint32_t anisotropy, const char *name, uint64_t *random) {
    /* a GPU's compiler may contract products differently in two programs */
    float most = slv_gl_get_info(gl)->software ? 0 : 1e-5f;
    slv_gl_texture *textures[2] = {upload(k, anisotropy, SLV_GL_BRANCHING_REAL),
                                   upload(k, anisotropy, SLV_GL_BRANCHING_VECTORS)};
    random_footprints(k, random);
    const float *full = look_up(textures[0], place_of("traverse-full"));
    for (int t = 0; t < 2; t++) {
        float apart =
            largest_difference(full, look_up(textures[t], place_of("traverse")), 4 * POINTS);
        CHECK_MSG(apart <= most, "%s aniso %u %s: lookups of traverse are %g off its full form",
                  name, anisotropy, t ? "vectors" : "branches", (double)apart);
    }
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        static float other[4 * POINTS];
        if (!slv_strategy_at(s)->coverage || slv_strategy_at(s)->comparison)
            continue;
        memcpy(other, look_up(textures[0], s), sizeof other);
        CHECK(largest_difference(other, look_up(textures[1], s), 4 * POINTS) <= most);
    }
    check_pictures(k, textures, name, most);
    slv_gl_texture_destroy(textures[0]);
    slv_gl_texture_destroy(textures[1]);
}

static void check_all_full(uint64_t *random) {
    for (int round = 0; round < 4; round += test_brief() ? 3 : 1) {
        kit k;
        char name[32];
        snprintf(name, sizeof name, "round %d", round);
        if (round % 4 == 3) {
            kit_cube(&k, random);
            place_cube(&k);
        } else {
            kit_grid(&k, 5, 4, false, round % 4 == 2 ? 40 : 0, random, NULL);
            place_grid(&k, 6, round % 4 ? 0.7f : 0, random);
        }
        if (round < 2)
            kit_equal(&k, round ? 0 : 4);
        else
            kit_mixed(&k, 2, random);
        for (uint32_t f = 0; round == 3 && f < k.nfaces; f++)
            k.res[f].v = (int8_t)(1 + test_random(random) % 3);
        kit_noise(&k, (slv_type)(round % 4), 1 + test_random(random) % 4, random);
        check_full(&k, round % 2 ? 16 : 1, name, random);
        kit_free(&k);
    }
}

/* Footprints that end well inside the face, of all shapes. */
static void check_interior(uint64_t *random) {
    kit k;
    kit_grid(&k, 4, 4, false, 0, random, NULL);
    kit_equal(&k, 6);
    kit_noise(&k, SLV_TYPE_U8, 3, random);
    for (uint32_t anisotropy = 1; anisotropy <= 16; anisotropy *= test_effort(1) > 1 ? 4 : 16) {
        if (test_brief() && anisotropy == 1)
            continue;
        slv_gl_texture *texture = upload(&k, anisotropy, SLV_GL_BRANCHING_AUTO);
        random_footprints(&k, random);
        for (int i = 0; i < 2 * POINTS; i++) {
            uv[i] = 0.35f + 0.3f * uv[i];
            dx[i] /= 4; /* four texels at most */
            dy[i] /= 4;
        }
        for (uint32_t s = 0; s < slv_strategy_count(); s++)
            look_up(texture, s);
        for (uint32_t s = 1; s < slv_strategy_count(); s++) {
            for (uint32_t t = 0; t < s; t++) {
                const slv_strategy *a = slv_strategy_at(s), *b = slv_strategy_at(t);
                float apart = largest_difference(values[s], values[t], 4 * POINTS);
                CHECK_MSG(apart <= 2.0f / 255 || a->resampled || b->resampled,
                          "aniso %u: %s and %s are %g apart inside faces", anisotropy, a->name,
                          b->name, (double)apart);
            }
        }
        slv_gl_texture_destroy(texture);
    }
    kit_free(&k);
}

static void extreme_texels(kit *k, slv_type type, float high, uint32_t nchannels,
                           uint64_t *random) {
    kit_begin_texture(k, type, nchannels);
    for (uint32_t f = 0; f < k->nfaces; f++) {
        size_t count = kit_texels(k->res[f]) * nchannels;
        float *texels = malloc(count * sizeof *texels);
        REQUIRE(texels);
        for (size_t i = 0; i < count; i++)
            texels[i] = test_random(random) % 3 ? high : test_random(random) % 2 ? -high : 0;
        kit_set(k, f, texels);
        free(texels);
    }
    kit_end_texture(k);
}

static void extreme_footprints(const kit *k, uint64_t *random) {
    static const float odd[] = {0, 1e-30f, 1e-6f, 1, -1, 100, 1e8f, -1e20f, 3e38f, INFINITY, NAN};
    random_footprints(k, random);
    for (int i = 0; i < 2 * POINTS; i++) {
        const uint32_t nodd = sizeof odd / sizeof *odd;
        if (test_random(random) % 2)
            dx[i] = odd[test_random(random) % nodd];
        if (test_random(random) % 2)
            dy[i] = odd[test_random(random) % nodd];
        if (test_random(random) % 4 == 0)
            uv[i] = odd[test_random(random) % nodd];
    }
}

static void check_finite_picture(const kit *k, slv_gl_texture *texture, uint32_t msaa,
                                 const char *name) {
    slv_env env = test_env();
    slv_surface *surface = NULL;
    slv_gl_renderer *renderer = NULL;
    const float low[3] = {0, 0, 0}, high[3] = {5, 1, 4};
    REQUIRE(slv_surface_create(&env, k->mesh, NULL, &surface) == SLV_OK);
    REQUIRE(slv_gl_renderer_create(gl, &env, k->mesh, surface, 4, &renderer) == SLV_OK);
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        slv_frame frame = {.width = 80,
                           .height = 60,
                           .msaa = msaa,
                           .float_target = true,
                           .camera = slv_camera_orbit(low, high, 20, 4, 40, 4.0f / 3)};
        slv_image image = draw(renderer, texture, frame, slv_strategy_at(s));
        uint32_t wrong = 0, covered = 0;
        for (uint32_t i = 0; i < 80 * 60 * 4; i++) {
            wrong += !isfinite(image.pixels[i]);
            covered += i % 4 == 3 && image.pixels[i] > 0;
        }
        CHECK_MSG(wrong == 0, "%s %s: %u values of a picture are not finite", name,
                  slv_strategy_at(s)->name, wrong);
        CHECK(covered > 200);
        slv_image_free(&image);
    }
    slv_gl_renderer_destroy(renderer);
    slv_surface_destroy(surface);
}

static void check_finite(uint64_t *random) {
    uint32_t most_msaa = slv_gl_get_info(gl)->max_msaa < 4 ? slv_gl_get_info(gl)->max_msaa : 4;
    for (int round = 0; round < 6; round++) {
        if (test_brief() && round != 0 && round != 1 && round != 5)
            continue;
        kit k;
        char name[64];
        slv_type type = round % 2 ? SLV_TYPE_FLOAT : SLV_TYPE_HALF;
        /* the largest half, a float that sums leave finite, and nearly the largest one */
        float high = type == SLV_TYPE_HALF ? 65504 : round == 1 ? 1e30f : 3e38f;
        uint32_t anisotropy = round % 3 == 0 ? 1 : round % 3 == 1 ? 4 : 16;
        kit_grid(&k, 5, 4, false, round % 4 == 1 ? 30 : 0, random, NULL);
        /* with a height of zero every other time, triangles degenerate at the horizon */
        place_grid(&k, 6, round % 2 ? 0.9f : 0, random);
        if (round % 3 == 2)
            kit_mixed(&k, 0, random);
        else
            kit_mixed(&k, 1, random);
        extreme_texels(&k, type, high, 1 + (uint32_t)round % 4, random);
        snprintf(name, sizeof name, "%s %g %u channels aniso %u", slv_type_name(type), (double)high,
                 k.nchannels, anisotropy);
        for (int b = 0; b < 2; b++) {
            /* compiling the programs is what takes time */
            if (test_effort(1) == 1 && b == round / 2 % 2)
                continue;
            slv_gl_texture *texture =
                upload(&k, anisotropy, b ? SLV_GL_BRANCHING_VECTORS : SLV_GL_BRANCHING_REAL);
            extreme_footprints(&k, random);
            for (uint32_t s = 0; s < slv_strategy_count(); s++) {
                int wrong = -1;
                if (test_skip(s + (uint32_t)round, 2))
                    continue;
                look_up(texture, s);
                for (int i = 0; i < 4 * POINTS; i++)
                    wrong = isfinite(values[s][i]) ? wrong : i / 4;
                CHECK_MSG(wrong < 0, "%s %s: not finite at %g %g with %g %g, %g %g of a face %dx%d",
                          name, slv_strategy_at(s)->name, (double)uv[2 * wrong],
                          (double)uv[2 * wrong + 1], (double)dx[2 * wrong],
                          (double)dx[2 * wrong + 1], (double)dy[2 * wrong],
                          (double)dy[2 * wrong + 1], 1 << k.res[faces[wrong]].u,
                          1 << k.res[faces[wrong]].v);
                /* what is finite because it was cut must not be cut by much */
                float largest = 0;
                for (int i = 0; i < 4 * POINTS; i++)
                    largest = fmaxf(largest, fabsf(values[s][i]));
                CHECK_MSG(largest > 0.9f * high, "%s %s: at most %g", name,
                          slv_strategy_at(s)->name, (double)largest);
            }
            if (test_effort(1) > 1 || round % 3 == 2 || round == 1)
                /* the driver's own mean of samples sums them */
                check_finite_picture(&k, texture, high > 1e37f ? 1 : most_msaa, name);
            slv_gl_texture_destroy(texture);
        }
        kit_free(&k);
    }
}

int main(void) {
    uint64_t random = 11;
    slv_env env = test_env();
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    check_all_full(&random);
    check_interior(&random);
    check_finite(&random);
    slv_gl_destroy(gl);
    return test_end();
}
