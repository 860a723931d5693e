/* The elements of a PLY file: vertices with their positions, texture coordinates and
 * colours, and faces. All
 * others are passed over. */
#include "mesh/ply/ply_header.h"

#include "base/log.h"
#include "base/memory.h"
#include "mesh/mesh_data.h"
#include "mesh/text_scan.h"

#include <selvage/mesh.h>

#include <math.h>
#include <string.h>

/* What a vertex has; positions are required. */
enum { PLY_X, PLY_Y, PLY_Z, PLY_U, PLY_V, PLY_RED, PLY_GREEN, PLY_BLUE, PLY_ALPHA, PLY_VALUES };

typedef struct ply {
    const slv_env *env;
    const char *name;
    ply_header header;
    slv_scan scan;
    float *positions, *rests, *texcoords; /* rests: what positions lack of the file's numbers */
    float *colors;
    uint32_t nverts;
    bool has_texcoords, has_colors, has_alpha, light;
    int32_t *sizes, *verts;
    uint64_t npolys, nsides, polys_room, sides_room;
    uint64_t skipped, first_skipped; /* faces of fewer than three vertices */
} ply;

static slv_result cut_short(const ply *p, const ply_element *element, uint64_t item) {
    return slvi_fail(p->env, SLV_ERROR_FORMAT, "%s: %s %llu of %llu cannot be read", p->name,
                     element->name, (unsigned long long)item, (unsigned long long)element->count);
}

static bool read_binary(ply *p, ply_type type, double *out) {
    unsigned char bytes[8];
    unsigned size = slvi_ply_size(type);
    uint64_t bits = 0;
    if ((size_t)(p->scan.end - p->scan.next) < size)
        return false;
    memcpy(bytes, p->scan.next, size);
    p->scan.next += size;
    for (unsigned i = 0; i < size; i++)
        bits |= (uint64_t)bytes[i]
                << (8 * (p->header.format == PLY_LITTLE_ENDIAN ? i : size - 1 - i));
    if (type == PLY_FLOAT) {
        uint32_t half = (uint32_t)bits;
        float value;
        memcpy(&value, &half, sizeof value);
        *out = (double)value;
    } else if (type == PLY_DOUBLE) {
        memcpy(out, &bits, sizeof *out);
    } else {
        uint64_t sign = UINT64_C(1) << (8 * size - 1);
        bool negative = (type == PLY_INT8 || type == PLY_INT16 || type == PLY_INT32) && bits & sign;
        *out = (double)bits - (negative ? 2 * (double)sign : 0);
    }
    return true;
}

/* Words go on from line to line: writers break long rows. */
static bool next_word(slv_scan *scan) {
    while (!slvi_scan_more(scan)) {
        if (scan->next == scan->end || *scan->next == '#')
            return false;
        slvi_scan_next_line(scan);
    }
    return true;
}

/* A number; `out` may be NULL, and then any word will do for one. */
static bool read_number(ply *p, ply_type type, double *out) {
    double value = 0;
    if (p->header.format != PLY_ASCII) {
        if (!read_binary(p, type, &value))
            return false;
    } else if (!next_word(&p->scan)) {
        return false;
    } else if (!out) {
        const char *word;
        slvi_scan_word(&p->scan, &word);
    } else if (type >= PLY_FLOAT) {
        if (!slvi_scan_double(&p->scan, &value) || !slvi_scan_at_break(&p->scan))
            return false;
    } else {
        int64_t number;
        if (!slvi_scan_int(&p->scan, &number) || !slvi_scan_at_break(&p->scan))
            return false;
        value = (double)number;
    }
    if (out)
        *out = value;
    return true;
}

/* The number of a list's values, which is at most what the rest of the file can hold. */
static bool read_count(ply *p, const ply_property *property, uint64_t *out) {
    double count;
    if (!read_number(p, property->count_type, &count) || !(count >= 0) ||
        count > (double)(p->scan.end - p->scan.next))
        return false;
    *out = (uint64_t)count;
    return true;
}

