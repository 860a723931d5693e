/* The statements of an OBJ file, one by one. */
#include "mesh/obj/obj_data.h"

#include "base/memory.h"
#include "mesh/mesh_data.h"

#include <selvage/file.h>

#include <math.h>
#include <string.h>
#include <strings.h>

static const char *const kind_names[OBJ_KINDS] = {"vertex", "texture", "normal"};

static const char *const keywords[OBJ_KINDS] = {"v", "vt", "vn"};

/* The colour of the vertex that is being read, `count` numbers of it; the first vertex that has one
 * also says that those before it have none. */
static slv_result add_color(obj *o, const double *numbers, uint64_t count) {
    uint64_t vertex = slvi_obj_count(o, OBJ_VERTEX);
    float color[4] = {NAN, NAN, NAN, NAN};
    slv_result result = SLV_OK;
    while (!result && o->colors.count / 4 < vertex)
        result = slvi_obj_append(o, &o->colors, color, 4, sizeof *color);
    for (uint64_t c = 0; count && c < 4; c++)
        color[c] = c < count ? (float)numbers[c] : 1;
    for (uint64_t c = 0; c < count; c++) {
        o->largest = fmaxf(o->largest, color[c]);
        o->fractions |= color[c] != floorf(color[c]);
    }
    o->alpha |= count == 4;
    return result ? result : slvi_obj_append(o, &o->colors, color, 4, sizeof *color);
}

/* A vertex may have a weight, a colour of three or four, or both; texture coordinates a depth. */
static slv_result read_rest(obj *o, int kind) {
    static const uint64_t most[OBJ_KINDS] = {5, 1, 0};
    double numbers[5];
    uint64_t count = slvi_obj_read_numbers(o, most[kind], numbers), weight = count == 5;
    slv_result result = SLV_OK;
    if (kind == OBJ_VERTEX && (count >= 3 || o->colors.count))
        result = add_color(o, numbers + weight, count >= 3 ? count - weight : 0);
    return result ? result : slvi_obj_end(o, keywords[kind], 0);
}

/* What printf makes of numbers that are none. */
static bool take_no_number(obj *o) {
    static const char *const forms[] = {"nan", "inf", "1.#"};
    slv_scan scan = o->scan;
    const char *word;
    if (!slvi_scan_more(&scan))
        return false;
    size_t length = slvi_scan_word(&scan, &word), sign = *word == '-' || *word == '+';
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
        if (length >= sign + 3 && strncasecmp(word + sign, forms[i], 3) == 0) {
            o->scan = scan;
            return true;
        }
    return false;
}

static slv_result read_value(obj *o, int kind) {
    float values[3] = {0, 0, 0}, rests[3];
    slv_result result = SLV_OK;
    for (unsigned i = 0; i < slvi_obj_kind_floats[kind]; i++) {
        if (kind == OBJ_TEXCOORD && i == 1 && !slvi_obj_more(o))
            break; /* a one-dimensional texture coordinate */
        double value = 0;
        /* faces without an area have such normals, and no face needs one */
        if (kind == OBJ_NORMAL && take_no_number(o)) {
            slvi_obj_tally(&o->no_numbers, o->line, NULL, 0);
            continue;
        }
        if ((result = slvi_obj_read_double(o, keywords[kind], &value)))
            return result;
        values[i] = (float)value;
        rests[i] = (float)(value - (double)values[i]);
    }
    if ((result = read_rest(o, kind)) ||
        (kind == OBJ_VERTEX && (result = slvi_obj_append(o, &o->rests, rests, 3, sizeof *rests))))
        return result;
    return slvi_obj_append(o, &o->values[kind], values, slvi_obj_kind_floats[kind], sizeof *values);
}

/* One index of a polygon's side, resolved to zero-based. Whether it is too large shows when all is
 * read. */
static slv_result read_index(obj *o, int kind, int32_t *out) {
    int64_t index;
    if (!slvi_scan_int(&o->scan, &index))
        return slvi_obj_fail(o, o->scan.line, "f: malformed %s index", kind_names[kind]);
    if (index == 0 || index > INT32_MAX || index < -(int64_t)slvi_obj_count(o, kind)) {
        if (kind == OBJ_VERTEX)
            return slvi_obj_fail(o, o->scan.line, "f: vertex index %lld, but there are %llu",
                                 (long long)index, (unsigned long long)slvi_obj_count(o, kind));
        slvi_obj_tally(&o->dangling[kind], o->scan.line, NULL, 0);
        *out = -1;
        return SLV_OK;
    }
    *out = (int32_t)(index > 0 ? index - 1 : (int64_t)slvi_obj_count(o, kind) + index);
    return SLV_OK;
}

