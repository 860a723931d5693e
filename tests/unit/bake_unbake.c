/* Textures back as UV images: what was baked comes back, nothing from outside of islands is in any
 * pixel, sets of tiles, alpha, and what is refused. */
#include "kit/uv_kit.h"

static float value_now = 7;
static float constant(uint32_t channel, float u, float v) {
    (void)u;
    (void)v;
    return channel == 3 ? 0.5f : value_now;
}

static slv_image load(const char *name) {
    slv_env env = test_env();
    slv_image image;
    MUST(slv_image_load(&env, tool_path(name), &image));
    return image;
}

/* Which pixels have their middle in a face of quads that are parallelograms or nearly so. */
static bool is_inside(const float *corners, double u, double v) {
    for (uint32_t face = 0; face < UV_FACES; face++) {
        const float *c = corners + 8 * face;
        bool inside = !isnan(c[0]);
        for (int k = 0; k < 4 && inside; k++) {
            int n = (k + 1) % 4;
            double ax = (double)c[2 * n] - (double)c[2 * k],
                   ay = (double)c[2 * n + 1] - (double)c[2 * k + 1];
            inside = ax * (v - (double)c[2 * k + 1]) - ay * (u - (double)c[2 * k]) >= 0;
        }
        if (inside)
            return true;
    }
    return false;
}

/* Far enough from the edges of an island: what lies across a seam, which has other values in this
 * image, is mixed in there. */
static bool is_deep(const float *corners, float u, float v) {
    bool deep = true;
    for (int k = 0; k < 8 && deep; k++)
        deep = is_inside(corners, (double)u + 0.04 * cos(0.785 * k),
                         (double)v + 0.04 * sin(0.785 * k));
    return deep && is_inside(corners, (double)u, (double)v);
}

/* A ramp comes back as the ramp, and of one value every pixel of the image, and so of its
 * reductions, has just that. */
static void values(void) {
    slv_env env = test_env();
    slv_mesh *mesh = uv_parse(uv_obj);
    float *corners = NULL;
    uint32_t inside = 0;
    uv_write_image("ramp.exr", 128, 96, 3, uv_ramp, &uv_floats);
    MUST(slv_mesh_face_texcoords(&env, mesh, &corners));
    slv_mesh_destroy(mesh);
    RUNS(1, "bake uv.obj --uv ramp.exr -o ramp.ptx --match 2"); /* one face has no coordinates */
    RUNS(0, "unbake ramp.ptx --mesh uv.obj -o back.exr --size 128x96");
    HAS("1 faces have no texture coordinates");
    slv_image back = load("back.exr");
    CHECK(back.width == 128 && back.height == 96 && back.nchannels == 3 &&
          back.type == SLV_TYPE_FLOAT);
    for (uint32_t y = 0; y < back.height; y++)
        for (uint32_t x = 0; x < back.width; x++) {
            float u = ((float)x + 0.5f) / 128, v = 1 - ((float)y + 0.5f) / 96;
            if (!is_deep(corners, u, v))
                continue;
            inside++;
            for (uint32_t c = 0; c < 3; c++) {
                float got = back.pixels[(y * 128 + x) * 3 + c], want = uv_ramp(c, u, v);
                CHECK_MSG(fabsf(got - want) < 0.02f, "pixel %u,%u: %g, not %g", x, y, (double)got,
                          (double)want);
            }
        }
    CHECK_MSG(inside > 1000, "%u", inside);
    slv_image_free(&back);
    uv_write_image("seven.exr", 64, 64, 3, constant, &uv_floats);
    RUNS(0, "bake all.obj --uv seven.exr -o seven.ptx --quiet");
    RUNS(0, "unbake seven.ptx --mesh all.obj -o back.exr --size 100x70 --json");
    HAS("\"faces_without\": 0");
    back = load("back.exr");
    for (uint32_t i = 0; i < 100 * 70 * 3; i++)
        CHECK_MSG(fabsf(back.pixels[i] - 7) < 1e-4f, "%u: %g", i / 3, (double)back.pixels[i]);
    slv_image_free(&back);
    slv_free(corners);
}

/* Beside the cut between the two quads, which are 3 and 4 in value, a pixel outside of the island
 * has what lies across the seam. */
