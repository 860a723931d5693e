// Texture coordinates that go round, one value a vertex: maps of cylinders and tori without duplicated vertices, after Tarini,
// "Cylindrical and toroidal parameterizations without vertex seams" (2011). For any program: this declares functions only, asks for
// no buffer, uniform or varying, and has nothing to do with the rest of Selvage. selvage/wrap.h has the same in C.
//
// Vertex stage: include this, and hand on a pair of each coordinate that goes round.
//     out vec2 round_u;            round_u = slv_wrap_pair(u);      // a cylinder
//     out vec4 round_uv;           round_uv = slv_wrap_pair(uv);    // a torus: u's pair, and v's
// Fragment stage: define SLV_WRAP_FRAGMENT, include this, and take the coordinate back, outside of branches that pixels part at.
//     texture(map, vec2(k * slv_wrap(round_u), v))
//     texture(map, slv_wrap(round_uv))
// With gradients of one's own, which keep the long axis of a footprint where textureLod loses it:
//     vec3 u = slv_wrap_grad(round_u);                              // value, change to the right, change upwards
//     textureGrad(map, vec2(k * u.x, v), vec2(k * u.y, dFdx(v)), vec2(k * u.z, dFdy(v)))
// A coordinate that is made in the fragment stage, an angle say, takes no varying: slv_wrap(slv_wrap_pair(u)).
//
// k is the number of repetitions around, and whole: with another one the ends of the map do not meet. The sampler repeats along
// such a coordinate. No triangle may span half of the map or more, and where a fan meets in a pole no value is right for the pole:
// `selvage wrap` names both.
//
// The fragment stage needs GLSL 4.50 for derivatives that the four pixels of a quad share. Where there are none, define
// SLV_WRAP_CHANGE as fwidth, which most drivers compute the same way.

// The coordinate in 0..1 and in -1/2..1/2: of every triangle that spans less than half of the map at least one is what was meant.
vec2 slv_wrap_pair(float u) {
    return vec2(fract(u), fract(u + 0.5) - 0.5);
}

vec4 slv_wrap_pair(vec2 uv) {
    return vec4(slv_wrap_pair(uv.x), slv_wrap_pair(uv.y));
}

// From one coordinate to another the short way: what to add to the first, -1/2 to 1/2.
float slv_wrap_step(float from, float to) {
    float d = to - from;
    return d - round(d);
}

vec2 slv_wrap_step(vec2 from, vec2 to) {
    vec2 d = to - from;
    return d - round(d);
}

#ifdef SLV_WRAP_FRAGMENT
#ifndef SLV_WRAP_CHANGE
#define SLV_WRAP_CHANGE fwidthCoarse
#endif

// Which of the two changes less from pixel to pixel. Coarse derivatives are the same in all four pixels of a quad, so that these
// choose alike, and the derivatives that a lookup takes of the result are right. Where both change alike rounding must not
// choose: one side counts a little less, by a part of itself, since how fast coordinates change depends on the picture.
bool slv_wrap_first(vec2 pair) {
    vec2 change = SLV_WRAP_CHANGE(pair);
    return change.x <= change.y * 1.01;
}

float slv_wrap(vec2 pair) {
    return slv_wrap_first(pair) ? pair.x : pair.y;
}

vec2 slv_wrap(vec4 pairs) {
    return vec2(slv_wrap(pairs.xy), slv_wrap(pairs.zw));
}

// The coordinate, and its change over one pixel to the right and over one upwards.
vec3 slv_wrap_grad(vec2 pair) {
    vec2 dx = dFdx(pair), dy = dFdy(pair);
    return slv_wrap_first(pair) ? vec3(pair.x, dx.x, dy.x) : vec3(pair.y, dx.y, dy.y);
}

// The direction along the surface in which u grows and v does not, of length 1, zero where there is none. `position` is the
// surface's in the space that the tangent is wanted in; `u` and `v` are as from slv_wrap_grad, or, of a coordinate that does not
// go round, vec3(v, dFdx(v), dFdy(v)). The other tangent has u and v exchanged.
vec3 slv_wrap_tangent(vec3 position, vec3 u, vec3 v) {
    vec3 across = dFdx(position), up = dFdy(position);
    vec3 t = (across * v.z - up * v.y) * (u.y * v.z - u.z * v.y < 0.0 ? -1.0 : 1.0);
    float size = length(t);
    return size > 0.0 ? t / size : vec3(0.0);
}
#endif
