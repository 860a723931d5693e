/* What every source must do, whatever its texels are. A source that cannot do all of it is no
 * source. */
#ifndef SLV_SOURCE_SUITE_H
#define SLV_SOURCE_SUITE_H

#include "kit/filter_kit.h"

#include <selvage/half.h>
#include <selvage/ptx_writer.h>

#include <pthread.h>
#include <stdatomic.h>

/* Error lines of suite_env. */
static _Atomic(int) suite_lines;

static inline void suite_log(void *user, slv_log_level level, const char *message) {
    (void)user;
    if (level == SLV_LOG_ERROR) {
        atomic_fetch_add(&suite_lines, 1);
        test_log(NULL, level, message);
    }
}

static inline slv_env suite_env(void) {
    return (slv_env){.log = suite_log};
}

/* One to be tried. It must have been made with suite_env. */
typedef struct suite_subject {
    slv_source source;
    /* the file that it is made of; NULL: reductions are those of its own texels */
    const slv_ptx *stored;
    /* changes some texels and says which; NULL if it never changes */
    void (*change)(void *user, uint64_t *random, uint32_t *face, slv_rect *rect);
    void *user;
    /* filled by suite_describes */
    slv_source_desc desc;
    size_t texel_size;
} suite_subject;

static inline slv_rect suite_whole(slv_res res) {
    return (slv_rect){0, 0, 1u << res.u, 1u << res.v};
}

static inline size_t suite_count(slv_res res) {
    return (size_t)1 << (res.u + res.v);
}

static inline slv_source_face suite_face(const suite_subject *s, uint32_t face) {
    slv_source_face out = {0};
    CHECK(s->source.fns->face(s->source.user, face, &out) == SLV_OK);
    return out;
}

/* For free(). */
static inline unsigned char *suite_read(const suite_subject *s, uint32_t face, slv_res res,
                                        slv_rect rect) {
    unsigned char *out = malloc((size_t)rect.width * rect.height * s->texel_size);
    REQUIRE(out);
    slv_result result = s->source.fns->read(s->source.user, face, res, rect, out);
    CHECK_MSG(result == SLV_OK, "%s: face %u at 2^%d x 2^%d: %s", s->desc.name, face, res.u, res.v,
              test_last_log);
    return out;
}

static inline void suite_describes(suite_subject *s) {
    slv_source_desc again = {0};
    REQUIRE(s->source.fns->describe(s->source.user, &s->desc) == SLV_OK);
    CHECK(s->source.fns->describe(s->source.user, &again) == SLV_OK);
    s->texel_size = slv_type_size(s->desc.type) * s->desc.nchannels;
    REQUIRE(s->desc.name && s->desc.name[0] && s->texel_size && s->desc.nfaces <= INT32_MAX);
    CHECK(again.name && strcmp(s->desc.name, again.name) == 0 && again.nfaces == s->desc.nfaces &&
          again.type == s->desc.type && again.nchannels == s->desc.nchannels);
    CHECK(s->desc.alpha_channel == SLV_NO_ALPHA ||
          (s->desc.alpha_channel >= 0 && (uint32_t)s->desc.alpha_channel < s->desc.nchannels));
    CHECK((unsigned)s->desc.border_u <= SLV_BORDER_PERIODIC &&
          (unsigned)s->desc.border_v <= SLV_BORDER_PERIODIC &&
          (unsigned)s->desc.edge_filter <= SLV_EDGE_FILTER_TANVEC);
    for (uint32_t i = 0; i < s->desc.nfaces; i++) {
        slv_source_face f = suite_face(s, i);
        CHECK(f.res.u >= 0 && f.res.v >= 0 && f.res.u <= SLV_MAX_LOG2_RES &&
              f.res.v <= SLV_MAX_LOG2_RES && (!s->desc.triangles || f.res.u == f.res.v));
        for (int e = 0; e < (s->desc.triangles ? 3 : 4); e++)
            CHECK(f.adjacency.face[e] == SLV_BOUNDARY ||
                  (f.adjacency.face[e] >= 0 && (uint32_t)f.adjacency.face[e] < s->desc.nfaces &&
                   f.adjacency.edge[e] < 4));
        if (!(f.flags & SLV_FACE_CONSTANT))
            continue;
        unsigned char *texels = suite_read(s, i, f.res, suite_whole(f.res));
        CHECK(memcmp(texels, texels + s->texel_size, (suite_count(f.res) - 1) * s->texel_size) ==
              0);
        free(texels);
    }
}

