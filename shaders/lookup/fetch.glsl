// Lookups in any of the array textures, not in number 0 alone. (Needs coverage.glsl; vectors.glsl first of all.)

// One lookup of those that make up a value.
struct slv_site {
    int pool;
    float layer;
    vec2 uv;
    slv_footprint f;
    float along; // how far along the shared edge its filter reaches, the edge's length being 1; 2 if it is not beside the point
    bool constant; // of one value
    vec2 size;
    int turns; // quarters that its face's axes are turned by, counter-clockwise, as the one that is drawn sees them
};

// How far the outermost tap is from the centre, as a part of the row's axis.
float slv_spread(slv_footprint f) {
#if SLV_TAPS || SLV_ANISOTROPY == 1
    return float(f.taps) / float(f.taps + 1) - 0.5;
#else
    return 0.5 - 0.5 / float(f.taps); // nearly: the sampler's own way of placing taps is not known exactly
#endif
}

#if SLV_VECTORS
// An index that is the same for a whole vector may select any array: one round for each that occurs among its fragments, which
// for neighbours across one edge is one.
slv_tap slv_fetch_site(slv_site site) {
    vec3 p = vec3(site.uv, site.layer);
    slv_tap sum = slv_tap(vec4(0.0), 0.0);
    bool waiting = !SLV_HELPER;
    do {
        int pool = readFirstInvocationARB(site.pool);
        if (pool == site.pool) {
#define SLV_VECTOR_LOOKUP(p, f) SLV_LOOKUP(pool, p, f)
            SLV_GATHER(sum, SLV_VECTOR_LOOKUP, p, site.f, site.size);
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

slv_tap slv_fetch_site(slv_site site) {
    vec3 p = vec3(site.uv, site.layer);
#define SLV_POOL_LOOKUP(p, f) slv_fetch_one(site.pool, p, f)
    slv_tap sum;
    SLV_GATHER(sum, SLV_POOL_LOOKUP, p, site.f, site.size);
    return sum;
}
#endif

slv_tap slv_fetch(slv_site site) {
#if SLV_CONSTANTS
    float covered = slv_constant(site.constant, site.size, site.uv, site.f);
    site.size = site.constant ? vec2(1.0) : site.size;
    slv_tap tap = slv_scaled(slv_fetch_site(site), covered);
#else
    slv_tap tap = slv_fetch_site(site);
#endif
#if SLV_TURNS
    tap.color = slv_turned(site.turns, tap.color);
#endif
    return tap;
}
