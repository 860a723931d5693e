/* Segments by what is seen of each face: its points are tried against the straight pieces between
 * fewer of them, in pixels of the picture. */
#include "mesh/rates.h"
#include "mesh/surface/surface_positions.h"

#include "base/memory.h"
#include "base/parallel.h"

#include <string.h>

enum {
    MOST = 256,     /* segments of a face */
    SAMPLES = 16,   /* segments on which a face is tried whose displacement is no finer */
    LOOK = 8,       /* and on which it is first seen whether it is in the picture */
    ROOM = 6 << 20, /* vertices in all */
    GRAIN = 16
};

typedef struct rates {
    const slvi_grid_job *job;
    const float *m; /* world to camera */
    bool perspective;
    float window[4], per_unit[2]; /* pixels of a length 1 at distance 1, or anywhere */
    float nearest;
    float pixels, turn; /* how far points and normals may be off */
} rates;

/* A face under trial: points in the eye's frame. */
typedef struct trial {
    const rates *r;
    uint32_t n;
    const float *eye, *normals;
} trial;

static void to_eye(const rates *r, const float p[3], float out[3]) {
    for (int k = 0; k < 3; k++)
        out[k] =
            r->m[4 * k] * p[0] + r->m[4 * k + 1] * p[1] + r->m[4 * k + 2] * p[2] + r->m[4 * k + 3];
}

static void to_pixels(const rates *r, const float eye[3], float out[2]) {
    float depth = r->perspective ? fmaxf(-eye[2], r->nearest) : 1;
    for (int k = 0; k < 2; k++)
        out[k] = eye[k] / depth * r->per_unit[k];
}

/* How many pixels a face's longest side would be long if it were seen face on, from where it is
 * nearest; from 1 to MOST. */
static float length_in_pixels(const rates *r, const float corners[12]) {
    float eye[4][3], middle = 0, reach = 0, longest = 0;
    for (int c = 0; c < 4; c++) {
        to_eye(r, corners + 3 * c, eye[c]);
        middle -= eye[c][2] / 4;
    }
    for (int c = 0; c < 4; c++) {
        const float *a = eye[c], *b = eye[(c + 1) % 4];
        float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
        longest = fmaxf(longest, sqrtf(x * x + y * y + z * z));
        reach = fmaxf(reach, middle + a[2]);
    }
    float depth = r->perspective ? fmaxf(middle - 2 * reach, r->nearest) : 1;
    float length = longest / depth * fmaxf(r->per_unit[0], r->per_unit[1]);
    return length > 1 ? fminf(length, MOST) : 1;
}

/* How many pixels the longest way across the points is, likewise: a face that is moved may be many
 * times as long as it was. */
static float stretched_length(const trial *t) {
    const rates *r = t->r;
    float longest = 0, depth = 1;
    for (uint32_t i = 0; r->perspective && i < (t->n + 1) * (t->n + 1); i++) {
        float here = fmaxf(-t->eye[3 * (size_t)i + 2], r->nearest);
        depth = i && depth < here ? depth : here;
    }
    for (uint32_t line = 0; line < 2 * (t->n + 1); line++) {
        size_t step = line & 1 ? t->n + 1 : 1, at = line / 2 * (line & 1 ? 1 : t->n + 1);
        float length = 0;
        for (uint32_t k = 0; k < t->n; k++, at += step) {
            const float *a = t->eye + 3 * at, *b = a + 3 * step;
            float x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2];
            length += sqrtf(x * x + y * y + z * z);
        }
        longest = fmaxf(longest, length);
    }
    return fminf(longest / depth * fmaxf(r->per_unit[0], r->per_unit[1]), MOST);
}

/* Whether all points, and what is half as far again around them, are on one side beyond the
 * picture or behind the eye. */