static inline float suite_get(slv_type type, const void *values, size_t i) {
    return type == SLV_TYPE_U8     ? (float)((const uint8_t *)values)[i]
           : type == SLV_TYPE_U16  ? (float)((const uint16_t *)values)[i]
           : type == SLV_TYPE_HALF ? slv_half_to_float(((const uint16_t *)values)[i])
                                   : ((const float *)values)[i];
}

static inline void suite_put(slv_type type, void *values, size_t i, float value) {
    if (type == SLV_TYPE_U8)
        ((uint8_t *)values)[i] = (uint8_t)value;
    else if (type == SLV_TYPE_U16)
        ((uint16_t *)values)[i] = (uint16_t)value;
    else if (type == SLV_TYPE_HALF)
        ((uint16_t *)values)[i] = slv_half_from_float(value);
    else
        ((float *)values)[i] = value;
}

/* Means of pairs along an axis, in place; integers are rounded down. */
static inline void suite_halve(const suite_subject *s, bool along_u, slv_res *res, void *texels) {
    size_t n = s->desc.nchannels, width = (size_t)1 << res->u, count = suite_count(*res) / 2;
    res->u -= along_u;
    res->v -= !along_u;
    size_t to_width = (size_t)1 << res->u;
    for (size_t i = 0; i < count; i++)
        for (size_t c = 0; c < n; c++) {
            size_t x = i % to_width, y = i / to_width;
            size_t a = along_u ? y * width + 2 * x : 2 * y * width + x;
            size_t b = along_u ? a + 1 : a + width;
            float mean = 0.5f * (suite_get(s->desc.type, texels, a * n + c) +
                                 suite_get(s->desc.type, texels, b * n + c));
            suite_put(s->desc.type, texels, i * n + c, mean);
        }
}

/* The resolution one step finer than another, as the format has it. */
static inline slv_res suite_finer(const suite_subject *s, slv_res full, slv_res res) {
    int du = full.u - res.u, dv = full.v - res.v;
    bool along_u = du > dv || (du == dv && (res.u & 1));
    if (s->desc.triangles)
        return (slv_res){(int8_t)(res.u + 1), (int8_t)(res.v + 1)};
    return (slv_res){(int8_t)(res.u + along_u), (int8_t)(res.v + !along_u)};
}

/* All texels of a face at a resolution as a .ptx file of them would have them: for free(). */
static inline unsigned char *suite_reduction(const suite_subject *s, uint32_t index, slv_res res) {
    const slv_source_desc *d = &s->desc;
    slv_ptx_mesh_type mesh = d->triangles ? SLV_PTX_TRIANGLE : SLV_PTX_QUAD;
    slv_source_face f = suite_face(s, index);
    unsigned char *texels = suite_read(s, index, f.res, suite_whole(f.res));
    unsigned char *other = malloc(suite_count(f.res) * s->texel_size);
    REQUIRE(other);
    int least = f.res.u < f.res.v ? f.res.u : f.res.v, level = 0;
    bool average = res.u + res.v == 0 && !(f.flags & SLV_FACE_CONSTANT);
    bool constant = (f.flags & SLV_FACE_CONSTANT) != 0;
    slv_res way[40] = {res};
    int steps = 0;
    if (average)
        level = least > 2 ? least - 2 : 0;
    for (; !average && !constant; steps++) {
        int du = f.res.u - way[steps].u, dv = f.res.v - way[steps].v;
        if (du == dv && (du == 0 || least - du >= 2)) {
            level = du;
            break;
        }
        way[steps + 1] = suite_finer(s, f.res, way[steps]);
    }
    slv_res at = f.res;
    if (level || average)
        slv_ptx_premultiply(d->type, d->nchannels, d->alpha_channel, texels, suite_count(at));
    for (; level > 0; level--) {
        slv_ptx_reduce(mesh, d->type, d->nchannels, at, texels, other);
        unsigned char *swap = texels;
        texels = other;
        other = swap;
        at = (slv_res){(int8_t)(at.u - 1), (int8_t)(at.v - 1)};
    }
    for (; steps > 0; steps--) {
        if (d->triangles) {
            slv_ptx_reduce(mesh, d->type, d->nchannels, at, texels, other);
            memcpy(texels, other, suite_count(way[steps - 1]) * s->texel_size);
            at = way[steps - 1];
        } else
            suite_halve(s, way[steps].u > way[steps - 1].u, &at, texels);
    }
    if (average) {
        slv_ptx_average(d->type, d->nchannels, texels, suite_count(at), other);
        slv_ptx_unmultiply(d->type, d->nchannels, d->alpha_channel, other, 1);
        memcpy(texels, other, s->texel_size);
    }
    free(other);
    return texels;
}

