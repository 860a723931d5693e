/* Interpolation is continuous across every edge and at every vertex. */
#include "kit/border_kit.h"

static int halvings(const slv_neighbour *n) {
    return n->scale > 1.5f ? 1 : n->scale < 0.75f ? -1 : 0;
}

static int along(slv_res res, unsigned edge) {
    return edge & 1 ? res.v : res.u;
}

typedef struct jump_sums {
    double clamp_sum, border_sum;
    uint64_t count;
} jump_sums;

static float clamped(const kit_level *level, double u, double v) {
    double half_u = 0.5 / (1 << level->res.u), half_v = 0.5 / (1 << level->res.v);
    u = u < half_u ? half_u : u > 1 - half_u ? 1 - half_u : u;
    v = v < half_v ? half_v : v > 1 - half_v ? 1 - half_v : v;
    return kit_lookup(level, u, v, 0);
}

/* Compares a face with a neighbour where they must agree. `fine` is the exponent of the points, the
 * face's own texel centres, when the neighbour is coarser; -1 means everywhere. Its
 * parameters are many since each tells one kind of edge from another. */
static void compare(const kit_level *mine, const kit_level *theirs, unsigned edge,
                    const slv_neighbour *n, int fine, double skip_at, double skip, double ends,
                    jump_sums *jumps) {
    uint32_t count = 33;
    for (uint32_t i = 0; i < count; i++) {
        double t = n->t0 + (n->t1 - n->t0) * i / (count - 1), u, v;
        bool exact = fine < 0 || i == 0 || i == count - 1;
        if (fine >= 0 && !exact && i % 2) {
            uint32_t texels = 1u << fine;
            uint32_t j = (uint32_t)(t * texels);
            t = ((double)(j < texels ? j : texels - 1) + 0.5) / texels;
            exact = t > n->t0 && t < n->t1;
        }
        if (fabs(t - skip_at) < skip || t < ends || t > 1 - ends)
            continue;
        kit_edge_point(edge, t, &u, &v);
        double nu = n->map.uu * u + n->map.uv * v + n->map.u0;
        double nv = n->map.vu * u + n->map.vv * v + n->map.v0;
        for (uint32_t c = 0; c < mine->nchannels; c++) {
            double a = kit_lookup(mine, u, v, c), b = kit_lookup(theirs, nu, nv, c);
            if (exact)
                CHECK_MSG(fabs(a - b) < 1e-5, "edge %u t %g to face %d scale %g fine %d: %g and %g",
                          edge, t, (int)n->face, (double)n->scale, fine, a, b);
            CHECK(isfinite(a) && isfinite(b));
            if (jumps && c == 0) {
                jumps->border_sum += fabs(a - b);
                jumps->clamp_sum +=
                    fabs((double)clamped(mine, u, v) - (double)clamped(theirs, nu, nv));
                jumps->count++;
            }
        }
    }
}

/* A quad's interpolation has no knot in the middle of its edge, so where one of two sub-faces is
 * coarser than it, the middle is met only nearly. */
static bool near_only(const kit *k, unsigned edge, slv_res res, const slv_neighbour *n,
                      uint32_t links) {
    for (uint32_t i = 0; i < links; i++)
        if (along(res, edge) - 1 > along(k->res[n[i].face], n[i].edge))
            return true;
    return false;
}

/* Checks all faces that meet at some pair of levels. `isotropic` textures also meet where the edge
 * is one texel; without `vertices`, the half texels at the ends of edges and in the middle between
 * two sub-faces are left out. */
static void check(const kit *k, bool isotropic, bool vertices, jump_sums *jumps) {
    for (uint32_t face = 0; face < k->nfaces; face++) {
        for (uint32_t level = 0; level < slv_levels_count(k->levels, face); level++) {
            kit_level mine = kit_build(k, face, level, 2, 2);
            for (unsigned edge = 0; edge < 4; edge++) {
                slv_neighbour n[2];
                uint32_t links = slv_adjacency_neighbours(k->adjacency, (int32_t)face, edge, n);
                for (uint32_t i = 0; i < links; i++) {
                    int want = along(mine.res, edge) - halvings(&n[i]);
                    int has = along(k->res[n[i].face], n[i].edge);
                    if (want < 0 || (!isotropic && (want == 0 || along(mine.res, edge) == 0)))
                        continue;
                    bool coarser = want > has;
                    kit_level theirs = kit_build(k, (uint32_t)n[i].face,
                                                 coarser ? 0 : (uint32_t)(has - want), 2, 2);
                    double skip_at = 0.5, skip = 0;
                    double ends = vertices ? 0 : 0.499 / (1 << along(mine.res, edge));
                    if (n[i].scale > 1.5f && (!vertices || near_only(k, edge, mine.res, n, links)))
                        skip = 0.51 / (1 << along(mine.res, edge));
                    if (n[i].scale < 0.75f) {
                        slv_neighbour back[2];
                        uint32_t nback =
                            slv_adjacency_neighbours(k->adjacency, n[i].face, n[i].edge, back);
                        skip_at = back[0].face == (int32_t)face && back[0].edge == edge ? 0 : 1;
                        if (near_only(k, n[i].edge, theirs.res, back, nback))
                            skip = 0.51 / (1 << along(mine.res, edge));
                    }
                    compare(&mine, &theirs, edge, &n[i], coarser ? along(mine.res, edge) : -1,
                            skip_at, skip, ends, coarser ? jumps : NULL);
                    free(theirs.values);
                }
            }
            free(mine.values);
        }
    }
}

