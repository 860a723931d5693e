// What lies beyond the boundary of a texture that is black there. (Comes last, after footprint.glsl.)
//
// Strategies repeat a face's outermost texels beyond its boundary, or leave that out of what they divide by, which is the same.
// So as much of a value has to go as the filter has weight there.
#undef slv_sample_grad

// The part of a row of taps at a level of so many texels that lies on this side of the edges that are asked for.
float slv_lit_level(vec2 texels, bvec4 edges, vec2 uv, slv_footprint f) {
    float sum = 0.0;
    int k = 1;
    do {
        vec2 at = uv + slv_tap_offset(f, k);
        vec2 low = clamp(at * texels + 0.5, 0.0, 1.0), high = clamp((1.0 - at) * texels + 0.5, 0.0, 1.0);
        vec4 lit = mix(vec4(1.0), vec4(low.y, high.x, high.y, low.x), edges);
        sum += lit.x * lit.y * lit.z * lit.w;
    } while (++k <= f.taps);
    return sum / float(f.taps);
}

vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {
    vec4 value = slv_sample_repeated(face, uv, dx, dy);
    uint black = slv_store[SLV_ROW(face)].y >> 16;
    vec2 size = slv_face_size(face);
    slv_footprint f = slv_footprint_of(size, dx, dy);
    float coarsest = log2(max(size.x, size.y)), level = clamp(f.level, 0.0, coarsest), fine = floor(level);
    bvec4 edges = notEqual(uvec4(black) & uvec4(1u, 2u, 4u, 8u), uvec4(0u));
    uv = slv_inside(uv);
    float lit = mix(slv_lit_level(max(size * exp2(-fine), 1.0), edges, uv, f),
                    slv_lit_level(max(size * exp2(-min(fine + 1.0, coarsest)), 1.0), edges, uv, f), level - fine);
#if SLV_OWN_ALPHA
    return value * lit;
#else
    return vec4(value.rgb * lit, value.a);
#endif
}