static inline void suite_reductions(const suite_subject *s) {
    for (uint32_t i = 0; i < s->desc.nfaces; i++) {
        slv_source_face f = suite_face(s, i);
        slv_res res;
        for (res.u = 0; res.u <= f.res.u; res.u++)
            for (res.v = 0; res.v <= f.res.v; res.v++) {
                if (s->desc.triangles && res.u != res.v)
                    continue;
                size_t bytes = suite_count(res) * s->texel_size;
                unsigned char *is = suite_read(s, i, res, suite_whole(res)), *should = NULL;
                if (s->stored) {
                    REQUIRE((should = malloc(bytes)));
                    CHECK(slv_ptx_read_face(s->stored, i, res, should) == SLV_OK);
                } else
                    should = suite_reduction(s, i, res);
                CHECK_MSG(memcmp(is, should, bytes) == 0, "%s: face %u of 2^%d x 2^%d at %d x %d",
                          s->desc.name, i, f.res.u, f.res.v, res.u, res.v);
                free(is);
                free(should);
            }
    }
}

static inline slv_res suite_any_res(const suite_subject *s, slv_res full, uint64_t *random) {
    slv_res res = {(int8_t)(test_random(random) % (uint32_t)(full.u + 1)),
                   (int8_t)(test_random(random) % (uint32_t)(full.v + 1))};
    if (test_random(random) % 4 == 0)
        res = full;
    if (s->desc.triangles)
        res.v = res.u;
    return res;
}

static inline slv_rect suite_any_rect(slv_res res, uint64_t *random) {
    slv_rect rect = {test_random(random) % (1u << res.u), test_random(random) % (1u << res.v), 0,
                     0};
    rect.width = 1 + test_random(random) % ((1u << res.u) - rect.x);
    rect.height = 1 + test_random(random) % ((1u << res.v) - rect.y);
    return rect;
}

/* How many of `count` rectangles, of any faces, are not what is found there in all of it. */
static inline int suite_wrong_rectangles(const suite_subject *s, int count, uint64_t *random) {
    int wrong = 0;
    for (int n = 0; n < count; n++) {
        uint32_t face = test_random(random) % s->desc.nfaces;
        slv_source_face f = {0};
        wrong += s->source.fns->face(s->source.user, face, &f) != SLV_OK;
        slv_res res = suite_any_res(s, f.res, random);
        slv_rect rect = suite_any_rect(res, random), all = suite_whole(res);
        size_t size = s->texel_size;
        unsigned char *whole = malloc((size_t)all.width * all.height * size);
        unsigned char *part = malloc((size_t)rect.width * rect.height * size);
        if (!whole || !part || s->source.fns->read(s->source.user, face, res, all, whole) ||
            s->source.fns->read(s->source.user, face, res, rect, part))
            wrong++;
        else
            for (uint32_t y = 0; y < rect.height; y++)
                wrong += memcmp(part + (size_t)y * rect.width * size,
                                whole + ((size_t)(rect.y + y) * all.width + rect.x) * size,
                                rect.width * size) != 0;
        free(whole);
        free(part);
    }
    return wrong;
}

typedef struct suite_thread {
    const suite_subject *subject;
    uint64_t random;
    int wrong;
} suite_thread;

static inline void *suite_read_many(void *user) {
    suite_thread *thread = user;
    thread->wrong = suite_wrong_rectangles(thread->subject, 40, &thread->random);
    return NULL;
}

static inline void suite_rectangles(const suite_subject *s) {
    suite_thread threads[4];
    pthread_t handles[4];
    uint64_t random = 5;
    if (!s->desc.nfaces)
        return;
    CHECK(suite_wrong_rectangles(s, 100, &random) == 0);
    for (int i = 0; i < 4; i++) {
        threads[i] = (suite_thread){s, (uint64_t)i / 2, 0};
        REQUIRE(pthread_create(&handles[i], NULL, suite_read_many, &threads[i]) == 0);
    }
    for (int i = 0; i < 4; i++) {
        pthread_join(handles[i], NULL);
        CHECK_MSG(threads[i].wrong == 0, "%s: %d wrong rows on a thread", s->desc.name,
                  threads[i].wrong);
    }
}

