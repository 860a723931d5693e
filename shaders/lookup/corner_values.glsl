// What faces agree on where they meet, from a table. (Needs interface.glsl.)

// For each of the strategy's corners a value for each of its levels, the next corner's after the last.
layout(std430, binding = SLV_FIRST_STORAGE + 3) readonly buffer slv_corner_block {
    vec4 slv_corner[];
};
