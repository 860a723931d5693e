/* Planes at other resolutions: by the bit what it is when every texel is made by itself, of all
 * kinds of planes, of faces finer and coarser than is wanted along each axis, and across edges. */
#include "kit/paint_kit.h"

#include "layer/document_data.h"
#include "texture/bilinear.h"

/* ---- one texel after the other ---- */

/* A plane as seen at a resolution no finer than that of its faces. */
typedef struct view {
    const slvi_plane *plane;
    const slv_adjacency *adjacency;
    uint32_t face;
    slv_res res; /* that of the face, or that which is wanted where it is coarser */
} view;

static slv_res coarser(slv_res a, slv_res b) {
    return (slv_res){a.u < b.u ? a.u : b.u, a.v < b.v ? a.v : b.v};
}

/* Whether a texel is in a block that nothing was put into, of a plane whose fill is not seen. */
static bool is_clear(const slvi_plane *plane, uint32_t face, uint32_t x, uint32_t y) {
    const slvi_table *table = plane->tables[face];
    slv_res res = plane->res[face];
    if (plane->filled && (plane->alpha < 0 || plane->fill[plane->alpha] != 0))
        return false;
    return !table || !table->blocks[(y >> slvi_block_log2(res.v)) * slvi_blocks_along(res.u) +
                                    (x >> slvi_block_log2(res.u))];
}

/* The mean of the texels of a face that one at `res` covers: colours by their alpha. */
static void mean(const slvi_plane *plane, uint32_t face, slv_res res, uint32_t x, uint32_t y,
                 float *out) {
    int du = plane->res[face].u - res.u, dv = plane->res[face].v - res.v;
    float row[SLVI_BLOCK_SIDE * SLVI_MOST_CHANNELS];
    double sum[SLVI_MOST_CHANNELS] = {0}, weight = 0;
    uint32_t n = plane->nchannels, width = 1u << du, height = 1u << dv;
    uint32_t piece = width < SLVI_BLOCK_SIDE ? width : SLVI_BLOCK_SIDE;
    if (!du && !dv) {
        slvi_plane_read(plane, face, (slv_rect){x, y, 1, 1}, out);
        return;
    }
    for (uint32_t j = 0; j < height; j++)
        for (uint32_t i = 0; i < width; i += piece) {
            if (is_clear(plane, face, (x << du) + i, (y << dv) + j)) {
                weight += plane->alpha < 0 ? piece : 0;
                continue;
            }
            slvi_plane_read(plane, face, (slv_rect){(x << du) + i, (y << dv) + j, piece, 1}, row);
            for (uint32_t k = 0; k < piece; k++) {
                double alpha = plane->alpha >= 0 ? (double)row[k * n + (uint32_t)plane->alpha] : 1;
                for (uint32_t c = 0; c < n; c++)
                    sum[c] += (double)row[k * n + c] * ((int32_t)c == plane->alpha ? 1 : alpha);
                weight += alpha;
            }
        }
    for (uint32_t c = 0; c < n; c++)
        out[c] = (int32_t)c == plane->alpha ? (float)ldexp(sum[c], -du - dv)
                 : weight > 0               ? (float)(sum[c] / weight)
                                            : 0;
}

/* A texel of a view, which may lie a texel outside of the face. */
static void tap(const view *v, int32_t x, int32_t y, float *out) {
    int32_t width = 1 << v->res.u, height = 1 << v->res.v, face = (int32_t)v->face;
    int32_t inside_x = x < 0 ? 0 : x < width ? x : width - 1;
    int32_t inside_y = y < 0 ? 0 : y < height ? y : height - 1;
    float s = ((float)x + 0.5f) / (float)width, t = ((float)y + 0.5f) / (float)height;
    if ((inside_x == x && inside_y == y) || !v->adjacency ||
        !slv_adjacency_resolve(v->adjacency, false, &face, &s, &t)) {
        mean(v->plane, v->face, v->res, (uint32_t)inside_x, (uint32_t)inside_y, out);
        return;
    }
    int8_t most = v->res.u > v->res.v ? v->res.u : v->res.v;
    slv_res res = coarser(v->plane->res[face], (slv_res){most, most});
    float last_x = (float)((1u << res.u) - 1), last_y = (float)((1u << res.v) - 1);
    float px = floorf(s * (float)(1u << res.u)), py = floorf(t * (float)(1u << res.v));
    mean(v->plane, (uint32_t)face, res, (uint32_t)fmaxf(0, fminf(px, last_x)),
         (uint32_t)fmaxf(0, fminf(py, last_y)), out);
}

