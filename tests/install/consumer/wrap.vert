// A vertex shader of somebody else's, with a map that goes round both ways.
layout(location = 0) in vec3 position;
layout(location = 1) in vec2 uv;
layout(location = 0) out vec4 round_uv;
layout(location = 1) out vec3 place;

void main() {
    round_uv = slv_wrap_pair(uv + slv_wrap_step(vec2(0.0), uv));
    place = position;
    gl_Position = vec4(position, 1.0);
}
