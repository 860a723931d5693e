// Levels side by side in one layer, each looked up by itself. (Needs footprint.glsl.)

const int SLV_LEVELS = 17; // room for 65536 x 65536

// Per pool and level: the part of a layer that the level's texels fill without their border, as scale and offset; with
// edge-aligned samples, the part from the first sample's centre to the last's.
layout(std430, binding = SLV_FIRST_STORAGE + 2) readonly buffer slv_rect_block {
    vec4 slv_rect[];
};

vec4 slv_packed_level(uint pool, float layer, int level, vec2 size, vec2 uv, slv_footprint f); // the strategy's own

vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {
    uvec2 store = slv_store[SLV_ROW(face)];
    uint pool = store.x & 0xffffu;
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
    float coarsest = log2(max(size.x, size.y));
    float level = clamp(f.level, 0.0, coarsest);
    float fine = floor(level);
    vec4 a = slv_packed_level(pool, layer, int(fine), size, uv, f);
    vec4 b = slv_packed_level(pool, layer, int(min(fine + 1.0, coarsest)), size, uv, f);
    return slv_value(mix(a, b, level - fine));
}
