/* The brushes that a script's lines name or describe, each made once. */
#include "script/script_data.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/names.h"
#include "base/words.h"

#include <stdlib.h>
#include <string.h>

slv_result slvi_script_copy(const slv_env *env, const char *text, char **out) {
    slv_result result = slvi_alloc(env, "script", strlen(text) + 1, 1, out);
    if (!result)
        strcpy(*out, text);
    return result;
}

slv_result slvi_script_path(const slv_script *script, const char *file, char **out) {
    size_t room = strlen(script->folder) + strlen(file) + 2;
    slv_result result = slvi_alloc(&script->env, "script", room, 1, out);
    if (!result)
        snprintf(*out, room, "%s%s%s", file[0] == '/' ? "" : script->folder,
                 file[0] == '/' || !script->folder[0] ? "" : "/", file);
    return result;
}

static slv_result load_file(slv_script *s, const char *file, slv_brush **out) {
    char *path = NULL;
    const char *const *unknown;
    slv_result result = slvi_script_path(s, file, &path);
    if (!result)
        result = slv_brush_load(&s->env, path, out);
    for (uint32_t i = 0; !result && s->params.unknown && i < slv_brush_unknown(*out, &unknown); i++)
        s->params.unknown(s->params.user, path, unknown[i]);
    slvi_free(path);
    return result;
}

static slv_result make_round(slv_script *s, uint64_t number, json_t *value, slv_brush **out) {
    slv_brush_params p = {0};
    const struct {
        const char *key;
        float *to;
        double low, high;
        const char *expected;
    } numbers[] = {{"hardness", &p.hardness, 0, 1, "a number from 0 to 1"},
                   {"spacing", &p.spacing, 0, 1000, "a number of radii, 0 to 1000"},
                   {"aspect", &p.aspect, 1, 1000, "a number from 1 to 1000, or 0"},
                   {"angle", &p.angle, -1e18, 1e18, "degrees"},
                   {"pressure_radius", &p.pressure_radius, 0, 1, "a number from 0 to 1"},
                   {"pressure_opacity", &p.pressure_opacity, 0, 1, "a number from 0 to 1"}};
    const char *key;
    json_t *entry;
    json_object_foreach(value, key, entry) {
        char known[128] = "follow", hint[SLV_WORDS_HINT];
        const char *expected = "true or false";
        size_t i = 0;
        bool fine = json_is_boolean(entry);
        while (i < SLVI_COUNT(numbers) && strcmp(numbers[i].key, key) != 0)
            slvi_words_add(known, sizeof known, numbers[i++].key);
        if (i < SLVI_COUNT(numbers)) {
            fine = slvi_script_number(entry, numbers[i].low, numbers[i].high, numbers[i].to) ||
                   slvi_script_number(entry, 0, 0, numbers[i].to); /* what is usual */
            expected = numbers[i].expected;
        } else if (strcmp(key, "follow") == 0) {
            p.follow = json_is_true(entry);
        } else {
            return slvi_fail(&s->env, SLV_ERROR_FORMAT,
                             "%s: line %llu: brush: unknown key '%.40s'%s", s->name,
                             (unsigned long long)number, key, slv_words_hint(key, known, hint));
        }
        if (!fine)
            return slvi_fail(&s->env, SLV_ERROR_FORMAT, "%s: line %llu: brush: %s: expected %s",
                             s->name, (unsigned long long)number, key, expected);
    }
    return slv_brush_create(&s->env, &p, out);
}

slv_result slvi_script_brush_of(slv_script *s, uint64_t number, json_t *value,
                                const slv_brush **out) {
    char *key = json_dumps(value, JSON_COMPACT | JSON_SORT_KEYS | JSON_ENCODE_ANY), *copy = NULL;
    slv_brush *brush = NULL;
    slv_result result = key ? SLV_OK
                            : slvi_fail(&s->env, SLV_ERROR_MEMORY, "%s: line %llu: no memory",
                                        s->name, (unsigned long long)number);
    for (uint32_t i = 0; !result && i < s->nbrushes; i++)
        if (strcmp(s->brushes[i].key, key) == 0) {
            *out = s->brushes[i].brush;
            free(key);
            return SLV_OK;
        }
    if (!result && json_is_string(value))
        result = load_file(s, json_string_value(value), &brush);
    else if (!result && json_is_object(value))
        result = make_round(s, number, value, &brush);
    else if (!result)
        result = slvi_fail(&s->env, SLV_ERROR_FORMAT,
                           "%s: line %llu: brush: expected the name of a file, or an object",
                           s->name, (unsigned long long)number);
    if (!result)
        result = slvi_script_copy(&s->env, key, &copy);
    if (!result)
        result = slvi_grow(&s->env, "script", (uint64_t)s->nbrushes + 1, sizeof *s->brushes,
                           &s->brushes);
    free(key);
    if (result) {
        slvi_free(copy);
        slv_brush_destroy(brush);
        return result;
    }
    s->brushes[s->nbrushes++] = (slvi_script_brush){copy, brush};
    *out = brush;
    return SLV_OK;
}