static inline void suite_refuses(const suite_subject *s, uint32_t face, slv_res res,
                                 slv_rect rect) {
    unsigned char room[64] = {0};
    atomic_store(&suite_lines, 0);
    slv_result result = s->source.fns->read(s->source.user, face, res, rect, room);
    CHECK_MSG(result == SLV_ERROR_ARGUMENT && atomic_load(&suite_lines) == 1,
              "%s: face %u, 2^%d x 2^%d, %u x %u at (%u, %u): %s, %d lines", s->desc.name, face,
              res.u, res.v, rect.width, rect.height, rect.x, rect.y, slv_result_string(result),
              atomic_load(&suite_lines));
}

static inline void suite_arguments(const suite_subject *s) {
    uint32_t strange[] = {s->desc.nfaces, s->desc.nfaces + 1, (uint32_t)INT32_MAX + 1, UINT32_MAX};
    const slv_rect one = {0, 0, 1, 1};
    for (int i = 0; i < 4; i++) {
        slv_source_face f;
        atomic_store(&suite_lines, 0);
        CHECK(s->source.fns->face(s->source.user, strange[i], &f) == SLV_ERROR_ARGUMENT);
        CHECK(atomic_load(&suite_lines) == 1);
        suite_refuses(s, strange[i], (slv_res){0, 0}, one);
    }
    for (uint32_t i = 0; i < s->desc.nfaces && i < 5; i++) {
        slv_res full = suite_face(s, i).res;
        uint32_t width = 1u << full.u, height = 1u << full.v;
        suite_refuses(s, i, (slv_res){(int8_t)(full.u + 1), full.v}, one);
        suite_refuses(s, i, (slv_res){full.u, (int8_t)(full.v + 1)}, one);
        suite_refuses(s, i, (slv_res){-1, 0}, one);
        suite_refuses(s, i, (slv_res){0, -1}, one);
        suite_refuses(s, i, (slv_res){127, 127}, one);
        if (s->desc.triangles && full.u)
            suite_refuses(s, i, (slv_res){full.u, (int8_t)(full.u - 1)}, one);
        suite_refuses(s, i, full, (slv_rect){0, 0, 0, 1});
        suite_refuses(s, i, full, (slv_rect){0, 0, 1, 0});
        suite_refuses(s, i, full, (slv_rect){width, 0, 1, 1});
        suite_refuses(s, i, full, (slv_rect){0, height, 1, 1});
        suite_refuses(s, i, full, (slv_rect){0, 0, width + 1, 1});
        suite_refuses(s, i, full, (slv_rect){width - 1, height - 1, 1, 2});
        suite_refuses(s, i, full, (slv_rect){1, 1, UINT32_MAX, UINT32_MAX});
        suite_refuses(s, i, full, (slv_rect){UINT32_MAX, 0, 2, 1});
    }
}

/* What a visit told: for each face a rectangle around all of it. */
typedef struct suite_told {
    const suite_subject *subject;
    uint32_t visits, odd;
    slv_rect *rects; /* nfaces; none has a width of 0 */
} suite_told;

static inline slv_result suite_tell(void *user, uint32_t face, slv_rect rect) {
    suite_told *told = user;
    told->visits++;
    if (face >= told->subject->desc.nfaces) {
        told->odd++;
        return SLV_OK;
    }
    slv_rect all = suite_whole(suite_face(told->subject, face).res), *to = &told->rects[face];
    told->odd += !rect.width || !rect.height || rect.x + rect.width > all.width ||
                 rect.y + rect.height > all.height;
    if (!to->width) {
        *to = rect;
        return SLV_OK;
    }
    uint32_t x = rect.x < to->x ? rect.x : to->x, y = rect.y < to->y ? rect.y : to->y;
    uint32_t end_x = rect.x + rect.width, end_y = rect.y + rect.height;
    end_x = end_x > to->x + to->width ? end_x : to->x + to->width;
    end_y = end_y > to->y + to->height ? end_y : to->y + to->height;
    *to = (slv_rect){x, y, end_x - x, end_y - y};
    return SLV_OK;
}