static void seams(void) {
    slv_env env = test_env();
    static const slv_res res[2] = {{4, 4}, {4, 4}};
    static const char pair[] = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
                               "vt .125 .25\nvt .375 .25\nvt .375 .75\nvt .125 .75\n"
                               "vt .625 .25\nvt .875 .25\nvt .875 .75\nvt .625 .75\n"
                               "f 1/1 2/2 5/3 4/4\nf 2/5 3/6 6/7 5/8\n";
    slv_mesh *mesh = uv_parse(pair);
    slv_adjacency *adjacency = NULL;
    slv_texture *texture = NULL;
    const slv_texture_desc desc = {.nfaces = 2,
                                   .type = SLV_TYPE_FLOAT,
                                   .nchannels = 1,
                                   .alpha_channel = SLV_NO_ALPHA,
                                   .res = res};
    MUST(slv_mesh_adjacency(&env, mesh, &adjacency));
    MUST(slv_texture_create(&env, &desc, &texture));
    for (uint32_t face = 0; face < 2; face++)
        MUST(slv_texture_set_constant(texture, face, &(float){(float)(3 + face)}));
    MUST(slv_ptx_save(&env, tool_path("pair.ptx"), texture, adjacency,
                      &(slv_ptx_write_params){.mesh = mesh}));
    slv_texture_destroy(texture);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    tool_write_file("pair.obj", pair, sizeof pair - 1);
    RUNS(0, "unbake pair.ptx --mesh pair.obj -o pair.exr --size 64");
    slv_image back = load("pair.exr");
    const float *row = back.pixels + 32 * 64;
    CHECK(row[8] == 3 && row[22] == 3 && row[41] == 4 && row[54] == 4);
    CHECK_MSG(row[25] == 4 && row[38] == 3, "%g %g", (double)row[25], (double)row[38]);
    CHECK_MSG(row[6] == 3 && row[57] == 4, "%g %g", (double)row[6], (double)row[57]);
    slv_image_free(&back);
}

static void tiles(void) {
    static const char strip[] = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
                                "vt 0 0\nvt 1 0\nvt 1.5 0\nvt 0 1\nvt 1 1\nvt 1.5 1\n"
                                "f 1/1 2/2 5/5 4/4\nf 2/2 3/3 6/6 5/5\n";
    tool_write_file("strip.obj", strip, sizeof strip - 1);
    value_now = 10;
    uv_write_image("t.1001.exr", 32, 32, 1, constant, &uv_floats);
    value_now = 20;
    uv_write_image("t.1002.exr", 32, 32, 1, constant, &uv_floats);
    RUNS(0, "bake strip.obj --uv 't.<UDIM>.exr' -o strip.ptx");
    HAS("tile 1002: 32x32, 1 faces");
    RUNS(0, "unbake strip.ptx --mesh strip.obj -o 'b.<UDIM>.exr'");
    HAS("2 images of 32x32");
    LACKS("no tile is");
    for (int tile = 1001; tile <= 1002; tile++) {
        char name[32];
        snprintf(name, sizeof name, "b.%d.exr", tile);
        slv_image back = load(name);
        for (uint32_t i = 0; i < 32 * 32; i++) {
            /* where the faces meet both are blended */
            float want = tile == 1001 ? 10 : 20;
            bool near = tile == 1001 ? i % 32 > 29 : i % 32 < 2;
            CHECK_MSG(near || back.pixels[i] == want, "%s: %g", name, (double)back.pixels[i]);
        }
        slv_image_free(&back);
    }
}

/* What no tile can show is told. */
static void beyond_tiles(void) {
    static const char strip[] = "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
                                "vt 9 0\nvt 10 0\nvt 10.5 0\nvt 9 1\nvt 10 1\nvt 10.5 1\n"
                                "f 1/1 2/2 5/5 4/4\nf 2/2 3/3 6/6 5/5\n";
    tool_write_file("beyond.obj", strip, sizeof strip - 1);
    RUNS(0, "bake beyond.obj --pattern checker --size 8 -o beyond.ptx");
    RUNS(0, "unbake beyond.ptx --mesh beyond.obj -o 'c.<UDIM>.exr'");
    HAS("1 faces, the first 1, lie where no tile is");
}

