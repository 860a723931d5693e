/* Points of the limit, with derivatives and normals: regular patches row by row, others through
 * Bfr, and flat polygons by their corners. */
#include "mesh/surface/surface_data.h"
#include "mesh/surface/surface_positions.h"

#include <algorithm>
#include <cmath>
#include <selvage/subface.h>

namespace slvi_surface {
namespace {

struct Point {
    float position[3], du[3], dv[3];
};

float clamp_unit(float x) {
    return x > 0 ? (x < 1 ? x : 1) : 0;
}

/* One face, ready for any number of points. */
struct Prepared {
    Kind kind;
    const float *points;
    const BfrSurface *surface;
    Bfr::Parameterization parameters;
    int sub, stride;     /* floats from point to point */
    float corners[4][3]; /* bilinear, in the order of the face's corners */
    float extent;        /* of the control polygon */
    float row_v;         /* regular: what the rows below were summed for; NaN at first */
    float row[4][3], row_dv[4][3];
};

inline void bspline(float t, float w[4]) {
    float s = 1 - t, t2 = t * t, s2 = s * s;
    w[0] = s2 * s * (1.0f / 6);
    w[1] = (4 - 6 * t2 + 3 * t2 * t) * (1.0f / 6);
    w[2] = (4 - 6 * s2 + 3 * s2 * s) * (1.0f / 6);
    w[3] = t2 * t * (1.0f / 6);
}

void bspline(float t, float w[4], float d[4]) {
    float s = 1 - t, t2 = t * t, s2 = s * s;
    bspline(t, w);
    d[0] = -0.5f * s2;
    d[1] = t * (1.5f * t - 2);
    d[2] = s * (2 - 1.5f * s);
    d[3] = 0.5f * t2;
}

void combine(const float w[4], const float points[4][3], float out[3]) {
    for (int c = 0; c < 3; c++)
        out[c] =
            w[0] * points[0][c] + w[1] * points[1][c] + w[2] * points[2][c] + w[3] * points[3][c];
}

void evaluate_regular(Prepared &face, float u, float v, bool derivatives, Point &out) {
    float w[4], d[4];
    if (face.row_v != v) {
        bspline(v, w, d);
        for (int i = 0; i < 4; i++)
            for (int c = 0; c < 3; c++) {
                const float *p = face.points + 3 * i + c;
                face.row[i][c] = w[0] * p[0] + w[1] * p[12] + w[2] * p[24] + w[3] * p[36];
                face.row_dv[i][c] = d[0] * p[0] + d[1] * p[12] + d[2] * p[24] + d[3] * p[36];
            }
        face.row_v = v;
    }
    bspline(u, w, d);
    combine(w, face.row, out.position);
    if (!derivatives)
        return;
    combine(d, face.row, out.du);
    combine(w, face.row_dv, out.dv);
}

constexpr size_t kAtOnce = 16;

/* How many of the first points lie on one line of constant v, as far as evaluate_row goes. */
size_t row_of(const slv_surface_point *points, size_t count) {
    size_t n = 1;
    while (n < count && n < kAtOnce && points[n].face == points[0].face &&
           points[n].v == points[0].v)
        n++;
    return n;
}

/* Positions of so many points: those of evaluate_regular to the bit, several at a time. */
void evaluate_row(Prepared &face, const slv_surface_point *points, size_t n, float *out) {
    float u[kAtOnce], w[4][kAtOnce], at[3][kAtOnce];
    Point first;
    for (size_t i = 0; i < kAtOnce; i++)
        u[i] = clamp_unit(points[i < n ? i : 0].u);
    evaluate_regular(face, u[0], clamp_unit(points[0].v), false, first); /* sums the rows up */
    for (size_t i = 0; i < kAtOnce; i++) {
        float each[4];
        bspline(u[i], each);
        for (size_t k = 0; k < 4; k++)
            w[k][i] = each[k];
    }
    for (size_t c = 0; c < 3; c++)
        for (size_t i = 0; i < kAtOnce; i++)
            at[c][i] = w[0][i] * face.row[0][c] + w[1][i] * face.row[1][c] +
                       w[2][i] * face.row[2][c] + w[3][i] * face.row[3][c];
    for (size_t i = 0; i < n; i++)
        for (size_t c = 0; c < 3; c++)
            out[3 * i + c] = at[c][i];
}

void evaluate_bilinear(const Prepared &face, float u, float v, Point &out) {
    for (int c = 0; c < 3; c++) {
        float a = face.corners[0][c], b = face.corners[1][c], e = face.corners[3][c],
              f = face.corners[2][c];
        out.position[c] = (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * e + u * f);
        out.du[c] = (1 - v) * (b - a) + v * (f - e);
        out.dv[c] = (1 - u) * (e - a) + u * (f - b);
    }
}

/* A place of a surface of OpenSubdiv's on `count` faces, which share their weights and whose points
 * alternate. */
void evaluate_bfr(const Prepared &face, uint32_t count, const float uv[2], bool derivatives,
                  Point *out) {
    float position[3 * kLanes], du[3 * kLanes], dv[3 * kLanes];
    const BfrSurface::PointDescriptor points(int(3 * count), face.stride);
    if (derivatives)
        face.surface->Evaluate(uv, face.points, points, position, du, dv);
    else
        face.surface->Evaluate(uv, face.points, points, position);
    for (uint32_t k = 0; k < count; k++)
        for (uint32_t c = 0; c < 3; c++) {
            out[k].position[c] = position[3 * k + c];
            out[k].du[c] = derivatives ? du[3 * k + c] : 0;
            out[k].dv[c] = derivatives ? dv[3 * k + c] : 0;
        }
}

void evaluate_irregular(const Prepared &face, uint32_t count, float u, float v, bool derivatives,
                        Point *out) {
    float uv[2] = {u, v};
    if (face.sub >= 0) {
        /* A sub-face is a quarter of its unit tile. */
        float half[2] = {0.5f * u, 0.5f * v};
        face.parameters.ConvertSubFaceToCoord(face.sub, half, uv);
    }
    evaluate_bfr(face, count, uv, derivatives, out);
    for (uint32_t k = 0; k < count && face.sub >= 0; k++)
        for (int c = 0; c < 3; c++) {
            out[k].du[c] *= 0.5f;
            out[k].dv[c] *= 0.5f;
        }
}

/* The limit of a triangle in its barycentric coordinates, of which a sub-face's are a function. */
void evaluate_triangle(const Prepared &face, uint32_t count, float s, float t, bool derivatives,
                       Point *out) {
    float uv[2];
    slv_triangle_from_subface(unsigned(face.sub), s, t, &uv[0], &uv[1]);
    evaluate_bfr(face, count, uv, derivatives, out);
    /* the weights of the vertices, from the sub-face's own on */
    const float along_s[3] = {(2 * t - 3) / 6, (3 - t) / 6, -t / 6},
                along_t[3] = {(2 * s - 3) / 6, -s / 6, (3 - s) / 6};
    int at_u = (4 - face.sub) % 3, at_v = (5 - face.sub) % 3;
    for (uint32_t k = 0; k < count; k++)
        for (int c = 0; c < 3; c++) {
            const float du = out[k].du[c], dv = out[k].dv[c];
            out[k].du[c] = along_s[at_u] * du + along_s[at_v] * dv;
            out[k].dv[c] = along_t[at_u] * du + along_t[at_v] * dv;
        }
}

void evaluate_point(Prepared &face, float u, float v, bool derivatives, Point &out) {
    switch (face.kind) {
    case Kind::bilinear:
        evaluate_bilinear(face, u, v, out);
        break;
    case Kind::regular:
        evaluate_regular(face, u, v, derivatives, out);
        break;
    case Kind::irregular:
        evaluate_irregular(face, 1, u, v, derivatives, &out);
        break;
    case Kind::triangle:
        evaluate_triangle(face, 1, u, v, derivatives, &out);
        break;
    }
}

/* False where the derivatives are too short or too parallel to say which way the surface faces. */
bool normal_of(const Point &point, float extent, float out[3]) {
    const float *a = point.du, *b = point.dv;
    double n[3], aa = 0, bb = 0, nn = 0;
    for (int c = 0; c < 3; c++) {
        int c1 = (c + 1) % 3, c2 = (c + 2) % 3;
        n[c] = double(a[c1]) * b[c2] - double(a[c2]) * b[c1];
        aa += double(a[c]) * a[c];
        bb += double(b[c]) * b[c];
        nn += n[c] * n[c];
    }
    double longest = std::max(aa, bb), least = 1e-6 * extent;
    if (!(longest > least * least) || !(nn > 1e-12 * longest * longest) || !std::isfinite(nn))
        return false;
    double scale = 1 / std::sqrt(nn);
    for (int c = 0; c < 3; c++)
        out[c] = float(n[c] * scale);
    return true;
}

void evaluate_normal(Prepared &face, float u, float v, const Point &point, float out[3]) {
    if (normal_of(point, face.extent, out))
        return;
    for (float step : {1e-3f, 1e-2f, 0.1f, 0.5f}) {
        Point moved;
        evaluate_point(face, u + (0.5f - u) * step, v + (0.5f - v) * step, true, moved);
        if (normal_of(moved, face.extent, out))
            return;
    }
    out[0] = out[1] = 0;
    out[2] = 1;
}

/* The corners of a face of the flat polygon, and how far the polygon reaches. */
void prepare_corners(const slv_surface &s, slv_mesh_face face, Prepared &out) {
    size_t size = size_t(s.sizes[size_t(face.poly)]);
    const int32_t *verts = &s.verts[s.first[size_t(face.poly)]];
    auto at = [&](size_t k) { return &s.positions[3 * size_t(verts[k])]; };
    const Middle &middle = s.middles[size_t(face.poly)];
    out.extent = middle.extent;
    for (size_t c = 0; c < 3; c++) {
        if (face.sub < 0) {
            for (size_t k = 0; k < 4; k++)
                out.corners[k][c] = at(k)[c];
            continue;
        }
        size_t k = size_t(face.sub);
        out.corners[0][c] = at(k)[c];
        out.corners[1][c] = 0.5f * (at(k)[c] + at((k + 1) % size)[c]);
        out.corners[2][c] = middle.centre[c];
        out.corners[3][c] = 0.5f * (at(k)[c] + at((k + size - 1) % size)[c]);
    }
}

void prepare_face(const slv_surface &s, int32_t id, Prepared &out) {
    slv_mesh_face face = s.faces[size_t(id)];
    size_t poly = size_t(face.poly);
    out.kind = Kind::bilinear;
    out.sub = face.sub;
    out.row_v = NAN;
    prepare_corners(s, face, out);
    if (s.patches.empty())
        return;
    const Patch &patch = s.patches[poly];
    const Chunk &chunk = s.chunks[poly / kChunk];
    out.kind = patch.kind;
    if (patch.kind == Kind::bilinear)
        return;
    out.points = patch.lanes ? &s.points[patch.points] : &chunk.points[patch.points];
    out.stride = patch.lanes ? 3 * patch.lanes : 3;
    if (patch.kind != Kind::regular) {
        out.surface = &chunk.surfaces[patch.surface];
        out.parameters = out.surface->GetParameterization();
    }
}

void put(float *array, size_t i, const float value[3]) {
    for (size_t c = 0; array && c < 3; c++) /* std::copy would call memmove */
        array[3 * i + c] = value[c];
}

bool wants_derivatives(const slv_surface_arrays &out) {
    return out.du || out.dv || out.normals;
}

void put_point(Prepared &face, float u, float v, const Point &point, const slv_surface_arrays &out,
               size_t i) {
    put(out.positions, i, point.position);
    put(out.du, i, point.du);
    put(out.dv, i, point.dv);
    if (out.normals)
        evaluate_normal(face, u, v, point, out.normals + 3 * i);
}

void evaluate_into(Prepared &face, float u, float v, const slv_surface_arrays &out, size_t i) {
    Point point;
    u = clamp_unit(u);
    v = clamp_unit(v);
    evaluate_point(face, u, v, wants_derivatives(out), point);
    put_point(face, u, v, point, out, i);
}

bool face_exists(const slv_surface *s, int32_t face) {
    return face >= 0 && size_t(face) < s->faces.size();
}

} // namespace
} // namespace slvi_surface

