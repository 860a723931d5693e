// One value from the lookups in a face and its neighbours. (Needs reach.glsl, corner_values.glsl.)

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

struct slv_sums {
    slv_tap own, first, second; // the face; across the two edges at the nearest corner, in their order
    slv_tap others, unlike;     // across the far edges, where texels are of one size and where not
    vec2 along;                 // how far the first and the second reach along their edges
#if SLV_SUBFACES
    slv_tap first_half, second_half; // of two sub-faces there, the one that is not beside the point
#endif
};

slv_sums slv_no_sums() {
    slv_tap none = slv_tap(vec4(0.0), 0.0);
#if SLV_SUBFACES
    return slv_sums(none, none, none, none, none, vec2(1.0), none, none);
#else
    return slv_sums(none, none, none, none, none, vec2(1.0));
#endif
}

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

// The value that the faces around a corner agree on at a level. The finest levels of a face can all have the first one.
vec4 slv_vertex_value(uint where, float level, vec2 size) {
    float coarsest = log2(max(size.x, size.y));
    level = clamp(level, 0.0, coarsest);
    int first = int(slv_corner_first(where)), skip = int(where >> 27), fine = int(level);
    vec4 a = slv_corner[first + max(fine - skip, 0)];
    vec4 b = slv_corner[first + max(min(fine + 1, int(coarsest)) - skip, 0)];
    return mix(a, b, fract(level));
}

vec4 slv_total(int face, uvec2 links, vec2 size, slv_sums sum, slv_reach reach, vec2 uv, slv_footprint f) {
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
#if SLV_SUBFACES
    bool passed = (slv_link(links, reach.corner) & 0x4000u) != 0u;
    if (passed)
        same_first = same_second = same_first && same_second; // three faces meet here, not twice two
#else
    const bool passed = false;
#endif
    float exact = sum.own.coverage + sum.others.coverage + (same_first ? sum.first.coverage : 0.0) +
                  (same_second ? sum.second.coverage : 0.0);
    vec2 most = 0.5 * near;
#if SLV_SUBFACES
    if (passed) {
        // beside the middle of a whole quad's edge the quad lies across one edge, the other sub-face across the other: on that
        // one both take the same from the quad, and on the quad's edge each what the other leaves
        bool quad_first = (slv_link(links, after) >> 2 & 3u) == 3u;
        float quad = quad_first ? mix(most.x, smaller.x, near.y) : mix(most.y, smaller.y, near.x);
        most = quad_first ? vec2(quad, most.y * (1.0 - quad)) : vec2(most.x * (1.0 - quad), quad);
    }
#endif
    most = min(most, vec2(1.0 - exact));
    sum.first = same_first ? sum.first : slv_at_most(sum.first, most.x);
    sum.second = same_second ? sum.second : slv_at_most(sum.second, most.y);
    float spare = (same_first ? 0.0 : sum.first.coverage) + (same_second ? 0.0 : sum.second.coverage);
    slv_add(sum.others, slv_at_most(sum.unlike, 1.0 - exact - spare));

    // what the far edges do not cover belongs to the corner
    float rest = 1.0 - sum.others.coverage;
    bool has_after = slv_linked(links, after), has_before = slv_linked(links, before);
    if (reach.edges[after] && reach.edges[before] && (has_after || has_before) && rest > 1e-3 && !passed) {
        vec4 vertex = slv_vertex_value(slv_adjacent[SLV_ROW(face)].corners[reach.corner], f.level, size);
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
