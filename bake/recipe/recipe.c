/* Recipes as JSON: reading them, and what they say of a job. */
#include "recipe/recipe_data.h"

#include "base/log.h"
#include "base/memory.h"

#include <selvage/file.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const sizing[] = {"size",  "density", "match", "texels",
                                     "bytes", "error",   "views"};
static const char *const files[] = {"uv", "detail", "points", "texture", "mesh", "cage", "views"};

/* ---- the job ---- */

static slv_result read_size(const recipe_reader *r, const json_t *root, const char *key,
                            slv_res *out, bool *given) {
    const json_t *value = json_object_get(root, key);
    int log2[2];
    if (!value)
        return SLV_OK;
    for (int i = 0; i < 2; i++) {
        const json_t *side = json_is_array(value) && json_array_size(value) == 2
                                 ? json_array_get(value, (size_t)i)
                                 : value;
        json_int_t texels = json_integer_value(side);
        log2[i] = json_is_integer(side) && texels > 0 ? slv_res_log2((uint64_t)texels) : -1;
        if (log2[i] < 0)
            return slvi_recipe_fail(r, "recipe", "%s: expected a power of two up to %u, or two",
                                    key, 1u << SLV_MAX_LOG2_RES);
    }
    *out = (slv_res){(int8_t)log2[0], (int8_t)log2[1]};
    if (given)
        *given = true;
    return SLV_OK;
}

static const char *type_name(int value) {
    return slv_type_name((slv_type)value);
}
static const char *scheme_name(int value) {
    return slv_scheme_name((slv_scheme)value);
}
static const char *seams_name(int value) {
    return slv_ptx_seams_name((slv_ptx_seams)value);
}

static slv_result read_reductions(const recipe_reader *r, slv_bake_recipe *recipe) {
    const json_t *value = json_object_get(recipe->root, "reductions");
    int seams = 0;
    if (!value)
        return SLV_OK;
    if (json_is_false(value)) {
        recipe->job.no_reductions = true;
        return SLV_OK;
    }
    slv_result result =
        slvi_recipe_word(r, "recipe", recipe->root, "reductions", seams_name, &seams);
    recipe->job.seams = (slv_ptx_seams)seams;
    recipe->job.seams_given = true;
    return result;
}

/* All that is one number, and where it goes. */
static slv_result read_numbers(const recipe_reader *r, slv_bake_recipe *recipe) {
    slv_bake_job *job = &recipe->job;
    double density = 0, match = 0, error = 0, texels = 0, bytes = 0, compression = 0, miss = 0,
           over = 0, pixels = 0;
    const struct {
        const char *key;
        double low, high, *out;
    } numbers[] = {{"density", 1e-30, 1e30, &density},
                   {"match", 1e-6, 1e6, &match},
                   {"error", 1e-9, 1e9, &error},
                   {"texels", 1, 1e18, &texels},
                   {"bytes", 1, 1e18, &bytes},
                   {"compression", 1, 12, &compression},
                   {"max-miss", 0, 1, &miss},
                   {"max-over", 0, 1, &over},
                   {"texels-per-pixel", 1e-6, 1e6, &pixels}};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        slv_result result = slvi_recipe_number(r, "recipe", recipe->root, numbers[i].key,
                                               numbers[i].low, numbers[i].high, numbers[i].out);
        if (result)
            return result;
    }
    job->density = (float)density;
    job->match = (float)match;
    job->max_error = (float)error;
    job->max_texels = (uint64_t)texels;
    job->max_bytes = (uint64_t)bytes;
    job->compression = (int)compression;
    job->texels_per_pixel = (float)pixels;
    recipe->max_miss = (float)miss;
    recipe->max_over = (float)over;
    return SLV_OK;
}

