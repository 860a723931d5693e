// A face's own texels, which the sampler repeats beyond its edges: every seam shows.
#include "lookup/interface.glsl"
#include "lookup/footprint.glsl"

vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {
    slv_footprint f = slv_footprint_of(slv_face_size(face), dx, dy);
    vec3 p = vec3(slv_inside(uv), float(slv_store[SLV_ROW(face)].x >> 16));
#if SLV_TAPS
    vec4 sum = vec4(0.0);
    int k = 1;
    do {
        sum += textureLod(slv_pool[0], p + vec3(slv_tap_offset(f, k), 0.0), f.level);
    } while (++k <= f.taps);
    return slv_value(sum / float(f.taps));
#else
    return slv_value(textureGrad(slv_pool[0], p, f.dx, f.dy));
#endif
}
