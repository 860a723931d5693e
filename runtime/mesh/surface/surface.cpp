/* Limit surfaces through OpenSubdiv's Bfr, the only C++ of the library. Every polygon is prepared
 * once, when the surface is built; regular ones become sixteen B-spline points that are evaluated
 * here, row by row. */
#include <selvage/surface.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <memory>
#include <mutex>
#include <new>
#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/bfr/surfaceFactoryCache.h>
#include <opensubdiv/far/ptexIndices.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefiner.h>
#include <shared_mutex>
#include <tuple>
#include <utility>
#include <vector>

extern "C" {
#include "base/log.h"
#include "base/parallel.h"
#include "mesh/mesh_data.h"
}

namespace Bfr = OpenSubdiv::Bfr;
namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

namespace {

constexpr uint32_t kChunk = 256; /* polygons prepared and stored together */
constexpr uint32_t kMostAround =
    512; /* beyond, the time and memory that Bfr takes grow with the square */
constexpr int kSmoothLevel = 3, kSharpLevel = 8;

using BfrSurface = Bfr::Surface<float>;
using Cache =
    Bfr::SurfaceFactoryCacheThreaded<std::shared_mutex, std::shared_lock<std::shared_mutex>,
                                     std::unique_lock<std::shared_mutex>>;
using Factory = Bfr::RefinerSurfaceFactory<Cache>;

enum class Kind : uint8_t { bilinear, regular, irregular };

struct Patch {
    Kind kind = Kind::bilinear;
    uint32_t surface = 0; /* irregular: which of the chunk's */
    size_t points = 0;    /* where in the chunk's points */
};

struct Chunk {
    std::vector<float> points;
    std::vector<BfrSurface> surfaces;
};

struct Point {
    float position[3], du[3], dv[3];
};

/* One face, ready for any number of points. */
struct Prepared {
    Kind kind;
    const float *points;
    const BfrSurface *surface;
    Bfr::Parameterization parameters;
    int sub;
    float corners[4][3]; /* bilinear, in the order of the face's corners */
    float extent;        /* of the control polygon */
    float row_v;         /* regular: what the rows below were summed for; NaN at first */
    float row[4][3], row_dv[4][3];
};

void bspline(float t, float w[4], float d[4]) {
    float s = 1 - t, t2 = t * t, s2 = s * s;
    w[0] = s2 * s * (1.0f / 6);
    w[1] = (4 - 6 * t2 + 3 * t2 * t) * (1.0f / 6);
    w[2] = (4 - 6 * s2 + 3 * s2 * s) * (1.0f / 6);
    w[3] = t2 * t * (1.0f / 6);
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

void evaluate_regular(Prepared &face, float u, float v, Point &out) {
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
    combine(d, face.row, out.du);
    combine(w, face.row_dv, out.dv);
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

void evaluate_irregular(const Prepared &face, float u, float v, bool derivatives, Point &out) {
    float uv[2] = {u, v};
    if (face.sub >= 0) {
        /* A sub-face is a quarter of its unit tile. */
        float half[2] = {0.5f * u, 0.5f * v};
        face.parameters.ConvertSubFaceToCoord(face.sub, half, uv);
    }
    if (!derivatives) {
        face.surface->Evaluate(uv, face.points, 3, out.position);
        return;
    }
    face.surface->Evaluate(uv, face.points, 3, out.position, out.du, out.dv);
    if (face.sub >= 0)
        for (int c = 0; c < 3; c++) {
            out.du[c] *= 0.5f;
            out.dv[c] *= 0.5f;
        }
}

void evaluate_point(Prepared &face, float u, float v, bool derivatives, Point &out) {
    switch (face.kind) {
    case Kind::bilinear:
        evaluate_bilinear(face, u, v, out);
        break;
    case Kind::regular:
        evaluate_regular(face, u, v, out);
        break;
    case Kind::irregular:
        evaluate_irregular(face, u, v, derivatives, out);
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

float clamp_unit(float x) {
    return x > 0 ? (x < 1 ? x : 1) : 0;
}

/* A polygon's centre, and how far it reaches along any axis. */
struct Middle {
    float centre[3] = {0, 0, 0}, extent = 0;
};

} // namespace

struct slv_surface {
    slv_env env;
    slv_scheme scheme;
    slv_boundary boundary;
    std::vector<slv_mesh_face> faces;
    std::vector<int32_t> sizes, verts, poly_face;
    std::vector<uint32_t> first;
    std::vector<float> positions;
    std::vector<Middle> middles; /* of the polygons */
    std::vector<Patch> patches;  /* per polygon; none for the bilinear scheme */
    std::vector<Chunk> chunks;
};

namespace {

/* What OpenSubdiv is given. It prints about tags that name nothing, and crashes on some polygons
 * that name a vertex twice and on some meshes that are not manifold, so it sees neither. */
struct Topology {
    std::vector<uint8_t> left_out; /* per polygon */
    std::vector<uint8_t> refused;  /* per polygon: known to OpenSubdiv, but not to be asked for */
    std::vector<int> osd_face;     /* per polygon, -1 if left out */
    std::vector<int> sizes, verts, poly_of;
    std::vector<int> crease_verts, corner_verts;
    std::vector<float> crease_sharpness, corner_sharpness;
    std::vector<float> positions;
    std::unique_ptr<Far::TopologyRefiner> refiner;
};

bool names_vertex_twice(const int32_t *verts, int32_t size, std::vector<int32_t> &scratch) {
    scratch.assign(verts, verts + size);
    std::sort(scratch.begin(), scratch.end());
    return std::adjacent_find(scratch.begin(), scratch.end()) != scratch.end();
}

void leave_out_bad(const slv_surface &s, Topology &out) {
    std::vector<int32_t> scratch;
    for (size_t p = 0; p < s.sizes.size(); p++)
        out.left_out.push_back(names_vertex_twice(&s.verts[s.first[p]], s.sizes[p], scratch));
}

/* `verts` is like the surface's, for `nverts` vertices. Leaves `out.refiner` empty where
 * OpenSubdiv's own limits are exceeded. */
void make_refiner(const slv_surface &s, const int32_t *verts, size_t nverts, Topology &out) {
    std::vector<uint32_t> valence(nverts, 0);
    bool fits = true;
    out.osd_face.assign(s.sizes.size(), -1);
    for (size_t p = 0; p < s.sizes.size(); p++) {
        if (out.left_out[p])
            continue;
        const int32_t *first = verts + s.first[p];
        fits = fits && s.sizes[p] <= Far::VALENCE_LIMIT / 2;
        out.osd_face[p] = int(out.sizes.size());
        out.poly_of.push_back(int(p));
        out.sizes.push_back(s.sizes[p]);
        out.verts.insert(out.verts.end(), first, first + s.sizes[p]);
        for (int32_t i = 0; i < s.sizes[p]; i++)
            fits = ++valence[size_t(first[i])] <= uint32_t(Far::VALENCE_LIMIT / 2) && fits;
    }
    if (!fits || out.sizes.empty())
        return;
    Far::TopologyDescriptor descriptor;
    descriptor.numVertices = int(nverts);
    descriptor.numFaces = int(out.sizes.size());
    descriptor.numVertsPerFace = out.sizes.data();
    descriptor.vertIndicesPerFace = out.verts.data();
    descriptor.numCreases = int(out.crease_sharpness.size());
    descriptor.creaseVertexIndexPairs = out.crease_verts.data();
    descriptor.creaseWeights = out.crease_sharpness.data();
    descriptor.numCorners = int(out.corner_sharpness.size());
    descriptor.cornerVertexIndices = out.corner_verts.data();
    descriptor.cornerWeights = out.corner_sharpness.data();
    using Refiners = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(s.boundary == SLV_BOUNDARY_EDGE_ONLY
                                            ? Sdc::Options::VTX_BOUNDARY_EDGE_ONLY
                                            : Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    out.refiner.reset(
        Refiners::Create(descriptor, Refiners::Options(Sdc::SCHEME_CATMARK, options)));
}

/* Edges that are not simply shared become infinitely sharp: that is what keeps the sheets that meet
 * in one together. */
void add_creases(const slv_mesh *mesh, const slv_mesh_edges &edges, const slv_mesh_fans &fans,
                 Topology &out) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    std::vector<float> sharpness(edges.count, 0);
    for (uint32_t i = 0; i < view->ncreases; i++) {
        const int32_t *ends = view->crease_verts + 2 * size_t(i);
        uint32_t edge = slvi_mesh_edges_find(&edges, ends[0], ends[1]);
        if (edge != SLV_NO_EDGE)
            sharpness[edge] = std::min(view->crease_sharpness[i], 10.0f);
    }
    for (uint32_t i = 0; i < edges.count; i++)
        if (edges.edges[i].count > 2)
            sharpness[i] = 10;
    for (uint32_t p = 0; p < view->npolys; p++) {
        uint32_t first = mesh->poly_first[p], end = mesh->poly_first[p + 1];
        for (uint32_t side = first; !out.left_out[p] && side < end; side++) {
            float sharp = sharpness[edges.side_edge[side]];
            if (!(sharp > 0))
                continue;
            out.crease_verts.push_back(fans.side_vert[side]);
            out.crease_verts.push_back(fans.side_vert[side + 1 < end ? side + 1 : first]);
            out.crease_sharpness.push_back(sharp);
        }
    }
}

void add_corners(const slv_mesh_view *view, const slv_mesh_fans &fans, Topology &out) {
    std::vector<float> sharpness(view->nverts, 0);
    for (uint32_t i = 0; i < view->ncorners; i++)
        sharpness[size_t(view->corner_verts[i])] = std::min(view->corner_sharpness[i], 10.0f);
    for (uint32_t v = 0; v < fans.nverts; v++) {
        float sharp = fans.sharp[v] ? 10 : sharpness[size_t(fans.origin[v])];
        if (!(sharp > 0))
            continue;
        out.corner_verts.push_back(int(v));
        out.corner_sharpness.push_back(sharp);
    }
}

/* The polygons that share two edges or more with one other polygon, by any side of theirs. */
std::vector<uint32_t> doubly_joined(const slv_mesh *mesh, const slv_mesh_edges &edges,
                                    const slv_mesh_fans &fans, const Topology &topology) {
    struct Use {
        int low, high;
        uint32_t poly;
    };
    std::vector<Use> uses;
    std::vector<std::pair<uint32_t, uint32_t>> pairs;
    auto join = [&](uint32_t p, uint32_t q) { pairs.emplace_back(std::min(p, q), std::max(p, q)); };
    for (uint32_t p = 0; p < slv_mesh_get_view(mesh)->npolys; p++) {
        uint32_t first = mesh->poly_first[p], end = mesh->poly_first[p + 1];
        for (uint32_t side = first; !topology.left_out[p] && side < end; side++) {
            const slv_mesh_edge &edge = edges.edges[edges.side_edge[side]];
            int a = fans.side_vert[side], b = fans.side_vert[side + 1 < end ? side + 1 : first];
            if (edge.count > 2)
                uses.push_back({std::min(a, b), std::max(a, b), p});
            else if (edge.count == 2 && edge.side[0] == side)
                join(p, edges.side_poly[edge.side[1]]);
        }
    }
    auto key = [](const Use &use) { return std::make_tuple(use.low, use.high, use.poly); };
    std::sort(uses.begin(), uses.end(),
              [&](const Use &x, const Use &y) { return key(x) < key(y); });
    for (size_t i = 1; i < uses.size(); i++)
        if (uses[i].low == uses[i - 1].low && uses[i].high == uses[i - 1].high)
            join(uses[i].poly, uses[i - 1].poly);
    std::sort(pairs.begin(), pairs.end());
    std::vector<uint32_t> found;
    for (size_t i = 1; i < pairs.size(); i++)
        if (pairs[i] == pairs[i - 1]) {
            found.push_back(pairs[i].first);
            found.push_back(pairs[i].second);
        }
    return found;
}

void refuse_crowded(const slv_surface &s, const slv_mesh_fans &fans, Topology &out) {
    std::vector<uint32_t> valence(fans.nverts, 0);
    for (size_t p = 0; p < s.sizes.size(); p++)
        for (uint32_t side = s.first[p]; !out.left_out[p] && side < s.first[p + 1]; side++)
            valence[size_t(fans.side_vert[side])]++;
    for (size_t p = 0; p < s.sizes.size(); p++)
        for (uint32_t side = s.first[p]; !out.refused[p] && side < s.first[p + 1]; side++)
            out.refused[p] = valence[size_t(fans.side_vert[side])] > kMostAround ||
                             s.first[p + 1] - s.first[p] > kMostAround;
}

/* Bfr 3.5 writes past its buffers where a sharp edge or vertex comes together with two polygons
 * that meet along two edges, as around a vertex of valence two or in a tube of two. What touches
 * such polygons there stays flat. */
void refuse_doubly_joined(const slv_mesh *mesh, const slv_mesh_edges &edges,
                          const slv_mesh_fans &fans, Topology &out) {
    if (out.crease_verts.empty() && out.corner_verts.empty())
        return;
    std::vector<uint8_t> tagged(fans.nverts, 0), doubly(fans.nverts, 0);
    for (int vertex : out.crease_verts)
        tagged[size_t(vertex)] = 1;
    for (int vertex : out.corner_verts)
        tagged[size_t(vertex)] = 1;
    for (uint32_t p : doubly_joined(mesh, edges, fans, out))
        for (uint32_t side = mesh->poly_first[p]; side < mesh->poly_first[p + 1]; side++)
            if (!out.left_out[p])
                doubly[size_t(fans.side_vert[side])] = 1;
    for (uint32_t p = 0; p < slv_mesh_get_view(mesh)->npolys; p++) {
        bool sharp = false, near = false;
        for (uint32_t side = mesh->poly_first[p];
             !out.left_out[p] && side < mesh->poly_first[p + 1]; side++) {
            sharp = sharp || tagged[size_t(fans.side_vert[side])];
            near = near || doubly[size_t(fans.side_vert[side])];
        }
        if (sharp && near)
            out.refused[p] = 1;
    }
}

struct Edges : slv_mesh_edges {
    Edges() : slv_mesh_edges() {
    }
    ~Edges() {
        slvi_mesh_edges_clear(this);
    }
    Edges(const Edges &) = delete;
    Edges &operator=(const Edges &) = delete;
};

struct Fans : slv_mesh_fans {
    Fans() : slv_mesh_fans() {
    }
    ~Fans() {
        slvi_mesh_fans_clear(this);
    }
    Fans(const Fans &) = delete;
    Fans &operator=(const Fans &) = delete;
};

slv_result make_manifold(const slv_env *env, const slv_mesh *mesh, const slv_surface &s,
                         Topology &out) {
    Edges edges;
    Fans fans;
    slv_result result;
    leave_out_bad(s, out);
    if ((result = slvi_mesh_edges_create(env, mesh, &edges)) ||
        (result = slvi_mesh_fans_create(env, mesh, &edges, out.left_out.data(), &fans)))
        return result;
    add_creases(mesh, edges, fans, out);
    add_corners(slv_mesh_get_view(mesh), fans, out);
    out.refused = out.left_out;
    refuse_crowded(s, fans, out);
    refuse_doubly_joined(mesh, edges, fans, out);
    for (uint32_t v = 0; v < fans.nverts; v++) {
        const float *from = &s.positions[3 * size_t(fans.origin[v])];
        out.positions.insert(out.positions.end(), from, from + 3);
    }
    make_refiner(s, fans.side_vert, fans.nverts, out);
    return SLV_OK;
}

/* OpenSubdiv leaves the points beyond a boundary out of a regular patch; as linear extrapolations
 * they turn it into an ordinary one. Which rows are left out shows in the weights of the patch's
 * middle. */
void store_regular(const BfrSurface &surface, const std::vector<float> &positions, Chunk &chunk) {
    static const float middle[2] = {0.5f, 0.5f};
    float weights[16], p[4][4][3];
    surface.EvaluateStencil(middle, weights);
    surface.GatherControlPoints(positions.data(), 3, &p[0][0][0], 3);
    auto missing = [&](int at, int step) {
        return weights[at] == 0 && weights[at + step] == 0 && weights[at + 2 * step] == 0 &&
               weights[at + 3 * step] == 0;
    };
    bool bottom = missing(0, 1), top = missing(12, 1), left = missing(0, 4), right = missing(3, 4);
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++) {
            if (bottom)
                p[0][i][c] = 2 * p[1][i][c] - p[2][i][c];
            if (top)
                p[3][i][c] = 2 * p[2][i][c] - p[1][i][c];
        }
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++) {
            if (left)
                p[i][0][c] = 2 * p[i][1][c] - p[i][2][c];
            if (right)
                p[i][3][c] = 2 * p[i][2][c] - p[i][1][c];
        }
    chunk.points.insert(chunk.points.end(), &p[0][0][0], &p[0][0][0] + 48);
}

struct Build {
    slv_surface *surface;
    const Topology *topology;
    const Factory *factory;
    uint64_t max_bytes;
    std::atomic<uint64_t> bytes{0};
    std::atomic<uint32_t> refused{0};
};

void prepare_polygon(Build &build, uint32_t poly, Chunk &chunk) {
    Patch &patch = build.surface->patches[poly];
    int face = build.topology->osd_face[poly];
    BfrSurface surface;
    if (build.topology->refused[poly] || !build.factory->InitVertexSurface(face, &surface)) {
        build.refused++;
        return;
    }
    patch.points = chunk.points.size();
    if (surface.IsRegular() && surface.GetNumControlPoints() == 16) {
        patch.kind = Kind::regular;
        store_regular(surface, build.topology->positions, chunk);
        return;
    }
    patch.kind = Kind::irregular;
    patch.surface = uint32_t(chunk.surfaces.size());
    chunk.points.resize(patch.points + 3 * size_t(surface.GetNumPatchPoints()));
    surface.PreparePatchPoints(build.topology->positions.data(), 3, &chunk.points[patch.points], 3);
    chunk.surfaces.push_back(surface);
}

slv_result prepare_range(void *user, uint64_t first, uint64_t end) {
    Build &build = *static_cast<Build *>(user);
    try {
        Chunk &chunk = build.surface->chunks[first / kChunk];
        for (uint64_t p = first; p < end; p++)
            prepare_polygon(build, uint32_t(p), chunk);
        chunk.points.shrink_to_fit();
        chunk.surfaces.shrink_to_fit();
        uint64_t size =
            chunk.points.size() * sizeof(float) + chunk.surfaces.size() * sizeof(BfrSurface);
        return (build.bytes += size) > build.max_bytes ? SLV_ERROR_LIMIT : SLV_OK;
    } catch (const std::bad_alloc &) {
        return SLV_ERROR_MEMORY;
    } catch (...) {
        return SLV_ERROR_UNSUPPORTED;
    }
}

slv_result build_patches(const slv_env *env, const slv_mesh *mesh, slv_surface *s) {
    Topology topology;
    slv_result result = make_manifold(env, mesh, *s, topology);
    if (result)
        return result;
    size_t npolys = s->sizes.size();
    s->patches.resize(npolys);
    s->chunks.resize((npolys + kChunk - 1) / kChunk);
    Build build;
    build.surface = s;
    build.topology = &topology;
    build.max_bytes = s->env.max_bytes;
    if (topology.refiner) {
        Factory::Options options;
        options.SetApproxLevelSmooth(kSmoothLevel).SetApproxLevelSharp(kSharpLevel);
        Factory factory(*topology.refiner, options);
        build.factory = &factory;
        if ((result = slvi_parallel_for(env, npolys, kChunk, prepare_range, &build)))
            return slvi_fail(env, result, "surface: could not be prepared: %s",
                             slv_result_string(result));
    } else {
        build.refused = uint32_t(npolys);
    }
    if (build.refused)
        slvi_logf(env, SLV_LOG_WARNING,
                  "surface: OpenSubdiv has no limit for %u polygon(s), they stay flat",
                  build.refused.load());
    return SLV_OK;
}

/* Once for each polygon, and not for each of its sub-faces: polygons may have many sides. */
void find_middles(slv_surface *s) {
    s->middles.resize(s->sizes.size());
    for (size_t p = 0; p < s->sizes.size(); p++) {
        const int32_t *verts = &s->verts[s->first[p]];
        double centre[3] = {0, 0, 0};
        Middle &middle = s->middles[p];
        for (int32_t k = 0; k < s->sizes[p]; k++)
            for (size_t c = 0; c < 3; c++) {
                float at = s->positions[3 * size_t(verts[k]) + c];
                centre[c] += double(at);
                middle.extent =
                    std::max(middle.extent, std::fabs(at - s->positions[3 * size_t(verts[0]) + c]));
            }
        for (size_t c = 0; c < 3; c++)
            middle.centre[c] = float(centre[c] / double(s->sizes[p]));
    }
}

void copy_mesh(const slv_mesh *mesh, slv_surface *s) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    s->faces.assign(mesh->faces, mesh->faces + mesh->nfaces);
    s->sizes.assign(view->poly_sizes, view->poly_sizes + view->npolys);
    s->first.assign(mesh->poly_first, mesh->poly_first + view->npolys + 1);
    s->verts.assign(view->poly_verts, view->poly_verts + s->first.back());
    s->poly_face.assign(mesh->poly_face, mesh->poly_face + view->npolys);
    s->positions.assign(view->positions, view->positions + 3 * size_t(view->nverts));
    find_middles(s);
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
    out.points = &chunk.points[patch.points];
    if (patch.kind == Kind::irregular) {
        out.surface = &chunk.surfaces[patch.surface];
        out.parameters = out.surface->GetParameterization();
    }
}

void put(float *array, size_t i, const float value[3]) {
    if (array)
        std::copy(value, value + 3, array + 3 * i);
}

void evaluate_into(Prepared &face, float u, float v, const slv_surface_arrays &out, size_t i) {
    Point point;
    u = clamp_unit(u);
    v = clamp_unit(v);
    evaluate_point(face, u, v, out.du || out.dv || out.normals, point);
    put(out.positions, i, point.position);
    put(out.du, i, point.du);
    put(out.dv, i, point.dv);
    if (out.normals)
        evaluate_normal(face, u, v, point, out.normals + 3 * i);
}

bool face_exists(const slv_surface *s, int32_t face) {
    return face >= 0 && size_t(face) < s->faces.size();
}

/* OpenSubdiv's throws, if any, and the standard library's. */
template <typename Body> slv_result guarded(const slv_env *env, Body body) {
    try {
        return body();
    } catch (const std::bad_alloc &) {
        return slvi_fail(env, SLV_ERROR_MEMORY, "surface: out of memory");
    } catch (...) {
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED, "surface: OpenSubdiv gave up");
    }
}

} // namespace

