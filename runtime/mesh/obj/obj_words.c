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

bool slvi_obj_begins_statement(slv_scan scan) {
    static const char *const known[] = {"v", "vt", "vn", "f", "fo", "g",     "o",
                                        "s", "t",  "l",  "p", "#",  "usemtl"};
    const char *word;
    if (!slvi_scan_more(&scan))
        return false;
    size_t length = slvi_scan_word(&scan, &word);
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (slvi_obj_word_is(word, length, known[i]))
            return true;
    return false;
}

bool slvi_obj_more(obj *o) {
    uint32_t line = o->scan.line;
    if (o->at_statement || !slvi_scan_more(&o->scan))
        return false;
    if (o->scan.line == line || !slvi_obj_begins_statement(o->scan))
        return true;
    slvi_obj_tally(&o->backslashes, line, NULL, 0);
    o->at_statement = true;
    return false;
}

slv_result slvi_obj_fail_joined(const obj *o, const char *what, size_t length, const char *word,
                                size_t size) {
    return slvi_obj_fail(o, o->scan.line,
                         "%.*s: '%.*s' stands on the same line, and would be lost; every statement "
                         "begins a line",
                         (int)length, what, (int)size, word);
}

uint64_t slvi_obj_read_numbers(obj *o, uint64_t most, double *out) {
    uint64_t count = 0;
    while (count < most && slvi_obj_more(o)) {
        slv_scan scan = o->scan;
        if (!slvi_scan_double(&scan, &out[count]) || !slvi_scan_at_break(&scan))
            break;
        o->scan = scan;
        count++;
    }
    return count;
}

slv_result slvi_obj_end(obj *o, const char *what, uint64_t most) {
    while (slvi_obj_more(o)) {
        slv_scan word = o->scan;
        const char *text;
        double number;
        bool good = slvi_scan_double(&o->scan, &number) && slvi_scan_at_break(&o->scan);
        if (good && most) {
            most--;
            continue;
        }
        bool statement = slvi_obj_begins_statement(word);
        size_t length = slvi_scan_word(&word, &text);
        if (statement)
            return slvi_obj_fail_joined(o, what, strlen(what), text, length);
        o->scan = word;
        slvi_obj_tally(&o->extra_words, o->line, text, length);
    }
    return SLV_OK;
}
