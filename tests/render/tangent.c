/* Vectors in the frames of faces, drawn: those of neighbours are turned at edges by every strategy
 * and by rays as lookups on the CPU turn them, and a field that is one vector everywhere on a plane
 * stays one whatever the frames and resolutions. */
#include "kit/point_kit.h"
#include "kit/seam_kit.h"
#include "kit/strategy_kit.h"

#include <selvage/reference.h>

static slv_gl *gl;
static const slv_ptx_write_params tanvec = {.edge_filter = SLV_EDGE_FILTER_TANVEC};

/* A vector in the frame of a face seen from another one. */
typedef struct turn {
    float xx, xy, yx, yy;
} turn;

static void apply(const turn *t, float *v) {
    float x = v[0], y = v[1];
    v[0] = t->xx * x + t->xy * y;
    v[1] = t->yx * x + t->yy * y;
}

/* The map across an edge is of places and leads away: its transpose brings vectors back. */
static turn turn_across(const slv_neighbour *to) {
    float by = 1 / (fabsf(to->map.uu) + fabsf(to->map.uv));
    return (turn){by * to->map.uu, by * to->map.vu, by * to->map.uv, by * to->map.vv};
}

static slv_gl_texture *upload(const kit *k) {
    return seam_upload(gl, k,
                       (slv_gl_texture_params){.encoding = SLV_TEXTURE_DATA,
                                               .edge_filter = SLV_EDGE_FILTER_TANVEC});
}

/* Whether a strategy looks at neighbours for such lookups. */
static bool crosses(const slv_strategy *strategy, int level) {
    return strategy->form != slv_form_bare || (strategy->reach != SLV_GL_REACH_OWN &&
                                               !(level && strcmp(strategy->name, "hybrid") == 0));
}

static float depth_of(const points *p, int i) {
    float u = p->uv[2 * i], v = p->uv[2 * i + 1];
    return fminf(fminf(u, 1 - u), fminf(v, 1 - v));
}

/* A closed mesh of four faces around each vertex, each begun at any of its vertices. */
static void check_lookups(slv_type type, uint32_t nchannels, int level, uint64_t *random) {
    static points p;
    static float values[4 * POINTS];
    slv_env env = test_env();
    const float reach = ldexpf(0.51f, level - LOG2_SIDE), most = level ? 6.0f / 255 : 2.5f / 255;
    kit k;
    kit_grid(&k, 4, 3, true, 0, random, NULL);
    kit_equal(&k, LOG2_SIDE);
    kit_noise(&k, type, nchannels, random);
    points_place(&k, level, random, &p);
    points_look_up(&k, &tanvec, &p);
    slv_gl_texture *texture = upload(&k);
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        const slv_strategy *strategy = slv_strategy_at(s);
        uint32_t crossed = 0;
        if (strategy->resampled)
            continue;
        REQUIRE(slv_gl_texture_lookup(texture, &env, strategy, POINTS, p.faces, p.uv, p.dx, p.dy,
                                      values) == SLV_OK);
        for (int i = 0; i < POINTS; i++) {
            if (depth_of(&p, i) < reach && !crosses(strategy, level))
                continue;
            crossed += depth_of(&p, i) < reach;
            for (uint32_t c = 0; c < nchannels && c < 3; c++)
                CHECK_MSG(fabsf(values[4 * i + c] - p.expected[4 * i + c]) < most,
                          "%s, %s, level %d: face %d at %g %g: %g, on the CPU %g", strategy->name,
                          slv_type_name(type), level, p.faces[i], (double)p.uv[2 * i],
                          (double)p.uv[2 * i + 1], (double)values[4 * i + c],
                          (double)p.expected[4 * i + c]);
        }
        CHECK_MSG(crossed > POINTS / 3 || !crosses(strategy, level), "%s: %u points",
                  strategy->name, crossed);
    }
    slv_gl_texture_destroy(texture);
    kit_free(&k);
}

