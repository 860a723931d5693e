/* What the table of actions calls: one function for each, which changes the model and nothing that
 * shows it. */
#ifndef SELVAGE_STUDIO_COMMANDS_H
#define SELVAGE_STUDIO_COMMANDS_H

#include "studio/studio.h"

typedef void (*studio_command)(studio_app *app, const char *target);
/* The value that is chosen, a word; of what is on or off NULL for off. */
typedef const char *(*studio_state)(const studio_app *app);

/* What actions that change the document share: after something was done to it, well or not; its
 * layers, with a session made if need be, or NULL when it has been said why there are none; the one
 * that is painted on; the face under the pointer. */
void studio_edited(studio_app *app, slv_result result);
slv_document *studio_layers_of(studio_app *app);
bool studio_layer_now(const studio_app *app, slv_layer_info *info, uint32_t *index);
bool studio_face_under(studio_app *app, slv_paint_hit *hit);

void studio_do_undo(studio_app *app, const char *target);
void studio_do_stroke_stop(studio_app *app, const char *target);
void studio_do_redo(studio_app *app, const char *target);
void studio_do_history(studio_app *app, const char *target);
void studio_do_layer_add(studio_app *app, const char *target);
void studio_do_layer_duplicate(studio_app *app, const char *target);
void studio_do_layer_remove(studio_app *app, const char *target);
void studio_do_layer_raise(studio_app *app, const char *target);
void studio_do_layer_lower(studio_app *app, const char *target);
void studio_do_layer_merge(studio_app *app, const char *target);
void studio_do_layer_hide(studio_app *app, const char *target);
void studio_do_layer_lock(studio_app *app, const char *target);
void studio_do_layer_show(studio_app *app, const char *target);
void studio_do_layer_name(studio_app *app, const char *target);
void studio_do_layer_opacity(studio_app *app, const char *target);
void studio_do_layer_blend(studio_app *app, const char *target);
void studio_set_layer(studio_app *app, const char *target);
void studio_do_mask_add(studio_app *app, const char *target);
void studio_do_mask_remove(studio_app *app, const char *target);
void studio_do_mask_paint(studio_app *app, const char *target);
void studio_do_texels_more(studio_app *app, const char *target);
void studio_do_texels_fewer(studio_app *app, const char *target);
void studio_do_faces_finer(studio_app *app, const char *target);
void studio_do_faces_coarser(studio_app *app, const char *target);
void studio_do_faces_density(studio_app *app, const char *target);
void studio_do_density_take(studio_app *app, const char *target);
void studio_do_density_more(studio_app *app, const char *target);
void studio_do_density_less(studio_app *app, const char *target);
void studio_do_density_none(studio_app *app, const char *target);
void studio_do_select_none(studio_app *app, const char *target);
void studio_do_select_face(studio_app *app, const char *target);
void studio_fill(studio_app *app, uint32_t face, slv_select select,
                 const studio_gradient *gradient);
