/* The image that a comparison has beside its strategies. */
#include "compare/compare.h"

#include "command/output.h"

#include <math.h>

/* A method for maps without vertices at their ends is of no use where these are still there twice.
 */
static slv_result warn_of_copies(const slv_env *env, const slv_mesh *mesh, const char *path) {
    slv_wrap_report welded;
    slv_mesh *once = NULL;
    slv_result result = slv_mesh_wrap(env, mesh, NULL, &welded, &once);
    if (!result && welded.nwelded)
        cli_warning(
            "%s: %u of its vertices lie where others do, as where a map ends: nothing goes "
            "round there until 'selvage wrap' has joined them (and the texture is baked for "
            "what it writes)",
            path, welded.nwelded);
    slv_mesh_destroy(once);
    return result;
}

slv_result compare_load_image(const slv_env *env, const char *path, slv_texture_encoding encoding,
                              slv_wrap_round round, scene_data *scene, report_data *report) {
    const slv_bake_uv how = {.encoding = encoding, .round_u = round & 1, .round_v = round >> 1 & 1};
    slv_result result = slv_bake_from_uv(env, scene->mesh, cli_input(path), &how, &scene->uv);
    if (!result && round)
        result = warn_of_copies(env, scene->mesh, report->mesh);
    if (result)
        return result;
    const slv_bake_source_desc *desc = slv_bake_source_get_desc(scene->uv);
    bool data = desc->encoding == SLV_TEXTURE_DATA;
    if (data != (report->pictures == SLV_ENCODE_RAW))
        return output_fail(env, SLV_ERROR_MISMATCH,
                           "%s: holds %s, and %s %s: --texture-encoding says what both hold", path,
                           data ? "data" : "colours", report->ptx, data ? "colours" : "data");
    if (desc->alpha_channel >= 0 && !scene->alpha)
        return output_fail(env, SLV_ERROR_MISMATCH,
                           "%s: has alpha, which --alpha blend or mask shows, if %s has it too",
                           path, report->ptx);
    slv_bake_source_images(scene->uv, &scene->images);
    report->maps.image = path;
    return SLV_OK;
}

void compare_warn_of_other_content(const report_data *report) {
    const report_maps *maps = &report->maps;
    double least = INFINITY;
    for (uint32_t k = 0; k < maps->nrows; k++)
        if (maps->rows[k].strategy)
            least = fmin(least, report_rms(&maps->rows[k].errors[REPORT_PLACE_INSIDE]));
    if (isfinite(least) && least > 16.0 / 255)
        cli_warning("%s: is %.0f/255 away from %s inside faces: it shows something else (bake --uv "
                    "makes a texture of an image), or is much coarser",
                    report->ptx, 255 * least, maps->image);
}
