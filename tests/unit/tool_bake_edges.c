/* Baked edges, however two faces are turned against each other: all 16 pairs of edges, at equal and
 * different resolutions; those of a pentagon; and a model carried over to itself, which stays what
 * it is. */
#include "kit/mesh_shapes.h"
#include "kit/tool_kit.h"

#include <selvage/bake.h>
#include <selvage/transfer.h>

/* Two quads in a plane that share the line x = 1: the left one meets it with edge `a`, the right
 * one with edge `b`. */
static slv_mesh *pair(unsigned a, unsigned b) {
    /* counter-clockwise from where the shared edge starts, as each sees it */
    static const int left[4] = {2, 5, 4, 1}, right[4] = {5, 2, 3, 6};
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    char text[512];
    size_t used = (size_t)snprintf(text, sizeof text,
                                   "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n");
    for (int face = 0; face < 2; face++) {
        used += (size_t)snprintf(text + used, sizeof text - used, "f");
        for (unsigned c = 0; c < 4; c++)
            used += (size_t)snprintf(text + used, sizeof text - used, " %d",
                                     (face ? right : left)[(c + 4 - (face ? b : a)) % 4]);
        used += (size_t)snprintf(text + used, sizeof text - used, "\n");
    }
    MUST(slv_mesh_parse_obj(&env, "pair", text, used, &mesh));
    return mesh;
}

/* Texel j of an edge's outermost row, counter-clockwise. */
static const float *row_texel(const float *texels, slv_res res, unsigned edge, uint32_t j) {
    uint32_t w = 1u << res.u, h = 1u << res.v;
    uint32_t at[4] = {j, j * w + w - 1, (h - 1) * w + w - 1 - j, (h - 1 - j) * w};
    return texels + (size_t)3 * at[edge];
}

static void one_pair(unsigned a, unsigned b, const slv_res res[2]) {
    slv_env env = test_env();
    slv_mesh *mesh = pair(a, b);
    slv_surface *surface = NULL;
    slv_bake_source *source = NULL;
    const slv_surface_params flat = {.scheme = SLV_SCHEME_BILINEAR};
    slv_ptx *ptx = NULL;
    slv_adjacency *adjacency = NULL;
    static float texels[2][3 * 16 * 16];
    MUST(slv_mesh_adjacency(&env, mesh, &adjacency));
    const slv_face_adjacency *faces = slv_adjacency_faces(adjacency);
    CHECK(faces[0].face[a] == 1 && faces[0].edge[a] == b && faces[1].face[b] == 0);
    MUST(slv_surface_create(&env, mesh, &flat, &surface));
    MUST(slv_bake_from_surface(&env, surface, SLV_BAKE_POSITION, &source));
    const slv_bake_job job = {.uniform = true, .res = {4, 4}};
    MUST(slv_bake_save(&env, mesh, source, &job, tool_path("pair.ptx"), NULL));
    char line[200];
    snprintf(line, sizeof line, "convert pair.ptx sized.ptx --res 0=%ux%u,1=%ux%u --reductions all",
             1u << res[0].u, 1u << res[0].v, 1u << res[1].u, 1u << res[1].v);
    RUNS(0, "%s", line);
    RUNS(0, "check --strict sized.ptx --seams 0.00001");
    MUST(slv_ptx_open(&env, tool_path("sized.ptx"), &ptx));
    for (uint32_t f = 0; f < 2; f++)
        MUST(slv_ptx_read_face(ptx, f, res[f], texels[f]));
    /* Of equal texels both rows lie on the shared line: at x = 1, and y in the middle of a texel,
     * which the left face sees from below and the right one from above. */
    uint32_t n[2] = {1u << (a & 1 ? res[0].v : res[0].u), 1u << (b & 1 ? res[1].v : res[1].u)};
    uint32_t deep[2] = {1u << (a & 1 ? res[0].u : res[0].v), 1u << (b & 1 ? res[1].u : res[1].v)};
    for (uint32_t j = 1; j + 1 < n[0] && n[0] == n[1] && deep[0] == deep[1]; j++) {
        const float *l = row_texel(texels[0], res[0], a, j),
                    *r = row_texel(texels[1], res[1], b, n[0] - 1 - j);
        float y = ((float)j + 0.5f) / (float)n[0];
        CHECK_MSG(l[0] == r[0] && l[1] == r[1] && fabsf(l[0] - 1) < 1e-5f &&
                      fabsf(l[1] - y) < 1e-5f,
                  "edges %u and %u, texel %u: %g %g and %g %g", a, b, j, (double)l[0], (double)l[1],
                  (double)r[0], (double)r[1]);
    }
    slv_ptx_close(ptx);
    slv_bake_source_destroy(source);
    slv_surface_destroy(surface);
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
}

static void edges(void) {
    static const slv_res sizes[3][2] = {{{4, 4}, {4, 4}}, {{4, 3}, {2, 4}}, {{3, 3}, {4, 4}}};
    for (unsigned a = 0; a < 4; a++)
        for (unsigned b = 0; b < 4; b++)
            for (int i = 0; i < 3; i++)
                one_pair(a, b, sizes[i]);
}

/* Onto itself: the same texels, to the bit. */
static void onto_itself(void) {
    static const char obj[] = "v 0 0 0\nv 1 0 .2\nv 3 0 0\nv 0 1 0\nv 1 1 .5\nv 3 1 1\nv 4 0 0\n"
                              "v 0 2 1\nv 1 2.5 1\nv 3 2 0\nf 1 2 5 4\nf 2 3 6 5\nf 3 7 6\n"
                              "f 4 5 9 8\nf 5 6 10 9\n";
    tool_write_file("self.obj", obj, sizeof obj - 1);
    RUNS(0, "bake self.obj --pattern noise --frequency 5 --density 20 --type float -o self.ptx");
    RUNS(0, "transfer self.ptx copied.ptx --to self.obj");
    RUNS(0, "diff self.ptx copied.ptx --texels");
}

/* A pentagon's sub-faces and the quads around it, at sizes of which the least would leave a quad no
 * texel for the middle of its edge. */
static void pentagon(void) {
    static const char mesh[] =
        "v 1 0 0\nv .31 .95 0\nv -.81 .59 0\nv -.81 -.59 0\nv .31 -.95 0\n"
        "v 2.2 0 -.4\nv .68 2.09 -.4\nv -1.78 1.29 -.4\nv -1.78 -1.29 -.4\nv .68 -2.09 -.4\n"
        "f 1 2 3 4 5\nf 1 6 7 2\nf 2 7 8 3\nf 3 8 9 4\nf 4 9 10 5\nf 5 10 6 1\n";
    FILE *file = fopen(tool_path("pentagon.obj"), "w");
    REQUIRE(file && fputs(mesh, file) >= 0 && fclose(file) == 0);
    for (int density = 1; density <= 8; density *= 2) {
        RUNS(
            0,
            "bake pentagon.obj --pattern noise --frequency 3 --density %d --type uint8 -q -o p.ptx",
            density);
        RUNS(0, "check p.ptx --seams 0.0042 --strict");
    }
}

int main(void) {
    tool_begin();
    edges();
    pentagon();
    onto_itself();
    tool_end();
    return test_end();
}
