/* The anisotropic filter: the same from both sides of every edge, whatever meets there, and the
 * ellipse that it says it is. */
#include "kit/filter_kit.h"

static slv_sampler *sampler;
static slv_cache *cache;
static char path[1100];

static slv_file_id begin(kit *k, const slv_filter_params *params) {
    snprintf(path, sizeof path, "%s", scratch_path("anisotropic.ptx"));
    kit_save(k, path, NULL);
    cache = kit_cache(0, 0);
    slv_file_id id = kit_open(cache, path);
    sampler = kit_sampler(cache, params);
    return id;
}

static void end(void) {
    slv_sampler_destroy(sampler);
    slv_cache_destroy(cache);
    unlink(path);
}

static float sample(const slv_lookup *l) {
    float out = -1;
    CHECK(slv_sample(sampler, l, &out) == SLV_OK);
    return out;
}

/* Footprints of all kinds: along the edge and across it, diagonal, long, and tiny. */
static void any_footprint(slv_lookup *l, unsigned edge, uint64_t *random) {
    float size = powf(2, 1 - 8 * kit_unit(random)), a[2], b[2],
          thin = powf(2, -5 * kit_unit(random));
    switch (test_random(random) % 4) {
    case 0: /* parallel to the edge */
        a[0] = 1, a[1] = 0, b[0] = 0, b[1] = thin;
        break;
    case 1: /* across it */
        a[0] = 0, a[1] = 1, b[0] = thin, b[1] = 0;
        break;
    case 2:
        a[0] = a[1] = b[1] = thin, b[0] = -thin;
        a[0] = a[1] = 1;
        break;
    default:
        a[0] = kit_unit(random) - 0.5f, a[1] = kit_unit(random) - 0.5f;
        b[0] = kit_unit(random) - 0.5f, b[1] = kit_unit(random) - 0.5f;
    }
    bool upright = edge & 1;
    l->uw1 = size * a[upright], l->vw1 = size * a[!upright];
    l->uw2 = size * b[upright], l->vw2 = size * b[!upright];
}

/* The same lookup as another face sees it. */
static slv_lookup seen_from(const slv_lookup *l, const slv_neighbour *there) {
    slv_lookup o = *l;
    const slv_affine *m = &there->map;
    o.face = (uint32_t)there->face;
    slv_affine_apply(m, l->u, l->v, &o.u, &o.v);
    o.uw1 = m->uu * l->uw1 + m->uv * l->vw1, o.vw1 = m->vu * l->uw1 + m->vv * l->vw1;
    o.uw2 = m->uu * l->uw2 + m->uv * l->vw2, o.vw2 = m->vu * l->uw2 + m->vv * l->vw2;
    return o;
}

static double seam_jump(const kit *k, slv_file_id id, uint32_t count, uint64_t *random) {
    double worst = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t face = test_random(random) % k->nfaces, edge = test_random(random) % 4;
        double t = kit_unit(random), u, v;
        slv_neighbour to[2];
        /* near the vertices too, and at them */
        if (i % 3 == 0)
            t *= pow(2, -14 * (double)kit_unit(random));
        else if (i % 3 == 1)
            t = floor(33 * t) / 32;
        kit_edge_point(edge, t > 1 ? 1 : t, &u, &v);
        slv_lookup l = {.file = id, .face = face, .u = (float)u, .v = (float)v};
        any_footprint(&l, edge, random);
        uint32_t n = slv_adjacency_neighbours(k->adjacency, (int32_t)face, edge, to);
        for (uint32_t j = 0; j < n; j++) {
            if (t < (double)to[j].t0 || t > (double)to[j].t1)
                continue;
            slv_lookup other = seen_from(&l, &to[j]);
            other.u = fminf(fmaxf(other.u, 0), 1);
            other.v = fminf(fmaxf(other.v, 0), 1);
            double jump = fabs((double)sample(&l) - (double)sample(&other));
            worst = fmax(worst, jump);
        }
    }
    return worst;
}

