// The face and each neighbour that the footprint reaches, colour over coverage (McDonald 2013).
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

vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {
    vec2 size = slv_face_size(face);
    uv = slv_inside(uv);
    slv_footprint f = slv_footprint_at(size, uv, dx, dy);
    slv_sums sum = slv_no_sums();
    return slv_value(slv_visit(face, size, uv, f, slv_reached_edges(size, uv, f), sum));
}
