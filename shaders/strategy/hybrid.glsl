// Traverse where texels are larger than pixels, discard where they are smaller.
#include "lookup/vectors.glsl"
#include "lookup/interface.glsl"
#include "lookup/footprint.glsl"
#include "lookup/coverage.glsl"
#include "lookup/links.glsl"
#include "lookup/fetch.glsl"
#include "lookup/across.glsl"
#include "lookup/reach.glsl"
#include "lookup/corner_values.glsl"
#include "lookup/join.glsl"
#include "lookup/visit.glsl"

const float SLV_HYBRID_RANGE = 0.5; // levels over which one goes over into the other

vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {
    vec2 size = slv_face_size(face);
    uv = slv_inside(uv);
    slv_footprint f = slv_footprint_at(size, uv, dx, dy);
    float crossing = clamp(1.0 - f.level / SLV_HYBRID_RANGE, 0.0, 1.0);
    bvec4 edges = slv_reached_edges(size, uv, f);
    edges = crossing > 0.0 ? edges : bvec4(false);
    slv_sums sum = slv_no_sums();
    vec4 value = slv_visit(face, size, uv, f, edges, sum);
    return slv_value(mix(slv_resolve(sum.own), value, crossing));
}
