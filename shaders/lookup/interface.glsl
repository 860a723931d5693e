// What every strategy offers, and what it finds bound: array textures and the table of faces.
//
//   vec4 slv_sample(int face, vec2 uv)                           footprint from the screen-space derivatives of uv
//   vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy)    footprint given: the change of uv over one pixel
//   float slv_level(int face, vec2 dx, vec2 dy)                  the level of detail that such a lookup uses
//
// `face` is the face that is being drawn (a flat input), uv in 0..1 its own coordinates. slv_sample needs uniform control flow,
// as every function of implicit derivatives does. The result is RGBA in the texture's own space; with three channels or fewer
// alpha is 1. Nothing here divides by zero, whatever the helper pixels hold.
//
// Each strategy is a file in strategy/ that begins with the features it chooses, names the parts that it is made of, and defines
// slv_sample_grad. Parts depend on two kinds of definitions. The library defines for each program, as numbers:
//   SLV_POOLS           array textures bound; the batch's own is number 0, but for squares of edges
//   SLV_HANDLES         0, or which storage buffer after the first has handles of array textures, which are bound to no units then
//   SLV_SUBFACES        1 if faces of the batch are sub-faces or meet some
//   SLV_SPLIT_COVERAGE  1 if coverage has textures of its own (four-channel data)
//   SLV_ANISOTROPY      the most taps of a footprint
//   SLV_BORDER          texels of a border
//   SLV_FIRST_UNIT, SLV_FIRST_STORAGE    the first texture unit and the first storage buffer
//   SLV_CHUNK           0, or how many faces have their rows in what is bound of tables that are longer than a block may be:
//                       those whose ids agree above that power of two
//   SLV_TAPS            1 if anisotropic taps are made here and not by the sampler, which places them as it likes: the two sides of a
//                       seam then differ
//   SLV_VECTORS         1 if fragments run in vectors that only a loop's end can leave early (llvmpipe). Both sides of an `if` run
//                       there for all, every case of a `switch`, and the body of a loop once more than needed if its condition
//                       stands at the top
//   SLV_EXPLICIT        1 where there are no derivatives: slv_sample is left out, for vertex and compute shaders
//   SLV_SCALED          1 if texels are stored divided by SLV_SCALE, because sums of such large floats would overflow
//   SLV_EVEN            1 if levels are even: as long in u as in v, of which footprint.glsl tells
//   SLV_CONSTANTS       1 if there may be faces of one value, which have one texel whatever their size
//   SLV_BLACK           1 if the texture is black beyond its boundary: what the strategy defines is then renamed, and beyond.glsl
//                       takes away what lies there
//   SLV_TURNS           1 if the first two channels are a vector in each face's own frame: those of neighbours are turned
//   SLV_SHARED_PAGES    1 if several items may lie in one layer
//   SLV_OWN_ALPHA       with SLV_BLACK: 1 if alpha is a channel of the texels and not always 1
// A strategy may define features:
//   SLV_ONE_LEVEL       of levels side by side the nearest alone is looked up: bilinear filtering, with steps between levels
//   SLV_KEEPS_ROW       both sides of an edge look up the same texels: a footprint keeps its row of taps however small it is
//   SLV_EDGE_TAP        how long the tap of even levels on an edge is at least, as a part of the footprint (1/2). Less where sides of
//                       different texels meet exactly in edges and vertices when they are magnified, too

#if SLV_EXPLICIT
#define SLV_HELPER false
#else
#define SLV_HELPER gl_HelperInvocation
#endif

// Of the batches that a draw shows, the one that a fragment is of: a host's gl_DrawID, where one draw shows many.
int slv_draw = 0;

#if SLV_HANDLES
struct slv_handle_row {
    sampler2DArray pool[16], coverage[16];
};
layout(std430, binding = SLV_FIRST_STORAGE + SLV_HANDLES) readonly buffer slv_handles_block {
    slv_handle_row slv_handles[];
};
#define slv_pool slv_handles[slv_draw].pool
#define slv_coverage slv_handles[slv_draw].coverage
#else
layout(binding = SLV_FIRST_UNIT) uniform sampler2DArray slv_pool[SLV_POOLS];
#endif

#if SLV_CHUNK
#define SLV_ROW(face) ((face) & (SLV_CHUNK - 1))
#else
#define SLV_ROW(face) (face)
#endif

// Per face: pool | layer << 16 (or the number of its cell), and log2 width | log2 height << 8 | the edges beyond which it is black << 16 |
// whether it has one texel for all << 20.
layout(std430, binding = SLV_FIRST_STORAGE) readonly buffer slv_store_block {
    uvec2 slv_store[];
};

vec2 slv_face_size(int face) {
    uint res = slv_store[SLV_ROW(face)].y;
    return vec2(float(1u << (res & 255u)), float(1u << (res >> 8 & 255u)));
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

#if SLV_TURNS
// A vector, the first two channels, seen from axes against which its own are turned by so many quarters, counter-clockwise.
vec4 slv_turned(int turns, vec4 value) {
    vec2 once = (turns & 1) == 0 ? value.xy : vec2(-value.y, value.x);
    return vec4((turns & 2) == 0 ? once : -once, value.zw);
}
#endif

vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy); // the strategy's own

#if !SLV_EXPLICIT
vec4 slv_sample(int face, vec2 uv) {
    return slv_sample_grad(face, uv, dFdx(uv), dFdy(uv));
}
#endif

#if SLV_BLACK
#define slv_sample_grad slv_sample_repeated
vec4 slv_sample_grad(int face, vec2 uv, vec2 dx, vec2 dy);
#endif
