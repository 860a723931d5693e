// A fragment shader of somebody else's, with a map that goes round both ways.
layout(binding = 0) uniform sampler2D map;
layout(location = 0) in vec4 round_uv;
layout(location = 1) in vec3 place;
layout(location = 0) out vec4 color;

void main() {
    vec3 u = slv_wrap_grad(round_uv.xy), v = slv_wrap_grad(round_uv.zw);
    color = texture(map, slv_wrap(round_uv)) + textureGrad(map, vec2(u.x, v.x), vec2(u.y, v.y), vec2(u.z, v.z));
    color.rgb += slv_wrap_tangent(place, u, v) + slv_wrap(round_uv.xy);
}
