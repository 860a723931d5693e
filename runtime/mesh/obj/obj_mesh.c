/* From the statements of an OBJ file to a mesh: what indices name is looked up now that all is
 * read, and what was left out is told. */
#include "mesh/obj/obj_data.h"

#include "base/memory.h"
#include "mesh/mesh_data.h"

#include <string.h>

static const char *const kind_names[OBJ_KINDS] = {"vertex", "texture", "normal"};

/* A polygon needs its vertices; texture coordinates and normals it can do without. */
static slv_result check_indices(obj *o) {
    uint64_t side = 0;
    for (uint64_t p = 0; p < o->sizes.count; p++) {
        uint64_t end = side + (uint64_t)((int32_t *)o->sizes.items)[p];
        uint32_t line = ((uint32_t *)o->poly_lines.items)[p];
        for (; side < end; side++)
            for (int kind = 0; kind < OBJ_KINDS; kind++) {
                int32_t *index = &((int32_t *)o->indices[kind].items)[side];
                if (*index < 0 || (uint64_t)*index < slvi_obj_count(o, kind))
                    continue;
                if (kind == OBJ_VERTEX)
                    return slvi_obj_fail(o, line, "f: %s index %lld, but there are %llu",
                                         kind_names[kind], (long long)*index + 1,
                                         (unsigned long long)slvi_obj_count(o, kind));
                slvi_obj_tally(&o->dangling[kind], line, NULL, 0);
                *index = -1;
            }
    }
    return SLV_OK;
}

static bool any_index(const obj *o, int kind) {
    const int32_t *indices = o->indices[kind].items;
    for (uint64_t i = 0; i < o->indices[kind].count; i++)
        if (indices[i] >= 0)
            return true;
    return false;
}

static slv_result check_tags(const obj *o, const obj_list *l, const char *what, bool pairs,
                             uint64_t limit) {
    const obj_tag *tags = l->items;
    for (uint64_t i = 0; i < l->count; i++) {
        int32_t bad = tags[i].a;
        bool good = bad >= 0 && (uint64_t)bad < limit;
        if (good && pairs) {
            bad = tags[i].b;
            good = bad >= 0 && (uint64_t)bad < limit;
        }
        if (!good)
            return slvi_obj_fail(o, tags[i].line, "t %s: index %d, expected 0..%lld", what, bad,
                                 (long long)limit - 1);
    }
    return SLV_OK;
}

