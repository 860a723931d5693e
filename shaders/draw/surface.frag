// Shades with a light at the eye. The numbers are linear.
layout(location = 0) in vec2 surface_uv;
layout(location = 1) in vec3 eye_position;
layout(location = 2) in vec3 eye_normal;
layout(location = 3) flat in int surface_face;

layout(location = 3) uniform int shading; // slv_shading
layout(location = 4) uniform int perspective;
layout(location = 5) uniform vec2 ambient_diffuse; // ka, kd

layout(location = 0) out vec4 color;

vec3 hue(float h) {
    return clamp(abs(fract(h + vec3(0.0, 2.0, 1.0) / 3.0) * 6.0 - 3.0) - 1.0, 0.0, 1.0);
}

void main() {
    vec3 n = eye_normal / max(length(eye_normal), 1e-20);
    vec3 i = perspective != 0 ? normalize(eye_position) : vec3(0.0, 0.0, -1.0);
    float ka = ambient_diffuse.x, kd = ambient_diffuse.y;
    float facing = -dot(n, i);
    vec4 c = slv_sample(surface_face, surface_uv);
    float headlight = kd * max(facing, 0.0) + ka;
    float headlight_abs = kd * clamp(abs(facing) + ka, 0.0, 1.0);
    if (shading == 0) {
        c.rgb *= headlight;
    } else if (shading == 1) {
        c.rgb *= headlight_abs;
    } else if (shading == 5) {
        c.rgb *= ka + kd * facing * facing;
    } else if (shading == 3) {
        uint h = uint(surface_face) * 0x9E3779B9u;
        h = (h ^ h >> 15) * 0x85EBCA6Bu;
        h ^= h >> 13;
        vec2 d = abs(surface_uv - 0.5);
        vec3 base = mix(vec3(0.8), hue(float(h & 1023u) / 1024.0), 0.6);
        c.rgb = base * (abs(facing) * kd + ka) * (max(d.x, d.y) > 0.48 ? 0.6 : 1.0);
    } else if (shading == 4) {
        float level = slv_level(surface_face, dFdx(surface_uv), dFdy(surface_uv));
        c.rgb = hue(min(level / 9.0, 1.0) * 0.7) * (abs(facing) * kd + ka);
    }
    color = vec4(c.rgb, 1.0);
}
