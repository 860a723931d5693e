/* What the verb compare is made of. */
#ifndef SELVAGE_TOOLS_COMPARE_H
#define SELVAGE_TOOLS_COMPARE_H

#include "command/scene.h"
#include "compare/engine/report.h"

/* Tables on a terminal, and the answer; `folder` is where the report is. */
void compare_print(const report_data *report, const char *folder);
/* The cameras of view files, which end in the report's proportions. */
slv_result compare_read_views(const slv_env *env, const cli_list *views, report_data *report);

/* The image that is drawn through texture coordinates, into the scene; it has to be of what the
 * texture is of: colours or data, with alpha or without. */
slv_result compare_load_image(const slv_env *env, const char *path, slv_texture_encoding encoding,
                              slv_wrap_round round, scene_data *scene, report_data *report);
/* So that nobody takes another picture for an error. */
void compare_warn_of_other_content(const report_data *report);

#endif
