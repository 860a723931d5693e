// Which faces are across the edges of a face. (Needs interface.glsl.)

// Per face, for each edge: the face across it; 16 bits a link, edges 0 and 1 in the first word:
//   bits 0-1   the adjacent edge
//   bits 2-3   kind: 0 boundary, 1 like to like, 2 whole quad to sub-faces, 3 sub-face to whole quad
//   bit 4      kind 2: there are two; kind 3: this is the second half of the whole quad's edge
//   bits 5-8   pool of the (first) neighbour
//   bits 9-12  pool of the second
//   bit 13     texels are of one size on both sides at the edge's start; bit 15 the same at its end
//   bit 14     the edge starts in the middle of a whole quad's edge: what lies across continues
//              straight past the corner, and nothing is missing there
struct slv_links {
    int face[4];
    uvec2 links;
    uint corners; // index of the first value of corner 0
    uint levels;
};
layout(std430, binding = SLV_FIRST_STORAGE + 1) readonly buffer slv_links_block {
    slv_links slv_adjacent[];
};

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
