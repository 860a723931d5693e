/* Grids moved by a displacement. Each face says how far it would move its points; a point of an
 * edge or a vertex moves by the mean over the faces that have it, summed up in one order, so that
 * it stays one point. */
#include "mesh/displace.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <string.h>

/* Normals of the limit further apart than 8 degrees are those of a crease. */
#define ONE_SURFACE 0.99f
/* Positions beyond are of no use to anybody, and their squares overflow. */
#define FARTHEST 1e18f

slv_result slvi_displace_begin(const slv_env *env, slvi_grid_job *job) {
    uint64_t count = 3 * (uint64_t)job->out->first[job->out->nfaces];
    slv_result result = slvi_alloc(env, "displacement", count, sizeof(float), &job->offsets);
    return result ? result : slvi_alloc(env, "displacement", count, sizeof(float), &job->facing);
}

static float dot(const float a[3], const float b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void slvi_displace_face(const slvi_grid_job *job, uint32_t face, const slvi_face_grid *grid) {
    size_t first = 3 * (size_t)job->out->first[face],
           size = 3 * ((size_t)job->out->first[face + 1] * sizeof(float)) - first * sizeof(float);
    memcpy(job->offsets + first, grid->offsets, size);
    memcpy(job->facing + first, grid->facing, size);
}

/* The vertices that are one point: those of a ring, or up to three beside an edge, in an order that
 * is the same for all of them. */
typedef struct meeting {
    const slv_corner *ring;
    uint32_t count, few[3];
} meeting;

static void sort_few(meeting *m) {
    for (uint32_t i = 1; i < m->count; i++)
        for (uint32_t k = i; k > 0 && m->few[k] < m->few[k - 1]; k--) {
            uint32_t swapped = m->few[k];
            m->few[k] = m->few[k - 1];
            m->few[k - 1] = swapped;
        }
}

/* The points t = k/n of an edge, but its ends. */
static meeting meet_on_edge(const slvi_grid_job *job, uint32_t face, unsigned edge, float t) {
    const slv_tessellation *grids = job->out;
    slv_neighbour other[2];
    float u, v;
    uint32_t count = slv_adjacency_neighbours(job->adjacency, (int32_t)face, edge, other);
    slvi_edge_point(edge, t, &u, &v);
    meeting m = {.count = 1, .few = {slvi_vertex_at(grids, face, u, v)}};
    for (uint32_t i = 0; i < count; i++) {
        float ou, ov;
        if (!grids->segments[other[i].face] || t < other[i].t0 || t > other[i].t1)
            continue;
        slv_affine_apply(&other[i].map, u, v, &ou, &ov);
        m.few[m.count++] = slvi_vertex_at(grids, (uint32_t)other[i].face, ou, ov);
    }
    sort_few(&m);
    return m;
}

static meeting meet_in_corner(const slvi_grid_job *job, uint32_t face, unsigned corner) {
    slv_neighbour quad;
    float uv[2];
    if (slv_adjacency_is_t_corner(job->adjacency, (int32_t)face, corner) &&
        slvi_t_corner_place(job, face, corner, &quad, uv))
        return meet_on_edge(job, (uint32_t)quad.face, quad.edge,
                            slvi_edge_t(quad.edge, uv[0], uv[1]));
    slv_ring ring = slv_adjacency_ring(job->adjacency, (int32_t)face, corner, NULL);
    return (meeting){.ring = ring.corners, .count = ring.count};
}

/* The i-th vertex of those; false if it belongs to a hole. */
static bool meeting_vertex(const slvi_grid_job *job, const meeting *m, uint32_t i, uint32_t *out) {
    if (!m->ring) {
        *out = m->few[i];
        return true;
    }
    const slv_corner *c = m->ring + i;
    if (!job->out->segments[c->face])
        return false;
    *out = slvi_corner_vertex(job->out, (uint32_t)c->face, c->corner);
    return true;
}

typedef void (*settle)(const slvi_grid_job *job, uint32_t vertex, const meeting *m);

static void move(const slvi_grid_job *job, uint32_t vertex, const meeting *m) {
    float sum[3] = {0, 0, 0}, count = 0;
    uint32_t other;
    for (uint32_t i = 0; i < m->count; i++) {
        if (!meeting_vertex(job, m, i, &other))
            continue;
        for (int c = 0; c < 3; c++)
            sum[c] += job->offsets[3 * (size_t)other + (size_t)c];
        count++;
    }
    for (int c = 0; c < 3 && count > 0; c++)
        job->out->vertices[vertex].position[c] += sum[c] / count;
}

/* One normal for the faces whose limit is smooth there. */
static void turn(const slvi_grid_job *job, uint32_t vertex, const meeting *m) {
    const slv_vertex *vertices = job->out->vertices;
    float sum[3] = {0, 0, 0};
    uint32_t other;
    for (uint32_t i = 0; i < m->count; i++) {
        if (!meeting_vertex(job, m, i, &other) ||
            dot(vertices[vertex].normal, vertices[other].normal) < ONE_SURFACE)
            continue;
        for (int c = 0; c < 3; c++)
            sum[c] += job->facing[3 * (size_t)other + (size_t)c];
    }
    if (!slvi_normalise(sum, job->offsets + 3 * (size_t)vertex))
        memcpy(job->offsets + 3 * (size_t)vertex, job->facing + 3 * (size_t)vertex, sizeof sum);
}

/* Does it to every vertex of a face, alone where no other face has it. */
static void settle_face(const slvi_grid_job *job, uint32_t face, settle what) {
    const slv_tessellation *t = job->out;
    uint32_t n = t->segments[face];
    if (!n)
        return;
    for (uint32_t y = 1; y < n; y++)
        for (uint32_t x = 1; x < n; x++) {
            uint32_t vertex = t->first[face] + y * (n + 1) + x;
            const meeting alone = {.count = 1, .few = {vertex}};
            what(job, vertex, &alone);
        }
    for (unsigned edge = 0; edge < 4; edge++) {
        uint32_t step = n / slvi_edge_segments(job, face, edge);
        meeting m = meet_in_corner(job, face, edge);
        what(job, slvi_corner_vertex(t, face, edge), &m);
        for (uint32_t k = 1; k < n; k++) {
            float u, v, at = (float)k / (float)n;
            slvi_edge_point(edge, at, &u, &v);
            uint32_t vertex = slvi_vertex_at(t, face, u, v);
            m = k % step ? (meeting){.count = 1, .few = {vertex}}
                         : meet_on_edge(job, face, edge, at);
            what(job, vertex, &m);
        }
    }
}

static slv_result move_faces(void *user, uint64_t begin, uint64_t end) {
    const slvi_grid_job *job = user;
    const slv_tessellation *t = job->out;
    for (uint64_t face = begin; face < end; face++) {
        settle_face(job, (uint32_t)face, move);
        for (uint32_t i = t->first[face]; i < t->first[face + 1]; i++)
            for (int c = 0; c < 3; c++)
                if (!(fabsf(t->vertices[i].position[c]) < FARTHEST))
                    return slvi_fail(&job->env, SLV_ERROR_LIMIT,
                                     "face %u is displaced out of reach, to %g along axis %d",
                                     (uint32_t)face, (double)t->vertices[i].position[c], c);
    }
    return SLV_OK;
}

static slv_result turn_faces(void *user, uint64_t begin, uint64_t end) {
    for (uint64_t face = begin; face < end; face++)
        settle_face(user, (uint32_t)face, turn);
    return SLV_OK;
}

static slv_result keep_normals(void *user, uint64_t begin, uint64_t end) {
    const slvi_grid_job *job = user;
    for (uint64_t i = job->out->first[begin]; i < job->out->first[end]; i++)
        memcpy(job->out->vertices[i].normal, job->offsets + 3 * i, 3 * sizeof(float));
    return SLV_OK;
}

slv_result slvi_displace_end(const slv_env *env, slvi_grid_job *job) {
    uint32_t nfaces = job->out->nfaces;
    slv_result result;
    /* one after the other: each reads of other faces what the next one changes */
    if ((result = slvi_parallel_for(env, nfaces, 64, move_faces, job)) ||
        (result = slvi_parallel_for(env, nfaces, 64, turn_faces, job)))
        return result;
    return slvi_parallel_for(env, nfaces, 256, keep_normals, job);
}
