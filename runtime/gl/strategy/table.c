/* The table of strategies: a row each. */
#include "gl/strategy/strategy.h"

#include <string.h>

static const slv_strategy *const table[] = {
    &slvi_strategy_clamp,        &slvi_strategy_borders, &slvi_strategy_traverse,
    &slvi_strategy_discard,      &slvi_strategy_hybrid,  &slvi_strategy_traverse_full,
    &slvi_strategy_edge_aligned, &slvi_strategy_htex,
};

uint32_t slv_strategy_count(void) {
    return sizeof table / sizeof *table;
}

const slv_strategy *slv_strategy_at(uint32_t index) {
    return index < slv_strategy_count() ? table[index] : NULL;
}

const slv_strategy *slv_strategy_find(const char *name) {
    for (uint32_t i = 0; i < slv_strategy_count(); i++)
        if (strcmp(table[i]->name, name) == 0)
            return table[i];
    return NULL;
}
