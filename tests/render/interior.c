/* Away from edges all strategies that draw the same texels show the same: on the demo scene, and on
 * the published samples where they are at hand, no pixel whose footprint stays inside its face is
 * further than 2/255 apart. */
#include "kit/command_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/bake.h>
#include <selvage/gl_renderer.h>
#include <selvage/ptx.h>
#include <selvage/reference.h>

enum { WIDTH = 320, HEIGHT = 180, PIXELS = WIDTH * HEIGHT, SEGMENTS = 8 };

/* All whose texels are the texture's own. */
static const slv_strategy *strategies[KIT_STRATEGIES];
static uint32_t nstrategies;

static slv_gl *gl;
static slv_reference_hit hits[PIXELS];

/* Whether what a lookup averages at this pixel lies in its face, with room for what the renderer's
 * own derivatives, those of two by two pixels, make of it. */
static bool inside(const slv_res *res, uint32_t pixel, uint32_t anisotropy) {
    const slv_reference_hit *hit = &hits[pixel];
    uint32_t x = pixel % WIDTH, y = pixel / WIDTH;
    if (x < 1 || y < 1 || x + 1 >= WIDTH || y + 1 >= HEIGHT || hit->face < 0)
        return false;
    for (uint32_t j = y - 1; j <= y + 1; j++)
        for (uint32_t i = x - 1; i <= x + 1; i++)
            if (hits[j * WIDTH + i].face != hit->face)
                return false;
    float at[2] = {hit->u, hit->v},
          size[2] = {(float)(1 << res[hit->face].u), (float)(1 << res[hit->face].v)};
    float a = hypotf(hit->du[0] * size[0], hit->dv[0] * size[1]);
    float b = hypotf(hit->du[1] * size[0], hit->dv[1] * size[1]);
    float shortest = fmaxf(fminf(a, b), fmaxf(a, b) / (float)anisotropy);
    float texels = exp2f(ceilf(fmaxf(log2f(shortest), 0)) + 1);
    for (int c = 0; c < 2; c++) {
        const float *d = c ? hit->dv : hit->du;
        float reach = fabsf(d[0]) + fabsf(d[1]) + texels / size[c];
        if (!(at[c] > reach && at[c] < 1 - reach))
            return false;
    }
    return true;
}

static void check_view(slv_gl_renderer *renderer, slv_gl_texture *texture, const slv_res *res,
                       slv_frame frame, uint32_t anisotropy, const char *name, uint32_t *count) {
    slv_env env = test_env();
    slv_image images[KIT_STRATEGIES];
    for (uint32_t s = 0; s < nstrategies; s++) {
        frame.strategy = strategies[s];
        REQUIRE(slv_gl_renderer_draw(renderer, &env, texture, &frame, &images[s], NULL) == SLV_OK);
    }
    for (uint32_t s = 1; s < nstrategies; s++) {
        for (uint32_t t = 0; t < s; t++) {
            float apart = 0;
            uint32_t where = 0;
            for (uint32_t pixel = 0; pixel < PIXELS; pixel++) {
                if (!inside(res, pixel, anisotropy))
                    continue;
                *count += s == 1;
                for (uint32_t c = 0; c < 3; c++) {
                    float difference =
                        fabsf(images[s].pixels[4 * pixel + c] - images[t].pixels[4 * pixel + c]);
                    where = difference > apart ? pixel : where;
                    apart = fmaxf(apart, difference);
                }
            }
            CHECK_MSG(apart <= 2.0f / 255, "%s aniso %u: %s and %s are %g/255 apart at pixel %u %u",
                      name, anisotropy, strategies[s]->name, strategies[t]->name,
                      (double)apart * 255, where % WIDTH, where / WIDTH);
        }
    }
    for (uint32_t s = 0; s < nstrategies; s++)
        slv_image_free(&images[s]);
}

