// The footprint of a lookup. (Needs interface.glsl.)

// What a lookup averages: an anisotropic footprint is a row of isotropic ones along its longer side (the definition of
// EXT_texture_filter_anisotropic).
struct slv_footprint {
    vec2 dx, dy;
    vec2 axis; // the longer side
    int taps;
    float level; // of each tap
    float wide;  // how much longer each is than in a row of taps side by side
};

// Coordinates and derivatives at silhouettes and of degenerate triangles can be anything. What is no number counts as huge.
vec2 slv_bounded(vec2 v) {
    const float huge = 1e9;
    return mix(vec2(huge), v, lessThanEqual(abs(v), vec2(huge)));
}
vec2 slv_inside(vec2 uv) {
    return mix(vec2(0.0), min(uv, 1.0), greaterThanEqual(uv, vec2(0.0)));
}

// What lengths of a face are multiplied by to measure them in texels, of which some level has one to a unit.
vec2 slv_measure(vec2 size) {
#if SLV_EVEN
    return vec2(max(size.x, size.y)); // even levels halve the longer side first, until a face is square
#else
    return size;
#endif
}
// How many texels a level has.
vec2 slv_level_size(vec2 size, float level) {
    vec2 texels = slv_measure(size) * exp2(-level);
#if SLV_EVEN
    texels = min(texels, size);
#endif
    return max(texels, 1.0);
}
// How long those are that `scale` of the finest are as long as, which is 1 or more.
vec2 slv_texel_length(vec2 size, float scale) {
#if SLV_EVEN
    return max(scale / slv_measure(size), 1.0 / size);
#else
    return scale / size;
#endif
}

slv_footprint slv_footprint_of(vec2 size, vec2 dx, vec2 dy) {
    dx = slv_bounded(dx);
    dy = slv_bounded(dy);
    size = slv_measure(size);
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
    return slv_footprint(dx, dy, axis, taps, log2(max(longest / float(taps), 1e-12)), 1.0);
}

// The same in a place of a face. What lies across an edge has other texels, other ends and other faces around its vertices than a row
// of even taps that begins on this side would find. So no row leaves the face, as an edge comes near it grows shorter, and within half
// a tap of it it becomes a single one on the edge, which both faces make alike: at least as long as a part of the footprint, so that
// what is small there does not fall between such taps.
slv_footprint slv_footprint_at(vec2 size, vec2 uv, vec2 dx, vec2 dy) {
    slv_footprint f = slv_footprint_of(size, dx, dy);
#if SLV_EVEN && SLV_ANISOTROPY > 1
#ifdef SLV_EDGE_TAP
    const float least = SLV_EDGE_TAP;
#else
    const float least = 0.5;
#endif
    vec2 inside = min(uv, 1.0 - uv);
    float taps = float(f.taps), row = max(length(f.axis), 1e-12);
    float part = clamp(2.0 * min(inside.x, inside.y) * taps / row, 0.0, 1.0);
    f.axis *= part * min(2.0 * inside / max(abs(f.axis), vec2(1e-12)), vec2(1.0));
    f.wide = mix(max(least * taps, 1.0), 1.0, part);
    f.level += log2(f.wide);
#endif
    return f;
}

// Where tap k = 1.. of a footprint lies, relative to its centre.
vec2 slv_tap_offset(slv_footprint f, int k) {
    return f.axis * (float(k) / float(f.taps + 1) - 0.5);
}

float slv_level(int face, vec2 dx, vec2 dy) {
    vec2 size = slv_face_size(face);
    return clamp(slv_footprint_of(size, dx, dy).level, 0.0, log2(max(size.x, size.y)));
}

// The part of a row of taps at a level of so many texels that lies on this side of some of a face's edges.
float slv_within_level(vec2 texels, bvec4 edges, vec2 uv, slv_footprint f) {
    float sum = 0.0;
    int k = 1;
    do {
        vec2 at = uv + slv_tap_offset(f, k);
        vec2 low = clamp(at * texels + 0.5, 0.0, 1.0), high = clamp((1.0 - at) * texels + 0.5, 0.0, 1.0);
        vec4 parts = mix(vec4(1.0), vec4(low.y, high.x, high.y, low.x), edges);
        sum += parts.x * parts.y * parts.z * parts.w;
    } while (++k <= f.taps);
    return sum / float(f.taps);
}

// The same between levels, of a face of a size.
float slv_within(vec2 size, bvec4 edges, vec2 uv, slv_footprint f) {
    float coarsest = log2(max(size.x, size.y)), level = clamp(f.level, 0.0, coarsest), fine = floor(level);
    return mix(slv_within_level(slv_level_size(size, fine), edges, uv, f),
               slv_within_level(slv_level_size(size, min(fine + 1.0, coarsest)), edges, uv, f), level - fine);
}
