/* Strokes: dabs do not depend on how often a pen is asked, brushes of MyPaint load and paint, and
 * places in a picture, mirrors and taps lead where they should. */
#include "kit/paint_kit.h"

#include <dirent.h>
#include <sys/stat.h>

#define RADIUS 0.15f

/* The dabs of a stroke. */
typedef struct record {
    const paint_scene *scene;
    double (*at)[3]; /* x, y, radius */
    uint32_t count, room;
} record;

static slv_result note(void *user, const slv_stroke_dab *dab) {
    record *r = user;
    float p[3] = {0};
    if (r->count == r->room) {
        r->room = 2 * r->room + 64;
        r->at = realloc(r->at, r->room * sizeof *r->at);
        REQUIRE(r->at);
    }
    CHECK(dab->on_screen || slv_paint_surface_at(r->scene->surface, dab->dab.at, p, NULL, NULL));
    r->at[r->count][0] = (double)p[0];
    r->at[r->count][1] = (double)p[1];
    r->at[r->count++][2] = (double)dab->dab.radius;
    return SLV_OK;
}

/* A figure in the square from 0 to 4 within two seconds. */
static void figure(double t, double *x, double *y) {
    *x = 2 + 1.5 * sin(2.2 * t);
    *y = 2 + 1.4 * sin(3.1 * t + 0.4);
}

static record stroke_at(paint_scene *s, const slv_brush *brush, double rate, bool in_picture) {
    record r = {.scene = s};
    slv_stroke_params params = {.brush = brush,
                                .paint = {.color = {1, 0.5f, 0.25f}, .opacity = 0.8f},
                                .radius = in_picture ? RADIUS * 250 : RADIUS,
                                .unit = in_picture ? SLV_SIZE_PIXELS : SLV_SIZE_WORLD,
                                .in_picture = in_picture,
                                .camera = paint_camera(4),
                                .width = 1000,
                                .height = 1000,
                                .each = note,
                                .user = &r};
    slv_stroke *stroke = NULL;
    slv_stroke_stats stats;
    MUST(slv_stroke_begin(s->painter, &s->canvas, &params, &stroke));
    int count = (int)(2 * rate);
    for (int i = 0; i <= count; i++) {
        double t = (double)i / rate, x, y;
        figure(t, &x, &y);
        slv_stroke_sample sample = {.pressure = 0.7f, .time = t};
        if (in_picture) {
            sample.x = (float)(x * 250);
            sample.y = (float)((4 - y) * 250);
        } else {
            sample.at = paint_below(s, x, y);
        }
        MUST(slv_stroke_add(stroke, &sample, 1));
    }
    MUST(slv_stroke_end(stroke, &stats));
    CHECK(stats.dabs == r.count && stats.missed == 0);
    slv_stroke_destroy(stroke);
    return r;
}

static const char plain[] =
    "{\"version\": 3, \"settings\": {\"radius_logarithmic\": {\"base_value\": 3.0, \"inputs\": {}},"
    "\"opaque\": {\"base_value\": 0.8, \"inputs\": {}}, \"hardness\": {\"base_value\": 0.6,"
    "\"inputs\": {\"pressure\": [[0, 0], [1, 0.1]], \"moon\": [[0, 0], [1, 1]]}},"
    "\"dabs_per_actual_radius\": {\"base_value\": 4, \"inputs\": {}}, \"sparkle\": "
    "{\"base_value\": "
    "1, \"inputs\": {}}}}";

static void rates(slv_env *env, const slv_brush *brush, const char *what) {
    static const double asked[] = {30, 125, 1000};
    for (int picture = 0; picture < 2; picture++) {
        record all[3];
        double worst = 0;
        shape p = paint_plane(4, 4);
        paint_scene s = paint_scene_of(env, &p, SLV_SCHEME_BILINEAR, 3, SLV_TYPE_U8, 3, -1);
        for (int k = 0; k < 3; k++)
            all[k] = stroke_at(&s, brush, asked[k], picture);
        for (int k = 0; k < 2; k++) {
            uint32_t n = all[k].count < all[2].count ? all[k].count : all[2].count;
            CHECK_MSG(all[2].count - n <= 1 && all[k].count - n <= 1 && n > 100,
                      "%s: %u dabs at %g Hz, %u at 1000", what, all[k].count, asked[k],
                      all[2].count);
            for (uint32_t i = 0; i < n; i++)
                worst = fmax(worst, hypot(all[k].at[i][0] - all[2].at[i][0],
                                          all[k].at[i][1] - all[2].at[i][1]));
        }
        CHECK_MSG(worst < 0.005 * (double)RADIUS, "%s, picture %d: dabs are %g radii apart", what,
                  picture, worst / (double)RADIUS);
        for (int k = 0; k < 3; k++)
            free(all[k].at);
        paint_scene_end(&s);
    }
}