/* Rays look at level 0 of a mesh with a shape. */
static void check_rays(slv_type type, uint64_t *random) {
    static points p;
    static slv_surface_point at[POINTS];
    static float rgb[3 * POINTS];
    slv_env env = test_env();
    slv_surface *surface = NULL;
    slv_reference *reference = NULL;
    kit k;
    kit_grid(&k, 4, 3, true, 0, random, NULL);
    kit_equal(&k, LOG2_SIDE);
    kit_noise(&k, type, 3, random);
    points_place(&k, 0, random, &p);
    points_look_up(&k, &tanvec, &p);
    for (int i = 0; i < POINTS; i++)
        at[i] = (slv_surface_point){p.faces[i], p.uv[2 * i], p.uv[2 * i + 1]};
    REQUIRE(slv_surface_create(&env, k.mesh, NULL, &surface) == SLV_OK);
    REQUIRE(slv_reference_create(&env, k.mesh, surface, k.texture, k.adjacency,
                                 &(slv_reference_params){.segments = 2,
                                                         .encoding = SLV_TEXTURE_DATA,
                                                         .edge_filter = SLV_EDGE_FILTER_TANVEC},
                                 &reference) == SLV_OK);
    REQUIRE(slv_reference_lookup(reference, POINTS, at, rgb) == SLV_OK);
    for (int i = 0; i < POINTS; i++)
        for (int c = 0; c < 3; c++)
            CHECK_MSG(fabsf(rgb[3 * i + c] - p.expected[4 * i + c]) < 0.5f / 255,
                      "rays, %s: face %d at %g %g: %g, on the CPU %g", slv_type_name(type),
                      p.faces[i], (double)p.uv[2 * i], (double)p.uv[2 * i + 1],
                      (double)rgb[3 * i + c], (double)p.expected[4 * i + c]);
    slv_reference_destroy(reference);
    slv_surface_destroy(surface);
    kit_free(&k);
}

/* Of each face, as face 0 sees it. */
static void find_frames(const kit *k, turn *turns) {
    static uint32_t queue[KIT_POLYS];
    static bool seen[KIT_POLYS];
    uint32_t count = 1;
    memset(seen, 0, sizeof seen);
    seen[0] = true;
    queue[0] = 0;
    turns[0] = (turn){1, 0, 0, 1};
    for (uint32_t i = 0; i < count; i++) {
        const turn *own = &turns[queue[i]];
        for (unsigned e = 0; e < 4; e++) {
            slv_neighbour to[2];
            if (!slv_adjacency_neighbours(k->adjacency, (int32_t)queue[i], e, to) || seen[to->face])
                continue;
            turn next = turn_across(to);
            float x[2] = {next.xx, next.yx}, y[2] = {next.xy, next.yy};
            apply(own, x);
            apply(own, y);
            turns[to->face] = (turn){x[0], y[0], x[1], y[1]};
            seen[to->face] = true;
            queue[count++] = (uint32_t)to->face;
        }
    }
}

/* One vector in the plane, whatever the faces' resolutions. */
static void check_field(slv_type type, uint64_t *random) {
    static points p;
    static float values[4 * POINTS], texels[2 * (1 << 2 * LOG2_SIDE)];
    static turn turns[KIT_POLYS];
    slv_env env = test_env();
    kit k;
    kit_grid(&k, 4, 4, true, 0, random, NULL);
    kit_mixed(&k, LOG2_SIDE, random);
    kit_begin_texture(&k, type, 2);
    find_frames(&k, turns);
    for (uint32_t f = 0; f < k.nfaces; f++) {
        const turn *t = &turns[f], back = {t->xx, t->yx, t->xy, t->yy};
        for (size_t i = 0; i < kit_texels(k.res[f]); i++) {
            texels[2 * i] = 0.75f;
            texels[2 * i + 1] = 0.25f;
            apply(&back, &texels[2 * i]);
        }
        kit_set(&k, f, texels);
    }
    kit_end_texture(&k);
    slv_gl_texture *texture = upload(&k);
    for (int level = 0; level < 3; level++) {
        points_place(&k, level, random, &p);
        for (uint32_t s = 0; s < slv_strategy_count(); s++) {
            const slv_strategy *strategy = slv_strategy_at(s);
            REQUIRE(slv_gl_texture_lookup(texture, &env, strategy, POINTS, p.faces, p.uv, p.dx,
                                          p.dy, values) == SLV_OK);
            for (int i = 0; i < POINTS; i++) {
                float *v = &values[4 * i];
                apply(&turns[p.faces[i]], v);
                CHECK_MSG(fabsf(v[0] - 0.75f) < 2e-3f && fabsf(v[1] - 0.25f) < 2e-3f,
                          "%s, %s, level %d: face %d (%d x %d) at %g %g: %g %g", strategy->name,
                          slv_type_name(type), level, p.faces[i], 1 << k.res[p.faces[i]].u,
                          1 << k.res[p.faces[i]].v, (double)p.uv[2 * i], (double)p.uv[2 * i + 1],
                          (double)v[0], (double)v[1]);
            }
        }
    }
    slv_gl_texture_destroy(texture);
    kit_free(&k);
}

/* Points on edges as one side sees them or as the other does, away from vertices around which there
 * may be no one vector. */
