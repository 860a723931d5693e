// The fragments of a pixel, one over the other, and all of them over the background; see surface.frag.
layout(location = 0) uniform ivec4 fragment_room;
layout(location = 1) uniform vec4 background;

layout(std430, binding = SURFACE_STORAGE) readonly buffer surface_heads_block {
    uint surface_heads[];
};
layout(std430, binding = SURFACE_STORAGE + 1) readonly buffer surface_fragments_block {
    uint nfragments, unused[3];
    uvec4 surface_fragments[];
};

layout(location = 0) out vec4 color;

void main() {
    int pixel = (int(gl_FragCoord.y) - fragment_room.y) * fragment_room.x + int(gl_FragCoord.x);
    uint head = surface_heads[pixel], last = 0u;
    float reached = -1.0;
    vec4 sums[SURFACE_MSAA];
    for (int s = 0; s < SURFACE_MSAA; s++)
        sums[s] = vec4(0.0);
    // each time the nearest of those behind the last one: lists are short, and of any length
    for (bool more = head != 0u; more;) {
        uint nearest = 0u;
        float depth = 2.0;
        for (uint at = head; at != 0u;) {
            uvec4 fragment = surface_fragments[2u * at - 2u];
            float d = uintBitsToFloat(fragment.y);
            if ((d > reached || (d == reached && at > last)) && (d < depth || (d == depth && at < nearest))) {
                nearest = at;
                depth = d;
            }
            at = fragment.x;
        }
        more = nearest != 0u;
        if (more) {
            uint samples = surface_fragments[2u * nearest - 2u].z;
            vec4 c = uintBitsToFloat(surface_fragments[2u * nearest - 1u]);
            float least = 1.0;
            for (int s = 0; s < SURFACE_MSAA; s++) {
                if ((samples >> s & 1u) != 0u)
                    sums[s] += (1.0 - sums[s].a) * c;
                least = min(least, sums[s].a);
            }
            more = least < 1.0;
            last = nearest;
            reached = depth;
        }
    }
    vec4 sum = vec4(0.0);
    for (int s = 0; s < SURFACE_MSAA; s++)
        sum += sums[s] + (1.0 - sums[s].a) * background;
    color = sum / float(SURFACE_MSAA);
}