/* Transparent colours count for nothing, there and back. */
static void alpha(void) {
    value_now = 0.25f;
    uv_write_image("a.png", 32, 32, 4, constant, &uv_raw);
    RUNS(0, "bake all.obj --uv a.png -o a.ptx --quiet");
    RUNS(0, "unbake a.ptx --mesh all.obj -o back.png --size 64 --quiet");
    slv_image back = load("back.png");
    REQUIRE(back.nchannels == 4 && back.type == SLV_TYPE_U8);
    for (uint32_t i = 0; i < 64 * 64 * 4; i++)
        CHECK_MSG(fabsf(back.pixels[i] - (i % 4 == 3 ? 128.0f / 255 : 64.0f / 255)) < 0.006f,
                  "%u: %g", i, (double)back.pixels[i]);
    slv_image_free(&back);
}

static void same_and_refused(void) {
    RUNS(0, "unbake ramp.ptx --mesh uv.obj -o one.png --threads 1 --quiet --size 256");
    RUNS(0, "unbake ramp.ptx --mesh uv.obj -o four.png --threads 4 --quiet --size 256");
    CHECK(uv_same_files("one.png", "four.png"));
    RUNS(2, "unbake ramp.ptx -o none.png");
    HAS("--mesh");
    RUNS(2, "unbake ramp.ptx --mesh uv.obj -o none.jpg");
    RUNS(2, "unbake ramp.ptx --mesh uv.obj -o none.png --bits 12");
    RUNS(1, "unbake ramp.ptx --mesh pair.obj -o none.png");
    RUNS(0, "new uv.obj five.ptx --channels 5 --size 4 --quiet");
    RUNS(1, "unbake five.ptx --mesh uv.obj -o none.png");
    HAS("5");
    static const char bare[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    tool_write_file("bare.obj", bare, sizeof bare - 1);
    RUNS(0, "new bare.obj bare.ptx --size 4 --quiet");
    RUNS(1, "unbake bare.ptx --mesh bare.obj -o none.png");
    HAS("no texture coordinates");
    static const char point[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt .5 .5\nf 1/1 2/1 3/1 4/1\n";
    tool_write_file("point.obj", point, sizeof point - 1);
    RUNS(1, "unbake bare.ptx --mesh point.obj -o point.png --size 16");
    HAS("no face of point.obj");
    RUNS(1, "unbake ramp.ptx --mesh uv.obj -o nowhere/none.png");
    CHECK(access(tool_path("none.png"), F_OK) != 0);
}

/* There and back again, within the islands. */
static void spot(const char *samples) {
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    float *corners = NULL;
    char path[1024];
    slv_image image, back;
    RUNS(0, "bake %s/spot/spot_control_mesh.obj --uv %s/spot/spot_texture.png -o spot.ptx", samples,
         samples);
    RUNS(0, "unbake spot.ptx --mesh %s/spot/spot_control_mesh.obj -o spot.png", samples);
    HAS("1 image of 1024x1024");
    snprintf(path, sizeof path, "%s/spot/spot_texture.png", samples);
    MUST(slv_image_load(&env, path, &image));
    back = load("spot.png");
    REQUIRE(back.width == image.width && back.height == image.height);
    snprintf(path, sizeof path, "%s/spot/spot_control_mesh.obj", samples);
    MUST(slv_mesh_load(&env, path, &mesh));
    MUST(slv_mesh_face_texcoords(&env, mesh, &corners));
    uint8_t *inside = calloc(1024 * 1024, 1);
    enum { STEPS = 400 };
    for (uint32_t face = 0; face < slv_mesh_face_count(mesh); face++)
        for (int k = 0; k < STEPS * STEPS; k++) {
            float uv[2];
            uv_of_face(corners, face, ((float)(k % STEPS) + 0.5f) / STEPS,
                       ((float)(k / STEPS) + 0.5f) / STEPS, uv);
            int x = (int)floorf((uv[0] - floorf(uv[0])) * 1024),
                y = (int)floorf((1 - uv[1]) * 1024);
            if (y >= 0 && y < 1024)
                inside[y * 1024 + x] = 1;
        }
    double sum = 0;
    uint64_t count = 0;
    for (uint32_t i = 0; i < 1024 * 1024 * 3; i++)
        if (inside[i / 3]) {
            double d = (double)back.pixels[i] - (double)image.pixels[i];
            sum += d * d;
            count++;
        }
    double decibels = -10 * log10(sum / (double)count);
    fprintf(stderr, "spot there and back: %.2f dB over %llu pixels\n", decibels,
            (unsigned long long)count / 3);
    CHECK_MSG(decibels >= 32 && count > 1000000, "%.2f dB", decibels);
    free(inside);
    slv_free(corners);
    slv_mesh_destroy(mesh);
    slv_image_free(&image);
    slv_image_free(&back);
}

static float wave(uint32_t channel, float u, float v) {
    return 0.5f + 0.3f * sinf(6.2831853f * u + (float)channel) * (0.5f + 0.5f * v);
}

/* Around a tube with one coordinate a vertex and back; without a word the faces over its end are
 * drawn the wrong way, of which both ways warn. */
static void round_and_back(void) {
    enum { COLUMNS = 8, ROWS = 3 };
    char obj[4000];
    size_t used = 0;
    for (int j = 0; j <= ROWS; j++)
        for (int i = 0; i < COLUMNS; i++)
            used += (size_t)snprintf(obj + used, sizeof obj - used, "v %g %g %g\nvt %g %g\n",
                                     cos(0.7853981634 * i), sin(0.7853981634 * i), 0.5 * j,
                                     (double)i / COLUMNS, (double)j / ROWS);
    for (int j = 0; j < ROWS; j++)
        for (int i = 0; i < COLUMNS; i++) {
            int a = j * COLUMNS + i + 1, b = j * COLUMNS + (i + 1) % COLUMNS + 1;
            used +=
                (size_t)snprintf(obj + used, sizeof obj - used, "f %d/%d %d/%d %d/%d %d/%d\n", a, a,
                                 b, b, b + COLUMNS, b + COLUMNS, a + COLUMNS, a + COLUMNS);
        }
    tool_write_file("tube.obj", obj, used);
    uv_write_image("wave.exr", 64, 64, 3, wave, &uv_floats);
    RUNS(0, "bake tube.obj --uv wave.exr -o tube.ptx --size 16");
    HAS("3 of 24 faces span half of the map or more and run the other way");
    RUNS(0, "bake tube.obj --uv wave.exr --round u -o tube.ptx --size 16");
    CHECK(!strstr(tool_out, "warning"));
    RUNS(0, "unbake tube.ptx --mesh tube.obj -o tube.exr --size 64 --bits 32");
    HAS("3 of 24 faces span half of the map or more and run the other way");
    RUNS(0, "unbake tube.ptx --mesh tube.obj --round u -o tube.exr --size 64 --bits 32");
    CHECK(!strstr(tool_out, "warning"));
    slv_image back = load("tube.exr");
    float most = 0;
    for (uint32_t y = 4; y < 60; y++)
        for (uint32_t x = 0; x < 64; x++)
            for (uint32_t c = 0; c < 3; c++)
                most =
                    fmaxf(most, fabsf(back.pixels[(y * 64 + x) * 3 + c] -
                                      wave(c, ((float)x + 0.5f) / 64, 1 - ((float)y + 0.5f) / 64)));
    CHECK_MSG(most < 0.01f, "off by %g", (double)most);
    slv_image_free(&back);
    RUNS(2, "unbake tube.ptx --mesh tube.obj --round u -o 'tube.<UDIM>.exr'");
    RUNS(2, "unbake tube.ptx --mesh tube.obj --round u --tangent object-normal -o tube.exr");
}

int main(void) {
    const char *samples = getenv("SELVAGE_SAMPLES");
    tool_begin();
    tool_write_file("uv.obj", uv_obj, sizeof uv_obj - 1);
    /* without the quad that has no coordinates */
    tool_write_file("all.obj", uv_obj, (size_t)(strstr(uv_obj, "f 3 10") - uv_obj));
    values();
    seams();
    tiles();
    beyond_tiles();
    alpha();
    same_and_refused();
    if (samples)
        spot(samples);
    round_and_back();
    tool_end();
    return test_end();
}
