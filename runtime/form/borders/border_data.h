/* The mathematics of borders, shared by the border files. Values inside are raw: an integer texel
 * is its own number, 0..255 or 0..65535, so that sums and differences of equal resolutions are
 * exact; channels go in blocks, so that no call needs memory of its own. */
#ifndef SLV_TEXTURE_BORDER_H
#define SLV_TEXTURE_BORDER_H

#include "texture/texture_data.h"

#include <selvage/border.h>
#include <selvage/form.h>

#define SLV_BORDER_CHANNELS 16

/* A block of channels, first..first+count-1, of a chain of levels. */
typedef struct slv_border_view {
    const slv_levels *levels;
    const slv_adjacency *adjacency;
    uint32_t first, count;
    float one; /* the raw value that stands for 1 */
} slv_border_view;

slv_border_view slvi_border_view_begin(const slv_levels *levels, const slv_adjacency *adjacency);
/* Goes on to the next block of channels; false after the last. */
bool slvi_border_view_next(slv_border_view *view);

/* The texel's channels of this block, raw. */
void slvi_border_fetch(const slv_border_view *view, uint32_t face, uint32_t level, uint32_t x,
                       uint32_t y, float *out);

/* Turns the channels of this block, of a face whose axes are turned by so many quarters, to those
 * of the face that asks. Whatever a function here finds of a face is in that face's frame. */
static inline void slvi_border_turn(const slv_border_view *view, unsigned turns, float *raw) {
    if (view->levels->vectors && view->first == 0)
        slvi_edge_turn_vector(turns, &raw[0], &raw[1]);
}

/* How a face at some level meets a neighbour. EXACT: at a level with as long texels. COARSER: its
 * texels are longer, at level 0 or, of even levels, at one whose other side is as near as it gets.
 * FINER: the face's edge is a single texel and the neighbour a sub-face of half its length. */
typedef enum slv_border_relation {
    SLV_BORDER_EXACT,
    SLV_BORDER_COARSER,
    SLV_BORDER_FINER
} slv_border_relation;

typedef struct slv_border_link {
    slv_neighbour to;
    slv_border_relation relation;
    uint32_t level;      /* of the neighbour */
    slv_res res;         /* of that level */
    uint32_t own;        /* the level of the face itself whose texels count on the edge: this one,
                            or one as coarse as the finest of a neighbour's even levels */
    bool aligned;        /* EXACT, and its texels are as long across the edge too */
    float slope, offset; /* t of this face's edge to the neighbour's: slope * t + offset */
} slv_border_link;

/* An edge of a face at a level: 2^exponent texels, counted counter-clockwise, and who is across. */
typedef struct slv_border_edge {
    uint32_t face, level, edge, exponent;
    slv_res res;
    uint32_t nlinks;
    slv_border_link links[2];
} slv_border_edge;

/* What is across an edge, seen from the face that has the edge. */
static inline void slvi_border_turn_across(const slv_border_view *view, const slv_border_edge *edge,
                                           const slv_border_link *link, float *raw) {
    slvi_border_turn(view, slvi_edge_turns(edge->edge, link->to.edge), raw);
}

slv_border_edge slvi_border_edge_at(const slv_border_view *view, uint32_t face, uint32_t level,
                                    uint32_t edge);

/* The level of the face across at which the vertex between two sub-faces there has the value that
 * the edge has at it: all levels 0 agree, also where the levels that meet do not. */
uint32_t slvi_border_corner_level(const slv_border_view *view, const slv_border_edge *edge,
                                  const slv_border_link *link);

/* Where the centre of the texel at index j is along an edge. */
static inline float slvi_border_centre(uint32_t exponent, uint32_t j) {
    return ((float)j + 0.5f) / (float)(UINT32_C(1) << exponent);
}

/* The texel at index j of the outermost row along an edge, raw. */
void slvi_border_fetch_row(const slv_border_view *view, uint32_t face, uint32_t level, slv_res res,
                           uint32_t edge, uint32_t j, float *out);

/* The neighbour's edge index that index j meets: floor of where its centre falls. */
uint32_t slvi_border_link_index(const slv_border_edge *edge, const slv_border_link *link,
                                uint32_t j);
/* The link that index j meets, or NULL at a boundary. */
const slv_border_link *slvi_border_link_at(const slv_border_edge *edge, uint32_t j);

/* Walks along a coarser neighbour's edge function E: the knots are its texel centres and its ends.
 */
typedef struct slv_border_function {
    slv_border_edge edge; /* the coarser face's */
    int32_t index[2];     /* which knots the two values are of; -2 is none yet */
    float value[2][SLV_BORDER_CHANNELS];
} slv_border_function;

void slvi_border_function_begin(const slv_border_view *view, const slv_border_link *link,
                                slv_border_function *out);
void slvi_border_function_at(const slv_border_view *view, slv_border_function *function, float t,
                             float *out);

/* The face's own texel at index j that counts on the edge beside a link (NULL at a boundary), raw,
 * where it is not the neighbour that decides. */
void slvi_border_own(const slv_border_view *view, const slv_border_edge *edge,
                     const slv_border_link *link, uint32_t j, float *out);
/* The neighbour's own texel where index j meets it, or the face's own if link is NULL, raw. */
void slvi_border_edge_from(const slv_border_view *view, const slv_border_edge *edge,
                           const slv_border_link *link, uint32_t j, float *out);
/* What is across the single texel of an edge that meets two sub-faces, raw: half of each, its own
 * texel where one is missing. */
void slvi_border_across_two(const slv_border_view *view, const slv_border_edge *edge, float *out);
/* The innermost border texel across an edge at index j, raw. */
void slvi_border_across(const slv_border_view *view, const slv_border_edge *edge, uint32_t j,
                        float *out);

/* The agreed value M of a vertex, raw. `opposite` (may be NULL) receives the texel diagonally
 * across where the vertex has four faces that all meet at equal resolution, and says so. */
bool slvi_border_vertex_value(const slv_border_view *view, uint32_t face, uint32_t level,
                              uint32_t corner, float *out, float *opposite);

/* Around a corner at which four squares of one resolution meet, the opposite one, whose texel is
 * the border's there at every level: most corners are such. NULL at others. */
const slv_corner *slvi_border_opposite(const slv_levels *levels, const slv_adjacency *adjacency,
                                       uint32_t face, uint32_t corner);

/* Whether levels can meet around a vertex: false where oblong resolutions contradict each other, so
 * that going once around it from level to level ends at another one. */
bool slvi_border_vertex_fits(const slv_border_view *view, uint32_t face, uint32_t corner);

/* The whole quad, and its edge, in whose middle a corner of two sub-faces lies, if it is one; and
 * how its axes are turned as the face sees them (may be NULL). */
bool slvi_border_quad_past(const slv_border_view *view, uint32_t face, uint32_t corner,
                           uint32_t *quad, uint32_t *edge, unsigned *turns);

/* slv_border_build without the level's own texels. */
slv_result slvi_border_build_rim(const slv_levels *levels, const slv_adjacency *adjacency,
                                 uint32_t face, uint32_t level, slv_form_extent extent, float *out,
                                 bool *out_of_range);

/* d = 4M - a - b - e, in an order that leaves a constant as it is. */
static inline float slv_border_diagonal(float m, float a, float b, float e) {
    return m + ((m - a) + (m - b) + (m - e));
}

#endif