/* The tags' fields as separate arrays, in one block: first indices, then sharpness. */
static slv_result split_tags(const obj *o, const obj_list *l, int width, int32_t **indices,
                             float **sharpness) {
    const obj_tag *tags = l->items;
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

/* Closes what is open, and leaves out runs without polygons. */
static void close_groups(obj *o, int32_t npolys) {
    obj_group *groups = o->groups.items;
    uint64_t kept = 0;
    for (uint64_t g = 0; g < o->groups.count; g++) {
        if (groups[g].count == OBJ_OPEN)
            groups[g].count = npolys - groups[g].first;
        if (groups[g].count)
            groups[kept++] = groups[g];
    }
    o->groups.count = kept;
}

static void tell(const obj *o, const obj_tally *tally, const char *what) {
    if (tally->count)
        slvi_logf(o->env, SLV_LOG_WARNING, "%s:%u: %llu %s%s%s%s", o->name, tally->line,
                  (unsigned long long)tally->count, what, tally->word[0] ? ", the first '" : "",
                  tally->word, tally->word[0] ? "'" : "");
}

/* One line for each kind of thing, with the place of the first. */
static void tell_all(const obj *o) {
    tell(o, &o->dangling[OBJ_TEXCOORD],
         "indices of texture coordinates that the file does not hold are left out");
    tell(o, &o->dangling[OBJ_NORMAL],
         "indices of normals that the file does not hold are left out");
    tell(o, &o->no_numbers, "values of normals are no numbers, and taken for 0");
    tell(o, &o->not_polygons, "faces of fewer than three vertices are left out");
    tell(o, &o->backslashes, "lines end in a backslash, which is not taken to join the next line");
    tell(o, &o->extra_words, "words that follow the numbers of v, vt, vn or t are not read");
    tell(o, &o->other_tags, "tags not known are skipped");
    tell(o, &o->other_statements, "statements not known are skipped");
}

static slv_result check_counts(const obj *o) {
    const obj_list *lists[] = {&o->sizes, &o->creases, &o->corners, &o->holes, &o->groups};
    bool good = true;
    for (int kind = 0; kind < OBJ_KINDS; kind++)
        good = good && slvi_obj_count(o, kind) <= INT32_MAX;
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        good = good && lists[i]->count <= INT32_MAX;
    return good ? SLV_OK
                : slvi_fail(o->env, SLV_ERROR_LIMIT, "%s: more than %d elements of a kind", o->name,
                            INT32_MAX);
}

/* The groups' fields as separate arrays. */
static slv_result split_groups(const obj *o, const char ***names, int32_t **first,
                               int32_t **count) {
    const obj_group *groups = o->groups.items;
    slv_result result;
    if ((result = slvi_alloc(o->env, o->name, o->groups.count, sizeof **names, names)) ||
        (result = slvi_alloc(o->env, o->name, o->groups.count, sizeof **first, first)) ||
        (result = slvi_alloc(o->env, o->name, o->groups.count, sizeof **count, count)))
        return result;
    for (uint64_t g = 0; g < o->groups.count; g++) {
        (*names)[g] = (const char *)o->letters.items + groups[g].name;
        (*first)[g] = groups[g].first;
        (*count)[g] = groups[g].count;
    }
    return SLV_OK;
}

/* Some write bytes as they are. */
static void scale_colors(obj *o) {
    float *colors = o->colors.items;
    bool bytes = o->largest > 1 && o->largest <= 255 && !o->fractions;
    for (uint64_t i = 0; bytes && i < o->colors.count; i++)
        if (i % 4 < 3 || o->alpha)
            colors[i] /= 255;
}

slv_result slvi_obj_make_mesh(obj *o, bool points, slv_mesh **out) {
    slv_result result = SLV_OK;
    int32_t *crease_verts = NULL, *corner_verts = NULL, *hole_polys = NULL;
    int32_t *group_first = NULL, *group_count = NULL;
    float *crease_sharpness = NULL, *corner_sharpness = NULL;
    const char **names = NULL;
    uint64_t nverts = slvi_obj_count(o, OBJ_VERTEX), npolys = o->sizes.count;
    if (!npolys && !(points && nverts))
        return slvi_fail(o->env, SLV_ERROR_FORMAT, "%s: holds no %s", o->name,
                         points ? "points" : "polygons");
    if ((result = check_counts(o)) || (result = check_indices(o)))
        return result;
    close_groups(o, (int32_t)npolys);
    if ((result = check_tags(o, &o->creases, "crease", true, nverts)) ||
        (result = check_tags(o, &o->corners, "corner", false, nverts)) ||
        (result = check_tags(o, &o->holes, "hole", false, npolys)) ||
        (result = split_tags(o, &o->creases, 2, &crease_verts, &crease_sharpness)) ||
        (result = split_tags(o, &o->corners, 1, &corner_verts, &corner_sharpness)) ||
        (result = split_tags(o, &o->holes, 1, &hole_polys, NULL)) ||
        (result = split_groups(o, &names, &group_first, &group_count)))
        goto done;
    tell_all(o);
    scale_colors(o);
    double origin[3];
    if (slvi_mesh_find_origin(o->values[OBJ_VERTEX].items,
                              npolys ? o->indices[OBJ_VERTEX].items : NULL,
                              npolys ? o->indices[OBJ_VERTEX].count : nverts, origin))
        slvi_mesh_shift(o->values[OBJ_VERTEX].items, o->rests.items, nverts, origin);
    slv_mesh_view view = {
        .nverts = (uint32_t)nverts,
        .positions = o->values[OBJ_VERTEX].items,
        .npolys = (uint32_t)npolys,
        .poly_sizes = o->sizes.items,
        .poly_verts = o->indices[OBJ_VERTEX].items,
        .ntexcoords = (uint32_t)slvi_obj_count(o, OBJ_TEXCOORD),
        .texcoords = o->values[OBJ_TEXCOORD].items,
        .poly_texcoords = any_index(o, OBJ_TEXCOORD) ? o->indices[OBJ_TEXCOORD].items : NULL,
        .nnormals = (uint32_t)slvi_obj_count(o, OBJ_NORMAL),
        .normals = o->values[OBJ_NORMAL].items,
        .poly_normals = any_index(o, OBJ_NORMAL) ? o->indices[OBJ_NORMAL].items : NULL,
        .ncreases = (uint32_t)o->creases.count,
        .crease_verts = crease_verts,
        .crease_sharpness = crease_sharpness,
        .ncorners = (uint32_t)o->corners.count,
        .corner_verts = corner_verts,
        .corner_sharpness = corner_sharpness,
        .nholes = (uint32_t)o->holes.count,
        .hole_polys = hole_polys,
        .boundary = o->boundary,
        .ngroups = (uint32_t)o->groups.count,
        .group_names = names,
        .group_first = group_first,
        .group_count = group_count,
        .origin = {origin[0], origin[1], origin[2]},
        .colors = o->colors.count ? o->colors.items : NULL,
        .colors_alpha = o->alpha,
    };
    result = slv_mesh_create(o->env, &view, out);
done:
    slvi_free(crease_verts);
    slvi_free(crease_sharpness);
    slvi_free(corner_verts);
    slvi_free(corner_sharpness);
    slvi_free(hole_polys);
    slvi_free(names);
    slvi_free(group_first);
    slvi_free(group_count);
    return result;
}