static bool is_outside(const trial *t) {
    const rates *r = t->r;
    float low[5], high[5];
    for (int side = 0; side < 5; side++) {
        low[side] = INFINITY;
        high[side] = -INFINITY;
    }
    for (uint32_t i = 0; i < (t->n + 1) * (t->n + 1); i++) {
        const float *p = t->eye + 3 * (size_t)i;
        float depth = r->perspective ? -p[2] : 1;
        const float beyond[5] = {r->window[0] * depth - p[0], p[0] - r->window[1] * depth,
                                 r->window[2] * depth - p[1], p[1] - r->window[3] * depth,
                                 r->perspective ? r->nearest - depth : -INFINITY};
        for (int side = 0; side < 5; side++) {
            low[side] = fminf(low[side], beyond[side]);
            high[side] = fmaxf(high[side], beyond[side]);
        }
    }
    for (int side = 0; side < 5; side++)
        if (low[side] > 0.5f * (high[side] - low[side]))
            return true;
    return false;
}

/* Between three of a cell's corners, as triangles are drawn. */
static void between(const float *points, size_t a, size_t n, size_t step, float x, float y,
                    float out[3]) {
    size_t row = step * (n + 1), d = a + row + step, side = x >= y ? a + step : a + row;
    for (size_t c = 0; c < 3; c++) {
        float from = points[3 * a + c], corner = points[3 * side + c], to = points[3 * d + c];
        out[c] = x >= y ? from + x * (corner - from) + y * (to - corner)
                        : from + y * (corner - from) + x * (to - corner);
    }
}

/* How much too far off the worst point is with every `step`th vertex: 1 is just allowed. Stops
 * where it is more than `enough`. */
static float excess(const trial *t, uint32_t step, float enough) {
    const rates *r = t->r;
    size_t n = t->n;
    float worst = 0;
    for (uint32_t y = 0; y <= n && worst <= enough; y++)
        for (uint32_t x = 0; x <= n; x++) {
            uint32_t x0 = x / step * step, y0 = y / step * step;
            size_t at = y * (n + 1) + x;
            float p[3], q[3], here[2], there[2], normal[3], turned = 0;
            if (x % step == 0 && y % step == 0)
                continue;
            x0 = x0 == n ? x0 - step : x0;
            y0 = y0 == n ? y0 - step : y0;
            float fx = (float)(x - x0) / (float)step, fy = (float)(y - y0) / (float)step;
            between(t->eye, y0 * (n + 1) + x0, n, step, fx, fy, p);
            to_pixels(r, p, here);
            to_pixels(r, t->eye + 3 * at, there);
            worst = fmaxf(worst, hypotf(here[0] - there[0], here[1] - there[1]) / r->pixels);
            between(t->normals, y0 * (n + 1) + x0, n, step, fx, fy, q);
            if (!slvi_normalise(q, normal))
                continue;
            for (size_t c = 0; c < 3; c++)
                turned +=
                    (normal[c] - t->normals[3 * at + c]) * (normal[c] - t->normals[3 * at + c]);
            worst = fmaxf(worst, sqrtf(turned) / r->turn);
        }
    return worst;
}

/* The fewest segments that do. Past what was tried, each doubling is taken to leave a quarter. */
static uint32_t fewest(const trial *t, uint32_t most) {
    float left = 0;
    uint32_t n = 1;
    for (; n < t->n; n *= 2) {
        bool last = 2 * n == t->n;
        left = excess(t, t->n / n, last && most > t->n ? INFINITY : 1);
        if (left <= 1)
            return n;
    }
    for (left /= 4; n < most && left > 1; n *= 2)
        left /= 4;
    return n;
}

/* Room for a grid, which most faces need little of. */
typedef struct trial_room {
    slvi_face_grid grid;
    uint32_t n;
} trial_room;

static slv_result see(const rates *r, uint32_t face, uint32_t n, trial_room *room, trial *out) {
    const slvi_grid_job *job = r->job;
    slvi_face_grid *grid = &room->grid;
    slv_result result = SLV_OK;
    if (n > room->n) {
        slvi_face_grid_free(grid);
        room->n = n;
        result = slvi_face_grid_make(&job->env, (uint64_t)(n + 1) * (n + 1),
                                     job->displacement != NULL, grid);
    }
    if (result || (result = slvi_face_grid_evaluate(job, face, n, grid)))
        return result;
    for (size_t i = 0; i < (size_t)(n + 1) * (n + 1) && !result; i++) {
        float p[3];
        memcpy(p, grid->limit.positions + 3 * i, sizeof p);
        for (size_t c = 0; c < 3 && job->displacement; c++)
            p[c] += grid->offsets[3 * i + c];
        to_eye(r, p, grid->limit.positions + 3 * i);
    }
    *out = (trial){r, n, grid->limit.positions,
                   job->displacement ? grid->facing : grid->limit.normals};
    return result;
}

