// Squares of texels around the edges of faces, two of which meet in a face's triangle of a half-edge (Barbier and Dupuy 2022).
#define SLV_KEEPS_ROW
#include "lookup/vectors.glsl"
#include "lookup/interface.glsl"
#include "lookup/footprint.glsl"
#include "lookup/corner_values.glsl"

// Per face, the squares of four half-edges that follow each other around the polygon: those of its own edges 0 to 3, or of the two
// before the sub-face's own, that one and the next. Bits of each:
//   bits 0-15   layer
//   bits 16-19  pool
//   bits 20-24  log2 of the square's side
//   bit 25      the half-edge has the half of the square where s + t > 1
//   bit 26      the face is a sub-face
// and the corners where these half-edges start, and the polygon's centre: the index of the first of their values in 27 bits, and
// log2 of the least square around them. A corner has a value for squares of 1, 2, 4 and more texels. Where these are vectors, the
// second component of `centre` has 2 bits for each of the squares, of the corners and for the centre: by how many quarters the axes
// there are turned, counter-clockwise, as the face sees them.
struct slv_square_links {
    uvec4 squares, corners, centre;
};
layout(std430, binding = SLV_FIRST_STORAGE + 1) readonly buffer slv_squares_block {
    slv_square_links slv_squares[];
};

vec4 slv_square_texel(int pool, vec3 p, float level) {
#if SLV_POOLS == 1
    return textureLod(slv_pool[0], p, level);
#elif SLV_VECTORS
    return textureLod(slv_pool[pool], p, level); // the caller sees to it that the index is the same for all
#else
    switch (pool) { // an index that differs between the fragments of a vector must not select an array
    case 0:
        return textureLod(slv_pool[0], p, level);
    case 1:
        return textureLod(slv_pool[1], p, level);
#if SLV_POOLS > 2
    case 2:
        return textureLod(slv_pool[2], p, level);
    case 3:
        return textureLod(slv_pool[3], p, level);
#endif
#if SLV_POOLS > 4
    case 4:
        return textureLod(slv_pool[4], p, level);
    case 5:
        return textureLod(slv_pool[5], p, level);
    case 6:
        return textureLod(slv_pool[6], p, level);
    case 7:
        return textureLod(slv_pool[7], p, level);
#endif
#if SLV_POOLS > 8
    case 8:
        return textureLod(slv_pool[8], p, level);
    case 9:
        return textureLod(slv_pool[9], p, level);
    case 10:
        return textureLod(slv_pool[10], p, level);
    case 11:
        return textureLod(slv_pool[11], p, level);
    case 12:
        return textureLod(slv_pool[12], p, level);
    case 13:
        return textureLod(slv_pool[13], p, level);
    case 14:
        return textureLod(slv_pool[14], p, level);
    case 15:
        return textureLod(slv_pool[15], p, level);
#endif
    }
    return vec4(0.0);
#endif
}

// A row of taps in one of the three squares that a half-edge's triangle can reach: `turn` 0 is its own, 1 that of the half-edge
// after it, 3 that of the one before. Each tap goes over from its own square to another within half a texel of the side between
// them, or less close to a corner, so that the other has no part in the value on the edge. The weights of the three add up to 1
// wherever a tap lies: nothing has to be divided by what was covered.
vec4 slv_square_row(uint square, int pool, int turn, vec2 st, vec2 texel, slv_footprint f) {
    float log2_side = float(square >> 20 & 31u), layer = float(square & 0xffffu);
    float level = clamp(f.level + log2_side, 0.0, log2_side);
    vec4 sum = vec4(0.0);
    int k = 1;
    do {
        vec2 at = st + slv_tap_offset(f, k);
        vec2 along = 2.0 * min(at.yx, 1.0 - at.yx);
        vec2 beyond = clamp(0.5 - at / max(min(texel, along), 1e-12), 0.0, 1.0);
        float both = beyond.x * beyond.y;
        float weight = turn == 0   ? (1.0 - beyond.x) * (1.0 - beyond.y)
                       : turn == 1 ? beyond.x - 0.5 * both
                                   : beyond.y - 0.5 * both;
        at = turn == 0 ? at : turn == 1 ? vec2(at.y, -at.x) : vec2(-at.y, at.x);
        at = clamp(at, 0.0, 1.0);
        at = (square & 0x2000000u) != 0u ? 1.0 - at : at;
        sum += weight * slv_square_texel(pool, vec3(at, layer), level);
    } while (++k <= f.taps);
    return sum / float(f.taps);
}

