/* The command `selvage transfer`, onto models whose every face is known. */
#include "kit/tool_kit.h"

enum { SIDE = 4 };

/* The grid of the kit as an OBJ whose polygon i is polygon order[i] of the grid, its vertices
 * turned and flipped by ways[i]; the corner of the grid is `lift` above the rest. */
static void write_obj(const char *name, const int *order, const int *ways, float lift) {
    char text[8192];
    size_t length = 0;
    slv_mesh *mesh = grid_mesh(SIDE, SIDE, false);
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    for (uint32_t i = 0; i < view->nverts; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, "v %.9g %.9g %.9g\n",
                                   (double)view->positions[3 * i],
                                   (double)view->positions[3 * i + 1], i ? 0.0 : (double)lift);
    for (uint32_t i = 0; i < view->npolys; i++) {
        uint32_t poly = order ? (uint32_t)order[i] : i;
        int way = ways ? ways[i] : 0;
        length += (size_t)snprintf(text + length, sizeof text - length, "f");
        for (int c = 0; c < 4; c++) {
            int from = way >= 4 ? (way - c + 4) % 4 : (way + c) % 4;
            length += (size_t)snprintf(text + length, sizeof text - length, " %d",
                                       view->poly_verts[4 * poly + (uint32_t)from] + 1);
        }
        length += (size_t)snprintf(text + length, sizeof text - length, "\n");
    }
    slv_mesh_destroy(mesh);
    tool_write_file(name, text, length);
}

/* The grid, many times as large or small. */
static void write_scaled(const char *name, double scale) {
    char text[8192];
    size_t length = 0;
    slv_mesh *mesh = grid_mesh(SIDE, SIDE, false);
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    for (uint32_t i = 0; i < view->nverts; i++)
        length += (size_t)snprintf(text + length, sizeof text - length, "v %.9g %.9g 0\n",
                                   scale * (double)view->positions[3 * i],
                                   scale * (double)view->positions[3 * i + 1]);
    for (uint32_t i = 0; i < view->npolys; i++) {
        const int32_t *v = view->poly_verts + (size_t)4 * i;
        length += (size_t)snprintf(text + length, sizeof text - length, "f %d %d %d %d\n", v[0] + 1,
                                   v[1] + 1, v[2] + 1, v[3] + 1);
    }
    slv_mesh_destroy(mesh);
    tool_write_file(name, text, length);
}

/* Position in space is the colour: wherever a texel goes, it says where it comes from. */
static void write_positions(const char *name, slv_res res) {
    slv_env env = test_env();
    slv_mesh *mesh = grid_mesh(SIDE, SIDE, false);
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                    .type = SLV_TYPE_FLOAT,
                                    .nchannels = 2,
                                    .alpha_channel = SLV_NO_ALPHA,
                                    .nfaces = SIDE * SIDE};
    slv_ptx_writer *writer = NULL;
    float texels[2 * 32 * 32];
    slv_ptx_meta meta = {"note", SLV_META_STRING, 5, "hello"};
    REQUIRE(!slv_ptx_writer_create(&env, tool_path(name), &params, &writer));
    REQUIRE(!slv_ptx_writer_set_mesh(writer, mesh) && !slv_ptx_writer_set_meta(writer, &meta));
    for (uint32_t face = 0; face < params.nfaces; face++) {
        slv_ptx_face info = {.res = res};
        int w = 1 << res.u, h = 1 << res.v;
        for (int i = 0; i < w * h; i++) {
            texels[2 * i] = ((float)(face % SIDE) + ((float)(i % w) + 0.5f) / (float)w) / SIDE;
            texels[2 * i + 1] =
                ((float)(int)(face / SIDE) + ((float)(int)(i / w) + 0.5f) / (float)h) / SIDE;
        }
        REQUIRE(!slv_ptx_writer_write_face(writer, face, &info, texels));
    }
    REQUIRE(!slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
    slv_mesh_destroy(mesh);
}

