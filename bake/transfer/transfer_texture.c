/* A transfer between textures in memory, and how much larger one model is than the other. */
#include "transfer/transfer_data.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

struct store {
    const slv_env *env;
    const slv_texture *from;
    slv_texture *out;
};

static slv_result begin(void *user, const slv_texture_desc *desc) {
    struct store *store = user;
    slv_texture_desc own = *desc;
    own.encoding = slv_texture_get_desc(store->from)->encoding; /* which sources do not tell */
    return slv_texture_create(store->env, &own, &store->out);
}

static slv_result put(void *user, const slv_env *env, uint32_t face, bool constant,
                      const void *texels) {
    const struct store *store = user;
    (void)env; /* the texture's own log is serialised */
    return constant ? slv_texture_set_constant(store->out, face, texels)
                    : slv_texture_set_face(store->out, face, texels);
}

static slv_result transfer(const slv_env *env, const slv_mesh *source, const slv_texture *texture,
                           const slv_mesh *target, const slv_transfer_params *params,
                           slv_transfer_face *faces, float *covered, slv_texture **out) {
    struct store store = {.env = env, .from = texture};
    const slv_transfer_sink sink = {begin, put, &store};
    slv_source texels;
    *out = NULL;
    slv_result result = slv_texture_as_source(env, texture, NULL, NULL, &texels);
    if (!result)
        result = slv_transfer_from(env, source, &texels, target, params, &sink, faces, covered);
    slv_source_close(&texels);
    if (result)
        slv_texture_destroy(store.out);
    else
        *out = store.out;
    return result;
}

slv_result slv_transfer(const slv_env *env, const slv_mesh *source, const slv_texture *texture,
                        const slv_mesh *target, const slv_transfer_params *params,
                        slv_transfer_face *faces, float *covered, slv_texture **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own,
                           transfer(&own, source, texture, target, params, faces, covered, out));
}

static double diagonal_of(const slv_mesh *mesh) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    double sum = 0;
    for (int k = 0; k < 3 && view->nverts; k++) {
        double low = INFINITY, high = -INFINITY;
        for (uint32_t v = 0; v < view->nverts; v++) {
            low = fmin(low, (double)view->positions[3 * (size_t)v + (size_t)k]);
            high = fmax(high, (double)view->positions[3 * (size_t)v + (size_t)k]);
        }
        sum += (high - low) * (high - low);
    }
    return sqrt(sum);
}

float slv_transfer_find_scale(const slv_mesh *source, const slv_mesh *target) {
    /* metres, inches and feet in each other, but for powers of ten */
    static const double units[] = {1, 2.54, 1 / 0.254, 3.048, 1 / 0.3048, 1.2, 1 / 0.12};
    double from = diagonal_of(source), to = diagonal_of(target), best = log(1.05), scale;
    if (!(from > 0) || !(to > 0))
        return 1;
    double ratio = scale = to / from;
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        for (int power = -7; power <= 7; power++) {
            double known = units[i] * pow(10, power), off = fabs(log(ratio / known));
            if (off < best) {
                best = off;
                scale = known;
            }
        }
    return (float)scale;
}
