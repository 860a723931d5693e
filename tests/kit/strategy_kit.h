/* Strategies by name, and lists of all and of one. */
#ifndef STRATEGY_KIT_H
#define STRATEGY_KIT_H

#include "kit/test.h"

#include <selvage/gl_context.h>
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

/* What lookups may be off where texels lie elsewhere in an array: samplers of GPUs weigh in steps
 * of 1/256, and another rounding of the place is another step. */
static inline float kit_weight_step(const slv_gl *gl) {
    return slv_gl_get_info(gl)->software ? 0 : 1.0f / 256;
}

/* Members of slv_gl_texture_params. */
#define KIT_ALL .strategies = kit_strategies(), .nstrategies = slv_strategy_count()
#define KIT_ONLY(strategy) .strategies = (const slv_strategy *const[]){strategy}, .nstrategies = 1

#endif
