/* A part of the control mesh inside a .ptx. */
#include "exchange/geometry.h"

#include "base/log.h"
#include "base/memory.h"

#include <string.h>

const char *const slvi_geometry_keys[SLVI_GEOMETRY_KEYS] = {
    "PtexVertPositions", "PtexFaceVertCounts", "PtexFaceVertIndices"};

int slvi_geometry_key(const char *key) {
    for (int i = 0; i < SLVI_GEOMETRY_KEYS; i++)
        if (strcmp(key, slvi_geometry_keys[i]) == 0)
            return i;
    return -1;
}

/* The three arrays of a file, and what is taken of them. */
typedef struct selection {
    const char *name;
    const slv_ptx_meta *from[SLVI_GEOMETRY_KEYS];
    bool triangles;
    int32_t *moved; /* of each vertex its number in the part, or -1 */
    int32_t *counts, *indices;
    float *positions;
    uint32_t ncounts, nindices, nverts;
} selection;

static uint32_t faces_of(const selection *s, int32_t sides) {
    return s->triangles || sides == 4 ? 1 : (uint32_t)sides;
}

/* Takes the polygons all of whose faces are listed. Returns the first face of one that is torn, or
 * -1. */
static int64_t take_polygons(selection *s, const uint32_t *faces, uint32_t nfaces) {
    const int32_t *sides = s->from[SLVI_COUNTS]->values, *verts = s->from[SLVI_INDICES]->values;
    uint32_t face = 0, next = 0;
    for (uint32_t p = 0; p < s->from[SLVI_COUNTS]->count; verts += sides[p++]) {
        uint32_t n = faces_of(s, sides[p]), taken = 0;
        while (next < nfaces && faces[next] < face + n) {
            next++;
            taken++;
        }
        if (taken && taken < n)
            return face;
        if (taken) {
            s->counts[s->ncounts++] = sides[p];
            for (int32_t k = 0; k < sides[p]; k++)
                s->indices[s->nindices++] = verts[k];
        }
        face += n;
    }
    return -1;
}

/* False if a polygon has a vertex outside of `only`. */
static bool take_vertices(selection *s, const slvi_vertices *only) {
    const slv_ptx_meta *positions = s->from[SLVI_POSITIONS];
    uint32_t have = positions->count / 3;
    for (uint32_t i = 0; i < s->nindices; i++)
        s->moved[s->indices[i]] = 1;
    for (uint32_t v = 0; v < have; v++) {
        bool inside = only && v - only->first < only->count;
        if (only && s->moved[v] && !inside)
            return false;
        if (only ? !inside : !s->moved[v])
            continue;
        memcpy(s->positions + 3 * (size_t)s->nverts,
               (const float *)positions->values + 3 * (size_t)v, 3 * sizeof(float));
        s->moved[v] = (int32_t)s->nverts++;
    }
    for (uint32_t i = 0; i < s->nindices; i++)
        s->indices[i] = s->moved[s->indices[i]];
    return true;
}

static slv_result write_selection(const selection *s, slv_ptx_writer *writer) {
    const slv_ptx_meta out[SLVI_GEOMETRY_KEYS] = {
        [SLVI_POSITIONS] = {.type = SLV_META_FLOAT, .count = 3 * s->nverts, .values = s->positions},
        [SLVI_COUNTS] = {.type = SLV_META_INT32, .count = s->ncounts, .values = s->counts},
        [SLVI_INDICES] = {.type = SLV_META_INT32, .count = s->nindices, .values = s->indices}};
    slv_result result = SLV_OK;
    for (int k = 0; k < SLVI_GEOMETRY_KEYS && !result; k++) {
        slv_ptx_meta meta = out[k];
        meta.key = slvi_geometry_keys[k];
        result = slv_ptx_writer_set_meta(writer, &meta);
    }
    return result;
}

static slv_result select_from(const slv_env *env, selection *s, const uint32_t *faces,
                              uint32_t nfaces, const slvi_vertices *only, slv_ptx_writer *writer) {
    uint32_t positions = s->from[SLVI_POSITIONS]->count;
    slv_result result;
    if ((result = slvi_alloc(env, s->name, positions / 3, sizeof *s->moved, &s->moved)) ||
        (result = slvi_alloc(env, s->name, positions, sizeof *s->positions, &s->positions)) ||
        (result = slvi_alloc(env, s->name, s->from[SLVI_COUNTS]->count, sizeof *s->counts,
                             &s->counts)) ||
        (result = slvi_alloc(env, s->name, s->from[SLVI_INDICES]->count, sizeof *s->indices,
                             &s->indices)))
        return result;
    int64_t torn = take_polygons(s, faces, nfaces);
    if (torn >= 0) {
        slvi_logf(env, SLV_LOG_WARNING,
                  "%s: of the polygon of face %lld and those after it only some are taken: "
                  "the geometry inside is left out",
                  s->name, (long long)torn);
        return SLV_OK;
    }
    if (!take_vertices(s, only))
        return SLV_OK;
    return write_selection(s, writer);
}

slv_result slvi_geometry_select(const slv_env *env, const slv_ptx *ptx, const uint32_t *faces,
                                uint32_t nfaces, const slvi_vertices *vertices,
                                slv_ptx_writer *writer) {
    selection s = {.name = slv_ptx_name(ptx),
                   .triangles = slv_ptx_get_info(ptx)->mesh_type == SLV_PTX_TRIANGLE};
    slv_mesh *mesh = NULL;
    slv_result result = slv_ptx_find_mesh(env, ptx, &mesh, NULL);
    bool there = mesh != NULL; /* and the arrays agree with each other */
    slv_mesh_destroy(mesh);
    for (int k = 0; k < SLVI_GEOMETRY_KEYS && there; k++)
        there = (s.from[k] = slv_ptx_find_meta(ptx, slvi_geometry_keys[k])) != NULL;
    if (!result && there)
        result = select_from(env, &s, faces, nfaces, vertices, writer);
    slvi_free(s.moved);
    slvi_free(s.counts);
    slvi_free(s.indices);
    slvi_free(s.positions);
    return result;
}