static slv_result read_side(obj *o) {
    int32_t side[OBJ_KINDS] = {-1, -1, -1};
    slv_result result = read_index(o, OBJ_VERTEX, &side[OBJ_VERTEX]);
    for (int kind = OBJ_TEXCOORD; !result && kind <= OBJ_NORMAL && slvi_obj_take_slash(o); kind++)
        if (!slvi_scan_at_break(&o->scan) && *o->scan.next != '/')
            result = read_index(o, kind, &side[kind]);
    if (result)
        return result;
    if (!slvi_scan_at_break(&o->scan))
        return slvi_obj_fail(o, o->scan.line, "f: expected v, v/t, v//n or v/t/n");
    for (int kind = 0; !result && kind < OBJ_KINDS; kind++)
        result = slvi_obj_append(o, &o->indices[kind], &side[kind], 1, sizeof side[kind]);
    return result;
}

static slv_result read_polygon(obj *o) {
    slv_result result = SLV_OK;
    uint64_t first = o->indices[OBJ_VERTEX].count;
    while (slvi_scan_more(&o->scan))
        if ((result = read_side(o)))
            return result;
    uint64_t size = o->indices[OBJ_VERTEX].count - first;
    if (size < 3) {
        for (int kind = 0; kind < OBJ_KINDS; kind++)
            o->indices[kind].count = first;
        slvi_obj_tally(&o->not_polygons, o->line, NULL, 0);
        return SLV_OK;
    }
    if (size > INT32_MAX)
        return slvi_obj_fail(o, o->line, "f: too many vertices");
    int32_t size32 = (int32_t)size;
    if ((result = slvi_obj_append(o, &o->sizes, &size32, 1, sizeof size32)))
        return result;
    return slvi_obj_append(o, &o->poly_lines, &o->line, 1, sizeof o->line);
}

/* A group ends at the next g or o, an object at the next o. */
static void end_groups(obj *o, bool objects) {
    obj_group *groups = o->groups.items;
    for (uint64_t g = o->groups.count; g-- > 0;)
        if (groups[g].count == OBJ_OPEN && (objects || !groups[g].object))
            groups[g].count = (int32_t)o->sizes.count - groups[g].first;
    while (o->groups.count && groups[o->groups.count - 1].count == 0)
        o->groups.count--;
}

static slv_result begin_group(obj *o, bool object, const char *name, size_t length) {
    static const char terminator = 0;
    obj_group group = {(int32_t)o->sizes.count, OBJ_OPEN, o->letters.count, object};
    slv_result result;
    if ((result = slvi_obj_append(o, &o->letters, name, length, 1)) ||
        (result = slvi_obj_append(o, &o->letters, &terminator, 1, 1)))
        return result;
    return slvi_obj_append(o, &o->groups, &group, 1, sizeof group);
}

/* What follows on the line as it stands, blanks at both ends removed. Names and comments end where
 * their line does: a backslash there is the end of a folder's name, not a line to be continued. */
static size_t rest_of_line(obj *o, const char **text) {
    slv_scan *scan = &o->scan;
    while (scan->next < scan->end && (*scan->next == ' ' || *scan->next == '\t'))
        scan->next++;
    *text = scan->next;
    while (scan->next < scan->end && *scan->next != '\n' && *scan->next != '\r')
        scan->next++;
    size_t length = (size_t)(scan->next - *text);
    while (length && ((*text)[length - 1] == ' ' || (*text)[length - 1] == '\t'))
        length--;
    if (length && (*text)[length - 1] == '\\')
        slvi_obj_tally(&o->backslashes, scan->line, NULL, 0);
    return length;
}

/* g names any number of groups, which all have the polygons that follow. */
static slv_result read_groups(obj *o) {
    const char *text, *word;
    slv_result result = SLV_OK;
    end_groups(o, false);
    size_t length = rest_of_line(o, &text), size;
    slv_scan names = {text, text + length, 1};
    while (!result && slvi_scan_more(&names)) {
        size = slvi_scan_word(&names, &word);
        result = begin_group(o, false, word, size);
    }
    return result;
}

static slv_result read_object(obj *o) {
    const char *text;
    end_groups(o, true);
    size_t length = rest_of_line(o, &text);
    return length ? begin_group(o, true, text, length) : SLV_OK;
}

/* Statements of the format that a control mesh has no use for: neither curves nor surfaces that are
 * no polygons are among them, nor other files, for what is in those is lost. */
