// The same values as traverse from the plain form of it, which traverse is measured against.
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

vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {
    uvec2 links = slv_adjacent[SLV_ROW(face)].links;
    vec2 size = slv_face_size(face);
    uv = slv_inside(uv);
    slv_footprint f = slv_footprint_at(size, uv, dx, dy);
    slv_sums sum = slv_no_sums();
    sum.own = slv_own(face, uv, f);
    slv_reach reach = slv_reach_of(links, slv_reached_edges(size, uv, f), uv, slv_extent(size, f));
    while (reach.pending != 0u) {
        int visit = findLSB(reach.pending), edge = visit & 3;
        reach.pending &= reach.pending - 1u;
        slv_site site = slv_neighbour(face, links, edge, visit > 3, uv, f);
        slv_place(sum, links, reach.corner, edge, slv_fetch(site), site.along);
    }
    return slv_value(slv_total(face, links, size, sum, reach, uv, f));
}
