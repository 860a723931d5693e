/* Template: the anisotropic filter's ellipse, and sums of texels under it. */
#ifndef SLV_FILTER_ELLIPSE_TEMPLATE_H
#define SLV_FILTER_ELLIPSE_TEMPLATE_H

#include "filter/gather_template.h"
#include "filter/unfold.h"

#define ELLIPSE_REACH 3.25            /* standard deviations */
#define ELLIPSE_REACH_LOG2 7.6192332f /* minus log2 of the gaussian there */
#define ELLIPSE_AT_REACH                                                                           \
    0.0050860692f          /* the gaussian there: subtracted, so that it ends continuously */
#define ELLIPSE_CUT 0.9267 /* how much variance is left of 1 */
#define ELLIPSE_TEXEL 0.7  /* the standard deviation that a texel has, at least */
#define ELLIPSE_STEP 0.7   /* samples are closer than the standard deviation over this */
#define ELLIPSE_MOST_DEVIATION 2.0 /* in units of the plane: a whole face */
#define ELLIPSE_MOST_RATIO 16.0    /* the longer axis to the shorter */
#define ELLIPSE_MOST_LOG2 20       /* of samples in a unit */

/* An ellipse around a place of the plane: a weight is 2^-(xx dx^2 + 2 xy dx dy + yy dy^2). */
typedef struct ellipse {
    float x, y, xx, xy, yy;
    float reach[2]; /* half of its bounding box */
    int log2[2];    /* samples in a unit along each axis */
} ellipse;

/* One lookup under way. */
typedef struct ellipse_job {
    lookup_state *state;
    ellipse e;
    float soft;  /* lines that pass vertices closer than this are taken apart */
    float scale; /* of all weights */
    bool weigh;  /* weights only */
    bool stay;   /* what is around the face is as beyond a border */
    /* few channels, and the sums of them all, in turns */
    bool few;
    v8f sums[2];
    /* the texels looked at last, while the thread stays pinned */
    const uint8_t *texels;
    uint64_t moves;
    uint32_t face, tile;
    int res_u, res_v;
} ellipse_job;

/* What a footprint asks for, as the plane has it. */
typedef struct ellipse_wanted {
    double xx, xy, yy; /* the covariance, with that of texels */
    double across[2];  /* the footprint's deviation along each axis, measured through its middle */
    double mean;       /* the footprint's deviation if it were a circle */
    float texel[2], soft; /* soft: the least deviation, texels included */
} ellipse_wanted;

/* The covariance is the footprint's, not too long nor too thin, and that of a gaussian that texels
 * are thought to have. */
static void ellipse_find_wanted(const slv_sampler *s, const slv_lookup *l, int unit,
                                const float texel[2], ellipse_wanted *out) {
    const float big = 1e4f;
    double x1 = unit * fmaxf(fminf(l->uw1 * s->width, big), -big);
    double y1 = unit * fmaxf(fminf(l->vw1 * s->width, big), -big);
    double x2 = unit * fmaxf(fminf(l->uw2 * s->width, big), -big);
    double y2 = unit * fmaxf(fminf(l->vw2 * s->width, big), -big);
    double blur = fminf(s->blur, big), mx = ELLIPSE_TEXEL * texel[0], my = ELLIPSE_TEXEL * texel[1];
    double xx = 0.25 * (x1 * x1 + x2 * x2) + blur * blur;
    double yy = 0.25 * (y1 * y1 + y2 * y2) + blur * blur;
    double xy = 0.25 * (x1 * y1 + x2 * y2);
    double middle = 0.5 * (xx + yy), half = 0.5 * (xx - yy), root = sqrt(half * half + xy * xy);
    /* the squares of its half axes */
    double most = fmin(middle + root, ELLIPSE_MOST_DEVIATION * ELLIPSE_MOST_DEVIATION);
    double least = fmax(middle - root, most / (ELLIPSE_MOST_RATIO * ELLIPSE_MOST_RATIO));
    least = fmin(least, most);
    double shrink = root > 0 ? fmin(0.5 * (most - least) / root, 1) : 0;
    middle = 0.5 * (most + least);
    xx = middle + shrink * half;
    yy = middle - shrink * half;
    xy *= shrink;
    double det = most * least;
    *out = (ellipse_wanted){.across = {yy > 0 ? sqrt(det / yy) : 0, xx > 0 ? sqrt(det / xx) : 0},
                            .mean = sqrt(middle),
                            .texel = {texel[0], texel[1]}};
    xx += mx * mx;
    yy += my * my;
    middle = 0.5 * (xx + yy), half = 0.5 * (xx - yy), root = sqrt(half * half + xy * xy);
    out->xx = xx, out->xy = xy, out->yy = yy;
    out->soft = (float)sqrt(fmax(middle - root, mx < my ? mx * mx : my * my));
}

/* The lattices of samples along an axis, one or two, and their shares: as fine as the footprint
 * asks for, or as texels are. Where these change from face to face, one lattice gives way to the
 * other.
 */