slv_result slv_surface_create(const slv_env *env, const slv_mesh *mesh,
                              const slv_surface_params *params, slv_surface **out) {
    *out = nullptr;
    slv_surface_params chosen = {};
    if (params) {
        /* C may put any number into an enumeration; in C++ even looking at it as one is undefined.
         */
        int scheme, boundary;
        static_assert(sizeof scheme == sizeof params->scheme &&
                          sizeof boundary == sizeof params->boundary,
                      "enumerations are ints");
        std::memcpy(&scheme, &params->scheme, sizeof scheme);
        std::memcpy(&boundary, &params->boundary, sizeof boundary);
        if (scheme < 0 || scheme > SLV_SCHEME_BILINEAR || boundary < 0 ||
            boundary > SLV_BOUNDARY_EDGE_AND_CORNER)
            return slvi_fail(env, SLV_ERROR_ARGUMENT,
                             "surface: unknown scheme %d or boundary rule %d", scheme, boundary);
        chosen = *params;
    }
    if (chosen.boundary == SLV_BOUNDARY_DEFAULT)
        chosen.boundary = slv_mesh_get_view(mesh)->boundary;
    if (chosen.boundary == SLV_BOUNDARY_NONE)
        slvi_logf(env, SLV_LOG_WARNING,
                  "surface: boundary rule 'none' leaves faces without a limit, edge-and-corner is "
                  "used instead");
    return guarded(env, [&]() -> slv_result {
        std::unique_ptr<slv_surface> s(new slv_surface());
        s->env = slvi_env_or_default(env);
        s->scheme = chosen.scheme;
        s->boundary = chosen.boundary;
        copy_mesh(mesh, s.get());
        if (chosen.scheme == SLV_SCHEME_CATMARK) {
            slv_result result = build_patches(env, mesh, s.get());
            if (result)
                return result;
        }
        *out = s.release();
        return SLV_OK;
    });
}

