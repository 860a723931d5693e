/* What other meshes have: textures of the mesh itself, faces that both have in all turns, the
 * nearest place and what lies along the normal, scans with coloured vertices, and misses. */
#include "kit/uv_kit.h"

#include <selvage/bake_recipe.h>

/* Two quads and a triangle, bent along the edges between. */
static const char bent[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 .5\nv 2 1 .5\nv 3 0 0\n"
                           "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
                           "f 1/1 2/2 3/3 4/4\nf 2/1 5/2 6/3 3/4\nf 5/1 7/2 6/3\n";

static float waves(uint32_t channel, float u, float v) {
    return 0.5f + 0.4f * sinf(9 * u + 4 * v + (float)channel) * cosf(7 * v);
}

/* Values of all texels of a recipe's source. */
static void evaluate(const char *obj, const char *source, uint32_t face, slv_res res, uint32_t n,
                     float *values, uint8_t *misses) {
    slv_env env = test_env();
    char text[2000];
    slv_bake_recipe *recipe = NULL;
    slv_bake_source *made = NULL;
    slv_mesh *mesh = uv_parse(obj);
    snprintf(text, sizeof text, "{\"source\": %s, \"scheme\": \"bilinear\"}", source);
    MUST(slv_bake_recipe_load(&env, NULL, text, &recipe));
    MUST(slv_bake_recipe_source(&env, recipe, mesh, &made));
    REQUIRE(slv_bake_source_get_desc(made)->nchannels == n);
    MUST(slv_bake_evaluate(made, &env, face, res, (slv_rect){0, 0, 1u << res.u, 1u << res.v},
                           values, misses));
    slv_bake_source_destroy(made);
    slv_bake_recipe_destroy(recipe);
    slv_mesh_destroy(mesh);
}

/* A texture baked of itself is itself; coarser it is its reduction; finer it is linear between its
 * texels, across edges too. */
static void textures(void) {
    char line[400];
    RUNS(0, "bake bent.obj --uv waves.exr --size 16 --type half --reductions plain -o half.ptx");
    RUNS(0, "bake bent.obj --texture half.ptx --reductions plain -o again.ptx");
    RUNS(0, "diff half.ptx again.ptx");
    RUNS(0, "bake bent.obj --uv waves.png --size 16 --reductions plain -o bytes.ptx");
    RUNS(0, "bake bent.obj --texture bytes.ptx --reductions plain -o again.ptx");
    RUNS(0, "diff bytes.ptx again.ptx");
    RUNS(0, "bake bent.obj --texture half.ptx --size 4 --reductions plain -o small.ptx");
    float fine[16 * 16 * 3], coarse[4 * 4 * 3], finer[32 * 16 * 3], mean = 0;
    uint8_t misses[512];
    snprintf(line, sizeof line, "{\"texture\": \"%s\"}", tool_path("half.ptx"));
    evaluate(bent, line, 0, (slv_res){4, 4}, 3, fine, misses);
    evaluate(bent, line, 0, (slv_res){2, 2}, 3, coarse, misses);
    evaluate(bent, line, 0, (slv_res){5, 4}, 3, finer, misses);
    for (int i = 0; i < 16; i++)
        mean += fine[3 * ((i / 4 + 4) * 16 + i % 4 + 8)] / 16;
    CHECK_MSG(fabsf(coarse[3 * (4 + 2)] - mean) < 1e-3f, "%g, not %g", (double)coarse[3 * (4 + 2)],
              (double)mean);
    for (int x = 1; x < 31; x++) {
        int left = (x - 1) / 2;
        float share = x % 2 ? 0.25f : 0.75f;
        float want =
            fine[3 * (5 * 16 + left)] * (1 - share) + fine[3 * (5 * 16 + left + 1)] * share;
        CHECK_MSG(fabsf(finer[3 * (5 * 32 + x)] - want) < 1e-6f, "%d: %g, not %g", x,
                  (double)finer[3 * (5 * 32 + x)], (double)want);
    }
    /* a coarser texel along one axis is a mean there, not a sample */
    evaluate(bent, line, 0, (slv_res){5, 0}, 3, finer, misses);
    mean = 0;
    for (int y = 0; y < 16; y++)
        mean += (0.75f * fine[3 * (y * 16 + 4)] + 0.25f * fine[3 * (y * 16 + 5)]) / 16;
    CHECK_MSG(fabsf(finer[3 * 9] - mean) < 1e-5f, "%g, not %g", (double)finer[3 * 9], (double)mean);
    RUNS(1, "bake square.obj --texture half.ptx -o none.ptx");
    RUNS(0, "bake bent.obj --texture bytes.ptx --match 2 -o double.ptx");
    RUNS(1, "bake bent.obj --texture missing.ptx -o none.ptx");
}

/* A face that both have is copied however its corners are numbered, in all eight ways. */
static void turns(void) {
    static const char corners[4][16] = {"0 0 0", "1 0 0", "1 1 0", "0 1 0"};
    float want[8 * 4 * 3], got[4 * 8 * 3];
    uint8_t misses[32];
    char source[600], obj[400];
    snprintf(source, sizeof source, "{\"uv\": \"%s\"}", tool_path("waves.exr"));
    evaluate(bent, source, 0, (slv_res){3, 2}, 3, want, misses);
    snprintf(source, sizeof source, "{\"carry\": {\"uv\": \"%s\"}, \"mesh\": \"%s\"}",
             tool_path("waves.exr"), tool_path("bent.obj"));
    for (int turn = 0; turn < 4; turn++)
        for (int flip = 0; flip < 2; flip++) {
            int order[4];
            size_t used = 0;
            for (int k = 0; k < 4; k++)
                order[k] = (turn + (flip ? 4 - k : k)) % 4;
            for (int k = 0; k < 4; k++)
                used +=
                    (size_t)snprintf(obj + used, sizeof obj - used, "v %s\n", corners[order[k]]);
            snprintf(obj + used, sizeof obj - used, "f 1 2 3 4\n");
            bool swapped = (turn % 2 != 0) != flip;
            slv_res res = swapped ? (slv_res){2, 3} : (slv_res){3, 2};
            int w = 1 << res.u;
            evaluate(obj, source, 0, res, 3, got, misses);
            for (int i = 0; i < 32; i++) {
                /* where the texel lies in the square, by the corners of this face */
                float u = ((float)(i % w) + 0.5f) / (float)w,
                      v = ((float)(i / w) + 0.5f) / (float)(1 << res.v), p[2];
                for (int axis = 0; axis < 2; axis++) {
                    float at[4];
                    for (int k = 0; k < 4; k++)
                        at[k] = (float)(corners[order[k]][2 * axis] - '0');
                    p[axis] =
                        (at[0] * (1 - u) + at[1] * u) * (1 - v) + (at[3] * (1 - u) + at[2] * u) * v;
                }
                int other = (int)(p[1] * 4) * 8 + (int)(p[0] * 8);
                CHECK_MSG(!misses[i] && memcmp(got + 3 * i, want + 3 * other, 12) == 0,
                          "turn %d flip %d texel %d: %g, not %g", turn, flip, i, (double)got[3 * i],
                          (double)want[3 * other]);
            }
        }
}

/* A plane of quads and triangles a little above the unit square, and larger. */
static void write_grid(void) {
    char obj[8000];
    size_t used = 0;
    for (int i = 0; i < 49; i++)
        used += (size_t)snprintf(obj + used, sizeof obj - used, "v %g %g %g\n", -0.1 + i % 7 * 0.2,
                                 -0.1 + i / 7 * 0.2, 0.01);
    for (int i = 0; i < 36; i++) {
        int a = i / 6 * 7 + i % 6 + 1;
        used += (size_t)snprintf(obj + used, sizeof obj - used,
                                 i % 5 ? "f %d %d %d %d\n" : "f %d %d %d\nf %d %d %d\n", a, a + 1,
                                 a + 8, i % 5 ? a + 7 : a, a + 8, a + 7);
    }
    tool_write_file("grid.obj", obj, used);
}

/* Positions of another division of the same surface are the own ones: by both ways, and for texels
 * that cover many of the other's. */
static void places(void) {
    char source[600];
    float got[16 * 16 * 3];
    uint8_t misses[256];
    for (int by = 0; by < 2; by++)
        for (int8_t size = 0; size < 5; size += 2) {
            snprintf(source, sizeof source,
                     "{\"carry\": {\"surface\": \"position\"}, \"mesh\": \"%s\", \"by\": \"%s\", "
                     "\"%s\": 0.02}",
                     tool_path("grid.obj"), by ? "rays" : "closest", by ? "front" : "distance");
            evaluate("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n", source, 0,
                     (slv_res){size, size}, 3, got, misses);
            for (int i = 0; i < 1 << 2 * size; i++) {
                float x = ((float)(i % (1 << size)) + 0.5f) / (float)(1 << size),
                      y = ((float)(i >> size) + 0.5f) / (float)(1 << size);
                float away = fmaxf(fabsf(got[3 * i] - x), fabsf(got[3 * i + 1] - y));
                CHECK_MSG(!misses[i] && away < 1e-3f + 0.01f / (float)(1 << size) &&
                              fabsf(got[3 * i + 2] - 0.01f) < 1e-5f,
                          "%s: %g %g %g, not %g %g", source, (double)got[3 * i],
                          (double)got[3 * i + 1], (double)got[3 * i + 2], (double)x, (double)y);
            }
        }
}

static void misses(void) {
    static const struct {
        const char *obj, *more;
        int miss;
    } cases[] = {{"v 0 0 .1\nv 1 0 .1\nv 1 1 .1\nv 0 1 .1\nv 0 0 0\nf 1 2 3 4\n",
                  "\"distance\": 0.05", SLV_BAKE_TOO_FAR},
                 {"v 0 0 .1\nv 1 0 .1\nv 1 1 .1\nv 0 1 .1\nf 4 3 2 1\n", "\"distance\": 0.2",
                  SLV_BAKE_BACK_FACING},
                 {"v 0 0 .1\nv 1 0 .1\nv 1 1 .1\nv 0 1 .1\nf 4 3 2 1\n",
                  "\"by\": \"rays\", \"front\": 0.2", SLV_BAKE_BACK_FACING},
                 {"v 0 0 .2\nv 1 0 .2\nv 1 1 .2\nv 0 1 .2\nv 0 0 0\nf 1 2 3 4\n",
                  "\"by\": \"rays\", \"front\": 0.1", SLV_BAKE_TOO_FAR},
                 {"v .5 0 .01\nv 1 0 .01\nv 1 1 .01\nv .5 1 .01\nf 1 2 3 4\n",
                  "\"by\": \"rays\", \"front\": 0.2", SLV_BAKE_NO_HIT}};
    float got[4 * 3];
    uint8_t missed[4];
    char source[600];
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        tool_write_file("other.obj", cases[k].obj, strlen(cases[k].obj));
        snprintf(source, sizeof source,
                 "{\"carry\": {\"surface\": \"position\"}, \"mesh\": \"%s\", %s}",
                 tool_path("other.obj"), cases[k].more);
        evaluate("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n", source, 0, (slv_res){2, 0}, 3,
                 got, missed);
        CHECK_MSG(missed[0] == cases[k].miss && got[0] == 0, "%s: %d", source, missed[0]);
    }
    /* what has no value on the other has none here, and texels beside it have theirs */
    tool_write_file("bare.obj", uv_obj, strlen(uv_obj));
    snprintf(source, sizeof source,
             "{\"carry\": {\"uv\": \"%s\"}, \"mesh\": \"%s\", \"distance\": 0.1}",
             tool_path("waves.exr"), tool_path("bare.obj"));
    evaluate("v 1.5 0 0.01\nv 2.5 0 0.01\nv 2.5 1 0.01\nv 1.5 1 0.01\nf 1 2 3 4\n", source, 0,
             (slv_res){2, 0}, 3, got, missed);
    CHECK_MSG(!missed[0] && !missed[1] && missed[2] == SLV_BAKE_NO_UV &&
                  missed[3] == SLV_BAKE_NO_UV,
              "%d %d %d %d", missed[0], missed[1], missed[2], missed[3]);
}