static void test_seams(void) {
    uint64_t random = 67;
    const slv_filter_params params[] = {{.filter = SLV_FILTER_ANISOTROPIC},
                                        {.filter = SLV_FILTER_ANISOTROPIC, .blur = 0.02f}};
    for (int shape = 2; shape < 20; shape++)
        for (int mixed = 0; mixed < 3; mixed++) {
            kit k;
            if (shape < 15)
                kit_disc(&k, shape, &random);
            else if (shape == 15)
                kit_cube(&k, &random);
            else if (shape == 16)
                kit_pentagons(&k, &random);
            else
                kit_grid(&k, 4, 4, shape == 18, shape == 19 ? 100 : 40, &random, NULL);
            if (mixed == 1)
                kit_mixed(&k, 5, &random);
            else
                kit_equal(&k, 5);
            for (uint32_t i = 0; mixed == 2 && i < k.nfaces; i++)
                k.res[i].v = (int8_t)(test_random(&random) % 6);
            kit_noise(&k, SLV_TYPE_FLOAT, 1, &random);
            slv_file_id id = begin(&k, &params[shape & 1]);
            double worst = seam_jump(&k, id, TEST_SANITIZED ? 300 : 3000, &random);
            CHECK_MSG(worst <= 1e-5, "shape %d, mixed %d: jumps by %g", shape, mixed, worst);
            if (getenv("SHOW"))
                printf("shape %d mixed %d: %g\n", shape, mixed, worst);
            end();
            kit_free(&k);
        }
}

/* Texels of a flat grid of 3x3 faces, each of which begins at any of its corners; and how far the
 * filter is from what it should be: at (x,y) of the grid, with a footprint in the grid's units. */
enum { SIDE = 3, LOG2 = 5, SIZE = 1 << LOG2 };

static double grid[SIDE * SIZE][SIDE * SIZE];
static uint32_t turns[SIDE * SIDE];

static void from_grid(uint32_t turn, double x, double y, float *u, float *v) {
    *u = (float)(turn == 0 ? x : turn == 1 ? y : turn == 2 ? 1 - x : 1 - y);
    *v = (float)(turn == 0 ? y : turn == 1 ? 1 - x : turn == 2 ? 1 - y : x);
}

static slv_file_id write_grid(const slv_filter_params *params, double (*texture)(double, double),
                              uint64_t *random) {
    kit k;
    kit_grid(&k, SIDE, SIDE, false, 0, random, turns);
    kit_equal(&k, LOG2);
    kit_begin_texture(&k, SLV_TYPE_FLOAT, 1);
    for (uint32_t face = 0; face < k.nfaces; face++) {
        static float values[SIZE * SIZE];
        uint32_t column = face % SIDE * SIZE, row = face / SIDE * SIZE;
        for (uint32_t y = 0; y < SIZE; y++)
            for (uint32_t x = 0; x < SIZE; x++) {
                float u, v,
                    value = (float)texture((column + x + 0.5) / SIZE, (row + y + 0.5) / SIZE);
                from_grid(turns[face], (x + 0.5) / SIZE, (y + 0.5) / SIZE, &u, &v);
                values[(int)(v * SIZE) * SIZE + (int)(u * SIZE)] = value;
                grid[row + y][column + x] = (double)value;
            }
        kit_set(&k, face, values);
    }
    kit_end_texture(&k);
    slv_file_id id = begin(&k, params);
    kit_free(&k);
    return id;
}

static float sample_grid(slv_file_id id, double x, double y, const double w[4]) {
    uint32_t column = (uint32_t)x, row = (uint32_t)y, turn = turns[row * SIDE + column];
    slv_lookup l = {.file = id, .face = row * SIDE + column};
    float u0, v0;
    from_grid(turn, 0, 0, &u0, &v0);
    from_grid(turn, x - column, y - row, &l.u, &l.v);
    from_grid(turn, w[0], w[1], &l.uw1, &l.vw1);
    from_grid(turn, w[2], w[3], &l.uw2, &l.vw2);
    l.uw1 -= u0, l.uw2 -= u0, l.vw1 -= v0, l.vw2 -= v0;
    return sample(&l);
}

static uint64_t noise_state;

static double noise(double x, double y) {
    (void)x;
    (void)y;
    return (double)kit_unit(&noise_state);
}