static slv_result read_job(const recipe_reader *r, slv_bake_recipe *recipe) {
    static const char *const keys[] = {
        "$schema",     "source",      "size",     "density",         "match",
        "texels",      "bytes",       "error",    "min-size",        "max-size",
        "type",        "scheme",      "max-miss", "max-over",        "reductions",
        "compression", "least-error", "views",    "texels-per-pixel"};
    int type = 0, scheme = 0;
    json_t *root = recipe->root;
    recipe->job.min_res = (slv_res){0, 0};
    slv_result result;
    if ((result = slvi_recipe_only(r, "recipe", root, keys, sizeof keys / sizeof *keys)) ||
        (result = read_numbers(r, recipe)) ||
        (result = read_size(r, root, "size", &recipe->job.res, &recipe->job.uniform)) ||
        (result = read_size(r, root, "min-size", &recipe->job.min_res, NULL)) ||
        (result = read_size(r, root, "max-size", &recipe->job.max_res, &recipe->job.max_given)) ||
        (result = slvi_recipe_word(r, "recipe", root, "type", type_name, &type)) ||
        (result = slvi_recipe_word(r, "recipe", root, "scheme", scheme_name, &scheme)) ||
        (result = read_reductions(r, recipe)))
        return result;
    recipe->job.type = (slv_type)type;
    recipe->job.type_given = json_object_get(root, "type") != NULL;
    recipe->job.scheme = (slv_scheme)scheme;
    const json_t *least = json_object_get(root, "least-error");
    if (least && !json_is_boolean(least))
        return slvi_recipe_fail(r, "recipe", "least-error: expected true or false");
    recipe->job.least_error = json_is_true(least);
    uint32_t given = 0;
    for (size_t i = 0; i < sizeof sizing / sizeof *sizing; i++)
        given += json_object_get(root, sizing[i]) != NULL;
    if (given > 1)
        return slvi_recipe_fail(
            r, "recipe", "size, density, match, texels, bytes, error and views: one of them");
    if (json_object_get(root, "views") && !slv_bake_recipe_views(recipe))
        return slvi_recipe_fail(r, "recipe", "views: expected the name of a view file");
    if (recipe->job.texels_per_pixel > 0 && !slv_bake_recipe_views(recipe))
        return slvi_recipe_fail(r, "recipe", "texels-per-pixel: views is missing");
    return SLV_OK;
}

/* ---- files ---- */

static slv_result parse(const recipe_reader *r, const char *text, size_t size, json_t **out) {
    json_error_t error;
    slv_result result = slvi_json_load(text, size, JSON_REJECT_DUPLICATES, out, &error);
    if (result == SLV_ERROR_MEMORY)
        return slvi_fail(r->env, result, "%s: no memory to read it", r->name);
    if (result)
        return slvi_fail(r->env, SLV_ERROR_FORMAT, "%s: line %d: %s", r->name, error.line,
                         error.text);
    if (json_is_object(*out))
        return SLV_OK;
    return slvi_recipe_fail(r, "recipe", "expected an object");
}

/* Names of files become those that they are opened by: relative to the folder of the recipe.
 * Recursive, as deep as sources are nested, which `depth` limits. */
static slv_result place_files(const recipe_reader *r, json_t *node, const char *folder, int depth) {
    const char *key;
    json_t *value;
    char path[4096];
    if (depth > RECIPE_DEPTH)
        return slvi_recipe_fail(r, "source", "is nested deeper than %d", RECIPE_DEPTH);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        const char *name = json_string_value(json_object_get(node, files[i]));
        if (!name || !*folder || name[0] == '/')
            continue;
        if ((size_t)snprintf(path, sizeof path, "%s%s", folder, name) >= sizeof path)
            return slvi_recipe_fail(r, files[i], "the name is too long");
        if (json_object_set_new(node, files[i], json_string(path)))
            return slvi_fail(r->env, SLV_ERROR_MEMORY, "%s: no memory", r->name);
    }
    json_object_foreach(node, key, value) {
        slv_result result =
            json_is_object(value) ? place_files(r, value, folder, depth + 1) : SLV_OK;
        if (result)
            return result;
    }
    return SLV_OK;
}

