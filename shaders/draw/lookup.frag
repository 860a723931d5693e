// One lookup a fragment, for measuring: face, place and footprint come with the vertex.
layout(location = 0) flat in int lookup_face;
layout(location = 1) flat in vec2 lookup_uv;
layout(location = 2) flat in vec4 lookup_footprint;

layout(location = 0) out vec4 value;

void main() {
    value = slv_sample_grad(lookup_face, lookup_uv, lookup_footprint.xy, lookup_footprint.zw);
}
