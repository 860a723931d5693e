/* What the files of recipes share. */
#ifndef SLV_BAKE_RECIPE_DATA_H
#define SLV_BAKE_RECIPE_DATA_H

#include "base/json.h"
#include "base/log.h"

#include <selvage/bake_recipe.h>

enum { RECIPE_DEPTH = 32, RECIPE_SURFACES = 64 };

struct slv_bake_recipe {
    json_t *root, *files; /* all of it; the names in it */
    char *text;
    slv_bake_job job;
    float max_miss, max_over;
    slv_surface **surfaces; /* that sources needed */
    uint32_t nsurfaces;
};

/* Who reads, and what messages call the file. */
typedef struct recipe_reader {
    const slv_env *env;
    const char *name;
} recipe_reader;

/* recipe_fields.c. One line: the file, where in it, what is wrong. */
slv_result slvi_recipe_fail(const recipe_reader *r, const char *where, const char *format, ...)
    SLV_PRINTF(3, 4);
/* The fields of an object; what is not there stays as it was. */
slv_result slvi_recipe_only(const recipe_reader *r, const char *where, const json_t *object,
                            const char *const *keys, size_t nkeys);
slv_result slvi_recipe_number(const recipe_reader *r, const char *where, const json_t *object,
                              const char *key, double low, double high, double *out);
slv_result slvi_recipe_word(const recipe_reader *r, const char *where, const json_t *object,
                            const char *key, const char *(*name_of)(int), int *out);
/* The parameters are an object, a field of it and what it may be. */
slv_result slvi_recipe_floats(const recipe_reader *r, const char *where, const json_t *object,
                              const char *key, uint32_t least, uint32_t most, float *out,
                              uint32_t *count);
/* recipe_sources.c: says what is wrong with sources without opening any. */
slv_result slvi_recipe_check_sources(const recipe_reader *r, slv_bake_recipe *recipe);

#endif
