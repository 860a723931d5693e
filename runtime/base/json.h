/* JSON that is read with jansson, for those who link it. */
#ifndef SLV_BASE_JSON_H
#define SLV_BASE_JSON_H

#include <selvage/result.h>

#include <jansson.h>

/* What a text says, by jansson's flags. SLV_ERROR_MEMORY, or SLV_ERROR_FORMAT and what is
 * wrong in `error`; tells nobody. jansson takes want of memory within a string for bad syntax:
 * what looks like that is tried once more. */
static inline slv_result slvi_json_load(const char *text, size_t size, size_t flags, json_t **out,
                                        json_error_t *error) {
    for (int i = 0; i < 2; i++) {
        if ((*out = json_loadb(text, size, flags, error)))
            return SLV_OK;
        if (!error->text[0] || json_error_code(error) == json_error_out_of_memory)
            return SLV_ERROR_MEMORY;
    }
    return SLV_ERROR_FORMAT;
}

/* A string. SLV_ERROR_ARGUMENT if it is not UTF-8, else SLV_ERROR_MEMORY; tells nobody. */
static inline slv_result slvi_json_text(const char *text, json_t **out) {
    if ((*out = json_string(text)) || (*out = json_string(text)))
        return SLV_OK;
    json_t *anything = json_string_nocheck(text);
    json_decref(anything);
    return anything ? SLV_ERROR_ARGUMENT : SLV_ERROR_MEMORY;
}

#endif
