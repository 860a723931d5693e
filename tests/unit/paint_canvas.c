/* Paint on canvases: blend modes, types and channels; each texel once; the same bytes with any
 * number of threads; fills, the seam certificate, and what a camera sees inside a disc. */
#include "kit/paint_kit.h"

#include <selvage/threads.h>

/* The formulas again, plainly. */
static double mixed(slv_blend blend, double b, double s) {
    switch (blend) {
    case SLV_BLEND_MULTIPLY:
        return b * s;
    case SLV_BLEND_SCREEN:
        return 1 - (1 - b) * (1 - s);
    case SLV_BLEND_OVERLAY:
        return b > 0.5 ? 1 - 2 * (1 - b) * (1 - s) : 2 * b * s;
    case SLV_BLEND_DARKEN:
        return b < s ? b : s;
    case SLV_BLEND_LIGHTEN:
        return b > s ? b : s;
    case SLV_BLEND_ADD:
        return b + s;
    case SLV_BLEND_SUBTRACT:
        return b - s;
    default:
        return s;
    }
}

static void expect_mixed(slv_blend blend, bool lock, bool erase, const double below[4],
                         const slv_paint *paint, double amount, const float got[4]) {
    double alpha = below[3], want[4] = {below[0], below[1], below[2], alpha};
    double result = lock ? alpha : amount + alpha * (1 - amount);
    if (erase) {
        want[3] = alpha * (1 - amount);
    } else if (blend == SLV_BLEND_REPLACE) {
        for (int c = 0; c < (lock ? 3 : 4); c++)
            want[c] += amount * ((double)paint->color[c] - want[c]);
    } else {
        double luminosity[2] = {0, 0};
        static const double shares[3] = {0.3, 0.59, 0.11};
        for (int c = 0; c < 3; c++) {
            luminosity[0] += shares[c] * below[c];
            luminosity[1] += shares[c] * (double)paint->color[c];
        }
        for (int c = 0; c < 3; c++) {
            double s = (double)paint->color[c], m = mixed(blend, below[c], s);
            if (blend == SLV_BLEND_COLOR)
                m = s + luminosity[0] - luminosity[1];
            want[c] =
                lock ? below[c] + amount * (m - below[c])
                     : (amount * ((1 - alpha) * s + alpha * m) + (1 - amount) * alpha * below[c]) /
                           result;
        }
        want[3] = result;
    }
    for (int c = 0; c < 4; c++)
        CHECK_MSG(fabs(want[c] - (double)got[c]) < 2e-6, "%s, channel %d: %g, not %g",
                  slv_blend_name(blend), c, (double)got[c], want[c]);
}

static void blends(const slv_env *env) {
    uint64_t seed = 5;
    shape p = paint_plane(1, 1);
    paint_scene s = paint_scene_of(env, &p, SLV_SCHEME_BILINEAR, 0, SLV_TYPE_FLOAT, 4, 3);
    for (int i = 0; i < 2000; i++) {
        const float amount = (float)(test_random(&seed) % 1000 + 1) / 1000;
        const slv_patch patch = {0, {0, 0, 1, 1}, &amount, 1};
        const slv_patches patches = {1, &patch, 1};
        slv_paint paint = {.opacity = 0.75f, .blend = (slv_blend)(i % SLV_BLEND_COUNT)};
        float texel[4], got[4];
        double below[4];
        for (int c = 0; c < 4; c++) {
            /* within what a shift of luminosity leaves in range */
            texel[c] = (float)(400 + test_random(&seed) % 200) / 1000;
            paint.color[c] = (float)(400 + test_random(&seed) % 200) / 1000;
            if (paint.blend != SLV_BLEND_COLOR && i % 3)
                texel[c] = (float)(test_random(&seed) % 1000 + 1) / 1000;
            below[c] = (double)texel[c];
        }
        paint.lock_alpha = i / 16 % 2;
        paint.erase = i % 32 == 31;
        MUST(slv_texture_set_constant(s.texture, 0, texel));
        MUST(slv_painter_apply(s.painter, &s.canvas, &patches, &paint));
        slv_texture_fetch(s.texture, 0, 0, 0, got);
        expect_mixed(paint.blend, paint.lock_alpha, paint.erase, below, &paint,
                     0.75 * (double)amount, got);
    }
    paint_scene_end(&s);
}

