/* Coordinates that go round, in a stranger's program with selvage_wrap.glsl: tubes and tori turned
 * before the camera, against rays, against meshes with duplicated vertices, against the same
 * picture of maps that end elsewhere, and against plain interpolation, which fails.
 * SELVAGE_TEST_EFFORT=120 turns them by one degree at a time. */
#include "kit/mesh_shapes.h"
#include "kit/wrap_kit.h"

#include <selvage/reference.h>
#include <selvage/wrap.h>

enum { SIZE = 96, WIDTH = 128, HEIGHT = 64, SAMPLES = 64 };

static slv_gl *gl;
static float *texels; /* RGB */
static char *include;

enum {
    METHOD,
    PLAIN,
    GRADIENTS,
    PLAIN_GRADIENTS,
    MADE,
    TANGENTS,
    METHOD_TURNED,
    PLAIN_TURNED,
    PROGRAMS
};
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
                                                  "#define TANGENTS\n",
                                                  "#define TURNED\n",
                                                  "#define PLAIN\n#define TURNED\n"};
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

enum { ENDS = 3 }; /* the map ends where it is to be tried, and a half and a quarter further on */

/* One surface with one picture on it: with one value a vertex and three places of the map's end,
 * and with the vertices twice. */
typedef struct subject {
    wrap_mesh once[ENDS], twice;
    wrap_buffers once_buffers[ENDS], twice_buffers;
    rays truth;
} subject;

static void subject_make(bool torus, double phase, subject *out) {
    static const float turns[ENDS] = {0, 0.5f, 0.25f};
    for (int e = 0; e < ENDS; e++) {
        out->once[e] = wrap_make(torus, false, WRAP_AROUND, WRAP_ACROSS, phase + (double)turns[e]);
        out->once_buffers[e] = wrap_upload(&out->once[e]);
        out->once_buffers[e].turn = turns[e];
    }
    out->twice = wrap_make(torus, true, WRAP_AROUND, WRAP_ACROSS, phase);
    out->twice_buffers = wrap_upload(&out->twice);
    rays_make(&out->twice, &out->truth);
}

static void subject_free(subject *s) {
    rays_free(&s->truth);
    for (int e = 0; e < ENDS; e++) {
        wrap_discard(&s->once_buffers[e]);
        wrap_free(&s->once[e]);
    }
    wrap_discard(&s->twice_buffers);
    wrap_free(&s->twice);
}

static struct {
    uint32_t views, literal, literal_elsewhere, seam_pixels;
    float seam, interior, plain, apart, moved;
} told;

typedef struct pictures {
    slv_image truth;
    uint8_t kinds[ENDS][SIZE * SIZE]; /* of each map */
} pictures;

static void pictures_make(const subject *s, const slv_camera *camera, pictures *out) {
    static slv_reference_hit hits[SIZE * SIZE];
    slv_env env = test_env();
    const slv_reference_frame frame = {.camera = *camera,
                                       .width = SIZE,
                                       .height = SIZE,
                                       .shading = SLV_SHADE_UNLIT,
                                       .samples = SAMPLES};
    MUST(slv_reference_render(s->truth.reference, &env, &frame, &out->truth, NULL, NULL));
    MUST(slv_reference_trace(s->truth.reference, &env, camera, SIZE, SIZE, hits));
    for (int e = 0; e < ENDS; e++)
        classify(&s->once[e], hits, &out->truth, out->kinds[e]);
    for (int i = 0; i < SIZE * SIZE; i++) {
        told.seam_pixels += out->kinds[0][i] == SEAM;
        /* of every pixel of the seam there is a picture in which it is no such thing */
        CHECK_MSG(out->kinds[0][i] != SEAM || out->kinds[1][i] == INTERIOR ||
                      out->kinds[2][i] == INTERIOR,
                  "pixel %d is at the end of all maps", i);
    }
}