static void place_on_edges(const kit *k, bool other, points *p, turn *turns) {
    uint64_t random = 77;
    for (int i = 0; i < POINTS; i++) {
        slv_neighbour to[2];
        uint32_t face = 0, count = 0;
        unsigned e = 0;
        float u, v;
        while (!count) {
            face = (uint32_t)(test_random(&random) % k->nfaces);
            e = test_random(&random) % 4;
            count = slv_adjacency_neighbours(k->adjacency, (int32_t)face, e, to);
        }
        const slv_neighbour *at = &to[test_random(&random) % count];
        kit_edge_point_float(
            e, at->t0 + (0.3f + 0.4f * points_uniform(&random)) * (at->t1 - at->t0), &u, &v);
        turns[i] = turn_across(at);
        if (other)
            slv_affine_apply(&at->map, u, v, &u, &v);
        p->faces[i] = other ? at->face : (int32_t)face;
        p->uv[2 * i] = u;
        p->uv[2 * i + 1] = v;
        p->dx[2 * i] = p->dy[2 * i + 1] = 1e-4f;
        p->dx[2 * i + 1] = p->dy[2 * i] = 0;
    }
}

/* Both sides of an edge have one vector there, also beside sub-faces. */
static void check_edges(bool mixed, uint64_t *random) {
    static points p[2];
    static float values[2][4 * POINTS];
    static turn turns[POINTS];
    slv_env env = test_env();
    kit k;
    kit_grid(&k, 4, 4, false, 40, random, NULL);
    kit_equal(&k, LOG2_SIDE);
    for (uint32_t f = 0; mixed && f < k.nfaces; f++)
        k.res[f].u = k.res[f].v = (int8_t)(2 + test_random(random) % 2);
    kit_noise(&k, SLV_TYPE_FLOAT, 2, random);
    place_on_edges(&k, false, &p[0], turns);
    place_on_edges(&k, true, &p[1], turns);
    slv_gl_texture *texture = upload(&k);
    for (uint32_t s = 0; s < slv_strategy_count(); s++) {
        const slv_strategy *strategy = slv_strategy_at(s);
        if (!crosses(strategy, 0))
            continue;
        for (int side = 0; side < 2; side++)
            REQUIRE(slv_gl_texture_lookup(texture, &env, strategy, POINTS, p[side].faces,
                                          p[side].uv, p[side].dx, p[side].dy,
                                          values[side]) == SLV_OK);
        /* beside longer texels borders agree at texel centres, and between them nearly */
        const float most = mixed && strategy->form == slv_form_borders ? 0.25f : 1e-2f;
        float apart = 0;
        for (int i = 0; i < POINTS; i++) {
            float *own = &values[0][4 * i], *other = &values[1][4 * i];
            apply(&turns[i], other);
            CHECK_MSG(fabsf(own[0] - other[0]) < most && fabsf(own[1] - other[1]) < most,
                      "%s%s: face %d at %g %g: %g %g, from the other side, face %d, %g %g",
                      strategy->name, mixed ? ", mixed" : "", p[0].faces[i], (double)p[0].uv[2 * i],
                      (double)p[0].uv[2 * i + 1], (double)own[0], (double)own[1], p[1].faces[i],
                      (double)other[0], (double)other[1]);
            apart += fabsf(own[0] - other[0]) + fabsf(own[1] - other[1]);
        }
        CHECK_MSG(apart / (2 * POINTS) < 0.02f, "%s: %g on average", strategy->name,
                  (double)apart / (2 * POINTS));
    }
    slv_gl_texture_destroy(texture);
    kit_free(&k);
}

/* What does not exist is refused. */
static void check_refusals(uint64_t *random) {
    slv_env env = test_env();
    slv_gl_texture *texture = NULL;
    kit k;
    kit_grid(&k, 2, 2, false, 0, random, NULL);
    kit_equal(&k, 1);
    kit_noise(&k, SLV_TYPE_U8, 2, random);
    const slv_gl_texture_params none = {.edge_filter = (slv_edge_filter)2};
    CHECK(slv_gl_texture_create(gl, &env, k.texture, k.adjacency, &none, &texture) ==
          SLV_ERROR_ARGUMENT);
    const slv_gl_texture_params blocks = {.edge_filter = SLV_EDGE_FILTER_TANVEC,
                                          .compression = SLV_GL_COMPRESSION_BLOCKS};
    CHECK(slv_gl_texture_create(gl, &env, k.texture, k.adjacency, &blocks, &texture) ==
          SLV_ERROR_UNSUPPORTED);
    CHECK(!texture);
    kit_free(&k);
}

int main(void) {
    uint64_t random = 41;
    slv_env env = test_env();
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    for (int level = 0; level < 2; level++) {
        check_lookups(SLV_TYPE_FLOAT, 3, level, &random);
        check_lookups(SLV_TYPE_U16, 2, level, &random);
        check_lookups(SLV_TYPE_U8, 4, level, &random);
    }
    check_rays(SLV_TYPE_FLOAT, &random);
    check_rays(SLV_TYPE_U8, &random);
    check_field(SLV_TYPE_FLOAT, &random);
    check_field(SLV_TYPE_HALF, &random);
    check_edges(false, &random);
    check_edges(true, &random);
    check_refusals(&random);
    slv_gl_destroy(gl);
    return test_end();
}