/* The largest distance between what a texel says and where it is, in a bilinear model. */
static float worst_error(const char *name, const char *obj) {
    slv_env env = test_env();
    slv_ptx *ptx = tool_open(name);
    slv_mesh *mesh = NULL;
    float worst = 0, texels[2 * 64 * 64];
    REQUIRE(!slv_mesh_load(&env, tool_path(obj), &mesh));
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    for (uint32_t face = 0; face < slv_ptx_get_info(ptx)->nfaces; face++) {
        slv_ptx_face info;
        REQUIRE(!slv_ptx_get_face(ptx, face, &info) && info.res.u <= 6 && info.res.v <= 6);
        REQUIRE(!slv_ptx_read_face(ptx, face, info.res, texels));
        int w = 1 << info.res.u, h = 1 << info.res.v;
        for (int i = 0; i < w * h; i++)
            for (int axis = 0; axis < 2; axis++) {
                float u = ((float)(i % w) + 0.5f) / (float)w,
                      v = ((float)(int)(i / w) + 0.5f) / (float)h;
                float p[4];
                for (int c = 0; c < 4; c++)
                    p[c] = view->positions[3 * view->poly_verts[4 * face + (uint32_t)c] + axis];
                float at = (p[0] * (1 - u) + p[1] * u) * (1 - v) + (p[3] * (1 - u) + p[2] * u) * v;
                worst = fmaxf(worst, fabsf(at - texels[2 * i + axis]));
            }
    }
    slv_mesh_destroy(mesh);
    slv_ptx_close(ptx);
    return worst;
}

static void check_copies(void) {
    int order[SIDE * SIDE], ways[SIDE * SIDE];
    uint64_t seed = 5;
    for (int i = 0; i < SIDE * SIDE; i++) {
        order[i] = (i * 7 + 3) % (SIDE * SIDE);
        ways[i] = i < 8 ? i : (int)(test_random(&seed) % 8);
    }
    write_obj("turned.obj", order, ways, 0);
    write_positions("grid.ptx", (slv_res){3, 4});
    RUNS(0, "transfer grid.ptx turned.ptx --to turned.obj --list-faces");
    HAS("16 faces: 16 copied, 0 resampled, 0 partly, 0 too far away");
    HAS("100% of the surface covered");
    HAS("face 7: copied from face 4, turned by 3 and flipped");
    CHECK(worst_error("turned.ptx", "turned.obj") < 1e-6f);
    slv_ptx *ptx = tool_open("turned.ptx");
    CHECK(slv_ptx_find_meta(ptx, "note") != NULL);
    slv_ptx_close(ptx);
    write_obj("same.obj", NULL, NULL, 0);
    RUNS(0, "transfer turned.ptx back.ptx --from turned.obj --to same.obj --quiet");
    RUNS(0, "diff grid.ptx back.ptx --progress");
    HAS("diff: 100% after");
    RUNS(0, "transfer grid.ptx again.ptx --to same.obj --progress --json");
    HAS("transfer: 100% after");
}

static void check_resampling(void) {
    write_positions("fine.ptx", (slv_res){5, 5});
    RUNS(0, "transfer fine.ptx again.ptx --to same.obj --no-copies --scheme bilinear --json");
    HAS("\"resampled\": 16");
    HAS("\"covered\": 1.0");
    CHECK(worst_error("again.ptx", "same.obj") < 1e-5f);
    static const char wider[] = "v 0 0 0\nv 0.5 0 0\nv 0.5 0.7 0\nv 0 0.7 0\n"
                                "v 1.5 0 0\nv 1.5 0.7 0\nv 4 0 0\nv 4 1 0\n"
                                "f 1 2 3 4\nf 2 5 6 3\nf 5 7 8 6\n";
    tool_write_file("wider.obj", wider, sizeof wider - 1);
    RUNS(0,
         "transfer fine.ptx wider.ptx --to wider.obj --scheme bilinear --list-faces --threads 3");
    HAS("3 faces: 0 copied, 1 resampled, 1 partly, 1 too far away");
    HAS("face 0: resampled, its middle from face 4");
    HAS("face 1: partly");
    HAS("face 2: far");
    RUNS(0, "transfer fine.ptx blank.ptx --to wider.obj --scheme bilinear --blank --threads 1");
    slv_ptx *ptx = tool_open("blank.ptx");
    slv_ptx_face info;
    REQUIRE(!slv_ptx_get_face(ptx, 2, &info));
    CHECK(info.flags & SLV_FACE_CONSTANT);
    REQUIRE(!slv_ptx_get_face(ptx, 0, &info));
    CHECK(info.res.u == 6 && (info.res.v == 6 || info.res.v == 7));
    slv_ptx_close(ptx);
    RUNS(0, "check --strict wider.ptx");
    RUNS(0, "transfer fine.ptx wider1.ptx --to wider.obj --scheme bilinear --threads 1");
    RUNS(0, "diff wider.ptx wider1.ptx");
    write_obj("bent.obj", NULL, NULL, 0.05f);
    RUNS(0, "transfer fine.ptx bent.ptx --to bent.obj --distance 0.1");
    HAS("15 copied, 1 resampled");
}

