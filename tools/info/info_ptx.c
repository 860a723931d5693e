/* What info says of a .ptx. */
#include "info/info.h"

#include <stdlib.h>
#include <string.h>

enum { RES_COUNT = SLV_MAX_LOG2_RES + 1, KEY_SHOWN = 60, STRING_SHOWN = 200, VALUES_SHOWN = 12 };

/* What the face table adds up to. */
struct summary {
    const slv_ptx *ptx;
    const slv_ptx_info *info;
    const char *path;
    unsigned nedges; /* of a face */
    uint64_t texels, boundary_edges;
    uint32_t constant, subfaces;
    uint32_t by_res[RES_COUNT][RES_COUNT]; /* faces by log2 of height and width */
    slv_mesh *mesh;                        /* the geometry inside, or NULL */
    slv_result geometry;
    info_levels *levels;
    info_sheet_layout sheet; /* if there is one */
};

static slv_result summarise(const slv_env *env, struct summary *s) {
    for (uint32_t f = 0; f < s->info->nfaces; f++) {
        slv_ptx_face face;
        slv_result result = slv_ptx_get_face(s->ptx, f, &face);
        if (!result && ((unsigned)face.res.u >= RES_COUNT || (unsigned)face.res.v >= RES_COUNT))
            result = output_fail(env, SLV_ERROR_FORMAT, "%s: face %u: resolution 2^%d x 2^%d",
                                 s->path, f, face.res.u, face.res.v);
        if (result)
            return result;
        s->texels += UINT64_C(1) << (face.res.u + face.res.v);
        s->by_res[face.res.v][face.res.u]++;
        s->constant += (face.flags & SLV_FACE_CONSTANT) != 0;
        s->subfaces += (face.flags & SLV_FACE_SUBFACE) != 0;
        for (unsigned e = 0; e < s->nedges; e++)
            s->boundary_edges += face.adjacency.face[e] < 0;
    }
    slv_result result = info_levels_make(env, s->ptx, &s->levels);
    return result ? result : slv_ptx_find_mesh(env, s->ptx, &s->mesh, &s->geometry);
}

static uint64_t texel_bytes(const struct summary *s) {
    return s->texels * s->info->nchannels * slv_type_size(s->info->type);
}

static double meta_value(const slv_ptx_meta *meta, uint32_t i) {
    switch (meta->type) {
    case SLV_META_STRING:
        break;
    case SLV_META_INT8:
        return ((const int8_t *)meta->values)[i];
    case SLV_META_INT16:
        return ((const int16_t *)meta->values)[i];
    case SLV_META_INT32:
        return ((const int32_t *)meta->values)[i];
    case SLV_META_FLOAT:
        return (double)((const float *)meta->values)[i];
    case SLV_META_DOUBLE:
        return ((const double *)meta->values)[i];
    }
    return 0;
}

static bool is_real(const slv_ptx_meta *meta) {
    return meta->type == SLV_META_FLOAT || meta->type == SLV_META_DOUBLE;
}

static void print_values(const slv_ptx_meta *meta) {
    fputs("    ", stdout);
    if (meta->type == SLV_META_STRING) {
        putchar('"');
        bool whole = output_terminal(stdout, meta->values, meta->count, STRING_SHOWN);
        fputs(whole ? "\"\n" : "\" ...\n", stdout);
        return;
    }
    for (uint32_t i = 0; i < meta->count && i < VALUES_SHOWN; i++)
        printf("%s%.*g", i ? " " : "", meta->type == SLV_META_FLOAT ? 7 : 15, meta_value(meta, i));
    fputs(meta->count > VALUES_SHOWN ? " ...\n" : "\n", stdout);
}

static void print_meta(const struct summary *s, bool values) {
    info_line("Metadata", s->info->nmeta == 1 ? "%u entry" : "%u entries", s->info->nmeta);
    for (uint32_t i = 0; i < s->info->nmeta; i++) {
        const slv_ptx_meta *meta = slv_ptx_get_meta(s->ptx, i);
        printf("  %-14s%-6s x %-9u ", "", slv_meta_type_name(meta->type), meta->count);
        if (!output_terminal(stdout, meta->key, strlen(meta->key), KEY_SHOWN))
            fputs("...", stdout);
        putchar('\n');
        if (values) {
            printf("  %-10s", "");
            print_values(meta);
        }
    }
}

static void print_resolutions(const struct summary *s) {
    const char *label = "Resolutions";
    for (uint32_t v = RES_COUNT; v-- > 0;)
        for (uint32_t u = RES_COUNT; u-- > 0;) {
            if (!s->by_res[v][u])
                continue;
            info_line(label, "%5u x %-5u %9u face%s", 1u << u, 1u << v, s->by_res[v][u],
                      s->by_res[v][u] == 1 ? "" : "s");
            label = "";
        }
}

static void print_geometry(const struct summary *s) {
    if (s->mesh) {
        const slv_mesh_view *view = slv_mesh_get_view(s->mesh);
        info_line("Geometry", "inside: %u polygons, %u vertices", view->npolys, view->nverts);
    } else if (s->geometry == SLV_ERROR_UNSUPPORTED) {
        info_line("Geometry", "none inside");
    } else {
        info_line("Geometry", "inside, but unusable: %s", slv_result_string(s->geometry));
    }
}

