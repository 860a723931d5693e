/* The table of forms: a row each. */
#include <selvage/edge_aligned.h>
#include <selvage/form.h>
#include <selvage/htex.h>

#include <string.h>

static const slv_form *(*const table[])(void) = {
    slv_form_bare,
    slv_form_borders,
    slv_form_edge_aligned,
    slv_form_htex,
};

uint32_t slv_form_count(void) {
    return sizeof table / sizeof *table;
}

const slv_form *slv_form_at(uint32_t index) {
    return index < slv_form_count() ? table[index]() : NULL;
}

const slv_form *slv_form_find(const char *name) {
    for (uint32_t i = 0; i < slv_form_count(); i++)
        if (strcmp(slv_form_at(i)->name, name) == 0)
            return slv_form_at(i);
    return NULL;
}