void studio_do_fill_face(studio_app *app, const char *target);
void studio_do_fill_gradient(studio_app *app, const char *target);
void studio_do_gradient_round(studio_app *app, const char *target);
const char *studio_get_gradient_round(const studio_app *app);
void studio_do_colors_swap(studio_app *app, const char *target);
void studio_set_tool(studio_app *app, const char *target);
void studio_do_pick_color(studio_app *app, const char *target);
void studio_do_stencil(studio_app *app, const char *target);
void studio_do_stencil_path(studio_app *app, const char *target);
void studio_do_stencil_none(studio_app *app, const char *target);
void studio_do_color(studio_app *app, const char *target);
void studio_do_swatch_add(studio_app *app, const char *target);
void studio_do_brush_larger(studio_app *app, const char *target);
void studio_do_brush_smaller(studio_app *app, const char *target);
void studio_do_mirror(studio_app *app, const char *target);
void studio_do_project(studio_app *app, const char *target);
void studio_set_brush(studio_app *app, const char *target);
void studio_do_discard(studio_app *app, const char *target);
void studio_do_quit(studio_app *app, const char *target);
void studio_do_open_path(studio_app *app, const char *target);
void studio_do_open(studio_app *app, const char *target);
void studio_do_open_cancel(studio_app *app, const char *target);
void studio_do_open_session(studio_app *app, const char *target);
void studio_do_save_to(studio_app *app, const char *target);
void studio_do_save_as(studio_app *app, const char *target);
void studio_do_save(studio_app *app, const char *target);
void studio_do_export_to(studio_app *app, const char *target);
void studio_do_export(studio_app *app, const char *target);
void studio_do_open_view(studio_app *app, const char *target);
void studio_do_save_view(studio_app *app, const char *target);
void studio_do_screenshot_to(studio_app *app, const char *target);
void studio_do_screenshot(studio_app *app, const char *target);
void studio_do_turntable_to(studio_app *app, const char *target);
void studio_do_turntable(studio_app *app, const char *target);
void studio_do_turntable_count(studio_app *app, const char *target);
void studio_do_turntable_cancel(studio_app *app, const char *target);
void studio_do_shortcuts(studio_app *app, const char *target);
void studio_do_about(studio_app *app, const char *target);
void studio_do_frame(studio_app *app, const char *target);
void studio_do_front(studio_app *app, const char *target);
void studio_do_right(studio_app *app, const char *target);
void studio_do_top(studio_app *app, const char *target);
void studio_do_orthographic(studio_app *app, const char *target);
void studio_do_bookmark(studio_app *app, const char *target);
void studio_do_bookmark_set(studio_app *app, const char *target);
void studio_do_brighter(studio_app *app, const char *target);
void studio_do_darker(studio_app *app, const char *target);
void studio_set_encoding(studio_app *app, const char *target);
void studio_set_shading(studio_app *app, const char *target);
void studio_do_displace(studio_app *app, const char *target);
void studio_do_displace_path(studio_app *app, const char *target);
void studio_do_displace_channel(studio_app *app, const char *target);
void studio_do_displace_more(studio_app *app, const char *target);
void studio_do_displace_less(studio_app *app, const char *target);
void studio_do_displace_none(studio_app *app, const char *target);
void studio_do_light(studio_app *app, const char *target);
void studio_do_light_path(studio_app *app, const char *target);
void studio_do_light_left(studio_app *app, const char *target);
void studio_do_light_right(studio_app *app, const char *target);
void studio_do_channel(studio_app *app, const char *target);
void studio_do_damaged_show(studio_app *app, const char *target);
void studio_set_overlay(studio_app *app, const char *target);
void studio_do_seams(studio_app *app, const char *target);
void studio_do_even_levels(studio_app *app, const char *target);
void studio_do_wires(studio_app *app, const char *target);
void studio_do_segments_more(studio_app *app, const char *target);
void studio_do_segments_fewer(studio_app *app, const char *target);
void studio_set_anisotropy(studio_app *app, const char *target);
void studio_set_msaa(studio_app *app, const char *target);
void studio_do_bias_up(studio_app *app, const char *target);
void studio_do_bias_down(studio_app *app, const char *target);
void studio_do_bias_none(studio_app *app, const char *target);
void studio_do_dark(studio_app *app, const char *target);
void studio_set_strategy(studio_app *app, const char *target);
void studio_set_compare(studio_app *app, const char *target);
void studio_do_other_next(studio_app *app, const char *target);
void studio_do_seam_jump(studio_app *app, const char *target);
void studio_do_report(studio_app *app, const char *target);
void studio_do_report_orbit(studio_app *app, const char *target);
void studio_do_report_cancel(studio_app *app, const char *target);
void studio_do_report_show(studio_app *app, const char *target);

const char *studio_get_layer_hide(const studio_app *app);
const char *studio_get_layer_lock(const studio_app *app);
const char *studio_get_mask_paint(const studio_app *app);
const char *studio_get_tool(const studio_app *app);
const char *studio_get_mirror(const studio_app *app);
const char *studio_get_project(const studio_app *app);
const char *studio_get_orthographic(const studio_app *app);
const char *studio_get_encoding(const studio_app *app);
const char *studio_get_shading(const studio_app *app);
const char *studio_get_overlay(const studio_app *app);
const char *studio_get_seams(const studio_app *app);
const char *studio_get_even_levels(const studio_app *app);
const char *studio_get_wires(const studio_app *app);
const char *studio_get_anisotropy(const studio_app *app);
const char *studio_get_msaa(const studio_app *app);
const char *studio_get_dark(const studio_app *app);
const char *studio_get_strategy(const studio_app *app);
const char *studio_get_compare(const studio_app *app);

/* Shows in the menus what the model has. */
void studio_actions_sync(studio_app *app);

#endif
