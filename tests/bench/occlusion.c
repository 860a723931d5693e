/* bench_occlusion [MESH.obj] [--json] [--smoke]
 *
 * Ambient occlusion against what Embree alone does with the same rays, in one run on one thread:
 * the program stands between the baker and Embree, keeps the rays of one bake, and times another
 * bake and the casting of what it kept, in turns. Of a torus whose surface is bumpy, or of a mesh.
 */
#include "kit/bench_kit.h"

#include <selvage/bake.h>

#include <dlfcn.h>
#include <string.h>
#if SLV_EMBREE_VERSION >= 4
#include <embree4/rtcore.h>
#define CONTEXT struct RTCOccludedArguments
#else
#include <embree3/rtcore.h>
#define CONTEXT struct RTCIntersectContext
#endif

enum { TURNS = 5 };

typedef void occluded_fn(RTCScene scene, CONTEXT *context, struct RTCRay *ray);

static struct {
    occluded_fn *embree;
    RTCScene scene;
    struct RTCRay *rays; /* NULL: none are kept */
    size_t count, room;
} kept;

/* Found before Embree's own, which it calls. */
__attribute__((visibility("default"))) void rtcOccluded1(RTCScene scene, CONTEXT *context,
                                                         struct RTCRay *ray) {
    if (kept.rays && kept.count < kept.room) {
        kept.scene = scene;
        kept.rays[kept.count++] = *ray;
    }
    kept.embree(scene, context, ray);
}

static void bake(const slv_env *env, const slv_bake_source *source, uint32_t nfaces, slv_res res) {
    float values[256];
    uint8_t misses[256];
    const slv_rect all = {0, 0, 1u << res.u, 1u << res.v};
    for (uint32_t face = 0; face < nfaces; face++)
        bench_stop(slv_bake_evaluate(source, env, face, res, all, values, misses));
}

static void cast_kept(void) {
    for (size_t i = 0; i < kept.count; i++) {
        struct RTCRay ray = kept.rays[i];
#if SLV_EMBREE_VERSION >= 4
        kept.embree(kept.scene, NULL, &ray);
#else
        struct RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        kept.embree(kept.scene, &context, &ray);
#endif
    }
}

static slv_mesh *bumpy_torus(const slv_env *env) {
    enum { AROUND = 48, ACROSS = 24 };
    static char text[AROUND * ACROSS * 160];
    size_t used = 0;
    slv_mesh *mesh = NULL;
    for (int i = 0; i < AROUND * ACROSS; i++) {
        const double a = 6.283185307 * (i / ACROSS) / AROUND,
                     b = 6.283185307 * (i % ACROSS) / ACROSS,
                     r = 0.4 + 0.08 * sin(9 * a) * sin(5 * b);
        used += (size_t)snprintf(text + used, sizeof text - used, "v %g %g %g\n",
                                 (1 + r * cos(b)) * cos(a), (1 + r * cos(b)) * sin(a), r * sin(b));
    }
    for (int i = 0; i < AROUND * ACROSS; i++) {
        const int a = i / ACROSS, b = i % ACROSS, c = (a + 1) % AROUND, d = (b + 1) % ACROSS;
        used +=
            (size_t)snprintf(text + used, sizeof text - used, "f %d %d %d %d\n", a * ACROSS + b + 1,
                             c * ACROSS + b + 1, c * ACROSS + d + 1, a * ACROSS + d + 1);
    }
    bench_stop(slv_mesh_parse_obj(env, "torus", text, used, &mesh));
    return mesh;
}

int main(int argc, char **argv) {
    bool json = false, smoke = false;
    const char *path = NULL;
    if (!bench_arguments(argc, argv, "MESH.obj", &path, &json, &smoke))
        return 2;
    const slv_env env = {.log = bench_log, .threads = 1};
    void *found = dlsym(RTLD_NEXT, "rtcOccluded1");
    memcpy(&kept.embree, &found, sizeof found);
    slv_mesh *mesh = NULL;
    slv_surface *surface = NULL;
    slv_bake_source *source = NULL;
    if (path)
        bench_stop(slv_mesh_load(&env, path, &mesh));
    else
        mesh = bumpy_torus(&env);
    const slv_bake_rays rays = {.samples = smoke ? 8 : 256};
    const slv_res res = {1, 1};
    uint32_t nfaces = slv_mesh_face_count(mesh);
    nfaces = nfaces < 1024 ? nfaces : 1024;
    bench_stop(slv_surface_create(&env, mesh, NULL, &surface));
    bench_stop(slv_bake_from_rays(&env, mesh, surface, &rays, &source));
    kept.room = (size_t)nfaces * 4 * rays.samples;
    if (!kept.embree || !(kept.rays = malloc(kept.room * sizeof *kept.rays)))
        return 1;
    struct RTCRay *all = kept.rays;
    bake(&env, source, nfaces, res);
    double ours = INFINITY, alone = INFINITY;
    for (int i = 0; i < TURNS; i++) {
        kept.rays = NULL;
        const double begin = bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
        bake(&env, source, nfaces, res);
        const double middle = bench_seconds(CLOCK_PROCESS_CPUTIME_ID);
        kept.rays = all;
        cast_kept();
        ours = fmin(ours, middle - begin);
        alone = fmin(alone, bench_seconds(CLOCK_PROCESS_CPUTIME_ID) - middle);
    }
    bench_report(json, "ambient occlusion", "Mray/s a core", (double)kept.count / ours * 1e-6);
    bench_report(json, "Embree alone, the same rays", "Mray/s a core",
                 (double)kept.count / alone * 1e-6);
    bench_bars bars = {0};
    bench_bar(&bars, json, "share of what Embree alone reaches", "", alone / ours, 0.7, false);
    bench_bars_end(&bars, json);
    free(all);
    slv_bake_source_destroy(source);
    slv_surface_destroy(surface);
    slv_mesh_destroy(mesh);
    return kept.count == kept.room ? 0 : 1;
}
