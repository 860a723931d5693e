/* Values of a script's keys, and what is said of one that is wrong. */
#include "script/script_data.h"

#include "base/log.h"

#include <string.h>

slv_result slvi_script_wrong(const slvi_reading *r, const char *key, const char *expected) {
    return slvi_fail(&r->script->env, SLV_ERROR_FORMAT, "%s: line %llu: %s: expected %s",
                     r->script->name, (unsigned long long)r->number, key, expected);
}

bool slvi_script_number(json_t *value, double low, double high, float *out) {
    double number = json_number_value(value);
    if (!json_is_number(value) || !(number >= low && number <= high))
        return false;
    *out = (float)number;
    return true;
}

bool slvi_script_numbers(json_t *value, size_t least, size_t most, float *out) {
    size_t count = json_array_size(value);
    if (!json_is_array(value) || count < least || count > most)
        return false;
    for (size_t i = 0; i < count; i++)
        if (!slvi_script_number(json_array_get(value, i), -1e18, 1e18, &out[i]))
            return false;
    return true;
}

bool slvi_script_knows(json_t *value, const char *const *keys, size_t count) {
    const char *key;
    json_t *entry;
    json_object_foreach(value, key, entry) {
        size_t i = 0;
        while (i < count && strcmp(keys[i], key) != 0)
            i++;
        if (i == count)
            return false;
    }
    return json_is_object(value);
}
