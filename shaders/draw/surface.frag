// Shades with a light at the eye, or one from all around. The numbers are linear.
layout(location = 0) in vec2 surface_uv;
layout(location = 1) in vec3 eye_position;
layout(location = 2) in vec3 eye_normal;
layout(location = 3) flat in int surface_face;
#ifndef SURFACE_DRAWS
#define SURFACE_DRAWS 0
#endif
#if SURFACE_DRAWS
layout(location = 4) flat in int surface_draw;
#endif

layout(location = 4) uniform int perspective;
layout(location = 5) uniform vec2 ambient_diffuse; // ka, kd
layout(location = 0) uniform mat4 world_to_eye;
layout(location = 8) uniform mat4 light[3]; // of slv_light, for normals in the world

layout(location = 0) out vec4 color;

// Before this stands SURFACE_SHADING, a slv_shading, so that drivers that run both sides of a branch run no other; and SURFACE_ALPHA, a
// slv_alpha_mode: colours of textures are multiplied by alpha if it is not 0. To blend, fragments are kept in lists, one a pixel;
// SURFACE_STORAGE is where, SURFACE_MSAA how many samples a pixel has.
#ifndef SURFACE_SHADING
#define SURFACE_SHADING 0
#endif
#ifndef SURFACE_ALPHA
#define SURFACE_ALPHA 0
#endif
#ifndef SURFACE_MSAA
#define SURFACE_MSAA 1
#endif
#ifndef SURFACE_BIASED
#define SURFACE_BIASED 0
#endif
#if SURFACE_BIASED
layout(location = 7) uniform float stretch; // of footprints, by which lookups take another level
#endif
#if SURFACE_ALPHA == 1
layout(location = 6) uniform ivec4 fragment_room; // width, the first row, and how many fragments there is room for

layout(std430, binding = SURFACE_STORAGE) buffer surface_heads_block {
    uint surface_heads[]; // the number of a fragment, or 0
};
layout(std430, binding = SURFACE_STORAGE + 1) buffer surface_fragments_block {
    uint nfragments, unused[3];
    uvec4 surface_fragments[]; // two each, from number 1 on: the next, depth, samples; colour
};

void keep(vec4 c) {
    uint at = atomicAdd(nfragments, 1u);
    if (at >= uint(fragment_room.z))
        return;
    int pixel = (int(gl_FragCoord.y) - fragment_room.y) * fragment_room.x + int(gl_FragCoord.x);
    uint next = atomicExchange(surface_heads[pixel], at + 1u);
    surface_fragments[2u * at] = uvec4(next, floatBitsToUint(gl_FragCoord.z), uint(gl_SampleMaskIn[0]), 0u);
    surface_fragments[2u * at + 1u] = floatBitsToUint(c);
}
#endif

vec3 hue(float h) {
    return clamp(abs(fract(h + vec3(0.0, 2.0, 1.0) / 3.0) * 6.0 - 3.0) - 1.0, 0.0, 1.0);
}

#if SURFACE_ALPHA == 2
// How much alpha changes from pixel to pixel. Helper pixels can do without a lookup, so that values are no good for derivatives.
float alpha_step(float a) {
#if SURFACE_IMAGES
    return fwidth(a);
#else
    vec2 dx = dFdx(surface_uv), dy = dFdy(surface_uv);
    vec2 x = clamp(surface_uv + dx, 0.0, 1.0) == surface_uv + dx ? dx : -dx;
    vec2 y = clamp(surface_uv + dy, 0.0, 1.0) == surface_uv + dy ? dy : -dy;
    return abs(slv_sample_grad(surface_face, surface_uv + x, dx, dy).a - a) +
           abs(slv_sample_grad(surface_face, surface_uv + y, dx, dy).a - a);
#endif
}