/* A dab of a quarter's opacity that is added leaves a quarter at most: no texel has it twice, where
 * faces meet or anywhere. */
static void once(const slv_env *env) {
    static const slv_type types[] = {SLV_TYPE_U8, SLV_TYPE_U16, SLV_TYPE_HALF, SLV_TYPE_FLOAT};
    for (int k = 0; k < 4; k++) {
        shape c = shape_cube();
        paint_scene s = paint_scene_of(env, &c, k % 2 ? SLV_SCHEME_CATMARK : SLV_SCHEME_BILINEAR, 6,
                                       types[k], (uint32_t)k + 1, k == 3 ? 1 : SLV_NO_ALPHA);
        slv_patches patches;
        uint64_t covered = 0, painted = 0;
        const slv_dab dab = {.at = {0, 0.9f, 0.97f}, .radius = 1.2f, .hardness = 1};
        const slv_paint paint = {.color = {0.25f, 0.25f, 0.25f, 0.25f},
                                 .opacity = 1,
                                 .blend = k == 3 ? SLV_BLEND_REPLACE : SLV_BLEND_ADD};
        MUST(slv_painter_cover(s.painter, slv_texture_get_desc(s.texture)->res, &dab, &patches));
        CHECK(patches.count >= 3);
        for (uint32_t i = 0; i < patches.count; i++)
            for (uint32_t t = 0; t < patches.list[i].rect.width * patches.list[i].rect.height; t++)
                covered += patches.list[i].coverage[t] > 0.5f;
        MUST(slv_painter_apply(s.painter, &s.canvas, &patches, &paint));
        for (uint32_t face = 0; face < s.nfaces; face++)
            for (uint32_t t = 0; t < 64 * 64; t++) {
                float texel[8];
                slv_texture_fetch(s.texture, face, t % 64, t / 64, texel);
                for (int i = 0; i <= k; i++)
                    CHECK(texel[i] <= 0.2511f);
                painted += texel[0] > 0.13f;
            }
        CHECK_MSG(painted > 2000 && painted + 100 > covered && covered + 100 > painted,
                  "%u painted, %u covered", (unsigned)painted, (unsigned)covered);
        paint_scene_end(&s);
    }
}

/* Large dabs, whose work is shared out. */
static void threads(void) {
    uint64_t sums[2] = {0, 0};
    for (int k = 0; k < 2; k++) {
        slv_env env = test_env();
        slv_threads *pool = NULL;
        env.threads = k ? 4 : 1;
        if (k) {
            MUST(slv_threads_create(&env, &pool));
            slv_threads_use(pool, &env);
        }
        shape p = paint_plane(8, 4);
        paint_scene s = paint_scene_of(&env, &p, SLV_SCHEME_CATMARK, 7, SLV_TYPE_U8, 3, -1);
        uint64_t seed = 9;
        for (int i = 0; i < 60; i++) {
            slv_patches patches;
            const slv_paint paint = {.color = {(float)(i % 7) / 7, (float)(i % 5) / 5, 0.5f},
                                     .opacity = 0.3f,
                                     .blend = (slv_blend)(i % SLV_BLEND_COUNT)};
            const slv_dab dab = {.at = {(int32_t)(test_random(&seed) % 64), 0.3f, 0.6f},
                                 .radius = 0.2f + (float)(test_random(&seed) % 100) / 70,
                                 .hardness = 0.7f,
                                 .aspect = 1 + (float)(i % 3),
                                 .angle = (float)(13 * i)};
            MUST(
                slv_painter_cover(s.painter, slv_texture_get_desc(s.texture)->res, &dab, &patches));
            MUST(slv_painter_apply(s.painter, &s.canvas, &patches, &paint));
        }
        for (uint32_t face = 0; face < s.nfaces; face++) {
            const uint8_t *texels = slv_texture_texels(s.texture, face);
            size_t count = slv_texture_is_constant(s.texture, face) ? 3 : 3 * 128 * 128;
            for (size_t i = 0; i < count; i++)
                sums[k] = sums[k] * 31 + texels[i];
        }
        paint_scene_end(&s);
        slv_threads_destroy(pool);
    }
    CHECK(sums[0] == sums[1] && sums[0] != 0);
}