static inline slv_result suite_stop(void *user, uint32_t face, slv_rect rect) {
    (void)face;
    (void)rect;
    ++*(int *)user;
    return SLV_ERROR_CANCELLED;
}

/* What was changed since a version; rects are for free(). */
static inline suite_told suite_changed(const suite_subject *s, uint64_t since) {
    suite_told told = {s, 0, 0, calloc((size_t)s->desc.nfaces + 1, sizeof *told.rects)};
    REQUIRE(told.rects);
    CHECK(slv_source_changed(&s->source, since, suite_tell, &told) == SLV_OK);
    CHECK_MSG(told.odd == 0, "%s: %u of %u changed rectangles make no sense", s->desc.name,
              told.odd, told.visits);
    return told;
}

/* Texels that are not what they were, though nothing said so; and flags. */
static inline void suite_compare(const suite_subject *s, const suite_told *told,
                                 unsigned char **before, const slv_source_face *faces) {
    for (uint32_t i = 0; i < s->desc.nfaces; i++) {
        slv_res res = faces[i].res;
        slv_rect all = suite_whole(res), r = told->rects[i];
        unsigned char *now = suite_read(s, i, res, all);
        for (uint32_t y = 0; y < all.height; y++)
            for (uint32_t x = 0; x < all.width; x++) {
                size_t at = ((size_t)y * all.width + x) * s->texel_size;
                bool inside = x - r.x < r.width && y - r.y < r.height;
                if (!inside && memcmp(now + at, before[i] + at, s->texel_size) != 0)
                    CHECK_MSG(false, "%s: face %u at (%u, %u) was changed untold", s->desc.name, i,
                              x, y);
            }
        slv_source_face f = suite_face(s, i);
        CHECK(f.res.u == res.u && f.res.v == res.v);
        CHECK(memcmp(f.adjacency.face, faces[i].adjacency.face, sizeof f.adjacency.face) == 0);
        CHECK_MSG(f.flags == faces[i].flags || r.width, "%s: flags of face %u were changed untold",
                  s->desc.name, i);
        free(now);
    }
}

static inline void suite_changes(const suite_subject *s) {
    uint32_t nfaces = s->desc.nfaces, all = 0;
    uint64_t random = 9, first = slv_source_version(&s->source);
    int stops = 0;
    unsigned char **before = calloc((size_t)nfaces + 1, sizeof *before);
    slv_source_face *faces = calloc((size_t)nfaces + 1, sizeof *faces);
    REQUIRE(before && faces);
    CHECK(first > 0);
    suite_told told = suite_changed(s, first);
    CHECK_MSG(told.visits == 0, "%s: %u changes since now", s->desc.name, told.visits);
    free(told.rects);
    told = suite_changed(s, 0);
    for (uint32_t i = 0; i < nfaces; i++) {
        slv_rect whole = suite_whole(suite_face(s, i).res);
        all += told.rects[i].width == whole.width && told.rects[i].height == whole.height;
    }
    CHECK_MSG(all == nfaces, "%s: since 0 only %u of %u faces are told", s->desc.name, all, nfaces);
    free(told.rects);
    CHECK(slv_source_changed(&s->source, 0, suite_stop, &stops) ==
              (nfaces ? SLV_ERROR_CANCELLED : SLV_OK) &&
          stops == (nfaces != 0));
    for (int turn = 0; s->change && nfaces && turn < 40; turn++) {
        uint64_t since = slv_source_version(&s->source);
        int count = turn == 39 ? 1000 : 1 + turn % 3;
        for (uint32_t i = 0; i < nfaces; i++) {
            faces[i] = suite_face(s, i);
            before[i] = suite_read(s, i, faces[i].res, suite_whole(faces[i].res));
        }
        for (int i = 0; i < count; i++) {
            uint32_t face;
            slv_rect rect;
            s->change(s->user, &random, &face, &rect);
        }
        CHECK(slv_source_version(&s->source) > since);
        told = suite_changed(s, since);
        CHECK(told.visits > 0);
        suite_compare(s, &told, before, faces);
        free(told.rects);
        told = suite_changed(s, slv_source_version(&s->source));
        CHECK(told.visits == 0);
        free(told.rects);
        for (uint32_t i = 0; i < nfaces; i++)
            free(before[i]);
    }
    free(before);
    free(faces);
}