static int ellipse_find_lattices(const ellipse_wanted *w, int axis, int log2[2], float share[2]) {
    const float blend = 1.25f;
    float step = (float)(w->across[axis] / ELLIPSE_STEP), texel = blend * w->texel[axis];
    int fine = step < 1 ? step > 0 ? num_negative_log2(step) : ELLIPSE_MOST_LOG2 : 0;
    int coarse = texel < 1 ? num_negative_log2(texel) : 0;
    float over = texel * num_power_of_two(coarse);
    fine = fine < ELLIPSE_MOST_LOG2 ? fine : ELLIPSE_MOST_LOG2;
    log2[0] = fine < coarse ? fine : coarse;
    log2[1] = fine < coarse + 1 ? fine : coarse + 1;
    if (log2[0] == log2[1] || over >= blend) {
        share[0] = 1;
        return 1;
    }
    share[0] = (over - 1) / (blend - 1);
    share[1] = 1 - share[0];
    return 2;
}

/* Returns what its weights add up to, but for a factor. */
static float ellipse_find(double x, double y, const ellipse_wanted *w, int log2_x, int log2_y,
                          ellipse *e) {
    const double log2e_half = 0.72134752044448170;
    /* samples are means of squares, which are part of what is wanted */
    double xx = (w->xx - (double)num_power_of_two(-2 * log2_x) / 12) / ELLIPSE_CUT;
    double yy = (w->yy - (double)num_power_of_two(-2 * log2_y) / 12) / ELLIPSE_CUT;
    double xy = w->xy / ELLIPSE_CUT, det = xx * yy - xy * xy;
    e->x = (float)x;
    e->y = (float)y;
    e->xx = (float)(yy / det * log2e_half);
    e->xy = (float)(-xy / det * log2e_half);
    e->yy = (float)(xx / det * log2e_half);
    e->reach[0] = (float)(ELLIPSE_REACH * sqrt(xx));
    e->reach[1] = (float)(ELLIPSE_REACH * sqrt(yy));
    e->log2[0] = log2_x;
    e->log2[1] = log2_y;
    return (float)sqrt(det) * num_power_of_two(log2_x + log2_y);
}

#define ELLIPSE_DEFINE_ADD_FEW(TYPE, T)                                                            \
    static inline void ellipse_add_few_##TYPE(const void *texels, size_t nchannels, int n,         \
                                              const float *weights, v8f *sums) {                   \
        const T *p = texels;                                                                       \
        v8f even = sums[0], odd = sums[1];                                                         \
        int i = 0;                                                                                 \
        for (; i + 1 < n; i += 2, p += 2 * nchannels) {                                            \
            even += v8_load_##TYPE(p) * weights[i];                                                \
            odd += v8_load_##TYPE(p + nchannels) * weights[i + 1];                                 \
        }                                                                                          \
        if (i < n)                                                                                 \
            even += v8_load_##TYPE(p) * weights[i];                                                \
        sums[0] = even;                                                                            \
        sums[1] = odd;                                                                             \
    }

ELLIPSE_DEFINE_ADD_FEW(u8, uint8_t)
ELLIPSE_DEFINE_ADD_FEW(u16, uint16_t)
ELLIPSE_DEFINE_ADD_FEW(half, uint16_t)
ELLIPSE_DEFINE_ADD_FEW(float, float)

/* Texels of few channels, one after the other; vectors may read beyond them. */
static inline void ellipse_add_few(const cache_tables *t, const uint8_t *texels, int n,
                                   const float *weights, v8f *sums) {
    switch (t->type) {
    case SLV_TYPE_U8:
        ellipse_add_few_u8(texels, t->nchannels, n, weights, sums);
        break;
    case SLV_TYPE_U16:
        ellipse_add_few_u16(texels, t->nchannels, n, weights, sums);
        break;
    case SLV_TYPE_HALF:
        ellipse_add_few_half(texels, t->nchannels, n, weights, sums);
        break;
    default:
        ellipse_add_few_float(texels, t->nchannels, n, weights, sums);
    }
}

/* Moves what was summed up of few channels to where sums belong. */
static void ellipse_settle(ellipse_job *j) {
    lookup_state *state = j->state;
    if (!j->few)
        return;
    v8f sum = j->sums[0] + j->sums[1];
    for (uint32_t c = 0; c < state->count; c++)
        state->sum[c] += sum[state->first + c];
    j->sums[0] = j->sums[1] = v8_splat(0);
}

/* Texels of a face, or a tile of them, and NULL if the lookup is over. */
static inline const uint8_t *ellipse_find_texels(ellipse_job *j, uint32_t face, cache_face *f,
                                                 int res_u, int res_v, uint32_t tile, bool whole) {
    lookup_state *state = j->state;
    if (j->texels && j->moves == state->sampler->thread.moves && j->face == face &&
        j->tile == tile && j->res_u == res_u && j->res_v == res_v)
        return j->texels;
    j->texels = whole ? lookup_find_whole(state, face, f, res_u, res_v)
                      : lookup_find_tile(state, face, res_u, res_v, tile);
    j->moves = state->sampler->thread.moves;
    j->face = face;
    j->tile = tile;
    j->res_u = res_u;
    j->res_v = res_v;
    return j->texels;
}

