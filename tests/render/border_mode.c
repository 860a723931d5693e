/* The border mode black, drawn: every strategy gives what lookups on the CPU give beside a
 * boundary, at corners of it too, and so does the ray-cast reference; periodic is as clamp is; what
 * is white is half as bright on a boundary. */
#include "kit/point_kit.h"
#include "kit/seam_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/reference.h>

static slv_gl *gl;

/* Three quads around a vertex where the mesh is notched, a row beside them, and a quad alone. */
static void make_shape(kit *k, uint64_t *random) {
    static const int32_t quads[][4] = {{0, 1, 5, 4}, {1, 2, 6, 5},   {2, 3, 7, 6},
                                       {4, 5, 9, 8}, {6, 7, 11, 10}, {12, 13, 15, 14}};
    memset(k, 0, sizeof *k);
    for (size_t i = 0; i < sizeof quads / sizeof *quads; i++)
        kit_poly(k, 4, quads[i], test_random(random) % 4);
    kit_finish(k);
    kit_equal(k, LOG2_SIDE);
    kit_noise(k, SLV_TYPE_U8, 3, random);
}

static float depth(unsigned edge, float u, float v) {
    const float of[4] = {v, 1 - u, 1 - v, u};
    return of[edge & 3];
}

/* Whether a lookup is about something else than boundaries: it reaches a neighbour, and the
 * strategy none; or a vertex around which faces agree on a value of their own. */
static bool is_other(const kit *k, const slv_strategy *strategy, const points *p, int i,
                     int level) {
    const slv_face_adjacency *a = &slv_adjacency_faces(k->adjacency)[p->faces[i]];
    const float reach = ldexpf(0.51f, level - LOG2_SIDE);
    bool alone =
        strategy && strategy->form == slv_form_bare &&
        (strategy->reach == SLV_GL_REACH_OWN || (level && strcmp(strategy->name, "hybrid") == 0));
    for (unsigned e = 0; e < 4; e++) {
        uint32_t position;
        slv_ring ring = slv_adjacency_ring(k->adjacency, p->faces[i], e, &position);
        bool reached = depth(e, p->uv[2 * i], p->uv[2 * i + 1]) < reach;
        if (reached && ((alone && a->face[e] >= 0) ||
                        (depth(e + 3, p->uv[2 * i], p->uv[2 * i + 1]) < reach && ring.count > 2)))
            return true;
    }
    return false;
}

static void check_lookups(slv_border_mode u, slv_border_mode v, int level, uint64_t *random) {
    static points p;
    static float values[4 * POINTS];
    slv_env env = test_env();
    const float most = level ? 6.0f / 255 : 2.5f / 255;
    kit k;
    make_shape(&k, random);
    points_place(&k, level, random, &p);
    points_look_up(&k, &(slv_ptx_write_params){.border_u = u, .border_v = v}, &p);
    slv_gl_texture *texture =
        seam_upload(gl, &k, (slv_gl_texture_params){.border_u = u, .border_v = v});
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        const slv_strategy *strategy = slv_strategy_at(s);
        uint32_t looked = 0;
        if (strategy->resampled)
            continue;
        REQUIRE(slv_gl_texture_lookup(texture, &env, strategy, POINTS, p.faces, p.uv, p.dx, p.dy,
                                      values) == SLV_OK);
        for (int i = 0; i < POINTS; i++) {
            if (is_other(&k, strategy, &p, i, level))
                continue;
            looked++;
            CHECK(fabsf(values[4 * i + 3] - 1) <= kit_weight_step(gl));
            for (int c = 0; c < 3; c++)
                CHECK_MSG(fabsf(values[4 * i + c] - p.expected[4 * i + c]) < most,
                          "%s, %s %s, level %d: face %d at %g %g: %g, on the CPU %g",
                          strategy->name, slv_border_mode_name(u), slv_border_mode_name(v), level,
                          p.faces[i], (double)p.uv[2 * i], (double)p.uv[2 * i + 1],
                          (double)values[4 * i + c], (double)p.expected[4 * i + c]);
        }
        CHECK_MSG(looked > POINTS / 3, "%s: %u points", strategy->name, looked);
    }
    slv_gl_texture_destroy(texture);
    kit_free(&k);
}