static double plane(double x, double y) {
    return 0.1 * x + 0.07 * y;
}

/* The gaussian of the footprint, with that of a texel added to it, over every texel as a square. */
static double integrate(double x, double y, const double w[4]) {
    /* what is lost by having texels as squares, and as points, is part of what is added */
    const double texel = sqrt(0.7 * 0.7 - 1.0 / 6) / SIZE;
    enum { FINE = 4 };
    double xx = 0.25 * (w[0] * w[0] + w[2] * w[2]) + texel * texel;
    double yy = 0.25 * (w[1] * w[1] + w[3] * w[3]) + texel * texel;
    double xy = 0.25 * (w[0] * w[1] + w[2] * w[3]), det = xx * yy - xy * xy, sum = 0, weights = 0;
    for (int j = 0; j < SIDE * SIZE * FINE; j++)
        for (int i = 0; i < SIDE * SIZE * FINE; i++) {
            double dx = (i + 0.5) / (SIZE * FINE) - x, dy = (j + 0.5) / (SIZE * FINE) - y;
            double weight = exp(-0.5 * (yy * dx * dx - 2 * xy * dx * dy + xx * dy * dy) / det);
            sum += weight * grid[j / FINE][i / FINE];
            weights += weight;
        }
    return sum / weights;
}

static void test_ellipse(void) {
    uint64_t random = 71;
    const slv_filter_params params = {.filter = SLV_FILTER_ANISOTROPIC};
    double worst = 0, mean = 0, spread = 0;
    enum { MANY = 200 };
    noise_state = 73;
    slv_file_id id = write_grid(&params, noise, &random);
    for (int i = 0; i < MANY; i++) {
        /* up to 16 to 1, inside the grid */
        double size = pow(2, -5 * (double)kit_unit(&random)) * 0.4,
               angle = 6.3 * (double)kit_unit(&random);
        double thin = size * pow(2, -4 * (double)kit_unit(&random));
        double w[4] = {size * cos(angle), size * sin(angle), -thin * sin(angle), thin * cos(angle)};
        double x = 1 + (double)kit_unit(&random), y = 1 + (double)kit_unit(&random);
        double right = integrate(x, y, w), error = fabs((double)sample_grid(id, x, y, w) - right);
        worst = fmax(worst, error);
        mean += error / MANY;
        spread += fabs(right - 0.5) / MANY;
    }
    if (getenv("SHOW"))
        printf("ellipse: worst %g mean %g spread %g\n", worst, mean, spread);
    CHECK_MSG(worst < 0.03 && mean < 0.005, "noise: %g from the integral, %g in the mean", worst,
              mean);
    end();

    id = write_grid(&params, plane, &random);
    worst = 0;
    for (int i = 0; i < 20 * MANY; i++) {
        double size = pow(2, -8 * (double)kit_unit(&random)) * 0.5, w[4];
        for (int j = 0; j < 4; j++)
            w[j] = size * ((double)kit_unit(&random) - 0.5);
        double x = 1 + (double)kit_unit(&random), y = 1 + (double)kit_unit(&random);
        worst = fmax(worst, fabs((double)sample_grid(id, x, y, w) - plane(x, y)));
    }
    if (getenv("SHOW"))
        printf("plane: worst %g\n", worst);
    CHECK_MSG(worst < 5e-5, "a plane: %g away", worst);
    end();
}

/* A step of a millionth of a face changes little, wherever it is made: on faces, over edges, and
 * around vertices that take lines apart. */