static bool skip_property(ply *p, const ply_property *property) {
    uint64_t count = 1;
    if (property->is_list && !read_count(p, property, &count))
        return false;
    while (count--)
        if (!read_number(p, property->type, NULL))
            return false;
    return true;
}

static int value_of(const char *name) {
    static const char *const names[PLY_VALUES][4] = {{"x"},
                                                     {"y"},
                                                     {"z"},
                                                     {"s", "u", "texture_u", "tx"},
                                                     {"t", "v", "texture_v", "ty"},
                                                     {"red", "r", "diffuse_red"},
                                                     {"green", "g", "diffuse_green"},
                                                     {"blue", "b", "diffuse_blue"},
                                                     {"alpha", "a", "diffuse_alpha"}};
    for (int value = 0; value < PLY_VALUES; value++)
        for (int i = 0; i < 4 && names[value][i]; i++)
            if (strcmp(name, names[value][i]) == 0)
                return value;
    return -1;
}

/* Integers are parts of their largest. */
static double scale_of(ply_type type) {
    static const double largest[] = {127, 255, 32767, 65535, 2147483647, 4294967295, 1, 1};
    return 1 / largest[type];
}

/* What is wanted of what a vertex has, as an entry of PLY_VALUES; -1: nothing. */
static int wanted(const ply *p, const ply_property *property) {
    int value = property->is_list ? -1 : value_of(property->name);
    if (value >= PLY_RED)
        return p->has_colors && (value < PLY_ALPHA || p->has_alpha) ? value : -1;
    return value <= PLY_Z || p->has_texcoords ? value : -1;
}

static slv_result begin_vertices(ply *p, const ply_element *element) {
    const ply_property *properties = p->header.properties + element->first;
    bool has[PLY_VALUES] = {false};
    slv_result result;
    for (uint32_t i = 0; i < element->nproperties; i++) {
        int value = properties[i].is_list ? -1 : value_of(properties[i].name);
        if (value >= 0)
            has[value] = true;
        p->light |= value == PLY_RED && properties[i].type >= PLY_FLOAT;
    }
    if (!has[PLY_X] || !has[PLY_Y] || !has[PLY_Z])
        return slvi_fail(p->env, SLV_ERROR_FORMAT, "%s: vertices without x, y and z", p->name);
    if (p->positions || element->count > INT32_MAX ||
        element->count > (uint64_t)(p->scan.end - p->scan.next))
        return slvi_fail(p->env, SLV_ERROR_FORMAT, "%s: %llu vertices%s", p->name,
                         (unsigned long long)element->count,
                         p->positions ? " more" : ", for which the file is too short");
    p->nverts = (uint32_t)element->count;
    p->has_texcoords = has[PLY_U] && has[PLY_V];
    p->has_colors = has[PLY_RED] && has[PLY_GREEN] && has[PLY_BLUE];
    p->has_alpha = p->has_colors && has[PLY_ALPHA];
    if ((result = slvi_alloc(p->env, p->name, p->nverts, 3 * sizeof(float), &p->positions)) ||
        (result = slvi_alloc(p->env, p->name, p->nverts, 3 * sizeof(float), &p->rests)) ||
        (result = slvi_alloc(p->env, p->name, p->has_colors ? p->nverts : 0, 4 * sizeof(float),
                             &p->colors)))
        return result;
    return slvi_alloc(p->env, p->name, p->has_texcoords ? p->nverts : 0, 2 * sizeof(float),
                      &p->texcoords);
}

