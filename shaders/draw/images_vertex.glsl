// Texture coordinates at the vertices, for the lookups of images.glsl: drivers read nothing of a buffer in pixels beside a triangle,
// whose derivatives are needed, so that fragments have all from here. A coordinate that goes round has one value a vertex of the
// mesh; within a face it takes the short way from corner to corner, and on to the fragments the way of selvage_wrap.glsl.
#define SLV_HANDS_ON
#include "wrap/selvage_wrap.glsl"

layout(location = 29) uniform ivec2 slv_round;

// Per face the texture coordinates of its corners.
layout(std430, binding = 4) readonly buffer slv_corner_block {
    vec4 slv_corners[];
};

layout(location = 5) flat out vec4 slv_below;
layout(location = 6) flat out vec4 slv_above;
layout(location = 7) out vec4 slv_pairs;

void slv_hand_on(int face, vec2 uv) {
    slv_below = slv_corners[2 * face];
    slv_above = slv_corners[2 * face + 1];
    slv_pairs = vec4(0.0);
    if (slv_round != ivec2(0)) {
        vec2 from = slv_below.xy, right = slv_wrap_step(from, slv_below.zw);
        vec2 across = slv_wrap_step(from, slv_above.xy), up = slv_wrap_step(from, slv_above.zw);
        slv_pairs = slv_wrap_pair(from + mix(right * uv.x, mix(up, across, uv.x), uv.y));
    }
}
