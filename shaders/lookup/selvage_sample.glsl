// Lookups in per-face textures: include this in a fragment shader of your own.
//
//   vec4 slv_sample(int face, vec2 uv)                           footprint from the screen-space derivatives of uv
//   vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy)    footprint given: the change of uv over one pixel
//   float slv_level(int face, vec2 dx, vec2 dy)                  the level of detail that such a lookup uses
//
// `face` is the face that is being drawn (a flat input), uv in 0..1 its own coordinates. slv_sample needs uniform control flow,
// as every function of implicit derivatives does. The result is RGBA in the texture's own space; with three channels or fewer
// alpha is 1. Nothing here divides by zero, whatever the helper pixels hold.
//
// The text comes from slv_gl_texture_glsl with these defined before it:
//   SLV_STRATEGY        0 clamp, 1 borders, 2 traverse, 3 discard, 4 hybrid, 5 traverse-full, 6 edge-aligned,
//                       7 htex
//   SLV_POOLS           array textures bound; the batch's own is number 0, but for htex
//   SLV_SUBFACES        1 if a face of the batch has two sub-faces across one edge
//   SLV_SPLIT_COVERAGE  1 if coverage has textures of its own (four-channel data)
//   SLV_ANISOTROPY, SLV_BORDER, SLV_FIRST_UNIT, SLV_FIRST_STORAGE
//   SLV_TAPS            1 if anisotropic taps are made here and not by the sampler: software drivers take the long axis of a
//                       footprint from the coordinates of neighbouring fragments, whatever derivatives they are given
//   SLV_VECTORS         1 if fragments run in vectors that only a loop's end can leave early (llvmpipe). Both sides of an `if` run
//                       there for all, every case of a `switch`, and the body of a loop once more than needed if its condition
//                       stands at the top
//   SLV_SCALED          1 if texels are stored divided by SLV_SCALE, because sums of such large floats would overflow
#if SLV_VECTORS
#extension GL_ARB_shader_ballot : require
#endif

const float SLV_HYBRID_RANGE = 0.5; // levels over which hybrid goes over from traverse to discard
const int SLV_LEVELS = 17; // room for 65536 x 65536

layout(binding = SLV_FIRST_UNIT) uniform sampler2DArray slv_pool[SLV_POOLS];
#if SLV_SPLIT_COVERAGE
layout(binding = SLV_FIRST_UNIT + SLV_POOLS) uniform sampler2DArray slv_coverage[SLV_POOLS];
#endif

// Per face: pool | layer << 16, and log2 width | log2 height << 8.
layout(std430, binding = SLV_FIRST_STORAGE) readonly buffer slv_store_block {
    uvec2 slv_store[];
};

vec2 slv_face_size(int face) {
    uint res = slv_store[face].y;
    return vec2(float(1u << (res & 255u)), float(1u << (res >> 8)));
}

// The value of a lookup from that of its texels as they are stored.
vec4 slv_value(vec4 stored) {
#if SLV_SCALED
    vec4 most = 3.4e38 / SLV_SCALE; // rounding must not go beyond the range
    return clamp(stored, -most, most) * SLV_SCALE;
#else
    return stored;
#endif
}

// What a lookup averages: an anisotropic footprint is a row of isotropic ones along its longer side (the definition of
// EXT_texture_filter_anisotropic).
struct slv_footprint {
    vec2 dx, dy;
    vec2 axis; // the longer side
    int taps;
    float level; // of each tap
};

// Coordinates and derivatives at silhouettes and of degenerate triangles can be anything. What is no number counts as huge.
vec2 slv_bounded(vec2 v) {
    const float huge = 1e9;
    return mix(vec2(huge), v, lessThanEqual(abs(v), vec2(huge)));
}
vec2 slv_inside(vec2 uv) {
    return mix(vec2(0.0), min(uv, 1.0), greaterThanEqual(uv, vec2(0.0)));
}

slv_footprint slv_footprint_of(vec2 size, vec2 dx, vec2 dy) {
    dx = slv_bounded(dx);
    dy = slv_bounded(dy);
    float px = length(dx * size), py = length(dy * size);
    float longest = max(px, py), shortest = min(px, py);
    int taps = int(clamp(ceil(longest / max(shortest, 1e-12)), 1.0, float(SLV_ANISOTROPY)));
    vec2 axis = px > py ? dx : dy;
#if SLV_TAPS
#if SLV_STRATEGY != 7
    // Within a quarter of a texel a row changes next to nothing. It would be another one for a neighbour whose texels have another
    // shape, and show at the edge. (Squares of edges are looked up from both sides alike, and their size is not known here.)
    float row = clamp(4.0 * longest - 1.0, 0.0, 1.0);
    axis *= row;
    taps = row > 0.0 ? taps : 1;
#endif
    taps |= 1; // an odd number has one in the centre, which the face cannot miss however small it is
#if SLV_VECTORS && SLV_STRATEGY != 5
    taps = gl_HelperInvocation ? 1 : taps;
#endif
#endif
    return slv_footprint(dx, dy, axis, taps, log2(max(longest / float(taps), 1e-12)));
}

