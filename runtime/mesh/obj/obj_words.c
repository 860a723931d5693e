/* Words and numbers of an OBJ file, the arrays that they go into, and errors with their line. */
#include "mesh/obj/obj_data.h"

#include "base/memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const unsigned slvi_obj_kind_floats[OBJ_KINDS] = {3, 2, 3};

slv_result slvi_obj_fail(const obj *o, uint32_t line, const char *format, ...) {
    char words[256];
    va_list args;
    va_start(args, format);
    vsnprintf(words, sizeof words, format, args);
    va_end(args);
    return slvi_fail(o->env, SLV_ERROR_FORMAT, "%s:%u: %s", o->name, line, words);
}

slv_result slvi_obj_append(obj *o, obj_list *l, const void *items, uint64_t count, size_t size) {
    if (count > l->capacity - l->count) {
        uint64_t capacity = l->capacity ? 2 * l->capacity : 256;
        void *grown = NULL;
        while (capacity < l->count + count)
            capacity *= 2;
        slv_result result = slvi_alloc(o->env, o->name, capacity, size, &grown);
        if (result)
            return result;
        if (l->count)
            memcpy(grown, l->items, (size_t)l->count * size);
        slvi_free(l->items);
        l->items = grown;
        l->capacity = capacity;
    }
    memcpy((char *)l->items + l->count * size, items, (size_t)count * size);
    l->count += count;
    return SLV_OK;
}

void slvi_obj_tally(obj_tally *tally, uint32_t line, const char *word, size_t length) {
    if (!tally->count++) {
        tally->line = line;
        snprintf(tally->word, sizeof tally->word, "%.*s", (int)(length < 39 ? length : 39),
                 word ? word : "");
    }
}

slv_result slvi_obj_read_float(obj *o, const char *what, float *out) {
    double value = 0;
    slv_result result = slvi_obj_read_double(o, what, &value);
    *out = (float)value;
    return result;
}

slv_result slvi_obj_read_double(obj *o, const char *what, double *out) {
    if (!slvi_scan_more(&o->scan))
        return slvi_obj_fail(o, o->scan.line, "%s: expected a number, found the line's end", what);
    slv_scan word = o->scan;
    if (slvi_scan_double(&o->scan, out) && slvi_scan_at_break(&o->scan))
        return SLV_OK;
    const char *text;
    size_t length = slvi_scan_word(&word, &text);
    return slvi_obj_fail(o, o->scan.line, "%s: expected a finite number, found '%.*s'", what,
                         (int)(length < 40 ? length : 40), text);
}

slv_result slvi_obj_read_int(obj *o, const char *what, int32_t *out) {
    int64_t value;
    if (!slvi_scan_more(&o->scan))
        return slvi_obj_fail(o, o->scan.line, "%s: expected an integer, found the line's end",
                             what);
    slv_scan word = o->scan;
    if (slvi_scan_int(&o->scan, &value) && slvi_scan_at_break(&o->scan) && value >= INT32_MIN &&
        value <= INT32_MAX) {
        *out = (int32_t)value;
        return SLV_OK;
    }
    const char *text;
    size_t length = slvi_scan_word(&word, &text);
    return slvi_obj_fail(o, o->scan.line, "%s: expected an integer, found '%.*s'", what,
                         (int)(length < 40 ? length : 40), text);
}

bool slvi_obj_take_slash(obj *o) {
    if (o->scan.next == o->scan.end || *o->scan.next != '/')
        return false;
    o->scan.next++;
    return true;
}

bool slvi_obj_word_is(const char *word, size_t length, const char *expected) {
    return strlen(expected) == length && memcmp(word, expected, length) == 0;
}
