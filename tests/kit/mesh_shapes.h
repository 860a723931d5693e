/* Meshes for tests: regular shapes, and ways to spoil them. */
#ifndef SLV_TEST_MESH_SHAPES_H
#define SLV_TEST_MESH_SHAPES_H

#include "kit/test.h"

#include <selvage/mesh.h>

/* A call that must succeed, made once. */
#define MUST(call)                                                                                 \
    do {                                                                                           \
        slv_result must_result = (call);                                                           \
        REQUIRE(must_result == SLV_OK);                                                            \
    } while (0)

typedef struct shape {
    float *positions;
    int32_t *sizes, *verts;
    uint32_t nverts, npolys, nsides;
} shape;

static inline void *shape_grow(void *p, size_t count, size_t size) {
    void *grown = realloc(p, (count + 1) * size);
    if (!grown)
        exit(1);
    return grown;
}

static inline int32_t shape_vertex(shape *s, float x, float y, float z) {
    if ((s->nverts & (s->nverts + 1)) == 0)
        s->positions = shape_grow(s->positions, 2 * s->nverts + 1, 3 * sizeof(float));
    float *p = s->positions + 3 * s->nverts;
    p[0] = x;
    p[1] = y;
    p[2] = z;
    return (int32_t)s->nverts++;
}

static inline void shape_polygon(shape *s, int32_t size, const int32_t *verts) {
    if ((s->npolys & (s->npolys + 1)) == 0)
        s->sizes = shape_grow(s->sizes, 2 * s->npolys + 1, sizeof(int32_t));
    s->sizes[s->npolys++] = size;
    for (int32_t i = 0; i < size; i++) {
        if ((s->nsides & (s->nsides + 1)) == 0)
            s->verts = shape_grow(s->verts, 2 * s->nsides + 1, sizeof(int32_t));
        s->verts[s->nsides++] = verts[i];
    }
}

static inline void shape_clear(shape *s) {
    free(s->positions);
    free(s->sizes);
    free(s->verts);
    *s = (shape){0};
}

/* nx by ny quads, rolled up in either direction if asked. */
static inline shape shape_grid(int nx, int ny, bool roll_x, bool roll_y) {
    shape s = {0};
    int columns = roll_x ? nx : nx + 1, rows = roll_y ? ny : ny + 1;
    const float turn = 6.2831853f;
    for (int j = 0; j < rows; j++)
        for (int i = 0; i < columns; i++) {
            float a = turn * (float)i / (float)nx, b = turn * (float)j / (float)ny;
            float r = roll_y ? 3 + cosf(b) : 3, h = roll_y ? sinf(b) : (float)j;
            if (roll_x)
                shape_vertex(&s, r * cosf(a), r * sinf(a), h);
            else
                shape_vertex(&s, (float)i, (float)j, 0.3f * sinf((float)(i + 2 * j)));
        }
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++) {
            int i1 = (i + 1) % columns, j1 = (j + 1) % rows;
            int32_t q[4] = {j * columns + i, j * columns + i1, j1 * columns + i1, j1 * columns + i};
            shape_polygon(&s, 4, q);
        }
    return s;
}

static inline shape shape_cube(void) {
    static const int32_t q[6][4] = {{0, 1, 3, 2}, {2, 3, 5, 4}, {4, 5, 7, 6},
                                    {6, 7, 1, 0}, {1, 7, 5, 3}, {6, 0, 2, 4}};
    static const float p[8][3] = {{-1, -1, 1}, {1, -1, 1}, {-1, 1, 1},   {1, 1, 1},
                                  {-1, 1, -1}, {1, 1, -1}, {-1, -1, -1}, {1, -1, -1}};
    shape s = {0};
    for (int i = 0; i < 8; i++)
        shape_vertex(&s, p[i][0], p[i][1], p[i][2]);
    for (int i = 0; i < 6; i++)
        shape_polygon(&s, 4, q[i]);
    return s;
}

static inline shape shape_tetrahedron(void) {
    static const int32_t t[4][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {3, 2, 1}};
    shape s = {0};
    shape_vertex(&s, 0, 0, 1);
    shape_vertex(&s, 1, 0, -0.5f);
    shape_vertex(&s, -0.5f, 0.9f, -0.5f);
    shape_vertex(&s, -0.5f, -0.9f, -0.4f);
    for (int i = 0; i < 4; i++)
        shape_polygon(&s, 3, t[i]);
    return s;
}

/* Polygons of `size` sides around one vertex: a fan of the given valence. */
static inline shape shape_fan(int valence, int size) {
    shape s = {0};
    int ring = valence * (size - 2);
    shape_vertex(&s, 0, 0, 0.5f);
    for (int i = 0; i < ring; i++) {
        float a = 6.2831853f * (float)i / (float)ring;
        shape_vertex(&s, 2 * cosf(a), 2 * sinf(a), 0.2f * sinf(3 * a));
    }
    for (int k = 0; k < valence; k++) {
        int32_t poly[16] = {0};
        for (int i = 0; i < size - 1; i++)
            poly[i + 1] = 1 + (k * (size - 2) + i) % ring;
        shape_polygon(&s, size, poly);
    }
    return s;
}