using namespace slvi_surface;

void slvi_surface_bounds(const slv_surface *surface, float low[3], float high[3]) {
    for (size_t k = 0; k < 3; k++) {
        low[k] = INFINITY;
        high[k] = -INFINITY;
    }
    for (size_t i = 0; i < surface->positions.size(); i++) {
        low[i % 3] = std::fmin(low[i % 3], surface->positions[i]);
        high[i % 3] = std::fmax(high[i % 3], surface->positions[i]);
    }
}

void slvi_surface_corners(const slv_surface *surface, int32_t face, float out[12]) {
    Prepared prepared;
    prepare_corners(*surface, surface->faces[size_t(face)], prepared);
    std::copy(&prepared.corners[0][0], &prepared.corners[0][0] + 12, out);
}

slv_result slv_surface_evaluate(const slv_surface *surface, size_t count,
                                const slv_surface_point *points, const slv_surface_arrays *out) {
    return guarded(&surface->env, [&]() -> slv_result {
        Prepared face;
        int64_t prepared = INT64_MIN; /* no face has this number */
        const bool positions_only = out->positions && !out->du && !out->dv && !out->normals;
        for (size_t i = 0; i < count;) {
            if (points[i].face != prepared) {
                if (!face_exists(surface, points[i].face))
                    return slvi_fail(&surface->env, SLV_ERROR_ARGUMENT,
                                     "surface: point %zu is on face %d of %zu", i, points[i].face,
                                     surface->faces.size());
                prepared = points[i].face;
                prepare_face(*surface, prepared, face);
            }
            const bool rows = positions_only && face.kind == Kind::regular;
            const size_t n = rows ? row_of(points + i, count - i) : 1;
            if (n > kAtOnce / 4)
                evaluate_row(face, points + i, n, out->positions + 3 * i);
            for (size_t k = i; n <= kAtOnce / 4 && k < i + n; k++)
                evaluate_into(face, points[k].u, points[k].v, *out, k);
            i += n;
        }
        return SLV_OK;
    });
}

