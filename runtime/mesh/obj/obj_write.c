/* Writing a mesh as an OBJ file. */
#include "mesh/mesh_data.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/output.h"

#include <inttypes.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* A line end in a name would start a statement, a blank another name. */
static void write_name(FILE *stream, const char *name) {
    fputc(' ', stream);
    for (; *name; name++)
        fputc((unsigned char)*name <= 0x20 || *name == '\\' || *name == '#' ? '_' : *name, stream);
}

/* The runs that cover the polygon being written. */
typedef struct open_groups {
    uint32_t *open;
    uint32_t count, begun; /* open; of all runs, how many have begun */
    uint32_t next_end;     /* the first polygon that one of the open ones does not cover */
} open_groups;

static uint32_t group_end(const slv_mesh_view *view, uint32_t group) {
    return (uint32_t)view->group_first[group] + (uint32_t)view->group_count[group];
}

/* One g with the names of all runs that cover a polygon, where one begins or ends. */
static void write_groups(FILE *stream, const slv_mesh_view *view, uint32_t poly, open_groups *o) {
    uint32_t kept = 0;
    if (poly < o->next_end &&
        (o->begun == view->ngroups || (uint32_t)view->group_first[o->begun] > poly))
        return;
    while (o->begun < view->ngroups && (uint32_t)view->group_first[o->begun] <= poly)
        o->open[o->count++] = o->begun++;
    o->next_end = UINT32_MAX;
    for (uint32_t i = 0; i < o->count; i++) {
        uint32_t end = group_end(view, o->open[i]);
        if (end <= poly)
            continue;
        o->open[kept++] = o->open[i];
        o->next_end = end < o->next_end ? end : o->next_end;
    }
    o->count = kept;
    fputc('g', stream);
    for (uint32_t i = 0; i < kept; i++)
        write_name(stream, view->group_names[o->open[i]]);
    fputc('\n', stream);
}

/* Behind a position, where programs look for it. */
static void write_color(FILE *stream, const slv_mesh_view *view, uint32_t vertex) {
    const float *color = view->colors ? view->colors + 4 * (size_t)vertex : NULL;
    for (int c = 0; color && !isnan(color[0]) && c < (view->colors_alpha ? 4 : 3); c++) {
        bool curved = view->colors_linear && c < 3;
        double x = (double)color[c];
        if (curved)
            x = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
        fprintf(stream, " %.9g", x);
    }
}

/* The decimal point is the locale's otherwise; nine digits give back the same float. */
static void write_mesh(FILE *stream, const slv_mesh *mesh, uint32_t *open) {
    const slv_mesh_view *view = &mesh->view;
    static const int rules[] = {-1, 0, 2, 1};
    open_groups groups = {.open = open, .next_end = UINT32_MAX};
    int digits = slvi_mesh_is_far(view) ? 15 : 9;
    for (uint32_t v = 0; v < view->nverts; v++) {
        const float *p = view->positions + 3 * (size_t)v;
        double x = (double)p[0] + view->origin[0], y = (double)p[1] + view->origin[1],
               z = (double)p[2] + view->origin[2];
        fprintf(stream, "v %.*g %.*g %.*g", digits, x, digits, y, digits, z);
        write_color(stream, view, v);
        fputc('\n', stream);
    }
    for (uint32_t i = 0; i < view->ntexcoords; i++)
        fprintf(stream, "vt %.9g %.9g\n", (double)view->texcoords[2 * (size_t)i],
                (double)view->texcoords[2 * (size_t)i + 1]);
    for (uint32_t p = 0; p < view->npolys; p++) {
        write_groups(stream, view, p, &groups);
        fputc('f', stream);
        for (uint32_t s = mesh->poly_first[p]; s < mesh->poly_first[p + 1]; s++) {
            fprintf(stream, " %" PRId64, (int64_t)view->poly_verts[s] + 1);
            if (view->poly_texcoords && view->poly_texcoords[s] >= 0)
                fprintf(stream, "/%" PRId64, (int64_t)view->poly_texcoords[s] + 1);
        }
        fputc('\n', stream);
    }
    for (uint32_t i = 0; i < view->ncreases; i++)
        fprintf(stream, "t crease 2/1/0 %" PRId32 " %" PRId32 " %.9g\n",
                view->crease_verts[2 * (size_t)i], view->crease_verts[2 * (size_t)i + 1],
                (double)view->crease_sharpness[i]);
    for (uint32_t i = 0; i < view->ncorners; i++)
        fprintf(stream, "t corner 1/1/0 %" PRId32 " %.9g\n", view->corner_verts[i],
                (double)view->corner_sharpness[i]);
    for (uint32_t i = 0; i < view->nholes; i++)
        fprintf(stream, "t hole 1/0/0 %" PRId32 "\n", view->hole_polys[i]);
    if (view->boundary)
        fprintf(stream, "t interpolateboundary 1/0/0 %d\n", rules[view->boundary]);
}

slv_result slv_mesh_save_obj(const slv_env *env, const slv_mesh *mesh, const char *path) {
    slv_output output;
    FILE *stream;
    uint32_t *open = NULL;
    slv_result result = slvi_output_begin(env, path, false, &output);
    if (result)
        return result;
    if ((result = slvi_output_stream(&output, &stream)) ||
        (result = slvi_alloc(env, path, mesh->view.ngroups, sizeof *open, &open)))
        goto done;
    locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!plain) {
        result = slvi_fail(env, SLV_ERROR_MEMORY, "%s: no memory for the C locale", path);
        goto done;
    }
    locale_t before = uselocale(plain);
    write_mesh(stream, mesh, open);
    uselocale(before);
    freelocale(plain);
    result = slvi_output_commit(&output, false);
done:
    slvi_free(open);
    slvi_output_discard(&output);
    return result;
}