/* The same picture of maps that end elsewhere, by the method and plainly, where plain interpolation
 * is right: so each pixel of the seam is an interior one of the same view, with the same error. To
 * `interior` the worst that these pixels have there. */
static void ends_elsewhere(const subject *s, const pictures *p, const wrap_target *target,
                           GLuint texture, const slv_camera *camera, const float *method,
                           float *interior) {
    static float other[4 * SIZE * SIZE];
    const GLuint *programs_of = programs[s->twice.torus];
    for (int e = 1; e < ENDS; e++) {
        const wrap_buffers *buffers = &s->once_buffers[e];
        wrap_picture(target, programs_of[METHOD_TURNED], texture, buffers, camera, 1, other);
        float moved = difference(method, other), plain = 0;
        wrap_picture(target, programs_of[PLAIN_TURNED], texture, buffers, camera, 1, other);
        for (int i = 0; i < 4 * SIZE * SIZE; i++)
            if (p->kinds[0][i / 4] == SEAM && p->kinds[e][i / 4] == INTERIOR) {
                plain = fmaxf(plain, fabsf(method[i] - other[i]));
                if (i % 4 < 3)
                    *interior = fmaxf(*interior, fabsf(other[i] - p->truth.pixels[i]));
            }
        told.moved = fmaxf(told.moved, fmaxf(moved, plain));
        CHECK_MSG(moved <= 1.0f / 255 && plain <= 1.0f / 255,
                  "%g from the map that ends elsewhere, %g from it drawn plainly", (double)moved,
                  (double)plain);
    }
    float there[3];
    measure(method, &p->truth, p->kinds[1], there);
    told.literal_elsewhere += there[SEAM] <= there[INTERIOR];
}

/* One picture in all ways. */
static void compare(const subject *s, const pictures *p, const wrap_target *target, GLuint texture,
                    const slv_camera *camera, const char *what) {
    static float method[4 * SIZE * SIZE], other[4 * SIZE * SIZE];
    const GLuint *programs_of = programs[s->twice.torus];
    const wrap_buffers *once = &s->once_buffers[0], *twice = &s->twice_buffers;
    float worst[3], plain[3];
    wrap_picture(target, programs_of[GRADIENTS], texture, once, camera, 1, method);
    wrap_picture(target, programs_of[PLAIN_GRADIENTS], texture, twice, camera, 1, other);
    float off2 = difference(method, other);
    wrap_picture(target, programs_of[METHOD], texture, once, camera, 1, method);
    wrap_picture(target, programs_of[PLAIN], texture, twice, camera, 1, other);
    float off = difference(method, other);
    CHECK_MSG(off <= 1.0f / 255 && off2 <= 1.0f / 255,
              "%s: %g to duplicated vertices, %g with gradients", what, (double)off, (double)off2);
    measure(method, &p->truth, p->kinds[0], worst);
    told.literal += worst[SEAM] <= worst[INTERIOR];
    ends_elsewhere(s, p, target, texture, camera, method, &worst[INTERIOR]);
    /* they are the same pixels, but for how coordinates are rounded */
    CHECK_MSG(worst[SEAM] <= worst[INTERIOR] + 1e-4f, "%s: %g at the seam, %g elsewhere", what,
              (double)worst[SEAM], (double)worst[INTERIOR]);
    wrap_picture(target, programs_of[PLAIN], texture, once, camera, 1, other);
    measure(other, &p->truth, p->kinds[0], plain);
    told.views++;
    told.seam = fmaxf(told.seam, worst[SEAM]);
    told.interior = fmaxf(told.interior, worst[INTERIOR]);
    told.plain = fmaxf(told.plain, plain[SEAM]);
    told.apart = fmaxf(told.apart, fmaxf(off, off2));
}