static slv_result read_vertices(ply *p, const ply_element *element) {
    const ply_property *properties = p->header.properties + element->first;
    slv_result result = begin_vertices(p, element);
    for (uint64_t vertex = 0; vertex < p->nverts && !result; vertex++) {
        double values[PLY_VALUES] = {0};
        values[PLY_ALPHA] = 1;
        for (uint32_t i = 0; i < element->nproperties; i++) {
            int value = wanted(p, &properties[i]);
            if (value >= 0 ? !read_number(p, properties[i].type, &values[value])
                           : !skip_property(p, &properties[i]))
                return cut_short(p, element, vertex);
            if (value >= PLY_RED)
                values[value] *= scale_of(properties[i].type);
        }
        for (int c = 0; c < 3; c++) {
            float position = (float)values[c];
            if (!isfinite(position))
                return slvi_fail(p->env, SLV_ERROR_FORMAT, "%s: vertex %llu is not finite", p->name,
                                 (unsigned long long)vertex);
            p->positions[3 * vertex + (uint64_t)c] = position;
            p->rests[3 * vertex + (uint64_t)c] = (float)(values[c] - (double)position);
        }
        for (int c = 0; p->has_texcoords && c < 2; c++) {
            float coordinate = (float)values[PLY_U + c];
            /* nothing here needs them, so that they are no reason to refuse the mesh */
            p->texcoords[2 * vertex + (uint64_t)c] = isfinite(coordinate) ? coordinate : 0;
        }
        for (int c = 0; p->has_colors && c < 4; c++)
            p->colors[4 * vertex + (uint64_t)c] = (float)values[PLY_RED + c];
    }
    return result;
}

static bool is_indices(const ply_property *property) {
    return property->is_list && (strcmp(property->name, "vertex_indices") == 0 ||
                                 strcmp(property->name, "vertex_index") == 0);
}

static slv_result make_room(ply *p, uint64_t sides) {
    slv_result result = SLV_OK;
    if (p->npolys == p->polys_room) {
        p->polys_room = p->polys_room ? 2 * p->polys_room : 256;
        result = slvi_grow(p->env, p->name, p->polys_room, sizeof *p->sizes, &p->sizes);
    }
    if (!result && sides > p->sides_room - p->nsides) {
        while (sides > p->sides_room - p->nsides)
            p->sides_room = p->sides_room ? 2 * p->sides_room : 1024;
        result = slvi_grow(p->env, p->name, p->sides_room, sizeof *p->verts, &p->verts);
    }
    return result;
}

static slv_result read_face(ply *p, const ply_element *element, const ply_property *property,
                            uint64_t face) {
    uint64_t size;
    if (!read_count(p, property, &size) || size > INT32_MAX)
        return cut_short(p, element, face);
    slv_result result = make_room(p, size);
    if (result)
        return result;
    for (uint64_t i = 0; i < size; i++) {
        double index;
        if (!read_number(p, property->type, &index))
            return cut_short(p, element, face);
        if (!(index >= 0 && index < INT32_MAX) || index != floor(index))
            return slvi_fail(p->env, SLV_ERROR_FORMAT, "%s: face %llu names vertex %.17g", p->name,
                             (unsigned long long)face, index);
        p->verts[p->nsides + i] = (int32_t)index;
    }
    if (size < 3) {
        if (!p->skipped++)
            p->first_skipped = face;
        return SLV_OK;
    }
    p->sizes[p->npolys++] = (int32_t)size;
    p->nsides += size;
    return SLV_OK;
}

static slv_result read_faces(ply *p, const ply_element *element) {
    const ply_property *properties = p->header.properties + element->first;
    for (uint64_t face = 0; element->nproperties && face < element->count; face++)
        for (uint32_t i = 0; i < element->nproperties; i++) {
            slv_result result = SLV_OK;
            if (is_indices(&properties[i]))
                result = read_face(p, element, &properties[i], face);
            else if (!skip_property(p, &properties[i]))
                result = cut_short(p, element, face);
            if (result)
                return result;
        }
    return SLV_OK;
}

static slv_result read_element(ply *p, const ply_element *element) {
    if (strcmp(element->name, "vertex") == 0)
        return read_vertices(p, element);
    if (strcmp(element->name, "face") == 0)
        return read_faces(p, element);
    if (strcmp(element->name, "tristrips") == 0)
        return slvi_fail(p->env, SLV_ERROR_UNSUPPORTED, "%s: triangle strips, not faces", p->name);
    const ply_property *properties = p->header.properties + element->first;
    for (uint64_t item = 0; element->nproperties && item < element->count; item++)
        for (uint32_t i = 0; i < element->nproperties; i++)
            if (!skip_property(p, &properties[i]))
                return cut_short(p, element, item);
    return SLV_OK;
}

