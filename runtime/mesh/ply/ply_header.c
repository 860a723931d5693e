/* Reading the header of a PLY file, which is text whatever follows (Turk 1994, "The PLY Polygon
 * File Format"). */
#include "mesh/ply/ply_header.h"

#include "base/log.h"
#include "mesh/text_scan.h"

#include <stdio.h>
#include <string.h>

enum { MAX_WORDS = 6 };

typedef struct line {
    char words[MAX_WORDS][PLY_NAME];
    int count;
} line;

static bool find_type(const char *word, ply_type *out) {
    static const char *const names[][2] = {
        {"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
        {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};
    for (int type = 0; type < (int)(sizeof names / sizeof *names); type++)
        if (strcmp(word, names[type][0]) == 0 || strcmp(word, names[type][1]) == 0) {
            *out = (ply_type)type;
            return true;
        }
    return false;
}

static bool is_break(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/* The words of a line, cut to the length of a name; more words than any statement has are passed.
 */
static void read_line(slv_scan *scan, line *out) {
    const char *word;
    out->count = 0;
    while (scan->next < scan->end && *scan->next != '\n' && *scan->next != '\r') {
        if (*scan->next == ' ' || *scan->next == '\t') {
            scan->next++;
            continue;
        }
        word = scan->next;
        while (scan->next < scan->end && !is_break(*scan->next))
            scan->next++;
        if (out->count < MAX_WORDS)
            snprintf(out->words[out->count++], PLY_NAME, "%.*s",
                     (int)(scan->next - word < PLY_NAME ? scan->next - word : PLY_NAME), word);
    }
    if (scan->next < scan->end) {
        bool crlf = *scan->next == '\r' && scan->end - scan->next >= 2 && scan->next[1] == '\n';
        scan->next += crlf ? 2 : 1;
    }
}

static bool read_format(const line *l, ply_format *out) {
    static const char *const names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    for (int format = 0; format < 3; format++)
        if (l->count >= 2 && strcmp(l->words[1], names[format]) == 0) {
            *out = (ply_format)format;
            return true;
        }
    return false;
}

static bool read_element(const line *l, ply_header *out) {
    int64_t count;
    if (l->count != 3 || out->nelements == PLY_MAX_ELEMENTS)
        return false;
    slv_scan number = {l->words[2], l->words[2] + strlen(l->words[2]), 1};
    if (!slvi_scan_int(&number, &count) || number.next != number.end || count < 0)
        return false;
    ply_element *element = &out->elements[out->nelements++];
    *element = (ply_element){.count = (uint64_t)count, .first = out->nproperties};
    memcpy(element->name, l->words[1], PLY_NAME);
    return true;
}

static bool read_property(const line *l, ply_header *out) {
    ply_property property = {.is_list = l->count >= 2 && strcmp(l->words[1], "list") == 0};
    int at = property.is_list ? 3 : 1;
    if (!out->nelements || out->nproperties == PLY_MAX_PROPERTIES || l->count != at + 2 ||
        !find_type(l->words[at], &property.type) ||
        (property.is_list &&
         (!find_type(l->words[2], &property.count_type) || property.count_type >= PLY_FLOAT)))
        return false;
    memcpy(property.name, l->words[at + 1], PLY_NAME);
    out->properties[out->nproperties++] = property;
    out->elements[out->nelements - 1].nproperties++;
    return true;
}

slv_result slvi_ply_read_header(const slv_env *env, const char *name, const char *text, size_t size,
                                ply_header *out) {
    slv_scan scan = {text, text + size, 1};
    bool good = true, formatted = false;
    line l;
    memset(out, 0, sizeof *out);
    for (; good && scan.next < scan.end; scan.line++) {
        read_line(&scan, &l);
        const char *word = l.count ? l.words[0] : "";
        if (scan.line == 1) {
            good = strcmp(word, "ply") == 0;
        } else if (strcmp(word, "format") == 0) {
            good = formatted = read_format(&l, &out->format);
        } else if (strcmp(word, "element") == 0) {
            good = read_element(&l, out);
        } else if (strcmp(word, "property") == 0) {
            good = read_property(&l, out);
        } else if (strcmp(word, "end_header") == 0) {
            out->lines = scan.line;
            out->bytes = (size_t)(scan.next - text);
            return formatted
                       ? SLV_OK
                       : slvi_fail(env, SLV_ERROR_FORMAT, "%s: the header names no format", name);
        } else {
            good = !*word || strcmp(word, "comment") == 0 || strcmp(word, "obj_info") == 0;
        }
        if (!good)
            return slvi_fail(env, SLV_ERROR_FORMAT, "%s:%u: not a line of a PLY header", name,
                             scan.line);
    }
    return slvi_fail(env, SLV_ERROR_FORMAT, "%s: the header does not end", name);
}
