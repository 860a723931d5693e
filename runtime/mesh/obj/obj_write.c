#include "mesh/mesh_data.h"

#include "base/file.h"
#include "base/log.h"

#include <errno.h>
#include <inttypes.h>
#include <locale.h>
#include <stdio.h>
#include <string.h>

/* A line end in a name would start a statement. */
static void write_group(FILE *stream, const char *name) {
    fputs("g ", stream);
    for (; *name; name++)
        fputc((unsigned char)*name < 0x20 || *name == '\\' ? '_' : *name, stream);
    fputc('\n', stream);
}

/* The decimal point is the locale's otherwise; nine digits give back the same float. */
static void write_mesh(FILE *stream, const slv_mesh *mesh) {
    const slv_mesh_view *view = &mesh->view;
    static const int rules[] = {-1, 0, 2, 1};
    uint32_t group = 0;
    for (uint32_t v = 0; v < view->nverts; v++) {
        const float *p = view->positions + 3 * (size_t)v;
        fprintf(stream, "v %.9g %.9g %.9g\n", (double)p[0], (double)p[1], (double)p[2]);
    }
    for (uint32_t p = 0; p < view->npolys; p++) {
        for (; group < view->ngroups && (uint32_t)view->group_first[group] <= p; group++)
            write_group(stream, view->group_names[group]);
        fputc('f', stream);
        for (uint32_t s = mesh->poly_first[p]; s < mesh->poly_first[p + 1]; s++)
            fprintf(stream, " %" PRId64, (int64_t)view->poly_verts[s] + 1);
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
    slv_file_writer writer;
    slv_result result = slvi_file_writer_open(env, path, &writer);
    if (result)
        return result;
    locale_t plain = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!plain) {
        result = slvi_fail(env, SLV_ERROR_MEMORY, "%s: no memory for the C locale", path);
        goto done;
    }
    locale_t before = uselocale(plain);
    write_mesh(writer.stream, mesh);
    uselocale(before);
    freelocale(plain);
    if (ferror(writer.stream)) {
        result = slvi_fail(env, SLV_ERROR_IO, "%s: write failed: %s", path, strerror(errno));
        goto done;
    }
    return slvi_file_writer_commit(env, &writer);
done:
    slvi_file_writer_abandon(&writer);
    return result;
}
