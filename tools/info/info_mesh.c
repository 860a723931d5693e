/* What info says of a mesh. */
#include "info/info.h"

#include <string.h>

static const char *const boundary_names[] = {
    [SLV_BOUNDARY_DEFAULT] = "default",
    [SLV_BOUNDARY_NONE] = "none",
    [SLV_BOUNDARY_EDGE_ONLY] = "edge-only",
    [SLV_BOUNDARY_EDGE_AND_CORNER] = "edge-and-corner",
};

enum { VALENCES = sizeof((slv_mesh_stats *)NULL)->nvalence / sizeof(uint32_t), GROUPS_SHOWN = 20 };

static void print_valences(const slv_mesh_stats *stats) {
    const char *label = "Valences";
    for (uint32_t v = 0; v < VALENCES; v++) {
        if (!stats->nvalence[v])
            continue;
        info_line(label, "%2u%s %9u vert%s", v, v + 1 == VALENCES ? "+" : " ", stats->nvalence[v],
                  stats->nvalence[v] == 1 ? "ex" : "ices");
        label = "";
    }
}

static void print_groups(const slv_mesh_view *view) {
    for (uint32_t g = 0; g < view->ngroups; g++) {
        if (g == GROUPS_SHOWN) {
            info_line("", "and %u more", view->ngroups - g);
            break;
        }
        printf("  %-14s", g ? "" : "Groups");
        output_terminal(stdout, view->group_names[g], strlen(view->group_names[g]), 60);
        printf(", %d polygon%s\n", view->group_count[g], view->group_count[g] == 1 ? "" : "s");
    }
}

static void print_faces(const slv_mesh *mesh, const slv_adjacency *adjacency) {
    const slv_mesh_face *faces = slv_mesh_faces(mesh);
    printf("  %8s %8s %4s %-5s neighbours (face:edge over edges 0 to 3)\n", "face", "polygon",
           "sub", "");
    for (uint32_t f = 0; f < slv_mesh_face_count(mesh); f++) {
        char sub[16] = "-";
        if (faces[f].sub >= 0)
            snprintf(sub, sizeof sub, "%d", faces[f].sub);
        printf("  %8u %8d %4s %-5s", f, faces[f].poly, sub,
               slv_mesh_face_is_hole(mesh, (int32_t)f) ? "hole" : "");
        info_print_adjacency(&slv_adjacency_faces(adjacency)[f], 4);
    }
}

static void print_mesh(const char *path, const slv_mesh *mesh, const slv_mesh_stats *stats) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    const float *low = stats->bounds_min, *high = stats->bounds_max;
    info_title(path);
    info_line("Kind", "control mesh");
    info_line("Polygons", "%u, of them %u hole%s", stats->npolys, stats->nholes,
              stats->nholes == 1 ? "" : "s");
    info_line("Faces", "%u, of them %u sub-face%s", stats->nfaces, stats->nsubfaces,
              stats->nsubfaces == 1 ? "" : "s");
    info_line("Vertices", "%u, of them %u extraordinary, %u in no polygon", stats->nverts,
              stats->nextraordinary, stats->nisolated_verts);
    print_valences(stats);
    info_line("Edges", "%u, of them %u boundary, %u non-manifold, %u flipped", stats->nedges,
              stats->nboundary_edges, stats->nnonmanifold_edges, stats->nflipped_edges);
    info_line("Sharpness", "%u crease edge%s, %u corner%s", view->ncreases,
              view->ncreases == 1 ? "" : "s", view->ncorners, view->ncorners == 1 ? "" : "s");
    info_line("Boundary rule", "%s", boundary_names[view->boundary]);
    info_line("Bounds", "%g %g %g to %g %g %g", (double)low[0], (double)low[1], (double)low[2],
              (double)high[0], (double)high[1], (double)high[2]);
    info_line("Also", "%u texture coordinates, %u normals", view->ntexcoords, view->nnormals);
    print_groups(view);
}

static json_t *vector_json(const float *v) {
    return json_pack("[o, o, o]", output_json_number((double)v[0]),
                     output_json_number((double)v[1]), output_json_number((double)v[2]));
}