/* A cage that leans: rays go straight through it and the surface, whatever lies before the cage. */
static void cage(void) {
    static const char shifted[] = "v 1 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nf 1 2 3 4\n",
                      other[] = "v -2 -2 .5\nv 4 -2 .5\nv 4 4 .5\nv -2 4 .5\n"
                                "v -2 -2 2\nv 4 -2 2\nv 4 4 2\nv -2 4 2\nf 1 2 3 4\nf 5 6 7 8\n",
                      square[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    char source[900];
    float got[16 * 3];
    uint8_t missed[16];
    tool_write_file("cage.obj", shifted, sizeof shifted - 1);
    tool_write_file("sheets.obj", other, sizeof other - 1);
    snprintf(source, sizeof source,
             "{\"carry\": {\"surface\": \"position\"}, \"mesh\": \"%s\", \"by\": \"rays\", "
             "\"cage\": \"%s\"}",
             tool_path("sheets.obj"), tool_path("cage.obj"));
    evaluate(square, source, 0, (slv_res){2, 2}, 3, got, missed);
    for (int i = 0; i < 16; i++) {
        float x = ((float)(i % 4) + 0.5f) / 4 + 0.5f, y = ((float)(i / 4) + 0.5f) / 4;
        CHECK_MSG(!missed[i] && fabsf(got[3 * i] - x) < 0.02f &&
                      fabsf(got[3 * i + 1] - y) < 0.02f && fabsf(got[3 * i + 2] - 0.5f) < 1e-5f,
                  "texel %d: %d %g %g %g", i, missed[i], (double)got[3 * i], (double)got[3 * i + 1],
                  (double)got[3 * i + 2]);
    }
    snprintf(source, sizeof source,
             "{\"detail\": \"%s\", \"kind\": \"face-normal\", "
             "\"cage\": \"%s\"}",
             tool_path("sheets.obj"), tool_path("cage.obj"));
    evaluate(square, source, 0, (slv_res){2, 2}, 3, got, missed);
    CHECK(!missed[0] && fabsf(got[2] - 1) < 1e-6f);
}

/* Triangles with colours at their vertices: linear between them. */
static void scan(void) {
    char text[8000], source[300];
    size_t used = (size_t)snprintf(
        text, sizeof text,
        "ply\nformat ascii 1.0\nelement vertex 49\nproperty float x\nproperty float y\nproperty "
        "float z\nproperty float red\nproperty float green\nproperty float blue\nelement face 72\n"
        "property list uchar int vertex_indices\nend_header\n");
    float got[64 * 3];
    uint8_t missed[64];
    for (int i = 0; i < 49; i++) {
        double x = -0.1 + i % 7 * 0.2, y = -0.1 + i / 7 * 0.2;
        used += (size_t)snprintf(text + used, sizeof text - used, "%g %g 0.01 %g %g 0.5\n", x, y,
                                 0.3 + 0.4 * x, 0.2 + 0.3 * x + 0.1 * y);
    }
    for (int i = 0; i < 36; i++) {
        int a = i / 6 * 7 + i % 6;
        used += (size_t)snprintf(text + used, sizeof text - used, "3 %d %d %d\n3 %d %d %d\n", a,
                                 a + 1, a + 8, a, a + 8, a + 7);
    }
    tool_write_file("scan.ply", text, used);
    snprintf(source, sizeof source, "{\"points\": \"%s\", \"distance\": 0.02}",
             tool_path("scan.ply"));
    evaluate("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n", source, 0, (slv_res){3, 3}, 3, got,
             missed);
    for (int i = 0; i < 64; i++) {
        float x = ((float)(i % 8) + 0.5f) / 8, y = ((float)(i / 8) + 0.5f) / 8;
        CHECK_MSG(!missed[i] && fabsf(got[3 * i] - 0.3f - 0.4f * x) < 3e-3f &&
                      fabsf(got[3 * i + 1] - 0.2f - 0.3f * x - 0.1f * y) < 3e-3f,
                  "texel %d: %d %g %g", i, missed[i], (double)got[3 * i], (double)got[3 * i + 1]);
    }
}

/* Options, threads, the mesh inside a texture, a mesh onto itself, and one that lies elsewhere. */
static void verb(void) {
    static const char far[] = "v 9 0 0\nv 10 0 0\nv 10 1 0\nv 9 1 0\nf 1 2 3 4\n";
    RUNS(0, "bake bent.obj --from half.ptx --texture half.ptx --reductions plain -o self.ptx");
    RUNS(0, "diff half.ptx self.ptx");
    RUNS(0, "bake grid.obj --from bent.obj --uv waves.exr --distance 0.4 --size 8 --max-miss 1 "
            "--threads 1 -o a.ptx");
    RUNS(0, "bake grid.obj --from bent.obj --uv waves.exr --distance 0.4 --size 8 --max-miss 1 "
            "--threads 3 -o b.ptx");
    CHECK(uv_same_files("a.ptx", "b.ptx"));
    RUNS(0, "bake grid.obj --from bent.obj --uv waves.exr --by rays --front 0.4 --print-recipe -o "
            "b.ptx");
    HAS("\"by\": \"rays\"");
    HAS("\"front\": 0.4");
    RUNS(2, "bake grid.obj --uv waves.exr --by rays -o b.ptx");
    RUNS(2, "bake grid.obj --from bent.obj -o b.ptx");
    RUNS(2, "bake grid.obj --from bent.obj --uv waves.exr --cage grid.obj -o b.ptx");
    RUNS(1, "bake grid.obj --from bent.obj --uv waves.exr --by rays --cage bent.obj -o none.ptx");
    HAS("the cage has 3 polygons");
    RUNS(1, "bake bent.obj --detail bent.obj --cage bent.obj -o none.ptx");
    HAS("a cage is for normals");
    tool_write_file("other.obj", far, sizeof far - 1);
    RUNS(1, "bake bent.obj --from other.obj --surface position -o none.ptx");
    HAS("elsewhere");
    RUNS(1, "bake bent.obj --from other.obj --texture half.ptx -o none.ptx");
    CHECK(access(tool_path("none.ptx"), F_OK) != 0);
}

int main(void) {
    tool_begin();
    tool_write_file("bent.obj", bent, sizeof bent - 1);
    tool_write_file("square.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n", 42);
    uv_write_image("waves.exr", 64, 64, 3, waves, &uv_floats);
    uv_write_image("waves.png", 64, 64, 3, waves, NULL);
    write_grid();
    textures();
    verb(); /* before Embree has threads, which forks have not */
    turns();
    places();
    misses();
    cage();
    scan();
    tool_end();
    return test_end();
}
