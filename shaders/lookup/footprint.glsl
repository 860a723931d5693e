// The footprint of a lookup. (Needs interface.glsl.)

// What a lookup averages: an anisotropic footprint is a row of isotropic ones along its longer side (the definition of
// EXT_texture_filter_anisotropic).
struct slv_footprint {
    vec2 dx, dy;
    vec2 axis; // the longer side
    int taps;
    float level; // of each tap
};

// Coordinates and derivatives at silhouettes and of degenerate triangles can be anything. What is no number counts as huge.
vec2 slv_bounded(vec2 v) {
    const float huge = 1e9;
    return mix(vec2(huge), v, lessThanEqual(abs(v), vec2(huge)));
}
vec2 slv_inside(vec2 uv) {
    return mix(vec2(0.0), min(uv, 1.0), greaterThanEqual(uv, vec2(0.0)));
}

slv_footprint slv_footprint_of(vec2 size, vec2 dx, vec2 dy) {
    dx = slv_bounded(dx);
    dy = slv_bounded(dy);
    float px = length(dx * size), py = length(dy * size);
    float longest = max(px, py), shortest = min(px, py);
    int taps = int(clamp(ceil(longest / max(shortest, 1e-12)), 1.0, float(SLV_ANISOTROPY)));
    vec2 axis = px > py ? dx : dy;
#if SLV_TAPS
#ifndef SLV_KEEPS_ROW
    // Within a quarter of a texel a row changes next to nothing. It would be another one for a neighbour whose texels have another
    // shape, and show at the edge.
    float row = clamp(4.0 * longest - 1.0, 0.0, 1.0);
    axis *= row;
    taps = row > 0.0 ? taps : 1;
#endif
    taps |= 1; // an odd number has one in the centre, which the face cannot miss however small it is
#if SLV_VECTORS
    taps = SLV_HELPER ? 1 : taps;
#endif
#endif
    return slv_footprint(dx, dy, axis, taps, log2(max(longest / float(taps), 1e-12)));
}

// Where tap k = 1.. of a footprint lies, relative to its centre.
vec2 slv_tap_offset(slv_footprint f, int k) {
    return f.axis * (float(k) / float(f.taps + 1) - 0.5);
}

float slv_level(int face, vec2 dx, vec2 dy) {
    vec2 size = slv_face_size(face);
    return clamp(slv_footprint_of(size, dx, dy).level, 0.0, log2(max(size.x, size.y)));
}
