// A fragment shader of somebody else's, around the lookups.
layout(location = 0) in vec2 uv;
layout(location = 1) flat in int face;
layout(location = 0) out vec4 color;

void main() {
    color = slv_sample(face, uv) + slv_sample_grad(face, uv, vec2(0.01, 0.0), vec2(0.0, 0.01));
}
