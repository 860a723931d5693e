/* Colours of vertices on faces: of all ways in which files have them, as light, on sub-faces, with
 * alpha, and where a vertex has none. */
#include "kit/uv_kit.h"

#include <selvage/wrap.h>

static float light(float x) {
    return x <= 0.04045f ? x / 12.92f : powf((x + 0.055f) / 1.055f, 2.4f);
}

/* Corners of a quad and a triangle beside it, as the formats have them; %s stands for a colour. */
static const float colors[5][3] = {
    {0.2f, 0.4f, 1}, {0.6f, 0, 0.2f}, {1, 1, 0.4f}, {0, 0.8f, 0.6f}, {0.4f, 0.6f, 0.8f}};
static const char *const places[5] = {"0 0 0", "1 0 0", "1 1 0", "0 1 0", "2 0 0"};

static slv_mesh *parse(const char *format, double scale, bool ply, const char *header) {
    slv_env env = test_env();
    char text[2000];
    size_t used = (size_t)snprintf(text, sizeof text, "%s", header);
    slv_mesh *mesh = NULL;
    for (int v = 0; v < 5; v++) {
        used +=
            (size_t)snprintf(text + used, sizeof text - used, "%s%s", ply ? "" : "v ", places[v]);
        used +=
            (size_t)snprintf(text + used, sizeof text - used, format, scale * (double)colors[v][0],
                             scale * (double)colors[v][1], scale * (double)colors[v][2]);
    }
    used += (size_t)snprintf(text + used, sizeof text - used,
                             ply ? "4 0 1 2 3\n3 1 4 2\n" : "f 1 2 3 4\nf 2 5 3\n");
    MUST(ply ? slv_mesh_parse_ply(&env, "mesh", text, used, &mesh)
             : slv_mesh_parse_obj(&env, "mesh", text, used, &mesh));
    return mesh;
}

/* All texels of both polygons against the interpolation of what `light_of` makes of the numbers;
 * takes the mesh. */
static void check(const char *what, slv_mesh *mesh, float (*light_of)(float), slv_type type,
                  float tolerance) {
    slv_env env = test_env();
    slv_bake_source *source = NULL;
    MUST(slv_bake_from_vertex_colors(&env, mesh, SLV_TEXTURE_AUTO, &source));
    const slv_bake_source_desc *desc = slv_bake_source_get_desc(source);
    uint32_t n = desc->nchannels;
    CHECK_MSG(n == (desc->alpha_channel < 0 ? 3 : 4) && desc->type == type, "%s", what);
    CHECK(slv_mesh_face_count(mesh) == 4);
    for (uint32_t face = 0; face < 4; face++) {
        static const int quad[4] = {0, 1, 2, 3}, triangle[3] = {1, 4, 2};
        float values[4 * 8 * 4];
        uint8_t misses[4 * 8];
        MUST(slv_bake_evaluate(source, &env, face, (slv_res){2, 3}, (slv_rect){0, 0, 4, 8}, values,
                               misses));
        for (int i = 0; i < 32; i++)
            for (uint32_t c = 0; c < n; c++) {
                float u = ((float)(i % 4) + 0.5f) / 4, v = ((float)(i / 4) + 0.5f) / 8, at[4];
                for (int k = 0; k < 4 && face == 0; k++)
                    at[k] = c < 3 ? light_of(colors[quad[k]][c]) : 1;
                if (face && c < 3) {
                    float own = light_of(colors[triangle[face - 1]][c]),
                          next = light_of(colors[triangle[face % 3]][c]),
                          last = light_of(colors[triangle[(face + 1) % 3]][c]);
                    at[0] = own;
                    at[1] = (own + next) / 2;
                    at[2] = (own + next + last) / 3;
                    at[3] = (own + last) / 2;
                }
                float want =
                    (at[0] * (1 - u) + at[1] * u) * (1 - v) + (at[3] * (1 - u) + at[2] * u) * v;
                want = c < 3 ? want : 1;
                CHECK_MSG(!misses[i] && fabsf(values[(uint32_t)i * n + c] - want) < tolerance,
                          "%s: face %u texel %d channel %u: %g, not %g", what, face, i, c,
                          (double)values[(uint32_t)i * n + c], (double)want);
            }
    }
    slv_bake_source_destroy(source);
    slv_mesh_destroy(mesh);
}

static float same(float x) {
    return x;
}

#define PLY(type, more)                                                                            \
    "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float " \
    "z\nproperty " type " red\nproperty " type " green\nproperty " type " blue\n" more             \
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"

static void formats(void) {
    slv_env env = test_env();
    slv_mesh *mesh;
    check("rgb", parse(" %g %g %g\n", 1, false, ""), light, SLV_TYPE_U8, 1e-6f);
    check("weighted", parse(" 1 %g %g %g 1\n", 1, false, "# five\n"), light, SLV_TYPE_U8, 1e-6f);
    check("bytes", parse(" %.0f %.0f %.0f\n", 255, false, ""), light, SLV_TYPE_U8, 1e-6f);
    check("uchar", parse(" %.0f %.0f %.0f\n", 255, true, PLY("uchar", "")), light, SLV_TYPE_U8,
          1e-6f);
    check("ushort", parse(" %.0f %.0f %.0f\n", 65535, true, PLY("ushort", "")), light, SLV_TYPE_U8,
          1e-6f);
    check("float", parse(" %g %g %g\n", 1, true, PLY("float", "")), same, SLV_TYPE_FLOAT, 1e-6f);
    /* and written again, the light of floats as sRGB */
    mesh = parse(" %g %g %g\n", 1, true, PLY("float", ""));
    MUST(slv_mesh_save_obj(&env, mesh, tool_path("saved.obj")));
    slv_mesh_destroy(mesh);
    MUST(slv_mesh_load(&env, tool_path("saved.obj"), &mesh));
    check("saved", mesh, same, SLV_TYPE_U8, 2e-6f);
}

