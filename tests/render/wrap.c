/* Coordinates that go round, in a stranger's program with selvage_wrap.glsl: tubes and tori turned
 * before the camera, against rays, against meshes with duplicated vertices, and against plain
 * interpolation, which fails. SELVAGE_TEST_EFFORT=120 turns them by one degree at a time. */
#include "kit/mesh_shapes.h"
#include "kit/wrap_kit.h"

#include <selvage/reference.h>
#include <selvage/wrap.h>

enum { SIZE = 96, WIDTH = 128, HEIGHT = 64, SAMPLES = 64 };

static slv_gl *gl;
static float *texels; /* RGB */
static char *include;

enum { METHOD, PLAIN, GRADIENTS, PLAIN_GRADIENTS, MADE, TANGENTS, PROGRAMS };
static GLuint programs[2][PROGRAMS]; /* of tubes and of tori */

static void make_texels(void) {
    texels = wrap_room(WIDTH * HEIGHT, 3 * sizeof *texels);
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
        for (uint32_t c = 0; c < 3; c++) {
            double u = (i % WIDTH + 0.5) / WIDTH, v = ((double)(i / WIDTH) + 0.5) / HEIGHT;
            double wave = cos(6.283185307 * 8 * u + c) * cos(6.283185307 * (3 + c) * v);
            texels[3 * i + c] = (float)(0.5 + 0.4 * wave);
        }
}

static void make_programs(void) {
    static const char *const defines[PROGRAMS] = {"",
                                                  "#define PLAIN\n",
                                                  "#define GRADIENTS\n",
                                                  "#define PLAIN\n#define GRADIENTS\n",
                                                  "#define MADE\n",
                                                  "#define TANGENTS\n"};
    for (int torus = 0; torus < 2; torus++)
        for (int i = 0; i < PROGRAMS; i++) {
            char text[64];
            snprintf(text, sizeof text, "%s%s", torus ? "#define TORUS\n" : "", defines[i]);
            programs[torus][i] = wrap_program(include, text);
        }
}

/* ---- rays ---- */

typedef struct rays {
    slv_mesh *mesh;
    slv_surface *surface;
    slv_adjacency *adjacency;
    slv_reference *reference;
    float *corners;
    slv_uv_images images;
    slv_uv_tile tile;
} rays;

static void texel(int x, int y, const float **out) {
    *out = texels + 3 * (((y % HEIGHT + HEIGHT) % HEIGHT) * WIDTH + (x % WIDTH + WIDTH) % WIDTH);
}

/* Bilinear between texels, at bilinear coordinates of a face. */
static void color_at(const void *user, uint32_t face, float u, float v, float rgba[4]) {
    const float *c = ((const rays *)user)->corners + 8 * (size_t)face;
    double at[2];
    for (int axis = 0; axis < 2; axis++)
        at[axis] = (1 - v) * ((1 - u) * c[axis] + u * c[2 + axis]) +
                   v * ((1 - u) * c[6 + axis] + u * c[4 + axis]);
    double x = at[0] * WIDTH - 0.5, y = at[1] * HEIGHT - 0.5;
    int x0 = (int)floor(x), y0 = (int)floor(y);
    memset(rgba, 0, 4 * sizeof *rgba);
    for (int k = 0; k < 4; k++) {
        const float *t;
        texel(x0 + (k & 1), y0 + (k >> 1), &t);
        double weight = fabs((k & 1) - 1 + x - x0) * fabs((k >> 1) - 1 + y - y0);
        for (int i = 0; i < 3; i++)
            rgba[i] += (float)weight * t[i];
    }
    rgba[3] = 1;
}

