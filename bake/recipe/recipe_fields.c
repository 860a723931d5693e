/* The fields of a recipe's objects: what they may be, and what is said of those that are not. */
#include "recipe/recipe_data.h"

#include "base/words.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

slv_result slvi_recipe_fail(const recipe_reader *r, const char *where, const char *format, ...) {
    char text[400];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return slvi_fail(r->env, SLV_ERROR_FORMAT, "%s: %s: %s", r->name, where, text);
}

slv_result slvi_recipe_only(const recipe_reader *r, const char *where, const json_t *object,
                            const char *const *keys, size_t nkeys) {
    const char *key;
    json_t *value;
    json_object_foreach((json_t *)(uintptr_t)object, key, value) {
        size_t i = 0;
        while (i < nkeys && strcmp(keys[i], key) != 0)
            i++;
        if (i < nkeys)
            continue;
        char known[512] = "", hint[SLV_WORDS_HINT];
        for (i = 0; i < nkeys; i++)
            slvi_words_add(known, sizeof known, keys[i]);
        return slvi_recipe_fail(r, where, "unknown field '%.60s'%s", key,
                                slv_words_hint(key, known, hint));
    }
    return SLV_OK;
}

slv_result slvi_recipe_number(const recipe_reader *r, const char *where, const json_t *object,
                              const char *key, double low, double high, double *out) {
    const json_t *value = json_object_get(object, key);
    if (!value)
        return SLV_OK;
    double number = json_number_value(value);
    if (!json_is_number(value) || !(number >= low && number <= high))
        return slvi_recipe_fail(r, where, "%s: expected a number from %g to %g", key, low, high);
    *out = number;
    return SLV_OK;
}

slv_result slvi_recipe_word(const recipe_reader *r, const char *where, const json_t *object,
                            const char *key, const char *(*name_of)(int), int *out) {
    const json_t *value = json_object_get(object, key);
    char list[300] = "";
    if (!value)
        return SLV_OK;
    for (int i = 0; strcmp(name_of(i), "unknown") != 0; i++) {
        if (json_is_string(value) && strcmp(json_string_value(value), name_of(i)) == 0) {
            *out = i;
            return SLV_OK;
        }
        slvi_words_add(list, sizeof list, name_of(i));
    }
    char hint[SLV_WORDS_HINT];
    const char *word = json_string_value(value);
    return slvi_recipe_fail(r, where, "%s: expected one of %s%s", key, list,
                            slv_words_hint(word ? word : "", list, hint));
}

slv_result slvi_recipe_floats(const recipe_reader *r, const char *where, const json_t *object,
                              const char *key, uint32_t least, uint32_t most, float *out,
                              uint32_t *count) {
    const json_t *value = json_object_get(object, key);
    size_t n = json_array_size(value);
    if (!value)
        return SLV_OK;
    if (!json_is_array(value) || n < least || n > most)
        return slvi_recipe_fail(r, where, "%s: expected %u to %u numbers in an array", key, least,
                                most);
    for (size_t i = 0; i < n; i++) {
        const json_t *item = json_array_get(value, i);
        if (!json_is_number(item) || !isfinite((float)json_number_value(item)))
            return slvi_recipe_fail(r, where, "%s: item %zu is no number", key, i);
        out[i] = (float)json_number_value(item);
    }
    if (count)
        *count = (uint32_t)n;
    return SLV_OK;
}