static slv_result merge(const recipe_reader *r, json_t *root, const char *changes) {
    json_t *with = NULL, *value;
    const char *key;
    const recipe_reader named = {r->env, "changes"};
    slv_result result = parse(&named, changes, strlen(changes), &with);
    bool sized = false;
    for (size_t i = 0; !result && i < sizeof sizing / sizeof *sizing; i++)
        sized |= json_object_get(with, sizing[i]) != NULL;
    for (size_t i = 0; sized && i < sizeof sizing / sizeof *sizing; i++)
        json_object_del(root, sizing[i]);
    if (sized)
        json_object_del(root, "texels-per-pixel");
    if (!result)
        json_object_foreach(with, key, value) if (json_object_set(root, key, value)) result =
            slvi_fail(r->env, SLV_ERROR_MEMORY, "%s: no memory", r->name);
    json_decref(with);
    return result;
}

static slv_result read_file(const recipe_reader *r, const char *path, json_t **out) {
    char folder[4096], *text = NULL;
    size_t size = 0;
    const char *slash = strrchr(path, '/');
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash + 1 - path) : 0, path);
    slv_result result = slv_text_load(r->env, path, &text, &size);
    if (!result && !(result = parse(r, text, size, out)))
        result = place_files(r, *out, folder, 0);
    slv_free(text);
    return result;
}

static slv_result list_files(slv_bake_recipe *recipe, json_t *node) {
    const char *key;
    json_t *value;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        json_t *name = json_object_get(node, files[i]);
        if (json_is_string(name) && json_array_append(recipe->files, name))
            return SLV_ERROR_MEMORY;
    }
    json_object_foreach(node, key, value) if (json_is_object(value) &&
                                              list_files(recipe, value)) return SLV_ERROR_MEMORY;
    return SLV_OK;
}

slv_result slv_bake_recipe_load(const slv_env *given, const char *path, const char *changes,
                                slv_bake_recipe **out) {
    slv_env env = slvi_env_or_default(given);
    const recipe_reader r = {&env, path ? path : "recipe"};
    slv_bake_recipe *recipe = NULL;
    *out = NULL;
    slv_result result = slvi_alloc(&env, r.name, 1, sizeof *recipe, &recipe);
    if (result)
        return result;
    if (path)
        result = read_file(&r, path, &recipe->root);
    else if (!(recipe->root = json_object()))
        result = slvi_fail(&env, SLV_ERROR_MEMORY, "%s: no memory", r.name);
    if (result || (changes && (result = merge(&r, recipe->root, changes))) ||
        (result = read_job(&r, recipe)) || (result = slvi_recipe_check_sources(&r, recipe)))
        goto done;
    recipe->files = json_array();
    recipe->text = json_dumps(recipe->root, JSON_INDENT(2) | JSON_SORT_KEYS);
    if (!recipe->files || !recipe->text || list_files(recipe, recipe->root)) {
        result = slvi_fail(&env, SLV_ERROR_MEMORY, "%s: no memory", r.name);
        goto done;
    }
    *out = recipe;
    recipe = NULL;
done:
    slv_bake_recipe_destroy(recipe);
    return result;
}

void slv_bake_recipe_destroy(slv_bake_recipe *recipe) {
    if (!recipe)
        return;
    for (uint32_t i = 0; i < recipe->nsurfaces; i++)
        slv_surface_destroy(recipe->surfaces[i]);
    slvi_free(recipe->surfaces);
    json_decref(recipe->root);
    json_decref(recipe->files);
    free(recipe->text);
    slvi_free(recipe);
}

const char *slv_bake_recipe_text(const slv_bake_recipe *recipe) {
    return recipe->text;
}

const slv_bake_job *slv_bake_recipe_job(const slv_bake_recipe *recipe) {
    return &recipe->job;
}

float slv_bake_recipe_max_miss(const slv_bake_recipe *recipe) {
    return recipe->max_miss;
}

float slv_bake_recipe_max_over(const slv_bake_recipe *recipe) {
    return recipe->max_over;
}

const char *slv_bake_recipe_views(const slv_bake_recipe *recipe) {
    return json_string_value(json_object_get(recipe->root, "views"));
}

const char *slv_bake_recipe_file(const slv_bake_recipe *recipe, uint32_t index) {
    return json_string_value(json_array_get(recipe->files, index));
}
