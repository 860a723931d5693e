/* A source of texels of your own: nothing is stored, texels are computed where they are asked for.
 *
 *   cc source.c $(pkg-config --cflags --libs selvage) -o source && ./source
 *
 * Prints what lookups see of it, before and after it changes. */
#include <selvage/filter.h>

#include <stdatomic.h>
#include <stdio.h>

enum { SIDE = 4, FACES = SIDE * SIDE, LOG2 = 5 }; /* a square of squares, 32 x 32 texels each */

typedef struct checkers {
    slv_env env;            /* where words go */
    _Atomic(uint64_t) time; /* from 1 on: the colours turn with it */
} checkers;

static const slv_source_fns checkers_fns;

static slv_result describe(void *user, slv_source_desc *out) {
    (void)user;
    *out = (slv_source_desc){.name = "checkers",
                             .nfaces = FACES,
                             .type = SLV_TYPE_U8,
                             .nchannels = 3,
                             .alpha_channel = SLV_NO_ALPHA};
    return SLV_OK;
}

static slv_result find_face(void *user, uint32_t face, slv_source_face *out) {
    checkers *c = user;
    int32_t x = (int32_t)face % SIDE, y = (int32_t)face / SIDE, at = (int32_t)face;
    if (face >= FACES && c->env.log)
        c->env.log(c->env.log_user, SLV_LOG_ERROR, "checkers: no such face");
    if (face >= FACES)
        return SLV_ERROR_ARGUMENT;
    *out = (slv_source_face){.res = {LOG2, LOG2}, .adjacency.edge = {2, 3, 0, 1}};
    out->adjacency.face[0] = y > 0 ? at - SIDE : SLV_BOUNDARY;
    out->adjacency.face[1] = x + 1 < SIDE ? at + 1 : SLV_BOUNDARY;
    out->adjacency.face[2] = y + 1 < SIDE ? at + SIDE : SLV_BOUNDARY;
    out->adjacency.face[3] = x > 0 ? at - 1 : SLV_BOUNDARY;
    return SLV_OK;
}

/* Computes what is asked for at full resolution; the library makes reductions of that. */
static slv_result read_rect(void *user, uint32_t face, slv_res res, slv_rect rect, void *out) {
    checkers *c = user;
    slv_source self = {&checkers_fns, c};
    slv_source_face found;
    uint8_t *to = out;
    slv_result result = slv_source_check(&c->env, &self, face, res, rect, &found);
    if (result || res.u < LOG2 || res.v < LOG2)
        return result ? result : slv_source_reduce(&c->env, &self, face, res, rect, out);
    for (uint32_t y = rect.y; y < rect.y + rect.height; y++)
        for (uint32_t x = rect.x; x < rect.x + rect.width; x++, to += 3) {
            to[0] = (uint8_t)((x / 4 + y / 4) % 2 ? 230 : 20);
            to[1] = (uint8_t)(8 * x + face);
            to[2] = (uint8_t)(16 * y + 40 * c->time);
        }
    return SLV_OK;
}

static uint64_t version(void *user) {
    return ((checkers *)user)->time;
}
/* All texels of all faces, whenever there was a change. */
static slv_result changed(void *user, uint64_t since, slv_visit_rect visit, void *visitor) {
    slv_result result = SLV_OK;
    for (uint32_t face = 0; since < version(user) && face < FACES && !result; face++)
        result = visit(visitor, face, (slv_rect){0, 0, 1 << LOG2, 1 << LOG2});
    return result;
}

/* Without `close`: the checkers are the caller's own. */
static const slv_source_fns checkers_fns = {.describe = describe,
                                            .face = find_face,
                                            .read = read_rect,
                                            .version = version,
                                            .changed = changed};

#ifndef EXAMPLE_WITHOUT_MAIN /* the library's tests look at this source too */
int main(void) {
    checkers c = {.time = 1};
    slv_source source = {&checkers_fns, &c};
    slv_filter_params params = {.filter = SLV_FILTER_GAUSSIAN};
    slv_cache *cache = NULL;
    slv_sampler *sampler = NULL;
    slv_file_id id = 0;
    float out[3];
    slv_result result = slv_cache_create(NULL, NULL, &cache);
    if (!result && !(result = slv_cache_open_source(cache, &source, NULL, &id)))
        result = slv_sampler_create(cache, &params, &sampler);
    for (int turn = 0; turn < 2 && !result; turn++, c.time++) {
        slv_lookup lookup = {.file = id, .face = 5, .u = 0.5f, .v = 0.5f, .uw1 = 0.1f, .vw2 = 0.1f};
        result = slv_cache_refresh(cache, id); /* the source was changed: look again */
        if (!result && !(result = slv_sample(sampler, &lookup, out)))
            printf("%.3f %.3f %.3f\n", (double)out[0], (double)out[1], (double)out[2]);
    }
    slv_sampler_destroy(sampler);
    slv_cache_destroy(cache); /* which closes the source */
    return result != SLV_OK;
}
#endif
