// A face's own texels and nothing beyond its edges, colour over coverage: multisampling blends the fragments (Toth 2013).
#include "lookup/interface.glsl"
#include "lookup/footprint.glsl"
#include "lookup/coverage.glsl"

// The centre is clamped into the face, the derivatives are not: then at least a quarter of an isotropic filter is inside, of a row
// of taps at least that of the one in the centre, and helper pixels need no second lookup.
vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {
    slv_footprint f = slv_footprint_of(slv_face_size(face), dx, dy);
    return slv_value(slv_resolve(slv_own(face, slv_inside(uv), f)));
}