/* Faces of the grid of their own kinds: fill() makes a texel of face, x, y. */
static void write_grid(const char *name, slv_type type, uint32_t nchannels, int32_t alpha,
                       const slv_res *res,
                       void (*fill)(uint32_t face, int x, int y, float *texel)) {
    slv_env env = test_env();
    slv_mesh *mesh = grid_mesh(SIDE, SIDE, false);
    slv_ptx_writer_params params = {.mesh_type = SLV_PTX_QUAD,
                                    .type = type,
                                    .nchannels = nchannels,
                                    .alpha_channel = alpha,
                                    .nfaces = SIDE * SIDE};
    slv_ptx_writer *writer = NULL;
    static float values[4 * 256 * 256], texels[4 * 256 * 256];
    REQUIRE(!slv_ptx_writer_create(&env, tool_path(name), &params, &writer));
    REQUIRE(!slv_ptx_writer_set_mesh(writer, mesh));
    for (uint32_t face = 0; face < params.nfaces; face++) {
        slv_ptx_face info = {.res = res[face]};
        int w = 1 << info.res.u, count = 1 << (info.res.u + info.res.v);
        for (int i = 0; i < count; i++)
            fill(face, i % w, i / w, values + (size_t)i * nchannels);
        slv_type_from_float(type, values, (size_t)count * nchannels, texels);
        REQUIRE(!slv_ptx_writer_write_face(writer, face, &info, texels));
    }
    REQUIRE(!slv_ptx_writer_finish(writer));
    slv_ptx_writer_destroy(writer);
    slv_mesh_destroy(mesh);
}

/* A texel of a chessboard, white or black; those in the middle of the grid are grey. */
static void fill_chess(uint32_t face, int x, int y, float *texel) {
    bool middle = face == 5 || face == 6 || face == 9 || face == 10;
    *texel = middle ? 0.5f : (float)((x + y) % 2);
}

/* Red that is covered on the left of each face, and green that is not. */
static void fill_half_covered(uint32_t face, int x, int y, float *texel) {
    (void)face, (void)y;
    texel[0] = texel[3] = x < 4 ? 1 : 0;
    texel[1] = x < 4 ? 0 : 1;
    texel[2] = 0.25f;
}

static uint32_t read_only_face(const char *name, float *texels) {
    slv_ptx *ptx = tool_open(name);
    slv_ptx_face info;
    uint32_t n = slv_ptx_get_info(ptx)->nchannels;
    REQUIRE(slv_ptx_get_info(ptx)->nfaces == 1 && !slv_ptx_get_face(ptx, 0, &info));
    uint32_t count = 1u << (info.res.u + info.res.v);
    void *raw = calloc(count, 16);
    REQUIRE(info.res.u + info.res.v <= 14 && !slv_ptx_read_face(ptx, 0, info.res, raw));
    slv_type_to_float(slv_ptx_get_info(ptx)->type, raw, (size_t)count * n, texels);
    free(raw);
    slv_ptx_close(ptx);
    return count;
}

