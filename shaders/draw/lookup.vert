// One point per lookup: lookup number n goes to pixel n of a target that is 1024 wide.
layout(location = 0) in int face;
layout(location = 1) in vec2 uv;
layout(location = 2) in vec2 dx;
layout(location = 3) in vec2 dy;

layout(location = 0) uniform vec2 target_size;

layout(location = 0) flat out int lookup_face;
layout(location = 1) flat out vec2 lookup_uv;
layout(location = 2) flat out vec4 lookup_footprint;

void main() {
    vec2 pixel = vec2(float(gl_VertexID % 1024), float(gl_VertexID / 1024));
    lookup_face = face;
    lookup_uv = uv;
    lookup_footprint = vec4(dx, dy);
    gl_Position = vec4((pixel + 0.5) / target_size * 2.0 - 1.0, 0.0, 1.0);
}
