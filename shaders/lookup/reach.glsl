// Which neighbours a lookup has to visit. (Needs links.glsl, fetch.glsl.)

// Which edges a footprint crosses, and how far from them taps still leave the face: the row of taps, and half a texel of the coarser
// level.
struct slv_reach {
    bvec4 edges;
    vec2 extent;
    int corner;   // the nearest; its own edge and the one before meet there
    uint pending; // visits still to make: bit e across edge e, bit 4 + e to the second of two sub-faces there
};

// How far from its centre a footprint averages.
vec2 slv_extent(vec2 size, slv_footprint f) {
    return slv_spread(f) * abs(f.axis) + 0.5 * slv_texel_length(size, exp2(ceil(max(f.level, 0.0))));
}

bvec4 slv_reached_edges(vec2 size, vec2 uv, slv_footprint f) {
#if SLV_TAPS || SLV_ANISOTROPY == 1
    vec2 reach = 1.002 * slv_extent(size, f);
#else
    vec2 reach = 0.5 * abs(f.axis) + slv_texel_length(size, exp2(ceil(max(f.level, 0.0))));
#endif
    bvec2 low = lessThan(uv, reach), high = greaterThan(uv, 1.0 - reach);
    return bvec4(low.y, high.x, high.y, low.x);
}

slv_reach slv_reach_of(uvec2 links, bvec4 edges, vec2 uv, vec2 extent) {
    slv_reach reach = slv_reach(edges, extent, uv.y < 0.5 ? (uv.x < 0.5 ? 0 : 1) : (uv.x < 0.5 ? 3 : 2), 0u);
    for (int e = 0; e < 4; e++) {
        if (edges[e] && slv_linked(links, e)) {
            reach.pending |= 1u << e;
#if SLV_SUBFACES
            if ((slv_link(links, e) >> 2 & 7u) == 6u)
                reach.pending |= 16u << e;
#endif
        }
    }
    return reach;
}
