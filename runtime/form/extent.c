/* How large the levels of a form are. */
#include "form/faces.h"

#include "texture/texture_data.h"

slv_form_extent slvi_form_extent(const slv_form *form, slv_res res, uint32_t level, uint32_t border,
                                 bool even) {
    slv_res r = slvi_res_level(res, level, even);
    slv_form_extent out = {.width = 1u << r.u, .height = 1u << r.v};
    if (form->borders) {
        out.border_u = border < out.width ? border : out.width;
        out.border_v = border < out.height ? border : out.height;
    }
    out.width += 2 * out.border_u + form->samples;
    out.height += 2 * out.border_v + form->samples;
    return out;
}

slv_form_extent slv_form_level_extent(const slv_form *form, slv_res res, uint32_t level,
                                      uint32_t border) {
    return slvi_form_extent(form, res, level, border, false);
}

slv_form_extent slv_form_even_extent(const slv_form *form, slv_res res, uint32_t level,
                                     uint32_t border) {
    return slvi_form_extent(form, res, level, border, true);
}
