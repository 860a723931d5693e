/* Recipes: what is baked and how large, as JSON (docs/bake.md, docs/bake-recipe.schema.json), so
 * that sources combine and a bake can be kept and run again. */
#ifndef SELVAGE_BAKE_RECIPE_H
#define SELVAGE_BAKE_RECIPE_H

#include <selvage/bake.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct slv_bake_recipe slv_bake_recipe;

/* Reads a file, or begins with an empty recipe if `path` is NULL, and lets the fields of the JSON
 * object in `changes` (may be NULL) take the place of the file's; of those that say how large faces
 * are one takes the place of all. Files that a recipe names are relative to it, those that
 * `changes` names to the working folder. What is wrong is named by field:
 * SLV_ERROR_FORMAT. */
SLV_NODISCARD SLV_API slv_result slv_bake_recipe_load(const slv_env *env, const char *path,
                                                      const char *changes, slv_bake_recipe **out);
SLV_API void slv_bake_recipe_destroy(slv_bake_recipe *recipe);

/* All of it as JSON, with every file's name as it is opened. Owned by the recipe. */
SLV_API const char *slv_bake_recipe_text(const slv_bake_recipe *recipe);
/* What it says of sizes, type, reductions and compression; the rest of a job is the caller's. Owned
 * by the recipe. */
SLV_API const slv_bake_job *slv_bake_recipe_job(const slv_bake_recipe *recipe);
/* The share of texels that may have no value (max-miss): 0 unless it says so. */
SLV_API float slv_bake_recipe_max_miss(const slv_bake_recipe *recipe);
/* The share of faces that may stay further from the source than `error` (max-over): likewise. */
SLV_API float slv_bake_recipe_max_over(const slv_bake_recipe *recipe);
/* The view file by whose cameras faces are sized, whose reading is the caller's; NULL if there is
 * none. Owned by the recipe. */
SLV_API const char *slv_bake_recipe_views(const slv_bake_recipe *recipe);
/* The names of the files that it reads, NULL past the last. Owned by the recipe. */
SLV_API const char *slv_bake_recipe_file(const slv_bake_recipe *recipe, uint32_t index);

/* Opens its source for a mesh: images and meshes are read. The recipe, which keeps the limit
 * surface if one is needed, must outlive the source, and is asked once. */
SLV_NODISCARD SLV_API slv_result slv_bake_recipe_source(const slv_env *env, slv_bake_recipe *recipe,
                                                        const slv_mesh *mesh,
                                                        slv_bake_source **out);

#ifdef __cplusplus
}
#endif

#endif
