#include "mesh/mesh_data.h"
#include "mesh/obj/obj_scan.h"

#include "base/file.h"
#include "base/log.h"
#include "base/memory.h"

#include <stdarg.h>
#include <string.h>

/* An array that grows by doubling. */
typedef struct list {
    void *items;
    uint64_t count, capacity;
} list;

/* What a tag names, with the tag's line, since tags may stand before what they name. */
typedef struct tag {
    int32_t a, b;
    float sharpness;
    uint32_t line;
} tag;

enum { VERTEX, TEXCOORD, NORMAL, NKINDS };
static const char *const kind_names[NKINDS] = {"vertex", "texture", "normal"};
static const unsigned kind_floats[NKINDS] = {3, 2, 3};

typedef struct obj {
    const slv_env *env;
    const char *name;
    slv_scan scan;
    uint32_t line; /* where the statement began */

    list values[NKINDS];  /* float, kind_floats per item */
    list indices[NKINDS]; /* int32_t, one per side of a polygon, -1 where there is none */
    bool has_index[NKINDS];
    list sizes, poly_lines;              /* int32_t and uint32_t per polygon */
    list creases, corners, holes;        /* tag */
    list group_first, group_at, letters; /* int32_t, uint64_t (where in letters), char */
    slv_boundary boundary;
    bool skipped_tag, skipped_keyword;
} obj;

static slv_result fail_at(const obj *o, uint32_t line, const char *format, ...) SLV_PRINTF(3, 4);

static slv_result fail_at(const obj *o, uint32_t line, const char *format, ...) {
    char words[256];
    va_list args;
    va_start(args, format);
    vsnprintf(words, sizeof words, format, args);
    va_end(args);
    return slvi_fail(o->env, SLV_ERROR_FORMAT, "%s:%u: %s", o->name, line, words);
}

