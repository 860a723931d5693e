// Colour, and how much of a filter's weight fell on texels, where a sampler adds nothing beyond a face. (Needs footprint.glsl.)

#if SLV_SPLIT_COVERAGE && !SLV_HANDLES
layout(binding = SLV_FIRST_UNIT + SLV_POOLS) uniform sampler2DArray slv_coverage[SLV_POOLS];
#endif

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

#if SLV_CONSTANTS
// A face of one value has one texel: it is looked up in its middle, and what a filter covers of the face is computed. Returns that.
float slv_constant(bool constant, vec2 size, inout vec2 uv, inout slv_footprint f) {
    float covered = 1.0;
    if (constant) {
        covered = slv_within(size, bvec4(true), uv, f);
        uv = vec2(0.5);
        f = slv_footprint(vec2(0.0), vec2(0.0), vec2(0.0), 1, 0.0, 1.0);
    }
    return covered;
}
#endif

#if SLV_EVEN
// The levels at hand halve both sides of an oblong face. So a tap in an even level is a row of lookups along the longer side, at the
// level whose texels are as long along the shorter one: a row of n texels next to each other fades at an edge as one texel of n
// times the length does.
struct slv_rows {
    int fine, coarse; // lookups in the row of either level
    float part;       // of the coarser one
    float level;      // of a square, between levels
    vec2 size;
};

slv_rows slv_rows_of(vec2 size, slv_footprint f) {
    float coarsest = log2(max(size.x, size.y)), level = clamp(f.level, 0.0, coarsest), oblong = abs(log2(size.x / size.y));
    float part = level - floor(level);
    if (oblong < 0.5)
        return slv_rows(1, 0, 0.0, level, size);
    return slv_rows(int(exp2(min(floor(level), oblong)) + 0.5), part > 0.0 ? int(exp2(min(floor(level) + 1.0, oblong)) + 0.5) : 0,
                    part, floor(level), size);
}

// Lookup i of a tap: where it is from the tap's place, and at which level. Returns its weight.
float slv_row_lookup(slv_rows rows, int i, out vec2 offset, out float level) {
    offset = vec2(0.0);
    level = rows.level;
    if (rows.size.x == rows.size.y)
        return 1.0;
    bool fine = i < rows.fine;
    int count = fine ? rows.fine : rows.coarse, k = fine ? i : i - rows.fine;
    level = max(rows.level + (fine ? 0.0 : 1.0) - abs(log2(rows.size.x / rows.size.y)), 0.0);
    float step = exp2(level) / max(rows.size.x, rows.size.y);
    offset = (float(k) - 0.5 * float(count - 1)) * (rows.size.x > rows.size.y ? vec2(step, 0.0) : vec2(0.0, step));
    return (fine ? 1.0 - rows.part : rows.part) / float(count);
}
#endif

// A whole footprint, from one lookup where the sampler makes the taps.
#if SLV_EVEN
#define SLV_GATHER(sum, lookup, p, f, size)                                                        \
    slv_rows rows = slv_rows_of(size, f);                                                          \
    slv_footprint at = f;                                                                          \
    sum = slv_tap(vec4(0.0), 0.0);                                                                 \
    int k = 1;                                                                                     \
    do {                                                                                           \
        int i = 0;                                                                                 \
        do {                                                                                       \
            vec2 offset;                                                                           \
            float weight = slv_row_lookup(rows, i, offset, at.level);                              \
            vec3 place = p + vec3(offset + slv_tap_offset(f, k), 0.0);                             \
            slv_add(sum, slv_scaled(lookup(place, at), weight));                                   \
        } while (++i < rows.fine + rows.coarse);                                                   \
    } while (++k <= f.taps);                                                                       \
    sum = slv_scaled(sum, 1.0 / float(f.taps))
#elif SLV_TAPS
#define SLV_GATHER(sum, lookup, p, f, size)                                                        \
    sum = slv_tap(vec4(0.0), 0.0);                                                                 \
    int k = 1;                                                                                     \
    do {                                                                                           \
        slv_add(sum, lookup(p + vec3(slv_tap_offset(f, k), 0.0), f));                              \
    } while (++k <= f.taps);                                                                       \
    sum = slv_tap(sum.color / float(f.taps), sum.coverage / float(f.taps))
#else
#define SLV_GATHER(sum, lookup, p, f, size) sum = lookup(p, f)
#endif

slv_tap slv_own_taps(int face, vec2 size, vec2 uv, slv_footprint f) {
    vec3 p = vec3(uv, float(slv_store[SLV_ROW(face)].x >> 16));
#define SLV_OWN_LOOKUP(p, f) SLV_LOOKUP(0, p, f)
    slv_tap tap;
    SLV_GATHER(tap, SLV_OWN_LOOKUP, p, f, size);
#if SLV_ANISOTROPY > 1 && !SLV_TAPS
    if (tap.coverage < 1e-3) {
        // a sampler's row of taps need not have one in the centre, and all can miss a face that is smaller than their distance
        f.dx = f.dy = f.axis / float(f.taps);
        f.dy = vec2(-f.dy.y, f.dy.x);
        tap = SLV_OWN_LOOKUP(p, f);
    }
#endif
    return tap;
}

slv_tap slv_own(int face, vec2 uv, slv_footprint f) {
#if SLV_CONSTANTS
    bool constant = (slv_store[SLV_ROW(face)].y >> 20 & 1u) != 0u;
    float covered = slv_constant(constant, slv_face_size(face), uv, f);
    return slv_scaled(slv_own_taps(face, constant ? vec2(1.0) : slv_face_size(face), uv, f), covered);
#else
    return slv_own_taps(face, slv_face_size(face), uv, f);
#endif
}

vec4 slv_resolve(slv_tap tap) {
    return tap.color / max(tap.coverage, 1e-6);
}