/* Adds a run of texels of one row, at a resolution that the face has, each times its weight. It
 * has nine parameters, since there are too many runs to fill a struct for each. */
static void ellipse_add_run(ellipse_job *j, const cell *c, cache_face *f, int res_u, int res_v,
                            int x, int y, int n, const float *weights) {
    lookup_state *state = j->state;
    const cache_tables *t = state->tables;
    bool whole = res_u + res_v <= t->whole_log2;
    slv_res tile = {(int8_t)res_u, (int8_t)res_v};
    if (!whole)
        tile = slvi_cache_tile_res(t, res_u, res_v);
    while (n > 0) {
        uint32_t index = 0;
        int here = n, from = x;
        if (!whole) {
            index = ((uint32_t)(y >> tile.v) << (res_u - tile.u)) + (uint32_t)(x >> tile.u);
            from = x & ((1 << tile.u) - 1);
            here = (1 << tile.u) - from < n ? (1 << tile.u) - from : n;
        }
        const uint8_t *texels = ellipse_find_texels(j, c->face, f, res_u, res_v, index, whole);
        if (!texels)
            return;
        int row = y & ((1 << tile.v) - 1);
        if (j->few) {
            size_t at = ((size_t)row << tile.u) + (size_t)from;
            ellipse_add_few(t, texels + at * t->pixel_size, here, weights, j->sums);
        } else {
            kernel k;
            k.a[0].start = from;
            k.a[0].n = here;
            memcpy(k.a[0].k, weights, (size_t)here * sizeof *weights);
            k.a[1].start = row;
            k.a[1].n = 1;
            k.a[1].k[0] = 1;
            gather_sum(t, texels, (size_t)1 << tile.u, &k, state->first, state->count, state->sum);
        }
        x += here;
        n -= here;
        weights += here;
    }
}

/* The same, with as many parameters since it takes the place of that, where the first two channels
 * may be a vector in the face's own frame. */
static void ellipse_add_turned_run(ellipse_job *j, const cell *c, cache_face *f, int res_u,
                                   int res_v, int x, int y, int n, const float *weights) {
    lookup_state *state = j->state;
    if (j->few || !state->tables->tanvec || !c->turn || state->count < 2) {
        ellipse_add_run(j, c, f, res_u, res_v, x, y, n, weights);
        return;
    }
    float *sum = state->sum, before[2] = {sum[0], sum[1]};
    sum[0] = sum[1] = 0;
    ellipse_add_run(j, c, f, res_u, res_v, x, y, n, weights);
    slvi_edge_turn_vector((unsigned)c->turn, &sum[0], &sum[1]);
    sum[0] += before[0];
    sum[1] += before[1];
}

/* A place in a cell's own frame. */
static void ellipse_to_local(const cell *c, float x, float y, float *u, float *v) {
    float dx = x - (float)c->x, dy = y - (float)c->y, size = (float)c->size;
    *u = c->turn == 0 ? dx : c->turn == 1 ? dy : c->turn == 2 ? size - dx : size - dy;
    *v = c->turn == 0 ? dy : c->turn == 1 ? size - dx : c->turn == 2 ? size - dy : dx;
}

/* The resolutions of a face that samples are taken from. */
static void ellipse_sample_res(const ellipse *e, const cell *c, const cache_face *f, int *res_u,
                               int *res_v) {
    int more = c->size == 2, turned = c->turn & 1;
    *res_u = e->log2[turned] + more < f->res_u ? e->log2[turned] + more : f->res_u;
    *res_v = e->log2[!turned] + more < f->res_v ? e->log2[!turned] + more : f->res_v;
}

static void ellipse_add_sample(ellipse_job *j, const cell *c, float x, float y, float weight) {
    lookup_state *state = j->state;
    cache_face *f = cache_find_face(state->tables, c->face);
    int res_u, res_v;
    float u, v;
    state->weight += weight;
    ellipse_sample_res(&j->e, c, f, &res_u, &res_v);
    if ((cache_flags(f) & SLV_FACE_CONSTANT) || res_u + res_v == 0) {
        gather_add_average(state, c->face, f, weight);
        return;
    }
    ellipse_to_local(c, x, y, &u, &v);
    int at_u = (int)(u * num_power_of_two(res_u) / (float)c->size);
    int at_v = (int)(v * num_power_of_two(res_v) / (float)c->size);
    at_u = at_u < 0 ? 0 : at_u < 1 << res_u ? at_u : (1 << res_u) - 1;
    at_v = at_v < 0 ? 0 : at_v < 1 << res_v ? at_v : (1 << res_v) - 1;
    ellipse_add_turned_run(j, c, f, res_u, res_v, at_u, at_v, 1, &weight);
}

#endif