/* One shape from one side, with each number of taps and samples. */
static void view(const subject *s, GLuint texture, int azimuth) {
    static const float low[3] = {-1.2f, -0.9f, -1.2f}, high[3] = {1.2f, 0.9f, 1.2f};
    static pictures p;
    const slv_camera camera = slv_camera_orbit(low, high, (float)azimuth, 35, 35, 1);
    pictures_make(s, &camera, &p);
    for (uint32_t msaa = 1; msaa <= 8; msaa *= 2) {
        wrap_target target = wrap_target_make(gl, SIZE, msaa);
        for (uint32_t taps = 1; taps <= 16; taps *= 4) {
            char what[80];
            snprintf(what, sizeof what, "%s from %d, %u taps, %u samples",
                     s->twice.torus ? "torus" : "tube", azimuth, taps, msaa);
            for (int i = 0; i < PROGRAMS; i++)
                wrap_anisotropy(gl, texture, programs[s->twice.torus][i], (float)taps);
            compare(s, &p, &target, texture, &camera, what);
        }
        wrap_target_free(&target);
    }
    slv_image_free(&p.truth);
}

static void turns(bool torus, double phase, GLuint texture) {
    static subject s;
    uint32_t count = test_effort(3);
    const char *name = torus ? "torus" : "tube";
    subject_make(torus, phase, &s);
    CHECK(s.once[0].nverts < s.twice.nverts);
    count = count < 360 ? count : 360;
    memset(&told, 0, sizeof told);
    for (uint32_t i = 0; i < count; i++)
        view(&s, texture, (int)(360 * i / count));
    /* the same test knows what is wrong */
    CHECK_MSG(told.plain > 1.5f * told.seam && told.plain > 0.3f && told.seam_pixels > 100,
              "%s: plain interpolation is off by %g only, in %u pixels", name, (double)told.plain,
              told.seam_pixels);
    fprintf(
        stderr,
        "%s, phase %g, %u pictures: seam %.4f, interior %.4f, plain %.3f, apart %.2g, from maps "
        "that end elsewhere %.2g; the seam is not the worst of its own map in %u, where a map "
        "half a turn on ends in %u\n",
        name, phase, told.views, (double)told.seam, (double)told.interior, (double)told.plain,
        (double)told.apart, (double)told.moved, told.literal, told.literal_elsewhere);
    subject_free(&s);
}

/* Two pictures of programs and meshes that are to show the same; ten parameters, since each of the
 * two has its own and all else is shared. */
static void same(const char *what, const wrap_target *target, GLuint texture, GLuint a,
                 const wrap_buffers *mesh_a, GLuint b, const wrap_buffers *mesh_b,
                 const slv_camera *camera, float times, float most) {
    static float first[4 * SIZE * SIZE], second[4 * SIZE * SIZE];
    float sum = 0;
    wrap_picture(target, a, texture, mesh_a, camera, times, first);
    wrap_picture(target, b, texture, mesh_b, camera, times, second);
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
    wrap_target target = wrap_target_make(gl, SIZE, 4);
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

/* Languages without coarse derivatives take the others. */
static void older_languages(void) {
    static const char *const versions[] = {"#version 330 core\n",
                                           "#version 300 es\nprecision highp float;\n"};
    for (size_t i = 0; i < sizeof versions / sizeof *versions; i++)
        wrap_api.DeleteProgram(
            wrap_link(versions[i], include, "#define SLV_WRAP_CHANGE fwidth\n",
                      "in vec2 uv; out vec4 pairs;\n"
                      "void main() { pairs = slv_wrap_pair(uv); gl_Position = vec4(uv, 0, 1); }\n",
                      "in vec4 pairs; out vec4 color;\n"
                      "void main() { color = vec4(slv_wrap(pairs), 0, 1); }\n"));
}

int main(void) {
    slv_env env = test_env();
    in_c();
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    wrap_load(gl);
    make_texels();
    include = wrap_include();
    make_programs();
    older_languages();
    GLuint texture = wrap_texture(texels, WIDTH, HEIGHT);
    turns(false, 0, texture);
    turns(true, 0.3, texture);
    turns(true, 0.5, texture); /* v ends on the inside, where footprints are longest */
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