static void check_equal(kit *k, uint64_t *random) {
    for (int r = 1; r <= 4; r++) {
        for (int type = 0; type < 4; type++) {
            kit_equal(k, r);
            kit_noise(k, (slv_type)type, type == 0 ? 3 : 1, random);
            check(k, true, true, NULL);
        }
    }
    kit_free(k);
}

static void test_equal(void) {
    uint64_t random = 1;
    static const int32_t valences[] = {3, 4, 5, 6, 8, 12};
    kit k;
    for (size_t i = 0; i < sizeof valences / sizeof *valences; i++) {
        kit_disc(&k, valences[i], &random);
        check_equal(&k, &random);
    }
    kit_cube(&k, &random);
    check_equal(&k, &random);
    kit_pentagons(&k, &random);
    check_equal(&k, &random);
    kit_grid(&k, 4, 3, false, 0, &random, NULL);
    check_equal(&k, &random);
    kit_grid(&k, 3, 4, true, 0, &random, NULL);
    check_equal(&k, &random);
    kit_grid(&k, 4, 4, false, 40, &random, NULL);
    check_equal(&k, &random);
    kit_grid(&k, 4, 4, true, 40, &random, NULL);
    check_equal(&k, &random);
}

static void test_mixed(void) {
    uint64_t random = 2;
    jump_sums jumps = {0};
    for (int round = 0; round < 12; round++) {
        kit k;
        switch (round % 6) {
        case 0:
            kit_grid(&k, 4, 4, true, 0, &random, NULL);
            break;
        case 1:
            kit_grid(&k, 4, 3, false, 30, &random, NULL);
            break;
        case 2:
            kit_cube(&k, &random);
            break;
        case 3:
            kit_pentagons(&k, &random);
            break;
        case 4:
            kit_disc(&k, 5, &random);
            break;
        default:
            kit_grid(&k, 4, 4, true, 50, &random, NULL);
            break;
        }
        for (int type = 0; type < 4; type++) {
            kit_mixed(&k, 4, &random);
            kit_noise(&k, (slv_type)type, 2, &random);
            check(&k, true, true, &jumps);
        }
        kit_free(&k);
    }
    REQUIRE(jumps.count > 0);
    double plain = jumps.clamp_sum / (double)jumps.count,
           ours = jumps.border_sum / (double)jumps.count;
    CHECK_MSG(ours < 0.5 * plain, "mean jump %g, clamped %g", ours, plain);
    fprintf(stderr, "mixed resolutions: mean jump %g, clamped %g\n", ours, plain);
}

/* Columns and rows of a grid with resolutions of their own: faces are oblong and meet at equal
 * levels. */
static void test_oblong(void) {
    uint64_t random = 3;
    for (int round = 0; round < 8; round++) {
        kit k;
        uint32_t turns[20];
        int8_t column[5], row[4];
        kit_grid(&k, 5, 4, round % 2 == 0, 0, &random, turns);
        for (int i = 0; i < 5; i++)
            column[i] = (int8_t)(test_random(&random) % 6);
        for (int i = 0; i < 4; i++)
            row[i] = (int8_t)(test_random(&random) % 6);
        for (int i = 0; i < 20; i++) {
            bool swap = turns[i] & 1;
            k.res[i].u = swap ? row[i / 5] : column[i % 5];
            k.res[i].v = swap ? column[i % 5] : row[i / 5];
        }
        kit_noise(&k, (slv_type)(round % 4), 1, &random);
        check(&k, false, true, NULL);
        kit_free(&k);
    }
}

/* Any oblong resolutions, which may contradict each other around vertices: the edges between still
 * agree. */
static void test_contradictory(void) {
    uint64_t random = 4;
    for (int round = 0; round < 12; round++) {
        kit k;
        if (round % 3 == 0)
            kit_cube(&k, &random);
        else if (round % 3 == 1)
            kit_pentagons(&k, &random);
        else
            kit_grid(&k, 4, 4, true, 40, &random, NULL);
        for (uint32_t face = 0; face < k.nfaces; face++)
            k.res[face] =
                (slv_res){(int8_t)(test_random(&random) % 5), (int8_t)(test_random(&random) % 5)};
        kit_noise(&k, (slv_type)(round % 4), 1, &random);
        check(&k, false, false, NULL);
        kit_free(&k);
    }
}

int main(void) {
    test_equal();
    test_mixed();
    test_oblong();
    test_contradictory();
    return test_end();
}
