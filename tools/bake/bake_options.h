/* What the options of bake say, as a recipe, and what is told of a bake. */
#ifndef SELVAGE_TOOLS_BAKE_OPTIONS_H
#define SELVAGE_TOOLS_BAKE_OPTIONS_H

#include "command/cli.h"

#include <selvage/bake_recipe.h>

typedef struct bake_options {
    const char *paths[2], *uv, *detail, *points, *texture, *from, *views, *cage, *bytes, *texels,
        *miss_map, *recipe;
    uint32_t size[2], min[2], max[2], compression, threads;
    float texels_per_pixel, density, match, max_miss, max_over, error, frequency, distance, front,
        back;
    uint32_t seed, samples;
    bool size_given, max_given, density_given, match_given, error_given, type_given, pattern_given;
    bool min_given, surface_given, rays_given, encoding_given, wrap_given, round_given,
        detail_kind_given, front_given, back_given, distance_given, seed_given, frequency_given;
    bool least_error, no_reductions, reductions_given, scheme_given, max_miss_given, max_over_given,
        print_recipe, resume, vertex_color, by_given, json, progress, quiet;
    int type, scheme, encoding, wrap, pattern, surface, rays, detail_kind, reductions, by, round;
} bake_options;

/* bake_recipe.c: checks the options, and puts what they say into the recipe that is named, or a new
 * one. Returns -1 to go on, or an exit code. */
int bake_recipe_make(const cli_command *command, const slv_env *env, const bake_options *options,
                     slv_bake_recipe **out);
/* All that decides what is baked: the recipe, and of each file it reads and the mesh when it was
 * changed. For free(); NULL if there is no memory. */
char *bake_recipe_key(const slv_bake_recipe *recipe, const bake_options *options);

/* bake_views.c: the pictures of a view file, for free(), and what the job is to know of them.
 * Nothing if `path` is NULL. */
slv_result bake_views_load(const slv_env *env, const char *path, const slv_mesh *mesh,
                           slv_bake_view **views, slv_bake_job *job);

/* bake_report.c. Warns of what no source has a value for, or none that goes on across edges. */
void bake_mesh_tell(const slv_env *env, const char *path, const slv_mesh *mesh);
/* Returns an exit code. */
int bake_report_tell(const bake_options *options, const slv_bake_recipe *recipe,
                     const slv_bake_report *report, const slv_bake_source *source);

#endif
