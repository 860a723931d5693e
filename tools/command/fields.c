/* Warns of fields that are misspelt. */
#include "command/fields.h"

#include "command/words.h"

#include <stdio.h>
#include <string.h>

uint32_t fields_warn(const slv_env *env, const char *what, const json_t *object,
                     const char *known) {
    const char *key;
    json_t *value;
    uint32_t count = 0;
    json_object_foreach((json_t *)(uintptr_t)object, key, value) {
        char hint[SLV_WORDS_HINT], line[512];
        if (words_index(known, key, strlen(key)) >= 0)
            continue;
        count++;
        snprintf(line, sizeof line, "%.200s: the field '%.80s' is not used%s", what, key,
                 slv_words_hint(key, known, hint));
        if (env->log)
            env->log(env->log_user, SLV_LOG_WARNING, line);
    }
    return count;
}