void slv_surface_destroy(slv_surface *surface) {
    delete surface;
}

uint32_t slv_surface_face_count(const slv_surface *surface) {
    return uint32_t(surface->faces.size());
}

slv_result slv_surface_evaluate(const slv_surface *surface, size_t count,
                                const slv_surface_point *points, const slv_surface_arrays *out) {
    return guarded(&surface->env, [&]() -> slv_result {
        Prepared face;
        int64_t prepared = INT64_MIN; /* no face has this number */
        for (size_t i = 0; i < count; i++) {
            if (points[i].face != prepared) {
                if (!face_exists(surface, points[i].face))
                    return slvi_fail(&surface->env, SLV_ERROR_ARGUMENT,
                                     "surface: point %zu is on face %d of %zu", i, points[i].face,
                                     surface->faces.size());
                prepared = points[i].face;
                prepare_face(*surface, prepared, face);
            }
            evaluate_into(face, points[i].u, points[i].v, *out, i);
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

slv_result slv_surface_osd_adjacency(const slv_surface *surface, slv_face_adjacency *out) {
    return guarded(&surface->env, [&]() -> slv_result {
        for (size_t f = 0; f < surface->faces.size(); f++)
            for (int e = 0; e < 4; e++) {
                out[f].face[e] = SLV_BOUNDARY;
                out[f].edge[e] = 0;
            }
        Topology topology;
        leave_out_bad(*surface, topology);
        make_refiner(*surface, surface->verts.data(), surface->positions.size() / 3, topology);
        if (!topology.refiner)
            return slvi_fail(&surface->env, SLV_ERROR_UNSUPPORTED,
                             "surface: the mesh is beyond OpenSubdiv's limits");
        Far::PtexIndices ptex(*topology.refiner);
        /* Its numbers count only the polygons that it was given. */
        std::vector<int32_t> ours;
        for (int poly : topology.poly_of)
            for (int32_t k = 0;
                 k < (surface->sizes[size_t(poly)] == 4 ? 1 : surface->sizes[size_t(poly)]); k++)
                ours.push_back(surface->poly_face[size_t(poly)] + k);
        for (int32_t f : ours) {
            slv_mesh_face face = surface->faces[size_t(f)];
            int faces[4], edges[4];
            ptex.GetAdjacency(*topology.refiner, topology.osd_face[size_t(face.poly)],
                              face.sub < 0 ? 0 : face.sub, faces, edges);
            for (int e = 0; e < 4; e++) {
                out[f].face[e] = faces[e] < 0 ? SLV_BOUNDARY : ours[size_t(faces[e])];
                out[f].edge[e] = faces[e] < 0 ? 0 : uint8_t(edges[e] & 3);
            }
        }
        return SLV_OK;
    });
}
