/* Inside an slv_surface: what topology, patches and evaluation share. C++ behind a C header:
 * nothing thrown leaves the folder. */
#ifndef SLV_MESH_SURFACE_DATA_H
#define SLV_MESH_SURFACE_DATA_H

#include <selvage/surface.h>

#include <memory>
#include <mutex>
#include <new>
#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/bfr/surfaceFactoryCache.h>
#include <opensubdiv/far/topologyRefiner.h>
#include <shared_mutex>
#include <vector>

#include "mesh/surface/surface_units.h"

extern "C" {
#include "base/log.h"
#include "mesh/mesh_data.h"
}

namespace slvi_surface {

namespace Bfr = OpenSubdiv::Bfr;
namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

constexpr uint32_t kChunk = 256; /* polygons prepared and stored together */
constexpr uint32_t kLanes =
    SLVI_UNIT_FACES; /* polygons at most whose points are moved and weighed together */

using BfrSurface = Bfr::Surface<float>;

/* How the limit of a polygon is found. */
enum class Kind : uint8_t { bilinear, regular, irregular, triangle };

struct Patch {
    Kind kind = Kind::bilinear;
    uint8_t open = 0;     /* regular: a bit for each side whose points lie beyond a boundary */
    uint8_t lanes = 0;    /* if not 0: points are among the surface's, those of so many together */
    uint32_t surface = 0; /* which of the chunk's; regular: of its controls */
    size_t points = 0;    /* where in the chunk's points, or the surface's */
};

struct Chunk {
    std::vector<float> points;
    std::vector<BfrSurface> surfaces;
    std::vector<int> controls; /* of a surface that moves: 16 vertices a regular polygon */
};

/* A polygon's centre, and how far it reaches along any axis. */
struct Middle {
    float centre[3] = {0, 0, 0}, extent = 0;
};

/* How the points of all polygons with the same topology around them follow from their controls: a
 * row of weights for each point behind the controls. */
struct Weights {
    uint32_t controls = 0, rows = 0;
    std::vector<float> values; /* none: OpenSubdiv is asked each time */
};

/* Polygons with the same weights. Their points alternate: the first of each, the second of each. */
struct Batch {
    uint32_t polys[kLanes], count, weights;
    size_t points; /* where in the surface's */
};

/* Faces of a batch, or one face. */
struct Unit {
    int32_t faces[kLanes];
    uint32_t count;
};

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
    std::vector<uint32_t> origin; /* per position the mesh's vertex */
    std::unique_ptr<Far::TopologyRefiner> refiner;
};

/* surface_topology.cpp */
/* What OpenSubdiv can be given of a mesh, cut where it is not manifold. */
slv_result make_manifold(const slv_env *env, const slv_mesh *mesh, const slv_surface &s,
                         Topology &out);

/* surface_batches.cpp */
/* Puts polygons together whose patches are the same (`trees`, one a polygon, NULL: by itself),
 * finds their weights. `bytes` is what the surface takes already. */
slv_result make_batches(const slv_env *env, slv_surface &s, const std::vector<const void *> &trees,
                        uint64_t bytes);
/* Gives all batches their points anew. */
slv_result move_batches(slv_surface &s);

/* Calls a function of slv_result; OpenSubdiv's throws, if any, and the standard library's become
 * results. */
template <typename Body> slv_result guarded(const slv_env *env, Body body) {
    try {
        return body();
    } catch (const std::bad_alloc &) {
        return slvi_fail(env, SLV_ERROR_MEMORY, "surface: out of memory");
    } catch (...) {
        return slvi_fail(env, SLV_ERROR_UNSUPPORTED, "surface: OpenSubdiv gave up");
    }
}

} // namespace slvi_surface

struct slv_surface {
    slv_env env;
    slv_scheme scheme;
    slv_boundary boundary;
    std::vector<slv_mesh_face> faces;
    std::vector<int32_t> sizes, verts, poly_face;
    std::vector<uint32_t> first;
    std::vector<float> positions;
    std::vector<slvi_surface::Middle> middles; /* of the polygons */
    std::vector<slvi_surface::Patch> patches;  /* per polygon; none for the bilinear scheme */
    std::vector<slvi_surface::Chunk> chunks;
    bool moves;
    std::vector<uint32_t> origin; /* if it moves: of OpenSubdiv's vertices the mesh's, */
    std::vector<float> placed;    /* and where they are */
    std::vector<slvi_surface::Weights> weights;
    std::vector<slvi_surface::Batch> batches;
    std::vector<slvi_surface::Unit> units;
    std::vector<float> points; /* of the batches */
};

#endif
