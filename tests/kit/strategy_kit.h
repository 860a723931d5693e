/* Strategies by name, and lists of one. */
#ifndef STRATEGY_KIT_H
#define STRATEGY_KIT_H

#include "kit/test.h"

#include <selvage/gl_strategy.h>

enum { KIT_STRATEGIES = 32 }; /* room for all in arrays */

static inline const slv_strategy *kit_strategy(const char *name) {
    const slv_strategy *strategy = slv_strategy_find(name);
    REQUIRE(strategy && slv_strategy_count() <= KIT_STRATEGIES);
    return strategy;
}

/* Members of slv_gl_texture_params. */
#define KIT_ONLY(strategy) .strategies = (const slv_strategy *const[]){strategy}, .nstrategies = 1

#endif