static void fills_and_seams(const slv_env *env) {
    shape c = shape_cube();
    paint_scene s = paint_scene_of(env, &c, SLV_SCHEME_BILINEAR, 7, SLV_TYPE_U8, 3, -1);
    slv_seam_certificate seams;
    uint8_t selected[6] = {0};
    uint32_t faces = 0;
    const slv_paint paint = {.color = {0.4f, 1, 0}, .opacity = 1};
    MUST(slv_painter_select(s.painter, 2, SLV_SELECT_ANGLE, 80, selected));
    CHECK(selected[2] == 1 && selected[0] + selected[1] + selected[3] + selected[4] == 0);
    MUST(slv_painter_fill(s.painter, &s.canvas, selected, &paint, &faces));
    CHECK(faces == 1 && slv_texture_is_constant(s.texture, 2));
    MUST(slv_seam_certify(env, &s.canvas, slv_paint_surface_adjacency(s.surface), &seams));
    CHECK(fabs(seams.largest - 1) < 1e-6 && seams.channel == 1 && seams.places == 12 * 128);
    MUST(slv_painter_select(s.painter, 0, SLV_SELECT_ANGLE, 95, selected));
    MUST(slv_painter_fill(s.painter, &s.canvas, selected, &paint, &faces));
    CHECK(faces == 6);
    MUST(slv_seam_certify(env, &s.canvas, slv_paint_surface_adjacency(s.surface), &seams));
    CHECK(seams.largest == 0 && seams.face == -1);
    /* soft dabs over edges and corners */
    for (int i = 0; i < 6; i++) {
        slv_patches patches;
        const slv_paint red = {.color = {1, 0, 0}, .opacity = 0.8f};
        const slv_dab dab = {.at = {i, 0.95f, 0.1f * (float)i}, .radius = 0.9f, .hardness = 0.4f};
        MUST(slv_painter_cover(s.painter, slv_texture_get_desc(s.texture)->res, &dab, &patches));
        MUST(slv_painter_apply(s.painter, &s.canvas, &patches, &red));
    }
    MUST(slv_seam_certify(env, &s.canvas, slv_paint_surface_adjacency(s.surface), &seams));
    CHECK_MSG(seams.largest < 4.0 / 255, "%g/255 at face %d edge %u", 255 * seams.largest,
              (int)seams.face, seams.edge);
    paint_scene_end(&s);
}

/* Two canvases fit to each other as well as what each has at the edges; and what nobody sees is no
 * seam. */
