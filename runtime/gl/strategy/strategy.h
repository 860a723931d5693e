/* The strategies of the library, a file each. */
#ifndef SLV_GL_STRATEGY_H
#define SLV_GL_STRATEGY_H

#include <selvage/gl_strategy.h>

extern const slv_strategy slvi_strategy_clamp, slvi_strategy_borders, slvi_strategy_traverse,
    slvi_strategy_discard, slvi_strategy_hybrid, slvi_strategy_traverse_full,
    slvi_strategy_edge_aligned, slvi_strategy_htex;

#endif