static bool is_ignored(const char *word, size_t length) {
    static const char *const known[] = {"s",        "p",      "l",          "vp",        "mtllib",
                                        "usemtl",   "usemap", "maplib",     "bevel",     "c_interp",
                                        "d_interp", "lod",    "shadow_obj", "trace_obj", "mg",
                                        "ctech",    "stech"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (slvi_obj_word_is(word, length, known[i]))
            return true;
    return false;
}

/* Passes a statement that is not looked at, with the lines that its backslashes join to it, but for
 * those which are statements themselves. */
static void skip_statement(obj *o) {
    slv_scan *scan = &o->scan;
    const char *text;
    for (;;) {
        uint64_t before = o->backslashes.count;
        size_t length = rest_of_line(o, &text);
        slv_scan following = *scan;
        slvi_scan_next_line(&following);
        if (!length || text[length - 1] != '\\' || following.next == scan->end ||
            slvi_obj_begins_statement(following))
            return;
        o->backslashes.count = before;
        *scan = following;
    }
}

/* Of the statements that only numbers follow, a face behind them would be lost. */
static slv_result check_numbers(const obj *o, const char *word, size_t length) {
    static const char *const numeric[] = {"s", "p", "l", "vp", "lod", "mg"};
    bool check = false;
    for (size_t i = 0; i < sizeof numeric / sizeof *numeric; i++)
        check = check || slvi_obj_word_is(word, length, numeric[i]);
    for (slv_scan scan = o->scan; check && slvi_scan_more(&scan) && scan.line == o->line;) {
        bool statement = slvi_obj_begins_statement(scan);
        const char *text;
        size_t size = slvi_scan_word(&scan, &text);
        if (statement)
            return slvi_obj_fail_joined(o, word, length, text, size);
    }
    return SLV_OK;
}

static bool is_name(const char *word, size_t length) {
    static const char *const known[] = {"mtllib",     "usemtl",    "usemap", "maplib",
                                        "shadow_obj", "trace_obj", "call",   "csh"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (slvi_obj_word_is(word, length, known[i]))
            return true;
    return false;
}

static slv_result read_other(obj *o, const char *word, size_t length) {
    const char *text;
    for (size_t i = 0; i < length; i++)
        if ((unsigned char)word[i] < 0x20 || (unsigned char)word[i] >= 0x7f)
            return slvi_obj_fail(o, o->line, "not a text of the OBJ format");
    if (!is_ignored(word, length))
        slvi_obj_tally(&o->other_statements, o->line, word, length);
    slv_result result = check_numbers(o, word, length);
    if (result)
        return result;
    if (is_name(word, length))
        rest_of_line(o, &text);
    else
        skip_statement(o);
    return SLV_OK;
}

static slv_result read_statement(obj *o) {
    const char *word;
    if (!slvi_scan_more(&o->scan))
        return SLV_OK;
    o->line = o->scan.line;
    size_t length = slvi_scan_word(&o->scan, &word);
    if (slvi_obj_word_is(word, length, "v"))
        return read_value(o, OBJ_VERTEX);
    if (slvi_obj_word_is(word, length, "vt"))
        return read_value(o, OBJ_TEXCOORD);
    if (slvi_obj_word_is(word, length, "vn"))
        return read_value(o, OBJ_NORMAL);
    if (slvi_obj_word_is(word, length, "f") || slvi_obj_word_is(word, length, "fo"))
        return read_polygon(o);
    if (slvi_obj_word_is(word, length, "g"))
        return read_groups(o);
    if (slvi_obj_word_is(word, length, "o"))
        return read_object(o);
    if (slvi_obj_word_is(word, length, "t"))
        return slvi_obj_read_tag(o);
    return read_other(o, word, length);
}

slv_result slvi_obj_parse(const slv_env *env, const char *name, const char *text, size_t size,
                          bool points, slv_mesh **out) {
    obj o = {.env = env, .name = name ? name : "mesh", .scan = {text, text + size, 1}};
    slv_result result = SLV_OK;
    *out = NULL;
    if (slv_text_encoding(text, size))
        return slvi_fail(env, SLV_ERROR_FORMAT, "%s: text in %s; save it as UTF-8", o.name,
                         slv_text_encoding(text, size));
    if (size >= 4 && memcmp(text, "Ptex", 4) == 0)
        return slvi_fail(env, SLV_ERROR_FORMAT, "%s: is a .ptx file and no mesh", o.name);
    if (size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) /* a byte order mark */
        o.scan.next += 3;
    while (!result && o.scan.next < o.scan.end) {
        const char *comment;
        o.at_statement = false;
        if ((result = read_statement(&o)))
            break;
        if (o.at_statement)
            continue;
        if (!slvi_scan_more(&o.scan) && o.scan.next < o.scan.end && *o.scan.next == '#')
            rest_of_line(&o, &comment);
        slvi_scan_next_line(&o.scan);
    }
    if (!result)
        result = slvi_obj_make_mesh(&o, points, out);
    obj_list *lists[] = {&o.rests,   &o.colors, &o.sizes,  &o.poly_lines, &o.creases,
                         &o.corners, &o.holes,  &o.groups, &o.letters};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        slvi_free(lists[i]->items);
    for (int kind = 0; kind < OBJ_KINDS; kind++) {
        slvi_free(o.values[kind].items);
        slvi_free(o.indices[kind].items);
    }
    return result;
}

slv_result slv_mesh_parse_obj(const slv_env *env, const char *name, const char *text, size_t size,
                              slv_mesh **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, slvi_obj_parse(&own, name, text, size, false, out));
}
