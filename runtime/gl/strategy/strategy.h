/* The strategies of the library: a file each, and a row here. */
#ifndef SLV_GL_STRATEGY_H
#define SLV_GL_STRATEGY_H

#include <selvage/gl_strategy.h>

/* In the order of help texts, reports and colours: a new one goes last. */
#define SLVI_STRATEGIES(ROW)                                                                       \
    ROW(clamp)                                                                                     \
    ROW(borders)                                                                                   \
    ROW(traverse)                                                                                  \
    ROW(discard)                                                                                   \
    ROW(hybrid)                                                                                    \
    ROW(traverse_full)                                                                             \
    ROW(edge_aligned)                                                                              \
    ROW(htex)

#define SLVI_STRATEGY_DECLARE(NAME) extern const slv_strategy slvi_strategy_##NAME;
SLVI_STRATEGIES(SLVI_STRATEGY_DECLARE)

#endif
