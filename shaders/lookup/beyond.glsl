// What lies beyond the boundary of a texture that is black there. (Comes last, after footprint.glsl.)
//
// Strategies repeat a face's outermost texels beyond its boundary, or leave that out of what they divide by, which is the same.
// So as much of a value has to go as the filter has weight there.
#undef slv_sample_grad

vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {
    vec4 value = slv_sample_repeated(face, uv, dx, dy);
    uint black = slv_store[SLV_ROW(face)].y >> 16 & 15u;
    vec2 size = slv_face_size(face);
    slv_footprint f = slv_footprint_at(size, slv_inside(uv), dx, dy);
    bvec4 edges = notEqual(uvec4(black) & uvec4(1u, 2u, 4u, 8u), uvec4(0u));
    float lit = slv_within(size, edges, slv_inside(uv), f);
#if SLV_OWN_ALPHA
    return value * lit;
#else
    return vec4(value.rgb * lit, value.a);
#endif
}
