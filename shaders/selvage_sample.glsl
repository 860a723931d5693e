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
//   SLV_STRATEGY        0 clamp, 1 borders, 2 traverse, 3 discard
//   SLV_POOLS           array textures bound; the batch's own is number 0
//   SLV_SUBFACES        1 if a face of the batch has two sub-faces across one edge
//   SLV_SPLIT_COVERAGE  1 if coverage has textures of its own (four-channel data)
//   SLV_ANISOTROPY, SLV_BORDER, SLV_FIRST_UNIT, SLV_FIRST_STORAGE
//   SLV_TAPS            1 if anisotropic taps are made here and not by the sampler: software drivers take the long axis of a
//                       footprint from the coordinates of neighbouring fragments, whatever derivatives they are given

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

// What a lookup averages: an anisotropic footprint is a row of isotropic ones along its longer side (the definition of
// EXT_texture_filter_anisotropic).
struct slv_footprint {
    vec2 dx, dy;
    vec2 axis; // the longer side
    int taps;
    float level; // of each tap
};

slv_footprint slv_footprint_of(vec2 size, vec2 dx, vec2 dy) {
    float px = length(dx * size), py = length(dy * size);
    float longest = max(px, py), shortest = min(px, py);
    int taps = int(clamp(ceil(longest / max(shortest, 1e-12)), 1.0, float(SLV_ANISOTROPY)));
#if SLV_TAPS
    taps |= 1; // an odd number has one in the centre, which the face cannot miss however small it is
#endif
    return slv_footprint(dx, dy, px > py ? dx : dy, taps, log2(max(longest / float(taps), 1e-12)));
}

// Where tap k = 1.. of a footprint lies, relative to its centre.
vec2 slv_tap_offset(slv_footprint f, int k) {
    return f.axis * (float(k) / float(f.taps + 1) - 0.5);
}

float slv_level(int face, vec2 dx, vec2 dy) {
    vec2 size = slv_face_size(face);
    return clamp(slv_footprint_of(size, dx, dy).level, 0.0, log2(max(size.x, size.y)));
}

#if SLV_STRATEGY == 1

// Per pool and level: the part of a layer that the level's texels fill without their border, as scale and offset.
layout(std430, binding = SLV_FIRST_STORAGE + 2) readonly buffer slv_rect_block {
    vec4 slv_rect[];
};

vec4 slv_bordered_level(uint pool, float layer, int level, vec2 size, vec2 uv, slv_footprint f) {
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
    for (int k = 1; k <= f.taps; k++)
        sum += textureLod(slv_pool[0], p + vec3(slv_tap_offset(f, k) * scale, 0.0), 0.0);
    return sum / float(f.taps);
#else
    return textureGrad(slv_pool[0], p, f.dx * scale, f.dy * scale);
#endif
#endif
}

vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {
    uvec2 store = slv_store[face];
    uint pool = store.x & 0xffffu;
    float layer = float(store.x >> 16);
    vec2 size = slv_face_size(face);
    slv_footprint f = slv_footprint_of(size, dx, dy);
    float coarsest = log2(max(size.x, size.y));
    float level = clamp(f.level, 0.0, coarsest);
    float fine = floor(level);
    uv = clamp(uv, 0.0, 1.0);
    vec4 a = slv_bordered_level(pool, layer, int(fine), size, uv, f);
    vec4 b = slv_bordered_level(pool, layer, int(min(fine + 1.0, coarsest)), size, uv, f);
    return mix(a, b, level - fine);
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
    for (int k = 1; k <= f.taps; k++)                                                              \
        slv_add(sum, lookup(p + vec3(slv_tap_offset(f, k), 0.0), f));                              \
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
    return slv_own(face, clamp(uv, 0.0, 1.0), f).color;
#else
    return slv_resolve(slv_own(face, clamp(uv, 0.0, 1.0), f));
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
    ivec4 face;
    uint links01, links23;
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

slv_tap slv_fetch(int pool, int face, vec2 uv, slv_footprint f) {
    vec3 p = vec3(uv, float(slv_store[face].x >> 16));
#define SLV_POOL_LOOKUP(p, f) slv_fetch_one(pool, p, f)
    SLV_GATHER(SLV_POOL_LOOKUP, p, f);
}

// An edge's own frame: x runs along the edge counter-clockwise from 0 to 1, y points out of the face.
mat2 slv_edge_axes(int edge) { // columns: what u and v contribute
    return edge == 0   ? mat2(1, 0, 0, -1)
           : edge == 1 ? mat2(0, 1, 1, 0)
           : edge == 2 ? mat2(-1, 0, 0, 1)
                       : mat2(0, -1, -1, 0);
}
vec2 slv_edge_origin(int edge) { // the corner where the edge starts
    return edge == 0 ? vec2(0, 0) : edge == 1 ? vec2(1, 0) : edge == 2 ? vec2(1, 1) : vec2(0, 1);
}
vec2 slv_to_edge(int edge, vec2 uv) {
    return slv_edge_axes(edge) * (uv - slv_edge_origin(edge));
}

uint slv_link(slv_links links, int edge) {
    uint word = edge < 2 ? links.links01 : links.links23;
    return (edge & 1) == 0 ? word & 0xffffu : word >> 16;
}

// A lookup in a neighbour: p in the frame of this face's edge; `scale` the edge's length in units of the neighbour's and `end`
// where, in the neighbour's frame, the edge's start lies. The axes matrices are their own inverses up to transposition. The taps
// are this face's, so that the weights of all lookups add up to 1; their level is the neighbour's own.
slv_tap slv_across(int pool, int face, int edge, int adjacent, float scale, float end, vec2 p, slv_footprint f) {
    mat2 back = transpose(slv_edge_axes(adjacent)) * -scale;
    mat2 across = back * slv_edge_axes(edge);
    vec2 uv = back * (p - vec2(end / scale, 0.0)) + slv_edge_origin(adjacent);
    vec2 size = slv_face_size(face);
    f.dx = across * f.dx;
    f.dy = across * f.dy;
    f.axis = across * f.axis;
    f.level = log2(max(max(length(f.dx * size), length(f.dy * size)) / float(f.taps), 1e-12));
    return slv_fetch(pool, face, uv, f);
}

// Across one edge; `second` asks for the second of two sub-faces, which lies across the first one's edge before the shared one.
slv_tap slv_neighbour(slv_links links, int edge, bool second, vec2 uv, slv_footprint f) {
    uint link = slv_link(links, edge);
    uint kind = link >> 2 & 3u;
    int face = links.face[edge], adjacent = int(link & 3u);
    int pool = int(link >> 5 & 15u);
    float scale = kind == 3u ? 0.5 : kind == 2u ? 2.0 : 1.0;
    float end = kind == 3u && (link & 16u) == 0u ? 0.5 : 1.0;
#if SLV_SUBFACES
    if (second) {
        int before = (adjacent + 3) & 3;
        uint beside = slv_link(slv_adjacent[face], before);
        face = slv_adjacent[face].face[before];
        if (face < 0)
            return slv_tap(vec4(0.0), 0.0); // its own batch had no room for that link
        adjacent = (int(beside & 3u) + 3) & 3;
        pool = int(link >> 9 & 15u);
        end = 2.0;
    }
#endif
    return slv_across(pool, face, edge, adjacent, scale, end, slv_to_edge(edge, uv), f);
}

bool slv_same_at(slv_links links, int edge, bool at_start) {
    return links.face[edge] >= 0 && (slv_link(links, edge) & (at_start ? 0x2000u : 0x8000u)) != 0u;
}
bool slv_same_texels(slv_links links, int edge) {
    return (slv_link(links, edge) & 0xa000u) == 0xa000u;
}

// Near a corner, from the lookups in the face and across the two edges that meet there. With t and s the parts of the filter
// that lie across the one edge and the other, and M the value at the vertex, bilinear interpolation is
//     (1 - s - t) own + t (1 - 2s) first + s (1 - 2t) second + 4 s t M.
// Coverage gives s and t, exactly so beside a neighbour whose texels are as large as the face's own; on an edge between two such
// faces both sides must use those. Away from the edge, where texels differ, the pair's own weights must come out.
vec4 slv_blend_corner(slv_tap own, slv_tap first, slv_tap second, bool same_first, bool same_second, bool has_first,
                      bool has_second, vec4 vertex) {
    vec4 a = slv_resolve(own);
    vec4 b = has_first && first.coverage > 0.0 ? slv_resolve(first) : a;
    vec4 c = has_second && second.coverage > 0.0 ? slv_resolve(second) : a;
    float across_second = 1.0 - (own.coverage + first.coverage), across_first = 1.0 - (own.coverage + second.coverage);
    float t = has_first ? first.coverage / max(own.coverage + first.coverage, 1e-6) : across_first;
    float s = has_second ? second.coverage / max(own.coverage + second.coverage, 1e-6) : across_second;
    s = clamp(s, 0.0, 0.5);
    t = clamp(t, 0.0, 0.5);
    float exact_s = same_first ? clamp(across_second, 0.0, 0.5) : s;
    float exact_t = same_second ? clamp(across_first, 0.0, 0.5) : t;
    float blended_s = mix(s, exact_s, 2.0 * t);
    float blended_t = mix(t, exact_t, 2.0 * s);
    s = blended_s;
    t = blended_t;
    return (1.0 - s - t) * a + t * (1.0 - 2.0 * s) * b + s * (1.0 - 2.0 * t) * c + 4.0 * s * t * vertex;
}

vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy) {
    slv_links links = slv_adjacent[face];
    vec2 size = slv_face_size(face);
    uv = clamp(uv, 0.0, 1.0);
    slv_footprint f = slv_footprint_of(size, dx, dy);
    slv_tap own = slv_own(face, uv, f);

    // how far from an edge taps still leave the face: the row of taps, and half a texel of the coarser level
#if SLV_TAPS || SLV_ANISOTROPY == 1
    float spread = float(f.taps) / float(f.taps + 1) - 0.5, halves = 0.501;
#else
    float spread = 0.5, halves = 1.0; // the sampler's own way of placing taps is not known exactly
#endif
    vec2 reach = spread * abs(f.axis) + halves * exp2(ceil(max(f.level, 0.0))) / size;
    bvec2 low = lessThan(uv, reach), high = greaterThan(uv, 1.0 - reach);
    bvec4 reached = bvec4(low.y, high.x, high.y, low.x); // by edge
    int corner = uv.y < 0.5 ? (uv.x < 0.5 ? 0 : 1) : (uv.x < 0.5 ? 3 : 2);
    int after = corner, before = (corner + 3) & 3; // the edges that meet there

    // one loop over what is reached, so that interior fragments skip it all and the lookup's code exists once
    uint pending = 0u;
    for (int e = 0; e < 4; e++) {
        if (reached[e] && links.face[e] >= 0) {
            pending |= 1u << e;
#if SLV_SUBFACES
            if ((slv_link(links, e) >> 2 & 7u) == 6u)
                pending |= 16u << e;
#endif
        }
    }
    slv_tap none = slv_tap(vec4(0.0), 0.0);
    slv_tap first = none, second = none, others = none, unlike = none;
    while (pending != 0u) {
        int visit = findLSB(pending), edge = visit & 3;
        pending &= pending - 1u;
        slv_tap tap = slv_neighbour(links, edge, visit > 3, uv, f);
        if (edge == after)
            slv_add(first, tap);
        else if (edge == before)
            slv_add(second, tap);
        else if (slv_same_texels(links, edge))
            slv_add(others, tap);
        else
            slv_add(unlike, tap);
    }

    // Neighbours with larger texels reach further into this face than its own filter reaches out: together they get no more
    // weight than is missing, so that their influence ends where the filter lies inside.
    bool same_first = slv_same_texels(links, after), same_second = slv_same_texels(links, before);
    float exact = own.coverage + others.coverage + (same_first ? first.coverage : 0.0) + (same_second ? second.coverage : 0.0);
    float spare = unlike.coverage + (same_first ? 0.0 : first.coverage) + (same_second ? 0.0 : second.coverage);
    float share = clamp((1.0 - exact) / max(spare, 1e-6), 0.0, 1.0);
    first = same_first ? first : slv_scaled(first, share);
    second = same_second ? second : slv_scaled(second, share);
    slv_add(others, slv_scaled(unlike, share));

    // what the far edges do not cover belongs to the corner
    float rest = 1.0 - others.coverage;
    bool has_after = links.face[after] >= 0, has_before = links.face[before] >= 0;
    bool passed = (slv_link(links, corner) & 0x4000u) != 0u;
    if (reached[after] && reached[before] && (has_after || has_before) && rest > 1e-3 && !passed) {
        float level = clamp(f.level, 0.0, float(links.levels - 1u));
        uint start = links.corners + uint(corner) * links.levels;
        vec4 vertex = mix(slv_corner[start + uint(level)], slv_corner[start + min(uint(level) + 1u, links.levels - 1u)],
                          fract(level));
        vec4 near = slv_blend_corner(slv_scaled(own, 1.0 / rest), slv_scaled(first, 1.0 / rest),
                                     slv_scaled(second, 1.0 / rest), slv_same_at(links, after, true),
                                     slv_same_at(links, before, false), has_after, has_before, vertex);
#if !SLV_SPLIT_COVERAGE
        near.a = 1.0;
#endif
        return others.color + rest * near;
    }
    slv_add(own, first);
    slv_add(own, second);
    slv_add(own, others);
    return slv_resolve(own);
}

#endif
#endif

vec4 slv_sample(int face, vec2 uv) {
    return slv_sample_grad(face, uv, dFdx(uv), dFdy(uv));
}
