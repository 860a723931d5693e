// Colour, and how much of a filter's weight fell on texels, where a sampler adds nothing beyond a face. (Needs footprint.glsl.)

#if SLV_SPLIT_COVERAGE
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
        f = slv_footprint(vec2(0.0), vec2(0.0), vec2(0.0), 1, 0.0);
    }
    return covered;
}
#endif

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

slv_tap slv_own_taps(int face, vec2 uv, slv_footprint f) {
    vec3 p = vec3(uv, float(slv_store[SLV_ROW(face)].x >> 16));
#define SLV_OWN_LOOKUP(p, f) SLV_LOOKUP(0, p, f)
#if SLV_ANISOTROPY > 1 && !SLV_TAPS
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

slv_tap slv_own(int face, vec2 uv, slv_footprint f) {
#if SLV_CONSTANTS
    bool constant = (slv_store[SLV_ROW(face)].y >> 20 & 1u) != 0u;
    float covered = slv_constant(constant, slv_face_size(face), uv, f);
    return slv_scaled(slv_own_taps(face, uv, f), covered);
#else
    return slv_own_taps(face, uv, f);
#endif
}

vec4 slv_resolve(slv_tap tap) {
    return tap.color / max(tap.coverage, 1e-6);
}