/* Of a mesh whose coordinates are right without any method. */
static void rays_make(const wrap_mesh *m, rays *out) {
    slv_env env = test_env();
    int32_t *sizes = wrap_room(2 * m->nquads, sizeof *sizes);
    for (uint32_t i = 0; i < 2 * m->nquads; i++)
        sizes[i] = 3;
    int32_t *ids = wrap_room(6 * m->nquads, sizeof *ids);
    for (uint32_t i = 0; i < 6 * m->nquads; i++)
        ids[i] = (int32_t)m->indices[i];
    const slv_mesh_view view = {.nverts = m->nverts,
                                .positions = m->positions,
                                .npolys = 2 * m->nquads,
                                .poly_sizes = sizes,
                                .poly_verts = ids,
                                .ntexcoords = m->nverts,
                                .texcoords = m->uv,
                                .poly_texcoords = ids};
    const slv_surface_params flat = {.scheme = SLV_SCHEME_BILINEAR};
    MUST(slv_mesh_create(&env, &view, &out->mesh));
    MUST(slv_surface_create(&env, out->mesh, &flat, &out->surface));
    MUST(slv_mesh_adjacency(&env, out->mesh, &out->adjacency));
    MUST(slv_mesh_face_texcoords(&env, out->mesh, &out->corners));
    out->tile = (slv_uv_tile){0, 0, WIDTH, HEIGHT};
    out->images = (slv_uv_images){.nfaces = slv_mesh_face_count(out->mesh),
                                  .texcoords = out->corners,
                                  .repeat_u = true,
                                  .repeat_v = true,
                                  .ntiles = 1,
                                  .tiles = &out->tile,
                                  .color = color_at,
                                  .user = out};
    const slv_reference_params params = {.segments = 2, .images = &out->images};
    MUST(slv_reference_create(&env, out->mesh, out->surface, NULL, out->adjacency, &params,
                              &out->reference));
    free(sizes);
    free(ids);
}

static void rays_free(rays *r) {
    slv_reference_destroy(r->reference);
    slv_adjacency_destroy(r->adjacency);
    slv_surface_destroy(r->surface);
    slv_mesh_destroy(r->mesh);
    slv_free(r->corners);
}

/* ---- what a view shows ---- */

enum { SEAM, INTERIOR, OTHER };

/* Where the map ends: quads whose coordinates in the mesh with one value a vertex step over it. */
static bool is_seam(const wrap_mesh *once, int32_t quad) {
    const uint32_t *six = once->indices + 6 * (size_t)quad;
    for (int axis = 0; axis < 2; axis++) {
        float low = 2, high = -1;
        for (int k = 0; k < 6; k++) {
            float at = once->uv[2 * six[k] + (uint32_t)axis];
            low = fminf(low, at);
            high = fmaxf(high, at);
        }
        if (high - low >= 0.5f && (axis == 0 || once->torus))
            return true;
    }
    return false;
}

static int apart(int a, int b, int n) {
    int d = abs(a - b);
    return d < n - d ? d : n - d;
}

/* What the surface shows in a pixel and all around it without a fold or an end is of the seam's
 * column if any of it is; all else that is covered is interior. */
static void classify(const wrap_mesh *once, const slv_reference_hit *hits, const slv_image *truth,
                     uint8_t *kinds) {
    int columns = (int)once->columns, rows = (int)once->rows;
    for (int i = 0; i < SIZE * SIZE; i++) {
        int x = i % SIZE, y = i / SIZE, quad = hits[i].face / 6;
        bool seam = false, whole = x && y && x < SIZE - 1 && y < SIZE - 1 && hits[i].face >= 0;
        for (int k = 0; k < 9 && hits[i].face >= 0; k++) {
            const slv_reference_hit *hit =
                &hits[whole ? (y + k / 3 - 1) * SIZE + x + k % 3 - 1 : i];
            int other = hit->face / 6;
            whole &= hit->face >= 0 && apart(other % columns, quad % columns, columns) <= 1 &&
                     apart(other / columns, quad / columns, rows) <= 1;
            seam |= hit->face >= 0 && is_seam(once, other);
        }
        bool covered = hits[i].face >= 0 && truth->pixels[4 * i + 3] > 0.999f;
        kinds[i] = whole && seam ? SEAM : covered && !seam ? INTERIOR : OTHER;
    }
}

static void measure(const float *picture, const slv_image *truth, const uint8_t *kinds,
                    float worst[3]) {
    memset(worst, 0, 3 * sizeof *worst);
    for (int i = 0; i < SIZE * SIZE; i++)
        for (int c = 0; c < 3; c++)
            worst[kinds[i]] =
                fmaxf(worst[kinds[i]], fabsf(picture[4 * i + c] - truth->pixels[4 * i + c]));
}

