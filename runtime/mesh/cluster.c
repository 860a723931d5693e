/* Vertices drawn together cell by cell (Rossignac and Borrel 1993, "Multi-resolution 3D
 * approximations for rendering complex scenes"): cells are less than a pixel wide and as deep.
 * Vertices at one place stay at one place, so that what was closed stays closed; those that a
 * larger face has, too, stay where they are. */
#include "mesh/cluster.h"

#include "mesh/face_grid.h"

#include "base/memory.h"

#include <string.h>

#define CELL 0.7f /* pixels: no corner of a cell is further than one from another */

enum { FEW = 2048 /* faces, for which it is not worth while */ };

typedef struct cell {
    int32_t key[3];
    uint32_t count; /* of vertices that were added */
    double position[3], normal[3];
} cell;

/* Cells by their keys. */
typedef struct table {
    cell *cells;
    uint32_t count, room;
    uint32_t *places; /* a power of two, never full: the number of a cell from 1 on, or 0 */
    uint64_t nplaces;
} table;

typedef struct clusters {
    slv_tessellation *grids;
    const float *m; /* world to camera */
    bool perspective;
    float per_unit[2], deep; /* pixels of a length 1 at distance 1, or anywhere */
    bool *tiny;              /* per face */
    uint64_t ntiny;
    table together, fixed; /* vertices drawn together; and the positions of those that stay */
} clusters;

/* In pixels, and as many deep; false if it is not before the eye. */
static bool to_picture(const clusters *c, const float p[3], float out[3]) {
    float eye[3], depth;
    for (int k = 0; k < 3; k++)
        eye[k] =
            c->m[4 * k] * p[0] + c->m[4 * k + 1] * p[1] + c->m[4 * k + 2] * p[2] + c->m[4 * k + 3];
    depth = c->perspective ? -eye[2] : 1;
    if (!(depth > 0))
        return false;
    for (int k = 0; k < 2; k++)
        out[k] = eye[k] / depth * c->per_unit[k];
    out[2] = (c->perspective ? logf(depth) : eye[2]) * c->deep;
    return fabsf(out[0]) < 1e8f && fabsf(out[1]) < 1e8f && fabsf(out[2]) < 1e8f;
}

static bool is_tiny(const clusters *c, uint32_t face) {
    const slv_tessellation *t = c->grids;
    const slv_vertex *v = t->vertices + t->first[face];
    float low[3], high[3], at[3];
    if (t->segments[face] != 1)
        return false;
    for (int i = 0; i < 4; i++) {
        if (!to_picture(c, v[i].position, at))
            return false;
        for (int k = 0; k < 3; k++) {
            low[k] = i ? fminf(low[k], at[k]) : at[k];
            high[k] = i ? fmaxf(high[k], at[k]) : at[k];
        }
    }
    return high[0] - low[0] < CELL && high[1] - low[1] < CELL && high[2] - low[2] < CELL;
}

static slv_result make_table(const slv_env *env, uint64_t most, table *out) {
    out->nplaces = 2;
    while (out->nplaces < 2 * most)
        out->nplaces *= 2;
    return slvi_alloc(env, "clusters", out->nplaces, sizeof *out->places, &out->places);
}

static void free_table(table *t) {
    slvi_free(t->cells);
    slvi_free(t->places);
}

/* The place of a key: that of its cell, or a free one. */
static uint32_t *find(const table *t, const int32_t key[3]) {
    uint64_t h = 0;
    for (int k = 0; k < 3; k++)
        h = (h ^ (uint32_t)key[k]) * UINT64_C(0x9E3779B97F4A7C15);
    for (h ^= h >> 32;; h++) {
        uint32_t *place = t->places + (h & (t->nplaces - 1));
        if (!*place || memcmp(t->cells[*place - 1].key, key, sizeof t->cells->key) == 0)
            return place;
    }
}

static slv_result add(const slv_env *env, table *t, const int32_t key[3], cell **out) {
    uint32_t *place = find(t, key);
    if (!*place) {
        if (t->count == t->room) {
            uint32_t room = t->room ? 2 * t->room : 1024;
            slv_result result = slvi_grow(env, "clusters", room, sizeof *t->cells, &t->cells);
            if (result)
                return result;
            t->room = room;
        }
        cell *made = t->cells + t->count++;
        memset(made, 0, sizeof *made);
        memcpy(made->key, key, sizeof made->key);
        *place = t->count;
    }
    *out = t->cells + *place - 1;
    return SLV_OK;
}

