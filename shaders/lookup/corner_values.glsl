// What faces agree on where they meet, from a table. (Needs interface.glsl.)

// For each of the strategy's corners a value for each of its levels, the next corner's after the last.
layout(std430, binding = SLV_FIRST_STORAGE + 3) readonly buffer slv_corner_block {
    vec4 slv_corner[];
};

// Where a corner's values are: the number of the first in 27 bits, and 5 bits that say what the strategy needs.
uint slv_corner_first(uint where) {
    return where & 0x7ffffffu;
}