/* Four texels around a place, colours by their alpha. */
static void between(const view *v, float x, float y, float *out) {
    const slvi_plane *plane = v->plane;
    float left = floorf(x), low = floorf(y), weight = 0, sum[SLVI_MOST_CHANNELS] = {0};
    float texel[SLVI_MOST_CHANNELS];
    for (int k = 0; k < 4; k++) {
        float share = slvi_bilinear_share(x - left, y - low, k);
        if (!(share > 0))
            continue;
        tap(v, (int32_t)left + (k & 1), (int32_t)low + (k >> 1), texel);
        float alpha = plane->alpha >= 0 ? share * texel[plane->alpha] : share;
        for (uint32_t c = 0; c < plane->nchannels; c++)
            sum[c] += texel[c] * ((int32_t)c == plane->alpha ? share : alpha);
        weight += alpha;
    }
    for (uint32_t c = 0; c < plane->nchannels; c++)
        out[c] = (int32_t)c == plane->alpha ? sum[c] : weight > 0 ? sum[c] / weight : 0;
}

static void sample(const slvi_plane *plane, const slv_adjacency *adjacency, uint32_t face,
                   slv_res res, slv_rect rect, float *out) {
    slv_res own = plane->res[face];
    view v = {plane, adjacency, face, coarser(own, res)};
    float step_x = ldexpf(1, v.res.u - res.u), step_y = ldexpf(1, v.res.v - res.v);
    if (own.u == res.u && own.v == res.v) {
        slvi_plane_read(plane, face, rect, out);
        return;
    }
    for (uint32_t y = 0; y < rect.height; y++)
        for (uint32_t x = 0; x < rect.width; x++, out += plane->nchannels)
            between(&v, ((float)(rect.x + x) + 0.5f) * step_x - 0.5f,
                    ((float)(rect.y + y) + 0.5f) * step_y - 0.5f, out);
}

/* ---- and all kinds of planes ---- */

/* The most is met often: only there a texel may cover several blocks. */
static int8_t random_log2(uint64_t *random, uint32_t most) {
    return (int8_t)(test_random(random) % 3 ? test_random(random) % (most + 1) : most);
}

static slv_res random_res(uint64_t *random, uint32_t most) {
    int8_t u = random_log2(random, most);
    return (slv_res){u, random_log2(random, most)};
}

/* Few texels of a block, or all, have something; some of a block's alphas are zero. */
static void put_block(const slvi_plane *plane, uint64_t *random, uint32_t face, uint32_t index) {
    slv_rect rect = slvi_block_rect(plane->res[face], index);
    float texels[SLVI_BLOCK_SIDE * SLVI_BLOCK_SIDE * SLVI_MOST_CHANNELS] = {0};
    uint32_t every = 1 + test_random(random) % 9, n = plane->nchannels;
    MUST(slvi_block_create(plane, plane->res[face], 1, &plane->tables[face]->blocks[index]));
    for (uint32_t i = 0; i < rect.width * rect.height; i++)
        for (uint32_t c = 0; c < n && i % every == 0; c++)
            texels[i * n + c] = (float)(test_random(random) % 1024) / 1023 *
                                (float)((int32_t)c != plane->alpha || test_random(random) % 4);
    slvi_table_write(plane, plane->res[face], plane->tables[face], rect, 1, texels);
}