// Where tap k = 1.. of a footprint lies, relative to its centre.
vec2 slv_tap_offset(slv_footprint f, int k) {
    return f.axis * (float(k) / float(f.taps + 1) - 0.5);
}

float slv_level(int face, vec2 dx, vec2 dy) {
    vec2 size = slv_face_size(face);
    return clamp(slv_footprint_of(size, dx, dy).level, 0.0, log2(max(size.x, size.y)));
}

#if SLV_STRATEGY == 1 || SLV_STRATEGY == 6

// Per pool and level: the part of a layer that the level's texels fill without their border, as scale and offset; with
// edge-aligned samples, the part from the first sample's centre to the last's.
layout(std430, binding = SLV_FIRST_STORAGE + 2) readonly buffer slv_rect_block {
    vec4 slv_rect[];
};

#if SLV_STRATEGY == 6

// A lookup of the value on the edge depends on the samples there only, which both faces share. So that this holds for a row of
// taps too, none leaves the face, and the row grows narrower across an edge as it comes near.
vec4 slv_packed_level(uint pool, float layer, int level, vec2 size, vec2 uv, slv_footprint f) {
    vec4 rect = slv_rect[int(pool) * SLV_LEVELS + level];
#if SLV_ANISOTROPY == 1
    return textureLod(slv_pool[0], vec3(uv * rect.xy + rect.zw, layer), 0.0);
#else
    vec2 fit = min(vec2(1.0), min(uv, 1.0 - uv) / max(0.5 * abs(f.axis), vec2(1e-12)));
    vec4 sum = vec4(0.0);
    int k = 1;
    do {
        vec2 at = slv_inside(uv + slv_tap_offset(f, k) * fit);
        sum += textureLod(slv_pool[0], vec3(at * rect.xy + rect.zw, layer), 0.0);
    } while (++k <= f.taps);
    return sum / float(f.taps);
#endif
}

#else

vec4 slv_packed_level(uint pool, float layer, int level, vec2 size, vec2 uv, slv_footprint f) {
    vec4 rect = slv_rect[int(pool) * SLV_LEVELS + level];
    vec3 p = vec3(uv * rect.xy + rect.zw, layer);
#if SLV_ANISOTROPY == 1
    return textureLod(slv_pool[0], p, 0.0);
#else
    // the taps must stay inside this level's border: beside it lie other levels
    vec2 level_size = max(size * exp2(-float(level)), vec2(1.0));
    vec2 room = min(vec2(SLV_BORDER), level_size) - 0.5;
    vec2 fit = room / max(0.5 * (abs(f.dx) + abs(f.dy)) * level_size, vec2(1e-12));
    vec2 scale = rect.xy * min(1.0, min(fit.x, fit.y));
#if SLV_TAPS
    vec4 sum = vec4(0.0);
    int k = 1;
    do {
        sum += textureLod(slv_pool[0], p + vec3(slv_tap_offset(f, k) * scale, 0.0), 0.0);
    } while (++k <= f.taps);
    return sum / float(f.taps);
#else
    return textureGrad(slv_pool[0], p, f.dx * scale, f.dy * scale);
#endif
#endif
}

#endif

vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {
    uvec2 store = slv_store[face];
    uint pool = store.x & 0xffffu;
    float layer = float(store.x >> 16);
    vec2 size = slv_face_size(face);
    slv_footprint f = slv_footprint_of(size, dx, dy);
    float coarsest = log2(max(size.x, size.y));
    float level = clamp(f.level, 0.0, coarsest);
    float fine = floor(level);
    uv = slv_inside(uv);
    vec4 a = slv_packed_level(pool, layer, int(fine), size, uv, f);
    vec4 b = slv_packed_level(pool, layer, int(min(fine + 1.0, coarsest)), size, uv, f);
    return slv_value(mix(a, b, level - fine));
}

#elif SLV_STRATEGY == 7