static void check_filtering(void) {
    static float texels[4 << 14];
    static const char inner[] = "v 0.1 0.13 0\nv 0.85 0.13 0\nv 0.85 0.88 0\nv 0.1 0.88 0\n"
                                "f 1 2 3 4\n",
                      all[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    tool_write_file("inner.obj", inner, sizeof inner - 1);
    tool_write_file("all.obj", all, sizeof all - 1);
    /* a slope stays one across the edges of the source, of equal faces and of others */
    write_positions("coarse.ptx", (slv_res){3, 2});
    RUNS(0, "transfer coarse.ptx inner.ptx --to inner.obj --scheme bilinear");
    HAS("1 resampled");
    CHECK(worst_error("inner.ptx", "inner.obj") < 1e-5f);

    /* the middle says how many texels; those around are the mean of many */
    slv_res res[SIDE * SIDE];
    for (int i = 0; i < SIDE * SIDE; i++)
        res[i] = i == 5 || i == 6 || i == 9 || i == 10 ? (slv_res){1, 1} : (slv_res){8, 7};
    write_grid("chess.ptx", SLV_TYPE_U8, 1, SLV_NO_ALPHA, res, fill_chess);
    RUNS(0, "transfer chess.ptx mean.ptx --to all.obj --scheme bilinear --threads 1");
    uint32_t count = read_only_face("mean.ptx", texels);
    float worst = 0;
    for (uint32_t i = 0; i < count; i++)
        worst = fmaxf(worst, fabsf(texels[i] - 0.5f));
    CHECK_MSG(count == 64 && worst < 0.02f, "%u texels, off by %g", count, (double)worst);
    RUNS(0, "transfer chess.ptx mean3.ptx --to all.obj --scheme bilinear --threads 3");
    RUNS(0, "diff mean.ptx mean3.ptx");

    /* what is not covered has no colour to give */
    for (int i = 0; i < SIDE * SIDE; i++)
        res[i] = (slv_res){3, 3};
    write_grid("alpha.ptx", SLV_TYPE_FLOAT, 4, 3, res, fill_half_covered);
    RUNS(0, "transfer alpha.ptx cover.ptx --to inner.obj --scheme bilinear");
    count = read_only_face("cover.ptx", texels);
    uint32_t partly = 0, wrong = 0;
    for (uint32_t i = 0; i < count; i++) {
        const float *t = texels + (size_t)4 * i;
        partly += t[3] > 0.01f && t[3] < 0.99f;
        wrong += t[3] > 0.01f &&
                 (fabsf(t[0] - 1) > 1e-4f || fabsf(t[1]) > 1e-4f || fabsf(t[2] - 0.25f) > 1e-4f);
    }
    CHECK_MSG(partly > count / 16 && wrong == 0, "%u partly covered, %u wrong", partly, wrong);
}

/* The largest side of a face, as a power of two. */
static int finest_side(const char *name) {
    slv_ptx *ptx = tool_open(name);
    int finest = 0;
    for (uint32_t face = 0; face < slv_ptx_get_info(ptx)->nfaces; face++) {
        slv_ptx_face info;
        REQUIRE(!slv_ptx_get_face(ptx, face, &info));
        finest = info.res.u > finest ? info.res.u : finest;
        finest = info.res.v > finest ? info.res.v : finest;
    }
    slv_ptx_close(ptx);
    return finest;
}

/* Models in other units, once that is said or found. */
static void check_scales(void) {
    write_positions("units.ptx", (slv_res){5, 5});
    write_scaled("from.obj", 1);
    write_scaled("to.obj", 100);
    RUNS(0, "transfer units.ptx scaled.ptx --from from.obj --to to.obj --scale-from 100");
    HAS("16 copied");
    RUNS(0, "transfer units.ptx scaled.ptx --from from.obj --to to.obj --scale-from auto");
    HAS("the old model's coordinates times 100\n");
    HAS("16 copied");
    RUNS(0, "transfer units.ptx scaled.ptx --from to.obj --to from.obj --scale-from 1/100 "
            "--list-faces");
    HAS("16 copied");
    write_scaled("to.obj", 2.54);
    RUNS(0, "transfer units.ptx scaled.ptx --from from.obj --to to.obj --scale-from auto --quiet");
    write_scaled("to.obj", 1.31);
    RUNS(0, "transfer units.ptx scaled.ptx --from from.obj --to to.obj --scale-from auto");
    HAS("times 1.31");
    RUNS(2, "transfer units.ptx scaled.ptx --from from.obj --to to.obj --scale-from 0");
    RUNS(2, "transfer units.ptx scaled.ptx --from from.obj --to to.obj --scale-from metres");
    HAS("expected auto or a number more than 0");
}

/* Whatever --distance says and however many sides a polygon has, the work stays within bounds: here
 * it ran for minutes. */
static void check_work(void) {
    enum { SIDES = 8000 };
    char *text = malloc(SIDES * 64);
    size_t size = 0;
    REQUIRE(text);
    for (int i = 0; i < SIDES; i++)
        size += (size_t)snprintf(text + size, 64, "v %.6f 0 %.6f\n",
                                 2 + 2 * cos(i * 6.283185307179586 / SIDES),
                                 2 + 2 * sin(i * 6.283185307179586 / SIDES));
    size += (size_t)snprintf(text + size, 64, "f");
    for (int i = 0; i < SIDES; i++)
        size += (size_t)snprintf(text + size, 16, " %d", SIDES - i);
    tool_write_file("round.obj", text, size);
    free(text);
    write_positions("units.ptx", (slv_res){2, 2});
    write_scaled("from.obj", 1);
    write_scaled("to.obj", 1000);
    RUNS(0, "transfer units.ptx round.ptx --from from.obj --to round.obj --distance 9 --quiet "
            "--scheme bilinear");
    RUNS(0, "transfer units.ptx far.ptx --from from.obj --to to.obj --distance 1e9 --quiet");
    RUNS(0, "transfer units.ptx far.ptx --from to.obj --to from.obj --distance 1e30 --quiet");
}

/* Models in other units than the texture's own do not grow the result, and are spoken of. */
static void check_units(void) {
    static const struct {
        double from, to;
        int most;
        const char *answer;
    } cases[] = {{1, 100, 6, "1 partly, 15 too far away"},
                 {1, 1e7, 6, "16 too far away"},
                 {1, 1e20, 6, "16 too far away"},
                 {1e-20, 1, 6, "16 too far away"},
                 {0, 1, 6, "16 too far away"},
                 {1e20, 1e20, 5, "16 copied"},
                 {1e-20, 1e-20, 5, "16 copied"}};
    write_positions("units.ptx", (slv_res){5, 5});
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        write_scaled("from.obj", cases[i].from);
        write_scaled("to.obj", cases[i].to);
        bool none = strncmp(cases[i].answer, "16 too", 6) == 0;
        if (none) {
            unlink(tool_path("scaled.ptx"));
            RUNS(1, "transfer units.ptx scaled.ptx --from from.obj --to to.obj --threads 2");
            HAS("nothing of the new surface is near the old one");
            CHECK(access(tool_path("scaled.ptx"), F_OK) != 0);
        }
        RUNS(0, "transfer units.ptx scaled.ptx --from from.obj --to to.obj --threads 2 --force");
        HAS(cases[i].answer);
        if (cases[i].from == cases[i].to)
            LACKS("are their units the same?");
        else
            HAS("are their units the same?");
        CHECK_MSG(finest_side("scaled.ptx") <= cases[i].most, "%g to %g: sides of 2^%d",
                  cases[i].from, cases[i].to, finest_side("scaled.ptx"));
    }
    /* fewer faces for the same surface hold what many held */
    RUNS(0, "transfer units.ptx fewer.ptx --to all.obj --scheme bilinear");
    CHECK(finest_side("fewer.ptx") == 7);
}

