/* Surfaces made, and moved: every polygon is prepared once. Regular ones become sixteen B-spline
 * points, others a surface of OpenSubdiv's Bfr with its points. */
#include "mesh/surface/surface_data.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>

extern "C" {
#include "base/parallel.h"
}

namespace slvi_surface {
namespace {

constexpr int kSmoothLevel = 3, kSharpLevel = 8;

using Cache =
    Bfr::SurfaceFactoryCacheThreaded<std::shared_mutex, std::shared_lock<std::shared_mutex>,
                                     std::unique_lock<std::shared_mutex>>;
using Factory = Bfr::RefinerSurfaceFactory<Cache>;

/* The trees of patches that polygons with the same topology around them share. */
class Trees : public Cache {
  public:
    using Cache::Add;
    using Cache::DataType;
    using Cache::Find;
    using Cache::KeyType;
};

/* Hands on to the shared ones, and says which tree it was that a polygon was given. */
class Witness : public Bfr::SurfaceFactoryCache {
  public:
    explicit Witness(Trees &trees) : trees_(trees) {
    }
    mutable const void *last = nullptr;

  protected:
    DataType Find(KeyType const &key) const override {
        return seen(trees_.Find(key));
    }
    DataType Add(KeyType const &key, DataType const &data) override {
        return seen(trees_.Add(key, data));
    }

  private:
    DataType seen(DataType tree) const {
        last = tree.get();
        return tree;
    }
    Trees &trees_;
};

enum Side : uint8_t { kBottom = 1, kTop = 2, kLeft = 4, kRight = 8 };

/* OpenSubdiv leaves the points beyond a boundary out of a regular patch. Which rows are left out
 * shows in the weights of the patch's middle. */
uint8_t open_sides(const BfrSurface &surface) {
    static const float middle[2] = {0.5f, 0.5f};
    float weights[16];
    surface.EvaluateStencil(middle, weights);
    auto missing = [&](int at, int step) {
        return weights[at] == 0 && weights[at + step] == 0 && weights[at + 2 * step] == 0 &&
               weights[at + 3 * step] == 0;
    };
    return uint8_t((missing(0, 1) ? kBottom : 0) | (missing(12, 1) ? kTop : 0) |
                   (missing(0, 4) ? kLeft : 0) | (missing(3, 4) ? kRight : 0));
}

/* As linear extrapolations points beyond a boundary make an ordinary patch. */
void place_regular(const int controls[16], uint8_t open, const float *positions, float *out) {
    float p[4][4][3];
    for (int i = 0; i < 16; i++)
        std::copy(positions + 3 * size_t(controls[i]), positions + 3 * size_t(controls[i]) + 3,
                  p[i / 4][i % 4]);
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++) {
            if (open & kBottom)
                p[0][i][c] = 2 * p[1][i][c] - p[2][i][c];
            if (open & kTop)
                p[3][i][c] = 2 * p[2][i][c] - p[1][i][c];
        }
    for (int i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++) {
            if (open & kLeft)
                p[i][0][c] = 2 * p[i][1][c] - p[i][2][c];
            if (open & kRight)
                p[i][3][c] = 2 * p[i][2][c] - p[i][1][c];
        }
    std::copy(&p[0][0][0], &p[0][0][0] + 48, out);
}

struct Build {
    slv_surface *surface;
    const Topology *topology;
    Trees trees;
    std::vector<const void *> tree; /* of a surface that moves: of each polygon, or none */
    uint64_t max_bytes;
    std::atomic<uint64_t> bytes{0};
    std::atomic<uint32_t> refused{0};
};

void prepare_polygon(Build &build, const Factory &factory, const Witness &witness, uint32_t poly,
                     Chunk &chunk) {
    Patch &patch = build.surface->patches[poly];
    int face = build.topology->osd_face[poly];
    BfrSurface surface;
    witness.last = nullptr;
    if (build.topology->refused[poly] || !factory.InitVertexSurface(face, &surface)) {
        build.refused++;
        return;
    }
    patch.points = chunk.points.size();
    if (build.surface->scheme == SLV_SCHEME_CATMARK && surface.IsRegular() &&
        surface.GetNumControlPoints() == 16) {
        int controls[16];
        patch.kind = Kind::regular;
        patch.open = open_sides(surface);
        surface.GetControlPointIndices(controls);
        chunk.points.resize(patch.points + 48);
        place_regular(controls, patch.open, build.topology->positions.data(),
                      &chunk.points[patch.points]);
        if (build.surface->moves) {
            patch.surface = uint32_t(chunk.controls.size() / 16);
            chunk.controls.insert(chunk.controls.end(), controls, controls + 16);
        }
        return;
    }
    patch.kind = build.surface->scheme == SLV_SCHEME_LOOP ? Kind::triangle : Kind::irregular;
    patch.surface = uint32_t(chunk.surfaces.size());
    chunk.surfaces.push_back(surface);
    if (build.surface->moves && witness.last) {
        build.tree[poly] = witness.last;
        return;
    }
    chunk.points.resize(patch.points + 3 * size_t(surface.GetNumPatchPoints()));
    surface.PreparePatchPoints(build.topology->positions.data(), 3, &chunk.points[patch.points], 3);
}

slv_result prepare_range(void *user, uint64_t first, uint64_t end) {
    Build &build = *static_cast<Build *>(user);
    try {
        Chunk &chunk = build.surface->chunks[first / kChunk];
        Witness witness(build.trees);
        Factory::Options options;
        options.SetApproxLevelSmooth(kSmoothLevel)
            .SetApproxLevelSharp(kSharpLevel)
            .SetExternalCache(&witness);
        Factory factory(*build.topology->refiner, options);
        for (uint64_t p = first; p < end; p++)
            prepare_polygon(build, factory, witness, uint32_t(p), chunk);
        chunk.points.shrink_to_fit();
        chunk.surfaces.shrink_to_fit();
        chunk.controls.shrink_to_fit();
        uint64_t size = chunk.points.size() * sizeof(float) + chunk.controls.size() * sizeof(int) +
                        chunk.surfaces.size() * sizeof(BfrSurface);
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
    if (s->moves)
        build.tree.assign(npolys, nullptr);
    if (topology.refiner) {
        if ((result = slvi_parallel_for(env, npolys, kChunk, prepare_range, &build)))
            return slvi_fail(env, result, "surface: could not be prepared: %s",
                             slv_result_string(result));
    } else {
        build.refused = uint32_t(npolys);
    }
    if (s->moves) {
        s->origin.swap(topology.origin);
        s->placed.swap(topology.positions);
        if ((result = make_batches(env, *s, build.tree, build.bytes)))
            return result;
    }
    if (build.refused)
        slvi_logf(env, SLV_LOG_WARNING,
                  "surface: OpenSubdiv has no limit for %u polygon(s), they stay flat",
                  build.refused.load());
    return SLV_OK;
}

/* Once for each polygon, and not for each of its sub-faces: polygons may have many sides. */
void find_middles(slv_surface *s) {
    s->middles.assign(s->sizes.size(), Middle());
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

slv_result move_range(void *user, uint64_t first, uint64_t end) {
    slv_surface &s = *static_cast<slv_surface *>(user);
    Chunk &chunk = s.chunks[first / kChunk];
    for (uint64_t p = first; p < end; p++) {
        const Patch &patch = s.patches[p];
        if (patch.kind == Kind::bilinear || patch.lanes)
            continue;
        float *points = &chunk.points[patch.points];
        if (patch.kind == Kind::regular)
            place_regular(&chunk.controls[16 * size_t(patch.surface)], patch.open, s.placed.data(),
                          points);
        else
            chunk.surfaces[patch.surface].PreparePatchPoints(s.placed.data(), 3, points, 3);
    }
    return SLV_OK;
}

} // namespace
} // namespace slvi_surface

using namespace slvi_surface;

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
        if (scheme < 0 || scheme > SLV_SCHEME_LOOP || boundary < 0 ||
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
        s->moves = chosen.moves;
        copy_mesh(mesh, s.get());
        for (size_t p = 0; chosen.scheme == SLV_SCHEME_LOOP && p < s->sizes.size(); p++)
            if (s->sizes[p] != 3)
                return slvi_fail(env, SLV_ERROR_UNSUPPORTED,
                                 "surface: polygon %zu has %d vertices, and the Loop scheme is of "
                                 "triangles only",
                                 p, int(s->sizes[p]));
        if (chosen.scheme != SLV_SCHEME_BILINEAR) {
            slv_result result = build_patches(env, mesh, s.get());
            if (result)
                return result;
        }
        *out = s.release();
        return SLV_OK;
    });
}

