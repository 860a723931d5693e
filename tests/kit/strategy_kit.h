/* Strategies by name, and lists of all and of one. */
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

static inline const slv_strategy *const *kit_strategies(void) {
    static const slv_strategy *list[KIT_STRATEGIES];
    REQUIRE(slv_strategy_count() <= KIT_STRATEGIES);
    for (uint32_t i = 0; i < slv_strategy_count(); i++)
        list[i] = slv_strategy_at(i);
    return list;
}

/* Members of slv_gl_texture_params. */
#define KIT_ALL .strategies = kit_strategies(), .nstrategies = slv_strategy_count()
#define KIT_ONLY(strategy) .strategies = (const slv_strategy *const[]){strategy}, .nstrategies = 1

#endif