static float difference(const float *a, const float *b) {
    float most = 0;
    for (int i = 0; i < 4 * SIZE * SIZE; i++)
        most = fmaxf(most, fabsf(a[i] - b[i]));
    return most;
}

/* ---- the tests ---- */

static struct {
    uint32_t views, strict, seam_pixels;
    float seam, interior, plain, apart;
} told;

/* One shape from one side, with each number of taps and samples. */
static void view(const wrap_mesh *once, const rays *r, const wrap_buffers *meshes, GLuint texture,
                 int azimuth) {
    static const float low[3] = {-1.2f, -0.9f, -1.2f}, high[3] = {1.2f, 0.9f, 1.2f};
    static float method[4 * SIZE * SIZE], other[4 * SIZE * SIZE];
    static slv_reference_hit hits[SIZE * SIZE];
    static uint8_t kinds[SIZE * SIZE];
    const slv_gl_info *info = slv_gl_get_info(gl);
    slv_env env = test_env();
    const slv_camera camera = slv_camera_orbit(low, high, (float)azimuth, 35, 35, 1);
    const slv_reference_frame frame = {.camera = camera,
                                       .width = SIZE,
                                       .height = SIZE,
                                       .shading = SLV_SHADE_UNLIT,
                                       .samples = SAMPLES};
    slv_image truth;
    MUST(slv_reference_render(r->reference, &env, &frame, &truth, NULL, NULL));
    MUST(slv_reference_trace(r->reference, &env, &camera, SIZE, SIZE, hits));
    classify(once, hits, &truth, kinds);
    for (int i = 0; i < SIZE * SIZE; i++)
        told.seam_pixels += kinds[i] == SEAM;
    for (uint32_t msaa = 1; msaa <= 8 && msaa <= info->max_msaa; msaa *= 2) {
        wrap_target target = wrap_target_make(SIZE, msaa);
        for (uint32_t taps = 1; taps <= 16; taps *= 4) {
            const GLuint *p = programs[once->torus];
            float worst[3], twice[3], plain[3];
            for (int i = 0; i < PROGRAMS; i++)
                wrap_anisotropy(gl, texture, p[i], (float)taps);
            wrap_draw(&target, p[METHOD], texture, &meshes[0], &camera, 1);
            wrap_read(&target, method);
            measure(method, &truth, kinds, worst);
            wrap_draw(&target, p[PLAIN], texture, &meshes[1], &camera, 1);
            wrap_read(&target, other);
            float off = difference(method, other);
            measure(other, &truth, kinds, twice);
            /* now and then the seam is where the view is worst for any mapping */
            told.strict += worst[SEAM] <= worst[INTERIOR];
            CHECK_MSG(worst[SEAM] <= fmaxf(worst[INTERIOR], twice[SEAM] + 1.0f / 255),
                      "%s from %d, %u taps, %u samples: %g at the seam, %g elsewhere",
                      once->torus ? "torus" : "tube", azimuth, taps, msaa, (double)worst[SEAM],
                      (double)worst[INTERIOR]);
            wrap_draw(&target, p[GRADIENTS], texture, &meshes[0], &camera, 1);
            wrap_read(&target, method);
            wrap_draw(&target, p[PLAIN_GRADIENTS], texture, &meshes[1], &camera, 1);
            wrap_read(&target, other);
            float off2 = difference(method, other);
            CHECK_MSG(off <= 1.0f / 255 && off2 <= 1.0f / 255,
                      "from %d, %u taps, %u samples: %g to duplicated vertices, %g with gradients",
                      azimuth, taps, msaa, (double)off, (double)off2);
            wrap_draw(&target, p[PLAIN], texture, &meshes[0], &camera, 1);
            wrap_read(&target, other);
            measure(other, &truth, kinds, plain);
            told.views++;
            told.seam = fmaxf(told.seam, worst[SEAM]);
            told.interior = fmaxf(told.interior, worst[INTERIOR]);
            told.plain = fmaxf(told.plain, plain[SEAM]);
            told.apart = fmaxf(told.apart, fmaxf(off, off2));
        }
        wrap_target_free(&target);
    }
    slv_image_free(&truth);
}

