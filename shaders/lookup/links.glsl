// Which faces are across the edges of a face. (Needs interface.glsl.)

// Per face, 16 bits for each edge, edges 0 and 1 in the first word:
//   bits 0-1   the adjacent edge
//   bits 2-3   kind: 0 boundary, 1 like to like, 2 whole quad to sub-faces, 3 sub-face to whole quad
//   bit 4      kind 2: there are two; kind 3: this is the second half of the whole quad's edge
//   bits 5-6   the second sub-face's edge
//   bit 13     texels are of one size on both sides at the edge's start; bit 15 the same at its end
//   bit 14     the edge starts in the middle of a whole quad's edge: what lies across continues
//              straight past the corner, and nothing is missing there
// then for each edge where the face across it has its texels, and the second of two sub-faces:
//   bits 0-15   layer
//   bits 16-20  log2 of the width, bits 21-25 of the height
//   bits 26-29  pool
//   bit 30      the face has one texel for all
// and for each corner where its values are (corner_values.glsl). Software drivers read word for word: only what is needed is read.
struct slv_links {
    uvec2 links, unused;
    uvec4 across, beside, corners;
};
layout(std430, binding = SLV_FIRST_STORAGE + 1) readonly buffer slv_links_block {
    slv_links slv_adjacent[];
};

vec2 slv_size_at(uint there) {
    return vec2(float(1u << (there >> 16 & 31u)), float(1u << (there >> 21 & 31u)));
}

uint slv_link(uvec2 links, int edge) {
    uint word = edge < 2 ? links.x : links.y;
    return (edge & 1) == 0 ? word & 0xffffu : word >> 16;
}

bool slv_linked(uvec2 links, int edge) {
    return (slv_link(links, edge) & 12u) != 0u;
}

bool slv_same_at(uvec2 links, int edge, bool at_start) {
    return (slv_link(links, edge) & (at_start ? 0x2000u : 0x8000u)) != 0u;
}
bool slv_same_texels(uvec2 links, int edge) {
    return (slv_link(links, edge) & 0xa000u) == 0xa000u;
}
