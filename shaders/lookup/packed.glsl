// Levels side by side in one layer, each looked up by itself. (Needs footprint.glsl.)

const int SLV_LEVELS = 17; // room for 65536 x 65536

// Per pool a row for each level: the part of a layer that the level's texels fill without their border, as scale and offset; with
// edge-aligned samples, the part from the first sample's centre to the last's. Of items that share a page as cells of a grid these
// rows are the first cell's, and one more has the grid's columns (0: a layer for each item), its page, and the size of a cell.
layout(std430, binding = SLV_FIRST_STORAGE + 2) readonly buffer slv_rect_block {
    vec4 slv_rect[];
};

// A lookup at one level: `rect` is the part of the layer that it fills.
vec4 slv_packed_level(float layer, vec4 rect, int level, vec2 size, vec2 uv, slv_footprint f); // the strategy's own

vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {
    uvec2 store = slv_store[SLV_ROW(face)];
    int first = int(store.x & 0xffffu) * (SLV_LEVELS + 1);
    float layer = float(store.x >> 16);
    vec2 size = slv_face_size(face);
    uv = slv_inside(uv);
    slv_footprint f = slv_footprint_at(size, uv, dx, dy);
#if SLV_CONSTANTS
    if ((store.y >> 20 & 1u) != 0u) { // one texel for all that lookups here can reach
        size = vec2(1.0);
        uv = vec2(0.5);
        f = slv_footprint(vec2(0.0), vec2(0.0), vec2(0.0), 1, 0.0, 1.0);
    }
#endif
    vec4 cell = vec4(0.0);
#if SLV_SHARED_PAGES
    vec4 grid = slv_rect[first + SLV_LEVELS];
    if (grid.x > 0.0) {
        float row = floor((layer + 0.5) / grid.x);
        cell.zw = vec2(layer - row * grid.x, row) * grid.zw;
        layer = grid.y;
    }
#endif
    float coarsest = log2(max(size.x, size.y));
    float level = clamp(f.level, 0.0, coarsest);
#ifdef SLV_ONE_LEVEL
    level = floor(level + 0.5);
#endif
    float fine = floor(level), coarse = min(fine + 1.0, coarsest);
    vec4 a = slv_packed_level(layer, slv_rect[first + int(fine)] + cell, int(fine), size, uv, f);
#ifdef SLV_ONE_LEVEL
    return slv_value(a);
#else
    vec4 b = slv_packed_level(layer, slv_rect[first + int(coarse)] + cell, int(coarse), size, uv, f);
    return slv_value(mix(a, b, level - fine));
#endif
}