static slvi_plane *random_plane(const slv_env *env, uint32_t nfaces, uint64_t *random) {
    static const slv_type types[] = {SLV_TYPE_U8, SLV_TYPE_U16, SLV_TYPE_HALF, SLV_TYPE_FLOAT};
    slv_res res[64];
    slv_texture_desc desc = {.nfaces = nfaces, .type = types[test_random(random) % 4], .res = res};
    bool usual = test_random(random) % 2;
    float fill[SLVI_MOST_CHANNELS] = {0.3f, 0.25f, 0.7f, 1, 0.125f, 0.9f, 0.6f, 0.2f};
    slvi_plane *plane = NULL;
    desc.nchannels = usual ? 4 : 1 + test_random(random) % SLVI_MOST_CHANNELS;
    desc.alpha_channel = usual ? 3 : (int32_t)(test_random(random) % (desc.nchannels + 1)) - 1;
    for (uint32_t i = 0; i < nfaces; i++)
        res[i] = random_res(random, i % 3 ? 5 : 7);
    if (desc.alpha_channel >= 0 && test_random(random) % 2)
        fill[desc.alpha_channel] = 0;
    MUST(slvi_plane_create(env, &desc, test_random(random) % 2 ? fill : NULL, &plane));
    for (uint32_t face = 0; face < nfaces; face++) {
        if (test_random(random) % 4 == 0)
            continue;
        MUST(slvi_table_create(plane, res[face], &plane->tables[face]));
        for (uint32_t i = 0; i < plane->tables[face]->count; i++)
            if (test_random(random) % 3)
                put_block(plane, random, face, i);
    }
    return plane;
}

static bool is_seen(const slvi_plane *plane, uint32_t count, const float *texels) {
    bool seen = false;
    for (uint32_t i = 0; i < count * plane->nchannels; i++)
        if (plane->alpha < 0 || i % plane->nchannels == (uint32_t)plane->alpha)
            seen = seen || texels[i] != 0;
    return seen;
}

static void compare(const slvi_plane *plane, const slv_adjacency *adjacency, uint64_t *random) {
    enum { ROOM = SLVI_BLOCK_SIDE * SLVI_BLOCK_SIDE * SLVI_MOST_CHANNELS };
    static const float zeros[ROOM];
    slvi_taps taps = {0};
    slv_res res[64];
    float expected[ROOM], found[ROOM];
    for (uint32_t face = 0; face < plane->nfaces; face++)
        res[face] = random_res(random, test_random(random) % 2 ? 7 : 1);
    for (uint32_t i = 0; i < 8 * plane->nfaces; i++) {
        uint32_t face = test_random(random) % plane->nfaces;
        uint32_t width = 1u << res[face].u, height = 1u << res[face].v;
        slv_rect rect = {test_random(random) % width, test_random(random) % height, 0, 0};
        if (i % 2) { /* as blocks lie */
            rect.x &= ~(uint32_t)(SLVI_BLOCK_SIDE - 1);
            rect.y &= ~(uint32_t)(SLVI_BLOCK_SIDE - 1);
        }
        rect.width = width - rect.x < SLVI_BLOCK_SIDE ? width - rect.x : SLVI_BLOCK_SIDE;
        rect.height = height - rect.y < SLVI_BLOCK_SIDE ? height - rect.y : SLVI_BLOCK_SIDE;
        uint32_t count = rect.width * rect.height;
        size_t bytes = count * plane->nchannels * sizeof(float);
        sample(plane, adjacency, face, res[face], rect, expected);
        bool any = slvi_plane_sample(plane, adjacency, face, res[face], rect, &taps, found);
        if (any ? memcmp(expected, found, bytes)
                : memcmp(zeros, found, bytes) || is_seen(plane, count, expected))
            CHECK_MSG(false, "face %u of 2^%d x 2^%d at 2^%d x 2^%d, %u x %u from %u, %u: %d",
                      (unsigned)face, plane->res[face].u, plane->res[face].v, res[face].u,
                      res[face].v, (unsigned)rect.width, (unsigned)rect.height, (unsigned)rect.x,
                      (unsigned)rect.y, any);
    }
    CHECK(true);
}

int main(void) {
    slv_env env = test_env();
    for (uint32_t i = 0; i < test_effort(150); i++) {
        uint64_t random = 1 + i;
        shape s = i % 3 ? paint_plane(3, 1) : shape_cube();
        paint_scene scene = paint_scene_of(&env, &s, SLV_SCHEME_BILINEAR, 0, SLV_TYPE_U8, 1, -1);
        slvi_plane *plane = random_plane(&env, scene.nfaces, &random);
        const slv_adjacency *adjacency = i % 5 ? slv_paint_surface_adjacency(scene.surface) : NULL;
        compare(plane, adjacency, &random);
        slvi_plane_drop(plane);
        paint_scene_end(&scene);
    }
    return test_end();
}