// Per face, the squares of four half-edges that follow each other around the polygon: those of its own edges 0 to 3, or of the two
// before the sub-face's own, that one and the next. Bits of each:
//   bits 0-15   layer
//   bits 16-19  pool
//   bits 20-24  log2 of the square's side
//   bit 25      the half-edge has the half of the square where s + t > 1
//   bit 26      the face is a sub-face
// and the corners where these half-edges start, and the polygon's centre: the index of the first of their values in 27 bits, and
// log2 of the least square around them.
struct slv_square_links {
    uvec4 squares, corners, centre;
};
layout(std430, binding = SLV_FIRST_STORAGE + 1) readonly buffer slv_squares_block {
    slv_square_links slv_squares[];
};

// The values that squares share where they meet, of one corner for squares of 1, 2, 4 and more texels.
layout(std430, binding = SLV_FIRST_STORAGE + 3) readonly buffer slv_corner_block {
    vec4 slv_corner[];
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
    bool waiting = !gl_HelperInvocation; // which are not among those that the value is read from
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
    uvec4 squares = slv_squares[face].squares;
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
    pending = gl_HelperInvocation ? 1u : pending;
#endif
    vec4 value = vec4(0.0);
    do {
        int turn = findLSB(pending);
        pending &= pending - 1u;
        value += slv_square_value(squares[(place.own + turn) & 3], turn, place.st, texel, f);
    } while (pending != 0u);
    // Around a corner the squares at hand differ from triangle to triangle: towards it the value becomes the one that all share.
    uint corner = most < 0.5 ? slv_squares[face].centre.x
                             : slv_squares[face].corners[place.st.x >= place.st.y ? place.own : after];
    uint first = corner & 0x7ffffffu, least = corner >> 27;
    float log2_side = clamp(-f.level, 0.0, float(least));
    float share = clamp(min(most, 1.0 - most) * 2.0 * exp2(log2_side), 0.0, 1.0);
    vec4 shared_value = mix(slv_corner[first + uint(log2_side)], slv_corner[first + min(uint(log2_side) + 1u, least)],
                            fract(log2_side));
    return slv_value(mix(shared_value, value, share));
}

#else

struct slv_tap {
    vec4 color; // weighted by coverage
    float coverage;
};

#if SLV_TAPS
#define SLV_TEXTURE(texture, p, f) textureLod(texture, p, f.level)
#else
#define SLV_TEXTURE(texture, p, f) textureGrad(texture, p, f.dx, f.dy)
#endif

#if SLV_SPLIT_COVERAGE
#define SLV_LOOKUP(i, p, f)                                                                        \
    slv_tap(SLV_TEXTURE(slv_pool[i], p, f), SLV_TEXTURE(slv_coverage[i], vec3((p).xy, 0.0), f).r)
#else
slv_tap slv_tap_of(vec4 texel) {
    return slv_tap(texel, texel.a);
}
#define SLV_LOOKUP(i, p, f) slv_tap_of(SLV_TEXTURE(slv_pool[i], p, f))
#endif

void slv_add(inout slv_tap sum, slv_tap tap) {
    sum.color += tap.color;
    sum.coverage += tap.coverage;
}

slv_tap slv_scaled(slv_tap tap, float scale) {
    return slv_tap(tap.color * scale, tap.coverage * scale);
}

// A whole footprint, from one lookup where the sampler makes the taps.
#if SLV_TAPS
#define SLV_GATHER(lookup, p, f)                                                                   \
    slv_tap sum = slv_tap(vec4(0.0), 0.0);                                                         \
    int k = 1;                                                                                     \
    do {                                                                                           \
        slv_add(sum, lookup(p + vec3(slv_tap_offset(f, k), 0.0), f));                              \
    } while (++k <= f.taps);                                                                       \
    return slv_tap(sum.color / float(f.taps), sum.coverage / float(f.taps))
#else
#define SLV_GATHER(lookup, p, f) return lookup(p, f)
#endif

slv_tap slv_own(int face, vec2 uv, slv_footprint f) {
    vec3 p = vec3(uv, float(slv_store[face].x >> 16));
#define SLV_OWN_LOOKUP(p, f) SLV_LOOKUP(0, p, f)
#if SLV_STRATEGY != 0 && SLV_ANISOTROPY > 1 && !SLV_TAPS
    slv_tap tap = SLV_OWN_LOOKUP(p, f);
    if (tap.coverage < 1e-3) {
        // a sampler's row of taps need not have one in the centre, and all can miss a face that is smaller than their distance
        f.dx = f.dy = f.axis / float(f.taps);
        f.dy = vec2(-f.dy.y, f.dy.x);
        tap = SLV_OWN_LOOKUP(p, f);
    }
    return tap;
#else
    SLV_GATHER(SLV_OWN_LOOKUP, p, f);
#endif
}

