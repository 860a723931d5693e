/* Seams of triangle textures: what holds of faces of quads holds of the sub-faces that triangles
 * are drawn as, on any mesh of triangles and with any resolutions side by side. */
#include "kit/seam_kit.h"
#include "kit/strategy_kit.h"
#include "kit/triangle_kit.h"

static slv_gl *gl;

static slv_gl_seam jump(slv_gl_texture *texture, const kit *k, const char *strategy,
                        uint32_t level) {
    return seam_jump(texture, k, kit_strategy(strategy),
                     (slv_gl_seam_params){.samples = 33, .level = level});
}

static void check_seam(slv_gl_texture *texture, const kit *k, const char *strategy, uint32_t level,
                       const char *name) {
    slv_gl_seam seam = jump(texture, k, strategy, level);
    CHECK_MSG(seam.max <= 1.0f / 255, "%s level %u: %s jumps by %g/255 at face %d edge %d t %g",
              name, level, strategy, (double)seam.max * 255, seam.face, seam.edge, (double)seam.t);
}

static void check_mesh(int kind, slv_type type, uint32_t nchannels, bool mixed, uint64_t *random) {
    shape s = triangle_shape(kind, random);
    int8_t log2[KIT_POLYS];
    char name[64];
    uint32_t equal = test_random(random) % 4;
    REQUIRE(s.npolys <= KIT_POLYS);
    for (uint32_t f = 0; f < s.npolys; f++)
        log2[f] = (int8_t)(mixed ? test_random(random) % 6 : equal);
    slv_texture *triangles = triangle_noise(s.npolys, log2, type, nchannels, random);
    kit k = triangle_kit(&s, triangles);
    slv_gl_texture *texture = seam_upload(gl, &k, (slv_gl_texture_params){.anisotropy = 1});
    snprintf(name, sizeof name, "kind %d, %s", kind, mixed ? "mixed" : "equal");
    slv_gl_seam clamp = jump(texture, &k, "clamp", 0);
    CHECK(clamp.nedges > 0 && clamp.max > (mixed ? 0.05f : 0.02f));
    for (uint32_t level = 0; level < (mixed ? 1 : equal + 1); level++) {
        if (!mixed)
            check_seam(texture, &k, "borders", level, name);
        check_seam(texture, &k, "traverse", level, name);
        check_seam(texture, &k, "traverse-full", level, name);
        check_seam(texture, &k, "edge-aligned", level, name);
        check_seam(texture, &k, "htex", level, name);
    }
    check_seam(texture, &k, "hybrid", 0, name);
    if (mixed) {
        slv_gl_seam borders = jump(texture, &k, "borders", 0);
        fprintf(stderr, "%s: clamp %.2f/255 mean, borders %.2f mean %.2f most, %.2f of equals\n",
                name, (double)clamp.mean * 255, (double)borders.mean * 255,
                (double)borders.max * 255, (double)borders.equal_max * 255);
        CHECK_MSG(borders.mean < clamp.mean / 8, "%s: borders %g clamp %g", name,
                  (double)borders.mean, (double)clamp.mean);
        CHECK_MSG(borders.equal_max <= 1.0f / 255, "%s: borders jump by %g between equals", name,
                  (double)borders.equal_max);
    }
    slv_gl_texture_destroy(texture);
    slv_texture_destroy(triangles);
    kit_free(&k);
    shape_clear(&s);
}

int main(void) {
    uint64_t random = 23;
    slv_env env = test_env();
    REQUIRE(slv_gl_create(&env, SLV_GL_AUTO, &gl) == SLV_OK);
    for (int kind = 0; kind < TRIANGLE_KINDS; kind++) {
        if (!test_skip((uint32_t)kind, 2))
            check_mesh(kind, (slv_type)(kind % 4), 1 + (uint32_t)kind % 4, false, &random);
        if (!test_skip((uint32_t)kind + 1, 2))
            check_mesh(kind, (slv_type)((kind + 1) % 4), 1 + (uint32_t)kind % 3, true, &random);
    }
    slv_gl_destroy(gl);
    return test_end();
}