static void taps_and_mirrors(slv_env *env, const slv_brush *brush) {
    shape p = paint_plane(4, 4);
    paint_scene s = paint_scene_of(env, &p, SLV_SCHEME_BILINEAR, 5, SLV_TYPE_U8, 3, -1);
    static const slv_mirror mirrors[2] = {{{2, 2, 0}, {1, 0, 0}}, {{2, 2, 0}, {0, 3, 0}}};
    for (int project = 0; project < 2; project++) {
        record r = {.scene = &s};
        slv_stroke_params params = {.brush = brush,
                                    .paint = {.color = {1, 1, 1}, .opacity = 1},
                                    .radius = RADIUS,
                                    .in_picture = project,
                                    .project = project,
                                    .camera = paint_camera(4),
                                    .width = 400,
                                    .height = 400,
                                    .mirrors = mirrors,
                                    .nmirrors = 2,
                                    .each = note,
                                    .user = &r};
        slv_stroke *stroke = NULL;
        slv_stroke_stats stats;
        const slv_stroke_sample sample = {
            .at = paint_below(&s, 1.1, 0.7), .x = 110, .y = 330, .pressure = 1};
        MUST(slv_stroke_begin(s.painter, &s.canvas, &params, &stroke));
        MUST(slv_stroke_add(stroke, &sample, 1));
        MUST(slv_stroke_end(stroke, &stats));
        CHECK_MSG(stats.dabs == 4 && stats.missed == 0, "%u dabs", (unsigned)stats.dabs);
        static const double want[4][2] = {{1.1, 0.7}, {2.9, 0.7}, {1.1, 3.3}, {2.9, 3.3}};
        for (uint32_t i = 0; i < 4 && r.count == 4; i++) {
            slv_surface_point at = paint_below(&s, want[i][0], want[i][1]);
            float texel[3];
            CHECK(project ||
                  (fabs(r.at[i][0] - want[i][0]) < 1e-4 && fabs(r.at[i][1] - want[i][1]) < 1e-4));
            slv_texture_fetch(s.texture, (uint32_t)at.face, (uint32_t)(at.u * 32),
                              (uint32_t)(at.v * 32), texel);
            CHECK_MSG(texel[0] > 0.15f, "project %d, mirror %u: %g", project, i, (double)texel[0]);
        }
        slv_stroke_destroy(stroke);
        free(r.at);
        for (uint32_t face = 0; face < s.nfaces; face++) {
            uint8_t black[3] = {0};
            MUST(slv_texture_set_constant(s.texture, face, black));
        }
    }
    paint_scene_end(&s);
}

/* On its own mirror a dab is put once, on two of them too; beside one, twice. */
static void on_the_mirror(slv_env *env, const slv_brush *brush) {
    static const slv_mirror mirrors[2] = {{{2, 2, 0}, {1, 0, 0}}, {{2, 2, 0}, {0, 1, 0}}};
    static const struct {
        double x, y;
        unsigned dabs;
    } all[] = {{2, 2, 1}, {2, 0.7, 2}, {0.9, 2, 2}, {1.9, 2, 2}, {1.9, 1.8, 4}};
    shape p = paint_plane(4, 4);
    paint_scene s = paint_scene_of(env, &p, SLV_SCHEME_BILINEAR, 5, SLV_TYPE_U8, 3, -1);
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        const slv_stroke_params params = {.brush = brush,
                                          .paint = {.color = {1, 1, 1}, .opacity = 0.5f},
                                          .radius = RADIUS,
                                          .mirrors = mirrors,
                                          .nmirrors = 2};
        const slv_stroke_sample sample = {.at = paint_below(&s, all[i].x, all[i].y), .pressure = 1};
        slv_stroke *stroke = NULL;
        slv_stroke_stats stats;
        MUST(slv_stroke_begin(s.painter, &s.canvas, &params, &stroke));
        MUST(slv_stroke_add(stroke, &sample, 1));
        MUST(slv_stroke_end(stroke, &stats));
        CHECK_MSG(stats.dabs == all[i].dabs && stats.missed == 0, "%g %g: %u dabs", all[i].x,
                  all[i].y, (unsigned)stats.dabs);
        slv_stroke_destroy(stroke);
    }
    paint_scene_end(&s);
}