vec4 slv_resolve(slv_tap tap) {
    return tap.color / max(tap.coverage, 1e-6);
}

#if SLV_STRATEGY == 0 || SLV_STRATEGY == 3

// Discard clamps the centre into the face and leaves the derivatives: then at least a quarter of an isotropic filter is inside, of a
// row of taps at least that of the one in the centre, and helper pixels need no second lookup. Clamp's sampler repeats the
// face's own texels instead of adding nothing, so coverage is 1.
vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {
    slv_footprint f = slv_footprint_of(slv_face_size(face), dx, dy);
#if SLV_STRATEGY == 0
    return slv_value(slv_own(face, slv_inside(uv), f).color);
#else
    return slv_value(slv_resolve(slv_own(face, slv_inside(uv), f)));
#endif
}

#else

// Per face, for each edge: the face across it; 16 bits a link, edges 0 and 1 in the first word:
//   bits 0-1   the adjacent edge
//   bits 2-3   kind: 0 boundary, 1 like to like, 2 whole quad to sub-faces, 3 sub-face to whole quad
//   bit 4      kind 2: there are two; kind 3: this is the second half of the whole quad's edge
//   bits 5-8   pool of the (first) neighbour
//   bits 9-12  pool of the second
//   bit 13     texels are of one size on both sides at the edge's start; bit 15 the same at its end
//   bit 14     the edge starts in the middle of a whole quad's edge: what lies across continues
//              straight past the corner, and nothing is missing there
struct slv_links {
    int face[4];
    uvec2 links;
    uint corners; // index of the first corner value
    uint levels;
};
layout(std430, binding = SLV_FIRST_STORAGE + 1) readonly buffer slv_links_block {
    slv_links slv_adjacent[];
};

// The value that all faces around a corner agree on: one for each level, for each of four corners.
layout(std430, binding = SLV_FIRST_STORAGE + 3) readonly buffer slv_corner_block {
    vec4 slv_corner[];
};

// One lookup of those that make up a value.
struct slv_site {
    int pool, face;
    vec2 uv;
    slv_footprint f;
    float along; // how far along the shared edge its filter reaches, the edge's length being 1; 2 if it is not beside the point
};

// How far the outermost tap is from the centre, as a part of the row's axis.
float slv_spread(slv_footprint f) {
#if SLV_TAPS || SLV_ANISOTROPY == 1
    return float(f.taps) / float(f.taps + 1) - 0.5;
#else
    return 0.5 - 0.5 / float(f.taps); // nearly: the sampler's own way of placing taps is not known exactly
#endif
}

#if SLV_VECTORS && SLV_STRATEGY != 5
// An index that is the same for a whole vector may select any array: one round for each that occurs among its fragments, which
// for neighbours across one edge is one.
slv_tap slv_fetch(slv_site site) {
    vec3 p = vec3(site.uv, float(slv_store[site.face].x >> 16));
    slv_tap sum = slv_tap(vec4(0.0), 0.0);
    bool waiting = !gl_HelperInvocation;
    do {
        int pool = readFirstInvocationARB(site.pool);
        if (pool == site.pool) {
#if SLV_TAPS
            int k = 1;
            do {
                slv_add(sum, SLV_LOOKUP(pool, p + vec3(slv_tap_offset(site.f, k), 0.0), site.f));
            } while (++k <= site.f.taps);
            sum = slv_tap(sum.color / float(site.f.taps), sum.coverage / float(site.f.taps));
#else
            sum = SLV_LOOKUP(pool, p, site.f);
#endif
            waiting = false;
        }
    } while (waiting);
    return sum;
}
#else
slv_tap slv_fetch_one(int pool, vec3 p, slv_footprint f) {
#if SLV_POOLS == 1
    return SLV_LOOKUP(0, p, f);
#else
    // an index that differs between fragments may only select among constants
    switch (pool) {
    case 0:
        return SLV_LOOKUP(0, p, f);
    case 1:
        return SLV_LOOKUP(1, p, f);
#if SLV_POOLS > 2
    case 2:
        return SLV_LOOKUP(2, p, f);
    case 3:
        return SLV_LOOKUP(3, p, f);
#endif
#if SLV_POOLS > 4
    case 4:
        return SLV_LOOKUP(4, p, f);
    case 5:
        return SLV_LOOKUP(5, p, f);
    case 6:
        return SLV_LOOKUP(6, p, f);
    case 7:
        return SLV_LOOKUP(7, p, f);
#endif
#if SLV_POOLS > 8
    case 8:
        return SLV_LOOKUP(8, p, f);
    case 9:
        return SLV_LOOKUP(9, p, f);
    case 10:
        return SLV_LOOKUP(10, p, f);
    case 11:
        return SLV_LOOKUP(11, p, f);
    case 12:
        return SLV_LOOKUP(12, p, f);
    case 13:
        return SLV_LOOKUP(13, p, f);
    case 14:
        return SLV_LOOKUP(14, p, f);
    case 15:
        return SLV_LOOKUP(15, p, f);
#endif
    }
    return slv_tap(vec4(0.0), 0.0);
#endif
}