static slv_result append(obj *o, list *l, const void *items, uint64_t count, size_t size) {
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

static uint64_t kind_count(const obj *o, int kind) {
    return o->values[kind].count / kind_floats[kind];
}

static slv_result read_float(obj *o, const char *what, float *out) {
    if (!slvi_scan_more(&o->scan))
        return fail_at(o, o->scan.line, "%s: expected a number, found the line's end", what);
    slv_scan word = o->scan;
    if (slvi_scan_float(&o->scan, out) && slvi_scan_at_break(&o->scan))
        return SLV_OK;
    const char *text;
    size_t length = slvi_scan_word(&word, &text);
    return fail_at(o, o->scan.line, "%s: expected a finite number, found '%.*s'", what,
                   (int)(length < 40 ? length : 40), text);
}

static slv_result read_int(obj *o, const char *what, int32_t *out) {
    int64_t value;
    if (!slvi_scan_more(&o->scan))
        return fail_at(o, o->scan.line, "%s: expected an integer, found the line's end", what);
    slv_scan word = o->scan;
    if (slvi_scan_int(&o->scan, &value) && slvi_scan_at_break(&o->scan) && value >= INT32_MIN &&
        value <= INT32_MAX) {
        *out = (int32_t)value;
        return SLV_OK;
    }
    const char *text;
    size_t length = slvi_scan_word(&word, &text);
    return fail_at(o, o->scan.line, "%s: expected an integer, found '%.*s'", what,
                   (int)(length < 40 ? length : 40), text);
}

static slv_result read_value(obj *o, int kind) {
    static const char *const keywords[NKINDS] = {"v", "vt", "vn"};
    float values[3] = {0, 0, 0};
    slv_result result = SLV_OK;
    for (unsigned i = 0; i < kind_floats[kind]; i++) {
        if (kind == TEXCOORD && i == 1 && !slvi_scan_more(&o->scan))
            break; /* a one-dimensional texture coordinate */
        if ((result = read_float(o, keywords[kind], &values[i])))
            return result;
    }
    return append(o, &o->values[kind], values, kind_floats[kind], sizeof *values);
}

/* One index of a polygon's side, resolved to zero-based. Whether it is too large shows when all is
 * read. */
static slv_result read_index(obj *o, int kind, int32_t *out) {
    int64_t index;
    if (!slvi_scan_int(&o->scan, &index))
        return fail_at(o, o->scan.line, "f: malformed %s index", kind_names[kind]);
    if (index == 0 || index > INT32_MAX || index < -(int64_t)kind_count(o, kind))
        return fail_at(o, o->scan.line, "f: %s index %lld, but there are %llu", kind_names[kind],
                       (long long)index, (unsigned long long)kind_count(o, kind));
    *out = (int32_t)(index > 0 ? index - 1 : (int64_t)kind_count(o, kind) + index);
    o->has_index[kind] = true;
    return SLV_OK;
}

static bool take_slash(obj *o) {
    if (o->scan.next == o->scan.end || *o->scan.next != '/')
        return false;
    o->scan.next++;
    return true;
}

static slv_result read_side(obj *o) {
    int32_t side[NKINDS] = {-1, -1, -1};
    slv_result result = read_index(o, VERTEX, &side[VERTEX]);
    for (int kind = TEXCOORD; !result && kind <= NORMAL && take_slash(o); kind++)
        if (!slvi_scan_at_break(&o->scan) && *o->scan.next != '/')
            result = read_index(o, kind, &side[kind]);
    if (result)
        return result;
    if (!slvi_scan_at_break(&o->scan))
        return fail_at(o, o->scan.line, "f: expected v, v/t, v//n or v/t/n");
    for (int kind = 0; !result && kind < NKINDS; kind++)
        result = append(o, &o->indices[kind], &side[kind], 1, sizeof side[kind]);
    return result;
}

static slv_result read_polygon(obj *o) {
    slv_result result = SLV_OK;
    uint64_t first = o->indices[VERTEX].count;
    while (slvi_scan_more(&o->scan))
        if ((result = read_side(o)))
            return result;
    uint64_t size = o->indices[VERTEX].count - first;
    if (size < 3)
        return fail_at(o, o->line, "f: %u vertices, expected at least 3", (unsigned)size);
    if (size > INT32_MAX)
        return fail_at(o, o->line, "f: too many vertices");
    int32_t size32 = (int32_t)size;
    if ((result = append(o, &o->sizes, &size32, 1, sizeof size32)))
        return result;
    return append(o, &o->poly_lines, &o->line, 1, sizeof o->line);
}

static slv_result read_group(obj *o) {
    int32_t first = (int32_t)o->sizes.count;
    slv_result result = SLV_OK;
    uint64_t at = o->letters.count;
    const char *word, terminator = 0;
    while (!result && slvi_scan_more(&o->scan)) {
        size_t length = slvi_scan_word(&o->scan, &word);
        if (o->letters.count > at)
            result = append(o, &o->letters, " ", 1, 1);
        if (!result)
            result = append(o, &o->letters, word, length, 1);
    }
    if (result || (result = append(o, &o->letters, &terminator, 1, 1)))
        return result;
    /* A group that no polygon followed gives way to the next. */
    if (o->group_first.count &&
        ((int32_t *)o->group_first.items)[o->group_first.count - 1] == first) {
        o->group_first.count--;
        o->group_at.count--;
    }
    if ((result = append(o, &o->group_first, &first, 1, sizeof first)))
        return result;
    return append(o, &o->group_at, &at, 1, sizeof at);
}

/* Tags read `t name nints/nfloats/nstrings`, then that many of each. */
static slv_result read_tag_counts(obj *o, int64_t counts[3]) {
    counts[0] = counts[1] = counts[2] = 0;
    bool good = slvi_scan_more(&o->scan);
    for (int i = 0; good && i < 3; i++) {
        good = (i == 0 || take_slash(o)) && slvi_scan_int(&o->scan, &counts[i]) && counts[i] >= 0;
        if (good && i && slvi_scan_at_break(&o->scan))
            break;
    }
    if (!good || !slvi_scan_at_break(&o->scan))
        return fail_at(o, o->scan.line, "t: expected three counts such as 2/1/0");
    return SLV_OK;
}

/* `width` indices per item, and one sharpness for all items or one for each. */
static slv_result read_sharp_tag(obj *o, list *l, const int64_t counts[3], int width) {
    slv_result result = SLV_OK;
    uint64_t first = l->count;
    int64_t items = counts[0] / width;
    if (counts[0] % width || items < 1 || (counts[1] != 1 && counts[1] != items))
        return fail_at(o, o->line, "t: %lld indices do not go with %lld numbers",
                       (long long)counts[0], (long long)counts[1]);
    for (int64_t i = 0; i < items; i++) {
        tag item = {-1, -1, 0, o->line};
        if ((result = read_int(o, "t", &item.a)) ||
            (width == 2 && (result = read_int(o, "t", &item.b))) ||
            (result = append(o, l, &item, 1, sizeof item)))
            return result;
    }
    tag *tags = l->items;
    for (uint64_t i = first; i < l->count; i++) {
        if (i > first && counts[1] == 1) {
            tags[i].sharpness = tags[first].sharpness;
            continue;
        }
        if ((result = read_float(o, "t", &tags[i].sharpness)))
            return result;
        if (tags[i].sharpness < 0)
            return fail_at(o, o->line, "t: negative sharpness");
    }
    return SLV_OK;
}

static slv_result read_boundary_tag(obj *o, const int64_t counts[3]) {
    static const slv_boundary rules[] = {SLV_BOUNDARY_NONE, SLV_BOUNDARY_EDGE_AND_CORNER,
                                         SLV_BOUNDARY_EDGE_ONLY};
    int32_t rule;
    if (counts[0] != 1)
        return fail_at(o, o->line, "t interpolateboundary: expected one integer");
    slv_result result = read_int(o, "t interpolateboundary", &rule);
    if (result)
        return result;
    if (rule < 0 || rule > 2)
        return fail_at(o, o->line, "t interpolateboundary: expected 0, 1 or 2, found %d", rule);
    o->boundary = rules[rule];
    return SLV_OK;
}

static slv_result read_hole_tag(obj *o, const int64_t counts[3]) {
    slv_result result = SLV_OK;
    for (int64_t i = 0; !result && i < counts[0]; i++) {
        tag item = {-1, -1, 0, o->line};
        if (!(result = read_int(o, "t hole", &item.a)))
            result = append(o, &o->holes, &item, 1, sizeof item);
    }
    return result;
}

static bool word_is(const char *word, size_t length, const char *expected) {
    return strlen(expected) == length && memcmp(word, expected, length) == 0;
}

static slv_result read_tag(obj *o) {
    const char *word;
    int64_t counts[3];
    if (!slvi_scan_more(&o->scan))
        return fail_at(o, o->line, "t: expected the name of a tag");
    size_t length = slvi_scan_word(&o->scan, &word);
    slv_result result = read_tag_counts(o, counts);
    if (result)
        return result;
    if (word_is(word, length, "crease"))
        return read_sharp_tag(o, &o->creases, counts, 2);
    if (word_is(word, length, "corner"))
        return read_sharp_tag(o, &o->corners, counts, 1);
    if (word_is(word, length, "interpolateboundary"))
        return read_boundary_tag(o, counts);
    if (word_is(word, length, "hole"))
        return read_hole_tag(o, counts);
    if (!o->skipped_tag)
        slvi_logf(o->env, SLV_LOG_WARNING, "%s:%u: tag '%.*s' and others not known are skipped",
                  o->name, o->line, (int)(length < 40 ? length : 40), word);
    o->skipped_tag = true;
    return SLV_OK;
}

/* Statements of the format that a control mesh has no use for. */
static bool is_ignored(const char *word, size_t length) {
    static const char *const known[] = {
        "s",      "p",      "l",        "vp",       "mtllib", "usemtl",     "usemap",
        "maplib", "bevel",  "c_interp", "d_interp", "lod",    "shadow_obj", "trace_obj",
        "mg",     "cstype", "deg",      "bmat",     "step",   "curv",       "curv2",
        "surf",   "parm",   "trim",     "hole",     "scrv",   "sp",         "end",
        "con",    "ctech",  "stech",    "call",     "csh"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (word_is(word, length, known[i]))
            return true;
    return false;
}

static slv_result read_other(obj *o, const char *word, size_t length) {
    for (size_t i = 0; i < length; i++)
        if ((unsigned char)word[i] < 0x20 || (unsigned char)word[i] >= 0x7f)
            return fail_at(o, o->line, "not a text of the OBJ format");
    if (!is_ignored(word, length) && !o->skipped_keyword) {
        slvi_logf(o->env, SLV_LOG_WARNING, "%s:%u: '%.*s' and others not known are skipped",
                  o->name, o->line, (int)(length < 40 ? length : 40), word);
        o->skipped_keyword = true;
    }
    return SLV_OK;
}

static slv_result read_statement(obj *o) {
    const char *word;
    if (!slvi_scan_more(&o->scan) || *o->scan.next == '#')
        return SLV_OK;
    o->line = o->scan.line;
    size_t length = slvi_scan_word(&o->scan, &word);
    if (word_is(word, length, "v"))
        return read_value(o, VERTEX);
    if (word_is(word, length, "vt"))
        return read_value(o, TEXCOORD);
    if (word_is(word, length, "vn"))
        return read_value(o, NORMAL);
    if (word_is(word, length, "f") || word_is(word, length, "fo"))
        return read_polygon(o);
    if (word_is(word, length, "g") || word_is(word, length, "o"))
        return read_group(o);
    if (word_is(word, length, "t"))
        return read_tag(o);
    return read_other(o, word, length);
}

static slv_result check_indices(const obj *o) {
    uint64_t side = 0;
    for (uint64_t p = 0; p < o->sizes.count; p++) {
        uint64_t end = side + (uint64_t)((int32_t *)o->sizes.items)[p];
        for (; side < end; side++)
            for (int kind = 0; kind < NKINDS; kind++) {
                int32_t index = ((int32_t *)o->indices[kind].items)[side];
                if (index >= 0 && (uint64_t)index >= kind_count(o, kind))
                    return fail_at(o, ((uint32_t *)o->poly_lines.items)[p],
                                   "f: %s index %lld, but there are %llu", kind_names[kind],
                                   (long long)index + 1, (unsigned long long)kind_count(o, kind));
            }
    }
    return SLV_OK;
}

static slv_result check_tags(const obj *o, const list *l, const char *what, bool pairs,
                             uint64_t limit) {
    const tag *tags = l->items;
    for (uint64_t i = 0; i < l->count; i++) {
        int32_t bad = tags[i].a;
        bool good = bad >= 0 && (uint64_t)bad < limit;
        if (good && pairs) {
            bad = tags[i].b;
            good = bad >= 0 && (uint64_t)bad < limit;
        }
        if (!good)
            return fail_at(o, tags[i].line, "t %s: index %d, expected 0..%lld", what, bad,
                           (long long)limit - 1);
    }
    return SLV_OK;
}

/* The tags' fields as separate arrays, in one block: first indices, then sharpness. */
static slv_result split_tags(const obj *o, const list *l, int width, int32_t **indices,
                             float **sharpness) {
    const tag *tags = l->items;
    slv_result result =
        slvi_alloc(o->env, o->name, l->count * (uint64_t)width, sizeof **indices, indices);
    if (!result && sharpness)
        result = slvi_alloc(o->env, o->name, l->count, sizeof **sharpness, sharpness);
    if (result)
        return result;
    for (uint64_t i = 0; i < l->count; i++) {
        (*indices)[i * (uint64_t)width] = tags[i].a;
        if (width == 2)
            (*indices)[i * 2 + 1] = tags[i].b;
        if (sharpness)
            (*sharpness)[i] = tags[i].sharpness;
    }
    return SLV_OK;
}

static slv_result make_mesh(obj *o, slv_mesh **out) {
    slv_result result = SLV_OK;
    int32_t *crease_verts = NULL, *corner_verts = NULL, *hole_polys = NULL;
    float *crease_sharpness = NULL, *corner_sharpness = NULL;
    const char **names = NULL;
    uint64_t nverts = kind_count(o, VERTEX), npolys = o->sizes.count;
    if (!npolys)
        return slvi_fail(o->env, SLV_ERROR_FORMAT, "%s: holds no polygons", o->name);
    if ((result = check_indices(o)) ||
        (result = check_tags(o, &o->creases, "crease", true, nverts)) ||
        (result = check_tags(o, &o->corners, "corner", false, nverts)) ||
        (result = check_tags(o, &o->holes, "hole", false, npolys)) ||
        (result = split_tags(o, &o->creases, 2, &crease_verts, &crease_sharpness)) ||
        (result = split_tags(o, &o->corners, 1, &corner_verts, &corner_sharpness)) ||
        (result = split_tags(o, &o->holes, 1, &hole_polys, NULL)) ||
        (result = slvi_alloc(o->env, o->name, o->group_at.count, sizeof *names, &names)))
        goto done;
    if (nverts > INT32_MAX || npolys > INT32_MAX || kind_count(o, TEXCOORD) > INT32_MAX ||
        kind_count(o, NORMAL) > INT32_MAX || o->creases.count > INT32_MAX ||
        o->corners.count > INT32_MAX || o->holes.count > INT32_MAX) {
        result = slvi_fail(o->env, SLV_ERROR_LIMIT, "%s: more than %d elements of a kind", o->name,
                           INT32_MAX);
        goto done;
    }
    for (uint64_t g = 0; g < o->group_at.count; g++)
        names[g] = (const char *)o->letters.items + ((uint64_t *)o->group_at.items)[g];
    bool empty_group =
        o->group_first.count &&
        (uint64_t)((int32_t *)o->group_first.items)[o->group_first.count - 1] == npolys;
    slv_mesh_view view = {
        .nverts = (uint32_t)nverts,
        .positions = o->values[VERTEX].items,
        .npolys = (uint32_t)npolys,
        .poly_sizes = o->sizes.items,
        .poly_verts = o->indices[VERTEX].items,
        .ntexcoords = (uint32_t)kind_count(o, TEXCOORD),
        .texcoords = o->values[TEXCOORD].items,
        .poly_texcoords = o->has_index[TEXCOORD] ? o->indices[TEXCOORD].items : NULL,
        .nnormals = (uint32_t)kind_count(o, NORMAL),
        .normals = o->values[NORMAL].items,
        .poly_normals = o->has_index[NORMAL] ? o->indices[NORMAL].items : NULL,
        .ncreases = (uint32_t)o->creases.count,
        .crease_verts = crease_verts,
        .crease_sharpness = crease_sharpness,
        .ncorners = (uint32_t)o->corners.count,
        .corner_verts = corner_verts,
        .corner_sharpness = corner_sharpness,
        .nholes = (uint32_t)o->holes.count,
        .hole_polys = hole_polys,
        .boundary = o->boundary,
        .ngroups = (uint32_t)o->group_first.count - (empty_group ? 1 : 0),
        .group_names = names,
        .group_first = o->group_first.items,
    };
    result = slv_mesh_create(o->env, &view, out);
done:
    slvi_free(crease_verts);
    slvi_free(crease_sharpness);
    slvi_free(corner_verts);
    slvi_free(corner_sharpness);
    slvi_free(hole_polys);
    slvi_free(names);
    return result;
}

slv_result slv_mesh_parse_obj(const slv_env *env, const char *name, const char *text, size_t size,
                              slv_mesh **out) {
    obj o = {.env = env, .name = name ? name : "mesh", .scan = {text, text + size, 1}};
    slv_result result = SLV_OK;
    *out = NULL;
    if (size >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) /* a byte order mark */
        o.scan.next += 3;
    while (!result && o.scan.next < o.scan.end) {
        if (!(result = read_statement(&o)))
            slvi_scan_next_line(&o.scan);
    }
    if (!result)
        result = make_mesh(&o, out);
    list *lists[] = {&o.sizes, &o.poly_lines,  &o.creases,  &o.corners,
                     &o.holes, &o.group_first, &o.group_at, &o.letters};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        slvi_free(lists[i]->items);
    for (int kind = 0; kind < NKINDS; kind++) {
        slvi_free(o.values[kind].items);
        slvi_free(o.indices[kind].items);
    }
    return result;
}

slv_result slv_mesh_load_obj(const slv_env *env, const char *path, slv_mesh **out) {
    char *text = NULL;
    size_t size = 0;
    *out = NULL;
    slv_result result = slvi_file_read(env, path, &text, &size);
    if (!result)
        result = slv_mesh_parse_obj(env, path, text, size, out);
    slvi_free(text);
    return result;
}