static void print_faces(const struct summary *s) {
    printf("  %8s %13s %9s  %-5s neighbours (face:edge over edges 0 to %u); flags: c constant, "
           "n neighbours constant, s sub-face, e edited\n",
           "face", "texels", "bytes", "flags", s->nedges - 1);
    for (uint32_t f = 0; f < s->info->nfaces; f++) {
        slv_ptx_face face;
        slv_ptx_block block;
        if (slv_ptx_get_face(s->ptx, f, &face) || slv_ptx_get_block(s->ptx, f, 0, &block))
            continue;
        printf("  %8u %5u x %-5u %9u  %c%c%c%c ", f, 1u << face.res.u, 1u << face.res.v,
               block.bytes, face.flags & SLV_FACE_CONSTANT ? 'c' : '-',
               face.flags & SLV_FACE_NEIGHBOURS_CONSTANT ? 'n' : '-',
               face.flags & SLV_FACE_SUBFACE ? 's' : '-', face.flags & SLV_FACE_EDITED ? 'e' : '-');
        info_print_adjacency(&face.adjacency, s->nedges);
    }
}

static void print_ptx(const struct summary *s, const info_options *options) {
    const slv_ptx_info *info = s->info;
    char a[32], b[32], alpha[32] = "no alpha";
    if (info->alpha_channel >= 0)
        snprintf(alpha, sizeof alpha, "alpha in channel %d", info->alpha_channel);
    info_title(s->path);
    info_line("Kind", ".ptx 1.%u, %s faces%s", info->minor_version,
              slv_ptx_mesh_type_name(info->mesh_type),
              info->has_edits ? ", edited after it was written" : "");
    info_line("Data", "%s, %u channel%s, %s", slv_type_name(info->type), info->nchannels,
              info->nchannels == 1 ? "" : "s", alpha);
    info_line("Faces", "%u, of them %u constant, %u sub-face%s", info->nfaces, s->constant,
              s->subfaces, s->subfaces == 1 ? "" : "s");
    info_line("Texels", "%llu, %s; the file has %s", (unsigned long long)s->texels,
              info_bytes(texel_bytes(s), a, sizeof a), info_bytes(info->file_bytes, b, sizeof b));
    print_resolutions(s);
    info_levels_print(s->levels);
    info_line("Boundary", "%llu of %llu face edges", (unsigned long long)s->boundary_edges,
              (unsigned long long)info->nfaces * s->nedges);
    info_line("Border modes", "%s in u, %s in v", slv_border_mode_name(info->border_u),
              slv_border_mode_name(info->border_v));
    info_line("Edge filter", "%s", slv_edge_filter_name(info->edge_filter));
    print_geometry(s);
    if (options->sheet) {
        printf("  %-14s", "Sheet");
        output_terminal(stdout, options->sheet, strlen(options->sheet), SIZE_MAX);
        printf(": %u x %u pixels, %u x %u cells of %u\n", s->sheet.width, s->sheet.height,
               s->sheet.columns, s->sheet.rows, s->sheet.cell);
    }
    print_meta(s, options->meta);
    if (options->faces)
        print_faces(s);
}

static json_t *values_json(const slv_ptx_meta *meta) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < meta->count; i++) {
        double value = meta_value(meta, i);
        list = info_append(list, is_real(meta) ? output_json_number(value)
                                               : json_integer((json_int_t)value));
    }
    return list;
}

static json_t *meta_json(const struct summary *s, bool values) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < s->info->nmeta; i++) {
        const slv_ptx_meta *meta = slv_ptx_get_meta(s->ptx, i);
        json_t *item =
            json_pack("{s:o, s:s, s:I}", "key", output_json_text(meta->key, strlen(meta->key)),
                      "type", slv_meta_type_name(meta->type), "count", (json_int_t)meta->count);
        if (values && item) {
            bool text = meta->type == SLV_META_STRING;
            json_t *value = text ? output_json_text(meta->values, meta->count) : values_json(meta);
            if (json_object_set_new(item, text ? "value" : "values", value)) {
                json_decref(item);
                item = NULL;
            }
        }
        list = info_append(list, item);
    }
    return list;
}

static json_t *resolutions_json(const struct summary *s) {
    json_t *list = json_array();
    for (uint32_t v = RES_COUNT; v-- > 0;)
        for (uint32_t u = RES_COUNT; u-- > 0;)
            if (s->by_res[v][u])
                list = info_append(list, json_pack("{s:I, s:I, s:I}", "width", (json_int_t)1 << u,
                                                   "height", (json_int_t)1 << v, "faces",
                                                   (json_int_t)s->by_res[v][u]));
    return list;
}

static json_t *levels_json(const slv_ptx_info *info) {
    json_t *list = json_array();
    for (uint32_t i = 0; i < info->nlevels; i++)
        list = info_append(list, json_integer(info->level_faces[i]));
    return list;
}

