// Lookups by texture coordinates: what stands in the place of a strategy where images are drawn.
#define SLV_WRAP_FRAGMENT
#include "wrap/selvage_wrap.glsl"

layout(binding = 0) uniform sampler2DArray slv_image;
// How many places of a long footprint are looked up here, which is so on software drivers: at the silhouettes of triangles that are
// seen edge-on a footprint may have no end, and theirs visit all of it. 1: the sampler does.
layout(location = 28) uniform int slv_image_taps;
layout(location = 29) uniform ivec2 slv_round;    // which coordinates go round
layout(location = 30) uniform vec2 slv_square;    // the lower left corner of the square that is drawn
layout(location = 31) uniform int slv_image_mode; // 0 one image for all; 1 the square's; 2 faces without any

// 0 to 4 are surface.vert's
layout(location = 5) flat in vec4 slv_below;  // the coordinates of the face's corners
layout(location = 6) flat in vec4 slv_above;
layout(location = 7) in vec4 slv_pairs;       // of those that go round

vec2 slv_texcoord(vec2 uv) {
    vec2 at = mix(mix(slv_below.xy, slv_below.zw, uv.x), mix(slv_above.zw, slv_above.xy, uv.x), uv.y);
    if (slv_round.x != 0)
        at.x = slv_wrap(slv_pairs.xy);
    if (slv_round.y != 0)
        at.y = slv_wrap(slv_pairs.zw);
    return at;
}

vec4 slv_along_footprint(vec2 place) {
    const float huge = 1e9;
    vec2 size = vec2(textureSize(slv_image, 0).xy), dx = dFdx(place), dy = dFdy(place);
    dx = mix(vec2(huge), dx, lessThanEqual(abs(dx), vec2(huge)));
    dy = mix(vec2(huge), dy, lessThanEqual(abs(dy), vec2(huge)));
    float px = length(dx * size), py = length(dy * size), longest = max(px, py);
    float sides = clamp(longest / max(min(px, py), 1e-12), 1.0, float(slv_image_taps));
    float level = log2(max(longest / sides, 1e-12));
    vec2 side = (px > py ? dx : dy) / (sides + 1.0);
    // from the middle to both ends, where the last ones count as far as the footprint reaches: with a number of equal ones rounding
    // would choose, here and there, how many
    float reach = 0.5 * (sides - 1.0);
    vec4 sum = textureLod(slv_image, vec3(place, 0.0), level);
    for (float k = 1.0; k < reach + 1.0; k++)
        sum += min(reach - k + 1.0, 1.0) * (textureLod(slv_image, vec3(place + k * side, 0.0), level) +
                                            textureLod(slv_image, vec3(place - k * side, 0.0), level));
    return sum / sides;
}

vec4 slv_sample(int face, vec2 uv) {
    vec2 at = slv_texcoord(uv), place = slv_image_mode == 2 ? vec2(0.5) : at - slv_square;
    // t runs downwards in images
    place.y = 1.0 - place.y;
    vec4 value = slv_image_taps > 1 ? slv_along_footprint(place) : texture(slv_image, vec3(place, 0.0));
    if (slv_image_mode == 1) {
        // a face on more squares than one is drawn once for each
        vec2 low = floor(min(min(slv_below.xy, slv_below.zw), min(slv_above.xy, slv_above.zw)));
        vec2 high = ceil(max(max(slv_below.xy, slv_below.zw), max(slv_above.xy, slv_above.zw))) - 1.0;
        if (clamp(floor(at), low, max(low, high)) != slv_square)
            discard;
    }
    return value;
}

// By the change in the middle of the face.
float slv_level(int face, vec2 dx, vec2 dy) {
    vec2 size = vec2(textureSize(slv_image, 0).xy);
    vec2 along_u = 0.5 * (slv_below.zw - slv_below.xy + slv_above.xy - slv_above.zw);
    vec2 along_v = 0.5 * (slv_above.zw - slv_below.xy + slv_above.xy - slv_below.zw);
    vec2 px = along_u * dx.x + along_v * dx.y, py = along_u * dy.x + along_v * dy.y;
    if (slv_round.x != 0) {
        vec3 u = slv_wrap_grad(slv_pairs.xy);
        px.x = u.y, py.x = u.z;
    }
    if (slv_round.y != 0) {
        vec3 v = slv_wrap_grad(slv_pairs.zw);
        px.y = v.y, py.y = v.z;
    }
    return clamp(log2(max(max(length(px * size), length(py * size)), 1e-12)), 0.0, log2(max(size.x, size.y)));
}