static inline uint32_t shape_first_side(const shape *s, uint32_t poly) {
    uint32_t first = 0;
    for (uint32_t p = 0; p < poly; p++)
        first += (uint32_t)s->sizes[p];
    return first;
}

static inline void shape_rotate_polygons(shape *s, uint64_t *random) {
    for (uint32_t p = 0, first = 0; p < s->npolys; first += (uint32_t)s->sizes[p++]) {
        int32_t *v = s->verts + first;
        for (uint32_t turns = test_random(random) % (uint32_t)s->sizes[p]; turns; turns--) {
            int32_t start = v[0];
            memmove(v, v + 1, (size_t)(s->sizes[p] - 1) * sizeof *v);
            v[s->sizes[p] - 1] = start;
        }
    }
}

/* Cuts some quads in two triangles, and drops some polygons altogether. */
static inline void shape_cut(shape *s, uint64_t *random, uint32_t split_of_8, uint32_t drop_of_8) {
    shape t = {0};
    for (uint32_t p = 0, first = 0; p < s->npolys; first += (uint32_t)s->sizes[p++]) {
        const int32_t *v = s->verts + first;
        if (test_random(random) % 8 < drop_of_8 && s->npolys > 1)
            continue;
        if (s->sizes[p] == 4 && test_random(random) % 8 < split_of_8) {
            int32_t other[3] = {v[0], v[2], v[3]};
            shape_polygon(&t, 3, v);
            shape_polygon(&t, 3, other);
        } else {
            shape_polygon(&t, s->sizes[p], v);
        }
    }
    free(s->sizes);
    free(s->verts);
    s->sizes = t.sizes;
    s->verts = t.verts;
    s->npolys = t.npolys;
    s->nsides = t.nsides;
}

/* Reverses the winding of one polygon. */
static inline void shape_flip_polygon(shape *s, uint32_t poly) {
    int32_t *v = s->verts + shape_first_side(s, poly), n = s->sizes[poly];
    for (int32_t i = 0; i < n / 2; i++) {
        int32_t keep = v[i];
        v[i] = v[n - 1 - i];
        v[n - 1 - i] = keep;
    }
}

/* Turns some vertex references into others, whatever that makes of the polygons. */
static inline void shape_scramble(shape *s, uint64_t *random, uint32_t count) {
    while (count-- && s->nsides)
        s->verts[test_random(random) % s->nsides] = (int32_t)(test_random(random) % s->nverts);
}

static inline slv_mesh_view shape_view(const shape *s) {
    slv_mesh_view view = {.nverts = s->nverts,
                          .positions = s->positions,
                          .npolys = s->npolys,
                          .poly_sizes = s->sizes,
                          .poly_verts = s->verts};
    return view;
}

static inline slv_mesh *shape_mesh(const slv_env *env, const shape *s) {
    slv_mesh_view view = shape_view(s);
    slv_mesh *mesh = NULL;
    MUST(slv_mesh_create(env, &view, &mesh));
    return mesh;
}

/* A random one of many kinds; `kind` counts up to SHAPE_KINDS. */
enum { SHAPE_KINDS = 14 };
static inline shape shape_random(int kind, uint64_t *random) {
    static const int valences[] = {3, 5, 6, 8};
    int nx = 3 + (int)(test_random(random) % 4), ny = 3 + (int)(test_random(random) % 4);
    shape s;
    switch (kind) {
    case 0:
        s = shape_cube();
        break;
    case 1:
        s = shape_tetrahedron();
        break;
    case 2:
        s = shape_grid(nx, ny, true, true);
        break;
    case 3:
        s = shape_fan(valences[test_random(random) % 4], 4);
        break;
    case 4:
        s = shape_fan(valences[test_random(random) % 4], 3);
        break;
    case 5:
        s = shape_fan(valences[test_random(random) % 4], 5);
        break;
    case 6:
        s = shape_grid(nx, ny, true, false);
        break;
    default:
        s = shape_grid(nx, ny, kind & 1, kind & 2);
        shape_cut(&s, random, kind >= 9 ? 3 : 0, kind >= 11 ? 2 : 0);
        break;
    }
    shape_rotate_polygons(&s, random);
    return s;
}

/* The corner of a face of the flat mesh. */
static inline void shape_corner(const slv_mesh *mesh, int32_t face, unsigned corner, float out[3]) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    slv_mesh_face f = slv_mesh_faces(mesh)[face];
    const int32_t *v = view->poly_verts;
    for (int32_t p = 0; p < f.poly; p++)
        v += view->poly_sizes[p];
    int32_t n = view->poly_sizes[f.poly], k = f.sub < 0 ? (int32_t)corner : f.sub;
    int32_t mate = corner == 1 ? (k + 1) % n : (k + n - 1) % n;
    for (int c = 0; c < 3; c++) {
        double sum = 0;
        for (int32_t i = 0; i < n; i++)
            sum += (double)view->positions[3 * v[i] + c];
        float own = view->positions[3 * v[k] + c];
        if (f.sub < 0 || corner == 0)
            out[c] = own;
        else if (corner == 2)
            out[c] = (float)(sum / n);
        else
            out[c] = 0.5f * (own + view->positions[3 * v[mate] + c]);
    }
}

#endif