/* A file of what the source has at full resolution. */
static inline void suite_write(const suite_subject *s, const char *path) {
    const slv_source_desc *d = &s->desc;
    slv_env env = test_env();
    slv_ptx_writer *writer = NULL;
    slv_ptx_writer_params params = {.mesh_type = d->triangles ? SLV_PTX_TRIANGLE : SLV_PTX_QUAD,
                                    .type = d->type,
                                    .nchannels = d->nchannels,
                                    .alpha_channel = d->alpha_channel,
                                    .nfaces = d->nfaces,
                                    .border_u = d->border_u,
                                    .border_v = d->border_v,
                                    .edge_filter = d->edge_filter};
    REQUIRE(slv_ptx_writer_create(&env, path, &params, &writer) == SLV_OK);
    for (uint32_t i = 0; i < d->nfaces; i++) {
        slv_ptx_face f = suite_face(s, i);
        unsigned char *texels = suite_read(s, i, f.res, suite_whole(f.res));
        CHECK(slv_ptx_writer_write_face(writer, i, &f, texels) == SLV_OK);
        free(texels);
    }
    REQUIRE(slv_ptx_writer_finish(writer) == SLV_OK);
    slv_ptx_writer_destroy(writer);
}

/* A source that passes calls on, but is closed by somebody else. */
static inline slv_source suite_lend(const suite_subject *s, slv_source_fns *fns) {
    *fns = *s->source.fns;
    fns->close = NULL;
    return (slv_source){fns, s->source.user};
}

/* Lookups in the source, through a cache, and those in a file with the same content. */
static inline void suite_lookups(const suite_subject *s) {
    enum { MANY = 120 };
    char path[1100];
    uint32_t n = s->desc.nchannels;
    slv_source_fns fns;
    slv_source lent = suite_lend(s, &fns);
    slv_cache *cache = kit_cache(UINT64_C(64) << 20, 0);
    slv_file_id is = 0, should;
    float *values[2] = {calloc(MANY, n * sizeof(float)), calloc(MANY, n * sizeof(float))};
    slv_lookup lookups[2][MANY];
    REQUIRE(values[0] && values[1]);
    snprintf(path, sizeof path, "%s", scratch_path("suite.ptx"));
    if (s->stored)
        should = kit_open(cache, slv_ptx_name(s->stored));
    else {
        suite_write(s, path);
        should = kit_open(cache, path);
    }
    REQUIRE(slv_cache_open_source(cache, &lent, NULL, &is) == SLV_OK);
    for (int p = 0; s->desc.nfaces && p < 3 * SLV_FILTER_COUNT; p++) {
        const slv_filter_params params = {.filter = (slv_filter)(p / 3),
                                          .lerp = p % 3 == 1,
                                          .no_edge_blend = p % 3 == 2,
                                          .sharpness = 0.5f};
        slv_sampler *sampler = kit_sampler(cache, &params);
        uint64_t random = 77;
        for (int i = 0; i < MANY; i++) {
            lookups[0][i] = lookups[1][i] = kit_lookup_any(is, s->desc.nfaces, &random);
            lookups[1][i].file = should;
        }
        for (int way = 0; way < 2; way++)
            CHECK(slv_sample_batch(sampler, lookups[way], MANY, values[way], n, NULL) == SLV_OK);
        CHECK_MSG(memcmp(values[0], values[1], MANY * n * sizeof(float)) == 0,
                  "%s: %s, kind %d: not what a file gives", s->desc.name,
                  slv_filter_name(params.filter), p % 3);
        for (int i = 0; i < MANY; i++) {
            CHECK(slv_sample(sampler, &lookups[0][i], values[0]) == SLV_OK);
            CHECK(memcmp(values[0], values[1] + (size_t)i * n, n * sizeof(float)) == 0);
        }
        slv_sampler_destroy(sampler);
    }
    slv_cache_destroy(cache);
    if (!s->stored)
        unlink(path);
    free(values[0]);
    free(values[1]);
}

/* All of it. */
static inline void suite_run(suite_subject *s) {
    suite_describes(s);
    suite_reductions(s);
    suite_rectangles(s);
    suite_arguments(s);
    suite_lookups(s);
    suite_changes(s);
    suite_reductions(s);
    suite_lookups(s);
}

#endif