/* The key of the cell that a vertex lies in; false if it stays. */
static bool key_of(const clusters *c, const slv_vertex *v, int32_t key[3]) {
    float at[3];
    memcpy(key, v->position, 3 * sizeof *key);
    if (*find(&c->fixed, key) || !to_picture(c, v->position, at))
        return false;
    for (int k = 0; k < 3; k++)
        key[k] = (int32_t)floorf(at[k] / CELL);
    return true;
}

/* What is on the rim of a larger face stays. */
static slv_result fix(const slv_env *env, clusters *c) {
    const slv_tessellation *t = c->grids;
    uint64_t count = 0;
    for (uint32_t f = 0; f < t->nfaces; f++)
        count += c->tiny[f] ? 0 : 4 * (uint64_t)t->segments[f];
    slv_result result = make_table(env, count, &c->fixed);
    for (uint32_t f = 0; f < t->nfaces && !result; f++) {
        uint32_t n = t->segments[f];
        for (uint32_t i = 0; !c->tiny[f] && n && i < (n + 1) * (n + 1) && !result; i++) {
            uint32_t x = i % (n + 1), y = i / (n + 1);
            int32_t key[3];
            cell *made;
            memcpy(key, t->vertices[t->first[f] + i].position, sizeof key);
            if (!x || !y || x == n || y == n)
                result = add(env, &c->fixed, key, &made);
        }
    }
    return result;
}

static slv_result gather(const slv_env *env, clusters *c) {
    const slv_tessellation *t = c->grids;
    slv_result result = make_table(env, 4 * c->ntiny, &c->together);
    for (uint32_t f = 0; f < t->nfaces && !result; f++)
        for (int i = 0; c->tiny[f] && i < 4 && !result; i++) {
            const slv_vertex *v = t->vertices + t->first[f] + i;
            int32_t key[3];
            cell *to;
            if (!key_of(c, v, key) || (result = add(env, &c->together, key, &to)))
                continue;
            for (int k = 0; k < 3; k++) {
                to->position[k] += (double)v->position[k];
                to->normal[k] += (double)v->normal[k];
            }
            to->count++;
        }
    return result;
}

static void move(clusters *c) {
    slv_tessellation *t = c->grids;
    static const uint8_t ends[4][2] = {{0, 1}, {1, 3}, {3, 2}, {2, 0}};
    for (uint32_t f = 0; f < t->nfaces; f++) {
        slv_vertex *v = t->vertices + t->first[f];
        for (int i = 0; c->tiny[f] && i < 4; i++) {
            int32_t key[3];
            float normal[3];
            if (!key_of(c, v + i, key))
                continue;
            const cell *from = c->together.cells + *find(&c->together, key) - 1;
            for (int k = 0; k < 3; k++) {
                v[i].position[k] = (float)(from->position[k] / from->count);
                normal[k] = (float)from->normal[k];
            }
            (void)slvi_normalise(normal, v[i].normal); /* or its own, where they cancel out */
        }
        for (int e = 0; c->tiny[f] && e < 4; e++)
            if (memcmp(v[ends[e][0]].position, v[ends[e][1]].position, sizeof v->position) == 0)
                t->edges[4 * (size_t)f + (size_t)e] = 0;
    }
}

slv_result slvi_cluster(const slv_env *env, slv_tessellation *grids,
                        const slv_tessellation_params *params) {
    const float *w = params->camera->window;
    clusters c = {.grids = grids,
                  .m = params->camera->world_to_camera,
                  .perspective = params->camera->perspective};
    slv_result result = slvi_alloc(env, "clusters", grids->nfaces, sizeof *c.tiny, &c.tiny);
    if (result)
        return result;
    c.per_unit[0] = (float)params->width / (w[1] - w[0]);
    c.per_unit[1] = (float)params->height / (w[3] - w[2]);
    c.deep = fmaxf(c.per_unit[0], c.per_unit[1]);
    for (uint32_t f = 0; f < grids->nfaces; f++) {
        c.tiny[f] = is_tiny(&c, f);
        c.ntiny += c.tiny[f];
    }
    if (c.ntiny > FEW && !(result = fix(env, &c)) && !(result = gather(env, &c)))
        move(&c);
    slvi_free(c.tiny);
    free_table(&c.fixed);
    free_table(&c.together);
    return result;
}