vec4 slv_square_value(uint square, int turn, vec2 st, vec2 texel, slv_footprint f) {
    int own = int(square >> 16 & 15u);
#if SLV_VECTORS && SLV_POOLS > 1
    vec4 value = vec4(0.0);
    bool waiting = !SLV_HELPER; // which are not among those that the value is read from
    do {
        int pool = readFirstInvocationARB(own);
        if (pool == own) {
            value = slv_square_row(square, pool, turn, st, texel, f);
            waiting = false;
        }
    } while (waiting);
    return value;
#else
    return slv_square_row(square, own, turn, st, texel, f);
#endif
}

// Where a point lies in the triangle of one of the face's half-edges, and how (s,t) there follows (u,v).
struct slv_place {
    int own; // which of the four
    vec2 st;
    mat2 to;
};

slv_place slv_place_of(bool part, vec2 uv) {
    if (part) {
        bool low = uv.x >= uv.y; // the half-edge that starts at this sub-face's corner 0
        mat2 to = low ? mat2(-0.5, 0.5, -0.5, -0.5) : mat2(-0.5, -0.5, 0.5, -0.5);
        return slv_place(low ? 2 : 1, to * uv + (low ? vec2(1.0, 0.0) : vec2(0.0, 1.0)), to);
    }
    vec2 p = uv - 0.5;
    bool upright = abs(p.y) >= abs(p.x);
    int own = upright ? (p.y > 0.0 ? 2 : 0) : (p.x > 0.0 ? 1 : 3);
    float turned = own > 1 ? -1.0 : 1.0;
    mat2 to = turned * (upright ? mat2(-1.0, 1.0, -1.0, -1.0) : mat2(1.0, 1.0, -1.0, 1.0));
    return slv_place(own, to * p, to);
}

vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {
    uvec4 squares = slv_squares[SLV_ROW(face)].squares;
    slv_place place = slv_place_of((squares.x & 0x4000000u) != 0u, slv_inside(uv));
    int after = (place.own + 1) & 3, before = (place.own + 3) & 3;
    slv_footprint f = slv_footprint_of(vec2(1.0), place.to * slv_bounded(dx), place.to * slv_bounded(dy));
    uvec3 log2_sides = uvec3(squares[place.own], squares[after], squares[before]) >> 20 & 31u;
    // of the finer of two squares, so that taps beyond the side between them have the same weights in both
    vec2 texel = exp2(clamp(vec2(f.level), -vec2(max(log2_sides.xx, log2_sides.yz)), vec2(0.0)));
    // On the edge both faces have the same square and no other, if the row of taps stays inside. Towards a vertex it grows shorter,
    // down to a point within half a texel.
    float most = max(place.st.x, place.st.y);
    float room = 1.0 - most - 0.5 * exp2(clamp(f.level, -float(log2_sides.x), 0.0));
    vec2 reach = 0.5 * abs(f.axis);
    float fit = clamp(room / max(max(reach.x, reach.y), 1e-12), 0.0, 1.0);
    f.axis *= fit;
    bvec2 near = lessThan(place.st - fit * reach, 0.5 * texel);
    uint pending = 1u | (near.x ? 2u : 0u) | (near.y ? 8u : 0u);
#if SLV_VECTORS
    pending = SLV_HELPER ? 1u : pending;
#endif
    vec4 value = vec4(0.0);
#if SLV_TURNS
    uint turns = slv_squares[SLV_ROW(face)].centre.y;
#endif
    do {
        int turn = findLSB(pending);
        pending &= pending - 1u;
        int slot = (place.own + turn) & 3;
        vec4 part = slv_square_value(squares[slot], turn, place.st, texel, f);
#if SLV_TURNS
        part = slv_turned(int(turns >> 2 * slot), part);
#endif
        value += part;
    } while (pending != 0u);
    // Around a corner the squares at hand differ from triangle to triangle: towards it the value becomes the one that all share.
    int start = place.st.x >= place.st.y ? place.own : after;
    uint corner = most < 0.5 ? slv_squares[SLV_ROW(face)].centre.x : slv_squares[SLV_ROW(face)].corners[start];
    uint first = slv_corner_first(corner), least = corner >> 27;
    float log2_side = clamp(-f.level, 0.0, float(least));
    float share = clamp(min(most, 1.0 - most) * 2.0 * exp2(log2_side), 0.0, 1.0);
    vec4 shared_value = mix(slv_corner[first + uint(log2_side)], slv_corner[first + min(uint(log2_side) + 1u, least)],
                            fract(log2_side));
#if SLV_TURNS
    shared_value = slv_turned(int(turns >> (most < 0.5 ? 16 : 8 + 2 * start)), shared_value);
#endif
    return slv_value(mix(shared_value, value, share));
}