static void seams_of_two(const slv_env *env) {
    shape c[3] = {shape_cube(), shape_cube(), shape_cube()};
    paint_scene s = paint_scene_of(env, &c[0], SLV_SCHEME_BILINEAR, 4, SLV_TYPE_FLOAT, 4, 3),
                t = paint_scene_of(env, &c[1], SLV_SCHEME_BILINEAR, 5, SLV_TYPE_FLOAT, 4, 3),
                u = paint_scene_of(env, &c[2], SLV_SCHEME_BILINEAR, 3, SLV_TYPE_FLOAT, 3, -1);
    const slv_adjacency *adjacency = slv_paint_surface_adjacency(s.surface);
    const float grey[4] = {0.5f, 0.5f, 0.5f, 1}, light[4] = {0.75f, 0.5f, 0.5f, 1},
                hidden[4] = {1, 1, 1, 0}, nothing[4] = {0};
    slv_seam_certificate seams, back;
    for (uint32_t f = 0; f < 6; f++) {
        MUST(slv_texture_set_constant(s.texture, f, grey));
        MUST(slv_texture_set_constant(t.texture, f, f == 3 ? light : grey));
    }
    MUST(slv_seam_certify_two(env, &s.canvas, &t.canvas, adjacency, &seams));
    MUST(slv_seam_certify_two(env, &t.canvas, &s.canvas, adjacency, &back));
    CHECK(fabs(seams.largest - 0.25) < 1e-6 && seams.channel == 0 && seams.places == 24 * 32);
    CHECK(back.largest == seams.largest && back.places == seams.places);
    CHECK(fabs(seams.mean - 0.25 * 4 / 24 / 4) < 1e-6);
    for (uint32_t f = 0; f < 6; f++)
        MUST(slv_texture_set_constant(t.texture, f, f % 2 ? hidden : nothing));
    MUST(slv_seam_certify(env, &t.canvas, adjacency, &seams));
    CHECK(seams.largest == 0);
    CHECK(slv_seam_certify_two(env, &s.canvas, &u.canvas, adjacency, &seams) == SLV_ERROR_MISMATCH);
    paint_scene_end(&s);
    paint_scene_end(&t);
    paint_scene_end(&u);
}

/* A step of paint right along an edge is no step once it was blurred, and means stay. */
static void blurs(const slv_env *env) {
    shape p = paint_plane(2, 2);
    paint_scene s = paint_scene_of(env, &p, SLV_SCHEME_BILINEAR, 6, SLV_TYPE_FLOAT, 1, -1);
    slv_seam_certificate seams;
    slv_patches patches;
    const float one = 1;
    double sums[2] = {0, 0};
    MUST(slv_texture_set_constant(s.texture, 0, &one));
    MUST(slv_texture_set_constant(s.texture, 2, &one));
    const slv_dab dab = {.at = paint_below(&s, 1, 1), .radius = 3, .hardness = 1};
    for (int i = 0; i < 2; i++) {
        MUST(slv_painter_cover(s.painter, slv_texture_get_desc(s.texture)->res, &dab, &patches));
        MUST(slv_painter_blur(s.painter, &s.canvas, &patches, 0.2f, 1));
    }
    for (uint32_t face = 0; face < 4; face++)
        for (uint32_t t = 0; t < 64 * 64; t++) {
            float texel;
            slv_texture_fetch(s.texture, face, t % 64, t / 64, &texel);
            sums[face % 2] += (double)texel / (2 * 64 * 64);
        }
    CHECK_MSG(sums[0] < 0.97 && fabs(sums[0] + sums[1] - 1) < 1e-3, "means of %g and %g", sums[0],
              sums[1]);
    MUST(slv_seam_certify(env, &s.canvas, slv_paint_surface_adjacency(s.surface), &seams));
    CHECK_MSG(seams.largest < 2.0 / 255, "edges differ by %g/255", 255 * seams.largest);
    CHECK(slv_painter_blur(s.painter, &s.canvas, &patches, NAN, 1) == SLV_ERROR_ARGUMENT);
    paint_scene_end(&s);
}

