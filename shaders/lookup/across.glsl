// A lookup continued in the face across an edge. (Needs links.glsl, fetch.glsl.)

vec2 slv_edge_origin(int edge) { // the corner where the edge starts
    return vec2(edge == 1 || edge == 2 ? 1.0 : 0.0, edge > 1 ? 1.0 : 0.0);
}

// A lookup in a neighbour; `scale` is the edge's length in units of the neighbour's and `end` where, along the neighbour's edge,
// this edge starts. Faces are turned against each other by quarters. The taps are this face's, so that the weights of all
// lookups add up to 1; their level is the neighbour's own.
slv_site slv_across(uint there, int edge, int adjacent, float scale, float end, vec2 uv, slv_footprint f) {
    int turns = (adjacent - edge + 2) & 3;
    float c = (turns & 1) != 0 ? 0.0 : turns == 0 ? scale : -scale, s = (turns & 1) == 0 ? 0.0 : turns == 1 ? scale : -scale;
    mat2 across = mat2(c, s, -s, c);
    float signed_end = adjacent < 2 ? end : -end;
    vec2 along = (adjacent & 1) == 0 ? vec2(signed_end, 0.0) : vec2(0.0, signed_end);
    vec2 size = slv_size_at(there);
    f.dx = across * f.dx;
    f.dy = across * f.dy;
    f.axis = across * f.axis;
    vec2 measure = slv_measure(size);
    float texels = max(length(f.dx * measure), length(f.dy * measure)) * f.wide / float(f.taps);
    f.level = log2(max(texels, 1e-12));
    uv = across * (uv - slv_edge_origin(edge)) + slv_edge_origin(adjacent) + along;
    vec2 texel = slv_texel_length(size, max(texels, 1.0));
    vec3 edge_wise = (adjacent & 1) == 0 ? vec3(uv.x, f.axis.x, texel.x) : vec3(uv.y, f.axis.y, texel.y);
    float reach = slv_spread(f) * abs(edge_wise.y) + 0.5 * edge_wise.z;
    return slv_site(int(there >> 26 & 15u), float(there & 0xffffu), uv, f, abs(edge_wise.x - 0.5) > 0.5001 ? 2.0 : min(reach / scale, 1.0),
                    (there >> 30 & 1u) != 0u, size, -turns);
}

// Across one edge; `second` asks for the second of two sub-faces, which lies across the first one's edge before the shared one.
slv_site slv_neighbour(int own, uvec2 links, int edge, bool second, vec2 uv, slv_footprint f) {
    uint link = slv_link(links, edge), there = slv_adjacent[SLV_ROW(own)].across[edge];
    int adjacent = int(link & 3u);
#if SLV_SUBFACES
    uint kind = link >> 2 & 3u;
    float scale = kind == 3u ? 0.5 : kind == 2u ? 2.0 : 1.0;
    float end = kind == 3u && (link & 16u) == 0u ? 0.5 : 1.0;
    if (second) {
        there = slv_adjacent[SLV_ROW(own)].beside[edge];
        adjacent = int(link >> 5 & 3u);
        end = 2.0;
    }
    return slv_across(there, edge, adjacent, scale, end, uv, f);
#else
    return slv_across(there, edge, adjacent, 1.0, 1.0, uv, f);
#endif
}