slv_result slv_surface_move(slv_surface *surface, uint32_t nverts, const float *positions) {
    slv_surface &s = *surface;
    if (!s.moves || nverts != s.positions.size() / 3)
        return slvi_fail(&s.env, SLV_ERROR_ARGUMENT,
                         "surface: %u positions for a surface of %zu vertices%s", nverts,
                         s.positions.size() / 3, s.moves ? "" : ", which was not made to be moved");
    for (size_t i = 0; i < 3 * size_t(nverts); i++)
        if (!std::isfinite(positions[i]))
            return slvi_fail(&s.env, SLV_ERROR_ARGUMENT, "surface: vertex %zu is nowhere", i / 3);
    std::copy(positions, positions + 3 * size_t(nverts), s.positions.begin());
    find_middles(&s);
    for (size_t v = 0; v < s.origin.size(); v++)
        std::copy(positions + 3 * size_t(s.origin[v]), positions + 3 * size_t(s.origin[v]) + 3,
                  &s.placed[3 * v]);
    slv_result result = slvi_parallel_for(&s.env, s.patches.size(), kChunk, move_range, &s);
    return result ? result : move_batches(s);
}

void slv_surface_destroy(slv_surface *surface) {
    delete surface;
}

uint32_t slv_surface_face_count(const slv_surface *surface) {
    return uint32_t(surface->faces.size());
}
