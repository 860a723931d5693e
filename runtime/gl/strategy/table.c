/* The strategies of strategy.h as a table, and words for what they choose among. */
#include "gl/strategy/strategy.h"

#include "base/names.h"

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

const char *slv_gl_packing_name(slv_gl_packing packing) {
    static const char *const names[] = {"layers", "pages"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)packing);
}

const char *slv_gl_wrapping_name(slv_gl_wrapping wrapping) {
    static const char *const names[] = {"clamp", "zero", "mirror"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)wrapping);
}

const char *slv_gl_reach_kind_name(slv_gl_reach_kind kind) {
    static const char *const names[] = {"own", "neighbours", "squares"};
    return slvi_name_of(names, SLVI_COUNT(names), (int)kind);
}