/* Triangles are carried over as their sub-faces, with Loop's surface where both are of them. */
static void check_triangles(void) {
    static const char two[] = "v 0 0 0\nv 1 0 0\nv 1 1 0.3\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
    static const char quad[] = "v 0 0 0\nv 1 0 0\nv 1 1 0.3\nv 0 1 0\nf 1 2 3 4\n";
    const char *data = data_folder();
    tool_write_file("two.obj", two, sizeof two - 1);
    tool_write_file("quad.obj", quad, sizeof quad - 1);
    RUNS(0, "transfer '%s/tri_tiled_u8_1.ptx' three.ptx --from two.obj --to two.obj", data);
    HAS("6 faces: 6 copied");
    RUNS(0, "info three.ptx");
    HAS("quad faces");
    HAS("6, of them 0 constant, 6 sub-faces");
    RUNS(0, "transfer '%s/tri_tiled_u8_1.ptx' one.ptx --from two.obj --to quad.obj --distance 1",
         data);
    HAS("1 faces: 0 copied, 1 resampled");
}

static void check_usage(void) {
    const char *data = data_folder();
    RUNS(2, "transfer grid.ptx x.ptx");
    RUNS(2, "transfer grid.ptx --to same.obj");
    RUNS(2, "transfer grid.ptx x.ptx --to same.obj --distance -1");
    RUNS(2, "transfer grid.ptx x.ptx --to same.obj --distance 0");
    HAS("--distance: expected more than 0");
    RUNS(2, "transfer grid.ptx same.obj --to wider.obj");
    HAS("same.obj: what is written is a .ptx file, so its name must end in .ptx");
    RUNS(0, "transfer grid.ptx y.PTX --to same.obj --quiet");
    RUNS(1, "transfer grid.ptx x.ptx --to missing.obj");
    RUNS(1, "transfer grid.ptx x.ptx --to same.obj --from wider.obj");
    RUNS(1, "transfer '%s/tri_tiled_u8_1.ptx' x.ptx --to same.obj --from same.obj", data);
    HAS("triangle-mesh texture");
    RUNS(1, "transfer '%s/cube_u16_rgba.ptx' x.ptx --to same.obj", data);
    RUNS(0, "transfer --help");
    HAS("Examples:");
    CHECK(access(tool_path("x.ptx"), F_OK) != 0);
}

int main(void) {
    tool_begin();
    check_copies();
    check_triangles();
    check_resampling();
    check_filtering();
    check_units();
    check_scales();
    check_work();
    check_usage();
    tool_end();
    return test_end();
}