/* What follows all that the header counts. */
static void tell_of_rest(ply *p) {
    uint64_t lines = 0, bytes = (uint64_t)(p->scan.end - p->scan.next);
    uint32_t first = 0;
    while (p->header.format == PLY_ASCII && p->scan.next < p->scan.end) {
        if (slvi_scan_more(&p->scan) && !lines++)
            first = p->scan.line;
        slvi_scan_next_line(&p->scan);
    }
    if (lines)
        slvi_logf(p->env, SLV_LOG_WARNING,
                  "%s:%u: %llu lines follow those that the header counts, and are left out",
                  p->name, first, (unsigned long long)lines);
    else if (p->header.format != PLY_ASCII && bytes > 2)
        slvi_logf(p->env, SLV_LOG_WARNING,
                  "%s: %llu bytes follow what the header counts, and are left out", p->name,
                  (unsigned long long)bytes);
}

static slv_result make_mesh(const ply *p, bool points, slv_mesh **out) {
    double origin[3];
    if (!p->npolys && !(points && p->nverts))
        return slvi_fail(p->env, SLV_ERROR_FORMAT, "%s: holds no %s", p->name,
                         points ? "points" : "polygons");
    if (p->npolys > INT32_MAX)
        return slvi_fail(p->env, SLV_ERROR_LIMIT, "%s: more than %d faces", p->name, INT32_MAX);
    for (uint64_t poly = 0, side = 0; poly < p->npolys; poly++)
        for (int32_t i = 0; i < p->sizes[poly]; i++, side++)
            if ((uint32_t)p->verts[side] >= p->nverts)
                return slvi_fail(p->env, SLV_ERROR_FORMAT,
                                 "%s: polygon %llu names vertex %d, but there are %u", p->name,
                                 (unsigned long long)poly, p->verts[side], p->nverts);
    if (p->skipped)
        slvi_logf(
            p->env, SLV_LOG_WARNING,
            "%s: %llu faces of fewer than three vertices are left out, the first is face %llu",
            p->name, (unsigned long long)p->skipped, (unsigned long long)p->first_skipped);
    if (slvi_mesh_find_origin(p->positions, p->npolys ? p->verts : NULL,
                              p->npolys ? p->nsides : p->nverts, origin))
        slvi_mesh_shift(p->positions, p->rests, p->nverts, origin);
    slv_mesh_view view = {.nverts = p->nverts,
                          .origin = {origin[0], origin[1], origin[2]},
                          .positions = p->positions,
                          .npolys = (uint32_t)p->npolys,
                          .poly_sizes = p->sizes,
                          .poly_verts = p->verts,
                          .ntexcoords = p->has_texcoords ? p->nverts : 0,
                          .texcoords = p->texcoords,
                          .poly_texcoords = p->has_texcoords ? p->verts : NULL,
                          .colors = p->has_colors ? p->colors : NULL,
                          .colors_linear = p->light,
                          .colors_alpha = p->has_alpha};
    return slv_mesh_create(p->env, &view, out);
}

slv_result slvi_ply_parse(const slv_env *env, const char *name, const char *bytes, size_t size,
                          bool points, slv_mesh **out) {
    ply p = {.env = env, .name = name ? name : "mesh"};
    *out = NULL;
    slv_result result = slvi_ply_read_header(env, p.name, bytes, size, &p.header);
    p.scan = (slv_scan){bytes + p.header.bytes, bytes + size, p.header.lines + 1};
    for (uint32_t i = 0; !result && i < p.header.nelements; i++)
        result = read_element(&p, &p.header.elements[i]);
    if (!result && !(result = make_mesh(&p, points, out)))
        tell_of_rest(&p);
    slvi_free(p.positions);
    slvi_free(p.rests);
    slvi_free(p.texcoords);
    slvi_free(p.colors);
    slvi_free(p.sizes);
    slvi_free(p.verts);
    return result;
}

slv_result slv_mesh_parse_ply(const slv_env *env, const char *name, const char *bytes, size_t size,
                              slv_mesh **out) {
    slv_env own = slvi_budget_begin(env);
    return slvi_budget_end(&own, slvi_ply_parse(&own, name, bytes, size, false, out));
}
