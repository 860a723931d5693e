/* What OpenSubdiv is told of a mesh: no polygon that it cannot take, sheets that meet in an edge or
 * vertex taken apart, creases and corners; and its own idea of adjacency. */
#include "mesh/surface/surface_data.h"

#include <algorithm>
#include <opensubdiv/far/ptexIndices.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <tuple>
#include <utility>

namespace slvi_surface {
namespace {

constexpr uint32_t kMostAround =
    512; /* beyond, the time and memory that Bfr takes grow with the square */

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
void make_refiner(const slv_surface &s, Sdc::SchemeType scheme, const int32_t *verts, size_t nverts,
                  Topology &out) {
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
    out.refiner.reset(Refiners::Create(descriptor, Refiners::Options(scheme, options)));
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

} // namespace

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
        out.origin.push_back(uint32_t(fans.origin[v]));
    }
    make_refiner(s, s.scheme == SLV_SCHEME_LOOP ? Sdc::SCHEME_LOOP : Sdc::SCHEME_CATMARK,
                 fans.side_vert, fans.nverts, out);
    return SLV_OK;
}

} // namespace slvi_surface

using namespace slvi_surface;

slv_result slv_surface_osd_adjacency(const slv_surface *surface, slv_face_adjacency *out) {
    return guarded(&surface->env, [&]() -> slv_result {
        for (size_t f = 0; f < surface->faces.size(); f++)
            for (int e = 0; e < 4; e++) {
                out[f].face[e] = SLV_BOUNDARY;
                out[f].edge[e] = 0;
            }
        Topology topology;
        leave_out_bad(*surface, topology);
        make_refiner(*surface, Sdc::SCHEME_CATMARK, surface->verts.data(),
                     surface->positions.size() / 3, topology);
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
