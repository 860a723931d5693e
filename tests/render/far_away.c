/* A mesh far from zero is drawn, traced and carried over as the same one near it is: floats of its
 * own coordinates would not do. */
#include "kit/reference_kit.h"

#include <selvage/gl_renderer.h>
#include <selvage/ptx_writer.h>
#include <selvage/transfer.h>

#include <unistd.h>

enum { SIZE = 96 };

/* Whole metres of a map, 132 km away, and 4000 km with decimals; the last is near. */
static const double places[][3] = {
    {131072, -131072, 65536}, {500000.37, 4000000.123, 31.7}, {-4e6, 3e6, -2e6}, {0, 0, 0}};
enum { PLACES = sizeof places / sizeof *places, NEAR = PLACES - 1 };

static void move_obj(const double by[3], char *out, size_t room) {
    const char *at = box_obj;
    size_t size = 0;
    while (*at) {
        double x, y, z;
        int taken = (int)strcspn(at, "\n") + 1;
        if (sscanf(at, "v %lf %lf %lf", &x, &y, &z) == 3)
            size += (size_t)snprintf(out + size, room - size, "v %.6f %.6f %.6f\n", x + by[0],
                                     y + by[1], z + by[2]);
        else
            size += (size_t)snprintf(out + size, room - size, "%.*s", taken, at);
        at += taken;
    }
    REQUIRE(size < room);
}

static void bounds_of(const slv_mesh *mesh, float low[3], float high[3]) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    for (int c = 0; c < 3; c++) {
        low[c] = INFINITY;
        high[c] = -INFINITY;
        for (uint32_t v = 0; v < view->nverts; v++) {
            low[c] = fminf(low[c], view->positions[3 * v + (uint32_t)c]);
            high[c] = fmaxf(high[c], view->positions[3 * v + (uint32_t)c]);
        }
    }
}

static slv_image draw(slv_gl *gl, const model *m, const slv_camera *camera) {
    slv_env env = test_env();
    slv_image image = {0};
    slv_gl_texture *texture = NULL;
    slv_gl_renderer *renderer = NULL;
    const slv_frame frame = {.camera = *camera, .width = SIZE, .height = SIZE, .msaa = 4};
    REQUIRE(!slv_gl_texture_create(gl, &env, m->texture, m->adjacency, NULL, &texture));
    REQUIRE(!slv_gl_renderer_create(gl, &env, m->mesh, m->surface, SEGMENTS, &renderer));
    REQUIRE(!slv_gl_renderer_draw(renderer, &env, texture, &frame, &image, NULL));
    slv_gl_renderer_destroy(renderer);
    slv_gl_texture_destroy(texture);
    return image;
}

static double rmse(const slv_image *a, const slv_image *b) {
    double sum = 0;
    size_t count = (size_t)4 * SIZE * SIZE;
    for (size_t i = 0; i < count; i++) {
        double difference = (double)a->pixels[i] - (double)b->pixels[i];
        sum += difference * difference;
    }
    return sqrt(sum / (double)count);
}

/* Faces keep their texels where the model did not change, and get them where all of it is
 * resampled.
 */
static void carry_over(const model *from, const model *to) {
    slv_env env = test_env();
    for (int copies = 0; copies < 2; copies++) {
        slv_transfer_face faces[64];
        const slv_transfer_params params = {.no_copies = !copies, .max_distance = 0.03f};
        slv_texture *moved = NULL;
        float covered = 0;
        REQUIRE(!slv_transfer(&env, from->mesh, from->texture, to->mesh, &params, faces, &covered,
                              &moved));
        CHECK(covered > 0.9999f);
        CHECK(faces[0].kind == (copies ? SLV_TRANSFER_COPIED : SLV_TRANSFER_RESAMPLED));
        CHECK(faces[0].source == 0);
        slv_texture_destroy(moved);
    }
}

/* The geometry inside a .ptx is floats from zero: what those hold comes back to the bit. */
static void through_ptx(const model *m) {
    slv_env env = test_env();
    char path[256];
    slv_ptx *ptx = NULL;
    slv_mesh *mesh = NULL;
    snprintf(path, sizeof path, "%s/selvage-far-%ld.ptx", test_parent(), (long)getpid());
    REQUIRE(!slv_ptx_save(&env, path, m->texture, m->adjacency,
                          &(slv_ptx_write_params){.mesh = m->mesh}));
    REQUIRE(!slv_ptx_open(&env, path, &ptx));
    REQUIRE(!slv_ptx_load_mesh(&env, ptx, &mesh));
    const slv_ptx_meta *meta = slv_ptx_find_meta(ptx, "PtexVertPositions");
    const slv_mesh_view *view = slv_mesh_get_view(mesh), *was = slv_mesh_get_view(m->mesh);
    REQUIRE(meta && view->nverts == was->nverts && meta->count == 3 * view->nverts);
    for (uint32_t i = 0; i < meta->count; i++) {
        float inside = ((const float *)meta->values)[i];
        CHECK(inside == (float)((double)was->positions[i] + was->origin[i % 3]));
        CHECK((double)inside == (double)view->positions[i] + view->origin[i % 3]);
    }
    slv_mesh_destroy(mesh);
    slv_ptx_close(ptx);
    unlink(path);
}

int main(void) {
    const slv_procedural noise = {.pattern = SLV_PATTERN_NOISE, .frequency = 2};
    slv_env env = test_env();
    slv_gl *gl = NULL;
    model models[PLACES];
    slv_image drawn[PLACES], traced[PLACES];
    REQUIRE(!slv_gl_create(&env, SLV_GL_AUTO, &gl));
    for (int i = NEAR; i >= 0; i--) {
        char obj[4096];
        float low[3], high[3];
        move_obj(places[i], obj, sizeof obj);
        models[i] = make_model(obj, SLV_SCHEME_CATMARK, &noise, 3, 4);
        for (uint32_t face = 0; i != NEAR && face < slv_mesh_face_count(models[i].mesh); face++)
            REQUIRE(!slv_texture_set_face(models[i].texture, face,
                                          slv_texture_texels(models[NEAR].texture, face)));
        slv_reference_destroy(models[i].reference);
        models[i].reference = NULL;
        REQUIRE(!slv_reference_create(
            &env, models[i].mesh, models[i].surface, models[i].texture, models[i].adjacency,
            &(slv_reference_params){.segments = SEGMENTS}, &models[i].reference));
        bounds_of(models[i].mesh, low, high);
        const slv_camera camera = slv_camera_orbit(low, high, 30, 20, 35, 1);
        const slv_reference_frame frame = {
            .camera = camera, .width = SIZE, .height = SIZE, .samples = 16};
        drawn[i] = draw(gl, &models[i], &camera);
        traced[i] = render(&models[i], &frame, 1);
        double a = rmse(&drawn[i], &drawn[NEAR]), b = rmse(&traced[i], &traced[NEAR]);
        fprintf(stderr, "%g %g %g away: drawn %.6f off, traced %.6f\n", places[i][0], places[i][1],
                places[i][2], a, b);
        CHECK(a < 0.002 && b < 0.002);
        const double *origin = slv_mesh_get_view(models[i].mesh)->origin;
        CHECK((origin[0] == 0 && origin[1] == 0) == (i == NEAR));
        carry_over(&models[i], &models[i]);
        through_ptx(&models[i]);
    }
    for (int i = 0; i < PLACES; i++) {
        slv_image_free(&drawn[i]);
        slv_image_free(&traced[i]);
        free_model(&models[i]);
    }
    slv_gl_destroy(gl);
    return test_end();
}