// How much of a pixel is there: where alpha passes 1/2 the rim is as wide as a pixel. A pixel that sees many texels has the mean of
// their alpha, which is how many of them are there, and nothing passes 1/2 any more; unless alpha is the same at the finest level.
float covered_part(float a) {
    float rim = clamp((a - 0.5) / max(alpha_step(a), 1e-4) + 0.5, 0.0, 1.0);
#if SURFACE_IMAGES
    return rim;
#else
    vec2 dx = dFdx(surface_uv), dy = dFdy(surface_uv);
    float level = slv_level(surface_face, dx, dy), part = exp2(-level);
    float finest = slv_sample_grad(surface_face, surface_uv, dx * part, dy * part).a;
    return mix(rim, a, clamp(level * 0.5, 0.0, 1.0) * clamp(abs(finest - a) * 20.0, 0.0, 1.0));
#endif
}
#endif

void main() {
#if SURFACE_DRAWS
    slv_draw = surface_draw;
#endif
    vec3 n = eye_normal / max(length(eye_normal), 1e-20);
#if SURFACE_MSAA > 1
    vec3 there = interpolateAtCentroid(eye_normal); // within the triangle: beyond one that is smaller than a pixel it could be any
    there /= max(length(there), 1e-20);
    n = mix(n, there, clamp(length(n - there) * 30.0 - 1.0, 0.0, 1.0));
    n /= max(length(n), 1e-20);
#endif
    vec3 i = perspective != 0 ? normalize(eye_position) : vec3(0.0, 0.0, -1.0);
    float ka = ambient_diffuse.x, kd = ambient_diffuse.y;
    float facing = -dot(n, i);
#if SURFACE_BIASED
    vec4 c = slv_sample_grad(surface_face, surface_uv, dFdx(surface_uv) * stretch, dFdy(surface_uv) * stretch);
#else
    vec4 c = slv_sample(surface_face, surface_uv);
#endif
#if SURFACE_ALPHA == 0
    c.a = 1.0;
#else
    c.a = clamp(c.a, 0.0, 1.0);
#endif
    float headlight = kd * max(facing, 0.0) + ka;
    float headlight_abs = kd * clamp(abs(facing) + ka, 0.0, 1.0);
    if (SURFACE_SHADING == 0) {
        c.rgb *= headlight;
    } else if (SURFACE_SHADING == 1) {
        c.rgb *= headlight_abs;
    } else if (SURFACE_SHADING == 5) {
        c.rgb *= ka + kd * facing * facing;
    } else if (SURFACE_SHADING == 6) {
        vec4 at = vec4(normalize(transpose(mat3(world_to_eye)) * n), 1.0);
        c.rgb *= max(vec3(dot(at, light[0] * at), dot(at, light[1] * at), dot(at, light[2] * at)), 0.0);
    } else if (SURFACE_SHADING == 3) {
        uint h = uint(surface_face) * 0x9E3779B9u;
        h = (h ^ h >> 15) * 0x85EBCA6Bu;
        h ^= h >> 13;
        vec2 d = abs(surface_uv - 0.5);
        vec3 base = mix(vec3(0.8), hue(float(h & 1023u) / 1024.0), 0.6);
        c.rgb = base * (abs(facing) * kd + ka) * (max(d.x, d.y) > 0.48 ? 0.6 : 1.0) * c.a;
    } else if (SURFACE_SHADING == 4) {
        vec2 dx = dFdx(surface_uv), dy = dFdy(surface_uv);
#if SURFACE_BIASED
        dx *= stretch, dy *= stretch;
#endif
        float level = slv_level(surface_face, dx, dy);
        c.rgb = hue(min(level / 9.0, 1.0) * 0.7) * (abs(facing) * kd + ka) * c.a;
    }
#if SURFACE_ALPHA == 1
    if (c != vec4(0.0))
        keep(c);
    color = vec4(0.0);
#elif SURFACE_ALPHA == 2
#if SURFACE_MSAA > 1
    int covered = int(covered_part(c.a) * float(SURFACE_MSAA) + 0.5);
#else
    int covered = c.a >= 0.5 ? 1 : 0;
#endif
    if (covered == 0)
        discard;
#if SURFACE_MSAA > 1
    gl_SampleMask[0] = (1 << covered) - 1;
#endif
    color = vec4(c.rgb / max(c.a, 1e-3), 1.0);
#else
    color = c;
#endif
}