/* Between a covered and a bare vertex the colour is that of the covered one, and half covered. */
static void alpha(void) {
    slv_env env = test_env();
    slv_mesh *mesh = uv_parse("v 0 0 0 1 0.5 0 1\nv 1 0 0 0 0 1 0\nv 1 1 0 0 0 1 0\n"
                              "v 0 1 0 1 0.5 0 1\nf 1 2 3 4\n");
    slv_bake_source *source = NULL;
    float value[4];
    uint8_t missed;
    MUST(slv_bake_from_vertex_colors(&env, mesh, SLV_TEXTURE_AUTO, &source));
    CHECK(slv_bake_source_get_desc(source)->alpha_channel == 3);
    MUST(slv_bake_evaluate(source, &env, 0, (slv_res){0, 0}, (slv_rect){0, 0, 1, 1}, value,
                           &missed));
    CHECK(!missed && fabsf(value[0] - 1) < 1e-6f && fabsf(value[1] - light(0.5f)) < 1e-6f &&
          value[2] < 1e-6f && fabsf(value[3] - 0.5f) < 1e-6f);
    slv_bake_source_destroy(source);
    slv_mesh_destroy(mesh);
}

/* A polygon with a vertex that has no colour is missed, a mesh without any refused; welding takes
 * colours along. */
static void missing(void) {
    slv_env env = test_env();
    slv_bake_source *source = NULL;
    slv_mesh *mesh =
                 uv_parse("v 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\nv 0 1 0 1 0 0\nv 2 0 0 1 0 0\n"
                          "v 2 1 0 1 0 0\nf 1 2 3 4\nf 2 5 6 3\n"),
             *bare = uv_parse("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n"), *welded = NULL;
    float value[3];
    uint8_t missed;
    const slv_rect one = {0, 0, 1, 1};
    MUST(slv_bake_from_vertex_colors(&env, mesh, SLV_TEXTURE_DATA, &source));
    MUST(slv_bake_evaluate(source, &env, 0, (slv_res){0, 0}, one, value, &missed));
    CHECK(missed == SLV_BAKE_NAN && value[0] == 0);
    MUST(slv_bake_evaluate(source, &env, 1, (slv_res){0, 0}, one, value, &missed));
    CHECK(!missed && value[0] == 1 && value[1] == 0);
    slv_bake_source_destroy(source);
    CHECK(slv_bake_from_vertex_colors(&env, bare, SLV_TEXTURE_AUTO, &source) == SLV_ERROR_MISMATCH);
    slv_mesh_destroy(bare);
    slv_mesh_destroy(mesh);
    mesh = uv_parse("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 1\nv 1 0 0 0 1 0\n"
                    "v 1 1 0 0 0 1\nv 2 0 0 0 1 1\nv 2 1 0 1 0 1\nf 1 2 3 4\nf 5 7 8 6\n");
    MUST(slv_mesh_wrap(&env, mesh, NULL, NULL, &welded));
    const slv_mesh_view *view = slv_mesh_get_view(welded);
    CHECK(view->nverts == 6 && view->colors);
    for (uint32_t v = 0; view->colors && v < view->nverts; v++)
        CHECK(view->colors[4 * v] == (view->positions[3 * v] == 0 || v == 5 ? 1.0f : 0.0f));
    slv_mesh_destroy(mesh);
    slv_mesh_destroy(welded);
}

/* The command, and what it says of a mesh that has no colours. */
static void verb(void) {
    static const char text[] = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 1\n"
                               "f 1 2 3 4\n";
    tool_write_file("c.obj", text, sizeof text - 1);
    RUNS(0, "bake c.obj --vertex-color --size 8 -o a.ptx");
    RUNS(0, "bake c.obj --vertex-color --size 8 --threads 2 -o b.ptx");
    CHECK(uv_same_files("a.ptx", "b.ptx"));
    RUNS(0, "bake c.obj --vertex-color --print-recipe --texture-encoding data -o b.ptx");
    HAS("\"vertex-color\": true");
    RUNS(2, "bake c.obj --vertex-color --pattern noise -o b.ptx");
    tool_write_file("r.json", "{\"source\": {\"vertex-color\": 1}}", 31);
    RUNS(1, "bake c.obj --recipe r.json -o none.ptx");
    HAS("expected true");
    tool_write_file("bare.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", 32);
    RUNS(1, "bake bare.obj --vertex-color -o none.ptx");
    HAS("no colours");
    CHECK(access(tool_path("none.ptx"), F_OK) != 0);
}

int main(void) {
    tool_begin();
    formats();
    alpha();
    missing();
    verb();
    tool_end();
    return test_end();
}