static uint32_t power_above(float x) {
    uint32_t n = 1;
    while ((float)n < x)
        n *= 2;
    return n;
}

static uint32_t least(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

static slv_result choose(const rates *r, uint32_t face, trial_room *room, uint16_t *out) {
    const slvi_grid_job *job = r->job;
    const slv_displacement *d = job->displacement;
    float corners[12], length;
    trial t;
    slv_result result = SLV_OK;
    slvi_surface_corners(job->surface, (int32_t)face, corners);
    length = length_in_pixels(r, corners);
    job->spacing[face] = 1 / length;
    *out = 1;
    if (d) {
        if ((result = see(r, face, length > 2 ? LOOK / 2 : 1, room, &t)))
            return result;
        length = fmaxf(length, stretched_length(&t));
        job->spacing[face] = 1 / length;
    }
    uint32_t most = power_above(length / 2);
    uint32_t detail = d && d->detail
                          ? 2 * power_above((float)least(d->detail(d->user, (int32_t)face), MOST))
                      : d ? MOST
                          : 0;
    uint32_t tried = least(most, detail > SAMPLES ? detail : SAMPLES);
    if (most == 1)
        return SLV_OK;
    if (tried > LOOK && ((result = see(r, face, LOOK, room, &t)) || is_outside(&t)))
        return result;
    if (!(result = see(r, face, tried, room, &t)) && !is_outside(&t))
        *out = (uint16_t)fewest(&t, most);
    return result;
}

static slv_result choose_faces(void *user, uint64_t begin, uint64_t end) {
    const rates *r = user;
    const slvi_grid_job *job = r->job;
    trial_room room = {.n = 0};
    slv_result result = SLV_OK;
    for (uint64_t face = begin; face < end && !result; face++)
        if (job->out->segments[face])
            result = choose(r, (uint32_t)face, &room, &job->out->segments[face]);
    slvi_face_grid_free(&room.grid);
    return result;
}

/* Halves the finest until there is room for all, and gives a whole quad beside sub-faces the vertex
 * in the middle of its edge. */
static void fit(const slvi_grid_job *job) {
    slv_tessellation *t = job->out;
    uint64_t count = UINT64_MAX;
    for (uint32_t most = MOST; most >= 1 && count > ROOM; most /= 2) {
        count = 0;
        for (uint32_t f = 0; f < t->nfaces; f++) {
            uint32_t n = t->segments[f] = (uint16_t)least(t->segments[f], most);
            count += n ? (uint64_t)(n + 1) * (n + 1) : 0;
        }
    }
    for (uint32_t f = 0; f < t->nfaces; f++)
        for (unsigned e = 0; e < 4 && t->segments[f] == 1; e++) {
            slv_neighbour other[2];
            uint32_t beside = slv_adjacency_neighbours(job->adjacency, (int32_t)f, e, other);
            if (beside && other->scale > 1)
                t->segments[f] = 2;
        }
}

slv_result slvi_choose_rates(const slv_env *env, slvi_grid_job *job,
                             const slv_tessellation_params *params) {
    const slv_camera *camera = params->camera;
    float low[3], high[3], farthest;
    rates r = {.job = job,
               .m = camera->world_to_camera,
               .perspective = camera->perspective,
               .pixels = params->pixels > 0 ? params->pixels : SLV_TESSELLATION_PIXELS,
               .turn = job->displacement ? SLV_TESSELLATION_TURN_MOVED : SLV_TESSELLATION_TURN};
    slvi_surface_bounds(job->surface, low, high);
    memcpy(r.window, camera->window, sizeof r.window);
    r.per_unit[0] = (float)params->width / (r.window[1] - r.window[0]);
    r.per_unit[1] = (float)params->height / (r.window[3] - r.window[2]);
    slv_camera_depths(camera, low, high, &r.nearest, &farthest);
    slv_result result = slvi_parallel_for(env, job->out->nfaces, GRAIN, choose_faces, &r);
    if (!result)
        fit(job);
    return result;
}