static void check_scene(const char *obj, const char *texels, const char *name) {
    /* azimuth, elevation, and which part of the whole is in the picture, around some vertex */
    static const float views[][3] = {{30, 15, 0.02f}, {120, 50, 0.06f}, {250, 8, 0.2f}, {0, 30, 1}};
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    slv_surface *surface = NULL;
    slv_ptx *ptx = NULL;
    slv_texture *texture = NULL;
    slv_reference *reference = NULL;
    slv_gl_renderer *renderer = NULL;
    slv_mesh_stats stats;
    uint32_t count = 0;
    REQUIRE(slv_mesh_load(&env, obj, &mesh) == SLV_OK);
    REQUIRE(slv_ptx_open(&env, texels, &ptx) == SLV_OK);
    REQUIRE(slv_ptx_load_texture(&env, ptx, &texture) == SLV_OK);
    slv_ptx_close(ptx);
    REQUIRE(slv_mesh_adjacency(&env, mesh, &adjacency) == SLV_OK);
    REQUIRE(slv_mesh_get_stats(&env, mesh, &stats) == SLV_OK);
    REQUIRE(slv_surface_create(&env, mesh, NULL, &surface) == SLV_OK);
    REQUIRE(slv_reference_create(&env, mesh, surface, texture, adjacency,
                                 &(slv_reference_params){.segments = SEGMENTS},
                                 &reference) == SLV_OK);
    REQUIRE(slv_gl_renderer_create(gl, &env, mesh, surface, SEGMENTS, &renderer) == SLV_OK);
    const slv_res *res = slv_texture_get_desc(texture)->res;
    for (uint32_t anisotropy = 1; anisotropy <= 16; anisotropy *= 16) {
        slv_gl_texture_params params = {KIT_ALL, .anisotropy = anisotropy};
        slv_gl_texture *uploaded = NULL;
        REQUIRE(slv_gl_texture_create(gl, &env, texture, adjacency, &params, &uploaded) == SLV_OK);
        for (uint32_t v = 0; v < sizeof views / sizeof *views; v++) {
            if (test_skip(v + (anisotropy > 1), 3))
                continue;
            const slv_mesh_view *view = slv_mesh_get_view(mesh);
            const float *middle = view->positions + 3 * (view->nverts / 7 * (2 * v + 1));
            float low[3], high[3];
            for (int c = 0; c < 3; c++) {
                float half = views[v][2] * (stats.bounds_max[c] - stats.bounds_min[c]) / 2;
                low[c] = middle[c] - half;
                high[c] = middle[c] + half;
            }
            slv_frame frame = {.width = WIDTH,
                               .height = HEIGHT,
                               .msaa = 1,
                               .float_target = true,
                               .shading = SLV_SHADE_UNLIT,
                               .camera = slv_camera_orbit(low, high, views[v][0], views[v][1], 40,
                                                          (float)WIDTH / HEIGHT)};
            REQUIRE(slv_reference_trace(reference, &env, &frame.camera, WIDTH, HEIGHT, hits) ==
                    SLV_OK);
            check_view(renderer, uploaded, res, frame, anisotropy, name, &count);
        }
        slv_gl_texture_destroy(uploaded);
    }
    fprintf(stderr, "%s: %u pixels inside their faces\n", name, count);
    CHECK(count > (test_brief() ? 2500 : 5000));
    slv_gl_renderer_destroy(renderer);
    slv_reference_destroy(reference);
    slv_texture_destroy(texture);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
}

static void check_sample(const char *samples, const char *name) {
    char folder[KIT_PATH], obj[KIT_PATH], ptx[KIT_PATH], file[64];
    kit_join(folder, samples, name);
    snprintf(file, sizeof file, "%s.obj", name);
    kit_join(obj, folder, file);
    snprintf(file, sizeof file, "%s.ptx", name);
    check_scene(obj, kit_join(ptx, folder, file), name);
}

int main(void) {
    static kit_scratch scratch;
    static kit_run run;
    const char *samples = getenv("SELVAGE_SAMPLES");
    slv_env env = test_env();
    char program[KIT_PATH], obj[KIT_PATH], ptx[KIT_PATH];
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    for (uint32_t s = 0; s < slv_strategy_count(); s++)
        if (!slv_strategy_at(s)->resampled && !test_skip(s, 2))
            strategies[nstrategies++] = slv_strategy_at(s);
    kit_scratch_make(&scratch);
    kit_join(program, kit_variable("SELVAGE_BIN"), "selvage-assets");
    kit_run_program(&scratch, NULL, (const char *const[]){program, scratch.folder, NULL}, &run);
    REQUIRE(run.code == 0);
    kit_join(obj, scratch.folder, "scene.obj");
    check_scene(obj, kit_join(ptx, scratch.folder, "scene.ptx"), "demo scene");
    if (!test_brief())
        check_scene(obj, kit_join(ptx, scratch.folder, "scene_faces.ptx"), "demo scene's faces");
    if (samples && *samples) {
        check_sample(samples, "nonquad");
        if (!test_brief())
            check_sample(samples, "teapot");
    } else {
        fprintf(stderr, "SELVAGE_SAMPLES is not set: the published samples were not compared\n");
    }
    test_remove(scratch.root);
    slv_gl_destroy(gl);
    return test_end();
}