static void turns(bool torus, double phase, GLuint texture) {
    wrap_mesh once = wrap_make(torus, false, WRAP_AROUND, WRAP_ACROSS, phase);
    wrap_mesh twice = wrap_make(torus, true, WRAP_AROUND, WRAP_ACROSS, phase);
    wrap_buffers meshes[2] = {wrap_upload(&once), wrap_upload(&twice)};
    uint32_t count = test_effort(3);
    rays r = {0};
    CHECK(once.nverts < twice.nverts);
    rays_make(&twice, &r);
    count = count < 360 ? count : 360;
    memset(&told, 0, sizeof told);
    for (uint32_t i = 0; i < count; i++)
        view(&once, &r, meshes, texture, (int)(360 * i / count));
    /* the same test knows what is wrong */
    CHECK_MSG(told.plain > 1.5f * told.seam && told.plain > 0.3f && told.seam_pixels > 100,
              "%s: plain interpolation is off by %g only, in %u pixels", torus ? "torus" : "tube",
              (double)told.plain, told.seam_pixels);
    CHECK_MSG(100 * told.strict >= 97 * told.views, "%u of %u pictures", told.strict, told.views);
    fprintf(stderr,
            "%s, phase %g: %u of %u pictures, seam %.4f, interior %.4f, plain %.3f, apart %.2g\n",
            torus ? "torus" : "tube", phase, told.strict, told.views, (double)told.seam,
            (double)told.interior, (double)told.plain, (double)told.apart);
    rays_free(&r);
    wrap_discard(&meshes[0]);
    wrap_discard(&meshes[1]);
    wrap_free(&once);
    wrap_free(&twice);
}

/* Two pictures of programs and meshes that are to show the same; ten parameters, since each of the
 * two has its own and all else is shared. */
static void same(const char *what, const wrap_target *target, GLuint texture, GLuint a,
                 const wrap_buffers *mesh_a, GLuint b, const wrap_buffers *mesh_b,
                 const slv_camera *camera, float times, float most) {
    static float first[4 * SIZE * SIZE], second[4 * SIZE * SIZE];
    float sum = 0;
    wrap_draw(target, a, texture, mesh_a, camera, times);
    wrap_read(target, first);
    wrap_draw(target, b, texture, mesh_b, camera, times);
    wrap_read(target, second);
    for (int i = 0; i < SIZE * SIZE; i++)
        sum += first[4 * i + 3];
    float off = difference(first, second);
    CHECK_MSG(off <= most && sum > SIZE, "%s: %g apart", what, (double)off);
}

/* Repetitions, coordinates that shaders make, tangents, and a camera at the seam itself. */
static void forms(bool torus, GLuint texture) {
    static const float low[3] = {-1.2f, -0.9f, -1.2f}, high[3] = {1.2f, 0.9f, 1.2f};
    static const float seam_low[3] = {-0.02f, 0.3f, 0.68f}, seam_high[3] = {0.02f, 0.34f, 0.72f};
    wrap_mesh once = wrap_make(torus, false, WRAP_AROUND, WRAP_ACROSS, 0);
    wrap_mesh twice = wrap_make(torus, true, WRAP_AROUND, WRAP_ACROSS, 0);
    wrap_buffers meshes[2] = {wrap_upload(&once), wrap_upload(&twice)};
    const GLuint *p = programs[torus];
    wrap_target target = wrap_target_make(SIZE, 4);
    const float step = 1.0f / 255;
    for (int i = 0; i < PROGRAMS; i++)
        wrap_anisotropy(gl, texture, p[i], 1);
    for (int azimuth = -30; azimuth <= 30; azimuth += 30) {
        slv_camera camera = slv_camera_orbit(low, high, (float)azimuth, 35, 35, 1);
        same("3 times", &target, texture, p[METHOD], &meshes[0], p[PLAIN], &meshes[1], &camera, 3,
             step);
        same("3 times, gradients", &target, texture, p[GRADIENTS], &meshes[0], p[PLAIN_GRADIENTS],
             &meshes[1], &camera, 3, step);
        same("made in the shader", &target, texture, p[MADE], &meshes[0], p[PLAIN], &meshes[1],
             &camera, 1, step);
        same("tangents", &target, texture, p[TANGENTS], &meshes[0], p[TANGENTS], &meshes[1],
             &camera, 1, step);
        if (!torus) {
            camera = slv_camera_orbit(seam_low, seam_high, (float)azimuth, 5, 35, 1);
            same("near", &target, texture, p[METHOD], &meshes[0], p[PLAIN], &meshes[1], &camera, 1,
                 step);
        }
    }
    if (!torus) {
        /* an angle per fragment, which ends in front or behind */
        GLuint front = wrap_program(include, "#define ANGLE -\n");
        GLuint behind = wrap_program(include, "#define ANGLE +\n");
        const slv_camera camera = slv_camera_orbit(low, high, 10, 35, 35, 1);
        same("angles", &target, texture, front, &meshes[0], behind, &meshes[0], &camera, 1, step);
        wrap_api.DeleteProgram(front);
        wrap_api.DeleteProgram(behind);
    }
    wrap_target_free(&target);
    wrap_discard(&meshes[0]);
    wrap_discard(&meshes[1]);
    wrap_free(&once);
    wrap_free(&twice);
}