slv_tap slv_fetch(slv_site site) {
    vec3 p = vec3(site.uv, float(slv_store[site.face].x >> 16));
#define SLV_POOL_LOOKUP(p, f) slv_fetch_one(site.pool, p, f)
    SLV_GATHER(SLV_POOL_LOOKUP, p, site.f);
}
#endif

vec2 slv_edge_origin(int edge) { // the corner where the edge starts
    return vec2(edge == 1 || edge == 2 ? 1.0 : 0.0, edge > 1 ? 1.0 : 0.0);
}
uint slv_link(uvec2 links, int edge) {
    uint word = edge < 2 ? links.x : links.y;
    return (edge & 1) == 0 ? word & 0xffffu : word >> 16;
}

bool slv_linked(uvec2 links, int edge) {
    return (slv_link(links, edge) & 12u) != 0u;
}

// A lookup in a neighbour; `scale` is the edge's length in units of the neighbour's and `end` where, along the neighbour's edge,
// this edge starts. Faces are turned against each other by quarters. The taps are this face's, so that the weights of all
// lookups add up to 1; their level is the neighbour's own.
slv_site slv_across(int pool, int face, int edge, int adjacent, float scale, float end, vec2 uv, slv_footprint f) {
    int turns = (adjacent - edge + 2) & 3;
    float c = (turns & 1) != 0 ? 0.0 : turns == 0 ? scale : -scale, s = (turns & 1) == 0 ? 0.0 : turns == 1 ? scale : -scale;
    mat2 across = mat2(c, s, -s, c);
    float signed_end = adjacent < 2 ? end : -end;
    vec2 along = (adjacent & 1) == 0 ? vec2(signed_end, 0.0) : vec2(0.0, signed_end);
    vec2 size = slv_face_size(face);
    f.dx = across * f.dx;
    f.dy = across * f.dy;
    f.axis = across * f.axis;
    float texels = max(length(f.dx * size), length(f.dy * size)) / float(f.taps);
    f.level = log2(max(texels, 1e-12));
    uv = across * (uv - slv_edge_origin(edge)) + slv_edge_origin(adjacent) + along;
    vec3 edge_wise = (adjacent & 1) == 0 ? vec3(uv.x, f.axis.x, size.x) : vec3(uv.y, f.axis.y, size.y);
    float reach = slv_spread(f) * abs(edge_wise.y) + 0.5 * max(texels, 1.0) / edge_wise.z;
    return slv_site(pool, face, uv, f, abs(edge_wise.x - 0.5) > 0.5001 ? 2.0 : min(reach / scale, 1.0));
}

// Across one edge; `second` asks for the second of two sub-faces, which lies across the first one's edge before the shared one.
slv_site slv_neighbour(int own, uvec2 links, int edge, bool second, vec2 uv, slv_footprint f) {
    uint link = slv_link(links, edge);
    uint kind = link >> 2 & 3u;
    int face = slv_adjacent[own].face[edge], adjacent = int(link & 3u);
    int pool = int(link >> 5 & 15u);
    float scale = kind == 3u ? 0.5 : kind == 2u ? 2.0 : 1.0;
    float end = kind == 3u && (link & 16u) == 0u ? 0.5 : 1.0;
#if SLV_SUBFACES
    if (second) {
        int before = (adjacent + 3) & 3;
        uint beside = slv_link(slv_adjacent[face].links, before);
        face = slv_adjacent[face].face[before];
        if (face < 0)
            return slv_site(-1, 0, vec2(0.0), f, 1.0); // its own batch had no room for that link
        adjacent = (int(beside & 3u) + 3) & 3;
        pool = int(link >> 9 & 15u);
        end = 2.0;
    }
#endif
    return slv_across(pool, face, edge, adjacent, scale, end, uv, f);
}

bool slv_same_at(uvec2 links, int edge, bool at_start) {
    return (slv_link(links, edge) & (at_start ? 0x2000u : 0x8000u)) != 0u;
}
bool slv_same_texels(uvec2 links, int edge) {
    return (slv_link(links, edge) & 0xa000u) == 0xa000u;
}

