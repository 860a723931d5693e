/* The strategies of strategy.h as a table. */
#include "gl/strategy/strategy.h"

#include <string.h>

#define ADDRESS(NAME) &slvi_strategy_##NAME,
static const slv_strategy *const table[] = {SLVI_STRATEGIES(ADDRESS)};

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

const slv_strategy *slv_strategy_default(void) {
    return &slvi_strategy_traverse;
}