static void test_steps(void) {
    uint64_t random = 79;
    const slv_filter_params params = {.filter = SLV_FILTER_ANISOTROPIC};
    for (int shape = 2; shape < 16; shape++) {
        const float step = 1e-6f;
        double worst = 0, most = 0;
        kit k;
        if (shape < 13)
            kit_disc(&k, shape, &random);
        else if (shape == 13)
            kit_cube(&k, &random);
        else if (shape == 14)
            kit_pentagons(&k, &random);
        else
            kit_grid(&k, 4, 4, false, 60, &random, NULL);
        kit_equal(&k, 4);
        for (uint32_t i = 0; shape & 1 && i < k.nfaces; i++)
            k.res[i].u = (int8_t)(test_random(&random) % 5);
        kit_noise(&k, SLV_TYPE_FLOAT, 1, &random);
        slv_file_id id = begin(&k, &params);
        for (int i = 0; i < (TEST_SANITIZED ? 500 : 5000); i++) {
            slv_lookup l = {.file = id, .face = test_random(&random) % k.nfaces};
            float near = powf(2, -12 * kit_unit(&random)), angle = 6.2832f * kit_unit(&random);
            l.u = near * kit_unit(&random), l.v = near * kit_unit(&random);
            if (test_random(&random) % 2)
                l.u = 1 - l.u;
            if (test_random(&random) % 2)
                l.v = 1 - l.v;
            any_footprint(&l, i % 4, &random);
            slv_lookup other = l;
            other.u = fminf(fmaxf(other.u + step * cosf(angle), 0), 1);
            other.v = fminf(fmaxf(other.v + step * sinf(angle), 0), 1);
            double moved = hypot((double)other.u - (double)l.u, (double)other.v - (double)l.v);
            double change = fabs((double)sample(&l) - (double)sample(&other));
            if (moved > 0.5e-6)
                worst = fmax(worst, (change - 1e-6) / moved);
            most = fmax(most, change);
        }
        if (getenv("SHOW"))
            printf("steps, shape %d: %g, slope %g\n", shape, most, worst);
        CHECK_MSG(most < 2e-4, "shape %d: a step of %g changes a value by %g", shape, (double)step,
                  most);
        end();
        kit_free(&k);
    }
}

/* One value on a row of faces: what lies beyond their border is as black as it should be, and
 * nothing at all when there is no black. */
static void test_borders(slv_border_mode mode, bool stay) {
    const slv_filter_params params = {.filter = SLV_FILTER_ANISOTROPIC, .no_edge_blend = stay};
    const slv_ptx_write_params how = {.border_u = mode, .border_v = mode};
    uint64_t random = 83;
    kit k;
    kit_grid(&k, 3, 1, false, 0, NULL, NULL);
    kit_equal(&k, 4);
    kit_begin_texture(&k, SLV_TYPE_FLOAT, 2);
    for (uint32_t face = 0; face < k.nfaces; face++) {
        float values[512];
        for (int i = 0; i < 256; i++)
            values[2 * i] = 0.75f, values[2 * i + 1] = (float)i; /* so that it is not constant */
        kit_set(&k, face, values);
    }
    kit_end_texture(&k);
    snprintf(path, sizeof path, "%s", scratch_path("borders.ptx"));
    kit_save(&k, path, &how);
    cache = kit_cache(0, 0);
    slv_file_id id = kit_open(cache, path);
    sampler = kit_sampler(cache, &params);
    bool black = mode == SLV_BORDER_BLACK;
    for (int i = 0; i < 500; i++) {
        float size = 0.5f * powf(2, -8 * kit_unit(&random)), out[2];
        float angle = i % 4 ? 6.3f * kit_unit(&random) : 0;
        float c = size * cosf(angle), n = size * sinf(angle);
        /* the middle of the row's lower border, its corner, and where two faces meet */
        const struct {
            uint32_t face;
            float u, v, share;
        } places[] = {{1, 0.4f, 0, 0.5f},
                      {0, 0, 0, 0.25f},
                      {2, 1, 1, 0.25f},
                      {1, 1, 0.5f, stay ? 0.5f : 1},
                      {1, 0.5f, 0.5f, 1}};
        for (size_t p = 0; p < sizeof places / sizeof *places; p++) {
            slv_lookup l = {id, places[p].face, places[p].u, places[p].v, c,
                            n,  -n * 0.5f,      c * 0.5f};
            /* long ones see more than one border, and slanting ones less of a corner */
            bool exact = p == 1 || p == 2 ? angle < 0.01f : size < 0.05f;
            CHECK(slv_sample(sampler, &l, out) == SLV_OK);
            if (!black)
                CHECK_MSG(fabsf(out[0] - 0.75f) < 2e-6f, "place %d: %g", (int)p, (double)out[0]);
            else if (exact)
                CHECK_MSG(fabsf(out[0] - 0.75f * places[p].share) < 1e-3f, "place %d: %g", (int)p,
                          (double)out[0]);
            else
                CHECK(out[0] > 0 && out[0] < 0.75f + 2e-6f);
            /* the order and the signs of the vectors do not matter */
            slv_lookup other = {id, l.face, l.u, l.v, -l.uw2, -l.vw2, l.uw1, l.vw1};
            float same[2];
            CHECK(slv_sample(sampler, &other, same) == SLV_OK && fabsf(same[0] - out[0]) < 2e-6f);
        }
        slv_lookup outside = {id, 1, 0.5f, -0.25f * kit_unit(&random) - 0.25f, 0.01f, 0, 0, 0.01f};
        CHECK(slv_sample(sampler, &outside, out) == SLV_OK);
        CHECK_MSG(fabsf(out[0] - (black ? 0 : 0.75f)) < 2e-6f, "outside: %g", (double)out[0]);
    }
    end();
    kit_free(&k);
}