// Near a corner, from the lookups in the face and across the two edges that meet there. With t and s the parts of the filter
// that lie across the one edge and the other, and M the value at the vertex, bilinear interpolation is
//     (1 - s - t) own + t (1 - 2s) first + s (1 - 2t) second + 4 s t M,
// or, P being the values that the face and each neighbour make alone, (1 - t) own + t first and (1 - s) own + s second,
//     (1 - 2s) P_first + (1 - 2t) P_second - (1 - 2s)(1 - 2t) own + 4 s t M.
// The second form also joins P of faces whose texels are not alike. On the edge to the first neighbour, where 2t is 1, it is
// (1 - 2s) P_first + 2s M, which is the same seen from there if s is. So s there comes from both faces: what the two filters
// lack, or if their texels differ, as far as the smaller one's reach. Away from the edge it is the face's own.
struct slv_side {
    float weight; // of the neighbour in P
    float part;   // s or t in the face itself
    float agreed; // s or t on the other edge, as both faces there see it
    float near;   // 1 on the edge, 0 where the neighbour is no longer reached
};

vec4 slv_join_corner(vec4 own, vec4 first, vec4 second, slv_side a, slv_side b, vec4 vertex) {
    float t = 2.0 * mix(a.part, a.agreed, b.near), s = 2.0 * mix(b.part, b.agreed, a.near);
    vec4 k = vec4(0.0, (1.0 - s) * a.weight, (1.0 - t) * b.weight, s * t);
    k.x = 1.0 - (k.y + k.z + k.w);
    return k.x * own + k.y * first + k.z * second + k.w * vertex;
}

// Which edges a footprint crosses, and how far from them taps still leave the face: the row of taps, and half a texel of the coarser
// level.
struct slv_reach {
    bvec4 edges;
    vec2 extent;
    int corner;   // the nearest; its own edge and the one before meet there
    uint pending; // visits still to make: bit e across edge e, bit 4 + e to the second of two sub-faces there
};

// How far from its centre a footprint averages.
vec2 slv_extent(vec2 size, slv_footprint f) {
    return slv_spread(f) * abs(f.axis) + 0.5 * exp2(ceil(max(f.level, 0.0))) / size;
}

bvec4 slv_reached_edges(vec2 size, vec2 uv, slv_footprint f) {
#if SLV_TAPS || SLV_ANISOTROPY == 1
    vec2 reach = 1.002 * slv_extent(size, f);
#else
    vec2 reach = 0.5 * abs(f.axis) + exp2(ceil(max(f.level, 0.0))) / size;
#endif
    bvec2 low = lessThan(uv, reach), high = greaterThan(uv, 1.0 - reach);
    return bvec4(low.y, high.x, high.y, low.x);
}

slv_reach slv_reach_of(int face, uvec2 links, bvec4 edges, vec2 uv, vec2 extent) {
    slv_reach reach = slv_reach(edges, extent, uv.y < 0.5 ? (uv.x < 0.5 ? 0 : 1) : (uv.x < 0.5 ? 3 : 2), 0u);
    for (int e = 0; e < 4; e++) {
#if SLV_STRATEGY == 5
        bool linked = slv_adjacent[face].face[e] >= 0;
#else
        bool linked = slv_linked(links, e);
#endif
        if (edges[e] && linked) {
            reach.pending |= 1u << e;
#if SLV_SUBFACES
            if ((slv_link(links, e) >> 2 & 7u) == 6u)
                reach.pending |= 16u << e;
#endif
        }
    }
    return reach;
}

struct slv_sums {
    slv_tap own, first, second; // the face; across the two edges at the nearest corner, in their order
    slv_tap others, unlike;     // across the far edges, where texels are of one size and where not
    vec2 along;                 // how far the first and the second reach along their edges
#if SLV_SUBFACES
    slv_tap first_half, second_half; // of two sub-faces there, the one that is not beside the point
#endif
};

void slv_place(inout slv_sums sum, uvec2 links, int corner, int edge, slv_tap tap, float along) {
#if SLV_SUBFACES
    if (along > 1.0 && !slv_same_texels(links, edge)) {
        if (edge == corner) {
            slv_add(sum.first_half, tap);
            return;
        }
        if (edge == ((corner + 3) & 3)) {
            slv_add(sum.second_half, tap);
            return;
        }
    }
#endif
    if (edge == corner) {
        slv_add(sum.first, tap);
        sum.along.x = min(sum.along.x, along);
    } else if (edge == ((corner + 3) & 3)) {
        slv_add(sum.second, tap);
        sum.along.y = min(sum.along.y, along);
    } else if (slv_same_texels(links, edge)) {
        slv_add(sum.others, tap);
    } else {
        slv_add(sum.unlike, tap);
    }
}

