// A tessellated limit surface. Lookups that fragments cannot make by themselves define SLV_HANDS_ON; SURFACE_DRAWS
// stands before this where one draw shows many batches.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in int face;

layout(location = 0) uniform mat4 world_to_eye;
layout(location = 1) uniform mat4 eye_to_clip;
layout(location = 2) uniform mat3 normal_to_eye;

layout(location = 0) out vec2 surface_uv;
layout(location = 1) out vec3 eye_position;
layout(location = 2) out vec3 eye_normal;
layout(location = 3) flat out int surface_face;
#ifdef SURFACE_DRAWS
layout(location = 4) flat out int surface_draw;
#endif

void main() {
    vec4 eye = world_to_eye * vec4(position, 1.0);
    surface_uv = uv;
    eye_position = eye.xyz;
    eye_normal = normal_to_eye * normal;
    surface_face = face;
#ifdef SURFACE_DRAWS
    surface_draw = gl_DrawIDARB;
#endif
#ifdef SLV_HANDS_ON
    slv_hand_on(face, uv);
#endif
    gl_Position = eye_to_clip * eye;
}
