// Visits to all neighbours that a lookup reaches, in the way that suits the processor. (Needs across.glsl, join.glsl.)

// The value of a lookup that crosses `edges`; `sum` starts as slv_no_sums() and has its parts afterwards.
vec4 slv_visit(int face, vec2 size, vec2 uv, slv_footprint f, bvec4 edges, inout slv_sums sum) {
#if SLV_VECTORS
    // the face itself is the first round of the loop, so that fragments away from edges make no other
    uvec2 links = uvec2(0u);
    if (any(edges))
        links = slv_adjacent[SLV_ROW(face)].links;
    slv_reach reach = slv_reach_of(links, edges, uv, slv_extent(size, f));
    reach.pending = SLV_HELPER ? 0u : reach.pending;
    slv_site site = slv_site(0, float(slv_store[SLV_ROW(face)].x >> 16), uv, f, 1.0,
                             (slv_store[SLV_ROW(face)].y >> 20 & 1u) != 0u, size, 0);
    int edge = -1;
    bool more;
    do {
        slv_tap tap = slv_fetch(site);
        if (edge < 0)
            sum.own = tap;
        else
            slv_place(sum, links, reach.corner, edge, tap, site.along);
        more = reach.pending != 0u;
        int visit = findLSB(reach.pending);
        edge = visit & 3;
        reach.pending &= reach.pending - 1u;
        site = slv_neighbour(face, links, edge, visit > 3, uv, f);
    } while (more);
    return slv_total(face, links, size, sum, reach, uv, f);
#else
    sum.own = slv_own(face, uv, f);
    vec4 value = slv_resolve(sum.own);
    if (any(edges)) {
        uvec2 links = slv_adjacent[SLV_ROW(face)].links;
        slv_reach reach = slv_reach_of(links, edges, uv, slv_extent(size, f));
        if (reach.pending != 0u) {
            do {
                int visit = findLSB(reach.pending), edge = visit & 3;
                reach.pending &= reach.pending - 1u;
                slv_site site = slv_neighbour(face, links, edge, visit > 3, uv, f);
                slv_place(sum, links, reach.corner, edge, slv_fetch(site), site.along);
            } while (reach.pending != 0u);
            value = slv_total(face, links, size, sum, reach, uv, f);
        }
    }
    return value;
#endif
}
