// Samples lie on the edges of faces, where both faces have the same ones.
#define SLV_EDGE_TAP 0.25
#include "lookup/interface.glsl"
#include "lookup/footprint.glsl"
#include "lookup/packed.glsl"

// A lookup of the value on the edge depends on the samples there only, which both faces share. So that this holds for a row of
// taps too, none leaves the face, and the row grows narrower across an edge as it comes near.
vec4 slv_packed_level(float layer, vec4 rect, int level, vec2 size, vec2 uv, slv_footprint f) {
#if SLV_ANISOTROPY == 1
    return textureLod(slv_pool[0], vec3(uv * rect.xy + rect.zw, layer), 0.0);
#else
    vec2 fit = min(vec2(1.0), min(uv, 1.0 - uv) / max(0.5 * abs(f.axis), vec2(1e-12)));
    vec4 sum = vec4(0.0);
    int k = 1;
    do {
        vec2 at = slv_inside(uv + slv_tap_offset(f, k) * fit);
        sum += textureLod(slv_pool[0], vec3(at * rect.xy + rect.zw, layer), 0.0);
    } while (++k <= f.taps);
    return sum / float(f.taps);
#endif
}
