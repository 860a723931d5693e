/* What makes surfaces quick to move: polygons with the same topology around them take the same
 * weights, so up to four of them are moved and weighed together. All sums are in OpenSubdiv's
 * order. */
#include "mesh/surface/surface_data.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_map>

extern "C" {
#include "base/parallel.h"
}

namespace slvi_surface {
namespace {

constexpr size_t kMostWeights = size_t(1) << 18; /* of a tree: beyond, they would take megabytes */
constexpr uint64_t kGrain = 16;

using Descriptor = BfrSurface::PointDescriptor;

typedef float Vector __attribute__((vector_size(16)));

Vector load(const float *from) {
    Vector v;
    std::memcpy(&v, from, sizeof v);
    return v;
}

/* Two rows of weights at a time, so that sums wait less for each other. What a row's last vector
 * has beyond its `stride` floats lies where the next row is written, or behind all. */
template <int kVectors>
void weigh(const Weights &w, size_t stride, const float *controls, float *out) {
    const float *row = w.values.data();
    for (uint32_t r = 0; r < w.rows; r += 2, row += 2 * size_t(w.controls), out += 2 * stride) {
        const bool both = r + 1 < w.rows;
        const float *next = both ? row + w.controls : row;
        Vector first[kVectors], second[kVectors];
        for (int k = 0; k < kVectors; k++) {
            Vector at = load(controls + 4 * k);
            first[k] = row[0] * at;
            second[k] = next[0] * at;
        }
        for (uint32_t i = 1; i < w.controls; i++) {
            const float a = row[i], b = next[i];
            for (int k = 0; k < kVectors; k++) {
                Vector at = load(controls + i * stride + 4 * size_t(k));
                first[k] += a * at;
                second[k] += b * at;
            }
        }
        std::memcpy(out, first, sizeof first);
        if (both)
            std::memcpy(out + stride, second, sizeof second);
    }
}

const BfrSurface &surface_of(const slv_surface &s, uint32_t poly) {
    return s.chunks[poly / kChunk].surfaces[s.patches[poly].surface];
}

void move_batch(slv_surface &s, const Batch &batch) {
    const Weights &w = s.weights[batch.weights];
    const size_t stride = 3 * size_t(batch.count);
    float *points = &s.points[batch.points], *out = points + w.controls * stride;
    for (uint32_t k = 0; k < batch.count; k++)
        surface_of(s, batch.polys[k])
            .GatherControlPoints(s.placed.data(), 3, points + 3 * k, Descriptor(3, int(stride)));
    if (w.values.empty())
        surface_of(s, batch.polys[0]).ComputePatchPoints(points, int(stride));
    else if (batch.count == 1)
        weigh<1>(w, stride, points, out);
    else if (batch.count == 2)
        weigh<2>(w, stride, points, out);
    else
        weigh<3>(w, stride, points, out);
}

slv_result move_range(void *user, uint64_t first, uint64_t end) {
    slv_surface &s = *static_cast<slv_surface *>(user);
    for (uint64_t b = first; b < end; b++)
        move_batch(s, s.batches[b]);
    return SLV_OK;
}

struct Finding {
    slv_surface *surface;
    std::vector<uint32_t> polys; /* the first of each tree */
};

/* What OpenSubdiv makes of controls that are 1 in one place each are the weights. They are kept if
 * the points that come of them are OpenSubdiv's own, which they are not where it was compiled to
 * round otherwise. That shows in controls that are no round numbers, as the mesh's own may be. */
void find_weights(const slv_surface &s, uint32_t poly, Weights &w) {
    const BfrSurface &surface = surface_of(s, poly);
    const size_t n = w.controls, all = n + w.rows;
    if (n * w.rows > kMostWeights)
        return;
    std::vector<float> units(all * n, 0), expected(3 * all), own(3 * all + 4);
    for (size_t i = 0; i < n; i++)
        units[i * n + i] = 1;
    surface.ComputePatchPoints(units.data(), int(n));
    w.values.assign(units.begin() + std::ptrdiff_t(n * n), units.end());
    for (size_t i = 0; i < 3 * n; i++)
        own[i] = expected[i] = std::fmod(float(i + 1) * 0.618034f, 1.0f) - 0.5f;
    surface.ComputePatchPoints(expected.data(), 3);
    weigh<1>(w, 3, own.data(), own.data() + 3 * n);
    if (std::memcmp(own.data(), expected.data(), 3 * all * sizeof(float)) != 0)
        w.values.clear();
}

slv_result find_range(void *user, uint64_t first, uint64_t end) {
    Finding &finding = *static_cast<Finding *>(user);
    try {
        for (uint64_t t = first; t < end; t++)
            find_weights(*finding.surface, finding.polys[t], finding.surface->weights[t]);
        return SLV_OK;
    } catch (const std::bad_alloc &) {
        return SLV_ERROR_MEMORY;
    } catch (...) {
        return SLV_ERROR_UNSUPPORTED;
    }
}

/* Numbers the trees as polygons meet them, and fills each tree's batches one after the other.
 * Returns how many floats their points are. */
size_t gather(slv_surface &s, const std::vector<const void *> &trees, Finding &finding) {
    std::unordered_map<const void *, uint32_t> numbers;
    std::vector<std::vector<uint32_t>> polys;
    for (uint32_t p = 0; p < trees.size(); p++) {
        if (!trees[p])
            continue;
        uint32_t number = numbers.emplace(trees[p], uint32_t(polys.size())).first->second;
        if (number == polys.size()) {
            const BfrSurface &surface = surface_of(s, p);
            Weights weights;
            weights.controls = uint32_t(surface.GetNumControlPoints());
            weights.rows = uint32_t(surface.GetNumPatchPoints()) - weights.controls;
            s.weights.push_back(weights);
            finding.polys.push_back(p);
            polys.emplace_back();
        }
        polys[number].push_back(p);
    }
    size_t points = 0;
    for (uint32_t t = 0; t < polys.size(); t++)
        for (size_t first = 0; first < polys[t].size(); first += kLanes) {
            Batch batch = {};
            batch.count = uint32_t(std::min<size_t>(kLanes, polys[t].size() - first));
            batch.weights = t;
            batch.points = points;
            for (uint32_t k = 0; k < batch.count; k++) {
                Patch &patch = s.patches[batch.polys[k] = polys[t][first + k]];
                patch.lanes = uint8_t(batch.count);
                patch.points = points + 3 * k;
            }
            points += 3 * batch.count * size_t(s.weights[t].controls + s.weights[t].rows) + 4;
            s.batches.push_back(batch);
        }
    return points;
}

void make_units(slv_surface &s) {
    auto end_of = [&](uint32_t poly) {
        return poly + 1 < s.poly_face.size() ? s.poly_face[poly + 1] : int32_t(s.faces.size());
    };
    for (const Batch &batch : s.batches)
        for (int32_t f = s.poly_face[batch.polys[0]]; f < end_of(batch.polys[0]); f++) {
            Unit unit = {};
            unit.count = batch.count;
            for (uint32_t k = 0; k < batch.count; k++)
                unit.faces[k] = f - s.poly_face[batch.polys[0]] + s.poly_face[batch.polys[k]];
            s.units.push_back(unit);
        }
    for (size_t f = 0; f < s.faces.size(); f++)
        if (!s.patches[size_t(s.faces[f].poly)].lanes)
            s.units.push_back({{int32_t(f)}, 1});
}

} // namespace

slv_result make_batches(const slv_env *env, slv_surface &s, const std::vector<const void *> &trees,
                        uint64_t bytes) {
    Finding finding;
    finding.surface = &s;
    const size_t points = gather(s, trees, finding);
    bytes += points * sizeof(float);
    for (const Weights &w : s.weights)
        if (uint64_t(w.controls) * w.rows <= kMostWeights)
            bytes += uint64_t(w.controls) * w.rows * sizeof(float);
    slv_result result = SLV_ERROR_LIMIT;
    if (bytes <= s.env.max_bytes) {
        s.points.resize(points);
        result = slvi_parallel_for(env, s.weights.size(), 1, find_range, &finding);
    }
    if (result)
        return slvi_fail(env, result, "surface: could not be prepared: %s",
                         slv_result_string(result));
    make_units(s);
    return move_batches(s);
}

slv_result move_batches(slv_surface &s) {
    return slvi_parallel_for(&s.env, s.batches.size(), kGrain, move_range, &s);
}

} // namespace slvi_surface

using namespace slvi_surface;

uint32_t slvi_surface_unit_count(const slv_surface *surface) {
    return uint32_t(surface->units.empty() ? surface->faces.size() : surface->units.size());
}

uint32_t slvi_surface_unit(const slv_surface *surface, uint32_t unit,
                           int32_t faces[SLVI_UNIT_FACES]) {
    if (surface->units.empty()) {
        faces[0] = int32_t(unit);
        return 1;
    }
    const Unit &chosen = surface->units[unit];
    std::copy_n(chosen.faces, chosen.count, faces);
    return chosen.count;
}