/* Six channels, of which the first two are a vector, the same all over a grid of turned faces: each
 * face has it in a frame of its own. */
static void test_vectors(void) {
    enum { CHANNELS = 6, LEVEL = 3, TEXELS = 1 << 2 * LEVEL };
    const slv_ptx_write_params how = {.edge_filter = SLV_EDGE_FILTER_TANVEC};
    const slv_filter_params params = {.filter = SLV_FILTER_ANISOTROPIC};
    uint64_t random = 89;
    kit k;
    kit_grid(&k, SIDE, SIDE, false, 0, &random, turns);
    kit_equal(&k, LEVEL);
    kit_begin_texture(&k, SLV_TYPE_FLOAT, CHANNELS);
    for (uint32_t face = 0; face < k.nfaces; face++) {
        float values[TEXELS * CHANNELS], u0, v0;
        from_grid(turns[face], 0, 0, &u0, &v0);
        for (int i = 0; i < TEXELS; i++) {
            float *texel = values + CHANNELS * i, grey = kit_unit(&random);
            from_grid(turns[face], 0.75, 0.25, &texel[0], &texel[1]);
            texel[0] -= u0, texel[1] -= v0;
            for (int c = 2; c < CHANNELS; c++)
                texel[c] = grey * (float)c;
        }
        kit_set(&k, face, values);
    }
    kit_end_texture(&k);
    snprintf(path, sizeof path, "%s", scratch_path("vectors.ptx"));
    kit_save(&k, path, &how);
    cache = kit_cache(0, 0);
    slv_file_id id = kit_open(cache, path);
    sampler = kit_sampler(cache, &params);
    for (int i = 0; i < 1000; i++) {
        slv_lookup l = {.file = id, .face = test_random(&random) % k.nfaces};
        float out[CHANNELS], u, v, u0, v0;
        l.u = kit_unit(&random), l.v = kit_unit(&random);
        any_footprint(&l, 0, &random);
        CHECK(slv_sample(sampler, &l, out) == SLV_OK);
        from_grid(turns[l.face], 0.75, 0.25, &u, &v);
        from_grid(turns[l.face], 0, 0, &u0, &v0);
        CHECK_MSG(fabsf(out[0] - u + u0) < 2e-6f && fabsf(out[1] - v + v0) < 2e-6f,
                  "%g %g instead of %g %g", (double)out[0], (double)out[1], (double)(u - u0),
                  (double)(v - v0));
        for (uint32_t c = 3; c < CHANNELS; c++)
            CHECK(fabsf(out[c] - out[2] * (float)c * 0.5f) < 5e-6f);
    }
    end();
    kit_free(&k);
}

int main(void) {
    test_seams();
    test_ellipse();
    test_steps();
    for (int mode = SLV_BORDER_CLAMP; mode <= SLV_BORDER_PERIODIC; mode++)
        for (int stay = 0; stay < 2; stay++)
            test_borders((slv_border_mode)mode, stay);
    test_vectors();
    return test_end();
}
