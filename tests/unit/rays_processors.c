/* Rays of texels made by each kind of processor are the same to the bit; they begin on the surface,
 * leave it, and are as likely as their cosine. */
#include "kit/test.h"

#include "base/processor.h"
#include "rays/texel_rays.h"

/* A wavy sheet, welded like any other. */
static slv_tessellation make_sheet(slv_mesh **mesh, slv_surface **surface) {
    enum { SIDE = 6 };
    static char text[SIDE * SIDE * 100];
    slv_env env = test_env();
    slv_adjacency *adjacency = NULL;
    slv_tessellation sheet;
    size_t used = 0;
    for (int i = 0; i < SIDE * SIDE; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, "v %d %d %g\n", i % SIDE,
                                 i / SIDE, (double)(i * 7 % 5) * 0.3);
    for (int i = 0; i < SIDE * (SIDE - 1); i++)
        if (i % SIDE < SIDE - 1)
            used += (size_t)snprintf(text + used, sizeof text - used, "f %d %d %d %d\n", i + 1,
                                     i + 2, i + SIDE + 2, i + SIDE + 1);
    REQUIRE(!slv_mesh_parse_obj(&env, "sheet", text, used, mesh));
    REQUIRE(!slv_surface_create(&env, *mesh, NULL, surface));
    REQUIRE(!slv_mesh_adjacency(&env, *mesh, &adjacency));
    REQUIRE(!slv_tessellate(&env, *mesh, *surface, adjacency, 8, &sheet));
    slv_adjacency_destroy(adjacency);
    return sheet;
}

int main(void) {
#define RAYS(KIND) {#KIND, slvi_has_##KIND, slvi_texel_rays_##KIND},
    static const struct {
        const char *name;
        bool (*runs)(void);
        slvi_texel_rays *make;
    } kinds[] = {SLVI_RAYS_PROCESSORS(RAYS)};
    enum { COUNT = sizeof kinds / sizeof *kinds, SAMPLES = 256 };
    slv_env env = test_env();
    slv_mesh *mesh = NULL;
    slv_surface *surface = NULL;
    slv_tessellation sheet = make_sheet(&mesh, &surface);
    reference_sampler sampler;
    uint64_t random = 5;
    int ran = 0;
    REQUIRE(!slvi_reference_sampler_create(&env, SLV_PIXEL_BOX, 3, SAMPLES, &sampler));
    for (int round = 0; round < 60; round++) {
        const ray_ground ground = {&sheet, &sampler, 1e-5f, 7, round & 1};
        const slv_res res = {(int8_t)(round % 4), (int8_t)(round % 3)};
        const ray_texel texel = {(uint32_t)(test_random(&random) % sheet.nfaces),
                                 (uint32_t)(test_random(&random) % (1u << res.u)),
                                 (uint32_t)(test_random(&random) % (1u << res.v)), res};
        double sum[3] = {0}, up = 0, length = 0;
        for (uint32_t first = 0; first < SAMPLES; first += SLVI_TEXEL_RAYS) {
            static struct RTCRay want[SLVI_TEXEL_RAYS], found[SLVI_TEXEL_RAYS];
            const uint32_t count = round % 5 ? SLVI_TEXEL_RAYS : SLVI_TEXEL_RAYS - 3;
            for (int k = COUNT - 1; k >= 0; k--) {
                if (!kinds[k].runs())
                    continue;
                memset(found, 0, sizeof found);
                kinds[k].make(&ground, &texel, first, count, found);
                if (k == COUNT - 1)
                    memcpy(want, found, sizeof want);
                CHECK_MSG(memcmp(want, found, sizeof want) == 0, "round %d: %s differs", round,
                          kinds[k].name);
                ran += k < COUNT - 1;
            }
            for (uint32_t i = 0; i < count; i++) {
                const struct RTCRay *ray = &want[i];
                const double d[3] = {(double)ray->dir_x, (double)ray->dir_y, (double)ray->dir_z};
                CHECK(fabs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - 1) < 1e-5 && ray->tfar == 7);
                CHECK(ray->org_x >= -1 && ray->org_x <= 6 && ray->org_y >= -1 && ray->org_y <= 6);
                for (int c = 0; c < 3; c++)
                    sum[c] += d[c] / SAMPLES;
                up += d[2] / SAMPLES;
            }
        }
        for (int c = 0; c < 3; c++)
            length += sum[c] * sum[c];
        /* of all 256: 2/3, and a little less where the surface bends within the texel */
        CHECK_MSG(round % 5 == 0 ||
                      (sqrt(length) < 0.673 && sqrt(length) > 0.5 && (up < 0) == (round & 1)),
                  "round %d: directions have a mean of %g, %g of it upwards", round, sqrt(length),
                  up);
    }
    slvi_reference_sampler_free(&sampler);
    slv_tessellation_free(&sheet);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    if (!ran) {
        fprintf(stderr, "this processor has no AVX2: nothing to compare\n");
        return test_end() ? 1 : 77;
    }
    return test_end();
}