/* The same in C: of a triangle over the end of the map, each point has the coordinate that its
 * corners have the short way. */
static void in_c(void) {
    static const float corners[3][3] = {{0.9f, 0.1f, 0.05f}, {0.4f, 0.6f, 0.45f}, {0, 0.2f, 0.8f}};
    for (int t = 0; t < 3; t++) {
        float pairs[3][2], along[3];
        for (int k = 0; k < 3; k++) {
            slv_wrap_pair(corners[t][k], pairs[k]);
            along[k] = corners[t][0] + slv_wrap_step(corners[t][0], corners[t][k]);
        }
        for (int i = 1; i < 20; i++) {
            float x = (float)i / 20, change[2], pair[2];
            for (int k = 0; k < 2; k++) {
                change[k] = fabsf(pairs[1][k] - pairs[0][k]) + fabsf(pairs[2][k] - pairs[0][k]);
                pair[k] = (1 - x) * pairs[0][k] + x * pairs[1][k];
            }
            float got = slv_wrap_choose(pair, change), want = (1 - x) * along[0] + x * along[1];
            CHECK_MSG(fabsf(slv_wrap_step(got, want)) < 1e-6f, "triangle %d at %g: %g, not %g", t,
                      (double)x, (double)got, (double)want);
        }
    }
    static const float positions[9] = {0, 0, 0, 2, 0, 0, 0, 0, -3};
    static const float u[3] = {0.95f, 0.15f, 0.95f}, v[3] = {0.9f, 0.9f, 0.1f};
    float tangent[3];
    slv_wrap_tangent(positions, u, v, true, true, tangent);
    CHECK(fabsf(tangent[0] - 1) < 1e-6f && fabsf(tangent[1]) < 1e-6f && fabsf(tangent[2]) < 1e-6f);
    slv_wrap_tangent(positions, v, u, true, true, tangent);
    CHECK(fabsf(tangent[2] + 1) < 1e-6f && fabsf(tangent[0]) < 1e-6f);
    slv_wrap_tangent(positions, u, v, false, false, tangent);
    CHECK(fabsf(tangent[0] + 1) < 1e-6f);
    static const float nowhere[3] = {0.5f, 0.5f, 0.5f};
    slv_wrap_tangent(positions, nowhere, nowhere, true, true, tangent);
    CHECK(tangent[0] == 0 && tangent[1] == 0 && tangent[2] == 0);
}

int main(void) {
    slv_env env = test_env();
    in_c();
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    wrap_load(gl);
    make_texels();
    include = wrap_include();
    make_programs();
    GLuint texture = wrap_texture(texels, WIDTH, HEIGHT);
    turns(false, 0, texture);
    turns(true, 0.3, texture);
    forms(false, texture);
    forms(true, texture);
    wrap_api.DeleteTextures(1, &texture);
    for (int i = 0; i < 2 * PROGRAMS; i++)
        wrap_api.DeleteProgram(programs[i / PROGRAMS][i % PROGRAMS]);
    free(texels);
    free(include);
    slv_gl_destroy(gl);
    return test_end();
}