static json_t *faces_json(const struct summary *s) {
    json_t *list = json_array();
    for (uint32_t f = 0; f < s->info->nfaces; f++) {
        slv_ptx_face face;
        if (slv_ptx_get_face(s->ptx, f, &face))
            continue;
        slv_ptx_block block;
        if (slv_ptx_get_block(s->ptx, f, 0, &block))
            continue;
        json_t *item = json_pack(
            "{s:I, s:I, s:I, s:s, s:I, s:b, s:b, s:b, s:b}", "face", (json_int_t)f, "width",
            (json_int_t)1 << face.res.u, "height", (json_int_t)1 << face.res.v, "encoding",
            slv_ptx_encoding_name(block.encoding), "block_bytes", (json_int_t)block.bytes,
            "constant", (face.flags & SLV_FACE_CONSTANT) != 0, "neighbours_constant",
            (face.flags & SLV_FACE_NEIGHBOURS_CONSTANT) != 0, "subface",
            (face.flags & SLV_FACE_SUBFACE) != 0, "edited", (face.flags & SLV_FACE_EDITED) != 0);
        list = info_append(list, info_adjacency_json(&face.adjacency, s->nedges, item));
    }
    return list;
}

static json_t *geometry_json(const struct summary *s) {
    if (!s->mesh)
        return json_null();
    const slv_mesh_view *view = slv_mesh_get_view(s->mesh);
    return json_pack("{s:I, s:I}", "polygons", (json_int_t)view->npolys, "vertices",
                     (json_int_t)view->nverts);
}

static json_t *sheet_json(const struct summary *s, const char *path) {
    const info_sheet_layout *sheet = &s->sheet;
    return json_pack("{s:o, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:I}", "path",
                     output_json_name(path), "width", (json_int_t)sheet->width, "height",
                     (json_int_t)sheet->height, "columns", (json_int_t)sheet->columns, "rows",
                     (json_int_t)sheet->rows, "cell", (json_int_t)sheet->cell, "gap",
                     (json_int_t)sheet->gap, "faces", (json_int_t)sheet->faces, "shown",
                     (json_int_t)sheet->shown);
}

static json_t *ptx_json(const struct summary *s, const info_options *options) {
    const slv_ptx_info *info = s->info;
    char version[16];
    snprintf(version, sizeof version, "1.%u", info->minor_version);
    json_t *root = json_pack(
        "{s:i, s:s, s:o, s:s, s:s, s:s, s:I, s:o, s:I, s:I, s:o, s:s, s:s, s:s, s:b, s:I, s:I, "
        "s:I, "
        "s:I, s:I, s:I, s:o, s:o, s:o, s:o, s:o}",
        "schema", 1, "kind", "ptx", "path", output_json_name(s->path), "version", version,
        "mesh_type", slv_ptx_mesh_type_name(info->mesh_type), "data_type",
        slv_type_name(info->type), "channels", (json_int_t)info->nchannels, "alpha_channel",
        info->alpha_channel < 0 ? json_null() : json_integer(info->alpha_channel), "faces",
        (json_int_t)info->nfaces, "levels", (json_int_t)info->nlevels, "level_faces",
        levels_json(info), "border_u", slv_border_mode_name(info->border_u), "border_v",
        slv_border_mode_name(info->border_v), "edge_filter",
        slv_edge_filter_name(info->edge_filter), "has_edits", (int)info->has_edits, "file_bytes",
        (json_int_t)info->file_bytes, "texels", (json_int_t)s->texels, "texel_bytes",
        (json_int_t)texel_bytes(s), "constant_faces", (json_int_t)s->constant, "subfaces",
        (json_int_t)s->subfaces, "boundary_edges", (json_int_t)s->boundary_edges, "resolutions",
        resolutions_json(s), "geometry", geometry_json(s), "meta", meta_json(s, options->meta),
        "level_table", info_levels_json(s->levels), "edits", info_edits_json(s->levels));
    bool failed = options->faces && json_object_set_new(root, "face_table", faces_json(s));
    failed |= options->sheet && json_object_set_new(root, "sheet", sheet_json(s, options->sheet));
    if (failed) {
        json_decref(root);
        root = NULL;
    }
    return root;
}

int info_ptx(const cli_command *command, const slv_env *env, const char *path,
             const info_options *options) {
    slv_ptx *ptx = NULL;
    int code = EXIT_FAILED;
    struct summary s = {.path = path};
    if (slv_ptx_open(env, path, &ptx) || slv_ptx_load_tables(ptx))
        goto done;
    s.ptx = ptx;
    s.info = slv_ptx_get_info(ptx);
    s.nedges = s.info->mesh_type == SLV_PTX_TRIANGLE ? 3 : 4;
    if (options->sheet && (code = info_sheet(command, env, options, path, &s.sheet)))
        goto done;
    code = EXIT_FAILED;
    if (summarise(env, &s))
        goto done;
    if (options->json) {
        code = output_print_json(path, ptx_json(&s, options));
    } else {
        print_ptx(&s, options);
        code = EXIT_OK;
    }
done:
    free(s.levels);
    slv_mesh_destroy(s.mesh);
    slv_ptx_close(ptx);
    return code;
}