slv_tap slv_at_most(slv_tap tap, float coverage) {
    return slv_scaled(tap, min(max(coverage, 0.0) / max(tap.coverage, 1e-6), 1.0));
}

float slv_part(slv_tap own, slv_tap other) {
    return other.coverage / max(own.coverage + other.coverage, 1e-6);
}

vec4 slv_total(int face, slv_sums sum, uvec2 links, slv_reach reach, vec2 uv, slv_footprint f) {
    int after = reach.corner, before = (reach.corner + 3) & 3;
    // the distance to the edge after the corner, and to that before it
    vec2 inside = min(uv, 1.0 - uv), extent = reach.extent;
    if ((after & 1) == 0) {
        inside = inside.yx;
        extent = extent.yx;
    }
    vec2 near = clamp(1.0 - inside / extent, 0.0, 1.0);
    // s and t as far as the smaller of two filters reaches
    vec2 smaller = 0.5 * clamp(1.0 - inside / min(extent, max(sum.along.yx, 1e-12)), 0.0, 1.0);
#if SLV_SUBFACES
    // the further of two sub-faces takes over at most what the nearer one leaves
    vec2 left = 0.25 * clamp(1.0 - (0.5 - inside.yx) / max(sum.along, 1e-12), 0.0, 1.0);
    slv_add(sum.first, slv_at_most(sum.first_half, left.x));
    slv_add(sum.second, slv_at_most(sum.second_half, left.y));
#endif

    // Neighbours with larger texels reach further into this face than its own filter reaches out: they get no more weight than is
    // missing, and none where the filter lies inside.
    bool same_first = slv_same_texels(links, after), same_second = slv_same_texels(links, before);
    bool passed = (slv_link(links, reach.corner) & 0x4000u) != 0u;
    if (passed)
        same_first = same_second = same_first && same_second; // three faces meet here, not twice two
    float exact = sum.own.coverage + sum.others.coverage + (same_first ? sum.first.coverage : 0.0) +
                  (same_second ? sum.second.coverage : 0.0);
    vec2 most = 0.5 * near;
    if (passed) {
        // beside the middle of a whole quad's edge the quad lies across one edge, the other sub-face across the other: on that
        // one both take the same from the quad, and on the quad's edge each what the other leaves
        bool quad_first = (slv_link(links, after) >> 2 & 3u) == 3u;
        float quad = quad_first ? mix(most.x, smaller.x, near.y) : mix(most.y, smaller.y, near.x);
        most = quad_first ? vec2(quad, most.y * (1.0 - quad)) : vec2(most.x * (1.0 - quad), quad);
    }
    most = min(most, vec2(1.0 - exact));
    sum.first = same_first ? sum.first : slv_at_most(sum.first, most.x);
    sum.second = same_second ? sum.second : slv_at_most(sum.second, most.y);
    float spare = (same_first ? 0.0 : sum.first.coverage) + (same_second ? 0.0 : sum.second.coverage);
    slv_add(sum.others, slv_at_most(sum.unlike, 1.0 - exact - spare));

    // what the far edges do not cover belongs to the corner
    float rest = 1.0 - sum.others.coverage;
    bool has_after = slv_linked(links, after), has_before = slv_linked(links, before);
    if (reach.edges[after] && reach.edges[before] && (has_after || has_before) && rest > 1e-3 && !passed) {
        uint levels = slv_adjacent[face].levels, start = slv_adjacent[face].corners + uint(reach.corner) * levels;
        float level = clamp(f.level, 0.0, float(levels - 1u));
        vec4 vertex = mix(slv_corner[start + uint(level)], slv_corner[start + min(uint(level) + 1u, levels - 1u)],
                          fract(level));
        // what two filters that are alike lack on their edge; where there is no neighbour, the same stands for the face's own part
        vec2 lacking = clamp(1.0 - (sum.own.coverage + vec2(sum.second.coverage, sum.first.coverage)) / rest, 0.0, 0.5);
        vec2 weights = vec2(slv_part(sum.own, sum.first), slv_part(sum.own, sum.second));
        vec2 agreed = vec2(slv_same_at(links, before, false) ? lacking.x : smaller.x,
                           slv_same_at(links, after, true) ? lacking.y : smaller.y);
        vec4 own = slv_resolve(sum.own);
        slv_side first = slv_side(weights.x, !has_after ? agreed.x : slv_same_at(links, after, true) ? weights.x : 0.5 * near.x,
                                  agreed.x, near.x);
        slv_side second = slv_side(weights.y, !has_before ? agreed.y : slv_same_at(links, before, false) ? weights.y : 0.5 * near.y,
                                   agreed.y, near.y);
        vec4 joined = slv_join_corner(own, sum.first.coverage > 0.0 ? slv_resolve(sum.first) : own,
                                      sum.second.coverage > 0.0 ? slv_resolve(sum.second) : own, first, second, vertex);
#if !SLV_SPLIT_COVERAGE
        joined.a = 1.0;
#endif
        return sum.others.color + rest * joined;
    }
    slv_add(sum.own, sum.first);
    slv_add(sum.own, sum.second);
    slv_add(sum.own, sum.others);
    return slv_resolve(sum.own);
}

vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {
    vec2 size = slv_face_size(face);
    uv = slv_inside(uv);
    slv_footprint f = slv_footprint_of(size, dx, dy);
    bvec4 edges = slv_reached_edges(size, uv, f);
#if SLV_STRATEGY == 4
    float crossing = clamp(1.0 - f.level / SLV_HYBRID_RANGE, 0.0, 1.0);
    edges = crossing > 0.0 ? edges : bvec4(false);
#endif
    slv_tap none = slv_tap(vec4(0.0), 0.0);
#if SLV_SUBFACES
    slv_sums sum = slv_sums(none, none, none, none, none, vec2(1.0), none, none);
#else
    slv_sums sum = slv_sums(none, none, none, none, none, vec2(1.0));
#endif
    uvec2 links = uvec2(0u);
#if SLV_STRATEGY == 5 // the plain form, which the other ways below are measured against
    links = slv_adjacent[face].links;
    sum.own = slv_own(face, uv, f);
    slv_reach reach = slv_reach_of(face, links, edges, uv, slv_extent(size, f));
    while (reach.pending != 0u) {
        int visit = findLSB(reach.pending), edge = visit & 3;
        reach.pending &= reach.pending - 1u;
        slv_site site = slv_neighbour(face, links, edge, visit > 3, uv, f);
        if (site.pool >= 0)
            slv_place(sum, links, reach.corner, edge, slv_fetch(site), site.along);
    }
    return slv_value(slv_total(face, sum, links, reach, uv, f));
#elif SLV_VECTORS
    // the face itself is the first round of the loop, so that fragments away from edges make no other
    if (any(edges))
        links = slv_adjacent[face].links;
    slv_reach reach = slv_reach_of(face, links, edges, uv, slv_extent(size, f));
    reach.pending = gl_HelperInvocation ? 0u : reach.pending;
    slv_site site = slv_site(0, face, uv, f, 1.0);
    int edge = -1;
    bool more;
    do {
        slv_tap tap = none;
        if (site.pool >= 0)
            tap = slv_fetch(site);
        if (edge < 0)
            sum.own = tap;
        else
            slv_place(sum, links, reach.corner, edge, tap, site.along);
        more = reach.pending != 0u;
        int visit = findLSB(reach.pending);
        edge = visit & 3;
        reach.pending &= reach.pending - 1u;
        site = slv_neighbour(face, links, edge, visit > 3, uv, f);
    } while (more);
    vec4 value = slv_total(face, sum, links, reach, uv, f);
#else
    sum.own = slv_own(face, uv, f);
    vec4 value = slv_resolve(sum.own);
    if (any(edges)) {
        links = slv_adjacent[face].links;
        slv_reach reach = slv_reach_of(face, links, edges, uv, slv_extent(size, f));
        if (reach.pending != 0u) {
            do {
                int visit = findLSB(reach.pending), edge = visit & 3;
                reach.pending &= reach.pending - 1u;
                slv_site site = slv_neighbour(face, links, edge, visit > 3, uv, f);
                if (site.pool >= 0)
                    slv_place(sum, links, reach.corner, edge, slv_fetch(site), site.along);
            } while (reach.pending != 0u);
            value = slv_total(face, sum, links, reach, uv, f);
        }
    }
#endif
#if SLV_STRATEGY == 4
    return slv_value(mix(slv_resolve(sum.own), value, crossing));
#elif SLV_STRATEGY == 2
    return slv_value(value);
#endif
}

#endif
#endif

vec4 slv_sample(int face, vec2 uv) {
    return slv_sample_grad(face, uv, dFdx(uv), dFdy(uv));
}