static json_t *valences_json(const slv_mesh_stats *stats) {
    json_t *list = json_array();
    for (uint32_t v = 0; v < VALENCES; v++)
        if (stats->nvalence[v])
            list = info_append(list, json_pack("{s:I, s:I, s:b}", "valence", (json_int_t)v,
                                               "vertices", (json_int_t)stats->nvalence[v],
                                               "or_more", v + 1 == VALENCES));
    return list;
}

static json_t *groups_json(const slv_mesh_view *view) {
    json_t *list = json_array();
    for (uint32_t g = 0; g < view->ngroups; g++) {
        const char *name = view->group_names[g];
        list = info_append(list, json_pack("{s:o, s:I, s:I}", "name",
                                           output_json_text(name, strlen(name)), "first_polygon",
                                           (json_int_t)view->group_first[g], "polygons",
                                           (json_int_t)view->group_count[g]));
    }
    return list;
}

static json_t *faces_json(const slv_mesh *mesh, const slv_adjacency *adjacency) {
    const slv_mesh_face *faces = slv_mesh_faces(mesh);
    json_t *list = json_array();
    for (uint32_t f = 0; f < slv_mesh_face_count(mesh); f++) {
        json_t *sub = faces[f].sub < 0 ? json_null() : json_integer(faces[f].sub);
        json_t *item = json_pack("{s:I, s:I, s:o, s:b}", "face", (json_int_t)f, "polygon",
                                 (json_int_t)faces[f].poly, "sub", sub, "hole",
                                 (int)slv_mesh_face_is_hole(mesh, (int32_t)f));
        list = info_append(list, info_adjacency_json(&slv_adjacency_faces(adjacency)[f], 4, item));
    }
    return list;
}

static json_t *mesh_json(const char *path, const slv_mesh *mesh, const slv_mesh_stats *stats) {
    const slv_mesh_view *view = slv_mesh_get_view(mesh);
    return json_pack(
        "{s:i, s:s, s:o, s:I, s:I, s:I, s:I, s:I, s:I, s:I, s:o, s:I, s:I, s:I, s:I, s:I, s:I, "
        "s:s, "
        "s:o, s:o, s:I, s:I, s:o}",
        "schema", 1, "kind", "mesh", "path", output_json_name(path), "polygons",
        (json_int_t)stats->npolys, "vertices", (json_int_t)stats->nverts, "isolated_vertices",
        (json_int_t)stats->nisolated_verts, "faces", (json_int_t)stats->nfaces, "subfaces",
        (json_int_t)stats->nsubfaces, "holes", (json_int_t)stats->nholes, "extraordinary_vertices",
        (json_int_t)stats->nextraordinary, "valences", valences_json(stats), "edges",
        (json_int_t)stats->nedges, "boundary_edges", (json_int_t)stats->nboundary_edges,
        "nonmanifold_edges", (json_int_t)stats->nnonmanifold_edges, "flipped_edges",
        (json_int_t)stats->nflipped_edges, "creases", (json_int_t)view->ncreases, "corners",
        (json_int_t)view->ncorners, "boundary_rule", boundary_names[view->boundary], "bounds_min",
        vector_json(stats->bounds_min), "bounds_max", vector_json(stats->bounds_max),
        "texture_coordinates", (json_int_t)view->ntexcoords, "normals", (json_int_t)view->nnormals,
        "groups", groups_json(view));
}

int info_mesh(const slv_env *env, const char *path, const info_options *options) {
    slv_mesh *mesh = NULL;
    slv_adjacency *adjacency = NULL;
    slv_mesh_stats stats;
    int code = EXIT_FAILED;
    if (slv_mesh_load(env, path, &mesh) || slv_mesh_get_stats(env, mesh, &stats) ||
        (options->faces && slv_mesh_adjacency(env, mesh, &adjacency)))
        goto done;
    if (options->json) {
        json_t *root = mesh_json(path, mesh, &stats);
        if (options->faces &&
            json_object_set_new(root, "face_table", faces_json(mesh, adjacency))) {
            json_decref(root);
            root = NULL;
        }
        code = output_print_json(path, root);
    } else {
        print_mesh(path, mesh, &stats);
        if (options->faces)
            print_faces(mesh, adjacency);
        code = EXIT_OK;
    }
done:
    slv_adjacency_destroy(adjacency);
    slv_mesh_destroy(mesh);
    return code;
}