/* Every file below a folder that ends in .myb; paints a short stroke with it. */
static void paint_with_all(paint_scene *s, const char *folder, uint32_t *count) {
    DIR *dir = opendir(folder);
    struct dirent *entry;
    slv_env env = test_env();
    while (dir && (entry = readdir(dir))) {
        char path[1024];
        struct stat status;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        if (entry->d_name[0] == '.' || stat(path, &status))
            continue;
        if (S_ISDIR(status.st_mode))
            paint_with_all(s, path, count);
        size_t n = strlen(path);
        if (n < 4 || strcmp(path + n - 4, ".myb") != 0)
            continue;
        (*count)++;
        slv_brush *brush = NULL;
        slv_stroke *stroke = NULL;
        slv_stroke_stats stats = {0};
        CHECK_MSG(!slv_brush_load(&env, path, &brush), "%s: %s", path, test_last_log);
        if (!brush)
            continue;
        const slv_stroke_params params = {
            .brush = brush, .paint = {.color = {0.2f, 0.9f, 0.4f}, .opacity = 1}, .radius = 0.2f};
        MUST(slv_stroke_begin(s->painter, &s->canvas, &params, &stroke));
        for (int i = 0; i <= 30; i++) {
            double t = i / 30.0;
            const slv_stroke_sample sample = {.at = paint_below(s, 0.5 + 3 * t, 2 + sin(4 * t)),
                                              .pressure = (float)(0.3 + 0.7 * t),
                                              .tilt_x = 0.3f,
                                              .time = t};
            CHECK_MSG(!slv_stroke_add(stroke, &sample, 1), "%s: %s", path, test_last_log);
        }
        CHECK_MSG(!slv_stroke_end(stroke, &stats), "%s: %s", path, test_last_log);
        CHECK_MSG(stats.dabs > 0, "%s leaves nothing", path);
        slv_stroke_destroy(stroke);
        slv_brush_destroy(brush);
    }
    if (dir)
        closedir(dir);
}

static void spoilt_brushes(slv_env *env) {
    static const char *const texts[] = {"",
                                        "{",
                                        "[]",
                                        "{\"version\": 3}",
                                        "{\"version\": 2, \"settings\": {}}",
                                        "{\"version\": 3, \"settings\": [1]}"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        slv_brush *brush = NULL;
        CHECK(slv_brush_parse(env, "spoilt", texts[i], strlen(texts[i]), &brush) && !brush);
        CHECK(strstr(test_last_log, "spoilt") != NULL);
    }
}

int main(void) {
    slv_env env = test_env();
    slv_brush *round = NULL, *mypaint = NULL;
    const slv_brush_params soft = {.hardness = 0.6f, .spacing = 0.25f};
    MUST(slv_brush_create(&env, &soft, &round));
    rates(&env, round, "round");
    taps_and_mirrors(&env, round);
    on_the_mirror(&env, round);
    slv_result result = slv_brush_parse(&env, "plain", plain, strlen(plain), &mypaint);
    CHECK(result == SLV_OK || result == SLV_ERROR_UNSUPPORTED);
    if (mypaint) {
        const char *const *unknown;
        REQUIRE(slv_brush_unknown(mypaint, &unknown) == 2);
        CHECK(strcmp(unknown[0], "hardness: moon") == 0 && strcmp(unknown[1], "sparkle") == 0);
        rates(&env, mypaint, "MyPaint");
        taps_and_mirrors(&env, mypaint);
        spoilt_brushes(&env);
        uint32_t count = 0;
        shape p = paint_plane(2, 4);
        paint_scene s = paint_scene_of(&env, &p, SLV_SCHEME_BILINEAR, 6, SLV_TYPE_U8, 4, 3);
        paint_with_all(&s, "/usr/share/mypaint-data", &count);
        fprintf(stderr, "%u brushes\n", count);
        paint_scene_end(&s);
    }
    slv_brush_destroy(round);
    slv_brush_destroy(mypaint);
    return test_end();
}
