/* The report's pictures as PNG files. */
#include "compare/report/report_files.h"

#include <stdio.h>
#include <string.h>

static slv_result save(const slv_env *env, const char *folder, const char *name,
                       const slv_image *image, slv_image_encoding encoding) {
    const slv_image_params params = {.encoding = encoding, .bits = 8};
    char path[4096];
    if (!image->pixels)
        return SLV_OK;
    if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path) {
        if (env && env->log)
            env->log(env->log_user, SLV_LOG_ERROR,
                     "the folder's name is too long for its pictures");
        return SLV_ERROR_LIMIT;
    }
    return slv_image_save(env, path, image, &params);
}

slv_result report_write_pictures(const slv_env *env, const char *folder,
                                 const report_data *report) {
    char name[128];
    slv_result result = SLV_OK;
    for (uint32_t i = 0; i < report->nstrategies; i++) {
        const report_strategy *row = &report->strategies[i];
        const char *strategy = row->strategy->name;
        for (uint32_t v = 0; !result && v < report->nviews; v++) {
            snprintf(name, sizeof name, "view%u_%s.png", v, strategy);
            result = save(env, folder, name, &row->views[v], report->pictures);
        }
        for (uint32_t s = 0; !result && s < report->nspots; s++) {
            snprintf(name, sizeof name, "seam%u_%s.png", s, strategy);
            result = save(env, folder, name, &row->spots[s], report->pictures);
        }
        snprintf(name, sizeof name, "error_%s.png", strategy);
        result = result ? result : save(env, folder, name, &row->heat, SLV_ENCODE_SRGB);
    }
    for (uint32_t s = 0; !result && s < report->nspots; s++) {
        snprintf(name, sizeof name, "seam%u_reference.png", s);
        result = save(env, folder, name, &report->reference.spots[s], report->pictures);
    }
    for (uint32_t v = 0; !result && v < report->nviews; v++) {
        snprintf(name, sizeof name, "view%u_reference.png", v);
        result = save(env, folder, name, &report->reference.views[v], report->pictures);
    }
    for (uint32_t k = 0; !result && k < report->maps.nrows; k++) {
        const report_map *row = &report->maps.rows[k];
        snprintf(name, sizeof name, "map_%s.png", row->name);
        if (!(result = save(env, folder, name, &row->view, report->pictures))) {
            snprintf(name, sizeof name, "map_close_%s.png", row->name);
            result = save(env, folder, name, &row->spot, report->pictures);
        }
    }
    if (!result &&
        !(result = save(env, folder, "map_reference.png", &report->maps.view, report->pictures)))
        result =
            save(env, folder, "map_close_reference.png", &report->maps.close_up, report->pictures);
    for (uint32_t i = 0; !result && i < report->npairs; i++) {
        const report_pair *pair = &report->pairs[i];
        snprintf(name, sizeof name, "difference_%s_%s.png",
                 report->strategies[pair->a].strategy->name,
                 report->strategies[pair->b].strategy->name);
        result = save(env, folder, name, &pair->heat, SLV_ENCODE_SRGB);
    }
    return result;
}