/* The same of rays, which look at level 0. The mesh is a plane, where a surface is. */
static void check_rays(slv_border_mode u, slv_border_mode v, uint64_t *random) {
    static points p;
    static slv_surface_point points_of[POINTS];
    static float rgb[3 * POINTS];
    slv_env env = test_env();
    slv_surface *surface = NULL;
    slv_reference *reference = NULL;
    kit k;
    make_shape(&k, random);
    points_place(&k, 0, random, &p);
    points_look_up(&k, &(slv_ptx_write_params){.border_u = u, .border_v = v}, &p);
    for (int i = 0; i < POINTS; i++)
        points_of[i] = (slv_surface_point){p.faces[i], p.uv[2 * i], p.uv[2 * i + 1]};
    REQUIRE(slv_surface_create(&env, k.mesh, NULL, &surface) == SLV_OK);
    REQUIRE(
        slv_reference_create(&env, k.mesh, surface, k.texture, k.adjacency,
                             &(slv_reference_params){.segments = 2, .border_u = u, .border_v = v},
                             &reference) == SLV_OK);
    REQUIRE(slv_reference_lookup(reference, POINTS, points_of, rgb) == SLV_OK);
    for (int i = 0; i < POINTS; i++)
        for (int c = 0; c < 3 && !is_other(&k, NULL, &p, i, 0); c++)
            CHECK_MSG(fabsf(rgb[3 * i + c] - p.expected[4 * i + c]) < 0.5f / 255,
                      "rays, %s %s: face %d at %g %g: %g, on the CPU %g", slv_border_mode_name(u),
                      slv_border_mode_name(v), p.faces[i], (double)p.uv[2 * i],
                      (double)p.uv[2 * i + 1], (double)rgb[3 * i + c],
                      (double)p.expected[4 * i + c]);
    slv_reference_destroy(reference);
    slv_surface_destroy(surface);
    kit_free(&k);
}

/* White faces and sub-faces of mixed sizes: half is left on the boundary, a quarter where a face
 * ends on two sides, all of it inside; whatever the strategy. */
static void check_white(uint64_t *random) {
    static const float places[3][2] = {{0.5f, 0}, {0, 0}, {0.5f, 0.5f}};
    static int32_t faces[POINTS];
    static float uv[2 * POINTS], step[2 * POINTS], values[4 * POINTS], left[POINTS];
    slv_env env = test_env();
    const float white[4] = {1, 1, 1, 1};
    uint32_t count = 0;
    kit k;
    kit_grid(&k, 3, 3, false, 40, random, NULL);
    kit_mixed(&k, 3, random);
    kit_begin_texture(&k, SLV_TYPE_FLOAT, 4);
    for (uint32_t f = 0; f < k.nfaces; f++)
        REQUIRE(slv_texture_set_constant(k.texture, f, white) == SLV_OK);
    for (uint32_t f = 0; f < k.nfaces; f++)
        for (unsigned e = 0; e < 12; e++) {
            const int32_t *across = slv_adjacency_faces(k.adjacency)[f].face;
            const float *place = places[e / 4];
            float u, v;
            if (across[e & 3] >= 0 || (e / 4 == 1 && across[(e + 3) & 3] >= 0) || count == POINTS)
                continue;
            kit_edge_point_float(e & 3, place[0], &u, &v);
            faces[count] = (int32_t)f;
            uv[2 * count] = place[1] > 0 ? 0.5f : u;
            uv[2 * count + 1] = place[1] > 0 ? 0.5f : v;
            step[2 * count] = step[2 * count + 1] = 1e-4f;
            left[count++] = e / 4 == 0 ? 0.5f : e / 4 == 1 ? 0.25f : 1;
        }
    slv_gl_texture *texture = seam_upload(
        gl, &k,
        (slv_gl_texture_params){.border_u = SLV_BORDER_BLACK, .border_v = SLV_BORDER_BLACK});
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        const slv_strategy *strategy = slv_strategy_at(s);
        REQUIRE(slv_gl_texture_lookup(texture, &env, strategy, count, faces, uv, step, step,
                                      values) == SLV_OK);
        for (uint32_t i = 0; i < 4 * count; i++)
            CHECK_MSG(fabsf(values[i] - left[i / 4]) < 0.01f, "%s: %g and not %g at face %d, %g %g",
                      strategy->name, (double)values[i], (double)left[i / 4], faces[i / 4],
                      (double)uv[i / 4 * 2], (double)uv[i / 4 * 2 + 1]);
    }
    slv_gl_texture_destroy(texture);
    kit_free(&k);
}

/* What does not exist is refused. */
static void check_refusals(uint64_t *random) {
    slv_env env = test_env();
    slv_gl_texture *texture = NULL;
    kit k;
    make_shape(&k, random);
    const slv_gl_texture_params params = {.border_v = (slv_border_mode)3};
    CHECK(slv_gl_texture_create(gl, &env, k.texture, k.adjacency, &params, &texture) ==
          SLV_ERROR_ARGUMENT);
    CHECK(!texture);
    kit_free(&k);
}

int main(void) {
    static const slv_border_mode modes[][2] = {{SLV_BORDER_BLACK, SLV_BORDER_BLACK},
                                               {SLV_BORDER_BLACK, SLV_BORDER_CLAMP},
                                               {SLV_BORDER_PERIODIC, SLV_BORDER_BLACK},
                                               {SLV_BORDER_PERIODIC, SLV_BORDER_PERIODIC}};
    uint64_t random = 31;
    slv_env env = test_env();
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    for (size_t m = 0; m < sizeof modes / sizeof *modes; m++) {
        check_lookups(modes[m][0], modes[m][1], 0, &random);
        check_lookups(modes[m][0], modes[m][1], 1, &random);
        check_rays(modes[m][0], modes[m][1], &random);
    }
    check_white(&random);
    check_refusals(&random);
    slv_gl_destroy(gl);
    return test_end();
}