/* Two squares, one behind the other, the front one half as wide; and a third that turns away. */
static void seen(const slv_env *env) {
    shape q = {0};
    static const float squares[3][5] = {
        {0, 4, 0, 1, 0}, {0, 2, 1, 1, 0}, {3, 4, 0.5f, -1, 0}}; /* x0, x1, z, winding */
    for (int i = 0; i < 3; i++) {
        const float *s = squares[i];
        int32_t a = shape_vertex(&q, s[0], 0, s[2]), b = shape_vertex(&q, s[1], 0, s[2]),
                c = shape_vertex(&q, s[1], 4, s[2]), d = shape_vertex(&q, s[0], 4, s[2]);
        int32_t up[4] = {a, b, c, d}, down[4] = {a, d, c, b};
        shape_polygon(&q, 4, s[3] > 0 ? up : down);
    }
    paint_scene s = paint_scene_of(env, &q, SLV_SCHEME_BILINEAR, 6, SLV_TYPE_U8, 1, -1);
    slv_screen_dab dab = {.camera = paint_camera(4),
                          .width = 400,
                          .height = 400,
                          .x = 200,
                          .y = 200,
                          .radius = 180,
                          .hardness = 1};
    for (int perspective = 0; perspective < 2; perspective++) {
        slv_patches patches;
        uint32_t wrong = 0, right = 0;
        dab.camera.perspective = perspective;
        if (perspective)
            for (int k = 0; k < 4; k++)
                dab.camera.window[k] /= 5; /* the eye is 5 away from z = 0 */
        MUST(slv_painter_cover_screen(s.painter, slv_texture_get_desc(s.texture)->res, &dab,
                                      &patches));
        for (uint32_t i = 0; i < patches.count; i++) {
            const slv_patch *p = &patches.list[i];
            for (uint32_t y = 0; y < p->rect.height; y++)
                for (uint32_t x = 0; x < p->rect.width; x++) {
                    double at[2] = {(p->rect.x + x + 0.5) / 64, (p->rect.y + y + 0.5) / 64};
                    double wide = p->face == 0 ? 4 : 2, depth = p->face == 1 ? 4.0 / 5 : 1;
                    double px = wide * at[0] - 2, py = 4 * at[1] - 2;
                    if (perspective && p->face == 1)
                        px /= depth, py /= depth;
                    double r = hypot(px, py);
                    float c = p->coverage[y * p->rect.width + x];
                    /* the third one, half a unit above, begins at 1 */
                    double third = perspective ? 5 / 4.5 : 1;
                    bool hidden = p->face == 2 || (p->face == 0 && px < -0.02) ||
                                  (p->face == 0 && px > third + 0.02);
                    bool shown = p->face == 1 || (p->face == 0 && px > 0.02 && px < third - 0.02);
                    wrong += (c > 0 && (hidden || r > 1.83)) || (c < 1 && shown && r < 1.77);
                    right += c > 0;
                }
        }
        CHECK_MSG(wrong == 0 && right > 2000, "perspective %d: %u texels wrong, %u right",
                  perspective, wrong, right);
    }
    paint_scene_end(&s);
}

static void refused(const slv_env *env) {
    shape p = paint_plane(2, 1);
    paint_scene s = paint_scene_of(env, &p, SLV_SCHEME_BILINEAR, 3, SLV_TYPE_U8, 3, -1);
    const slv_res *res = slv_texture_get_desc(s.texture)->res;
    const slv_dab dabs[] = {{.at = {4, 0, 0}, .radius = 1},
                            {.at = {-1, 0, 0}, .radius = 1},
                            {.radius = 0},
                            {.radius = NAN},
                            {.radius = 1, .hardness = 2},
                            {.radius = 1, .aspect = 0.5f},
                            {.radius = 1, .angle = INFINITY},
                            {.at = {0, NAN, 0}, .radius = 1},
                            {.radius = 1, .axis = {NAN, 0, 0}},
                            {.radius = INFINITY}};
    for (size_t i = 0; i < sizeof dabs / sizeof *dabs; i++) {
        slv_patches patches;
        CHECK(slv_painter_cover(s.painter, res, &dabs[i], &patches) == SLV_ERROR_ARGUMENT);
        CHECK(patches.count == 0);
    }
    slv_patches patches;
    const slv_screen_dab blind = {.width = 9, .height = 9, .radius = 1};
    CHECK(slv_painter_cover_screen(s.painter, res, &blind, &patches) == SLV_ERROR_ARGUMENT);
    paint_scene_end(&s);
}

int main(void) {
    slv_env env = test_env();
    blends(&env);
    once(&env);
    threads();
    fills_and_seams(&env);
    seams_of_two(&env);
    blurs(&env);
    seen(&env);
    refused(&env);
    return test_end();
}
