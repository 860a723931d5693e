// Lookups by texture coordinates: what stands in the place of a strategy where images are drawn.
layout(binding = 0) uniform sampler2DArray slv_image;
layout(location = 30) uniform vec2 slv_square;   // the lower left corner of the square that is drawn
layout(location = 31) uniform int slv_image_mode; // 0 one image for all; 1 the square's; 2 faces without any


// Per face the texture coordinates of its corners.
layout(std430, binding = 4) readonly buffer slv_corner_block {
    vec4 slv_corners[];
};

vec2 slv_texcoord(int face, vec2 uv) {
    vec4 below = slv_corners[2 * face], above = slv_corners[2 * face + 1];
    return mix(mix(below.xy, below.zw, uv.x), mix(above.zw, above.xy, uv.x), uv.y);
}

vec4 slv_sample(int face, vec2 uv) {
    vec2 at = slv_texcoord(face, uv);
    if (slv_image_mode == 2)
        at = vec2(0.5);
    // t runs downwards in images
    vec2 place = at - slv_square;
    // storage buffers read as zero in helper pixels here and there, so that only what is interpolated can be differentiated
    vec4 low_side = slv_corners[2 * face], high_side = slv_corners[2 * face + 1];
    vec2 du = mix(low_side.zw - low_side.xy, high_side.xy - high_side.zw, uv.y), dv = mix(high_side.zw - low_side.xy, high_side.xy - low_side.zw, uv.x);
    vec2 dx = dFdx(uv), dy = dFdy(uv);
    vec2 px = du * dx.x + dv * dx.y, py = du * dy.x + dv * dy.y;
    vec4 value = textureGrad(slv_image, vec3(place.x, 1.0 - place.y, 0.0), px * vec2(1, -1), py * vec2(1, -1));
    if (slv_image_mode == 1) {
        // a face on more squares than one is drawn once for each
        vec4 below = slv_corners[2 * face], above = slv_corners[2 * face + 1];
        vec2 low = floor(min(min(below.xy, below.zw), min(above.xy, above.zw)));
        vec2 high = ceil(max(max(below.xy, below.zw), max(above.xy, above.zw))) - 1.0;
        if (clamp(floor(at), low, max(low, high)) != slv_square)
            discard;
    }
    return value;
}

float slv_level(int face, vec2 dx, vec2 dy) {
    vec2 size = vec2(textureSize(slv_image, 0).xy);
    vec2 middle = slv_texcoord(face, vec2(0.5));
    vec2 along_u = slv_texcoord(face, vec2(1.5, 0.5)) - middle, along_v = slv_texcoord(face, vec2(0.5, 1.5)) - middle;
    vec2 px = (along_u * dx.x + along_v * dx.y) * size, py = (along_u * dy.x + along_v * dy.y) * size;
    return clamp(log2(max(max(length(px), length(py)), 1e-12)), 0.0, log2(max(size.x, size.y)));
}
