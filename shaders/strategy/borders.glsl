// Every level has a border of texels from the neighbours, within which a footprint must fit.
#include "lookup/interface.glsl"
#include "lookup/footprint.glsl"
#include "lookup/packed.glsl"

vec4 slv_packed_level(float layer, vec4 rect, int level, vec2 size, vec2 uv, slv_footprint f) {
    vec3 p = vec3(uv * rect.xy + rect.zw, layer);
#if SLV_ANISOTROPY == 1
    return textureLod(slv_pool[0], p, 0.0);
#else
    // the taps must stay inside this level's border: beside it lie other levels
#if SLV_EVEN
    vec2 scale = rect.xy;
#else
    vec2 level_size = slv_level_size(size, float(level));
    vec2 room = min(vec2(SLV_BORDER), level_size) - 0.5078125; // and a little, for coordinates are rounded
    vec2 fit = room / max(0.5 * (abs(f.dx) + abs(f.dy)) * level_size, vec2(1e-12));
    vec2 scale = rect.xy * min(1.0, min(fit.x, fit.y));
#endif
#if SLV_TAPS
    vec4 sum = vec4(0.0);
    int k = 1;
    do {
        sum += textureLod(slv_pool[0], p + vec3(slv_tap_offset(f, k) * scale, 0.0), 0.0);
    } while (++k <= f.taps);
    return sum / float(f.taps);
#else
    return textureGrad(slv_pool[0], p, f.dx * scale, f.dy * scale);
#endif
#endif
}