slv_result slv_surface_evaluate_grid(const slv_surface *surface, int32_t face_id, uint32_t nu,
                                     uint32_t nv, const slv_surface_arrays *out) {
    if (!face_exists(surface, face_id) || !nu || !nv)
        return slvi_fail(&surface->env, SLV_ERROR_ARGUMENT,
                         "surface: a grid of %u x %u on face %d of %zu", nu, nv, face_id,
                         surface->faces.size());
    return guarded(&surface->env, [&]() -> slv_result {
        Prepared face;
        size_t i = 0;
        prepare_face(*surface, face_id, face);
        for (uint32_t y = 0; y <= nv; y++)
            for (uint32_t x = 0; x <= nu; x++)
                evaluate_into(face, float(x) / float(nu), float(y) / float(nv), *out, i++);
        return SLV_OK;
    });
}

slv_result slvi_surface_evaluate_unit(const slv_surface *surface, uint32_t unit, uint32_t n,
                                      const slv_surface_arrays out[SLVI_UNIT_FACES]) {
    int32_t faces[SLVI_UNIT_FACES];
    uint32_t count = slvi_surface_unit(surface, unit, faces);
    if (count == 1)
        return slv_surface_evaluate_grid(surface, faces[0], n, n, out);
    return guarded(&surface->env, [&]() -> slv_result {
        Prepared prepared[SLVI_UNIT_FACES];
        Point points[SLVI_UNIT_FACES];
        bool derivatives = false;
        for (uint32_t k = 0; k < count; k++) {
            prepare_face(*surface, faces[k], prepared[k]);
            derivatives = derivatives || wants_derivatives(out[k]);
        }
        for (size_t i = 0; i < size_t(n + 1) * (n + 1); i++) {
            float u = float(i % (n + 1)) / float(n), v = float(i / (n + 1)) / float(n);
            if (prepared[0].kind == Kind::triangle)
                evaluate_triangle(prepared[0], count, u, v, derivatives, points);
            else
                evaluate_irregular(prepared[0], count, u, v, derivatives, points);
            for (uint32_t k = 0; k < count; k++)
                put_point(prepared[k], u, v, points[k], out[k], i);
        }
        return SLV_OK;
    });
}
